//! Tests of warnings on the page.

use serde_json::{Value, json};

use crate::http::request;
use crate::{Preview, SCENE, open, settle, until};

/// An expression that is true if no part of the warnings is over the picture, and no text is outside the page.
const BESIDE: &str = "(() => {
    const film = at('stage').getBoundingClientRect(), width = document.documentElement.scrollWidth;
    return width === innerWidth && ['warned', 'warnings'].every(id => {
        const box = at(id).getBoundingClientRect();
        return box.height > 0 && (box.right <= film.left || box.left >= film.right || box.bottom <= film.top || box.top >= film.bottom);
    }); })()";

#[test]
fn warnings_are_beside_the_picture_until_they_are_mended() {
    let pale = SCENE.replace("(255, 120, 60)", "(1, 0.5, 0.25)");
    let hidden_light = "(light: Point(intensity: (1, 1, 1)), transform: (translation: (0, 0, 0))),\n    ],";
    let both = pale.replacen("    ],", &format!("        {hidden_light}"), 1);
    let preview = Preview::of(&both);
    let host = format!("127.0.0.1:{}", preview.port);
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && !at('warnings').hidden");
    let text = |id: &str| browser.evaluate(&format!("at('{id}').innerText")).as_str().unwrap().to_owned();
    assert_eq!(text("warned"), "2 warnings");
    let listed = text("warnings");
    for part in [
        "2 warnings",
        "a colour that is almost black: no channel is above 1",
        "channels are from 0 to 255: write (255, 128, 64), or (255, 188, 137) for linear light as in POV-Ray",
        "ball.ron:6:52 · dark-color",
        "entity #2 lights nothing in view",
        "ball.ron:10 · idle-light",
    ] {
        assert!(listed.contains(part), "{part}: {listed}");
    }
    let state = request(preview.port, "GET", "/state", &[("Host", &host)], "").body;
    let state: Value = serde_json::from_str(&state).unwrap();
    assert_eq!(state["warnings"]["list"][1]["name"], "idle-light");
    assert_eq!(state["warnings"]["unlisted"], 0);

    // The panels keep their place, and the button leads to the list.
    assert_eq!(browser.evaluate(BESIDE), json!(true));
    browser.click("#warned");
    assert_eq!(browser.evaluate("document.activeElement.id"), json!("warnings"));
    let phone = json!({ "width": 360, "height": 640, "deviceScaleFactor": 2, "mobile": true });
    browser.emulate("Emulation.setDeviceMetricsOverride", &phone);
    until(&browser, "innerWidth === 360");
    until(&browser, BESIDE);
    browser.click("#warned");
    until(&browser, "at('warnings').getBoundingClientRect().bottom <= innerHeight");

    // Mistakes hide them, as the last good picture is not the scene.
    preview.save("Scene(");
    until(&browser, "!at('wrong').hidden && at('warnings').hidden && at('warned').hidden");
    preview.save(&both);
    until(&browser, "at('wrong').hidden && !at('warnings').hidden");
    preview.save(&pale);
    until(
        &browser,
        "shown.full && at('warned').innerText === '1 warning' && !at('warnings').innerText.includes('idle')",
    );
    preview.save(SCENE);
    until(&browser, "shown.full && at('warnings').hidden && at('warned').hidden");
}

#[test]
fn allowed_warnings_are_not_shown() {
    let pale = SCENE.replace("(255, 120, 60)", "(1, 0.5, 0.25)");
    let preview = Preview::allowing(&pale, vec!["dark-color"]);
    let Some(browser) = open(&preview) else { return };
    settle(&browser);
    assert_eq!(browser.evaluate("at('warnings').hidden && at('warned').hidden"), json!(true));
}

/// Checks that texts of any length in the header move neither the picture nor the buttons, at widths from a tablet's to a desktop's.
#[test]
fn texts_of_the_header_do_not_move_the_picture_or_cover_buttons() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && at('unsaved').hidden");
    let tops = "[700, 761, 800, 900, 1000, 1100, 1280].map(width => {
        document.body.style.width = `${width}px`;
        const tops = ['', 'm', 'a text of some length', 'a text that is as long as the names of files may be '.repeat(4)].flatMap(text => {
            for (const id of ['status', 'written']) at(id).textContent = text;
            at('percent').textContent = text && '99 %';
            return [true, false].map(isHidden => {
                Object.assign(at('warned'), { hidden: isHidden, textContent: '12 warnings' });
                const [news, last, fit] = ['news', isHidden ? 'percent' : 'warned', 'fit'].map(id => at(id).getBoundingClientRect());
                return [at('view').getBoundingClientRect().top, fit.left, fit.top, last.right <= news.right + 0.5].join();
            });
        });
        return [new Set(tops).size, tops.every(places => places.endsWith('true'))].join();
    })";
    assert_eq!(browser.evaluate(tops), json!(vec!["1,true"; 7]));
}
