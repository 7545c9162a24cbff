//! The overlay at a moment, as plain text and colours.

use glam::DVec3;
use hecs::{Entity, World};

use super::Viewpoint;
use super::camera::active_camera;
use super::settings::{first_of, sane};
use crate::components::{
    Anchor, CloudLegend, CloudSource, DataMoment, Overlay, OverlayContent, OverlayItem, TextPart,
};
use crate::overlay::{PreparedContent, PreparedItem, PreparedOverlay};
use crate::time::Time;
use crate::trace::PreparedCamera;

/// Returns what is drawn over the picture of the frame at `moment`. Items whose data are missing are left out.
pub(super) fn prepared_overlay(
    world: &World,
    camera: &PreparedCamera,
    moment: Time,
    viewpoint: Option<Viewpoint>,
) -> PreparedOverlay {
    let Some(Overlay(items)) = first_of(world) else { return PreparedOverlay::default() };
    let item = |item: &OverlayItem| {
        let OverlayItem { content, anchor, size, color, .. } = item;
        let size = (*size > 0.0 && *size <= 1.0).then_some(*size)?;
        let opacity = item.opacity_at(moment.seconds());
        let opacity = (opacity > 0.0).then_some(opacity)?;
        let content = match content {
            OverlayContent::Text { parts, cloud } => {
                PreparedContent::Text(text(world, parts, *cloud, moment)?)
            }
            OverlayContent::ScaleBar { length, label, at } => {
                let own = || active_camera(world, moment).and_then(|camera| camera.target);
                let target = || viewpoint.map(|viewpoint| viewpoint.target).or_else(own);
                let share = length / camera.height_at(at.or_else(target).unwrap_or(DVec3::ZERO))?;
                PreparedContent::Bar((share > 0.0).then_some(share)?, label.clone())
            }
            OverlayContent::Legend { cloud, title } => legend(world, *cloud, title)?,
        };
        Some(PreparedItem { content, anchor: shares(*anchor), size, color: sane(*color), opacity })
    };
    PreparedOverlay::new(items.iter().filter_map(item).collect())
}

/// Returns how far across and down the picture an anchor is.
fn shares(anchor: Anchor) -> [f64; 2] {
    match anchor {
        Anchor::TopLeft => [0.0, 0.0],
        Anchor::Top => [0.5, 0.0],
        Anchor::TopRight => [1.0, 0.0],
        Anchor::Left => [0.0, 0.5],
        Anchor::Center => [0.5, 0.5],
        Anchor::Right => [1.0, 0.5],
        Anchor::BottomLeft => [0.0, 1.0],
        Anchor::Bottom => [0.5, 1.0],
        Anchor::BottomRight => [1.0, 1.0],
    }
}

fn text(world: &World, parts: &[TextPart], cloud: Option<Entity>, moment: Time) -> Option<String> {
    let DataMoment { frame, time } = match cloud {
        Some(cloud) => world.get::<&CloudSource>(cloud).ok()?.particles.moment(moment).ok()??,
        None => DataMoment { frame: 0, time: Some(moment.seconds()) },
    };
    let part = |part: &TextPart| match part {
        TextPart::Words(words) => words.clone(),
        // The sign as in the numbers of legends.
        TextPart::Time(decimals) => time
            .map_or_else(|| "?".to_owned(), |time| format!("{time:.*}", usize::from(*decimals)))
            .replace('-', "\u{2212}"),
        TextPart::Frame => frame.to_string(),
    };
    Some(parts.iter().map(part).collect())
}

fn legend(world: &World, cloud: Entity, title: &str) -> Option<PreparedContent> {
    let legend = world.get::<&CloudSource>(cloud).ok()?.particles.legend().ok()??;
    let titled = |own: String| if title.is_empty() { own } else { title.to_owned() };
    Some(match legend {
        CloudLegend::Ramp { title, colors, range } => PreparedContent::Ramp(titled(title), colors, range),
        CloudLegend::Kinds { title, kinds } => PreparedContent::Kinds(titled(title), kinds),
    })
}
