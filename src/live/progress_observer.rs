//! Observation of the requested picture while it is rendered.

use std::ops::ControlFlow::{self, Break, Continue};
use std::sync::Arc;

use super::presenter::{FinishedRender, PictureKind, Presenter};
use super::preview_level::{Effort, PreviewLevel, RequestedPicture, Timings};
use super::published::Published;
use super::refresh_timer::RefreshTimer;
use super::state::{State, Times};
use super::worker::{LevelRole, NextTask};
use crate::color::Transfer;
use crate::trace::{Film, RenderJob};

/// The observer of the requested picture, which records its speed and shows unfinished pictures.
pub(super) struct ProgressObserver<'a> {
    /// State of the session when rendering began.
    pub(super) state: &'a State,
    pub(super) target: RequestedPicture,
    pub(super) transfer: Transfer,
    /// Offset from [`RefreshTimer::traced`] to the tracing time of the picture, in milliseconds.
    pub(super) traced_before: f64,
    pub(super) visits: &'a RefreshTimer,
    /// True if any part of the picture has been shown.
    pub(super) is_shown: &'a mut bool,
    pub(super) timings: &'a mut Timings,
    pub(super) presenter: &'a mut Presenter,
    pub(super) published: &'a Published,
    /// The last coarse picture of the displayed frame, and its time in milliseconds.
    pub(super) last_step: Option<(PreviewLevel, f64)>,
    /// The next task, if a visit stops the picture.
    pub(super) next: &'a mut NextTask,
}

impl ProgressObserver<'_> {
    /// Records the speed and progress of the picture, and shows it if that is due. Decides whether to continue the picture.
    pub(super) fn on_progress(&mut self, job: &RenderJob) -> ControlFlow<()> {
        let since = self.visits.now();
        self.visits.go_on();
        let traced = self.traced_before + self.visits.traced();
        self.timings.note(Effort::Whole, traced, rays(job.share(), self.target));
        let so_far = share_of_unfinished(job);
        // The speed now known may leave time for another coarse picture, which would be worse than an unfinished one that is already
        // shown.
        let step = self.last_step.filter(|_| !*self.is_shown);
        if let Some(finer) = step.and_then(|(step, took)| self.timings.finer(step, took, self.target)) {
            *self.next = NextTask::Step(finer, LevelRole::Between);
            return Break(());
        }
        self.published.update(|state| state.progress = so_far);
        let beneath = self.presenter.latest().map(|(_, film)| Arc::clone(film));
        if let Some(beneath) = beneath.filter(|_| self.visits.show()) {
            if !self.show(job.resolve_over(&beneath), so_far, traced) {
                *self.next = NextTask::Nothing;
                return Break(());
            }
            self.visits.shown(since);
            self.visits.go_on();
            *self.is_shown = true;
        }
        Continue(())
    }

    /// Publishes the unfinished picture. Returns whether this succeeded.
    fn show(&mut self, film: Film, so_far: f64, traced: f64) -> bool {
        let made = FinishedRender {
            film,
            transfer: self.transfer,
            kind: PictureKind::Coarse(so_far),
            times: Times { trace: traced, ..self.state.times },
            rays: self.state.rays,
            plan: None,
            warnings: Vec::new(),
            rendering: true,
        };
        self.presenter.present(self.state, made)
    }
}

/// Returns the finished fraction of an unfinished picture, at most 0.99. With adaptive sampling, the remaining work is unknown until the
/// picture is finished.
pub(super) fn share_of_unfinished(job: &RenderJob) -> f64 {
    job.share().min(0.99)
}

/// Returns the number of camera rays of a fraction of a picture, but at least the rays of one sample of a tile, which are lost when the
/// picture is stopped.
pub(super) fn rays(share: f64, target: RequestedPicture) -> u64 {
    const IN_HAND: u64 = 256;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let rays = (share * target.rays()) as u64;
    rays.max(IN_HAND)
}
