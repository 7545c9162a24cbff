//! Pictures being rendered: the requested one, and a full one in the background.

use std::time::Duration;

use super::mailbox::Detail;
use super::visits::Visits;
use crate::trace::Exposure;

/// The requested picture while it is being rendered.
pub(super) struct Begun {
    pub(super) frame: u32,
    pub(super) detail: Detail,
    pub(super) exposure: Option<Exposure>,
    pub(super) traced: Duration,
    /// True if any part of the picture has been shown.
    pub(super) is_shown: bool,
    /// Schedule of the visits to the picture. Interrupting commands do not postpone them.
    pub(super) visits: Visits,
}

impl Begun {
    pub(super) fn new(frame: u32, detail: Detail) -> Self {
        Self { frame, detail, exposure: None, traced: Duration::ZERO, is_shown: false, visits: Visits::new() }
    }
}

/// A full picture that is rendered while other pictures are shown.
pub(super) struct Aside {
    pub(super) frame: u32,
    pub(super) exposure: Option<Exposure>,
    pub(super) traced: Duration,
}
