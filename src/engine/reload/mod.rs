//! Another scene in place of the one before: its entities are matched with those that there are, and what differs is patched.

mod counterparts;
mod matching;
mod patch;
mod scene;
