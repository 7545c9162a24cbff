//! The origins of scene elements.

/// The location of a scene element: the file, the list in the file, and the index in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) struct Origin {
    pub(in crate::scene) file: usize,
    pub(in crate::scene) list: &'static str,
    pub(in crate::scene) index: usize,
}
