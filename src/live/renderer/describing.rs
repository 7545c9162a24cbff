//! Descriptions of the displayed frame and of its scene.

use std::path::PathBuf;

use super::Renderer;
use crate::engine::EngineError;
use crate::live::camera_view::CameraView;
use crate::live::outline::{OutlineRequest, OutlineRow, PartInfo, outline};
use crate::live::path_info::{PathInfo, PathRequest};
use crate::live::pixel_info::PixelInfo;
use crate::live::placement::Placement;
use crate::live::ray_info::RayTreeInfo;
use crate::scene::ScenePart;

impl Renderer {
    /// Describes a pixel of the current frame. Returns `None` outside the film, and before a scene is read.
    pub(in crate::live) fn probe(&mut self, pixel: (u32, u32)) -> Result<Option<PixelInfo>, EngineError> {
        let state = self.publisher.published().state();
        if state.reloads == 0 {
            return Ok(None);
        }
        let time = self.engine.timeline.time_of(state.frame);
        let latest = self.publisher.latest().filter(|(info, _)| info.full);
        let full = latest.and_then(|(_, film)| film).map(|film| &**film);
        PixelInfo::of(&mut self.engine, &self.sources, time, pixel, full)
    }

    /// Describes the rays of a pixel of the current frame. Returns `None` outside the film, and before a scene is read.
    pub(in crate::live) fn rays(
        &mut self,
        pixel: (u32, u32),
        sample: u32,
    ) -> Result<Option<RayTreeInfo>, EngineError> {
        let state = self.publisher.published().state();
        if state.reloads == 0 {
            return Ok(None);
        }
        let time = self.engine.timeline.time_of(state.frame);
        RayTreeInfo::of(&mut self.engine, &self.sources, time, pixel, sample)
    }

    /// Describes the path of the camera of the current frame. Returns `None` without a camera, and before a scene is read.
    pub(in crate::live) fn path(&mut self, request: &PathRequest) -> Result<Option<PathInfo>, EngineError> {
        let state = self.publisher.published().state();
        if state.reloads == 0 {
            return Ok(None);
        }
        PathInfo::of(&mut self.engine, state.frame, request)
    }

    /// Lists the parts of the scene.
    pub(in crate::live) fn outline(&self, request: &OutlineRequest) -> Vec<OutlineRow> {
        outline(self.engine.world(), &self.sources, request)
    }

    /// Describes a part of the scene in files.
    pub(in crate::live) fn part(&self, part: &ScenePart, files: &[PathBuf]) -> Option<PartInfo> {
        PartInfo::of(self.engine.world(), &self.sources, part, files)
    }

    /// Describes the place of a part at the current frame. `files` are those of the scene; `None` for a world of a program.
    pub(in crate::live) fn placement(
        &mut self,
        part: &ScenePart,
        files: Option<&[PathBuf]>,
    ) -> Option<Placement> {
        let state = self.publisher.published().state();
        if state.reloads == 0 {
            return None;
        }
        Placement::of(&mut self.engine, &self.sources, state.frame, part, files)
    }

    /// Describes the camera of the current frame of a scene in files. Returns the reason why it cannot be moved.
    pub(in crate::live) fn camera(&mut self, files: &[PathBuf]) -> Result<CameraView, String> {
        let state = self.publisher.published().state();
        if state.reloads == 0 {
            return Err("the file has mistakes: correct them first".to_owned());
        }
        CameraView::of(&mut self.engine, state.frame, files)
    }
}
