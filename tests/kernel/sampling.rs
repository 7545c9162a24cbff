//! Tests of pixels as means of samples, against closed forms and for their rate of convergence.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;

use rayreel::accuracy::{FilmError, Observer, Parameter, Preset, ReferenceImage, Request, Subject, measure};
use rayreel::color::Transfer;
use rayreel::components::{
    Ambient, Background, Camera, FilmSettings, Lens, Material, Noise, Projection, Sampling, Shape, Transform,
    View,
};
use rayreel::{Engine, Entity, Film, RenderRequest, RenderSettings, Rgb, Time, World};

const SIDE: u32 = 48;

/// Returns an engine with a white shape, and the shape's entity. The camera is at the origin and looks along +z, with a square film at
/// distance 1 whose pixels are squares of side 1/SIDE.
fn engine(shape: Shape, place: DVec3, sampling: Sampling) -> (Engine, Entity) {
    let mut world = World::new();
    let white = Material { k_a: 1.0, k_d: 0.0, color: Rgb::ONE, ambient_color: None, metallic: false };
    let entity = world.spawn((shape, Transform::from_translation(place), white));
    let extent = f64::from(SIDE - 1) / f64::from(SIDE);
    world.spawn((Camera {
        position: DVec3::ZERO,
        view: View::Direction(DVec3::Z),
        up: DVec3::Y,
        roll: 0.0,
        projection: Projection::Screen { distance: 1.0, width: Some(extent), height: extent },
        lens: None,
        shutter: None,
    },));
    let film = FilmSettings { width: SIDE, height: SIDE, ..FilmSettings::default() };
    world.spawn((film, Ambient(Rgb::ONE), Background::default(), sampling));
    (Engine::new(world), entity)
}

fn sampling(samples: u32) -> Sampling {
    Sampling { samples, ..Sampling::default() }
}

fn set(engine: &mut Engine, sampling: Sampling) {
    for current in engine.world_mut().query_mut::<&mut Sampling>() {
        *current = sampling;
    }
}

fn set_lens(engine: &mut Engine, aperture: f64, focus: f64) {
    for camera in engine.world_mut().query_mut::<&mut Camera>() {
        camera.lens = Some(Lens { aperture, focus });
    }
}

fn render(engine: &mut Engine, samples: u32) -> Film {
    set(engine, sampling(samples));
    engine.render(Time::ZERO).unwrap().film
}

#[expect(clippy::cast_possible_truncation, reason = "films are f32")]
fn single(value: f64) -> f32 {
    value as f32
}

/// Returns the offset of a pixel's centre from the centre of the screen, to the right and up.
fn place(i: u32, j: u32) -> (f64, f64) {
    let step = |index: u32| (f64::from(index) + 0.5) / f64::from(SIDE) - 0.5;
    (step(i), -step(j))
}

/// Returns the share of a square of this side around (x, y) in which a x + b y + c < 0, for a, b > 0: the mean of the shares of the
/// square's columns.
fn half_plane_in_square([a, b, c]: [f64; 3], (x, y): (f64, f64), side: f64) -> f64 {
    // The height of the edge above the square's lower side, in sides, at its left and right.
    let height = |x: f64| (-(a * x + c) / b - y) / side + 0.5;
    let (left, right) = (height(x - 0.5 * side), height(x + 0.5 * side));
    // An integral of the height, clamped to 0..1.
    let integral = |height: f64| {
        if height < 0.0 {
            0.0
        } else if height < 1.0 {
            0.5 * height * height
        } else {
            height - 0.5
        }
    };
    (integral(right) - integral(left)) / (right - left)
}

/// Returns the exponent e of an error that falls as n^e, by least squares.
fn exponent(errors: &[(u32, f64)]) -> f64 {
    let points: Vec<(f64, f64)> =
        errors.iter().map(|(count, error)| (libm::log(f64::from(*count)), libm::log(*error))).collect();
    let count = points.len() as f64;
    let middle = points.iter().map(|point| point.0).sum::<f64>() / count;
    let rise: f64 = points.iter().map(|(x, y)| (x - middle) * y).sum();
    rise / points.iter().map(|(x, _)| (x - middle) * (x - middle)).sum::<f64>()
}

#[test]
fn coverage_along_an_edge_converges_to_the_closed_form() {
    // The plane passes below the origin. Rays from the origin hit it if they point against its normal.
    let normal = DVec3::new(0.37, 1.0, 0.021);
    let (mut engine, _) = engine(Shape::Plane { normal }, DVec3::new(0.0, -1.0, 0.0), sampling(1));
    let mut errors = Vec::new();
    for samples in [4, 16, 64, 256, 1024] {
        let film = render(&mut engine, samples);
        let (mut squares, mut edge) = (0.0, 0.0);
        for j in 0..SIDE {
            for i in 0..SIDE {
                let expected =
                    half_plane_in_square([normal.x, normal.y, normal.z], place(i, j), 1.0 / f64::from(SIDE));
                let error = f64::from(film.pixel(i, j).x) - expected;
                if expected > 0.0 && expected < 1.0 {
                    squares += error * error;
                    edge += 1.0;
                } else {
                    assert_eq!(error, 0.0, "pixel ({i}, {j}) beside the edge");
                }
            }
        }
        assert!(edge > 50.0);
        errors.push((samples, libm::sqrt(squares / edge)));
    }
    println!("{errors:?}");
    assert!(exponent(&errors) < -0.65, "n^{}: {errors:?}", exponent(&errors));
    assert!(errors[1].1 < 0.05 && errors[4].1 < 0.003, "{errors:?}");
}

/// Returns an engine with a plane that passes below the origin, and its exact picture.
fn edge() -> (Engine, Film) {
    let normal = DVec3::new(0.37, 1.0, 0.021);
    let (engine, _) = engine(Shape::Plane { normal }, DVec3::new(0.0, -1.0, 0.0), sampling(16));
    let pixels = (0..SIDE * SIDE).map(|pixel| {
        let place = place(pixel % SIDE, pixel / SIDE);
        let covered = half_plane_in_square([normal.x, normal.y, normal.z], place, 1.0 / f64::from(SIDE));
        Rgb::splat(single(covered))
    });
    (engine, Film::from_pixels(SIDE, SIDE, pixels.collect::<Vec<_>>().into_iter()))
}

#[test]
fn reference_uncertainty_covers_the_closed_form() {
    let (mut engine, truth) = edge();
    for samples in [4, 16, 64, 256] {
        let films: Vec<Film> = (1..=4)
            .map(|seed| {
                set(&mut engine, Sampling { seed, ..sampling(samples) });
                engine.render(Time::ZERO).unwrap().film
            })
            .collect();
        let reference = ReferenceImage::mean(&films, Transfer::Classic);
        let error = FilmError::between(&reference.film, &truth, Transfer::Classic);
        assert!(error.rms <= reference.rms && error.rms > 0.2 * reference.rms, "{error:?} {}", reference.rms);
        assert!(error.max <= 1.5 * reference.max, "{error:?} {}", reference.max);
    }
}

#[test]
fn adaptive_pictures_meet_their_target_against_the_closed_form() {
    let (mut engine, truth) = edge();
    let mut rays = 0;
    for max_error in [4.0, 1.0, 0.25, 0.06] {
        set(&mut engine, Sampling { max_error, ..sampling(65_536) });
        let film = engine.render(Time::ZERO).unwrap().film;
        let error = FilmError::between(&film, &truth, Transfer::Srgb);
        assert!(error.rms <= 1.05 * f64::from(max_error), "{max_error}: {error:?}");
        assert!(engine.report().error.unwrap().value <= f64::from(max_error));
        let before = std::mem::replace(&mut rays, engine.report().rays.camera);
        assert!(rays > before, "{max_error}");
    }
    // Uniform sampling would take a hundred times as many rays.
    assert!(rays < 200 * u64::from(SIDE * SIDE), "{rays}");
}

/// An observer that records all shares, and counts a thousand instructions per query.
#[derive(Default)]
struct Counting {
    shares: Vec<f64>,
    instructions: u64,
}

impl Observer for Counting {
    fn at(&mut self, _: Option<Subject>, share: f64) {
        self.shares.push(share);
    }

    fn instructions(&mut self) -> Option<u64> {
        self.instructions += 1000;
        Some(self.instructions)
    }
}

fn measurement(preset: Preset, parameters: &[Parameter]) -> Request {
    let parameters = parameters.to_vec();
    Request { frames: vec![0], preset, parameters, sizes: Vec::new(), keep_films: false }
}

/// Cancels a measurement once this share of its work is done.
struct Cancelling<'a> {
    share: f64,
    cancelled: &'a AtomicBool,
}

impl Observer for Cancelling<'_> {
    fn at(&mut self, _: Option<Subject>, share: f64) {
        self.cancelled.fetch_or(share >= self.share, Ordering::Relaxed);
    }
}

#[test]
fn cancelled_measurements_keep_complete_rounds() {
    let (mut engine, _) = edge();
    let preset = Preset { rounds: 10, samples: 4, pictures: 2, factor: 1 };
    let request = measurement(preset, &[Parameter::Samples]);
    let mut rounds = |share: f64| {
        let cancelled = AtomicBool::new(false);
        let mut observer = Cancelling { share, cancelled: &cancelled };
        let report = measure(&mut engine, &request, &cancelled, &mut observer).unwrap()?;
        // The scene's own 16 samples, and 1, 2, 4 and 8.
        assert_eq!(report.rows.len(), 5);
        assert!(report.rows.iter().all(|row| row.seconds.low > 0.0));
        Some(report.rounds)
    };
    let found = [0.0, 0.2, 0.35, 0.75, 2.0].map(&mut rounds);
    assert!(matches!(found, [None, None, Some(2..=3), Some(6..=8), Some(10)]), "{found:?}");
}

#[test]
fn a_measurement_finds_the_order_of_convergence() {
    let (mut engine, _) = edge();
    let preset = Preset { rounds: 1, samples: 64, pictures: 4, factor: 16 };
    let request = measurement(preset, &Parameter::ALL);
    let mut observer = Counting::default();
    let report = measure(&mut engine, &request, &AtomicBool::new(false), &mut observer).unwrap().unwrap();
    let (knob, law) = report.orders[0];
    assert_eq!(knob, Parameter::Samples);
    assert!((-0.95..-0.6).contains(&law.exponent), "{law:?}");
    let adaptive = report.of_parameter(Parameter::MaxError).map(|row| row.error.rms).collect::<Vec<_>>();
    assert!(adaptive.is_sorted() && adaptive.len() == 5, "{adaptive:?}");
    assert!(report.rows.iter().all(|row| row.instructions == Some(1000.0)));
    let Counting { shares, .. } = observer;
    assert!(
        shares.is_sorted() && shares[0] == 0.0 && (0.9..=1.0).contains(shares.last().unwrap()),
        "{shares:?}"
    );
    // It is left as it was.
    assert_eq!(engine.settings, RenderSettings::default());
    assert_eq!(
        measure(&mut engine, &request, &AtomicBool::new(true), &mut Counting::default()).unwrap().map(|_| ()),
        None
    );
}

#[test]
fn mean_of_one_color_is_exact() {
    let color = Rgb::new(1.0 / 3.0, 0.7, 1e-3);
    let (mut engine, _) = engine(Shape::Plane { normal: DVec3::Z }, DVec3::new(0.0, 0.0, 3.0), sampling(1));
    for material in engine.world_mut().query_mut::<&mut Material>() {
        material.color = color;
    }
    for samples in [1, 2, 3, 7, 16, 100, 1000] {
        assert!(render(&mut engine, samples).pixels().iter().all(|pixel| *pixel == color), "{samples}");
    }
}

#[test]
fn samples_cast_camera_rays_and_all_paths_agree() {
    let (mut engine, _) = engine(Shape::Sphere { radius: 1.0 }, DVec3::new(0.1, 0.2, 3.0), sampling(1));
    let single = render(&mut engine, 1);
    for samples in [1, 5, 16] {
        let film = render(&mut engine, samples);
        assert_eq!(engine.report().rays.camera, u64::from(SIDE * SIDE * samples));
        assert_eq!(film == single, samples == 1);
        assert_eq!(
            engine.render(RenderRequest { reference: true, ..RenderRequest::at(Time::ZERO) }).unwrap().film,
            film
        );
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| engine.render(Time::ZERO).unwrap().film), film);
        }
    }
}

#[test]
fn pixels_are_the_mean_of_probed_samples() {
    let (mut engine, _) = engine(Shape::Sphere { radius: 1.0 }, DVec3::new(0.1, 0.2, 3.0), sampling(6));
    let film = engine.render(Time::ZERO).unwrap().film;
    for (i, j) in [(0, 0), (9, 24), (24, 24), (40, 17)] {
        let mut sample = |index| engine.probe(Time::ZERO, (i, j), index).unwrap();
        let sum: f64 = (0..6).map(|index| f64::from(sample(index).unwrap().color().x)).sum();
        assert_eq!(f64::from(film.pixel(i, j).x), f64::from(single(sum / 6.0)));
        assert!(sample(6).is_none());
    }
}

#[test]
fn noise_is_fixed_or_a_function_of_the_moment_and_the_seed() {
    let moment = |numerator, denominator| Time::from_ratio(numerator, denominator).unwrap();
    let (mut engine, _) = engine(Shape::Sphere { radius: 1.0 }, DVec3::new(0.1, 0.2, 3.0), sampling(4));
    let start = engine.render(Time::ZERO).unwrap().film;
    assert_eq!(engine.render(moment(1, 24)).unwrap().film, start);

    set(&mut engine, Sampling { seed: 1, ..sampling(4) });
    assert_ne!(engine.render(Time::ZERO).unwrap().film, start);

    set(&mut engine, Sampling { noise: Noise::PerFrame, ..sampling(4) });
    let start = engine.render(Time::ZERO).unwrap().film;
    let later = engine.render(moment(1, 2)).unwrap().film;
    assert_ne!(later, start);
    assert_eq!(engine.render_frame(12).unwrap(), later);
    assert_eq!(engine.render(moment(10, 20)).unwrap().film, later);
    assert_eq!(engine.render(Time::ZERO).unwrap().film, start);
    set(&mut engine, Sampling { noise: Noise::PerFrame, seed: 1, ..sampling(4) });
    assert_ne!(engine.render_frame(12).unwrap(), later);
    // A single sample is in the centre, without noise.
    set(&mut engine, Sampling { noise: Noise::PerFrame, ..sampling(1) });
    assert_eq!(engine.render_frame(12).unwrap(), engine.render_frame(0).unwrap());
}

#[test]
fn blur_disc_matches_the_lens_equation() {
    const APERTURE: f64 = 2.0;
    // Beyond the plane in focus, and in front of it.
    for (focus, place) in [(4.0, DVec3::new(1.0, -0.5, 8.0)), (10.0, DVec3::new(0.3, 0.4, 4.0))] {
        let radius = 0.03 * place.z;
        let (mut engine, _) = engine(Shape::Sphere { radius }, place, sampling(1));
        set_lens(&mut engine, APERTURE, focus);
        let film = render(&mut engine, 1024);

        // On the screen at distance 1, a point of the lens sees the sphere's centre shifted by this factor times the point's distance from
        // the centre of the lens.
        let confusion = 0.5 * APERTURE * (1.0 / focus - 1.0 / place.z).abs();
        let (x, y) = (place.x / place.z, place.y / place.z);
        let pixel = 1.0 / f64::from(SIDE);
        let (mut light, mut middle, mut moment) = (0.0, [0.0; 2], 0.0);
        let (mut inside, mut inside_count) = (0.0, 0.0);
        for j in 0..SIDE {
            for i in 0..SIDE {
                let value = f64::from(film.pixel(i, j).x);
                let (right, up) = self::place(i, j);
                let (right, up) = (right - x, up - y);
                let distance = libm::hypot(right, up);
                if distance > confusion + 0.04 + pixel {
                    assert_eq!(value, 0.0, "pixel ({i}, {j})");
                }
                if distance < confusion - 0.04 - pixel {
                    inside += value;
                    inside_count += 1.0;
                }
                light += value;
                middle[0] += value * right;
                middle[1] += value * up;
                moment += value * distance * distance;
            }
        }
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 0.05;
        // The light of the sphere's image is spread evenly over the disc.
        let image = std::f64::consts::PI * 0.03 * 0.03;
        assert!(near(light * pixel * pixel, image), "{} {image}", light * pixel * pixel);
        let (density, expected) = (inside / inside_count, 0.03 * 0.03 / (confusion * confusion));
        assert!(inside_count > 20.0 && near(density, expected), "{density} {expected}");
        // The mean square of distances from the centre of a disc is half its radius squared.
        let expected = 0.5 * (confusion * confusion + 0.03 * 0.03);
        assert!(near(moment / light, expected), "{} {expected}", moment / light);
        assert!(middle.iter().all(|part| (part / light).abs() < 0.03 * confusion), "{middle:?} {light}");
    }
}

#[test]
fn focused_points_stay_sharp() {
    // A thin plate in the plane in focus: through a point of the screen, all points of the lens see the same point of the plate.
    let plate = Shape::Box { size: DVec3::new(1.3, 2.1, 1e-9) };
    let (mut engine, _) = engine(plate, DVec3::new(0.2, 0.1, 5.0), sampling(1));
    let sharp = render(&mut engine, 16);
    set_lens(&mut engine, 0.7, 5.0);
    assert_eq!(render(&mut engine, 16), sharp);
    set_lens(&mut engine, 0.7, 4.0);
    assert_ne!(render(&mut engine, 16), sharp);
}

#[test]
fn zero_aperture_and_single_samples_equal_a_pinhole() {
    let (mut engine, _) = engine(Shape::Sphere { radius: 1.0 }, DVec3::new(0.1, 0.2, 3.0), sampling(1));
    let (single, several) = (render(&mut engine, 1), render(&mut engine, 4));
    for (aperture, focus) in [(0.0, 2.0), (-1.0, 2.0), (f64::NAN, 2.0), (0.5, 0.0), (f64::INFINITY, 2.0)] {
        set_lens(&mut engine, aperture, focus);
        assert_eq!(render(&mut engine, 4), several, "{aperture} {focus}");
    }
    set_lens(&mut engine, 0.5, 2.0);
    assert_eq!(render(&mut engine, 1), single);
    let blurred = render(&mut engine, 4);
    assert_ne!(blurred, several);
    assert_eq!(
        engine.render(RenderRequest { reference: true, ..RenderRequest::at(Time::ZERO) }).unwrap().film,
        blurred
    );
}
