//! Marbles that fall through a board of pegs: `cargo run --release --example marbles` makes the movie `out/marbles.mp4`, or the file that it
//! is given, as `marbles.gif`. Rays find when and where a marble strikes, so that no marble enters a peg, however fast it is.

use std::error::Error;

use rayreel::color::{hex, srgb};
use rayreel::components::{
    Ambient, Background, Camera, FilmSettings, Light, Material, Sampling, Shape, Specular, Transform,
};
use rayreel::glam::DVec3;
use rayreel::time::Timeline;
use rayreel::{Context, Engine, EngineError, Ray, Rgb, Step, Time, World};

/// Radius of a marble.
pub(crate) const MARBLE: f64 = 0.22;
/// Radius of a peg.
pub(crate) const PEG: f64 = 0.16;
/// Distance of the walls from the middle.
pub(crate) const WALL: f64 = 3.9;
const GRAVITY: DVec3 = DVec3::new(0.0, -9.81, 0.0);

/// Velocity in scene units per second.
#[derive(Clone)]
pub(crate) struct Velocity(DVec3);

/// Returns the centres of the pegs: rows of 6 and 7 by turns.
pub(crate) fn pegs() -> Vec<DVec3> {
    let row = |row: i32| {
        let count = 6 + row % 2;
        (0..count).map(move |index| {
            DVec3::new(f64::from(2 * index - count + 1) * 0.5, 1.0 + 0.8 * f64::from(row), 0.0)
        })
    };
    (0..5).flat_map(row).collect()
}

/// Returns the obstacles as the centre of a marble meets them: pegs, floor and walls, grown by the radius of a marble.
fn obstacles() -> Result<Engine, EngineError> {
    let mut world = World::new();
    let shape = Shape::Sphere { radius: PEG + MARBLE };
    for peg in pegs() {
        world.spawn((shape, Material::default(), Transform::from_translation(peg)));
    }
    for (normal, distance) in [(DVec3::Y, MARBLE), (DVec3::X, MARBLE - WALL), (DVec3::NEG_X, MARBLE - WALL)] {
        let place = Transform::from_translation(distance * normal);
        world.spawn((Shape::Plane { normal }, Material::default(), place));
    }
    let mut engine = Engine::new(world);
    engine.seek(Time::ZERO)?;
    Ok(engine)
}

/// Moves the marbles by one step, from bounce to bounce.
fn fall(context: &mut Context<'_>, obstacles: &Engine) {
    let dt = context.step_seconds();
    for (transform, Velocity(velocity)) in context.world.query_mut::<(&mut Transform, &mut Velocity)>() {
        *velocity += dt * GRAVITY;
        let mut rest = dt;
        let mut next = obstacles.cast(Ray { origin: transform.translation, direction: *velocity });
        // A marble in a wedge would bounce without end: the rest of its step is dropped.
        for _ in 0..32 {
            // The ray's direction is the velocity, so that t is a time.
            let Some((hit, t)) = next.and_then(|hit| hit.t.filter(|t| *t < rest).map(|t| (hit, t))) else {
                transform.translation += rest * *velocity;
                break;
            };
            rest -= t;
            transform.translation = hit.point;
            *velocity -= 1.5 * velocity.dot(hit.normal) * hit.normal;
            // The ray leaves the surface that was hit, without an offset.
            next = obstacles.cast(hit.leave_towards(*velocity));
        }
    }
}

pub(crate) fn engine() -> Result<Engine, Box<dyn Error>> {
    let mut world = World::new();
    let steel = Material::matte(srgb(120, 124, 136));
    for peg in pegs() {
        let transform = Transform::from_translation(peg);
        world.spawn((
            Shape::Sphere { radius: PEG },
            steel,
            Specular { k_s: 0.5, shininess: 40.0 },
            transform,
        ));
    }
    let shine = Specular { k_s: 0.4, shininess: 60.0 };
    for (x, y, color) in [
        (-2.1, 5.0, "#ff783c"),
        (0.93, 5.8, "#ffc83c"),
        (-1.1, 6.6, "#78c850"),
        (2.37, 7.4, "#3ca0ff"),
        (0.3, 8.2, "#a064dc"),
    ] {
        let (shape, color) = (Shape::Sphere { radius: MARBLE }, Material::matte(hex(color)?));
        world.spawn((shape, color, shine, Transform::at(x, y, 0.0), Velocity(DVec3::ZERO)));
    }
    let (board, wood) = (Material::matte(srgb(232, 218, 194)), Material::matte(srgb(168, 128, 92)));
    world.spawn((Shape::Plane { normal: DVec3::NEG_Z }, board, Transform::at(0.0, 0.0, 0.3)));
    world.spawn((Shape::Plane { normal: DVec3::Y }, wood));
    for side in [-1.0, 1.0] {
        let shape = Shape::Box { size: DVec3::new(0.3, 12.0, 0.6) };
        world.spawn((shape, wood, Transform::at(side * (WALL + 0.15), 6.0, 0.0)));
    }
    world.spawn((Light::directional(DVec3::new(0.4, -0.8, 1.0), Rgb::splat(0.8)),));
    world.spawn((Camera::looking_at(DVec3::new(0.0, 2.6, -6.6), DVec3::new(0.0, 2.5, 0.0)),));
    world.spawn((FilmSettings::new(448, 252), Sampling { samples: 8, ..Sampling::default() }));
    world.spawn((Ambient(Rgb::ONE), Background::Flat(srgb(232, 218, 194))));

    let mut engine = Engine::new(world);
    engine.timeline = Timeline::new(24, 4.0);
    engine.register::<Velocity>();
    let obstacles = obstacles()?;
    engine.add_stepped_system(Step::per_second(240), move |context| fall(context, &obstacles));
    Ok(engine)
}

#[allow(clippy::print_stdout, reason = "a program prints its report")]
fn main() -> Result<(), Box<dyn Error>> {
    let movie = std::env::args().nth(1).unwrap_or("out/marbles.mp4".to_owned());
    let report = engine()?.render_movie(&movie)?;
    println!("{movie}: {report}");
    Ok(())
}
