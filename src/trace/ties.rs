//! Surfaces that a ray meets at the very same place.

use super::{Hit, Slot};

/// The shapes, besides the one that is seen, that a ray meets exactly where it meets that one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ties {
    slots: [Slot; Self::MOST],
    /// Whether each was met on its far side, as a bit mask.
    far: u8,
    length: u8,
    overflowed: bool,
}

impl Ties {
    /// More than this are not kept, only that there are more.
    const MOST: usize = 8;

    /// None.
    pub const NONE: Self = Self { slots: [Slot(0); Self::MOST], far: 0, length: 0, overflowed: false };

    pub(super) fn push(&mut self, hit: &Hit) {
        let index = usize::from(self.length);
        if index == Self::MOST {
            self.overflowed = true;
            return;
        }
        self.slots[index] = hit.slot;
        self.far |= u8::from(hit.far) << index;
        self.length += 1;
    }

    /// If the shape is among them: was it met on its far side?
    pub(super) fn find(&self, slot: Slot) -> Option<bool> {
        let index = self.slots[..usize::from(self.length)].iter().position(|tied| *tied == slot)?;
        Some(self.far & (1 << index) != 0)
    }

    /// Were there more than are kept?
    pub(super) fn overflowed(&self) -> bool {
        self.overflowed
    }
}
