//! Renders sequences into folders, and tells whether what is in a folder is a sequence.
//!
//! A frame is done if its file is whole and was rendered from what would be rendered now: both are looked at, and nothing else is, neither
//! names nor times of files. So a sequence may be interrupted anywhere, in any way, and the next run does what is left; after an
//! edit it does the frames that the edit touches; and several processes may work in one folder, each of which puts the same bytes
//! in the same place.
//!
//! ```text
//! Shot -> is it done? -> engine -> output::FramePixels -> output::FrameWriter -> frame file, with its provenance
//! ```

mod heartbeat;
mod order;
mod render;
mod shot;
mod surplus;
mod verify;

pub use order::{RenderOrder, Shard, ShardError};
pub use render::{Existing, SequenceError, SequenceObserver, SequenceProgress, SequenceReport};
pub use shot::Shot;
pub use surplus::{Surplus, SurplusReason, find_surplus};
pub use verify::{FrameVerdict, SequenceVerdict, VerifyError};
