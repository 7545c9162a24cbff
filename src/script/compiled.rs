//! The compiled scripts of a scene.

use super::{Language, Script};
use crate::color::Transfer;

/// The compiled scripts of a scene.
#[derive(Debug)]
pub(crate) struct CompiledScripts {
    /// The language that runs the scripts.
    pub(crate) language: Language,
    /// All scripts.
    pub(crate) list: Vec<Script>,
    /// Uses of scripts: the index of the script in `list`, and the prefix of the entity names that it reads.
    pub(crate) uses: Vec<(usize, String)>,
    /// Transfer function for colours in scripts.
    pub(crate) transfer: Transfer,
}

impl CompiledScripts {
    /// Creates a collection without scripts.
    #[must_use]
    pub(crate) fn new(language: Language, transfer: Transfer) -> Self {
        Self { language, list: Vec::new(), uses: Vec::new(), transfer }
    }

    /// Returns the script of the use with index `place`, and the prefix of the names that it reads.
    #[must_use]
    pub(crate) fn used(&self, place: usize) -> Option<(&Script, &str)> {
        let (script, prefix) = self.uses.get(place)?;
        Some((self.list.get(*script)?, prefix))
    }
}
