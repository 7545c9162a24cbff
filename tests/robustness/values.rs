//! Values in the notation of scene files, often extreme or degenerate.

use proptest::prelude::*;

/// Generates numbers, some of them at the limits of scene files and beyond.
pub(crate) fn number() -> impl Strategy<Value = f64> {
    let extreme = prop::sample::select(vec![
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-60,
        -1e-60,
        1e60,
        -1e60,
        1e-310,
        -1e-310,
        5e-324,
        1e-20,
        1e20,
        1e-9,
        1e9,
        1e300,
        0.1,
        1.0 + f64::EPSILON,
        90.0,
        180.0,
        360.0,
    ]);
    prop_oneof![
        6 => -3.0..3.0f64,
        3 => (-8i32..8).prop_map(f64::from),
        2 => extreme,
        1 => (-60.0..60.0f64).prop_map(libm::exp10),
    ]
}

/// Generates sizes that are mostly valid.
pub(crate) fn size() -> impl Strategy<Value = String> {
    prop_oneof![4 => (0.01..4.0f64).boxed(), 1 => number().prop_map(f64::abs).boxed()]
        .prop_map(|size| format!("{size:?}"))
}

pub(crate) fn triple() -> impl Strategy<Value = String> {
    (number(), number(), number()).prop_map(|(x, y, z)| format!("({x:?}, {y:?}, {z:?})"))
}

/// Generates points that are mostly near the origin.
pub(crate) fn point() -> impl Strategy<Value = String> {
    let near = (-4i32..=4, -4i32..=4, -4i32..=4).prop_map(|(x, y, z)| format!("({x}, {y}, {z})"));
    prop_oneof![2 => near, 2 => triple()]
}

pub(crate) fn rotation() -> impl Strategy<Value = String> {
    prop_oneof![
        3 => Just("Euler(0, 0, 0)".to_owned()),
        1 => triple().prop_map(|angles| format!("Euler{angles}")),
        1 => (triple(), number()).prop_map(|(axis, angle)| format!("AxisAngle({axis}, {angle:?})")),
        1 => (number(), number(), number(), number()).prop_map(|(x, y, z, w)| format!("Quat({x:?}, {y:?}, {z:?}, {w:?})")),
    ]
}

pub(crate) fn scale() -> impl Strategy<Value = String> {
    prop_oneof![3 => Just("1".to_owned()), 2 => number().prop_map(|factor| format!("{factor:?}")), 2 => triple()]
}

pub(crate) fn intensity() -> impl Strategy<Value = String> {
    let channel =
        || prop_oneof![4 => 0.0..2.0f64, 1 => prop::sample::select(vec![0.0, 1e30, 1e29, 1e-40, 1e-310])];
    (channel(), channel(), channel()).prop_map(|(r, g, b)| format!("({r:?}, {g:?}, {b:?})"))
}

pub(crate) fn coefficient() -> impl Strategy<Value = String> {
    prop_oneof![3 => (0.0..=1.0f64).boxed(), 1 => prop::sample::select(vec![0.0, 1.0, 1e-310, 1e-45]).boxed()]
        .prop_map(|value| format!("{value:?}"))
}

pub(crate) fn shininess() -> impl Strategy<Value = String> {
    prop_oneof![1.0..200.0f64, prop::sample::select(vec![0.0, 1e-310, 1e6])]
        .prop_map(|value| format!("{value:?}"))
}

pub(crate) fn color() -> impl Strategy<Value = String> {
    prop_oneof![
        ((0u8..), (0u8..), (0u8..)).prop_map(|(r, g, b)| format!("({r}, {g}, {b})")),
        (0u32..0x100_0000).prop_map(|color| format!("\"#{color:06x}\"")),
    ]
}

pub(crate) fn ior() -> impl Strategy<Value = String> {
    prop_oneof![2 => (1.0..2.5f64).boxed(), 1 => prop::sample::select(vec![1.0, 1e-3, 1e3, 1.0 + f64::EPSILON]).boxed()]
        .prop_map(|ior| format!("{ior:?}"))
}

/// Generates three numbers of 0 or more, like intensities.
pub(crate) fn absorption() -> impl Strategy<Value = String> {
    prop_oneof![Just("(0, 0, 0)".to_owned()), intensity()]
}
