//! Limits of scripts. Together they bound time and memory: each of at most [`CALLS`] nested calls holds at most [`VARIABLES`] values,
//! each with at most [`LIST`] numbers and [`TEXT`] bytes of text. Copying and traversing values also count as operations.

/// Maximum number of operations in one run of a channel's script: a few hundredths of a second.
pub(crate) const OPERATIONS: u64 = 100_000;
/// Maximum number of operations of a channel at a frame's moment, summed over the runs of its script that stop at a value that is not known
/// yet, and over the runs of scripts at other moments that its script needs.
pub(crate) const OPERATIONS_UNTIL_KNOWN: u64 = 1_000_000;
/// Operations charged for a read at another moment: its time is that of 10 operations, apart from the runs of scripts.
pub(crate) const READ_ELSEWHERE: u64 = 10;
/// Number of reads at other moments whose values are kept for other channels.
pub(crate) const KNOWN_ELSEWHERE: usize = 10_000;
/// Maximum number of operations of a spawning script without entities. Each entity adds [`OPERATIONS_PER_ENTITY`].
pub(crate) const SPAWNING_OPERATIONS: u64 = 200_000;
/// Operations added to the limit for each spawned entity, unless another entity has its name.
pub(crate) const OPERATIONS_PER_ENTITY: u64 = 100;
/// Maximum number of operations of a spawning script with any number of entities.
pub(crate) const MOST_SPAWNING_OPERATIONS: u64 = 40_000_000;
/// Operations charged for a rejected entity: as many as an accepted entity adds to the limit.
pub(super) const REFUSAL: usize = 100;
/// Operations charged for an error, since a script can catch it.
pub(super) const FAILURE: usize = 10;
/// Maximum number of entities spawned by the scripts of a scene.
pub(crate) const ENTITIES: u64 = 1_000_000;
/// Maximum total size in bytes of the strings in all spawned entities, names included: 64 per entity.
pub(crate) const SPAWNED_TEXT: u64 = 64 << 20;
/// Maximum length of a script in bytes. Reading a script can take quadratic time.
pub(crate) const SCRIPT: usize = 1 << 16;
/// Maximum length of a string in bytes, and of all strings in a list or a map together.
pub(crate) const TEXT: usize = 4096;
/// Maximum number of values in a list, including the values of nested lists.
pub(crate) const LIST: usize = 256;
/// Maximum number of values in a map, including the values of nested maps.
pub(crate) const MAP: usize = 32;
/// Maximum number of variables at a time.
pub(crate) const VARIABLES: usize = 128;
/// Maximum number of arguments of a call.
pub(crate) const ARGUMENTS: usize = 16;
/// Maximum number of functions in a script.
pub(crate) const FUNCTIONS: usize = 256;
/// Maximum depth of nested calls.
pub(crate) const CALLS: usize = 32;
/// Maximum depth of nested expressions outside functions.
pub(crate) const NESTING: usize = 64;
/// Maximum depth of nested expressions in functions.
pub(crate) const NESTING_IN_FUNCTIONS: usize = 32;
