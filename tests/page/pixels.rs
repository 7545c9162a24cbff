//! Tests of pinned pictures, of differences and of the loupe.

use serde_json::json;

use crate::{Preview, SCENE, open, until};

#[test]
fn pinned_pictures_are_compared() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && at('differ').disabled && at('wipe').disabled");
    browser.press('p');
    until(&browser, "pinned !== null && at('before').naturalWidth === 160 && !at('wipe').disabled");
    assert_eq!(
        browser.evaluate("at('before').src.startsWith('blob:') && at('swap').textContent"),
        json!("Pinned")
    );
    browser.press('d');
    until(&browser, "at('compared').innerText === 'difference × 1 from the pinned picture: same'");

    // Another frame, through all amplifications.
    let seek = |frame: u32| {
        browser.evaluate(&format!("(seek({frame}), true)"));
        until(&browser, &format!("shown.full && shown.frame === {frame}"));
    };
    seek(15);
    // The largest difference of a channel, the fraction of different pixels, and whether the canvas shows them.
    browser.evaluate(
        "(window.differences = gain => {
            const [now, past] = [at('now'), at('before')].map(image => bytesOf(image).data), canvas = at('difference'), copy = element('canvas', undefined, { width: canvas.width, height: canvas.height }).getContext('2d', { willReadFrequently: true });
            copy.drawImage(canvas, 0, 0);
            const drawn = copy.getImageData(0, 0, canvas.width, canvas.height).data;
            let most = 0, right = canvas.width === 160 && canvas.height === 90;
            for (let byte = 0; byte < now.length; byte++) {
                const apart = Math.abs(now[byte] - past[byte]);
                most = Math.max(most, apart);
                right &&= drawn[byte] === (byte % 4 === 3 ? 255 : Math.min(255, gain * apart));
            }
            return [most, right];
        }, true)",
    );
    for gain in [1, 8, 64] {
        until(
            &browser,
            &format!(
                "at('compared').innerText.startsWith('difference × {gain} from the pinned picture, frame 0: at most ')"
            ),
        );
        let [most, right]: [serde_json::Value; 2] =
            serde_json::from_value(browser.evaluate(&format!("differences({gain})"))).unwrap();
        assert_eq!(right, json!(true), "{gain}");
        let text = browser.evaluate("at('compared').innerText");
        assert!(
            text.as_str().unwrap().contains(&format!("at most {most} of 255, in ")) && most != 0,
            "{text}"
        );
        browser.press('d');
    }
    until(&browser, "at('difference').hidden && at('compared').hidden && view.gain === null");

    // It survives edits and playback.
    preview.save(&SCENE.replace("255, 120, 60", "0, 255, 0"));
    until(&browser, "shown.full && shown.reloads === 2");
    browser.press(' ');
    until(&browser, "playing !== null && view.frame > 17");
    browser.press(' ');
    seek(0);
    browser.press('w');
    until(&browser, "at('film').classList.contains('wipe') && at('compared').innerText === 'left: pinned'");
    browser.press('b');
    until(&browser, "at('film').classList.contains('swap') && at('compared').innerText === 'pinned'");
    browser.evaluate("(window.pinnedColor = bytesOf(at('before')).data.slice(4 * (45 * 160 + 80), 4 * (45 * 160 + 80) + 3).join())");
    assert_ne!(
        browser.evaluate("pinnedColor"),
        browser
            .evaluate("bytesOf(at('now')).data.slice(4 * (45 * 160 + 80), 4 * (45 * 160 + 80) + 3).join()")
    );
    browser.press('d');
    until(&browser, "!at('difference').hidden && view.wipe === null && !view.swap");
    // A picture of another size has no difference.
    browser.evaluate("(at('detail').value = 'half', at('detail').onchange({ target: at('detail') }), true)");
    until(
        &browser,
        "shown.width === 80 && at('compared').innerText.endsWith('sizes differ: 160 × 90 and 80 × 45')",
    );
    browser.evaluate("(at('detail').value = 'full', at('detail').onchange({ target: at('detail') }), true)");
    until(&browser, "shown.full && at('compared').innerText.includes('of the pixels')");

    // Without it, the picture before the edit is compared again.
    browser.click("#pin");
    until(
        &browser,
        "pinned === null && at('before').src.includes('picture/') && at('swap').textContent === 'Before'",
    );
    assert_eq!(browser.console(), json!([]));
}

#[test]
fn loupe_shows_the_pixels_around() {
    let preview = Preview::new();
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && at('loupe').hidden");
    browser.evaluate("(hovered = null, probe([70, 40]), true)");
    browser.hold('z', true);
    until(&browser, "!at('loupe').hidden");
    let read = "bytesOf(at('now')).data.slice(4 * (40 * 160 + 70), 4 * (40 * 160 + 70) + 3).join(' ')";
    let color = browser.evaluate(read).as_str().unwrap().to_owned();
    assert_eq!(browser.evaluate("at('loupe').innerText"), json!(format!("70, 40: {color}")));
    // The corner of the loupe is four pixels away.
    let corner = "[at('loupe').firstChild.getContext('2d').getImageData(3, 3, 1, 1).data.join(), bytesOf(at('now')).data.slice(4 * (36 * 160 + 66), 4 * (36 * 160 + 66) + 4).join()]";
    let corner = browser.evaluate(corner);
    assert_eq!(corner[0], corner[1]);
    // It follows the pointer, and stays inside the stage.
    let [x, y]: [f64; 2] = serde_json::from_value(browser.evaluate(
        "(({ left, top, width, height }) => [left + 0.8 * width, top + 0.7 * height].map(Math.round))(at('film').getBoundingClientRect())",
    ))
    .unwrap();
    browser.point(&[json!({ "type": "pointerMove", "duration": 20, "origin": "viewport", "x": x, "y": y })]);
    until(&browser, "hovered !== null && at('loupe').innerText.startsWith(hovered.join(', ') + ': ')");
    let inside = "(([own, stage]) => own.right <= stage.right && own.bottom <= stage.bottom && own.left >= stage.left)([at('loupe'), at('stage')].map(part => part.getBoundingClientRect()))";
    assert_eq!(browser.evaluate(inside), json!(true));
    browser.hold('z', false);
    until(&browser, "at('loupe').hidden");
    assert_eq!(browser.console(), json!([]));
}
