//! Tests of the heat map.

use serde_json::json;

use crate::{Preview, SCENE, open, settle, until};

/// The page's map of rays has the same number of rays as its list of times.
const SUMS: &str = "heat !== null && RAY_KINDS.flatMap(kind => heat[kind]).reduce((sum, count) => sum + count, 0) === state.rays";

#[test]
fn heat_map_counts_the_rays_of_the_picture() {
    let mirror = r#"(name: "mirror", shape: Plane(normal: (0, 1, 0)), material: "mirror", transform: (translation: (0, -1, 0))),"#;
    let scene = SCENE
        .replace(
            "materials: {",
            r#"materials: { "mirror": (k_a: 0.1, k_d: 0.2, reflective: (k_r: 0.5), color: (255, 255, 255)),"#,
        )
        .replace("entities: [", &format!("entities: [{mirror}"));
    let preview = Preview::of(&scene);
    let Some(browser) = open(&preview) else { return };
    until(&browser, "shown !== null && shown.full && at('heat-map').hidden && at('heat-legend').hidden");
    browser.press('h');
    until(&browser, "!at('heat-map').hidden && at('heat').getAttribute('aria-pressed') === 'true'");
    assert_eq!(browser.evaluate(SUMS), json!(true));
    // Ten columns and six rows; those of the last row are ten pixels high.
    assert_eq!(
        browser.evaluate("[heat.camera.length, heat.camera[0], heat.camera[59], String(heatTile(59))]"),
        json!([60, 16 * 16, 16 * 10, "144,80,16,10"])
    );
    until(
        &browser,
        "/^[0-9.]+ rays per pixel on average: 1 camera, [0-9.]+ shadow, [0-9.]+ reflection$/.test(at('heat-count').textContent)",
    );
    // The least and the most rays have the ends of the scale.
    let ends = "((counts, copy) => {
        copy.drawImage(at('heat-map'), 0, 0);
        return [Math.min(...counts), Math.max(...counts)].map(count => {
            const [x, y, across, down] = heatTile(counts.indexOf(count));
            return [rounded(count), copy.getImageData(x + across - 1, y + down - 1, 1, 1).data.join()];
        });
    })(heat.camera.map((_, index) => total(raysOf(index))), element('canvas', undefined, { width: 160, height: 90 }).getContext('2d', { willReadFrequently: true }))";
    let ends = browser.evaluate(ends);
    assert_eq!((&ends[0][1], &ends[1][1]), (&json!("68,1,84,255"), &json!("253,231,37,255")));
    let scale = "[...document.querySelectorAll('#heat-scale span')].map(mark => mark.textContent)";
    let scale = browser.evaluate(scale);
    assert_eq!((&scale[0], &scale[2]), (&ends[0][0], &ends[1][0]));
    assert_ne!(scale[0], scale[2]);

    // The numbers at the marked pixel, which a click through the map marks, and at the pointer.
    browser.click("#film");
    until(&browser, "view.spot !== null");
    let numbers = |index: &str| {
        format!(
            "at('heat-count').textContent.startsWith(rounded(total(raysOf({index}))) + ' rays per pixel: 1 camera, ')"
        )
    };
    until(&browser, &numbers("Math.floor(view.spot[1] / 16) * 10 + Math.floor(view.spot[0] / 16)"));
    browser.evaluate("(hovered = null, moveSpot(-1000, -1000), true)");
    until(&browser, "at('heat-count').textContent === '1 ray per pixel: 1 camera'");

    // It lies on the picture at every zoom, below the one that is compared.
    browser.press('1');
    until(&browser, "at('heat-map').getBoundingClientRect().width * devicePixelRatio === 160");
    browser.press('0');
    let alike = "JSON.stringify(at('heat-map').getBoundingClientRect()) === JSON.stringify(at('now').getBoundingClientRect())";
    assert_eq!(browser.evaluate(alike), json!(true));
    browser.press('p');
    until(&browser, "pinned !== null && !at('wipe').disabled");
    browser.press('b');
    until(&browser, "at('film').classList.contains('swap')");
    let top = "(box => document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2).id)(at('film').getBoundingClientRect())";
    assert_eq!(browser.evaluate(top), json!("before"));
    until(&browser, "at('heat-legend').hidden");
    browser.press('b');
    until(&browser, "!at('heat-legend').hidden");
    browser.press('p');

    // It follows edits, other frames, whether cached or not, and drafts.
    preview.save(
        &scene.replace("radius: 1", "radius: 1.5").replace("film: (", "sampling: (samples: 4), film: ("),
    );
    until(&browser, "shown.full && shown.reloads === 2 && heat?.camera[0] === 4 * 16 * 16");
    assert_eq!(browser.evaluate(SUMS), json!(true));
    until(&browser, "state.cached.ranges.length === 1 && state.cached.ranges[0][1] === state.frames - 1");
    let before = browser.evaluate("heat.shadow");
    browser.evaluate("(seek(19), true)");
    until(
        &browser,
        "shown.full && shown.frame === 19 && heated === `tiles/${state.session}/${shown.id}` && heat !== null",
    );
    until(&browser, SUMS);
    assert_ne!(browser.evaluate("heat.shadow"), before);
    browser.evaluate("(at('detail').value = 'half', at('detail').onchange({ target: at('detail') }), true)");
    until(&browser, "shown.width === 80 && heat?.width === 80 && heat.camera.length === 15");
    assert_eq!(browser.evaluate(SUMS), json!(true));

    // It waits while the film plays.
    browser.press(' ');
    until(
        &browser,
        "playing !== null && at('heat-map').hidden && at('heat-count').textContent === 'Pause to see the numbers.'",
    );
    browser.press(' ');
    until(&browser, "playing === null && !at('heat-map').hidden");
    browser.press('h');
    until(
        &browser,
        "at('heat-map').hidden && at('heat-legend').hidden && !at('film').classList.contains('heat')",
    );
    assert_eq!(browser.console(), json!([]));
}

/// The RMS error of the tiles, which is that of the picture.
const RMS: &str = "Math.sqrt(heat.error.reduce((sum, error, index) => sum + error * error * pixelsOf(index), 0) / (heat.width * heat.height))";

#[test]
fn heat_map_shows_samples_and_errors() {
    let scene = |sampling: &str| SCENE.replace("film: (", &format!("sampling: ({sampling}), film: ("));
    let preview = Preview::of(&scene("samples: 4"));
    let Some(browser) = open(&preview) else { return };
    let choose = |kind: &str| {
        browser.evaluate(&format!(
            "(at('heat-kind').value = '{kind}', at('heat-kind').onchange({{ target: at('heat-kind') }}), true)"
        ));
    };
    settle(&browser);
    browser.press('h');
    until(&browser, "heat !== null");
    // The space bar plays although the pointer has left the focus on a button; a button that was reached by keys is pressed.
    browser.click("#loop");
    let is_looped = browser.evaluate("view.loop");
    browser.press(' ');
    until(&browser, "playing !== null");
    assert_eq!(browser.evaluate("view.loop"), is_looped);
    browser.press(' ');
    until(&browser, "playing === null && shown.full && heat !== null");
    browser.press('\u{e004}');
    browser.evaluate("(at('loop').focus(), true)");
    browser.press(' ');
    until(&browser, &format!("view.loop !== {is_looped} && playing === null"));
    browser.evaluate("(seek(0), true)");
    until(&browser, "shown.full && shown.frame === 0 && heat !== null");

    choose("samples");
    until(&browser, "at('heat-count').textContent === '4 samples per pixel on average'");
    assert_eq!(browser.evaluate("at('heat-scale').textContent"), json!("4"));

    // Without a target, the error is unknown until it is measured.
    choose("error");
    until(&browser, "at('heat-map').hidden && !at('heat-measure').hidden");
    browser.click("#heat-measure");
    until(
        &browser,
        "state.curve.length > 0 && heat?.is_measured && !at('heat-map').hidden && at('heat-measure').hidden",
    );
    let apart = browser.evaluate(&format!("Math.abs({RMS} / state.curve[0].error - 1)"));
    assert!(apart.as_f64().unwrap() < 1e-5, "{apart}");
    let whole = "at('heat-count').textContent === `measured error ${rounded(state.curve[0].error)} of 255 in the whole picture`";
    until(&browser, whole);
    // The edges of the ball have errors, the background has none.
    assert_eq!(
        browser.evaluate("[Math.min(...heat.error) === 0, Math.max(...heat.error) > 0]"),
        json!([true, true])
    );

    // Drafts have other errors than the full pictures that are measured.
    until(&browser, "!state.rendering");
    browser.evaluate("(at('detail').value = 'draft', at('detail').onchange({ target: at('detail') }), true)");
    until(
        &browser,
        "state.detail === 'draft' && shown.id === state.picture.id && !state.rendering && heat !== null && at('heat-map').hidden",
    );
    browser.press('m');
    until(&browser, "state.curve.length > 0 && heated.endsWith('?measured') && heat !== null");
    assert_eq!(browser.evaluate("[heat.error, at('heat-map').hidden]"), json!([null, true]));
    browser.evaluate("(at('detail').value = 'full', at('detail').onchange({ target: at('detail') }), true)");
    until(&browser, "shown.full && !state.rendering");
    // That of single samples is measured by more, tile by tile; the whole picture has the error of the list.
    preview.save(&scene("samples: 1"));
    until(&browser, "shown.full && shown.reloads === 2 && !state.rendering && heat !== null");
    browser.press('m');
    until(&browser, &format!("state.curve.length > 0 && heat?.is_measured && {whole}"));

    // With a target, it is estimated; edges take more samples. The choice stays.
    preview.save(&scene("samples: 256, max_error: 0.5"));
    until(
        &browser,
        "shown.full && shown.reloads === 3 && heat?.error && !heat.is_measured && !at('heat-map').hidden",
    );
    let rms = browser.evaluate(RMS).as_f64().unwrap();
    assert!(rms > 0.0 && rms <= 0.5, "{rms}");
    browser.evaluate("(hovered = [0, 0], describeHeat(), true)");
    until(
        &browser,
        "at('heat-count').textContent === `estimated error ${rounded(heat.error[0])} of 255 in this tile`",
    );
    choose("samples");
    until(&browser, "at('heat-count').textContent === `${rounded(heat.camera[0] / 256)} samples per pixel`");
    assert_eq!(
        browser.evaluate("Math.max(...heat.camera) > 2 * Math.min(...heat.camera.slice(0, 10))"),
        json!(true)
    );
    browser.evaluate("(location.reload(), true)");
    until(&browser, "typeof view === 'object' && heat !== null && at('heat-kind').value === 'samples'");
    assert_eq!(browser.console(), json!([]));
}
