//! Messages for Rhai's errors, with remedies.

mod parsing;
mod running;
mod told;

pub(super) use parsing::LONG_HEAD;
pub(super) use told::{Told, function_name, shortened};
