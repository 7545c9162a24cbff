//! Messages for Rhai's errors, with remedies.

mod message;
mod parsing;
mod running;

pub(super) use message::{Message, function_name, shortened};
pub(super) use parsing::LONG_HEAD;
