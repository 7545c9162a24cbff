//! Easings and playback as the file has them, for the timeline.

use super::document::{AnimationDocument, EasingDocument, RepeatDocument};
use crate::timeline::{Ease, Easing, Playback, Repeat};

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
        Document::Linear => Easing::Linear,
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
