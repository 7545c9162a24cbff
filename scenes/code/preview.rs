//! A preview of a world built in code: `cargo run --release --example preview` shows three suns that chase each other along a figure of
//! eight, until Enter is pressed. The page has a slider for their gravity, and the colour of the sky. The port is 8080, or the one that it is
//! given. A page that is open stays where it is when the program is changed and starts again.

use std::error::Error;

use rayreel::color::hex;
use rayreel::components::{
    Ambient, Background, Camera, Control, Emission, FilmSettings, Light, Material, Sampling, Shape, Transform,
};
use rayreel::glam::DVec3;
use rayreel::live::{Server, Session};
use rayreel::time::Timeline;
use rayreel::{Context, Engine, Rgb, Step, World};

/// With 1, the orbit is closed; with less, the suns fly apart.
pub(crate) const GRAVITY: Control = Control::number("gravity", 1.0, 0.5..=1.5);
pub(crate) const SKY: Control<Rgb> = Control::color("sky", Rgb::new(0.001_5, 0.001_8, 0.003_7));

#[derive(Clone)]
struct Velocity(DVec3);

/// Moves the suns by one step, under their mutual gravity. The leapfrog method keeps their orbit closed.
fn attract(context: &mut Context<'_>) {
    let (dt, gravity) = (context.step_seconds(), GRAVITY.value(context.world));
    let mut suns =
        context.world.query_mut::<(&mut Transform, &mut Velocity)>().into_iter().collect::<Vec<_>>();
    for (transform, velocity) in &mut suns {
        transform.translation += 0.5 * dt * velocity.0;
    }
    let places: Vec<DVec3> = suns.iter().map(|(transform, _)| transform.translation).collect();
    for (transform, velocity) in &mut suns {
        for away in
            places.iter().map(|place| *place - transform.translation).filter(|away| *away != DVec3::ZERO)
        {
            velocity.0 += gravity * dt * away / (away.length() * away.length_squared());
        }
        transform.translation += 0.5 * dt * velocity.0;
    }
}

/// Paints the sky in its colour.
fn paint(context: &mut Context<'_>) {
    let sky = SKY.value(context.world);
    for background in context.world.query_mut::<&mut Background>() {
        *background = Background::Flat(sky);
    }
    context.changes.mark_settings();
}

pub(crate) fn engine() -> Result<Engine, Box<dyn Error>> {
    // Chenciner and Montgomery, "A remarkable periodic solution of the three-body problem", 2000: masses and gravity of 1.
    const PERIOD: f64 = 6.325_913_98;
    let start = DVec3::new(0.970_004_36, -0.243_087_53, 0.0);
    let speed = DVec3::new(-0.932_407_37, -0.864_731_46, 0.0);
    let mut world = World::new();
    for (color, place, velocity) in
        [("#ffd27a", start, -0.5 * speed), ("#ff8a5c", -start, -0.5 * speed), ("#8ab8ff", DVec3::ZERO, speed)]
    {
        let (shape, transform) = (Shape::Sphere { radius: 0.12 }, Transform::from_translation(place));
        let (color, velocity) = (hex(color)?, Velocity(velocity));
        let light = Light::point(0.5 * color);
        world.spawn((shape, Material::matte(color), Emission(color), light, transform, velocity));
    }
    world.spawn((
        Shape::Plane { normal: DVec3::Y },
        Material::matte(hex("#8c8fa0")?),
        Transform::at(0.0, -0.7, 0.0),
    ));
    world.spawn((Camera::looking_at(DVec3::new(0.0, 0.6, -3.2), DVec3::ZERO), Ambient(Rgb::splat(0.05))));
    world.spawn((FilmSettings::new(960, 540), Sampling { samples: 8, ..Sampling::default() }));
    world.spawn((Background::default(), SKY));
    world.spawn((GRAVITY,));

    let mut engine = Engine::new(world);
    engine.timeline = Timeline::new(24, PERIOD);
    engine.register::<Velocity>();
    engine.add_stepped_system(Step::per_second(1000), attract);
    engine.add_system(paint);
    Ok(engine)
}

/// Starts the preview, which runs until both are dropped.
pub(crate) fn serve(port: u16) -> Result<(Server, Session), Box<dyn Error>> {
    let session = Session::of_engine("three suns", engine()?, |_| {})?;
    Ok((Server::start(port, session.handle())?, session))
}

#[allow(clippy::print_stdout, reason = "a program prints its address")]
fn main() -> Result<(), Box<dyn Error>> {
    let (server, _session) = serve(std::env::args().nth(1).map_or(Ok(8080), |port| port.parse())?)?;
    println!("http://{}/ until Enter is pressed", server.address());
    std::io::stdin().read_line(&mut String::new())?;
    Ok(())
}
