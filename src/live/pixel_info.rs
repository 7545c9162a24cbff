//! What a pixel shows.

use hecs::{Entity, World};
use serde::Serialize;

use crate::components::{Name, Order};
use crate::engine::{Engine, EngineError, Probe};
use crate::scene::Sources;
use crate::time::Time;
use crate::trace::reference::RayEnd;
use crate::trace::{Film, SurfacePoint};

/// A pixel of a picture, and what its first sample sees.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PixelInfo {
    /// Column and row, from 0 at the top left of the film.
    pub pixel: (u32, u32),
    /// The linear colour: of the pixel in the full picture, if there is one, or of its first sample.
    pub linear: [f32; 3],
    /// The same colour as the bytes of a frame file.
    pub bytes: [u8; 3],
    /// The number of samples that the colour is the mean of; `None` for as many as it took.
    pub samples: Option<u32>,
    /// The number of samples of the pixel in the full picture; `None` for as many as it takes.
    pub all: Option<u32>,
    /// The surface that the first sample sees; `None` where its ray meets nothing.
    pub surface: Option<SurfaceInfo>,
}

/// A visible surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceInfo {
    /// The entity's name or, where it has none, `#` and its place in document order.
    pub entity: String,
    /// The material's name where the entity is written.
    pub material: Option<String>,
    /// The place where the entity is written, as `ball.ron:12`.
    pub place: Option<String>,
    /// The point, in scene units.
    pub point: [f64; 3],
    /// The unit normal, on the visible side.
    pub normal: [f64; 3],
    /// The distance from the camera, in scene units.
    pub distance: f64,
}

impl PixelInfo {
    /// Traces a pixel at a moment; its colour is taken from `picture`, the full one, if given. `None` outside the film, and for a
    /// camera without a place.
    pub(super) fn of(
        engine: &mut Engine,
        sources: &Sources,
        time: Time,
        pixel: (u32, u32),
        picture: Option<&Film>,
    ) -> Result<Option<Self>, EngineError> {
        engine.seek_sample(time, 0)?;
        let all = engine.sampling().map_or(1, |sampling| sampling.samples);
        let all = (!engine.is_adaptive()).then_some(all);
        let Some(probe) = engine.probe(pixel.0, pixel.1) else { return Ok(None) };
        let surface = probe.tree.rays.first().and_then(|first| match &first.end {
            RayEnd::Surface(lit) => {
                let distance = lit.surface.distance(&first.ray);
                Some(SurfaceInfo::of(engine, sources, &probe, &lit.surface, distance))
            }
            RayEnd::Background(_) | RayEnd::BeyondDepth(_) => None,
        });
        let (color, samples) = match picture {
            Some(film) => (film.pixel(pixel.0, pixel.1), all),
            None => (probe.color(), Some(1)),
        };
        let bytes = engine.film_settings().transfer.encode(color);
        Ok(Some(Self { pixel, linear: color.to_array(), bytes, samples, all, surface }))
    }
}

impl SurfaceInfo {
    fn of(
        engine: &Engine,
        sources: &Sources,
        probe: &Probe<'_>,
        surface: &SurfacePoint,
        distance: f64,
    ) -> Self {
        let (world, seen) = (engine.world(), probe.entity(surface.hit.id));
        let (entity, place) = named(world, sources, seen);
        Self {
            entity,
            material: order_of(world, seen).and_then(|order| sources.material(order)),
            place,
            point: surface.point.to_array(),
            normal: surface.facing_normal().to_array(),
            distance,
        }
    }
}

/// Returns an entity's name, or `#17` with its place in document order, and the line in which it starts.
pub(super) fn named(world: &World, sources: &Sources, entity: Entity) -> (String, Option<String>) {
    let order = order_of(world, entity);
    let unnamed = || order.map_or_else(|| "#".to_owned(), |order| format!("#{order}"));
    let place = order.and_then(|order| sources.entities(&[order]).next().map(|line| line.to_string()));
    (world.get::<&Name>(entity).map_or_else(|_| unnamed(), |name| name.0.clone()), place)
}

fn order_of(world: &World, entity: Entity) -> Option<usize> {
    world.get::<&Order>(entity).ok().and_then(|order| usize::try_from(order.0).ok())
}
