//! `rayreel farm`: job scripts for the schedulers of render farms. They are printed, to be looked at and handed over.
//!
//! Each renders a sequence in shards, which share a folder, and looks afterwards at what is there: schedulers call jobs complete whose files
//! are not.

mod kubernetes;
mod openjd;
mod slurm;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail, ensure};
use clap::Parser;

use rayreel::scene::input::is_stream;
use rayreel::time::FrameList;

use super::args::{Arguments, Command, FarmArguments, RenderArguments, SchedulerName};
use super::exit::Failure;
use super::overrides::load;
use super::print;
use super::render::set_up;

pub(super) fn run(arguments: &FarmArguments) -> Result<(), Failure> {
    let script = match arguments.scheduler {
        SchedulerName::Slurm => slurm::script(&Farm::new(arguments)?),
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

/// What is rendered, and by how many.
struct Farm {
    /// The scene file, as a job sees it from the folder where it was submitted.
    scene: String,
    /// The folder of the frames, likewise.
    out: String,
    /// By what the jobs are called.
    name: String,
    shards: u32,
    /// Further options of `render`.
    options: Vec<String>,
}

impl Farm {
    /// Checks all that jobs would stumble over: the scene, the options, and the number of shards.
    fn new(arguments: &FarmArguments) -> Result<Self, Failure> {
        if is_stream(&arguments.scene) {
            return Err(anyhow!("jobs read the scene later, and not from standard input: name a file").into());
        }
        let rendered = render_arguments(arguments)?;
        let mut engine = load(&rendered.scene, &rendered.overrides)?;
        let settings = set_up(&mut engine, &rendered)?;
        let (frames, shards) = (settings.count(), arguments.shards);
        if shards as usize > frames {
            return Err(anyhow!(
                "{shards} shards of {frames} frames leave some without any: write at most {frames}"
            )
            .into());
        }
        let name = job_name(&arguments.scene)?;
        Ok(Self {
            scene: in_words(&arguments.scene)?,
            out: in_words(settings.sequence.directory())?,
            name,
            shards,
            options: arguments.options.clone(),
        })
    }

    /// Returns the words of the command of a shard, whose number is put in by the scheduler.
    fn render(&self, index: &str) -> Vec<String> {
        let fixed = ["rayreel", "render", &self.scene, "--out", &self.out, "--shard"];
        let shard = format!("{index}/{}", self.shards);
        fixed.into_iter().map(str::to_owned).chain([shard]).chain(self.options.iter().cloned()).collect()
    }

    /// Returns the words of the command that looks at what is there: at the frames that were asked for.
    fn verify(&self) -> Vec<String> {
        let mut words: Vec<String> = ["rayreel", "verify", &self.out].map(str::to_owned).into();
        words.extend(self.frames().map(|frames| format!("--frames={frames}")));
        words
    }

    /// Returns the frames that were asked for, if not all are.
    fn frames(&self) -> Option<FrameList> {
        let mut options = self.options.iter();
        while let Some(option) = options.next() {
            let list = match option.strip_prefix("--frames") {
                Some("") => options.next().cloned(),
                Some(list) => list.strip_prefix('=').map(str::to_owned),
                None => None,
            };
            if let Some(list) = list {
                return list.parse().ok();
            }
        }
        None
    }
}

/// Reads the options behind `--` as `render` would, and refuses those that shards cannot have.
fn render_arguments(arguments: &FarmArguments) -> anyhow::Result<RenderArguments> {
    let mut words: Vec<OsString> = ["rayreel", "render"].map(OsString::from).into();
    words.push(arguments.scene.clone().into());
    words.extend(arguments.options.iter().map(OsString::from));
    let parsed =
        Arguments::try_parse_from(words).map_err(|error| anyhow!("{}", error.render().to_string().trim()))?;
    let Command::Render(mut rendered) = parsed.command else { bail!("these are no options of `render`") };
    for (is_given, option, reason) in [
        (rendered.out.is_some(), "--out", "write it before `--`"),
        (rendered.shard.is_some(), "--shard", "each job gets its own"),
        (rendered.at.is_some(), "--at", "a moment has no shards"),
        (rendered.sheet.is_some(), "--sheet", "a sheet has no shards"),
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

fn in_words(path: &Path) -> anyhow::Result<String> {
    let words = path.to_str().with_context(|| format!("`{}` is no text, as scripts are", path.display()))?;
    ensure!(
        !words.contains('\n') && !words.contains('\0'),
        "`{}` has a line end in its name",
        path.display()
    );
    Ok(words.to_owned())
}

/// Returns a name that every scheduler takes: small letters, digits and hyphens.
fn job_name(scene: &Path) -> anyhow::Result<String> {
    let stem = PathBuf::from(scene.file_stem().context("the scene has no name")?);
    let letters = stem.to_string_lossy().to_lowercase();
    let name: String =
        letters.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '-' }).collect();
    let name: String = name.trim_matches('-').chars().take(40).collect();
    let name = name.trim_end_matches('-');
    Ok(if name.is_empty() { "rayreel".to_owned() } else { format!("rayreel-{name}") })
}

/// Quotes a word for a POSIX shell.
fn quoted(word: &str) -> String {
    let is_plain = |character: char| character.is_ascii_alphanumeric() || "-_./=:,@%+".contains(character);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// Quotes words, and puts them in a line.
fn line(words: &[String]) -> String {
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_as_shells_need_it() {
        for (word, expected) in [
            ("a/b.ron", "a/b.ron"),
            ("it's", "'it'\\''s'"),
            ("", "''"),
            ("a b", "'a b'"),
            ("$HOME", "'$HOME'"),
        ] {
            assert_eq!(quoted(word), expected);
        }
    }

    #[test]
    fn names_are_those_that_schedulers_take() {
        for (scene, name) in [
            ("a/First_Light.ron", "rayreel-first-light"),
            ("\u{e9}.ron", "rayreel"),
            ("-a-.ron", "rayreel-a"),
        ] {
            assert_eq!(job_name(Path::new(scene)).unwrap(), name);
        }
    }
}
