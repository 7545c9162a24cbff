//! Definitions of the command-line arguments. Their doc comments are the text of `--help`.

mod measuring;
mod overrides;

use std::path::PathBuf;
use std::time::Duration;

use clap::builder::NonEmptyStringValueParser;
use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use rayreel::live::{EditorCommand, HostName};
use rayreel::output::FrameNames;
use rayreel::sequence::{RenderOrder, Shard};
use rayreel::time::FrameList;
use rayreel::trace::{Passes, Precision};
use rayreel::{Effect, Ray, Time};

use super::probe::parse_ray;
use super::values::{
    parse_cutoff, parse_duration, parse_effect, parse_index, parse_max_error, parse_movie, parse_pixel,
    parse_sheet, parse_size, parse_threads, parse_warning,
};

pub(super) use measuring::{AccuracyArguments, CompareArguments};
pub(super) use overrides::OverrideArguments;

/// Ray-traced animation from plain text scenes: exact, reproducible frame sequences.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true, arg_required_else_help = true, max_term_width = 100)]
#[command(after_help = "Examples:
  rayreel new ball.ron                     write a small commented scene to start from
  rayreel check ball.ron                   report the errors in the scene
  rayreel watch ball.ron                   preview the scene in the browser while editing it
  rayreel render ball.ron                  render all frames into out/ball/
  rayreel render ball.ron --frames 0-47x4  render every fourth frame of the first two seconds
  rayreel verify out/ball                  check that all frames are complete and up to date
  rayreel render ball.ron --sheet 6x4      render 24 frames into one picture
  rayreel explain ball.ron                 list the effects of the scene, with reasons
  rayreel accuracy ball.ron                measure the cost and the error of each setting
  rayreel compare a.png b.png              print the difference of two pictures
  rayreel probe ball.ron --pixel 320,180   print the ray tree of a pixel, which explains its colour

Exit codes:
  0    success; `verify`: all frames are complete and up to date; `check`: no scene has an error; `compare`: the
       pictures are equal
  1    error, reported on standard error; `compare`: the pictures are different
  2    invalid arguments; `compare`: the pictures cannot be compared
  129  SIGHUP, 130 Ctrl-C or SIGINT, 143 SIGTERM: interrupted; all written files are complete")]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render the frames of a scene into out/<scene>/<scene>.0000.png and so on
    Render(RenderArguments),
    /// Show a live preview of a scene in the browser, updated after every edit
    Watch(WatchArguments),
    /// Report the errors in scenes: file, line, column, cause and remedy
    Check(CheckArguments),
    /// List the effects of a scene, their reasons and costs
    Explain(ExplainArguments),
    /// Measure the trade-off between error and time for all settings and effects
    Accuracy(AccuracyArguments),
    /// Compare two pictures: largest difference, RMS error, PSNR, SSIM and FLIP
    Compare(CompareArguments),
    /// Print the ray tree of a pixel or a ray, or the hits of many rays
    Probe(ProbeArguments),
    /// Check a folder of frames: list missing, corrupt (torn), outdated (stale) and stray (surplus) files
    Verify(VerifyArguments),
    /// Print job scripts that render a sequence on a render farm
    Farm(FarmArguments),
    /// Write a small commented scene to start from
    New(NewArguments),
    /// Serve editors: mistakes, completion and descriptions while a scene is typed (a language server)
    Lsp(LspArguments),
    /// Print the scene format as JSON Schema, for editors and generators
    Schema(SchemaArguments),
    /// Print a shell completion script
    Completions(CompletionsArguments),
    /// Print a manual page
    Man(ManArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel render scenes/first_light.ron
  rayreel render scenes/first_light.ron --frames 10-20,30,40-80x5 --size 1920x1080
  rayreel render scenes/first_light.ron --at 1.5s --out stills
  rayreel render scenes/first_light.ron --sheet 6x4
  rayreel render scenes/first_light.ron --frames 12 --variants shadows,reflection
  rayreel render scenes/first_light.ron --draft
  rayreel render scenes/first_light.ron --samples 16 --set camera.fov=50 --without shadows
  rayreel render scenes/first_light.ron --max-error 0.5
  rayreel render scenes/first_light.ron --deadline 2m
  rayreel render scenes/first_light.ron --shard 0/4
  rayreel render scenes/first_light.ron --movie first_light.mp4
  rayreel render scenes/first_light.ron --out - | ffplay -
  rayreel render scenes/first_light.ron --format exr --alpha --passes depth,normal,id
  rayreel render scenes/first_light.ron --json > report.json

Finished frames are kept if their files are intact and their input is unchanged. Repeating the same
command therefore resumes an interrupted run, and after an edit renders only the frames that changed.
`rayreel verify` lists missing and outdated frames.

Every frame depends only on the scene and its frame number: it has the same bytes whether it is
rendered alone or in a sequence, on one thread or many. Ctrl-C keeps the frames already written,
discards the frame being rendered, and exits with 130 (SIGTERM with 143, SIGHUP with 129); an
interrupted sheet leaves no file. Partial files of killed processes are removed from the folder.")]
pub(super) struct RenderArguments {
    /// The scene file; - reads standard input, at most 1 GiB
    pub(super) scene: PathBuf,
    /// Only these frames: numbers, ranges and ranges with a stride, as in 10-20,30,40-80x5,90-
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(super) frames: Option<FrameList>,
    /// Render only this moment, in seconds, as in 1.5s; it can lie between frames
    #[arg(long, value_name = "SECONDS", conflicts_with = "frames", allow_hyphen_values = true)]
    pub(super) at: Option<Time>,
    /// Render one of several disjoint parts of the frames, one per machine: its index, from 0, and their count, as in 0/4
    #[arg(long, value_name = "INDEX/COUNT", conflicts_with_all = ["at", "sheet"])]
    pub(super) shard: Option<Shard>,
    /// Order of rendering
    #[arg(long, value_enum, default_value_t = OrderName::Ascending, conflicts_with_all = ["at", "sheet"])]
    pub(super) order: OrderName,
    /// Render frames again that are already done
    #[arg(long)]
    pub(super) overwrite: bool,
    /// Delete leftover frames of this sequence from the folder, such as those of a longer timeline or of another size
    #[arg(long, conflicts_with_all = ["at", "sheet"])]
    pub(super) clean: bool,
    /// Folder for the frame files; - streams video to standard output [default: out/<scene>]
    #[arg(long, value_name = "FOLDER")]
    pub(super) out: Option<PathBuf>,
    /// Name pattern of the frame files without extension, as shot_#### or shot_%04d, where #### or %04d stands for the digits of
    /// the frame number; optional for a single frame
    /// [default: <scene>.####]
    #[arg(long, value_name = "PATTERN", conflicts_with_all = ["at", "sheet"])]
    pub(super) name: Option<FrameNames>,
    /// Frame size in pixels, as in 1280x720 [default: the scene's size]. Frames of another size than the scene's go to a
    /// subfolder, as out/<scene>/1280x720, unless --out is given
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, allow_hyphen_values = true)]
    pub(super) size: Option<(u32, u32)>,
    /// Render a contact sheet of this many columns and rows, <scene>.sheet.png: frames evenly spaced from the first to the last,
    /// each with its number and time below. --size is the size of one frame; without it the sheet is at most 1920 pixels
    /// wide
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = parse_sheet, conflicts_with = "at", allow_hyphen_values = true)]
    pub(super) sheet: Option<(u32, u32)>,
    /// Render one frame onto a captioned sheet, <scene>.variants.png: with all effects and, side by side, without each of these, as in
    /// --variants shadows,reflection. --without lists the effects; --sheet sets the columns and rows
    #[arg(long, value_name = "EFFECTS", value_parser = parse_effect, value_delimiter = ',', conflicts_with_all = ["shard", "clean", "name", "movie", "max_error", "deadline", "settings"])]
    pub(super) variants: Vec<Effect>,
    /// Render fast low-quality frames into the subfolder draft: a third of the film's width and height, unless --size is given,
    /// one sample per pixel, no motion blur or depth of field, a depth of at most 5, and at most 4 samples per area light
    #[arg(long)]
    pub(super) draft: bool,
    /// Number of render threads [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = parse_threads, allow_hyphen_values = true)]
    pub(super) threads: Option<u16>,
    /// Precision of ray-shape intersections
    #[arg(long, value_enum, default_value_t = PrecisionName::Guaranteed)]
    pub(super) precision: PrecisionName,
    /// Skip faint rays, whose total contribution to a pixel is certainly less than this many 8-bit levels; 0 traces all rays
    /// [default: the scene's value]
    #[arg(long, value_name = "LEVELS", value_parser = parse_cutoff, allow_hyphen_values = true)]
    pub(super) cutoff: Option<f32>,
    /// Add samples per pixel until the estimated error of each frame is at most this many 8-bit levels, RMS or as set by --norm.
    /// Frames are independent of each other. --samples is the maximum per pixel [default maximum: 65536]
    #[arg(long, value_name = "LEVELS", value_parser = parse_max_error, allow_hyphen_values = true, conflicts_with_all = ["deadline", "settings", "draft"])]
    pub(super) max_error: Option<f32>,
    /// Render all frames within this time, as in 90s, 10m or 1.5h, with as many samples as it allows
    #[arg(long, value_name = "TIME", value_parser = parse_duration, allow_hyphen_values = true, conflicts_with_all = ["settings", "draft", "samples"])]
    pub(super) deadline: Option<Duration>,
    /// Reproduce the frames of an earlier run from the settings file that --max-error and --deadline write next to them
    #[arg(long, value_name = "FILE", conflicts_with_all = ["draft", "samples"])]
    pub(super) settings: Option<PathBuf>,
    /// Compute all effects, even those that the scene does not need: slower, with the same bytes
    #[arg(long)]
    pub(super) full: bool,
    /// Format of the files or of standard output [default: png for files, y4m for standard output]
    #[arg(long, value_enum)]
    pub(super) format: Option<FormatName>,
    /// Add passes to OpenEXR files: depth, distance, normal, id, albedo, position, separated by commas [default format with
    /// passes: exr]
    ///
    /// Passes describe the first hit of the ray through the centre of each pixel; they are never blurred. depth: distance from
    /// the camera along its view axis, in scene units (channel Z). distance: distance from the camera along the ray. normal:
    /// unit normal in world space, on the visible side. id: index of the shape among the shapes drawn in the frame, in document
    /// order, from 1. albedo: k_d times the surface colour, linear. position: point in world space. The background has infinite
    /// depth and distance, and 0 in all other passes.
    #[arg(long, value_name = "PASSES")]
    pub(super) passes: Option<Passes>,
    /// Add an alpha channel holding pixel coverage and omit the background, for compositing; formats png, png16 and exr
    #[arg(long)]
    pub(super) alpha: bool,
    /// Also encode a movie when all frames are complete: .mp4, .mov, .mkv or .webm with ffmpeg, .gif or .apng, which repeat for
    /// ever, without
    #[arg(long, value_name = "FILE", value_parser = parse_movie, conflicts_with_all = ["at", "sheet", "shard"])]
    pub(super) movie: Option<PathBuf>,
    /// Format of progress reports
    #[arg(long, value_enum, default_value_t = ProgressName::Auto)]
    pub(super) progress: ProgressName,
    /// Print only warnings and errors
    #[arg(short, long)]
    pub(super) quiet: bool,
    /// Print the cost of each rendered frame, the kept frames, and the reason why an existing file is not kept
    #[arg(short, long, conflicts_with_all = ["progress", "quiet"])]
    pub(super) verbose: bool,
    /// Print a report as one JSON object at the end: the seconds of each phase, the rays of each kind, the effects needed and the
    /// number of escalations to more exact arithmetic for every frame, and the peak memory usage
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) allowed: AllowArguments,
    #[command(flatten)]
    pub(super) overrides: OverrideArguments,
}

/// The warnings that are not given.
#[derive(Clone, Debug, Args)]
pub(super) struct AllowArguments {
    /// Do not warn of these, as in --allow one-color,idle-light: dark-color, not-drawn, no-light, nothing-seen, passed-target,
    /// short-turn, distorted, replaced-value, one-color, cut-off, idle-light, too-bright, black-surface, default-view, at-origin,
    /// out-of-date, incomplete, data-file, left-handed, hidden-background [can be repeated]
    #[arg(long = "allow", value_name = "WARNINGS", value_parser = parse_warning, value_delimiter = ',')]
    pub(super) warnings: Vec<&'static str>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum PrecisionName {
    /// Robust formulas: all hits and their order are correct
    Guaranteed,
    /// Naive textbook formulas in double precision, for comparison
    TextbookF64,
    /// Naive textbook formulas in single precision
    TextbookF32,
}

impl From<PrecisionName> for Precision {
    fn from(name: PrecisionName) -> Self {
        match name {
            PrecisionName::Guaranteed => Self::Robust,
            PrecisionName::TextbookF64 => Self::NaiveF64,
            PrecisionName::TextbookF32 => Self::NaiveF32,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ProgressName {
    /// Progress bar on a terminal; otherwise one line per frame, and one every ten seconds during long frames
    Auto,
    /// One JSON object per line on standard error: for every frame an event `kept` or `rendered` with its number, file, seconds, rays
    /// and error, the number of finished frames and the total; during long frames an event `rendering` once a second with the
    /// finished fraction. Warnings, and without --quiet the final lines, are events `warning` and `note` with a message
    Json,
    /// No progress reports
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum OrderName {
    /// Ascending by frame number
    Ascending,
    /// Every eighth frame first, then the frames midway between them, and so on
    Coarse,
}

impl From<OrderName> for RenderOrder {
    fn from(name: OrderName) -> Self {
        match name {
            OrderName::Ascending => Self::Ascending,
            OrderName::Coarse => Self::Coarse,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum FormatName {
    /// PNG: 8 bits per channel, lossless compression
    Png,
    /// PNG with 16 bits per channel, for grading
    Png16,
    /// Portable pixmap: 8 bits per channel, uncompressed
    Ppm,
    /// Portable float map: linear light, 32 bits per channel, uncompressed
    Pfm,
    /// OpenEXR: linear light, 32 bits per channel, with the channels of --passes, lossless compression
    Exr,
    /// Radiance HDR: linear light, 8 bits per channel with an exponent per pixel, run-length encoded
    Hdr,
    /// Standard output only: YUV4MPEG2, uncompressed video with a header of size and frame rate, BT.709, 4:4:4
    Y4m,
    /// Standard output only: red, green and blue of each pixel in turn, without headers
    Raw,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel watch scenes/first_light.ron
  rayreel watch scenes/first_light.ron --port 4000
  rayreel watch scenes/first_light.ron --out now.png
  rayreel watch scenes/first_light.ron --cache-dir out/first_light
  rayreel watch scenes/first_light.ron --port 4000 --allow-host localhost:9000

Prints the address of a page for a browser on this machine, which shows the picture, the timeline,
errors in the files, and the ray data of a clicked pixel. The preview is updated after each save of
the scene, its included files or its scripts; while the files contain errors, the last valid scene
stays. Ctrl-C stops the preview with exit code 130.")]
pub(super) struct WatchArguments {
    /// The scene file
    pub(super) scene: PathBuf,
    /// Port of the page on 127.0.0.1; 0 selects a free port [default: 0]
    #[arg(long, value_name = "NUMBER")]
    pub(super) port: Option<u16>,
    /// Accept this host name too, as localhost:9000 for `ssh -L 9000:127.0.0.1:4000`; without a port, any port [can be repeated]
    #[arg(long, value_name = "NAME[:PORT]")]
    pub(super) allow_host: Vec<HostName>,
    /// Frame to show first [default: 0]
    #[arg(long, value_name = "INDEX", value_parser = parse_index, allow_hyphen_values = true)]
    pub(super) frame: Option<u32>,
    /// Write the current frame to this file, .png, .ppm, .pfm, .exr or .hdr, after every edit
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Poll the files ten times a second, for network folders and other places without change notifications
    #[arg(long)]
    pub(super) poll: bool,
    /// Keep finished frames of up to this size in all, in MiB, for playback and for edits that are undone; 0 keeps none [default: 512]
    #[arg(long, value_name = "MIB")]
    pub(super) cache: Option<u16>,
    /// Keep finished frames in this folder too, as `render --out DIR` writes them, and show those that are there already
    #[arg(long, value_name = "DIR")]
    pub(super) cache_dir: Option<PathBuf>,
    /// Open places in the files by this command when they are clicked, as 'code -g {file}:{line}:{column}'
    #[arg(long, value_name = "COMMAND")]
    pub(super) editor: Option<EditorCommand>,
    #[command(flatten)]
    pub(super) allowed: AllowArguments,
    #[command(flatten)]
    pub(super) overrides: OverrideArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  rayreel check scenes/*.ron

Scripts are run for the first, the middle and the last frame. Exits with 1 if any scene has an error.")]
pub(super) struct CheckArguments {
    /// The scene files
    #[arg(required = true)]
    pub(super) scenes: Vec<PathBuf>,
    /// Print the errors as a JSON list, with line, column, cause and remedy
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) allowed: AllowArguments,
    #[command(flatten)]
    pub(super) overrides: OverrideArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel explain scenes/first_light.ron
  rayreel explain scenes/first_light.ron --frames 0-47 --measure
  rayreel explain scenes/first_light.ron --json
  rayreel explain scenes/fly_around.ron --path path.svg

Effects that a frame does not need are omitted, and the reason is given: no material has the effect,
its coefficient is 0 at this time, the light is off, nothing moves while the shutter is open, or no
shape with the effect is visible. The picture is the same, bit for bit, as with all effects
(render --full).

At most 10000 frames, evenly spaced, are examined, and none is rendered. --measure renders up to three
of them, spread over the timeline, about ten times per effect. The cost of an effect is the saving
from rendering without it, as the median of five interleaved rounds with half the range between the
extremes. The error of the picture without the effect, maximum and RMS, is in 8-bit levels.")]
pub(super) struct ExplainArguments {
    /// The scene file
    pub(super) scene: PathBuf,
    /// Only these frames: numbers, ranges and ranges with a stride, as in 10-20,30,40-80x5,90-
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(super) frames: Option<FrameList>,
    /// Frame size in pixels, as in 1280x720 [default: the scene's size]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, allow_hyphen_values = true)]
    pub(super) size: Option<(u32, u32)>,
    /// Number of render threads [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = parse_threads, allow_hyphen_values = true)]
    pub(super) threads: Option<u16>,
    /// Also render with and without each effect, and print its cost in rays and time, and the error without it
    #[arg(long)]
    pub(super) measure: bool,
    /// Instead, draw the camera's path into this SVG file: from above, from the side, and its speed over time; at most 4000
    /// frames, evenly spaced
    #[arg(long, value_name = "FILE", conflicts_with_all = ["size", "threads", "measure", "json"])]
    pub(super) path: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) overrides: OverrideArguments,
}

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("question").required(true).args(["pixel", "ray", "rays"])))]
#[command(after_help = "Examples:
  rayreel probe scenes/first_light.ron --pixel 480,270
  rayreel probe scenes/first_light.ron --pixel 480,270 --frame 12 --json
  rayreel probe scenes/first_light.ron --pixel 480,270 --terms
  rayreel probe scenes/first_light.ron --ray 0,1,-8,0,0,1 --terms
  rayreel probe scenes/first_light.ron --pixel 480,200 --svg rays.svg
  rayreel probe scenes/first_light.ron --rays rays.csv > hits.csv
  echo 0,1,-8,0,0,1 | rayreel probe scenes/first_light.ron --at 1.5s --rays -

--pixel prints the tree of a pixel's rays. The light of each hit is the sum of the contributions
listed below it; multiplied by the ray's throughput, it is added to the pixel, whose colour is the
sum over all rays. If pixels have several samples, one sample is printed, and the pixel is the mean
of all samples. --ray prints the tree of a given ray instead.

--terms adds the terms of the sums. In the equation of an intersection, the direction dir is a unit
vector, so that t is the distance from the origin. The colour at a point is the sum of
  ambient           k_a c I_a
  emission          the light that the surface gives off
  for each light    (k_d c I (N.L) + k_s I (N.H)^shininess) V
  reflected light   k_r R, and k_t F R if a part of the refracted light is reflected
  refracted light   k_t (1 - F) T
On a metal, highlights and reflected light are multiplied by its colour. V is the share of the light
that arrives, R and T are the light that the reflected and the refracted ray bring back, and F is
the reflectance. n1 and n2 are the refractive indices. A light behind a transparent surface adds
k_d c I |N.L| V. Every sum is rounded to 32 bits per channel.

--rays reads one ray per line, ox,oy,oz,dx,dy,dz: its origin and its direction, which may have any
length except zero; a header line with these names is skipped. For each ray, a line
hit,entity,t,px,py,pz,nx,ny,nz is printed: 1 and the first hit, or 0 and empty fields. The entity is
its name or, if it has none, # and its index in the scene's list, from 0. The point is
origin + t direction; t is omitted if it exceeds 1.8e308, the largest finite number. The normal is on
the side of the ray's origin. Both outputs are the renderer's own results, and every number reads
back to the same bits.")]
pub(super) struct ProbeArguments {
    /// The scene file
    pub(super) scene: PathBuf,
    /// Print the ray tree of this pixel: column and row, from 0 at the top left
    #[arg(long, value_name = "COLUMN,ROW", value_parser = parse_pixel, allow_hyphen_values = true)]
    pub(super) pixel: Option<(u32, u32)>,
    /// Index of the sample to print, from 0 [default: 0]
    #[arg(long, value_name = "INDEX", conflicts_with_all = ["ray", "rays"], value_parser = parse_index, allow_hyphen_values = true)]
    pub(super) sample: Option<u32>,
    /// Print the ray tree of this ray: its origin and its direction, which may have any length except zero
    #[arg(long, value_name = "OX,OY,OZ,DX,DY,DZ", value_parser = parse_ray, allow_hyphen_values = true)]
    pub(super) ray: Option<Ray>,
    /// Also print the terms of every sum: the equation of each intersection with all roots, the coefficients of the material, N.L,
    /// N.H, diffuse term, highlight and visibility of each light, and the shares of the reflected and the refracted light
    #[arg(long, conflicts_with = "rays")]
    pub(super) terms: bool,
    /// Instead, draw the rays into this SVG file, in two views from above, from the side or from the front: camera ray, reflected
    /// and refracted rays, normals, and shadow rays, dashed up to the occluder if they are occluded; at most 200 rays
    #[arg(long, value_name = "FILE", conflicts_with_all = ["rays", "terms", "json"])]
    pub(super) svg: Option<PathBuf>,
    /// Print the hits of the rays in this CSV file; - reads standard input
    #[arg(long, value_name = "FILE")]
    pub(super) rays: Option<PathBuf>,
    /// Frame to probe [default: 0]
    #[arg(long, value_name = "INDEX", value_parser = parse_index, allow_hyphen_values = true)]
    pub(super) frame: Option<u32>,
    /// Moment to probe, in seconds, as in 1.5s; it can lie between frames
    #[arg(long, value_name = "SECONDS", conflicts_with = "frame", allow_hyphen_values = true)]
    pub(super) at: Option<Time>,
    /// Frame size in pixels, as in 1280x720 [default: the scene's size]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, conflicts_with_all = ["ray", "rays"], allow_hyphen_values = true)]
    pub(super) size: Option<(u32, u32)>,
    /// Print JSON: one object for --pixel or --ray, or one line with an object for each ray of --rays
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) overrides: OverrideArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel verify out/first_light
  rayreel verify out/first_light --frames 0-47 --json

Reads every frame file completely and compares it with the scene. Lists frames, in the syntax of
`render --frames`, that are `missing`, `torn` (incomplete, or with altered pixels), `stale`
(outdated: rendering them now would use different input) or `unknown` (without a record of their
input), and `surplus` files (stray files that look like frames of the sequence). Exits with 0 if all
frames are complete and up to date, otherwise with 1.")]
pub(super) struct VerifyArguments {
    /// A folder written by `render`
    pub(super) folder: PathBuf,
    /// Only these frames: numbers, ranges and ranges with a stride, as in 10-20,30,40-80x5,90-
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(super) frames: Option<FrameList>,
    /// The scene file, if it has moved, or if the folder has frames of several scenes
    #[arg(long, value_name = "FILE")]
    pub(super) scene: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel farm slurm scenes/first_light.ron --shards 8 > jobs.sh && sh jobs.sh
  rayreel farm slurm scenes/first_light.ron --shards 8 -- --size 1920x1080 --samples 16
  rayreel farm openjd scenes/first_light.ron --shards 8 > job.json
  rayreel farm kubernetes scenes/first_light.ron --shards 8 --image ours/rayreel --claim frames

The scene and the options are checked first. The scene and the folder of the frames must have the
same paths on all machines. Every script ends with a job that verifies the frames. If `farm` fails in
a pipe to sh, the script is empty and sh exits with 0, unless `set -o pipefail` is in effect.")]
pub(super) struct FarmArguments {
    /// Scheduler
    pub(super) scheduler: SchedulerName,
    /// The scene file
    pub(super) scene: PathBuf,
    /// Number of jobs, each of which renders one part of the frames
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(super) shards: u32,
    /// Folder for the frame files [default: out/<scene>]
    #[arg(long, value_name = "FOLDER")]
    pub(super) out: Option<PathBuf>,
    /// Container image that contains rayreel, for Kubernetes
    #[arg(long, value_name = "IMAGE", value_parser = NonEmptyStringValueParser::new())]
    pub(super) image: Option<String>,
    /// Persistent volume claim that contains the scene and is the working directory of the jobs, for Kubernetes
    #[arg(long, value_name = "NAME", value_parser = NonEmptyStringValueParser::new())]
    pub(super) claim: Option<String>,
    /// Further options for `render`, after `--`
    #[arg(last = true, value_name = "OPTIONS")]
    pub(super) options: Vec<String>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum SchedulerName {
    /// Shell script that submits a job array and a verification job
    Slurm,
    /// Open Job Description template, 2023-09
    Openjd,
    /// Indexed job and a verification job
    Kubernetes,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel new ball.ron && rayreel render ball.ron
  rayreel new --from water.xyz water.ron && rayreel watch water.ron")]
pub(super) struct NewArguments {
    /// The file to write; it must not exist
    pub(super) file: PathBuf,
    /// Write a scene that shows the particles of this data file: the camera circles around them, and elements have their usual colours
    #[arg(long, value_name = "DATA")]
    pub(super) from: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Editors start it by themselves, and speak the language server protocol with it on standard input
and output. Example, for Helix:
  [language-server.rayreel]
  command = \"rayreel\"
  args = [\"lsp\"]"
)]
pub(super) struct LspArguments {
    /// Use standard input and output, as always; some editors add this option
    #[arg(long)]
    stdio: bool,
    #[command(flatten)]
    pub(super) allowed: AllowArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  rayreel schema > scene.schema.json")]
pub(super) struct SchemaArguments {}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel man > rayreel.1
  rayreel man render | man -l -")]
pub(super) struct ManArguments {
    /// Command to document [default: all commands]
    pub(super) command: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  rayreel completions bash > /etc/bash_completion.d/rayreel")]
pub(super) struct CompletionsArguments {
    /// The shell
    pub(super) shell: Shell,
}
