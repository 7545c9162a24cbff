//! Encoding, publishing and reporting of pictures.

use std::sync::Arc;
use std::time::Instant;

use super::event::{Event, Shown};
use super::published::{Picture, Published};
use super::state::{Mistakes, PictureInfo, Planned, State, Times};
use crate::color::Transfer;
use crate::output;
use crate::trace::Film;

/// A function that encodes a film as a file, or returns the reason for its failure.
type Encode = fn(&Film, Transfer) -> Result<Vec<u8>, String>;

/// The encoder and publisher of pictures, which also reports them.
pub(super) struct Presenter {
    published: Arc<Published>,
    emit: Box<dyn FnMut(Event) + Send>,
    encode: Encode,
    last_id: u64,
    latest: Option<(PictureInfo, Arc<Film>)>,
}

/// A finished picture.
pub(super) struct FinishedRender {
    pub(super) film: Film,
    pub(super) transfer: Transfer,
    pub(super) kind: PictureKind,
    /// Times of the phases, except encoding.
    pub(super) times: Times,
    pub(super) rays: u64,
    /// Effects of its frame, if known.
    pub(super) plan: Option<Vec<Planned>>,
    /// Faults of the scene, one line each.
    pub(super) warnings: Vec<String>,
    /// True if a better picture follows.
    pub(super) rendering: bool,
}

/// The kind of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PictureKind {
    /// A coarse or unfinished picture, with the fraction of the better picture that is finished, 0 to 1.
    Coarse(f64),
    /// A requested draft.
    Draft,
    /// A picture identical to one rendered to a file.
    Full,
}

impl Presenter {
    pub(super) fn new(published: Arc<Published>, emit: Box<dyn FnMut(Event) + Send>) -> Self {
        let encode: Encode =
            |film, transfer| output::encode_quickly(film, transfer).map_err(|error| error.to_string());
        Self { published, emit, encode, last_id: 0, latest: None }
    }

    pub(super) fn emit(&mut self, event: Event) {
        (self.emit)(event);
    }

    /// Returns the latest picture if it shows the current frame of the current scene.
    pub(super) fn latest(&self) -> Option<(PictureInfo, &Arc<Film>)> {
        let state = self.published.state();
        let (info, film) = self.latest.as_ref()?;
        (info.frame == state.frame && info.reloads == state.reloads).then_some((*info, film))
    }

    /// Encodes and publishes a picture. If encoding fails, reports a mistake of the frame and returns `false`.
    pub(super) fn present(&mut self, state: &State, made: FinishedRender) -> bool {
        let start = Instant::now();
        let png = match (self.encode)(&made.film, made.transfer) {
            Ok(png) => png,
            Err(error) => {
                let mistakes = Mistakes::of_picture(&error);
                self.published.update(|state| {
                    state.frame_mistakes = Some(mistakes.clone());
                    state.rendering = false;
                });
                self.emit(Event::NotShown(mistakes));
                return false;
            }
        };
        let FinishedRender { film, transfer, kind, mut times, rays, plan, warnings, rendering } = made;
        times.encode = Times::milliseconds(start.elapsed());
        let info = self.info(state, &film, kind);
        let film = Arc::new(film);
        self.latest = Some((info, Arc::clone(&film)));
        self.published.publish(Picture { info, png: png.into() });
        self.published.update(|state| {
            state.picture = Some(info);
            state.times = times;
            state.rays = rays;
            state.rendering = rendering;
            state.progress = match kind {
                PictureKind::Coarse(share) => share,
                PictureKind::Draft | PictureKind::Full => 1.0,
            };
            state.frame_mistakes = None;
            if let Some(plan) = plan {
                state.plan = plan;
                state.curve.clear();
            }
        });
        self.emit(Event::Shown(Shown { info, film, transfer, times, rays, warnings }));
        true
    }

    /// Reports a picture without publishing it.
    pub(super) fn report_only(&mut self, state: &State, made: FinishedRender) {
        let FinishedRender { film, transfer, kind, times, rays, warnings, .. } = made;
        let info = self.info(state, &film, kind);
        self.emit(Event::Shown(Shown { info, film: Arc::new(film), transfer, times, rays, warnings }));
    }

    fn info(&mut self, state: &State, film: &Film, kind: PictureKind) -> PictureInfo {
        self.last_id += 1;
        PictureInfo {
            id: self.last_id,
            frame: state.frame,
            reloads: state.reloads,
            width: film.width(),
            height: film.height(),
            film: state.film,
            full: kind == PictureKind::Full,
            coarse: matches!(kind, PictureKind::Coarse(_)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::*;

    #[test]
    fn a_picture_that_cannot_be_encoded_says_so_and_is_not_waited_for() {
        let state = State { rendering: true, ..State::default() };
        let published = Arc::new(Published::new(state.clone()));
        let (sender, events) = channel();
        let emit = move |event| sender.send(event).unwrap();
        let mut presenter = Presenter::new(Arc::clone(&published), Box::new(emit));
        let made = |kind| FinishedRender {
            film: Film::new(2, 1),
            transfer: Transfer::Classic,
            kind,
            times: Times::default(),
            rays: 0,
            plan: None,
            warnings: Vec::new(),
            rendering: kind != PictureKind::Full,
        };
        for kind in
            [PictureKind::Coarse(0.0), PictureKind::Coarse(0.5), PictureKind::Draft, PictureKind::Full]
        {
            published.update(|state| state.rendering = true);
            presenter.encode = |_, _| Err("no room".to_owned());
            assert!(!presenter.present(&state, made(kind)));
            let told = published.state();
            assert!(!told.rendering && told.frame_mistakes.unwrap().text.contains("no room"));
            assert!(matches!(events.try_recv(), Ok(Event::NotShown(_))));
            // The next picture can be shown again.
            presenter.encode = |_, _| Ok(Vec::new());
            assert!(presenter.present(&state, made(kind)));
            assert_eq!(published.state().frame_mistakes, None);
            assert!(matches!(events.try_recv(), Ok(Event::Shown(_))));
        }
    }
}
