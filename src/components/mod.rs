//! Components: plain data on hecs entities, without behaviour.
//!
//! | component | says |
//! |---|---|
//! | [`Transform`], [`Parent`] | where an entity is, and relative to what |
//! | [`Shape`] with [`Material`] | something to be seen |
//! | [`Specular`] | its surface shows highlights |
//! | [`Reflective`] | its surface mirrors |
//! | [`Refractive`] | light goes through it |
//! | [`Checker`] | its surface has squares of two colours |
//! | [`Light`] | it gives light |
//! | [`Camera`], [`FilmSettings`] | from where and on what the picture is taken |
//! | [`Follow`], [`LookAt`], [`Shots`] | what a camera goes along with and looks at, and which one is active when |
//! | [`Ambient`], [`Background`], [`Fog`], [`Quality`], [`Sampling`] | settings of the whole scene; one of each in a world |
//! | [`Animated`] | motions of the values above: a [`Property`] and a [`Motion`] each |
//! | [`Name`], [`Order`] | how people and sums refer to it |
//! | [`WorldTransform`] | derived by [`systems::propagate`](crate::systems::propagate); never written by hand |

mod animated;
mod camera;
mod identity;
mod light;
mod list;
mod material;
mod property;
mod quantity;
mod settings;
mod shape;
mod table;
mod transform;

pub use animated::{Animated, Channel, Motion, ScriptId, ShortTurn};
pub use camera::{Camera, Follow, Lens, LookAt, Projection, Shot, Shots, View};
pub use identity::{Name, Order};
pub use light::{AreaShape, Falloff, Light, LightKind};
pub(crate) use list::with_components;
pub use material::{Checker, Material, Reflective, Refractive, Specular};
pub(crate) use property::Part;
pub use property::Property;
pub(crate) use quantity::Quantity;
pub use settings::{Ambient, Background, FilmSettings, Fog, Noise, Quality, Sampling};
pub use shape::Shape;
pub(crate) use table::table;
pub use transform::{Parent, Transform, WorldTransform};
