//! Validated render settings, derived from the arguments.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};

use rayreel::components::FilmSettings;
use rayreel::output::{Channels, FrameFormat, Sequence, Sheet, VideoFormat};
use rayreel::scene::input::is_stream;
use rayreel::sequence::{Existing, FrameRequest, RenderOrder};
use rayreel::time::{FrameList, Timeline};
use rayreel::{Effect, Time};

use super::args::{FormatName, ProgressName, RenderArguments};
use super::values::effect_name;

/// The pictures to render.
#[derive(Clone, Debug)]
enum Selection {
    Moment(Time),
    Frames(FrameList, Timeline),
    /// An empty shard: there are more shards than frames.
    Nothing,
}

/// The pictures to render and their destination.
#[derive(Debug)]
pub(super) struct OutputSettings {
    selection: Selection,
    order: RenderOrder,
    pub(super) sequence: Sequence,
    pub(super) existing: Existing,
    /// Columns and rows of the sheet, if all pictures go to one.
    pub(super) sheet: Option<(u32, u32)>,
    /// The effects without which the picture is rendered again, each next to the picture with all effects on the sheet.
    pub(super) variants: Vec<Effect>,
    /// Format of the frames on standard output, if they go there.
    pub(super) stream: Option<VideoFormat>,
    pub(super) progress: ProgressOutput,
    pub(super) size: Option<(u32, u32)>,
    pub(super) threads: Option<usize>,
}

impl OutputSettings {
    /// Validates the arguments for a scene with this timeline and this film.
    pub(super) fn new(
        arguments: &RenderArguments,
        timeline: Timeline,
        film: FilmSettings,
    ) -> anyhow::Result<Self> {
        let last = timeline.frame_count() - 1;
        let name = scene_name(&arguments.scene)?;
        let mut directory = arguments.out.clone().unwrap_or_else(|| Path::new("out").join(name));
        if arguments.draft {
            directory.push("draft");
        } else if let Some((width, height)) = own_folder_size(arguments, film) {
            directory.push(format!("{width}x{height}"));
        }
        let (format, stream) = formats(arguments)?;
        let mut sequence = Sequence::new(directory, name, last, format);
        if let Some(names) = &arguments.name {
            sequence = sequence.with_names(names.clone());
        }
        let selection = match arguments.at {
            Some(time) => Selection::Moment(time),
            None => {
                let frames = arguments.frames.clone().unwrap_or_else(|| FrameList::all(last + 1));
                let frames = frames.within(last + 1);
                require_frame(frames.last(), timeline)?;
                if let Some(names) = arguments.name.as_ref().filter(|names| !names.have_numbers()) {
                    ensure!(
                        frames.count() == 1,
                        "`{names}` is the name of one frame, and {} are rendered: write a place for their numbers, as --name={names}####",
                        frames.count()
                    );
                }
                let sheet = arguments.sheet.filter(|_| arguments.variants.is_empty());
                let most = sheet.map(|(columns, rows)| columns * rows);
                let frames = most.map_or_else(|| frames.clone(), |most| frames.spread(most));
                match arguments.shard.map_or_else(|| Some(frames.clone()), |shard| shard.of(&frames)) {
                    Some(frames) => Selection::Frames(frames, timeline),
                    None => Selection::Nothing,
                }
            }
        };
        let variants = variants(arguments)?;
        let sheet = match variants.len() {
            0 => arguments.sheet.map(|(columns, _)| filled(columns, selection.count())),
            count => Some(sheet_of_variants(arguments.sheet, count + 1, selection.count())?),
        };
        let fitting = sheet.map(|(columns, _)| Sheet::fitting_tile(columns, (film.width, film.height)));
        let size = arguments.size.or(fitting);
        let existing = if arguments.overwrite { Existing::Overwrite } else { Existing::Keep };
        let (order, threads) = (arguments.order.into(), arguments.threads.map(usize::from));
        let progress = ProgressOutput::new(arguments);
        Ok(Self { selection, order, sequence, existing, sheet, variants, stream, progress, size, threads })
    }
}

/// Returns the size of frames that go to a subfolder: a test in another size than the scene's keeps finished frames as they are.
fn own_folder_size(arguments: &RenderArguments, film: FilmSettings) -> Option<(u32, u32)> {
    let makes_frames = arguments.sheet.is_none() && arguments.variants.is_empty();
    let size = arguments.size.filter(|size| *size != (film.width, film.height))?;
    (makes_frames && arguments.out.is_none()).then_some(size)
}

/// The kind of progress output.
#[derive(Clone, Copy, Debug)]
pub(super) enum ProgressOutput {
    Auto,
    Details,
    Json,
    Nothing,
}

impl ProgressOutput {
    fn new(arguments: &RenderArguments) -> Self {
        match arguments.progress {
            ProgressName::Json => Self::Json,
            _ if arguments.quiet => Self::Nothing,
            _ if arguments.verbose => Self::Details,
            ProgressName::Auto => Self::Auto,
            ProgressName::None => Self::Nothing,
        }
    }
}

impl OutputSettings {
    /// Returns whether the pictures are frames with a file each.
    pub(super) fn are_frames(&self) -> bool {
        self.sheet.is_none() && self.stream.is_none() && !matches!(self.selection, Selection::Moment(_))
    }

    /// Returns all pictures in the order of rendering.
    pub(super) fn requests(&self) -> Box<dyn Iterator<Item = FrameRequest> + '_> {
        match &self.selection {
            Selection::Moment(time) => Box::new(std::iter::once(FrameRequest { frame: None, time: *time })),
            Selection::Frames(frames, timeline) => {
                Box::new(self.order.of(frames).map(|index| FrameRequest::frame(index, *timeline)))
            }
            Selection::Nothing => Box::new(std::iter::empty()),
        }
    }

    /// Returns all pictures in ascending order of time.
    pub(super) fn ascending(&self) -> Box<dyn Iterator<Item = FrameRequest> + '_> {
        match &self.selection {
            Selection::Frames(frames, timeline) => Box::new(FrameRequest::frames(frames, *timeline)),
            Selection::Moment(_) | Selection::Nothing => self.requests(),
        }
    }

    /// Returns the number of pictures.
    pub(super) fn count(&self) -> usize {
        self.selection.count() * (1 + self.variants.len())
    }

    /// Returns the path of the sheet.
    pub(super) fn file_of_sheet(&self) -> PathBuf {
        if self.variants.is_empty() { self.sequence.sheet() } else { self.sequence.variants() }
    }

    /// Returns the path of the settings file.
    pub(super) fn file_of_settings(&self) -> PathBuf {
        if self.sheet.is_some() { self.sequence.sheet_settings() } else { self.sequence.settings() }
    }
}

impl Selection {
    fn count(&self) -> usize {
        match self {
            Self::Moment(_) => 1,
            Self::Nothing => 0,
            Self::Frames(frames, _) => frames.count(),
        }
    }
}

/// Returns the format of files and, if frames go to standard output, the format of the stream.
fn formats(arguments: &RenderArguments) -> anyhow::Result<(FrameFormat, Option<VideoFormat>)> {
    let is_stream = arguments.out.as_deref() == Some(Path::new("-"));
    if is_stream { format_of_stream(arguments) } else { Ok((format_of_files(arguments)?, None)) }
}

fn format_of_files(arguments: &RenderArguments) -> anyhow::Result<FrameFormat> {
    let passes = arguments.passes.unwrap_or_default();
    let channels = if arguments.alpha { Channels::Rgba } else { Channels::Rgb };
    let format = match arguments.format {
        None if !passes.is_empty() => FrameFormat::Exr(channels, passes),
        None | Some(FormatName::Png) => FrameFormat::Png(channels),
        Some(FormatName::Png16) => FrameFormat::Png16(channels),
        Some(FormatName::Ppm) => FrameFormat::Ppm,
        Some(FormatName::Pfm) => FrameFormat::Pfm,
        Some(FormatName::Exr) => FrameFormat::Exr(channels, passes),
        Some(FormatName::Hdr) => FrameFormat::Hdr,
        Some(FormatName::Y4m | FormatName::Raw) => bail!("y4m and raw are for standard output: add --out -"),
    };
    ensure!(format.passes() == passes, "--passes are for --format exr: other files have no room for them");
    ensure!(
        format.channels() == channels,
        "--alpha is for --format png, png16 or exr: other files have no room for it"
    );
    let of_bytes = [
        (arguments.sheet.is_some(), "--sheet"),
        (!arguments.variants.is_empty(), "--variants"),
        (arguments.movie.is_some(), "--movie"),
    ];
    if let Some((_, option)) = of_bytes.into_iter().find(|(is_given, _)| *is_given && format.is_linear()) {
        bail!("{option} is made of colours in 8 bits: it takes --format png or ppm, without --alpha");
    }
    Ok(format)
}

fn format_of_stream(arguments: &RenderArguments) -> anyhow::Result<(FrameFormat, Option<VideoFormat>)> {
    let others = [
        (arguments.json, "--json writes to standard output, too"),
        (arguments.sheet.is_some(), "--sheet makes one file"),
        (!arguments.variants.is_empty(), "--variants makes one file"),
        (arguments.passes.is_some(), "--passes are for files"),
        (arguments.alpha, "--alpha is for files"),
        (arguments.draft, "--draft makes files in a folder of their own"),
        (arguments.movie.is_some(), "--movie is made of files"),
        (arguments.max_error.is_some(), "--max-error writes the selected samples next to the frames"),
        (arguments.deadline.is_some(), "--deadline writes the selected samples next to the frames"),
    ];
    if let Some((_, reason)) = others.into_iter().find(|(is_given, _)| *is_given) {
        bail!("frames cannot go to standard output: {reason}; name a folder with --out");
    }
    match arguments.format {
        None | Some(FormatName::Y4m) => Ok((FrameFormat::default(), Some(VideoFormat::Y4m))),
        Some(FormatName::Raw) => Ok((FrameFormat::default(), Some(VideoFormat::Raw))),
        Some(
            FormatName::Png
            | FormatName::Png16
            | FormatName::Ppm
            | FormatName::Pfm
            | FormatName::Exr
            | FormatName::Hdr,
        ) => {
            bail!(
                "png, ppm, pfm, exr and hdr are files: standard output takes --format y4m or raw; `--out ./-` is a folder of that name"
            )
        }
    }
}

/// Returns the effects of `--variants`, each once.
fn variants(arguments: &RenderArguments) -> anyhow::Result<Vec<Effect>> {
    let disabled = arguments.overrides.without();
    let mut variants = Vec::new();
    for effect in arguments.variants.iter().copied() {
        ensure!(
            !disabled.contains(effect),
            "--variants {0}: the picture has no {effect} in any variant, as --without or --only disables it: omit one of them",
            effect_name(effect)
        );
        if !variants.contains(&effect) {
            variants.push(effect);
        }
    }
    Ok(variants)
}

/// Returns the columns and rows of a sheet with `count` variants of a picture. `pictures` is the number of chosen pictures.
fn sheet_of_variants(sheet: Option<(u32, u32)>, count: usize, pictures: usize) -> anyhow::Result<(u32, u32)> {
    ensure!(
        pictures == 1,
        "--variants show one frame, and {pictures} are chosen: choose one, as --frames 0, or a moment, as --at 1s"
    );
    let Some((columns, rows)) = sheet else {
        // Up to three pictures are in a row, and more in a grid that is not higher than wide.
        let columns = (count.min(3)..).find(|columns| columns * columns >= count).unwrap_or(count);
        return Ok(filled(u32::try_from(columns).unwrap_or(u32::MAX), count));
    };
    ensure!(
        (columns * rows) as usize >= count,
        "--sheet {columns}x{rows} has no room for {count} pictures: write --sheet {columns}x{}",
        count.div_ceil(columns as usize)
    );
    Ok(filled(columns, count))
}

/// Returns the columns and rows that `count` pictures fill.
fn filled(columns: u32, count: usize) -> (u32, u32) {
    // A sheet has at most 10 000 tiles.
    let count = u32::try_from(count).unwrap_or(u32::MAX);
    (columns.min(count), count.div_ceil(columns))
}

/// Returns an error if the timeline has no such frame.
pub(super) fn require_frame(index: u32, timeline: Timeline) -> anyhow::Result<()> {
    ensure!(index < timeline.frame_count(), "there is no frame {index}: {}", describe_timeline(timeline));
    Ok(())
}

/// Returns the file's name without its extension, or `stdin` for standard input.
fn scene_name(path: &Path) -> anyhow::Result<&OsStr> {
    if is_stream(path) {
        return Ok(OsStr::new("stdin"));
    }
    path.file_stem().with_context(|| format!("`{}` does not name a file", path.display()))
}

fn describe_timeline(timeline: Timeline) -> String {
    match timeline.frame_count() {
        1 => "the scene is a single frame, 0".to_owned(),
        count => format!(
            "the timeline of {} s at {} frames a second has frames 0 to {}",
            timeline.duration,
            timeline.rate.per_second(),
            count - 1
        ),
    }
}
