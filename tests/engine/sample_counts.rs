//! Test of sample counts that differ between pixels.

use std::ops::ControlFlow::Continue;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayreel::trace::{RenderJob, Signals};
use rayreel::{Engine, RenderRequest, RenderSettings, Scene, Time};

const SCENE: &str = r#"Scene(
    film: (width: 50, height: 30),
    sampling: (samples: 256, max_error: 1),
    camera: (position: (0, 0, -5), target: (0, 0, 0), fov: 40),
    ambient: (1, 1, 1),
    materials: { "white": (k_a: 1, k_d: 0, color: (255, 255, 255)) },
    entities: [
        (name: "ball", shape: Sphere(radius: 0.4), material: "white", transform: (translation: (-1.5, 0.8, 0))),
    ],
)"#;

#[test]
fn samples_are_counted_per_pixel() {
    let mut engine = Engine::from_scene(Scene::from_text("balls.ron", SCENE.to_owned()).unwrap());
    let counted = || RenderRequest { sample_counts: true, ..RenderRequest::at(Time::ZERO) };
    let reference = engine.render(RenderRequest { reference: true, ..counted() }).unwrap();
    let image = engine.render(counted()).unwrap();
    assert_eq!(reference, image);
    let (film, counts) = (image.film, image.sample_counts.unwrap().pixels().to_vec());
    assert_eq!(counts.len(), 50 * 30);
    assert_eq!(counts.iter().map(|count| u64::from(*count)).sum::<u64>(), engine.report().rays.camera);
    // Pixels on the outline of the ball take the most samples.
    let most = counts.iter().max().unwrap();
    for (pixel, count) in (0_u32..).zip(&counts).filter(|(_, count)| *count == most) {
        let around = [(0, 1), (2, 1), (1, 0), (1, 2)]
            .map(|(right, down)| film.pixel((pixel % 50 + right).max(1) - 1, (pixel / 50 + down).max(1) - 1));
        assert!(around.iter().any(|color| *color != around[0]), "{pixel}: {count}");
    }
    engine.settings = RenderSettings { max_error: Some(0.0), ..RenderSettings::default() };
    assert_eq!(engine.render(counted()).unwrap().sample_counts, None);
}

/// Checks that the estimated progress of a frame comes near its end, also if the target is out of reach of the largest number of samples.
#[test]
fn progress_with_an_error_target_comes_near_the_end() {
    for sampling in
        ["samples: 256, max_error: 1", "samples: 16, max_error: 0.01", "samples: 64, max_error: 0.3"]
    {
        let text = SCENE.replace("samples: 256, max_error: 1", sampling);
        let mut engine = Engine::from_scene(Scene::from_text("balls.ron", text).unwrap());
        let (mut shares, polls) = (Vec::new(), AtomicUsize::new(0));
        let pause = || polls.fetch_add(1, Ordering::Relaxed) % 3 == 2;
        let request = RenderRequest {
            signals: Signals { pause: &pause, ..Signals::none() },
            on_pause: Some(&mut |job: &RenderJob| {
                shares.extend(job.progress().share);
                Continue(())
            }),
            ..RenderRequest::at(Time::ZERO)
        };
        let image = engine.render(request).unwrap();
        assert_eq!(image, engine.render(RenderRequest::at(Time::ZERO)).unwrap());
        assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)), "{sampling}: {shares:?}");
        // The last pause is some batches before the end.
        let last = shares.last().unwrap();
        assert!(*last > 0.5, "{sampling}: {shares:?}");
    }
}
