//! Results of scripts.

use super::{number, run};
use crate::script::{Data, Language, NoResult, Read, ScriptContext, SpawnBudget, run_spawning};

#[test]
fn division_is_real() {
    for (text, expected) in [
        ("1 / 2", 0.5),
        ("let a = 7; a /= 2; a", 3.5),
        ("7 % 4", 3.0),
        ("-7 % 4", -3.0),
        ("mod(-7, 4)", 1.0),
        ("2 ** 10", 1024.0),
        ("2 ** -1", 0.5),
        ("2 ** 0.5", std::f64::consts::SQRT_2),
        ("let a = 3; a **= 2; a", 9.0),
        ("let a = 3; a %= 2; a", 1.0),
        ("let a = 3; a *= 0.5; a", 1.5),
        ("let a = 3; a += 0.5; a -= 1; a", 2.5),
        ("9223372036854775807 + 1", 9.223_372_036_854_776e18),
        ("let a = 9223372036854775807; a += 1; a *= 4; a", 3.689_348_814_741_910_3e19),
        ("-(-9223372036854775807 - 1)", 9.223_372_036_854_776e18),
    ] {
        assert_eq!(number(text).to_bits(), expected.to_bits(), "{text}");
    }
}

#[test]
fn functions_match_libm() {
    for (text, expected) in [
        ("sin(t)", libm::sin(2.5)),
        ("cos(t)", libm::cos(2.5)),
        ("tan(t)", libm::tan(2.5)),
        ("asin(0.3)", libm::asin(0.3)),
        ("acos(0.3)", libm::acos(0.3)),
        ("atan(t)", libm::atan(2.5)),
        ("atan2(t, -1)", libm::atan2(2.5, -1.0)),
        ("sinh(t)", libm::sinh(2.5)),
        ("cosh(t)", libm::cosh(2.5)),
        ("tanh(t)", libm::tanh(2.5)),
        ("exp(t)", libm::exp(2.5)),
        ("ln(t)", libm::log(2.5)),
        ("log(1000)", 3.0),
        ("log2(8)", 3.0),
        ("sqrt(2)", libm::sqrt(2.0)),
        ("cbrt(t)", libm::cbrt(2.5)),
        ("pow(t, 0.3)", libm::pow(2.5, 0.3)),
        ("t ** 0.3", libm::pow(2.5, 0.3)),
        ("hypot(3, 4)", 5.0),
        ("abs(-3) + abs(-0.5)", 3.5),
        ("sign(-0.1) + sign(0) + sign(7)", 0.0),
        ("floor(-1.5)", -2.0),
        ("ceil(-1.5)", -1.0),
        ("round(2.5)", 3.0),
        ("trunc(-1.5)", -1.0),
        ("fract(-0.25)", 0.75),
        ("min(3, 1, 2) + max([1, 5, 2])", 6.0),
        ("clamp(7, 0, 5)", 5.0),
        ("mix(2, 4, 0.25)", 2.5),
        ("step(1, 0.5) + step(1, 1)", 1.0),
        ("smoothstep(0, 2, 1)", 0.5),
        ("radians(180)", std::f64::consts::PI),
        ("degrees(pi)", 180.0),
        ("tau / 2 - pi", 0.0),
        ("length([2, 3, 6])", 7.0),
        ("distance([1, 1, 1], [3, 4, 7])", 7.0),
        ("dot([1, 2, 3], [4, 5, 6])", 32.0),
        ("sum([1, 2, 3.5])", 6.5),
        ("len([1, 2]) + len(\"abc\") + len(#{ a: 1 })", 6.0),
        ("frame + fps + index", 87.0),
    ] {
        assert_eq!(number(text).to_bits(), expected.to_bits(), "{text}");
    }
}

#[test]
fn lists_of_numbers_are_vectors() {
    let vector = |x: f64, y: f64, z: f64| [x, y, z];
    let numbers = |data: Data| match data {
        Data::List(list) => list
            .iter()
            .map(|part| match part {
                Data::Number(number) => *number,
                Data::Whole(whole) => f64::from(i32::try_from(*whole).unwrap()),
                other => panic!("{other:?}"),
            })
            .collect::<Vec<_>>(),
        other => panic!("{other:?}"),
    };
    for (text, expected) in [
        ("[1, 2, 3] + [10, 20, 30]", vector(11.0, 22.0, 33.0)),
        ("[1, 2, 3] - [10, 20, 30]", vector(-9.0, -18.0, -27.0)),
        ("2 * [1, 2, 3]", vector(2.0, 4.0, 6.0)),
        ("[1, 2, 3] / 2", vector(0.5, 1.0, 1.5)),
        ("-[1, 2, 3]", vector(-1.0, -2.0, -3.0)),
        ("let p = [0, 1, 0]; p += [1, 0, 0]; p *= 2; p", vector(2.0, 2.0, 0.0)),
        ("let p = [0, 1, 0]; p[1] += 0.5; p", vector(0.0, 1.5, 0.0)),
        ("base + [0, 1, 0]", vector(1.0, 3.0, 3.0)),
        ("cross([1, 0, 0], [0, 1, 0])", vector(0.0, 0.0, 1.0)),
        ("normalize([0, 3, 4])", vector(0.0, 0.6, 0.8)),
        ("mix([0, 0, 0], [2, 4, 6], 0.5)", vector(1.0, 2.0, 3.0)),
        ("append([1], [2, 3])", vector(1.0, 2.0, 3.0)),
        ("let list = []; for i in 1..4 { list.push(i); } reverse(list)", vector(3.0, 2.0, 1.0)),
    ] {
        assert_eq!(numbers(run(text).unwrap()), expected, "{text}");
    }
}

#[test]
fn scripts_have_variables_branches_loops_and_functions() {
    for (text, expected) in [
        ("let sum = 0; for i in 0..10 { sum += i; } sum", 45.0),
        ("let n = 0; while n < 7 { n += 1; } n", 7.0),
        ("if t > 2 { 1 } else { 0 }", 1.0),
        ("fn square(x) { x * x } square(3)", 9.0),
        ("fn wave(x) { sin(t + x) * pi } wave(0)", libm::sin(2.5) * std::f64::consts::PI),
        ("fn f(n) { if n < 2 { 1 } else { n * f(n - 1) } } f(5)", 120.0),
        ("let t = 9; t", 9.0),
        ("let s = 0; for k in keys(#{ a: 1, b: 2 }) { s += len(k); } s", 2.0),
        ("if [1, 2] == [1, 2.0] && 1 == 1.0 && \"a\" != \"b\" && 2 in [1, 2] { 1 } else { 0 }", 1.0),
        ("let p = #{ x: 1, y: [1, 2] }; p.y[1] += 3; p.y[1] + p.x", 6.0),
        ("switch index { 3 => 30, _ => 0 }", 30.0),
        ("let x = 0; for a in range(0, 10, 2) { x += a; } x", 20.0),
        ("let a = 5; a = a / 2; floor(a)", 2.0),
        ("[5, 6, 7][floor(5 / 2)]", 7.0),
        ("let n = 0; for x in range(0, 1, 0.1) { n += 1; } n", 10.0),
        ("let n = 0; for x in range(1, 0, -0.25) { n += x; } n", 2.5),
        ("let n = 0; for x in range(0.5, 3) { n += x; } n", 4.5),
    ] {
        assert_eq!(number(text), expected, "{text}");
    }
    assert_eq!(run("name + \"/\" + 6 / 2 + 1").unwrap(), Data::Text("ball/31".to_owned()));
    assert_eq!(run("`${6 / 2} ${0.1}`").unwrap(), run("6 / 2 + \" \" + 0.1").unwrap());
    assert_eq!(run("`post ${6 / 2}`").unwrap(), Data::Text("post 3".to_owned()));
    assert_eq!(run("`${name} ${index}`").unwrap(), Data::Text("ball 3".to_owned()));
    assert_eq!(run("let a = 1;").unwrap(), Data::Nothing);
}

#[test]
fn other_values_are_read_once_known() {
    let language = Language::new(0);
    let script =
        language.compile("let r = 0; try { r = value(\"ball\", \"Radius\"); } catch { } r * 2").unwrap();
    let mut context = ScriptContext::default();
    let read =
        |seconds| Read { target: "ball".to_owned(), channel: "Radius".to_owned(), seconds, span: 21..26 };
    assert_eq!(language.run(&script, &mut context), Err(NoResult::Needs(read(0.0))));
    context.set_value(&read(0.0), Data::Number(1.5));
    assert_eq!(language.run(&script, &mut context), Ok(Data::Number(3.0)));
    context.set_time(1.0, 24.0);
    assert_eq!(language.run(&script, &mut context), Err(NoResult::Needs(read(1.0))));
    context.set_time(0.0, 0.0);
    assert_eq!(language.run(&script, &mut context), Ok(Data::Number(3.0)));
    context.clear_values();
    assert_eq!(language.run(&script, &mut context), Err(NoResult::Needs(read(0.0))));
}

#[test]
fn other_moments_are_read_once_known() {
    let language = Language::new(0);
    let script = language
        .compile(
            "value(`ball`, `Radius`, t - 0.5) + 10 * value(`ball`, `Radius`, 2) + value(`ball`, `Radius`)",
        )
        .unwrap();
    let mut context = ScriptContext::default();
    context.set_time(2.0, 48.0);
    for (seconds, known) in [(1.5, 1.0), (2.0, 5.0)] {
        let Err(NoResult::Needs(read)) = language.run(&script, &mut context) else { panic!("{seconds}") };
        assert_eq!(read.seconds, seconds);
        context.set_value(&read, Data::Number(known));
    }
    assert_eq!(language.run(&script, &mut context), Ok(Data::Number(56.0)));
}

#[test]
fn randomness_is_a_function_of_its_arguments_and_the_seed() {
    let of = |seed: u64, text: &str| {
        let language = Language::new(seed);
        let script = language.compile(text).unwrap();
        language.run(&script, &mut ScriptContext::default()).unwrap()
    };
    assert_eq!(of(1, "random(3)"), of(1, "let a = random(7); random(3.0)"));
    assert_ne!(of(1, "random(3)"), of(2, "random(3)"));
    assert_ne!(of(1, "noise(3.3)"), of(2, "noise(3.3)"));
    assert_ne!(of(1, "noise(3.3, 1.1)"), of(1, "noise(3.3, 1.2)"));
}

#[test]
fn names_of_the_other_script_kind_are_not_reported_as_typos() {
    let refused = |text: &str| {
        let error = run_spawning(text, 0, &mut SpawnBudget::default(), |_| Ok(())).unwrap_err();
        (error.message, error.help, error.unknown)
    };
    for name in ["t", "frame", "fps", "duration", "index", "name", "base"] {
        let (message, help, unknown) = refused(&format!("spawn(#{{ shape: sphere({name}) }})"));
        assert_eq!(message, format!("nothing is called `{name}`"));
        assert!(help.is_some_and(|help| help.contains("spawns runs once")) && unknown.is_none());
    }
    let (message, help, _) = refused("value(\"ball\", \"Radius\")");
    assert_eq!(message, "there is no function `value`");
    assert!(help.is_some_and(|help| help.contains("scripts that drive a value")));
    let Err(NoResult::Error(error)) = run("clock * 360") else { panic!("there is no clock") };
    assert!(error.help.is_some_and(|help| help.contains("t / duration")));
    let (_, _, unknown) = refused("taw");
    assert_eq!(unknown.unwrap().known, ["pi", "tau", "e"]);
}
