//! What can be typed.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use rayreel::Time;
use rayreel::time::FrameList;
use rayreel::trace::Precision;

/// Ray-traced animation from plain text scenes: exact, repeatable frame sequences.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true, arg_required_else_help = true, max_term_width = 100)]
#[command(after_help = "Examples:
  rayreel new ball.ron                     start from a small commented scene
  rayreel check ball.ron                   say what is wrong with it, if anything
  rayreel render ball.ron                  render all its frames into out/ball/
  rayreel render ball.ron --frames 0-47x4  every fourth frame of the first two seconds")]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render a scene's frames into out/<scene>/<scene>.0000.png and so on
    Render(RenderArguments),
    /// Say what is wrong with scenes: file, line, column, cause and remedy
    Check(CheckArguments),
    /// Write a small commented scene to start from
    New(NewArguments),
    /// Print completions for a shell
    Completions(CompletionsArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel render scenes/first_light.ron
  rayreel render scenes/first_light.ron --frames 10-20,30,40-80x5 --size 1920x1080
  rayreel render scenes/first_light.ron --at 1.5s --out stills
  rayreel render scenes/first_light.ron --json > report.json

Every frame is a function of the scene and its index: it has the same bytes whether it is rendered
alone or with the others, with one thread or many. Ctrl-C keeps the frames that are written, drops
the one being rendered, and exits with 130.")]
pub(super) struct RenderArguments {
    /// The scene file
    pub(super) scene: PathBuf,
    /// Only these frames: single ones, ranges and ranges with a stride, as in 10-20,30,40-80x5
    #[arg(long, value_name = "LIST")]
    pub(super) frames: Option<FrameList>,
    /// Only this moment, in seconds, as in 1.5s; it need not be a frame's
    #[arg(long, value_name = "SECONDS", conflicts_with = "frames")]
    pub(super) at: Option<Time>,
    /// The folder for the frame files [default: out/<scene>]
    #[arg(long, value_name = "FOLDER")]
    pub(super) out: Option<PathBuf>,
    /// Pixels, instead of the scene's own, as in 1280x720
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    pub(super) size: Option<(u32, u32)>,
    /// Threads to render on [default: one a core]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// How rays and shapes are intersected
    #[arg(long, value_enum, default_value_t = PrecisionName::Guaranteed)]
    pub(super) precision: PrecisionName,
    /// The files' format
    #[arg(long, value_enum, default_value_t = Format::Png)]
    pub(super) format: Format,
    /// Print one JSON object at the end: for every frame seconds by phase, rays by kind and how often arithmetic had to be
    /// helped, and peak memory
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum PrecisionName {
    /// Every verdict and every digit right
    Guaranteed,
    /// The schoolbook's formulas in double precision, to compare with
    TextbookF64,
    /// The same in single precision
    TextbookF32,
}

impl From<PrecisionName> for Precision {
    fn from(name: PrecisionName) -> Self {
        match name {
            PrecisionName::Guaranteed => Self::Guaranteed,
            PrecisionName::TextbookF64 => Self::TextbookF64,
            PrecisionName::TextbookF32 => Self::TextbookF32,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Format {
    /// Lossless, compressed
    Png,
    /// Portable pixmap, uncompressed
    Ppm,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  rayreel check scenes/*.ron

Exits with 1 if any scene has a mistake.")]
pub(super) struct CheckArguments {
    /// The scene files
    #[arg(required = true)]
    pub(super) scenes: Vec<PathBuf>,
    /// Print a JSON list of mistakes, with line, column, cause and remedy
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  rayreel new ball.ron && rayreel render ball.ron")]
pub(super) struct NewArguments {
    /// The file to write; it must not exist
    pub(super) file: PathBuf,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  rayreel completions bash > /etc/bash_completion.d/rayreel")]
pub(super) struct CompletionsArguments {
    /// The shell
    pub(super) shell: Shell,
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let side = |digits: &str| digits.trim().parse::<u32>().ok();
    let size = text.split_once(['x', 'X']).and_then(|(width, height)| Some((side(width)?, side(height)?)));
    size.ok_or_else(|| "write width and height in pixels, as in 1280x720".to_owned())
}
