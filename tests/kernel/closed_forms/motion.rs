//! Tests of motion blur: a box at constant speed becomes a trapezoid.

use super::{engine, exponent, root_mean_square};

const COLUMNS: u32 = 256;
/// Width of the box, in units of its path while the shutter is open.
const WIDTH: f64 = 0.5;

/// Renders a white box of width 1/2 that passes the middle at a speed of 1 per second, straight ahead of the camera at a distance of 1,
/// while the shutter is open for `shutter` seconds. Returns the positions and values of a row of pixels.
fn row(shutter: f64, sampling: &str) -> Vec<(f64, f64)> {
    let mut engine = engine(&format!(
        r#"timeline: (fps: 1, duration: 3), film: (width: {COLUMNS}, height: 1, transfer: Classic), ambient: (1, 1, 1),
        sampling: ({sampling}), camera: (position: (0, 0, -1), view: (0, 0, 1), shutter: {shutter:?},
            screen: (distance: 1, width: 2, height: 1)),
        materials: {{ "m": (k_a: 1) }}, entities: [(name: "box", shape: Box(size: ({WIDTH:?}, 2, 1e-9)), material: "m")],
        animate: [(target: "box", channel: Translation, track: Keys([(0, (-1, 0, 0)), (2, (1, 0, 0))]))]"#
    ));
    let film = engine.render_frame(1).unwrap();
    let place = |i: u32| -1.0 + 2.0 * f64::from(i) / f64::from(COLUMNS - 1);
    (0..COLUMNS).map(|i| (place(i), f64::from(film.pixel(i, 0).x))).collect()
}

/// Returns the share of the times from -open/2 to open/2 at which the box is at x.
fn trapezoid(x: f64, open: f64) -> f64 {
    let (first, last) = ((x - 0.5 * WIDTH).max(-0.5 * open), (x + 0.5 * WIDTH).min(0.5 * open));
    (last - first).max(0.0) / open
}

/// Checks that instants lie in the middles of equal parts of the shutter's time, and that a pixel that no edge crosses at any instant shows
/// the share of samples at which the box is there.
#[test]
fn moving_box_is_drawn_at_every_instant() {
    let pitch = 2.0 / f64::from(COLUMNS - 1);
    for (instants, samples) in [(2, 2), (3, 60), (4, 64), (16, 64), (7, 50)] {
        let times = (0..instants).map(|k| (f64::from(k) + 0.5) / f64::from(instants) - 0.5);
        let times: Vec<f64> = times.collect();
        // Sample s of n belongs to instant floor(s K / n).
        let share = |index: usize| {
            let of = |sample: u32| (sample * instants / samples) as usize == index;
            f64::from((0..samples).map(|sample| u32::from(of(sample))).sum::<u32>()) / f64::from(samples)
        };
        let mut whole = 0;
        for (x, found) in row(1.0, &format!("samples: {samples}, instants: {instants}")) {
            let to_edge = |time: &f64| 0.5 * WIDTH - (x - time).abs();
            if times.iter().any(|time| to_edge(time).abs() <= 0.5 * pitch) {
                continue;
            }
            let expected: f64 = times
                .iter()
                .enumerate()
                .filter(|(_, time)| to_edge(time) > 0.0)
                .map(|(index, _)| share(index))
                .sum();
            assert!(
                (found - expected).abs() < 1e-7,
                "{instants} instants, at {x}: {found} is not {expected}"
            );
            whole += 1;
        }
        assert!(whole > 190, "{whole}");
    }
}

/// Checks that there are at most as many instants as samples.
#[test]
fn there_are_never_more_instants_than_samples() {
    for samples in [2, 5, 8] {
        let some = row(1.0, &format!("samples: {samples}, instants: {samples}"));
        assert_eq!(row(1.0, &format!("samples: {samples}, instants: 256")), some);
    }
    let still = row(1.0, "samples: 64, instants: 1");
    assert!(
        still.iter().all(|(x, found)| (x.abs() - 0.5 * WIDTH).abs() < 0.01 || *found == trapezoid(*x, 1e-9))
    );
}

/// Checks that steps of a height of 1/K about a slope are off by up to half their height, and by 1/(K sqrt 12) RMS.
#[test]
fn steps_converge_to_the_trapezoid() {
    for open in [1.0, 0.5] {
        let mut errors = Vec::new();
        for instants in [2, 4, 8, 16] {
            let (mut on_slopes, mut largest) = (Vec::new(), 0.0_f64);
            for (x, found) in row(open, &format!("samples: 256, instants: {instants}")) {
                let difference = found - trapezoid(x, open);
                largest = largest.max(difference.abs());
                if ((open - WIDTH).abs()..open + WIDTH).contains(&(2.0 * x.abs())) {
                    on_slopes.push(difference);
                }
            }
            let count = f64::from(instants);
            assert!(largest < 0.55 / count, "{instants}: {largest}");
            errors.push((instants, root_mean_square(&on_slopes)));
        }
        println!("{errors:?}");
        let slope = exponent(&errors);
        assert!((-1.1..-0.9).contains(&slope), "K^{slope}: {errors:?}");
        let (count, error) = errors[1];
        let ratio = error * f64::from(count) * 12.0_f64.sqrt();
        assert!((0.8..1.2).contains(&ratio), "{ratio}");
    }
}
