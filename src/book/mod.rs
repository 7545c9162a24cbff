#![doc = include_str!(concat!(env!("OUT_DIR"), "/README.md"))]

/// Declares the chapters, which `build.rs` prepares.
macro_rules! chapters {
    ($($name:ident)*) => {
        $(
            #[doc = include_str!(concat!(env!("OUT_DIR"), "/", stringify!($name), ".md"))]
            pub mod $name {}
        )*
    };
}

chapters! {
    first_film lesson motion product_shot trajectories physics production accuracy editors
    coming_from_pov_ray coming_from_blender coming_from_manim coming_from_ovito_and_vmd
    commands
}
