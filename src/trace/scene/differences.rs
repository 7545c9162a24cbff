//! Differences between the shapes of a scene and those of a former one, by which unchanged parts of a picture are found.
//!
//! Shapes are compared in document order, not by their ids, which refer to other shapes after a shape has been added or removed.

use rayon::prelude::*;

use super::geometry::Geometry;
use super::material_table::MaterialTable;
use super::prepared_scene::PreparedScene;
use crate::trace::rays::ShapeId;
use crate::trace::shapes::Bounds;

/// The shapes and materials of a scene, copied for comparison with those of a later one.
#[derive(Clone, Debug)]
pub(crate) struct ShapeSnapshot {
    geometry: Geometry,
    materials: MaterialTable,
}

/// The differences between the shapes of two scenes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ShapeDifferences {
    /// The bounds, before and after, of shapes that may be hit elsewhere, or transmit other light.
    pub(crate) bounds: Vec<Bounds>,
    /// The former materials, as a set of [bits](PreparedScene::material_bit), of shapes that differ only in the light from their surfaces.
    pub(crate) materials: u64,
}

/// Shapes with their materials, by rank in document order.
#[derive(Clone, Copy)]
struct ShapeList<'a> {
    geometry: &'a Geometry,
    materials: &'a MaterialTable,
}

impl PreparedScene {
    /// Copies the shapes and their materials.
    pub(crate) fn snapshot(&self) -> ShapeSnapshot {
        ShapeSnapshot { geometry: self.geometry().clone(), materials: self.materials().clone() }
    }

    /// Returns the differences from former shapes. `None` if one may reach any pixel: a shape without bounds, or one that
    /// a light names as its own by its place in the order.
    pub(crate) fn differences(&self, former: &ShapeSnapshot) -> Option<ShapeDifferences> {
        let before = ShapeList { geometry: &former.geometry, materials: &former.materials };
        let after = ShapeList { geometry: self.geometry(), materials: self.materials() };
        let (old, new) = (before.geometry.len(), after.geometry.len());
        let mut found = ShapeDifferences::default();
        if old == new {
            let differ = |rank: &usize| !before.equals(*rank, after, *rank);
            let differing: Vec<usize> = (0..old).into_par_iter().filter(differ).collect();
            differing.into_iter().try_for_each(|rank| found.add(before, after, rank))?;
            return Some(found);
        }
        // The shapes before and after those that were added or removed have kept their relative order.
        let shorter = old.min(new);
        let differ = |rank: usize| !before.equals(rank, after, rank);
        let head = (0..shorter).into_par_iter().position_first(differ).unwrap_or(shorter);
        let is_same = |back: &usize| before.equals(old - back, after, new - back);
        let tail = (1..=shorter - head).take_while(is_same).count();
        // A light names its own shape by its place in the order, which here may be that of another shape.
        let place = |own: ShapeId| self.order().rank(own).number() as usize;
        if self.lights.iter().filter_map(|light| light.own_shape).any(|own| place(own) >= head) {
            return None;
        }
        (head..old - tail).try_for_each(|rank| found.add_bounds(before.bounds(rank)))?;
        (head..new - tail).try_for_each(|rank| found.add_bounds(after.bounds(rank)))?;
        Some(found)
    }
}

impl ShapeList<'_> {
    fn id(&self, rank: usize) -> ShapeId {
        self.geometry.order().shape_at(u32::try_from(rank).unwrap_or(u32::MAX))
    }

    /// Returns whether a shape equals one of another list, and is seen by the same rays.
    fn has_shape_of(&self, rank: usize, other: ShapeList<'_>, other_rank: usize) -> bool {
        let (id, other_id) = (self.id(rank), other.id(other_rank));
        self.geometry.shape(id) == other.geometry.shape(other_id)
            && self.geometry.visibility(id) == other.geometry.visibility(other_id)
    }

    /// Returns whether a shape and its material equal those of another list.
    fn equals(&self, rank: usize, other: ShapeList<'_>, other_rank: usize) -> bool {
        self.has_shape_of(rank, other, other_rank)
            && self.materials.of(self.id(rank)) == other.materials.of(other.id(other_rank))
    }

    fn is_transparent(&self, rank: usize) -> bool {
        self.materials.of(self.id(rank)).refraction.is_some()
    }

    fn bounds(&self, rank: usize) -> Option<Bounds> {
        self.geometry.bounds(self.id(rank))
    }
}

impl ShapeDifferences {
    /// Maximum number of boxes after condensing. A test takes some 20 ns for each of at most four joined hulls: this many take some 20 us for
    /// a tile that is far from all of them.
    const MOST: usize = 256;

    /// Adds the differences of another instant.
    pub(crate) fn join(&mut self, other: &Self) {
        self.materials |= other.materials;
        self.bounds.extend_from_slice(&other.bounds);
    }

    /// Adds a shape that differs. Returns `None` if it may reach any pixel.
    fn add(&mut self, before: ShapeList<'_>, after: ShapeList<'_>, rank: usize) -> Option<()> {
        let is_transparent = before.is_transparent(rank) || after.is_transparent(rank);
        if before.has_shape_of(rank, after, rank) && !is_transparent {
            self.materials |= before.materials.bit(before.id(rank));
            return Some(());
        }
        self.add_bounds(before.bounds(rank))?;
        self.add_bounds(after.bounds(rank))
    }

    fn add_bounds(&mut self, bounds: Option<Bounds>) -> Option<()> {
        // A union would lose what is not a number.
        let is_number = |Bounds { min, max }: &Bounds| !min.is_nan() && !max.is_nan();
        self.bounds.push(bounds.filter(is_number)?);
        Some(())
    }

    /// Returns the same differences in few boxes: neighbours in the scene's text, which are often neighbours in space, are joined.
    pub(crate) fn condensed(&self) -> Self {
        let groups = self.bounds.chunks(self.bounds.len().div_ceil(Self::MOST).max(1));
        let joined = groups.filter_map(|group| group.iter().copied().reduce(Bounds::union));
        Self { bounds: joined.collect(), materials: self.materials }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::color::Rgb;
    use crate::trace::scene::{
        LightSource, PreparedLight, PreparedShape, RayVisibility, Refraction, SurfaceMaterial,
    };
    use crate::trace::shapes::{Plane, Sphere};

    type Thing = (PreparedShape, SurfaceMaterial, RayVisibility);

    fn ball(x: f64) -> Thing {
        let shape = PreparedShape::Sphere(Sphere { center: DVec3::X * x, radius: 0.25 });
        (shape, SurfaceMaterial::default(), RayVisibility::ALL)
    }

    fn red((shape, _, visibility): Thing) -> Thing {
        (shape, SurfaceMaterial { diffuse: Rgb::X, ..SurfaceMaterial::default() }, visibility)
    }

    fn glass((shape, _, visibility): Thing) -> Thing {
        let refraction = Refraction { transmitted: 1.0, ior: 1.5, absorption: Rgb::ZERO, fresnel: true };
        (shape, SurfaceMaterial { refraction: Some(refraction), ..SurfaceMaterial::default() }, visibility)
    }

    fn scene(things: &[Thing]) -> PreparedScene {
        let mut geometry = Geometry::default();
        for (shape, _, visibility) in things {
            let id = geometry.push(*shape);
            geometry.set_visibility(id, *visibility);
        }
        let materials: Vec<SurfaceMaterial> = things.iter().map(|thing| thing.1.clone()).collect();
        PreparedScene::new(geometry, materials)
    }

    /// Returns the number of boxes of the differences, and of materials.
    fn differences(before: &[Thing], after: &[Thing]) -> Option<(usize, u32)> {
        let found = scene(after).differences(&scene(before).snapshot())?;
        Some((found.bounds.len(), found.materials.count_ones()))
    }

    #[test]
    fn differences_are_as_small_as_the_edit() {
        let floor = |height: f64| {
            let plane = Plane::new(DVec3::Y * height, DVec3::Y).unwrap();
            (PreparedShape::Plane(plane), SurfaceMaterial::default(), RayVisibility::ALL)
        };
        let hidden = |(shape, material, _): Thing| {
            (shape, material, RayVisibility { shadow: false, ..RayVisibility::ALL })
        };
        let all = [floor(0.0), ball(0.0), ball(1.0), ball(2.0)];
        let with = |index: usize, thing: Thing| {
            let mut changed = all.to_vec();
            changed[index] = thing;
            changed
        };
        let [first, second, third, fourth] = all.clone();
        assert_eq!(differences(&all, &all), Some((0, 0)));
        assert_eq!(differences(&all, &with(1, ball(0.5))), Some((2, 0)), "moved");
        assert_eq!(differences(&all, &with(1, red(ball(0.0)))), Some((0, 1)), "painted");
        assert_eq!(differences(&all, &with(0, red(floor(0.0)))), Some((0, 1)), "a painted plane");
        assert_eq!(differences(&all, &with(0, floor(0.5))), None, "a moved plane");
        assert_eq!(differences(&all, &with(1, glass(ball(0.0)))), Some((2, 0)), "glass");
        assert_eq!(differences(&all, &with(0, glass(floor(0.0)))), None, "a plane of glass");
        assert_eq!(differences(&all, &with(1, hidden(ball(0.0)))), Some((2, 0)), "hidden");
        let added = [first.clone(), second.clone(), ball(5.0), third.clone(), fourth.clone()];
        assert_eq!(differences(&all, &added), Some((1, 0)), "added");
        assert_eq!(differences(&added, &all), Some((1, 0)), "removed");
        let swapped = [first, third, second, fourth];
        assert_eq!(differences(&all, &swapped), Some((4, 0)), "in another order");
    }

    #[test]
    fn many_boxes_are_joined_but_none_is_lost() {
        let places = |start: f64| (0..500_u16).map(move |index| start + f64::from(index));
        let many = |start: f64| places(start).map(ball).collect::<Vec<_>>();
        let found = scene(&many(0.5)).differences(&scene(&many(0.0)).snapshot()).unwrap().condensed().bounds;
        assert!(found.len() <= ShapeDifferences::MOST, "{}", found.len());
        for place in places(0.0).chain(places(0.5)).map(|x| DVec3::X * x) {
            let holds = |found: &Bounds| place.cmpge(found.min).all() && place.cmple(found.max).all();
            assert!(found.iter().any(holds), "{place}");
        }
        let widest = found.iter().map(Bounds::extent).fold(0.0, f64::max);
        assert!(widest < 3.0, "only neighbours are joined: {widest}");
    }

    #[test]
    fn lights_at_other_shapes_in_the_same_place_of_the_order_are_noticed() {
        let lit = |things: &[Thing], own: usize| {
            let mut scene = scene(things);
            let own_shape = scene.geometry().ids().nth(own);
            let source = LightSource::Point(DVec3::Y);
            let (intensity, falloff, samples, casts_shadows) = (Rgb::ONE, None, 1, true);
            scene.lights =
                vec![PreparedLight { source, intensity, falloff, samples, casts_shadows, own_shape }];
            scene
        };
        let all = [ball(0.0), ball(1.0), ball(2.0)];
        // The light has moved from the second shape to the third, which is the second now.
        assert!(lit(&all[1..], 1).differences(&lit(&all, 1).snapshot()).is_none());
        assert!(lit(&all[..2], 1).differences(&lit(&all, 1).snapshot()).is_some());
    }
}
