//! Tests of the dialog that renders into files.

use serde_json::json;

use crate::{Preview, open, until};

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
    until(&browser, "shown !== null && shown.full");
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
    let long = crate::SCENE.replace("film: (", "sampling: (samples: 5000), film: (");
    preview.save(&long);
    until(&browser, "state.reloads > 1");
    render("long");
    until(&browser, "state.export?.end === null");
    assert_eq!(browser.console(), json!([]));
    render("other");
    until(&browser, "at('export-refused').textContent.startsWith('a film is being rendered')");
    browser.click("#export-close");
    browser.click("#export button");
    ends("cancelled");
}
