//! Cost of converting a world of moving spheres to the kernel's arrays, by the number of spheres and the share that moves.
//!
//! `cargo bench --bench preparation` measures on rayon's default number of threads; `RAYON_NUM_THREADS=1` sets it to one. `-- first`,
//! `-- again`, `-- camera` and `-- moving` measure one part each, `-- 1000000` one number of spheres.

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::DVec3;

use rayreel::color::Rgb;
use rayreel::components::{Camera, Material, Shape, Transform};
use rayreel::systems::{Preparation, propagate};
use rayreel::{Changes, Engine, Entity, Time, World};

const COUNTS: [u32; 4] = [1000, 10_000, 100_000, 1_000_000];

fn main() {
    rayon::ThreadPoolBuilder::new().use_current_thread().build_global().expect("there is none");
    divan::main();
}

/// Prepares the first frame of a newly spawned world.
#[divan::bench(args = COUNTS, sample_count = 9, sample_size = 1)]
fn first(bencher: Bencher<'_, '_>, count: u32) {
    bencher
        .counter(ItemsCount::new(count))
        .with_inputs(|| Engine::new(Gas::new(count).world))
        .bench_local_refs(|engine| engine.seek(Time::ZERO));
}

/// Prepares a world again, in newly allocated arrays.
#[divan::bench(args = COUNTS, sample_count = 9, sample_size = 1)]
fn in_new_memory(bencher: Bencher<'_, '_>, count: u32) {
    let mut gas = Gas::new(count);
    gas.prepare();
    bencher.counter(ItemsCount::new(count)).bench_local(|| gas.prepare());
}

/// Prepares a world again, in the arrays of the previous frame.
#[divan::bench(args = COUNTS, sample_count = 9, sample_size = 1)]
fn again(bencher: Bencher<'_, '_>, count: u32) {
    let mut gas = Gas::new(count);
    let mut preparation = gas.prepare();
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        let moved = propagate(&mut gas.world, &Changes::all());
        preparation.update(&mut gas.world, Time::ZERO, &Changes::all(), &moved)
    });
}

/// Prepares frames in which only the camera moves.
#[divan::bench(args = COUNTS, sample_count = 101, sample_size = 1)]
fn camera(bencher: Bencher<'_, '_>, count: u32) {
    let mut gas = Gas::new(count);
    let mut preparation = gas.prepare();
    bencher.bench_local(|| {
        gas.step += 1;
        for camera in gas.world.query_mut::<&mut Camera>() {
            camera.position.x = f64::from(gas.step % 7);
        }
        let mut changes = Changes::default();
        changes.mark_settings();
        let moved = propagate(&mut gas.world, &changes);
        preparation.update(&mut gas.world, Time::ZERO, &changes, &moved)
    });
}

/// Frames in which some spheres move a little.
mod moving {
    use super::*;

    #[divan::bench(args = COUNTS, sample_count = 51, sample_size = 1)]
    fn one_in_a_thousand(bencher: Bencher<'_, '_>, count: u32) {
        measure(bencher, count, 1000);
    }

    #[divan::bench(args = COUNTS, sample_count = 51, sample_size = 1)]
    fn one_in_a_hundred(bencher: Bencher<'_, '_>, count: u32) {
        measure(bencher, count, 100);
    }

    #[divan::bench(args = COUNTS, sample_count = 21, sample_size = 1)]
    fn one_in_ten(bencher: Bencher<'_, '_>, count: u32) {
        measure(bencher, count, 10);
    }

    #[divan::bench(args = COUNTS, sample_count = 21, sample_size = 1)]
    fn all(bencher: Bencher<'_, '_>, count: u32) {
        measure(bencher, count, 1);
    }

    fn measure(bencher: Bencher<'_, '_>, count: u32, one_in: usize) {
        let mut gas = Gas::new(count);
        let mut preparation = gas.prepare();
        let gas = std::cell::RefCell::new(gas);
        bencher
            .counter(ItemsCount::new(count as usize / one_in))
            .with_inputs(|| gas.borrow_mut().push(one_in))
            .bench_local_refs(|changes| {
                let world = &mut gas.borrow_mut().world;
                let moved = propagate(world, changes);
                preparation.update(world, Time::ZERO, changes, &moved)
            });
    }
}

/// Unit spheres at random positions in a cube. Their volumes add up to a tenth of the cube's.
struct Gas {
    world: World,
    spheres: Vec<Entity>,
    step: u32,
}

impl Gas {
    fn new(count: u32) -> Self {
        let mut world = World::new();
        let side = f64::from(count).cbrt() * 3.5;
        let material = Material { k_a: 0.2, k_d: 0.8, color: Rgb::ONE, ambient_color: None, metallic: false };
        let mut random = 1_u64;
        let spheres = (0..count)
            .map(|_| {
                let translation = DVec3::from_array([(); 3].map(|()| number(&mut random) * side));
                let transform = Transform { translation, ..Transform::IDENTITY };
                world.spawn((Shape::Sphere { radius: 1.0 }, material, transform))
            })
            .collect();
        world.spawn((Camera::default(),));
        Self { world, spheres, step: 0 }
    }

    fn prepare(&mut self) -> Preparation {
        propagate(&mut self.world, &Changes::all());
        Preparation::of(&mut self.world, Time::ZERO)
    }

    /// Moves every `one_in`-th sphere, and returns the changes.
    fn push(&mut self, one_in: usize) -> Changes {
        let mut changes = Changes::default();
        self.step += 1;
        let ahead = if self.step.is_multiple_of(2) { 0.1 } else { -0.1 };
        for entity in self.spheres.iter().step_by(one_in) {
            let transform = self.world.query_one_mut::<&mut Transform>(*entity).expect("it was spawned");
            transform.translation += DVec3::new(ahead, 0.05 * ahead, -ahead);
            changes.mark_transform(*entity);
        }
        changes
    }
}

/// Returns the next random number in 0..1 (Steele and others, `SplitMix64`, 2014).
#[expect(clippy::cast_precision_loss, reason = "53 bits")]
fn number(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mixed = (*state ^ *state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((mixed ^ mixed >> 31) >> 11) as f64 / (1_u64 << 53) as f64
}
