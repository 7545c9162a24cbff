//! Texts, scale bars and legends over a picture: placed at its corners, and drawn as vector shapes.
//!
//! ```text
//! PreparedOverlay -> blocks (layout: shapes relative to a block's top left) -> places at corners -> trace::FilmOverlay
//! ```

mod layout;
mod letters;
mod ticks;

use crate::color::Rgb;
use crate::trace::FilmOverlay;

/// The items over a picture at a moment, independent of the picture's size.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PreparedOverlay(pub(crate) Vec<PreparedItem>);

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

impl PreparedOverlay {
    /// Draws all items for a film of a size. Items at the same place stand below each other, in order.
    #[must_use]
    pub(crate) fn drawn(&self, size: (u32, u32)) -> FilmOverlay {
        let mut film = FilmOverlay::new(size);
        let (width, height) = (f64::from(size.0), f64::from(size.1));
        let margin = (layout::MARGIN * height).round();
        let mut is_placed = vec![false; self.0.len()];
        for first in 0..self.0.len() {
            if is_placed[first] {
                continue;
            }
            let anchor = self.0[first].anchor;
            let there: Vec<usize> =
                (first..self.0.len()).filter(|item| self.0[*item].anchor == anchor).collect();
            there.iter().for_each(|item| is_placed[*item] = true);
            let blocks: Vec<_> = there.iter().map(|item| layout::block(&self.0[*item], height)).collect();
            let gaps = margin * (blocks.len() - 1) as f64;
            let stack: f64 = blocks.iter().map(|block| block.size[1]).sum::<f64>() + gaps;
            let mut top = margin + anchor[1] * (height - 2.0 * margin - stack);
            for block in blocks {
                let left = margin + anchor[0] * (width - 2.0 * margin - block.size[0]);
                block.draw(&mut film, [left.round(), top.round()]);
                top += block.size[1] + margin;
            }
        }
        film
    }
}
