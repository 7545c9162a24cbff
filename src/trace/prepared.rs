//! A scene as arrays, ready for rays.

use std::cmp::Ordering;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec3;
use rayon::prelude::*;

use super::bvh::Tree;
use super::copies::{Copies, Heap};
use super::exact::{Double, Double3};
use super::geometry::{Leaves, with_leaves};
use super::scratch::Scratch;
use super::shadow::{Crossed, Look};
use super::ties::Tie;
use super::{
    Background, Bounds, Fog, Geometry, Guards, Light, Limit, Precision, PreparedShape, Ray, Refined, Root,
    Slot, SurfaceMaterial, Surfaces, Ties,
};
use crate::color::Rgb;

/// All that the kernel knows of a scene at one moment, apart from the camera.
#[derive(Clone, Debug)]
pub struct PreparedScene {
    geometry: Geometry,
    materials: Vec<SurfaceMaterial>,
    /// Of equal shapes the tree and what is beside it hold the first in document order.
    copies: Copies,
    tree: Tree,
    /// Shapes without bounds, as planes, and shapes so much larger than the rest that they would spoil the tree.
    beside: Vec<Slot>,
    surfaces: Surfaces,
    /// In document order.
    pub lights: Vec<Light>,
    /// I_a.
    pub ambient: Rgb,
    /// What rays see that meet nothing.
    pub background: Background,
    /// What is between things.
    pub fog: Fog,
    /// Generations of rays that are traced; that of camera rays is, whatever it says.
    pub depth: u32,
    /// How much of a sample's light may be left out, in linear light, by not following rays that bring little; 0 follows
    /// all.
    pub cutoff: f32,
    /// How shapes are asked.
    pub precision: Precision,
}

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray's parameter, with a bound of its error.
    pub root: Root,
    /// The shape.
    pub slot: Slot,
    /// Is this the far side of a shape that the ray left inwards?
    pub far: bool,
}

/// What a ray meets first: the first in document order of all that it meets exactly there.
#[derive(Clone, Debug, PartialEq)]
pub struct Closest {
    /// What is seen.
    pub hit: Hit,
    /// What else is met there, in any order; of equal shapes the first in document order stands for all.
    pub ties: Vec<Hit>,
}

impl Closest {
    /// Takes another shape into account, and says from which `t` on nothing is of interest any more.
    #[inline(always)]
    fn meet(
        best: &mut Option<Self>,
        slot: Slot,
        leaves: &impl Leaves,
        ray: &Ray,
        guards: &mut Guards,
    ) -> f64 {
        if let Some(hit) = leaves.first_hit(slot, ray, guards) {
            Self::consider(best, hit, leaves, ray, guards);
        }
        best.as_ref().map_or(f64::INFINITY, |best| best.hit.root.latest())
    }

    /// Takes another hit of the ray into account.
    #[inline(always)]
    pub(super) fn consider(
        best: &mut Option<Self>,
        hit: Hit,
        leaves: &impl Leaves,
        ray: &Ray,
        guards: &mut Guards,
    ) {
        let Some(closest) = best else {
            *best = Some(Self { hit, ties: Vec::new() });
            return;
        };
        match leaves.compare(ray, &hit, &closest.hit, guards) {
            Ordering::Less => {
                closest.hit = hit;
                closest.ties.clear();
            }
            Ordering::Equal => {
                let (first, second) =
                    if hit.slot < closest.hit.slot { (hit, closest.hit) } else { (closest.hit, hit) };
                closest.hit = first;
                closest.ties.push(second);
            }
            Ordering::Greater => {}
        }
    }
}

/// A point of a surface, found by a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// What found it.
    pub hit: Hit,
    /// The first in document order of all shapes that equal the one it is on.
    pub(super) asked: Slot,
    /// What else is there, besides those; see [`PreparedScene::tied`].
    pub ties: Ties,
    /// The parameter of the ray that found it, right to some bits beyond an `f64`'s.
    pub t: Double,
    /// On the surface.
    pub point: DVec3,
    /// The outward unit normal; of a plane, its own.
    pub normal: DVec3,
    /// Did the ray come from the side that the normal points to?
    pub from_outside: bool,
}

impl Surface {
    /// The normal on the side that the ray came from.
    #[must_use]
    pub fn facing_normal(&self) -> DVec3 {
        if self.from_outside { self.normal } else { -self.normal }
    }
}

impl PreparedScene {
    /// A scene of these shapes with one material each, without lights, black all around.
    #[must_use]
    pub fn new(geometry: Geometry, materials: Vec<SurfaceMaterial>) -> Self {
        let mut scene = Self {
            geometry,
            surfaces: Surfaces::of(&materials),
            materials,
            copies: Copies::default(),
            tree: Tree::build(&[], &[]),
            beside: Vec::new(),
            lights: Vec::new(),
            ambient: Rgb::ZERO,
            background: Background::default(),
            fog: Fog::default(),
            depth: 1,
            cutoff: 0.0,
            precision: Precision::default(),
        };
        scene.rebuild_tree();
        scene
    }

    /// The shapes.
    #[must_use]
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Puts other shapes of the same kinds into slots. `false` if a kind differs: the scene must then be made anew.
    #[must_use]
    pub fn replace_shapes(&mut self, replacements: &[(Slot, PreparedShape)]) -> bool {
        let fits = replacements.iter().all(|(slot, shape)| self.geometry.replace(*slot, *shape));
        if fits && !replacements.is_empty() {
            self.rebuild_tree();
        }
        fits
    }

    /// The surface of a slot.
    #[must_use]
    pub fn material(&self, slot: Slot) -> &SurfaceMaterial {
        &self.materials[slot.index()]
    }

    /// What there is among the surfaces.
    #[must_use]
    pub fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// Replaces the surfaces of slots. Is any of them different?
    pub fn replace_materials(
        &mut self,
        replacements: impl IntoIterator<Item = (Slot, SurfaceMaterial)>,
    ) -> bool {
        let mut any = false;
        for (slot, material) in replacements {
            any |= self.materials[slot.index()] != material;
            self.materials[slot.index()] = material;
        }
        if any {
            self.surfaces = Surfaces::of(&self.materials);
            self.sort_copies();
        }
        any
    }

    fn sort_copies(&mut self) {
        self.copies.sort(|slot| self.materials[slot.index()].refraction.is_some());
    }

    fn rebuild_tree(&mut self) {
        self.copies = Copies::of(&self.geometry);
        self.sort_copies();
        let asked = || self.geometry.slots().filter(|slot| self.first_equal(*slot) == *slot);
        let bounded = asked().filter_map(|slot| Some((slot, self.geometry.bounds(slot)?)));
        let (mut slots, mut bounds): (Vec<Slot>, Vec<Bounds>) = bounded.unzip();
        self.beside = asked().filter(|slot| self.geometry.bounds(*slot).is_none()).collect();
        let huge = huge_shapes(&bounds);
        for index in huge.into_iter().rev() {
            self.beside.push(slots.remove(index));
            bounds.remove(index);
        }
        self.beside.sort_unstable();
        self.tree = Tree::build(&slots, &bounds);
    }

    /// The first in document order of all shapes that equal one: the one that is asked what a ray meets.
    #[must_use]
    #[inline]
    pub(super) fn first_equal(&self, slot: Slot) -> Slot {
        self.copies.first(slot)
    }

    /// The clear ones, of a shape and all that equal it, that may count among the solids that a ray is inside of.
    pub(super) fn nesting_at<'a>(&'a self, asked: &'a Slot) -> &'a [Slot] {
        match self.copies.heap(*asked) {
            Some(heap) => heap.nesting(),
            None if self.material(*asked).refraction.is_some() => std::slice::from_ref(asked),
            None => &[],
        }
    }

    /// May a clear shape count among the solids that a ray is inside of?
    pub(super) fn may_nest(&self, clear: Slot) -> bool {
        self.copies.heap(clear).is_none_or(|heap| heap.nesting().contains(&clear))
    }

    /// The shapes that a surface is on, besides the one that is seen, in document order.
    #[must_use]
    pub fn tied(&self, surface: &Surface) -> Vec<Slot> {
        let asked = surface.ties.slots().chain([surface.asked]);
        let mut tied: Vec<Slot> = Vec::new();
        for slot in asked {
            match self.copies.heap(slot) {
                Some(heap) => tied.extend(heap.slots()),
                None => tied.push(slot),
            }
        }
        tied.retain(|slot| *slot != surface.hit.slot);
        tied.sort_unstable();
        tied
    }

    /// The nearest surface that the ray meets; of several at the same place the first in document order.
    #[must_use]
    pub(super) fn closest(
        &self,
        leaves: &impl Leaves,
        ray: &Ray,
        scratch: &mut Scratch<'_>,
    ) -> Option<Closest> {
        let Scratch { stack, guards, cancelled, .. } = scratch;
        let mut best: Option<Closest> = None;
        let mut limit = f64::INFINITY;
        for slot in &self.beside {
            if cancelled.load(Relaxed) {
                return None;
            }
            limit = Closest::meet(&mut best, *slot, leaves, ray, guards);
        }
        self.tree.visit_nearest(ray, limit, stack, cancelled, |slot| {
            Closest::meet(&mut best, slot, leaves, ray, guards)
        });
        best
    }

    /// Anything but `except` that stands between the ray's origin and `limit`: whatever is found first.
    #[must_use]
    pub(super) fn occluder(
        &self,
        leaves: &impl Leaves,
        ray: &Ray,
        limit: &Limit,
        except: Option<Slot>,
        scratch: &mut Scratch<'_>,
    ) -> Option<Slot> {
        let Scratch { stack, guards, cancelled, .. } = scratch;
        // Where there are several equal shapes, one of them is another than `except`.
        let counts = |slot: Slot| Some(slot) != except || self.copies.heap(slot).is_some();
        let mut hides = |slot: Slot| counts(slot) && leaves.stands_before(slot, ray, limit, guards);
        let mut beside = self.beside.iter().copied();
        let beside = beside.find(|slot| cancelled.load(Relaxed) || hides(*slot));
        beside.or_else(|| self.tree.find_any(ray, limit.t(), stack, cancelled, hides))
    }

    /// Anything opaque but `except` that stands between the ray's origin and `limit`. If there is nothing, `scratch.crossed` are
    /// the clear shapes that do.
    #[must_use]
    pub(super) fn occluder_or_crossed(
        &self,
        leaves: &impl Leaves,
        ray: &Ray,
        limit: &Limit,
        except: Option<Slot>,
        scratch: &mut Scratch<'_>,
    ) -> Option<Slot> {
        let Scratch { stack, guards, crossed, cancelled, .. } = scratch;
        crossed.clear();
        let mut hides = |slot: Slot| match self.copies.heap(slot) {
            Some(heap) => self.heap_hides_or_is_crossed(leaves, heap, ray, (limit, except), crossed, guards),
            None if Some(slot) == except => false,
            None => self.hides_or_is_crossed(leaves, slot, (ray, limit), Look::Glance, crossed, guards),
        };
        let mut beside = self.beside.iter().copied();
        let beside = beside.find(|slot| cancelled.load(Relaxed) || hides(*slot));
        beside.or_else(|| self.tree.find_any(ray, limit.t(), stack, cancelled, hides))
    }

    /// Does the shape stand in the ray's way? A clear one never does, but is added to those that are crossed.
    #[inline]
    pub(super) fn hides_or_is_crossed(
        &self,
        leaves: &impl Leaves,
        slot: Slot,
        (ray, limit): (&Ray, &Limit),
        look: Look,
        crossed: &mut Vec<Crossed>,
        guards: &mut Guards,
    ) -> bool {
        // A ray that leaves a shape leaves all that equal it.
        let asked = self.first_equal(slot);
        if self.material(slot).refraction.is_none() {
            return leaves.stands_before(asked, ray, limit, guards);
        }
        crossed.extend(Crossed::new(leaves, asked, (ray, limit), look, guards).map(|met| met.by(slot)));
        false
    }

    /// The same for equal shapes at once.
    #[cold]
    fn heap_hides_or_is_crossed(
        &self,
        leaves: &impl Leaves,
        heap: &Heap,
        ray: &Ray,
        (limit, except): (&Limit, Option<Slot>),
        crossed: &mut Vec<Crossed>,
        guards: &mut Guards,
    ) -> bool {
        if let Some(opaque) = heap.opaque(except) {
            return self.hides_or_is_crossed(leaves, opaque, (ray, limit), Look::Glance, crossed, guards);
        }
        let mut clear = heap.clear().iter().copied().filter(|slot| Some(*slot) != except);
        if let Some(first) = clear.next() {
            let from = crossed.len();
            self.hides_or_is_crossed(leaves, first, (ray, limit), Look::Glance, crossed, guards);
            if let Some(met) = crossed.get(from).copied() {
                crossed.extend(clear.map(|slot| met.by(slot)));
            }
        }
        false
    }

    /// The point that the ray found, with its normal. Of several surfaces at the same place it is the first in document order,
    /// save that a clear one that the ray leaves gives way to the first opaque one: what a glass stands on is seen through it.
    #[must_use]
    #[inline]
    pub(super) fn surface(
        &self,
        leaves: &impl Leaves,
        ray: &Ray,
        closest: &Closest,
        guards: &mut Guards,
    ) -> Surface {
        if closest.ties.is_empty() && self.copies.heap(closest.hit.slot).is_none() {
            return surface_at(leaves, ray, closest.hit, closest.hit.slot, Ties::default(), guards);
        }
        self.tied_surface(leaves, ray, closest, guards)
    }

    #[cold]
    fn tied_surface(
        &self,
        leaves: &impl Leaves,
        ray: &Ray,
        closest: &Closest,
        guards: &mut Guards,
    ) -> Surface {
        let mut shapes: Vec<Hit> = closest
            .ties
            .iter()
            .chain([&closest.hit])
            .map(|hit| Hit { slot: self.first_equal(hit.slot), ..*hit })
            .collect();
        shapes.sort_unstable_by_key(|hit| hit.slot);
        shapes.dedup_by_key(|hit| hit.slot);
        let seen_as = |hit: Hit, guards: &mut Guards| {
            let asked = self.first_equal(hit.slot);
            let others = shapes.iter().filter(|other| other.slot != asked).map(|tied| {
                let normal = leaves.refined(ray, tied, guards).normal;
                Tie { slot: tied.slot, normal }
            });
            let ties = Ties::new(others.collect());
            surface_at(leaves, ray, hit, asked, ties, guards)
        };
        let seen = seen_as(closest.hit, guards);
        if seen.from_outside || self.material(closest.hit.slot).refraction.is_none() {
            return seen;
        }
        let opaque = shapes.iter().filter_map(|hit| Some(Hit { slot: self.first_opaque(hit.slot)?, ..*hit }));
        opaque.min_by_key(|hit| hit.slot).map_or(seen, |opaque| seen_as(opaque, guards))
    }

    /// The first opaque one, in document order, of a shape and all that equal it.
    fn first_opaque(&self, asked: Slot) -> Option<Slot> {
        match self.copies.heap(asked) {
            Some(heap) => heap.opaque(None),
            None => self.material(asked).refraction.is_none().then_some(asked),
        }
    }

    /// The nearest surface that the ray meets, by the renderer's own path.
    #[must_use]
    pub fn cast(&self, ray: &Ray) -> Option<Surface> {
        with_leaves!(self, leaves => self.cast_at(leaves, ray, &mut Scratch::default()))
    }

    /// The same for many rays, on the current rayon pool's threads.
    #[must_use]
    pub fn cast_all(&self, rays: &[Option<Ray>]) -> Vec<Option<Surface>> {
        with_leaves!(self, leaves => {
            let cast = |scratch: &mut Scratch<'_>, ray: &Option<Ray>| {
                self.cast_at(leaves, ray.as_ref()?, scratch)
            };
            rays.par_iter().map_init(Scratch::default, cast).collect()
        })
    }

    /// For asking after many rays, one by one.
    #[must_use]
    pub fn search(&self) -> Search<'_> {
        Search { scene: self, scratch: Scratch::default() }
    }

    fn cast_at(&self, leaves: &impl Leaves, ray: &Ray, scratch: &mut Scratch<'_>) -> Option<Surface> {
        let closest = self.closest(leaves, ray, scratch)?;
        Some(self.surface(leaves, ray, &closest, &mut scratch.guards))
    }
}

/// The renderer's own questions, with what they need kept from ray to ray: nothing is allocated for each. Always asked with
/// [`Precision::Guaranteed`].
#[derive(Debug)]
pub struct Search<'a> {
    scene: &'a PreparedScene,
    scratch: Scratch<'static>,
}

impl Search<'_> {
    /// What the ray meets first.
    #[must_use]
    #[inline]
    pub fn closest(&mut self, ray: &Ray) -> Option<Closest> {
        self.scene.closest(&self.scene.geometry, ray, &mut self.scratch)
    }

    /// The point that the ray found, with its normal.
    #[must_use]
    #[inline]
    pub fn surface(&mut self, ray: &Ray, closest: &Closest) -> Surface {
        self.scene.surface(&self.scene.geometry, ray, closest, &mut self.scratch.guards)
    }

    /// Does anything but `except` stand between the ray's origin and `limit`?
    #[must_use]
    #[inline]
    pub fn is_hidden(&mut self, ray: &Ray, limit: &Limit, except: Option<Slot>) -> bool {
        self.scene.occluder(&self.scene.geometry, ray, limit, except, &mut self.scratch).is_some()
    }
}

impl Surface {
    /// How far it is from the origin of the ray that found it: t |d| with a hundred bits, rounded once.
    #[must_use]
    pub fn distance(&self, ray: &Ray) -> f64 {
        let direction = Double3::from(ray.direction());
        (self.t * direction.dot(direction).sqrt()).rounded()
    }

    /// A ray that leaves this surface. It never meets the surface it starts on by rounding. `None` if the direction is zero
    /// or not finite.
    #[must_use]
    pub fn leave_towards(&self, direction: DVec3) -> Option<Ray> {
        Ray::leaving(self, direction.dot(self.normal) >= 0.0, direction)
    }

    /// A ray that leaves this surface towards a point, on the side that the ray came from which found it, and where that
    /// is on it. `None` if the point is this one or not finite.
    #[must_use]
    #[inline]
    pub fn leave_to(&self, point: DVec3) -> Option<(Ray, Limit)> {
        Ray::leaving_to(self, self.from_outside, point)
    }
}

#[inline(always)]
fn surface_at(
    leaves: &impl Leaves,
    ray: &Ray,
    hit: Hit,
    asked: Slot,
    ties: Ties,
    guards: &mut Guards,
) -> Surface {
    let Refined { t, point, normal } = leaves.refined(ray, &hit, guards);
    // A far side is met from inside, however the last bits of a grazing ray fall.
    let from_outside = !hit.far && ray.direction().dot(normal) <= 0.0;
    Surface { hit, asked, ties, t, point, normal, from_outside }
}

/// Indices of at most 64 boxes whose longest edge is over 2^16 times the median of all that have one, ascending.
fn huge_shapes(bounds: &[Bounds]) -> Vec<usize> {
    const TIMES_MEDIAN: f64 = 65_536.0;
    const MOST: usize = 64;
    let mut extents: Vec<f64> = bounds.iter().map(Bounds::extent).filter(|extent| *extent > 0.0).collect();
    if extents.is_empty() {
        return Vec::new();
    }
    let middle = extents.len() / 2;
    let median = *extents.select_nth_unstable_by(middle, f64::total_cmp).1;
    let mut huge: Vec<usize> =
        (0..bounds.len()).filter(|index| bounds[*index].extent() > median * TIMES_MEDIAN).collect();
    huge.sort_by(|left, right| bounds[*right].extent().total_cmp(&bounds[*left].extent()));
    huge.truncate(MOST);
    huge.sort_unstable();
    huge
}
