//! Texts, scale bars and legends over the picture.

use serde::Deserialize;

use super::{ColorDocument, Triple};

/// A text, a scale bar or a legend over the picture.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "OverlayItem")]
pub(crate) enum OverlayDocument {
    Text {
        text: String,
        #[serde(default)]
        cloud: Option<String>,
        #[serde(default)]
        anchor: AnchorDocument,
        #[serde(default = "size")]
        size: f64,
        #[serde(default = "white")]
        color: ColorDocument,
        #[serde(default)]
        times: Option<(f64, f64)>,
        #[serde(default)]
        fade: f64,
    },
    ScaleBar {
        length: f64,
        label: String,
        #[serde(default)]
        at: Option<Triple>,
        #[serde(default)]
        anchor: AnchorDocument,
        #[serde(default = "size")]
        size: f64,
        #[serde(default = "white")]
        color: ColorDocument,
        #[serde(default)]
        times: Option<(f64, f64)>,
        #[serde(default)]
        fade: f64,
    },
    Legend {
        cloud: String,
        #[serde(default)]
        title: String,
        #[serde(default)]
        anchor: AnchorDocument,
        #[serde(default = "size")]
        size: f64,
        #[serde(default = "white")]
        color: ColorDocument,
        #[serde(default)]
        times: Option<(f64, f64)>,
        #[serde(default)]
        fade: f64,
    },
}

/// A place in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename = "Anchor")]
pub(crate) enum AnchorDocument {
    #[default]
    TopLeft,
    Top,
    TopRight,
    Left,
    Center,
    Right,
    BottomLeft,
    Bottom,
    BottomRight,
}

/// Returns the default height of a line of text.
fn size() -> f64 {
    0.04
}

fn white() -> ColorDocument {
    ColorDocument([255.0; 3])
}

impl OverlayDocument {
    /// Returns the name of the cloud that the item is about.
    pub(crate) fn cloud(&self) -> Option<&String> {
        match self {
            Self::Text { cloud, .. } => cloud.as_ref(),
            Self::Legend { cloud, .. } => Some(cloud),
            Self::ScaleBar { .. } => None,
        }
    }

    /// Returns the place, the height of a line of text and the colour.
    pub(crate) fn look(&self) -> (AnchorDocument, f64, ColorDocument) {
        match self {
            Self::Text { anchor, size, color, .. }
            | Self::ScaleBar { anchor, size, color, .. }
            | Self::Legend { anchor, size, color, .. } => (*anchor, *size, *color),
        }
    }

    /// Returns the times between which the item is shown, and the seconds in which it appears and disappears.
    pub(crate) fn times(&self) -> (Option<(f64, f64)>, f64) {
        match self {
            Self::Text { times, fade, .. }
            | Self::ScaleBar { times, fade, .. }
            | Self::Legend { times, fade, .. } => (*times, *fade),
        }
    }
}
