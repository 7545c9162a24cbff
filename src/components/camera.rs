//! The camera, its lens and its shots.

use glam::DVec3;
use hecs::Entity;

/// The camera: an eye, and a screen at a distance in front of it (see [`trace::PreparedCamera`](crate::trace::PreparedCamera) for pixels).
///
/// Points and directions are in the entity's own space; its [`WorldTransform`](super::WorldTransform), if any, maps them to the world.
/// Sizes of the screen and the lens, and distances from the eye, are in world units.
///
/// A moving camera can pass through degenerate poses, which still have an image. If the eye is at the target, the camera looks along the
/// world's +z. If the view is parallel to `up`, the world's y axis is used as up, or its z axis if the view is parallel to y as well. A
/// camera with y up that passes over its target is therefore rotated about its view at that moment, and by half a turn from one side to the
/// other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The position of the eye, P0.
    pub position: DVec3,
    /// The view direction or target.
    pub view: View,
    /// The view-up vector, VUP: the direction that is up in the image. Any length; not parallel to the view.
    pub up: DVec3,
    /// The rotation about the view direction in radians. Positive angles tilt the camera to its left, so that the image contents rotate
    /// clockwise: at +90 degrees the camera's up vector points to its former left.
    pub roll: f64,
    /// The screen's size and distance.
    pub projection: Projection,
    /// The lens. `None` is a pinhole: everything is in focus.
    pub lens: Option<Lens>,
    /// The fraction of the frame interval during which the shutter is open, > 0, at most 1, centred on the frame's time; moving objects are
    /// blurred. `None` exposes a single instant, without motion blur.
    pub shutter: Option<f64>,
}

impl Default for Camera {
    /// Returns a camera 5 units in front of the origin, looking at it, with a vertical field of view of 45 degrees.
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

impl Camera {
    /// Creates a camera at a point that looks towards another, with y up and a vertical field of view of 45 degrees.
    ///
    /// ```
    /// use glam::DVec3;
    /// use rayreel::components::{Camera, Projection};
    /// let projection = Projection::FieldOfView { vertical: 30_f64.to_radians() };
    /// let camera = Camera { projection, ..Camera::looking_at(DVec3::new(0.0, 2.0, -12.0), DVec3::ZERO) };
    /// # assert_eq!(camera.up, DVec3::Y);
    /// ```
    #[must_use]
    pub fn looking_at(position: DVec3, target: DVec3) -> Self {
        Self { position, view: View::Target(target), ..Self::default() }
    }
}

/// The entity that the camera follows without rotating. Its world position is added to the camera's position and to the point that the
/// camera looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Follow(pub Entity);

/// The entity whose world position a camera looks at, or to which the +z axis of another entity points. Overrides the camera's [`View`],
/// or the entity's [`Target`] and the rotation of its [`Transform`](super::Transform).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LookAt(pub Entity);

/// The entity on which a camera's lens focuses: the plane in focus lies at the depth of the entity's world position, in place of
/// [`Lens::focus`], while it is in front of the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FocusOn(pub Entity);

/// The point to which the +z axis of an entity without a camera points, in the space of its parent. Overrides the rotation of its
/// [`Transform`](super::Transform).
///
/// The entity's +y axis is up: as near to +y of the parent's space as possible, or to +z if the point is straight above or below. If the
/// point is at the entity's own position, the +z axis points along the world's +z. Points that an entity looks at by [`LookAt`] are treated
/// alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target(pub DVec3);

/// The cuts between cameras. A world has at most one `Shots`. Without it, the first camera in document order is always active.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shots(pub Vec<Shot>);

/// A camera that is active from a point in time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// The start in seconds, later than the start of the preceding shot. The first shot also covers the time before its start. A frame
    /// belongs to the last shot that starts no later than the frame's moment, both rounded once to `f64`. The whole frame belongs to that
    /// shot, even if its shutter is open across the cut.
    pub start: f64,
    /// The entity with the camera.
    pub camera: Entity,
}

/// The view direction of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// Along a direction (VPN) of any nonzero length.
    Direction(DVec3),
    /// Towards a point.
    Target(DVec3),
}

/// A thin lens around the eye: objects that are out of focus are blurred. It has an effect only if [`Sampling`](super::Sampling) has more
/// than one sample per pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// The diameter in scene units; 0 disables the lens.
    pub aperture: f64,
    /// The distance from the eye to the plane of focus, along the view direction, > 0.
    pub focus: f64,
}

/// The screen in front of the camera. The centres of the first and the last pixels lie on the edges of the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// A screen of the given size in scene units.
    Screen {
        /// The distance d from the eye to the screen, > 0.
        distance: f64,
        /// The width W, > 0. `None` derives it from square pixels.
        width: Option<f64>,
        /// The height H, > 0.
        height: f64,
    },
    /// Square pixels whose outer borders span the vertical angle.
    FieldOfView {
        /// The vertical angle in radians, between 0 and pi.
        vertical: f64,
    },
    /// Square pixels whose outer borders span the horizontal angle.
    HorizontalFieldOfView {
        /// The horizontal angle in radians, between 0 and pi.
        horizontal: f64,
    },
    /// Parallel rays from the plane through the camera's position, perpendicular to the view: the size of objects in the image does not
    /// depend on their distance. Square pixels.
    Orthographic {
        /// The height of the view in scene units, between the outer borders of the pixels, > 0.
        height: f64,
    },
}
