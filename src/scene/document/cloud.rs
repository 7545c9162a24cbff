//! Clouds of particles from data files.

use serde::Deserialize;

use super::values::{three_whole, yes};
use super::{ColorDocument, RateDocument, ShapeDocument, SurfaceDocument, TransformDocument};

/// A cloud of particles.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Cloud")]
pub(crate) struct CloudDocument {
    pub(crate) source: String,
    pub(crate) name: Option<String>,
    pub(crate) parent: Option<String>,
    #[serde(default)]
    pub(crate) transform: TransformDocument,
    pub(crate) style: Option<StyleDocument>,
    pub(crate) shape: Option<ShapeDocument>,
    pub(crate) scale_by: Option<ScaleByDocument>,
    pub(crate) bonds: Option<BondsDocument>,
    pub(crate) material: Option<SurfaceDocument>,
    pub(crate) color: Option<ColorDocument>,
    pub(crate) color_by: Option<ColorByDocument>,
    pub(crate) filter: Option<String>,
    #[serde(default = "one_cell", deserialize_with = "three_whole")]
    pub(crate) images: [u64; 3],
    #[serde(default)]
    pub(crate) frames: FramesDocument,
    #[serde(default = "yes")]
    pub(crate) visible: bool,
    #[serde(default = "yes")]
    pub(crate) casts_shadow: bool,
    #[serde(default = "yes")]
    pub(crate) in_reflections: bool,
}

/// A look of particles and bonds together.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename = "Style")]
pub(crate) enum StyleDocument {
    BallAndStick,
    Licorice,
    Cell,
}

/// The rods between particles.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Bonds")]
pub(crate) struct BondsDocument {
    pub(crate) radius: Option<f64>,
    pub(crate) color: Option<ColorDocument>,
    pub(crate) distance: Option<f64>,
}

/// The sizes of particles.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename = "ScaleBy")]
pub(crate) enum ScaleByDocument {
    Column(String),
    VanDerWaals,
    Covalent,
}

/// The colours of particles.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "ColorBy")]
pub(crate) enum ColorByDocument {
    Element,
    Category(String),
    Map {
        column: String,
        #[serde(default)]
        map: ColorMapDocument,
        #[serde(default)]
        range: Option<(f64, f64)>,
    },
}

/// A colour map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename = "ColorMap")]
pub(crate) enum ColorMapDocument {
    #[default]
    Viridis,
    Magma,
    Inferno,
    Plasma,
    Cividis,
    Turbo,
    CoolWarm,
}

/// The times of the frames of a data file.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Frames")]
pub(crate) struct FramesDocument {
    pub(crate) start: f64,
    pub(crate) fps: RateDocument,
    pub(crate) between: BetweenDocument,
    pub(crate) end: EndDocument,
}

/// The values between two frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename = "Between")]
pub(crate) enum BetweenDocument {
    #[default]
    Hold,
    Linear,
}

/// The frames after the last one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename = "End")]
pub(crate) enum EndDocument {
    #[default]
    Hold,
    Loop,
}

impl CloudDocument {
    /// Returns the shape of a particle.
    pub(crate) fn particle_shape(&self) -> ShapeDocument {
        let radius = match self.style {
            // As in Jmol and VMD: a quarter of the van der Waals radius.
            Some(StyleDocument::BallAndStick) => 0.25,
            Some(StyleDocument::Licorice) => LICORICE,
            Some(StyleDocument::Cell) | None => 1.0,
        };
        self.shape.clone().unwrap_or(ShapeDocument::Sphere { radius })
    }

    /// Returns the sizes of the particles.
    pub(crate) fn sizes(&self) -> Option<ScaleByDocument> {
        let by_style =
            (self.style == Some(StyleDocument::BallAndStick)).then_some(ScaleByDocument::VanDerWaals);
        self.scale_by.clone().or(by_style)
    }

    /// Returns the bonds, with a radius.
    pub(crate) fn rods(&self) -> Option<(f64, BondsDocument)> {
        let radius = match self.style {
            Some(StyleDocument::Cell) => return None,
            Some(StyleDocument::Licorice) => LICORICE,
            Some(StyleDocument::BallAndStick) | None => 0.15,
        };
        let bonds = self.bonds.clone().or(self.style.map(|_| BondsDocument::default()))?;
        Some((bonds.radius.unwrap_or(radius), bonds))
    }
}

/// Returns the default of `images`: the cell of the file alone.
fn one_cell() -> [u64; 3] {
    [1; 3]
}

/// The radius of atoms and bonds in angstroms, as in VMD.
const LICORICE: f64 = 0.3;

/// Returns the cloud and the number in the name of a particle, as `gas/1234`.
pub(crate) fn parse_particle_name(name: &str) -> Option<(&str, u64)> {
    let (cloud, number) = name.rsplit_once('/')?;
    let is_number = number.bytes().all(|digit| digit.is_ascii_digit());
    Some((cloud, number.parse().ok().filter(|_| is_number)?))
}
