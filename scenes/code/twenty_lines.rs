//! A film in twenty lines, to build on: `cargo run --release --example twenty_lines` makes the movie `out/twenty_lines.gif` of a ball that
//! hops.

use std::error::Error;
use std::path::Path;

use rayreel::color::hex;
use rayreel::components::{Ambient, Camera, FilmSettings, Light, Material, Sampling, Shape, Transform};
use rayreel::glam::DVec3;
use rayreel::sequence::SequenceReport;
use rayreel::time::Timeline;
use rayreel::{Engine, Rgb, World};

pub(crate) fn film(movie: impl AsRef<Path>) -> Result<SequenceReport, Box<dyn Error>> {
    let mut world = World::new();
    world.spawn((FilmSettings::new(480, 270), Sampling { samples: 8, ..Sampling::default() }));
    world.spawn((Ambient(Rgb::splat(0.6)), Camera::looking_at(DVec3::new(0.0, 3.0, -9.0), DVec3::Y)));
    world.spawn((Light::point(Rgb::splat(0.8)), Transform::at(-5.0, 8.0, -5.0)));
    world.spawn((Shape::Plane { normal: DVec3::Y }, Material::matte(hex("#d2c8b4")?)));
    let (shape, clay) = (Shape::Sphere { radius: 1.0 }, Material::matte(hex("#ff783c")?));
    let ball = world.spawn((shape, clay, Transform::IDENTITY));

    let mut engine = Engine::new(world);
    engine.timeline = Timeline::new(24, 1.0);
    engine.add_system(move |context| {
        let seconds = context.time.seconds();
        if let Ok(mut transform) = context.world.get::<&mut Transform>(ball) {
            transform.translation.y = 1.0 + 6.0 * seconds * (1.0 - seconds);
        }
    });
    Ok(engine.render_movie(movie)?)
}

#[allow(clippy::print_stdout, reason = "a program prints its report")]
fn main() -> Result<(), Box<dyn Error>> {
    println!("{}", film("out/twenty_lines.gif")?);
    Ok(())
}
