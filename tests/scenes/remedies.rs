//! Tests that remedies, followed to the letter, lead to valid scenes, and that the positions of mistakes in lists of any length are right.

use rayreel::Scene;
use rayreel::scene::LoadError;

const CAMERA: &str = "camera: (position: (0, 0, -5), target: (0, 0, 0))";

fn error(text: &str) -> LoadError {
    let read = Scene::from_text("scene.ron", text.to_owned());
    read.err().unwrap_or_else(|| panic!("it can be read:\n{text}"))
}

/// Returns the message, the remedy and the byte position of the first mistake.
fn first(text: &str) -> (String, String, usize) {
    let error = error(text);
    let diagnostic = error.mistakes().next().unwrap().diagnostic;
    let start = diagnostic.span.as_ref().unwrap().start;
    (diagnostic.message.clone(), diagnostic.help.clone().unwrap_or_default(), start)
}

/// Fields of a scene, with every form of their named values.
const NAMED: [(&str, &[&str]); 7] = [
    (
        "entities: [(material: \"clay\", shape: FORM)], materials: { \"clay\": (k_d: 1) }",
        &[
            "Sphere(radius: 0.7)",
            "Plane(normal: (0, 0.5, 0))",
            "Box(size: (1, 2, 3))",
            "Cylinder(radius: 0.3, from: (0, 1, 0), to: (2, 0, 0))",
            "Capsule(radius: 0.3, from: (0, 1, 0), to: (2, 0, 0))",
        ],
    ),
    (
        "entities: [(light: FORM)]",
        &[
            "Point(intensity: (1, 1, 1))",
            "Point(intensity: (1, 1, 1), casts_shadows: false)",
            "Spot(intensity: (1, 0.5, 1), angle: 30)",
            "Spot(intensity: (1, 0.5, 1), angle: 30, softness: 0.5)",
            "Directional(intensity: (1, 1, 1))",
            "Directional(intensity: (1, 1, 1), direction: (0, -1, 1))",
            "Area(shape: Sphere(radius: 2), intensity: (1, 1, 1))",
        ],
    ),
    (
        "entities: [(light: Area(shape: FORM, intensity: (1, 1, 1)))]",
        &["Sphere(radius: 0.7)", "Rectangle(width: 3, height: 4)"],
    ),
    (
        "animate: [(target: \"camera\", channel: Position, track: FORM)]",
        &[
            "Path(points: [(0, 0, -5), (1, 2, -5)], duration: 3)",
            "Orbit(center: (0, 1, 0), radius: 6, duration: 4)",
        ],
    ),
    ("materials: { \"clay\": FORM }", &["(k_a: 0.3, k_d: 0.7, color: (255, 120, 60))"]),
    ("materials: { \"clay\": (specular: FORM) }", &["(k_s: 0.4, shininess: 32)"]),
    (
        "fog: (color: (200, 200, 200), density: 0.05), film: FORM",
        &["(width: 64, height: 36)", "(width: 64, height: 36, transfer: Classic)"],
    ),
];

/// Removes the field names of a form, except inside inner brackets.
fn without_names(form: &str) -> String {
    let (mut depth, mut kept) = (0, String::new());
    for part in form.split_inclusive(['(', ')', '[', ']', ' ']) {
        let is_name = depth == 1 && part.ends_with(": ");
        if !is_name {
            kept += part;
        }
        depth += match part.chars().last() {
            Some('(' | '[') => 1,
            Some(')' | ']') => -1,
            _ => 0,
        };
    }
    kept
}

#[test]
fn positional_values_are_reported_with_their_names() {
    assert_eq!(without_names("Box(size: (1, 2), a: [B(c: 1)])"), "Box((1, 2), [B(c: 1)])");
    for (place, forms) in NAMED {
        for form in forms {
            let written = |form: &str| format!("({CAMERA}, {})", place.replace("FORM", form));
            assert!(Scene::from_text("scene.ron", written(form)).is_ok(), "{form}");
            let (message, help, _) = first(&written(&without_names(form)));
            assert_eq!(help, format!("write it as {form}"), "{form}: {message}");
        }
    }
    // The value of a single field, written with one bracket too few.
    let text = format!("({CAMERA}, entities: [(shape: Box(1, 2, 3))])");
    assert_eq!(first(&text).1, "write it as Box(size: (1, 2, 3))");
    // No remedy contains a value that cannot be read.
    for shape in ["Sphere(\"large\")", "Sphere(1, 2)", "Box(1, 2)", "Sphere(radius: 1, 2)", "Sphere([1])"] {
        let help = first(&format!("({CAMERA}, entities: [(shape: {shape})])")).1;
        let forms = ["Sphere(radius: 1)", "Box(size: (1, 1, 1))"];
        assert!(forms.iter().any(|form| help.contains(form)), "{shape}: {help}");
    }
}

/// Checks that missing struct names are reported if the extension requires names, until the scene can be read.
#[test]
fn explicit_struct_names_reports_missing_names() {
    let mut text = format!(
        "#![enable(explicit_struct_names)]\n({CAMERA}, film: (width: 8, height: 8), shots: [(0, \"camera\")],
    materials: {{ \"clay\": (specular: (k_s: 0.4, shininess: 32)) }},
    entities: [(shape: Sphere(radius: 1), material: \"clay\", transform: (scale: 2)), (name: \"b\")])"
    );
    for named in 0.. {
        let Err(error) = Scene::from_text("scene.ron", text.clone()) else {
            assert_eq!(named, 9);
            break;
        };
        let (message, help, start) = first(&text);
        let name = message.strip_prefix("expected the name `").and_then(|rest| rest.split('`').next());
        let name = name.unwrap_or_else(|| panic!("{error}"));
        assert!(help.starts_with(&format!("write `{name}( .. )`")), "{help}");
        let wrong = text.clone();
        text.insert_str(start, name);
        let mut wrong = wrong;
        wrong.insert_str(start, "Wrong");
        assert_eq!(first(&wrong).1, format!("write `{name}( .. )`"));
    }
}

#[test]
fn broken_extension_attributes_are_reported_as_such() {
    let head = "#![enable(implicit_some, unwrap_newtypes)]";
    let heads = (2..head.len()).map(|end| head[..end].to_owned());
    let without = (2..head.len()).map(|at| head[..at].to_owned() + &head[at + 1..]);
    for head in heads.chain(without).chain(["#![enable(nonsense)]".to_owned(), head.to_owned()]) {
        for scene in ["", "\n", "\n// a comment", &format!("\n({CAMERA})")] {
            let text = head.clone() + scene;
            let Err(error) = Scene::from_text("scene.ron", text.clone()) else { continue };
            let message = error.to_string();
            let is_about_it = message.contains("attribute") || message.contains("extension");
            assert!(is_about_it && message.contains(":1:1\n"), "{text}\n{message}");
        }
    }
}

#[test]
fn equal_mistakes_are_grouped_and_counted() {
    let entity = "(shape: Sphere(radius: 1), material: \"gold\"),";
    let with = |equal: usize| {
        let others = "(parent: \"nobody\"), (shape: Sphere(radius: 0), material: \"clay\")";
        format!(
            "({CAMERA}, materials: {{ \"clay\": (k_d: 1) }}, entities: [{}{others}])",
            entity.repeat(equal)
        )
    };
    for equal in [1, 2, 3, 4, 60, 3341] {
        let text = with(equal);
        let error = error(&text);
        let of_gold = error.mistakes().filter(|mistake| mistake.diagnostic.message.contains("\"gold\""));
        let places: Vec<usize> =
            of_gold.map(|mistake| mistake.diagnostic.span.clone().unwrap().start).collect();
        let expected: Vec<usize> = text.match_indices("\"gold\"").map(|(at, _)| at).take(3).collect();
        assert_eq!(places, expected);
        assert_eq!(error.mistakes().count() + error.unlisted(), equal + 2);
        // The other mistakes are listed, too, and none is left uncounted at the end.
        let message = error.to_string();
        assert!(message.contains("\"nobody\"") && message.contains("radius must"), "{message}");
        let counted = format!("(and {} more like this)", equal.saturating_sub(3));
        assert_eq!(message.contains(&counted), equal > 3, "{message}");
        assert!(!message.contains("more mistake"), "{message}");
    }
}

/// Checks positions at indices beyond one byte and beyond two bytes.
#[test]
fn places_in_lists_of_any_length_are_right() {
    const LISTS: [(&str, &str, &str, [&str; 2]); 4] = [
        ("entities: [", "(name: NAME),", "]", ["(parent: \"nobody\"),", "(parent: -7),"]),
        (
            "animate: [(target: \"camera\", channel: Position, track: Path(duration: 1, points: [",
            "(INDEX, 0, -5),",
            "]))]",
            ["(0, 1e999, 0),", "(0, up, 0),"],
        ),
        (
            "animate: [(target: \"camera\", channel: Fov, track: Keys([",
            "(INDEX, 40),",
            "]))]",
            ["(INDEX, 1e999),", "(INDEX, up),"],
        ),
        ("materials: {", "NAME: (k_d: 1),", "}", ["\"m\": (k_d: -7),", "\"m\": (k_d: up),"]),
    ];
    let marks = ["\"nobody\"", "-7", "1e999", "up"];
    for (begin, item, end, mistakes) in LISTS {
        for place in (255..=258).chain(65_535..=65_537) {
            for mistake in mistakes {
                let numbered = |item: &str, index: usize| {
                    item.replace("NAME", &format!("\"n{index}\"")).replace("INDEX", &index.to_string())
                };
                let mut text = format!("({CAMERA}, {begin}");
                (0..place).for_each(|index| text += &numbered(item, index));
                let wrong = numbered(mistake, place);
                let at = marks.iter().find_map(|mark| wrong.rfind(mark)).unwrap() + text.len();
                text += &wrong;
                (place + 1..place + 3).for_each(|index| text += &numbered(item, index));
                text += &format!("{end})");
                let (message, _, start) = first(&text);
                assert_eq!(start, at, "{begin} {place} {mistake} {message}");
            }
        }
    }
}
