//! Rendering of a picture from samples: the job and its tiles, adaptive sampling, and the film.
//!
//! | | |
//! |---|---|
//! | `job` | a picture being rendered, instant by instant |
//! | `tile_work`, `work_queue` | distribution of the tiles to threads |
//! | `accumulator` | the sums of a tile's samples |
//! | `adaptive`, `visibility` | the choice of sample counts for an error target, and the geometry in each pixel, on which it depends |
//! | `film`, `passes`, `image` | the pixels, the data of the surfaces that they show, and both together |
//! | `film_overlay` | what is drawn over the pixels |
//! | `reuse` | the tiles of a former picture that no difference between two scenes can reach |
//! | `fingerprint` | the identity of a picture: a hash of everything that determines it |

mod accumulator;
pub(super) mod adaptive;
pub(super) mod film;
pub(super) mod film_overlay;
pub(super) mod fingerprint;
pub(super) mod image;
pub(super) mod job;
pub(super) mod passes;
pub(super) mod reuse;
pub(super) mod tile_work;
pub(super) mod visibility;
mod work_queue;
