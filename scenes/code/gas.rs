//! A heavy sphere in a gas: `cargo run --release --example gas` writes the trajectory `out/gas.extxyz`, or the file that it is given.
//! `scenes/gas.ron` shows it, from a compressed copy in `scenes/data`.
//!
//! Hard spheres move in a box. Between collisions they fly straight ahead; collisions with each other and with the walls are elastic. The
//! program goes from one collision to the next, whose times are the roots of quadratic equations (B. J. Alder and T. E. Wainwright, J.
//! Chem. Phys. 31, 1959), so that there is no time step, and energy is conserved to rounding. The first sphere is large and heavy, and is
//! shot into the gas, which is nearly in thermal equilibrium. Its collisions with light spheres slow it down: this is the friction of a
//! gas. Lengths and times are those of the scene, masses those of a light sphere. Only sums, products, quotients and square roots are used,
//! so that every machine writes the same bytes.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::Path;

type Vector = [f64; 3];

/// Half of the edges of the box, which has its centre at the origin.
pub(crate) const HALF_BOX: Vector = [8.0, 5.0, 16.0];
const LIGHT_SPHERES: usize = 320;
const LIGHT_RADIUS: f64 = 0.34;
const HEAVY_RADIUS: f64 = 1.3;
const HEAVY_MASS: f64 = 60.0;
/// Position and velocity of the heavy sphere at the start.
const SHOT: [Vector; 2] = [[-2.5, -0.6, -13.0], [1.4, 0.5, 7.0]];
/// Mean square of each component of the velocity of a light sphere, at the start.
const TEMPERATURE: f64 = 2.0;
const FRAMES_PER_SECOND: f64 = 20.0;

/// A hard sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    pub(crate) position: Vector,
    pub(crate) velocity: Vector,
    pub(crate) radius: f64,
    pub(crate) mass: f64,
}

/// The obstacle of a collision.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Obstacle {
    Sphere(usize),
    /// The two walls that are perpendicular to an axis.
    Walls(usize),
}

/// The next collision of a sphere.
#[derive(Clone, Copy, Debug)]
struct Collision {
    time: f64,
    obstacle: Obstacle,
}

/// The gas at a time.
#[derive(Debug)]
pub(crate) struct Gas {
    pub(crate) spheres: Vec<Sphere>,
    pub(crate) time: f64,
    /// The next collision of each sphere.
    next: Vec<Collision>,
    /// The momentum that the walls have given to the spheres.
    pub(crate) from_walls: Vector,
}

impl Gas {
    /// Creates the gas: the heavy sphere, and light ones at random places that are free.
    pub(crate) fn new() -> Self {
        // With this seed, few spheres come between the heavy one and the camera of the scene.
        let mut state: u64 = 13;
        let mut random = || {
            // A linear congruential generator (D. Knuth, The Art of Computer Programming 2, 3.3.4); its upper bits are good.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        let [position, velocity] = SHOT;
        let mut spheres = vec![Sphere { position, velocity, radius: HEAVY_RADIUS, mass: HEAVY_MASS }];
        while spheres.len() <= LIGHT_SPHERES {
            let position = HALF_BOX.map(|half| 2.0 * (half - LIGHT_RADIUS) * random());
            let is_free = |other: &Sphere| {
                let (way, reach) = (difference(position, other.position), LIGHT_RADIUS + other.radius);
                dot(way, way) > reach * reach
            };
            if spheres.iter().all(is_free) {
                // A sum of twelve uniform numbers is nearly normal, with a variance of 1.
                let velocity = [(); 3].map(|()| TEMPERATURE.sqrt() * (0..12).map(|_| random()).sum::<f64>());
                spheres.push(Sphere { position, velocity, radius: LIGHT_RADIUS, mass: 1.0 });
            }
        }
        let mut gas = Self { spheres, time: 0.0, next: Vec::new(), from_walls: [0.0; 3] };
        gas.next = (0..gas.spheres.len()).map(|index| gas.predict(index)).collect();
        gas
    }

    /// Returns the kinetic energy.
    pub(crate) fn energy(&self) -> f64 {
        self.spheres.iter().map(|sphere| 0.5 * sphere.mass * dot(sphere.velocity, sphere.velocity)).sum()
    }

    /// Advances to a time, through all collisions before it.
    pub(crate) fn advance(&mut self, time: f64) {
        loop {
            let first = (0..self.next.len()).min_by(|a, b| self.next[*a].time.total_cmp(&self.next[*b].time));
            let Some(index) = first.filter(|index| self.next[*index].time < time) else { break };
            self.collide(index);
        }
        self.fly(time);
    }

    /// Moves all spheres straight ahead.
    fn fly(&mut self, time: f64) {
        let duration = time - self.time;
        for Sphere { position, velocity, .. } in &mut self.spheres {
            (0..3).for_each(|axis| position[axis] += duration * velocity[axis]);
        }
        self.time = time;
    }

    /// Carries out the next collision of a sphere.
    fn collide(&mut self, index: usize) {
        let Collision { time, obstacle } = self.next[index];
        self.fly(time);
        let mut struck = vec![index];
        match obstacle {
            Obstacle::Walls(axis) => {
                let Sphere { velocity, mass, .. } = &mut self.spheres[index];
                velocity[axis] = -velocity[axis];
                self.from_walls[axis] += 2.0 * *mass * velocity[axis];
            }
            Obstacle::Sphere(other) => {
                self.exchange_momentum(index, other);
                struck.push(other);
            }
        }
        // Predictions for the spheres that were struck, and those of collisions with them, are void.
        for sphere in 0..self.spheres.len() {
            let involves =
                |one: &usize| sphere == *one || self.next[sphere].obstacle == Obstacle::Sphere(*one);
            if struck.iter().any(involves) {
                self.next[sphere] = self.predict(sphere);
            }
        }
        // The others may now collide with them sooner than with what was predicted.
        for sphere in 0..self.spheres.len() {
            for moved in struck.iter().filter(|moved| **moved != sphere) {
                let time = self.time_of_contact(sphere, *moved);
                if time < self.next[sphere].time {
                    self.next[sphere] = Collision { time, obstacle: Obstacle::Sphere(*moved) };
                }
            }
        }
    }

    /// Reverses the relative velocity of two spheres along the line of their centres.
    fn exchange_momentum(&mut self, one: usize, other: usize) {
        let [a, b] = [self.spheres[one], self.spheres[other]];
        let way = difference(b.position, a.position);
        let approach = dot(difference(a.velocity, b.velocity), way) / dot(way, way);
        let transfer = 2.0 * a.mass * b.mass / (a.mass + b.mass) * approach;
        for (axis, way) in way.into_iter().enumerate() {
            self.spheres[one].velocity[axis] -= transfer / a.mass * way;
            self.spheres[other].velocity[axis] += transfer / b.mass * way;
        }
    }

    /// Returns the next collision of a sphere, if all others fly straight ahead.
    fn predict(&self, index: usize) -> Collision {
        let Sphere { position, velocity, radius, .. } = self.spheres[index];
        let wall = |axis: usize| {
            let side = if velocity[axis] > 0.0 { HALF_BOX[axis] - radius } else { radius - HALF_BOX[axis] };
            let wait =
                if velocity[axis] == 0.0 { f64::INFINITY } else { (side - position[axis]) / velocity[axis] };
            Collision { time: self.time + wait.max(0.0), obstacle: Obstacle::Walls(axis) }
        };
        let sphere = |other: usize| Collision {
            time: self.time_of_contact(index, other),
            obstacle: Obstacle::Sphere(other),
        };
        let others = (0..self.spheres.len()).filter(|other| *other != index).map(sphere);
        let sooner = |a: Collision, b: Collision| if b.time < a.time { b } else { a };
        others.fold(sooner(sooner(wall(0), wall(1)), wall(2)), sooner)
    }

    /// Returns the time at which two spheres touch, infinite if they never do.
    fn time_of_contact(&self, one: usize, other: usize) -> f64 {
        let [a, b] = [&self.spheres[one], &self.spheres[other]];
        let (way, motion) = (difference(b.position, a.position), difference(b.velocity, a.velocity));
        let (reach, approach) = (a.radius + b.radius, -dot(way, motion));
        let speed = dot(motion, motion);
        // |way + t motion| = reach, whose earlier root is a contact of spheres that approach each other.
        let root = approach * approach - speed * (dot(way, way) - reach * reach);
        if approach <= 0.0 || root <= 0.0 {
            return f64::INFINITY;
        }
        self.time + ((dot(way, way) - reach * reach) / (approach + root.sqrt())).max(0.0)
    }

    /// Appends a frame in extended XYZ.
    fn write(&self, text: &mut String) -> std::fmt::Result {
        let ([x, y, z], [a, b, c]) = (HALF_BOX.map(|half| -half), HALF_BOX.map(|half| 2.0 * half));
        writeln!(text, "{}", self.spheres.len())?;
        write!(text, "Lattice=\"{a} 0 0 0 {b} 0 0 0 {c}\" Origin=\"{x} {y} {z}\" pbc=\"F F F\" ")?;
        write!(text, "Properties=type:I:1:pos:R:3:speed:R:1 ")?;
        writeln!(text, "Time={:.2} energy={:.3}", self.time, self.energy())?;
        for (index, Sphere { position: [x, y, z], velocity, .. }) in self.spheres.iter().enumerate() {
            let kind = if index == 0 { 1 } else { 2 };
            writeln!(text, "{kind} {x:.2} {y:.2} {z:.2} {:.1}", dot(*velocity, *velocity).sqrt())?;
        }
        Ok(())
    }
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn difference(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

/// Writes a trajectory of this many frames.
pub(crate) fn shoot(file: &Path, frames: usize) -> Result<(), Box<dyn Error>> {
    let (mut gas, mut text) = (Gas::new(), String::new());
    for frame in 0..frames {
        gas.advance(frame as f64 / FRAMES_PER_SECOND);
        gas.write(&mut text)?;
    }
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    Ok(fs::write(file, text)?)
}

#[allow(clippy::print_stdout, reason = "a program prints its report")]
fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).unwrap_or("out/gas.extxyz".to_owned());
    shoot(Path::new(&file), 101)?;
    println!("the trajectory is in {file}");
    Ok(())
}
