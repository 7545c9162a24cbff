//! A node: eight boxes, tested against one ray.

use fearless_simd::{f32x8, prelude::*};

use super::frame::{FrameBox, FrameRay};

/// Number of children of a node.
pub(crate) const WIDTH: usize = 8;

/// Index of a leaf of the tree, which holds one shape. The leaves of a node have consecutive indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct LeafId(u32);

/// A child of a node in packed form: another node, or a leaf.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Child(u32);

/// A child in unpacked form.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Link {
    Node(usize),
    Leaf(LeafId),
}

/// The boxes of eight children, plane by plane: lower x, y, z, then upper x, y, z.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Node {
    planes: [[f32; WIDTH]; 6],
    pub(crate) children: [Child; WIDTH],
    /// Bit mask of the children in use.
    used: u32,
    /// Bit mask of the children that are spheres touching all sides of their boxes.
    round: u32,
}

impl LeafId {
    /// Creates the id of the leaf with this index.
    pub(crate) fn new(index: usize) -> Self {
        Self(to_u32(index))
    }

    /// Returns the index into arrays with one entry per leaf.
    #[inline(always)]
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

impl Child {
    /// Bit that marks leaves, whose indices are below 2^28.
    const LEAF: u32 = 1 << 31;

    pub(crate) fn node(index: u32) -> Self {
        Self(index)
    }

    pub(crate) fn leaf(index: u32) -> Self {
        Self(Self::LEAF | index)
    }

    #[inline]
    pub(crate) fn read(self) -> Link {
        if self.0 & Self::LEAF == 0 {
            Link::Node(self.0 as usize)
        } else {
            Link::Leaf(LeafId(self.0 & !Self::LEAF))
        }
    }

    /// Returns the packed form as a number.
    #[inline]
    pub(crate) fn word(self) -> u32 {
        self.0
    }

    /// Creates a child from its packed form.
    #[inline]
    pub(crate) fn from_word(word: u32) -> Self {
        Self(word)
    }
}

impl Node {
    /// Factor by which far sides are lengthened: 1 + 2^-20.
    pub(crate) const LENGTHEN: f32 = 1.0 + 1.0 / 1_048_576.0;

    pub(crate) fn empty() -> Self {
        let (lower, upper) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self {
            planes: [lower, lower, lower, upper, upper, upper],
            children: [Child::default(); WIDTH],
            used: 0,
            round: 0,
        }
    }

    pub(crate) fn set(&mut self, index: usize, bounds: &FrameBox, child: Child, round: bool) {
        self.set_box(index, bounds);
        self.children[index] = child;
        self.used |= 1 << index;
        self.round |= u32::from(round) << index;
    }

    /// Replaces the box of a child.
    pub(super) fn set_box(&mut self, index: usize, bounds: &FrameBox) {
        for axis in 0..3 {
            self.planes[axis][index] = bounds.min[axis];
            self.planes[axis + 3][index] = bounds.max[axis];
        }
    }

    /// Returns the box of a child.
    pub(super) fn child_box(&self, index: usize) -> FrameBox {
        let [x, y, z, upper_x, upper_y, upper_z] = self.bounds(index);
        FrameBox { min: [x, y, z], max: [upper_x, upper_y, upper_z] }
    }

    /// Returns the union of the boxes of all children.
    pub(super) fn around(&self) -> FrameBox {
        self.places().fold(FrameBox::EMPTY, |all, place| all.union(&self.child_box(place)))
    }

    /// Returns a node with the same boxes and other children.
    pub(super) fn relinked(&self, relink: impl Fn(Child) -> Child) -> Self {
        let mut children = self.children;
        for place in self.places() {
            children[place] = relink(children[place]);
        }
        Self { children, ..*self }
    }

    /// Returns the indices of the children in use.
    pub(super) fn places(&self) -> impl Iterator<Item = usize> + use<> {
        let used = self.used;
        (0..WIDTH).filter(move |place| used & (1 << place) != 0)
    }

    /// Returns plane `index` of the boxes of all children: lower x, y, z, then upper x, y, z.
    #[inline(always)]
    pub(super) fn plane<S: Simd>(&self, simd: S, index: usize) -> f32x8<S> {
        f32x8::load_array_ref(simd, &self.planes[index])
    }

    /// Returns the box of a child, plane by plane.
    #[inline(always)]
    pub(super) fn bounds(&self, child: usize) -> [f32; 6] {
        let [x, y, z, upper_x, upper_y, upper_z] = &self.planes;
        let child = child % WIDTH;
        [x[child], y[child], z[child], upper_x[child], upper_y[child], upper_z[child]]
    }

    /// Returns the bit mask of the children in use.
    #[inline(always)]
    pub(super) fn used(&self) -> u32 {
        self.used
    }

    /// Returns whether a child is a sphere that touches all sides of its box.
    #[inline(always)]
    pub(super) fn is_round(&self, child: usize) -> bool {
        self.round & (1 << child) != 0
    }

    /// Returns a bit mask of the children that the ray may hit before `limit`, and the distances at which it may enter them.
    ///
    /// Never stricter than exact arithmetic: the origin is taken at the conservative end of its interval, three roundings of at most 2^-24
    /// each are compensated for by lengthening the far side by 2^-20 (after Ize, "Robust BVH Ray Traversal", JCGT 2013), and a comparison
    /// with NaN (the origin lies in a plane and the ray is parallel to it) passes.
    #[inline(always)]
    pub(crate) fn entries(&self, ray: &FrameRay, limit: f32) -> (u32, [f32; WIDTH]) {
        let mut entry = [0.0_f32; WIDTH];
        let mut exit = [limit; WIDTH];
        for axis in 0..3 {
            let (near, far) = if ray.downward[axis] { (axis + 3, axis) } else { (axis, axis + 3) };
            let (near, far) = (&self.planes[near], &self.planes[far]);
            let (near_origin, far_origin, inverse) =
                (ray.near_origin[axis], ray.far_origin[axis], ray.inverse[axis]);
            for child in 0..WIDTH {
                let enters = (near[child] - near_origin) * inverse;
                let leaves = (far[child] - far_origin) * inverse;
                entry[child] = if enters > entry[child] { enters } else { entry[child] };
                exit[child] = if leaves < exit[child] { leaves } else { exit[child] };
            }
        }
        let mut mask = 0;
        for child in 0..WIDTH {
            mask |= u32::from(entry[child] <= exit[child] * Self::LENGTHEN) << child;
        }
        (mask & self.used, entry)
    }
}

/// Converts an index to 32 bits. Shape indices are below 2^28.
pub(super) fn to_u32(index: usize) -> u32 {
    debug_assert!(u32::try_from(index).is_ok(), "{index}");
    u32::try_from(index).unwrap_or(u32::MAX)
}
