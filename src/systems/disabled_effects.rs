//! Removes effects from prepared data, to measure their contribution to the image.

use std::borrow::Cow;

use super::{Effect, EffectSet, Preparation};
use crate::color::Rgb;
use crate::trace::{LightSource, PreparedBackground, PreparedFog, SurfaceMaterial};

/// The effects that render settings disable without a copy of the data: of lights, samples, instants, or the kernel's own.
const IN_SETTINGS: [Effect; 4] =
    [Effect::Shadows, Effect::TransparentShadows, Effect::Antialiasing, Effect::MotionBlur];

impl Preparation {
    /// Returns the data without these effects.
    pub(crate) fn without(&self, effects: EffectSet) -> Cow<'_, Self> {
        let mut shown = Cow::Borrowed(self);
        for effect in effects.iter().filter(|effect| !IN_SETTINGS.contains(effect)) {
            shown.to_mut().remove(effect);
        }
        shown
    }

    /// Removes the data that causes an effect.
    fn remove(&mut self, effect: Effect) {
        match effect {
            Effect::Ambient => self.scene.ambient = Rgb::ZERO,
            Effect::AmbientOcclusion => self.scene.ambient_occlusion = None,
            Effect::Emission => self.repaint(|material| material.emission = Rgb::ZERO),
            Effect::Diffuse => self.repaint(|material| {
                material.diffuse = Rgb::ZERO;
                if let Some(pattern) = &mut material.pattern {
                    pattern.diffuse = Rgb::ZERO;
                }
            }),
            Effect::Specular => self.repaint(|material| material.specular = 0.0),
            Effect::AreaLights => self.shrink_lights(|source| match *source {
                LightSource::Sphere { center, .. } | LightSource::Rectangle { center, .. } => {
                    LightSource::Point(center)
                }
                other => other,
            }),
            Effect::SpotLights => self.shrink_lights(|source| match *source {
                LightSource::Spot(position, _) => LightSource::Point(position),
                other => other,
            }),
            Effect::Falloff => self.scene.lights.iter_mut().for_each(|light| light.falloff = None),
            Effect::Reflection => self.repaint(|material| material.reflected = 0.0),
            Effect::Refraction => self.repaint(|material| material.refraction = None),
            Effect::Fresnel => self.repaint(|material| {
                if let Some(refraction) = &mut material.refraction {
                    refraction.fresnel = false;
                }
            }),
            Effect::Absorption => self.repaint(|material| {
                if let Some(refraction) = &mut material.refraction {
                    refraction.absorption = Rgb::ZERO;
                }
            }),
            Effect::Patterns => self.repaint(|material| material.pattern = None),
            Effect::Fog => self.scene.fog = PreparedFog::default(),
            Effect::Gradient => {
                self.scene.background = PreparedBackground::Flat(self.scene.background.mean());
            }
            Effect::Sun => self.scene.sky.sun = None,
            Effect::Stars => self.scene.sky.stars = None,
            Effect::RayVisibility => self.scene.show_all(),
            Effect::DepthOfField => self.camera = self.camera.without_lens(),
            Effect::Shadows | Effect::TransparentShadows | Effect::Antialiasing | Effect::MotionBlur => {}
        }
    }

    fn repaint(&mut self, paint: impl Fn(&mut SurfaceMaterial)) {
        let painted: Vec<_> = self
            .scene
            .geometry()
            .ids()
            .map(|slot| {
                let mut material = self.scene.material(slot).clone();
                paint(&mut material);
                (slot, material)
            })
            .collect();
        self.scene.replace_materials(painted);
    }

    fn shrink_lights(&mut self, shrunk: impl Fn(&LightSource) -> LightSource) {
        for light in &mut self.scene.lights {
            light.source = shrunk(&light.source);
            if !light.source.is_extended() {
                light.samples = 1;
            }
        }
    }
}
