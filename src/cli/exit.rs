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
    /// Ctrl-C, or another polite signal; with the exit code that says which.
    Interrupted(u8),
}

impl Failure {
    /// 1 for errors. Wrong usage exits with 2 on its own.
    pub(super) fn code(&self) -> ExitCode {
        match self {
            Self::Interrupted(code) => ExitCode::from(*code),
            Self::Scene(_) | Self::Script(_) | Self::Other(_) | Self::Reported => ExitCode::FAILURE,
        }
    }

    /// Tells the reason on standard error.
    pub(super) fn print(&self) {
        match self {
            Self::Scene(error) => print::mistakes(|color| error.render(color)),
            Self::Script(mistake) => print::mistakes(|color| mistake.render(color)),
            Self::Other(error) => print::error(&format!("{error:#}")),
            Self::Reported | Self::Interrupted(_) => {}
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
