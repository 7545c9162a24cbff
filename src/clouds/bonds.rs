//! Bonds between the particles of a frame: those of the file, and those found by distance.
//!
//! Two atoms are bonded if they are more than 0.4 and less than the sum of their covalent radii plus 0.45 angstroms apart, the rule of Jmol,
//! Open Babel and OEChem after E. C. Meng and R. A. Lewis, Journal of Computational Chemistry 12, 891 (1991).
//!
//! Pairs are found in a grid of cells, each as wide as the longest bond, so that the ends of a bond are in the same cell or in neighbours. The
//! grid is a list of the particles, sorted by cell: cells without particles take no memory, however far apart the others are.

use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::columns::{FrameColumns, NearestImage};
use super::error::{CloudError, CloudPart};
use super::mapping::{ELEMENT, by_element};
use crate::color::Rgb;
use crate::trajectory::Snapshot;

/// The rods between bonded particles.
#[derive(Clone, Debug, PartialEq)]
pub struct BondSettings {
    /// The radius of the rods.
    pub radius: f64,
    /// The colour of all rods, linear; `None` if they have those of their particles.
    pub color: Option<Rgb>,
    /// The distance below which particles are bonded; `None` for the bonds of the file and, by their elements, of atoms.
    pub distance: Option<f64>,
}

/// By how much a bond may be longer than the sum of the covalent radii, in angstroms.
const TOLERANCE: f64 = 0.45;

/// The distance up to which atoms count as two places of the same one, in angstroms.
const TOO_CLOSE: f64 = 0.4;

/// Maximum number of distances that are computed per particle, on average. In molecules and crystals it is below 200; beyond, lengths are
/// surely not in the expected unit.
const MOST_DISTANCES: usize = 2000;

/// Maximum number of bonds per particle, on average; in molecules and crystals it is below 8.
const MOST_BONDS: usize = 32;

/// The greatest distance of bonded particles.
enum Reach {
    All(f64),
    /// The sum of these radii, of one for each particle, plus [`TOLERANCE`].
    Radii(Vec<f64>),
}

/// Returns the pairs of particles of a frame that are bonded, by row, each with the smaller row first, in order. Pairs through a side of a
/// periodic cell are left out.
pub(super) fn bonds_of(snapshot: &Snapshot, distance: Option<f64>) -> Result<Vec<[u32; 2]>, CloudError> {
    let columns = FrameColumns::of(snapshot);
    let positions = columns.positions(None)?;
    let Some(distance) = distance else {
        let images = snapshot.cell.as_ref().and_then(NearestImage::of);
        let is_direct = |pair: &&[u32; 2]| {
            let [one, other] = pair.map(|row| positions.get(row as usize));
            let way = one.zip(other).map(|(one, other)| *other - *one);
            way.is_some_and(|way| images.as_ref().is_none_or(|images| images.nearest(way) == way))
        };
        let mut listed: Vec<[u32; 2]> = snapshot.bonds.iter().filter(is_direct).copied().collect();
        // Files of proteins list the bonds of ligands alone. Jmol's rule: those of at least half the atoms are all.
        if snapshot.bonds.len() * 2 < snapshot.count {
            if !columns.has(ELEMENT) {
                return match listed.is_empty() {
                    true => Err(CloudError::new(
                        CloudPart::Bonds,
                        format!("the data has no bonds, and no column `{ELEMENT}` to find them by"),
                        "write the distance below which particles are bonded, as `distance: 1.5`",
                    )),
                    false => Ok(listed),
                };
            }
            let radii = by_element(&columns, &CloudPart::Bonds, |element| element.covalent)?;
            listed.extend(found(&positions, &Reach::Radii(radii))?);
            listed.par_sort_unstable();
            listed.dedup();
        }
        return Ok(listed);
    };
    found(&positions, &Reach::All(distance))
}

impl Reach {
    /// Returns an upper bound of all distances.
    fn longest(&self) -> f64 {
        match self {
            Self::All(distance) => *distance,
            Self::Radii(radii) => 2.0 * radii.iter().copied().fold(0.0, f64::max) + TOLERANCE,
        }
    }

    /// Returns whether the particles of two rows at this squared distance are bonded.
    fn joins(&self, one: u32, other: u32, square: f64) -> bool {
        match self {
            Self::All(distance) => square < distance * distance,
            Self::Radii(radii) => {
                let reach = radii[one as usize] + radii[other as usize] + TOLERANCE;
                square < reach * reach && square > TOO_CLOSE * TOO_CLOSE
            }
        }
    }
}

/// A cell of the grid: its place along z, y and x.
type GridCell = [i64; 3];

/// The index of a particle, after its cell.
type InCell = (GridCell, u32);

/// Returns all pairs within reach.
fn found(positions: &[DVec3], reach: &Reach) -> Result<Vec<[u32; 2]>, CloudError> {
    // Wider by more than the rounding of places in the grid.
    let width = reach.longest() * 1.001;
    let finite = positions.iter().filter(|position| position.is_finite());
    let least = finite.fold(DVec3::INFINITY, |least, position| least.min(*position));
    #[expect(clippy::cast_possible_truncation, reason = "saturates, which keeps neighbours")]
    let key = |position: DVec3| ((position - least) / width).to_array().map(|place| place.floor() as i64);
    let placed = |(row, position): (usize, &DVec3)| {
        let [x, y, z] = key(*position);
        Some(([z, y, x], u32::try_from(row).ok()?)).filter(|_| position.is_finite())
    };
    let mut grid: Vec<InCell> = positions.par_iter().enumerate().filter_map(placed).collect();
    grid.par_sort_unstable();
    let starts: Vec<usize> =
        (0..grid.len()).filter(|place| *place == 0 || grid[*place - 1].0 != grid[*place].0).collect();
    let tried: usize = starts.par_iter().map(|start| distances(&grid, *start)).sum();
    let count = AtomicUsize::new(0);
    let too_many = || {
        CloudError::new(
            CloudPart::Bonds,
            "the particles are too close to each other to tell bonds by their distance",
            "write a smaller `distance`; without one, lengths are in angstroms",
        )
    };
    let [most_tried, most_found] =
        [MOST_DISTANCES, MOST_BONDS].map(|each| each.saturating_mul(positions.len()));
    if tried > most_tried {
        return Err(too_many());
    }
    let of_cell = |start: &usize| {
        let mut pairs = Vec::new();
        let (own, others) = neighbours(&grid, *start);
        for (index, (_, one)) in own.iter().enumerate() {
            let rest = own[index + 1..].iter().chain(others.iter().copied().flatten());
            for (_, other) in rest {
                let square = positions[*one as usize].distance_squared(positions[*other as usize]);
                if reach.joins(*one, *other, square) {
                    pairs.push([*one.min(other), *one.max(other)]);
                }
            }
        }
        let is_few = count.fetch_add(pairs.len(), Ordering::Relaxed) + pairs.len() <= most_found;
        is_few.then_some(pairs)
    };
    let pairs: Option<Vec<Vec<[u32; 2]>>> = starts.par_iter().map(of_cell).collect();
    let mut pairs = pairs.ok_or_else(too_many)?.concat();
    pairs.par_sort_unstable();
    Ok(pairs)
}

/// Returns the particles of the cell that starts here, and those of the neighbours after it, in runs along x.
fn neighbours(grid: &[InCell], start: usize) -> (&[InCell], [&[InCell]; 5]) {
    let cell @ [z, y, x] = grid[start].0;
    let next = |place: i64| place.saturating_add(1);
    let before = |key: GridCell| grid[start..].partition_point(|(own, _)| *own < key) + start;
    let after = |key: GridCell| grid[start..].partition_point(|(own, _)| *own <= key) + start;
    let end = after(cell);
    // A saturated place is its own neighbour.
    let row = |z: i64, y: i64| {
        let row = before([z, y, x - 1]).max(end)..after([z, y, next(x)]).max(end);
        &grid[row]
    };
    let others = [
        &grid[end..after([z, y, next(x)])],
        if next(y) > y { row(z, next(y)) } else { &[] },
        if next(z) > z { row(next(z), y - 1) } else { &[] },
        if next(z) > z { row(next(z), y) } else { &[] },
        if next(z) > z && next(y) > y { row(next(z), next(y)) } else { &[] },
    ];
    (&grid[start..end], others)
}

/// Returns the number of distances that are computed for the cell that starts here.
fn distances(grid: &[InCell], start: usize) -> usize {
    let (own, others) = neighbours(grid, start);
    own.len() * (own.len() / 2 + others.iter().map(|run| run.len()).sum::<usize>())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::trajectory::{Cell, Column, Values};

    fn snapshot(elements: &[&str], places: &[[f64; 3]]) -> Snapshot {
        let axis = |axis: usize| Values::Numbers(places.iter().map(|place| place[axis]).collect());
        let columns = ["x", "y", "z"].into_iter().zip([axis(0), axis(1), axis(2)]);
        let mut columns: Vec<Column> =
            columns.map(|(name, values)| Column { name: name.to_owned(), values }).collect();
        if !elements.is_empty() {
            let names = elements.iter().map(|name| (*name).to_owned()).collect();
            let values = Values::Labels { labels: (0..).take(elements.len()).collect(), names };
            columns.push(Column { name: ELEMENT.to_owned(), values });
        }
        Snapshot { count: places.len(), columns, ..Snapshot::default() }
    }

    const WATER: [[f64; 3]; 3] = [[0.0, 0.0, 0.117], [0.0, 0.757, -0.469], [0.0, -0.757, -0.469]];

    #[test]
    fn atoms_are_bonded_by_their_covalent_radii() {
        assert_eq!(bonds_of(&snapshot(&["O", "H", "H"], &WATER), None).unwrap(), [[0, 1], [0, 2]]);
        // Ethanol: C C O, three hydrogens at the first carbon, two at the second, one at the oxygen.
        let ethanol = [
            [-1.1879, -0.3829, 0.0],
            [0.0, 0.5526, 0.0],
            [1.1867, -0.2472, 0.0],
            [-2.1146, 0.1970, 0.0],
            [-1.1659, -1.0215, 0.8874],
            [-1.1659, -1.0215, -0.8874],
            [0.0227, 1.1958, 0.8874],
            [0.0227, 1.1958, -0.8874],
            [1.9422, 0.3446, 0.0],
        ];
        let elements = ["C", "C", "O", "H", "H", "H", "H", "H", "H"];
        let bonds = bonds_of(&snapshot(&elements, &ethanol), None).unwrap();
        assert_eq!(bonds, [[0, 1], [0, 3], [0, 4], [0, 5], [1, 2], [1, 6], [1, 7], [2, 8]]);
        // Two places of one atom are not bonded.
        assert_eq!(
            bonds_of(&snapshot(&["C", "C"], &[[0.0; 3], [0.3, 0.0, 0.0]]), None).unwrap(),
            [[0; 2]; 0]
        );
    }

    #[test]
    fn bonds_of_the_file_come_first() {
        let mut water = snapshot(&["O", "H", "H"], &WATER);
        // As many as half the atoms: all that there are, however long.
        water.bonds = vec![[0, 1], [1, 2]];
        assert_eq!(bonds_of(&water, None).unwrap(), [[0, 1], [1, 2]]);
        // Fewer: those of a ligand, say.
        water.bonds = vec![[1, 2]];
        assert_eq!(bonds_of(&water, None).unwrap(), [[0, 1], [0, 2], [1, 2]]);
        // A distance in their place.
        assert_eq!(bonds_of(&water, Some(0.9)).unwrap(), [[0; 2]; 0]);
        assert_eq!(bonds_of(&water, Some(2.0)).unwrap(), [[0, 1], [0, 2], [1, 2]]);
    }

    #[test]
    fn bonds_through_sides_of_the_cell_are_left_out() {
        let mut pair = snapshot(&[], &[[0.5, 5.0, 5.0], [9.5, 5.0, 5.0], [1.5, 5.0, 5.0]]);
        pair.bonds = vec![[0, 1], [0, 2]];
        assert_eq!(bonds_of(&pair, None).unwrap(), [[0, 1], [0, 2]]);
        let edges = [DVec3::X * 10.0, DVec3::Y * 10.0, DVec3::Z * 10.0];
        pair.cell = Some(Cell { origin: DVec3::ZERO, edges, periodic: [true; 3] });
        assert_eq!(bonds_of(&pair, None).unwrap(), [[0, 2]]);
        assert_eq!(bonds_of(&pair, Some(1.5)).unwrap(), [[0, 2]]);
    }

    #[test]
    fn what_cannot_be_bonded_is_an_error() {
        let error = bonds_of(&snapshot(&[], &WATER), None).unwrap_err();
        assert!(error.message.contains("no bonds") && error.help.contains("distance: 1.5"), "{error}");
        let error = bonds_of(&snapshot(&["O", "Qq", "H"], &WATER), None).unwrap_err();
        assert!(error.message.contains("\"Qq\""), "{error}");
        // All at one place: neither a hang nor a bond.
        let crowd = snapshot(&[], &vec![[1.0; 3]; 20_000]);
        assert!(bonds_of(&crowd, Some(1.0)).unwrap_err().message.contains("too close"));
    }

    proptest! {
        #[test]
        fn the_grid_finds_what_all_pairs_have(
            places in prop::collection::vec([-3.0..3.0, -3.0..3.0, -3.0..3.0], 0..120),
            far in prop::option::of(prop::sample::select(vec![1e9, 1e30, f64::MAX, f64::NAN])),
            distance in 0.3..1.5,
            shift in -1e6..1e6,
        ) {
            let mut places: Vec<DVec3> = places.into_iter().map(|place| DVec3::from_array(place) + shift).collect();
            places.extend(far.into_iter().flat_map(|far| [DVec3::splat(far), DVec3::new(0.0, -far, 0.0)]));
            let radii = (0..places.len()).map(|row| if row % 3 == 0 { 0.1 } else { 0.4 }).collect();
            for reach in [Reach::All(distance), Reach::Radii(radii)] {
                let rows = 0..u32::try_from(places.len()).unwrap();
                let pairs = rows.clone().flat_map(|one| rows.clone().skip(one as usize + 1).map(move |other| [one, other]));
                let is_bonded = |[one, other]: &[u32; 2]| {
                    reach.joins(*one, *other, places[*one as usize].distance_squared(places[*other as usize]))
                };
                let all: Vec<[u32; 2]> = pairs.filter(is_bonded).collect();
                if all.len() < places.len() * MOST_BONDS {
                    prop_assert_eq!(found(&places, &reach).unwrap(), all);
                }
            }
        }
    }
}
