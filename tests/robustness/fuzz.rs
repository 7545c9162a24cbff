//! The number and the seeds of test cases.

use std::time::{Duration, Instant, SystemTime};

use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseResult, TestRunner};

/// Returns a number from the environment.
pub(crate) fn variable(name: &str) -> Option<u64> {
    Some(std::env::var(name).ok()?.parse().unwrap_or_else(|_| panic!("{name} is not a number")))
}

/// Runs a check on many cases: by default the same few, or as many as the environment variables set.
pub(crate) fn fuzz<S: Strategy>(
    what: &str,
    few: u32,
    strategy: &S,
    check: impl Fn(S::Value) -> TestCaseResult,
) {
    let run = |seed: u64, cases: u32| {
        let rng_seed = RngSeed::Fixed(seed);
        let config = ProptestConfig {
            cases,
            failure_persistence: None,
            rng_seed,
            max_shrink_time: 120_000,
            ..ProptestConfig::default()
        };
        let outcome = TestRunner::new(config).run(strategy, &check);
        outcome.unwrap_or_else(|error| panic!("{what}, RAYREEL_FUZZ_SEED={seed}: {error}"));
    };
    let cases = variable("RAYREEL_CASES").map_or(few, |cases| u32::try_from(cases).unwrap());
    let fresh = || SystemTime::UNIX_EPOCH.elapsed().map_or(0, |elapsed| elapsed.as_secs() * 1000);
    let seconds = variable("RAYREEL_FUZZ_SECONDS").map(Duration::from_secs);
    match (variable("RAYREEL_FUZZ_SEED"), seconds) {
        (Some(seed), _) => run(seed, cases),
        (None, Some(duration)) => {
            let start = Instant::now();
            let first = fresh();
            let mut seed = first;
            while start.elapsed() < duration {
                println!("{what}: seed {seed}");
                run(seed, cases);
                seed += 1;
            }
            println!("{what}: {} cases", (seed - first) * u64::from(cases));
        }
        (None, None) if variable("RAYREEL_CASES").is_some() => {
            let seed = fresh();
            println!("{what}: seed {seed}");
            run(seed, cases);
        }
        (None, None) => run(2026, cases),
    }
}
