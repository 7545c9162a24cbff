//! Cameras, shots, backgrounds, fog and sampling, often extreme or degenerate.

use proptest::prelude::*;

use super::values::{color, number, point, size, triple};

pub(crate) fn background() -> impl Strategy<Value = String> {
    prop_oneof![
        color(),
        (color(), color()).prop_map(|(bottom, top)| format!("(bottom: {bottom}, top: {top})")),
        (color(), color(), color()).prop_map(|(bottom, horizon, top)| {
            format!("(bottom: {bottom}, horizon: {horizon}, top: {top})")
        }),
        (color(), color(), color(), -1.0..0.5f64, 1e-9..0.5f64).prop_map(
            |(low, middle, high, height, step)| {
                let next = height + step;
                format!("(stops: [({height:?}, {low}), ({next:?}, {middle}), (1, {high})])")
            }
        ),
    ]
}

/// Generates the field of fog with its name, or an empty text.
pub(crate) fn fog() -> impl Strategy<Value = String> {
    let layer =
        (size(), number()).prop_map(|(height, level)| format!(", height: {height}, level: {level:?}"));
    let rest = prop_oneof![Just(String::new()), Just(", hides_background: false".to_owned()), layer].boxed();
    let some = (color(), prop_oneof![0.0..1.0f64, number().prop_map(f64::abs)], rest)
        .prop_map(|(color, density, rest)| format!("fog: (color: {color}, density: {density:?}{rest}), "));
    prop_oneof![2 => Just(String::new()), 1 => some]
}

/// Generates the fields of quality and of sampling.
pub(crate) fn effort() -> impl Strategy<Value = (String, String)> {
    let depth = prop_oneof![20 => 1u32..8, 1 => Just(1000)];
    let cutoff = prop_oneof![Just(0.25), Just(0.0), Just(255.0), 0.0..255.0f64];
    let samples = prop_oneof![4 => Just(1u32), 1 => 2..4u32];
    let instants = prop_oneof![1..4u32, Just(256)];
    (depth, cutoff, samples, instants).prop_map(|(depth, cutoff, samples, instants)| {
        (format!("depth: {depth}, cutoff: {cutoff:?}"), format!("samples: {samples}, instants: {instants}"))
    })
}

/// Generates the fields of a camera, which may have a parent, look at an entity, or follow one.
pub(crate) fn camera() -> impl Strategy<Value = String> {
    let view = prop_oneof![
        6 => point().prop_map(|target| format!("target: {target}")),
        2 => triple().prop_map(|view| format!("view: {view}")),
        1 => (0..3).prop_map(|index| format!("look_at: \"e{index}\"")),
    ];
    let up = prop_oneof![2 => Just("(0, 1, 0)".to_owned()), 1 => triple()];
    let projection = prop_oneof![
        2 => Just(String::new()),
        1 => prop_oneof![1.0..179.0f64, number()].prop_map(|fov| format!(", fov: {fov:?}")),
        1 => prop_oneof![1.0..179.0f64, number()].prop_map(|fov| format!(", horizontal_fov: {fov:?}")),
        1 => size().prop_map(|height| format!(", orthographic: {height}")),
        1 => (size(), size(), size()).prop_map(|(distance, width, height)| {
            format!(", screen: (distance: {distance}, width: {width}, height: {height})")
        }),
    ]
    .boxed();
    let lens = (number(), size())
        .prop_map(|(aperture, focus)| format!(", lens: (aperture: {:?}, focus: {focus})", aperture.abs()));
    let lens = prop_oneof![2 => Just(String::new()), 1 => lens];
    (point(), view, up, projection, (lens, shutter()), relations()).prop_map(
        |(position, view, up, projection, (lens, shutter), relations)| {
            format!("position: {position}, {view}, up: {up}{projection}{lens}{shutter}{relations}")
        },
    )
}

fn shutter() -> impl Strategy<Value = String> {
    let share = prop_oneof![Just(1.0), Just(5e-324), 0.01..1.0f64];
    prop_oneof![2 => Just(String::new()), 1 => share.prop_map(|share| format!(", shutter: {share:?}"))]
}

fn relations() -> impl Strategy<Value = String> {
    prop_oneof![
        6 => Just(String::new()),
        1 => (0..3).prop_map(|index| format!(", parent: \"e{index}\"")),
        1 => (0..3).prop_map(|index| format!(", follow: \"e{index}\"")),
        1 => number().prop_map(|roll| format!(", roll: {roll:?}")),
    ]
}

/// Generates shots of the main camera and of `cameras` others, named c0 and so on.
pub(crate) fn shots(cameras: usize) -> impl Strategy<Value = String> {
    let gap = prop_oneof![4 => 0.1..1.0f64, 1 => prop::sample::select(vec![5e-324, 1e-16, 1e60, -1.0, 0.0])];
    prop::collection::vec((gap, 0..=cameras), 0..5).prop_map(|shots| {
        let mut time = -0.5;
        let mut text = String::new();
        for (gap, camera) in shots {
            time += gap;
            text += &format!(
                "({time:?}, \"{}\"), ",
                camera.checked_sub(1).map_or("camera".to_owned(), |index| format!("c{index}"))
            );
        }
        text
    })
}
