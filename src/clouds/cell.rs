//! The periodic cell: its edges, and copies of its particles in the cells next to it.

use std::sync::Arc;

use glam::DVec3;

use super::error::{CloudError, CloudPart};
use crate::components::{Cloud, CloudBonds};
use crate::trajectory::Cell;

/// The radius of edges without one, as a share of the longest edge: that of a thin line in a picture of the whole cell.
const THIN: f64 = 1.0 / 400.0;

/// Maximum number of particles with those in copies of the cell. Each takes some 250 bytes while a frame is prepared.
const MOST_PARTICLES: usize = 100_000_000;

/// Returns the edges of a cell as rods, with a particle of their radius at each corner. Directions along which the cell has no extent have
/// none.
pub(super) fn edges(cell: &Cell, radius: Option<f64>) -> Cloud {
    let longest = cell.edges.iter().map(|edge| edge.length()).fold(0.0, f64::max);
    let radius = radius.unwrap_or(longest * THIN);
    let axes: Vec<DVec3> = cell.edges.into_iter().filter(|edge| *edge != DVec3::ZERO).collect();
    let corners = 1_u32 << axes.len();
    let has = |corner: u32, axis: usize| corner & 1 << axis != 0;
    let place = |corner: u32| {
        let along = axes.iter().enumerate().filter(|(axis, _)| has(corner, *axis));
        along.fold(cell.origin, |place, (_, edge)| place + *edge)
    };
    let from = |corner: u32| {
        (0..axes.len()).filter(move |axis| !has(corner, *axis)).map(move |axis| [corner, corner | 1 << axis])
    };
    Cloud {
        positions: Arc::new((0..corners).map(place).collect()),
        scales: Some(Arc::new(vec![radius; corners as usize])),
        bonds: Some(CloudBonds {
            pairs: Arc::new((0..corners).flat_map(from).collect()),
            radius,
            color: None,
        }),
        ..Cloud::default()
    }
}

/// Returns the places of the cells that show `count` particles each, `counts` along each edge: the first is the cell itself.
pub(super) fn images(cell: Option<&Cell>, counts: [u32; 3], count: usize) -> Result<Vec<DVec3>, CloudError> {
    let fail = |message: String, help: &str| Err(CloudError::new(CloudPart::Images, message, help));
    let copies = counts.iter().fold(1, |product: usize, count| product.saturating_mul(*count as usize));
    if copies == 1 {
        return Ok(vec![DVec3::ZERO]);
    }
    let Some(cell) = cell else {
        return fail(
            "the data has no periodic cell".to_owned(),
            "remove `images`, or add the cell to the file",
        );
    };
    let mut along = ["first", "second", "third"].into_iter().zip(cell.edges).zip(counts);
    if let Some(((name, _), _)) = along.find(|((_, edge), count)| *edge == DVec3::ZERO && *count > 1) {
        let message = format!("the cell of the data has no {name} edge");
        return fail(message, "write 1 in its place");
    }
    if count.saturating_mul(copies) > MOST_PARTICLES {
        let message = format!("{copies} cells of {count} particles are more than 100 million");
        return fail(message, "write smaller numbers");
    }
    let [a, b, c] = cell.edges;
    let [across, up, deep] = counts.map(|count| 0..count);
    let rows = deep.flat_map(|k| up.clone().map(move |j| f64::from(j) * b + f64::from(k) * c));
    Ok(rows.flat_map(|row| across.clone().map(move |i| f64::from(i) * a + row)).collect())
}

/// Repeats the particles of a cloud and their bonds at these places. Copies have the numbers of their particles, which come first.
pub(super) fn repeat(cloud: &mut Cloud, images: &[DVec3]) {
    let (count, copies) = (cloud.positions.len(), images.len());
    if copies == 1 {
        return;
    }
    let numbers = || (0..count as u64).collect();
    let numbers = cloud.numbers.as_ref().map_or_else(numbers, |numbers| numbers.to_vec());
    let shifted = images.iter().flat_map(|image| cloud.positions.iter().map(move |place| *place + *image));
    cloud.positions = Arc::new(shifted.collect());
    cloud.numbers = Some(Arc::new(numbers.repeat(copies)));
    if let Some(scales) = &mut cloud.scales {
        *scales = Arc::new(scales.repeat(copies));
    }
    if let Some(colors) = &mut cloud.colors {
        colors.indices = Arc::new(colors.indices.repeat(copies));
    }
    if let Some(bonds) = &mut cloud.bonds {
        let first_rows = (0_u32..).step_by(count.max(1)).take(copies);
        let moved =
            first_rows.flat_map(|first| bonds.pairs.iter().map(move |pair| pair.map(|row| first + row)));
        bonds.pairs = Arc::new(moved.collect());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHEARED: Cell = Cell {
        origin: DVec3::new(1.0, 2.0, 3.0),
        edges: [DVec3::new(4.0, 0.0, 0.0), DVec3::new(1.0, 5.0, 0.0), DVec3::new(0.0, 0.0, 6.0)],
        periodic: [true; 3],
    };

    #[test]
    fn a_cell_has_twelve_edges_and_a_flat_one_four() {
        let cloud = edges(&SHEARED, None);
        let pairs = &cloud.bonds.as_ref().unwrap().pairs;
        assert_eq!((cloud.positions.len(), pairs.len()), (8, 12));
        assert_eq!(cloud.positions[7], DVec3::new(6.0, 7.0, 9.0));
        let mut ways: Vec<DVec3> = pairs
            .iter()
            .map(|[from, to]| cloud.positions[*to as usize] - cloud.positions[*from as usize])
            .collect();
        ways.sort_by(|one, other| one.to_array().partial_cmp(&other.to_array()).unwrap());
        assert!(
            ways.chunks(4)
                .zip([2, 1, 0])
                .all(|(ways, axis)| ways.iter().all(|way| *way == SHEARED.edges[axis]))
        );
        assert_eq!(cloud.bonds.unwrap().radius, 6.0 / 400.0);
        let flat = Cell { edges: [DVec3::X, DVec3::Y, DVec3::ZERO], ..SHEARED };
        let cloud = edges(&flat, Some(0.25));
        assert_eq!((cloud.positions.len(), cloud.bonds.unwrap().pairs.len()), (4, 4));
        assert_eq!(*cloud.scales.unwrap(), [0.25; 4]);
    }

    #[test]
    fn images_repeat_all_columns() {
        let mut cloud = Cloud {
            positions: Arc::new(vec![DVec3::ZERO, DVec3::ONE]),
            scales: Some(Arc::new(vec![1.0, 2.0])),
            bonds: Some(CloudBonds { pairs: Arc::new(vec![[0, 1]]), radius: 0.1, color: None }),
            ..Cloud::default()
        };
        repeat(&mut cloud, &images(Some(&SHEARED), [2, 1, 3], 2).unwrap());
        assert_eq!(cloud.positions.len(), 12);
        assert_eq!(
            cloud.positions[..4],
            [DVec3::ZERO, DVec3::ONE, SHEARED.edges[0], DVec3::ONE + SHEARED.edges[0]]
        );
        assert_eq!(cloud.positions[11], DVec3::ONE + SHEARED.edges[0] + 2.0 * SHEARED.edges[2]);
        assert_eq!(cloud.bonds.as_ref().unwrap().pairs[5], [10, 11]);
        assert_eq!((cloud.number(11), cloud.position(1)), (1, Some(DVec3::ONE)));
        assert_eq!(cloud.scales.as_ref().unwrap()[9], 2.0);
    }

    #[test]
    fn images_need_a_cell_with_these_edges() {
        let flat = Cell { edges: [DVec3::X, DVec3::Y, DVec3::ZERO], ..SHEARED };
        let message = |cell: Option<&Cell>, counts| images(cell, counts, 2).unwrap_err().message;
        assert_eq!(message(None, [1, 2, 1]), "the data has no periodic cell");
        assert_eq!(message(Some(&flat), [1, 1, 2]), "the cell of the data has no third edge");
        let message = message(Some(&SHEARED), [100_000, 1000, 1]);
        assert_eq!(message, "100000000 cells of 2 particles are more than 100 million");
        assert_eq!(images(None, [1; 3], 2), Ok(vec![DVec3::ZERO]));
    }
}
