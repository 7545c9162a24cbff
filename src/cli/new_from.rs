//! The scene that `rayreel new --from` writes for a data file.

use std::path::Path;

use anyhow::anyhow;

use rayreel::clouds::{TrajectoryFile, is_element};
use rayreel::glam::DVec3;
use rayreel::trajectory::{Snapshot, Values};

/// Returns the text of a scene, to be written to `scene`, that shows a data file.
pub(super) fn scene_of(data: &Path, scene: &Path) -> anyhow::Result<String> {
    let file = TrajectoryFile::open(data, false)?;
    let frames = file.trajectory().frames();
    // The extent changes little from frame to frame; reading all of them could take long.
    let mut extent = ParticleBounds::default();
    for frame in [0, frames / 2, frames - 1] {
        let snapshot = file.frame(frame).map_err(|error| anyhow!(error))?;
        extent.add(&snapshot)?;
    }
    let first = file.frame(0).map_err(|error| anyhow!(error))?;
    let look = Look::of(&first, &extent);
    let source = source_of(data, scene);
    let radius = Some(extent.radius() + look.largest).filter(|radius| *radius > 0.0).unwrap_or(1.0);
    let (center, distance) = (extent.center(), radius / libm::sin(FIELD_OF_VIEW.to_radians() / 2.0) * 1.05);
    // Rounded to a small part of the extent, however far from the origin the particles are.
    let in_extent = |number: f64| rounded_to(number, radius);
    let [x, y, z] = center.to_array().map(in_extent);
    let seconds = if frames > 1 { frames.div_ceil(FRAMES_PER_SECOND).max(4) } else { 6 };
    let Look { shape, settings, about, .. } = look;
    let (count, distance) = (first.count, rounded(distance));
    Ok(format!(
        "// {count} particles in {frames} {} of {source}. Render it with:  rayreel render FILE
// Lengths are in the units of the data, angles in degrees, times in seconds; x is right, y up, z towards the viewer.
Scene(
    timeline: (fps: {FRAMES_PER_SECOND}, duration: {seconds}),
    film: (width: 1280, height: 720),
    sampling: (samples: 4),
    // The axes of the data, as other programs show them.
    space: RightHanded,
    camera: (position: ({x}, {y}, {}), target: ({x}, {y}, {z}), fov: {FIELD_OF_VIEW}),
    ambient: (0.35, 0.35, 0.35),
    background: \"#ffffff\",
    materials: {{ \"particle\": (k_a: 1, k_d: 0.7, color: \"#4c8ed9\", specular: (k_s: 0.2, shininess: 40)) }},
    entities: [
        (light: Directional(intensity: (0.9, 0.9, 0.9), direction: (-0.5, -1, -0.8))),
    ],
    clouds: [
        // {about}
        (name: \"particles\", source: {source}, {shape}, material: \"particle\"{settings},
         frames: (fps: {FRAMES_PER_SECOND}, end: Loop)),
    ],
    // A turntable: one turn around the particles.
    animate: [
        (target: \"camera\", channel: Position, track: Orbit(center: ({x}, {y}, {z}), radius: {distance}, duration: {seconds})),
    ],
)
",
        if frames == 1 { "frame" } else { "frames" },
        in_extent(center.z + distance),
    ))
}

const FRAMES_PER_SECOND: usize = 24;

/// The number of atoms from which on bonds are too small to be seen.
const MOST_BONDED: usize = 20_000;

/// The vertical field of view, in degrees.
const FIELD_OF_VIEW: f64 = 30.0;

/// The box around particles.
#[derive(Clone, Copy)]
struct ParticleBounds {
    least: DVec3,
    greatest: DVec3,
}

impl Default for ParticleBounds {
    fn default() -> Self {
        Self { least: DVec3::INFINITY, greatest: DVec3::NEG_INFINITY }
    }
}

impl ParticleBounds {
    fn add(&mut self, snapshot: &Snapshot) -> anyhow::Result<()> {
        let [x, y, z] = snapshot.positions()?;
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            let position = DVec3::new(*x, *y, *z);
            if position.is_finite() {
                self.least = self.least.min(position);
                self.greatest = self.greatest.max(position);
            }
        }
        Ok(())
    }

    fn center(&self) -> DVec3 {
        let center = self.least.midpoint(self.greatest);
        if center.is_finite() { center } else { DVec3::ZERO }
    }

    /// Returns half the diagonal.
    fn radius(&self) -> f64 {
        let radius = (self.greatest - self.least).length() / 2.0;
        if radius.is_finite() { radius } else { 0.0 }
    }
}

/// The shape and the settings of particles.
struct Look {
    shape: String,
    /// Further fields, each after a comma.
    settings: String,
    /// A comment on them.
    about: &'static str,
    /// The largest radius, or nearly so.
    largest: f64,
}

impl Look {
    fn of(snapshot: &Snapshot, extent: &ParticleBounds) -> Self {
        let kinds = match snapshot.column("element") {
            Some(Values::Labels { names, .. }) => names.as_slice(),
            _ => &[],
        };
        if !kinds.is_empty() && kinds.iter().all(|kind| is_element(kind)) {
            let (look, about, largest) = if snapshot.count < MOST_BONDED {
                ("style: BallAndStick", "Atoms and bonds; `style: Licorice` shows the bonds alone.", 0.5)
            } else {
                (
                    "shape: Sphere(radius: 1), scale_by: VanDerWaals",
                    "Atoms by their van der Waals radii, in angstroms; `style: BallAndStick` in place of both adds bonds.",
                    2.0,
                )
            };
            return Self {
                shape: look.to_owned(),
                settings: ", color_by: Element".to_owned(),
                about,
                largest,
            };
        }
        let kind = if kinds.is_empty() { "type" } else { "element" };
        let color = match snapshot.column(kind) {
            Some(_) => format!(", color_by: Category({kind:?})"),
            None => String::new(),
        };
        let radii = ["radius", "r", "Radius"].into_iter().find_map(|name| match snapshot.column(name) {
            Some(Values::Numbers(radii)) => Some((name, radii.iter().copied().fold(0.0, f64::max))),
            _ => None,
        });
        if let Some((name, largest)) = radii {
            let settings = format!(", scale_by: Column({name:?}){color}");
            return Self {
                shape: "shape: Sphere(radius: 1)".to_owned(),
                settings,
                about: "Radii from the data.",
                largest,
            };
        }
        let radius = spacing(snapshot, extent) * 0.4;
        Self {
            shape: format!("shape: Sphere(radius: {})", rounded(radius)),
            settings: color,
            about: "The radius leaves some space between particles; `scale_by` takes it from a column.",
            largest: radius,
        }
    }
}

/// Returns the distance of particles that fill the box around them evenly, or 1.
#[expect(clippy::cast_precision_loss, reason = "an estimate")]
fn spacing(snapshot: &Snapshot, extent: &ParticleBounds) -> f64 {
    let sides = (extent.greatest - extent.least)
        .to_array()
        .into_iter()
        .filter(|side| *side > 0.0 && side.is_finite());
    let sides: Vec<f64> = sides.collect();
    if sides.is_empty() {
        return 1.0;
    }
    let volume: f64 = sides.iter().product();
    libm::pow(volume / snapshot.count.max(1) as f64, 1.0 / sides.len() as f64)
}

/// Returns a number of four digits, as written in a scene.
fn rounded(number: f64) -> f64 {
    let number: f64 = format!("{number:.3e}").parse().unwrap_or(number);
    if number == 0.0 { 0.0 } else { number }
}

/// Returns a number with the decimals that are needed for a thousandth of `size`, as written in a scene.
fn rounded_to(number: f64, size: f64) -> f64 {
    let decimals = usize::try_from(4 - libm::ilogb(size) * 3 / 10).unwrap_or(0).min(300);
    let number: f64 = format!("{number:.decimals$}").parse().unwrap_or(number);
    if number == 0.0 { 0.0 } else { number }
}

/// Returns the path of a data file as written in a scene: relative to the folder of the scene if the file is in it.
fn source_of(data: &Path, scene: &Path) -> String {
    let folder = scene.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let absolute = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let (data, folder) = (absolute(data), absolute(folder));
    let path = data.strip_prefix(&folder).unwrap_or(&data);
    // RON has the escapes of Rust.
    format!("{:?}", path.to_string_lossy())
}
