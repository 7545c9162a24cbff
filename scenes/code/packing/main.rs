//! Boxes that fall into a tray: `cargo run --release --example packing` writes a part of a scene, `out/packing.ron`, or the file that it is
//! given. `scenes/packing.ron` includes it, from `scenes/data`.
//!
//! Rigid boxes are released all at once, slowly spinning. Collisions are inelastic, with Coulomb friction. Contacts of two boxes are found
//! along the axis of least overlap; those of two faces are the corners of one face, clipped by the other. In each short step, impulses at
//! all contacts are corrected in turn, so that no contact moves inwards and friction stays within its bounds (E. Catto, Iterative Dynamics
//! with Temporal Coherence, 2005). The impulses of the previous step are the first guess. Only sums, products, quotients and square roots
//! are used, so that every machine writes the same bytes.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::Path;

mod body;
mod contacts;

use body::{Body, STEP, Vector, difference, dot, sign};
use contacts::{Contact, MARGIN, overlap, touch};

const STEPS_PER_FRAME: usize = 20;
const FRAMES_PER_SECOND: usize = 24;
const ITERATIONS: usize = 6;
/// Scene units per second squared: the pace of boxes half a metre long, or of toys in slow motion.
const GRAVITY: f64 = 6.0;
/// Numbers of boxes along x, y and z at the start, and the distances between them.
const GRID: [usize; 3] = [5, 8, 5];
const SPACING: Vector = [1.15, 1.6, 1.15];
/// Height of the lowest boxes at the start.
const LOWEST: f64 = 3.0;
/// Half of the edges of each kind of box, and its colour.
const KINDS: [(Vector, &str); 5] = [
    ([0.32, 0.32, 0.32], "#e23d28"),
    ([0.62, 0.31, 0.31], "#f7b01b"),
    ([0.46, 0.2, 0.32], "#1f83b5"),
    ([0.75, 0.16, 0.3], "#6aa84f"),
    ([0.38, 0.38, 0.24], "#f6efe0"),
];
/// Centres and halves of the edges of the table, the floor of the tray and its four sides.
const FIXED: [[Vector; 2]; 6] = [
    [[0.0, -1.0, 0.0], [60.0, 1.0, 60.0]],
    [[0.0, 0.1, 0.0], [3.2, 0.1, 3.2]],
    [[-3.3, 0.9, 0.0], [0.1, 0.9, 3.4]],
    [[3.3, 0.9, 0.0], [0.1, 0.9, 3.4]],
    [[0.0, 0.9, -3.3], [3.2, 0.9, 0.1]],
    [[0.0, 0.9, 3.3], [3.2, 0.9, 0.1]],
];
/// Greatest errors of positions and of quaternions between two keys.
const TOLERANCES: [f64; 2] = [0.012, 0.009];

/// The boxes at a time.
#[derive(Debug)]
pub(crate) struct Packing {
    /// Those that do not move, and those that do.
    bodies: Vec<Body>,
    contacts: Vec<Contact>,
}

impl Packing {
    /// Creates the boxes above the tray, turned at random and slowly spinning.
    pub(crate) fn new() -> Self {
        let mut state: u64 = 1;
        let mut random = || {
            // A linear congruential generator (D. Knuth, The Art of Computer Programming 2, 3.3.4); its upper bits are good.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        let mut bodies: Vec<Body> = FIXED.into_iter().map(Body::fixed).collect();
        let [columns, layers, rows] = GRID;
        for index in 0..columns * layers * rows {
            let cell = [index % columns, index / (columns * rows), index / columns % rows];
            loop {
                let place = |axis: usize, random: f64| SPACING[axis] * (cell[axis] as f64 + 0.45 * random);
                let [x, y, z] = [0, 1, 2].map(|axis| place(axis, random()));
                let middle = [(columns - 1) as f64, (rows - 1) as f64].map(|count| count / 2.0);
                let position = [x - SPACING[0] * middle[0], y + LOWEST, z - SPACING[2] * middle[1]];
                let mut body = Body::new(position, kind(index).0);
                body.turn_to([random(), random(), random(), random()]);
                body.spin = [random(), random(), random()];
                if bodies.iter().all(|other| overlap(other, &body).0 < 0.0) {
                    bodies.push(body);
                    break;
                }
            }
        }
        Self { bodies, contacts: Vec::new() }
    }

    /// Returns the boxes that move.
    pub(crate) fn boxes(&self) -> &[Body] {
        &self.bodies[FIXED.len()..]
    }

    /// Returns the kinetic and potential energy.
    pub(crate) fn energy(&self) -> f64 {
        let energy = |body: &Body| body.energy() + GRAVITY * body.position[1] / body.inverse_mass;
        self.boxes().iter().map(energy).sum()
    }

    /// Returns the greatest overlap of two boxes.
    pub(crate) fn overlap(&self) -> f64 {
        self.pairs().map(|[a, b]| overlap(&self.bodies[a], &self.bodies[b]).0).fold(0.0, f64::max)
    }

    /// Returns the pairs of boxes that may touch, the second of which moves.
    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> {
        let pairs = (FIXED.len()..self.bodies.len()).flat_map(|b| (0..b).map(move |a| [a, b]));
        pairs.filter(|[a, b]| {
            let (one, other) = (&self.bodies[*a], &self.bodies[*b]);
            let way = difference(other.position, one.position);
            let reach = dot(other.half, other.half).sqrt() + MARGIN;
            if *a < FIXED.len() {
                return (0..3).all(|axis| way[axis].abs() < one.half[axis] + reach);
            }
            let reach = reach + dot(one.half, one.half).sqrt();
            dot(way, way) < reach * reach
        })
    }

    /// Advances by one step.
    pub(crate) fn step(&mut self) {
        for body in &mut self.bodies[FIXED.len()..] {
            body.velocity[1] -= STEP * GRAVITY;
        }
        let mut contacts: Vec<Contact> = self.pairs().flat_map(|pair| touch(&self.bodies, pair)).collect();
        for contact in &mut contacts {
            let order = |[a, b]: [usize; 2]| [b, a];
            let first = self.contacts.partition_point(|old| order(old.bodies) < order(contact.bodies));
            let count = self.contacts[first..].partition_point(|old| old.bodies == contact.bodies);
            contact.start(&self.contacts[first..first + count], &mut self.bodies);
        }
        for _ in 0..ITERATIONS {
            contacts.iter_mut().for_each(|contact| contact.correct(&mut self.bodies));
        }
        self.bodies[FIXED.len()..].iter_mut().for_each(Body::fly);
        self.contacts = contacts;
    }
}

/// Positions and orientations of a box in each frame.
#[derive(Debug, Default)]
struct Course {
    positions: Vec<Vector>,
    orientations: Vec<[f64; 4]>,
}

impl Course {
    fn record(&mut self, body: &Body) {
        // Two quaternions stand for one orientation. The nearer one leads there by the shorter way.
        let before = self.orientations.last().unwrap_or(&body.orientation);
        let nearness: f64 = (0..4).map(|part| before[part] * body.orientation[part]).sum();
        self.orientations.push(body.orientation.map(|part| part * sign(nearness)));
        self.positions.push(body.position);
    }
}

/// Returns the size and the colour of a box.
fn kind(index: usize) -> (Vector, &'static str) {
    // A multiplicative hash (D. Knuth, The Art of Computer Programming 3, 6.4) mixes them.
    KINDS[(((index + 1) * 40_503) >> 7) % KINDS.len()]
}

/// Returns the frames that become keys: linear interpolation between them gives all other frames within the tolerance.
fn keys<const N: usize>(values: &[[f64; N]], tolerance: f64) -> Vec<usize> {
    let fits = |from: usize, to: usize| {
        (from + 1..to).all(|frame| {
            let share = (frame - from) as f64 / (to - from) as f64;
            let error = |part: usize| {
                let between = values[from][part] + share * (values[to][part] - values[from][part]);
                values[frame][part] - between
            };
            (0..N).map(|part| error(part) * error(part)).sum::<f64>() < tolerance * tolerance
        })
    };
    let (mut keys, last) = (vec![0], values.len() - 1);
    while let Some(from) = keys.last().copied().filter(|from| *from < last) {
        keys.push((from + 1..=last).take_while(|to| fits(from, *to)).last().unwrap_or(last));
    }
    // A box that rests needs no more keys.
    let rests = |frame: usize| values[frame].iter().zip(&values[last]).all(|(a, b)| (a - b).abs() < 0.001);
    while keys.len() > 1 && rests(keys[keys.len() - 2]) {
        keys.pop();
    }
    keys
}

/// Appends the keys of a target, as `"box 1", channel: Rotation`. Their times are frames.
fn write_keys<const N: usize>(
    text: &mut String,
    target: &str,
    values: &[[f64; N]],
    tolerance: f64,
) -> std::fmt::Result {
    write!(text, "        (target: {target}, speed: {FRAMES_PER_SECOND}, track: Keys([")?;
    for frame in keys(values, tolerance) {
        let parts = values[frame].map(|part| format!("{part:.3}")).join(", ");
        let kind = if N == 4 { "Quat" } else { "" };
        write!(text, "({frame}, {kind}({parts})), ")?;
    }
    writeln!(text, "])),")
}

/// Writes a part of a scene with this many frames, and returns the boxes after the last one.
pub(crate) fn pack(file: &Path, frames: usize) -> Result<Packing, Box<dyn Error>> {
    let mut packing = Packing::new();
    let count = packing.boxes().len();
    let mut text = format!(
        "// {count} boxes that fall into a tray, written by the program in `code/packing`.\nScene(\n"
    );
    text += "    materials: { \"block\": (k_a: 0.8, k_d: 0.8, specular: (k_s: 0.2, shininess: 60)) },\n    entities: [\n";
    for index in 0..count {
        let (half, color) = kind(index);
        let [x, y, z] = half.map(|half| 2.0 * half);
        writeln!(
            text,
            "        (name: \"box {index}\", shape: Box(size: ({x}, {y}, {z})), color: \"{color}\", material: \"block\"),"
        )?;
    }
    let mut courses: Vec<Course> = packing.boxes().iter().map(|_| Course::default()).collect();
    for frame in 0..frames {
        if frame > 0 {
            (0..STEPS_PER_FRAME).for_each(|_| packing.step());
        }
        packing.boxes().iter().zip(&mut courses).for_each(|(body, course)| course.record(body));
    }
    text += "    ],\n    animate: [\n";
    for (index, Course { positions, orientations }) in courses.iter().enumerate() {
        write_keys(&mut text, &format!("\"box {index}\", channel: Translation"), positions, TOLERANCES[0])?;
        write_keys(&mut text, &format!("\"box {index}\", channel: Rotation"), orientations, TOLERANCES[1])?;
    }
    text += "    ],\n)\n";
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(file, text)?;
    Ok(packing)
}

#[allow(clippy::print_stdout, reason = "a program prints its report")]
fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).unwrap_or("out/packing.ron".to_owned());
    let packing = pack(Path::new(&file), 121)?;
    let (overlap, energy) = (packing.overlap(), packing.energy());
    println!(
        "the boxes are in {file}; at the end they overlap by at most {overlap:.4}, and their energy is {energy:.0}"
    );
    Ok(())
}
