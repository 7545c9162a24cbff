//! A crystal that melts: `cargo run --release --example melting` writes the trajectory `out/melting.extxyz`, or the file that it is given.
//! `scenes/melting.ron` shows it, from a compressed copy in `scenes/data`.
//!
//! Atoms attract and repel each other by the Lennard-Jones potential 4 (r^-12 - r^-6), cut off at a distance of 2.5, in units of its
//! length, its depth and the mass of an atom. A cube of 500 atoms in a face-centred cubic lattice floats in empty space. It is integrated by
//! the velocity Verlet method in steps of 0.005, and warmed from a temperature of 0.05 to 0.7 by scaling all velocities a little in each
//! step (H. J. C. Berendsen and others, J. Chem. Phys. 81, 1984). The crystal melts, and the liquid draws itself into a drop. Only sums,
//! products, quotients and square roots are used, so that every machine writes the same bytes.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::Path;

type Vector = [f64; 3];

/// Edge of the crystal, in cells of four atoms.
const CELLS: i32 = 5;
/// Edge of a cell in a crystal at rest.
const EDGE: f64 = 1.55;
const STEP: f64 = 0.005;
const STEPS_PER_FRAME: usize = 250;
const COOLEST: f64 = 0.05;
const WARMEST: f64 = 0.7;
/// Steps in which a difference of temperature falls to a part of 1/e.
const COUPLING: f64 = 200.0;

pub(crate) struct Atoms {
    pub(crate) positions: Vec<Vector>,
    velocities: Vec<Vector>,
    accelerations: Vec<Vector>,
}

impl Atoms {
    /// Creates the crystal, with random velocities.
    pub(crate) fn crystal() -> Self {
        let middle = f64::from(CELLS) / 2.0 - 0.25;
        let cells = (0..CELLS).flat_map(|x| (0..CELLS).flat_map(move |y| (0..CELLS).map(move |z| [x, y, z])));
        let corners = [[0.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];
        let place = |cell: [i32; 3], corner: Vector| {
            [0, 1, 2].map(|axis| EDGE * (f64::from(cell[axis]) + corner[axis] - middle))
        };
        let positions: Vec<Vector> =
            cells.flat_map(|cell| corners.map(|corner| place(cell, corner))).collect();
        let mut state: u64 = 1;
        let mut random = || {
            // A linear congruential generator (D. Knuth, The Art of Computer Programming 2, 3.3.4); its upper bits are good.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        let mut velocities: Vec<Vector> = positions.iter().map(|_| [random(), random(), random()]).collect();
        let count = velocities.len() as f64;
        for axis in 0..3 {
            // The crystal as a whole rests.
            let mean = velocities.iter().map(|velocity| velocity[axis]).sum::<f64>() / count;
            velocities.iter_mut().for_each(|velocity| velocity[axis] -= mean);
        }
        let accelerations = accelerations(&positions);
        let mut atoms = Self { positions, velocities, accelerations };
        atoms.scale_velocities((COOLEST / atoms.temperature()).sqrt());
        atoms
    }

    /// Returns two thirds of the mean kinetic energy.
    pub(crate) fn temperature(&self) -> f64 {
        let squares = self.velocities.iter().flatten().map(|part| part * part).sum::<f64>();
        squares / (3.0 * self.velocities.len() as f64)
    }

    fn scale_velocities(&mut self, factor: f64) {
        self.velocities.iter_mut().flatten().for_each(|part| *part *= factor);
    }

    /// Advances by one step, towards a temperature.
    pub(crate) fn step(&mut self, temperature: f64) {
        let half = STEP / 2.0;
        let Self { positions, velocities, accelerations: before } = self;
        for (index, velocity) in velocities.iter_mut().enumerate() {
            for axis in 0..3 {
                velocity[axis] += half * before[index][axis];
                positions[index][axis] += STEP * velocity[axis];
            }
        }
        *before = accelerations(positions);
        for (velocity, acceleration) in velocities.iter_mut().zip(before) {
            (0..3).for_each(|axis| velocity[axis] += half * acceleration[axis]);
        }
        let ratio = temperature / self.temperature();
        self.scale_velocities((1.0 + (ratio - 1.0) / COUPLING).sqrt());
    }

    /// Appends a frame in extended XYZ.
    fn write(&self, text: &mut String) -> std::fmt::Result {
        writeln!(text, "{}", self.positions.len())?;
        writeln!(text, "Properties=species:S:1:pos:R:3:speed:R:1 temperature={:.3}", self.temperature())?;
        for ([x, y, z], [a, b, c]) in self.positions.iter().zip(&self.velocities) {
            writeln!(text, "Ar {x:.2} {y:.2} {z:.2} {:.2}", (a * a + b * b + c * c).sqrt())?;
        }
        Ok(())
    }
}

/// Returns the accelerations of atoms of mass 1.
fn accelerations(positions: &[Vector]) -> Vec<Vector> {
    const REACH: f64 = 2.5;
    let mut all = vec![[0.0; 3]; positions.len()];
    for one in 0..positions.len() {
        for other in 0..one {
            let way = [0, 1, 2].map(|axis| positions[one][axis] - positions[other][axis]);
            let square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
            if square < REACH * REACH {
                let sixth = 1.0 / (square * square * square);
                let force = 24.0 * sixth * (2.0 * sixth - 1.0) / square;
                for axis in 0..3 {
                    all[one][axis] += force * way[axis];
                    all[other][axis] -= force * way[axis];
                }
            }
        }
    }
    all
}

/// Writes a trajectory of this many frames.
pub(crate) fn melt(file: &Path, frames: usize) -> Result<(), Box<dyn Error>> {
    let (mut atoms, mut text) = (Atoms::crystal(), String::new());
    for frame in 0..frames {
        atoms.write(&mut text)?;
        let temperature = COOLEST + (WARMEST - COOLEST) * (frame + 1) as f64 / frames as f64;
        (0..STEPS_PER_FRAME).for_each(|_| atoms.step(temperature));
    }
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    Ok(fs::write(file, text)?)
}

#[allow(clippy::print_stdout, reason = "a program prints its report")]
fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).unwrap_or("out/melting.extxyz".to_owned());
    melt(Path::new(&file), 60)?;
    println!("the trajectory is in {file}");
    Ok(())
}
