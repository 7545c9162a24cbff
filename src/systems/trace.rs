//! The tracer system: queries the prepared world for closest hits and shadow rays, and writes the film.
//!
//! It runs last, at each instant of a frame ([`Simulation::visit`]): on all threads with the kernel's BVH, or, as the reference, on one
//! thread with a linear scan.

use std::ops::ControlFlow::Continue;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::fingerprint::HashedInstants;
use super::{
    FrameInstants, FrameReport, Interrupted, NextInstants, Preparation, PreparedInstant, RenderRequest,
    Simulation,
};
use crate::color::Encoding;
use crate::trace::reference::{RayTree, Reference, ReferenceSums};
use crate::trace::{
    Effects, FrameFingerprint, PassPixel, RenderJob, RenderedImage, SampleMemory, SharedRoundPolicy, Signals,
    round_policy,
};

/// The state of sampling that is kept from image to image.
#[derive(Default)]
pub(crate) struct Sampler {
    /// The policy that chooses the samples of each round. `None` uses the error target alone.
    pub(crate) policy: Option<SharedRoundPolicy>,
    /// The sample buffers of the last image.
    pub(crate) memory: SampleMemory,
}

/// Renders a frame, and reports its costs.
///
/// # Errors
///
/// If the world cannot be advanced to an instant of the frame, or if rendering is cancelled or stopped at a pause.
pub(crate) fn trace<E: Encoding>(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    request: RenderRequest<'_, E>,
    sampler: &mut Sampler,
    report: &mut FrameReport,
) -> Result<RenderedImage<E::Pixel>, Interrupted> {
    let RenderRequest { encoding, alpha, fingerprint, signals, on_pause, resume, .. } = request;
    let (mut own_job, mut own_visit) = (None, |_: &RenderJob<E>| Continue(()));
    let job = resume.unwrap_or(&mut own_job);
    let on_pause = on_pause.unwrap_or(&mut own_visit);
    let mut memory = std::mem::take(&mut sampler.memory);
    let mut start_job = |data: &Preparation| {
        let plan = frame.sample_plan(data, alpha);
        RenderJob::encoded(encoding, data.camera().resolution(), plan, std::mem::take(&mut memory))
    };
    let mut hashed = fingerprint.then(|| HashedInstants::new(frame));
    let is_fresh = job.is_none();
    let first = job.as_ref().map_or_else(|| frame.first_instants(), RenderJob::instants);
    let identifying = frame.identifying_instants();
    // With an open shutter, the first round visits few instants. The others are searched too, since shapes may be visible only there.
    if identifying != first && (is_fresh || fingerprint) {
        simulation.visit(frame, identifying, report, signals.cancelled, |instant| {
            if let Some(hashed) = &mut hashed {
                hashed.note(instant);
            }
            let job = job.get_or_insert_with(|| start_job(instant.data));
            if is_fresh {
                job.search(instant.data.scene(), instant.data.camera(), signals.cancelled);
            }
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
        let job = job.get_or_insert_with(|| start_job(data));
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
            true if job.next_round(sampler.policy.as_ref()) => NextInstants::Visit(job.instants()),
            true => NextInstants::Stop,
        };
        traced += start.elapsed();
        next
    });
    report.prepare += hashing;
    report.trace = traced;
    visited?;
    let job = job.take_if(|_| is_complete).ok_or(Interrupted::Cancelled)?;
    report.rounds = job.rounds().to_vec();
    report.error = job.estimated_error();
    let start = Instant::now();
    let (image, stats, memory) = job.finish();
    report.trace += start.elapsed();
    (report.rays, report.ends, report.escalations) = (stats.rays, stats.ends, stats.escalations);
    report.fingerprint = hashed.map(|hashed| match &sampler.policy {
        Some(_) => hashed.finish().with_rounds(&report.rounds),
        None => hashed.finish(),
    });
    sampler.memory = memory;
    Ok(image)
}

/// Renders a frame by the reference path, which tests every ray against every shape. It is slow and single-threaded, and gives the same
/// bits.
///
/// # Errors
///
/// If the world cannot be advanced to an instant of the frame.
pub(crate) fn trace_reference(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    alpha: bool,
    policy: Option<&SharedRoundPolicy>,
    report: &mut FrameReport,
) -> Result<RenderedImage, Interrupted> {
    let mut sums = None;
    let start_sums =
        |data: &Preparation| ReferenceSums::new(data.camera().resolution(), frame.sample_plan(data, alpha));
    let (first, identifying) = (frame.first_instants(), frame.identifying_instants());
    let mut rest = first.len();
    if identifying != first {
        simulation.visit(
            frame,
            identifying,
            report,
            Signals::none().cancelled,
            |PreparedInstant { data, .. }| {
                reference(frame, data).search(sums.get_or_insert_with(|| start_sums(data)));
                NextInstants::Continue
            },
        )?;
    }
    simulation.visit(
        frame,
        first,
        report,
        Signals::none().cancelled,
        |PreparedInstant { data, index, .. }| {
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
        },
    )?;
    sums.map(|sums| sums.resolve()).ok_or(Interrupted::Cancelled)
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

/// Returns the first hit of the ray through the centre of each pixel, row by row from the top, at the frame's first instant. `None` if
/// `cancelled` became true.
///
/// # Errors
///
/// If the world cannot be advanced to the instant.
pub(crate) fn trace_passes(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    cancelled: &AtomicBool,
) -> Result<Option<Vec<PassPixel>>, Interrupted> {
    let mut passes = None;
    simulation.visit(frame, vec![0], &mut FrameReport::default(), cancelled, |instant| {
        passes = instant.data.scene().passes(instant.data.camera(), cancelled);
        NextInstants::Stop
    })?;
    Ok(passes)
}

/// Returns the reference renderer of an instant. It renders all effects that are enabled.
fn reference<'a>(frame: &FrameInstants, data: &'a Preparation) -> Reference<'a> {
    let effects = Effects { lighting: frame.lighting(), ..Effects::ALL };
    Reference::new(data.scene(), data.camera(), data.sampling(frame.time), effects)
}

/// Plans a frame without rendering it, and stores the plan in the report. Leaves the world at one of the frame's instants.
///
/// # Errors
///
/// If the world cannot be advanced to an instant of the frame.
pub(crate) fn plan(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    report: &mut FrameReport,
) -> Result<(), Interrupted> {
    let never = Signals::none().cancelled;
    simulation.visit(frame, frame.identifying_instants(), report, never, |_| NextInstants::Continue)
}

/// Returns the fingerprint of a frame without rendering it. Leaves the world at one of the frame's instants.
///
/// # Errors
///
/// If the world cannot be advanced to an instant of the frame.
pub(crate) fn fingerprint(
    simulation: &mut Simulation,
    frame: &FrameInstants,
    policy: Option<&SharedRoundPolicy>,
    report: &mut FrameReport,
) -> Result<FrameFingerprint, Interrupted> {
    let mut hashed = HashedInstants::new(frame);
    simulation.visit(frame, frame.identifying_instants(), report, Signals::none().cancelled, |instant| {
        hashed.note(instant);
        NextInstants::Continue
    })?;
    let fingerprint = hashed.finish();
    let Some(policy) = policy else { return Ok(fingerprint) };
    // No round has a least gain of 0, so this fingerprint matches no image whose rounds depended on a clock.
    Ok(fingerprint.with_rounds(round_policy::locked(policy).rounds().unwrap_or(&[0])))
}
