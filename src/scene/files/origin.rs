//! Where something of a scene of several files is written.

/// Where something is written: in which list of which file, at which index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) struct Origin {
    pub(in crate::scene) file: usize,
    pub(in crate::scene) list: &'static str,
    pub(in crate::scene) index: usize,
}
