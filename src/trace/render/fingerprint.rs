//! The fingerprint of a picture: a digest of everything that the kernel receives for it, and of nothing else.
//!
//! For each of the frame's instants, it covers the shapes, as the numbers used for intersection, in document order, each with its material,
//! and the lights, the camera and the surroundings. It also covers the film, the samples, and the version of the semantics of all that. It
//! excludes data on which no bit of a picture depends: names, ids, the tree, the number of threads, the level of vector instructions, and
//! effects that are computed although nothing needs them.
//!
//! The digest (`math/digest`) is truncated to 128 bits.

use std::fmt;
use std::str::FromStr;

use crate::color::Transfer;
use crate::trace::effects::Lighting;
use crate::trace::math::{Bytes, PixelSampling};
use crate::trace::render::adaptive::ErrorTarget;
use crate::trace::render::film_overlay::FilmOverlay;
use crate::trace::scene::{PreparedCamera, PreparedScene};

/// The version of the semantics of prepared numbers. A change after which the same numbers give another picture must increment it: frames
/// written before are then stale.
pub const SEMANTICS: u32 = 3;

/// The version of the choice of samples for an error target. It affects only frames that have a target.
const ADAPTIVE_SEMANTICS: u32 = 12;

/// The fingerprint of a picture: pictures with equal fingerprints have equal pixels.
///
/// ```
/// use rayreel::{Engine, Time, World};
///
/// let mut engine = Engine::new(World::new());
/// engine.render(Time::ZERO)?;
/// let fingerprint = engine.report().fingerprint.unwrap();
/// assert_eq!(engine.plan(Time::ZERO)?.fingerprint, Some(fingerprint));
/// assert_eq!(fingerprint.to_string().parse(), Ok(fingerprint));
/// # Ok::<(), rayreel::EngineError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FrameFingerprint([u8; 16]);

/// The error for a text that is not a fingerprint: 32 hexadecimal digits in lower case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a fingerprint is 32 hexadecimal digits, 0 to 9 and a to f")]
pub struct NotAFingerprint;

impl FrameFingerprint {
    /// Returns the fingerprint of a picture without instants.
    pub(crate) fn of_nothing() -> Self {
        Self([0; 16])
    }

    /// Returns the fingerprint of the same picture, sampled in rounds with these minimum gains.
    pub(crate) fn with_rounds(self, rounds: &[u32]) -> Self {
        let mut bytes = Bytes::default();
        self.0.into_iter().for_each(|byte| bytes.count(byte));
        rounds.iter().for_each(|least| bytes.count(*least));
        FrameHasher(bytes).finish()
    }
}

impl fmt::Display for FrameFingerprint {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{:032x}", u128::from_be_bytes(self.0))
    }
}

impl FromStr for FrameFingerprint {
    type Err = NotAFingerprint;

    fn from_str(text: &str) -> Result<Self, NotAFingerprint> {
        let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
        let is_whole = text.len() == 32 && text.bytes().all(is_digit);
        let number = is_whole.then(|| u128::from_str_radix(text, 16).ok()).flatten();
        number.map(|number| Self(number.to_be_bytes())).ok_or(NotAFingerprint)
    }
}

/// Computes the fingerprint of a frame, instant by instant.
pub(crate) struct FrameHasher(Bytes);

/// The data that are common to a whole frame.
pub(crate) struct FrameConstants {
    pub(crate) transfer: Transfer,
    /// The sampling, with the seed of this frame.
    pub(crate) sampling: PixelSampling,
    pub(crate) target: Option<ErrorTarget>,
    /// The highest level of lighting.
    pub(crate) lighting: Lighting,
    /// The number of instants.
    pub(crate) instants: u32,
}

impl FrameHasher {
    /// Starts the fingerprint of a frame.
    pub(crate) fn new(constants: &FrameConstants) -> Self {
        let FrameConstants {
            transfer,
            sampling: PixelSampling { samples, seed: _ },
            target,
            lighting,
            instants,
        } = constants;
        let mut bytes = Bytes::default();
        bytes.count(SEMANTICS);
        bytes.count(match transfer {
            Transfer::Srgb => 0_u32,
            Transfer::Classic => 1,
        });
        bytes.count(*samples);
        bytes.number(target.map_or(0.0, |target| target.error));
        if let Some(ErrorTarget { norm, least, .. }) = target {
            bytes.count(ADAPTIVE_SEMANTICS);
            bytes.count(*norm as u64);
            bytes.count(*least);
        }
        bytes.count(*lighting as u64);
        bytes.count(*instants);
        Self(bytes)
    }

    /// Adds the next instant.
    pub(crate) fn add(&mut self, scene: &PreparedScene, camera: &PreparedCamera, sampling: PixelSampling) {
        // A single sample without area lights and ambient occlusion uses no random numbers.
        let is_sampled = sampling.samples > 1 || scene.samples_light();
        self.0.count(is_sampled);
        self.0.count(if is_sampled { sampling.seed } else { 0 });
        camera.write(&mut self.0);
        scene.write_surroundings(&mut self.0);
        self.0.digest(scene.shapes_digest());
    }

    /// Adds what is drawn over the picture.
    pub(crate) fn add_overlay(&mut self, overlay: &FilmOverlay) {
        overlay.write(&mut self.0);
    }

    /// Returns the fingerprint.
    pub(crate) fn finish(&self) -> FrameFingerprint {
        let mut fingerprint = [0; 16];
        let digest = self.0.finish();
        fingerprint.copy_from_slice(&digest[..16]);
        FrameFingerprint(fingerprint)
    }
}

#[cfg(test)]
mod tests;
