//! Failures of commands and their exit codes.

use std::process::ExitCode;

use rayreel::EngineError;
use rayreel::scene::{LoadError, ScriptMistake};

use super::print;

/// The reason for the failure of a command.
#[derive(Debug)]
pub(super) enum Failure {
    /// A mistake in a scene, printed in the style of compiler errors.
    Scene(LoadError),
    /// A mistake in a script of a scene, printed in the style of compiler errors.
    Script(Box<ScriptMistake>),
    /// Any other error, with its causes.
    Other(anyhow::Error),
    /// An error of a command whose exit code 1 has another meaning, such as `compare`.
    Trouble(anyhow::Error),
    /// A failure that is already reported.
    Reported,
    /// Ctrl-C or another termination signal, with its exit code.
    Interrupted(u8),
}

impl Failure {
    /// Returns the exit code: 1 for errors, 2 for errors of `compare`, or the code of a signal. Usage errors exit with 2 earlier.
    pub(super) fn code(&self) -> ExitCode {
        match self {
            Self::Interrupted(code) => ExitCode::from(*code),
            Self::Trouble(_) => ExitCode::from(2),
            Self::Scene(_) | Self::Script(_) | Self::Other(_) | Self::Reported => ExitCode::FAILURE,
        }
    }

    /// Prints the reason on standard error.
    pub(super) fn print(&self) {
        match self {
            Self::Scene(error) => print::mistakes(|color| error.render(color)),
            Self::Script(mistake) => print::mistakes(|color| mistake.render(color)),
            Self::Other(error) | Self::Trouble(error) => print::error(&format!("{error:#}")),
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
            error @ (EngineError::UnknownComponent(_) | EngineError::Cloud(_) | EngineError::Cancelled) => {
                Self::Other(error.into())
            }
        }
    }
}
