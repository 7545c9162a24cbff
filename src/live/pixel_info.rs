//! Description of single pixels.

use hecs::{Entity, World};
use serde::Serialize;

use crate::components::Order;
use crate::drawing::label;
use crate::engine::{Engine, EngineError};
use crate::scene::Sources;
use crate::systems::Preparation;
use crate::time::Time;
use crate::trace::{Film, ShapeId, SurfacePoint};

/// A pixel of a picture, and the surface seen by its first sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PixelInfo {
    /// Column and row, from 0 at the top left of the film.
    pub pixel: (u32, u32),
    /// Linear colour of the pixel in the full picture or, if there is none, of the pixel's first sample.
    pub linear: [f32; 3],
    /// The same colour encoded as the bytes of a frame file.
    pub bytes: [u8; 3],
    /// Number of samples averaged in the colour; `None` for adaptive sampling.
    pub samples: Option<u32>,
    /// Number of samples of the pixel in the full picture; `None` for adaptive sampling.
    pub all: Option<u32>,
    /// Surface seen by the first sample; `None` if its ray hits nothing.
    pub surface: Option<SurfaceInfo>,
}

/// A visible surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceInfo {
    /// Name of the entity or, if it has none, `#` and its index in document order.
    pub entity: String,
    /// Name of the material in the definition of the entity.
    pub material: Option<String>,
    /// Position of the entity's definition, as `ball.ron:12`.
    pub place: Option<String>,
    /// Visible point, in scene units.
    pub point: [f64; 3],
    /// Unit normal on the visible side.
    pub normal: [f64; 3],
    /// Distance from the camera, in scene units.
    pub distance: f64,
}

impl PixelInfo {
    /// Traces a pixel at a moment. The colour is taken from `picture`, the full picture, if given. Returns `None` outside the film, and
    /// for a camera without a position.
    pub(super) fn of(
        engine: &mut Engine,
        sources: &Sources,
        time: Time,
        pixel: (u32, u32),
        picture: Option<&Film>,
    ) -> Result<Option<Self>, EngineError> {
        let sampling = engine.effective_settings().sampling;
        let all = (!sampling.is_adaptive()).then_some(sampling.samples);
        let Some(tree) = engine.probe(time, pixel, 0)? else { return Ok(None) };
        let surface = tree.rays.first().and_then(|first| {
            let surface = &first.surface()?.surface;
            SurfaceInfo::of(engine, sources, surface, surface.distance(&first.ray))
        });
        let (color, samples) = match picture {
            Some(film) => (film.pixel(pixel.0, pixel.1), all),
            None => (tree.color(), Some(1)),
        };
        let bytes = engine.effective_settings().film.transfer.encode(color);
        Ok(Some(Self { pixel, linear: color.to_array(), bytes, samples, all, surface }))
    }
}

impl SurfaceInfo {
    fn of(engine: &Engine, sources: &Sources, surface: &SurfacePoint, distance: f64) -> Option<Self> {
        let (world, prepared) = (engine.world(), engine.prepared()?);
        let id = prepared.entity(surface.hit.id);
        let (entity, place) = slot_name(engine, prepared, sources, surface.hit.id);
        Some(Self {
            entity,
            material: order_of(world, id).and_then(|order| sources.material(order)),
            place,
            point: surface.point.to_array(),
            normal: surface.facing_normal().to_array(),
            distance,
        })
    }
}

/// Returns the name of the entity in a slot, with the number of a particle, and the line in which its definition starts.
pub(super) fn slot_name(
    engine: &Engine,
    prepared: &Preparation,
    sources: &Sources,
    slot: ShapeId,
) -> (String, Option<String>) {
    let (world, id) = (engine.world(), prepared.entity(slot));
    let (name, place) = (label(world, id), place_of(world, sources, id));
    let Some((member, origin)) = prepared.cloud_member(slot) else { return (name, place) };
    let places: Vec<String> = place.into_iter().chain(origin.map(str::to_owned)).collect();
    (format!("{name}/{member}"), (!places.is_empty()).then(|| places.join(", ")))
}

/// Returns the line in which the definition of an entity starts.
pub(super) fn place_of(world: &World, sources: &Sources, entity: Entity) -> Option<String> {
    order_of(world, entity).and_then(|order| sources.entities(&[order]).next().map(|line| line.to_string()))
}

/// Returns an entity's index in document order.
pub(super) fn order_of(world: &World, entity: Entity) -> Option<usize> {
    world.get::<&Order>(entity).ok().and_then(|order| usize::try_from(order.0).ok())
}
