//! The materials of a scene's shapes. Each is stored once, regardless of the number of shapes that have it.

use std::collections::HashMap;

use super::material::SurfaceMaterial;
use crate::trace::math::{Bytes, Digest};
use crate::trace::rays::ShapeId;

/// The distinct materials, and the material of each shape.
#[derive(Clone, Debug, Default)]
pub struct MaterialTable {
    materials: Vec<SurfaceMaterial>,
    /// Fingerprints, by material.
    fingerprints: Vec<u64>,
    /// Number of shapes that have a material, by material.
    users: Vec<u32>,
    /// Materials that no shape has any more. New materials reuse their entries.
    unused: Vec<MaterialId>,
    /// Materials that shapes have, by fingerprint.
    ids: HashMap<u64, Vec<MaterialId>>,
    of_shapes: Vec<MaterialId>,
}

/// Identifies a material in a [`MaterialTable`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct MaterialId(u32);

/// Materials that many shapes share, as those of particles that differ in colour alone. Each is looked up once.
#[derive(Clone, Debug)]
pub struct MaterialPalette {
    materials: Vec<SurfaceMaterial>,
    /// The ids in the table, of those that have been added.
    ids: Vec<Option<MaterialId>>,
}

impl MaterialPalette {
    /// Creates a palette of materials that are in no table yet.
    #[must_use]
    pub fn new(materials: Vec<SurfaceMaterial>) -> Self {
        Self { ids: vec![None; materials.len()], materials }
    }

    /// Returns the materials.
    #[must_use]
    pub fn materials(&self) -> &[SurfaceMaterial] {
        &self.materials
    }
}

impl MaterialId {
    fn index(self) -> usize {
        self.0 as usize
    }
}

impl MaterialTable {
    /// Adds the material of the next shape.
    pub fn push(&mut self, material: SurfaceMaterial) {
        self.push_all(material, 1);
    }

    /// Adds the material of the next `shapes` shapes, at least one.
    pub fn push_all(&mut self, material: SurfaceMaterial, shapes: u32) {
        // Neighbours in the document often have the same material.
        let last = self.of_shapes.last().copied().filter(|id| self.materials[id.index()] == material);
        let id = last.unwrap_or_else(|| self.find_or_add(material));
        self.users[id.index()] += shapes;
        self.of_shapes.extend((0..shapes).map(|_| id));
    }

    /// Adds material `index` of a palette as that of the next shape. All materials of one palette must be added to one table, between which
    /// none is removed.
    ///
    /// # Panics
    ///
    /// If the palette has no such material.
    pub fn push_of(&mut self, palette: &mut MaterialPalette, index: usize) {
        let MaterialPalette { materials, ids } = palette;
        let id = *ids[index].get_or_insert_with(|| self.find_or_add(materials[index].clone()));
        self.users[id.index()] += 1;
        self.of_shapes.push(id);
    }

    /// Removes all materials, and keeps the memory.
    pub(super) fn clear(&mut self) {
        let Self { materials, fingerprints, users, unused, ids, of_shapes } = self;
        materials.clear();
        fingerprints.clear();
        users.clear();
        unused.clear();
        ids.clear();
        of_shapes.clear();
    }

    /// Replaces a shape's material, and returns whether the new one differs.
    pub(super) fn replace(&mut self, shape: ShapeId, material: SurfaceMaterial) -> bool {
        if *self.of(shape) == material {
            return false;
        }
        self.release(self.of_shapes[shape.index()]);
        let id = self.find_or_add(material);
        self.users[id.index()] += 1;
        self.of_shapes[shape.index()] = id;
        true
    }

    /// Returns the material of a shape.
    #[inline]
    pub(super) fn of(&self, shape: ShapeId) -> &SurfaceMaterial {
        &self.materials[self.of_shapes[shape.index()].index()]
    }

    /// Returns the materials of all shapes, in the order of their ids.
    pub(super) fn of_shapes(&self) -> impl Iterator<Item = (ShapeId, &SurfaceMaterial)> {
        (0..).map(ShapeId).zip(self.of_shapes.iter().map(|id| &self.materials[id.index()]))
    }

    /// Returns all materials that shapes have, each once.
    pub(super) fn distinct(&self) -> impl Iterator<Item = &SurfaceMaterial> {
        self.ids.values().flatten().map(|id| &self.materials[id.index()])
    }

    /// Returns the digests of all materials, indexed by [`place_of`](Self::place_of).
    pub(super) fn digests(&self) -> Vec<Digest> {
        let digest = |material: &SurfaceMaterial| {
            let mut bytes = Bytes::default();
            material.write(&mut bytes);
            bytes.finish()
        };
        self.materials.iter().map(digest).collect()
    }

    /// Returns the index of a shape's material.
    pub(super) fn place_of(&self, shape: ShapeId) -> usize {
        self.of_shapes[shape.index()].index()
    }

    /// Returns the bit of a shape's material in sets of materials.
    #[inline]
    pub(super) fn bit(&self, shape: ShapeId) -> u64 {
        1 << (self.fingerprints[self.place_of(shape)] % 64)
    }

    /// Returns the id of a material, which is added if it is new.
    fn find_or_add(&mut self, material: SurfaceMaterial) -> MaterialId {
        let Self { materials, fingerprints, users, unused, ids, .. } = self;
        let fingerprint = material.fingerprint();
        let alike = ids.entry(fingerprint).or_default();
        if let Some(found) = alike.iter().find(|id| materials[id.index()] == material) {
            return *found;
        }
        let id = if let Some(id) = unused.pop() {
            (materials[id.index()], fingerprints[id.index()]) = (material, fingerprint);
            id
        } else {
            materials.push(material);
            fingerprints.push(fingerprint);
            users.push(0);
            // There are at most as many materials as shapes, and at most 2^28 shapes.
            MaterialId(u32::try_from(users.len() - 1).unwrap_or(u32::MAX))
        };
        alike.push(id);
        id
    }

    /// Removes one user of a material, and the material with its last user.
    fn release(&mut self, id: MaterialId) {
        let users = &mut self.users[id.index()];
        *users -= 1;
        if *users > 0 {
            return;
        }
        let fingerprint = self.fingerprints[id.index()];
        if let Some(alike) = self.ids.get_mut(&fingerprint) {
            alike.retain(|other| *other != id);
            if alike.is_empty() {
                self.ids.remove(&fingerprint);
            }
        }
        self.unused.push(id);
    }
}

impl From<Vec<SurfaceMaterial>> for MaterialTable {
    fn from(materials: Vec<SurfaceMaterial>) -> Self {
        let mut table = Self::default();
        materials.into_iter().for_each(|material| table.push(material));
        table
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn mirror(reflected: f32) -> SurfaceMaterial {
        SurfaceMaterial { reflected, ..SurfaceMaterial::default() }
    }

    #[test]
    fn zeros_of_either_sign_are_one_material() {
        let table = MaterialTable::from(vec![mirror(0.0), mirror(-0.0)]);
        assert_eq!(table.materials.len(), 1);
    }

    proptest! {
        #[test]
        fn each_material_is_there_once_whatever_is_replaced(
            first in prop::collection::vec(0..6_u8, 1..12),
            edits in prop::collection::vec((0..12_usize, 0..6_u8), 0..40),
        ) {
            let material = |number: u8| mirror(f32::from(number) / 8.0);
            let mut all = first;
            let mut table = MaterialTable::from(all.iter().map(|number| material(*number)).collect::<Vec<_>>());
            for (index, number) in edits {
                let index = index % all.len();
                let id = (0..).map(ShapeId).nth(index).unwrap();
                prop_assert_eq!(table.replace(id, material(number)), all[index] != number);
                all[index] = number;
                prop_assert!(table.of_shapes().zip(&all).all(|((_, found), number)| *found == material(*number)));
                let mut distinct: Vec<f32> = table.distinct().map(|material| material.reflected).collect();
                distinct.sort_by(f32::total_cmp);
                let mut expected: Vec<f32> = all.iter().map(|number| material(*number).reflected).collect();
                expected.sort_by(f32::total_cmp);
                expected.dedup();
                prop_assert_eq!(distinct, expected);
                prop_assert!(table.materials.len() <= all.len() + 1);
            }
        }
    }
}
