//! The origins of scene elements.

use crate::scene::extend::EXTENDS;
use crate::scene::spans::PathStep;

/// The location of a scene element: the file, the list in the file, and the index in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) struct Origin {
    pub(in crate::scene) file: usize,
    pub(in crate::scene) list: &'static str,
    pub(in crate::scene) index: usize,
}

impl Origin {
    /// Returns the path of the element in its file.
    pub(in crate::scene) fn path(self) -> Vec<PathStep> {
        let step = match self.list {
            // Not a list: the path of the extended scene.
            EXTENDS => return vec![PathStep::Field(EXTENDS)],
            "materials" => PathStep::Key(self.index),
            _ => PathStep::Index(self.index),
        };
        vec![PathStep::Field(self.list), step]
    }
}
