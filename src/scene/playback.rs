//! Conversion of keys, easings and playback settings from the file.

use glam::DVec3;

use super::document::{
    AnimationDocument, ColorDocument, EasingDocument, KeyDocument, OffsetDocument, RepeatDocument,
    RotationDocument, ScaleDocument, Triple,
};
use crate::animation::{Ease, Easing, Interpolate, Key, Playback, Repeat};

/// A key value as written in the file. Handles are offsets from it.
pub(super) trait ValueDocument: Sized {
    /// Returns the sum of this value and an offset; `None` if values of this type take no such offset.
    fn offset_by(&self, offset: OffsetDocument) -> Option<Self>;
}

impl ValueDocument for f64 {
    fn offset_by(&self, offset: OffsetDocument) -> Option<Self> {
        match offset {
            OffsetDocument::Number(offset) => Some(self + offset),
            OffsetDocument::Triple(_) => None,
        }
    }
}

impl ValueDocument for Triple {
    fn offset_by(&self, offset: OffsetDocument) -> Option<Self> {
        match offset {
            OffsetDocument::Triple([x, y, z]) => Some([self[0] + x, self[1] + y, self[2] + z]),
            OffsetDocument::Number(_) => None,
        }
    }
}

impl ValueDocument for ColorDocument {
    fn offset_by(&self, offset: OffsetDocument) -> Option<Self> {
        self.0.offset_by(offset).map(Self)
    }
}

impl ValueDocument for ScaleDocument {
    fn offset_by(&self, _: OffsetDocument) -> Option<Self> {
        None
    }
}

impl ValueDocument for RotationDocument {
    fn offset_by(&self, _: OffsetDocument) -> Option<Self> {
        None
    }
}

impl ValueDocument for bool {
    fn offset_by(&self, _: OffsetDocument) -> Option<Self> {
        None
    }
}

/// Converts keys; `value` converts their values.
pub(super) fn keys<D: ValueDocument, T: Interpolate>(
    written: &[KeyDocument<D>],
    value: impl Fn(&D) -> T,
) -> Vec<Key<T>> {
    let way = |key: &D, offset| {
        key.offset_by(offset).map_or(DVec3::ZERO, |handle| T::difference(&value(key), &value(&handle)))
    };
    let easing = |index: usize, key: &KeyDocument<D>| match key.easing {
        EasingDocument::Handles(out, back) => {
            let next = written.get(index + 1).unwrap_or(key);
            Easing::Handles(way(&key.value, out), way(&next.value, back))
        }
        other => easing(other),
    };
    let key = |(index, key): (usize, &KeyDocument<D>)| Key {
        time: key.time,
        value: value(&key.value),
        easing: easing(index, key),
    };
    written.iter().enumerate().map(key).collect()
}

pub(super) fn playback(animation: &AnimationDocument) -> Playback {
    let repeat = match animation.repeat {
        RepeatDocument::Clamp => Repeat::Clamp,
        RepeatDocument::Loop => Repeat::Loop,
        RepeatDocument::PingPong => Repeat::PingPong,
    };
    Playback { repeat, offset: animation.offset, speed: animation.speed }
}

pub(super) fn easing(document: EasingDocument) -> Easing {
    use EasingDocument as Document;
    match document {
        Document::Hold => Easing::Hold,
        // `keys` converts handles, which depend on the values of the keys.
        Document::Linear | Document::Handles(..) => Easing::Linear,
        Document::EaseIn => Easing::EaseIn,
        Document::EaseOut => Easing::EaseOut,
        Document::EaseInOut => Easing::EaseInOut,
        Document::InSine => Easing::In(Ease::Sine),
        Document::OutSine => Easing::Out(Ease::Sine),
        Document::InOutSine => Easing::InOut(Ease::Sine),
        Document::InQuad => Easing::In(Ease::Quad),
        Document::OutQuad => Easing::Out(Ease::Quad),
        Document::InOutQuad => Easing::InOut(Ease::Quad),
        Document::InCubic => Easing::In(Ease::Cubic),
        Document::OutCubic => Easing::Out(Ease::Cubic),
        Document::InOutCubic => Easing::InOut(Ease::Cubic),
        Document::InQuart => Easing::In(Ease::Quart),
        Document::OutQuart => Easing::Out(Ease::Quart),
        Document::InOutQuart => Easing::InOut(Ease::Quart),
        Document::InQuint => Easing::In(Ease::Quint),
        Document::OutQuint => Easing::Out(Ease::Quint),
        Document::InOutQuint => Easing::InOut(Ease::Quint),
        Document::InExpo => Easing::In(Ease::Expo),
        Document::OutExpo => Easing::Out(Ease::Expo),
        Document::InOutExpo => Easing::InOut(Ease::Expo),
        Document::InCirc => Easing::In(Ease::Circ),
        Document::OutCirc => Easing::Out(Ease::Circ),
        Document::InOutCirc => Easing::InOut(Ease::Circ),
        Document::InBack => Easing::In(Ease::Back),
        Document::OutBack => Easing::Out(Ease::Back),
        Document::InOutBack => Easing::InOut(Ease::Back),
        Document::InElastic => Easing::In(Ease::Elastic),
        Document::OutElastic => Easing::Out(Ease::Elastic),
        Document::InOutElastic => Easing::InOut(Ease::Elastic),
        Document::InBounce => Easing::In(Ease::Bounce),
        Document::OutBounce => Easing::Out(Ease::Bounce),
        Document::InOutBounce => Easing::InOut(Ease::Bounce),
        Document::Steps(count) => Easing::Steps(u32::try_from(count).unwrap_or(u32::MAX)),
        Document::Bezier(x1, y1, x2, y2) => Easing::Bezier(x1, y1, x2, y2),
        Document::Cubic => Easing::Cubic,
        Document::CatmullRom => Easing::CatmullRom,
        Document::Monotone => Easing::Monotone,
    }
}
