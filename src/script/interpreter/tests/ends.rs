//! Termination of scripts that loop forever or grow without bounds.

use std::time::{Duration, Instant};

use super::mistake;

const LIST: &str = "a list that is too large";
const MAP: &str = "a map that is too large";
const TEXT: &str = "a text that is too large";
const LONG: &str = "this takes too long";

// Setup statements before a loop.
const FULL: &str = "let a = []; for i in 0..256 { a.push(i); }";
const LESS: &str = "let a = []; for i in 0..200 { a.push(i); }";
const FULL_OF_LISTS: &str = "let a = []; for i in 0..256 { a.push([]); }";
const FULL_MAP: &str = "let m = #{}; for i in 0..32 { m[`key ${i}`] = [i, i]; }";
const FULL_TEXT: &str = "let s = \"x\"; for i in 0..12 { s += s; }";

/// Setup statements and loop bodies of scripts that never end by themselves.
const TURNS: &[(&str, &str)] = &[
    (FULL, "a[0] += 0;"),
    (FULL, "let b = a;"),
    (FULL, "a = a;"),
    (FULL, "try { throw a; } catch (b) { }"),
    (FULL, "try { sum(a == a); } catch { }"),
    (LESS, "[[[[[[[[a]]]]]]]];"),
    (FULL, "switch a { 1 => 2 }"),
    (FULL, "`${a}`;"),
    (FULL, "for x in a { a[x] = x; }"),
    (FULL, "a.len();"),
    (LESS, "push(a, 1); pop(a);"),
    (LESS, "[a][0][0];"),
    (FULL_OF_LISTS, "a[0] += 0;"),
    (FULL_OF_LISTS, "let b = a;"),
    (FULL_OF_LISTS, "a == a;"),
    (FULL_OF_LISTS, "`${a}`;"),
    (FULL_OF_LISTS, "append(a, []);"),
    (FULL_MAP, "m[\"key 7\"][0] = 1;"),
    (FULL_MAP, "let n = m;"),
    (FULL_MAP, "`${m}`;"),
    (FULL_MAP, "keys(m);"),
    (FULL_TEXT, "s[4000] = 'b';"),
    (FULL_TEXT, "s[4000];"),
    (FULL_TEXT, "s[1..4000];"),
    (FULL_TEXT, "let r = s + \"\";"),
    (FULL_TEXT, "let r = `${s}`;"),
    (FULL_TEXT, "s == s + \"\";"),
    (FULL_TEXT, "contains(s, \"xxxxxxxxxxxxxxxxxxxxxxy\");"),
    (FULL_TEXT, "for c in s { s.len(); }"),
    ("", "try { sin(1, 2, 3, 4, 5, 6, 7); } catch { }"),
    ("", "try { [1][9]; } catch (error) { }"),
    ("", "try { no(1) } catch { } fn no(x) { x.nothing }"),
    ("", "let s = `${5e-324}${1e308}`;"),
    ("let x = 1;", "x[3] = true;"),
];

/// Scripts and their error messages; an empty message matches any.
const SCRIPTS: &[(&str, &str)] = &[
    ("loop { }", LONG),
    ("while true { let a = [1, 2, 3]; }", LONG),
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
    ("fn f() { for i in 0..8000 { this[`k${i}`] = i; } } let m = #{}; m.f(); 1", "`this` means nothing here"),
    ("let a = []; for i in 0..256 { a.push(i); } loop { mix(a, a, 0.5); }", LONG),
    ("let a = []; for i in 0..256 { a.push(i); } loop { -a; }", LONG),
    ("let a = []; for i in 0..256 { a.push(i); } loop { a[0] += 1; }", LONG),
    ("let a = []; for i in 0..256 { a.push(i); } loop { let b = a; let c = b + a; }", LONG),
    ("let a = []; for i in 0..256 { a.push(i); } loop { if a == [1] { } }", LONG),
    ("let s = \"a\"; for i in 0..12 { s += s; } loop { let r = s == \"b\"; s.len(); }", LONG),
    ("fn f(n) { f(n + 1) } f(0)", "functions call each other too deep"),
    ("fn f(n, a) { f(n + 1, [a, a]) } f(0, 1)", ""),
    ("fn f(n) { for i in 0..1000 { f(n); } } f(0)", ""),
    ("fn f(n) { if n > 30 { 0 } else { f(n + 1) + f(n + 1) } } f(0)", LONG),
    ("for i in 0..9223372036854775807 { }", LONG),
    ("try { loop { } } catch { 1 }", LONG),
    ("let a = []; for i in 0..256 { a.push(i); } loop { let b = a; }", LONG),
    ("let a = []; for i in 0..256 { a.push(i); } loop { dot(a, a); }", LONG),
    ("let a = []; for i in 0..256 { a.push(i); } loop { a == a; }", LONG),
    ("let a = []; for i in 0..256 { a.push(i); } loop { sum(reverse(a)); max(a); 7 in a; }", LONG),
    ("let m = #{}; for i in 0..32 { m[`key ${i}`] = [i, i]; } loop { let b = m; }", LONG),
    ("let m = #{}; for i in 0..32 { m[`key ${i}`] = i; } loop { m == m; keys(m); }", LONG),
];

/// Returns a script that runs the setup statements once and the loop body forever.
fn endless(before: &str, turn: &str) -> String {
    match turn.split_once(" fn ") {
        Some((turn, function)) => format!("fn {function} {before} loop {{ {turn} }}"),
        None => format!("{before} loop {{ {turn} }}"),
    }
}

/// Returns scripts that are too long or nested too deep, with their error messages.
fn oversized() -> [(String, &'static str); 5] {
    [
        (
            format!("fn f(n) {{ {}f(n + 1){} }} f(0)", "-(".repeat(5), ")".repeat(5)),
            "functions call each other too deep",
        ),
        (format!("{}1{}", "(".repeat(5000), ")".repeat(5000)), "this is nested too deep"),
        (format!("\"{}\"", "a".repeat(60_000)), TEXT),
        (format!("[{}]", "1, ".repeat(20_000)), LIST),
        (format!("1{}", " + 1".repeat(15_000)), ""),
    ]
}

#[test]
fn every_script_terminates_quickly() {
    let written = SCRIPTS.iter().map(|(text, message)| ((*text).to_owned(), *message));
    let endless = TURNS.iter().map(|(before, turn)| (endless(before, turn), LONG));
    let mut wrong = Vec::new();
    for (text, message) in written.chain(oversized()).chain(endless) {
        let start = Instant::now();
        let (found, _) = mistake(&text);
        let shown: String = text.chars().take(90).collect();
        println!("{:>8.1?} {shown}: {found}", start.elapsed());
        if start.elapsed() > Duration::from_secs(1) || !(message.is_empty() || found == message) {
            wrong.push(format!("{shown}: {found} after {:?}", start.elapsed()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
