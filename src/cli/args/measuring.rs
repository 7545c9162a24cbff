//! Arguments of the commands that measure pictures.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use rayreel::accuracy::Parameter;
use rayreel::color::Transfer;
use rayreel::time::FrameList;

use super::overrides::OverrideArguments;
use crate::cli::values::{parse_parameter, parse_size, parse_threads, parse_tolerance};

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel accuracy scenes/first_light.ron --quick
  rayreel accuracy scenes/chess_morning.ron --html report.html
  rayreel accuracy scenes/first_light.ron --frames 0,40,80 --json > report.json
  rayreel accuracy scenes/first_light.ron --vary effects --sizes 480x270,320x180

Varies every setting that affects the scene: samples, error target, samples per light, instants,
depth, cutoff and precision; and renders without each effect. Each picture is compared with a
reference of many samples, whose own uncertainty is printed; its time is measured in alternation with
the scene's own settings. Takes minutes, and --quick less, with less certainty; begin with a small --size,
or --vary few parameters. Ctrl-C ends the measurement; once every setting has been timed twice, the
table is then printed nevertheless.

A star marks the Pareto front: no other setting is cheaper and at least as accurate, or more accurate
and at least as cheap. Differences within the uncertainty of errors and the scatter of times are
ignored, and costs are compared by ray counts where possible, so that stars hardly differ from run to
run. = marks settings that trace the same rays as a setting above; ^ marks error targets that were not
reached with the maximum number of samples per pixel of the measurement.")]
pub(in crate::cli) struct AccuracyArguments {
    /// The scene file
    pub(in crate::cli) scene: PathBuf,
    /// Frames to measure, as in 10-20,30,40-80x5; at most 8 of them, evenly spaced, are used [default: the middle frame]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(in crate::cli) frames: Option<FrameList>,
    /// Frame size in pixels, as in 1280x720 [default: the scene's size]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, allow_hyphen_values = true)]
    pub(in crate::cli) size: Option<(u32, u32)>,
    /// Number of render threads [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = parse_threads, allow_hyphen_values = true)]
    pub(in crate::cli) threads: Option<u16>,
    /// Also vary the film size: pictures of these sizes are scaled to the scene's size and compared, as in 480x270,320x180
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_size, allow_hyphen_values = true)]
    pub(in crate::cli) sizes: Vec<(u32, u32)>,
    /// Vary only these parameters: samples, max-error, light-samples, instants, depth, cutoff, precision, effects [default: all that
    /// affect the scene]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_parameter)]
    pub(in crate::cli) vary: Vec<Parameter>,
    /// Use fewer samples and fewer rounds: less certain, in a fraction of the time
    #[arg(long)]
    pub(in crate::cli) quick: bool,
    /// Also write an HTML page with plots and pictures to this file
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) html: Option<PathBuf>,
    /// Also write the table as CSV to this file, with the scene, the size, the version and all uncertainties
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) csv: Option<PathBuf>,
    /// Also write a PNG of the error of each pixel of the first frame with the scene's own settings, from black (none) to white
    /// (largest)
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) error_map: Option<PathBuf>,
    /// Also write a picture of the sample count of each pixel of the first frame, in powers of two, from black to white (most)
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) sample_map: Option<PathBuf>,
    /// Print one JSON object instead of the table
    #[arg(long)]
    pub(in crate::cli) json: bool,
    #[command(flatten)]
    pub(in crate::cli) overrides: OverrideArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel compare a.png b.png
  rayreel compare a.exr b.exr --tolerance 0.5 --out difference.png
  rayreel compare out/first_light/first_light.0000.png other.png --json

Reads PNG, binary PPM, PFM, Radiance HDR, and OpenEXR as written by rayreel; the two formats may
differ. Pictures are compared as displayed, by unrounded output values from 0 to 255: the linear light
of PFM, Radiance HDR and OpenEXR is encoded first, and light above 1 is clamped. Transparent areas are composited over
black, and the alpha channel is compared, too.

max           largest difference of any channel, with its pixel: column and row from 0 at the top left
RMS           root mean square of the differences of all channels
PSNR          20 log10(255 / RMS), in decibels
SSIM          structural similarity (Wang et al. 2004), 1 for equal pictures
FLIP          mean difference perceived when alternating between both (Andersson et al. 2020), from
              0 to 1, on a screen 3840 pixels wide, viewed from a distance equal to its width
relative MSE  of linear light, for PFM, Radiance HDR and OpenEXR: mean of (a - b)^2 / (b^2 + 0.01)

Exits with 0 if the pictures are equal, that is, if no channel of any pixel differs by more than
--tolerance. With a tolerance of 0, light above 1 must be equal, too. Exits with 1 if they are
different, and with 2 if they cannot be compared, for example because their sizes differ.")]
pub(in crate::cli) struct CompareArguments {
    /// The picture to compare
    pub(in crate::cli) picture: PathBuf,
    /// The picture to compare it with
    pub(in crate::cli) reference: PathBuf,
    /// Maximum difference of any channel at which pictures count as equal, in 8-bit levels
    #[arg(long, value_name = "LEVELS", default_value = "0", value_parser = parse_tolerance, allow_hyphen_values = true)]
    pub(in crate::cli) tolerance: f64,
    /// Transfer curve from linear light to output values
    #[arg(long, value_enum, default_value_t = TransferName::Srgb)]
    pub(in crate::cli) transfer: TransferName,
    /// Write a PNG of the differences to this file, from black (equal) to white (largest difference)
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum TransferName {
    /// The sRGB curve, the default of scenes
    Srgb,
    /// The linear curve of scenes with `transfer: Classic`
    Classic,
}

impl From<TransferName> for Transfer {
    fn from(name: TransferName) -> Self {
        match name {
            TransferName::Srgb => Self::Srgb,
            TransferName::Classic => Self::Classic,
        }
    }
}
