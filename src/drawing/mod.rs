//! Drawings as SVG.
//!
//! `writer` writes the elements, `axis` chooses ticks and draws the grid of a plot, and `labels` places texts next to points.
//! `view` shows a scene's `shapes` from above, from the side and from the front, and `rays` the rays of a pixel among them.
//! `camera_path` samples the camera over frames.
//! `names` names entities and rays.

mod area;
mod axis;
mod camera_path;
mod labels;
mod names;
mod rays;
mod shapes;
mod view;
mod writer;

pub use area::{Area, PagePoint};
pub use axis::{Axis, Plot, Steps};
pub use camera_path::{CameraPath, CameraSample, Rates};
pub use labels::{Labels, directions};
pub use names::{ABSORBED, label, ray_name, unlit_reason};
pub use rays::{RayDrawing, RayKey};
pub use shapes::{OutlinedShape, outlined_shapes};
pub use view::{OrthographicView, VIEW_STYLE, draw_map};
pub use writer::{Svg, TextAnchor, escaped};
