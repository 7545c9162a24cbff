//! Sizes and colours of particles from their columns.

use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

use rayon::prelude::*;

use super::columns::{ColumnValues, FrameColumns, picked};
use super::elements::{ChemicalElement, colors, element, numbered};
use super::error::{CloudError, CloudPart};
use super::palette::{CATEGORIES, ColorMap};
use crate::color::{Transfer, hex_channels};
use crate::components::CloudColors;

/// The sizes of particles, as factors of the shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScaleBy {
    /// The numbers of a column.
    Column(String),
    /// Van der Waals radii of the elements, in angstroms.
    VanDerWaals,
    /// Covalent radii of the elements, in angstroms.
    Covalent,
}

/// The colours of particles.
#[derive(Clone, Debug, PartialEq)]
pub enum ColorBy {
    /// The numbers of a column, by a colour map.
    Map {
        /// The column.
        column: String,
        /// The colours.
        map: ColorMap,
        /// The numbers with the first and the last colour; `None` for the least and the greatest of the first frame.
        range: Option<(f64, f64)>,
    },
    /// The elements.
    Element,
    /// The labels or whole numbers of a column.
    Category(String),
}

/// Facts of the first frame of a file that the colours of all frames depend on.
#[derive(Clone, Debug, Default)]
pub(super) struct FirstFrame {
    /// The least and the greatest number of the mapped column.
    range: (f64, f64),
    /// The labels of the categories, in order.
    labels: HashMap<String, usize>,
}

impl FirstFrame {
    /// Returns the numbers of the first and the last colour of a map.
    pub(super) fn range(&self) -> [f64; 2] {
        [self.range.0, self.range.1]
    }
}

/// The column with the elements.
pub(super) const ELEMENT: &str = "element";

impl ScaleBy {
    /// Returns the factors of all particles.
    pub(super) fn scales<'a>(&self, columns: &'a FrameColumns<'_>) -> Result<Cow<'a, [f64]>, CloudError> {
        let radius: fn(&ChemicalElement) -> f64 = match self {
            Self::Column(name) => {
                return columns.numbers(name, &CloudPart::ScaleBy);
            }
            Self::VanDerWaals => |element| element.van_der_waals,
            Self::Covalent => |element| element.covalent,
        };
        by_element(columns, &CloudPart::ScaleBy, radius).map(Cow::Owned)
    }
}

/// Returns a value for the element of each particle.
pub(super) fn by_element<T: Copy + Send + Sync>(
    columns: &FrameColumns<'_>,
    part: &CloudPart,
    value: impl Fn(&ChemicalElement) -> T + Sync,
) -> Result<Vec<T>, CloudError> {
    let unknown = |name: String| {
        let message = format!("there is no chemical element {name}");
        let help = format!(
            "correct the column `{ELEMENT}` of the data; for other kinds, write a `shape` and `color_by: Category(\"{ELEMENT}\")`"
        );
        CloudError::new(part.clone(), message, help)
    };
    match columns.column(ELEMENT, part)? {
        ColumnValues::Labels(labels, names) => {
            let known = names.iter().map(|name| element(name).map(&value));
            let known: Vec<Option<T>> = known.collect();
            let of = |label: &u32| {
                let found = known.get(*label as usize).copied().flatten();
                found.ok_or_else(|| {
                    unknown(names.get(*label as usize).map_or_else(String::new, |name| format!("\"{name}\"")))
                })
            };
            labels.par_iter().map(of).collect()
        }
        ColumnValues::Numbers(numbers) => {
            let of = |number: &f64| {
                numbered(*number).map(&value).ok_or_else(|| unknown(format!("number {number}")))
            };
            numbers.par_iter().map(of).collect()
        }
    }
}

impl ColorBy {
    /// Returns the facts of the first frame.
    pub(super) fn first_frame(&self, columns: &FrameColumns<'_>) -> Result<FirstFrame, CloudError> {
        let mut first = FirstFrame::default();
        match self {
            Self::Map { column, range, .. } => {
                let numbers = columns.numbers(column, &CloudPart::ColorBy)?;
                let finite = || numbers.iter().copied().filter(|number| number.is_finite());
                let ends =
                    (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
                first.range = range.unwrap_or(ends);
            }
            Self::Element => {
                by_element(columns, &CloudPart::ColorBy, |_| ())?;
            }
            Self::Category(column) => {
                if let ColumnValues::Labels(_, names) = columns.column(column, &CloudPart::ColorBy)? {
                    first.labels = names.iter().cloned().zip(0..).collect();
                }
            }
        }
        Ok(first)
    }

    /// Returns the colours of the particles in these rows, or of all.
    pub(super) fn colors(
        &self,
        columns: &FrameColumns<'_>,
        rows: Option<&[u32]>,
        first: &FirstFrame,
        transfer: Transfer,
    ) -> Result<CloudColors, CloudError> {
        let decoded = |colors: &[[f64; 3]]| colors.iter().map(|color| transfer.decode(*color)).collect();
        let part = &CloudPart::ColorBy;
        let (palette, indices): (Vec<_>, Vec<u16>) = match self {
            Self::Map { column, map, .. } => {
                let colors = map.colors();
                let numbers = columns.numbers(column, part)?;
                let (least, greatest) = first.range;
                let step = |number: f64| map_step(number, least, greatest, colors.len());
                (decoded(colors), picked(rows, columns.count(), |row| step(numbers[row])))
            }
            Self::Element => {
                let elements = by_element(columns, part, |element| element.index)?;
                let colors: Vec<[f64; 3]> = colors().collect();
                (decoded(&colors), picked(rows, columns.count(), |row| elements[row]))
            }
            Self::Category(column) => {
                let colors: Vec<[f64; 3]> =
                    CATEGORIES.iter().filter_map(|color| hex_channels(color)).collect();
                let wrapped = |index: usize| u16::try_from(index % CATEGORIES.len()).unwrap_or(0);
                let indices = match columns.column(column, part)? {
                    ColumnValues::Labels(labels, names) => {
                        // A label that the first frame lacks has a color by its letters, whichever frame brings it.
                        let letters = |name: &str| name.bytes().map(usize::from).sum();
                        let of_name = |name: &String| {
                            wrapped(first.labels.get(name).copied().unwrap_or_else(|| letters(name)))
                        };
                        let of_names: Vec<u16> = names.iter().map(of_name).collect();
                        picked(rows, columns.count(), |row| {
                            of_names.get(labels[row] as usize).copied().unwrap_or(0)
                        })
                    }
                    ColumnValues::Numbers(numbers) => {
                        picked(rows, columns.count(), |row| category(numbers[row]))
                    }
                };
                (decoded(&colors), indices)
            }
        };
        Ok(CloudColors { palette: Arc::new(palette), indices: Arc::new(indices) })
    }
}

/// Returns the color of a whole number: the first one of 1. Types are usually numbered from there.
#[expect(clippy::cast_possible_truncation, reason = "in range")]
#[expect(clippy::cast_sign_loss, reason = "not negative")]
fn category(number: f64) -> u16 {
    let index = (number.round() - 1.0).rem_euclid(CATEGORIES.len() as f64);
    if index.is_finite() { index as u16 } else { 0 }
}

/// Returns the step of a colour map of `count` colours. Numbers beyond the range, and such that are none, have the colours at its ends.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
#[expect(clippy::cast_precision_loss, reason = "there are few colours")]
fn map_step(number: f64, least: f64, greatest: f64, count: usize) -> u16 {
    let share = (number - least) / (greatest - least);
    let step = (share * count as f64).floor();
    if step > 0.0 { step.min(count as f64 - 1.0) as u16 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_step_evenly_and_end_at_their_ends() {
        let steps = [f64::NEG_INFINITY, -1.0, 0.0, 0.0039, 0.004, 0.5, 0.9999, 1.0, 7.0, f64::NAN];
        let steps = steps.map(|number| map_step(number, 0.0, 1.0, 256));
        assert_eq!(steps, [0, 0, 0, 0, 1, 128, 255, 255, 255, 0]);
        // A range in falling order reverses the map; a single value has the first colour.
        assert_eq!([0.0, 1.0, 0.75].map(|number| map_step(number, 1.0, 0.0, 256)), [255, 0, 64]);
        assert_eq!(map_step(2.0, 2.0, 2.0, 256), 0);
    }

    #[test]
    fn categories_count_from_one() {
        assert_eq!([1.0, 2.0, 20.0, 21.0, 0.0, f64::NAN].map(category), [0, 1, 19, 0, 19, 0]);
    }
}
