//! `rayreel farm`: job scripts for the schedulers of render farms. They are printed for review and submission.
//!
//! Each script renders a sequence in shards that share a folder, and then verifies the frames: schedulers report jobs as complete even if
//! their files are incomplete.

mod kubernetes;
mod openjd;
mod shell;
mod slurm;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail, ensure};
use clap::Parser;
use serde_json::Value;

use rayreel::scene::{input::is_stream, is_printable};
use rayreel::time::FrameList;

use super::args::{Arguments, Command, FarmArguments, RenderArguments, SchedulerName};
use super::exit::Failure;
use super::overrides::load;
use super::print;
use super::render::set_up;
use super::settings_file::SettingsFile;

pub(super) fn run(arguments: &FarmArguments) -> Result<(), Failure> {
    let script = match arguments.scheduler {
        SchedulerName::Slurm => slurm::script(&Farm::new(arguments)?)?,
        SchedulerName::Openjd => openjd::template(&Farm::new(arguments)?)?,
        SchedulerName::Kubernetes => {
            let (Some(image), Some(claim)) = (&arguments.image, &arguments.claim) else {
                return Err(anyhow!(
                    "a Kubernetes job needs --image, with rayreel in it, and --claim, with the scene in it"
                )
                .into());
            };
            kubernetes::manifests(&Farm::new(arguments)?, image, claim)?
        }
    };
    Ok(print::result(&script)?)
}

/// The sequence to render, and the number of jobs.
struct Farm {
    /// Path of the scene file, as seen from the folder where the job is submitted.
    scene: String,
    /// Path of the folder of the frames, as seen from the folder where the job is submitted.
    out: String,
    /// The name of the jobs.
    name: String,
    shards: u32,
    /// The frames to render; `None` for all.
    frames: Option<FrameList>,
    /// Further options of `render`.
    options: Vec<String>,
}

impl Farm {
    /// Checks everything that could make jobs fail: the scene, the options and the number of shards.
    fn new(arguments: &FarmArguments) -> Result<Self, Failure> {
        if is_stream(&arguments.scene) {
            return Err(anyhow!("jobs read the scene later, and not from standard input: name a file").into());
        }
        let rendered = render_arguments(arguments)?;
        let mut engine = load(&rendered.scene, &rendered.overrides)?;
        let settings = set_up(&mut engine, &rendered)?;
        if settings.stream.is_some() {
            return Err(
                anyhow!("jobs share a folder, and not standard output: name a folder with --out").into()
            );
        }
        if let Some(file) = &rendered.settings {
            let known = SettingsFile::read(file)?;
            if let Some(request) = settings.requests().find(|request| known.samples_of(request).is_none()) {
                return Err(anyhow!("`{}` has no settings for {}", file.display(), request.moment()).into());
            }
        }
        let (frames, shards) = (settings.count(), arguments.shards);
        if shards as usize > frames {
            return Err(anyhow!(
                "{shards} shards of {frames} frames leave some without any: write at most {frames}"
            )
            .into());
        }
        let out = path_text(settings.sequence.directory())?;
        Ok(Self {
            scene: path_text(&arguments.scene)?,
            // `verify` would parse a leading hyphen as an option.
            out: if out.starts_with('-') { format!("./{out}") } else { out },
            name: job_name(&arguments.scene)?,
            shards,
            frames: rendered.frames,
            options: arguments.options.clone(),
        })
    }

    /// Returns the words of the command of a shard. `literal` converts a text to a word of the scheduler's language. `shard` is the word of
    /// the option `--shard`, in which the scheduler substitutes the index.
    fn render<W>(&self, literal: impl Fn(&str) -> anyhow::Result<W>, shard: W) -> anyhow::Result<Vec<W>> {
        let out = format!("--out={}", self.out);
        let fixed = ["rayreel", "render", &self.scene, &out].map(&literal).into_iter();
        let options = self.options.iter().map(|option| literal(option));
        fixed.chain([Ok(shard)]).chain(options).collect()
    }

    /// Returns the words of the command that verifies the frames.
    fn verify<W>(&self, literal: impl Fn(&str) -> anyhow::Result<W>) -> anyhow::Result<Vec<W>> {
        let frames = self.frames.as_ref().map(|frames| format!("--frames={frames}"));
        ["rayreel", "verify", &self.out].into_iter().chain(frames.as_deref()).map(literal).collect()
    }
}

/// Parses the options after `--` as options of `render`, and rejects those that shards do not support.
fn render_arguments(arguments: &FarmArguments) -> anyhow::Result<RenderArguments> {
    let mut words: Vec<OsString> = ["rayreel", "render"].map(OsString::from).into();
    words.push(arguments.scene.clone().into());
    for option in &arguments.options {
        words.push(one_line(option)?.into());
    }
    let parsed = Arguments::try_parse_from(words).map_err(|error| {
        if !error.use_stderr() {
            return anyhow!("--help and --version are not for farms: try `rayreel render --help`");
        }
        // Only the cause is kept: the usage describes another command.
        let message = error.to_string();
        let cause = message.split("\n\n").next().unwrap_or_default().trim_start_matches("error: ");
        let cause: Vec<&str> = cause.lines().map(str::trim).collect();
        anyhow!("in the options after `--`, those of `render`: {}", cause.join(" "))
    })?;
    let Command::Render(mut rendered) = parsed.command else { bail!("these are no options of `render`") };
    for (is_given, option, reason) in [
        (rendered.out.is_some(), "--out", "write it before `--`"),
        (rendered.shard.is_some(), "--shard", "each job gets its own"),
        (rendered.at.is_some(), "--at", "a moment has no shards"),
        (rendered.sheet.is_some(), "--sheet", "a sheet has no shards"),
        (!rendered.variants.is_empty(), "--variants", "a sheet has no shards"),
        (rendered.movie.is_some(), "--movie", "make it once all frames are there"),
        (rendered.clean, "--clean", "a shard knows nothing of the others"),
        (rendered.deadline.is_some(), "--deadline", "each job would have all of that time"),
        (
            rendered.max_error.is_some(),
            "--max-error",
            "jobs would write each other's choice: set sampling.max_error instead",
        ),
        (rendered.draft, "--draft", "drafts are quick enough"),
    ] {
        ensure!(!is_given, "{option} is not for farms: {reason}");
    }
    rendered.out.clone_from(&arguments.out);
    Ok(rendered)
}

/// Returns the text of a path, or an error if it is not UTF-8.
fn path_text(path: &Path) -> anyhow::Result<String> {
    let words = path.to_str();
    words
        .map(str::to_owned)
        .with_context(|| format!("`{}` is not UTF-8 text, as scripts are", path.display()))
}

/// Returns the text, or an error if a script cannot hold it: it must be printable and on one line.
fn one_line(text: &str) -> anyhow::Result<&str> {
    ensure!(
        text.chars().all(is_printable),
        "`{text}` has a line end or a control character, which job scripts cannot hold: write it on one line, without"
    );
    Ok(text)
}

/// Formats a JSON document that is also valid YAML: escapes the two characters that JSON allows and YAML does not.
fn document(value: &Value) -> anyhow::Result<String> {
    let text = serde_json::to_string_pretty(value)?;
    Ok(format!("{}\n", text.replace('\u{fffe}', "\\ufffe").replace('\u{ffff}', "\\uffff")))
}

/// Returns a job name that every scheduler accepts: lower-case letters, digits and hyphens.
fn job_name(scene: &Path) -> anyhow::Result<String> {
    let stem = PathBuf::from(scene.file_stem().context("the scene has no name")?);
    let letters = stem.to_string_lossy().to_lowercase();
    let name: String =
        letters.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '-' }).collect();
    let name: String = name.trim_matches('-').chars().take(40).collect();
    let name = name.trim_end_matches('-');
    Ok(if name.is_empty() { "rayreel".to_owned() } else { format!("rayreel-{name}") })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn job_names_are_valid_for_schedulers() {
        for (scene, name) in [
            ("a/First_Light.ron", "rayreel-first-light"),
            ("\u{e9}.ron", "rayreel"),
            ("-a-.ron", "rayreel-a"),
        ] {
            assert_eq!(job_name(Path::new(scene)).unwrap(), name);
        }
    }
}
