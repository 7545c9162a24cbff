//! Selection and order of the frames to render.

use std::fmt;
use std::str::FromStr;

use crate::time::FrameList;

/// The order in which frames are rendered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RenderOrder {
    /// Ascending by frame number.
    #[default]
    Ascending,
    /// Every eighth frame first, then the frames in the middle between them, and so on, so that errors anywhere are seen early.
    Coarse,
}

impl RenderOrder {
    /// Returns the frames of a list in this order, each once.
    pub fn of(self, frames: &FrameList) -> Box<dyn Iterator<Item = u32> + '_> {
        /// Offset and step of each pass, as indices into the list.
        const PASSES: [(usize, usize); 4] = [(0, 8), (4, 8), (2, 4), (1, 2)];
        match self {
            Self::Ascending => Box::new(frames.frames()),
            Self::Coarse => Box::new(
                PASSES.into_iter().flat_map(|(first, apart)| frames.frames().skip(first).step_by(apart)),
            ),
        }
    }
}

/// One of several parts of a frame list, determined by the list alone. Together, the parts contain every frame once. Their sizes differ
/// by at most one.
///
/// ```
/// use rayreel::sequence::Shard;
/// use rayreel::time::FrameList;
///
/// let shard: Shard = "1/3".parse().unwrap();
/// assert!(shard.of(&FrameList::all(8)).unwrap().frames().eq([1, 4, 7]));
/// assert!("3/3".parse::<Shard>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    index: u32,
    count: u32,
}

/// The error for a string that is not a shard.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a shard: write its number, from 0, and how many there are, as in 0/4")]
pub struct ShardError(String);

debug_as_message!(ShardError);

impl Shard {
    /// Returns this part of a list: the frames whose index in the list, modulo the number of shards, is the index of the shard.
    /// Neighbouring frames take similar times, so that shards do, too. Returns `None` if there are fewer frames than shards, and none for
    /// this one.
    #[must_use]
    pub fn of(&self, frames: &FrameList) -> Option<FrameList> {
        let (index, count) = (self.index as usize, self.count as usize);
        FrameList::of(frames.frames().skip(index).step_by(count))
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let number = |digits: &str| digits.trim().parse::<u32>().ok();
        let parts = text.split_once('/').and_then(|(index, count)| Some((number(index)?, number(count)?)));
        match parts {
            Some((index, count)) if index < count => Ok(Self { index, count }),
            _ => Err(ShardError(text.to_owned())),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_partition_a_list() {
        for list in ["0-95", "5", "0-7,20-30x3,40", "1,2"] {
            let list: FrameList = list.parse().unwrap();
            for count in 1..9_u32 {
                let shard = |index| Shard { index, count }.of(&list);
                let parts: Vec<Vec<u32>> = (0..count)
                    .map(|index| shard(index).map_or_else(Vec::new, |part| part.frames().collect()))
                    .collect();
                let mut all = parts.concat();
                all.sort_unstable();
                assert!(all.into_iter().eq(list.frames()), "{count} of {list}");
                let (most, least) = (parts[0].len(), parts[parts.len() - 1].len());
                assert!(most - least <= 1, "{count} of {list}");
            }
        }
    }

    #[test]
    fn coarse_order_contains_every_frame_once() {
        let list: FrameList = "3-20,30".parse().unwrap();
        let coarse: Vec<u32> = RenderOrder::Coarse.of(&list).collect();
        assert_eq!(coarse[..5], [3, 11, 19, 7, 15]);
        let mut sorted = coarse;
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(list.frames()));
    }

    #[test]
    fn shards_are_parsed_and_formatted() {
        assert_eq!("2/7".parse::<Shard>().unwrap().to_string(), "2/7");
        for text in ["", "1", "1/", "/2", "2/2", "-1/2", "0/0", "1/2/3", "a/b"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
