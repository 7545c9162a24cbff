//! Tests of the changes reported by updates of the kernel's scene.

use glam::DVec3;
use hecs::{Entity, World};

use rayreel::Scene;
use rayreel::Time;
use rayreel::components::{Light, Material, Name, Shape, Transform};
use rayreel::systems::{Changes, Preparation, propagate};
use rayreel::trace::{Bounds, BvhUpdate, SceneChanges};

const SCENE: &str = r#"Scene(
    timeline: (fps: 10, duration: 1), film: (width: 8, height: 4), camera: (position: (0, 0, -8), target: (0, 0, 0)),
    materials: { "clay": (k_a: 1, k_d: 1) },
    entities: [
        (name: "floor", shape: Plane(normal: (0, 1, 0)), material: "clay"),
        (name: "ball", shape: Sphere(radius: 1), material: "clay"),
        (name: "lamp", light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 5, 0))),
    ])"#;

struct Prepared {
    world: World,
    preparation: Preparation,
}

impl Prepared {
    fn new() -> Self {
        let mut world = Scene::from_text("changes.ron", SCENE.to_owned()).unwrap().world;
        propagate(&mut world, &Changes::all());
        let preparation = Preparation::of(&mut world, Time::ZERO);
        Self { world, preparation }
    }

    fn named(&self, name: &str) -> Entity {
        let mut all = self.world.query::<(Entity, &Name)>();
        all.iter().find(|(_, found)| &*found.0 == name).unwrap().0
    }

    fn update(&mut self, changes: &Changes) -> SceneChanges {
        let moved = propagate(&mut self.world, changes);
        self.preparation.update(&mut self.world, Time::ZERO, changes, &moved)
    }
}

#[test]
fn unchanged_world_has_no_changes() {
    let mut prepared = Prepared::new();
    let mut changes = Changes::default();
    let ball = prepared.named("ball");
    changes.mark_transform(ball);
    changes.mark_shape(ball);
    changes.mark_material(ball);
    changes.mark_settings();
    assert!(prepared.update(&changes).is_empty());
}

#[test]
fn changes_are_distinguished_by_kind() {
    let mut prepared = Prepared::new();
    let (floor, ball, lamp) = (prepared.named("floor"), prepared.named("ball"), prepared.named("lamp"));

    let mut changes = Changes::default();
    prepared.world.get::<&mut Transform>(ball).unwrap().translation = DVec3::new(3.0, 0.0, 0.0);
    changes.mark_transform(ball);
    let moved = prepared.update(&changes);
    let [shape] = moved.shapes[..] else { panic!("{moved:?}") };
    assert_eq!(prepared.preparation.entity(shape.id), ball);
    // Bounds are rounded outward.
    let around = |bounds: Option<Bounds>, center: DVec3| {
        let Some(Bounds { min, max }) = bounds else { return false };
        let near = |corner: DVec3, exact: DVec3| corner.abs_diff_eq(exact, 1e-12);
        near(min, center - DVec3::ONE) && near(max, center + DVec3::ONE)
    };
    assert!(around(shape.before, DVec3::ZERO) && around(shape.after, DVec3::new(3.0, 0.0, 0.0)), "{shape:?}");
    assert_eq!(moved.bvh, BvhUpdate::Built, "one of two is not few");
    let rest = SceneChanges { shapes: Vec::new(), bvh: BvhUpdate::Kept, ..moved };
    assert_eq!(rest, SceneChanges::default());

    let mut changes = Changes::default();
    *prepared.world.get::<&mut Shape>(floor).unwrap() = Shape::Plane { normal: DVec3::new(0.0, 1.0, 0.5) };
    prepared.world.get::<&mut Material>(ball).unwrap().k_a = 0.5;
    changes.mark_shape(floor);
    changes.mark_material(ball);
    let both = prepared.update(&changes);
    assert!(both.shapes.len() == 1 && both.shapes[0].before.is_none());
    assert_eq!(both.bvh, BvhUpdate::Built);
    assert_eq!(both.materials, [shape.id]);

    let mut changes = Changes::default();
    prepared.world.get::<&mut Light>(lamp).unwrap().intensity *= 2.0;
    changes.mark_settings();
    let lit = prepared.update(&changes);
    assert_eq!(lit, SceneChanges { lights: true, ..SceneChanges::default() });
}

#[test]
fn spawned_and_retyped_entities_rebuild_the_scene() {
    let mut prepared = Prepared::new();
    let ball = prepared.named("ball");
    let mut changes = Changes::default();
    *prepared.world.get::<&mut Shape>(ball).unwrap() = Shape::Box { size: DVec3::ONE };
    changes.mark_shape(ball);
    assert_eq!(prepared.update(&changes), SceneChanges::remade());

    prepared.world.despawn(ball).unwrap();
    let mut changes = Changes::default();
    changes.mark_all();
    let again = prepared.update(&changes);
    assert!(again.remade && again.bvh == BvhUpdate::Built);
}
