//! Tests of the strip that shows the mistakes of a scene.

use serde_json::json;

use crate::{Preview, SCENE, open, settle, until};

#[test]
fn strip_shows_the_first_mistake_and_expands() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    let shows = |text: &str| {
        let before = browser.evaluate("wrongText");
        preview.save(text);
        until(
            &browser,
            &format!("!at('wrong').hidden && wrongText !== {before} && wrongText === state.mistakes.text"),
        );
        browser.evaluate("at('wrong').innerText").as_str().unwrap().to_owned()
    };
    let folder = preview.folder.path().display().to_string();
    // One mistake: its place relative to the scene, its message, its line without indentation, and the remedy.
    let one = shows(&SCENE.replace("\"clay\"),", "\"caly\"),"));
    let expected = "ball.ron:8:60 there is no material \"caly\"\n8 | (name: \"ball\", shape: Sphere(radius: 1), material: \"caly\"),\n  |                                                    ^^^^^^ unknown";
    assert!(one.starts_with(expected), "{one}");
    assert!(one.contains("help: did you mean `clay`?") && !one.contains("mistake"), "{one}");
    assert_eq!(browser.evaluate("at('expand').hidden"), json!(true));
    // Several mistakes: the first, and all of them on request, with the number.
    let broken = SCENE.replace("\"clay\"),", "\"caly\"),").replace("radius: 1", "radius: -1");
    let first = shows(&broken);
    assert!(first.starts_with("ball.ron:8:46 the radius must be greater than 0, not -1"), "{first}");
    assert!(!first.contains("no material"), "{first}");
    assert_eq!(browser.evaluate("at('expand').innerText"), json!("Show all 2"));
    let share = "at('wrong').offsetHeight / at('stage').offsetHeight";
    let height = browser.evaluate(share).as_f64().unwrap();
    assert!(height < 0.35, "{height}");
    browser.click("#expand");
    let all = browser.evaluate("at('wrong').innerText");
    let all = all.as_str().unwrap();
    assert!(all.starts_with("2 mistakes\nShow the first\n"), "{all}");
    assert!(all.contains("--> ball.ron:8:46\n") && all.contains("there is no material \"caly\""), "{all}");
    assert!(!all.contains(&folder), "{all}");
    assert_eq!(browser.evaluate("at('expand').getAttribute('aria-expanded')"), json!("true"));
    // The picture stays, and a mistake after a correction is brief again.
    assert_eq!(browser.evaluate("at('now').naturalWidth"), json!(160));
    preview.save(SCENE);
    until(&browser, "at('wrong').hidden && shown.full");
    assert_eq!(shows(&broken), first);
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn mistakes_are_readable_on_phones() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    let phone = json!({ "width": 360, "height": 640, "deviceScaleFactor": 2, "mobile": true });
    browser.emulate("Emulation.setDeviceMetricsOverride", &phone);
    until(&browser, "shown !== null && shown.full && innerWidth === 360");
    let far = " ".repeat(150);
    for broken in [
        SCENE.replace("\"clay\"),", "\"caly\"),"),
        SCENE.replace("(name: \"ball\",", &format!("(name: \"ball\",{far}shope: 3,")),
        SCENE.replace("width: 160", &format!("{far}width: -160")),
        "Scene(".to_owned(),
    ] {
        let before = browser.evaluate("wrongText");
        preview.save(&broken);
        until(
            &browser,
            &format!("!at('wrong').hidden && wrongText !== {before} && wrongText === state.mistakes.text"),
        );
        // All text is within the page. Only lines of the file scroll, to the caret.
        let outside =
            "[...at('wrong').querySelectorAll('h2, p')].some(part => { const range = document.createRange();
            range.selectNodeContents(part);
            return [...range.getClientRects()].some(box => box.left < 0 || box.right > innerWidth); })";
        assert_eq!(browser.evaluate(outside), json!(false), "{broken}");
        assert_eq!(browser.evaluate("at('wrong').scrollLeft"), json!(0));
        let caret = "[...at('wrong').querySelectorAll('pre')].every(lines => {
            const at = lines.firstChild.data.indexOf('^'), range = document.createRange();
            if (at < 0) return true;
            range.setStart(lines.firstChild, at); range.setEnd(lines.firstChild, at + 1);
            const box = range.getBoundingClientRect();
            return box.left >= 0 && box.right <= innerWidth; })";
        assert_eq!(browser.evaluate(caret), json!(true), "{broken}");
    }
}
