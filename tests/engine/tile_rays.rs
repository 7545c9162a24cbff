//! Test of the numbers of rays in the tiles of a picture.

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
fn rays_of_tiles_sum_to_those_of_the_picture() {
    for sampling in ["", "sampling: (samples: 9),", "sampling: (samples: 64, max_error: 1),"] {
        let text = SCENE.replace("SAMPLING", sampling);
        let mut engine = Engine::from_scene(Scene::from_text("mirror.ron", text).unwrap());
        let request = RenderRequest { sample_counts: true, tile_rays: true, ..RenderRequest::at(Time::ZERO) };
        let image = engine.render(request).unwrap();
        let (rays, tiles) = (engine.report().rays, &engine.report().tile_rays);
        let mut sum = RayCounts::default();
        tiles.iter().for_each(|tile| sum += *tile);
        assert_eq!((sum, tiles.len()), (rays, 4 * 3), "{sampling}");
        assert!(tiles[0].shadow > 0 && tiles[0].reflection > 0, "{sampling}: {:?}", tiles[0]);
        // The last tile shows only the background.
        assert_eq!(tiles[11].total(), tiles[11].camera, "{sampling}");

        let everywhere = u64::from(engine.effective_settings().sampling.samples);
        let samples = |pixel: (u32, u32)| match &image.sample_counts {
            Some(counts) => u64::from(counts.pixels()[(pixel.1 * 60 + pixel.0) as usize]),
            None => everywhere,
        };
        for (index, tile) in (0_u32..).zip(tiles.iter()) {
            let (left, top) = (index % 4 * 16, index / 4 * 16);
            let pixels = (top..41.min(top + 16)).flat_map(|j| (left..60.min(left + 16)).map(move |i| (i, j)));
            assert_eq!(tile.camera, pixels.map(samples).sum::<u64>(), "{sampling}: {index}");
        }
    }
}
