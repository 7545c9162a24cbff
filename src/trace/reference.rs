//! The reference path: every ray tests every shape. It is the oracle for the fast path, bit for bit, the shortest definition of the picture,
//! and, as it keeps the whole ray tree of a pixel, the source of its explanation.

use glam::DVec3;

use crate::color::Rgb;
use crate::trace::effects::{Effects, Lighting};
use crate::trace::intersect::{CrossingDetail, Scratch, SurfacePoint};
use crate::trace::math::{LANES, PixelSampling};
use crate::trace::ray_tree::{
    LightReach, LitSurface, RayEnd, RayKind, RayTree, SurfaceTerms, TracedLightSample, TracedRay,
};
use crate::trace::rays::{PreparedRay, RayView, ShapeId};
use crate::trace::render::adaptive::{
    Adaptive, PacketSums, PixelMemory, SampleSums, SharedRoundPolicy, block,
};
use crate::trace::render::film::{self, Film};
use crate::trace::render::image::RenderedImage;
use crate::trace::render::job::SamplePlan;
use crate::trace::render::visibility::{FeatureScratch, FeatureSearch, images};
use crate::trace::scene::{
    Attenuation, PassageTerms, PreparedCamera, PreparedLight, PreparedScene, RayClass, SIDE,
};
use crate::trace::shading::{
    ErrorBudget, LARGEST_TREE, LightSample, LightScratch, MediumStack, PathState, RenderContext, SampleId,
    SecondaryRays, SecondaryTerms, ShadingPoint, ShadowRay, TreeRay, Unlit, ambient, emission,
    filtered_and_absorbed, handed_over, light_terms, secondary_rays_and_terms,
};
use crate::trace::stages::{Portion, Tile};

/// Renders samples of pixels, one ray tree after the other.
pub(crate) struct Reference<'a> {
    context: RenderContext<'a>,
    scratch: LightScratch<'static>,
}

impl<'a> Reference<'a> {
    /// Creates the renderer of a scene at one moment, with the given effects.
    #[must_use]
    pub(crate) fn new(
        scene: &'a PreparedScene,
        camera: &'a PreparedCamera,
        sampling: PixelSampling,
        effects: Effects,
    ) -> Self {
        let mut context = RenderContext::new(scene, camera, sampling, effects);
        context.scans_all = true;
        Self { context, scratch: LightScratch::default() }
    }

    /// Adds an instant's samples of the current round to `sums`, whose pixels are in rows from the top.
    pub(crate) fn add(&mut self, sums: &mut ReferenceSums, instant: u32) {
        let resolution = self.context.camera.resolution();
        let mut portions = Vec::new();
        if let Some(adaptive) = sums.adaptive.as_mut().filter(|adaptive| adaptive.wants_images()) {
            adaptive.record_images(&images(&self.context, adaptive.is_open()));
        }
        if sums.adaptive.as_ref().is_some_and(Adaptive::is_unsearched) {
            self.search(sums, instant);
        }
        for tile in Tile::all(resolution) {
            sums.portions(&tile, instant, &mut portions);
            for portion in &portions {
                let (column, row) = tile.pixel(portion.pixel);
                let pixel = row as usize * resolution.0 as usize + column as usize;
                for sample in (0..portion.count).map(|number| portion.first + number * portion.stride) {
                    let tree = self.sample(column, row, sample);
                    let color =
                        tree.as_ref().map_or_else(|| self.context.unplaced_camera_color(), RayTree::color);
                    sums.pixels[pixel].add(color, tree.is_some_and(|tree| tree.is_covered()));
                }
            }
        }
    }

    /// Searches for the features of pixels at an instant.
    pub(crate) fn search(&self, sums: &mut ReferenceSums, instant: u32) {
        let Some(adaptive) = &mut sums.adaptive else { return };
        let RenderContext { scene, camera, .. } = self.context;
        let search = FeatureSearch::new(scene, camera, adaptive.is_open());
        let mut scratch = FeatureScratch::default();
        for mut tile in adaptive.tiles_to_search(instant) {
            let found = search.reference_features((tile.tile(), &tile.known()), &mut scratch);
            found.into_iter().for_each(|found| tile.record(found));
        }
        adaptive.end_search((scene, camera));
    }

    /// Returns the rays of sample `index` of the pixel in column `i` and row `j`. `None` if the camera's position is not finite.
    #[must_use]
    pub(crate) fn sample(&mut self, i: u32, j: u32, index: u32) -> Option<RayTree> {
        let ray = self.context.camera.sample_ray(self.context.sampling, i, j, index)?;
        self.clear();
        let medium = self.context.medium(ray.origin(), &mut self.scratch.media);
        let sample_id = SampleId { seed: self.context.sampling.seed, pixel: (i, j), sample: index };
        Some(self.tree(ray, medium, sample_id))
    }

    /// Returns the rays that follow from any ray. Area lights are sampled as for the first sample of the first pixel.
    #[must_use]
    pub(crate) fn cast(&mut self, ray: PreparedRay) -> RayTree {
        self.clear();
        let medium = self.context.medium_anywhere(ray.origin(), &mut self.scratch.media);
        let sample_id = SampleId { seed: self.context.sampling.seed, pixel: (0, 0), sample: 0 };
        self.tree(ray, medium, sample_id)
    }

    fn clear(&mut self) {
        self.scratch.media.clear();
        self.scratch.search.ties.clear();
        self.scratch.search.tied_hits.clear();
    }

    fn tree(&mut self, ray: PreparedRay, medium: MediumStack, sample_id: SampleId) -> RayTree {
        let Self { context, scratch } = self;
        let mut tree = Vec::new();
        let state = PathState::at_camera(medium);
        let mut wave: Vec<Queued> = vec![(RayKind::Camera, None, TreeRay { ray, state })];
        let (mut beyond, mut size, mut budget) = (Vec::new(), 1, ErrorBudget::new(context.scene));
        for bounces in (0..context.bounces()).rev() {
            if wave.is_empty() {
                break;
            }
            let mut next = Vec::new();
            for (kind, parent, mut ray) in wave {
                let mut traced = trace(context, scratch, kind, parent, &ray, sample_id);
                ray.state.throughput *= traced.passage.transmitted;
                if let RayEnd::Surface(lit) = &mut traced.end {
                    let arrived = (context.seen_by(class_of(kind)), &ray.ray, &ray.state);
                    let (SecondaryRays { reflected, refracted }, terms) =
                        secondary_rays_and_terms(context, scratch, arrived, &lit.surface);
                    lit.terms.secondary = terms;
                    let kinds = [(RayKind::Reflection, reflected), (RayKind::Refraction, refracted)];
                    let parent = Some(tree.len());
                    next.extend(kinds.into_iter().filter_map(|(kind, ray)| Some((kind, parent, ray?))));
                }
                tree.push(traced);
            }
            let cut = negligible(context, &mut budget, &next, bounces);
            wave = Vec::new();
            for (queued, cut) in next.into_iter().zip(cut) {
                if cut {
                    tree[queued.1.unwrap_or(0)].cut += 1;
                } else if bounces > 0 && size < LARGEST_TREE {
                    size += 1;
                    wave.push(queued);
                } else {
                    beyond.push(queued);
                }
            }
        }
        let untraced = (Attenuation::CLEAR, PassageTerms::default());
        let beyond = beyond.into_iter().map(|(kind, parent, ray)| {
            let background = Box::new(context.scene.background_terms(ray.ray.direction()));
            traced(kind, parent, &ray, scratch, untraced, RayEnd::BeyondDepth(background))
        });
        tree.extend(beyond);
        RayTree { rays: tree }
    }
}

/// The kind of a ray to be traced, the index of its parent, and the ray.
type Queued = (RayKind, Option<usize>, TreeRay);

/// Returns, for each ray of a bounce, whether it is cut because its contribution is negligible.
fn negligible(
    context: &RenderContext<'_>,
    budget: &mut ErrorBudget,
    rays: &[Queued],
    bounces: u32,
) -> Vec<bool> {
    let most = |(_, _, ray): &Queued| context.radiance_bound.most(ray.state.throughput, bounces);
    let mut weighed: Vec<(f32, usize)> = rays.iter().map(most).zip(0..).collect();
    let count = budget.cut(&mut weighed);
    let mut cut = vec![false; rays.len()];
    for (_, index) in &weighed[..count] {
        cut[*index] = true;
    }
    cut
}

/// The sums over the samples of all pixels so far.
pub(crate) struct ReferenceSums {
    resolution: (u32, u32),
    pixels: Vec<PixelSum>,
    plan: SamplePlan,
    adaptive: Option<Adaptive>,
}

impl ReferenceSums {
    /// Creates sums without samples. They include alpha in any case.
    #[must_use]
    pub(crate) fn new(resolution: (u32, u32), plan: SamplePlan) -> Self {
        let (columns, rows) = resolution;
        let pixels = vec![PixelSum::default(); columns as usize * rows as usize];
        Self { resolution, pixels, plan, adaptive: plan.adaptive(resolution, PixelMemory::default()) }
    }

    /// Returns the instants of this round's samples, in chronological order.
    pub(crate) fn instants(&self) -> Vec<u32> {
        self.adaptive.as_ref().map_or_else(|| (0..self.plan.instants).collect(), Adaptive::instants)
    }

    /// Returns the instants to search in advance in addition to those that were searched. Empty from the second call on.
    pub(crate) fn instants_between(&mut self) -> Vec<u32> {
        self.adaptive.as_mut().map_or_else(Vec::new, Adaptive::instants_between)
    }

    /// Starts the next round unless the picture has reached its error target. Returns whether there is a next round.
    pub(crate) fn next_round(&mut self, policy: Option<&SharedRoundPolicy>) -> bool {
        let Some(mut adaptive) = self.adaptive.take() else { return false };
        let goes_on = adaptive.judge(&*self, policy);
        self.adaptive = Some(adaptive);
        goes_on
    }

    /// Collects the samples of a tile's pixels at an instant in this round.
    fn portions(&self, tile: &Tile, instant: u32, portions: &mut Vec<Portion>) {
        if let Some(adaptive) = &self.adaptive {
            adaptive.portions(tile, instant, portions);
            return;
        }
        let samples = block(self.plan.samples, self.plan.instants, instant);
        let (first, count) = (samples.start, samples.end - samples.start);
        portions.clear();
        for (row, column) in (0..tile.height).flat_map(|row| (0..tile.width).map(move |column| (row, column)))
        {
            let (packet, lane) = Tile::lane_of(column as usize, row as usize);
            let pixel = u32::try_from(packet * LANES + lane).unwrap_or(0);
            portions.push(Portion { pixel, first, stride: 1, count });
        }
    }

    /// Returns the picture and its sample counts, with alpha if its plan asks for it.
    #[must_use]
    pub(crate) fn resolve(self) -> RenderedImage {
        let ((columns, rows), has_alpha) = (self.resolution, self.plan.alpha);
        let light = |pixel: &PixelSum| pixel.mean(if has_alpha { pixel.covered } else { pixel.all });
        let share = |pixel: &PixelSum| film::alpha(pixel.covered_count.into(), f64::from(pixel.count.max(1)));
        let film = Film::from_pixels(columns, rows, self.pixels.iter().map(light));
        let alpha =
            has_alpha.then(|| Film::from_values(columns, rows, self.pixels.iter().map(share).collect()));
        let sample_counts = self.adaptive.and_then(|adaptive| adaptive.into_memory().counts(self.resolution));
        RenderedImage { film, alpha, passes: None, sample_counts }
    }
}

impl SampleSums for ReferenceSums {
    fn have_alpha(&self) -> bool {
        self.plan.alpha
    }

    fn of(&self, _: usize, (column, row): (usize, usize)) -> PacketSums {
        let (columns, rows) = (self.resolution.0 as usize, self.resolution.1 as usize);
        let mut sums = PacketSums { all: [[0.0; LANES]; 3], squares: [[0.0; LANES]; 3], covered: None };
        let mut covered = [0.0; LANES];
        for (lane, covered) in covered.iter_mut().enumerate() {
            let (column, row) = (column + lane % SIDE as usize, row + lane / SIDE as usize);
            if column >= columns || row >= rows {
                continue;
            }
            let pixel = &self.pixels[row * columns + column];
            for channel in 0..3 {
                sums.all[channel][lane] = pixel.all[channel];
                sums.squares[channel][lane] = pixel.squares[channel];
            }
            *covered = pixel.covered_count.into();
        }
        PacketSums { covered: self.plan.alpha.then_some(covered), ..sums }
    }
}

/// Renders a picture of one moment, pixel by pixel and sample by sample.
#[must_use]
pub fn render(scene: &PreparedScene, camera: &PreparedCamera, sampling: PixelSampling) -> Film {
    let mut sums = ReferenceSums::new(camera.resolution(), SamplePlan::uniform(sampling.samples, 1));
    Reference::new(scene, camera, sampling, Effects::ALL).add(&mut sums, 0);
    sums.resolve().film
}

fn trace(
    context: &RenderContext<'_>,
    scratch: &mut LightScratch<'_>,
    kind: RayKind,
    parent: Option<usize>,
    ray: &TreeRay,
    sample_id: SampleId,
) -> TracedRay {
    let (scene, seen) = (context.scene, context.seen_by(class_of(kind)));
    let Some(closest) = seen.closest_of_all(&ray.ray, &mut scratch.search) else {
        let passage = ray.state.passage(context.effects, scene, &scratch.media, (&ray.ray, f64::INFINITY));
        let background = scene.background_terms(ray.ray.direction());
        return traced(kind, parent, ray, scratch, passage, RayEnd::Background(Box::new(background)));
    };
    let surface = seen.surface(&ray.ray, &closest, &mut scratch.search);
    let length = surface.distance(&ray.ray);
    let passage = ray.state.passage(context.effects, scene, &scratch.media, (&ray.ray, length));
    let lit = lit(context, scratch, (seen, ray), surface, sample_id);
    traced(kind, parent, ray, scratch, passage, RayEnd::Surface(Box::new(lit)))
}

fn class_of(kind: RayKind) -> RayClass {
    if kind == RayKind::Camera { RayClass::Camera } else { RayClass::Secondary }
}

fn traced(
    kind: RayKind,
    parent: Option<usize>,
    ray: &TreeRay,
    scratch: &LightScratch<'_>,
    (passage, medium): (Attenuation, PassageTerms),
    end: RayEnd,
) -> TracedRay {
    let inside = scratch.media.solids(ray.state.medium).collect();
    let (ray, throughput) = (ray.ray, ray.state.throughput);
    TracedRay { kind, parent, ray, throughput, inside, passage, medium, end, cut: 0 }
}

fn lit(
    context: &RenderContext<'_>,
    scratch: &mut LightScratch<'_>,
    (arrived_in, arrived): (&PreparedScene, &TreeRay),
    surface: SurfacePoint,
    sample_id: SampleId,
) -> LitSurface {
    let scene = context.scene;
    let material = scene.material(surface.hit.id);
    let (ambient_color, diffuse) = material.colors_at(surface.point, surface.normal);
    let TreeRay { ray, state } = arrived;
    let normal = surface.facing_normal();
    let (arriving, path, point) = (ray.direction(), state.path, surface.point);
    let lit =
        ShadingPoint { arriving, path, point, material, diffuse, ambient: ambient_color, sample_id, normal };
    let coincident = arrived_in.tied(&surface, &scratch.search.ties);
    let (left, medium) =
        handed_over(context, (arrived_in, context.shadow), (ray, &surface), state.medium, scratch);
    let (seen, mut samples) = ((&left, medium), Vec::new());
    let lights = scene.lights.iter().enumerate();
    let lights = lights.map(|light| reach(context, scratch, light, &lit, seen, &mut samples)).collect();
    let (mut ambient, mut ambient_samples) = (ambient(scene, ambient_color), Vec::new());
    if let Some(dome) = context.dome() {
        let dome = (RenderContext::DOME, dome);
        ambient = reach(context, scratch, dome, &lit, seen, &mut ambient_samples).color();
    }
    let terms = SurfaceTerms {
        pattern: material.pattern_share(surface.point, surface.normal),
        ambient_color,
        ambient_light: scene.ambient,
        diffuse_color: diffuse,
        specular: material.specular,
        shininess: material.shininess,
        secondary: SecondaryTerms::default(),
    };
    let emission = emission(context.effects, material);
    LitSurface { ambient, ambient_samples, emission, lights, samples, terms, surface, coincident }
}

fn reach(
    context: &RenderContext<'_>,
    scratch: &mut LightScratch<'_>,
    light: (usize, &PreparedLight),
    lit: &ShadingPoint<'_>,
    seen: (&SurfacePoint, MediumStack),
    samples: &mut Vec<TracedLightSample>,
) -> LightReach {
    let (mut first, mut occluded, mut traced, mut unlit) = (None, 0, false, None);
    let own_shape = light.1.own_shape;
    let mut sum = DVec3::ZERO;
    for sample in 0..light.1.sample_count() {
        let terms = match light_terms(context.effects, light, lit, sample) {
            Ok(terms) => terms,
            Err(reason) => {
                unlit = Some(if light.1.intensity == Rgb::ZERO { Unlit::Off } else { reason });
                continue;
            }
        };
        let LightSample { color, shadow } = terms.light_sample(context.effects, light.1);
        let share = shadow.map_or(Ok(Rgb::ONE), |segment| {
            traced = true;
            visibility(context, scratch, &segment.ray(seen.0), own_shape, seen)
        });
        let (visibility, occluder) = (share.unwrap_or(Rgb::ZERO), share.err());
        samples.push(TracedLightSample { light: light.0, sample, terms, visibility, occluder });
        match share {
            Ok(share) => sum += (color * share).as_dvec3(),
            Err(id) => {
                first.get_or_insert(id);
                occluded += 1;
            }
        }
    }
    let color = (sum / f64::from(light.1.sample_count())).as_vec3();
    match (first, unlit) {
        (Some(id), _) if color == Rgb::ZERO => LightReach::Occluded(id),
        (None, Some(reason)) if color == Rgb::ZERO && !traced => LightReach::NoShadowRay(reason),
        (None, _) if color == Rgb::ZERO && traced => LightReach::Absorbed,
        _ => LightReach::Reaches { color, occluded },
    }
}

/// Returns the share of a light that is transmitted, or the shape that occludes it: an opaque one or, without transparent shadows, any.
fn visibility(
    context: &RenderContext<'_>,
    scratch: &mut LightScratch<'_>,
    shadow_ray: &ShadowRay,
    own_shape: Option<ShapeId>,
    seen: (&SurfacePoint, MediumStack),
) -> Result<Rgb, ShapeId> {
    let ShadowRay { ray, limit, .. } = shadow_ray;
    let (scene, passes_transparent) =
        (context.shadow, context.effects.lighting == Lighting::TransparentShadows);
    scratch.search.crossed.clear();
    let occludes = |id: &ShapeId| {
        let Scratch { crossed, intersector, ties, .. } = &mut scratch.search;
        let (ray, detail) = (&RayView::new(ray, ties), CrossingDetail::FirstHit);
        Some(*id) != own_shape
            && (scene.occludes_or_is_crossed(*id, (ray, limit), detail, crossed, intersector)
                || !passes_transparent && !crossed.is_empty())
    };
    match scene.geometry().ids_in_order().filter(|id| scene.sees(*id)).find(occludes) {
        Some(id) => Err(id),
        None => Ok(filtered_and_absorbed(scene, shadow_ray, own_shape, seen, scratch)),
    }
}

/// The sums over a pixel's samples. They are `f64`, so that the mean of equal samples is exactly their value, and the mean of 2^16 samples is
/// as accurate as the mean of two.
#[derive(Clone, Copy, Debug, Default)]
struct PixelSum {
    all: DVec3,
    squares: DVec3,
    count: u32,
    /// Sum over the samples in which the pixel is covered.
    covered: DVec3,
    covered_count: u32,
}

impl PixelSum {
    fn add(&mut self, sample: Rgb, is_covered: bool) {
        let sample = sample.as_dvec3();
        self.all += sample;
        self.squares += sample * sample;
        self.count += 1;
        if is_covered {
            self.covered += sample;
            self.covered_count += 1;
        }
    }

    /// Returns a sum divided by the number of samples, rounded to `f32` once.
    fn mean(&self, sum: DVec3) -> Rgb {
        (sum / f64::from(self.count.max(1))).as_vec3()
    }
}
