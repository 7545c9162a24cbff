//! Frame selections in text form: `10-20,30,40-80x5,90-`.

use std::fmt;
use std::str::FromStr;

/// A selection of frames: single frames and inclusive ranges, each range with an optional stride. A range without an end extends to the
/// last frame of a timeline.
///
/// ```
/// use rayreel::time::FrameList;
/// let list: FrameList = "3,0-10x5,10".parse().unwrap();
/// assert!(list.frames().eq([0, 3, 5, 10]));
/// assert!("5-3".parse::<FrameList>().is_err());
///
/// let list: FrameList = "0,90-x2".parse().unwrap();
/// assert!(list.within(96).frames().eq([0, 90, 92, 94]));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameList {
    ranges: Vec<FrameRange>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct FrameRange {
    first: u32,
    /// [`NO_END`] for a range without an end.
    last: u32,
    stride: u32,
}

/// The end of a range that extends to the last frame of a timeline. No timeline has as many frames.
const NO_END: u32 = u32::MAX;

/// The reason for which the text of a frame selection is invalid.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
pub enum FrameListError {
    /// A part that is neither a frame, a range nor a range with a stride.
    #[error("`{0}` is not a frame or a range: write `12`, `10-20`, `40-80x5` or `90-`, separated by commas")]
    NotARange(String),
    /// A range that runs backwards.
    #[error("`{0}` runs backwards: write the smaller frame first")]
    Backwards(String),
    /// A stride of zero, which never advances.
    #[error("`{0}` has a stride of 0: use 1 or more")]
    ZeroStride(String),
}

debug_as_message!(FrameListError);

impl FrameList {
    /// Selects frames `0..count`.
    #[must_use]
    pub fn all(count: u32) -> Self {
        let last = count.saturating_sub(1);
        Self { ranges: vec![FrameRange { first: 0, last, stride: 1 }] }
    }

    /// Selects these frames, which ascend. Consecutive frames and evenly spaced frames become ranges.
    ///
    /// ```
    /// use rayreel::time::FrameList;
    /// assert_eq!(FrameList::of([3, 17, 18, 19, 30, 40, 50]).unwrap().to_string(), "3,17-19,30-50x10");
    /// assert_eq!(FrameList::of([]), None);
    /// ```
    #[must_use]
    pub fn of(frames: impl IntoIterator<Item = u32>) -> Option<Self> {
        /// Fewer frames are listed one by one, unless they are consecutive.
        const RANGE: usize = 3;
        let frames: Vec<u32> = frames.into_iter().collect();
        let mut ranges = Vec::new();
        let mut rest = &frames[..];
        while let [first, ..] = *rest {
            let stride = rest.get(1).map_or(1, |second| second - first);
            let apart = rest.windows(2).take_while(|pair| pair[1] - pair[0] == stride).count();
            let count = if apart + 1 >= RANGE || stride == 1 { apart + 1 } else { 1 };
            let last = rest[count - 1];
            ranges.push(FrameRange { first, last, stride: if count == 1 { 1 } else { stride } });
            rest = &rest[count..];
        }
        (!ranges.is_empty()).then_some(Self { ranges })
    }

    /// Returns the same frames, with ranges without an end extended to the last frame of a timeline with `count` frames.
    #[must_use]
    pub fn within(&self, count: u32) -> Self {
        let last = count.saturating_sub(1);
        let within = |range: &FrameRange| match range.last {
            // A range that starts beyond the end keeps its first frame, which is invalid as well.
            NO_END => FrameRange { last: last.max(range.first), ..*range },
            _ => *range,
        };
        Self { ranges: self.ranges.iter().map(within).collect() }
    }

    /// Returns the largest frame number in the list; a stride may skip it.
    #[must_use]
    pub fn last(&self) -> u32 {
        self.ranges.iter().map(|range| range.last).max().unwrap_or(0)
    }

    /// Returns every selected frame once, in ascending order, without collecting them in memory.
    pub fn frames(&self) -> impl Iterator<Item = u32> {
        let next_from = |start: u32| self.ranges.iter().filter_map(|range| range.first_from(start)).min();
        std::iter::successors(next_from(0), move |frame| next_from(frame.checked_add(1)?))
    }

    /// Returns the number of selected frames.
    #[must_use]
    pub fn count(&self) -> usize {
        match self.ranges[..] {
            [range] => ((range.last - range.first) / range.stride) as usize + 1,
            _ => self.frames().count(),
        }
    }

    /// Selects `count` of the frames, spread evenly. The first and the last frame are included if `count` is more than one. Selects all
    /// frames if there are no more.
    ///
    /// ```
    /// use rayreel::time::FrameList;
    /// assert!(FrameList::all(96).spread(4).frames().eq([0, 31, 63, 95]));
    /// assert!(FrameList::all(3).spread(4).frames().eq([0, 1, 2]));
    /// ```
    #[must_use]
    pub fn spread(&self, count: u32) -> Self {
        match self.spread_frames(count) {
            Some(frames) => {
                let single = |frame| FrameRange { first: frame, last: frame, stride: 1 };
                Self { ranges: frames.into_iter().map(single).collect() }
            }
            None => self.clone(),
        }
    }

    /// Returns the frames of [`spread`](FrameList::spread), ascending; `None` if all frames are selected.
    #[must_use]
    pub fn spread_frames(&self, count: u32) -> Option<Vec<u32>> {
        let (selected, count) = (self.count() as u64, u64::from(count));
        if count >= selected {
            return None;
        }
        let places = (0..count).map(|index| index * (selected - 1) / (count - 1).max(1));
        if let [range] = self.ranges[..] {
            return Some(places.filter_map(|place| range.nth(place)).collect());
        }
        let mut frames = (0..).zip(self.frames());
        let chosen = places.filter_map(|place| frames.find(|(at, _)| *at == place));
        Some(chosen.map(|(_, frame)| frame).collect())
    }
}

impl FrameRange {
    /// Returns the first frame of the range that is not before `start`.
    fn first_from(&self, start: u32) -> Option<u32> {
        let steps = start.saturating_sub(self.first).div_ceil(self.stride);
        let frame = self.first.checked_add(steps.checked_mul(self.stride)?)?;
        (frame <= self.last).then_some(frame)
    }

    /// Returns a frame of the range by its index, from 0.
    fn nth(self, place: u64) -> Option<u32> {
        let frame = u64::from(self.first) + place * u64::from(self.stride);
        u32::try_from(frame).ok().filter(|frame| *frame <= self.last)
    }
}

impl FromStr for FrameList {
    type Err = FrameListError;

    fn from_str(text: &str) -> Result<Self, FrameListError> {
        let ranges = text.split(',').map(parse_range).collect::<Result<_, _>>()?;
        Ok(Self { ranges })
    }
}

fn parse_range(part: &str) -> Result<FrameRange, FrameListError> {
    let part = part.trim();
    let number = |digits: &str| digits.parse().map_err(|_| FrameListError::NotARange(part.to_owned()));
    let (range, stride) = match part.split_once('x') {
        Some((range, stride)) if range.contains('-') => (range, number(stride)?),
        Some(_) => return Err(FrameListError::NotARange(part.to_owned())),
        None => (part, 1),
    };
    let (first, last) = match range.split_once('-') {
        Some((first, "")) => (number(first)?, NO_END),
        Some((first, last)) => (number(first)?, number(last)?),
        None => (number(range)?, number(range)?),
    };
    if last < first {
        return Err(FrameListError::Backwards(part.to_owned()));
    }
    if stride == 0 {
        return Err(FrameListError::ZeroStride(part.to_owned()));
    }
    Ok(FrameRange { first, last, stride })
}

impl fmt::Display for FrameList {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, range) in self.ranges.iter().enumerate() {
            let separator = if index == 0 { "" } else { "," };
            match *range {
                FrameRange { first, last, .. } if first == last => write!(formatter, "{separator}{first}")?,
                FrameRange { first, last: NO_END, stride: 1 } => write!(formatter, "{separator}{first}-")?,
                FrameRange { first, last: NO_END, stride } => {
                    write!(formatter, "{separator}{first}-x{stride}")?;
                }
                FrameRange { first, last, stride: 1 } => write!(formatter, "{separator}{first}-{last}")?,
                FrameRange { first, last, stride } => {
                    write!(formatter, "{separator}{first}-{last}x{stride}")?;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_sorted_and_without_doubles() {
        let list: FrameList = "10-20, 30,40-80x5,12".parse().unwrap();
        let expected: Vec<u32> = (10..=20).chain([30]).chain((40..=80).step_by(5)).collect();
        assert_eq!(list.frames().collect::<Vec<_>>(), expected);
        assert_eq!(list.count(), expected.len());
        assert_eq!(list.last(), 80);
        assert_eq!(list.to_string(), "10-20,30,40-80x5,12");
    }

    #[test]
    fn spread_frames_are_as_far_apart_as_whole_frames_can_be() {
        let list: FrameList = "10-20,30,40-80x5".parse().unwrap();
        let all: Vec<u32> = list.frames().collect();
        for count in 2..all.len() {
            let spread: Vec<u32> = list.spread(u32::try_from(count).unwrap()).frames().collect();
            assert_eq!((spread.len(), spread[0], spread[count - 1]), (count, 10, 80));
            let places: Vec<usize> =
                spread.iter().map(|frame| all.iter().position(|one| one == frame).unwrap()).collect();
            let steps: Vec<usize> = places.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!(steps.iter().max().unwrap() - steps.iter().min().unwrap() <= 1, "{places:?}");
        }
        let one: FrameList = "7-1000x9".parse().unwrap();
        let two: FrameList = "7-700x9,7-1000x9".parse().unwrap();
        for count in 0..120 {
            assert!(one.spread(count).frames().eq(two.spread(count).frames()), "{count}");
        }
        assert!(list.spread(1).frames().eq([10]));
        assert_eq!(list.spread(21), list);
        assert!(FrameList::all(1).spread(9).frames().eq([0]));
    }

    #[test]
    fn huge_lists_cost_nothing() {
        let list: FrameList = "0-4294967295".parse().unwrap();
        assert_eq!(list.count(), 4_294_967_296);
        assert_eq!(list.spread_frames(3), Some(vec![0, 2_147_483_647, 4_294_967_295]));
        assert!(list.frames().skip(1000).take(2).eq([1000, 1001]));
        let list: FrameList = "4294967290-4294967295x4,4294967295".parse().unwrap();
        assert!(list.frames().eq([4_294_967_290, 4_294_967_294, 4_294_967_295]));
    }

    #[test]
    fn ranges_without_an_end_go_on_to_the_last_frame() {
        let list: FrameList = "3,90-,10-x40".parse().unwrap();
        assert_eq!(list.to_string(), "3,90-,10-x40");
        assert!(list.within(93).frames().eq([3, 10, 50, 90, 91, 92]));
        assert_eq!(list.within(50).last(), 90);
    }

    #[test]
    fn frames_become_the_ranges_that_they_are() {
        for frames in [
            vec![0],
            vec![0, 5],
            vec![1, 2],
            vec![0, 1, 2, 4, 6, 8, 9],
            vec![7, 9, 11, 12, 13, 20, 30, 41],
            (0..96).collect(),
        ] {
            let list = FrameList::of(frames.iter().copied()).unwrap();
            assert!(list.frames().eq(frames.iter().copied()), "{list}");
            assert_eq!(list.to_string().parse::<FrameList>().unwrap(), list);
        }
    }

    #[test]
    fn mistakes_are_named() {
        for (text, message) in [
            ("", "`` is not a frame"),
            ("1,,2", "`` is not a frame"),
            ("a-b", "`a-b` is not a frame"),
            ("-5", "`-5` is not a frame"),
            ("3x2", "`3x2` is not a frame"),
            ("9-3", "`9-3` runs backwards"),
            ("1-9x0", "`1-9x0` has a stride of 0"),
            ("99999999999", "`99999999999` is not a frame"),
        ] {
            let error = text.parse::<FrameList>().unwrap_err().to_string();
            assert!(error.starts_with(message), "{text}: {error}");
        }
    }
}
