//! The shapes of an item, relative to the top left of its block.

use super::{PreparedContent, PreparedItem, letters, ticks};
use crate::color::Rgb;
use crate::trace::FilmOverlay;

/// The distance from the border of the picture and between items, as a share of the picture's height.
pub(super) const MARGIN: f64 = 0.025;

/// Maximum length of a scale bar in pixels, more than any picture is wide.
const LONGEST_BAR: f64 = (1 << 20) as f64;

/// Maximum height of a line in pixels. A letter takes memory for its whole square.
const HIGHEST_LINE: f64 = 4096.0;

/// An item, laid out in pixels.
pub(super) struct Block {
    /// Width and height.
    pub(super) size: [f64; 2],
    shapes: Vec<BlockShape>,
    /// The height of a line of text.
    line: f64,
    color: Rgb,
}

/// A shape with its top left.
enum BlockShape {
    Text([f64; 2], String),
    /// A rectangle of a size with colours of even steps from left to right, or with the item's.
    Bar([f64; 2], [f64; 2], Vec<Rgb>),
    /// A disc that fills a square of this side.
    Disc([f64; 2], f64, Rgb),
}

/// Lays out an item for a picture of a height.
pub(super) fn block(item: &PreparedItem, height: f64) -> Block {
    let line = (item.size * height).min(HIGHEST_LINE);
    let mut block = Block { size: [0.0; 2], shapes: Vec::new(), line, color: item.color };
    match &item.content {
        PreparedContent::Text(text) => {
            block.lines(text, item.anchor[0]);
        }
        PreparedContent::Bar(length, label) => block.scale_bar((length * height).min(LONGEST_BAR), label),
        PreparedContent::Ramp(title, colors, range) => {
            block.title(title);
            block.ramp(colors, *range);
        }
        PreparedContent::Kinds(title, kinds) => {
            block.title(title);
            kinds.iter().for_each(|(name, color)| block.kind(name, *color));
        }
    }
    block
}

impl Block {
    /// Draws the shapes, with the top left of the block at a pixel.
    pub(super) fn draw(&self, film: &mut FilmOverlay, [left, top]: [f64; 2]) {
        let at = |[x, y]: [f64; 2]| [left + x, top + y];
        for shape in &self.shapes {
            match shape {
                BlockShape::Text(place, words) => {
                    letters::draw(film, words, self.line, at(*place), self.color);
                }
                BlockShape::Bar(place, size, colors) => bar(film, at(*place), *size, colors, self.color),
                BlockShape::Disc(place, side, color) => disc(film, at(*place), *side, *color),
            }
        }
    }

    /// Adds lines of text: left, centred or right within the widest one, as `side` is 0, 1/2 or 1.
    fn lines(&mut self, text: &str, side: f64) {
        let width = |words: &str| letters::width(words, self.line);
        let lines: Vec<(&str, f64)> = text.split('\n').map(|words| (words, width(words))).collect();
        let widest = lines.iter().map(|(_, width)| *width).fold(0.0, f64::max);
        for (words, width) in lines {
            self.shapes.push(BlockShape::Text([side * (widest - width), self.size[1]], words.to_owned()));
            self.grow(widest, self.line);
        }
    }

    fn title(&mut self, title: &str) {
        if !title.is_empty() {
            self.lines(title, 0.0);
        }
    }

    /// Adds a bar, with a text centred below it.
    fn scale_bar(&mut self, length: f64, label: &str) {
        let width = letters::width(label, self.line);
        let whole = width.max(length);
        let thickness = (0.15 * self.line).max(1.0);
        self.shapes.push(BlockShape::Bar(
            [(whole - length) / 2.0, self.size[1]],
            [length, thickness],
            Vec::new(),
        ));
        self.grow(whole, thickness);
        if label.is_empty() {
            return;
        }
        self.shapes.push(BlockShape::Text([(whole - width) / 2.0, self.size[1]], label.to_owned()));
        self.grow(whole, self.line);
    }

    /// Adds a bar of colours, with numbers below it.
    fn ramp(&mut self, colors: &[Rgb], range: [f64; 2]) {
        let (width, height) = (9.0 * self.line, 0.6 * self.line);
        let numbers = ticks::ticks(range);
        let widths: Vec<f64> = numbers.iter().map(|(_, text)| letters::width(text, self.line)).collect();
        // Numbers stand below their colours, and may reach beyond the ends of the bar.
        let beyond = |end: f64| {
            let beyond = |((share, _), text_width): (&(f64, String), &f64)| {
                text_width / 2.0 - (share - end).abs() * width
            };
            numbers.iter().zip(&widths).map(beyond).fold(0.0, f64::max)
        };
        let (left, right) = (beyond(0.0), beyond(1.0));
        let top = self.size[1] + 0.15 * self.line;
        self.shapes.push(BlockShape::Bar([left, top], [width, height], colors.to_vec()));
        let mark = [(0.05 * self.line).max(1.0), 0.2 * self.line];
        // Long numbers would touch each other: only every second mark has one then, or every third.
        let widest = widths.iter().copied().fold(0.0, f64::max) + 0.4 * self.line;
        let spacing = numbers.windows(2).map(|pair| (pair[1].0 - pair[0].0).abs() * width).next();
        let is_apart = |every: &usize| spacing.is_none_or(|spacing| widest <= *every as f64 * spacing);
        let every = (1..numbers.len()).find(is_apart).unwrap_or(numbers.len());
        for (index, ((share, text), text_width)) in numbers.iter().zip(&widths).enumerate() {
            let x = left + share * width;
            self.shapes.push(BlockShape::Bar([x - mark[0] / 2.0, top + height], mark, Vec::new()));
            if index % every != 0 {
                continue;
            }
            let place = [x - text_width / 2.0, top + height + mark[1]];
            self.shapes.push(BlockShape::Text(place, text.clone()));
        }
        let labels = if numbers.is_empty() { 0.0 } else { mark[1] + self.line };
        self.grow(left + width + right, 0.15 * self.line + height + labels);
    }

    /// Adds a disc of a colour, with its name beside it.
    fn kind(&mut self, name: &str, color: Rgb) {
        let side = 0.7 * self.line;
        self.shapes.push(BlockShape::Disc([0.0, self.size[1] + 0.15 * self.line], side, color));
        let left = side + 0.35 * self.line;
        self.shapes.push(BlockShape::Text([left, self.size[1]], name.to_owned()));
        self.grow(left + letters::width(name, self.line), self.line);
    }

    fn grow(&mut self, width: f64, height: f64) {
        self.size = [self.size[0].max(width), self.size[1] + height];
    }
}

/// Draws a rectangle whose sides lie between pixels, so that they are sharp.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "pixels of a film, and steps of a list"
)]
fn bar(film: &mut FilmOverlay, [left, top]: [f64; 2], [width, height]: [f64; 2], colors: &[Rgb], color: Rgb) {
    let sides = |start: f64, length: f64| {
        let first = start.round() as i64;
        first..first + (length.round() as i64).max(1)
    };
    let (columns, rows) = (sides(left, width), sides(top, height));
    let across = (columns.end - columns.start) as f64;
    // A bar may be far longer than the picture is wide.
    for column in columns.start.max(0)..columns.end.min(film.size().0.into()) {
        let share = ((column - columns.start) as f64 + 0.5) / across;
        let step = (share * colors.len() as f64) as usize;
        let color = colors.get(step.min(colors.len().saturating_sub(1))).copied().unwrap_or(color);
        rows.clone().for_each(|row| film.cover((column, row), 1.0, color));
    }
}

/// Draws a disc. A pixel that the circle crosses is covered by the share that a straight edge at the circle's distance would leave.
#[expect(clippy::cast_possible_truncation, reason = "pixels of a film; coverage is rounded")]
fn disc(film: &mut FilmOverlay, [left, top]: [f64; 2], side: f64, color: Rgb) {
    let (radius, center) = (side / 2.0, [left + side / 2.0, top + side / 2.0]);
    let range = |start: f64| start.floor() as i64..=(start + side).ceil() as i64;
    for row in range(top) {
        for column in range(left) {
            let [x, y] = [column as f64 + 0.5 - center[0], row as f64 + 0.5 - center[1]];
            let share = (radius - (x * x + y * y).sqrt() + 0.5).clamp(0.0, 1.0);
            film.cover((column, row), share as f32, color);
        }
    }
}
