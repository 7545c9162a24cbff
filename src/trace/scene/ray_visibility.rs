//! The shapes that each class of rays sees.
//!
//! A shape that rays of a class do not see does not exist for them: it is neither hit nor crossed, contains none of them, and coincides with
//! nothing. Rays of a class therefore have a scene of their own, with the same shape ids, in whose tree the other shapes are missing. The
//! scene of camera rays is the prepared scene itself. The scenes of the other classes are made only if some shape is not seen by all rays.

/// The class of a ray, which decides the shapes that it sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayClass {
    /// Rays from the camera.
    Camera,
    /// Mirrored and refracted rays.
    Secondary,
    /// Rays to lights.
    Shadow,
}

impl RayClass {
    /// All classes, in the order of their declaration.
    pub(super) const ALL: [Self; 3] = [Self::Camera, Self::Secondary, Self::Shadow];
}

/// The classes of rays that see a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayVisibility {
    /// True if rays from the camera see the shape.
    pub camera: bool,
    /// True if mirrored and refracted rays see the shape.
    pub secondary: bool,
    /// True if rays to lights see the shape: it casts shadows.
    pub shadow: bool,
}

impl RayVisibility {
    /// All rays see the shape.
    pub const ALL: Self = Self { camera: true, secondary: true, shadow: true };

    /// Returns whether rays of a class see the shape.
    #[must_use]
    pub fn sees(self, class: RayClass) -> bool {
        match class {
            RayClass::Camera => self.camera,
            RayClass::Secondary => self.secondary,
            RayClass::Shadow => self.shadow,
        }
    }

    /// Returns the classes as a bit mask, in the order of their declaration.
    pub(super) fn bits(self) -> u64 {
        RayClass::ALL.into_iter().fold(0, |bits, class| bits | u64::from(self.sees(class)) << class as u64)
    }
}

impl Default for RayVisibility {
    fn default() -> Self {
        Self::ALL
    }
}

/// The scenes, each an `S`, of secondary rays and of shadow rays. Classes that see the same shapes share one.
#[derive(Clone, Debug)]
pub(super) struct RayViews<S> {
    pub(super) scenes: Vec<S>,
    /// By class: the index of its scene; `None` if it is the scene of camera rays.
    of: [Option<usize>; 3],
}

impl<S> RayViews<S> {
    /// Makes the scenes of the other classes of rays. `None` if all rays see all shapes.
    pub(super) fn new(visibilities: &[RayVisibility], make: impl Fn(RayClass) -> S) -> Option<Box<Self>> {
        if visibilities.iter().all(|visibility| *visibility == RayVisibility::ALL) {
            return None;
        }
        let all_seen = |class| visibilities.iter().all(|visibility| visibility.sees(class));
        let are_same =
            |one, other| visibilities.iter().all(|visibility| visibility.sees(one) == visibility.sees(other));
        let mut views = Self { scenes: Vec::new(), of: [None; 3] };
        for class in [RayClass::Secondary, RayClass::Shadow] {
            // In scenes of other classes, the materials of unseen shapes are blank, unlike in the scene of camera rays.
            if all_seen(RayClass::Camera) && all_seen(class) {
                continue;
            }
            let secondary = views.of[RayClass::Secondary as usize];
            let found = secondary.filter(|_| are_same(class, RayClass::Secondary));
            views.of[class as usize] = found.or(Some(views.scenes.len()));
            if found.is_none() {
                views.scenes.push(make(class));
            }
        }
        Some(Box::new(views))
    }

    /// Returns the scene of a class of rays; `None` if it is the scene of camera rays.
    pub(super) fn get(&self, class: RayClass) -> Option<&S> {
        self.of[class as usize].map(|index| &self.scenes[index])
    }
}
