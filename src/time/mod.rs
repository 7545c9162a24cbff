//! Time: exact rational seconds, frame rates, timelines and frame lists.
//!
//! Times are never sums of steps. Frame `i` is at exactly `i * denominator / numerator` seconds, computed from integers, so that frame 240
//! has the same time whether rendering starts at 0 or at 240.

mod frame_list;
mod frame_rate;
#[expect(clippy::module_inception, reason = "what the folder is about")]
mod time;
mod timeline;

pub use frame_list::{FrameList, FrameListError};
pub use frame_rate::FrameRate;
pub use time::{Time, TimeError};
pub use timeline::Timeline;
