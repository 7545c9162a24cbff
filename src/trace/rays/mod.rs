//! Rays, and the surfaces that they leave.

mod departure;
mod limit;
mod packet;
mod ray;
mod shape_id;
mod ties;
mod view;

pub(crate) use departure::Departure;
pub(crate) use limit::{FAR, Limit};
pub(crate) use packet::RayPacket;
pub use ray::Ray;
pub use shape_id::ShapeId;
pub(crate) use shape_id::ShapeIds;

pub(crate) use ties::{Tie, TieLists, Ties};
pub(crate) use view::RayView;
