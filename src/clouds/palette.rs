//! Colour maps of numbers, and the colours of categories.

use std::sync::LazyLock;

use crate::color::hex_channels;

/// A perceptual colour map of 256 colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorMap {
    /// From dark blue over green to yellow.
    Viridis,
    /// From black over purple to pale yellow.
    Magma,
    /// From black over red to pale yellow.
    Inferno,
    /// From dark blue over red to yellow.
    Plasma,
    /// From dark blue to yellow, alike for colour-blind people.
    Cividis,
    /// A rainbow of even steps.
    Turbo,
    /// From blue over grey to red, for values on both sides of a middle.
    CoolWarm,
}

/// The colours of categories, as in scene files: ten strong ones, then their lighter ones (Tableau 20).
pub const CATEGORIES: [&str; 20] = [
    "#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22",
    "#17becf", "#aec7e8", "#ffbb78", "#98df8a", "#ff9896", "#c5b0d5", "#c49c94", "#f7b6d2", "#c7c7c7",
    "#dbdb8d", "#9edae5",
];

static MAPS: LazyLock<Vec<Vec<[f64; 3]>>> = LazyLock::new(|| {
    let mut maps: Vec<Vec<[f64; 3]>> = Vec::new();
    for line in include_str!("maps.txt").lines().filter(|line| !line.starts_with('#')) {
        if line.contains(' ') {
            let colors = line.split(' ').filter_map(|color| hex_channels(&format!("#{color}")));
            maps.last_mut().into_iter().for_each(|map| map.extend(colors.clone()));
        } else {
            maps.push(Vec::new());
        }
    }
    maps
});

impl ColorMap {
    /// Returns the colours from the lower to the upper end, as in scene files.
    #[must_use]
    pub fn colors(self) -> &'static [[f64; 3]] {
        MAPS.get(self as usize).map_or(&[], Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_have_their_ends() {
        let ends = |map: ColorMap| [map.colors()[0], map.colors()[255]];
        assert!(MAPS.iter().all(|map| map.len() == 256) && MAPS.len() == 7);
        assert_eq!(ends(ColorMap::Viridis), [[68.0, 1.0, 84.0], [253.0, 231.0, 37.0]]);
        assert_eq!(ends(ColorMap::CoolWarm), [[59.0, 76.0, 192.0], [180.0, 4.0, 38.0]]);
        assert_eq!(ends(ColorMap::Magma)[1], [252.0, 253.0, 191.0]);
        assert_eq!(ends(ColorMap::Turbo)[0], [48.0, 18.0, 59.0]);
        assert!(CATEGORIES.iter().all(|color| hex_channels(color).is_some()));
    }
}
