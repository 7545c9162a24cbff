//! An entity's name and its index in document order.

/// The name in the scene file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Name(pub String);

impl Name {
    /// Creates a name.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self(name.into())
    }
}

/// An entity's index in document order. Entities spawned later follow in the order in which they were spawned.
///
/// Every order-dependent result uses this index, for example the choice among coincident surfaces and the summation of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Order(pub u64);
