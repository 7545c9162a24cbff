//! Scripts with errors.

use super::mistake;

/// Scripts, their error messages, and the text that the errors mark.
const MISTAKES: &[(&str, &str, &str)] = &[
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
    ("value(\"a\", \"Radius\", \"now\")", "`value` takes a number of seconds, not a text", "value"),
    ("value(\"a\", \"Radius\", 1e61)", "there is no moment at 1e61 s", "value"),
    ("value(\"a\", \"Radius\", [t])", "`value` takes a number of seconds, not a list", "value"),
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
];

#[test]
fn script_mistakes_have_a_message_and_a_position() {
    let mut wrong = Vec::new();
    for (text, message, marked) in MISTAKES {
        let (found, at) = mistake(text);
        if (found.as_str(), at.as_str()) != (*message, *marked) {
            wrong.push(format!("{text}: {found}, at {at}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
