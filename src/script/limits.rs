//! How much a program may do. Together they bound time and memory: a run holds at most [`VARIABLES`] values, each of them at
//! most [`LIST`] numbers and [`TEXT`] bytes of text, in each of [`CALLS`] calls; what it is to copy a value, and to go through one, are
//! operations too.

/// The most operations of a channel's program in one run: some hundredths of a second.
pub const OPERATIONS: u64 = 100_000;
/// The most operations of a channel's program at a moment in all runs that end at a value that is not known yet.
pub const OPERATIONS_UNTIL_KNOWN: u64 = 1_000_000;
/// The most operations of a program that spawns, before those that its entities add.
pub const SPAWNING_OPERATIONS: u64 = 200_000;
/// So many operations more for each spawned entity whose name no other has.
pub const OPERATIONS_PER_ENTITY: u64 = 100;
/// The most operations of a program that spawns, however many entities it has.
pub const MOST_SPAWNING_OPERATIONS: u64 = 40_000_000;
/// Operations that it is to refuse an entity: what one that is taken brings.
pub(super) const REFUSAL: usize = 100;
/// Operations that it is to say what is wrong, which a program may catch.
pub(super) const FAILURE: usize = 10;
/// The most entities that the programs of a scene spawn.
pub const ENTITIES: u64 = 1_000_000;
/// The most bytes of text in all of these, names included: 64 for each of them.
pub const SPAWNED_TEXT: u64 = 64 << 20;
/// The longest program, in bytes: reading one takes up to the square of its length.
pub const PROGRAM: usize = 1 << 16;
/// The longest text, in bytes, also of all texts in a list or a map together.
pub const TEXT: usize = 4096;
/// The most values in a list, with those of the lists in it.
pub const LIST: usize = 256;
/// The most values in a map, with those of the maps in it.
pub const MAP: usize = 32;
/// The most variables at a time.
pub const VARIABLES: usize = 128;
/// The most values that a function is called with.
pub const ARGUMENTS: usize = 16;
/// The most functions in a program.
pub const FUNCTIONS: usize = 256;
/// How deep functions may call each other.
pub const CALLS: usize = 32;
/// How deep expressions may be nested.
pub const NESTING: usize = 64;
/// How deep expressions in functions may be nested.
pub const NESTING_IN_FUNCTIONS: usize = 32;
