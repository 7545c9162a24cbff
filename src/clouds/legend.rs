//! Legends of the colours of a cloud, from the first frame of its file.

use std::collections::BTreeMap;

use super::columns::{ColumnValues, FrameColumns};
use super::elements::numbered;
use super::error::{CloudError, CloudPart};
use super::mapping::{ColorBy, ELEMENT, FirstFrame};
use crate::color::{Rgb, Transfer};
use crate::components::CloudLegend;

/// Maximum number of kinds that are listed.
const MOST_KINDS: usize = 24;

/// Returns the legend of the particles in these rows of the first frame, or of all.
pub(super) fn legend(
    color_by: &ColorBy,
    columns: &FrameColumns<'_>,
    rows: Option<&[u32]>,
    first: &FirstFrame,
    transfer: Transfer,
) -> Result<CloudLegend, CloudError> {
    let name = match color_by {
        ColorBy::Map { column, map, .. } => {
            let colors = map.colors().iter().map(|color| transfer.decode(*color)).collect();
            return Ok(CloudLegend::Ramp { title: column.clone(), colors, range: first.range() });
        }
        ColorBy::Category(column) => column.as_str(),
        ColorBy::Element => ELEMENT,
    };
    let colors = color_by.colors(columns, rows, first, transfer)?;
    let color = |particle: usize| colors.palette[usize::from(colors.indices[particle])];
    let count = rows.map_or(columns.count(), <[u32]>::len);
    let particles =
        (0..count).map(|particle| (particle, rows.map_or(particle, |rows| rows[particle] as usize)));
    let kinds: Vec<(String, Rgb)> = match columns.column(name, &CloudPart::ColorBy)? {
        ColumnValues::Labels(labels, names) => {
            let mut found = vec![None; names.len()];
            for (particle, row) in particles {
                found[labels[row] as usize].get_or_insert_with(|| color(particle));
            }
            names.iter().cloned().zip(found).filter_map(|(name, color)| Some((name, color?))).collect()
        }
        ColumnValues::Numbers(numbers) => {
            let mut found = BTreeMap::new();
            for (particle, row) in particles.filter(|(_, row)| numbers[*row].is_finite()) {
                #[expect(clippy::cast_possible_truncation, reason = "categories are small whole numbers")]
                let number = numbers[row].round() as i64;
                found.entry(number).or_insert_with(|| color(particle));
            }
            let is_element = matches!(color_by, ColorBy::Element);
            let named = |(number, color): (i64, Rgb)| match numbered(number as f64).filter(|_| is_element) {
                Some(element) => (element.symbol.to_owned(), color),
                None => (number.to_string(), color),
            };
            found.into_iter().map(named).collect()
        }
    };
    Ok(CloudLegend::Kinds { title: name.to_owned(), kinds: shortened(kinds) })
}

/// Returns the first kinds of many, and three dots in the colour of the next.
fn shortened(mut kinds: Vec<(String, Rgb)>) -> Vec<(String, Rgb)> {
    if kinds.len() > MOST_KINDS {
        kinds.truncate(MOST_KINDS);
        kinds[MOST_KINDS - 1].0 = "…".to_owned();
    }
    kinds
}
