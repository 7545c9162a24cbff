//! The arguments of commands that measure pictures.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use rayreel::color::Transfer;
use rayreel::time::FrameList;

use super::OverrideArguments;
use crate::cli::values::{parse_size, parse_threads, parse_tolerance};

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel accuracy scenes/first_light.ron --quick
  rayreel accuracy scenes/chess_morning.ron --html report.html
  rayreel accuracy scenes/first_light.ron --frames 0,40,80 --json > report.json
  rayreel accuracy scenes/first_light.ron --sizes 480x270,320x180

Renders frames again and again with every knob that the scene calls for turned through its values:
samples, the error that a picture may have, samples of lights, instants, depth, cutoff, precision;
and without each effect. Each is compared with a reference of many samples, whose own uncertainty is
told, and timed in turns with the scene's own settings. Takes minutes; --quick takes seconds, and is
less sure. Ctrl-C ends it.

A star marks the Pareto front: no other setting is cheaper and at least as good, or better and at
least as cheap. Differences within the uncertainty of errors and the scatter of times do not count,
and settings that can be are compared by their rays, so that stars hardly differ from run to run.
= marks settings that trace the same rays as one above, ^ errors that were not reached with the most
samples per pixel that the measurement takes.")]
pub(in crate::cli) struct AccuracyArguments {
    /// The scene file
    pub(in crate::cli) scene: PathBuf,
    /// These frames, of many at most 8, spread evenly, as in 10-20,30,40-80x5 [default: the middle one]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(in crate::cli) frames: Option<FrameList>,
    /// Pixels, instead of the scene's own, as in 1280x720
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, allow_hyphen_values = true)]
    pub(in crate::cli) size: Option<(u32, u32)>,
    /// Threads to render on [default: one a core]
    #[arg(long, value_name = "COUNT", value_parser = parse_threads, allow_hyphen_values = true)]
    pub(in crate::cli) threads: Option<u16>,
    /// Turn the film's size, too: pictures of these sizes are scaled to the scene's and compared, as in 480x270,320x180
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_size, allow_hyphen_values = true)]
    pub(in crate::cli) sizes: Vec<(u32, u32)>,
    /// Measure with fewer samples and fewer rounds: seconds instead of minutes
    #[arg(long)]
    pub(in crate::cli) quick: bool,
    /// Write a page with plots and pictures to this file, too
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) html: Option<PathBuf>,
    /// Write the table as CSV to this file, too, with the scene, the size, the version and all uncertainties
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) csv: Option<PathBuf>,
    /// Write the error of each pixel of the first frame as a PNG to this file, with the scene's own settings: from black, none, to
    /// white, the largest
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) error_map: Option<PathBuf>,
    /// Write the samples of each pixel of the first frame, too, by powers of two: from black to white, the most
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

Reads PNG, binary PPM, PFM, and OpenEXR that rayreel wrote; the two formats may differ. Pictures are
compared as they are shown, by unrounded output values from 0 to 255: the linear light of PFM and
OpenEXR is encoded first, and light above 1 is clamped. What alpha leaves open is black, and alpha
is compared, too.

max           largest difference of any channel, with its pixel: column and row from 0 at the top left
RMS           root of the mean square of the differences of all channels
PSNR          20 log10(255 / RMS), in decibels
SSIM          structural similarity (Wang et al. 2004), 1 for equal pictures
FLIP          mean difference as seen when alternating between both (Andersson et al. 2020), from
              0 to 1, on a screen of 3840 pixels that is as far away as it is wide
relative MSE  of linear light, of PFM and OpenEXR: mean of (a - b)^2 / (b^2 + 0.01)

Exits with 0 if the pictures are equal: if no channel of any pixel differs by more than --tolerance.
With a tolerance of 0, light above 1 must be equal, too. Exits with 1 if they are different, and with
2 if they cannot be compared, as pictures of different sizes.")]
pub(in crate::cli) struct CompareArguments {
    /// A picture
    pub(in crate::cli) picture: PathBuf,
    /// The picture that it is compared with
    pub(in crate::cli) reference: PathBuf,
    /// The largest difference of any channel of pictures that count as equal, in steps of 8 bits
    #[arg(long, value_name = "STEPS", default_value = "0", value_parser = parse_tolerance, allow_hyphen_values = true)]
    pub(in crate::cli) tolerance: f64,
    /// The curve from linear light to output values
    #[arg(long, value_enum, default_value_t = TransferName::Srgb)]
    pub(in crate::cli) transfer: TransferName,
    /// Write the differences as a PNG to this file: equal pixels are black, the largest difference is white
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(in crate::cli) enum TransferName {
    /// That of sRGB, the default of scenes
    Srgb,
    /// A straight line, that of scenes with `transfer: Classic`
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
