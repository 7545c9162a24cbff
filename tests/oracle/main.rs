//! The kernel against exact arithmetic, on random rays in the categories where numbers are hard.
//!
//! Rays that start anywhere are held against the exact verdict and distance: wherever the exact margin is more than 2^-90,
//! the verdict must be right and the distance within 2 units in the last place. Rays that leave a surface must not meet it
//! again by rounding, nor slip through what is near it. `RAYREEL_CASES` asks for more than the usual thousand cases a
//! category.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::cast_precision_loss,
    reason = "a test may fail loudly, prints its table, and rounds small integers"
)]

mod categories;
mod exact;
mod journeys;
mod primary;
mod random;
mod secondary;

use random::Random;

fn cases() -> usize {
    std::env::var("RAYREEL_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(1000)
}

fn report(mut wrong: Vec<String>) {
    let count = wrong.len();
    wrong.truncate(12);
    assert!(wrong.is_empty(), "{count} wrong:\n{}", wrong.join("\n"));
}

#[test]
fn verdicts_and_distances_are_right_in_every_category() {
    let cases = cases();
    let mut random = Random(2026);
    let mut wrong = Vec::new();
    let mut table = String::from(
        "| category | cases | hits | median ulp | worst ulp | wrong verdicts |\n|---|---|---|---|---|---|\n",
    );
    for (name, make) in categories::CATEGORIES {
        let mut tally = primary::Tally::default();
        for _ in 0..cases {
            primary::check(name, &make(&mut random), &mut tally);
        }
        let primary::Tally { mut errors, wrong_verdicts, wrong: mut found } = tally;
        errors.sort_by(f64::total_cmp);
        let (median, worst) =
            (errors.get(errors.len() / 2).copied().unwrap_or(0.0), errors.last().copied().unwrap_or(0.0));
        table += &format!(
            "| {name} | {cases} | {} | {median:.2} | {worst:.2} | {wrong_verdicts} |\n",
            errors.len()
        );
        if median > 0.5 {
            found.push(format!("{name}: the median is off by {median} ulp"));
        }
        found.truncate(3);
        wrong.append(&mut found);
    }
    println!("{table}");
    report(wrong);
}

#[test]
fn rays_that_leave_a_surface_meet_what_they_must() {
    let cases = cases();
    let mut random = Random(1971);
    let mut wrong = Vec::new();
    let mut table = String::from("| category | cases | rays asked | wrong answers |\n|---|---|---|---|\n");
    for (name, journey) in journeys::JOURNEYS {
        let mut tally = secondary::Tally::default();
        for _ in 0..cases {
            journey(&mut random, &mut tally);
        }
        table += &format!("| {name} | {cases} | {} | {} |\n", tally.rays, tally.wrong);
        assert!(tally.rays >= cases / 4, "{name} asks next to nothing");
        wrong.extend(tally.examples.into_iter().map(|example| format!("{name}: {example}")));
    }
    println!("{table}");
    report(wrong);
}
