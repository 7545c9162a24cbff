//! A moment as it would be without an effect: the difference is what the effect is worth.

use super::{Effect, Preparation};
use crate::color::Rgb;
use crate::trace::{Background, Fog, LightSource, SurfaceMaterial};

impl Preparation {
    /// Returns the same moment without what calls for an effect. Motion blur and shadows of transparent objects are not called
    /// for by anything that is prepared: the renderer leaves them out.
    #[must_use]
    pub fn without(&self, effect: Effect) -> Self {
        let mut less = self.clone();
        match effect {
            Effect::Ambient => less.scene.ambient = Rgb::ZERO,
            Effect::Diffuse => less.repaint(|material| {
                material.diffuse = Rgb::ZERO;
                if let Some(checker) = &mut material.checker {
                    checker.diffuse = Rgb::ZERO;
                }
            }),
            Effect::Specular => less.repaint(|material| material.specular = 0.0),
            Effect::Shadows => less.scene.lights.iter_mut().for_each(|light| light.casts_shadows = false),
            Effect::AreaLights => less.shrink_lights(|source| match *source {
                LightSource::Sphere { center, .. } | LightSource::Rectangle { center, .. } => {
                    LightSource::Point(center)
                }
                other => other,
            }),
            Effect::SpotLights => less.shrink_lights(|source| match *source {
                LightSource::Spot(position, _) => LightSource::Point(position),
                other => other,
            }),
            Effect::Falloff => less.scene.lights.iter_mut().for_each(|light| light.falloff = None),
            Effect::Reflection => less.repaint(|material| material.reflected = 0.0),
            Effect::Refraction => less.repaint(|material| material.refraction = None),
            Effect::Fresnel => less.repaint(|material| {
                if let Some(refraction) = &mut material.refraction {
                    refraction.fresnel = false;
                }
            }),
            Effect::Absorption => less.repaint(|material| {
                if let Some(refraction) = &mut material.refraction {
                    refraction.absorption = Rgb::ZERO;
                }
            }),
            Effect::Checker => less.repaint(|material| material.checker = None),
            Effect::Fog => less.scene.fog = Fog::default(),
            Effect::Gradient => {
                if let Background::Gradient { bottom, top } = less.scene.background {
                    less.scene.background = Background::Flat((bottom + top) * 0.5);
                }
            }
            Effect::Antialiasing => less.sampling.samples = 1,
            Effect::DepthOfField => less.camera = less.camera.without_lens(),
            Effect::ClearShadows | Effect::MotionBlur => {}
        }
        less
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
