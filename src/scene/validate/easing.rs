//! Validation of the numbers in easings.

use super::{At, Problems, check};
use crate::animation::Notation;
use crate::components::ValidRange;
use crate::scene::document::{EasingDocument, OffsetDocument};

pub(super) fn easing(easing: EasingDocument, notation: Notation, at: &At<'_>, problems: &mut Problems) {
    /// Maximum magnitude of a handle's progress, which keeps values far from overflow.
    const FARTHEST: f64 = 1000.0;
    match easing {
        EasingDocument::Hold | EasingDocument::Linear => {}
        _ if notation == Notation::Flag => {
            let message = "there is nothing between true and false";
            let help = "remove the easing: the value changes at the time of the next key";
            problems.add(at, message, "not here", help);
        }
        EasingDocument::Steps(count) => {
            let help = "write how many equal jumps to make, as Steps(8)";
            check::count(count, u32::MAX, "the number of steps", help, &at.index(0), problems);
        }
        EasingDocument::Bezier(x1, y1, x2, y2) => {
            for (index, x) in [(0, x1), (2, x2)] {
                let range = ValidRange::Between(0.0, 1.0);
                let help =
                    "write Bezier(x1, y1, x2, y2), x being shares of the time, as in cubic-bezier of CSS";
                check::range(x, range, "a handle's time", help, &at.index(index), problems);
            }
            for (index, y) in [(1, y1), (3, y2)] {
                let range = ValidRange::Between(-FARTHEST, FARTHEST);
                let help = "0 is at this key, 1 at the next; a little below or above swings beyond them";
                check::range(y, range, "a handle's progress", help, &at.index(index), problems);
            }
        }
        EasingDocument::Handles(out, back) => {
            for (index, offset) in [out, back].into_iter().enumerate() {
                handle(offset, notation, &at.index(index), problems);
            }
        }
        _ => {}
    }
}

fn handle(offset: OffsetDocument, notation: Notation, at: &At<'_>, problems: &mut Problems) {
    let one = matches!(notation, Notation::Number | Notation::Degrees);
    match (offset, notation) {
        (_, Notation::Rotation | Notation::Scale) => {
            let message = "rotations and scales have no handles";
            let help = "write another easing, as Cubic or InOutSine";
            problems.add(at, message, "not here", help);
        }
        (OffsetDocument::Number(offset), _) if one => {
            check::number(offset, at, problems);
        }
        (OffsetDocument::Triple(offset), _) if !one => {
            check::vector(offset, at, problems);
        }
        (OffsetDocument::Number(_), _) => {
            let help = "write how far it is from the key's value, as (1, 0, 0)";
            problems.add(at, "a handle of three numbers is three numbers", "one number", help);
        }
        (OffsetDocument::Triple(_), _) => {
            let help = "write how far it is from the key's value, as 0.5";
            problems.add(at, "a handle of a number is a number", "three numbers", help);
        }
    }
}
