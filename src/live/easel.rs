//! Encoding, publishing and reporting of pictures.

use std::sync::Arc;
use std::time::Instant;

use super::board::{Board, Picture};
use super::event::{Event, Shown};
use super::state::{Mistakes, PictureInfo, Planned, State, Times};
use crate::color::Transfer;
use crate::output;
use crate::trace::Film;

/// A function that encodes a film as a file, or returns the reason for its failure.
type Encode = fn(&Film, Transfer) -> Result<Vec<u8>, String>;

/// The encoder and publisher of pictures, which also reports them.
pub(super) struct Easel {
    board: Arc<Board>,
    tell: Box<dyn FnMut(Event) + Send>,
    encode: Encode,
    last_id: u64,
    latest: Option<(PictureInfo, Arc<Film>)>,
}

/// A finished picture.
pub(super) struct Made {
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

impl Easel {
    pub(super) fn new(board: Arc<Board>, tell: Box<dyn FnMut(Event) + Send>) -> Self {
        let encode: Encode =
            |film, transfer| output::encode_quickly(film, transfer).map_err(|error| error.to_string());
        Self { board, tell, encode, last_id: 0, latest: None }
    }

    pub(super) fn tell(&mut self, event: Event) {
        (self.tell)(event);
    }

    /// Returns the latest picture if it shows the current frame of the current scene.
    pub(super) fn latest(&self) -> Option<(PictureInfo, &Arc<Film>)> {
        let state = self.board.state();
        let (info, film) = self.latest.as_ref()?;
        (info.frame == state.frame && info.reloads == state.reloads).then_some((*info, film))
    }

    /// Encodes and publishes a picture. If encoding fails, reports a mistake of the frame and returns `false`.
    pub(super) fn put_up(&mut self, state: &State, made: Made) -> bool {
        let start = Instant::now();
        let png = match (self.encode)(&made.film, made.transfer) {
            Ok(png) => png,
            Err(error) => {
                let mistakes = Mistakes::of_picture(&error);
                self.board.change(|state| {
                    state.frame_mistakes = Some(mistakes.clone());
                    state.rendering = false;
                });
                self.tell(Event::NotShown(mistakes));
                return false;
            }
        };
        let Made { film, transfer, kind, mut times, rays, plan, warnings, rendering } = made;
        times.encode = Times::milliseconds(start.elapsed());
        let info = self.info(state, &film, kind);
        let film = Arc::new(film);
        self.latest = Some((info, Arc::clone(&film)));
        self.board.hang(Picture { info, png: png.into() });
        self.board.change(|state| {
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
        self.tell(Event::Shown(Shown { info, film, transfer, times, rays, warnings }));
        true
    }

    /// Reports a picture without publishing it.
    pub(super) fn hand_over(&mut self, state: &State, made: Made) {
        let Made { film, transfer, kind, times, rays, warnings, .. } = made;
        let info = self.info(state, &film, kind);
        self.tell(Event::Shown(Shown { info, film: Arc::new(film), transfer, times, rays, warnings }));
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
        let board = Arc::new(Board::new(state.clone()));
        let (sender, events) = channel();
        let tell = move |event| sender.send(event).unwrap();
        let mut easel = Easel::new(Arc::clone(&board), Box::new(tell));
        let made = |kind| Made {
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
            board.change(|state| state.rendering = true);
            easel.encode = |_, _| Err("no room".to_owned());
            assert!(!easel.put_up(&state, made(kind)));
            let told = board.state();
            assert!(!told.rendering && told.frame_mistakes.unwrap().text.contains("no room"));
            assert!(matches!(events.try_recv(), Ok(Event::NotShown(_))));
            // The next picture can be shown again.
            easel.encode = |_, _| Ok(Vec::new());
            assert!(easel.put_up(&state, made(kind)));
            assert_eq!(board.state().frame_mistakes, None);
            assert!(matches!(events.try_recv(), Ok(Event::Shown(_))));
        }
    }
}
