//! Texts, scale bars and legends over the picture.

use glam::DVec3;
use hecs::Entity;

use crate::color::Rgb;

/// Texts, scale bars and legends over the picture, in order. A world has at most one `Overlay`; if there are several, the first in document
/// order is used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay(pub Vec<OverlayItem>);

/// A text, a scale bar or a legend.
#[derive(Clone, Debug, PartialEq)]
pub struct OverlayItem {
    /// The content.
    pub content: OverlayContent,
    /// The place in the picture. Items at the same place stand below each other.
    pub anchor: Anchor,
    /// The height of a line of text as a share of the picture's height, greater than 0 and at most 1.
    pub size: f64,
    /// The colour of letters and bars.
    pub color: Rgb,
    /// The times in seconds between which the item is shown, the first one included; `None` for all.
    pub times: Option<[f64; 2]>,
    /// The duration of the fade-in and of the fade-out, in seconds, 0 or more. Both lie within `times`.
    pub fade: f64,
}

/// The content of an [`OverlayItem`].
#[derive(Clone, Debug, PartialEq)]
pub enum OverlayContent {
    /// Words and numbers.
    Text {
        /// The parts, one after the other. Line ends in words start a new line.
        parts: Vec<TextPart>,
        /// The cloud whose time and frame are written; `None` for the time of the film.
        cloud: Option<Entity>,
    },
    /// A bar of a length in the world.
    ScaleBar {
        /// The length in scene units, greater than 0.
        length: f64,
        /// The text below the bar.
        label: String,
        /// The point at whose depth the bar has its length; `None` for the target of the camera or, without one, the origin. Parallel rays
        /// show the same length at all depths.
        at: Option<DVec3>,
    },
    /// The colours of a cloud with a [`CloudSource`](super::CloudSource), and what they mean.
    Legend {
        /// The cloud.
        cloud: Entity,
        /// The text above the colours.
        title: String,
    },
}

/// A part of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextPart {
    /// Words as they are.
    Words(String),
    /// A time, with so many decimals.
    Time(u8),
    /// The frame of a data file, counted from 0.
    Frame,
}

/// A place in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Anchor {
    /// Top left.
    #[default]
    TopLeft,
    /// Top centre.
    Top,
    /// Top right.
    TopRight,
    /// Left, half-way down.
    Left,
    /// The centre.
    Center,
    /// Right, half-way down.
    Right,
    /// Bottom left.
    BottomLeft,
    /// Bottom centre.
    Bottom,
    /// Bottom right.
    BottomRight,
}

impl OverlayItem {
    /// Returns the opacity at a time in seconds, from 0 to 1.
    ///
    /// ```
    /// use rayreel::color::Rgb;
    /// use rayreel::components::{Anchor, OverlayContent, OverlayItem, TextPart};
    ///
    /// let content = OverlayContent::Text { parts: TextPart::parse("The end").unwrap(), cloud: None };
    /// let times = Some([2.0, 5.0]);
    /// let title = OverlayItem { content, anchor: Anchor::Center, size: 0.1, color: Rgb::ONE, times, fade: 1.0 };
    /// let opacities = [1.9, 2.0, 2.5, 3.0, 4.0, 4.75, 5.0].map(|time| title.opacity_at(time));
    /// assert_eq!(opacities, [0.0, 0.0, 0.5, 1.0, 1.0, 0.25, 0.0]);
    /// ```
    #[must_use]
    pub fn opacity_at(&self, seconds: f64) -> f64 {
        let Some([first, end]) = self.times else { return 1.0 };
        if !(first..end).contains(&seconds) {
            return 0.0;
        }
        if self.fade > 0.0 { ((seconds - first).min(end - seconds) / self.fade).min(1.0) } else { 1.0 }
    }
}

impl OverlayContent {
    /// Returns the cloud that the content is about.
    pub(crate) fn cloud_mut(&mut self) -> Option<&mut Entity> {
        match self {
            Self::Text { cloud, .. } => cloud.as_mut(),
            Self::Legend { cloud, .. } => Some(cloud),
            Self::ScaleBar { .. } => None,
        }
    }
}

impl TextPart {
    /// Maximum number of decimals.
    pub const MOST_DECIMALS: u8 = 9;

    /// Returns the parts of a text in which `{time}`, `{time:3}` (with three decimals) and `{frame}` stand for numbers, and `{{` for an
    /// opening brace. The error is the text between braces that stands for nothing.
    ///
    /// ```
    /// use rayreel::components::TextPart;
    /// let parts = TextPart::parse("t = {time:1} ps")?;
    /// assert_eq!(parts[1], TextPart::Time(1));
    /// assert_eq!(TextPart::parse("{date}"), Err("{date}".to_owned()));
    /// # Ok::<(), String>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If braces hold anything else, or are not closed.
    pub fn parse(text: &str) -> Result<Vec<Self>, String> {
        let (mut parts, mut words, mut rest) = (Vec::new(), String::new(), text);
        while let Some((before, after)) = rest.split_once('{') {
            words.push_str(before);
            if let Some(after) = after.strip_prefix('{') {
                words.push('{');
                rest = after;
                continue;
            }
            let (inside, after) = after.split_once('}').ok_or_else(|| rest[before.len()..].to_owned())?;
            if !words.is_empty() {
                parts.push(Self::Words(std::mem::take(&mut words)));
            }
            parts.push(Self::of_field(inside).ok_or_else(|| format!("{{{inside}}}"))?);
            rest = after;
        }
        words.push_str(rest);
        if !words.is_empty() {
            parts.push(Self::Words(words));
        }
        Ok(parts)
    }

    fn of_field(field: &str) -> Option<Self> {
        match field.split_once(':') {
            None if field == "frame" => Some(Self::Frame),
            None => (field == "time").then_some(Self::Time(2)),
            Some(("time", decimals)) => {
                decimals.parse().ok().filter(|decimals| *decimals <= Self::MOST_DECIMALS).map(Self::Time)
            }
            Some(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_have_fields_in_braces() {
        let words = |text: &str| TextPart::Words(text.to_owned());
        assert_eq!(TextPart::parse(""), Ok(vec![]));
        assert_eq!(TextPart::parse("a } b"), Ok(vec![words("a } b")]));
        assert_eq!(
            TextPart::parse("{{a}, {{{frame}{{"),
            Ok(vec![words("{a}, {"), TextPart::Frame, words("{")])
        );
        let all = [TextPart::Time(2), words(" s, "), TextPart::Frame, TextPart::Time(0)];
        assert_eq!(TextPart::parse("{time} s, {frame}{time:0}"), Ok(all.to_vec()));
        for (text, wrong) in
            [("{time:10}", "{time:10}"), ("a{frame:2}", "{frame:2}"), ("x {time", "{time"), ("{}", "{}")]
        {
            assert_eq!(TextPart::parse(text), Err(wrong.to_owned()));
        }
    }
}
