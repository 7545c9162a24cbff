//! `rayreel verify`

use std::ops::ControlFlow::{Break, Continue};
use std::path::Path;
use std::sync::atomic::Ordering;

use anyhow::anyhow;
use serde_json::json;

use rayreel::sequence::{FrameVerdict, SequenceVerdict, Surplus, VerifyError, verify_sequence};
use rayreel::time::FrameList;

use super::args::VerifyArguments;
use super::exit::Failure;
use super::interrupt::Interruption;
use super::manifest;
use super::overrides::load;
use super::print;
use super::progress;
use super::render::set_up;
use super::settings::require_frame;
use super::settings_file::SettingsFile;

pub(super) fn run(arguments: &VerifyArguments, interruption: &Interruption) -> Result<(), Failure> {
    let rendered = manifest::render_arguments(&arguments.folder, arguments.scene.as_deref())?;
    let mut engine = load(&rendered.scene, &rendered.overrides)?;
    let settings = set_up(&mut engine, &rendered)?;
    let timeline = engine.timeline;
    let all = FrameList::all(timeline.frame_count());
    let frames = arguments
        .frames
        .clone()
        .or_else(|| rendered.frames.clone())
        .unwrap_or(all)
        .within(timeline.frame_count());
    require_frame(frames.last(), timeline)?;
    let samples = match &rendered.settings {
        Some(file) if file.exists() => Some(SettingsFile::read(file)?),
        _ => None,
    };
    let cancelled = interruption.deferred();
    let own = engine.settings;
    let bar = progress::plain_bar(frames.count());
    let verdict = verify_sequence(&mut engine, &frames, &settings.sequence, |engine, request| {
        bar.inc(1);
        let chosen = samples.as_ref().and_then(|samples| samples.samples_of(request));
        match chosen {
            Some(samples) => samples.set_up(engine),
            None => engine.settings = own,
        }
        if cancelled.load(Ordering::Relaxed) { Break(()) } else { Continue(()) }
    });
    bar.finish_and_clear();
    let verdict = match verdict {
        Ok(verdict) => verdict,
        Err(VerifyError::Engine(error)) => return Err(error.into()),
        Err(error) => return Err(anyhow!(error).into()),
    };
    if cancelled.load(Ordering::Relaxed) {
        return Err(interruption.failure());
    }
    if arguments.json {
        print::json(to_json(&verdict, &rendered.scene.display().to_string()))?;
    } else {
        print_verdict(&verdict, arguments, &rendered.scene)?;
    }
    if verdict.is_complete() { Ok(()) } else { Err(Failure::Reported) }
}

/// Returns the kinds of invalid frames with the frames of each kind, in the order of the report.
fn kinds(verdict: &SequenceVerdict) -> [(&'static str, Option<FrameList>); 4] {
    [
        ("missing", verdict.frames_with(|frame| *frame == FrameVerdict::Missing)),
        ("torn", verdict.frames_with(|frame| matches!(frame, FrameVerdict::Corrupt(_)))),
        (
            "stale",
            verdict.frames_with(|frame| matches!(frame, FrameVerdict::Stale | FrameVerdict::OtherSize(..))),
        ),
        ("unknown", verdict.frames_with(|frame| *frame == FrameVerdict::Unknown)),
    ]
}

fn print_verdict(verdict: &SequenceVerdict, arguments: &VerifyArguments, scene: &Path) -> anyhow::Result<()> {
    let (folder, scene) = (arguments.folder.display(), scene.display());
    let complete = verdict.frames.iter().filter(|(_, frame)| *frame == FrameVerdict::UpToDate).count();
    let count = verdict.frames.len();
    print::result_line(&format!(
        "{folder}: {complete} of {count} frames of {scene} are complete and up to date"
    ))?;
    for (name, frames) in kinds(verdict) {
        if let Some(frames) = frames {
            print::result_line(&format!("{name} {frames}"))?;
        }
    }
    for (frame, reason) in corrupt(verdict).take(MOST) {
        print::result_line(&format!("  frame {frame}: {reason}"))?;
    }
    for Surplus { path, reason } in &verdict.surplus {
        print::result_line(&format!("surplus {}: {reason}", path.display()))?;
    }
    if let Some(frames) = verdict.to_render() {
        print::error_line(&format!(
            "the same `rayreel render` renders them again, and nothing else; only these: --frames {frames}"
        ));
    }
    if !verdict.surplus.is_empty() {
        print::error_line("`rayreel render` with --clean removes what is surplus");
    }
    Ok(())
}

/// Maximum number of frames whose damage is described.
const MOST: usize = 10;

fn corrupt(verdict: &SequenceVerdict) -> impl Iterator<Item = (u32, &str)> {
    verdict.frames.iter().filter_map(|(frame, of_frame)| match of_frame {
        FrameVerdict::Corrupt(reason) => Some((*frame, reason.as_str())),
        _ => None,
    })
}

fn to_json(verdict: &SequenceVerdict, scene: &str) -> serde_json::Value {
    let list =
        |frames: Option<FrameList>| frames.map_or_else(Vec::new, |list| list.frames().collect::<Vec<_>>());
    let [missing, corrupt_frames, stale, unknown] = kinds(verdict).map(|(_, frames)| list(frames));
    let surplus = |Surplus { path, reason }: &Surplus| json!({ "file": path.display().to_string(), "reason": reason.to_string() });
    let damage = |(frame, reason): (u32, &str)| json!({ "frame": frame, "reason": reason });
    json!({
        "scene": scene,
        "whole": verdict.is_complete(),
        "frames": verdict.frames.len(),
        "missing": missing,
        "torn": corrupt_frames,
        "stale": stale,
        "unknown": unknown,
        "damage": corrupt(verdict).map(damage).collect::<Vec<_>>(),
        "surplus": verdict.surplus.iter().map(surplus).collect::<Vec<_>>(),
        "to_render": verdict.to_render().map(|frames| frames.to_string()),
    })
}
