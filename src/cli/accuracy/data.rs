//! The measurements for other programs.

use anyhow::Context;
use serde_json::{Value, json};

use rayreel::accuracy::{FilmError, Knob, Report, Row, Spread, Subject};

use super::Measured;

pub(super) fn json(measured: &Measured) -> Value {
    let report = &measured.report;
    let reference = &report.reference;
    let mut told = json!({
        "scene": measured.scene,
        "machine": measured.machine.json(),
        "frames": report.frames,
        "spread_over": measured.spread_over,
        "width": report.size.0,
        "height": report.size.1,
        "rounds": report.rounds,
        "reference": {
            "samples": reference.samples,
            "pictures": reference.pictures,
            "rms_uncertainty": reference.rms,
            "max_uncertainty": reference.max,
            "seconds": reference.time.as_secs_f64(),
        },
        "rows": report.rows.iter().map(row).collect::<Vec<_>>(),
        "orders": report.orders.iter().map(|(knob, law)| json!({
            "knob": knob.name(),
            "exponent": law.exponent,
            "uncertainty": law.uncertainty,
        })).collect::<Vec<_>>(),
    });
    measured.changed.tell(&mut told);
    told
}

fn row(row: &Row) -> Value {
    let (knob, value) = match row.subject {
        Subject::Knob(knob, value) => (Some(knob.name()), Some(value)),
        subject => (subject.knob().map(Knob::name), None),
    };
    let size = match row.subject {
        Subject::Size(width, height) => Some([width, height]),
        _ => None,
    };
    let without = match row.subject {
        Subject::Without(effect) => Some(effect.name()),
        _ => None,
    };
    json!({
        "setting": row.subject.to_string(),
        "knob": knob,
        "value": value,
        "size": size,
        "without": without,
        "seconds": spread(&row.seconds),
        "relative": spread(&row.relative),
        "rays": {
            "camera": row.rays.camera,
            "shadow": row.rays.shadow,
            "reflection": row.rays.reflection,
            "refraction": row.rays.refraction,
        },
        "instructions": row.instructions,
        "error": error(&row.error, Some(row.similarity)),
        "alone": error(&row.alone, None),
        "pareto": row.on_front,
    })
}

fn spread(spread: &Spread) -> Value {
    json!({ "median": spread.median, "low": spread.low, "high": spread.high })
}

/// Equal films have no PSNR.
fn error(error: &FilmError, similarity: Option<f64>) -> Value {
    let psnr = Some(error.psnr()).filter(|psnr| psnr.is_finite());
    let mut told = json!({ "max": error.max, "rms": error.rms, "psnr": psnr, "share_off": error.share_off });
    if let Some(similarity) = similarity {
        told["ssim"] = similarity.into();
    }
    told
}

/// Returns the rows as CSV, with a line of names.
pub(super) fn csv(report: &Report) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "setting",
        "seconds",
        "seconds_low",
        "seconds_high",
        "relative",
        "relative_low",
        "relative_high",
        "camera_rays",
        "shadow_rays",
        "reflection_rays",
        "refraction_rays",
        "instructions",
        "max",
        "rms",
        "psnr",
        "ssim",
        "share_off",
        "alone_max",
        "alone_rms",
        "pareto",
    ])?;
    for row in &report.rows {
        let numbers = [
            row.seconds.median,
            row.seconds.low,
            row.seconds.high,
            row.relative.median,
            row.relative.low,
            row.relative.high,
        ];
        let rays = [row.rays.camera, row.rays.shadow, row.rays.reflection, row.rays.refraction];
        let errors = [
            row.error.max,
            row.error.rms,
            row.error.psnr(),
            row.similarity,
            row.error.share_off,
            row.alone.max,
            row.alone.rms,
        ];
        let cells = numbers.iter().map(f64::to_string).chain(rays.iter().map(u64::to_string));
        let cells = cells.chain([row.instructions.map_or_else(String::new, |count| count.to_string())]);
        let cells = cells.chain(errors.iter().map(f64::to_string)).chain([row.on_front.to_string()]);
        writer.write_record(std::iter::once(row.subject.to_string()).chain(cells))?;
    }
    writer.into_inner().context("cannot write the table")
}
