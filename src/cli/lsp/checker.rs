//! Diagnostics: the mistakes and warnings of `rayreel check`, on a thread of its own.
//!
//! A text is checked once the check before it has ended. A newer text replaces one that waits, and cancels the frames of one that is being
//! checked.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use serde_json::{Value, json};

use rayreel::Scene;
use rayreel::scene::{Diagnostic, Inclusion, LoadError, SourcePosition};
use rayreel::trace::Signals;

use super::positions::{byte_of, line_span, path_of, range};
use crate::cli::args::AllowArguments;
use crate::cli::check::{CheckFailed, CheckPassed, check};
use crate::cli::print;

/// Severities of the protocol.
const ERROR: u32 = 1;
const WARNING: u32 = 2;

#[derive(Debug)]
pub(super) struct Checker(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    waiting: Mutex<WaitingTexts>,
    is_changed: Condvar,
    /// True while the text that is being checked is out of date.
    cancelled: AtomicBool,
}

#[derive(Debug, Default)]
struct WaitingTexts {
    /// The texts to check by their URIs, each with its version.
    texts: BTreeMap<String, (Value, String)>,
    /// The URI of the text that is being checked.
    checked: Option<String>,
}

impl Checker {
    pub(super) fn start(allowed: AllowArguments) -> Self {
        let shared = Arc::new(Shared::default());
        let of_thread = Arc::clone(&shared);
        thread::spawn(move || of_thread.run(&allowed));
        Self(shared)
    }

    /// Checks a text soon.
    pub(super) fn submit(&self, uri: &str, version: Value, text: String) {
        let mut waiting = self.0.waiting();
        self.0.cancel(&waiting, uri);
        waiting.texts.insert(uri.to_owned(), (version, text));
        self.0.is_changed.notify_one();
    }

    /// Removes the diagnostics of a text.
    pub(super) fn close(&self, uri: &str) {
        let mut waiting = self.0.waiting();
        self.0.cancel(&waiting, uri);
        waiting.texts.remove(uri);
        publish(uri, &Value::Null, &[]);
    }
}

impl Shared {
    fn waiting(&self) -> MutexGuard<'_, WaitingTexts> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn cancel(&self, waiting: &WaitingTexts, uri: &str) {
        if waiting.checked.as_deref() == Some(uri) {
            self.cancelled.store(true, Ordering::SeqCst);
        }
    }

    fn run(&self, allowed: &AllowArguments) {
        // The texts whose last diagnostics were mistakes.
        let mut faulty = BTreeSet::new();
        loop {
            let mut waiting = self.waiting();
            waiting.checked = None;
            let Some((uri, (version, text))) = waiting.texts.pop_first() else {
                drop(self.is_changed.wait(waiting).unwrap_or_else(PoisonError::into_inner));
                continue;
            };
            waiting.checked = Some(uri.clone());
            self.cancelled.store(false, Ordering::SeqCst);
            drop(waiting);
            let file = path_of(&uri).display().to_string();
            let own = OwnText { file: &file, text: &text };
            let publish = |diagnostics: &[Value]| {
                let _waiting = self.waiting();
                if !self.cancelled.load(Ordering::SeqCst) {
                    publish(&uri, &version, diagnostics);
                }
            };
            let loaded = Scene::from_text_with_sources(&file, text.clone());
            if loaded.is_ok() && faulty.remove(&uri) {
                // Mistakes that are mended disappear before frames are rendered for warnings.
                publish(&[]);
            }
            let diagnostics = match check(loaded, allowed, Signals::unless(&self.cancelled)) {
                Ok(CheckPassed { warnings, sources, .. }) => own.warnings(&warnings.to_json(Some(&sources))),
                Err(CheckFailed::Scene(error)) => own.mistakes(&error),
                Err(CheckFailed::Cloud(message)) => {
                    vec![own.diagnostic(ERROR, &line_span(&text, 1), &message, None)]
                }
                Err(CheckFailed::Script(mistake)) => {
                    let diagnostic = mistake.diagnostic();
                    let file = diagnostic.source.as_ref().map_or("", |source| &source.file);
                    vec![own.mistake(file, mistake.position(), &[], diagnostic)]
                }
            };
            if diagnostics.iter().any(|diagnostic| diagnostic["severity"] == ERROR) {
                faulty.insert(uri.clone());
            }
            publish(&diagnostics);
        }
    }
}

/// Sends diagnostics. If the editor is gone, the server ends soon.
fn publish(uri: &str, version: &Value, diagnostics: &[Value]) {
    let mut params = json!({ "uri": uri, "diagnostics": diagnostics });
    if version.is_number() {
        params["version"] = version.clone();
    }
    let message = json!({ "jsonrpc": "2.0", "method": "textDocument/publishDiagnostics", "params": params });
    let _ = print::protocol_message(&message);
}

/// The text that is checked, as opposed to the files that it includes.
struct OwnText<'a> {
    file: &'a str,
    text: &'a str,
}

impl OwnText<'_> {
    fn mistakes(&self, error: &LoadError) -> Vec<Value> {
        let one = error.mistakes().map(|mistake| {
            self.mistake(mistake.file, mistake.position, mistake.included_from, mistake.diagnostic)
        });
        one.collect()
    }

    /// Returns a mistake. One in another file is where that file is included.
    fn mistake(
        &self,
        file: &str,
        position: Option<SourcePosition>,
        included_from: &[Inclusion],
        Diagnostic { message, help, span, .. }: &Diagnostic,
    ) -> Value {
        let here = if file == self.file { position } else { None };
        let span = match here {
            Some(position) => {
                let start = byte_of(self.text, position);
                start..self.text.floor_char_boundary(start + span.as_ref().map_or(0, Range::len))
            }
            None => {
                let from = included_from.iter().find(|from| from.file == self.file);
                line_span(self.text, from.map_or(1, |from| from.line))
            }
        };
        let place = match position {
            _ if file == self.file => String::new(),
            Some(position) => format!("{file}:{position}: "),
            None => format!("{file}: "),
        };
        self.diagnostic(ERROR, &span, &format!("{place}{message}"), help.as_deref())
    }

    /// Returns warnings, given those of `check`.
    fn warnings(&self, warnings: &Value) -> Vec<Value> {
        let one = |warning: &Value| {
            let text = |name: &str| warning[name].as_str().unwrap_or_default();
            let line = warning["line"].as_u64().and_then(|line| usize::try_from(line).ok()).unwrap_or(1);
            let is_own = text("file") == self.file || warning["file"].is_null();
            let place = if is_own { String::new() } else { format!("{}:{line}: ", text("file")) };
            let entity =
                if text("entity").is_empty() { String::new() } else { format!("{} ", text("entity")) };
            let span = line_span(self.text, if is_own { line } else { 1 });
            let message = format!("{place}{entity}{}", text("message"));
            let mut warned = self.diagnostic(WARNING, &span, &message, Some(text("help")));
            warned["code"] = warning["name"].clone();
            warned
        };
        warnings.as_array().into_iter().flatten().map(one).collect()
    }

    fn diagnostic(&self, severity: u32, span: &Range<usize>, message: &str, help: Option<&str>) -> Value {
        let help = help.map_or_else(String::new, |help| format!("\nhelp: {help}"));
        json!({
            "range": range(self.text, span),
            "severity": severity,
            "source": "rayreel",
            "message": format!("{message}{help}"),
        })
    }
}
