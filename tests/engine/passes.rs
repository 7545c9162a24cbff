//! What pixels meet first, held against the reference path.

use std::sync::atomic::AtomicBool;

use rayreel::components::{FilmSettings, Sampling};
use rayreel::trace::reference::RayEnd;
use rayreel::{Engine, FrameReport, Time};

#[test]
fn passes_are_what_the_reference_path_meets() {
    for scene in ["first_light", "glass_marbles", "box_field"] {
        let path = format!("{}/scenes/{scene}.ron", env!("CARGO_MANIFEST_DIR"));
        let mut engine = Engine::load(path).unwrap();
        for film in engine.world_mut().query_mut::<&mut FilmSettings>() {
            (film.width, film.height) = (24, 14);
        }
        for sampling in engine.world_mut().query_mut::<&mut Sampling>() {
            (sampling.samples, sampling.max_error) = (1, 0.0);
        }
        let film = engine.render_at(Time::ZERO).unwrap();
        let report = *engine.report();
        assert_eq!(engine.passes_unless(Time::ZERO, &AtomicBool::new(true)).unwrap(), None);
        let passes = engine.passes_unless(Time::ZERO, &AtomicBool::new(false)).unwrap().unwrap();
        let told = *engine.report();
        assert!(told.trace > report.trace);
        assert_eq!((passes.len(), told), (film.pixels().len(), FrameReport { trace: told.trace, ..report }));
        let mut met = 0;
        for (index, pass) in (0..).zip(&passes) {
            let probe = engine.probe(index % 24, index / 24).unwrap();
            let traced = &probe.tree.rays[0];
            match &traced.end {
                RayEnd::Surface(lit) => {
                    let surface = &lit.surface;
                    let rounded = |vector: glam::DVec3| (vector + glam::DVec3::ZERO).as_vec3().to_array();
                    assert_eq!(pass.position, rounded(surface.point), "{scene}, pixel {index}");
                    assert_eq!(pass.normal, rounded(surface.facing_normal()));
                    let depth = glam::DVec3::splat(surface.distance(&traced.ray));
                    assert_eq!(pass.depth, rounded(depth)[0]);
                    assert!(pass.id > 0 && pass.albedo.min_element() >= 0.0);
                    met += 1;
                }
                _ => assert_eq!((pass.depth, pass.id, pass.normal), (f32::INFINITY, 0, [0.0; 3])),
            }
        }
        assert!(met > 50, "{scene}");
    }
}
