//! An entity's name and its index in document order.

/// The name in the scene file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Name(pub String);

/// An entity's index in document order. Entities spawned later follow in the order in which they were spawned.
///
/// Every order-dependent result uses this index, for example the choice among coincident surfaces and the summation of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Order(pub u64);
