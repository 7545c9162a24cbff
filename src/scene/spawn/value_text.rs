//! The text of the value that keys have at a time.

use glam::{DQuat, DVec3, EulerRot};

use super::motion;
use crate::animation::Notation;
use crate::color::{Rgb, Transfer};
use crate::components::Motion;
use crate::scene::document::AnimationDocument;

/// Returns the text of the value that an animation has at a time of its keys, in seconds, with 7 digits. `None` if it has no keys.
pub(in crate::scene) fn value_text(
    animation: &AnimationDocument,
    transfer: Transfer,
    time: f64,
) -> Option<String> {
    let seconds = animation.offset + time / animation.speed;
    let notation = animation.channel.0.notation();
    let triple = |values: [f64; 3]| format!("({})", values.map(number_text).join(", "));
    Some(match motion(animation, transfer)? {
        Motion::Number(track) if notation == Notation::Degrees => number_text(track.at(seconds).to_degrees()),
        Motion::Number(track) => number_text(track.at(seconds)),
        Motion::Vector(track) => triple(DVec3::to_array(&track.at(seconds))),
        Motion::Rotation(track) => format!("Euler{}", triple(euler_angles(track.at(seconds)))),
        Motion::Color(track) if notation == Notation::Light => {
            triple(track.at(seconds).to_array().map(f64::from))
        }
        Motion::Color(track) => triple(file_color(track.at(seconds), transfer)),
        Motion::Flag(track) => track.at(seconds).to_string(),
        Motion::Path(_)
        | Motion::Orbit(_)
        | Motion::Turns(_)
        | Motion::Direction(_)
        | Motion::Facing(_)
        | Motion::Script(_) => {
            return None;
        }
    })
}

/// Returns the text of a number, with 7 digits.
fn number_text(number: f64) -> String {
    let rounded: f64 = format!("{number:.6e}").parse().unwrap_or(number);
    // Zero has no sign.
    (rounded + 0.0).to_string()
}

/// Returns the angles of `Euler` in degrees.
fn euler_angles(rotation: DQuat) -> [f64; 3] {
    let (z, y, x) = rotation.to_euler(EulerRot::ZYX);
    [x, y, z].map(|angle| 1e-6 * (1e6 * angle.to_degrees()).round())
}

/// Returns the channels of a colour from 0 to 255, to a hundredth.
fn file_color(color: Rgb, transfer: Transfer) -> [f64; 3] {
    transfer.encode_unrounded(color).map(|channel| 0.01 * (100.0 * channel).round())
}
