//! Balls that bounce on a floor, simulated in 240 steps per second: `cargo run --release --example bouncing_balls` makes the movie
//! `out/bouncing_balls.mp4`, or the file that it is given, as `balls.gif`.

use std::error::Error;

use rayreel::color::{hex, srgb};
use rayreel::components::{Ambient, Background, Camera, FilmSettings, Light, Material, Shape, Transform};
use rayreel::glam::DVec3;
use rayreel::time::Timeline;
use rayreel::{Context, Engine, Rgb, Step, World};

/// A ball and its motion.
#[derive(Clone)]
struct Ball {
    radius: f64,
    velocity: DVec3,
}

/// Moves the balls by one step.
fn bounce(context: &mut Context<'_>) {
    let dt = context.step_seconds();
    for (transform, ball) in context.world.query_mut::<(&mut Transform, &mut Ball)>() {
        ball.velocity.y -= 9.81 * dt;
        transform.translation += ball.velocity * dt;
        if transform.translation.y < ball.radius && ball.velocity.y < 0.0 {
            ball.velocity.y *= -0.85;
        }
    }
}

pub(crate) fn engine() -> Result<Engine, Box<dyn Error>> {
    let mut world = World::new();
    for (index, color) in (0..5).zip(["#ff783c", "#ffc83c", "#78c850", "#3ca0ff", "#a064dc"]) {
        let (x, radius) = (2.0 * f64::from(index) - 4.0, 0.5 + 0.1 * f64::from(index));
        let ball = Ball { radius, velocity: DVec3::new(0.0, 0.0, -0.5 * x) };
        let place = Transform::at(x, 2.0 + f64::from(index), 2.0);
        world.spawn((Shape::Sphere { radius }, Material::matte(hex(color)?), place, ball));
    }
    world.spawn((Shape::Plane { normal: DVec3::Y }, Material::matte(srgb(210, 200, 180))));
    world.spawn((Light::point(Rgb::splat(0.9)), Transform::at(-6.0, 9.0, -6.0)));
    world.spawn((Camera::looking_at(DVec3::new(0.0, 3.0, -12.0), DVec3::new(0.0, 2.0, 0.0)),));
    world.spawn((FilmSettings::new(640, 360), Ambient(Rgb::ONE), Background::Flat(srgb(190, 215, 240))));

    let mut engine = Engine::new(world);
    engine.timeline = Timeline::new(24, 4.0);
    engine.register::<Ball>();
    engine.add_stepped_system(Step::per_second(240), bounce);
    Ok(engine)
}

#[allow(clippy::print_stdout, reason = "a program prints its report")]
fn main() -> Result<(), Box<dyn Error>> {
    let movie = std::env::args().nth(1).unwrap_or("out/bouncing_balls.mp4".to_owned());
    let report = engine()?.render_movie(&movie)?;
    println!("{movie}: {report}");
    Ok(())
}
