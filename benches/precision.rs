//! Cost of robust intersection, compared with the naive intersectors in f64 and f32, per ray and per frame.
//!
//! `cargo bench --bench precision` measures on one thread. The kernel's documentation has tables of the medians. `-- rays` measures single
//! rays, as `Mitem/s`, and `-- frames` the middle frame of every shipped scene; `-- --sample-count 5` is quicker.

use std::fmt;
use std::path::Path;

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::{DAffine3, DQuat, DVec3};

use rayreel::trace::shapes::{AlignedBox, BoxImage, Plane, Sphere, SphereImage};
use rayreel::trace::{CastRay, Geometry, Precision, PreparedScene, PreparedShape, SurfaceMaterial};
use rayreel::{Engine, RenderSettings};

const PRECISIONS: [Precision; 3] = [Precision::NaiveF32, Precision::NaiveF64, Precision::Robust];

fn main() {
    // The measuring thread is the pool's only thread.
    rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build_global()
        .expect("there is none");
    divan::main();
}

/// A named subject at a precision.
struct At<T> {
    name: String,
    of: T,
    precision: Precision,
}

impl<T> fmt::Display for At<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let precision = match self.precision {
            Precision::NaiveF32 => "textbook f32",
            Precision::NaiveF64 => "textbook f64",
            Precision::Robust => "guaranteed",
        };
        write!(formatter, "{}, {precision}", self.name)
    }
}

fn at_all<T: Clone>(of: impl IntoIterator<Item = (String, T)>) -> impl Iterator<Item = At<T>> {
    of.into_iter().flat_map(|(name, of)| {
        PRECISIONS.map(|precision| At { name: name.clone(), of: of.clone(), precision })
    })
}

fn shapes() -> impl Iterator<Item = At<PreparedShape>> {
    let turned = DAffine3::from_scale_rotation_translation(
        DVec3::new(1.0, 0.7, 1.3),
        DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, -0.2),
        DVec3::ZERO,
    );
    at_all(
        [
            ("sphere", PreparedShape::Sphere(Sphere { center: DVec3::ZERO, radius: 1.0 })),
            ("plane", PreparedShape::Plane(Plane::new(DVec3::ZERO, DVec3::Y).expect("it has a direction"))),
            ("box", PreparedShape::AlignedBox(AlignedBox { min: DVec3::NEG_ONE, max: DVec3::ONE })),
            ("ellipsoid", PreparedShape::SphereImage(SphereImage::new(turned, 1.0))),
            (
                "turned box",
                PreparedShape::BoxImage(BoxImage::new(turned, DVec3::ONE).expect("it has an inside")),
            ),
        ]
        .map(|(name, shape)| (name.to_owned(), shape)),
    )
}

/// Casts rays from all sides towards one shape. About half of them hit.
#[divan::bench(args = shapes(), sample_count = 21, sample_size = 1)]
fn rays(bencher: Bencher<'_, '_>, At { of, precision, .. }: &At<PreparedShape>) {
    const COUNT: usize = 200_000;
    let mut geometry = Geometry::default();
    geometry.push(*of);
    let mut scene = PreparedScene::new(geometry, vec![SurfaceMaterial::default()]);
    scene.precision = *precision;
    let rays: Vec<Option<CastRay>> = (0..COUNT).map(ray).collect();
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| scene.cast_all(&rays));
}

/// Returns a ray from a sphere of radius 4 around the shape to a point in a cube of half-extent 1.3, spread by golden ratios.
fn ray(index: usize) -> Option<CastRay> {
    let spread = |step: f64| (index as f64 * step).fract() * 2.0 - 1.0;
    let origin = DVec3::new(spread(0.618_033_988_75), spread(0.754_877_666_25), spread(0.569_840_290_99));
    let target = DVec3::new(spread(0.819_172_513_4), spread(0.671_043_606_7), spread(0.549_700_477_9)) * 1.3;
    let origin = origin.normalize_or(DVec3::Z) * 4.0;
    CastRay::new(origin, target - origin)
}

fn scenes() -> impl Iterator<Item = At<()>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let entries = std::fs::read_dir(folder).expect("there are scenes");
    let paths = entries.map(|entry| entry.expect("it is a file of the repository").path());
    let mut names: Vec<String> = paths
        .filter(|path| path.is_file())
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    at_all(names.into_iter().map(|name| (name, ())))
}

/// Renders the middle frame of every shipped scene with every effect, so that all precisions do the same work.
#[divan::bench(args = scenes(), sample_count = 11, sample_size = 1)]
fn frames(bencher: Bencher<'_, '_>, At { name, precision, .. }: &At<()>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).with_extension("ron");
    let mut engine = Engine::load(path).expect("shipped scenes are good");
    engine.settings = RenderSettings { all_effects: true, precision: Some(*precision), ..engine.settings };
    let timeline = engine.timeline;
    let middle = timeline.time_of(timeline.frame_count() / 2);
    bencher.bench_local(|| engine.render(middle).expect("shipped scenes can be rendered"));
}
