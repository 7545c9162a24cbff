//! The limits of scripts.

use std::time::{Duration, Instant};

use super::run;
use crate::script::limits;

/// A function that builds a script with the given number of items.
type Many = fn(usize) -> String;

#[test]
fn limits_are_inclusive() {
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
fn long_scripts_are_parsed_or_rejected_quickly() {
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
