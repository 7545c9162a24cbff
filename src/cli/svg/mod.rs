//! Drawings as SVG.
//!
//! [`writer`] writes the elements, [`axis`] chooses ticks and draws the grid of a plot, and [`labels`] places texts next to points.
//! [`view`] shows a scene's [`shapes`] from above, from the side and from the front.

mod area;
mod axis;
mod labels;
mod shapes;
mod view;
mod writer;

pub(super) use area::{Area, PagePoint};
pub(super) use axis::{Axis, Plot, Steps};
pub(super) use labels::{Labels, directions};
pub(super) use shapes::{OutlinedShape, outlined_shapes};
pub(super) use view::{OrthographicView, VIEW_STYLE};
pub(super) use writer::{Svg, TextAnchor, escaped};
