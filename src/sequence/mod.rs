//! Rendering of sequences into folders, and verification of sequences in folders.
//!
//! A frame is done if its file is complete and was rendered from the current input. Only these two conditions are checked, not the names
//! or times of files. A sequence may therefore be interrupted at any point and in any way, and the next run renders the remaining frames.
//! After an edit, the next run renders the frames that the edit affects. Several processes may work in one folder, since all of them
//! write the same bytes to the same files.
//!
//! ```text
//! FrameRequest -> FrameVerdict -> engine -> output::FramePixels -> output::FrameWriter -> frame file, with its provenance
//! ```

mod faults;
mod former_frame;
mod frame_request;
mod movie;
mod order;
mod progress_timer;
mod render;
mod surplus;
mod verify;

pub use faults::SequenceFault;
pub use former_frame::FormerFrame;
pub use frame_request::FrameRequest;
pub use movie::render_movie_until;
pub use order::{RenderOrder, Shard, ShardError};
pub use render::{
    Existing, SequenceError, SequenceObserver, SequenceProgress, SequenceReport, frame_verdict,
    render_encoded, render_frames, render_sequence, render_sequence_until,
};
pub use surplus::{Surplus, SurplusReason, find_surplus};
pub use verify::{FrameVerdict, SequenceVerdict, VerifyError, verify_sequence};
