//! Tests of crowds in which a few entities change from frame to frame: the BVH is mostly refitted, which must not affect the pictures.

use glam::{DQuat, DVec3};

use rayreel::components::{
    Camera, FilmSettings, Light, Material, Name, Quality, Reflective, Refractive, Sampling, Shape, Transform,
};
use rayreel::{Context, Engine, Entity, Ray, RenderRequest, Rgb, Step, World};

use crate::splitmix::Random;

const COUNT: usize = 600;

fn number(random: &mut Random) -> f64 {
    f64::from(u32::try_from(random.bits() >> 32).unwrap()) / f64::from(u32::MAX)
}

fn place(random: &mut Random) -> DVec3 {
    (DVec3::from_array([(); 3].map(|()| number(random))) - 0.5) * 12.0
}

fn clay(random: &mut Random) -> Material {
    let color = Rgb::from_array([(); 3].map(|()| if random.once_in(2) { 1.0 } else { 0.3 }));
    Material::matte(color)
}

/// Returns a world of spheres, ellipsoids, axis-aligned and rotated boxes, some of them mirrors or glass, on a plane and in front of a huge
/// sphere, and the entities of the crowd.
fn crowd(seed: u64) -> (World, Vec<Entity>) {
    let mut random = Random(seed);
    let mut world = World::new();
    world.spawn((Light::point(Rgb::ONE), Transform::at(9.0, 9.0, 9.0)));
    world.spawn((Camera { position: DVec3::new(0.0, 1.0, -12.0), ..Camera::default() },));
    let film = FilmSettings::new(28, 18);
    world.spawn((
        film,
        Quality { depth: 4, ..Quality::default() },
        Sampling { samples: 2, ..Sampling::default() },
    ));
    let floor = Transform::at(0.0, -8.0, 0.0);
    world.spawn((Shape::Plane { normal: DVec3::Y }, clay(&mut random), floor));
    let far = Transform::at(0.0, 0.0, 3.0e6);
    world.spawn((Shape::Sphere { radius: 2.9e6 }, clay(&mut random), far));
    let crowd: Vec<Entity> = (0..COUNT)
        .map(|index| {
            let size = 0.1 + 0.5 * number(&mut random);
            let rod = (DVec3::ZERO, DVec3::new(0.3, size, 0.1));
            let shape = match index % 4 {
                0 => Shape::Sphere { radius: 0.5 * size },
                1 => Shape::Cylinder { radius: 0.3 * size, from: rod.0, to: rod.1 },
                2 => Shape::Capsule { radius: 0.2 * size, from: rod.0, to: rod.1 },
                _ => Shape::Box { size: DVec3::new(size, 0.5, size) },
            };
            let mut transform = Transform::from_translation(place(&mut random));
            if random.once_in(3) {
                transform.rotation = DQuat::from_axis_angle(DVec3::Y, number(&mut random));
                transform.scale = DVec3::new(1.0, 0.7, 1.0);
            }
            let entity = world.spawn((shape, clay(&mut random), transform));
            if random.once_in(9) {
                world.insert_one(entity, Reflective { k_r: 0.6 }).unwrap();
            } else if random.once_in(9) {
                let glass = Refractive { k_t: 0.8, ior: 1.5, absorption: Rgb::splat(0.2), fresnel: true };
                world.insert_one(entity, glass).unwrap();
            }
            entity
        })
        .collect();
    (world, crowd)
}

/// Changes some entities, mostly by a small move. Rarely, an entity moves far away or onto another one, or becomes invisible because its
/// size is 0 or its position is not finite. Rarely, an entity is added, removed, hidden or shown again.
fn move_some(context: &mut Context<'_>, crowd: &[Entity]) {
    let mut random = Random(context.time.seconds().to_bits());
    for _ in 0..random.index(COUNT / 20) {
        let (one, other) = (crowd[random.index(COUNT)], crowd[random.index(COUNT)]);
        let copied = *context.world.get::<&Transform>(other).unwrap();
        let shape = *context.world.get::<&Shape>(other).unwrap();
        let mut transform = context.world.get::<&mut Transform>(one).unwrap();
        if random.once_in(400) {
            transform.translation *= 1e3;
        } else if random.once_in(400) {
            transform.translation.y = f64::NAN;
        } else if random.once_in(200) {
            transform.scale = if random.once_in(2) { DVec3::ZERO } else { DVec3::ONE };
        } else if random.once_in(100) {
            *transform = copied;
            *context.world.get::<&mut Shape>(one).unwrap() = shape;
            context.changes.mark_shape(one);
        } else if random.once_in(10) {
            transform.translation = place(&mut random);
        } else {
            transform.translation += place(&mut random) * 0.02;
        }
        context.changes.mark_transform(one);
    }
    match random.index(60) {
        0 => {
            context.spawn((Shape::Sphere { radius: 0.7 }, clay(&mut random), Name::new("guest")));
        }
        1 => {
            let mut guests = context.world.query_mut::<(Entity, &Name)>().into_iter();
            if let Some((guest, _)) = guests.find(|(_, name)| name.0 == "guest") {
                context.world.despawn(guest).unwrap();
                context.changes.mark_all();
            }
        }
        2 => {
            let one = crowd[random.index(COUNT)];
            if context.world.remove_one::<Material>(one).is_err() {
                context.world.insert_one(one, clay(&mut random)).unwrap();
            }
            context.changes.mark_all();
        }
        _ => context.changes.mark_settings(),
    }
}

fn engine(seed: u64) -> Engine {
    let (world, crowd) = crowd(seed);
    let mut engine = Engine::new(world);
    engine.add_stepped_system(Step::per_second(24), move |context| move_some(context, &crowd));
    engine
}

/// Returns the hits of rays from in front of the crowd.
fn hits(engine: &Engine) -> Vec<Option<(Entity, f64)>> {
    let mut random = Random(5);
    let origin = DVec3::new(0.0, 1.0, -12.0);
    let rays: Vec<Ray> = (0..300).map(|_| Ray { origin, direction: place(&mut random) - origin }).collect();
    engine.cast_all(&rays).into_iter().map(|hit| hit.map(|hit| (hit.entity, hit.distance))).collect()
}

#[test]
fn refits_do_not_change_films_or_hits() {
    let (mut builds, mut refits) = (0, 0);
    for seed in 0..3 {
        let mut along = engine(seed);
        let mut last = None;
        for frame in 0..90 {
            let film = along.render_frame(frame).unwrap();
            builds += along.report().bvh_builds;
            refits += along.report().bvh_refits;
            if frame % 9 == 8 {
                // A fresh engine runs all steps before it prepares anything.
                let mut alone = engine(seed);
                assert!(alone.render_frame(frame).unwrap() == film, "frame {frame} of {seed} alone");
                assert_eq!(alone.report().bvh_refits, 0);
                assert_eq!(hits(&along), hits(&alone), "frame {frame} of {seed}");
                let moment = alone.timeline.time_of(frame);
                assert!(
                    alone
                        .render(RenderRequest { reference: true, ..RenderRequest::at(moment) })
                        .unwrap()
                        .film
                        == film,
                    "frame {frame} of {seed} by reference"
                );
                assert!(last.replace(film.clone()) != Some(film), "nothing moves: the test shows nothing");
            }
        }
    }
    assert!(builds >= 9 && refits >= 90, "both are to be tested: {builds} and {refits}");
}

#[test]
fn tree_is_refitted_for_few_moves_and_rebuilt_for_many() {
    let (world, crowd) = crowd(1);
    let mut engine = Engine::new(world);
    engine.add_stepped_system(Step::per_second(24), move |context| {
        // In every fifth step half of the crowd moves, otherwise one entity.
        let many = (context.time.seconds() * 24.0).round() % 5.0 == 0.0;
        for entity in crowd.iter().take(if many { COUNT / 2 } else { 1 }) {
            context.world.get::<&mut Transform>(*entity).unwrap().translation.x += 0.01;
            context.changes.mark_transform(*entity);
        }
    });
    let work: Vec<(u32, u32)> = (0..12)
        .map(|frame| {
            engine.render_frame(frame).unwrap();
            (engine.report().bvh_builds, engine.report().bvh_refits)
        })
        .collect();
    for (frame, work) in work.into_iter().enumerate() {
        assert_eq!(work, if frame == 0 || frame % 5 == 1 { (1, 0) } else { (0, 1) }, "frame {frame}");
    }
}
