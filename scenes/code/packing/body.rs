//! Rigid boxes that fly, and vectors.

pub(crate) type Vector = [f64; 3];

/// Seconds of a step.
pub(crate) const STEP: f64 = 1.0 / 480.0;

/// A box. Those that do not move have an inverse mass and inverse moments of 0.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) position: Vector,
    /// A quaternion (x, y, z, w).
    pub(crate) orientation: [f64; 4],
    pub(crate) velocity: Vector,
    pub(crate) spin: Vector,
    pub(super) half: Vector,
    pub(super) inverse_mass: f64,
    /// Inverse moments of inertia about the own axes.
    pub(super) inverse_moments: Vector,
    /// The own axes in space.
    pub(super) axes: [Vector; 3],
}

impl Body {
    /// Creates a box with a density of 1, at rest.
    pub(super) fn new(position: Vector, half: Vector) -> Self {
        let mass = 8.0 * half[0] * half[1] * half[2];
        let inverse_moments =
            [(1, 2), (2, 0), (0, 1)].map(|(a, b)| 3.0 / (mass * (half[a] * half[a] + half[b] * half[b])));
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (orientation, still) = ([0.0, 0.0, 0.0, 1.0], [0.0; 3]);
        let (velocity, spin, inverse_mass) = (still, still, 1.0 / mass);
        Self { position, orientation, velocity, spin, half, inverse_mass, inverse_moments, axes }
    }

    /// Creates a box that does not move.
    pub(super) fn fixed([position, half]: [Vector; 2]) -> Self {
        Self { inverse_mass: 0.0, inverse_moments: [0.0; 3], ..Self::new(position, half) }
    }

    /// Normalises the orientation, and computes the axes.
    pub(super) fn turn_to(&mut self, [x, y, z, w]: [f64; 4]) {
        let length = (x * x + y * y + z * z + w * w).sqrt();
        let [x, y, z, w] = [x / length, y / length, z / length, w / length];
        self.orientation = [x, y, z, w];
        self.axes = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
            [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
            [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
    }

    /// Returns the change of the spin for an angular momentum.
    pub(super) fn spin_of(&self, momentum: Vector) -> Vector {
        let part = |axis: usize| self.inverse_moments[axis] * dot(self.axes[axis], momentum);
        (0..3).fold([0.0; 3], |sum, axis| add(sum, part(axis), self.axes[axis]))
    }

    /// Moves for a step without contacts.
    pub(super) fn fly(&mut self) {
        self.position = add(self.position, STEP, self.velocity);
        let own = self.axes.map(|axis| dot(axis, self.spin));
        let momentum = (0..3)
            .fold([0.0; 3], |sum, axis| add(sum, own[axis] / self.inverse_moments[axis], self.axes[axis]));
        let ([x, y, z, w], [a, b, c]) = (self.orientation, self.spin.map(|part| 0.5 * STEP * part));
        self.turn_to([
            x + a * w + b * z - c * y,
            y + b * w + c * x - a * z,
            z + c * w + a * y - b * x,
            w - a * x - b * y - c * z,
        ]);
        // Angular momentum stays, while spin follows from the new axes.
        self.spin = self.spin_of(momentum);
    }

    /// Returns the velocity of the point at the end of an arm.
    pub(super) fn velocity_at(&self, arm: Vector) -> Vector {
        add(self.velocity, 1.0, cross(self.spin, arm))
    }

    /// Returns the kinetic energy.
    pub(super) fn energy(&self) -> f64 {
        let own = self.axes.map(|axis| dot(axis, self.spin));
        let turning: f64 = (0..3).map(|axis| own[axis] * own[axis] / self.inverse_moments[axis]).sum();
        0.5 * (dot(self.velocity, self.velocity) / self.inverse_mass + turning)
    }

    /// Returns half of the extent along a direction of unit length.
    pub(super) fn reach(&self, direction: Vector) -> f64 {
        (0..3).map(|axis| self.half[axis] * dot(self.axes[axis], direction).abs()).sum()
    }

    /// Returns the corner that is farthest in a direction, or the middle of the edge along an axis that is.
    pub(super) fn farthest(&self, direction: Vector, along: Option<usize>) -> Vector {
        (0..3).filter(|axis| Some(*axis) != along).fold(self.position, |point, axis| {
            add(point, self.half[axis] * sign(dot(self.axes[axis], direction)), self.axes[axis])
        })
    }

    /// Changes the motion by an impulse at the end of an arm.
    pub(super) fn kick(&mut self, arm: Vector, impulse: f64, direction: Vector) {
        self.velocity = add(self.velocity, impulse * self.inverse_mass, direction);
        self.spin = add(self.spin, impulse, self.spin_of(cross(arm, direction)));
    }
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns a + factor b.
pub(super) fn add(a: Vector, factor: f64, b: Vector) -> Vector {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}

pub(super) fn difference(a: Vector, b: Vector) -> Vector {
    add(a, -1.0, b)
}

pub(super) fn unit(a: Vector) -> Vector {
    let length = dot(a, a).sqrt();
    a.map(|part| part / length)
}

pub(super) fn sign(number: f64) -> f64 {
    if number < 0.0 { -1.0 } else { 1.0 }
}
