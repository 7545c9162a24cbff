//! Scenes of parts that are often extreme or degenerate.

use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

use super::animations::{animation, spawning};
use super::cameras::{background, camera, effort, fog, shots};
use super::entities::{entity, material};
use super::read;
use super::values::intensity;

/// Number of cameras in addition to the one in `camera`.
const CAMERAS: usize = 2;

/// The parts of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    transfer: &'static str,
    quality: String,
    sampling: String,
    camera: String,
    cameras: Vec<String>,
    shots: String,
    ambient: String,
    background: String,
    /// The field with its name, or an empty text.
    fog: String,
    materials: [String; 3],
    /// The fields of each entity, and possibly the index of its parent.
    entities: Vec<(String, Option<usize>)>,
    scripts: Vec<String>,
    animations: Vec<String>,
}

pub(crate) fn parts() -> impl Strategy<Value = Parts> {
    let transfer = prop::sample::select(vec!["Classic", "Srgb"]);
    let settings = (transfer, effort(), intensity(), background().boxed(), fog().boxed());
    // Boxed, because nested strategies are too large for the stack.
    let cameras = prop::collection::vec(camera().boxed(), 0..=CAMERAS);
    let views = (camera().boxed(), prop_oneof![Just(Vec::new()), cameras], shots(CAMERAS));
    let materials = [material().boxed(), material().boxed(), material().boxed()];
    let entities = prop::collection::vec((entity().boxed(), prop::option::weighted(0.3, 0..12usize)), 0..12);
    let scripts = prop_oneof![3 => Just(Vec::new()), 1 => prop::collection::vec(spawning(), 1..3)];
    (settings, views, materials, entities, scripts, prop::collection::vec(animation().boxed(), 0..5))
        .prop_map(|(settings, (camera, cameras, shots), materials, entities, scripts, animations)| {
            let (transfer, (quality, sampling), ambient, background, fog) = settings;
            let shots = if cameras.len() == CAMERAS { shots } else { String::new() };
            Parts {
                transfer,
                quality,
                sampling,
                camera,
                cameras,
                shots,
                ambient,
                background,
                fog,
                materials,
                entities,
                scripts,
                animations,
            }
        })
}

impl Parts {
    pub(crate) fn text(&self) -> String {
        let Self { transfer, quality, sampling, camera, shots, ambient, background, fog, .. } = self;
        let [m0, m1, m2] = &self.materials;
        let mut entities = String::new();
        for (index, (what, parent)) in self.entities.iter().enumerate() {
            // Parent 11 may come later and thus form a ring.
            let parent = parent.filter(|parent| *parent < index || *parent == 11);
            let parent = parent.map_or_else(String::new, |parent| format!("parent: \"e{parent}\", "));
            entities += &format!("(name: \"e{index}\", {parent}{what}),\n");
        }
        // Entities that cameras refer to must exist.
        for index in self.entities.len()..3 {
            entities += &format!("(name: \"e{index}\"),\n");
        }
        let cameras: String = self
            .cameras
            .iter()
            .enumerate()
            .map(|(index, camera)| format!("\"c{index}\": ({camera}),\n"))
            .collect();
        let (animations, scripts) = (self.animations.join(",\n"), self.scripts.join(",\n"));
        format!(
            r#"Scene(timeline: (fps: 5, duration: 2), film: (width: 32, height: 18, transfer: {transfer}),
            quality: ({quality}), sampling: ({sampling}), camera: ({camera}), cameras: {{ {cameras} }}, shots: [{shots}],
            ambient: {ambient}, background: {background}, {fog}
            materials: {{ "m0": {m0}, "m1": {m1}, "m2": {m2} }},
            entities: [{entities}], spawn: [{scripts}], animate: [{animations}])"#
        )
    }

    /// Removes invalid parts, so that one of them does not waste the others.
    pub(crate) fn good(self) -> Result<Self, TestCaseError> {
        let plain = "position: (0, 0, -9), target: (0, 0, 0)".to_owned();
        let mut good = Self {
            camera: plain.clone(),
            cameras: Vec::new(),
            shots: String::new(),
            entities: Vec::new(),
            scripts: Vec::new(),
            animations: Vec::new(),
            ..self.clone()
        };
        let is_good = |parts: &Self| read(&parts.text()).map(|scene| scene.is_some());
        let first = Self { camera: self.camera, ..good.clone() };
        if is_good(&first)? {
            good = first;
        }
        for camera in self.cameras {
            let is_good = is_good(&Self { camera: camera.clone(), ..good.clone() })?;
            good.cameras.push(if is_good { camera } else { plain.clone() });
        }
        good.shots = self.shots;
        if !is_good(&good)? {
            good.shots.clear();
        }
        let frame = good.clone();
        for (what, parent) in self.entities {
            if is_good(&Self { entities: vec![(what.clone(), None)], ..frame.clone() })? {
                good.entities.push((what, parent));
            }
        }
        for script in self.scripts {
            good.scripts.push(script);
            if !is_good(&good)? {
                good.scripts.pop();
            }
        }
        for animation in self.animations {
            good.animations.push(animation);
            if !is_good(&good)? {
                good.animations.pop();
            }
        }
        Ok(good)
    }
}
