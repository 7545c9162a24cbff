//! rayreel renders animated frame sequences of scenes made of spheres, planes and boxes.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod color;
pub mod components;
pub mod engine;
pub mod output;
pub mod scene;
pub mod systems;
pub mod time;
pub mod timeline;
pub mod trace;

pub use color::Rgb;
pub use engine::{Engine, EngineError, FrameReport, Hit, Ray};
pub use hecs::{Entity, World};
pub use scene::Scene;
pub use systems::{Changes, Context, Step};
pub use time::Time;
pub use trace::Film;
