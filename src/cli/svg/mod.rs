//! Drawings as SVG.
//!
//! [`writer`] writes the elements, [`axis`] chooses ticks and draws the grid of a plot, and [`labels`] places texts next to points.

mod area;
mod axis;
mod labels;
mod writer;

pub(super) use area::{Area, PagePoint};
pub(super) use axis::{Axis, Plot, Steps};
pub(super) use labels::{Labels, directions};
pub(super) use writer::{Anchor, Svg, escaped};
