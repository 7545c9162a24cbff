//! Tests of the example programs, on small films.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use image::AnimationDecoder;
use image::codecs::gif::GifDecoder;

use glam::DVec3;
use rayreel::Engine;
use rayreel::components::Transform;
use rayreel::output::{FrameFormat, read_frame};
use rayreel::trajectory::Trajectory;

use super::movies::animated_png;

#[path = "../../scenes/code/bouncing_balls.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod bouncing_balls;
#[path = "../../scenes/code/camera_path.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod camera_path;
#[path = "../../scenes/code/gas.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod gas;
#[path = "../../scenes/code/marbles.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod marbles;
#[path = "../../scenes/code/melting.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod melting;
#[path = "../../scenes/code/packing/main.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod packing;
#[path = "../../scenes/code/passes.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod passes;
#[path = "../../scenes/code/twenty_lines.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod twenty_lines;

/// Renders the timeline of a moving scene as a small movie, without faults.
fn render_movie(mut engine: Engine) {
    engine.settings.size = Some((32, 18));
    let folder = tempfile::tempdir().unwrap();
    let report = engine.render_movie(folder.path().join("film.apng")).unwrap();
    assert_eq!(report.to_string(), "96 frames rendered, 0 kept");
    let frames = animated_png(&folder.path().join("film.apng"));
    assert!(frames.len() == 96 && frames.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn bouncing_balls_are_rendered_without_faults() {
    render_movie(bouncing_balls::engine().unwrap());
}

#[test]
fn camera_path_keeps_the_size_of_its_subject() {
    let mut engine = camera_path::engine().unwrap();
    // Returns the eye, and the corner of the view in the plane of the subject.
    let mut view = |frame| {
        engine.seek(engine.timeline.time_of(frame)).unwrap();
        let camera = engine.prepared().unwrap().camera();
        (camera.position(), camera.position() + camera.towards(0, 0))
    };
    let ((near, first), (far, last)) = (view(0), view(95));
    assert!(near.distance(far) > 40.0 && first.distance(last) < 1e-9, "{near} {first} {far} {last}");
    render_movie(engine);
}

/// Checks that a program writes the trajectory of this many frames that a shipped scene shows.
#[track_caller]
fn assert_writes(shipped: &str, frames: usize, write: impl FnOnce(&Path)) {
    let folder = tempfile::tempdir().unwrap();
    let written = folder.path().join("written.extxyz");
    write(&written);
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/data").join(shipped);
    let [written, shipped] = [written, shipped].map(|file| Trajectory::open(&file, None).unwrap());
    assert_eq!((written.frames(), shipped.frames()), (frames, frames));
    for frame in 0..frames {
        assert!(written.read(frame).unwrap() == shipped.read(frame).unwrap(), "frame {frame}");
    }
}

#[test]
fn programs_write_the_trajectories_of_the_shipped_scenes() {
    assert_writes("melting.extxyz.gz", 60, |file| melting::melt(file, 60).unwrap());
    assert_writes("gas.extxyz.gz", 101, |file| gas::shoot(file, 101).unwrap());
}

#[test]
fn the_crystal_keeps_its_temperature_and_its_middle() {
    let mut atoms = melting::Atoms::crystal();
    let middle = |atoms: &melting::Atoms| {
        let sum = atoms.positions.iter().fold(DVec3::ZERO, |sum, position| sum + DVec3::from(*position));
        sum / atoms.positions.len() as f64
    };
    assert_eq!(atoms.positions.len(), 500);
    assert!(middle(&atoms).length() < 1e-12);
    (0..1000).for_each(|_| atoms.step(0.1));
    assert!((atoms.temperature() - 0.1).abs() < 0.01, "{}", atoms.temperature());
    assert!(middle(&atoms).length() < 1e-9, "{}", middle(&atoms));
}

#[test]
fn the_gas_keeps_its_energy_and_only_walls_change_its_momentum() {
    let mut gas = gas::Gas::new();
    let momentum = |gas: &gas::Gas| {
        gas.spheres.iter().fold(DVec3::ZERO, |sum, sphere| sum + sphere.mass * DVec3::from(sphere.velocity))
    };
    let (energy, before, shot) = (gas.energy(), momentum(&gas), gas.spheres[0]);
    for frame in 1..=100 {
        gas.advance(0.05 * f64::from(frame));
        for (index, sphere) in gas.spheres.iter().enumerate() {
            let position = DVec3::from(sphere.position);
            let room = DVec3::from(gas::HALF_BOX) - position.abs() - sphere.radius;
            assert!(room.min_element() > -1e-9, "frame {frame}: sphere {index} is in a wall, {room}");
            for other in &gas.spheres[..index] {
                let gap = position.distance(DVec3::from(other.position)) - sphere.radius - other.radius;
                assert!(gap > -1e-9, "frame {frame}: sphere {index} is in another, {gap}");
            }
        }
        assert!((gas.energy() / energy - 1.0).abs() < 1e-12, "frame {frame}: {}", gas.energy());
        let change = momentum(&gas) - before - DVec3::from(gas.from_walls);
        assert!(change.length() < 1e-9, "frame {frame}: {change}");
    }
    // Friction slows the heavy sphere down.
    let speed = |sphere: &gas::Sphere| DVec3::from(sphere.velocity).length();
    assert!(speed(&gas.spheres[0]) < 0.75 * speed(&shot), "{}", speed(&gas.spheres[0]));
}

#[test]
fn boxes_lose_energy_and_rest_in_the_tray_and_around_without_overlap() {
    let folder = tempfile::tempdir().unwrap();
    let written = folder.path().join("packing.ron");
    packing::pack(&written, 121).unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/data/packing.ron");
    assert!(fs::read_to_string(written).unwrap() == fs::read_to_string(shipped).unwrap());

    let mut packing = packing::Packing::new();
    let mut energy = packing.energy();
    for step in 0..2400 {
        packing.step();
        let before = energy;
        energy = packing.energy();
        assert!(energy < before + 1e-6, "step {step}: {before} {energy}");
        assert!(step % 20 > 0 || packing.overlap() < 0.015, "step {step}: {}", packing.overlap());
    }
    let is_slow = |velocity: [f64; 3]| DVec3::from(velocity).length() < 0.05;
    let slow = packing.boxes().iter().filter(|body| is_slow(body.velocity)).count();
    assert!(slow > 190, "{slow} of {}", packing.boxes().len());
    assert!(packing.boxes().iter().all(|body| body.position[1] > 0.14));
}

#[test]
fn marbles_stay_outside_pegs_floor_walls_and_each_other() {
    let mut engine = marbles::engine().unwrap();
    let (pegs, radius) = (marbles::pegs(), marbles::MARBLE);
    let mut lowest = f64::INFINITY;
    for frame in 0..96 {
        engine.seek(engine.timeline.time_of(frame)).unwrap();
        let mut query = engine.world().query::<(&Transform, &marbles::Velocity)>();
        let places: Vec<DVec3> = query.iter().map(|(transform, _)| transform.translation).collect();
        for (index, marble) in places.iter().enumerate() {
            let nearest = |others: &[DVec3]| {
                others.iter().map(|other| other.distance(*marble)).fold(f64::INFINITY, f64::min)
            };
            assert!(marble.z == 0.0 && marble.y > radius - 1e-9, "frame {frame}: {marble}");
            assert!(marble.x.abs() < marbles::WALL - radius + 1e-9, "frame {frame}: {marble}");
            assert!(nearest(&pegs) > marbles::PEG + radius - 1e-9, "frame {frame}: {marble}");
            assert!(nearest(&places[..index]) > 2.0 * radius, "frame {frame}: {marble}");
            lowest = lowest.min(marble.y);
        }
    }
    assert!(lowest < radius + 0.01, "no marble has come down: {lowest}");
    render_movie(engine);
}

#[test]
fn twenty_lines_make_a_film() {
    let folder = tempfile::tempdir().unwrap();
    let movie = folder.path().join("film.gif");
    assert_eq!(twenty_lines::film(&movie).unwrap().to_string(), "24 frames rendered, 0 kept");
    let file = BufReader::new(File::open(movie).unwrap());
    let frames = GifDecoder::new(file).unwrap().into_frames().collect_frames().unwrap();
    assert!(frames.len() == 24 && frames[0].buffer() != frames[12].buffer());
}

#[test]
fn passes_are_pictures_of_one_frame() {
    let mut engine = Engine::load("scenes/chess_morning.ron").unwrap();
    engine.settings.size = Some((96, 54));
    let folder = tempfile::tempdir().unwrap();
    passes::write_passes(&mut engine, 48, folder.path()).unwrap();
    let read = |name| read_frame(&folder.path().join(name), FrameFormat::default()).unwrap();
    let transfer = engine.effective_settings().film.transfer;
    assert_eq!(read("frame.png"), engine.render_frame(48).unwrap().encoded(transfer));
    let colors = |name| read(name).pixels().iter().copied().collect::<BTreeSet<_>>();
    // The nearest point is white. Boards face upwards. Outlines are black on white.
    assert!(colors("depth.png").contains(&[255; 3]) && colors("depth.png").len() > 20);
    assert!(colors("normal.png").contains(&[128, 255, 128]));
    assert!(colors("albedo.png").len() > 5);
    assert_eq!(colors("outlines.png"), BTreeSet::from([[0; 3], [255; 3]]));
}
