//! Tests that shape ids do not affect pictures: among coincident shapes, the order of the document alone decides which one is visible.

use glam::DVec3;

use rayreel::Rgb;
use rayreel::trace::shapes::{AlignedBox, Sphere};
use rayreel::trace::{
    Geometry, PixelSampling, PreparedScene, PreparedShape, Refraction, ShapeId, SurfaceMaterial,
    render_reference,
};

use crate::coincident::{self, film};
use crate::splitmix::Random;

/// Returns a shape at one of a few positions, so that faces and whole shapes often coincide.
fn shape(random: &mut Random) -> PreparedShape {
    let mut place = || [-1.0, 0.0, 0.5][random.index(3)];
    let place = DVec3::new(place(), place(), place());
    if random.once_in(3) {
        PreparedShape::Sphere(Sphere { center: place, radius: 1.0 })
    } else {
        let size = DVec3::splat(if random.once_in(2) { 1.0 } else { 1.5 });
        PreparedShape::AlignedBox(AlignedBox { min: place, max: place + size })
    }
}

fn material(random: &mut Random) -> SurfaceMaterial {
    let mut share = || 0.1 + 0.8 * f32::from(u8::try_from(random.index(256)).unwrap()) / 255.0;
    let color = Rgb::new(share(), share(), share());
    let refraction = Refraction {
        transmitted: share(),
        ior: 1.0 + f64::from(share()),
        absorption: color,
        fresnel: share() > 0.5,
    };
    SurfaceMaterial {
        ambient: color * 0.2,
        diffuse: color * 0.7,
        reflected: if share() > 0.7 { share() } else { 0.0 },
        refraction: (share() > 0.5).then_some(refraction),
        ..SurfaceMaterial::default()
    }
}

/// Returns the scene of these shapes, in document order, inserted in the order `added`.
fn scene(shapes: &[(PreparedShape, SurfaceMaterial)], added: &[usize]) -> PreparedScene {
    let mut geometry = Geometry::default();
    let mut ids: Vec<Option<ShapeId>> = vec![None; shapes.len()];
    for index in added {
        ids[*index] = Some(geometry.push(shapes[*index].0));
    }
    let materials: Vec<SurfaceMaterial> = added.iter().map(|index| shapes[*index].1.clone()).collect();
    let mut scene = PreparedScene::new(geometry, materials);
    let ids: Vec<ShapeId> = ids.into_iter().map(Option::unwrap).collect();
    scene.renumber(&ids);
    coincident::light(&mut scene, Some(ids[0]));
    scene
}

#[test]
fn shape_ids_are_independent_of_document_order() {
    let mut random = Random(7);
    let mut differing_orders = 0;
    for _ in 0..300 {
        let count = 2 + random.index(8);
        let shapes: Vec<_> = (0..count).map(|_| (shape(&mut random), material(&mut random))).collect();
        let in_order: Vec<usize> = (0..count).collect();
        let mut shuffled = in_order.clone();
        for last in (1..count).rev() {
            shuffled.swap(last, random.index(last + 1));
        }
        let camera = coincident::camera(&mut random);
        let expected = film(&scene(&shapes, &in_order), &camera);
        let renamed = scene(&shapes, &shuffled);
        assert_eq!(film(&renamed, &camera).pixels(), expected.pixels());
        let slow = render_reference(&renamed, &camera, PixelSampling::default());
        assert_eq!(slow.pixels(), expected.pixels());
        // Checks the test itself: the order matters where shapes coincide.
        let reordered: Vec<_> = shuffled.iter().map(|index| shapes[*index].clone()).collect();
        differing_orders +=
            u32::from(film(&scene(&reordered, &in_order), &camera).pixels() != expected.pixels());
    }
    assert!(differing_orders > 100, "{differing_orders} of 300 orders show");
}
