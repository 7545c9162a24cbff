//! The measurements as a table for the terminal.

use std::fmt::Write;

use rayreel::accuracy::{MedianRange, Parameter, Preset, Report, Row};
use rayreel::scene::Printable;

use super::super::report::in_millions;
use super::Measured;

/// Headings of the columns. That of estimates is shown only if it has values. Counts of instructions, which not every machine has, are left to
/// the JSON and CSV output: the table has the same columns on all machines.
const HEADS: [&str; 12] =
    ["", "setting", "s/frame", "x own", "spread", "rays", "max", "rms", ESTIMATED, "PSNR", "SSIM", "off > 1"];
const ESTIMATED: &str = "estimated";

pub(super) fn draw(measured: &Measured) -> String {
    let report = &measured.report;
    let mut text = format!("{}: {}\n", Printable(&measured.scene), describe_frames(measured));
    if let Some(changed) = measured.changed.describe() {
        let _ = writeln!(text, "{changed}");
    }
    let _ = writeln!(text, "{}", measured.machine.describe());
    let _ = writeln!(text, "{}\n", describe_reference(report));
    text += &rows(report);
    let _ = writeln!(text, "\n{}\nErrors are in steps of 8 bits.", notes(report, measured.preset).join("\n"));
    for (parameter, law) in &report.orders {
        let _ = writeln!(
            text,
            "The error falls as {}^{:.2} ± {:.2}.",
            symbol(*parameter),
            law.exponent,
            law.uncertainty
        );
    }
    for row in report.of_parameter(Parameter::Precision) {
        let _ = writeln!(text, "{}", describe_precision(row, report));
    }
    text
}

/// Returns the notes that explain the marks of settings.
pub(super) fn notes(report: &Report, preset: Preset) -> Vec<String> {
    let resolution = report.resolution;
    let mut notes = vec![format!(
        "* Pareto front: no other setting is cheaper and at least as good, or better and at least as cheap. Errors within {} rms count as \
         equal, and cheaper is what takes less time by more than {:.0} %: so far do measurements scatter. Settings with as many samples \
         in all pixels are compared by their rays instead, if those decide.",
        error(resolution.rms),
        100.0 * resolution.time
    )];
    if report.rows.iter().any(|row| row.same_as.is_some()) {
        notes.push(
            "= The same rays and picture as a setting above, so that its time is that one's.".to_owned(),
        );
    }
    let capped = || report.rows.iter().filter(|row| row.capped.is_some());
    if let Some(samples) = capped().find_map(|row| row.capped) {
        let missed = capped()
            .filter_map(|row| Some(format!("{} (estimated {})", row.subject, error(row.estimated?.value))));
        notes.push(format!(
            "^ Capped at {samples} samples per pixel, too few for the target, and so not on the front: {}.{}",
            missed.collect::<Vec<_>>().join(", "),
            if preset == Preset::QUICK { " Without --quick pixels get more." } else { "" }
        ));
    }
    if report.rounds < preset.rounds {
        notes.push(format!(
            "Interrupted: times are medians of {} rounds instead of {}.",
            report.rounds, preset.rounds
        ));
    }
    notes
}

/// Describes the number of pixels that a precision gets wrong.
pub(super) fn describe_precision(row: &Row, report: &Report) -> String {
    let pixels = f64::from(report.size.0) * f64::from(report.size.1);
    format!(
        "With {} formulas {:.0} of {pixels} pixels are wrong by more than a step.",
        row.subject,
        row.alone.share_off * pixels
    )
}

pub(super) fn describe_frames(measured: &Measured) -> String {
    let Report { frames, size: (width, height), .. } = &measured.report;
    let names: Vec<String> = frames.iter().map(u32::to_string).collect();
    let of = match (&names[..], measured.spread_over) {
        ([one], _) => format!("frame {one}"),
        (_, Some(all)) => format!("{} of {all} frames, spread evenly: {}", names.len(), names.join(", ")),
        (_, None) => format!("frames {}", names.join(", ")),
    };
    format!("{of}, {width}x{height}")
}

pub(super) fn describe_reference(report: &Report) -> String {
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

/// Returns a parameter's symbol in a formula.
fn symbol(parameter: Parameter) -> String {
    parameter.name().replace(' ', "_")
}

/// Returns the headings of the columns that are shown.
pub(super) fn heads(report: &Report) -> Vec<&'static str> {
    let is_shown = |head: &&str| match *head {
        ESTIMATED => report.rows.iter().any(|row| row.estimated.is_some()),
        _ => true,
    };
    HEADS.into_iter().filter(is_shown).collect()
}

fn rows(report: &Report) -> String {
    let heads = heads(report);
    let mut cells: Vec<Vec<String>> = vec![heads.iter().map(|head| (*head).to_owned()).collect()];
    let mut group = None;
    for row in &report.rows {
        let parameter = row.subject.parameter();
        if group.replace(parameter).is_some_and(|before| before != parameter) {
            cells.push(Vec::new());
        }
        cells.push(heads.iter().map(|head| cell(row, head)).collect());
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

/// Formats the cell of a row in the column with this heading.
pub(super) fn cell(row: &Row, head: &str) -> String {
    let mark = match row {
        Row { on_front: true, .. } => "*",
        Row { same_as: Some(_), .. } => "=",
        Row { capped: Some(_), .. } => "^",
        _ => "",
    };
    let estimated = |error_of: rayreel::trace::EstimatedError| {
        format!("{} ±{}", error(error_of.value), error(error_of.deviation))
    };
    match head {
        "" => mark.to_owned(),
        "setting" => row.subject.to_string(),
        "s/frame" => seconds(row.seconds.median),
        "x own" => format!("{:.2}", row.relative.median),
        "spread" => spread(&row.relative),
        "rays" => in_millions(row.rays.total() as f64),
        "max" => error(row.error.max),
        "rms" => error(row.error.rms),
        ESTIMATED => row.estimated.map_or_else(String::new, estimated),
        "PSNR" => decibels(row.error.psnr()),
        "SSIM" => format!("{:.4}", row.similarity),
        "off > 1" => percent(row.error.share_off),
        _ => error(row.alone.rms),
    }
}

/// Formats seconds, with more digits for small values.
pub(super) fn seconds(value: f64) -> String {
    if value < 0.01 { format!("{value:.5}") } else { format!("{value:.3}") }
}

/// Formats half of the distance between the extremes.
fn spread(MedianRange { low, high, .. }: &MedianRange) -> String {
    format!("±{:.2}", 0.5 * (high - low))
}

pub(super) fn error(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        small if small < 0.1 => format!("{small:.3}"),
        _ => format!("{value:.2}"),
    }
}

fn decibels(value: f64) -> String {
    if value.is_finite() { format!("{value:.1}") } else { "∞".to_owned() }
}

pub(super) fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use rayreel::RenderSettings;
    use rayreel::accuracy::{FilmError, ReferenceInfo, Resolution, Subject};
    use rayreel::trace::{EstimatedError, Film, RayCounts};

    fn row(subject: Subject, error: f64, samples: u64) -> Row {
        Row {
            subject,
            settings: RenderSettings::default(),
            error: FilmError { max: 10.0 * error, rms: error, share_off: 0.25 },
            similarity: 0.99,
            alone: FilmError::default(),
            seconds: MedianRange { median: 0.5, low: 0.25, high: 0.75 },
            relative: MedianRange { median: 1.0, low: 0.5, high: 1.5 },
            rays: RayCounts { camera: 1000 * samples, ..RayCounts::default() },
            instructions: Some(2.5e6),
            estimated: None,
            capped: None,
            same_as: None,
            on_front: false,
            film: None,
        }
    }

    fn report() -> Report {
        let estimated = Some(EstimatedError { value: 2.5, deviation: 0.125, hidden: 0.0 });
        let capped = |error| Row {
            estimated,
            capped: Some(32),
            ..row(Subject::Parameter(Parameter::MaxError, error), 2.5, 32)
        };
        let reference = ReferenceInfo {
            samples: 128,
            pictures: 4,
            rms: 0.5,
            max: 4.0,
            time: Duration::from_secs(1),
            film: Film::new(0, 0),
        };
        Report {
            frames: vec![0],
            size: (100, 10),
            reference,
            rows: vec![
                row(Subject::Own, 4.0, 8),
                Row { on_front: true, ..row(Subject::Parameter(Parameter::Samples, 4.0), 6.0, 4) },
                capped(0.25),
                Row { same_as: Some(2), ..capped(0.5) },
            ],
            resolution: Resolution { rms: 0.125, time: 0.04 },
            orders: Vec::new(),
            rounds: 4,
            own_samples: 8,
        }
    }

    #[test]
    fn rows_have_marks_with_a_legend() {
        let report = report();
        let expected = [
            "   setting          s/frame  x own  spread  rays    max   rms   estimated  PSNR    SSIM  off > 1",
            "   the scene's own    0.500   1.00   ±0.50   8 k  40.00  4.00              36.1  0.9900  25.00 %",
            "",
            "*  samples 4          0.500   1.00   ±0.50   4 k  60.00  6.00              32.6  0.9900  25.00 %",
            "",
            "^  max error 0.25     0.500   1.00   ±0.50  32 k  25.00  2.50  2.50 ±0.12  40.2  0.9900  25.00 %",
            "=  max error 0.5      0.500   1.00   ±0.50  32 k  25.00  2.50  2.50 ±0.12  40.2  0.9900  25.00 %",
        ];
        assert_eq!(rows(&report).lines().collect::<Vec<_>>(), expected);
        let [front, same, capped] = &notes(&report, Preset::QUICK)[..] else {
            panic!("three marks are explained")
        };
        assert_eq!(
            front,
            "* Pareto front: no other setting is cheaper and at least as good, or better and at least as cheap. \
             Errors within 0.12 rms count as equal, and cheaper is what takes less time by more than 4 %: so far do \
             measurements scatter. Settings with as many samples in all pixels are compared by their rays instead, \
             if those decide."
        );
        assert_eq!(same, "= The same rays and picture as a setting above, so that its time is that one's.");
        assert_eq!(
            capped,
            "^ Capped at 32 samples per pixel, too few for the target, and so not on the front: \
             max error 0.25 (estimated 2.50), max error 0.5 (estimated 2.50). Without --quick pixels get more."
        );
        let [_, _, capped, interrupted] = &notes(&report, Preset::THOROUGH)[..] else {
            panic!("one is added")
        };
        assert!(capped.ends_with("max error 0.5 (estimated 2.50)."));
        assert_eq!(interrupted, "Interrupted: times are medians of 4 rounds instead of 5.");
    }
}
