//! The measurements as a table for the terminal.

use std::fmt::Write;

use rayreel::accuracy::{Knob, Report, Row, Spread, Subject};
use rayreel::scene::Printable;

use super::super::report::in_millions;
use super::Measured;

/// The columns' heads. That of instructions is there where they are counted.
const HEADS: [&str; 12] = [
    "",
    "setting",
    "s/frame",
    "x own",
    "spread",
    "rays",
    INSTRUCTIONS,
    "max",
    "rms",
    "PSNR",
    "SSIM",
    "off > 1",
];
const INSTRUCTIONS: &str = "instr.";

pub(super) fn draw(measured: &Measured) -> String {
    let report = &measured.report;
    let mut text = format!("{}: {}\n", Printable(&measured.scene), frames_in_words(measured));
    if let Some(changed) = measured.changed.in_words() {
        let _ = writeln!(text, "{changed}");
    }
    let _ = writeln!(text, "{}", measured.machine.in_words());
    let _ = writeln!(text, "{}\n", reference_in_words(report));
    text += &rows(report);
    text += "\n* Pareto front: no other setting is both better and quicker. Errors are in steps of 8 bits.\n";
    for (knob, law) in &report.orders {
        let _ = writeln!(
            text,
            "The error falls as {}^{:.2} ± {:.2}.",
            symbol(*knob),
            law.exponent,
            law.uncertainty
        );
    }
    for row in report.of_knob(Knob::Precision) {
        let _ = writeln!(text, "{}", precision_in_words(row, report));
    }
    text
}

/// Says what numerical safety is worth.
pub(super) fn precision_in_words(row: &Row, report: &Report) -> String {
    let pixels = f64::from(report.size.0) * f64::from(report.size.1);
    format!(
        "With {} formulas {:.0} of {pixels} pixels are wrong by more than a step.",
        row.subject,
        row.alone.share_off * pixels
    )
}

pub(super) fn frames_in_words(measured: &Measured) -> String {
    let Report { frames, size: (width, height), .. } = &measured.report;
    let names: Vec<String> = frames.iter().map(u32::to_string).collect();
    let of = match (&names[..], measured.spread_over) {
        ([one], _) => format!("frame {one}"),
        (_, Some(all)) => format!("{} of {all} frames, spread evenly: {}", names.len(), names.join(", ")),
        (_, None) => format!("frames {}", names.join(", ")),
    };
    format!("{of}, {width}x{height}")
}

pub(super) fn reference_in_words(report: &Report) -> String {
    let reference = &report.reference;
    format!(
        "compared with {} samples per pixel, in {} pictures that took {:.1} s; uncertain by {:.3} rms, by {:.1} in any channel",
        reference.samples,
        reference.pictures,
        reference.time.as_secs_f64(),
        reference.rms,
        reference.max
    )
}

/// Returns a knob's letter in a formula.
fn symbol(knob: Knob) -> String {
    knob.name().replace(' ', "_")
}

fn rows(report: &Report) -> String {
    let counted = are_instructions_counted(report);
    let heads: Vec<&str> = HEADS.into_iter().filter(|head| counted || *head != INSTRUCTIONS).collect();
    let mut cells: Vec<Vec<String>> = vec![heads.iter().map(|head| (*head).to_owned()).collect()];
    let mut group = None;
    for row in &report.rows {
        if group.replace(kind(row)).is_some_and(|before| before != kind(row)) {
            cells.push(Vec::new());
        }
        cells.push(row_cells(row));
    }
    let width = |column: usize| {
        cells.iter().filter_map(|row| Some(row.get(column)?.chars().count())).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..heads.len()).map(width).collect();
    let mut text = String::new();
    for row in &cells {
        let mut line = String::new();
        for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
            let _ = match column {
                0 | 1 => write!(line, "{cell:<width$}  "),
                _ => write!(line, "{cell:>width$}  "),
            };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// Rows of a kind stand together.
fn kind(row: &Row) -> (Option<Knob>, bool) {
    (row.subject.knob(), matches!(row.subject, Subject::Without(_)))
}

fn row_cells(row: &Row) -> Vec<String> {
    let mut cells = vec![
        if row.on_front { "*" } else { "" }.to_owned(),
        row.subject.to_string(),
        format!("{:.3}", row.seconds.median),
        format!("{:.2}", row.relative.median),
        spread(&row.relative),
        in_millions(row.rays.total() as f64),
    ];
    cells.extend(row.instructions.map(in_millions));
    cells.extend([
        error(row.error.max),
        error(row.error.rms),
        decibels(row.error.psnr()),
        format!("{:.4}", row.similarity),
        percent(row.error.share_off),
    ]);
    cells
}

/// Returns whether the machine counts instructions.
pub(super) fn are_instructions_counted(report: &Report) -> bool {
    report.rows.iter().all(|row| row.instructions.is_some())
}

/// Writes the half of the distance between the extremes.
pub(super) fn spread(Spread { low, high, .. }: &Spread) -> String {
    format!("±{:.2}", 0.5 * (high - low))
}

pub(super) fn error(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        small if small < 0.1 => format!("{small:.3}"),
        _ => format!("{value:.2}"),
    }
}

pub(super) fn decibels(value: f64) -> String {
    if value.is_finite() { format!("{value:.1}") } else { "∞".to_owned() }
}

pub(super) fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}
