//! How people and sums refer to an entity.

/// What the scene file calls it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Name(pub String);

/// An entity's place in document order. Entities spawned later follow in the order they were spawned.
///
/// Every order that can reach a bit of a picture is this one: which of two coincident surfaces is seen, and in which
/// order lights are added up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Order(pub u64);
