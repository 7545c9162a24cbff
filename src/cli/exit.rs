//! How a command fails, and the exit code that says so.

use std::process::ExitCode;

use rayreel::EngineError;
use rayreel::scene::{LoadError, ScriptMistake};

use super::print;

/// Why a command did not succeed.
#[derive(Debug)]
pub(super) enum Failure {
    /// A scene is wrong; shown as a compiler would.
    Scene(LoadError),
    /// A script of a scene is wrong; likewise.
    Script(Box<ScriptMistake>),
    /// Anything else, with its causes.
    Other(anyhow::Error),
    /// It was reported already.
    Reported,
    /// Ctrl-C, or a polite signal.
    Interrupted,
}

impl Failure {
    /// 130 after an interruption, as shells have it (128 + SIGINT); 1 for errors. Wrong usage exits with 2 on its own.
    pub(super) fn code(&self) -> ExitCode {
        match self {
            Self::Interrupted => ExitCode::from(130),
            Self::Scene(_) | Self::Script(_) | Self::Other(_) | Self::Reported => ExitCode::FAILURE,
        }
    }

    /// Tells the reason on standard error.
    pub(super) fn print(&self) {
        match self {
            Self::Scene(error) => print::error_line(&error.render(print::is_colorful())),
            Self::Script(mistake) => print::error_line(&mistake.render(print::is_colorful())),
            Self::Other(error) => print::error_line(&format!("{} {error:#}", print::error_word())),
            Self::Reported | Self::Interrupted => {}
        }
    }
}

impl From<anyhow::Error> for Failure {
    fn from(error: anyhow::Error) -> Self {
        Self::Other(error)
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        Self::Scene(error)
    }
}

impl From<EngineError> for Failure {
    fn from(error: EngineError) -> Self {
        match error {
            EngineError::Scene(error) => Self::Scene(error),
            EngineError::Script(mistake) => Self::Script(mistake.into()),
            error @ EngineError::UnknownComponent(_) => Self::Other(error.into()),
        }
    }
}
