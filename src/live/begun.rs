//! Pictures in the making: the requested one, and a full one made beside others.

use std::time::Duration;

use super::mailbox::Detail;
use super::visits::Visits;
use crate::trace::Exposure;

/// The requested picture in the making.
pub(super) struct Begun {
    pub(super) frame: u32,
    pub(super) detail: Detail,
    pub(super) exposure: Option<Exposure>,
    pub(super) traced: Duration,
    /// Whether any of it has been shown.
    pub(super) is_shown: bool,
    /// The times at which it is looked at; commands that come in between do not postpone them.
    pub(super) visits: Visits,
}

impl Begun {
    pub(super) fn new(frame: u32, detail: Detail) -> Self {
        Self { frame, detail, exposure: None, traced: Duration::ZERO, is_shown: false, visits: Visits::new() }
    }
}

/// A full picture that is made while others are on show.
pub(super) struct Aside {
    pub(super) frame: u32,
    pub(super) exposure: Option<Exposure>,
    pub(super) traced: Duration,
}
