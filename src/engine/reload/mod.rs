//! Another scene in place of the one before: its entities are matched with the existing ones, and the differences are patched.

mod counterparts;
mod matching;
mod patch;
mod scene;
