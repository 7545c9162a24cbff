//! Construction and refitting of trees over many kinds of box sets.

use glam::DVec3;
use proptest::prelude::*;

use super::frame::FrameBox;
use super::node::{LeafId, Link};
use super::{Builder, Extent, Refitter, Tree};
use crate::trace::shapes::Bounds;

/// A tree, and the index of each leaf's shape.
struct Built {
    tree: Tree,
    shapes: Vec<usize>,
}

impl Built {
    fn over(bounds: &[Bounds], builder: &mut Builder) -> Self {
        let extent = |index: usize| Extent { bounds: bounds[index], round: false };
        let mut tree = Tree::default();
        let shapes =
            builder.build(bounds.len(), extent, &mut tree).iter().map(|shape| *shape as usize).collect();
        Self { tree, shapes }
    }

    /// Checks that the tree has every shape once, that all boxes enclose their contents exactly, and that nodes come before their children.
    /// Returns the number of nodes above the deepest leaf.
    fn check(&self, bounds: &[Bounds]) -> usize {
        let mut found = Vec::new();
        let mut deepest = 0;
        let mut pending = Vec::from_iter((!self.tree.nodes.is_empty()).then_some((0, 1)));
        while let Some((index, depth)) = pending.pop() {
            deepest = deepest.max(depth);
            let node = &self.tree.nodes[index];
            for place in node.places() {
                let around = node.child_box(place);
                match node.children[place].read() {
                    Link::Node(child) => {
                        assert!(child > index, "{child} lies below {index}");
                        assert_eq!(self.tree.nodes[child].around(), around);
                        pending.push((child, depth + 1));
                    }
                    Link::Leaf(leaf) => {
                        let shape = self.shapes[leaf.index()];
                        assert!(self.encloses(&around, &bounds[shape]), "{around:?} {:?}", bounds[shape]);
                        found.push(shape);
                    }
                }
            }
        }
        found.sort_unstable();
        assert_eq!(found, (0..bounds.len()).collect::<Vec<usize>>());
        deepest
    }

    /// Compares in the scene's coordinates: boxes are not widened, and scaling by a power of two is exact.
    fn encloses(&self, around: &FrameBox, bounds: &Bounds) -> bool {
        let (origin, scale) = (self.tree.frame.origin(), self.tree.frame.scale());
        (0..3).all(|axis| {
            let low = f64::from(around.min[axis]) / scale;
            let high = f64::from(around.max[axis]) / scale;
            // Differences of numbers this close are exact, or off on the conservative side by less than the outward rounding.
            low <= (bounds.min - origin)[axis]
                && high >= (bounds.max - origin)[axis]
                && around.min[axis] >= -1.0
                && around.max[axis] <= 1.0
        })
    }
}

#[test]
fn heaps_rows_and_grids_make_shallow_trees() {
    let count = 5000;
    let places: [fn(u32) -> DVec3; 5] = [
        |_| DVec3::ZERO,
        |index| if index == 0 { DVec3::X * 1e9 } else { DVec3::ZERO },
        |index| DVec3::X * f64::from(index),
        |index| DVec3::new(f64::from(index % 17), f64::from(index / 17 % 17), f64::from(index / 289)),
        |index| DVec3::Y * f64::from(index) * 1e-12,
    ];
    let mut builder = Builder::default();
    for place in places {
        for half in [0.0, 1e-60, 0.4] {
            let around = |index: u32| Bounds::around(place(index), DVec3::splat(half));
            let bounds: Vec<Bounds> = (0..count).map(around).collect();
            let depth = Built::over(&bounds, &mut builder).check(&bounds);
            assert!(depth <= 8, "{depth} nodes deep");
        }
    }
}

/// Rounding outwards must not move boxes out of the frame.
#[test]
fn heaps_that_reach_nearly_as_far_as_a_power_of_two_make_trees() {
    for reach in [1.0_f64, 1024.0, 1e-9_f64.log2().floor().exp2()] {
        for short in [0.0, 1e-16, 1e-9, 2.9e-8, 6e-8, 1.2e-7, 2.4e-7, 1e-6] {
            let half = DVec3::splat(reach * (1.0 - short));
            let bounds: Vec<Bounds> = (0..20).map(|_| Bounds::around(DVec3::ZERO, half)).collect();
            Built::over(&bounds, &mut Builder::default()).check(&bounds);
        }
    }
}

#[test]
fn shapes_within_each_other_make_a_tree_too() {
    let bounds: Vec<Bounds> =
        (1..3000).map(|index| Bounds::around(DVec3::ZERO, DVec3::splat(f64::from(index)))).collect();
    let depth = Built::over(&bounds, &mut Builder::default()).check(&bounds);
    assert!(depth <= 30, "{depth} nodes deep");
}

#[test]
fn many_treelets_make_one_tree() {
    let mut builder = Builder::default();
    let corners = |count: u32| -> Vec<Bounds> {
        // Most are in a corner, a few are far out, and some hundreds coincide.
        let place = |index: u32| match index % 100 {
            0 => DVec3::new(f64::from(index), f64::from(index % 777), -1e6),
            1 => DVec3::ONE,
            _ => DVec3::new(f64::from(index % 61), f64::from(index % 53), f64::from(index % 47)) * 1e-3,
        };
        (0..count).map(|index| Bounds::around(place(index), DVec3::splat(2e-4))).collect()
    };
    for count in [70_000, 16_384, 16_385, 0, 1, 2, 40_000] {
        let bounds = corners(count);
        let depth = Built::over(&bounds, &mut builder).check(&bounds);
        assert!(depth <= 24, "{depth} nodes deep");
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let place =
        |index: u32| DVec3::new(f64::from(index % 613), f64::from(index % 127), f64::from(index % 31));
    let bounds: Vec<Bounds> =
        (0..50_000).map(|index| Bounds::around(place(index), DVec3::splat(0.3))).collect();
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let built = pool.install(|| Built::over(&bounds, &mut Builder::default()));
        let nodes = built.tree.nodes.iter().map(|node| {
            let boxes: Vec<FrameBox> = node.places().map(|place| node.child_box(place)).collect();
            (node.children, boxes)
        });
        (built.shapes, nodes.collect::<Vec<_>>())
    };
    let alone = build(1);
    assert!(alone == build(2) && alone == build(7));
}

/// Generates boxes of all sizes, near each other or far apart.
fn boxes() -> impl Strategy<Value = Vec<Bounds>> {
    let coordinate = prop_oneof![-1.0..1.0_f64, -1e3..1e3, Just(0.5), Just(1e-9)];
    let point = prop::array::uniform3(coordinate).prop_map(DVec3::from_array);
    let half = prop_oneof![Just(0.0), 0.0..0.5_f64, Just(1e-20), Just(40.0)];
    let bounds = (point, half).prop_map(|(point, half)| Bounds::around(point, DVec3::splat(half)));
    prop::collection::vec(bounds, 1..300)
}

proptest! {
    #[test]
    fn every_box_encloses_what_it_is_around(bounds in boxes()) {
        Built::over(&bounds, &mut Builder::default()).check(&bounds);
    }

    #[test]
    fn every_box_still_does_after_shapes_have_moved(
        first in boxes(),
        moves in prop::collection::vec((0..300_usize, prop::array::uniform3(-1.0..1.0_f64), 0.0..2.0_f64), 1..60),
    ) {
        let mut bounds = first;
        let mut built = Built::over(&bounds, &mut Builder::default());
        let mut refitter = Refitter::new(&built.tree, bounds.len());
        let leaf_of = |built: &Built, shape: usize| {
            LeafId::new(built.shapes.iter().position(|found| *found == shape).unwrap())
        };
        for few in moves.chunks(3) {
            let mut moved = Vec::new();
            for (shape, way, half) in few {
                let shape = shape % bounds.len();
                let way = DVec3::from_array(*way);
                bounds[shape] = Bounds::around(bounds[shape].center() + way, DVec3::splat(*half));
                moved.push((leaf_of(&built, shape), bounds[shape]));
            }
            // For each shape, its last move counts.
            let inside = moved.iter().all(|(_, bounds)| built.tree.frame.bounds(bounds).is_inside());
            let before = refitter.cost();
            let kept = refitter.refit(&mut built.tree, moved);
            if inside {
                built.check(&bounds);
                let fresh = Refitter::new(&built.tree, bounds.len()).cost();
                let off = (refitter.cost() - fresh).abs();
                prop_assert!(off <= 1e-5 * (fresh + before), "{} and {fresh}", refitter.cost());
            } else {
                prop_assert!(!kept, "a shape has left the frame");
                built = Built::over(&bounds, &mut Builder::default());
                refitter = Refitter::new(&built.tree, bounds.len());
            }
        }
    }
}
