//! What the language does, and what it refuses.

use std::time::{Duration, Instant};

use super::{Data, Language, Read, ScriptContext, SpawnBudget, Stop, limits, run_spawning};

fn run(text: &str) -> Result<Data, Stop> {
    let language = Language::new(0);
    let script = language.compile(text).map_err(|error| Stop::Error(Box::new(error)))?;
    let mut context = ScriptContext::new(24.0, 5.0);
    context.turn_to(2.5, 60.0);
    context.belong(3, "ball", Data::from([1.0, 2.0, 3.0]));
    language.run(&script, &mut context)
}

fn number(text: &str) -> f64 {
    match run(text) {
        Ok(Data::Number(number)) => number,
        #[expect(clippy::cast_precision_loss, reason = "small")]
        Ok(Data::Whole(whole)) => whole as f64,
        other => panic!("{text}: {other:?}"),
    }
}

/// The message, and what it marks.
fn mistake(text: &str) -> (String, String) {
    match run(text) {
        Err(Stop::Error(error)) => (error.message.clone(), text[error.span.clone()].to_owned()),
        other => panic!("{text}: {other:?}"),
    }
}

#[test]
fn division_is_that_of_real_numbers() {
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
fn functions_are_those_of_libm() {
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
fn mistakes_have_a_message_and_a_place() {
    let mut wrong = Vec::new();
    for (text, message, marked) in [
        ("let a = 0;\n 3 / a", "division by zero", "/"),
        ("5 % (t - t)", "division by zero", "%"),
        ("let a = 1; a /= 0", "division by zero", "/"),
        ("1 + sqrt(-t)", "the result is not a number", "sqrt"),
        ("exp(1000)", "the result is too large for a number", "exp"),
        ("ln(0)", "the logarithm of 0 is minus infinity", "ln"),
        ("1e308 * 10", "the result is too large for a number", "*"),
        ("asin(2)", "the result is not a number", "asin"),
        ("1 + 1e400", "this number is too large", "1e400"),
        ("fn f() { [1, -1e400] } 1", "this number is too large", "-"),
        ("normalize([1.7e308, 1.7e308, 0])", "the result is too large for a number", "normalize"),
        ("range(0, 1, 0.0)", "the step of `range` is 0", "range"),
        ("range(0, \"a\")", "`range` takes numbers, not a text", "range"),
        ("if 1 { 2 }", "expected true or false, found a number", "1"),
        ("let a = 1; a.foo = 2; a", "a number has no `foo`", "foo"),
        ("fn f(x) { 1 / x }\nf(0)", "division by zero", "/"),
        ("sin(\"a\")", "`sin` takes numbers, not a text", "sin"),
        ("sin(1, 2)", "`sin` does not take a number and a number", "sin"),
        ("[1, 2] + [1, 2, 3]", "`+` of a list of 2 and a list of 3 values", "+"),
        ("#{} + 1", "`+` does not take a map and a number", "+"),
        ("sim(t)", "there is no function `sim`", "sim"),
        ("radius * 2", "nothing is called `radius`", "radius"),
        ("if false { radius } else { 1 }", "nothing is called `radius`", "radius"),
        ("if false { sim(t) } else { 1 }", "there is no function `sim`", "sim"),
        ("fn f(x) { sim(x) } 1", "there is no function `sim`", "sim"),
        ("normalize([0, 0, 0])", "a vector of length 0 has no direction", "normalize"),
        ("t = 5", "`t` cannot be changed", "t"),
        ("[1, 2][5]", "there is no value 5 in a list of 2", "5"),
        ("throw \"no\"", "no", "throw"),
        ("[1, 2, 3][floor(1e300)]", "an index must be a whole number", "floor"),
        ("let a = [1, 2]; a[t]", "an index must be a whole number", "t"),
        ("[1, 2][0.5]", "an index must be a whole number", "0.5"),
        ("#{ a: 1 }[t]", "expected a text, found a number", "t"),
        ("[][0]", "the list is empty", "0"),
        ("\"ab\"[7]", "there is no character 7 in a text of 2", "7"),
        ("let a = range(0, 1, 0.1); a + 1", "`+` does not take a range and a number", "+"),
        ("len(range(0, 1, 0.1))", "`len` does not take a range", "len"),
        ("[1, 2] < [3, 4]", "`<` does not take a list and a list", "<"),
        ("throw", "the script stops itself by `throw`", "throw"),
        ("let a = #{ b: 1 }; a.c", "the map has no `c`", "c"),
        ("spawn(#{})", "`spawn` means nothing here", "spawn"),
        ("sphere(1)", "there is no function `sphere`", "sphere"),
        (
            "max(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17)",
            "`max` is called with too many values",
            "max",
        ),
        ("if t = 2 { 1 }", "`=` means nothing here", "="),
        ("t === 2", "`===` means nothing here", "="),
        ("1 +", "the script ends too early", ""),
        ("let a = 1 let b = 2", "expected `;`", "let"),
        ("[1 2]", "expected `,`", "2"),
        ("#{ a 1 }", "expected `:`", "1"),
        ("#{ a: 1, a: 2 }", "`a` is twice in this map", "a"),
        ("\"never closed", "this text is never closed", "\""),
        ("\"a\\q\"", "`\\q` stands for no character", "q"),
        ("1.5.2 + 1", "a name is missing", "2"),
        ("'ab'", "this is not one character", "'"),
        ("1 = 2", "this cannot be given a value", "1"),
        (
            "fn f(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r) { 1 }",
            "a function of too many values",
            ",",
        ),
        ("fn f(a, a) { a }", "two are called `a`", "a"),
        ("fn f(a) { a } fn f(b) { b }", "there are two functions `f` of 1 value", "fn"),
        ("if true { fn f() { 1 } }", "a function inside of something else", "fn"),
        ("break", "there is no loop to leave or to go on with", "break"),
        ("let 5 = 1", "the name of a variable is missing", "5"),
        ("switch t { _ => 1, 2 => 3 }", "a case of `switch` at a wrong place", "_"),
        ("import \"x\"", "`import` means nothing here", "import"),
        ("eval(\"1\")", "`eval` means nothing here", "eval"),
        ("print(1)", "`print` means nothing here", "print"),
        ("for i in 0..(9 / 3) { }", "`..` does not take a number and a number", "."),
    ] {
        let (found, at) = mistake(text);
        if (found.as_str(), at.as_str()) != (message, marked) {
            wrong.push(format!("{text}: {found}, at {at}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn whatever_a_script_does_it_ends_soon() {
    const LIST: &str = "a list that is too large";
    const MAP: &str = "a map that is too large";
    const TEXT: &str = "a text that is too large";
    let full = "let a = []; for i in 0..256 { a.push(i); }";
    let less = "let a = []; for i in 0..200 { a.push(i); }";
    let full_of_lists = "let a = []; for i in 0..256 { a.push([]); }";
    let full_map = "let m = #{}; for i in 0..32 { m[`key ${i}`] = [i, i]; }";
    let full_text = "let s = \"x\"; for i in 0..12 { s += s; }";
    let endless: Vec<String> = [
        (full, "a[0] += 0;"),
        (full, "let b = a;"),
        (full, "a = a;"),
        (full, "try { throw a; } catch (b) { }"),
        (full, "try { sum(a == a); } catch { }"),
        (less, "[[[[[[[[a]]]]]]]];"),
        (full, "switch a { 1 => 2 }"),
        (full, "`${a}`;"),
        (full, "for x in a { a[x] = x; }"),
        (full, "a.len();"),
        (less, "push(a, 1); pop(a);"),
        (less, "[a][0][0];"),
        (full_of_lists, "a[0] += 0;"),
        (full_of_lists, "let b = a;"),
        (full_of_lists, "a == a;"),
        (full_of_lists, "`${a}`;"),
        (full_of_lists, "append(a, []);"),
        (full_map, "m[\"key 7\"][0] = 1;"),
        (full_map, "let n = m;"),
        (full_map, "`${m}`;"),
        (full_map, "keys(m);"),
        (full_text, "s[4000] = 'b';"),
        (full_text, "s[4000];"),
        (full_text, "s[1..4000];"),
        (full_text, "let r = s + \"\";"),
        (full_text, "let r = `${s}`;"),
        (full_text, "s == s + \"\";"),
        (full_text, "contains(s, \"xxxxxxxxxxxxxxxxxxxxxxy\");"),
        (full_text, "for c in s { s.len(); }"),
        ("", "try { sin(1, 2, 3, 4, 5, 6, 7); } catch { }"),
        ("", "try { [1][9]; } catch (error) { }"),
        ("", "try { no(1) } catch { } fn no(x) { x.nothing }"),
        ("", "let s = `${5e-324}${1e308}`;"),
        ("let x = 1;", "x[3] = true;"),
    ]
    .map(|(before, turn)| match turn.split_once(" fn ") {
        Some((turn, function)) => format!("fn {function} {before} loop {{ {turn} }}"),
        None => format!("{before} loop {{ {turn} }}"),
    })
    .into();
    let deep = format!("{}1{}", "(".repeat(5000), ")".repeat(5000));
    let long = format!("\"{}\"", "a".repeat(60_000));
    let many = format!("[{}]", "1, ".repeat(20_000));
    let stacked = format!("fn f(n) {{ {}f(n + 1){} }} f(0)", "-(".repeat(5), ")".repeat(5));
    let chain = format!("1{}", " + 1".repeat(15_000));
    let texts = [
        ("loop { }", "this takes too long"),
        ("while true { let a = [1, 2, 3]; }", "this takes too long"),
        ("let a = []; loop { a.push(a); }", ""),
        ("let a = [0]; loop { a = append(a, a); }", ""),
        ("let s = \"a\"; loop { s += s; }", ""),
        ("let s = \"a\"; loop { s = `${s}${s}`; }", ""),
        ("let a = []; loop { a.push(\"0123456789012345678901234567890123456789\"); }", ""),
        ("let m = #{}; let i = 0; loop { m[`k${i}`] = m; i += 1; }", MAP),
        ("let m = #{}; for i in 0..8000 { m[`k${i}`] = i; } 1", MAP),
        ("let m = #{ a: #{} }; for i in 0..8000 { m.a[`k${i}`] = i; } 1", MAP),
        ("let l = [#{}]; for i in 0..8000 { l[0][`k${i}`] = i; } 1", MAP),
        ("let a = []; for i in 0..250 { a.push(i); } for i in 0..250 { a[i] = a; } 1", LIST),
        ("let a = [[]]; for i in 0..300 { a[0].push(i); } 1", LIST),
        ("let a = [0, 0]; loop { a[1] = a; }", LIST),
        ("let s = \"x\"; for i in 0..11 { s += s; } let a = [0, 0, 0]; for i in 0..3 { a[i] = s; } a", TEXT),
        ("let s = \"abc\"; loop { s[0..1] = s; }", TEXT),
        ("let k = \"x\"; for i in 0..11 { k += k; } let m = #{}; for i in 0..3 { m[k + i] = i; } m", TEXT),
        (
            "fn f() { for i in 0..8000 { this[`k${i}`] = i; } } let m = #{}; m.f(); 1",
            "`this` means nothing here",
        ),
        ("let a = []; for i in 0..256 { a.push(i); } loop { mix(a, a, 0.5); }", "this takes too long"),
        ("let a = []; for i in 0..256 { a.push(i); } loop { -a; }", "this takes too long"),
        ("let a = []; for i in 0..256 { a.push(i); } loop { a[0] += 1; }", "this takes too long"),
        (
            "let a = []; for i in 0..256 { a.push(i); } loop { let b = a; let c = b + a; }",
            "this takes too long",
        ),
        ("let a = []; for i in 0..256 { a.push(i); } loop { if a == [1] { } }", "this takes too long"),
        (
            "let s = \"a\"; for i in 0..12 { s += s; } loop { let r = s == \"b\"; s.len(); }",
            "this takes too long",
        ),
        ("fn f(n) { f(n + 1) } f(0)", "functions call each other too deep"),
        ("fn f(n, a) { f(n + 1, [a, a]) } f(0, 1)", ""),
        ("fn f(n) { for i in 0..1000 { f(n); } } f(0)", ""),
        ("fn f(n) { if n > 30 { 0 } else { f(n + 1) + f(n + 1) } } f(0)", "this takes too long"),
        ("for i in 0..9223372036854775807 { }", "this takes too long"),
        ("try { loop { } } catch { 1 }", "this takes too long"),
        ("let a = []; for i in 0..256 { a.push(i); } loop { let b = a; }", "this takes too long"),
        ("let a = []; for i in 0..256 { a.push(i); } loop { dot(a, a); }", "this takes too long"),
        ("let a = []; for i in 0..256 { a.push(i); } loop { a == a; }", "this takes too long"),
        (
            "let a = []; for i in 0..256 { a.push(i); } loop { sum(reverse(a)); max(a); 7 in a; }",
            "this takes too long",
        ),
        (
            "let m = #{}; for i in 0..32 { m[`key ${i}`] = [i, i]; } loop { let b = m; }",
            "this takes too long",
        ),
        (
            "let m = #{}; for i in 0..32 { m[`key ${i}`] = i; } loop { m == m; keys(m); }",
            "this takes too long",
        ),
        (&stacked, "functions call each other too deep"),
        (&deep, "this is nested too deep"),
        (&long, TEXT),
        (&many, LIST),
        (&chain, ""),
    ];
    let endless = endless.iter().map(|text| (text.as_str(), "this takes too long"));
    let mut wrong = Vec::new();
    for (text, message) in texts.into_iter().chain(endless) {
        let start = Instant::now();
        let (found, _) = mistake(text);
        let shown: String = text.chars().take(90).collect();
        println!("{:>8.1?} {shown}: {found}", start.elapsed());
        if start.elapsed() > Duration::from_secs(1) || !(message.is_empty() || found == message) {
            wrong.push(format!("{shown}: {found} after {:?}", start.elapsed()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A script of so many of something.
type Many = fn(usize) -> String;

#[test]
fn what_is_within_a_limit_is_taken_and_one_more_is_not() {
    let limits: [(&str, usize, Many); 11] = [
        ("values of a list", limits::LIST, |count| format!("[{}]", vec!["1"; count].join(", "))),
        ("values of a list in a list", limits::LIST - 1, |count| {
            format!("[[{}]]", vec!["1"; count].join(", "))
        }),
        ("values that are pushed", limits::LIST, |count| {
            format!("let a = []; for i in 0..{count} {{ a.push(i); }} a")
        }),
        ("values that are put into lists", limits::LIST - 1, |count| {
            format!("let a = [0]; let b = []; for i in 0..{count} {{ b.push(i); }} a[0] = b; a")
        }),
        ("values of a map", limits::MAP, |count| {
            let fields: Vec<String> = (0..count).map(|index| format!("f{index}: 1")).collect();
            format!("#{{ {} }}", fields.join(", "))
        }),
        ("values that are put into a map", limits::MAP, |count| {
            format!("let m = #{{}}; for i in 0..{count} {{ m[`${{i}}`] = i; }} m")
        }),
        ("bytes of a text", limits::TEXT, |count| format!("\"{}\"", "a".repeat(count))),
        ("variables", limits::VARIABLES, |count| {
            (0..count).map(|index| format!("let v{index} = 1; ")).collect()
        }),
        ("calls", limits::CALLS, |count| {
            format!("fn f(n) {{ if n > 1 {{ f(n - 1) }} else {{ 1 }} }} f({count})")
        }),
        ("functions", limits::FUNCTIONS, |count| {
            (0..count).map(|index| format!("fn f{index}() {{ 1 }}\n")).collect()
        }),
        ("values of a call", limits::ARGUMENTS, |count| {
            let names: Vec<String> = (0..count).map(|index| format!("v{index}")).collect();
            format!("fn f({}) {{ 1 }} f({})", names.join(", "), vec!["1"; count].join(", "))
        }),
    ];
    for (what, most, many) in limits {
        assert!(run(&many(most)).is_ok(), "{most} {what}: {:?}", run(&many(most)));
        assert!(run(&many(most + 1)).is_err(), "{} {what}", most + 1);
    }
}

#[test]
fn long_scripts_are_read_or_refused_soon() {
    let numbered = |part: fn(usize) -> String| {
        let mut text = String::new();
        (0..)
            .map(part)
            .take_while(|part| {
                text += part;
                text.len() < limits::SCRIPT - 100
            })
            .count();
        text
    };
    let repeated = |part: &str| part.repeat((limits::SCRIPT - 100) / part.len());
    let mut wrong = Vec::new();
    for (what, text) in [
        ("variables", numbered(|index| format!("let variable{index} = 1; "))),
        ("uses of variables", numbered(|index| format!("let v{index} = 1; v{}; ", index / 2))),
        ("constants", numbered(|index| format!("const C{index} = 1; "))),
        ("parameters", format!("fn f({}x) {{ 1 }} 1", numbered(|index| format!("v{index}, ")))),
        ("fields", format!("#{{ {} }}", numbered(|index| format!("f{index}: 1, ")))),
        ("functions", numbered(|index| format!("fn f{index}() {{ 1 }} "))),
        ("calls", format!("fn f() {{ 1 }} {}", repeated("f(); "))),
        ("unknown calls", repeated("sim(1); ")),
        ("cases", format!("switch t {{ {} }}", numbered(|index| format!("{index} => 1, ")))),
        ("ranges", format!("switch t {{ {} }}", numbered(|index| format!("{index}..{} => 1, ", index + 3)))),
        ("blocks", repeated("{")),
        ("comments", repeated("/* */")),
        ("opened comments", repeated("/*")),
        ("comments on functions", repeated("/// a\n")),
        ("negations", repeated("!")),
        ("minus signs", repeated("-")),
        ("chains", format!("t{}", repeated(".a"))),
        ("indices", format!("t{}", repeated("[0]"))),
        ("sums", format!("1{}", repeated("+1"))),
        ("opened texts", repeated("`${")),
        ("quotes", repeated("\"")),
        ("long names", format!("let {0} = 1; {0}", "a".repeat(limits::SCRIPT / 3))),
        ("branches", repeated("if t > 1 { 1 } else ") + "{ 2 }"),
        ("statements", repeated("1;")),
        ("lines", repeated("\n")),
    ] {
        let start = Instant::now();
        let result = run(&text);
        println!("{:>8.1?} {what}: {:?}", start.elapsed(), result.is_ok());
        if start.elapsed() > Duration::from_secs(1) {
            wrong.push(format!("{what}: {:?}", start.elapsed()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn others_are_read_when_they_are_known() {
    let language = Language::new(0);
    let script =
        language.compile("let r = 0; try { r = value(\"ball\", \"Radius\"); } catch { } r * 2").unwrap();
    let mut context = ScriptContext::default();
    let read = Read { target: "ball".to_owned(), channel: "Radius".to_owned(), span: 21..26 };
    assert_eq!(language.run(&script, &mut context), Err(Stop::Needs(read.clone())));
    context.know(&read, Data::Number(1.5));
    assert_eq!(language.run(&script, &mut context), Ok(Data::Number(3.0)));
    context.turn_to(1.0, 24.0);
    assert_eq!(language.run(&script, &mut context), Err(Stop::Needs(read)));
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
fn what_is_for_the_other_kind_of_script_is_not_called_mistyped() {
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
    let (_, _, unknown) = refused("taw");
    assert_eq!(unknown.unwrap().known, ["pi", "tau", "e"]);
}
