//! The names of entities and rays, and the reasons why lights do not reach a surface.

use hecs::{Entity, World};

use crate::components::{Material, Name, Order};
use crate::engine::Engine;
use crate::systems::{Effect, Preparation};
use crate::trace::{LitSurface, RayKind, Unlit};

/// The reason why nothing of a light arrives behind transparent shapes.
pub const ABSORBED: &str = "absorbed by transparent shapes";

/// Returns an entity's name or, without one, its index in document order, as `#17`.
pub fn label(world: &World, entity: Entity) -> String {
    match world.get::<&Name>(entity) {
        Ok(name) => name.0.clone(),
        Err(_) => match world.get::<&Order>(entity).ok().map(|order| order.0) {
            Some(order) => format!("#{order}"),
            None => "#".to_owned(),
        },
    }
}

/// Returns the name of a ray at a depth.
pub fn ray_name(kind: RayKind, depth: usize) -> String {
    match kind {
        RayKind::Camera => "camera ray".to_owned(),
        RayKind::Reflection => format!("reflection {depth}"),
        RayKind::Refraction => format!("refraction {depth}"),
    }
}

/// Explains why a light contributes nothing to a surface.
pub fn unlit_reason(engine: &Engine, prepared: &Preparation, unlit: Unlit, lit: &LitSurface) -> &'static str {
    let disabled = engine.settings.without;
    let material = engine.world().get::<&Material>(prepared.entity(lit.surface.hit.id));
    let is_black = material.is_ok_and(|material| material.k_d > 0.0);
    match unlit {
        Unlit::Off => "the light is off",
        Unlit::Behind => "the light is behind the surface",
        Unlit::OutsideCone => "the point is outside the light's cone",
        Unlit::OutOfReach => "the point is beyond the light's reach",
        Unlit::NotDiffuse | Unlit::NoHighlight if disabled.contains(Effect::Diffuse) => {
            "diffuse light is disabled"
        }
        Unlit::NotDiffuse if is_black => "the surface is black",
        Unlit::NotDiffuse => "k_d is 0, and the surface has no highlights",
        Unlit::NoHighlight => "the ray is outside the light's highlight",
        Unlit::OtherColor => "the surface reflects none of the light's colour",
        Unlit::NoDirection => "the point is at the light",
    }
}
