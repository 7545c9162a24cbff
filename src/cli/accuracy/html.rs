//! The measurements as a page that needs nothing else: for a paper, a lecture, or oneself.

use std::fmt::Write;

use rayreel::accuracy::{Knob, PowerLaw, Report, Row, Subject};
use rayreel::color::Transfer;
use rayreel::trace::Film;

use super::super::report::in_millions;
use super::Measured;
use super::chart::{Chart, Layout, Mark, Series, escaped};
use super::pictures::{address, difference};
use super::table::{
    are_instructions_counted, decibels, error, frames_in_words, percent, precision_in_words,
    reference_in_words, spread,
};

const STYLE: &str = include_str!("page.css");
/// How much brighter differences are shown than they are.
const BRIGHTER: f64 = 8.0;

/// Returns the page.
pub(super) fn page(measured: &Measured, transfer: Transfer) -> anyhow::Result<String> {
    let title = format!("What accuracy costs in {}", measured.scene);
    let report = &measured.report;
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n",
        title = escaped(&title)
    );
    head(&mut page, measured);
    page += &pictures(report, transfer)?;
    page += "<h2>Error against time</h2>\n";
    page += &overview(report).svg();
    page += "<p class=\"dim\">Bars are from the quickest to the slowest of all rounds; the dashed line is the Pareto front: \
             nothing else is both better and quicker. In the grey area the reference is no better than the picture.</p>\n";
    page += &table(report);
    page += &effects(report, transfer)?;
    page += &knobs(report);
    method(&mut page, measured);
    page += "</body>\n</html>\n";
    Ok(page)
}

fn head(page: &mut String, measured: &Measured) {
    let mut line = |text: &str| {
        let _ = writeln!(page, "<p class=\"dim\">{}</p>", escaped(text));
    };
    line(&frames_in_words(measured));
    if let Some(changed) = measured.changed.in_words() {
        line(&changed);
    }
    line(&measured.machine.in_words());
}

/// The picture as the scene has it, as it would be without error, and what is between them.
fn pictures(report: &Report, transfer: Transfer) -> anyhow::Result<String> {
    let own = report.own();
    let Some(film) = &own.film else { return Ok(String::new()) };
    let reference = &report.reference.film;
    let apart = difference(film, reference, transfer, BRIGHTER);
    Ok(format!(
        "<div class=\"pictures\">\n{}{}{}</div>\n",
        figure(
            film,
            transfer,
            &format!(
                "As the scene is: off by {} rms, {} at most",
                error(own.error.rms),
                error(own.error.max)
            )
        )?,
        figure(
            reference,
            transfer,
            &format!("The reference, with {} samples per pixel", report.reference.samples)
        )?,
        figure(&apart, Transfer::Classic, &format!("The difference, {BRIGHTER} times as bright"))?
    ))
}

fn figure(film: &Film, transfer: Transfer, caption: &str) -> anyhow::Result<String> {
    let (address, caption) = (address(film, transfer)?, escaped(caption));
    Ok(format!(
        "<figure><img src=\"{address}\" alt=\"{caption}\"><figcaption>{caption}</figcaption></figure>\n"
    ))
}

/// All settings by time and error.
fn overview(report: &Report) -> Chart<'_> {
    // Multiples of one time, since machines have slower and faster minutes.
    let usual = report.own().seconds.median;
    let mark = |row: &Row| Mark {
        x: usual * row.relative.median,
        y: row.error.rms.max(LEAST),
        reach: Some((usual * row.relative.low, usual * row.relative.high)),
        title: format!(
            "{}: {:.3} s, rms {}, max {}",
            row.subject,
            usual * row.relative.median,
            error(row.error.rms),
            error(row.error.max)
        ),
        label: match row.subject {
            Subject::Own => Some("own".to_owned()),
            Subject::Knob(Knob::Samples | Knob::MaxError, value) => Some(value.to_string()),
            _ => None,
        },
    };
    let own = Series { name: "the scene's own".to_owned(), marks: vec![mark(report.own())], joined: false };
    let knobs = Knob::ALL.into_iter().map(|knob| Series {
        name: knob.name().to_owned(),
        marks: report.of_knob(knob).map(mark).collect(),
        joined: knob != Knob::Precision,
    });
    let series = std::iter::once(own).chain(knobs).filter(|series| !series.marks.is_empty()).collect();
    let mut front: Vec<(f64, f64)> = report
        .rows
        .iter()
        .filter(|row| row.on_front)
        .map(|row| (usual * row.relative.median, row.error.rms.max(LEAST)))
        .collect();
    front.sort_by(|one, other| one.0.total_cmp(&other.0));
    Chart {
        title: "Error against time",
        x: "seconds a frame",
        y: "rms error, steps of 8 bits",
        series,
        lines: vec![front],
        floor: Some(report.reference.rms),
        layout: Layout::WIDE,
    }
}

/// What is drawn for no error at all, which has no logarithm.
const LEAST: f64 = 1e-4;

fn table(report: &Report) -> String {
    /// The place of the rays among the cells.
    const RAYS: usize = 4;
    let counted = are_instructions_counted(report);
    let instructions = if counted { "<th>instructions</th>" } else { "" };
    let mut table = format!(
        "<h2>Settings</h2>\n<div class=\"wide\"><table>\n<tr><th>setting</th><th>s / frame</th><th>× own</th><th>±</th>\
                     <th>rays</th>{instructions}<th>max</th><th>rms</th><th>PSNR, dB</th><th>SSIM</th><th>off &gt; 1</th><th>alone, rms</th></tr>\n"
    );
    for row in report.rows.iter().filter(|row| !matches!(row.subject, Subject::Without(_))) {
        let class = if row.on_front { " class=\"front\"" } else { "" };
        let mut cells = vec![
            escaped(&row.subject.to_string()),
            format!("{:.3}", row.seconds.median),
            format!("{:.2}", row.relative.median),
            spread(&row.relative).replace('±', ""),
            in_millions(row.rays.total() as f64),
            error(row.error.max),
            error(row.error.rms),
            decibels(row.error.psnr()),
            format!("{:.4}", row.similarity),
            percent(row.error.share_off),
            error(row.alone.rms),
        ];
        if let Some(count) = row.instructions.filter(|_| counted) {
            cells.insert(RAYS + 1, in_millions(count));
        }
        let _ = writeln!(table, "<tr{class}><td>{}</td></tr>", cells.join("</td><td>"));
    }
    let precisions: Vec<String> =
        report.of_knob(Knob::Precision).map(|row| precision_in_words(row, report)).collect();
    let _ = writeln!(table, "</table></div>\n<p>{}</p>", escaped(&precisions.join(" ")));
    table
        + "<p class=\"dim\">Errors are in steps of 8 bits, before they are rounded. ★ is the Pareto front: no other setting is both \
             better and quicker. Alone: what is due to this knob only.</p>\n"
}

/// The price and the worth of each effect.
fn effects(report: &Report, transfer: Transfer) -> anyhow::Result<String> {
    if report.without().next().is_none() {
        return Ok(String::new());
    }
    let own = report.own();
    let mut text = "<h2>Effects</h2>\n<div class=\"wide\"><table>\n<tr><th>effect</th><th>share of the time</th><th>±</th><th>rays</th>\
                    <th>without it: max</th><th>rms</th><th>off &gt; 1</th></tr>\n"
        .to_owned();
    let mut figures = String::new();
    for row in report.without() {
        let Subject::Without(effect) = row.subject else { continue };
        let saved = own.rays.total() as f64 - row.rays.total() as f64;
        let cells = [
            effect.name().to_owned(),
            percent(1.0 - row.relative.median),
            format!("{:.2} %", 50.0 * (row.relative.high - row.relative.low)),
            if saved < 0.0 { format!("-{}", in_millions(-saved)) } else { in_millions(saved) },
            error(row.alone.max),
            error(row.alone.rms),
            percent(row.alone.share_off),
        ];
        let _ = writeln!(text, "<tr><td>{}</td></tr>", cells.join("</td><td>"));
        if let (Some(film), Some(with)) = (&row.film, &own.film) {
            let apart = difference(film, with, transfer, 1.0);
            let _ = writeln!(
                figures,
                "<div class=\"pair\">{}{}</div>",
                figure(film, transfer, &format!("Without {effect}"))?,
                figure(&apart, Transfer::Classic, "What it adds or takes away")?
            );
        }
    }
    let _ = writeln!(text, "</table></div>\n<div class=\"pictures\">\n{figures}</div>");
    Ok(text)
}

/// Every knob's curve.
fn knobs(report: &Report) -> String {
    let mut text = "<h2>Knobs</h2>\n<div class=\"charts\">\n".to_owned();
    for knob in Knob::ALL.into_iter().filter(|knob| *knob != Knob::Precision) {
        let marks: Vec<Mark> = report
            .of_knob(knob)
            .filter_map(|row| match row.subject {
                Subject::Knob(_, value) if value > 0.0 => Some(Mark {
                    x: value,
                    y: row.alone.rms.max(LEAST),
                    reach: None,
                    title: format!(
                        "{}: rms {}, {:.3} s",
                        row.subject,
                        error(row.alone.rms),
                        row.seconds.median
                    ),
                    label: None,
                }),
                _ => None,
            })
            .collect();
        if marks.len() < 2 {
            continue;
        }
        let law = report.orders.iter().find(|(of, _)| *of == knob).map(|(_, law)| law);
        let line = |law: &PowerLaw| {
            let at = |mark: Option<&Mark>| mark.map(|mark| (mark.x, law.at(mark.x)));
            at(marks.first()).into_iter().chain(at(marks.last())).collect::<Vec<_>>()
        };
        let caption = law.map_or_else(String::new, |law| {
            format!(": the error falls as n<sup>{:.2} ± {:.2}</sup>", law.exponent, law.uncertainty)
        });
        let chart = Chart {
            title: knob.name(),
            x: knob.name(),
            y: "rms error due to it",
            lines: law.map(line).into_iter().collect(),
            series: vec![Series { name: String::new(), marks, joined: true }],
            floor: matches!(knob, Knob::Samples | Knob::MaxError).then_some(report.reference.rms),
            layout: Layout::NARROW,
        };
        let _ = writeln!(
            text,
            "<figure>{}<figcaption>{}{caption}</figcaption></figure>",
            chart.svg(),
            knob.name()
        );
    }
    text + "</div>\n"
}

fn method(page: &mut String, measured: &Measured) {
    let report = &measured.report;
    let _ = writeln!(
        page,
        "<h2>How it was measured</h2>\n<p>Every setting was rendered {} times, all in turns; times are medians, and × own is the time as a \
         multiple of that of the scene's own settings, rendered right before and after. Pictures were {}: twice the standard error of \
         the mean of those pictures, whose samples are independent. Smooth pictures converge as n<sup>-1.5</sup>, edges as n<sup>-0.75</sup>, and what \
         is sampled in more dimensions, as soft shadows, between that and n<sup>-0.5</sup>.</p>",
        report.rounds,
        escaped(&reference_in_words(report))
    );
}
