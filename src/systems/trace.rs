//! The tracer system: queries the prepared world for closest hits and shadow rays, and writes the film.
//!
//! It runs last, at each instant of a frame ([`Simulation::visit`]): on all threads with the kernel's BVH, or, as the reference, on one
//! thread with a linear scan.

use std::ops::ControlFlow::Continue;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::fingerprint::HashedInstants;
use super::{
    FrameInstants, FrameReport, Interrupted, NextInstants, OneColor, Preparation, PreparedInstant,
    RenderRequest, Simulation,
};
use crate::color::{Encoding, Linear};
use crate::trace::reference::{Reference, ReferenceSums};
use crate::trace::{
    Effects, Film, FinishedJob, InstantInputs, PassPixel, Precision, PreparedRay, RayTree, RenderJob,
    RenderedImage, ReusablePicture, SampleMemory, SharedRoundPolicy, Signals, TileReuse, round_policy,
};

/// Renders a frame, and reports its costs.
///
/// # Errors
///
/// If the world cannot be advanced to an instant of the frame, or if rendering is cancelled or stopped at a pause.
pub(crate) fn render<E: Encoding>(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    request: RenderRequest<'_, E>,
    policy: Option<&SharedRoundPolicy>,
    memory: &mut SampleMemory,
    report: &mut FrameReport,
) -> Result<RenderedImage<E::Pixel>, Interrupted> {
    let (has_passes, encoding, cancelled) = (request.passes, request.encoding, request.signals.cancelled);
    let mut image = match request.reference {
        true => trace_reference(simulation, frame, &request, policy, report)?,
        false => trace(simulation, frame, request, policy, memory, report)?,
    };
    report.one_color = one_color(encoding, &image.film);
    if has_passes {
        let start = Instant::now();
        image.passes = Some(trace_passes(simulation, frame, cancelled)?);
        report.trace += start.elapsed();
    }
    Ok(image)
}

/// Returns the colour of a film of two or more equal pixels.
fn one_color<E: Encoding>(encoding: E, film: &Film<E::Pixel>) -> Option<OneColor> {
    let [first, others @ ..] = film.pixels() else { return None };
    let are_equal = !others.is_empty() && others.iter().all(|pixel| pixel == first);
    are_equal.then(|| match encoding.black(1).first() == Some(first) {
        true => OneColor::Black,
        false => OneColor::Other,
    })
}

/// Renders a frame by the fast path.
fn trace<E: Encoding>(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    request: RenderRequest<'_, E>,
    policy: Option<&SharedRoundPolicy>,
    memory: &mut SampleMemory,
    report: &mut FrameReport,
) -> Result<RenderedImage<E::Pixel>, Interrupted> {
    let RenderRequest {
        encoding,
        alpha,
        sample_counts,
        tile_stats,
        fingerprint,
        signals,
        on_pause,
        resume,
        reuse,
        ..
    } = request;
    let (mut own_job, mut own_visit) = (None, |_: &RenderJob<E>| Continue(()));
    let job = resume.unwrap_or(&mut own_job);
    let on_pause = on_pause.unwrap_or(&mut own_visit);
    let former = reuse.as_deref().filter(|_| job.is_none());
    let mut compared = former.map(|former| TileReuse::new(encoding, alpha, former.as_ref()));
    // Which tiles are the same is known only after all instants.
    if frame.count() > 1 {
        compared = compare(simulation, frame, compared, report, signals.cancelled)?;
    }
    let mut start_job = |instant: PreparedInstant<'_>| {
        let data = instant.data;
        let plan = frame.sample_plan(data, alpha);
        let job = RenderJob::encoded(encoding, data.camera().resolution(), plan, std::mem::take(memory));
        let job = job.with_overlay(data.overlay());
        if frame.count() == 1 {
            compare_instant(frame, &mut compared, instant);
        }
        match compared.take() {
            Some(compared) => job.reusing(compared),
            None => job,
        }
    };
    let mut hashed = fingerprint.then(|| HashedInstants::new(frame));
    let is_fresh = job.is_none();
    let first = job.as_ref().map_or_else(|| frame.first_instants(), RenderJob::instants);
    let identifying = frame.identifying_instants();
    // With an open shutter, the first round visits few instants. Others are searched too, since shapes may be visible only there.
    if identifying != first && (is_fresh || fingerprint) {
        simulation.visit(frame, identifying, report, signals.cancelled, |instant| {
            if let Some(hashed) = &mut hashed {
                hashed.note(instant);
            }
            let job = job.get_or_insert_with(|| start_job(instant));
            if is_fresh {
                let PreparedInstant { data, index, .. } = instant;
                job.search((data.scene(), data.camera()), index, signals.cancelled);
            }
            NextInstants::Continue
        })?;
        let between = job.as_mut().filter(|_| is_fresh).map_or_else(Vec::new, RenderJob::instants_between);
        simulation.visit(frame, between, report, signals.cancelled, |instant| {
            let PreparedInstant { data, index, .. } = instant;
            job.iter_mut()
                .for_each(|job| job.search((data.scene(), data.camera()), index, signals.cancelled));
            NextInstants::Continue
        })?;
    }
    let (mut traced, mut hashing, mut is_complete) = (Duration::ZERO, Duration::ZERO, true);
    let visited = simulation.visit(frame, first, report, signals.cancelled, |instant| {
        let start = Instant::now();
        if let Some(hashed) = &mut hashed {
            hashed.note(instant);
        }
        hashing += start.elapsed();
        let PreparedInstant { data, effects, index } = instant;
        let job = job.get_or_insert_with(|| start_job(instant));
        let sampling = data.sampling(frame.time);
        let mut start = Instant::now();
        while !job.add(data.scene(), data.camera(), sampling, index, effects, signals) {
            traced += start.elapsed();
            if signals.cancelled.load(Ordering::Relaxed) || on_pause(job).is_break() {
                is_complete = false;
                return NextInstants::Stop;
            }
            start = Instant::now();
        }
        let next = match job.is_round_done() {
            false => NextInstants::Continue,
            true if job.next_round(policy) => NextInstants::Visit(job.instants()),
            true => NextInstants::Stop,
        };
        traced += start.elapsed();
        next
    });
    report.prepare += hashing;
    report.trace = traced;
    visited?;
    let job = job.take_if(|_| is_complete).ok_or(Interrupted::Cancelled)?;
    if tile_stats {
        report.tile_stats = job.tile_stats();
    }
    let mut image = finish(job, memory, report, reuse);
    report.fingerprint = hashed.map(|hashed| match policy {
        Some(_) => hashed.finish().with_rounds(&report.rounds),
        None => hashed.finish(),
    });
    image.sample_counts = sample_counts.then(|| memory.counts(image.film.size())).flatten();
    Ok(image)
}

/// Finishes a job, and reports its samples and rays.
fn finish<E: Encoding>(
    job: RenderJob<E>,
    memory: &mut SampleMemory,
    report: &mut FrameReport,
    reuse: Option<&mut Option<Arc<ReusablePicture<E>>>>,
) -> RenderedImage<E::Pixel> {
    report.rounds = job.rounds().to_vec();
    report.error = job.estimated_error();
    report.reused = job.reused_share();
    let start = Instant::now();
    let FinishedJob { image, stats, memory: job_memory, reusable } = job.finish();
    if let (Some(reuse), Some(reusable)) = (reuse, reusable) {
        *reuse = Some(Arc::new(reusable));
    }
    report.trace += start.elapsed();
    (report.rays, report.ends, report.escalations) = (stats.rays, stats.ends, stats.escalations);
    *memory = job_memory;
    image
}

/// Compares all instants of a frame with those of a former picture. Returns `None` if tiles cannot be reused, and if the comparison would take
/// long, since custom systems would start again.
///
/// # Errors
///
/// If the world cannot be advanced to an instant of the frame, or if `cancelled` becomes true.
fn compare<E: Encoding>(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    compared: Option<TileReuse<E>>,
    report: &mut FrameReport,
    cancelled: &AtomicBool,
) -> Result<Option<TileReuse<E>>, Interrupted> {
    let mut compared = compared.filter(|_| simulation.schedule.is_empty());
    let instants = compared.iter().flat_map(|_| 0..frame.count()).collect();
    simulation.visit(frame, instants, report, cancelled, |instant| {
        compare_instant(frame, &mut compared, instant);
        if compared.is_some() { NextInstants::Continue } else { NextInstants::Stop }
    })?;
    Ok(compared)
}

/// Compares the next instant of a frame with that of a former picture. Sets `compared` to `None` if tiles cannot be reused, since pixels may depend
/// on other pixels or there are very many shapes.
fn compare_instant<E: Encoding>(
    frame: &FrameInstants,
    compared: &mut Option<TileReuse<E>>,
    PreparedInstant { data, effects, .. }: PreparedInstant<'_>,
) {
    let most = ReusablePicture::<Linear>::MOST_SHAPES / frame.count().max(1) as usize;
    let is_comparable = data.error_target(false).is_none()
        && data.scene().precision == Precision::Robust
        && data.scene().geometry().len() <= most;
    *compared = compared.take().filter(|_| is_comparable);
    if let Some(compared) = compared {
        let (scene, camera, sampling) = (data.scene(), data.camera(), data.sampling(frame.time));
        let overlay = data.overlay();
        compared.add(&InstantInputs { scene, camera, sampling, effects, overlay: overlay.as_deref() });
    }
}

/// Renders a frame by the reference path.
fn trace_reference<E: Encoding>(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    request: &RenderRequest<'_, E>,
    policy: Option<&SharedRoundPolicy>,
    report: &mut FrameReport,
) -> Result<RenderedImage<E::Pixel>, Interrupted> {
    let RenderRequest { encoding, alpha, sample_counts, signals: Signals { cancelled, .. }, .. } = *request;
    let (mut sums, mut overlay) = (None, None);
    let start_sums =
        |data: &Preparation| ReferenceSums::new(data.camera().resolution(), frame.sample_plan(data, alpha));
    let (first, identifying) = (frame.first_instants(), frame.identifying_instants());
    let mut rest = first.len();
    if identifying != first {
        simulation.visit(frame, identifying, report, cancelled, |instant| {
            let PreparedInstant { data, index, .. } = instant;
            reference(frame, data).search(sums.get_or_insert_with(|| start_sums(data)), index);
            NextInstants::Continue
        })?;
        let between = sums.as_mut().map_or_else(Vec::new, ReferenceSums::instants_between);
        simulation.visit(frame, between, report, cancelled, |PreparedInstant { data, index, .. }| {
            sums.iter_mut().for_each(|sums| reference(frame, data).search(sums, index));
            NextInstants::Continue
        })?;
    }
    simulation.visit(frame, first, report, cancelled, |PreparedInstant { data, index, .. }| {
        overlay = data.overlay();
        let sums = sums.get_or_insert_with(|| start_sums(data));
        reference(frame, data).add(sums, index);
        rest -= 1;
        if rest > 0 {
            return NextInstants::Continue;
        }
        if !sums.next_round(policy) {
            return NextInstants::Stop;
        }
        let next = sums.instants();
        rest = next.len();
        NextInstants::Visit(next)
    })?;
    let RenderedImage { mut film, mut alpha, sample_counts: counts, .. } =
        sums.ok_or(Interrupted::Cancelled)?.resolve();
    if let Some(overlay) = overlay {
        film.draw_over(&overlay);
        alpha.iter_mut().for_each(|alpha| alpha.draw_over(&overlay));
    }
    let sample_counts = counts.filter(|_| sample_counts);
    Ok(RenderedImage { film: film.encoded(encoding), alpha, passes: None, sample_counts })
}

/// Returns the ray tree of sample `index` of the pixel in column `i` and row `j`, by the reference path. `None` outside the film, and for a
/// sample that the pixel does not have.
///
/// # Errors
///
/// If the world cannot be advanced to the instant of the sample.
pub(crate) fn trace_sample(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    (i, j): (u32, u32),
    index: u32,
) -> Result<Option<RayTree>, Interrupted> {
    simulation.seek_sample(frame, index, Signals::none().cancelled)?;
    let Some(preparation) = &simulation.preparation else { return Ok(None) };
    let data = preparation.without(frame.settings.without);
    let (columns, rows) = data.camera().resolution();
    let exists = i < columns && j < rows && index < data.samples();
    Ok(exists.then(|| reference(frame, &data).sample(i, j, index)).flatten())
}

/// Returns the ray tree of any ray at a moment, by the reference path. The ray need not pass through a pixel.
///
/// # Errors
///
/// If the world cannot be advanced to the moment.
pub(crate) fn trace_ray(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    ray: PreparedRay,
) -> Result<Option<RayTree>, Interrupted> {
    simulation.advance_to(frame.time, frame, &mut FrameReport::default(), Signals::none().cancelled)?;
    let overridden = simulation.apply_settings(&frame.settings, &mut None);
    let Some(preparation) = simulation.preparation.as_ref().filter(|_| overridden.is_some()) else {
        return Ok(None);
    };
    Ok(Some(reference(frame, &preparation.without(frame.settings.without)).cast(ray)))
}

/// Returns the first hit of the ray through the centre of each pixel, row by row from the top, at the frame's first instant.
fn trace_passes(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    cancelled: &AtomicBool,
) -> Result<Film<PassPixel>, Interrupted> {
    let mut passes = None;
    simulation.visit(frame, vec![0], &mut FrameReport::default(), cancelled, |instant| {
        passes = instant.data.scene().passes(instant.data.camera(), cancelled);
        NextInstants::Stop
    })?;
    passes.ok_or(Interrupted::Cancelled)
}

/// Returns the reference renderer of an instant. It renders all effects that are enabled.
fn reference<'a>(frame: &FrameInstants, data: &'a Preparation) -> Reference<'a> {
    let effects = Effects { lighting: frame.lighting(), ..Effects::ALL };
    Reference::new(data.scene(), data.camera(), data.sampling(frame.time), effects)
}

/// Plans a frame without rendering it, and stores the plan and, if requested, the fingerprint in the report. Leaves the world at one of the
/// frame's instants.
///
/// # Errors
///
/// If the world cannot be advanced to an instant of the frame, or if the request is cancelled.
pub(crate) fn plan<E: Encoding>(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    request: &RenderRequest<'_, E>,
    policy: Option<&SharedRoundPolicy>,
    report: &mut FrameReport,
) -> Result<(), Interrupted> {
    let mut hashed = request.fingerprint.then(|| HashedInstants::new(frame));
    let former = request.reuse.as_deref().and_then(Option::as_ref).filter(|_| !request.reference);
    let mut compared = former.map(|former| TileReuse::new(request.encoding, request.alpha, Some(former)));
    simulation.visit(frame, frame.identifying_instants(), report, request.signals.cancelled, |instant| {
        if let Some(hashed) = &mut hashed {
            hashed.note(instant);
        }
        compare_instant(frame, &mut compared, instant);
        NextInstants::Continue
    })?;
    report.reused = compared.map_or(0.0, |compared| compared.share());
    report.fingerprint = hashed.map(|hashed| match policy {
        // No round has a least gain of 0, so this fingerprint matches no image whose rounds depended on a clock.
        Some(policy) => hashed.finish().with_rounds(round_policy::locked(policy).rounds().unwrap_or(&[0])),
        None => hashed.finish(),
    });
    Ok(())
}
