//! From where the picture is taken.

use glam::DVec3;

/// The camera: an eye and a screen at a distance before it (see [`trace::Camera`](crate::trace::Camera) for pixels).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye, P0.
    pub position: DVec3,
    /// Which way it looks.
    pub view: View,
    /// VUP: the direction that is up in the picture; any length, not parallel to the view.
    pub up: DVec3,
    /// The screen's size and distance.
    pub projection: Projection,
    /// `None` is a pinhole: everything is sharp.
    pub lens: Option<Lens>,
    /// The share of the time from frame to frame during which the shutter is open, > 0, at most 1, centred on the frame's
    /// time: what moves is blurred. `None` is an instant: everything is sharp.
    pub shutter: Option<f64>,
}

impl Default for Camera {
    /// Five units before the origin, looking at it, 45 degrees high.
    fn default() -> Self {
        Self {
            position: DVec3::new(0.0, 0.0, -5.0),
            view: View::Target(DVec3::ZERO),
            up: DVec3::Y,
            projection: Projection::FieldOfView { vertical: std::f64::consts::FRAC_PI_4 },
            lens: None,
            shutter: None,
        }
    }
}

/// Which way a camera looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// Along a direction (VPN), of any length but zero.
    Direction(DVec3),
    /// Towards a point.
    Target(DVec3),
}

/// A thin lens around the eye: what is not in focus is blurred. It shows where [`Sampling`](super::Sampling) asks for more
/// than one sample in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Its diameter in scene units; 0 is no lens.
    pub aperture: f64,
    /// How far from the eye things are sharp, along the view direction, > 0.
    pub focus: f64,
}

/// The screen before the camera. The first and the last pixel's centres lie on the screen's edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A screen of given size, scene units.
    Screen {
        /// From the eye to the screen, d > 0.
        distance: f64,
        /// W > 0; `None` follows from square pixels.
        width: Option<f64>,
        /// H > 0.
        height: f64,
    },
    /// Square pixels whose outer borders span a vertical angle.
    FieldOfView {
        /// Radians, in 0..pi.
        vertical: f64,
    },
}
