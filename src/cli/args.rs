//! Command-line arguments as typed. Their doc comments are the text of `--help`.

mod measuring;

use std::path::PathBuf;
use std::time::Duration;

use clap::builder::NonEmptyStringValueParser;
use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use rayreel::live::HostName;
use rayreel::output::FrameNames;
use rayreel::scene::Override;
use rayreel::sequence::{RenderOrder, Shard};
use rayreel::time::FrameList;
use rayreel::trace::{Passes, Precision};
use rayreel::{Effect, Time};

use super::values::{
    parse_cutoff, parse_depth, parse_duration, parse_effect, parse_index, parse_max_error, parse_min_samples,
    parse_movie, parse_norm, parse_pixel, parse_samples, parse_sheet, parse_size, parse_threads,
};

pub(super) use measuring::{AccuracyArguments, CompareArguments};

/// Ray-traced animation from plain text scenes: exact, repeatable frame sequences.
#[derive(Debug, Parser)]
#[command(version, propagate_version = true, arg_required_else_help = true, max_term_width = 100)]
#[command(after_help = "Examples:
  rayreel new ball.ron                     start from a small commented scene
  rayreel check ball.ron                   say what is wrong with it, if anything
  rayreel watch ball.ron                   see it in the browser while editing it
  rayreel render ball.ron                  render all its frames into out/ball/
  rayreel render ball.ron --frames 0-47x4  every fourth frame of the first two seconds
  rayreel verify out/ball                  say whether all its frames are there, whole and up to date
  rayreel render ball.ron --sheet 6x4      24 of its frames in one picture
  rayreel explain ball.ron                 tell which effects it calls for, and what they cost
  rayreel accuracy ball.ron                measure what each setting costs, and what it is worth
  rayreel compare a.png b.png              tell how far two pictures are from each other
  rayreel probe ball.ron --pixel 320,180   tell what that pixel sees, and why it has its colour

Exit codes:
  0    it is done; of `verify`, all frames are whole and up to date; of `check`, no scene has a mistake; of `compare`,
       the pictures are equal
  1    something is wrong, and told on standard error; of `compare`, the pictures are different
  2    the arguments are not understood; of `compare`, the pictures cannot be compared
  129  SIGHUP, 130 Ctrl-C or SIGINT, 143 SIGTERM: it was ended, and what is written is whole")]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Render a scene's frames into out/<scene>/<scene>.0000.png and so on
    Render(RenderArguments),
    /// Show a scene in the browser, and again after every edit
    Watch(WatchArguments),
    /// Say what is wrong with scenes: file, line, column, cause and remedy
    Check(CheckArguments),
    /// Tell which effects a scene calls for, why, and what each of them costs
    Explain(ExplainArguments),
    /// Measure what accuracy costs in time: errors and prices of all settings and effects
    Accuracy(AccuracyArguments),
    /// Compare two pictures: largest difference, RMS error, PSNR, SSIM and FLIP
    Compare(CompareArguments),
    /// Tell what a pixel sees, or what rays of one's own meet
    Probe(ProbeArguments),
    /// Say whether a folder of frames is whole: what is missing, torn, stale or surplus
    Verify(VerifyArguments),
    /// Print job scripts that render a sequence on a farm of machines
    Farm(FarmArguments),
    /// Write a small commented scene to start from
    New(NewArguments),
    /// Print completions for a shell
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
  rayreel render scenes/first_light.ron --draft
  rayreel render scenes/first_light.ron --samples 16 --set camera.fov=50 --without shadows
  rayreel render scenes/first_light.ron --max-error 0.5
  rayreel render scenes/first_light.ron --deadline 2m
  rayreel render scenes/first_light.ron --shard 0/4
  rayreel render scenes/first_light.ron --movie first_light.mp4
  rayreel render scenes/first_light.ron --out - | ffplay -
  rayreel render scenes/first_light.ron --format exr --alpha --passes depth,normal,id
  rayreel render scenes/first_light.ron --json > report.json

Frames that are done are kept: those whose files are whole, and were rendered from just what would be
rendered now. So the same command goes on where it was interrupted, and after an edit renders what
the edit changes. `rayreel verify` tells what is done.

Every frame is a function of the scene and its index: it has the same bytes whether it is rendered
alone or with the others, with one thread or many. Ctrl-C keeps the frames that are written, drops
the one being rendered, and exits with 130 (SIGTERM with 143, SIGHUP with 129); of a sheet it leaves
nothing. What a killed process left half-written in the folder is removed.")]
pub(super) struct RenderArguments {
    /// The scene file; - is standard input, of at most 1 GiB
    pub(super) scene: PathBuf,
    /// Only these frames: single ones, ranges and ranges with a stride, as in 10-20,30,40-80x5,90-
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(super) frames: Option<FrameList>,
    /// Only this moment, in seconds, as in 1.5s; it need not be a frame's
    #[arg(long, value_name = "SECONDS", conflicts_with = "frames", allow_hyphen_values = true)]
    pub(super) at: Option<Time>,
    /// Only one of several parts of the frames, for as many machines: its number, from 0, and how many there are, as in 0/4
    #[arg(long, value_name = "INDEX/COUNT", conflicts_with_all = ["at", "sheet"])]
    pub(super) shard: Option<Shard>,
    /// Which frames come first
    #[arg(long, value_enum, default_value_t = OrderName::Ascending, conflicts_with_all = ["at", "sheet"])]
    pub(super) order: OrderName,
    /// Render frames again that are done
    #[arg(long)]
    pub(super) overwrite: bool,
    /// Remove files from the folder that look like frames of this sequence and are none: of a longer timeline, or of another size
    #[arg(long, conflicts_with_all = ["at", "sheet"])]
    pub(super) clean: bool,
    /// The folder for the frame files; - is standard output, for programs that read video [default: out/<scene>]
    #[arg(long, value_name = "FOLDER")]
    pub(super) out: Option<PathBuf>,
    /// The names of the frame files without their endings, as shot_#### or shot_%04d: the number's digits are written there; a
    /// single frame needs no number
    /// [default: <scene>.####]
    #[arg(long, value_name = "PATTERN", conflicts_with_all = ["at", "sheet"])]
    pub(super) name: Option<FrameNames>,
    /// Pixels, instead of the scene's own, as in 1280x720
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, allow_hyphen_values = true)]
    pub(super) size: Option<(u32, u32)>,
    /// Put frames side by side into one picture, <scene>.sheet.png: as many as fit into so many columns and rows, spread evenly
    /// from the first to the last, each with its number and its time below. --size is the size of one of them; without it the
    /// sheet is at most 1920 pixels wide
    #[arg(long, value_name = "COLUMNSxROWS", value_parser = parse_sheet, conflicts_with = "at", allow_hyphen_values = true)]
    pub(super) sheet: Option<(u32, u32)>,
    /// Quick pictures to look at, in a folder draft within the other: a third of the film's width and height, unless --size
    /// says otherwise, one sample a pixel, sharp throughout, a depth of 5 at most, and 4 samples of an area light at most
    #[arg(long)]
    pub(super) draft: bool,
    /// Threads to render on [default: one a core]
    #[arg(long, value_name = "COUNT", value_parser = parse_threads, allow_hyphen_values = true)]
    pub(super) threads: Option<u16>,
    /// How exactly it is found where rays meet shapes
    #[arg(long, value_enum, default_value_t = PrecisionName::Guaranteed)]
    pub(super) precision: PrecisionName,
    /// Leave out rays that are too faint to be seen: those that certainly change a pixel, all together, by less than so many of
    /// the 255 steps of a colour. 0 follows them all [default: the scene's own]
    #[arg(long, value_name = "STEPS", value_parser = parse_cutoff, allow_hyphen_values = true)]
    pub(super) cutoff: Option<f32>,
    /// Add samples where they are needed until the estimated error of each frame is at most this many 8-bit levels, RMS or --norm; a frame depends
    /// on no other frame. --samples is the most that a pixel gets [default of that: 65536]
    #[arg(long, value_name = "STEPS", value_parser = parse_max_error, allow_hyphen_values = true, conflicts_with_all = ["deadline", "settings", "draft"])]
    pub(super) max_error: Option<f32>,
    /// Give frames as many samples as there is time for, so that all are rendered within it, as 90s, 10m or 1.5h
    #[arg(long, value_name = "TIME", value_parser = parse_duration, allow_hyphen_values = true, conflicts_with_all = ["settings", "draft", "samples"])]
    pub(super) deadline: Option<Duration>,
    /// Give frames the samples in this file, which --max-error and --deadline write beside the frames: the same bytes again
    #[arg(long, value_name = "FILE", conflicts_with_all = ["draft", "samples"])]
    pub(super) settings: Option<PathBuf>,
    /// Compute with every effect, also with those that the scene does not call for: slower, and the same bytes
    #[arg(long)]
    pub(super) full: bool,
    /// The files' format, or that of standard output [default: png, and y4m there]
    #[arg(long, value_enum)]
    pub(super) format: Option<Format>,
    /// Add passes to OpenEXR files: depth, distance, normal, id, albedo, position, with commas between them [default of the
    /// format then: exr]
    ///
    /// Passes describe the surface that the ray through the middle of each pixel hits first; they are never blurred. depth:
    /// distance from the eye along the camera's view axis, in scene units (channel Z). distance: distance from the eye along
    /// the ray. normal: unit normal in world space, on the visible side. id: index of the shape among the shapes drawn in the
    /// frame, in document order, from 1. albedo: k_d times the surface colour, linear. position: point in world space. The
    /// background has infinite depth and distance, and 0 in all other passes.
    #[arg(long, value_name = "PASSES")]
    pub(super) passes: Option<Passes>,
    /// Leave the background out, and tell which share of each pixel the scene covers, to put frames over other pictures: png, png16
    /// or exr
    #[arg(long)]
    pub(super) alpha: bool,
    /// Make a movie of the frames, too, once all are there: .mp4, .mov, .mkv or .webm by ffmpeg, or .gif or .apng
    #[arg(long, value_name = "FILE", value_parser = parse_movie, conflicts_with_all = ["at", "sheet", "shard"])]
    pub(super) movie: Option<PathBuf>,
    /// How it is told which frames are done
    #[arg(long, value_enum, default_value_t = ProgressName::Auto)]
    pub(super) progress: ProgressName,
    /// Tell nothing but warnings and errors
    #[arg(short, long)]
    pub(super) quiet: bool,
    /// Tell of every frame what it took, that it is kept, or why its file is not
    #[arg(short, long, conflicts_with_all = ["progress", "quiet"])]
    pub(super) verbose: bool,
    /// Print a report as one JSON object at the end: for every frame the seconds of each phase, the rays of each kind, the effects
    /// that were needed and how often plain arithmetic was not exact enough; and the most memory that was used
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) overrides: OverrideArguments,
}

/// Values in the place of the scene's own, for one run.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Instead of the scene's own")]
pub(super) struct OverrideArguments {
    /// A value in the place of another, both as in the file: camera.fov=40, entities.ball.shape.radius=2, film.transfer=Classic or
    /// 'materials.clay.color=(255, 0, 0)'. Lists are counted from 0, as in camera.position.1=3; what the file leaves out is added
    /// [can be repeated]
    #[arg(long = "set", value_name = "PATH=VALUE", allow_hyphen_values = true)]
    values: Vec<Override>,
    /// Samples per pixel: --set sampling.samples=COUNT
    #[arg(long, value_name = "COUNT", value_parser = parse_samples, allow_hyphen_values = true)]
    samples: Option<Override>,
    /// The fewest samples of a pixel with an error target: --set sampling.min_samples=COUNT
    #[arg(long, value_name = "COUNT", value_parser = parse_min_samples, allow_hyphen_values = true)]
    min_samples: Option<Override>,
    /// The norm of an error target: rms, max or p99, the 99th percentile: --set sampling.norm=Rms
    #[arg(long, value_name = "NORM", value_parser = parse_norm)]
    norm: Option<Override>,
    /// Generations of rays: --set quality.depth=COUNT
    #[arg(long, value_name = "COUNT", value_parser = parse_depth, allow_hyphen_values = true)]
    depth: Option<Override>,
    /// Leave an effect out, though the scene calls for it, as in --without shadows [can be repeated]
    #[arg(long, value_name = "EFFECT", value_parser = parse_effect)]
    pub(super) without: Vec<Effect>,
}

impl OverrideArguments {
    /// Returns the samples per pixel, if an override sets that value itself.
    pub(super) fn samples(&self) -> Option<u32> {
        self.last("sampling.samples")?.value().parse().ok()
    }

    /// Returns the last override of a value, which is the effective one.
    pub(super) fn last(&self, path: &str) -> Option<Override> {
        self.all().into_iter().rfind(|value| value.path().iter().map(String::as_str).eq(path.split('.')))
    }

    /// Returns all overrides in the order of application.
    pub(super) fn all(&self) -> Vec<Override> {
        let counts = self.samples.iter().chain(&self.min_samples).chain(&self.norm).chain(&self.depth);
        counts.chain(&self.values).cloned().collect()
    }
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

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ProgressName {
    /// A bar on a terminal; elsewhere a line for every frame, and one every ten seconds while a frame takes long
    Auto,
    /// A JSON object in a line of standard error for every frame, its event `kept` or `rendered`: its number, file, seconds, rays and
    /// error, and how many are done of how many; and while a frame takes long one a second, `rendering`, with the share that is done.
    /// Warnings, and without --quiet the lines at the end, are objects with a message: `warning` and `note`
    Json,
    /// Not at all
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum OrderName {
    /// One after the other
    Ascending,
    /// Every eighth, then those in the middle between them, and so on
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
pub(super) enum Format {
    /// Lossless, compressed, 8 bits a channel
    Png,
    /// The same with 16 bits a channel, for grading
    Png16,
    /// Portable pixmap, uncompressed, 8 bits a channel
    Ppm,
    /// Portable float map: linear light in 32 bits a channel, uncompressed
    Pfm,
    /// OpenEXR: linear light in 32 bits a channel, and what --passes asks for, compressed without loss
    Exr,
    /// On standard output: YUV4MPEG2, uncompressed video that says its size and rate; its colours are those of BT.709, 4:4:4
    Y4m,
    /// On standard output: red, green and blue of pixel after pixel, and nothing else
    Raw,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel watch scenes/first_light.ron
  rayreel watch scenes/first_light.ron --port 4000
  rayreel watch scenes/first_light.ron --out now.png
  rayreel watch scenes/first_light.ron --port 4000 --allow-host localhost:9000

Prints the address of a page for this machine's browser: the picture, the timeline, what is wrong
with the files, and what each pixel sees. Every save of the scene, of what it includes and of its
scripts is seen at once; while something is wrong with them, the last good scene stays.
Ctrl-C ends it, with 130.")]
pub(super) struct WatchArguments {
    /// The scene file
    pub(super) scene: PathBuf,
    /// The page's port on 127.0.0.1; 0 is one that is free [default: 0]
    #[arg(long, value_name = "NUMBER")]
    pub(super) port: Option<u16>,
    /// Answer under this name too, as localhost:9000 with `ssh -L 9000:127.0.0.1:4000`; without a port, at any [can be repeated]
    #[arg(long, value_name = "NAME[:PORT]")]
    pub(super) allow_host: Vec<HostName>,
    /// The first frame to show [default: 0]
    #[arg(long, value_name = "INDEX", value_parser = parse_index, allow_hyphen_values = true)]
    pub(super) frame: Option<u32>,
    /// Write the current frame to this file, .png, .ppm, .pfm or .exr, after every edit
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Look at the files ten times a second, where the system does not tell of changes: in network folders
    #[arg(long)]
    pub(super) poll: bool,
    #[command(flatten)]
    pub(super) overrides: OverrideArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  rayreel check scenes/*.ron

Scripts are run for the first, the middle and the last frame. Exits with 1 if any scene has a mistake.")]
pub(super) struct CheckArguments {
    /// The scene files
    #[arg(required = true)]
    pub(super) scenes: Vec<PathBuf>,
    /// Print a JSON list of mistakes, with line, column, cause and remedy
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) overrides: OverrideArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel explain scenes/first_light.ron
  rayreel explain scenes/first_light.ron --frames 0-47 --measure
  rayreel explain scenes/first_light.ron --json
  rayreel explain scenes/fly_around.ron --path path.svg

What a frame does not call for is left out, and left out for a reason: no material has the effect,
its coefficient is 0 at this time, the light is off, nothing moves while the shutter is open, or
nothing that shows it can be seen. The picture is the same, bit for bit, as with everything in it
(render --full).

Of more than 10000 frames so many are looked at, spread evenly. Rays and seconds are those of up to
three of them, spread over the timeline. What an effect costs is what is saved by rendering without
it; with --measure, in five rounds that take turns, with half of the distance between the extremes.
What it is worth (--measure) is how far the picture is then off, in steps of 8 bits: at most, and as
the root of the mean square.")]
pub(super) struct ExplainArguments {
    /// The scene file
    pub(super) scene: PathBuf,
    /// Only these frames: single ones, ranges and ranges with a stride, as in 10-20,30,40-80x5,90-
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(super) frames: Option<FrameList>,
    /// Pixels, instead of the scene's own, as in 1280x720
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, allow_hyphen_values = true)]
    pub(super) size: Option<(u32, u32)>,
    /// Threads to render on [default: one a core]
    #[arg(long, value_name = "COUNT", value_parser = parse_threads, allow_hyphen_values = true)]
    pub(super) threads: Option<u16>,
    /// Tell too what the picture loses without each effect
    #[arg(long)]
    pub(super) measure: bool,
    /// Draw the camera's path into this SVG file instead: from above, from the side, and its speed over time; of very many
    /// frames 4000, spread evenly
    #[arg(long, value_name = "FILE", conflicts_with_all = ["size", "threads", "measure", "json"])]
    pub(super) path: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) overrides: OverrideArguments,
}

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("question").required(true).args(["pixel", "rays"])))]
#[command(after_help = "Examples:
  rayreel probe scenes/first_light.ron --pixel 480,270
  rayreel probe scenes/first_light.ron --pixel 480,270 --frame 12 --json
  rayreel probe scenes/first_light.ron --rays rays.csv > hits.csv
  echo 0,1,-8,0,0,1 | rayreel probe scenes/first_light.ron --at 1.5s --rays -

A pixel is answered with the tree of its rays. What a ray finds gives light, the sum of what stands
below it; times the ray's throughput it goes to the pixel, whose colour is the sum over all rays.
Where pixels have several samples, this is one of them, and the pixel is the mean of all.

A ray is a line ox,oy,oz,dx,dy,dz, its origin and its direction, which may have any length but zero;
a first line with just these names is skipped. It is answered with a line
hit,entity,t,px,py,pz,nx,ny,nz: 1 and the first surface it meets, or 0 and nothing. The entity is
its name or, where it has none, # and its place in the scene's list from 0; the point is
origin + t direction, and t is left out where it is beyond 1.8e308, the largest number there is;
the normal is on the side that the ray came from. Both are the renderer's own
answers, and every number reads back to the same bits.")]
pub(super) struct ProbeArguments {
    /// The scene file
    pub(super) scene: PathBuf,
    /// Tell everything about this pixel: column and row from 0 at the top left
    #[arg(long, value_name = "COLUMN,ROW", value_parser = parse_pixel, allow_hyphen_values = true)]
    pub(super) pixel: Option<(u32, u32)>,
    /// Tell this sample of the pixel, from 0 [default: 0]
    #[arg(long, value_name = "INDEX", conflicts_with = "rays", value_parser = parse_index, allow_hyphen_values = true)]
    pub(super) sample: Option<u32>,
    /// Tell what the rays in this CSV file meet; - is standard input
    #[arg(long, value_name = "FILE")]
    pub(super) rays: Option<PathBuf>,
    /// The frame to look at [default: 0]
    #[arg(long, value_name = "INDEX", value_parser = parse_index, allow_hyphen_values = true)]
    pub(super) frame: Option<u32>,
    /// The moment to look at, in seconds, as in 1.5s; it need not be a frame's
    #[arg(long, value_name = "SECONDS", conflicts_with = "frame", allow_hyphen_values = true)]
    pub(super) at: Option<Time>,
    /// Pixels, instead of the scene's own, as in 1280x720
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, conflicts_with = "rays", allow_hyphen_values = true)]
    pub(super) size: Option<(u32, u32)>,
    /// Print JSON: one object for a pixel, one object a line for rays
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) overrides: OverrideArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel verify out/first_light
  rayreel verify out/first_light --frames 0-47 --json

Reads every frame to its last byte and holds it against the scene: `missing`, `torn` (not whole, or
with other pixels than were written), `stale` (not what would be rendered now) and `unknown` (not
known from what it was rendered), each with frames as `render --frames` takes them; and `surplus`,
files that look like frames and are none. Exits with 0 if all are whole and up to date, else with 1.")]
pub(super) struct VerifyArguments {
    /// The folder, as `render` has written it
    pub(super) folder: PathBuf,
    /// Only these frames: single ones, ranges and ranges with a stride, as in 10-20,30,40-80x5,90-
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(super) frames: Option<FrameList>,
    /// The scene file, if it is not where it was, or if there are frames of several scenes
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

The scene and the options are checked first. All machines must see the scene, and the folder of the
frames, under the same names. Every script ends with a job that verifies the frames. In a pipe to sh,
an error of farm leaves an empty script, and sh exits with 0, except after `set -o pipefail`.")]
pub(super) struct FarmArguments {
    /// Who distributes the work
    pub(super) scheduler: SchedulerName,
    /// The scene file
    pub(super) scene: PathBuf,
    /// How many jobs render a part of the frames each
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(super) shards: u32,
    /// The folder for the frame files [default: out/<scene>]
    #[arg(long, value_name = "FOLDER")]
    pub(super) out: Option<PathBuf>,
    /// The container image with rayreel in it, for Kubernetes
    #[arg(long, value_name = "IMAGE", value_parser = NonEmptyStringValueParser::new())]
    pub(super) image: Option<String>,
    /// The persistent volume claim with the scene in it, in whose folder jobs run, for Kubernetes
    #[arg(long, value_name = "NAME", value_parser = NonEmptyStringValueParser::new())]
    pub(super) claim: Option<String>,
    /// Further options of `render`, behind `--`
    #[arg(last = true, value_name = "OPTIONS")]
    pub(super) options: Vec<String>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum SchedulerName {
    /// A script that submits a job array, and a job that verifies it
    Slurm,
    /// A template of Open Job Description, 2023-09
    Openjd,
    /// An indexed job, and one that verifies it
    Kubernetes,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  rayreel new ball.ron && rayreel render ball.ron")]
pub(super) struct NewArguments {
    /// The file to write; it must not exist
    pub(super) file: PathBuf,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  rayreel man > rayreel.1
  rayreel man render | man -l -")]
pub(super) struct ManArguments {
    /// The command that the page is of; without it, of all
    pub(super) command: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "Example:
  rayreel completions bash > /etc/bash_completion.d/rayreel")]
pub(super) struct CompletionsArguments {
    /// The shell
    pub(super) shell: Shell,
}
