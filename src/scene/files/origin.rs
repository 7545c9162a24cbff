//! The origin of something in a scene of several files.

/// The file, the list in it and the index at which something is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) struct Origin {
    pub(in crate::scene) file: usize,
    pub(in crate::scene) list: &'static str,
    pub(in crate::scene) index: usize,
}
