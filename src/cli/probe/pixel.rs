//! Explanation of the colour of a pixel.

use anyhow::{Context, ensure};
use serde_json::{Value, json};

use rayreel::components::Name;
use rayreel::scene::{SourceLine, Sources};
use rayreel::systems::{Preparation, active_camera};
use rayreel::trace::Attenuation;
use rayreel::trace::{LightReach, LitSurface, RayEnd, RayKind, RayTree, TracedRay, Unlit};
use rayreel::{Engine, Entity, Rgb, Time};

use super::super::exit::Failure;
use super::super::print;
use super::names::EntityLines;
use super::numbers::{Shortest, exact};
use super::tree::TreeNode;

/// Number of ray depths that are drawn nested; rays at the next depth become separate trees at the margin.
const NESTED: usize = 6;

/// The pixel to explain, with its scene and moment.
pub(super) struct PixelAt<'a> {
    pub(super) file: &'a str,
    pub(super) sources: &'a Sources,
    /// The column and the row.
    pub(super) pixel: (u32, u32),
    /// The index of the sample.
    pub(super) sample: u32,
    /// Number of samples of the pixel.
    pub(super) samples: u32,
    /// Number of the frame; `None` for a moment that is not a frame.
    pub(super) frame: Option<u32>,
    pub(super) time: Time,
}

pub(super) fn run(at: &PixelAt<'_>, engine: &mut Engine, json: bool) -> Result<(), Failure> {
    let film = engine.effective_settings().film;
    ensure_pixel(at.pixel, (film.width, film.height))?;
    ensure_sample(at.sample, at.samples)?;
    let tree = engine.probe(at.time, at.pixel, at.sample)?;
    let (tree, prepared) = tree
        .zip(engine.prepared())
        .context("the camera is not in a finite place at this moment: all pixels show the background")?;
    let mut entities = prepared.lights().to_vec();
    entities.extend(tree.rays.iter().flat_map(|traced| met(prepared, traced)));
    let lines = EntityLines::of(engine.world(), at.sources, &entities);
    let explanation = PixelExplanation { at, engine, prepared, tree, lines };
    if json {
        print::json(explanation.json())?;
    } else {
        print::result(&explanation.text())?;
    }
    Ok(())
}

fn ensure_pixel((column, row): (u32, u32), (width, height): (u32, u32)) -> anyhow::Result<()> {
    ensure!(
        column < width && row < height,
        "there is no pixel {column},{row}: the film of {width}x{height} has columns 0 to {} and rows 0 to {}",
        width - 1,
        height - 1
    );
    Ok(())
}

fn ensure_sample(sample: u32, samples: u32) -> anyhow::Result<()> {
    let pixels_have = match samples {
        1 => "one, 0".to_owned(),
        _ => format!("samples 0 to {}", samples - 1),
    };
    ensure!(sample < samples, "there is no sample {sample}: pixels of this scene have {pixels_have}");
    Ok(())
}

/// Returns all entities that are hit by a ray or by the shadow rays from its end.
fn met(prepared: &Preparation, traced: &TracedRay) -> Vec<Entity> {
    let RayEnd::Surface(lit) = &traced.end else { return Vec::new() };
    let hiding = lit.lights.iter().filter_map(|reach| match reach {
        LightReach::Occluded(slot) => Some(*slot),
        LightReach::NoShadowRay(_) | LightReach::Reaches { .. } => None,
    });
    let slots = std::iter::once(lit.surface.hit.id).chain(lit.coincident.iter().copied()).chain(hiding);
    slots.map(|slot| prepared.entity(slot)).collect()
}

/// The contents of an explanation.
struct PixelExplanation<'a> {
    at: &'a PixelAt<'a>,
    engine: &'a Engine,
    prepared: &'a Preparation,
    tree: RayTree,
    lines: EntityLines<'a>,
}

impl PixelExplanation<'_> {
    fn bytes(&self) -> [u8; 3] {
        self.engine.effective_settings().film.transfer.encode(self.tree.color())
    }

    /// Returns the line on which the active camera of the moment starts.
    fn camera(&self) -> SourceLine<'_> {
        let world = self.engine.world();
        let name =
            active_camera(world, self.at.time).and_then(|active| world.get::<&Name>(active.entity).ok());
        self.at.sources.camera(name.as_ref().map_or("", |name| name.0.as_str()))
    }

    fn text(&self) -> String {
        let (film, (column, row)) = (self.engine.effective_settings().film, self.at.pixel);
        let time = Shortest(self.at.time.seconds());
        let moment = match self.at.frame {
            Some(frame) => format!("frame {frame} at {time} s"),
            None => format!("the moment {time} s"),
        };
        let sample = match self.at.samples {
            1 => String::new(),
            samples if self.engine.effective_settings().sampling.is_adaptive() => {
                format!(" sample {} of {samples} at most,", self.at.sample)
            }
            samples => format!(" sample {} of {samples},", self.at.sample),
        };
        let mut text = format!(
            "Pixel {column},{row} of {}x{},{sample} {moment}, camera ({})\n",
            film.width,
            film.height,
            self.camera()
        );
        text += &format!("{:<14}{}\n", "linear", color(self.tree.color()).trim_end());
        let bytes = self.bytes().map(|byte| column_of(&byte.to_string()));
        text += &format!("{:<14}{}\n", "bytes", bytes.concat().trim_end());
        for node in self.roots() {
            text.push('\n');
            text += &node.draw();
        }
        text
    }

    /// Returns the tree of rays. Subtrees nested deeper than [`NESTED`] become separate trees.
    fn roots(&self) -> Vec<TreeNode> {
        let rays = &self.tree.rays;
        let mut depths: Vec<usize> = Vec::with_capacity(rays.len());
        for traced in rays {
            depths.push(traced.parent.map_or(0, |parent| depths[parent] + 1));
        }
        let mut roots = Vec::new();
        let mut nodes: Vec<TreeNode> =
            rays.iter().zip(&depths).map(|(traced, depth)| self.node(traced, *depth)).collect();
        // Rays are stored after their parents, so the last node already has all its children.
        while let Some(mut node) = nodes.pop() {
            let index = nodes.len();
            if let Some(parent) = rays[index].parent {
                if depths[index].is_multiple_of(NESTED) {
                    let below =
                        TreeNode::leaf(format!("{} is below", ray_name(rays[index].kind, depths[index])));
                    roots.push(std::mem::replace(&mut node, below));
                }
                nodes[parent].children.push(node);
            } else {
                roots.push(node);
            }
        }
        roots.reverse();
        roots
    }

    fn node(&self, traced: &TracedRay, depth: usize) -> TreeNode {
        let name = ray_name(traced.kind, depth);
        let light = traced.end.light();
        let mut facts =
            vec![("origin", vector(traced.ray.origin())), ("direction", vector(traced.ray.direction()))];
        let (found, children) = match &traced.end {
            RayEnd::Background(_) => ("sees the background".to_owned(), Vec::new()),
            RayEnd::BeyondDepth(_) => {
                (format!("is beyond the depth of {depth} and sees the background"), Vec::new())
            }
            RayEnd::Surface(lit) => {
                let surface = &lit.surface;
                let side = if surface.from_outside { "outside" } else { "inside" };
                facts.extend([
                    ("t", number(surface.t.rounded())),
                    ("distance", number(surface.distance(&traced.ray))),
                    ("point", vector(surface.point)),
                    ("normal", vector(surface.facing_normal())),
                ]);
                for slot in lit.coincident.iter().copied() {
                    facts.push(("also there", format!(" {}", self.lines.text(self.prepared.entity(slot)))));
                }
                let entity = self.lines.text(self.prepared.entity(surface.hit.id));
                (format!("meets {entity} from {side}"), self.contributions(lit))
            }
        };
        for slot in &traced.inside {
            facts.push(("inside", format!(" {}", self.lines.text(self.prepared.entity(*slot)))));
        }
        facts.push(("light", color(light)));
        if traced.passage != Attenuation::CLEAR {
            facts.push(("let through", color(traced.passage.transmitted)));
            facts.push(("added", color(traced.passage.added)));
        }
        facts.push(("throughput", color(traced.throughput)));
        facts.push(("to pixel", color(traced.contribution())));
        if traced.cut > 0 {
            facts.push(("not followed", format!(" {} too faint to show", rays(traced.cut))));
        }
        TreeNode { title: format!("{name} {found}"), facts, children }
    }

    /// Lists all contributions to the light from a surface: the ambient light, the emission and each light source.
    fn contributions(&self, lit: &LitSurface) -> Vec<TreeNode> {
        let lights =
            self.prepared.lights().iter().zip(&lit.lights).enumerate().map(|(index, (entity, reach))| {
                let text = match reach {
                    LightReach::Reaches { color, occluded: 0 } => adds(*color),
                    LightReach::Reaches { color, occluded } => {
                        let samples = self.prepared.light_samples(index);
                        format!("{} ({occluded} of {samples} samples are hidden)", adds(*color))
                    }
                    LightReach::NoShadowRay(reason) => format!("no shadow ray: {}", reason_text(*reason)),
                    LightReach::Occluded(slot) => {
                        format!("hidden by {}", self.lines.text(self.prepared.entity(*slot)))
                    }
                };
                (self.lines.text(*entity), text)
            });
        let mut all = vec![("ambient".to_owned(), adds(lit.ambient))];
        if lit.emission != Rgb::ZERO {
            all.push(("emission".to_owned(), adds(lit.emission)));
        }
        all.extend(lights);
        let width = all.iter().map(|(source, _)| source.chars().count()).max().unwrap_or(0);
        all.into_iter().map(|(source, text)| TreeNode::leaf(format!("{source:<width$}  {text}"))).collect()
    }

    fn json(&self) -> Value {
        let film = self.engine.effective_settings().film;
        json!({
            "scene": self.at.file,
            "width": film.width,
            "height": film.height,
            "pixel": [self.at.pixel.0, self.at.pixel.1],
            "sample": self.at.sample,
            "samples": self.at.samples,
            "frame": self.at.frame,
            "time": self.at.time.seconds(),
            "camera_line": self.camera().line,
            "linear": self.tree.color().to_array(),
            "bytes": self.bytes(),
            "rays": self.tree.rays.iter().map(|traced| self.ray_json(traced)).collect::<Vec<_>>(),
        })
    }

    fn ray_json(&self, traced: &TracedRay) -> Value {
        let entity = |slot: &_| self.lines.json(self.prepared.entity(*slot));
        let (found, surface) = match &traced.end {
            RayEnd::Background(_) => ("background", Value::Null),
            RayEnd::BeyondDepth(_) => ("depth limit", Value::Null),
            RayEnd::Surface(lit) => ("surface", self.surface_json(traced, lit)),
        };
        json!({
            "kind": kind(traced.kind),
            "parent": traced.parent,
            "origin": traced.ray.origin().to_array(),
            "direction": traced.ray.direction().to_array(),
            "finds": found,
            "surface": surface,
            "inside": traced.inside.iter().map(entity).collect::<Vec<_>>(),
            "light": traced.end.light().to_array(),
            "let_through": traced.passage.transmitted.to_array(),
            "added": traced.passage.added.to_array(),
            "throughput": traced.throughput.to_array(),
            "to_pixel": traced.contribution().to_array(),
            "not_followed": traced.cut,
        })
    }

    fn surface_json(&self, traced: &TracedRay, lit: &LitSurface) -> Value {
        let surface = &lit.surface;
        let entity = |slot| self.lines.json(self.prepared.entity(slot));
        let lights = self.prepared.lights().iter().zip(&lit.lights).map(|(light, reach)| {
            let (outcome, adds, hidden_samples, hidden_by, reason) = match reach {
                LightReach::Reaches { color, occluded } => {
                    ("reaches", Some(color.to_array()), Some(*occluded), None, None)
                }
                LightReach::NoShadowRay(unlit) => {
                    ("no shadow ray", None, None, None, Some(reason_text(*unlit)))
                }
                LightReach::Occluded(slot) => ("hidden", None, None, Some(entity(*slot)), None),
            };
            json!({
                "entity": self.lines.json(*light),
                "outcome": outcome,
                "adds": adds,
                "hidden_samples": hidden_samples,
                "hidden_by": hidden_by,
                "reason": reason,
            })
        });
        json!({
            "entity": entity(surface.hit.id),
            "t": surface.t.rounded(),
            "distance": surface.distance(&traced.ray),
            "point": surface.point.to_array(),
            "normal": surface.facing_normal().to_array(),
            "from_outside": surface.from_outside,
            "also_there": lit.coincident.iter().copied().map(entity).collect::<Vec<_>>(),
            "ambient": lit.ambient.to_array(),
            "emission": lit.emission.to_array(),
            "lights": lights.collect::<Vec<_>>(),
        })
    }
}

fn reason_text(unlit: Unlit) -> &'static str {
    match unlit {
        Unlit::Off => "the light is off",
        Unlit::Behind => "the light is behind the surface",
        Unlit::OutOfReach => "the point is outside the light's cone or reach",
        Unlit::Unscattered => "the surface scatters none of it along the ray",
        Unlit::NoDirection => "the point is at the light",
    }
}

fn ray_name(kind: RayKind, depth: usize) -> String {
    match kind {
        RayKind::Camera => "camera ray".to_owned(),
        RayKind::Reflection => format!("reflection {depth}"),
        RayKind::Refraction => format!("refraction {depth}"),
    }
}

fn kind(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Camera => "camera",
        RayKind::Reflection => "reflection",
        RayKind::Refraction => "refraction",
    }
}

fn rays(count: u64) -> String {
    if count == 1 { "1 ray".to_owned() } else { format!("{count} rays") }
}

/// Pads a number so that signs and decimal points align in columns, with a space after it.
fn column_of(number: &str) -> String {
    let sign = if number.starts_with('-') { "" } else { " " };
    format!("{:<22}", format!("{sign}{number} "))
}

fn number(value: f64) -> String {
    column_of(&exact(value))
}

fn vector(value: impl Into<[f64; 3]>) -> String {
    value.into().map(number).concat()
}

fn color(value: Rgb) -> String {
    value.to_array().map(|channel| column_of(&Shortest(channel).to_string())).concat()
}

fn adds(value: Rgb) -> String {
    let channels = value.to_array().map(|channel| format!("{:<13}", format!("{} ", Shortest(channel))));
    format!("adds {}", channels.concat())
}
