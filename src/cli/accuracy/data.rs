//! The measurements as JSON and CSV.

use anyhow::Context;
use serde_json::{Value, json};

use rayreel::accuracy::{FilmError, MedianRange, Parameter, Report, Row, Subject};

use super::Measured;

pub(super) fn json(measured: &Measured) -> Value {
    let report = &measured.report;
    let reference = &report.reference;
    let mut object = json!({
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
        "resolution": { "rms": report.resolution.rms, "time": report.resolution.time },
        "rows": report.rows.iter().map(|one| row(one, report)).collect::<Vec<_>>(),
        "orders": report.orders.iter().map(|(parameter, law)| json!({
            "knob": parameter.name(),
            "exponent": law.exponent,
            "uncertainty": law.uncertainty,
        })).collect::<Vec<_>>(),
    });
    measured.changed.add_to(&mut object);
    object
}

fn row(row: &Row, report: &Report) -> Value {
    let (parameter, value) = match row.subject {
        Subject::Parameter(parameter, value) => (Some(parameter.name()), Some(value)),
        Subject::Without(_) => (None, None),
        subject => (subject.parameter().map(Parameter::name), None),
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
        "knob": parameter,
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
        "error": error(&row.error, Some((row.similarity, report.rms_range(row)))),
        "alone": error(&row.alone, None),
        "estimated": row.estimated.map(|error| json!({ "value": error.value, "deviation": error.deviation })),
        "capped": row.capped,
        "share": without.map(|_| {
            let share = row.share();
            json!({ "median": share.median, "deviation": share.deviation, "clamped": share.is_clamped })
        }),
        "same_as": row.same_as.map(|other| report.rows[other].subject.to_string()),
        "pareto": row.on_front,
    })
}

fn spread(spread: &MedianRange) -> Value {
    json!({ "median": spread.median, "low": spread.low, "high": spread.high })
}

/// Returns an error as JSON. Equal films have no PSNR.
fn error(error: &FilmError, compared: Option<(f64, (f64, f64))>) -> Value {
    let psnr = Some(error.psnr()).filter(|psnr| psnr.is_finite());
    let mut object =
        json!({ "max": error.max, "rms": error.rms, "psnr": psnr, "share_off": error.share_off });
    if let Some((similarity, (low, high))) = compared {
        object["ssim"] = similarity.into();
        object["rms_low"] = low.into();
        object["rms_high"] = high.into();
    }
    object
}

/// Names of the CSV columns, and the JSON pointers to their values in a row or, failing that, in the report.
const COLUMNS: [(&str, &str); 40] = [
    ("scene", "/scene"),
    ("version", "/machine/rayreel"),
    ("width", "/width"),
    ("height", "/height"),
    ("rounds", "/rounds"),
    ("reference_rms_uncertainty", "/reference/rms_uncertainty"),
    ("reference_max_uncertainty", "/reference/max_uncertainty"),
    ("setting", "/setting"),
    ("seconds", "/seconds/median"),
    ("seconds_low", "/seconds/low"),
    ("seconds_high", "/seconds/high"),
    ("relative", "/relative/median"),
    ("relative_low", "/relative/low"),
    ("relative_high", "/relative/high"),
    ("camera_rays", "/rays/camera"),
    ("shadow_rays", "/rays/shadow"),
    ("reflection_rays", "/rays/reflection"),
    ("refraction_rays", "/rays/refraction"),
    ("instructions", "/instructions"),
    ("max", "/error/max"),
    ("rms", "/error/rms"),
    ("rms_low", "/error/rms_low"),
    ("rms_high", "/error/rms_high"),
    ("psnr", "/error/psnr"),
    ("ssim", "/error/ssim"),
    ("share_off", "/error/share_off"),
    ("alone_max", "/alone/max"),
    ("alone_rms", "/alone/rms"),
    ("alone_psnr", "/alone/psnr"),
    ("alone_share_off", "/alone/share_off"),
    ("estimated_error", "/estimated/value"),
    ("estimated_deviation", "/estimated/deviation"),
    ("capped", "/capped"),
    ("share", "/share/median"),
    ("share_deviation", "/share/deviation"),
    ("share_clamped", "/share/clamped"),
    ("same_as", "/same_as"),
    ("rms_resolution", "/resolution/rms"),
    ("time_resolution", "/resolution/time"),
    ("pareto", "/pareto"),
];

/// Returns the rows as CSV, with a header line.
pub(super) fn csv(measured: &Measured) -> anyhow::Result<Vec<u8>> {
    let report = json(measured);
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS.map(|(name, _)| name))?;
    for row in report["rows"].as_array().into_iter().flatten() {
        writer.write_record(COLUMNS.map(
            |(_, place)| match row.pointer(place).or(report.pointer(place)) {
                None | Some(Value::Null) => String::new(),
                Some(Value::String(text)) => text.clone(),
                Some(value) => value.to_string(),
            },
        ))?;
    }
    writer.into_inner().context("cannot write the table")
}
