//! Tests of the dialog that renders into files.

use serde_json::json;

use crate::{Preview, SCENE, open, settle, until};

#[test]
fn dialog_renders_a_range_cancels_and_offers_a_movie() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    let render = |target: &str| {
        let target = preview.folder.path().join(target);
        browser.press('R');
        until(&browser, "at('export-dialog').open");
        browser.evaluate(&format!("(at('export-target').value = {:?}, true)", target.display().to_string()));
        browser.click("#export-start");
    };
    let ends = |end: &str| {
        until(&browser, &format!("state.export?.end === '{end}' && !at('export').hidden"));
    };
    settle(&browser);
    browser.evaluate("(setRange('first', 3), setRange('last', 5), true)");
    render("made");
    ends("complete");
    until(&browser, "!at('export-dialog').open && at('export').innerText.includes('3 frames are in')");
    for frame in 0..20 {
        let file = preview.folder.path().join(format!("made/ball.{frame:04}.png"));
        assert_eq!(file.exists(), (3..=5).contains(&frame), "{frame}");
    }
    browser.evaluate("(clearRange(), true)");
    render("ball.gif");
    ends("complete");
    until(&browser, "!document.querySelector('#export a').hidden");
    let size = std::fs::metadata(preview.folder.path().join("ball.gif")).unwrap().len();
    browser.evaluate(
        "(fetch(document.querySelector('#export a').href).then(answer => answer.blob()).then(blob => { window.got = blob.size; }), true)",
    );
    until(&browser, &format!("window.got === {size}"));
    browser.click("#export button");
    until(&browser, "at('export').hidden");
    // A long film is cancelled, and what is refused is said in the dialog.
    let long = SCENE.replace("film: (", "sampling: (samples: 5000), film: (");
    preview.save(&long);
    until(&browser, "state.reloads > 1");
    render("long");
    until(&browser, "state.export?.end === null");
    assert_eq!(browser.console(), json!([]));
    render("other");
    until(&browser, "at('export-refused').textContent.startsWith('a film is being rendered')");
    browser.click("#export-cancel");
    browser.click("#export button");
    ends("cancelled");
}

#[test]
fn dialog_describes_the_files_before_they_are_made() {
    let preview = Preview::of(&SCENE.replace("width: 160", "width: 161"));
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    let facts = || browser.evaluate("at('export-facts').innerText").as_str().unwrap().to_owned();
    browser.evaluate("(setRange('first', 3), setRange('last', 5), true)");
    browser.press('R');
    until(&browser, "at('export-dialog').open");
    let here = std::env::current_dir().unwrap().display().to_string();
    let described = facts();
    for part in [
        "161 × 90 pixels",
        "3 frames, 0.30 s at 10 per second, the range of the timeline",
        "ball.0003.png to ball.0005.png",
    ] {
        assert!(described.contains(part), "{part}: {described}");
    }
    assert_eq!(
        browser.evaluate("document.querySelector('#export-facts tr:last-child td').title"),
        json!(format!("{here}/out/ball"))
    );
    // The time is that of the frames that were rendered, among which the shown one may be noted again at any moment.
    let timed = |action: &str| {
        let times = "frameTimes.clear(), frameTimes.set(0, 12000), frameTimes.set(1, 15000)";
        let facts = browser.evaluate(&format!("({times}, {action}, at('export-facts').innerText)"));
        facts.as_str().unwrap().to_owned()
    };
    let described = timed("describeExport()");
    assert!(described.contains("about 40 s"), "{described}");
    let described = timed("at('export-all').click()");
    assert!(described.contains("20 frames, 2.00 s at 10 per second\n"), "{described}");
    assert!(described.contains("about 5 minutes"), "{described}");
    // A format changes the name, and a name the format. Movies of ffmpeg have even sides.
    let choose = |format: &str| {
        browser.evaluate(&format!("(at('export-format').value = '{format}', at('export-format').dispatchEvent(new Event('change')), at('export-target').value)"))
    };
    assert_eq!(choose("mp4"), json!("out/ball.mp4"));
    assert!(facts().contains("162 × 90 pixels") && facts().contains("/out/ball.mp4"), "{}", facts());
    assert_eq!(choose("gif"), json!("out/ball.gif"));
    assert!(facts().contains("161 × 90 pixels"), "{}", facts());
    assert_eq!(choose(""), json!("out/ball"));
    let typed = browser.evaluate("(at('export-target').value = '/a/long/way/down/into/the/folders/of/somebody/far/away/from/here/film.webm', at('export-target').dispatchEvent(new Event('input')), at('export-format').value)");
    assert_eq!(typed, json!("webm"));
    // Names are not broken, since lines break between them.
    let broken = "[...document.querySelectorAll('#export-facts .whole')].filter(name => name.offsetHeight > 30).map(name => name.textContent)";
    assert_eq!(browser.evaluate(broken), json!([]));
    assert_eq!(
        browser.evaluate("at('export-dialog').scrollWidth <= at('export-dialog').clientWidth"),
        json!(true)
    );
    assert!(facts().contains("/a/…/") && facts().contains("/from/here/film.webm"), "{}", facts());
    assert_eq!(browser.console(), json!([]));
}
