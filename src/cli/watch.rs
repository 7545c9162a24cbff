//! `rayreel watch`

use std::mem::ManuallyDrop;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, bail};

use indicatif::FormattedDuration;
use rayreel::live::{
    DEFAULT_CACHE, Event, ExportEnd, ExportState, PictureWarning, Server, Session, SessionSettings, Shown,
    Times, Watching,
};
use rayreel::output::{self, Channels, FrameFormat};
use rayreel::scene::input::is_stream;
use rayreel::trace::Passes;

use super::args::WatchArguments;
use super::exit::Failure;
use super::interrupt::Interruption;
use super::print;
use super::report::in_millions;

/// Interval between lines about the progress of an export.
const EXPORT_INTERVAL: Duration = Duration::from_secs(10);
/// Maximum delay until Ctrl-C is noticed.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

pub(super) fn run(arguments: &WatchArguments, interruption: &Interruption) -> Result<(), Failure> {
    if is_stream(&arguments.scene) {
        return Err(anyhow!("a scene from standard input cannot be read again: name a file to watch").into());
    }
    let interrupted = interruption.deferred();
    let mut printer = WatchPrinter::new(arguments)?;
    let (sender, events) = channel();
    let settings = SessionSettings {
        scene: arguments.scene.clone(),
        overrides: arguments.overrides.all(),
        without: arguments.overrides.without(),
        allowed: arguments.allowed.warnings.clone(),
        frame: arguments.frame.unwrap_or(0),
        watching: if arguments.poll { Watching::Polling } else { Watching::Events },
        finish: arguments.out.is_some(),
        editor: arguments.editor.clone(),
        cache_folder: arguments.cache_dir.clone(),
        cache: arguments.cache.map_or(DEFAULT_CACHE, |mebibytes| usize::from(mebibytes) << 20),
    };
    let mut reported = 0;
    // The session ends with the program, which does not wait for loading or rendering, only for the end of an export.
    let session = ManuallyDrop::new(Session::start(settings, move |event| {
        if should_report(&event, &mut reported) {
            // The receiver is dropped when the program ends.
            let _ = sender.send(event);
        }
    }));
    let server = Server::start_for(&arguments.allow_host, arguments.port.unwrap_or(0), session.handle())
        .with_context(|| match arguments.port.filter(|port| *port != 0) {
            Some(port) => {
                format!("cannot serve at port {port}; without --port one that is free is taken")
            }
            None => "cannot serve at any port of 127.0.0.1".to_owned(),
        })?;
    print::result_line(&format!("{}: http://{}/", arguments.scene.display(), server.address()))?;
    while !interrupted.load(Ordering::Relaxed) {
        match events.recv_timeout(POLL_INTERVAL) {
            Ok(event) => printer.print(event),
            Err(RecvTimeoutError::Timeout) => {
                printer.print_export(session.handle().export());
                printer.print_cache_error(session.handle().cache_error());
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(anyhow::anyhow!("the session has come to an end by itself").into());
            }
        }
    }
    session.handle().cancel_export();
    printer.print_export(session.handle().export());
    Err(interruption.failure())
}

/// Returns whether to report an event. Only the first full picture after each reload is reported; the other pictures, and values that are
/// tried there, appear only on the page. `reported` holds the reload count of the last reported picture.
fn should_report(event: &Event, reported: &mut u64) -> bool {
    let Event::Shown(shown) = event else { return true };
    shown.info.full
        && !shown.tried
        && std::mem::replace(reported, shown.info.reloads.max(*reported)) < shown.info.reloads
}

/// Reports events and writes the current frame to a file.
struct WatchPrinter {
    scene: String,
    out: Option<(PathBuf, FrameFormat)>,
    /// True once a scene has been loaded without mistakes.
    good: bool,
    /// The state of the export that was printed last, and when.
    export: Option<(ExportState, Instant)>,
    /// True once an error of the folder of the cache has been printed.
    has_cache_error: bool,
}

impl WatchPrinter {
    fn new(arguments: &WatchArguments) -> anyhow::Result<Self> {
        let out = arguments.out.clone().map(|path| Ok::<_, anyhow::Error>((path.clone(), format_of(&path)?)));
        if let Some(path) = &arguments.out {
            output::remove_leftovers(output::folder_of(path));
        }
        Ok(Self {
            scene: arguments.scene.display().to_string(),
            out: out.transpose()?,
            good: false,
            export: None,
            has_cache_error: false,
        })
    }

    /// Prints the beginning and the end of an export, and its progress from time to time.
    fn print_export(&mut self, export: Option<ExportState>) {
        let Some(export) = export else { return };
        let is_known = |(last, at): &(ExportState, Instant)| {
            (&last.target, &last.end) == (&export.target, &export.end)
                && (export.end.is_some() || last.done == export.done || at.elapsed() < EXPORT_INTERVAL)
        };
        if self.export.as_ref().is_some_and(is_known) {
            return;
        }
        let ExportState { target, done, total, left, end, .. } = &export;
        let left = left.map_or_else(String::new, |left| {
            format!(", {} left", FormattedDuration(Duration::from_secs_f64(left)))
        });
        print::error_line(&match end {
            None => format!("{target}: {done} of {total} frames are done{left}"),
            Some(ExportEnd::Complete) => format!("{target}: all {total} frames are done"),
            Some(ExportEnd::Cancelled) => format!("{target}: cancelled after {done} of {total} frames"),
            Some(ExportEnd::Failed(message)) => format!("{target}: {message}"),
        });
        self.export = Some((export, Instant::now()));
    }

    /// Prints the reason why no more frames are kept in the folder of the cache, once.
    fn print_cache_error(&mut self, error: Option<String>) {
        let Some(error) = error.filter(|_| !self.has_cache_error) else { return };
        self.has_cache_error = true;
        print::error_line(&format!("no more frames are kept in the folder: {error}"));
    }

    fn print(&mut self, event: Event) {
        match event {
            Event::Reloaded(Times { read, build, .. }) => {
                self.good = true;
                print::error_line(&format!("{}: read in {:.1} ms", self.scene, read + build));
            }
            Event::Broken(error) => {
                let stays =
                    if self.good { "the last good scene stays" } else { "there is nothing to show yet" };
                print::mistakes(|color| format!("{}\n", error.render(color)));
                print::error_line(&format!("{}: {stays}", self.scene));
            }
            Event::Failed(error) => Failure::from(error).print(),
            Event::NotShown(mistakes) => print::error_line(&mistakes.text),
            Event::Shown(shown) => self.show(&shown),
        }
    }

    fn show(&self, shown: &Shown) {
        let Times { animate, prepare, trace, reused, .. } = shown.times;
        let kept =
            if reused >= 0.01 { format!(" ({:.0} % kept)", (100.0 * reused).floor()) } else { String::new() };
        print::error_line(&format!(
            "{}: frame {}: animate {animate:.1} ms, prepare {prepare:.1} ms, trace {trace:.1} ms{kept}, {} rays",
            self.scene,
            shown.info.frame,
            in_millions(shown.rays as f64),
        ));
        for PictureWarning { message, help, place, .. } in &shown.warnings.list {
            let place = place.iter().map(|place| format!(" --> {place}"));
            print::warning(message, &place.chain([format!("  = help: {help}")]).collect::<Vec<_>>());
        }
        match shown.warnings.unlisted {
            0 => {}
            1 => print::warning("one more is not listed", &[]),
            count => print::warning(&format!("{count} more are not listed"), &[]),
        }
        if let Some((path, format)) = &self.out
            && let Err(error) = output::write(path, &shown.film, shown.transfer, *format)
        {
            Failure::from(anyhow::Error::from(error)).print();
        }
    }
}

fn format_of(path: &std::path::Path) -> anyhow::Result<FrameFormat> {
    let ending = path.extension().and_then(|ending| ending.to_str());
    let formats = [
        FrameFormat::default(),
        FrameFormat::Ppm,
        FrameFormat::Pfm,
        FrameFormat::Exr(Channels::Rgb, Passes::default()),
        FrameFormat::Hdr,
    ];
    match formats.into_iter().find(|format| ending == Some(format.extension())) {
        Some(format) => Ok(format),
        None => bail!("--out {}: the file must end in .png, .ppm, .pfm, .exr or .hdr", path.display()),
    }
}
