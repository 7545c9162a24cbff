//! What lights add at sixteen surface points: the operations of [`propose`](super::propose), in their order.

use fearless_simd::{f32x16, prelude::*};
use glam::DVec3;

use super::direct::{LitPoint, Proposal, SampleId, WayToLight, light_place, propose};
use super::path_packet::PathPacket;
use super::shading::{intensity, specular};
use crate::color::Rgb;
use crate::trace::effects::Effects;
use crate::trace::math::{
    Colors, F64s, F64s3, Mask, Numbers, Scaled, Vectors, bits, bits16, dot_lanes as dot, finite3, half_of,
    lanes, mask, scaled, scaled_lanes, select3, splat, splat3, subtract,
};
use crate::trace::query::{HitPacket, SurfacePacket};
use crate::trace::rays::{Limit, RayPacket};
use crate::trace::scene::{Light, LightSource, PreparedScene, SurfaceMaterial};

/// Surface points to be lit, lane by lane.
pub(crate) struct LitPacket<'a> {
    /// The rays that found them.
    pub(crate) rays: &'a RayPacket,
    /// What those carry.
    pub(crate) paths: &'a PathPacket,
    pub(crate) hits: &'a HitPacket,
    pub(crate) surfaces: &'a SurfacePacket,
    /// The diffuse colours there.
    pub(crate) diffuse: &'a Colors,
    /// Lanes whose materials have highlights.
    pub(crate) shiny: u32,
    /// Lanes whose materials are clear.
    pub(crate) clear: u32,
}

/// What a light adds, lane by lane, if it comes through.
#[derive(Clone, Debug)]
pub(crate) struct ProposalPacket {
    /// Lanes to which something is added.
    pub(crate) lanes: u32,
    /// Of these, lanes of which it has to be asked first what stands in the way.
    pub(crate) asking: u32,
    /// Lanes to which light comes from the other side, through the clear medium behind the surface.
    pub(crate) from_behind: u32,
    /// What is added where nothing is in the way.
    pub(crate) colors: Colors,
    /// From the points to the light, where it has to be asked what stands in the way; also their directions wherever the operations of
    /// lanes found what is added.
    pub(crate) rays: RayPacket,
    /// How many times as far it is.
    pub(crate) limits: Numbers,
    /// Where it is, if it has a size.
    places: Vectors,
}

impl ProposalPacket {
    /// Of nothing.
    pub(crate) const EMPTY: Self = Self {
        lanes: 0,
        asking: 0,
        from_behind: 0,
        colors: Colors::splat(Rgb::ZERO),
        rays: RayPacket::EMPTY,
        limits: Numbers::splat(0.0),
        places: Vectors::splat(DVec3::ZERO),
    };

    /// Returns the way to the light in a lane that has one.
    #[inline]
    pub(crate) fn way(&self, light: &Light, lane: usize) -> WayToLight {
        let limit = match light.source {
            LightSource::Point(place) | LightSource::Spot(place, _) => {
                Limit::new(self.limits.get(lane), place)
            }
            LightSource::Directional(_) => Limit::NONE,
            LightSource::Sphere { .. } | LightSource::Rectangle { .. } => {
                Limit::new(self.limits.get(lane), self.places.get(lane))
            }
        };
        let from_behind = self.from_behind & (1 << lane) != 0;
        WayToLight { direction: self.rays.directions.get(lane), limit, from_behind }
    }

    /// Lets the rays of lanes that ask leave the surfaces.
    #[inline(always)]
    fn leave(&mut self, surfaces: &SurfacePacket) {
        self.rays.lanes = self.asking;
        self.rays.left = surfaces.first_equals;
        self.rays.departing = self.asking;
        self.rays.outward = surfaces.from_outside ^ self.from_behind;
        // Which others they leave besides is left to who follows them one by one.
        self.rays.tied = surfaces.tied & self.asking;
    }

    /// Puts a proposal into a lane that has none.
    fn set(&mut self, lane: usize, proposal: &Proposal) {
        let bit = 1 << lane;
        self.lanes |= bit;
        self.colors.set(lane, proposal.color);
        if let Some(WayToLight { direction, limit, from_behind }) = proposal.shadow {
            self.asking |= bit;
            self.rays.directions.set(lane, direction);
            self.limits.set(lane, limit.t());
            self.places.set(lane, limit.place());
            if from_behind {
                self.from_behind |= bit;
            }
        }
    }
}

/// Finds what sample `sample` of light number `index` adds to each point, as far as nothing stands in its way. `asker` says for
/// which sample of which pixel the light is asked in a lane.
#[inline(always)]
pub(crate) fn propose_lanes<S: Simd>(
    simd: S,
    (scene, effects): (&PreparedScene, Effects),
    (index, light): (usize, &Light),
    lit: &LitPacket<'_>,
    sample: u32,
    asker: impl Fn(usize) -> SampleId,
    proposals: &mut ProposalPacket,
) {
    (proposals.lanes, proposals.asking, proposals.from_behind) = (0, 0, 0);
    if lit.surfaces.lanes == 0 {
        return;
    }
    let Some(target) = target((index, light), effects, lit, sample, &asker, proposals) else { return };
    let Aim { cosines, lengths, facing, behind, unusual } = aim(simd, &target, lit, proposals);
    if effects.clear_shadows() {
        proposals.from_behind = behind & lit.clear;
    }
    proposals.lanes = facing | proposals.from_behind;
    let intensities = intensities(effects, light, &lengths, proposals);
    let (diffuse, arriving, cosine) = (lit.diffuse.load(simd), intensities.load(simd), cosines.rounded(simd));
    proposals.colors.store([
        diffuse[0] * arriving[0] * cosine,
        diffuse[1] * arriving[1] * cosine,
        diffuse[2] * arriving[2] * cosine,
    ]);
    if effects.extras {
        add_highlights(scene, lit, &intensities, proposals);
    }
    let black = f32x16::splat(simd, 0.0);
    let [red, green, blue] = proposals.colors.load(simd);
    proposals.lanes &= bits16(!(red.simd_eq(black) & green.simd_eq(black) & blue.simd_eq(black)));
    if effects.shadows() && light.casts_shadows {
        proposals.asking = proposals.lanes;
    }
    for lane in lanes(unusual) {
        let Some(id) = lit.hits.ids.get(lane) else { continue };
        let point = lit_point(lit, lane, scene.material(id), asker(lane));
        if let Some(proposal) = propose(effects, (index, light), &point, sample) {
            proposals.set(lane, &proposal);
        }
    }
    proposals.leave(lit.surfaces);
}

/// How a light is seen from points.
struct Aim {
    /// Cosines of the angles to the normals, without their signs.
    cosines: Numbers,
    /// The lengths of the directions to the light.
    lengths: Numbers,
    /// Lanes whose points face the light.
    facing: u32,
    /// Lanes whose points turn their backs on it.
    behind: u32,
    /// Lanes that have to be asked one by one.
    unusual: u32,
}

/// Finds the directions to a light, and how far it is, for the proposals.
#[inline(always)]
fn aim<S: Simd>(simd: S, target: &Target, lit: &LitPacket<'_>, proposals: &mut ProposalPacket) -> Aim {
    let asked = lit.surfaces.lanes;
    let (cosines, lengths) = (Numbers::splat(0.0), Numbers::splat(1.0));
    let mut aim = Aim { cosines, lengths, facing: 0, behind: 0, unusual: 0 };
    let mut usual = 0;
    for half in 0..2 {
        if half_of(asked, half) == 0 {
            continue;
        }
        let point = lit.surfaces.points.load(simd, half);
        let (to_light, limit, found) = way(simd, target, point, (proposals, half));
        let length = dot(to_light, to_light).sqrt();
        let normal = lit.surfaces.normals.load(simd, half);
        let outside = mask(simd, lit.surfaces.from_outside, half);
        let normal = select3(outside, normal, [-normal[0], -normal[1], -normal[2]]);
        let cosine = dot(normal, to_light) / length;
        let zero = splat(simd, 0.0);
        usual |= bits(found, half);
        aim.facing |= bits(cosine.simd_gt(zero), half);
        aim.behind |= bits(cosine.simd_lt(zero), half);
        aim.cosines.store(half, cosine.abs());
        aim.lengths.store(half, length);
        proposals.rays.origins.store(half, point);
        proposals.rays.directions.store(half, to_light);
        proposals.limits.store(half, limit);
    }
    aim.facing &= asked & usual;
    aim.behind &= asked & usual;
    aim.unusual = asked & !usual;
    aim
}

/// Returns how much of a light arrives in the lanes of proposals.
#[inline(always)]
fn intensities(effects: Effects, light: &Light, lengths: &Numbers, proposals: &ProposalPacket) -> Colors {
    let mut intensities = Colors::splat(light.intensity);
    if effects.extras && (light.falloff.is_some() || matches!(light.source, LightSource::Spot(..))) {
        for lane in lanes(proposals.lanes) {
            let (length, limit) = (lengths.get(lane), proposals.limits.get(lane));
            let direction = proposals.rays.directions.get(lane);
            intensities.set(lane, intensity(effects, light, direction, length, limit));
        }
    }
    intensities
}

/// Adds highlights to the colours of proposals.
#[inline(always)]
fn add_highlights(
    scene: &PreparedScene,
    lit: &LitPacket<'_>,
    intensities: &Colors,
    proposals: &mut ProposalPacket,
) {
    for lane in lanes(lit.shiny & proposals.lanes & !proposals.from_behind) {
        let intensity = intensities.get(lane);
        let Some(id) = lit.hits.ids.get(lane).filter(|_| intensity != Rgb::ZERO) else { continue };
        let normal = facing_normal(lit.surfaces, lane);
        let back = -lit.rays.directions.get(lane);
        let way = proposals.rays.directions.get(lane);
        let highlight = specular(scene.material(id), intensity, normal, way, back);
        proposals.colors.set(lane, proposals.colors.get(lane) + highlight);
    }
}

fn lit_point<'a>(
    lit: &LitPacket<'_>,
    lane: usize,
    material: &'a SurfaceMaterial,
    asker: SampleId,
) -> LitPoint<'a> {
    LitPoint {
        arriving: lit.rays.directions.get(lane),
        path: lit.paths.places[lane],
        point: lit.surfaces.points.get(lane),
        normal: facing_normal(lit.surfaces, lane),
        material,
        diffuse: lit.diffuse.get(lane),
        asker,
    }
}

fn facing_normal(surfaces: &SurfacePacket, lane: usize) -> DVec3 {
    let normal = surfaces.normals.get(lane);
    if surfaces.from_outside & (1 << lane) != 0 { normal } else { -normal }
}

/// Where light comes from.
enum Target {
    /// From here.
    Place(DVec3),
    /// From the places of the lanes.
    Places,
    /// From infinitely far away; [`scaled`].
    Direction(DVec3),
}

/// `None` where nothing comes.
fn target(
    light: (usize, &Light),
    effects: Effects,
    lit: &LitPacket<'_>,
    sample: u32,
    asker: impl Fn(usize) -> SampleId,
    proposals: &mut ProposalPacket,
) -> Option<Target> {
    match light.1.source {
        LightSource::Point(place) | LightSource::Spot(place, _) => Some(Target::Place(place)),
        LightSource::Directional(direction) => Some(Target::Direction(scaled(direction)?.0)),
        LightSource::Sphere { .. } | LightSource::Rectangle { .. } if !effects.extras => None,
        LightSource::Sphere { .. } | LightSource::Rectangle { .. } => {
            for lane in lanes(lit.surfaces.lanes) {
                let (point, path) = (lit.surfaces.points.get(lane), lit.paths.places[lane]);
                proposals.places.set(lane, light_place(light, point, (asker(lane), path), sample));
            }
            Some(Target::Places)
        }
    }
}

/// The direction to the light, how many times as far it is, and where that is so.
#[inline(always)]
fn way<S: Simd>(
    simd: S,
    target: &Target,
    point: F64s3<S>,
    (proposals, half): (&ProposalPacket, usize),
) -> (F64s3<S>, F64s<S>, Mask<S>) {
    let place = match *target {
        Target::Place(place) => splat3(simd, place),
        Target::Places => proposals.places.load(simd, half),
        Target::Direction(direction) => {
            return (splat3(simd, direction), splat(simd, f64::INFINITY), finite3(simd, point));
        }
    };
    let Scaled { direction, length, usual } = scaled_lanes(simd, subtract(place, point));
    (direction, length, usual)
}
