//! Tests of the kernel against exact arithmetic, with random rays in numerically hard categories.
//!
//! Rays that start anywhere are compared with the exact result: hit or miss must always be right, and the distance within 2 units in the
//! last place. Rays that leave a surface must not hit it again because of rounding, must not pass through nearby surfaces, and must leave a
//! shape at the exact point. `RAYREEL_CASES` sets the number of cases per category; the default is 1000.

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
fn hits_and_distances_are_exact_in_every_category() {
    let cases = cases();
    let mut random = Random(2026);
    let mut wrong = Vec::new();
    let mut table = String::from(
        "Errors of distances in units in the last place of f64, median and worst; wrong verdicts.\n\n\
         | category | hits | ours | wrong | textbook f64 | wrong | textbook f32 | wrong |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for (name, make) in categories::CATEGORIES {
        let mut tallies: [primary::Tally; 3] = Default::default();
        for _ in 0..cases {
            primary::check(name, &make(&mut random), &mut tallies);
        }
        table += &format!("| {name} | {}", tallies[0].errors.len());
        for tally in &mut tallies {
            let (median, worst) = tally.median_and_worst();
            table += &format!(" | {}, {} | {}", short(median), short(worst), tally.wrong_verdicts);
        }
        table += " |\n";
        let [ours, ..] = &mut tallies;
        let (median, _) = ours.median_and_worst();
        if median > 0.5 {
            ours.wrong.push(format!("{name}: the median is off by {median} ulp"));
        }
        ours.wrong.truncate(3);
        wrong.append(&mut ours.wrong);
    }
    println!("{cases} cases in each of {} categories.\n{table}", categories::CATEGORIES.len());
    report(wrong);
}

#[test]
fn slabs_of_turned_boxes_are_their_maps_rounded_once() {
    let mut random = Random(7);
    for _ in 0..cases() {
        let place = random.point() * random.scale(-20..=40);
        let scale = random.scale(-60..=60);
        let factors = random.extents() * scale;
        let forward =
            if random.once_in(2) { random.turned(factors, place * scale) } else { random.sheared(place) };
        let shape = exact::Shape::Turned { forward, half: random.extents() };
        for error in shape.slab_errors() {
            assert!(error <= 0.500_001, "{error} units in the last place: {shape:?}");
        }
    }
}

/// Formats a number with two decimals, or as a power of ten.
fn short(number: f64) -> String {
    if number < 1000.0 { format!("{number:.2}") } else { format!("{number:.0e}") }
}

#[test]
fn spawned_rays_hit_the_exact_next_surface() {
    let cases = cases();
    let mut random = Random(1971);
    let mut wrong = Vec::new();
    let mut table = String::from("| category | cases | rays | wrong answers |\n|---|---|---|---|\n");
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
