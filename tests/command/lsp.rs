//! Tests of the language server: sessions over its pipes.

use std::collections::HashMap;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout};

use serde_json::{Value, json};

use crate::splitmix::Random;
use crate::{FIRST_LIGHT, RAYREEL, command, rayreel, stdout_of};

/// A session with a server.
struct Session {
    server: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    requests: u64,
    /// The last diagnostics of each document.
    diagnostics: HashMap<String, Vec<Value>>,
}

impl Session {
    /// Starts a server.
    fn start(folder: &Path) -> Self {
        let mut starting = command(RAYREEL, folder);
        let mut server = starting.arg("lsp").stdin(std::process::Stdio::piped()).spawn().unwrap();
        let (input, output) = (server.stdin.take(), BufReader::new(server.stdout.take().unwrap()));
        Self { server, input, output, requests: 0, diagnostics: HashMap::new() }
    }

    fn initialized(folder: &Path) -> Self {
        let mut session = Self::start(folder);
        let answer = session.request("initialize", &json!({ "capabilities": {} }));
        assert_eq!(answer["result"]["capabilities"]["positionEncoding"], "utf-16");
        session.notify("initialized", &json!({}));
        session
    }

    fn write(&mut self, bytes: &[u8]) {
        let input = self.input.as_mut().unwrap();
        input.write_all(bytes).unwrap();
        input.flush().unwrap();
    }

    fn send(&mut self, message: &Value) {
        let message = message.to_string();
        self.write(format!("Content-Length: {}\r\n\r\n{message}", message.len()).as_bytes());
    }

    fn notify(&mut self, method: &str, params: &Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    fn read(&mut self) -> Value {
        let mut header = String::new();
        self.output.read_line(&mut header).unwrap();
        let length = header.trim().strip_prefix("Content-Length: ").unwrap().parse().unwrap();
        self.output.read_line(&mut String::new()).unwrap();
        let mut content = vec![0; length];
        self.output.read_exact(&mut content).unwrap();
        let message: Value = serde_json::from_slice(&content).unwrap();
        if message["method"] == "textDocument/publishDiagnostics" {
            let params = &message["params"];
            let diagnostics = params["diagnostics"].as_array().unwrap().clone();
            self.diagnostics.insert(params["uri"].as_str().unwrap().to_owned(), diagnostics);
        }
        message
    }

    /// Returns the next message that fulfils a condition.
    fn wait(&mut self, is_wanted: impl Fn(&Value) -> bool) -> Value {
        loop {
            let message = self.read();
            if is_wanted(&message) {
                return message;
            }
        }
    }

    fn request(&mut self, method: &str, params: &Value) -> Value {
        self.requests += 1;
        let id = json!(self.requests);
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        self.wait(|message| message["id"] == id)
    }

    fn open(&mut self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "languageId": "ron", "version": 1, "text": text });
        self.notify("textDocument/didOpen", &json!({ "textDocument": document }));
    }

    fn change(&mut self, uri: &str, version: u64, change: &Value) {
        let document = json!({ "uri": uri, "version": version });
        self.notify(
            "textDocument/didChange",
            &json!({ "textDocument": document, "contentChanges": [change] }),
        );
    }

    /// Returns the answer to a request about a position, marked by `|` in the text, which is then the text of the document.
    fn ask(&mut self, method: &str, uri: &str, marked: &str) -> Value {
        let at = marked.find('|').unwrap();
        self.change(uri, 2, &json!({ "text": marked.replacen('|', "", 1) }));
        let params = json!({ "textDocument": { "uri": uri }, "position": position(marked, at) });
        self.request(&format!("textDocument/{method}"), &params)["result"].clone()
    }

    fn labels(&mut self, uri: &str, marked: &str) -> Vec<String> {
        let answer = self.ask("completion", uri, marked);
        let items = answer["items"].as_array().unwrap();
        items.iter().map(|item| item["label"].as_str().unwrap().to_owned()).collect()
    }

    /// Returns the last diagnostics of a document, after all checks of it.
    fn last_diagnostics(&mut self, uri: &str) -> Vec<Value> {
        // Documents are checked in the order of their URIs, and this one has a mistake.
        const LAST: &str = "file:///~last.ron";
        self.open(LAST, "(");
        self.wait(|message| {
            message["params"]["uri"] == LAST && message["params"]["diagnostics"] != json!([])
        });
        self.notify("textDocument/didClose", &json!({ "textDocument": { "uri": LAST } }));
        self.wait(|message| message["params"]["uri"] == LAST);
        self.diagnostics.get(uri).cloned().unwrap_or_default()
    }

    fn end(mut self) {
        assert_eq!(self.request("shutdown", &Value::Null)["result"], Value::Null);
        self.notify("exit", &Value::Null);
        assert!(self.server.wait().unwrap().success());
    }
}

/// Returns the position of a byte.
fn position(text: &str, at: usize) -> Value {
    let line = text[..at].rsplit('\n').next().unwrap();
    json!({ "line": text[..at].matches('\n').count(), "character": line.encode_utf16().count() })
}

const URI: &str = "file:///nowhere/a.ron";

const SCENE: &str = r#"Scene( // a ball
    camera: (position: (0, 0, -5), target: (0, 0, 0)),
    materials: { "glänzend 😀": (color: (255, 120, 60)), "clay": (k_d: 0.7) },
    entities: [
        (name: "ball", shape: Sphere(radius: 1), material: "clay"),
    ],
)"#;

#[test]
fn completions_are_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = Session::initialized(folder.path());
    session.open(URI, SCENE);
    let with = |entity: &str| SCENE.replace("    ],", &format!("        {entity}\n    ],"));

    assert_eq!(session.labels(URI, "Sc|"), ["Scene"]);
    let labels = session.labels(URI, &SCENE.replace("    camera", "    |\n    camera"));
    assert!(labels.contains(&"film".to_owned()) && !labels.contains(&"camera".to_owned()), "{labels:?}");
    assert_eq!(session.labels(URI, &with("(shape: |")), ["Sphere", "Plane", "Box", "Cylinder", "Capsule"]);
    assert_eq!(session.labels(URI, &with("(shape: Box(|")), ["size"]);
    assert_eq!(
        session.labels(URI, &with("(light: Area(intensity: (1, 1, 1), sh|")),
        ["shape", "samples", "casts_shadows", "falloff",]
    );
    assert_eq!(session.labels(URI, &with("(material: \"|\", shape: ")), ["glänzend 😀", "clay"]);
    assert_eq!(session.labels(URI, &with("(material: (specular: (k_s: 1, |")), ["shininess"]);
    assert_eq!(session.labels(URI, &with("(parent: \"b|")), ["ball"]);
    assert_eq!(session.labels(URI, &with("(visible: |),")), ["true", "false"]);
    assert_eq!(session.labels(URI, &with("(shape: Torus(|")), [""; 0]);
    assert_eq!(session.labels(URI, &with("(transform: // sca|")), [""; 0]);
    let animated =
        |track: &str| SCENE.replace("    entities", &format!("    animate: [({track}\n    entities"));
    assert_eq!(session.labels(URI, &animated("target: \"|")), ["ball", "camera", "scene"]);
    assert!(session.labels(URI, &animated("channel: |")).contains(&"FogDensity".to_owned()));
    let easings = session.labels(URI, &animated("channel: Rotation, track: Keys([(0, Euler(0, 0, 0), |"));
    assert!(easings.contains(&"InOutSine".to_owned()), "{easings:?}");
    assert_eq!(session.labels(URI, &animated("repeat: |")), ["Clamp", "Loop", "PingPong"]);
    assert_eq!(session.labels(URI, "(background: (bottom: (1, 2, 3), |"), ["horizon", "top", "stops"]);
    assert_eq!(
        session.labels(URI, "(cameras: {\"side\": (position: (0, 0, 0))}, shots: [(0, \"|"),
        ["side", "camera"]
    );

    // The edit replaces what is typed, in UTF-16 units.
    let answer = session.ask("completion", URI, &with("(name: \"😀\", shape: Sph|"));
    let edit = &answer["items"][0]["textEdit"];
    assert_eq!(
        (&edit["newText"], &edit["range"]["start"]["character"]),
        (&json!("Sphere(radius: 1)"), &json!(28))
    );
    let about = answer["items"][0]["documentation"]["value"].as_str().unwrap();
    assert_eq!(about, "greater than 0.");
    session.end();
}

#[test]
fn descriptions_definitions_and_symbols() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("car.ron"),
        "(materials: {\"paint\": (k_d: 1)}, entities: [(name: \"wheel\")])",
    )
    .unwrap();
    let uri = format!("file://{}/a%20b.ron", folder.path().display());
    let mut session = Session::initialized(folder.path());
    session.open(&uri, SCENE);
    let mut hover = |marked: &str| {
        let answer = session.ask("hover", &uri, marked);
        answer["contents"]["value"].as_str().unwrap_or_default().to_owned()
    };
    assert_eq!(hover(&SCENE.replace("rad", "r|ad")), "**radius of Sphere**\n\ngreater than 0.");
    let about = hover(&SCENE.replace("\"clay\": (k", "\"clay\": (|k"));
    assert_eq!(about, "**k_d of Material**\n\ndiffuse reflection coefficient, 0 to 1");
    assert_eq!(hover(&SCENE.replace("0.7", "0|.7")), about);
    assert!(
        hover("(film: (width: 8, transfer: |Classic))")
            .starts_with("**Classic of Transfer**\n\nbytes are 255 times")
    );
    assert!(hover("(timeline: (f|ps: 24))").ends_with("Default: 24"));
    assert!(hover("(entities: [(light: Spot(soft|ness: 1, ").contains("0 to 1 and `0` by default"));
    assert_eq!(hover("(foo: |1)"), "");

    let used = SCENE.replace("material: \"clay\"", "material: \"cl|ay\"");
    let found = session.ask("definition", &uri, &used);
    let clay = position(SCENE, SCENE.find("\"clay\"").unwrap());
    assert_eq!((&found["uri"], &found["range"]["start"]), (&json!(uri), &clay));
    let with = |entity: &str| {
        SCENE.replace(
            "    entities: [",
            &format!("    include: [(file: \"car.ron\", name: \"car\")], entities: [\n{entity}"),
        )
    };
    let car = format!("file://{}/car.ron", folder.path().display());
    let found = session.ask("definition", &uri, &with("(parent: \"car/whe|el\"),"));
    assert_eq!((&found["uri"], &found["range"]["start"]["character"]), (&json!(car), &json!(51)));
    assert_eq!(session.ask("definition", &uri, &with("").replace("car.ron", "car|.ron"))["uri"], json!(car));
    assert_eq!(session.ask("definition", &uri, &SCENE.replace("radius: 1", "radius: |1")), Value::Null);
    assert!(session.labels(&uri, &with("(material: \"car|\"),")).contains(&"car/paint".to_owned()));

    let symbols = session.ask("documentSymbol", &uri, &format!("|{}", with("(),")));
    let names: Vec<&str> =
        symbols.as_array().unwrap().iter().map(|symbol| symbol["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["glänzend 😀", "clay", "car", "(entity)", "ball"]);
    session.end();
}

/// Returns the mistakes and warnings that `check` finds in the file `a.ron`, as the server formats them, with their lines from 0.
fn checked(folder: &Path, text: &str) -> Vec<(u64, String)> {
    fs::write(folder.join("a.ron"), text).unwrap();
    let printed = rayreel(folder, ["check", "--json", folder.join("a.ron").to_str().unwrap()]).stdout;
    let printed: Value = serde_json::from_slice(&printed).unwrap();
    let listed = ["mistakes", "warnings"]
        .into_iter()
        .flat_map(|list| printed[0][list].as_array().into_iter().flatten());
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let line = |found: &Value| found["line"].as_u64().unwrap_or(1) - 1;
    let message = |found: &Value| {
        let entity = text(&found["entity"]);
        let entity = if entity.is_empty() { entity } else { entity + " " };
        let help =
            if found["help"].is_null() { String::new() } else { format!("\nhelp: {}", text(&found["help"])) };
        format!("{entity}{}{help}", text(&found["message"]))
    };
    listed.map(|found| (line(found), message(found))).collect()
}

fn of_server(diagnostics: &[Value]) -> Vec<(u64, String)> {
    let line = |found: &Value| found["range"]["start"]["line"].as_u64().unwrap();
    diagnostics.iter().map(|found| (line(found), found["message"].as_str().unwrap().to_owned())).collect()
}

#[test]
fn diagnostics_are_those_of_check() {
    let folder = tempfile::tempdir().unwrap();
    let uri = format!("file://{}/a.ron", folder.path().display());
    for text in [
        "",
        "(",
        SCENE,
        &SCENE.replace("\"clay\"),", "\"glänzend\"), (light: Point(intensity: (-1, 0, 0), angle: 3)),"),
        &SCENE.replace("radius: 1", "radius: -1").replace("material: \"clay\"", "material: \"cly\""),
        &SCENE.replace("(255, 120, 60)", "(1, 0.5, 0.2)"),
        &SCENE.replace(
            "    entities",
            "    spawn: [Script(\"spawn(\")], include: [(file: \"none.ron\")],\n    entities",
        ),
    ] {
        let mut session = Session::initialized(folder.path());
        session.open(&uri, text);
        let last = session.last_diagnostics(&uri);
        assert_eq!(of_server(&last), checked(folder.path(), text), "{text}");
        session.end();
    }
    let mut session = Session::initialized(folder.path());
    session.open(&uri, &SCENE.replace("material: \"clay\"", "name: \"😀\", material: \"cly\""));
    let found = session.wait(|message| message["method"] == "textDocument/publishDiagnostics");
    let range = &found["params"]["diagnostics"][0]["range"];
    assert_eq!(
        range,
        &json!({ "start": { "line": 4, "character": 49 }, "end": { "line": 4, "character": 53 } })
    );
    session.notify("textDocument/didClose", &json!({ "textDocument": { "uri": uri } }));
    let found = session.wait(|message| message["params"]["diagnostics"] == json!([]));
    assert_eq!(found["params"]["uri"], json!(uri));
    session.end();
}

#[test]
fn a_mistake_in_a_part_is_where_the_part_is_included() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("part.ron"), "(\n  entities: [(parent: \"nobody\")])").unwrap();
    let uri = format!("file://{}/a.ron", folder.path().display());
    let mut session = Session::initialized(folder.path());
    session.open(&uri, &SCENE.replace("    entities", "    include: [(file: \"part.ron\")],\n    entities"));
    let last = session.last_diagnostics(&uri);
    let found = of_server(&last);
    assert_eq!(found.len(), 1);
    assert!(
        found[0].0 == 3 && found[0].1.contains("part.ron:2:23: there is no entity \"nobody\""),
        "{found:?}"
    );
    session.end();
}

#[test]
fn malformed_messages_are_answered() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = Session::start(folder.path());
    assert_eq!(session.request("textDocument/hover", &json!({}))["error"]["code"], -32002);
    session.write(b"Content-Length: 4\r\n\r\n{{{{");
    assert_eq!(session.read()["error"]["code"], -32700);
    session.write(b"nonsense\r\n\r\nContent-Length: 2\r\n\r\n[]");
    assert_eq!(session.read()["error"]["code"], -32600);
    session.request("initialize", &Value::Null);
    assert_eq!(session.request("initialize", &Value::Null)["error"]["code"], -32600);
    assert_eq!(session.request("textDocument/nothing", &json!(7))["error"]["code"], -32601);
    assert_eq!(session.request("textDocument/hover", &json!([1]))["error"]["code"], -32602);
    session.open(URI, "(");
    session.notify(
        "textDocument/didChange",
        &json!({ "textDocument": { "uri": URI }, "contentChanges": [{ "range": 3 }, 4] }),
    );
    let nowhere = json!({ "textDocument": { "uri": URI }, "position": { "line": -1, "character": 1e99 } });
    assert_eq!(session.request("textDocument/hover", &nowhere)["result"], Value::Null);
    session.end();

    let mut session = Session::initialized(folder.path());
    session.notify("exit", &Value::Null);
    assert_eq!(session.server.wait().unwrap().code(), Some(1));
    let mut session = Session::initialized(folder.path());
    session.write(b"Content-Length: 100\r\n\r\n{");
    session.input = None;
    assert!(session.server.wait().unwrap().success());
}

/// Checks that no text makes the server panic, and that the last diagnostics are those of `check`.
#[test]
fn random_edits_of_a_scene() {
    const PIECES: [&str; 18] = [
        "(",
        ")",
        "[",
        "]",
        "{",
        "}",
        ",",
        ":",
        "\"",
        "/*",
        "//",
        "r#\"",
        "😀",
        "\n",
        "name: \"a\"",
        "Sphere(",
        "Some(",
        "-1e999",
    ];
    let folder = tempfile::tempdir().unwrap();
    let uri = format!("file://{}/a.ron", folder.path().display());
    let mut text = fs::read_to_string(FIRST_LIGHT).unwrap();
    let mut session = Session::initialized(folder.path());
    session.open(&uri, &text);
    let mut random = Random(1);
    for version in 2..102 {
        let at = |random: &mut Random, text: &str| text.floor_char_boundary(random.index(text.len() + 1));
        let start = at(&mut random, &text);
        let end = text.floor_char_boundary((start + random.index(9)).min(text.len())).max(start);
        let new = PIECES[random.index(PIECES.len())];
        let range = json!({ "start": position(&text, start), "end": position(&text, end) });
        session.change(&uri, version, &json!({ "range": range, "text": new }));
        text.replace_range(start..end, new);
        for method in ["completion", "hover", "definition", "documentSymbol"] {
            let asked = at(&mut random, &text);
            let params = json!({ "textDocument": { "uri": uri }, "position": position(&text, asked) });
            let answer = session.request(&format!("textDocument/{method}"), &params);
            assert!(answer.get("result").is_some(), "{answer}");
        }
    }
    let last = session.last_diagnostics(&uri);
    assert_eq!(of_server(&last), checked(folder.path(), &text));

    // The scene itself has the diagnostics of `check`, too.
    let original = fs::read_to_string(FIRST_LIGHT).unwrap();
    session.change(&uri, 200, &json!({ "text": original }));
    let last = session.last_diagnostics(&uri);
    assert_eq!(of_server(&last), checked(folder.path(), &original));
    session.end();
}

#[test]
fn schema_is_json_schema() {
    let folder = tempfile::tempdir().unwrap();
    let schema: Value = serde_json::from_str(&stdout_of(folder.path(), ["schema"])).unwrap();
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    let film = &schema["$defs"]["Film"]["properties"]["width"];
    let width = json!({
        "type": "integer", "minimum": 1, "maximum": 32768, "default": 640,
        "description": "columns of pixels, 1 to 32768; at most 2^28 pixels in total. Default: 640",
    });
    assert_eq!(film, &width);
}
