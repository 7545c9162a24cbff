//! Errors that `main` prints as their message. A program prints the error that its `main` returns with `Debug`, whose derived form is the
//! structure of the error, not its message.

/// Implements `Debug` as the message of an error, followed by those of its causes.
macro_rules! debug_as_message {
    ($error:ty) => {
        impl std::fmt::Debug for $error {
            fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(formatter, "{self}")?;
                let mut cause = std::error::Error::source(self);
                while let Some(error) = cause {
                    write!(formatter, ": {error}")?;
                    cause = error.source();
                }
                Ok(())
            }
        }
    };
}
