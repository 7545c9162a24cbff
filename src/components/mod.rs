//! Components: plain data on hecs entities, without behaviour.
//!
//! | component | describes |
//! |---|---|
//! | [`Transform`], [`Parent`] | the position of an entity and the entity it is relative to |
//! | [`Shape`] with [`Material`] | a visible object |
//! | [`Cloud`], [`CloudSource`] | many copies of a shape, and where they come from over time |
//! | [`AtParticle`] | the particle of a cloud that an entity is at |
//! | [`Visibility`] | the kinds of rays that see a shape |
//! | [`Specular`] | a surface with highlights |
//! | [`Reflective`] | a surface that reflects |
//! | [`Refractive`] | a surface that transmits light |
//! | [`Pattern`] | a surface with a pattern of two colours |
//! | [`Emission`] | a surface that gives off light |
//! | [`Light`] | a light source |
//! | [`Camera`], [`FilmSettings`] | the view, and the size and encoding of the image |
//! | [`LookAt`], [`Target`] | the entity that a camera looks at, or the entity or point that another entity points to |
//! | [`Follow`], [`FocusOn`] | the entity that a camera follows, and the one on which its lens focuses |
//! | [`Shots`] | the active camera over time |
//! | [`Ambient`], [`AmbientOcclusion`], [`Background`], [`Sun`], [`Stars`], [`Fog`], [`Quality`], [`Sampling`], [`Space`] | settings of the whole scene; at most one of each in a world |
//! | [`Overlay`] | texts, scale bars and legends over the picture |
//! | [`Animated`] | motions of the values above, each a [`Property`] and a [`Motion`] |
//! | [`Name`], [`Order`] | the name of an entity and its index in document order |
//! | [`WorldTransform`] | the transform to world space; derived by [`systems::propagate`](crate::systems::propagate), never written by hand |
//!
//! [`Control`] is a value of a program that its preview changes.

mod animated;
mod camera;
mod cloud;
mod control;
mod identity;
mod light;
mod list;
mod material;
mod overlay;
mod property;
mod quantity;
mod range;
mod settings;
mod shape;
mod table;
mod transform;
mod visibility;

pub use animated::{Animated, Channel, Motion, ScriptId, ShortTurn, Way};
pub use camera::{Camera, FocusOn, Follow, Lens, LookAt, Projection, Shot, Shots, Target, View};
pub use cloud::{
    AtParticle, Cloud, CloudBonds, CloudColors, CloudLegend, CloudMember, CloudSource, DataMoment, Particles,
};
pub use control::Control;
pub use identity::{Name, Order};
pub use light::{AreaShape, Falloff, Light, LightKind};
pub(crate) use list::with_components;
pub use material::{Emission, Material, Pattern, PatternKind, Reflective, Refractive, Specular};
pub use overlay::{Anchor, Overlay, OverlayContent, OverlayItem, TextPart};
pub use property::Property;
pub(crate) use property::Requirement;
pub(crate) use quantity::Quantity;
pub(crate) use range::Figure;
pub use range::{RangeError, ValidRange};
pub use settings::{
    Ambient, AmbientOcclusion, Background, FilmSettings, Fog, Noise, Quality, Sampling, Space, Stars, Sun,
};
pub use shape::Shape;
pub(crate) use table::table;
pub use transform::{Parent, Transform, WorldTransform};
pub use visibility::Visibility;
