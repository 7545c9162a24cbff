//! The terms of the sums that give the light of a ray, in the notation of textbooks.

use glam::DVec3;
use serde_json::{Value, json};

use rayreel::color::blend;
use rayreel::components::{Material, Pattern};
use rayreel::systems::Preparation;
use rayreel::trace::{
    BackgroundTerms, Equation, GradientTerms, Interval, LitSurface, PassageTerms, RayKind, RayTree,
    RefractionTerms, RodEnds, SkyLight, SurfaceTerms, TracedLightSample,
};
use rayreel::{Effect, Engine, Rgb, Time};

use super::names::EntityLines;
use super::numbers::{Shortest, adds, color, column_of, number, vector};
use super::tree::TreeNode;

/// The scene and the ray tree that the terms come from.
pub(super) struct Terms<'a> {
    engine: &'a Engine,
    prepared: &'a Preparation,
    tree: &'a RayTree,
    lines: &'a EntityLines<'a>,
    /// The light that each ray brings back to its origin.
    pub(super) returned: Vec<Rgb>,
}

/// The place of a sample on the camera's screen.
pub(super) struct ScreenPlace {
    eye: DVec3,
    /// u, v and n.
    axes: [DVec3; 3],
    distance: f64,
    /// Alpha and beta.
    place: [f64; 2],
    /// True if the rays of all pixels have the direction n.
    is_orthographic: bool,
}

/// The directions on both sides of a refractive surface, relative to its normal.
struct RefractionAngles {
    /// The cosines c1 and c2; no c2 under total reflection.
    cosines: [Option<f64>; 2],
    /// The angles theta1 and theta2 in degrees.
    degrees: [Option<f64>; 2],
    /// n1 sin(theta1).
    invariant: f64,
}

/// The coefficients and the colour of a material.
struct Coefficients {
    k_a: f32,
    k_d: f32,
    color: Rgb,
    ambient_color: Rgb,
}

impl<'a> Terms<'a> {
    pub(super) fn new(
        engine: &'a Engine,
        prepared: &'a Preparation,
        tree: &'a RayTree,
        lines: &'a EntityLines<'a>,
    ) -> Self {
        Self { engine, prepared, tree, lines, returned: tree.returned() }
    }

    /// Returns the place on the screen of a sample of a pixel.
    pub(super) fn screen(&self, pixel: (u32, u32), sample: u32, time: Time) -> ScreenPlace {
        let camera = self.prepared.camera();
        ScreenPlace {
            eye: camera.position(),
            axes: camera.axes(),
            distance: camera.distance(),
            place: camera.on_screen_at(self.prepared.sampling(time), pixel, sample),
            is_orthographic: camera.is_orthographic(),
        }
    }

    /// Returns the equation of the intersection at the end of a ray.
    fn equation(&self, index: usize, lit: &LitSurface) -> Equation {
        self.prepared.scene().geometry().equation(lit.surface.hit.id, &self.tree.rays[index].ray)
    }

    /// Explains the surface at the end of a ray: its equation and its material.
    pub(super) fn surface(&self, index: usize, lit: &LitSurface) -> [TreeNode; 2] {
        let direction = self.tree.rays[index].ray.direction();
        let mut equation = equation_node(&self.equation(index, lit));
        equation.facts.insert(0, ("dir", vector(direction / direction.length())));
        [equation, self.material_node(index, lit)]
    }

    fn material_node(&self, index: usize, lit: &LitSurface) -> TreeNode {
        let Coefficients { k_a, k_d, color: c, ambient_color } = self.coefficients(lit);
        let terms = &lit.terms;
        let mut facts = vec![("k_a", single(k_a)), ("k_d", single(k_d)), ("c", color(c))];
        if ambient_color != c {
            facts.push(("c ambient", color(ambient_color)));
        }
        if terms.specular > 0.0 {
            facts.extend([("k_s", single(terms.specular)), ("shininess", single(terms.shininess))]);
        }
        if terms.secondary.mirror > 0.0 {
            facts.push(("k_r", single(terms.secondary.mirror)));
        }
        facts.extend(terms.secondary.tint.map(|tint| ("metal", color(tint))));
        if let Some(refraction) = &terms.secondary.refraction {
            facts.extend(refraction_facts(refraction, &self.angles(index, lit, refraction)));
        }
        TreeNode { facts, ..TreeNode::leaf("material".to_owned()) }
    }

    /// Returns the angles at the refractive surface at the end of a ray.
    fn angles(&self, index: usize, lit: &LitSurface, refraction: &RefractionTerms) -> RefractionAngles {
        let direction = self.tree.rays[index].ray.direction();
        let (unit, normal) = (direction / direction.length(), lit.surface.facing_normal());
        let (cosine, sine) = (-unit.dot(normal), unit.cross(normal).length());
        let eta = refraction.from / refraction.into;
        let beyond =
            (!refraction.is_total()).then(|| (1.0 - eta * eta * (1.0 - cosine * cosine)).max(0.0).sqrt());
        let degrees = |sine, cosine| libm::atan2(sine, cosine).to_degrees();
        RefractionAngles {
            cosines: [Some(cosine), beyond],
            degrees: [Some(degrees(sine, cosine)), beyond.map(|cosine| degrees(eta * sine, cosine))],
            invariant: refraction.from * sine,
        }
    }

    /// Returns the coefficients of the material at a point. k_d is 0 if diffuse light is disabled. Without ambient light, I_a is 0 instead of
    /// k_a.
    fn coefficients(&self, lit: &LitSurface) -> Coefficients {
        let entity = self.prepared.entity(lit.surface.hit.id);
        let is_enabled = |effect| !self.engine.settings.without.contains(effect);
        let world = self.engine.world();
        let mut material =
            world.get::<&Material>(entity).map_or_else(|_| Material::default(), |found| *found);
        material.color = self.prepared.member_color(lit.surface.hit.id).unwrap_or(material.color);
        let second = lit.terms.pattern;
        let pattern = world.get::<&Pattern>(entity).ok();
        let color = pattern.map_or(material.color, |pattern| blend(material.color, pattern.color, second));
        let ambient_color = material.ambient_color.unwrap_or(color);
        let k_d = if is_enabled(Effect::Diffuse) { material.k_d } else { 0.0 };
        Coefficients { k_a: material.k_a, k_d, color, ambient_color }
    }

    /// Lists the light of the secondary rays of a surface.
    pub(super) fn secondary(&self, index: usize, lit: &LitSurface) -> Vec<(String, String, TreeNode)> {
        let children = self.tree.rays.iter().enumerate().filter(|(_, ray)| ray.parent == Some(index));
        let terms = children.map(|(child, ray)| {
            let (name, symbol) = match ray.kind {
                RayKind::Refraction => ("refracted light", "T"),
                RayKind::Reflection | RayKind::Camera => ("reflected light", "R"),
            };
            let (secondary, light) = (&lit.terms.secondary, self.returned[child]);
            let tint = secondary.tint.filter(|_| ray.kind == RayKind::Reflection);
            let mut facts = vec![("share", single(secondary.share(ray.kind))), (symbol, color(light))];
            facts.extend(tint.map(|tint| ("metal", color(tint))));
            let node = TreeNode { facts, ..TreeNode::default() };
            (name.to_owned(), adds(secondary.part(ray.kind, light)), node)
        });
        terms.collect()
    }

    /// Explains the light of light number `index`, sample by sample.
    pub(super) fn light_node(&self, index: usize, lit: &LitSurface) -> TreeNode {
        let mut samples: Vec<&TracedLightSample> = samples_of(index, lit).collect();
        let facts = |sample: &TracedLightSample| self.light_facts(sample, lit);
        let count = light_samples(self.engine, self.prepared, index) as usize;
        if count == 1 {
            return TreeNode { facts: samples.pop().map(facts).unwrap_or_default(), ..TreeNode::default() };
        }
        let omitted = match count - samples.len() {
            0 => None,
            _ if samples.is_empty() => None,
            1 => Some("1 other sample adds nothing".to_owned()),
            omitted => Some(format!("{omitted} other samples add nothing")),
        };
        let child = |sample: &TracedLightSample| TreeNode {
            facts: facts(sample),
            ..TreeNode::leaf(format!("sample {}  {}", sample.sample, adds(sample.contribution())))
        };
        let children = samples.into_iter().map(child).chain(omitted.map(TreeNode::leaf)).collect();
        TreeNode { children, ..TreeNode::default() }
    }

    fn light_facts(
        &self,
        TracedLightSample { terms, visibility, occluder, .. }: &TracedLightSample,
        lit: &LitSurface,
    ) -> Vec<(&'static str, String)> {
        let mut facts = vec![
            ("L", vector(terms.to_light / terms.to_light.length())),
            ("N.L", number(terms.cosine)),
            ("I", color(terms.intensity)),
            ("k_d c I", color(lit.terms.diffuse_color * terms.intensity)),
            ("diffuse", color(terms.diffuse)),
        ];
        if let Some(half_cosine) = terms.half_cosine {
            facts.extend([("N.H", number(half_cosine)), ("highlight", color(terms.specular))]);
        }
        facts.push(("V", color(*visibility)));
        if let Some(slot) = occluder {
            facts.push(("hidden by", format!(" {}", self.lines.slot_text(self.prepared, *slot))));
        }
        facts
    }

    /// Returns the samples of light number `index`.
    pub(super) fn light_json(&self, index: usize, lit: &LitSurface) -> Value {
        let sample_json = |sample: &TracedLightSample| {
            let terms = &sample.terms;
            let occluder = sample.occluder.map(|slot| self.prepared.entity(slot));
            json!({
                "sample": sample.sample,
                "L": (terms.to_light / terms.to_light.length()).to_array(),
                "N_L": terms.cosine,
                "N_H": terms.half_cosine,
                "I": terms.intensity.to_array(),
                "k_d_c_I": (lit.terms.diffuse_color * terms.intensity).to_array(),
                "diffuse": terms.diffuse.to_array(),
                "highlight": terms.specular.to_array(),
                "V": sample.visibility.to_array(),
                "hidden_by": occluder.map(|entity| self.lines.json(entity)),
            })
        };
        samples_of(index, lit).map(sample_json).collect()
    }

    /// Returns the values of the surface at the end of a ray, without those of the lights.
    pub(super) fn surface_json(&self, index: usize, lit: &LitSurface) -> Value {
        let Coefficients { k_a, k_d, color, ambient_color } = self.coefficients(lit);
        let SurfaceTerms { ambient_light, specular, shininess, secondary, .. } = lit.terms;
        let returned = |kind| {
            let mut rays = self.tree.rays.iter().zip(&self.returned);
            let child = rays.find(|(ray, _)| ray.parent == Some(index) && ray.kind == kind);
            child.map(|(_, light)| light.to_array())
        };
        let refraction = secondary.refraction;
        let angles = refraction.map(|refraction| self.angles(index, lit, &refraction));
        json!({
            "equation": equation_json(&self.equation(index, lit)),
            "k_a": k_a,
            "k_d": k_d,
            "c": color.to_array(),
            "c_ambient": ambient_color.to_array(),
            "I_a": ambient_light.to_array(),
            "V_a": lit.ambient_visibility().unwrap_or(Rgb::ONE).to_array(),
            "k_s": specular,
            "shininess": shininess,
            "k_r": secondary.mirror,
            "metal": secondary.tint.map(|tint| tint.to_array()),
            "k_t": refraction.map_or(0.0, |refraction| refraction.coefficient),
            "n": refraction.map(|refraction| [refraction.from, refraction.into]),
            "cosines": angles.as_ref().map(|angles| angles.cosines),
            "angles": angles.as_ref().map(|angles| angles.degrees),
            "F": refraction.map(|refraction| refraction.reflectance),
            "total_reflection": refraction.is_some_and(|refraction| refraction.is_total()),
            "reflected_share": secondary.reflected,
            "R": returned(RayKind::Reflection),
            "refracted_share": secondary.share(RayKind::Refraction),
            "T": returned(RayKind::Refraction),
        })
    }
}

impl ScreenPlace {
    /// Returns the vector from the eye to the place: P1 - P0.
    fn towards(&self) -> DVec3 {
        let [_, _, forward] = self.axes;
        self.across() + forward * self.distance
    }

    /// Returns the vector from the middle of the screen to the place.
    fn across(&self) -> DVec3 {
        let ([right, up, _], [alpha, beta]) = (self.axes, self.place);
        right * alpha + up * beta
    }

    pub(super) fn node(&self) -> TreeNode {
        let ([right, up, forward], [alpha, beta]) = (self.axes, self.place);
        let axes = [("n", vector(forward)), ("u", vector(right)), ("v", vector(up))];
        let place = [("alpha", number(alpha)), ("beta", number(beta))];
        let mut facts = vec![(if self.is_orthographic { "eye" } else { "P0" }, vector(self.eye))];
        facts.extend(axes);
        if self.is_orthographic {
            facts.extend(place);
            facts.push(("P0", vector(self.eye + self.across())));
            let title = "screen of parallel rays: P0 = eye + alpha u + beta v, dir = n";
            return TreeNode { facts, ..TreeNode::leaf(title.to_owned()) };
        }
        facts.push(("d", number(self.distance)));
        facts.extend(place);
        facts.push(("P1 - P0", vector(self.towards())));
        TreeNode { facts, ..TreeNode::leaf("screen: P1 - P0 = alpha u + beta v + d n".to_owned()) }
    }

    pub(super) fn json(&self) -> Value {
        let ([right, up, forward], [alpha, beta]) = (self.axes, self.place);
        let start = if self.is_orthographic { self.eye + self.across() } else { self.eye };
        let mut object = json!({
            "eye": self.eye.to_array(),
            "P0": start.to_array(),
            "n": forward.to_array(),
            "u": right.to_array(),
            "v": up.to_array(),
            "alpha": alpha,
            "beta": beta,
        });
        if !self.is_orthographic {
            object["d"] = self.distance.into();
            object["P1_P0"] = self.towards().to_array().into();
        }
        object
    }
}

/// Explains the background and the lights in the sky; nothing if there is only a flat colour.
pub(super) fn background_nodes(terms: &BackgroundTerms) -> Vec<(String, String, TreeNode)> {
    let BackgroundTerms { background, gradient, sun, stars, .. } = terms;
    let mut nodes = Vec::new();
    if let Some(GradientTerms { from, to, share }) = gradient {
        let facts = vec![("c1", color(*from)), ("c2", color(*to)), ("s", single(*share))];
        let node = TreeNode { facts, ..TreeNode::default() };
        nodes.push(("gradient (1 - s) c1 + s c2".to_owned(), adds(*background), node));
    }
    for (name, light) in [("sun", sun), ("stars", stars)] {
        let Some(SkyLight { intensity, share }) = light else { continue };
        if nodes.is_empty() {
            nodes.push(("background".to_owned(), adds(*background), TreeNode::default()));
        }
        let facts = vec![("I", color(*intensity)), ("share", single(*share))];
        let node = TreeNode { facts, ..TreeNode::default() };
        nodes.push((name.to_owned(), adds(*intensity * *share), node));
    }
    nodes
}

/// Returns the terms of the background of a ray.
pub(super) fn background_json(terms: &BackgroundTerms) -> Value {
    let light = |light: &Option<SkyLight>| {
        light.map(|light| json!({ "I": light.intensity.to_array(), "share": light.share }))
    };
    let gradient = terms.gradient.map(
        |GradientTerms { from, to, share }| json!({ "c1": from.to_array(), "c2": to.to_array(), "s": share }),
    );
    json!({
        "background": terms.background.to_array(),
        "gradient": gradient,
        "sun": light(&terms.sun),
        "stars": light(&terms.stars),
    })
}

/// Lists the terms of the medium along a ray.
pub(super) fn medium_facts(medium: &PassageTerms) -> Vec<(&'static str, String)> {
    let mut facts = Vec::new();
    if medium.absorption != Rgb::ZERO {
        facts.push(("absorption", color(medium.absorption)));
    }
    if medium.optical_depth > 0.0 {
        facts.extend([("fog", color(medium.fog)), ("fog depth", number(medium.optical_depth))]);
    }
    facts
}

/// Lists the terms of refraction at a surface.
fn refraction_facts(refraction: &RefractionTerms, angles: &RefractionAngles) -> [(&'static str, String); 5] {
    let indices = [refraction.from, refraction.into].map(|index| column_of(&Shortest(index).to_string()));
    let numbers = |numbers: [Option<f64>; 2]| numbers.map(|value| value.map_or(" none".to_owned(), number));
    let reflectance = match refraction.is_total() {
        true => format!(" 1 (total reflection: n1 sin(theta1) = {:.3} > n2)", angles.invariant),
        false => single(refraction.reflectance),
    };
    [
        ("k_t", single(refraction.coefficient)),
        ("n1, n2", indices.concat()),
        ("c1, c2", numbers(angles.cosines).concat()),
        ("angles", numbers(angles.degrees).concat()),
        ("F", reflectance),
    ]
}

/// Explains the ambient light.
pub(super) fn ambient_node(lit: &LitSurface) -> TreeNode {
    let mut facts = vec![("k_a c", color(lit.terms.ambient_color)), ("I_a", color(lit.terms.ambient_light))];
    facts.extend(lit.ambient_visibility().map(|share| ("V_a", color(share))));
    TreeNode { facts, ..TreeNode::default() }
}

fn samples_of(index: usize, lit: &LitSurface) -> impl Iterator<Item = &TracedLightSample> {
    lit.samples.iter().filter(move |sample| sample.light == index)
}

/// Returns the number of samples of a light.
pub(super) fn light_samples(engine: &Engine, prepared: &Preparation, index: usize) -> u32 {
    let is_point = engine.settings.without.contains(Effect::AreaLights);
    if is_point { 1 } else { prepared.light_samples(index) }
}

fn equation_node(equation: &Equation) -> TreeNode {
    let numbers = |numbers: &[f64]| numbers.iter().copied().map(number).collect::<String>();
    let roots = ("t", numbers(&equation.roots()));
    let interval = |interval: &Interval| match interval {
        Interval::Between(interval) => numbers(interval),
        Interval::All => " all t".to_owned(),
        Interval::Nothing => " no t".to_owned(),
    };
    let (title, mut facts) = match equation {
        Equation::Quadratic { direction, from_center, a, b, c, discriminant, .. } => {
            let title = if direction.is_some() {
                "ellipsoid: A t^2 + B t + C = 0, A = dir'.dir', D = B^2 - 4 A C, in the space of its sphere"
            } else {
                "sphere: t^2 + B t + C = 0, D = B^2 - 4 C"
            };
            let mut facts: Vec<_> = direction.iter().map(|direction| ("dir'", vector(*direction))).collect();
            facts.push(("P0 - Pc", vector(*from_center)));
            if direction.is_some() {
                facts.push(("A", number(*a)));
            }
            facts.extend([("B", number(*b)), ("C", number(*c)), ("D", number(*discriminant))]);
            (title, facts)
        }
        Equation::Linear { numerator, denominator, .. } => (
            "plane: t = (Q0-P0).N / dir.N",
            vec![("(Q0-P0).N", number(*numerator)), ("dir.N", number(*denominator))],
        ),
        Equation::Slabs { intervals, .. } => {
            let facts = ["t in x", "t in y", "t in z"].into_iter().zip(intervals.iter().map(interval));
            ("box: t in the three intervals between its faces", facts.collect())
        }
        Equation::Rod { direction, from_start, axis, a, b, c, discriminant, side, ends, .. } => {
            let title = match ends {
                RodEnds::Flat(_) => "cylinder: A t^2 + B t + C = 0 on its side, and t between its ends",
                RodEnds::Round(_) => "capsule: A t^2 + B t + C = 0 on its side, and spheres at its ends",
            };
            let mut facts: Vec<_> = direction.iter().map(|direction| ("dir'", vector(*direction))).collect();
            facts.extend([("P0 - Pc", vector(*from_start)), ("a", vector(*axis))]);
            facts.extend([
                ("A", number(*a)),
                ("B", number(*b)),
                ("C", number(*c)),
                ("D", number(*discriminant)),
            ]);
            facts.push(("t in side", interval(side)));
            match ends {
                RodEnds::Flat(ends) => facts.push(("t in ends", interval(ends))),
                RodEnds::Round([start, stop]) => {
                    facts.extend([("t in from", interval(start)), ("t in to", interval(stop))]);
                }
            }
            (title, facts)
        }
    };
    facts.push(roots);
    TreeNode { facts, ..TreeNode::leaf(title.to_owned()) }
}

fn equation_json(equation: &Equation) -> Value {
    let interval = |interval: &Interval| match interval {
        Interval::Between(interval) => json!(interval),
        Interval::All => json!("all"),
        Interval::Nothing => json!("none"),
    };
    match equation {
        Equation::Quadratic { direction, from_center, a, b, c, discriminant, roots } => json!({
            "shape": if direction.is_some() { "ellipsoid" } else { "sphere" },
            "direction": direction.map(|direction| direction.to_array()),
            "P0_Pc": from_center.to_array(),
            "A": a,
            "B": b,
            "C": c,
            "D": discriminant,
            "t": roots,
        }),
        Equation::Linear { numerator, denominator, root } => json!({
            "shape": "plane",
            "numerator": numerator,
            "denominator": denominator,
            "t": root.map(|root| [root]),
        }),
        Equation::Slabs { intervals, roots } => {
            json!({ "shape": "box", "intervals": intervals.each_ref().map(interval), "t": roots })
        }
        Equation::Rod { direction, from_start, axis, a, b, c, discriminant, side, ends, roots } => {
            let (shape, ends) = match ends {
                RodEnds::Flat(ends) => ("cylinder", interval(ends)),
                RodEnds::Round(ends) => ("capsule", ends.each_ref().map(interval).into()),
            };
            json!({
                "shape": shape,
                "direction": direction.map(|direction| direction.to_array()),
                "P0_Pc": from_start.to_array(),
                "a": axis.to_array(),
                "A": a,
                "B": b,
                "C": c,
                "D": discriminant,
                "side": interval(side),
                "ends": ends,
                "t": roots,
            })
        }
    }
}

fn single(value: f32) -> String {
    column_of(&Shortest(value).to_string())
}
