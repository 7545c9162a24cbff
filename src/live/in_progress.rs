//! Pictures being rendered: the requested one, and a full one in the background.

use std::time::Duration;

use super::commands::Detail;
use super::refresh_timer::RefreshTimer;
use crate::trace::RenderJob;

/// The requested picture while it is being rendered.
pub(super) struct RenderInProgress {
    pub(super) frame: u32,
    pub(super) detail: Detail,
    pub(super) job: Option<RenderJob>,
    pub(super) traced: Duration,
    /// True if any part of the picture has been shown.
    pub(super) is_shown: bool,
    /// Schedule of the visits to the picture. Interrupting commands do not postpone them.
    pub(super) visits: RefreshTimer,
}

impl RenderInProgress {
    pub(super) fn new(frame: u32, detail: Detail) -> Self {
        Self {
            frame,
            detail,
            job: None,
            traced: Duration::ZERO,
            is_shown: false,
            visits: RefreshTimer::new(),
        }
    }
}

/// A full picture that is rendered while other pictures are shown.
pub(super) struct BackgroundRender {
    pub(super) frame: u32,
    pub(super) job: Option<RenderJob>,
    pub(super) traced: Duration,
}
