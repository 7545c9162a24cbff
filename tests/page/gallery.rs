//! Tests of the example program that makes the gallery, in a real browser.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::browser::Browser;
use super::{SCENE, until};
use program::Options;
use program::source::{beginning, highlighted};

#[path = "../../scenes/code/gallery/main.rs"]
#[allow(dead_code, reason = "its `main` is not called")]
mod program;

/// Returns the texts of the page whose contrast to their background is less than 4.5, the limit of WCAG 2 for normal text.
const FAINT: &str = "(() => {
    const numbers = color => color.match(/[\\d.]+/g).map(Number);
    const light = color => { const [r, g, b] = numbers(color).map(c => c / 255).map(c => c <= .04045 ? c / 12.92 : ((c + .055) / 1.055) ** 2.4);
        return .2126 * r + .7152 * g + .0722 * b; };
    const ground = one => { while (one && numbers(getComputedStyle(one).backgroundColor)[3] === 0) one = one.parentElement;
        return getComputedStyle(one ?? document.body).backgroundColor; };
    return [...document.querySelectorAll('body *:not(script)')]
        .filter(one => [...one.childNodes].some(node => node.nodeType === 3 && node.data.trim()))
        .map(one => { const [dark, bright] = [light(getComputedStyle(one).color), light(ground(one))].sort((a, b) => a - b);
            return [one.textContent.slice(0, 20), (bright + .05) / (dark + .05)]; })
        .filter(([, contrast]) => contrast < 4.5); })()";

/// Makes a gallery of a scene that moves and of one that does not.
fn make_gallery(folder: &Path) -> PathBuf {
    let moving = format!("// A <ball> rises & falls. Twice.\n// Slowly.\n{SCENE}");
    let still = SCENE.replace("timeline: (fps: 10, duration: 2),", "/* one frame */");
    fs::write(folder.join("ball.ron"), moving).unwrap();
    fs::write(folder.join("still.ron"), still).unwrap();
    program::make(&Options {
        folder: folder.join("pages"),
        scenes: ["ball.ron", "still.ron"].map(|name| folder.join(name)).into(),
        size: (160, 160),
        samples: Some(1),
        seconds: 10.0,
        pictures: false,
    })
    .unwrap()
}

#[test]
fn gallery_is_readable_everywhere_and_loads_loops_on_demand() {
    let folder = tempfile::tempdir().unwrap();
    let index = make_gallery(folder.path());
    let pages: Vec<PathBuf> =
        ["index.html", "ball.html", "still.html"].map(|name| index.with_file_name(name)).into();
    for page in &pages {
        assert!(!fs::read_to_string(page).unwrap().contains("://"), "{} links to the web", page.display());
    }
    let Some(browser) = Browser::start("1000,700") else {
        println!("there is no chromedriver: the gallery was not tried");
        return;
    };
    let open = |page: &Path| browser.go(&format!("file://{}", page.display()));
    let prefer = |scheme: &str, motion: &str| {
        let features = json!([
            { "name": "prefers-color-scheme", "value": scheme },
            { "name": "prefers-reduced-motion", "value": motion },
        ]);
        browser.emulate("Emulation.setEmulatedMedia", &json!({ "features": features }));
    };

    for (scheme, width, is_phone) in [("light", 1000, false), ("dark", 1000, false), ("light", 390, true)] {
        prefer(scheme, "reduce");
        let screen = json!({ "width": width, "height": 800, "deviceScaleFactor": 1, "mobile": is_phone });
        browser.emulate("Emulation.setDeviceMetricsOverride", &screen);
        for page in &pages {
            open(page);
            assert_eq!(browser.evaluate(FAINT), json!([]), "{scheme}: {}", page.display());
            assert_eq!(browser.evaluate("document.documentElement.scrollWidth <= innerWidth"), json!(true));
            until(&browser, "[...document.images].every(image => image.alt && image.naturalWidth === 160)");
        }
        let is_dark = "getComputedStyle(document.body).backgroundColor === 'rgb(20, 23, 26)'";
        assert_eq!(browser.evaluate(is_dark), json!(scheme == "dark"));
    }

    // By keys to the first scene, and by clicks to the second and back.
    open(&index);
    browser.press('\u{e004}');
    browser.press('\u{e007}');
    until(&browser, "location.pathname.endsWith('/ball.html') && document.readyState === 'complete'");
    let source = fs::read_to_string(folder.path().join("ball.ron")).unwrap();
    assert_eq!(browser.evaluate("document.querySelector('pre').textContent"), json!(source));
    let highlighted = "['.comment', '.string'].map(kind => document.querySelectorAll('pre ' + kind).length)";
    assert_eq!(browser.evaluate(highlighted), json!([2, 4]));
    assert_eq!(
        browser.evaluate("document.querySelector('p').innerText"),
        json!("A <ball> rises & falls. Twice. Slowly.")
    );
    until(
        &browser,
        "document.querySelector('.plan').innerText.includes('diffuse light\tall\tk_d is above 0')",
    );

    // Nothing of the loop is loaded before it is asked for.
    if browser.evaluate("document.querySelector('video') !== null") == json!(true) {
        assert_eq!(browser.evaluate("document.querySelector('video').readyState"), json!(0));
        browser.evaluate("document.querySelector('video').focus()");
        browser.press(' ');
        until(&browser, "document.querySelector('video').currentTime > 0");
        prefer("light", "no-preference");
        open(&pages[1]);
        until(&browser, "document.querySelector('video').currentTime > 0");
    } else {
        let loaded = "document.querySelector('details img').naturalWidth";
        assert_eq!(browser.evaluate(loaded), json!(0));
        browser.click("summary");
        until(&browser, &format!("{loaded} === 160"));
    }
    browser.click("a[rel=next]");
    until(
        &browser,
        "location.pathname.endsWith('/still.html') && document.querySelector('video, details') === null",
    );
    browser.click("nav a");
    until(&browser, "location.pathname.endsWith('/index.html')");
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn long_sources_are_cut_after_a_line() {
    let line = "(é: 1),\n";
    let [short, long] = [40, 40_000].map(|count| line.repeat(count));
    assert_eq!(beginning(&short), (short.as_str(), 0));
    let (shown, left_out) = beginning(&long);
    assert!((32_000..=32_768).contains(&shown.len()) && shown.ends_with(line), "{}", shown.len());
    assert_eq!(shown.lines().count() + left_out, 40_000);
    // There is no place to cut.
    let wide = "é".repeat(40_000);
    assert_eq!(beginning(&wide), (wide.as_str(), 0));
}

#[test]
fn sources_are_highlighted_and_otherwise_unchanged() {
    for (source, expected) in [
        ("a1: 1.5e-3 // \"x\"\ny", "a1: {number 1.5e-3} {comment // &quot;x&quot;}\ny"),
        ("r#\"a\"b\"# /* < */ for", "{string r#&quot;a&quot;b&quot;#} {comment /* &lt; */} for"),
        ("\"\\\"\" 0..10 `-2`", "{string &quot;\\&quot;&quot;} {number 0}..{number 10} {string `-2`}"),
        ("\"open", "{string &quot;open}"),
    ] {
        let expected = expected.replace('{', "<span class=\"").replace('}', "</span>");
        let expected = ["number", "string", "comment"]
            .into_iter()
            .fold(expected, |text, class| text.replace(&format!("\"{class} "), &format!("\"{class}\">")));
        assert_eq!(highlighted(source), expected);
    }
    for entry in fs::read_dir("scenes").unwrap().map(|entry| entry.unwrap().path()) {
        let Ok(source) = fs::read_to_string(&entry) else { continue };
        let mut text = highlighted(&source).replace("</span>", "");
        for class in ["number", "string", "comment"] {
            text = text.replace(&format!("<span class=\"{class}\">"), "");
        }
        let escapes = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&amp;", "&")];
        let text = escapes.iter().fold(text, |text, (escape, letter)| text.replace(escape, letter));
        assert!(text == source, "{}", entry.display());
    }
}
