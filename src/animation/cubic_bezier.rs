//! Progress along a Bezier curve with two handles, as `cubic-bezier` in CSS Easing Functions Level 1.

/// Returns the progress at elapsed fraction `u` in 0..=1 of the curve from (0, 0) to (1, 1) with handles (x1, y1) and (x2, y2), where x is
/// time and y is progress. The times of the handles are clamped to 0..=1, so that every time has one progress.
pub(super) fn bezier([x1, y1, x2, y2]: [f64; 4], u: f64) -> f64 {
    let (x1, x2) = (x1.clamp(0.0, 1.0), x2.clamp(0.0, 1.0));
    let (mut low, mut high) = (0.0, 1.0);
    // Bisects until no number lies between the bounds. x ascends but may have a vertical tangent, where Newton's method fails.
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return coordinate(y1, y2, high);
        }
        if coordinate(x1, x2, middle) < u {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Returns a coordinate of the curve at a parameter, in Bernstein form, which has no cancellation for handles in 0..=1.
fn coordinate(first: f64, second: f64, parameter: f64) -> f64 {
    let rest = 1.0 - parameter;
    3.0 * (rest * rest * parameter * first + rest * parameter * parameter * second)
        + parameter * parameter * parameter
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Handles x1, y1, x2, y2, with u and the progress to 40 digits, rounded once.
    #[rustfmt::skip]
    const EXACT: [([f64; 4], f64, f64); 40] = [
        ([0.25, 0.1, 0.25, 1.0], 0.001, 0.0004048078221549123),
        ([0.25, 0.1, 0.25, 1.0], 0.25, 0.40851059135539586),
        ([0.25, 0.1, 0.25, 1.0], 0.3, 0.5133151609733584),
        ([0.25, 0.1, 0.25, 1.0], 0.5, 0.802403387584857),
        ([0.25, 0.1, 0.25, 1.0], 0.9, 0.9943164774845564),
        ([0.42, 0.0, 1.0, 1.0], 0.001, 1.8875054558443416e-06),
        ([0.42, 0.0, 1.0, 1.0], 0.25, 0.09346465071882486),
        ([0.42, 0.0, 1.0, 1.0], 0.3, 0.12957676084535255),
        ([0.42, 0.0, 1.0, 1.0], 0.5, 0.31535681257253934),
        ([0.42, 0.0, 1.0, 1.0], 0.9, 0.8394278457624665),
        ([0.0, 0.0, 0.58, 1.0], 0.001, 0.0017140056336284928),
        ([0.0, 0.0, 0.58, 1.0], 0.25, 0.37813813082510983),
        ([0.0, 0.0, 0.58, 1.0], 0.3, 0.44518596747133715),
        ([0.0, 0.0, 0.58, 1.0], 0.5, 0.6846431874274607),
        ([0.0, 0.0, 0.58, 1.0], 0.9, 0.9829733903484371),
        ([0.42, 0.0, 0.58, 1.0], 0.001, 1.8905015519453908e-06),
        ([0.42, 0.0, 0.58, 1.0], 0.25, 0.12916193104731982),
        ([0.42, 0.0, 0.58, 1.0], 0.3, 0.18739590670531256),
        ([0.42, 0.0, 0.58, 1.0], 0.5, 0.5),
        ([0.42, 0.0, 0.58, 1.0], 0.9, 0.9802775464516889),
        ([0.3, -0.6, 0.7, 1.6], 0.001, -0.0019889053269701892),
        ([0.3, -0.6, 0.7, 1.6], 0.25, 0.0003377927915325232),
        ([0.3, -0.6, 0.7, 1.6], 0.3, 0.07915576044285193),
        ([0.3, -0.6, 0.7, 1.6], 0.5, 0.5000000000000001),
        ([0.3, -0.6, 0.7, 1.6], 0.9, 1.1033905610526773),
        ([0.0, 1.0, 1.0, 0.0], 0.001, 0.05311076157643484),
        ([0.0, 1.0, 1.0, 0.0], 0.25, 0.479055466999209),
        ([0.0, 1.0, 1.0, 0.0], 0.3, 0.4897724732717028),
        ([0.0, 1.0, 1.0, 0.0], 0.5, 0.5),
        ([0.0, 1.0, 1.0, 0.0], 0.9, 0.6125996830227248),
        ([1.0, 0.0, 0.0, 1.0], 0.001, 3.3370419825627253e-07),
        ([1.0, 0.0, 0.0, 1.0], 0.25, 0.029724605511925198),
        ([1.0, 0.0, 0.0, 1.0], 0.3, 0.047395275203942),
        ([1.0, 0.0, 0.0, 1.0], 0.375, 0.09002960628942257),
        ([1.0, 0.0, 0.0, 1.0], 0.9, 0.9962383250419168),
        ([0.5, 0.5, 0.5, 0.5], 0.001, 0.001),
        ([0.5, 0.5, 0.5, 0.5], 0.25, 0.25),
        ([0.5, 0.5, 0.5, 0.5], 0.3, 0.3),
        ([0.5, 0.5, 0.5, 0.5], 0.5, 0.5),
        ([0.5, 0.5, 0.5, 0.5], 0.9, 0.9),
    ];

    #[test]
    fn progress_agrees_with_40_digits() {
        for (handles, u, expected) in EXACT {
            let found = bezier(handles, u);
            assert!((found - expected).abs() < 1e-15, "{handles:?} at {u}: {found}, not {expected}");
        }
    }

    /// Checks that progress is time up to rounding if y equals x, even where the curve is vertical, as at a half for (1, 0).
    #[test]
    fn progress_inverts_the_curve_up_to_rounding() {
        let parts = [0.0, 0.1, 1.0 / 3.0, 0.5, 0.9, 1.0];
        for x1 in parts {
            for x2 in parts {
                for u in (1..1000).map(|step| f64::from(step) / 1000.0).chain([1e-300, 1e-15]) {
                    let found = bezier([x1, x1, x2, x2], u);
                    assert!((found - u).abs() < 4e-16, "{x1} {x2} at {u}: {found}");
                }
            }
        }
    }

    #[test]
    fn progress_of_handles_within_the_square_never_goes_back() {
        let parts = [0.0, 0.3, 0.9, 1.0];
        for x1 in parts {
            for x2 in parts {
                let steps = (0..=1000).map(|step| bezier([x1, 0.2, x2, 0.7], f64::from(step) / 1000.0));
                assert!(steps.is_sorted(), "{x1} {x2}");
            }
        }
    }
}
