//! Description of the rays of a pixel, as a list and as a drawing.

use serde::Serialize;

use super::pixel_info::slot_name;
use crate::color::Rgb;
use crate::drawing::{ABSORBED, RayDrawing, RayKey, label, ray_name, unlit_reason};
use crate::engine::{Engine, EngineError};
use crate::scene::Sources;
use crate::systems::Preparation;
use crate::time::Time;
use crate::trace::{LightReach, LitSurface, RayEnd, RayKind, RayTree};

/// Maximum number of listed rays and lights: more than anyone reads, and few enough for a page.
const MOST_ROWS: usize = 500;

/// The rays of a sample of a pixel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayTreeInfo {
    /// Index of the sample.
    pub sample: u32,
    /// Number of samples of the pixel, at most.
    pub samples: u32,
    /// The rays and the lights at their hits, parents first.
    pub rows: Vec<RayRow>,
    /// Notes about rays that are not drawn or not listed.
    pub notes: Vec<String>,
    /// The drawing. Its lines have the keys of the rows.
    pub svg: String,
}

/// A ray, or the result of a light at its hit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayRow {
    /// Key of the row.
    pub key: String,
    /// Number of rays before this one on its path.
    pub depth: usize,
    /// Class of the lines in the drawing; `None` without a line.
    pub kind: Option<&'static str>,
    /// The ray and its end.
    pub text: String,
    /// Line in which the definition of the entity at the end starts.
    pub place: Option<String>,
    /// Distance to the end, in scene units.
    pub distance: Option<f64>,
    /// The share of the light of the end that reaches the pixel.
    pub share: Option<[f32; 3]>,
    /// The light that is added at the hit, for lights.
    pub adds: Option<[f32; 3]>,
}

/// The traced rays, with their scene.
struct Traced<'a> {
    engine: &'a Engine,
    prepared: &'a Preparation,
    sources: &'a Sources,
    tree: &'a RayTree,
}

impl RayTreeInfo {
    /// Traces a sample of a pixel at a moment; of indices beyond the last sample, the last one. Returns `None` outside the film, and for a
    /// camera without a position.
    pub(super) fn of(
        engine: &mut Engine,
        sources: &Sources,
        time: Time,
        pixel: (u32, u32),
        sample: u32,
    ) -> Result<Option<Self>, EngineError> {
        let samples = engine.effective_settings().sampling.samples;
        let sample = sample.min(samples.saturating_sub(1));
        let Some(tree) = engine.probe(time, pixel, sample)? else { return Ok(None) };
        let Some(prepared) = engine.prepared() else { return Ok(None) };
        let drawing = RayDrawing::new(engine, prepared, &tree, time, true);
        let mut rows = Traced { engine, prepared, sources, tree: &tree }.rows();
        let mut notes = drawing.omitted(&tree);
        if rows.len() > MOST_ROWS {
            notes.push(format!("{} more lines are not listed.", rows.len() - MOST_ROWS));
            rows.truncate(MOST_ROWS);
        }
        let cut: u64 = tree.rays.iter().map(|traced| traced.cut).sum();
        if cut > 0 {
            notes.push(format!("{cut} rays are not followed, because they are too faint."));
        }
        let svg = drawing.draw_for_page(&format!("The rays of pixel {}, {} in two views", pixel.0, pixel.1));
        Ok(Some(Self { sample, samples, rows, notes, svg }))
    }
}

impl Traced<'_> {
    /// Lists the rays depth first, each with the lights at its hit.
    fn rows(&self) -> Vec<RayRow> {
        let mut children = vec![Vec::new(); self.tree.rays.len()];
        for (index, traced) in self.tree.rays.iter().enumerate() {
            if let Some(parent) = traced.parent {
                children[parent].push(index);
            }
        }
        let (mut rows, mut open) = (Vec::new(), vec![(0, 0)]);
        while let Some((index, depth)) = open.pop().filter(|_| !self.tree.rays.is_empty()) {
            rows.push(self.ray(index, depth));
            if let Some(lit) = self.tree.rays[index].surface() {
                rows.extend(self.lights(index, depth + 1, lit));
            }
            open.extend(children[index].iter().rev().map(|child| (*child, depth + 1)));
        }
        rows
    }

    fn ray(&self, index: usize, depth: usize) -> RayRow {
        let traced = &self.tree.rays[index];
        let kind = match traced.kind {
            RayKind::Camera => "camera",
            RayKind::Reflection => "reflection",
            RayKind::Refraction => "refraction",
        };
        let (found, place) = match &traced.end {
            RayEnd::Background(_) => ("sees the background".to_owned(), None),
            RayEnd::BeyondDepth(_) => {
                (format!("is beyond the depth of {depth} and sees the background"), None)
            }
            RayEnd::Surface(lit) => {
                let side = if lit.surface.from_outside { "outside" } else { "inside" };
                let (name, place) = slot_name(self.engine, self.prepared, self.sources, lit.surface.hit.id);
                (format!("meets {name} from {side}"), place)
            }
        };
        RayRow {
            key: RayKey { ray: index, light: None }.to_string(),
            depth,
            kind: Some(kind),
            text: format!("{} {found}", ray_name(traced.kind, depth)),
            place,
            distance: traced.surface().map(|lit| lit.surface.distance(&traced.ray)),
            share: Some(traced.throughput.to_array()),
            adds: None,
        }
    }

    /// Lists the results of the lights at a hit.
    fn lights<'a>(
        &'a self,
        ray: usize,
        depth: usize,
        lit: &'a LitSurface,
    ) -> impl Iterator<Item = RayRow> + 'a {
        let lights = self.prepared.lights().iter().zip(&lit.lights).enumerate();
        lights.map(move |(light, (entity, reach))| {
            let mut samples = lit.samples.iter().filter(|sample| sample.light == light);
            let first = samples.next();
            let (kind, result, distance) = match reach {
                LightReach::Reaches { occluded, .. } => {
                    let hidden = match occluded {
                        0 => String::new(),
                        _ => format!(", {occluded} of {} samples are hidden", 1 + samples.count()),
                    };
                    let distance = first.map(|sample| sample.terms.distance());
                    (Some("shadow"), hidden, distance.filter(|distance| distance.is_finite()))
                }
                LightReach::NoShadowRay(reason) => {
                    let reason = unlit_reason(self.engine, self.prepared, *reason, lit);
                    (None, format!(": no shadow ray: {reason}"), None)
                }
                LightReach::Occluded(slot) => {
                    let (name, _) = slot_name(self.engine, self.prepared, self.sources, *slot);
                    (Some("occluded"), format!(": hidden by {name}"), None)
                }
                LightReach::Absorbed => (Some("shadow"), format!(": {ABSORBED}"), None),
            };
            let adds = reach.color();
            RayRow {
                key: RayKey { ray, light: Some(light) }.to_string(),
                depth,
                kind,
                text: format!("to {}{result}", label(self.engine.world(), *entity)),
                place: None,
                distance,
                share: None,
                adds: (adds != Rgb::ZERO).then(|| adds.to_array()),
            }
        })
    }
}
