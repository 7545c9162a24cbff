//! An entity's name, and its place in document order.

/// The name in the scene file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Name(pub String);

/// An entity's place in document order. Entities spawned later follow in the order they were spawned.
///
/// Every order that can affect a bit of a picture is this one: which of two coincident surfaces is seen, and in which order
/// lights are added up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Order(pub u64);
