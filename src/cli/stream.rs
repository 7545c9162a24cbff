//! `rayreel render --out -`: streams frames to standard output.

use std::io::{ErrorKind, stdout};
use std::sync::atomic::AtomicBool;

use anyhow::Context;

use rayreel::Engine;
use rayreel::output::{VideoFormat, VideoStream};
use rayreel::sequence::{FormerFrame, render_encoded};

use super::choice::SampleSelection;
use super::exit::Failure;
use super::interrupt::unless_cancelled;
use super::progress::Progress;
use super::report::{RenderReport, RenderedFrameReport};
use super::settings::OutputSettings;

/// Renders and writes every frame, until cancellation or until the reader closes the pipe, which is not a failure.
pub(super) fn render(
    engine: &mut Engine,
    settings: &OutputSettings,
    choice: &mut SampleSelection,
    format: VideoFormat,
    cancelled: &AtomicBool,
    report: &mut RenderReport,
) -> Result<(), Failure> {
    let (mut progress, mut former) = (Progress::start(settings), FormerFrame::default());
    let mut stream = VideoStream::new(stdout(), format, engine.timeline.rate);
    for request in settings.requests() {
        choice.begin(engine, &request);
        choice.render(engine);
        let film = render_encoded(engine, &request, &mut former, cancelled, &mut |so_far| {
            progress.rendering(&request, so_far);
        })?;
        let Some(film) = film else { return Ok(()) };
        choice.end(engine, &request)?;
        report.warnings.collect(engine, &request.moment());
        let written = unless_cancelled(cancelled, move || {
            let written = stream.add(&film);
            (stream, written)
        });
        let Some((next, written)) = written else { return Ok(()) };
        stream = next;
        match written {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                report.unread = true;
                return Ok(());
            }
            written => written.context("cannot write to standard output")?,
        }
        let rendered = RenderedFrameReport::new(&request, None, engine.report());
        progress.done(&rendered);
        report.frames.push(rendered);
    }
    Ok(())
}
