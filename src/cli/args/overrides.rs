//! Arguments that override values of the scene.

use clap::Args;

use rayreel::scene::Override;
use rayreel::{Effect, EffectSet};

use crate::cli::values::{parse_depth, parse_effect, parse_min_samples, parse_norm, parse_samples};

/// Overrides of scene values for one run.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Scene overrides")]
pub(in crate::cli) struct OverrideArguments {
    /// Override a scene value, in the syntax of the scene file: camera.fov=40, entities.ball.shape.radius=2, film.transfer=Classic
    /// or 'materials.clay.color=(255, 0, 0)'. List indices start at 0, as in camera.position.1=3; missing fields are added
    /// [can be repeated]
    #[arg(long = "set", value_name = "PATH=VALUE", allow_hyphen_values = true)]
    values: Vec<Override>,
    /// Samples per pixel; same as --set sampling.samples=COUNT
    #[arg(long, value_name = "COUNT", value_parser = parse_samples, allow_hyphen_values = true)]
    samples: Option<Override>,
    /// Minimum number of samples per pixel with an error target; same as --set sampling.min_samples=COUNT
    #[arg(long, value_name = "COUNT", value_parser = parse_min_samples, allow_hyphen_values = true)]
    min_samples: Option<Override>,
    /// Norm of an error target: rms, max or p99 (99th percentile); same as --set sampling.norm=Rms
    #[arg(long, value_name = "NORM", value_parser = parse_norm)]
    norm: Option<Override>,
    /// Maximum ray depth, 1 for camera rays only; same as --set quality.depth=COUNT
    #[arg(long, value_name = "COUNT", value_parser = parse_depth, allow_hyphen_values = true)]
    depth: Option<Override>,
    /// Disable effects that the scene uses, as in --without shadows,reflection: ambient-light, ambient-occlusion, emission,
    /// diffuse-light, highlights, shadows, transparent-shadows, area-lights, spot-lights, falloff, reflection, refraction, fresnel,
    /// absorption, patterns, fog, gradient, sun, stars, ray-visibility, antialiasing, depth-of-field, motion-blur. Words as specular,
    /// reflected and refracted are accepted, too [can be repeated]
    #[arg(long, value_name = "EFFECTS", value_parser = parse_effect, value_delimiter = ',')]
    without: Vec<Effect>,
    /// Disable the other terms of light: ambient and diffuse light, ambient occlusion, emission, highlights, shadows and
    /// transparent shadows, reflection, refraction, Fresnel, absorption and fog, but for those that are named, as in
    /// --only ambient-light,diffuse-light [can be repeated]
    #[arg(long, value_name = "EFFECTS", value_parser = parse_effect, value_delimiter = ',')]
    only: Vec<Effect>,
}

/// The effects that `--only` disables unless they are named: the terms of a picture's light.
const LIGHT_TERMS: [Effect; 12] = [
    Effect::Ambient,
    Effect::AmbientOcclusion,
    Effect::Emission,
    Effect::Diffuse,
    Effect::Specular,
    Effect::Shadows,
    Effect::TransparentShadows,
    Effect::Reflection,
    Effect::Refraction,
    Effect::Fresnel,
    Effect::Absorption,
    Effect::Fog,
];

impl OverrideArguments {
    /// Returns the samples per pixel, if an override sets that value itself.
    pub(in crate::cli) fn samples(&self) -> Option<u32> {
        self.last("sampling.samples")?.value().parse().ok()
    }

    /// Returns the disabled effects.
    pub(in crate::cli) fn without(&self) -> EffectSet {
        let is_other = |effect: &Effect| !self.only.is_empty() && !self.only.contains(effect);
        self.without.iter().copied().chain(LIGHT_TERMS.into_iter().filter(is_other)).collect()
    }

    /// Returns the last override of a value, which is the effective one.
    pub(in crate::cli) fn last(&self, path: &str) -> Option<Override> {
        self.all().into_iter().rfind(|value| value.path().iter().map(String::as_str).eq(path.split('.')))
    }

    /// Returns all overrides in the order of application.
    pub(in crate::cli) fn all(&self) -> Vec<Override> {
        let counts = self.samples.iter().chain(&self.min_samples).chain(&self.norm).chain(&self.depth);
        counts.chain(&self.values).cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use clap::Args;

    use super::*;
    use crate::cli::values::effect_name;

    #[test]
    fn help_lists_all_effects() {
        let command = OverrideArguments::augment_args(clap::Command::new("test"));
        let without = command.get_arguments().find(|argument| argument.get_id() == "without").unwrap();
        let help = without.get_help().unwrap().to_string();
        for effect in Effect::ALL {
            assert!(help.contains(&effect_name(effect)), "{effect}");
        }
    }
}
