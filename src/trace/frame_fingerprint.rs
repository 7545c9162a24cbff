//! What identifies a picture: a digest of all that the kernel receives for it, and of nothing else.
//!
//! Shapes go in as the numbers that rays ask, in document order, each with its material; so do lights, the camera, and what is around
//! them, at each of the frame's instants; then the film, the samples, and which meaning all of that has. What no bit of a picture
//! depends on is left out: names, ids, the tree, the number of threads, the level of vector instructions, and effects that
//! are computed though nothing calls for them.
//!
//! It is the digest (`math/digest`), cut to 128 bits.

use std::fmt;
use std::str::FromStr;

use crate::color::Transfer;
use crate::trace::adaptive::ErrorTarget;
use crate::trace::effects::Lighting;
use crate::trace::math::{Bytes, Sampling};
use crate::trace::scene::{Camera, PreparedScene};

/// The version of what prepared numbers mean. A change after which the same numbers make another picture must raise it: frames
/// that were written before are then stale.
pub const SEMANTICS: u32 = 2;

/// The version of how samples are chosen for an error: the same for frames that have a target alone.
const ADAPTIVE_SEMANTICS: u32 = 5;

/// What identifies a picture: pictures of equal fingerprints have equal pixels.
///
/// ```
/// use rayreel::{Engine, Time, World};
///
/// let mut engine = Engine::new(World::new());
/// engine.render_at(Time::ZERO)?;
/// let fingerprint = engine.report().fingerprint.unwrap();
/// assert_eq!(engine.fingerprint_at(Time::ZERO)?, fingerprint);
/// assert_eq!(fingerprint.to_string().parse(), Ok(fingerprint));
/// # Ok::<(), rayreel::EngineError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FrameFingerprint([u8; 16]);

/// Says that a text is no fingerprint: 32 hexadecimal digits, small ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a fingerprint is 32 hexadecimal digits, 0 to 9 and a to f")]
pub struct NotAFingerprint;

impl FrameFingerprint {
    /// Returns that of a picture of no instant.
    pub(crate) fn of_nothing() -> Self {
        Self([0; 16])
    }

    /// Returns that of the same picture with rounds of these least gains.
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

/// Computes the fingerprint of a frame, instant after instant.
pub(crate) struct FrameHasher(Bytes);

/// What a whole frame has in common.
pub(crate) struct FrameConstants {
    pub(crate) transfer: Transfer,
    /// With the seed of this frame.
    pub(crate) sampling: Sampling,
    pub(crate) target: Option<ErrorTarget>,
    /// The most that is asked of lights.
    pub(crate) lighting: Lighting,
    /// How many there are.
    pub(crate) instants: u32,
}

impl FrameHasher {
    /// Begins a frame.
    pub(crate) fn new(constants: &FrameConstants) -> Self {
        let FrameConstants { transfer, sampling: Sampling { samples, seed: _ }, target, lighting, instants } =
            constants;
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
    pub(crate) fn add(&mut self, scene: &PreparedScene, camera: &Camera, sampling: Sampling) {
        // Nothing is random in a single sample of lights without a size.
        let is_sampled = sampling.samples > 1 || scene.lights.iter().any(|light| light.source.is_extended());
        self.0.count(is_sampled);
        self.0.count(if is_sampled { sampling.seed } else { 0 });
        camera.write(&mut self.0);
        scene.write_surroundings(&mut self.0);
        self.0.digest(scene.shapes_digest());
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
