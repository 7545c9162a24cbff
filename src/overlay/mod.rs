//! Texts, scale bars and legends over a picture: placed at its borders, and drawn as vector shapes.
//!
//! ```text
//! PreparedOverlay -> blocks (layout: shapes relative to a block's top left) -> places at anchors -> trace::FilmOverlay
//! ```

mod layout;
mod letters;
mod ticks;

use std::sync::{Arc, Mutex, PoisonError};

use crate::color::Rgb;
use crate::trace::FilmOverlay;

/// The items over a picture at a moment, independent of the picture's size.
#[derive(Clone, Debug, Default)]
pub(crate) struct PreparedOverlay {
    items: Vec<PreparedItem>,
    /// The last drawing: a frame needs it for its fingerprint and for its film, and following frames often need the same.
    drawn: Arc<Mutex<Option<Arc<FilmOverlay>>>>,
}

/// A text, a scale bar or a legend at a moment.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PreparedItem {
    /// The content.
    pub(crate) content: PreparedContent,
    /// The place: 0 is left or top, 1 right or bottom, and 1/2 the centre between them, across and down.
    pub(crate) anchor: [f64; 2],
    /// The height of a line of text as a share of the picture's height.
    pub(crate) size: f64,
    /// The colour of letters and bars.
    pub(crate) color: Rgb,
    /// The opacity, greater than 0 and at most 1.
    pub(crate) opacity: f64,
}

/// The content of a [`PreparedItem`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PreparedContent {
    /// Lines of text.
    Text(String),
    /// A bar, with its length as a share of the picture's height, and the text below it.
    Bar(f64, String),
    /// The title of a legend, the colours of even steps, and the numbers of the first and the last of them.
    Ramp(String, Vec<Rgb>, [f64; 2]),
    /// The title of a legend, and the names of colours.
    Kinds(String, Vec<(String, Rgb)>),
}

impl PartialEq for PreparedOverlay {
    /// Compares the items. Equal ones have equal drawings.
    fn eq(&self, other: &Self) -> bool {
        self.items == other.items
    }
}

impl PreparedOverlay {
    /// Creates an overlay of these items.
    pub(crate) fn new(items: Vec<PreparedItem>) -> Self {
        Self { items, drawn: Arc::default() }
    }

    /// Returns the drawing for a film of a size; `None` without items.
    pub(crate) fn drawn(&self, size: (u32, u32)) -> Option<Arc<FilmOverlay>> {
        if self.items.is_empty() {
            return None;
        }
        let mut drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
        if drawn.as_ref().is_none_or(|film| film.size() != size) {
            *drawn = Some(Arc::new(self.draw(size)));
        }
        drawn.clone()
    }

    /// Draws all items. Items at the same anchor stand below each other, in order.
    fn draw(&self, size: (u32, u32)) -> FilmOverlay {
        let mut film = FilmOverlay::new(size);
        let (width, height) = (f64::from(size.0), f64::from(size.1));
        let margin = (layout::MARGIN * height).round();
        let mut rest: Vec<&PreparedItem> = self.items.iter().collect();
        while let Some(PreparedItem { anchor, .. }) = rest.first().copied() {
            let (there, others) = rest.into_iter().partition::<Vec<_>, _>(|item| item.anchor == *anchor);
            rest = others;
            let blocks = there.into_iter().map(|item| (layout::block(item, height), item.opacity));
            let blocks: Vec<_> = blocks.collect();
            let stack: f64 = blocks.iter().map(|(block, _)| block.size[1] + margin).sum::<f64>() - margin;
            let mut top = margin + anchor[1] * (height - 2.0 * margin - stack);
            for (block, opacity) in blocks {
                let left = margin + anchor[0] * (width - 2.0 * margin - block.size[0]);
                let place = [left.round(), top.round()];
                if opacity < 1.0 {
                    let mut drawn = FilmOverlay::new(size);
                    block.draw(&mut drawn, place);
                    film.cover_with(&drawn, opacity);
                } else {
                    block.draw(&mut film, place);
                }
                top += block.size[1] + margin;
            }
        }
        film
    }
}
