//! Comparison of what a command prints with what the book shows.

/// Returns true if a text is as shown, where a line `…` stands for any lines, and `…` within a line for any characters.
pub(crate) fn is_output(shown: &str, printed: &str) -> bool {
    let (shown, printed): (Vec<&str>, Vec<&str>) =
        (shown.trim_end().lines().collect(), printed.trim_end().lines().collect());
    is_match(&shown, &printed, &|shown, line| is_line(shown, line), &"…")
}

fn is_line(shown: &str, line: &str) -> bool {
    let (shown, line): (Vec<char>, Vec<char>) =
        (shown.trim_end().chars().collect(), line.trim_end().chars().collect());
    is_match(&shown, &line, &|shown, character| shown == character, &'…')
}

/// Returns true if a list matches a pattern, in which the wildcard stands for any number of items.
fn is_match<T: PartialEq + Copy>(
    pattern: &[T],
    list: &[T],
    is_same: &dyn Fn(T, T) -> bool,
    wildcard: &T,
) -> bool {
    let Some((first, rest)) = pattern.split_first() else { return list.is_empty() };
    if first == wildcard {
        return (0..=list.len()).any(|skipped| is_match(rest, &list[skipped..], is_same, wildcard));
    }
    list.split_first()
        .is_some_and(|(item, others)| is_same(*first, *item) && is_match(rest, others, is_same, wildcard))
}

#[test]
fn wildcards_stand_for_lines_and_characters() {
    assert!(is_output("a\n…\nd … s\n", "a\nb\nc\nd 1.5 s\n"));
    assert!(is_output("…\n", ""));
    assert!(!is_output("a\n…\nd … s\n", "a\nd 1.5 m\n"));
    assert!(!is_output("a\n", "a\nb\n"));
}
