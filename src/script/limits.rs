//! The limits of a script. Together they bound time and memory: a run holds at most [`VARIABLES`] values, each of them at most
//! [`LIST`] numbers and [`TEXT`] bytes of text, in each of [`CALLS`] calls; copying a value, and going through one, counts as
//! operations too.

/// The most operations of a channel's script in one run: some hundredths of a second.
pub(crate) const OPERATIONS: u64 = 100_000;
/// The most operations of a channel's script at a moment in all runs that end at a value that is not known yet.
pub(crate) const OPERATIONS_UNTIL_KNOWN: u64 = 1_000_000;
/// The most operations of a script that spawns, before those that its entities add.
pub(crate) const SPAWNING_OPERATIONS: u64 = 200_000;
/// The operations added for each spawned entity whose name no other has.
pub(crate) const OPERATIONS_PER_ENTITY: u64 = 100;
/// The most operations of a script that spawns, however many entities it has.
pub(crate) const MOST_SPAWNING_OPERATIONS: u64 = 40_000_000;
/// The operations that refusing an entity counts as: as many as an accepted one adds.
pub(super) const REFUSAL: usize = 100;
/// The operations that a failure counts as, since a script may catch it.
pub(super) const FAILURE: usize = 10;
/// The most entities that the scripts of a scene spawn.
pub(crate) const ENTITIES: u64 = 1_000_000;
/// The most bytes of text in all of these, names included: 64 for each of them.
pub(crate) const SPAWNED_TEXT: u64 = 64 << 20;
/// The longest script, in bytes: reading one takes up to the square of its length.
pub(crate) const SCRIPT: usize = 1 << 16;
/// The longest text, in bytes, also of all texts in a list or a map together.
pub(crate) const TEXT: usize = 4096;
/// The most values in a list, with those of the lists in it.
pub(crate) const LIST: usize = 256;
/// The most values in a map, with those of the maps in it.
pub(crate) const MAP: usize = 32;
/// The most variables at a time.
pub(crate) const VARIABLES: usize = 128;
/// The most values that a function is called with.
pub(crate) const ARGUMENTS: usize = 16;
/// The most functions in a script.
pub(crate) const FUNCTIONS: usize = 256;
/// The greatest depth of calls.
pub(crate) const CALLS: usize = 32;
/// The greatest depth of nested expressions.
pub(crate) const NESTING: usize = 64;
/// The greatest depth of nested expressions in functions.
pub(crate) const NESTING_IN_FUNCTIONS: usize = 32;
