//! `rayreel probe`
//!
//! [`pixel`] explains a pixel or a ray, as a [`tree`] or as JSON, with the [`terms`] of its light, or as a [`drawing`].
//! [`rays`] casts given rays, which [`read`] parses.

mod names;
mod numbers;
mod pixel;
mod rays;
mod read;
mod terms;
mod tree;

use rayreel::{Engine, RenderSettings, Scene};

use super::args::ProbeArguments;
use super::exit::Failure;
use super::settings::require_frame;
use pixel::{OutputForm, Probed, ProbedAt};

pub(super) use read::parse_ray;

pub(super) fn run(arguments: &ProbeArguments) -> Result<(), Failure> {
    if arguments.scene.as_os_str() == "-"
        && arguments.rays.as_deref().is_some_and(|rays| rays.as_os_str() == "-")
    {
        let message =
            "both the scene and the rays are to be read from standard input: name a file for one of them";
        return Err(anyhow::anyhow!(message).into());
    }
    // The scene is read only once, because it may be a pipe. Its sources are kept to look up lines later.
    let (scene, sources) = Scene::load_overridden(&arguments.scene, &arguments.overrides.all())?;
    let file = arguments.scene.display().to_string();
    let mut engine = Engine::from_scene(scene);
    engine.settings = RenderSettings {
        size: arguments.size,
        without: arguments.overrides.without(),
        ..RenderSettings::default()
    };
    let frame = arguments.at.is_none().then(|| arguments.frame.unwrap_or(0));
    if let Some(frame) = frame {
        require_frame(frame, engine.timeline)?;
    }
    let time = arguments.at.unwrap_or_else(|| engine.timeline.time_of(frame.unwrap_or(0)));
    if let Some(rays) = &arguments.rays {
        engine.seek(time)?;
        return rays::run(rays, &engine, arguments.json);
    }
    let probed = match arguments.ray {
        Some(ray) => Probed::Ray(ray),
        None => Probed::Pixel {
            pixel: arguments.pixel.unwrap_or((0, 0)),
            sample: arguments.sample.unwrap_or(0),
            samples: engine.effective_settings().sampling.samples,
        },
    };
    let at = ProbedAt { file: &file, sources: &sources, probed, terms: arguments.terms, frame, time };
    let scene = &arguments.scene;
    let output = match &arguments.svg {
        Some(file) => OutputForm::Svg { file, scene },
        None if arguments.json => OutputForm::Json,
        None => OutputForm::Text,
    };
    pixel::run(&at, &mut engine, output)
}
