//! The camera, its lens and its shots.

use glam::DVec3;
use hecs::Entity;

/// The camera: an eye and a screen at a distance before it (see [`trace::Camera`](crate::trace::Camera) for pixels).
///
/// Points and directions are in the entity's own space, which its [`WorldTransform`](super::WorldTransform), if it has one,
/// takes to the world; sizes of the screen and the lens, and distances from the eye, are the world's.
///
/// Some moments of moving cameras have no view or no upright, and still a picture. A camera that stands at its target looks along
/// the world's +z. Where the view is parallel to `up`, the world's y is up, or, if the view is parallel to that too, its z: so
/// that a camera that passes over its target with y up turns about its view at that moment, and by half a turn from one side to
/// the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye, P0.
    pub position: DVec3,
    /// The view direction or target.
    pub view: View,
    /// VUP: the direction that is up in the picture; any length, not parallel to the view.
    pub up: DVec3,
    /// The rotation about the view direction, radians. Positive angles tip the camera to its left, so the picture's contents turn
    /// clockwise: at +90 degrees the camera's up points to where its left was.
    pub roll: f64,
    /// The screen's size and distance.
    pub projection: Projection,
    /// The lens. `None` is a pinhole: everything is sharp.
    pub lens: Option<Lens>,
    /// The share of the time from frame to frame during which the shutter is open, > 0, at most 1, centred on the frame's time:
    /// what moves is blurred. `None` is an instant: everything is sharp.
    pub shutter: Option<f64>,
}

impl Default for Camera {
    /// Returns a camera five units before the origin, looking at it, 45 degrees high.
    fn default() -> Self {
        Self {
            position: DVec3::new(0.0, 0.0, -5.0),
            view: View::Target(DVec3::ZERO),
            up: DVec3::Y,
            roll: 0.0,
            projection: Projection::FieldOfView { vertical: std::f64::consts::FRAC_PI_4 },
            lens: None,
            shutter: None,
        }
    }
}

/// The entity with which the camera moves, without turning: its place in the world is added to the camera's position and to the
/// point that it looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Follow(pub Entity);

/// The entity at whose place in the world the camera looks, whatever its [`View`] says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LookAt(pub Entity);

/// The cuts between cameras. A world has at most one; without it the first camera in document order is active throughout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shots(pub Vec<Shot>);

/// A camera that is active from a moment on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Seconds; later than that of the shot before. The first shot also covers the time before it. A frame belongs to the last
    /// shot that starts no later than the frame's moment, both rounded once to `f64`; all of the frame, even if its shutter is
    /// open across the cut.
    pub start: f64,
    /// The entity with the camera.
    pub camera: Entity,
}

/// The direction in which a camera looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// Along a direction (VPN), of any length but zero.
    Direction(DVec3),
    /// Towards a point.
    Target(DVec3),
}

/// A thin lens around the eye: what is not in focus is blurred. It is used where [`Sampling`](super::Sampling) has more than
/// one sample per pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// The diameter in scene units; 0 is no lens.
    pub aperture: f64,
    /// The distance from the eye to the plane of focus, along the view direction, > 0.
    pub focus: f64,
}

/// The screen before the camera. The first and the last pixel's centres lie on the screen's edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A screen of given size, scene units.
    Screen {
        /// The distance from the eye to the screen, d > 0.
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
