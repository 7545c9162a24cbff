//! The file format as serde types. Doc comments here are short: the [manual](super::manual) documents the format with units, ranges and
//! defaults, and a test compares it with these types.

mod animation;
mod channel;
mod cloud;
mod entity;
mod include;
mod material;
mod overlay;
mod settings;
mod surface;
mod values;

pub(super) use animation::{
    AnimationDocument, EasingDocument, KeyDocument, RepeatDocument, ScriptDocument, TrackDocument,
    TracksDocument,
};
pub(super) use channel::ChannelDocument;
pub(super) use cloud::{
    BetweenDocument, BondsDocument, CloudDocument, ColorByDocument, ColorMapDocument, EndDocument,
    FramesDocument, ScaleByDocument, StyleDocument, parse_particle_name,
};
pub(super) use entity::{
    AreaShapeDocument, EntityDocument, LightDocument, RodDocument, RotationDocument, ShapeDocument,
    TransformDocument,
};
pub(super) use include::IncludeDocument;
pub(super) use material::{MaterialDocument, PatternDocument};
pub(super) use overlay::{AnchorDocument, OverlayDocument};
pub(super) use settings::{
    AmbientOcclusionDocument, CameraDocument, FilmDocument, FogDocument, NoiseDocument, NormDocument,
    QualityDocument, SamplingDocument, SceneDocument, ShotDocument, SpaceDocument, StarsDocument,
    SunDocument, TimelineDocument, TransferDocument,
};
pub(super) use surface::SurfaceDocument;
pub(super) use values::{
    BackgroundDocument, ColorDocument, Entries, OffsetDocument, RateDocument, ScaleDocument, Triple, whole,
};

#[cfg(test)]
pub(super) use {
    material::{ReflectiveDocument, RefractiveDocument, SpecularDocument},
    settings::{LensDocument, ScreenDocument},
};
