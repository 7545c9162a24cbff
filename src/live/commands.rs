//! The queue of commands to a session.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::camera_view::CameraView;
use super::export::ExportRequest;
use super::outline::{OutlineRequest, OutlineRow, PartInfo};
use super::path_info::{PathInfo, PathRequest};
use super::pixel_info::PixelInfo;
use super::placement::Placement;
use super::ray_info::RayTreeInfo;
use crate::scene::{KeyChange, ScenePart, WrittenTracks};

/// A command to a session.
#[derive(Debug)]
pub enum SessionCommand {
    /// Reads the files again after a change.
    Reload,
    /// Changes the view.
    ViewChange(ViewChange),
    /// Describes a pixel of the film, given by column and row.
    Probe((u32, u32), Reply<Option<PixelInfo>>),
    /// Describes the rays of a sample of a pixel, given by column and row.
    Rays((u32, u32), u32, Reply<Option<RayTreeInfo>>),
    /// Changes values of the scene.
    Edit(SceneEdit, Reply<Result<(), String>>),
    /// Lists the parts of the scene.
    Outline(OutlineRequest, Reply<Vec<OutlineRow>>),
    /// Describes a part of the scene, or the controls of an engine; `None` if there is no such part, or no control.
    Part(Option<ScenePart>, Reply<Option<PartInfo>>),
    /// Lists the keys of tracks, and the shots.
    Tracks(Reply<WrittenTracks>),
    /// Renders frames into files, on another thread.
    Export(ExportRequest, Reply<Result<(), String>>),
    /// Continues what an export has delayed.
    ExportEnded,
    /// Opens a file of the scene in an editor, at a place such as `ball.ron:12`.
    Open(String, Reply<Result<(), String>>),
    /// Describes the camera of the current frame, or the reason why it cannot be moved.
    Camera(Reply<Result<CameraView, String>>),
    /// Describes the place of a part at the current frame; `None` for a part without one.
    Placement(ScenePart, Reply<Option<Placement>>),
    /// Describes the path of the camera of the current frame; `None` without a camera.
    Path(PathRequest, Reply<Option<PathInfo>>),
    /// Ends the session.
    Stop,
}

/// A change of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ViewChange {
    /// Shows a frame. Indices beyond the last frame show the last frame.
    Seek {
        /// Index of the frame, from 0.
        frame: u32,
        /// True for a frame of playback, which has a single picture: the full one only if there is time for it.
        #[serde(default)]
        playing: bool,
    },
    /// Sets the quality of subsequent pictures.
    Detail(Detail),
    /// Shows the current frame at full quality once.
    Finish,
    /// Measures the cost of each effect of the current frame, and its error by the number of samples, once its picture is finished. A
    /// change of the view or the scene, and an export, end the measurements; questions begin the current one again.
    Measure,
}

/// The quality of pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Detail {
    /// Identical to a picture rendered to a file.
    #[default]
    Full,
    /// One sample per pixel.
    Draft,
    /// Half the width and height, with one sample per pixel.
    Half,
}

/// A change of values of the scene.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SceneEdit {
    /// Overrides values, as in `camera.fov=40`, and keys of tracks, and leaves the files as they are. Values that are already overridden keep
    /// their override; keys that are overridden already are changed further. Values of an engine are those of its controls.
    Try(Vec<String>, Vec<KeyChange>),
    /// Overrides the keys of a track, and leaves the files as they are.
    TryKey(KeyChange),
    /// Writes the overriding values into the files; the values of controls become a change that can be taken back.
    Keep,
    /// Ends the overrides.
    Drop,
    /// Ends the overrides at these paths.
    DropPaths(Vec<String>),
    /// Shows the scene from another view than that of its camera, which is never written.
    Look(LookView),
    /// Takes back the last change.
    Undo,
    /// Makes the change again that was taken back last.
    Redo,
}

/// A view in the space of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LookView {
    /// Position of the eye.
    pub position: [f64; 3],
    /// The point that is looked at.
    pub target: [f64; 3],
    /// The direction that is up in the picture.
    pub up: [f64; 3],
    /// True to look from elsewhere although the camera can be moved.
    #[serde(default)]
    pub is_free: bool,
}

/// A callback that receives the result of a command.
pub struct Reply<T>(pub Box<dyn FnOnce(T) + Send>);

impl<T> fmt::Debug for Reply<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Reply")
    }
}

/// The queue of pending commands.
#[derive(Debug, Default)]
pub(super) struct CommandQueue {
    commands: Mutex<Vec<SessionCommand>>,
    arrived: Condvar,
    /// True if a pending command interrupts the current work.
    interrupt: AtomicBool,
    /// True if a command other than the next frame of playback is pending.
    urgent: AtomicBool,
}

impl CommandQueue {
    pub(super) fn send(&self, command: SessionCommand) {
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        let is_urgent =
            !matches!(command, SessionCommand::ViewChange(ViewChange::Seek { playing: true, .. }));
        commands.push(command);
        self.interrupt.store(true, Ordering::Relaxed);
        self.urgent.fetch_or(is_urgent, Ordering::Relaxed);
        self.arrived.notify_one();
    }

    /// Waits for commands until the given time, or endlessly without one. Returns all commands since the last call, in order.
    pub(super) fn take(&self, until: Option<Instant>) -> Vec<SessionCommand> {
        let mut commands = self.commands.lock().unwrap_or_else(PoisonError::into_inner);
        while commands.is_empty() {
            let Some(until) = until else {
                commands = self.arrived.wait(commands).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let rest = until.saturating_duration_since(Instant::now());
            if rest.is_zero() {
                break;
            }
            commands = self.arrived.wait_timeout(commands, rest).unwrap_or_else(PoisonError::into_inner).0;
        }
        self.interrupt.store(false, Ordering::Relaxed);
        self.urgent.store(false, Ordering::Relaxed);
        std::mem::take(&mut commands)
    }

    /// Returns the flag that becomes true when a command arrives.
    pub(super) fn interrupt(&self) -> &AtomicBool {
        &self.interrupt
    }

    /// Returns the flag that becomes true when a command other than the next frame of playback arrives.
    pub(super) fn urgent(&self) -> &AtomicBool {
        &self.urgent
    }
}
