//! The scene and its settings.

use std::sync::Arc;

use serde::Deserialize;

use super::{
    AnimationDocument, BackgroundDocument, CloudDocument, ColorDocument, EntityDocument, Entries,
    IncludeDocument, MaterialDocument, OverlayDocument, RateDocument, ScriptDocument, Triple, whole,
};
use crate::components::{AmbientOcclusion, FilmSettings, Quality, Sampling, Stars};

/// A whole scene file.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Scene")]
pub(crate) struct SceneDocument {
    pub(crate) include: Vec<IncludeDocument>,
    pub(crate) timeline: TimelineDocument,
    pub(crate) film: FilmDocument,
    pub(crate) quality: QualityDocument,
    pub(crate) sampling: SamplingDocument,
    /// `None` in scenes that use `cameras` instead, and in files that are meant to be included.
    pub(crate) camera: Option<CameraDocument>,
    pub(crate) cameras: Entries<CameraDocument>,
    pub(crate) shots: Vec<ShotDocument>,
    pub(crate) ambient: Triple,
    pub(crate) ambient_occlusion: Option<AmbientOcclusionDocument>,
    pub(crate) background: BackgroundDocument,
    pub(crate) sun: Option<SunDocument>,
    pub(crate) stars: Option<StarsDocument>,
    pub(crate) fog: Option<FogDocument>,
    pub(crate) space: Option<SpaceDocument>,
    pub(crate) materials: Entries<MaterialDocument>,
    /// Shared between successive loads of an edited file.
    pub(crate) entities: Vec<Arc<EntityDocument>>,
    pub(crate) clouds: Vec<CloudDocument>,
    pub(crate) overlay: Vec<OverlayDocument>,
    pub(crate) spawn: Vec<ScriptDocument>,
    pub(crate) animate: Vec<AnimationDocument>,
    pub(crate) extends: Option<String>,
    pub(crate) without: Vec<String>,
}

impl SceneDocument {
    /// The name of the camera in the field `camera`.
    pub(crate) const CAMERA: &'static str = "camera";
    /// The name that stands for the scene as a whole.
    pub(crate) const SCENE: &'static str = "scene";
    /// The name of the field with the entities.
    pub(crate) const ENTITIES: &'static str = "entities";
    /// The name of the field with the clouds.
    pub(crate) const CLOUDS: &'static str = "clouds";

    /// Returns the paths of the includes as written.
    pub(crate) fn included_files(&self) -> impl Iterator<Item = String> {
        self.include.iter().map(|include| include.file.clone())
    }

    /// Returns the index of the first entity that is a cloud, if there is one. The entities of clouds follow all others, once they are there.
    pub(crate) fn first_cloud(&self) -> Option<usize> {
        let others = self.entities.len().checked_sub(self.clouds.len())?;
        (!self.clouds.is_empty()).then_some(others)
    }

    /// Returns where an entity is written: the list, and the index in it.
    pub(crate) fn place_of(&self, entity: usize) -> (&'static str, usize) {
        match entity.checked_sub(self.entities.len().saturating_sub(self.clouds.len())) {
            Some(cloud) if !self.clouds.is_empty() => (Self::CLOUDS, cloud),
            _ => (Self::ENTITIES, entity),
        }
    }

    /// Returns all cameras with their names, starting with the field `camera`.
    pub(crate) fn named_cameras(&self) -> impl Iterator<Item = (&str, &CameraDocument)> {
        let first = self.camera.iter().map(|camera| (Self::CAMERA, camera));
        first.chain(self.cameras.0.iter().map(|(name, camera)| (name.as_str(), camera)))
    }
}

/// A shot: its start time in seconds, and the name of its camera.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(
    rename = "Shot",
    expecting = "a shot: when it starts, in seconds, and a camera's name, as (2.5, \"side\")"
)]
pub(crate) struct ShotDocument(pub(crate) f64, pub(crate) String);

/// The occlusion of ambient light.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "AmbientOcclusion")]
pub(crate) struct AmbientOcclusionDocument {
    #[serde(default = "occlusion_samples", deserialize_with = "whole")]
    pub(crate) samples: u64,
    pub(crate) distance: f64,
}

fn occlusion_samples() -> u64 {
    AmbientOcclusion::DEFAULT_SAMPLES.into()
}

/// A sun in the sky.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Sun")]
pub(crate) struct SunDocument {
    pub(crate) direction: Triple,
    pub(crate) intensity: Triple,
    #[serde(default = "sun_size")]
    pub(crate) size: f64,
    #[serde(default)]
    pub(crate) glow: f64,
    #[serde(default = "glow_size")]
    pub(crate) glow_size: f64,
}

fn sun_size() -> f64 {
    0.5
}

fn glow_size() -> f64 {
    10.0
}

/// Stars in the sky.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Stars")]
pub(crate) struct StarsDocument {
    #[serde(deserialize_with = "whole")]
    pub(crate) count: u64,
    pub(crate) intensity: Triple,
    pub(crate) size: f64,
    #[serde(deserialize_with = "whole")]
    pub(crate) seed: u64,
}

impl Default for StarsDocument {
    fn default() -> Self {
        Self { count: Stars::default().count.into(), intensity: [1.0; 3], size: 0.2, seed: 0 }
    }
}

/// Fog that dims distant surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Fog")]
pub(crate) struct FogDocument {
    pub(crate) color: ColorDocument,
    pub(crate) density: f64,
    pub(crate) height: Option<f64>,
    #[serde(default)]
    pub(crate) level: f64,
    pub(crate) hides_background: Option<bool>,
}

/// The frame rate and the duration.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Timeline")]
pub(crate) struct TimelineDocument {
    pub(crate) fps: RateDocument,
    pub(crate) duration: f64,
}

/// The film: image size and transfer function.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Film")]
pub(crate) struct FilmDocument {
    #[serde(deserialize_with = "whole")]
    pub(crate) width: u64,
    #[serde(deserialize_with = "whole")]
    pub(crate) height: u64,
    pub(crate) transfer: TransferDocument,
}

impl Default for FilmDocument {
    fn default() -> Self {
        let FilmSettings { width, height, .. } = FilmSettings::default();
        Self { width: width.into(), height: height.into(), transfer: TransferDocument::default() }
    }
}

/// The orientation of the axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename = "Space")]
pub(crate) enum SpaceDocument {
    #[default]
    LeftHanded,
    RightHanded,
}

/// The conversion of file colours to light, and of light to bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename = "Transfer")]
pub(crate) enum TransferDocument {
    #[default]
    Srgb,
    Classic,
}

/// Limits on the tracing of light paths.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Quality")]
pub(crate) struct QualityDocument {
    #[serde(deserialize_with = "whole")]
    pub(crate) depth: u64,
    pub(crate) cutoff: f64,
}

impl Default for QualityDocument {
    fn default() -> Self {
        let Quality { depth, cutoff } = Quality::default();
        Self { depth: depth.into(), cutoff: cutoff.into() }
    }
}

/// The sampling of pixels.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default, rename = "Sampling")]
pub(crate) struct SamplingDocument {
    #[serde(deserialize_with = "whole")]
    pub(crate) samples: u64,
    #[serde(deserialize_with = "whole")]
    pub(crate) min_samples: u64,
    pub(crate) max_error: f64,
    pub(crate) norm: NormDocument,
    #[serde(deserialize_with = "whole")]
    pub(crate) instants: u64,
    #[serde(deserialize_with = "whole")]
    pub(crate) seed: u64,
    pub(crate) noise: NoiseDocument,
}

impl Default for SamplingDocument {
    fn default() -> Self {
        let Sampling { samples, min_samples, max_error, instants, seed, .. } = Sampling::default();
        Self {
            samples: samples.into(),
            min_samples: min_samples.into(),
            max_error: max_error.into(),
            norm: NormDocument::Rms,
            instants: instants.into(),
            seed,
            noise: NoiseDocument::Fixed,
        }
    }
}

/// The norm of image errors.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename = "Norm")]
pub(crate) enum NormDocument {
    Rms,
    Max,
    P99,
}

/// The variation of noise from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename = "Noise")]
pub(crate) enum NoiseDocument {
    Fixed,
    PerFrame,
}

/// A camera.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Camera")]
pub(crate) struct CameraDocument {
    pub(crate) position: Triple,
    pub(crate) target: Option<Triple>,
    pub(crate) view: Option<Triple>,
    #[serde(default = "upwards")]
    pub(crate) up: Triple,
    #[serde(default)]
    pub(crate) roll: f64,
    pub(crate) screen: Option<ScreenDocument>,
    pub(crate) fov: Option<f64>,
    pub(crate) horizontal_fov: Option<f64>,
    pub(crate) orthographic: Option<f64>,
    pub(crate) lens: Option<LensDocument>,
    pub(crate) shutter: Option<f64>,
    pub(crate) parent: Option<String>,
    pub(crate) follow: Option<String>,
    pub(crate) look_at: Option<String>,
    pub(crate) focus_on: Option<String>,
}

impl CameraDocument {
    /// Returns the names of the entities to which the camera is linked, each with its field.
    pub(crate) fn links(&self) -> [(&'static str, Option<&String>); 4] {
        let Self { parent, follow, look_at, focus_on, .. } = self;
        let links = [("parent", parent), ("follow", follow), ("look_at", look_at), ("focus_on", focus_on)];
        links.map(|(field, name)| (field, name.as_ref()))
    }
}

fn upwards() -> Triple {
    [0.0, 1.0, 0.0]
}

/// The lens, which determines the depth of field.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Lens")]
pub(crate) struct LensDocument {
    pub(crate) aperture: f64,
    pub(crate) focus: Option<f64>,
}

/// The screen in front of the camera.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename = "Screen")]
pub(crate) struct ScreenDocument {
    pub(crate) distance: f64,
    pub(crate) width: Option<f64>,
    pub(crate) height: f64,
}
