//! Tests of random pairs of scenes: every tile whose pixels or ray counts differ is found, and each part of a record is needed for that.

use std::collections::HashMap;

use glam::{DAffine3, DMat3, DVec3};

use super::*;
use crate::color::Rgb;
use crate::trace::render::job::RenderJob;
use crate::trace::scene::{
    Geometry, LightSource, PreparedAmbientOcclusion, PreparedLight, PreparedShape, RayVisibility, Refraction,
    SurfaceMaterial,
};
use crate::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere};
use crate::trace::stages::Forgotten;
use crate::trace::{Signals, SimdLevel};

/// Twelve tiles, some of them cut off by the film's border.
const SIZE: (u32, u32) = (60, 41);
const PAIRS: usize = 1500;

/// A generator of 64-bit words (Steele, Lea, Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
struct Random(u64);

impl Random {
    fn index(&mut self, length: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        usize::try_from((z ^ (z >> 31)) % u64::try_from(length).unwrap()).unwrap()
    }

    fn small(&mut self, length: usize) -> u8 {
        u8::try_from(self.index(length)).unwrap()
    }

    fn once_in(&mut self, times: usize) -> bool {
        self.index(times) == 0
    }

    /// Returns a multiple of an eighth, so that faces coincide at times, from a number of them on.
    fn number(&mut self, least: i8, steps: usize) -> f64 {
        (f64::from(least) + f64::from(self.small(steps + 1))) / 8.0
    }

    fn place(&mut self) -> DVec3 {
        DVec3::new(self.number(-20, 40), self.number(-12, 24), self.number(-8, 32))
    }

    fn light(&mut self) -> Rgb {
        let mut channel = || f32::from(self.small(9)) / 8.0;
        Rgb::new(channel(), channel(), channel())
    }
}

#[derive(Clone)]
struct Thing {
    shape: PreparedShape,
    material: SurfaceMaterial,
    visibility: RayVisibility,
}

#[derive(Clone)]
struct World {
    things: Vec<Thing>,
    lights: Vec<PreparedLight>,
    occlusion: Option<PreparedAmbientOcclusion>,
    depth: u32,
    cutoff: f32,
    fog: f64,
    samples: u32,
    camera: PreparedCamera,
}

fn shape(random: &mut Random) -> PreparedShape {
    let (place, size) = (random.place(), random.number(1, 5));
    match random.index(8) {
        0 => PreparedShape::Plane(Plane::new(DVec3::Y * random.number(-16, 8), DVec3::Y).unwrap()),
        1..=4 => PreparedShape::Sphere(Sphere { center: place, radius: size }),
        5 | 6 => PreparedShape::AlignedBox(AlignedBox { min: place, max: place + 2.0 * size }),
        _ => {
            let turn = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(0.3);
            let map = DAffine3 { matrix3: turn, translation: place };
            PreparedShape::BoxImage(BoxImage::new(map, DVec3::splat(size)).unwrap())
        }
    }
}

fn material(random: &mut Random) -> SurfaceMaterial {
    let color = random.light();
    let refraction = Refraction {
        transmitted: 0.75,
        ior: random.number(8, 4),
        absorption: if random.once_in(2) { color } else { Rgb::ZERO },
        fresnel: random.once_in(2),
    };
    SurfaceMaterial {
        ambient: color * 0.25,
        diffuse: color * 0.5,
        specular: if random.once_in(3) { 0.5 } else { 0.0 },
        shininess: 20.0,
        tint: random.once_in(3).then_some(color),
        reflected: if random.once_in(3) { 0.5 } else { 0.0 },
        refraction: random.once_in(4).then_some(refraction),
        ..SurfaceMaterial::default()
    }
}

fn thing(random: &mut Random) -> Thing {
    let flag = |random: &mut Random| !random.once_in(12);
    let visibility = RayVisibility { camera: flag(random), secondary: flag(random), shadow: flag(random) };
    Thing { shape: shape(random), material: material(random), visibility }
}

fn light(random: &mut Random) -> PreparedLight {
    let place = DVec3::new(random.number(-32, 64), random.number(8, 24), random.number(-32, 48));
    let source = match random.index(4) {
        0 => LightSource::Point(place),
        1 => LightSource::Directional(place),
        2 => LightSource::Sphere { center: place, radius: 0.5 },
        _ => LightSource::Rectangle { center: place, halves: [DVec3::X * 0.5, DVec3::Z * 0.25] },
    };
    let intensity = random.light();
    let casts_shadows = !random.once_in(6);
    PreparedLight { source, intensity, falloff: None, samples: 1, casts_shadows, own_shape: None }
}

impl World {
    fn new(random: &mut Random) -> Self {
        let eye = DVec3::new(random.number(-8, 16), random.number(0, 8), -5.0);
        let camera = PreparedCamera::new(eye, -eye, DVec3::Y, 1.0, (1.2, 0.82), SIZE);
        let camera = if random.once_in(4) { camera.with_lens(0.25, 5.0) } else { camera };
        Self {
            things: (0..=random.index(9)).map(|_| thing(random)).collect(),
            lights: (0..random.index(4)).map(|_| light(random)).collect(),
            occlusion: random.once_in(5).then_some(PreparedAmbientOcclusion { samples: 2, distance: 1.5 }),
            depth: 1 + u32::from(random.small(5)),
            cutoff: [0.0, 0.002, 0.25][random.index(3)],
            fog: if random.once_in(5) { 0.125 } else { 0.0 },
            samples: if random.once_in(3) { 3 } else { 1 },
            camera,
        }
    }

    /// Changes a thing or two, mostly.
    fn edit(&mut self, random: &mut Random) {
        for _ in 0..=random.index(2) {
            let count = self.things.len();
            let one = random.index(count);
            match random.index(9) {
                0 | 1 => self.things[one].shape = shape(random),
                2 | 3 => self.things[one].material = material(random),
                4 => self.things.insert(one, thing(random)),
                5 if count > 1 => drop(self.things.remove(one)),
                6 => self.things.swap(one, random.index(count)),
                // Changes the bounds by which secondary rays are dropped everywhere.
                7 => self.things[one].material.ambient = random.light() * 16.0,
                _ => self.things[one].visibility = thing(random).visibility,
            }
        }
    }

    fn sampling(&self) -> PixelSampling {
        PixelSampling { samples: self.samples, seed: 5 }
    }

    fn scene(&self) -> PreparedScene {
        let mut geometry = Geometry::default();
        for thing in &self.things {
            let id = geometry.push(thing.shape);
            geometry.set_visibility(id, thing.visibility);
        }
        let materials: Vec<_> = self.things.iter().map(|thing| thing.material.clone()).collect();
        let mut scene = PreparedScene::new(geometry, materials);
        scene.lights.clone_from(&self.lights);
        (scene.ambient, scene.ambient_occlusion) = (Rgb::splat(0.5), self.occlusion);
        (scene.depth, scene.cutoff, scene.fog.density) = (self.depth, self.cutoff, self.fog);
        scene.fog.color = Rgb::new(0.5, 0.25, 0.0);
        scene
    }
}

/// Compares a picture with a former one.
fn compared(
    world: &World,
    scene: &PreparedScene,
    former: Option<&Arc<ReusablePicture>>,
) -> TileReuse<Linear> {
    let mut reuse = TileReuse::new(Linear, false, former);
    let (camera, sampling) = (&world.camera, world.sampling());
    reuse.add(&InstantInputs { scene, camera, sampling, effects: Effects::ALL, overlay: None });
    reuse
}

/// Renders a picture in full or, if there is a former one, with its tiles.
fn picture(
    world: &World,
    former: Option<&Arc<ReusablePicture>>,
    level: SimdLevel,
) -> (ReusablePicture, RenderStats) {
    let mut scene = world.scene();
    scene.set_simd(level);
    let sampling = world.sampling();
    let mut job = RenderJob::new(SIZE, world.samples).reusing(compared(world, &scene, former));
    assert!(job.add(&scene, &world.camera, sampling, 0, Effects::ALL, Signals::none()));
    let finished = job.finish();
    (finished.reusable.unwrap(), finished.stats)
}

/// Returns the tiles, by index, whose pixels or ray counts differ.
fn differing(one: &ReusablePicture, other: &ReusablePicture) -> Vec<usize> {
    let differ = |(tile, index): (Tile, usize)| {
        let rows = tile.j..tile.j + tile.height;
        let mut pixels = rows.flat_map(|j| (tile.i..tile.i + tile.width).map(move |i| (i, j)));
        let (stats, others) = (one.tiles[index].stats, other.tiles[index].stats);
        let differs = pixels.any(|(i, j)| one.film.pixel(i, j) != other.film.pixel(i, j))
            || (stats.rays, stats.ends) != (others.rays, others.ends);
        differs.then_some(index)
    };
    Tile::all(SIZE).zip(0..).filter_map(differ).collect()
}

#[test]
fn every_tile_that_differs_is_found_and_nothing_recorded_is_needless() {
    let (mut kept, mut differed) = (0, 0);
    let mut missed: HashMap<String, usize> = HashMap::new();
    let levels = SimdLevel::all();
    for seed in 0..PAIRS {
        let random = &mut Random(seed as u64);
        let before = World::new(random);
        let mut after = before.clone();
        after.edit(random);
        let level = levels[random.index(levels.len())].1;
        let (former, _) = picture(&before, None, level);
        let (fresh, stats) = picture(&after, None, level);
        let differing = differing(&former, &fresh);
        let scene = after.scene();
        let former = Arc::new(former);
        let reuse = compared(&after, &scene, Some(&former));
        let unchanged = reuse.unchanged_tiles();
        if unchanged.is_empty() {
            continue;
        }
        let wrong: Vec<usize> =
            differing.iter().copied().filter(|index| unchanged[*index].is_some()).collect();
        assert!(wrong.is_empty(), "seed {seed}: {wrong:?}");
        kept += unchanged.iter().flatten().count();
        differed += differing.len();

        // The picture with reused tiles is the fresh one, and can be reused in turn.
        let (mixed, mixed_stats) = picture(&after, Some(&former), level);
        assert!(mixed.film == fresh.film, "seed {seed}");
        assert_eq!((mixed_stats.rays, mixed_stats.ends), (stats.rays, stats.ends), "seed {seed}");
        let mut third = after.clone();
        third.edit(random);
        let (expected, _) = picture(&third, None, level);
        assert!(picture(&third, Some(&Arc::new(mixed)), level).0.film == expected.film, "seed {seed}");

        let misses = |reuse: &TileReuse<Linear>| {
            let unchanged = reuse.unchanged_tiles();
            differing.iter().filter(|index| unchanged[**index].is_some()).count()
        };
        let mut note = |part: String, weaker: &TileReuse<Linear>| {
            *missed.entry(part).or_default() += misses(weaker);
        };
        for part in [
            Forgotten::CameraRays,
            Forgotten::LaterBounces,
            Forgotten::EndlessRays,
            Forgotten::ShadowRays,
            Forgotten::Materials,
            Forgotten::Extents,
        ] {
            let mut weaker = (*former).clone();
            weaker.tiles.iter_mut().for_each(|tile| Arc::make_mut(tile).dependencies.forget(part));
            note(format!("{part:?}"), &TileReuse { former: Some(Arc::new(weaker)), ..reuse.clone() });
        }
        note("RadianceBound".to_owned(), &TileReuse { has_same_bounds: true, ..reuse.clone() });
        for (name, first) in [("Before", 0), ("After", 1)] {
            let mut weaker = reuse.clone();
            let mut index = 0;
            weaker.differences.bounds.retain(|_| {
                index += 1;
                index % 2 == first
            });
            note(name.to_owned(), &weaker);
        }
    }
    println!("{kept} tiles kept, {differed} differed; missed without a part: {missed:?}");
    assert!(kept.min(differed) > 2 * PAIRS, "{kept} {differed}");
    assert!(missed.values().all(|missed| *missed > 0), "{missed:?}");
}

#[test]
fn every_input_but_the_shapes_is_compared() {
    let world = World { lights: vec![light(&mut Random(1))], ..World::new(&mut Random(7)) };
    let plain = world.scene();
    let digests = |scene: &PreparedScene, camera: &PreparedCamera, sampling, effects| {
        InstantInputs { scene, camera, sampling, effects, overlay: None }.record().common
    };
    let sampling = PixelSampling { samples: 4, seed: 5 };
    let changed = |change: &dyn Fn(&mut PreparedScene)| {
        let mut scene = plain.clone();
        change(&mut scene);
        digests(&scene, &world.camera, sampling, Effects::ALL)
    };
    let mut all = vec![
        digests(&plain, &world.camera, sampling, Effects::ALL),
        digests(&plain, &world.camera.rolled(0.1), sampling, Effects::ALL),
        digests(&plain, &world.camera.with_lens(0.5, 2.0), sampling, Effects::ALL),
        digests(&plain, &world.camera, PixelSampling { seed: 6, ..sampling }, Effects::ALL),
        digests(&plain, &world.camera, PixelSampling { samples: 5, ..sampling }, Effects::ALL),
        digests(&plain, &world.camera, sampling, Effects { extras: false, ..Effects::ALL }),
        changed(&|scene| scene.lights[0].intensity *= 2.0),
        changed(&|scene| scene.lights[0].casts_shadows ^= true),
        changed(&|scene| scene.lights.clear()),
        changed(&|scene| scene.ambient = Rgb::splat(0.1)),
        changed(&|scene| {
            scene.ambient_occlusion = Some(PreparedAmbientOcclusion { samples: 9, distance: 1.0 });
        }),
        changed(&|scene| scene.fog.density = 0.5),
        changed(&|scene| scene.depth += 1),
        changed(&|scene| scene.cutoff = 0.125),
    ];
    let count = all.len();
    all.sort_unstable();
    all.dedup();
    assert_eq!(all.len(), count);
}
