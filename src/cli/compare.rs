//! `rayreel compare`

use std::fmt::Write;
use std::path::Path;

use anyhow::{anyhow, ensure};
use serde_json::{Value, json};

use rayreel::accuracy::{FilmError, OutputValues, flip, relative_mse, structural_similarity};
use rayreel::color::Transfer;
use rayreel::output::PictureFile;
use rayreel::scene::Printable;

use super::args::CompareArguments;
use super::exit::Failure;
use super::heat_map::heat_map;
use super::print;
use super::write_file::{ensure_another, write_file};

pub(super) fn run(arguments: &CompareArguments) -> Result<(), Failure> {
    match compare(arguments) {
        Ok(comparison) if comparison.is_equal => Ok(()),
        Ok(_) => Err(Failure::Reported),
        Err(error) => Err(Failure::Trouble(error)),
    }
}

fn compare(arguments: &CompareArguments) -> anyhow::Result<Comparison> {
    let CompareArguments { picture, reference, .. } = arguments;
    for read in arguments.out.iter().flat_map(|file| [(file, picture), (file, reference)]) {
        ensure_another(read.0, read.1, "a picture that is compared")?;
    }
    let transfer = arguments.transfer.into();
    let comparison =
        Comparison::of(load(picture, transfer)?, load(reference, transfer)?, arguments.tolerance)
            .map_err(|reason| anyhow!("`{}` and `{}`: {reason}", picture.display(), reference.display()))?;
    if let Some(file) = &arguments.out {
        write_file(file, &heat_map(comparison.size, &comparison.differences)?)?;
    }
    if arguments.json {
        print::json(comparison.json(arguments))?;
    } else {
        print::result(&comparison.text(arguments))?;
    }
    Ok(comparison)
}

fn load(path: &Path, transfer: Transfer) -> anyhow::Result<PictureFile> {
    PictureFile::read(path, transfer).map_err(|reason| anyhow!("cannot read `{}`: {reason}", path.display()))
}

/// The differences between two pictures.
struct Comparison {
    size: (u32, u32),
    is_equal: bool,
    error: FilmError,
    similarity: f64,
    flip: f64,
    /// Relative mean square error of linear light, if both files contain it.
    relative_mse: Option<f64>,
    /// Largest difference of alpha in 8-bit levels, if either file contains it.
    alpha: Option<f64>,
    /// Largest difference of each pixel in 8-bit levels, including alpha, row by row from the top.
    differences: Vec<f64>,
}

impl Comparison {
    fn of(picture: PictureFile, reference: PictureFile, tolerance: f64) -> anyhow::Result<Self> {
        let size = picture.size;
        ensure!(
            size == reference.size,
            "pictures of different sizes cannot be compared: {}x{} and {}x{} pixels",
            size.0,
            size.1,
            reference.size.0,
            reference.size.1
        );
        let light = picture.light.zip(reference.light);
        let values = OutputValues::new(size, picture.values);
        let reference_values = OutputValues::new(size, reference.values);
        let error = FilmError::of_values(&values, &reference_values);
        let mut differences = values.differences(&reference_values);
        let mut alpha = None;
        if picture.alpha.is_some() || reference.alpha.is_some() {
            let of =
                |alpha: &Option<Vec<f32>>, pixel: usize| alpha.as_ref().map_or(1.0, |alpha| alpha[pixel]);
            let mut most: f64 = 0.0;
            for (pixel, difference) in differences.iter_mut().enumerate() {
                let apart = of(&picture.alpha, pixel) - of(&reference.alpha, pixel);
                let apart = 255.0 * f64::from(apart.abs());
                (most, *difference) = (most.max(apart), difference.max(apart));
            }
            alpha = Some(most);
        }
        let most = error.max.max(alpha.unwrap_or(0.0));
        // Output values are clamped at 1: equal output values do not imply equal light.
        let is_same_light = light.as_ref().is_none_or(|(one, other)| one == other);
        Ok(Self {
            size,
            is_equal: most <= tolerance && (tolerance > 0.0 || is_same_light),
            error,
            similarity: structural_similarity(&values, &reference_values),
            flip: flip(&values, &reference_values).mean,
            relative_mse: light.map(|(one, other)| relative_mse(&one, &other)),
            alpha,
            differences,
        })
    }

    /// Returns the column and row of the largest difference, or `None` if there is no difference.
    fn place(&self) -> Option<(usize, usize)> {
        let most = self.differences.iter().copied().fold(0.0, f64::max);
        let index = self.differences.iter().position(|apart| *apart == most).filter(|_| most > 0.0)?;
        let width = self.size.0 as usize;
        Some((index % width, index / width))
    }

    fn text(&self, arguments: &CompareArguments) -> String {
        let (picture, reference) =
            (arguments.picture.display().to_string(), arguments.reference.display().to_string());
        let (width, height) = self.size;
        let verdict = match (self.is_equal, arguments.tolerance) {
            (true, 0.0) => "equal".to_owned(),
            (true, tolerance) => format!("equal within {tolerance}"),
            (false, _) => "different".to_owned(),
        };
        let mut text =
            format!("{} and {}, {width}x{height}: {verdict}\n", Printable(&picture), Printable(&reference));
        let mut line = |name: &str, value: &str| {
            let _ = writeln!(text, "{name:<12}  {value}");
        };
        let place =
            self.place().map_or_else(String::new, |(column, row)| format!(" at pixel {column},{row}"));
        let alpha = self.alpha.filter(|alpha| *alpha > self.error.max);
        let place_of = |is_there: bool| if is_there { place.as_str() } else { "" };
        line("max", &format!("{}{}", number(self.error.max), place_of(alpha.is_none())));
        if let Some(apart) = self.alpha {
            line("max, alpha", &format!("{}{}", number(apart), place_of(alpha.is_some())));
        }
        line("RMS", &number(self.error.rms));
        let psnr = self.error.psnr();
        line("PSNR", &if psnr.is_finite() { format!("{psnr:.2} dB") } else { "∞".to_owned() });
        line("SSIM", &number(self.similarity));
        line("FLIP", &number(self.flip));
        if let Some(error) = self.relative_mse {
            line("relative MSE", &number(error));
        }
        text
    }

    fn json(&self, arguments: &CompareArguments) -> Value {
        json!({
            "picture": arguments.picture.display().to_string(),
            "reference": arguments.reference.display().to_string(),
            "width": self.size.0,
            "height": self.size.1,
            "equal": self.is_equal,
            "tolerance": arguments.tolerance,
            "max": self.error.max,
            "max_alpha": self.alpha,
            "pixel": self.place().map(|(column, row)| [column, row]),
            "rms": self.error.rms,
            "psnr": Some(self.error.psnr()).filter(|psnr| psnr.is_finite()),
            "ssim": self.similarity,
            "flip": self.flip,
            "relative_mse": self.relative_mse,
            "share_off": self.error.share_off,
        })
    }
}

/// Formats a number with about four significant digits.
pub(super) fn number(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        small if small.abs() < 1e-3 => format!("{small:.3e}"),
        // Only equal pictures show a similarity of 1.
        nearly if nearly < 1.0 && nearly > 0.9999 => format!("{nearly:.8}"),
        one if one.abs() < 10.0 => format!("{one:.4}"),
        large => format!("{large:.2}"),
    }
}
