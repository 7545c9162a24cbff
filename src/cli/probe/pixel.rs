//! Explanation of the colour of a pixel, or of the light along a ray.

use std::path::Path;

use anyhow::{Context, ensure};
use serde_json::{Value, json};

use rayreel::components::Name;
use rayreel::drawing::{ABSORBED, RayDrawing, ray_name, unlit_reason};
use rayreel::scene::{SourceLine, Sources};
use rayreel::systems::{Preparation, active_camera};
use rayreel::trace::{
    Attenuation, BackgroundTerms, LightReach, LitSurface, RayEnd, RayKind, RayTree, TracedRay,
};
use rayreel::{Engine, Entity, Ray, Rgb, Time};

use super::super::exit::Failure;
use super::super::print;
use super::super::write_file::{ensure_not_the_scene, write_file};
use super::names::EntityLines;
use super::numbers::{Shortest, adds, color, column_of, number, vector};
use super::terms::{self, Terms};
use super::tree::TreeNode;

/// Number of ray depths that are drawn nested; rays at the next depth become separate trees at the margin.
const NESTED: usize = 6;

/// The rays to explain.
#[derive(Clone, Copy)]
pub(super) enum Probed {
    /// The rays of a pixel.
    Pixel {
        /// The column and the row.
        pixel: (u32, u32),
        /// The index of the sample.
        sample: u32,
        /// Number of samples of the pixel.
        samples: u32,
    },
    /// The rays that follow from a ray.
    Ray(Ray),
}

/// The rays to explain, with their scene and moment.
pub(super) struct ProbedAt<'a> {
    pub(super) file: &'a str,
    pub(super) sources: &'a Sources,
    pub(super) probed: Probed,
    /// True if the terms of every sum are printed.
    pub(super) terms: bool,
    /// Number of the frame; `None` for a moment that is not a frame.
    pub(super) frame: Option<u32>,
    pub(super) time: Time,
}

/// The form of an explanation.
#[derive(Clone, Copy)]
pub(super) enum OutputForm<'a> {
    Text,
    Json,
    /// A drawing in a file, which must not be the scene's.
    Svg {
        file: &'a Path,
        scene: &'a Path,
    },
}

pub(super) fn run(at: &ProbedAt<'_>, engine: &mut Engine, output: OutputForm<'_>) -> Result<(), Failure> {
    if let OutputForm::Svg { file, scene } = output {
        ensure_not_the_scene(file, scene)?;
    }
    let tree = match at.probed {
        Probed::Pixel { pixel, sample, samples } => {
            let film = engine.effective_settings().film;
            ensure_pixel(pixel, (film.width, film.height))?;
            ensure_sample(sample, samples)?;
            engine.probe(at.time, pixel, sample)?
        }
        Probed::Ray(ray) => engine.probe_ray(at.time, ray)?,
    };
    let (tree, prepared) = tree
        .zip(engine.prepared())
        .context("the camera is not in a finite place at this moment: all pixels show the background")?;
    let mut entities = prepared.lights().to_vec();
    entities.extend(tree.rays.iter().flat_map(|traced| met(prepared, traced)));
    let lines = EntityLines::of(engine.world(), at.sources, &entities);
    let terms = at.terms.then(|| Terms::new(engine, prepared, &tree, &lines));
    let explanation = RayExplanation { at, engine, prepared, tree: &tree, lines: &lines, terms };
    match output {
        OutputForm::Text => print::result(&explanation.text())?,
        OutputForm::Json => print::json(explanation.json())?,
        OutputForm::Svg { file, .. } => {
            write_file(file, explanation.drawing().as_bytes())?;
            print::result_line(&format!("{}: {}", file.display(), explanation.summary()))?;
        }
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
    let hiding = lit.samples.iter().filter_map(|sample| sample.occluder);
    let slots = std::iter::once(lit.surface.hit.id).chain(lit.coincident.iter().copied()).chain(hiding);
    slots.map(|slot| prepared.entity(slot)).collect()
}

/// The contents of an explanation.
struct RayExplanation<'a> {
    at: &'a ProbedAt<'a>,
    engine: &'a Engine,
    prepared: &'a Preparation,
    tree: &'a RayTree,
    lines: &'a EntityLines<'a>,
    /// The terms of every sum, if they are printed.
    terms: Option<Terms<'a>>,
}

impl RayExplanation<'_> {
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

    /// Draws the rays in two views.
    fn drawing(&self) -> String {
        let is_pixel = matches!(self.at.probed, Probed::Pixel { .. });
        let drawing = RayDrawing::new(self.engine, self.prepared, self.tree, self.at.time, is_pixel);
        let heading = self.heading();
        drawing.draw(heading.trim_end(), &self.summary(), self.bytes())
    }

    /// Counts the rays and shadow rays.
    fn summary(&self) -> String {
        let surfaces = self.tree.rays.iter().filter_map(|traced| match &traced.end {
            RayEnd::Surface(lit) => Some(lit),
            RayEnd::Background(_) | RayEnd::BeyondDepth(_) => None,
        });
        let samples: Vec<_> = surfaces.flat_map(|lit| &lit.samples).collect();
        let occluded = samples.iter().filter(|sample| sample.occluder.is_some()).count();
        let [red, green, blue] = self.bytes();
        format!(
            "{} and {} to lights, {occluded} of them occluded; the colour is {red}, {green}, {blue}",
            rays(self.tree.rays.len() as u64),
            rays(samples.len() as u64),
        )
    }

    fn text(&self) -> String {
        let mut text = self.heading();
        text += &format!("{:<14}{}\n", "linear", color(self.tree.color()).trim_end());
        let bytes = self.bytes().map(|byte| column_of(&byte.to_string()));
        text += &format!("{:<14}{}\n", "bytes", bytes.concat().trim_end());
        for node in self.screen().into_iter().chain(self.roots()) {
            text.push('\n');
            text += &node.draw();
        }
        text
    }

    /// Describes the probed rays in a line.
    fn heading(&self) -> String {
        let time = Shortest(self.at.time.seconds());
        let moment = match self.at.frame {
            Some(frame) => format!("frame {frame} at {time} s"),
            None => format!("the moment {time} s"),
        };
        match self.at.probed {
            Probed::Pixel { pixel: (column, row), sample, samples } => {
                let (settings, camera) = (self.engine.effective_settings(), self.camera());
                let (width, height) = (settings.film.width, settings.film.height);
                let sample = match samples {
                    1 => String::new(),
                    _ if settings.sampling.is_adaptive() => format!(" sample {sample} of {samples} at most,"),
                    _ => format!(" sample {sample} of {samples},"),
                };
                format!("Pixel {column},{row} of {width}x{height},{sample} {moment}, camera ({camera})\n")
            }
            Probed::Ray(Ray { origin, direction }) => {
                let vector = |vector: [f64; 3]| vector.map(|part| Shortest(part).to_string()).join(",");
                let (origin, direction) = (vector(origin.to_array()), vector(direction.to_array()));
                format!("Ray from {origin} in direction {direction}, {moment} ({})\n", self.at.file)
            }
        }
    }

    /// Returns the place of the pixel on the screen, if the terms are printed.
    fn screen(&self) -> Option<TreeNode> {
        let Probed::Pixel { pixel, sample, .. } = self.at.probed else { return None };
        self.terms.as_ref().map(|terms| terms.screen(pixel, sample, self.at.time).node())
    }

    /// Returns the tree of rays. Subtrees nested deeper than [`NESTED`] become separate trees.
    fn roots(&self) -> Vec<TreeNode> {
        let rays = &self.tree.rays;
        let mut depths: Vec<usize> = Vec::with_capacity(rays.len());
        for traced in rays {
            depths.push(traced.parent.map_or(0, |parent| depths[parent] + 1));
        }
        let mut roots = Vec::new();
        let mut nodes: Vec<TreeNode> = (0..rays.len()).map(|index| self.node(index, depths[index])).collect();
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

    fn node(&self, index: usize, depth: usize) -> TreeNode {
        let traced = &self.tree.rays[index];
        let name = match (self.at.probed, traced.kind) {
            (Probed::Ray(_), RayKind::Camera) => "ray".to_owned(),
            (_, kind) => ray_name(kind, depth),
        };
        let light = traced.end.light();
        let mut facts =
            vec![("origin", vector(traced.ray.origin())), ("direction", vector(traced.ray.direction()))];
        let (found, children) = match &traced.end {
            RayEnd::Background(seen) => ("sees the background".to_owned(), self.background(seen)),
            RayEnd::BeyondDepth(seen) => {
                (format!("is beyond the depth of {depth} and sees the background"), self.background(seen))
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
                    facts.push(("also there", format!(" {}", self.lines.slot_text(self.prepared, slot))));
                }
                let entity = self.lines.slot_text(self.prepared, surface.hit.id);
                (format!("meets {entity} from {side}"), self.contributions(index, lit))
            }
        };
        for slot in &traced.inside {
            facts.push(("inside", format!(" {}", self.lines.slot_text(self.prepared, *slot))));
        }
        facts.push(("light", color(light)));
        if self.terms.is_some() {
            facts.extend(terms::medium_facts(&traced.medium));
        }
        if traced.passage != Attenuation::CLEAR {
            facts.push(("let through", color(traced.passage.transmitted)));
            facts.push(("added", color(traced.passage.added)));
        }
        if let Some(terms) = &self.terms {
            facts.push(("brings back", color(terms.returned[index])));
        }
        facts.push(("throughput", color(traced.throughput)));
        facts.push(("to pixel", color(traced.contribution())));
        if traced.cut > 0 {
            facts.push(("not followed", format!(" {} too faint to show", rays(traced.cut))));
        }
        TreeNode { title: format!("{name} {found}"), facts, children }
    }

    /// Lists the terms of the background, if they are printed.
    fn background(&self, seen: &BackgroundTerms) -> Vec<TreeNode> {
        aligned(self.terms.as_ref().map_or_else(Vec::new, |_| terms::background_nodes(seen)))
    }

    /// Lists all contributions to the light from a surface: the ambient light, the emission and each light source. With terms, lists the
    /// values that they consist of and the light of the secondary rays, too.
    fn contributions(&self, index: usize, lit: &LitSurface) -> Vec<TreeNode> {
        let lights =
            self.prepared.lights().iter().zip(&lit.lights).enumerate().map(|(index, (entity, reach))| {
                let text = match reach {
                    LightReach::Reaches { color, occluded: 0 } => adds(*color),
                    LightReach::Reaches { color, occluded } => {
                        let samples = terms::light_samples(self.engine, self.prepared, index);
                        format!("{} ({occluded} of {samples} samples are hidden)", adds(*color))
                    }
                    LightReach::NoShadowRay(reason) => {
                        format!("no shadow ray: {}", unlit_reason(self.engine, self.prepared, *reason, lit))
                    }
                    LightReach::Occluded(slot) => {
                        format!("hidden by {}", self.lines.slot_text(self.prepared, *slot))
                    }
                    LightReach::Absorbed => ABSORBED.to_owned(),
                };
                let node = self.terms.as_ref().map(|terms| terms.light_node(index, lit));
                (self.lines.text(*entity), text, node.unwrap_or_default())
            });
        let ambient = self.terms.as_ref().map(|_| terms::ambient_node(lit));
        let mut all = vec![("ambient".to_owned(), adds(lit.ambient), ambient.unwrap_or_default())];
        if lit.emission != Rgb::ZERO {
            all.push(("emission".to_owned(), adds(lit.emission), TreeNode::default()));
        }
        all.extend(lights);
        if let Some(terms) = &self.terms {
            all.extend(terms.secondary(index, lit));
        }
        let equation = self.terms.iter().flat_map(|terms| terms.surface(index, lit));
        equation.chain(aligned(all)).collect()
    }

    fn json(&self) -> Value {
        let mut object = json!({
            "scene": self.at.file,
            "frame": self.at.frame,
            "time": self.at.time.seconds(),
            "linear": self.tree.color().to_array(),
            "bytes": self.bytes(),
            "rays": (0..self.tree.rays.len()).map(|index| self.ray_json(index)).collect::<Vec<_>>(),
        });
        match self.at.probed {
            Probed::Pixel { pixel, sample, samples } => {
                let film = self.engine.effective_settings().film;
                (object["width"], object["height"]) = (film.width.into(), film.height.into());
                object["pixel"] = json!([pixel.0, pixel.1]);
                (object["sample"], object["samples"]) = (sample.into(), samples.into());
                object["camera_line"] = self.camera().line.into();
                if let Some(terms) = &self.terms {
                    object["screen"] = terms.screen(pixel, sample, self.at.time).json();
                }
            }
            Probed::Ray(ray) => {
                object["ray"] =
                    json!({ "origin": ray.origin.to_array(), "direction": ray.direction.to_array() });
            }
        }
        object
    }

    fn ray_json(&self, index: usize) -> Value {
        let traced = &self.tree.rays[index];
        let entity = |slot: &_| self.lines.slot_json(self.prepared, *slot);
        let (found, surface) = match &traced.end {
            RayEnd::Background(_) => ("background", Value::Null),
            RayEnd::BeyondDepth(_) => ("depth limit", Value::Null),
            RayEnd::Surface(lit) => ("surface", self.surface_json(index, lit)),
        };
        let mut object = json!({
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
        });
        if let Some(terms) = &self.terms {
            object["brings_back"] = terms.returned[index].to_array().into();
            object["absorption"] = traced.medium.absorption.to_array().into();
            object["fog"] = traced.medium.fog.to_array().into();
            object["fog_depth"] = json!(traced.medium.optical_depth);
            if let RayEnd::Background(seen) | RayEnd::BeyondDepth(seen) = &traced.end {
                object["background"] = terms::background_json(seen);
            }
        }
        object
    }

    fn surface_json(&self, index: usize, lit: &LitSurface) -> Value {
        let (surface, traced) = (&lit.surface, &self.tree.rays[index]);
        let entity = |slot| self.lines.slot_json(self.prepared, slot);
        let lights =
            self.prepared.lights().iter().zip(&lit.lights).enumerate().map(|(index, (light, reach))| {
                let (outcome, adds, hidden_samples, hidden_by, reason) = match reach {
                    LightReach::Reaches { color, occluded } => {
                        ("reaches", Some(color.to_array()), Some(*occluded), None, None)
                    }
                    LightReach::NoShadowRay(unlit) => (
                        "no shadow ray",
                        None,
                        None,
                        None,
                        Some(unlit_reason(self.engine, self.prepared, *unlit, lit)),
                    ),
                    LightReach::Occluded(slot) => ("hidden", None, None, Some(entity(*slot)), None),
                    LightReach::Absorbed => ("absorbed", None, None, None, Some(ABSORBED)),
                };
                let mut object = json!({
                    "entity": self.lines.json(*light),
                    "outcome": outcome,
                    "adds": adds,
                    "hidden_samples": hidden_samples,
                    "hidden_by": hidden_by,
                    "reason": reason,
                });
                if let Some(terms) = &self.terms {
                    object["sample_count"] = terms::light_samples(self.engine, self.prepared, index).into();
                    object["samples"] = terms.light_json(index, lit);
                }
                object
            });
        let mut object = json!({
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
        });
        if let Some(terms) = &self.terms {
            object["terms"] = terms.surface_json(index, lit);
        }
        object
    }
}

/// Gives nodes titles of two columns: the sources of light, and what comes from them.
fn aligned(nodes: Vec<(String, String, TreeNode)>) -> Vec<TreeNode> {
    let width = nodes.iter().map(|(source, ..)| source.chars().count()).max().unwrap_or(0);
    let titled = |(source, text, node)| TreeNode { title: format!("{source:<width$}  {text}"), ..node };
    nodes.into_iter().map(titled).collect()
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
