//! A scene at one moment, as arrays: shapes, materials, lights, the camera and the environment. Ray queries are in `query`.

mod camera;
mod changes;
mod checker;
mod document_order;
mod environment;
mod equal_shapes;
mod fingerprint;
mod geometry;
mod leaf_shapes;
mod light;
mod material;
mod material_summary;
mod material_table;
mod precision;
mod prepared_scene;
mod sky;
mod tree_maintenance;

pub use camera::PreparedCamera;
pub(crate) use camera::{PixelCenters, PixelKeys, SIDE, Square};
pub use changes::{BvhUpdate, SceneChanges, ShapeChange};
pub(crate) use checker::CheckerPattern;
pub(crate) use environment::transmittance;
pub use environment::{Attenuation, PreparedBackground};
pub(crate) use environment::{FogLayer, PreparedFog};
pub(crate) use equal_shapes::EqualGroup;
pub use geometry::{Geometry, PreparedShape};
pub(crate) use geometry::{ShapeKind, ShapeLocation, ShapeRef};
pub(crate) use light::{Cone, PreparedFalloff};
pub use light::{LightSource, PreparedLight};
pub(crate) use light::{on_rectangle, on_sphere};
pub(crate) use material::PreparedChecker;
pub use material::{Refraction, SurfaceMaterial};
pub(crate) use material_table::MaterialTable;
pub use precision::Precision;
pub use prepared_scene::PreparedScene;
pub(crate) use sky::{PreparedSky, PreparedStars, PreparedSun};
