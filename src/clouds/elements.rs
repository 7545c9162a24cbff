//! Radii and colours of the chemical elements.

use std::sync::LazyLock;

use crate::color::hex_channels;

/// A chemical element.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChemicalElement {
    pub(super) symbol: &'static str,
    /// The index in the table: the atomic number less 1.
    pub(super) index: u16,
    /// Both radii in angstroms.
    pub(super) covalent: f64,
    pub(super) van_der_waals: f64,
    /// The colour as in scene files.
    pub(super) color: [f64; 3],
}

/// The radius of elements for which none is known, in angstroms.
const UNKNOWN_RADIUS: f64 = 2.0;

static ELEMENTS: LazyLock<Vec<ChemicalElement>> = LazyLock::new(|| {
    let rows = include_str!("elements.txt").lines().filter(|line| !line.starts_with('#'));
    let element = |(row, index): (&'static str, u16)| {
        let mut cells = row.split(' ');
        let symbol = cells.next()?;
        let mut radius = || cells.next().and_then(|cell| cell.parse().ok()).unwrap_or(UNKNOWN_RADIUS);
        let (covalent, van_der_waals) = (radius(), radius());
        let color = hex_channels(&format!("#{}", cells.next()?))?;
        Some(ChemicalElement { symbol, index, covalent, van_der_waals, color })
    };
    rows.zip(0..).filter_map(element).collect()
});

/// Returns the colours of all elements, in the order of the table.
pub(super) fn colors() -> impl Iterator<Item = [f64; 3]> {
    ELEMENTS.iter().map(|element| element.color)
}

/// Returns the element with a symbol, in any case. `D` and `T` are hydrogen.
pub(super) fn element(symbol: &str) -> Option<&'static ChemicalElement> {
    let symbol = if ["D", "T"].contains(&symbol) { "H" } else { symbol };
    ELEMENTS.iter().find(|element| element.symbol.eq_ignore_ascii_case(symbol))
}

/// Returns whether a word is the symbol of a chemical element, in any case.
#[must_use]
pub fn is_element(symbol: &str) -> bool {
    element(symbol).is_some()
}

/// Returns the element with an atomic number.
pub(super) fn numbered(number: f64) -> Option<&'static ChemicalElement> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a whole number from 1 to 118"
    )]
    let index = |number: f64| number as usize - 1;
    let is_known = number.fract() == 0.0 && (1.0..=118.0).contains(&number);
    is_known.then(|| ELEMENTS.get(index(number))).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_found_by_symbol_and_number() {
        assert_eq!(ELEMENTS.len(), 118);
        let carbon = element("c").unwrap();
        assert_eq!((carbon.covalent, carbon.van_der_waals), (0.76, 1.77));
        assert_eq!(carbon.color, [144.0; 3]);
        assert_eq!(numbered(6.0).unwrap().symbol, "C");
        assert_eq!(element("D").unwrap().symbol, "H");
        assert!(element("Xx").is_none() && numbered(0.0).is_none() && numbered(1.5).is_none());
        assert_eq!(element("Og").unwrap().van_der_waals, UNKNOWN_RADIUS);
    }
}
