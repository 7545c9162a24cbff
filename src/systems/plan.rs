//! The effects that a moment needs, with reasons.
//!
//! Omitting an effect that is not needed changes no bit of the image. Tests compare images with the planned effects to images with all
//! effects.

use hecs::{Component, World};

use super::{Effect, EffectSet, Preparation};
use crate::color::Rgb;
use crate::components::{
    AmbientOcclusion, Emission, Fog, Light, Pattern, Reflective, Refractive, Specular, Stars, Sun, Visibility,
};
use crate::trace::{self, Effects, LightSource, Lighting, Paths, PreparedBackground, RayClass, ShapeId};

/// The need for an effect, with a reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Need {
    /// The effect is needed for this reason.
    Needed(&'static str),
    /// The effect is not needed for this reason.
    Omitted(&'static str),
}

/// The effects that one moment needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    needs: [Need; Effect::ALL.len()],
    effects: Effects,
}

impl Need {
    /// Returns whether the effect is needed.
    #[must_use]
    pub fn is_needed(self) -> bool {
        matches!(self, Self::Needed(_))
    }

    /// Returns the reason why the effect is needed or not needed.
    #[must_use]
    pub fn reason(self) -> &'static str {
        match self {
            Self::Needed(reason) | Self::Omitted(reason) => reason,
        }
    }
}

impl Plan {
    /// Plans a moment that is rendered at a single instant.
    #[must_use]
    pub(super) fn of(world: &World, preparation: &Preparation) -> Self {
        let scan = EffectScan::new(world, preparation);
        Self { needs: Effect::ALL.map(|effect| scan.need(effect)), effects: scan.effects() }
    }

    /// Returns the need for an effect, with the reason.
    #[must_use]
    pub fn need(&self, effect: Effect) -> Need {
        self.needs[effect as usize]
    }

    /// Returns whether the effect is needed.
    #[must_use]
    pub fn needs(&self, effect: Effect) -> bool {
        self.need(effect).is_needed()
    }

    /// Returns the effects that are needed.
    pub fn needed(&self) -> impl Iterator<Item = Effect> {
        Effect::ALL.into_iter().filter(|effect| self.needs(*effect))
    }

    /// Returns the effects for which the kernel selects its stages.
    #[doc(hidden)]
    #[must_use]
    pub fn effects(&self) -> Effects {
        self.effects
    }

    /// Adds the plan of another instant of the frame.
    pub(crate) fn join(&mut self, other: &Self) {
        for (need, other) in self.needs.iter_mut().zip(&other.needs) {
            if !need.is_needed() {
                *need = *other;
            }
        }
        self.effects = self.effects.join(other.effects);
    }

    /// Marks effects as disabled by request.
    pub(crate) fn disable(&mut self, effects: EffectSet) {
        for effect in effects.iter() {
            self.needs[effect as usize] = Need::Omitted("it is disabled by request");
        }
    }

    /// Sets the need for motion blur.
    pub(crate) fn set_motion_blur(&mut self, need: Need) {
        self.needs[Effect::MotionBlur as usize] = need;
    }
}

/// The prepared moment from which needs are derived.
struct EffectScan<'a> {
    world: &'a World,
    preparation: &'a Preparation,
    /// True if a camera ray can hit a mirror or a transparent surface.
    continues: bool,
}

impl<'a> EffectScan<'a> {
    fn new(world: &'a World, preparation: &'a Preparation) -> Self {
        let mut scan = Self { world, preparation, continues: false };
        scan.continues = scan.is_any_in_view();
        scan
    }

    fn has<T: Component>(&self) -> bool {
        self.world.archetypes().any(|archetype| !archetype.is_empty() && archetype.has::<T>())
    }

    /// Returns whether there can be reflection or refraction rays. The first of them start where camera rays hit, so a mirror or a
    /// transparent surface must be in view.
    fn is_any_in_view(&self) -> bool {
        /// The maximum number of surfaces to check. With more, the check takes longer than it could save.
        const MOST: usize = 4096;
        let scene = self.preparation.scene();
        let surfaces = scene.surfaces();
        if surfaces.mirrors.len() + surfaces.transparent.len() > MOST {
            return true;
        }
        let seen = |slot: &ShapeId| {
            scene.geometry().bounds(*slot).is_none_or(|bounds| self.preparation.camera().may_see(&bounds))
        };
        surfaces.mirrors.iter().chain(&surfaces.transparent).any(seen)
    }

    fn is_lit(&self) -> bool {
        self.preparation.scene().lights.iter().any(|light| light.intensity != Rgb::ZERO)
    }

    fn scatters(&self) -> bool {
        let surfaces = self.preparation.scene().surfaces();
        self.is_lit() && (surfaces.diffuse > 0.0 || surfaces.specular > 0.0)
    }

    fn need(&self, effect: Effect) -> Need {
        use Need::{Needed, Omitted};
        let scene = self.preparation.scene();
        let surfaces = scene.surfaces();
        match effect {
            Effect::Ambient if scene.ambient == Rgb::ZERO => Omitted("there is no ambient light"),
            Effect::Ambient if surfaces.ambient == 0.0 => Omitted("k_a is 0 on all surfaces"),
            Effect::Ambient => Needed("k_a is above 0"),
            Effect::AmbientOcclusion => self.ambient_occlusion(),
            Effect::Emission if !self.has::<Emission>() => Omitted("no material has `emission`"),
            Effect::Emission if surfaces.emission == 0.0 => Omitted("emission is 0 at this time"),
            Effect::Emission => Needed("emission is above 0"),
            Effect::TransparentShadows if self.is_ambient_filtered() => {
                Needed("ambient light is occluded, and a surface is transparent")
            }
            Effect::Diffuse | Effect::Specular | Effect::Shadows | Effect::TransparentShadows
                if !self.is_lit() =>
            {
                self.unlit()
            }
            Effect::Diffuse if surfaces.diffuse == 0.0 => Omitted("k_d is 0 on all surfaces"),
            Effect::Diffuse => Needed("k_d is above 0 and a light is on"),
            Effect::Specular if !self.has::<Specular>() => Omitted("no material has `specular`"),
            Effect::Specular if surfaces.specular == 0.0 => Omitted("k_s is 0 at this time"),
            Effect::Specular => Needed("k_s is above 0 and a light is on"),
            Effect::Shadows | Effect::TransparentShadows => self.shadows(effect),
            Effect::RayVisibility => self.ray_visibility(),
            Effect::AreaLights => self.light_of(
                |light| light.source.is_extended(),
                "there are no area lights",
                "a light is an area light",
            ),
            Effect::SpotLights => self.light_of(
                |light| matches!(light.source, LightSource::Spot(..)),
                "no light is a spot light",
                "a light is a spot light",
            ),
            Effect::Falloff => self.light_of(
                |light| light.falloff.is_some(),
                "no light has `falloff`",
                "a light has `falloff`",
            ),
            Effect::Reflection | Effect::Refraction | Effect::Fresnel | Effect::Absorption => {
                self.continued(effect)
            }
            Effect::Patterns if !self.has::<Pattern>() => Omitted("no material has `pattern`"),
            Effect::Patterns if !surfaces.patterned => Omitted("no surface with a pattern is drawn"),
            Effect::Patterns => Needed("a surface has a pattern"),
            Effect::Fog if scene.fog.density > 0.0 => Needed("its density is above 0"),
            Effect::Fog if self.has::<Fog>() => Omitted("its density is 0"),
            Effect::Fog => Omitted("the scene has no `fog`"),
            Effect::Gradient => match scene.background {
                PreparedBackground::Flat(_) => Omitted("the background is the same everywhere"),
                PreparedBackground::Gradient { .. } | PreparedBackground::Stops(_) => {
                    Needed("the background is a gradient")
                }
            },
            Effect::Sun | Effect::Stars => self.sky(effect),
            Effect::Antialiasing | Effect::DepthOfField => self.sampled(effect),
            Effect::MotionBlur => Omitted("the camera has no shutter"),
        }
    }

    fn ambient_occlusion(&self) -> Need {
        use Need::{Needed, Omitted};
        let scene = self.preparation.scene();
        let (ambient, geometry) = (self.need(Effect::Ambient), scene.geometry());
        match scene.ambient_occlusion {
            None if self.has::<AmbientOcclusion>() => Omitted("its distance is not above 0"),
            None => Omitted("the scene has no `ambient_occlusion`"),
            Some(_) if !ambient.is_needed() => ambient,
            Some(_) if geometry.hidden_from(RayClass::Shadow).count() == geometry.len() => {
                Omitted("no shape casts a shadow")
            }
            Some(_) if !self.can_occlude() => Omitted("no surface can occlude another"),
            Some(_) => Needed("the scene has `ambient_occlusion`"),
        }
    }

    /// Returns whether transparent shapes may attenuate ambient light.
    fn is_ambient_filtered(&self) -> bool {
        let scene = self.preparation.scene();
        let casts = |id: &ShapeId| scene.geometry().visibility(*id).sees(RayClass::Shadow);
        self.need(Effect::AmbientOcclusion).is_needed() && scene.surfaces().transparent.iter().any(casts)
    }

    fn sky(&self, effect: Effect) -> Need {
        use Need::{Needed, Omitted};
        let sky = &self.preparation.scene().sky;
        match effect {
            Effect::Sun if sky.sun.is_some() => Needed("its intensity is above 0"),
            Effect::Sun if self.has::<Sun>() => Omitted("it is not seen at this time"),
            Effect::Sun => Omitted("the scene has no `sun`"),
            _ if sky.stars.is_some() => Needed("their intensity is above 0"),
            _ if self.has::<Stars>() => Omitted("they are not seen at this time"),
            _ => Omitted("the scene has no `stars`"),
        }
    }

    fn sampled(&self, effect: Effect) -> Need {
        use Need::{Needed, Omitted};
        match effect {
            Effect::Antialiasing if self.samples() == 1 => Omitted("a pixel has one sample"),
            Effect::Antialiasing => Needed("a pixel has several samples"),
            _ if !self.preparation.camera().has_lens() => Omitted("the camera has no lens"),
            _ if self.samples() == 1 => Omitted("a pixel has one sample, through the middle of the lens"),
            _ => Needed("the camera has a lens"),
        }
    }

    fn samples(&self) -> u32 {
        self.preparation.samples()
    }

    fn unlit(&self) -> Need {
        let none = !self.has::<Light>();
        Need::Omitted(if none { "there are no lights" } else { "all lights are off at this time" })
    }

    fn light_of(
        &self,
        kind: impl Fn(&trace::PreparedLight) -> bool,
        missing: &'static str,
        needed: &'static str,
    ) -> Need {
        let scene = self.preparation.scene();
        let on = |light: &&trace::PreparedLight| light.intensity != Rgb::ZERO;
        if !scene.lights.iter().any(&kind) {
            Need::Omitted(missing)
        } else if !scene.lights.iter().filter(on).any(kind) {
            Need::Omitted("it is off at this time")
        } else if !self.scatters() {
            Need::Omitted("k_d and k_s are 0 on all surfaces")
        } else {
            Need::Needed(needed)
        }
    }

    fn shadows(&self, effect: Effect) -> Need {
        use Need::{Needed, Omitted};
        let scene = self.preparation.scene();
        let surfaces = scene.surfaces();
        let casts = scene.lights.iter().any(|light| light.casts_shadows && light.intensity != Rgb::ZERO);
        // Only shapes that rays to lights see occlude lights.
        let unseen = || scene.geometry().hidden_from(RayClass::Shadow);
        let is_transparent = |id: &ShapeId| scene.material(*id).refraction.is_some();
        let transparent = surfaces.transparent.len() - unseen().filter(is_transparent).count();
        let all = scene.geometry().len() - unseen().count();
        match effect {
            _ if !self.scatters() => Omitted("k_d and k_s are 0 on all surfaces"),
            _ if !casts => Omitted("no light that is on casts shadows"),
            Effect::Shadows if all == 0 && unseen().count() > 0 => Omitted("no shape casts a shadow"),
            Effect::Shadows if transparent == all => Omitted("no surface is opaque"),
            Effect::Shadows if !self.can_occlude() => Omitted("no surface can occlude another"),
            Effect::Shadows => Needed("a light casts shadows"),
            _ if surfaces.transparent.is_empty() && !self.has::<Refractive>() => {
                Omitted("no material has `refractive`")
            }
            _ if surfaces.transparent.is_empty() => Omitted("k_t is 0 at this time"),
            // Lights behind a transparent surface light it, whether it casts a shadow or not.
            _ if transparent == 0
                && !unseen().any(|id| is_transparent(&id) && scene.material(id).scatters()) =>
            {
                Omitted("no transparent shape casts a shadow")
            }
            _ => Needed("a light casts shadows, and a surface is transparent"),
        }
    }

    fn ray_visibility(&self) -> Need {
        use Need::{Needed, Omitted};
        let geometry = self.preparation.scene().geometry();
        let hides = |class| geometry.hidden_from(class).next().is_some();
        match [RayClass::Camera, RayClass::Secondary, RayClass::Shadow].map(hides) {
            [false, false, false] if self.has::<Visibility>() => {
                Omitted("every shape is seen by all rays or by none at this time")
            }
            [false, false, false] => Omitted("all rays see all shapes"),
            [true, false, false] => Needed("a shape is hidden from the camera"),
            [false, true, false] => Needed("a shape is hidden from mirrored and refracted rays"),
            [false, false, true] => Needed("a shape casts no shadow"),
            _ => Needed("shapes are hidden from some rays"),
        }
    }

    /// Returns whether anything can occlude. A single plane does not occlude itself; a single shape of another kind may, at least for a
    /// camera inside it.
    fn can_occlude(&self) -> bool {
        let geometry = self.preparation.scene().geometry();
        geometry.len() > 1 || geometry.planes() < geometry.len()
    }

    fn continued(&self, effect: Effect) -> Need {
        use Need::{Needed, Omitted};
        const OUT_OF_REACH: &str = "no reflective or transparent surface is in view";
        let surfaces = self.preparation.scene().surfaces();
        match effect {
            Effect::Reflection if !surfaces.mirrors.is_empty() => {
                if self.continues {
                    Needed("k_r is above 0")
                } else {
                    Omitted(OUT_OF_REACH)
                }
            }
            Effect::Reflection if !surfaces.transparent.is_empty() && self.continues => {
                Needed("transparent media can reflect light totally")
            }
            Effect::Reflection if self.has::<Reflective>() => Omitted("k_r is 0 at this time"),
            Effect::Reflection => Omitted("no material has `reflective`"),
            _ if !self.has::<Refractive>() => Omitted("no material has `refractive`"),
            _ if surfaces.transparent.is_empty() => Omitted("k_t is 0 at this time"),
            Effect::Absorption if !surfaces.absorbs => Omitted("no medium absorbs"),
            // Tinted shadows can be in view when the object that casts them is not.
            Effect::Absorption if self.need(Effect::TransparentShadows).is_needed() => {
                Needed("a medium absorbs")
            }
            _ if !self.continues => Omitted(OUT_OF_REACH),
            Effect::Fresnel if !surfaces.fresnel => Omitted("no material has `fresnel`"),
            Effect::Fresnel => Needed("a transparent material has `fresnel`"),
            Effect::Absorption => Needed("a medium absorbs"),
            _ => Needed("k_t is above 0"),
        }
    }

    fn effects(&self) -> Effects {
        let needs = |effect| self.need(effect).is_needed();
        let transparent = !self.preparation.scene().surfaces().transparent.is_empty();
        let is_occluded = needs(Effect::AmbientOcclusion);
        let lighting = if !self.scatters() && !is_occluded {
            Lighting::None
        } else if transparent {
            Lighting::TransparentShadows
        } else if needs(Effect::Shadows) || is_occluded {
            Lighting::Shadows
        } else {
            Lighting::Unshadowed
        };
        let paths = if !self.continues {
            Paths::Straight
        } else if transparent {
            Paths::Media
        } else {
            Paths::Mirrors
        };
        let extras = Effect::ALL.into_iter().any(|effect| effect.is_extra() && needs(effect));
        Effects { lighting, paths, extras }
    }
}
