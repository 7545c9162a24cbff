//! Finished pictures of frames, kept by fingerprint.
//!
//! An edit changes the fingerprints of the frames that it changes, so that all other pictures still apply, and undoing it restores the
//! former fingerprints. Pictures that no frame of the scene needs are dropped first, the one used least recently before others, then those
//! of frames that playback reaches last.

use std::collections::HashMap;
use std::sync::Arc;

use super::state::{CachedFrames, Planned, Times};
use super::warnings::PictureWarnings;
use crate::trace::{FrameFingerprint, TileStats};

/// The finished pictures, and the fingerprints of the frames of the current scene at the requested quality.
#[derive(Debug, Default)]
pub(super) struct FrameCache {
    /// Maximum size of all pictures in bytes.
    limit: usize,
    bytes: usize,
    /// Size of the last picture for which there was no room; 0 after others were dropped.
    refused: usize,
    pictures: HashMap<FrameFingerprint, CachedPicture>,
    /// Empty if the cache keeps nothing.
    frames: Vec<FrameKey>,
    /// Number of times that the frames were forgotten.
    generation: u64,
    /// Number of pictures used so far.
    clock: u64,
}

/// A finished picture.
#[derive(Clone, Debug)]
pub(super) struct CachedPicture {
    pub(super) png: Arc<[u8]>,
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) times: Times,
    pub(super) rays: u64,
    pub(super) tile_stats: Arc<[TileStats]>,
    pub(super) plan: Vec<Planned>,
    pub(super) warnings: PictureWarnings,
    /// Time of the last use, by the cache's clock.
    pub(super) used: u64,
}

/// The fingerprint of a frame, if known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum FrameKey {
    #[default]
    Unknown,
    Known(FrameFingerprint),
    /// The frame cannot be rendered, or its picture is larger than the cache.
    Failed,
}

impl CachedPicture {
    /// Returns the size of the PNG file and of the statistics of tiles, in bytes.
    fn size(&self) -> usize {
        self.png.len() + size_of_val(&*self.tile_stats)
    }
}

impl FrameCache {
    /// Creates a cache for at most `limit` bytes; 0 keeps nothing.
    pub(super) fn new(limit: usize) -> Self {
        Self { limit, ..Self::default() }
    }

    /// Forgets the fingerprints of frames, for another scene of `frames` frames or another quality. The pictures stay.
    pub(super) fn begin(&mut self, frames: u32) {
        self.frames = vec![FrameKey::Unknown; if self.limit == 0 { 0 } else { frames as usize }];
        self.refused = 0;
        self.generation += 1;
    }

    pub(super) fn generation(&self) -> u64 {
        self.generation
    }

    /// Returns the generation and the frames that have pictures.
    pub(super) fn contents(&self) -> CachedFrames {
        CachedFrames { generation: self.generation, ranges: self.ranges() }
    }

    /// Returns what is known about a frame; `Failed` beyond the end of the timeline.
    pub(super) fn key(&self, frame: u32) -> FrameKey {
        self.frames.get(frame as usize).copied().unwrap_or(FrameKey::Failed)
    }

    pub(super) fn set_key(&mut self, frame: u32, key: FrameKey) {
        if let Some(known) = self.frames.get_mut(frame as usize) {
            *known = key;
        }
    }

    /// Returns the picture of a frame, which counts as used.
    pub(super) fn picture(&mut self, frame: u32) -> Option<&CachedPicture> {
        let FrameKey::Known(fingerprint) = self.key(frame) else { return None };
        let picture = self.pictures.get_mut(&fingerprint)?;
        self.clock += 1;
        picture.used = self.clock;
        Some(picture)
    }

    fn holds(&self, frame: u32) -> bool {
        matches!(self.key(frame), FrameKey::Known(fingerprint) if self.pictures.contains_key(&fingerprint))
    }

    /// Adds the picture of a frame whose fingerprint is known, and drops others for it. `current` is the displayed frame. A picture that
    /// does not fit is not kept, and is not the [next](Self::next_missing) one as long as there is no more room.
    pub(super) fn add(&mut self, frame: u32, mut picture: CachedPicture, current: u32) {
        let FrameKey::Known(fingerprint) = self.key(frame) else { return };
        // Pictures with the same fingerprint are the same.
        if self.picture(frame).is_some() {
            return;
        }
        let size = picture.size();
        if size > self.limit {
            self.set_key(frame, FrameKey::Failed);
            return;
        }
        if self.bytes + size > self.limit {
            for (distance, dropped) in self.droppable(current) {
                if distance.is_some_and(|distance| distance <= self.distance(frame, current)) {
                    self.refused = size;
                    return;
                }
                self.remove(dropped);
                if self.bytes + size <= self.limit {
                    break;
                }
            }
        }
        self.clock += 1;
        picture.used = self.clock;
        self.bytes += size;
        self.pictures.insert(fingerprint, picture);
    }

    /// Returns the frame to be rendered next: the first one from `current` on, or then from the start on, that has no picture. `None` if
    /// there is no such frame, or no room for its picture.
    pub(super) fn next_missing(&self, current: u32) -> Option<u32> {
        let count = self.frame_count();
        let missing = |frame: &u32| self.key(*frame) != FrameKey::Failed && !self.holds(*frame);
        let frame = (0..count).map(|ahead| (current.min(count - 1) + ahead) % count).find(missing)?;
        // The pictures of a film are of similar size.
        let size = self.bytes.checked_div(self.pictures.len()).unwrap_or(0).max(self.refused);
        let has_room = self.bytes + size <= self.limit;
        let is_nearer = |(distance, _): (Option<u32>, _)| {
            distance.is_none_or(|distance| distance > self.distance(frame, current))
        };
        (has_room || self.droppable(current).into_iter().next().is_some_and(is_nearer)).then_some(frame)
    }

    /// Returns the ranges of frames that have pictures, with both ends.
    fn ranges(&self) -> Vec<(u32, u32)> {
        let mut ranges: Vec<(u32, u32)> = Vec::new();
        for frame in (0..self.frame_count()).filter(|frame| self.holds(*frame)) {
            match ranges.last_mut() {
                Some((_, last)) if *last + 1 == frame => *last = frame,
                _ => ranges.push((frame, frame)),
            }
        }
        ranges
    }

    pub(super) fn is_empty(&self) -> bool {
        self.pictures.is_empty()
    }

    fn frame_count(&self) -> u32 {
        u32::try_from(self.frames.len()).unwrap_or(u32::MAX)
    }

    /// Returns the number of frames until playback from `current` reaches a frame.
    fn distance(&self, frame: u32, current: u32) -> u32 {
        let count = self.frame_count();
        (frame + count - current.min(count - 1)) % count
    }

    /// Returns the pictures in the order in which they are dropped, with the distance of the nearest of their frames, if the scene has any.
    fn droppable(&self, current: u32) -> Vec<(Option<u32>, FrameFingerprint)> {
        let mut distances: HashMap<FrameFingerprint, u32> = HashMap::new();
        for frame in 0..self.frame_count() {
            if let FrameKey::Known(fingerprint) = self.key(frame) {
                let distance = self.distance(frame, current);
                let nearest = distances.entry(fingerprint).or_insert(distance);
                *nearest = distance.min(*nearest);
            }
        }
        let mut all: Vec<_> = self
            .pictures
            .iter()
            .map(|(fingerprint, picture)| (distances.get(fingerprint).copied(), picture.used, *fingerprint))
            .collect();
        // Without a frame, the least recently used first; then the farthest first.
        all.sort_by_key(|(distance, used, _)| {
            (distance.is_some(), distance.map(|distance| !distance), *used)
        });
        all.into_iter().map(|(distance, _, fingerprint)| (distance, fingerprint)).collect()
    }

    fn remove(&mut self, fingerprint: FrameFingerprint) {
        if let Some(picture) = self.pictures.remove(&fingerprint) {
            self.bytes -= picture.size();
            self.refused = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fingerprint(number: u128) -> FrameFingerprint {
        format!("{number:032x}").parse().unwrap()
    }

    fn picture(bytes: usize) -> CachedPicture {
        CachedPicture {
            png: vec![0; bytes].into(),
            width: 2,
            height: 1,
            times: Times::default(),
            rays: 0,
            tile_stats: Arc::default(),
            plan: Vec::new(),
            warnings: PictureWarnings::default(),
            used: 0,
        }
    }

    /// Returns a cache with the pictures of `frames` frames, of 10 bytes each, of a scene of 8.
    fn filled(limit: usize, frames: u32) -> FrameCache {
        let mut cache = FrameCache::new(limit);
        scene(&mut cache, 0);
        (0..frames).for_each(|frame| cache.add(frame, picture(10), 0));
        cache
    }

    /// Begins a scene of 8 frames whose fingerprints are `first` and the following numbers.
    fn scene(cache: &mut FrameCache, first: u128) {
        cache.begin(8);
        (0..8)
            .for_each(|frame| cache.set_key(frame, FrameKey::Known(fingerprint(first + u128::from(frame)))));
    }

    #[test]
    fn edit_drops_only_what_it_changes_and_undo_restores_it() {
        let mut cache = filled(1000, 8);
        assert_eq!(cache.ranges(), [(0, 7)]);
        scene(&mut cache, 4); // Frames 0 to 3 look like frames 4 to 7 before.
        assert_eq!((cache.ranges(), cache.next_missing(2)), (vec![(0, 3)], Some(4)));
        scene(&mut cache, 0);
        assert_eq!((cache.ranges(), cache.next_missing(2)), (vec![(0, 7)], None));
        cache.begin(8);
        assert_eq!((cache.ranges(), cache.next_missing(5)), (vec![], Some(5)));
    }

    #[test]
    fn size_is_bounded_and_stale_pictures_are_dropped_first() {
        let mut cache = filled(50, 5);
        assert_eq!((cache.ranges(), cache.bytes, cache.next_missing(0)), (vec![(0, 4)], 50, None));
        // Near frames replace those that playback reaches last.
        assert_eq!(cache.next_missing(3), Some(5));
        cache.add(5, picture(10), 3);
        assert_eq!((cache.ranges(), cache.bytes), (vec![(0, 1), (3, 5)], 50));
        // Frames 0 and 1 of the next scene look like frames 4 and 5 of this one; the others are stale.
        scene(&mut cache, 4);
        assert!(cache.picture(1).is_some());
        for frame in 2..5 {
            assert_eq!(cache.next_missing(0), Some(frame));
            cache.add(frame, picture(10), 0);
        }
        assert_eq!((cache.ranges(), cache.bytes, cache.next_missing(0)), (vec![(0, 4)], 50, None));
        // A picture that is larger than the cache is made once.
        cache.add(6, picture(51), 6);
        assert_eq!((cache.ranges(), cache.bytes, cache.next_missing(6)), (vec![(0, 4)], 50, Some(7)));
        cache.add(7, picture(50), 7);
        assert_eq!((cache.ranges(), cache.bytes), (vec![(7, 7)], 50));
    }

    #[test]
    fn pictures_larger_than_the_others_are_not_made_again_and_again() {
        let mut cache = filled(45, 3);
        assert_eq!(cache.next_missing(0), Some(3));
        cache.add(3, picture(20), 0);
        assert_eq!((cache.ranges(), cache.next_missing(0)), (vec![(0, 2)], None));
        // Elsewhere, it replaces a farther one.
        assert_eq!(cache.next_missing(3), Some(3));
        cache.add(3, picture(20), 3);
        assert_eq!((cache.ranges(), cache.bytes), (vec![(0, 1), (3, 3)], 40));
    }

    #[test]
    fn equal_frames_share_a_picture_and_failed_frames_are_skipped() {
        let mut cache = filled(100, 0);
        (0..8).for_each(|frame| cache.set_key(frame, FrameKey::Known(fingerprint(1))));
        cache.set_key(3, FrameKey::Failed);
        cache.add(0, picture(10), 0);
        assert_eq!((cache.ranges(), cache.bytes, cache.next_missing(0)), (vec![(0, 2), (4, 7)], 10, None));
        cache.add(6, picture(20), 0);
        assert_eq!(cache.bytes, 10);
    }

    #[test]
    fn without_room_nothing_is_kept() {
        let mut cache = filled(0, 8);
        assert!(cache.is_empty() && cache.ranges().is_empty() && cache.picture(0).is_none());
        assert_eq!(cache.next_missing(0), None);
        cache.begin(0);
        assert_eq!(cache.next_missing(0), None);
    }
}
