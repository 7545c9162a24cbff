//! Test of the numbers of rays and of the errors of the tiles of a picture.

use rayreel::trace::RayCounts;
use rayreel::{Engine, RenderRequest, Scene, Time};

/// A mirror in the upper left of twelve tiles, in front of a background.
const SCENE: &str = r#"Scene(
    film: (width: 60, height: 41),
    SAMPLING
    camera: (position: (0, 0, -5), target: (0, 0, 0), fov: 40),
    materials: { "mirror": (k_a: 0, k_d: 0.5, color: (255, 255, 255), reflective: (k_r: 0.5)) },
    entities: [
        (name: "ball", shape: Sphere(radius: 0.5), material: "mirror", transform: (translation: (-1.5, 0.8, 0))),
        (light: Point(intensity: (1, 1, 1)), transform: (translation: (4, 6, -4))),
    ],
)"#;

#[test]
fn rays_and_squared_errors_of_tiles_add_up_to_those_of_the_picture() {
    for sampling in ["", "sampling: (samples: 9),", "sampling: (samples: 64, max_error: 1),"] {
        let text = SCENE.replace("SAMPLING", sampling);
        let mut engine = Engine::from_scene(Scene::from_text("mirror.ron", text).unwrap());
        let request =
            RenderRequest { sample_counts: true, tile_stats: true, ..RenderRequest::at(Time::ZERO) };
        let image = engine.render(request).unwrap();
        let (rays, tiles) = (engine.report().rays, &engine.report().tile_stats);
        let mut sum = RayCounts::default();
        tiles.iter().for_each(|tile| sum += tile.rays);
        assert_eq!((sum, tiles.len()), (rays, 4 * 3), "{sampling}");
        assert!(tiles[0].rays.shadow > 0 && tiles[0].rays.reflection > 0, "{sampling}: {:?}", tiles[0]);
        // The last tile shows only the background.
        assert_eq!(tiles[11].rays.total(), tiles[11].rays.camera, "{sampling}");

        let everywhere = u64::from(engine.effective_settings().sampling.samples);
        let samples = |pixel: (u32, u32)| match &image.sample_counts {
            Some(counts) => u64::from(counts.pixels()[(pixel.1 * 60 + pixel.0) as usize]),
            None => everywhere,
        };
        let mut squares = 0.0;
        for (index, tile) in (0_u32..).zip(tiles.iter()) {
            let (left, top) = (index % 4 * 16, index / 4 * 16);
            let pixels = (top..41.min(top + 16)).flat_map(|j| (left..60.min(left + 16)).map(move |i| (i, j)));
            assert_eq!(tile.rays.camera, pixels.map(samples).sum::<u64>(), "{sampling}: {index}");
            let area = f64::from((60 - left).min(16) * (41 - top).min(16));
            squares += area * tile.error.map_or(f64::NAN, |error| f64::from(error * error));
        }
        // The last tile has no error, and is not NaN for that.
        let error = engine.report().error.map(|error| error.value);
        let of_tiles = (!squares.is_nan()).then(|| (squares / (60.0 * 41.0)).sqrt());
        assert_eq!(of_tiles.is_some(), error.is_some(), "{sampling}");
        assert!(
            of_tiles.zip(error).is_none_or(|(one, other)| (one - other).abs() < 1e-5 * other && one > 0.0)
        );
    }
}
