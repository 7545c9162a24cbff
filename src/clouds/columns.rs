//! The columns of a moment: of one frame of a file, or of the values between two frames.

use std::borrow::Cow;
use std::collections::HashMap;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::error::{CloudError, CloudPart};
use crate::trajectory::{Cell, Snapshot, Values};

/// The columns of a moment. Particles are those of the earlier frame, in its order.
#[derive(Debug)]
pub(super) struct FrameColumns<'a> {
    earlier: &'a Snapshot,
    later: Option<Later<'a>>,
}

/// The later of two frames.
#[derive(Debug)]
struct Later<'a> {
    snapshot: &'a Snapshot,
    /// The share of its values, between 0 and 1.
    share: f64,
    /// The row of each particle in it, [`NO_PARTNER`] without one; `None` if rows are the same in both frames.
    partners: Option<Vec<u32>>,
}

/// The row of particles that are in the earlier frame alone, which keep its values.
const NO_PARTNER: u32 = u32::MAX;

/// The columns whose values tell particles apart, and are those of the earlier frame.
const NOT_BLENDED: [&str; 2] = ["id", "type"];

/// A column of either kind.
pub(super) enum ColumnValues<'a> {
    Numbers(Cow<'a, [f64]>),
    Labels(&'a [u32], &'a [String]),
}

impl<'a> FrameColumns<'a> {
    /// Returns the columns of a frame.
    pub(super) fn of(snapshot: &'a Snapshot) -> Self {
        Self { earlier: snapshot, later: None }
    }

    /// Returns the columns between two frames, `share` of the way to the later one. Particles are matched by the column `id` if both frames
    /// have it, or else by their order.
    pub(super) fn between(
        earlier: &'a Snapshot,
        later: &'a Snapshot,
        share: f64,
    ) -> Result<Self, CloudError> {
        let ids = |snapshot: &'a Snapshot| match snapshot.column("id") {
            Some(Values::Numbers(ids)) => Some(ids),
            _ => None,
        };
        let partners = match (ids(earlier), ids(later)) {
            (Some(own), Some(other)) if own == other => None,
            (Some(own), Some(other)) => {
                let rows: HashMap<u64, u32> = other.iter().map(|id| id.to_bits()).zip(0..).collect();
                let row = |id: &f64| rows.get(&id.to_bits()).copied().unwrap_or(NO_PARTNER);
                Some(own.par_iter().map(row).collect())
            }
            _ if earlier.count == later.count => None,
            _ => {
                let (before, after) = (earlier.count, later.count);
                return Err(CloudError::new(
                    CloudPart::Frames,
                    format!(
                        "a frame with {before} particles is followed by one with {after}, and no ids say which is which"
                    ),
                    "write `between: Hold`, or add a column `id` to the file",
                ));
            }
        };
        Ok(Self { earlier, later: Some(Later { snapshot: later, share, partners }) })
    }

    /// Returns the number of particles.
    pub(super) fn count(&self) -> usize {
        self.earlier.count
    }

    /// Returns whether there is a column.
    pub(super) fn has(&self, name: &str) -> bool {
        self.earlier.column(name).is_some()
    }

    /// Returns the periodic cell, in proportion between those of both frames.
    pub(super) fn cell(&self) -> Option<Cell> {
        let own = self.earlier.cell?;
        let Some(Later { snapshot, share, .. }) = &self.later else { return Some(own) };
        let Some(other) = snapshot.cell else { return Some(own) };
        let [a, b, c] = [0, 1, 2].map(|axis| own.edges[axis].lerp(other.edges[axis], *share));
        Some(Cell { origin: own.origin.lerp(other.origin, *share), edges: [a, b, c], ..own })
    }

    /// Returns a column. An error names those that there are.
    pub(super) fn column(&self, name: &str, part: &CloudPart) -> Result<ColumnValues<'_>, CloudError> {
        match self.earlier.column(name) {
            Some(Values::Labels { labels, names }) => Ok(ColumnValues::Labels(labels, names)),
            Some(Values::Numbers(own)) => Ok(ColumnValues::Numbers(self.blended(name, own))),
            None => Err(lacking(self.earlier, name, part)),
        }
    }

    /// Returns a column of numbers.
    pub(super) fn numbers(&self, name: &str, part: &CloudPart) -> Result<Cow<'_, [f64]>, CloudError> {
        match self.column(name, part)? {
            ColumnValues::Numbers(numbers) => Ok(numbers),
            ColumnValues::Labels(..) => Err(of_words(name, part)),
        }
    }

    fn blended<'b>(&'b self, name: &str, own: &'b [f64]) -> Cow<'b, [f64]> {
        let Some(Later { snapshot, share, partners }) = &self.later else { return Cow::Borrowed(own) };
        let Some(Values::Numbers(other)) = snapshot.column(name) else { return Cow::Borrowed(own) };
        if NOT_BLENDED.contains(&name) {
            return Cow::Borrowed(own);
        }
        let blend = |(row, own): (usize, &f64)| {
            let partner = partner_of(partners.as_deref(), row).and_then(|row| other.get(row));
            partner.map_or(*own, |other| own + share * (other - own))
        };
        Cow::Owned(own.par_iter().enumerate().map(blend).collect())
    }

    /// Returns the positions of the particles in these rows, or of all.
    pub(super) fn positions(&self, rows: Option<&[u32]>) -> Result<Vec<DVec3>, CloudError> {
        let earlier = axes(self.earlier)?;
        let at = |axes: [&[f64]; 3], row: usize| DVec3::from_array(axes.map(|axis| axis[row]));
        let later = match &self.later {
            Some(later) => Some((later, axes(later.snapshot)?)),
            None => None,
        };
        let images = self.earlier.cell.as_ref().and_then(NearestImage::of);
        let place = |row: usize| {
            let own = at(earlier, row);
            let Some((Later { share, partners, .. }, axes)) = &later else { return own };
            let Some(partner) = partner_of(partners.as_deref(), row) else { return own };
            let way = at(*axes, partner) - own;
            own + *share * images.as_ref().map_or(way, |images| images.nearest(way))
        };
        Ok(picked(rows, self.count(), place))
    }
}

/// Returns the values in these rows, or in all `count`.
pub(super) fn picked<T: Send>(
    rows: Option<&[u32]>,
    count: usize,
    value: impl Fn(usize) -> T + Sync + Send,
) -> Vec<T> {
    match rows {
        None => (0..count).into_par_iter().map(value).collect(),
        Some(rows) => rows.par_iter().map(|row| value(*row as usize)).collect(),
    }
}

fn partner_of(partners: Option<&[u32]>, row: usize) -> Option<usize> {
    match partners {
        None => Some(row),
        Some(partners) => Some(partners[row]).filter(|row| *row != NO_PARTNER).map(|row| row as usize),
    }
}

/// Returns the error for a column that is not there. It names those that there are.
fn lacking(snapshot: &Snapshot, name: &str, part: &CloudPart) -> CloudError {
    /// The number of columns that are listed at most.
    const MOST: usize = 24;
    let columns = &snapshot.columns;
    let mut names: Vec<String> =
        columns.iter().take(MOST).map(|column| format!("`{}`", column.name)).collect();
    names.extend((columns.len() > MOST).then(|| "..".to_owned()));
    let message = format!("the data has no column `{name}`");
    CloudError::new(part.clone(), message, format!("its columns are {}", names.join(", ")))
}

/// Returns the error for a column of words in place of numbers.
fn of_words(name: &str, part: &CloudPart) -> CloudError {
    let message = format!("the column `{name}` holds words, not numbers");
    CloudError::new(part.clone(), message, "name a column of numbers")
}

fn axes(snapshot: &Snapshot) -> Result<[&[f64]; 3], CloudError> {
    let axis = |name: &str| match snapshot.column(name) {
        Some(Values::Numbers(axis)) if axis.len() == snapshot.count => Ok(axis.as_slice()),
        Some(Values::Numbers(_)) => {
            let message = format!("the column `{name}` is too short");
            Err(CloudError::new(CloudPart::Source, message, "write one value for each particle"))
        }
        Some(Values::Labels { .. }) => Err(of_words(name, &CloudPart::Source)),
        None => Err(lacking(snapshot, name, &CloudPart::Source)),
    };
    Ok([axis("x")?, axis("y")?, axis("z")?])
}

/// The displacements that are shortest among the periodic images of a cell (minimum image convention).
pub(super) struct NearestImage {
    /// The edges, as columns.
    edges: DMat3,
    /// From a displacement to multiples of the edges.
    multiples: DMat3,
    /// 1 for periodic edges, 0 for the others.
    periodic: DVec3,
}

impl NearestImage {
    /// Returns `None` for a cell without periodic edges, and for a flat one.
    pub(super) fn of(cell: &Cell) -> Option<Self> {
        let [a, b, c] = std::array::from_fn(|axis| {
            let (edge, others) = (cell.edges[axis], [1, 2].map(|step| cell.edges[(axis + step) % 3]));
            // Edges without a period may be missing; any other direction takes their place.
            let is_missing = edge == DVec3::ZERO && !cell.periodic[axis];
            if is_missing {
                others[0].cross(others[1]).normalize_or(others[0].any_orthogonal_vector())
            } else {
                edge
            }
        });
        let edges = DMat3::from_cols(a, b, c);
        let multiples = edges.inverse();
        let periodic = DVec3::from_array(cell.periodic.map(|periodic| f64::from(u8::from(periodic))));
        let is_flat = edges.determinant() == 0.0 || !multiples.is_finite();
        (!is_flat && periodic != DVec3::ZERO).then_some(Self { edges, multiples, periodic })
    }

    pub(super) fn nearest(&self, way: DVec3) -> DVec3 {
        let turns = (self.multiples * way).round() * self.periodic;
        // Without a turn the displacement stays exact.
        if turns == DVec3::ZERO || !turns.is_finite() { way } else { way - self.edges * turns }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::Column;

    fn snapshot(rows: &[(f64, [f64; 3])]) -> Snapshot {
        let column =
            |name: &str, values: Vec<f64>| Column { name: name.to_owned(), values: Values::Numbers(values) };
        let axis = |axis: usize| rows.iter().map(|(_, place)| place[axis]).collect();
        let columns = vec![
            column("id", rows.iter().map(|(id, _)| *id).collect()),
            column("x", axis(0)),
            column("y", axis(1)),
            column("z", axis(2)),
        ];
        Snapshot { count: rows.len(), columns, ..Snapshot::default() }
    }

    #[test]
    fn particles_are_matched_by_id_and_take_the_nearest_image() {
        let mut earlier = snapshot(&[(1.0, [9.0, 1.0, 0.0]), (2.0, [5.0, 5.0, 5.0]), (3.0, [7.0, 7.0, 7.0])]);
        let later = snapshot(&[(2.0, [6.0, 5.0, 5.0]), (1.0, [1.0, 9.0, 0.0])]);
        let at = |earlier: &Snapshot, rows: Option<&[u32]>| {
            FrameColumns::between(earlier, &later, 0.25).unwrap().positions(rows).unwrap()
        };
        // Without a cell, the first crosses it; the third is in the earlier frame alone.
        let crossing = DVec3::new(7.0, 3.0, 0.0);
        let others = [DVec3::new(5.25, 5.0, 5.0), DVec3::splat(7.0)];
        assert_eq!(at(&earlier, None), [crossing, others[0], others[1]]);
        let edges = [DVec3::X * 10.0, DVec3::Y * 10.0, DVec3::Z * 10.0];
        earlier.cell = Some(Cell { origin: DVec3::ZERO, edges, periodic: [true, false, true] });
        assert_eq!(at(&earlier, None), [DVec3::new(9.5, 3.0, 0.0), others[0], others[1]]);
        earlier.cell = Some(Cell {
            origin: DVec3::ZERO,
            edges: [edges[0], edges[1], DVec3::ZERO],
            periodic: [true, false, false],
        });
        assert_eq!(at(&earlier, Some(&[0])), [DVec3::new(9.5, 3.0, 0.0)]);
        // A sheared cell: going up one edge also moves along the first one.
        let sheared = [DVec3::X * 10.0, DVec3::new(2.0, 10.0, 0.0), DVec3::Z * 10.0];
        earlier.cell = Some(Cell { origin: DVec3::ZERO, edges: sheared, periodic: [true; 3] });
        assert_eq!(at(&earlier, Some(&[0])), [DVec3::new(9.0, 1.0, 0.0) + 0.25 * DVec3::new(0.0, -2.0, 0.0)]);
    }

    #[test]
    fn counts_must_agree_without_ids() {
        let mut frames = [snapshot(&[(1.0, [0.0; 3])]), snapshot(&[])];
        frames.iter_mut().for_each(|frame| {
            frame.columns.remove(0);
        });
        let error = FrameColumns::between(&frames[0], &frames[1], 0.5).unwrap_err();
        assert!(error.message.contains("1 particles is followed by one with 0"), "{error}");
    }
}
