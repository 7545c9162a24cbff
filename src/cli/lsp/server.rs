//! The server: texts, and answers to requests.

use std::collections::HashMap;
use std::ops::ControlFlow;

use anyhow::anyhow;
use serde_json::{Value, json};

use rayreel::scene::assist::{
    SceneSymbol, Suggestion, SuggestionKind, Suggestions, SymbolKind, complete, definition, describe, outline,
};
use rayreel::scene::input::{InputKind, LARGEST_FILE, read};

use super::checker::Checker;
use super::positions::{LineStarts, offset, path_of, range, uri_of};
use crate::cli::exit::Failure;
use crate::cli::print;

/// Codes of errors, as in the protocol.
const PARSE_ERROR: i32 = -32700;
const INVALID_REQUEST: i32 = -32600;
const METHOD_NOT_FOUND: i32 = -32601;
const INVALID_PARAMS: i32 = -32602;
const NOT_INITIALIZED: i32 = -32002;

/// The progress of a session.
#[derive(Clone, Copy, Debug, PartialEq)]
enum SessionState {
    New,
    Initialized,
    ShutDown,
}

#[derive(Debug)]
pub(super) struct LanguageServer {
    session: SessionState,
    /// The texts by their URIs.
    texts: HashMap<String, String>,
    checker: Checker,
}

impl LanguageServer {
    pub(super) fn new(checker: Checker) -> Self {
        Self { session: SessionState::New, texts: HashMap::new(), checker }
    }

    /// Handles a message. Returns `Break` with the result of the command at the end of the session.
    pub(super) fn receive(
        &mut self,
        message: serde_json::Result<Value>,
    ) -> anyhow::Result<ControlFlow<Result<(), Failure>>> {
        let (id, answer) = match message {
            Err(error) => (Value::Null, Err((PARSE_ERROR, error.to_string()))),
            Ok(message) => match (message["method"].as_str(), message.get("id")) {
                (Some("exit"), None) => return Ok(ControlFlow::Break(self.end())),
                (Some(method), None) => {
                    self.notified(method, &message["params"]);
                    return Ok(ControlFlow::Continue(()));
                }
                (Some(method), Some(id)) => (id.clone(), self.answer(method, &message["params"])),
                // An answer to a request, of which this server makes none.
                (None, _) if message.get("result").or(message.get("error")).is_some() => {
                    return Ok(ControlFlow::Continue(()));
                }
                (None, _) => (Value::Null, Err((INVALID_REQUEST, "a message without a method".to_owned()))),
            },
        };
        let answer = match answer {
            Ok(result) => json!({ "jsonrpc": "2.0", "id": id, "result": result }),
            Err((code, message)) => {
                json!({ "jsonrpc": "2.0", "id": id, "error": { "code": code, "message": message } })
            }
        };
        Ok(print::protocol_message(&answer)?.map_break(|()| Ok(())))
    }

    fn end(&self) -> Result<(), Failure> {
        match self.session {
            SessionState::ShutDown => Ok(()),
            SessionState::New | SessionState::Initialized => {
                Err(anyhow!("the editor exits without a shutdown").into())
            }
        }
    }

    fn notified(&mut self, method: &str, params: &Value) {
        let document = &params["textDocument"];
        let Some(uri) = document["uri"].as_str().filter(|_| self.session == SessionState::Initialized) else {
            return;
        };
        match method {
            "textDocument/didOpen" => {
                let text = document["text"].as_str().unwrap_or_default();
                self.texts.insert(uri.to_owned(), text.to_owned());
            }
            "textDocument/didChange" => {
                let text = self.texts.entry(uri.to_owned()).or_default();
                for change in params["contentChanges"].as_array().into_iter().flatten() {
                    apply(text, change);
                }
            }
            "textDocument/didSave" => {}
            "textDocument/didClose" => {
                self.texts.remove(uri);
                self.checker.close(uri);
                return;
            }
            _ => return,
        }
        let text = self.texts.get(uri).cloned().unwrap_or_default();
        self.checker.submit(uri, document["version"].clone(), text);
    }

    fn answer(&mut self, method: &str, params: &Value) -> Result<Value, (i32, String)> {
        match (method, self.session) {
            ("initialize", SessionState::New) => {
                self.session = SessionState::Initialized;
                return Ok(abilities());
            }
            (_, SessionState::New) => {
                return Err((NOT_INITIALIZED, "the first request is `initialize`".to_owned()));
            }
            ("initialize", _) | (_, SessionState::ShutDown) => {
                return Err((INVALID_REQUEST, format!("`{method}` is out of order")));
            }
            ("shutdown", SessionState::Initialized) => {
                self.session = SessionState::ShutDown;
                return Ok(Value::Null);
            }
            (_, SessionState::Initialized) => {}
        }
        let answer = match method {
            "textDocument/completion" => completion,
            "textDocument/hover" => hover,
            "textDocument/definition" => Self::definition,
            "textDocument/documentSymbol" => symbols,
            _ => return Err((METHOD_NOT_FOUND, format!("there is no method `{method}`"))),
        };
        let uri = params["textDocument"]["uri"].as_str().unwrap_or_default();
        let Some(text) = self.texts.get(uri) else {
            return Err((INVALID_PARAMS, format!("`{uri}` is not open")));
        };
        Ok(answer(self, uri, text, &params["position"]))
    }

    fn definition(&self, uri: &str, text: &str, position: &Value) -> Value {
        let Some(found) = definition(text, offset(text, position), &path_of(uri)) else { return Value::Null };
        let Some(file) = found.file else { return json!({ "uri": uri, "range": range(text, &found.span) }) };
        let uri = uri_of(&file);
        let of_file = || {
            String::from_utf8(read(&file, InputKind::Refused, LARGEST_FILE).unwrap_or_default())
                .unwrap_or_default()
        };
        let text = self.texts.get(&uri).cloned().unwrap_or_else(of_file);
        json!({ "uri": uri, "range": range(&text, &found.span) })
    }
}

/// Returns the abilities of the server.
fn abilities() -> Value {
    json!({
        "capabilities": {
            "positionEncoding": "utf-16",
            // Changes are parts of the text.
            "textDocumentSync": { "openClose": true, "change": 2, "save": true },
            "completionProvider": { "triggerCharacters": ["(", "\"", ":", ",", " "] },
            "hoverProvider": true,
            "definitionProvider": true,
            "documentSymbolProvider": true,
        },
        "serverInfo": { "name": "rayreel", "version": env!("CARGO_PKG_VERSION") },
    })
}

/// Applies a change to a text: of a range, or of the whole text.
fn apply(text: &mut String, change: &Value) {
    let new = change["text"].as_str().unwrap_or_default();
    match change.get("range") {
        Some(range) => {
            let start = offset(text, &range["start"]);
            let end = offset(text, &range["end"]).max(start);
            text.replace_range(start..end, new);
        }
        None => new.clone_into(text),
    }
}

fn completion(_: &LanguageServer, uri: &str, text: &str, position: &Value) -> Value {
    let Suggestions { span, items } = complete(text, offset(text, position), &path_of(uri));
    let range = range(text, &span);
    let item = |(index, Suggestion { kind, label, text, about }): (usize, Suggestion)| {
        // Names are completed with their quotes.
        let filter = if kind == SuggestionKind::Name { &text } else { &label };
        // Kinds of the protocol: a field, a value, a reference.
        let kind = match kind {
            SuggestionKind::Field => 5,
            SuggestionKind::Value => 12,
            SuggestionKind::Name => 18,
        };
        json!({
            "label": label,
            "kind": kind,
            "documentation": { "kind": "markdown", "value": about },
            // Editors sort by this text: as in the reference, not by name.
            "sortText": format!("{index:06}"),
            "filterText": filter,
            "textEdit": { "range": range, "newText": text },
        })
    };
    json!({ "isIncomplete": false, "items": items.into_iter().enumerate().map(item).collect::<Value>() })
}

fn hover(_: &LanguageServer, _uri: &str, text: &str, position: &Value) -> Value {
    let Some(found) = describe(text, offset(text, position)) else { return Value::Null };
    let value = format!("**{}**\n\n{}", found.title, found.about);
    json!({ "contents": { "kind": "markdown", "value": value }, "range": range(text, &found.span) })
}

fn symbols(_: &LanguageServer, _uri: &str, text: &str, _: &Value) -> Value {
    let lines = LineStarts::new(text);
    let symbol = |SceneSymbol { kind, name, span, name_span, .. }: SceneSymbol| {
        // Kinds of the protocol: a file, a constant, an interface, an object, an event.
        let (kind, noun) = match kind {
            SymbolKind::Include => (1, "include"),
            SymbolKind::Material => (14, "material"),
            SymbolKind::Camera => (11, "camera"),
            SymbolKind::Entity => (19, "entity"),
            SymbolKind::Animation => (24, "animation"),
        };
        let (range, selection) = (lines.range(&span), lines.range(&name_span));
        let name = if name.is_empty() { format!("({noun})") } else { name };
        json!({ "name": name, "detail": noun, "kind": kind, "range": range, "selectionRange": selection })
    };
    outline(text).into_iter().map(symbol).collect()
}
