//! Sorting of boxes along a space-filling curve: neighbours on the curve are mostly neighbours in space.
//!
//! The curve is the Morton curve through the cells of a cube that is halved repeatedly. If many boxes share a single cell, as when all but
//! one are in a corner, the cell is subdivided as a cube of its own.

use rayon::prelude::*;

use crate::trace::bvh::frame::FrameBox;

/// Sorts boxes, given by their indices, along the curve into consecutive cells of at most `most` boxes each. Returns the ends of the cells
/// in that order, ascending.
pub(super) fn divide(boxes: &[FrameBox], order: &mut [u32], most: usize) -> Vec<usize> {
    let mut ends = Vec::new();
    let mut pending = Vec::from_iter((!order.is_empty()).then_some(0..order.len()));
    while let Some(run) = pending.pop() {
        let members = &mut order[run.clone()];
        if members.len() <= most {
            ends.push(run.end);
            continue;
        }
        let Some(grid) = Grid::around(boxes, members, levels(members.len())) else {
            ends.extend(run.clone().skip(most).step_by(most).chain([run.end]));
            continue;
        };
        let starts = sort_by_counting(&grid, boxes, members);
        let mut halves = Vec::from_iter(Some(0..starts.len() - 1));
        while let Some(cells) = halves.pop() {
            let (start, end) = (starts[cells.start] as usize, starts[cells.end] as usize);
            let middle = cells.start.midpoint(cells.end);
            match end - start {
                0 => {}
                count if count <= most => ends.push(run.start + end),
                _ if cells.len() == 1 => pending.push(run.start + start..run.start + end),
                _ => halves.extend([middle..cells.end, cells.start..middle]),
            }
        }
    }
    ends.sort_unstable();
    ends
}

/// Returns the number of halvings of a cube around `count` boxes that leaves some dozens in a cell.
fn levels(count: usize) -> u32 {
    const HALVINGS_IN_A_CELL: u32 = 5;
    (count.ilog2().saturating_sub(HALVINGS_IN_A_CELL) / 3).clamp(1, 6)
}

/// Sorts boxes by their cells. Returns the start of each cell, and the end of the last one.
fn sort_by_counting(grid: &Grid, boxes: &[FrameBox], order: &mut [u32]) -> Vec<u32> {
    let cell = |index: &u32| grid.cell(boxes[*index as usize].center());
    let members: Vec<(usize, u32)> =
        order.par_iter().map(|index| (usize::try_from(cell(index)).unwrap_or(usize::MAX), *index)).collect();
    let mut starts = vec![0; (1 << (3 * grid.levels)) + 1];
    for (cell, _) in &members {
        starts[cell + 1] += 1;
    }
    let mut total = 0;
    for start in &mut starts {
        total += *start;
        *start = total;
    }
    let mut next = starts.clone();
    for (cell, index) in members {
        order[next[cell] as usize] = index;
        next[cell] += 1;
    }
    starts
}

/// Sorts a few boxes, given by their indices, along the curve. `keys` is scratch memory.
#[expect(clippy::cast_possible_truncation, reason = "the lower bits are an index")]
pub(super) fn sort(boxes: &[FrameBox], order: &mut [u32], keys: &mut Vec<u64>) {
    /// Maximum number of boxes in a cell that is not subdivided as a cube of its own.
    const FEW: usize = 16;
    let index_bits = u64::BITS - (boxes.len() as u64).leading_zeros();
    let Some(grid) = Grid::around(boxes, order, ((u64::BITS - index_bits) / 3).min(Grid::MOST_LEVELS)) else {
        return;
    };
    let key = |index: &u32| grid.cell(boxes[*index as usize].center()) << index_bits | u64::from(*index);
    keys.clear();
    keys.extend(order.iter().map(key));
    keys.sort_unstable();
    for (place, key) in order.iter_mut().zip(&*keys) {
        *place = (key & ((1 << index_bits) - 1)) as u32;
    }
    let mut end = 0;
    let runs = keys.chunk_by(|one, next| one >> index_bits == next >> index_bits).map(|run| {
        end += run.len();
        end - run.len()..end
    });
    let pending: Vec<_> = runs.filter(|run| run.len() > FEW).collect();
    for run in pending {
        sort(boxes, &mut order[run], keys);
    }
}

/// A cube of cells, 2^`levels` along each edge.
struct Grid {
    origin: [f32; 3],
    cells_a_unit: f32,
    levels: u32,
}

impl Grid {
    /// Maximum number of levels, as a cell's number has three bits per level.
    const MOST_LEVELS: u32 = 21;

    /// Creates a cube around the centres of boxes; `None` if all centres coincide.
    #[expect(clippy::cast_precision_loss, reason = "a power of two")]
    fn around(boxes: &[FrameBox], order: &[u32], levels: u32) -> Option<Self> {
        let all = order.iter().fold(FrameBox::EMPTY, |all, index| {
            let center = boxes[*index as usize].center();
            all.union(&FrameBox { min: center, max: center })
        });
        let edge = (0..3).map(|axis| all.max[axis] - all.min[axis]).fold(0.0, f32::max);
        // Slightly less than the number of cells, so that the index of the last one stays below it.
        let cells = (1_u32 << levels) as f32 * (1.0 - f32::EPSILON);
        let cells_a_unit = cells / edge;
        cells_a_unit.is_finite().then_some(Self { origin: all.min, cells_a_unit, levels })
    }

    /// Returns the number, along the curve, of the cell that contains a point.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the cube")]
    fn cell(&self, place: [f32; 3]) -> u64 {
        let [x, y, z] = std::array::from_fn(|axis| {
            spread(((place[axis] - self.origin[axis]) * self.cells_a_unit) as u32)
        });
        x << 2 | y << 1 | z
    }
}

/// Inserts two zero bits between adjacent bits of the lowest 21 bits.
fn spread(number: u32) -> u64 {
    let mut bits = u64::from(number) & 0x001f_ffff;
    bits = (bits | bits << 32) & 0x001f_0000_0000_ffff;
    bits = (bits | bits << 16) & 0x001f_0000_ff00_00ff;
    bits = (bits | bits << 8) & 0x100f_00f0_0f00_f00f;
    bits = (bits | bits << 4) & 0x10c3_0c30_c30c_30c3;
    (bits | bits << 2) & 0x1249_2492_4924_9249
}
