//! Faults of a rendered image.

use glam::DVec3;
use hecs::{Entity, World};

use super::{
    Consequence, Effect, Fault, FaultCause, FrameReport, OneColor, Plan, Preparation, active_camera,
};
use crate::components::{Shape, Visibility};
use crate::trace::{Bounds, PreparedScene, RayClass, Signals};

/// The number of strong rays at the maximum depth per camera ray from which the image is wrong in a visible part.
const VISIBLE: f64 = 0.05;

/// Returns the faults of the image that `report` describes, whose last instant has been prepared.
pub(crate) fn image_faults(world: &World, prepared: &Preparation, report: &FrameReport) -> Vec<Fault> {
    let entity = active_camera(world, report.time).map_or(Entity::DANGLING, |camera| camera.entity);
    let fault = |consequence, cause| Fault { entity, consequence, cause };
    let one_color = report.one_color.zip(report.plan.as_ref());
    let one_color = one_color.map(|(color, plan)| (color, cause_of_one_color(world, prepared, plan, color)));
    let share = report.ends.strong as f64 / report.rays.camera.max(1) as f64;
    let is_explained =
        !matches!(one_color, None | Some((_, FaultCause::NoLightArrives | FaultCause::EqualRadiance)));
    if share >= VISIBLE && !is_explained {
        let depth = prepared.scene().depth;
        return vec![fault(Consequence::CutOff, FaultCause::DepthReached { depth, share })];
    }
    one_color.into_iter().map(|(color, cause)| fault(Consequence::OneColor(color), cause)).collect()
}

fn cause_of_one_color(world: &World, prepared: &Preparation, plan: &Plan, color: OneColor) -> FaultCause {
    let scene = prepared.scene();
    let hidden = || world.query::<(&Shape, &Visibility)>().iter().filter(|(_, seen)| !seen.camera).count();
    let visible = scene.geometry().len() - scene.geometry().hidden_from(RayClass::Camera).count();
    if visible == 0 {
        return match hidden() {
            0 => FaultCause::NoShapes,
            shapes => FaultCause::HiddenShapes { shapes },
        };
    }
    let passes = scene.passes(prepared.camera(), Signals::none().cancelled);
    let pixels = passes.as_ref().map_or(&[][..], |passes| passes.pixels());
    let closest = pixels.iter().map(|pixel| f64::from(pixel.distance)).fold(f64::INFINITY, f64::min);
    let is_lit = || [Effect::Diffuse, Effect::Specular].into_iter().any(|effect| plan.needs(effect));
    match () {
        () if closest.is_infinite() => FaultCause::OutOfView { shapes: visible, middle: middle(scene) },
        _ if scene.fog.layer.is_none() && libm::exp(-scene.fog.density * closest) < 1.0 / 512.0 => {
            FaultCause::HiddenByFog
        }
        _ if color != OneColor::Black => FaultCause::EqualRadiance,
        _ if plan.needs(Effect::Ambient) || is_lit() => FaultCause::NoLightArrives,
        _ => {
            let [ambient, lights] =
                [Effect::Ambient, Effect::Diffuse].map(|effect| plan.need(effect).reason());
            FaultCause::Unlit { ambient, lights }
        }
    }
}

/// Returns the middle of the bounded shapes that the camera may see.
fn middle(scene: &PreparedScene) -> Option<DVec3> {
    let geometry = scene.geometry();
    let bounds = geometry.ids().filter(|id| scene.sees(*id)).filter_map(|id| geometry.bounds(id));
    let around =
        bounds.reduce(|one, other| Bounds { min: one.min.min(other.min), max: one.max.max(other.max) });
    around.map(|around| around.center())
}
