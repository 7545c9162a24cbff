//! Reloading: matches the entities of the old and the new scene and patches the differences.

mod counterparts;
mod matching;
mod patch;
mod scene;
