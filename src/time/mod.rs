//! Time: exact rational seconds, frame rates, timelines and frame lists.
//!
//! Nothing here is ever advanced by adding a step. Frame `i` is at exactly `i * denominator / numerator` seconds, from integers,
//! so that frame 240 is the same moment whether one starts at 0 or at 240.

mod frame_list;
mod frame_rate;
#[expect(clippy::module_inception, reason = "what the folder is about")]
mod time;
mod timeline;

pub use frame_list::{FrameList, FrameListError};
pub use frame_rate::FrameRate;
pub use time::{Time, TimeError};
pub use timeline::Timeline;
