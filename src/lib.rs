//! rayreel renders animated frame sequences of scenes made of spheres, planes, boxes, cylinders and capsules, by recursive ray
//! tracing on the CPU.
//!
//! rayreel is an entity-component-system engine with a timeline. Entities of a [hecs](hecs::World) world carry [components], [systems]
//! advance the world to a moment in time, and the [trace] kernel renders the image. A frame is a pure function of the scene and its index:
//! its bits are the same on any number of threads, whether it is rendered alone or in a sequence.
//!
//! # From scene to frame
//!
//! ```text
//! RON text -> scene::document -> scene::spawn -> hecs World
//!    each frame: stepped systems -> clouds(t) -> animate(t) -> scripts -> pure systems -> propagate -> prepare -> trace -> Film
//!    Film -> output (frame files; sequence selects the frames to render), or live (a preview in the browser)
//! ```
//!
//! # Rendering a scene
//!
//! ```
//! use rayreel::{Engine, Ray, Scene};
//! use glam::DVec3;
//!
//! let text = r#"Scene(
//!     timeline: (fps: 10, duration: 2),
//!     film: (width: 64, height: 36),
//!     camera: (position: (0, 0, -5), target: (0, 0, 0)),
//!     ambient: (1, 1, 1),
//!     materials: { "clay": (k_a: 1, color: (255, 120, 60)) },
//!     entities: [ (name: "ball", shape: Sphere(radius: 1), material: "clay") ],
//!     animate: [ (target: "ball", channel: Translation, track: Keys([(0, (0, 0, 0)), (2, (0, 4, 0))])) ],
//! )"#;
//! let mut engine = Engine::from_scene(Scene::from_text("ball.ron", text.to_owned())?);
//!
//! let film = engine.render_frame(0)?;
//! let transfer = engine.effective_settings().film.transfer;
//! assert_eq!(transfer.encode(film.pixel(32, 18)), [255, 120, 60]); // k_a and I_a of 1 give the file's own colour
//!
//! engine.render_frame(10)?; // one second later the ball is two units higher
//! let up = Ray { origin: DVec3::ZERO, direction: DVec3::Y };
//! assert_eq!(engine.cast(up).unwrap().distance, 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # A film in Rust
//!
//! Worlds can also be built in Rust, with custom components and systems. A ball bounces on a floor, in 240 steps per second:
//!
//! ```
//! use rayreel::color::{hex, srgb};
//! use rayreel::components::{Ambient, Camera, FilmSettings, Light, Material, Shape, Transform};
//! use rayreel::glam::DVec3;
//! use rayreel::time::Timeline;
//! use rayreel::{Context, Engine, Rgb, Step, World};
//!
//! #[derive(Clone)]
//! struct Velocity(DVec3);
//!
//! fn bounce(context: &mut Context<'_>) {
//!     let dt = context.step_seconds();
//!     for (transform, velocity) in context.world.query_mut::<(&mut Transform, &mut Velocity)>() {
//!         velocity.0.y -= 9.81 * dt;
//!         transform.translation += velocity.0 * dt;
//!         if transform.translation.y < 1.0 {
//!             transform.translation.y = 2.0 - transform.translation.y;
//!             velocity.0.y *= -0.8;
//!         }
//!     }
//! }
//!
//! let mut world = World::new();
//! let (ball, clay) = (Shape::Sphere { radius: 1.0 }, Material::matte(hex("#ff783c")?));
//! world.spawn((ball, clay, Transform::at(-1.0, 4.0, 0.0), Velocity(DVec3::X)));
//! world.spawn((Shape::Plane { normal: DVec3::Y }, Material::matte(srgb(210, 200, 180))));
//! world.spawn((Light::point(Rgb::splat(0.9)), Transform::at(-5.0, 9.0, -5.0)));
//! world.spawn((Camera::looking_at(DVec3::new(0.0, 3.0, -12.0), DVec3::new(0.0, 2.0, 0.0)),));
//! world.spawn((FilmSettings::new(32, 18), Ambient(Rgb::ONE)));
//!
//! let mut engine = Engine::new(world);
//! engine.timeline = Timeline::new(24, 2.0);
//! engine.register::<Velocity>(); // copied and restored when time goes back
//! engine.add_stepped_system(Step::per_second(240), bounce);
//!
//! # let directory = tempfile::tempdir()?;
//! # let folder = directory.path().join("ball");
//! let report = engine.render_to(&folder)?; // ball.0000.png to ball.0047.png; `render_movie` makes a movie
//! assert_eq!(report.to_string(), "48 frames rendered, 0 kept"); // and the faults: entities that are not drawn, and why
//! assert_eq!(engine.render_to(&folder)?.kept, 48); // complete frames are not rendered again
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`glam`], the crate of vectors and quaternions, and [`hecs`], the crate of the world, are re-exported, so that programs use the same
//! versions without depending on them.
//!
//! # Features
//!
//! - `script`: scripts in scenes. Without it, each script of a scene is an error at its position.
//! - `image`: GIF and Radiance HDR files, and [`Film::to_image`]. Without it, writing and reading these files is an error.
//! - `exr`: OpenEXR files. Without it, writing and reading them is an error.
//! - `trajectories`: compressed data files of particles. Without it, reading these files is an error.
//! - `live`: the module `live`, the preview with its file watching, server and page.
//! - `cli`: the command `rayreel`; includes the other features.
//!
//! All features are on by default. With `default-features = false`, about a third of the packages is compiled.
//!
//! # Terms
//!
//! - *Track*: a value as a function of time.
//! - *Film*: the linear pixels of one frame.
//! - *Sequence*: the frames of a timeline.
//! - *Frame file*: a frame written to disk.
//! - *Order*: an entity's index in document order. Every order-dependent result uses it.
//! - *Kernel*: the ray tracer, module [`trace`]. It operates on arrays and has no entities.
//! - *Prepared*: stored in the kernel's arrays.
//! - *Fast path*: rendering with the kernel's tree of bounding boxes, on all threads.
//! - *Reference path*: rendering of the same shapes with a linear scan, the test oracle of the fast path.
//! - *Moment*: a point in time on the timeline; each frame has one.
//! - *Instant*: one of the moments at which samples are taken while the shutter of a frame is open.
//! - *Plan*: the effects that a frame needs, with reasons.
//!
//! Space is left-handed from the viewer's position: x right, y up, z forward, unless its [`components::Space`] is right-handed. Colours are
//! linear; 1 corresponds to 255 in scene files. Time is exact.
//!
//! # Index of concepts
//!
//! - *Transform*: [`components::Transform`], relative to the parent; [`systems::propagate`] derives the
//!   [`WorldTransform`](components::WorldTransform).
//! - *Cloud*: [`components::Cloud`], copies of a shape at the positions of particles; [`clouds`] takes them from data files.
//! - *Shape*: [`components::Shape`], the sphere, plane, box, cylinder or capsule of an entity; `src/trace/shapes` intersects it.
//! - *Material*: [`components::Material`], the appearance of a shape; `src/trace/shading` shades it.
//! - *Light*: [`components::Light`], a point, spot, directional or area light.
//! - *Overlay*: [`components::Overlay`], texts, scale bars and legends over the picture; `src/overlay` draws them.
//! - *Systems*: [`systems`], the functions that run for each frame; [`Engine::add_system`] adds custom ones.
//! - *Tracer*: `src/systems/trace.rs`, the last system, which renders the prepared world with the kernel.
//! - *Frame loop*: `src/systems/frame.rs`, which advances the world to the instants of a frame and runs the tracer at each.
//! - *Timeline*: [`time::Timeline`], the frame rate and the duration; it converts frame indices to exact times.
//! - *Frame sequence*: [`Engine::render_to`] and [`sequence::render_sequence`], which render the frames that are missing or out of date;
//!   [`output::Sequence`] names their files.
//! - *Trajectory*: [`trajectory::Trajectory`], a data file of particles, read frame by frame.
//! - *Movie*: [`Engine::render_movie`], and [`output::write_movie`] for finished frames.
//! - *Fault*: [`Engine::faults`], the entities that are not drawn or not used as given, with causes and remedies.
//! - *Reload*: [`Engine::reload`], which replaces the scene after an edit; [`scene::Reader`] parses only the edited parts.
//!
//! # Layers
//!
//! The table lists the modules and crates that each module may import; a test checks the sources against it. `std`, `thiserror` and `libm`
//! are allowed in all modules.
//!
//! | module | holds | may import | outside crates |
//! |---|---|---|---|
//! | `error_text` | errors that `main` prints as their message | | |
//! | `color` | linear colour, sRGB | | bytemuck, glam |
//! | `time` | seconds, frame rates, frame lists | | |
//! | `animation` | values over time, pure | color, time | glam |
//! | `script` | scripts in scenes, sandboxed | color, time, animation | glam, rhai |
//! | `trajectory` | data files of particles, read frame by frame | | glam, rayon, memchr, fast_float2, flate2, ruzstd, tempfile |
//! | `trace` | the kernel: prepared arrays in, film out; no entities, no clock, no files | color | glam, rayon, fearless_simd, dashu_int, blake3 |
//! | `overlay` | texts, scale bars and legends, drawn over a film | color, trace | ab_glyph, notosans |
//! | `components` | plain data of entities | color, time, animation | glam, hecs |
//! | `clouds` | particles of data files at a moment: interpolation, filters, sizes, colours | color, time, components, trajectory | glam, rayon |
//! | `scene` | RON to world, diagnostics, help for editors | components, animation, script, color, time, clouds | hecs, glam, hashbrown, rayon, ron, serde, annotate_snippets, strsim |
//! | `systems` | the work of each frame, `frame` to `trace`; `prepare` is the only bridge from world to kernel | components, animation, script, trace, overlay, color, time | hecs, glam, rayon |
//! | `engine` | world, systems and reused buffers | color, time, animation, components, scene, systems, trace | hecs, glam, rayon |
//! | `accuracy` | cost of accuracy: errors between pictures, sweeps over settings | engine, systems, components, trace, time, color | glam, rayon |
//! | `output` | frame files, sequences, sheets, movies | trace, color, time | image, color_quant, png, exr, blake3, font8x8, rayon |
//! | `sequence` | sequences in folders: existing, missing and corrupt frames; movies of timelines | engine, systems, components, trace, output, color, time | rayon |
//! | `drawing` | drawings of scenes and rays as SVG | components, systems, trace, engine, time | glam, hecs |
//! | `live` | file watching, reloading, the preview's server and page | color, time, components, scene, systems, engine, accuracy, trace, output, sequence, drawing | glam, hecs, notify, axum, hyper_util, tokio, futures_util, serde, serde_json |
//! | `book` | chapters for rustdoc, which `build.rs` prepares | | base64 |
//! | `main`, `cli` | arguments, calls, and all printing; binary only | rayreel | glam, clap, clap_complete, clap_mangen, csv, indicatif, ctrlc, libc, signal_hook, anyhow, base64, libm, perf_event, rayon, serde, serde_json, tempfile |

#[macro_use]
mod error_text;

pub mod accuracy;
pub mod animation;
#[cfg(any(doc, doctest))]
pub mod book;
pub mod clouds;
pub mod color;
pub mod components;
#[cfg(feature = "live")]
#[doc(hidden)]
pub mod drawing;
pub mod engine;
#[cfg(feature = "live")]
pub mod live;
pub mod output;
mod overlay;
pub mod scene;
#[cfg_attr(
    not(feature = "script"),
    allow(dead_code, reason = "without the interpreter, nothing makes the values and errors that it shares")
)]
mod script;
pub mod sequence;
pub mod systems;
pub mod time;
pub mod trace;
pub mod trajectory;

pub use color::Rgb;
pub use engine::{Engine, EngineError, FrameReport, Hit, Ray};
pub use hecs::{Entity, World};
pub use scene::Scene;
pub use systems::{
    Changes, Context, Effect, EffectSet, EffectiveSettings, Fault, Need, Plan, RenderRequest, RenderSettings,
    Step,
};
pub use time::Time;
pub use trace::{Film, RenderedImage};
pub use {glam, hecs};
