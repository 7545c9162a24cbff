//! Tests of `rayreel probe --terms` and `--ray`: the printed terms must add up to the light, and agree with the hits.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use crate::probe::{json_of, numbers, probe, single};
use crate::text;

type Color = [f32; 3];

fn color(value: &Value) -> Color {
    let channels = numbers(value);
    std::array::from_fn(|channel| single(channels[channel]))
}

fn number(value: &Value) -> f32 {
    single(value.as_f64().unwrap())
}

fn each(one: Color, other: Color, operation: impl Fn(f32, f32) -> f32) -> Color {
    std::array::from_fn(|channel| operation(one[channel], other[channel]))
}

fn product(one: Color, other: Color) -> Color {
    each(one, other, |one, other| one * other)
}

fn sum(one: Color, other: Color) -> Color {
    each(one, other, |one, other| one + other)
}

/// Returns the colour of highlights and reflected light, given the terms of a surface.
fn metal(terms: &Value) -> Color {
    if terms["metal"].is_null() { [1.0; 3] } else { color(&terms["metal"]) }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap()
}

/// Returns the ray trees, with terms, of pixels all over a film of 24x16 pixels.
fn trees_of(scene: &str) -> Vec<Value> {
    let pixels = (0..24).step_by(3).flat_map(|i| (1..16).step_by(3).map(move |j| format!("{i},{j}")));
    pixels.map(|pixel| json_of(&[scene, "--pixel", &pixel, "--terms", "--size", "24x16"])).collect()
}

/// Returns the ray trees, with terms, of pixels that see all shapes of `terms.ron`, and all that gives light in `sky.ron`.
fn trees() -> Vec<Value> {
    ["terms.ron", "sky.ron"].into_iter().flat_map(trees_of).collect()
}

/// Returns the surfaces at the ends of the rays of trees, each with its ray.
fn surfaces(trees: &[Value]) -> Vec<(&Value, &Value)> {
    let rays = trees.iter().flat_map(|tree| list(&tree["rays"]));
    rays.map(|ray| (ray, &ray["surface"])).filter(|(_, surface)| !surface.is_null()).collect()
}

/// Checks that the terms of the surfaces at the ends of all rays add up to the light of the rays. Returns the numbers of light samples and
/// highlights.
fn check_light(trees: &[Value]) -> (u32, u32) {
    let (mut samples, mut highlights) = (0, 0);
    for (ray, surface) in surfaces(trees) {
        let terms = &surface["terms"];
        let ambient = color(&terms["c_ambient"]).map(|channel| channel * number(&terms["k_a"]));
        assert_eq!(product(ambient, color(&terms["I_a"])), color(&surface["ambient"]));
        let mut light_sum = sum(color(&surface["ambient"]), color(&surface["emission"]));
        let diffuse_color = color(&terms["c"]).map(|channel| channel * number(&terms["k_d"]));
        for light in list(&surface["lights"]) {
            let mut total = [0.0_f64; 3];
            for sample in list(&light["samples"]) {
                let (intensity, cosine) = (color(&sample["I"]), sample["N_L"].as_f64().unwrap());
                let diffuse = product(diffuse_color, intensity).map(|channel| channel * single(cosine.abs()));
                assert_eq!(diffuse, color(&sample["diffuse"]));
                if let Some(half) = sample["N_H"].as_f64() {
                    let share =
                        number(&terms["k_s"]) * single(libm::pow(half, terms["shininess"].as_f64().unwrap()));
                    let highlight = color(&sample["highlight"]);
                    let expected = product(intensity, metal(terms)).map(|channel| channel * share);
                    assert!(each(expected, highlight, |e, h| e - h).iter().all(|d| d.abs() < 1e-6));
                    highlights += 1;
                }
                let unoccluded = sum(diffuse, color(&sample["highlight"]));
                let arriving = product(unoccluded, color(&sample["V"]));
                assert_eq!(sample["hidden_by"].is_null(), color(&sample["V"]) != [0.0; 3]);
                total = std::array::from_fn(|channel| total[channel] + f64::from(arriving[channel]));
                samples += 1;
            }
            let count = light["sample_count"].as_f64().unwrap();
            let adds = if light["adds"].is_null() { [0.0; 3] } else { color(&light["adds"]) };
            assert_eq!(total.map(|channel| single(channel / count)), adds);
            light_sum = sum(light_sum, adds);
        }
        assert_eq!(light_sum, color(&ray["light"]));
    }
    (samples, highlights)
}

#[test]
fn printed_terms_add_up_to_the_light_of_every_surface() {
    let (samples, highlights) = check_light(&trees());
    assert!(samples > 200 && highlights > 40, "{samples} {highlights}");
}

#[test]
fn printed_terms_add_up_in_every_step_of_the_lesson() {
    let folder = "../../scenes/lesson";
    for (step, has_samples, has_highlights) in [
        ("1_ambient", false, false),
        ("2_diffuse", true, false),
        ("3_specular", true, true),
        ("4_reflection", true, true),
        ("5_refraction", true, true),
    ] {
        let trees = trees_of(&format!("{folder}/{step}.ron"));
        let (samples, highlights) = check_light(&trees);
        assert_eq!((samples > 0, highlights > 0), (has_samples, has_highlights), "{step}");
    }
}

#[test]
fn disabled_effects_have_no_terms() {
    for (effect, term) in
        [("ambient-light", "I_a"), ("diffuse-light", "k_d"), ("highlights", "k_s"), ("reflection", "k_r")]
    {
        let tree = json_of(&["terms.ron", "--pixel", "6,8", "--terms", "--without", effect]);
        let terms = &tree["rays"][0]["surface"]["terms"];
        assert!([json!(0.0), json!([0.0, 0.0, 0.0])].contains(&terms[term]), "{effect}: {}", terms[term]);
        check_light(&[tree]);
    }
    // Without area lights, a light has a single sample in its middle.
    let tree = json_of(&["terms.ron", "--pixel", "6,8", "--terms", "--without", "area-lights"]);
    assert_eq!(tree["rays"][0]["surface"]["lights"][2]["sample_count"], 1);
    check_light(&[tree]);
}

#[test]
fn terms_of_backgrounds_and_media_add_up() {
    let up = [-2, -1, 0, 1, 2].map(|x| [-2, -1, 0, 1, 2].map(|z| format!("0,9,0,{x}.37,1,{z}.21")));
    let up = up.iter().flatten().map(|ray| json_of(&["sky.ron", "--ray", ray, "--terms"]));
    let trees: Vec<Value> = trees_of("sky.ron").into_iter().chain(up).collect();
    let (mut suns, mut stars, mut fogs, mut solids) = (0, 0, 0, 0);
    for ray in trees.iter().flat_map(|tree| list(&tree["rays"])) {
        let background = &ray["background"];
        if !background.is_null() {
            let direction = numbers(&ray["direction"]);
            let y = direction[1] / direction.iter().map(|part| part * part).sum::<f64>().sqrt();
            let gradient = &background["gradient"];
            let share = number(&gradient["s"]);
            assert!((f64::from(share) - y.abs()).abs() < 1e-7, "{y} {gradient}");
            let mixed = each(color(&gradient["c1"]), color(&gradient["c2"]), |c1, c2| {
                c1 * (1.0 - share) + c2 * share
            });
            assert_eq!(mixed, color(&background["background"]));
            let lit = |light: &Value| color(&light["I"]).map(|channel| channel * number(&light["share"]));
            let lights = sum(lit(&background["sun"]), lit(&background["stars"]));
            assert_eq!(sum(mixed, lights), color(&ray["light"]));
            suns += u32::from(number(&background["sun"]["share"]) > 0.01);
            stars += u32::from(number(&background["stars"]["share"]) > 0.0);
        }
        let (depth, absorption) =
            (ray["fog_depth"].as_f64().unwrap_or(f64::INFINITY), color(&ray["absorption"]));
        let distance = ray["surface"]["distance"].as_f64().unwrap_or(0.0);
        let absorbed = absorption.map(|channel| libm::exp(-f64::from(channel) * distance));
        let (through, added) = (color(&ray["let_through"]), color(&ray["added"]));
        for channel in 0..3 {
            let fog = f64::from(color(&ray["fog"])[channel]) * (1.0 - libm::exp(-depth)) * absorbed[channel];
            assert!(
                (f64::from(through[channel]) - absorbed[channel] * libm::exp(-depth)).abs() < 1e-6,
                "{ray}"
            );
            assert!((f64::from(added[channel]) - fog).abs() < 1e-6, "{ray}");
        }
        fogs += u32::from(depth > 0.0);
        solids += u32::from(absorption != [0.0; 3]);
    }
    assert!([suns, stars, fogs, solids].iter().all(|count| *count > 1), "{suns} {stars} {fogs} {solids}");
}

#[test]
fn screens_of_parallel_rays_hold_the_starts_of_the_rays() {
    for tree in trees_of("sky.ron") {
        let (screen, ray) = (&tree["screen"], &tree["rays"][0]);
        assert_eq!((&screen["P0"], screen.get("d"), screen.get("P1_P0")), (&ray["origin"], None, None));
        let [n, u, v] = ["n", "u", "v"].map(|name| numbers(&screen[name]));
        let [alpha, beta] = ["alpha", "beta"].map(|name| screen[name].as_f64().unwrap());
        let eye = numbers(&screen["eye"]);
        assert_eq!(eye, [-1.0, 2.0, -6.0]);
        for axis in 0..3 {
            let start = eye[axis] + alpha * u[axis] + beta * v[axis];
            assert!((start - numbers(&screen["P0"])[axis]).abs() < 1e-14);
        }
        let direction = numbers(&ray["direction"]);
        let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
        assert!(direction.iter().zip(&n).all(|(part, n)| (part / length - n).abs() < 1e-15));
    }
}

#[test]
fn shares_of_secondary_rays_add_up_to_the_light_that_rays_bring_back() {
    let (mut kinds, mut metals) = ([0, 0], 0);
    for tree in trees() {
        let rays = list(&tree["rays"]);
        for (index, ray) in rays.iter().enumerate() {
            let mut light = color(&ray["light"]);
            let terms = &ray["surface"]["terms"];
            for child in rays.iter().rev().filter(|child| child["parent"] == index) {
                let kind = usize::from(child["kind"] == "refraction");
                let share = number(&terms[["reflected_share", "refracted_share"][kind]]);
                assert_eq!(child["brings_back"], terms[["R", "T"][kind]]);
                let returned = color(&child["brings_back"]).map(|channel| channel * share);
                light = sum(light, if kind == 0 { product(returned, metal(terms)) } else { returned });
                kinds[kind] += 1;
                metals += u32::from(kind == 0 && !terms["metal"].is_null());
            }
            let back = sum(product(color(&ray["let_through"]), light), color(&ray["added"]));
            assert_eq!(back, color(&ray["brings_back"]));
            if let (Some(k_t), Some(f)) = (terms["k_t"].as_f64(), terms["F"].as_f64()) {
                let (k_r, refracted) = (terms["k_r"].as_f64().unwrap(), k_t * (1.0 - f));
                assert!((terms["reflected_share"].as_f64().unwrap() - k_r - k_t * f).abs() < 1e-7);
                assert!((terms["refracted_share"].as_f64().unwrap() - refracted).abs() < 1e-7);
            }
        }
        // Rounding distinguishes the recursion from the renderer's sum over all rays.
        let difference = each(color(&rays[0]["brings_back"]), color(&tree["linear"]), |a, b| (a - b).abs());
        assert!(difference.iter().all(|difference| *difference < 1e-6), "{difference:?}");
    }
    assert!(kinds.iter().all(|count| *count > 10) && metals > 2, "{kinds:?} {metals}");
}

#[test]
fn equations_have_the_distance_of_the_hit_as_a_root() {
    let trees = trees();
    let mut shapes = std::collections::BTreeMap::new();
    for (_, surface) in surfaces(&trees) {
        let equation = &surface["terms"]["equation"];
        let (distance, roots) = (surface["distance"].as_f64().unwrap(), numbers(&equation["t"]));
        let is_equal = |root: &f64| (root - distance).abs() <= distance * f64::EPSILON;
        assert!(roots.iter().any(is_equal), "{distance} is none of {roots:?}");
        *shapes.entry(surface["entity"]["name"].as_str().unwrap()).or_insert(0) += 1;
        let value = |name: &str| equation[name].as_f64().unwrap();
        match equation["shape"].as_str().unwrap() {
            shape @ ("sphere" | "ellipsoid") => {
                let (a, b, c, d) = (value("A"), value("B"), value("C"), value("D"));
                assert!((b * b - 4.0 * a * c - d).abs() < 1e-13 * (b * b));
                assert_eq!(equation["direction"].is_array(), shape == "ellipsoid");
                if shape == "ellipsoid" {
                    let [direction, from_center] =
                        ["direction", "P0_Pc"].map(|name| numbers(&equation[name]));
                    let dot = |one: &[f64], other: &[f64]| -> f64 {
                        one.iter().zip(other).map(|(a, b)| a * b).sum()
                    };
                    assert!((dot(&direction, &direction) - a).abs() < 1e-14 * a);
                    assert!((2.0 * dot(&direction, &from_center) - b).abs() < 1e-14 * b.abs());
                }
                assert!((roots[0] + roots[1] + b / a).abs() < 1e-13 * (b / a).abs());
                assert!((roots[0] * roots[1] - c / a).abs() < 1e-12 * (1.0 + (c / a).abs()));
            }
            "plane" => {
                assert!((roots[0] * value("denominator") - value("numerator")).abs() < 1e-14);
            }
            _ => {
                let intervals = list(&equation["intervals"]).iter().filter(|interval| interval.is_array());
                let ends = |end: usize| intervals.clone().map(move |interval| numbers(interval)[end]);
                assert_eq!(roots, [ends(0).fold(f64::MIN, f64::max), ends(1).fold(f64::MAX, f64::min)]);
            }
        }
    }
    assert_eq!(
        shapes.keys().copied().collect::<Vec<_>>(),
        ["ball", "crate", "egg", "floor", "jelly", "lamp", "mirror", "tilted"]
    );
}

#[test]
fn equations_of_rods_are_those_of_their_sides_and_ends() {
    let equation = |ray: &str| {
        let report = json_of(&["rods.ron", "--ray", ray, "--terms"]);
        let surface = &report["rays"][0]["surface"];
        let equation = surface["terms"]["equation"].clone();
        assert!(numbers(&equation["t"]).contains(&surface["distance"].as_f64().unwrap()), "{equation}");
        equation
    };
    let near = |found: &Value, expected: &[f64]| {
        let found = numbers(found);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {expected:?}");
    };
    let root = 0.75_f64.sqrt();
    let column = equation("-3,1,0.5,1,0,0");
    let coefficients = ["A", "B", "C", "D"].map(|name| column[name].as_f64().unwrap());
    assert_eq!((&column["shape"], coefficients), (&json!("cylinder"), [1.0, -6.0, 8.25, 3.0]));
    assert_eq!((&column["direction"], &column["ends"]), (&Value::Null, &json!("all")));
    near(&column["side"], &[3.0 - root, 3.0 + root]);
    let pill = equation("5.5,9,0,0,-1,0");
    assert_eq!((&pill["shape"], &pill["A"], &pill["side"]), (&json!("capsule"), &json!(0.0), &json!("all")));
    near(&pill["t"], &[7.0 - root, 9.0 + root]);
    near(&pill["ends"][0], &[9.0 - root, 9.0 + root]);
    near(&pill["ends"][1], &[7.0 - root, 7.0 + root]);
    let wide = equation("7,1,0,2,0,0");
    assert_eq!((&wide["direction"], &wide["t"]), (&json!([0.5, 0.0, 0.0]), &json!([2.0, 4.0])));
    let output = probe(&["rods.ron", "--ray", "-3,1,0.5,1,0,0", "--terms"], "");
    let title = "cylinder: A t^2 + B t + C = 0 on its side, and t between its ends";
    assert!(String::from_utf8_lossy(&output.stdout).contains(title), "{output:?}");
}

#[test]
fn worked_examples_of_the_textbook_are_readable() {
    let report = json_of(&["seed.ron", "--ray", "0,-2,0,1,2,1", "--terms"]);
    let surface = &report["rays"][0]["surface"];
    let equation = &surface["terms"]["equation"];
    assert_eq!(
        (&equation["P0_Pc"], &equation["A"], &equation["C"]),
        (&json!([-3.0, -5.0, -1.0]), &json!(1.0), &json!(31.0))
    );
    // D = 784/6 - 124 = 20/3. The textbook truncates the last digits of the point, and those of the greater root.
    let (root_of_6, root_of_d) = (6.0_f64.sqrt(), (20.0_f64 / 3.0).sqrt());
    let t = [-1.0, 1.0].map(|sign| 0.5 * (28.0 / root_of_6 + sign * root_of_d));
    let point = [0.0, -2.0, 0.0].iter().zip([1.0, 2.0, 1.0]).map(|(p0, dir)| p0 + t[0] / root_of_6 * dir);
    let expected = [(-28.0 / root_of_6, -11.43), (20.0 / 3.0, 6.67), (t[0], 4.42), (t[1], 7.01)];
    let expected = expected.into_iter().chain(point.zip([1.80, 1.61, 1.80]));
    let found = [&equation["B"], &equation["D"], &equation["t"][0], &equation["t"][1]];
    let found: Vec<_> = found.into_iter().chain(list(&surface["point"])).collect();
    assert_eq!(found.len(), 7);
    for (found, (exact, rounded)) in found.into_iter().zip(expected) {
        let found = found.as_f64().unwrap();
        assert!((found - exact).abs() < 2e-15 && (found - rounded).abs() < 0.01, "{found} {exact}");
    }
    let screen = &json_of(&["seed.ron", "--pixel", "10,20", "--terms"])["screen"];
    let root = 2.0_f64.sqrt();
    for (name, expected) in [
        ("P0", [-2.0, -2.0, 0.0]),
        ("n", [1.0 / root, 1.0 / root, 0.0]),
        ("u", [-1.0 / root, 1.0 / root, 0.0]),
        ("v", [0.0, 0.0, 1.0]),
        ("P1_P0", [1.9 / root, 0.1 / root, 0.8]),
    ] {
        let found = numbers(&screen[name]);
        assert!(
            found.iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-15),
            "{name} {found:?}"
        );
    }
    for (name, expected) in [("d", 1.0), ("alpha", -0.9), ("beta", 0.8)] {
        assert!((screen[name].as_f64().unwrap() - expected).abs() < 1e-15, "{name}");
    }
}

#[test]
fn rays_of_pixels_give_the_trees_of_the_pixels() {
    for (scene, pixel) in [("corner.ron", "2,1"), ("mirrors.ron", "3,4"), ("seed.ron", "100,90")] {
        let of_pixel = json_of(&[scene, "--pixel", pixel]);
        let ray = &of_pixel["rays"][0];
        let ends = [numbers(&ray["origin"]), numbers(&ray["direction"])].concat();
        let ray = ends.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let of_ray = json_of(&[scene, "--ray", &ray]);
        assert_eq!((&of_ray["rays"], &of_ray["linear"]), (&of_pixel["rays"], &of_pixel["linear"]));
        assert_eq!(of_ray["ray"]["origin"], of_pixel["rays"][0]["origin"]);
        assert!(of_ray.get("pixel").is_none() && of_pixel.get("ray").is_none());
    }
    // The camera is outside the glass in which this ray starts.
    let inside = json_of(&["terms.ron", "--ray", "0.4,0.8,-1,0,0,3"]);
    assert_eq!(inside["rays"][0]["inside"][0]["name"], "egg");
    assert_eq!(inside["rays"][0]["surface"]["from_outside"], json!(false));
}

#[test]
fn lights_that_give_nothing_have_one_reason() {
    let reasons = |ray: &str, more: &[&str]| -> Vec<(String, String)> {
        let report = json_of(&[&["reasons.ron", "--ray", ray], more].concat());
        let lights = report["rays"][0]["surface"]["lights"].as_array().unwrap().clone();
        let reason = |light: &Value| match light["reason"].as_str().or(light["hidden_by"]["name"].as_str()) {
            Some(reason) => reason.to_owned(),
            None => light["outcome"].as_str().unwrap().to_owned(),
        };
        lights
            .iter()
            .map(|light| (light["entity"]["name"].as_str().unwrap().to_owned(), reason(light)))
            .collect()
    };
    let owned = |(name, reason): (&str, &str)| (name.to_owned(), reason.to_owned());
    assert_eq!(
        reasons("0,1,0,0,-1,0", &[]),
        [
            ("off", "the light is off"),
            ("below", "the light is behind the surface"),
            ("away", "the point is outside the light's cone"),
            ("far", "the point is beyond the light's reach"),
            ("blue", "the surface reflects none of the light's colour"),
            ("at", "the point is at the light"),
            ("hidden", "curtain"),
            ("absorbed", "absorbed by transparent shapes"),
        ]
        .map(owned)
    );
    for (ray, more, expected) in [
        ("10,1,0,0,-1,0", &[][..], "k_d is 0, and the surface has no highlights"),
        ("20,1,0,0,-1,0", &[], "the surface is black"),
        ("30,1,0,0,-1,0", &[], "the ray is outside the light's highlight"),
        ("20,1,0,0,-1,0", &["--without", "diffuse-light"], "diffuse light is disabled"),
        ("0,1,0,0,-1,0", &["--without", "diffuse-light"], "diffuse light is disabled"),
    ] {
        let found = reasons(ray, more);
        assert_eq!(found.iter().find(|(name, _)| name == "hidden").unwrap().1, expected, "{ray}");
    }
}

#[test]
fn invalid_rays_report_the_valid_form() {
    for (ray, message) in [
        ("1,2,3", "3 values instead of 6: write a ray as ox,oy,oz,dx,dy,dz, its origin and its direction"),
        ("0,0,x,0,0,1", "`x` is not a number: write one such as 1, -0.25 or 1e-3"),
        ("0,0,0,0,-0,0", "the direction is zero: let at least one of dx, dy and dz be another number"),
        (
            "inf,0,0,0,0,1",
            "`inf` is not finite: write a number from -1.7976931348623157e308 to 1.7976931348623157e308",
        ),
        (
            "0,0,0,0,0,NaN",
            "`NaN` is not finite: write a number from -1.7976931348623157e308 to 1.7976931348623157e308",
        ),
    ] {
        let output = probe(&["seed.ron", "--ray", ray], "");
        assert_eq!(output.status.code(), Some(2), "{ray}");
        let expected = format!("error: invalid value '{ray}' for '--ray <OX,OY,OZ,DX,DY,DZ>': {message}\n");
        assert!(text(&output.stderr).starts_with(&expected), "{}", text(&output.stderr));
    }
    for other in [["--pixel", "0,0"], ["--rays", "-"], ["--size", "5x5"], ["--sample", "0"]] {
        let output = probe(&[&["seed.ron", "--ray", "0,0,0,0,0,1"], &other[..]].concat(), "");
        assert_eq!(output.status.code(), Some(2), "{other:?}");
        assert!(text(&output.stderr).contains("cannot be used with"), "{other:?}");
    }
    let output = probe(&["seed.ron", "--rays", "-", "--terms"], "");
    assert!(text(&output.stderr).contains("cannot be used with"));
}

#[test]
fn printed_angles_obey_snell_and_fresnel() {
    let inside = json_of(&["terms.ron", "--ray", "0.78,0.8,-1,0,0,1", "--terms"]);
    let (mut passed, mut total) = (0, 0);
    for (_, surface) in surfaces(&[trees(), vec![inside]].concat()) {
        let terms = &surface["terms"];
        if terms["n"].is_null() {
            assert!(["cosines", "angles"].iter().all(|name| terms[name].is_null()));
            continue;
        }
        let ([n1, n2], [c1, c2]) = (pair(&terms["n"]), pair(&terms["cosines"]));
        let [theta1, theta2] = pair(&terms["angles"]).map(f64::to_radians);
        assert!((libm::cos(theta1) - c1).abs() < 1e-12);
        assert_eq!(terms["total_reflection"] == true, c2.is_nan());
        if c2.is_nan() {
            assert!(theta2.is_nan() && n1 * libm::sin(theta1) > n2 && terms["F"] == 1.0);
            total += 1;
            continue;
        }
        assert!((libm::cos(theta2) - c2).abs() < 1e-9);
        assert!((n1 * libm::sin(theta1) - n2 * libm::sin(theta2)).abs() < 1e-9);
        let [rs, rp] =
            [[n1 * c1, n2 * c2], [n1 * c2, n2 * c1]].map(|[one, other]| (one - other) / (one + other));
        // Materials without Fresnel's equations have an F of 0.
        let reflectance = terms["F"].as_f64().unwrap();
        if reflectance > 0.0 {
            assert!((0.5 * (rs * rs + rp * rp) - reflectance).abs() < 1e-6);
            passed += 1;
        }
    }
    assert!(passed > 4 && total > 0, "{passed} {total}");
}

/// Reads two numbers. `null` is read as NaN.
fn pair(value: &Value) -> [f64; 2] {
    [0, 1].map(|index| value[index].as_f64().unwrap_or(f64::NAN))
}

/// Collects the names of all fields of a value.
fn field_names(value: &Value, names: &mut BTreeSet<String>) {
    match value {
        Value::Object(fields) => {
            names.extend(fields.keys().cloned());
            fields.values().for_each(|value| field_names(value, names));
        }
        Value::Array(values) => values.iter().for_each(|value| field_names(value, names)),
        _ => {}
    }
}

#[test]
fn every_field_of_the_json_is_in_the_manual() {
    let manual = include_str!("../../src/cli/manual.md");
    let section = manual.split("\n## Pixel and ray queries\n").nth(1).unwrap().split("\n## ").next().unwrap();
    let described: BTreeSet<&str> = section.split('`').skip(1).step_by(2).collect();
    let rows = section
        .split("| field of ")
        .skip(1)
        .flat_map(|table| table.lines().skip(2).take_while(|line| line.starts_with('|')));
    let listed: Vec<&str> =
        rows.flat_map(|row| row.split('|').nth(1).unwrap().split('`').skip(1).step_by(2)).collect();
    let mut names = BTreeSet::new();
    let ray = json_of(&["terms.ron", "--ray", "0.4,0.8,-6,0,0,1", "--terms"]);
    [trees(), vec![ray]].concat().iter().for_each(|tree| field_names(tree, &mut names));
    names.remove("json_version");
    for name in &names {
        assert!(described.contains(name.as_str()), "the manual has no `{name}`");
    }
    assert!(listed.len() > 50, "{listed:?}");
    for name in listed {
        assert!(names.contains(name), "no object has `{name}`");
    }
}

/// Returns the number of lines of each class in a view of a drawing.
fn drawn(drawing: &str, view: usize, class: &str) -> usize {
    let start = format!("<path class=\"{class}\" d=\"");
    let lines = drawing.split("<g clip-path").nth(1 + view).unwrap().split("</g>").next().unwrap();
    // Arrowheads are in paths of their own, with three points.
    let paths = lines.split(&start).skip(1).filter_map(|rest| rest.split('"').next());
    paths.flat_map(|path| path.split('M').skip(1)).filter(|line| line.matches('L').count() == 1).count()
}

#[test]
fn drawings_show_all_rays_in_both_views() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rays.svg");
    let file = file.to_str().unwrap();
    let printed = crate::probe::stdout_of(&["corner.ron", "--pixel", "2,1", "--svg", file], "");
    let summary = "3 rays and 4 rays to lights, 1 of them occluded; the colour is 141, 132, 130";
    assert_eq!(printed, format!("{file}: {summary}\n"));
    let drawing = std::fs::read_to_string(file).unwrap();
    for view in [0, 1] {
        for (class, count) in [
            ("camera", 1),
            ("reflection", 2),
            ("refraction", 0),
            ("shadow", 3),
            ("occluded", 1),
            ("normal", 2),
        ] {
            assert_eq!(drawn(&drawing, view, class), count, "{class}");
        }
    }
    assert!(drawing.starts_with("<svg ") && !drawing.contains("NaN") && !drawing.contains("inf"));
    let title = "<title>Pixel 2,1 of 5x3, frame 0 at 0 s, camera (corner.ron:4)</title>";
    for text in [title, summary, ">camera ray<", ">to lamp<", ">back mirror<", "fill: rgb(141, 132, 130)"] {
        assert!(drawing.contains(text), "{text}\n{drawing}");
    }
    assert!(!drawing.contains(">refracted ray<"), "only lines that occur are in the legend");

    // The occluded shadow ray ends on the curtain: 0.3 from (1.5, 0, -1.5), before its light at (3, 0, -3).
    let occluded = drawing.split("<path class=\"occluded\" d=\"M").nth(1).unwrap();
    let ends: Vec<f64> =
        occluded.split(['L', ' ', '"']).filter_map(|part| part.parse().ok()).take(4).collect();
    let lamp = drawing.split("<circle class=\"lamp\"").find(|circle| circle.contains("<title>#3<")).unwrap();
    let lamp: Vec<f64> = lamp.split('"').filter_map(|part| part.parse().ok()).take(2).collect();
    let share = (ends[2] - ends[0]) / (lamp[0] - ends[0]);
    assert!((share - (0.5 - 0.1 * 0.5_f64.sqrt())).abs() < 1e-3, "{share}");

    crate::probe::stdout_of(&["terms.ron", "--ray", "0.4,0.8,-6,0,0,1", "--svg", file], "");
    let drawing = std::fs::read_to_string(file).unwrap();
    assert!(drawn(&drawing, 0, "refraction") > 2 && drawing.contains(">refracted ray<"));
    assert!(
        drawing.contains("<title>Ray from 0.4,0.8,-6 in direction 0,0,1, frame 0 at 0 s (terms.ron)</title>")
    );

    // The rays stay in the plane z = -1, which appears as a line from above and from the side.
    assert!(drawing.contains(">from above: ") && drawing.contains(">from the side: "));
    crate::probe::stdout_of(&["terms.ron", "--ray", "-6,0.9,-1,1,0,0", "--svg", file], "");
    let drawing = std::fs::read_to_string(file).unwrap();
    assert!(drawing.contains(">from the front: ") && !drawing.contains(">from the side: "));
    assert!(!drawing.contains("total reflection"));
    let inside =
        ["terms.ron", "--ray", "0.78,0.8,-1,0,0,1", "--depth", "2", "--without", "shadows", "--svg", file];
    crate::probe::stdout_of(&inside, "");
    assert!(std::fs::read_to_string(file).unwrap().contains(">total reflection 1<"));

    let output = probe(&["seed.ron", "--pixel", "0,0", "--svg", "seed.ron"], "");
    assert_eq!(text(&output.stderr), "error: `seed.ron` is the scene itself: name another file\n");
    for other in ["--json", "--terms"] {
        let output = probe(&["seed.ron", "--pixel", "0,0", "--svg", file, other], "");
        assert!(text(&output.stderr).contains("cannot be used with"), "{other}");
    }
}
