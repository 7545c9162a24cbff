//! Warnings about a scene and the picture of a frame.

use serde::Serialize;

use crate::engine::Engine;
use crate::scene::{Owner, SceneWarning, Sources};

/// Maximum number of warnings that are listed. A fault may occur in every entity.
const MOST: usize = 10;

/// The warnings about a scene and the full picture of a frame.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PictureWarnings {
    /// The first warnings: those about the files, then those about the picture.
    pub list: Vec<PictureWarning>,
    /// Number of further warnings.
    pub unlisted: usize,
}

/// A warning about a scene or its picture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PictureWarning {
    /// Name of the warning, as in `--allow` of the command.
    pub name: &'static str,
    /// The element of the scene, its fault and the cause.
    pub message: String,
    /// The remedy.
    pub help: String,
    /// Position in the files, as `ball.ron:12`.
    pub place: Option<String>,
}

impl PictureWarnings {
    /// Returns the warnings about the engine's files and its last picture, except those whose names are `allowed`.
    pub(super) fn of(engine: &Engine, sources: &Sources, allowed: &[&str]) -> Self {
        let of_file = |SceneWarning { name, file, position, message, help }: &SceneWarning| PictureWarning {
            name,
            message: message.clone(),
            help: help.clone(),
            place: Some(format!("{file}:{position}")),
        };
        let files = engine.scene_warnings().iter().filter(|warning| !allowed.contains(&warning.name));
        let mut list: Vec<PictureWarning> = files.map(of_file).collect();
        let mut faults = engine.faults();
        faults.retain(|fault| !allowed.contains(&fault.consequence.name()));
        let count = list.len() + faults.len();
        list.extend(faults.iter().take(MOST).map(|fault| {
            let owner = Owner::of(engine.world(), fault.entity);
            PictureWarning {
                name: fault.consequence.name(),
                message: format!("{owner} {fault}"),
                help: fault.remedy(),
                place: owner.line(sources).map(|line| line.to_string()),
            }
        }));
        list.truncate(MOST);
        Self { unlisted: count - list.len(), list }
    }
}
