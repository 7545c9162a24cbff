//! The measurements as a self-contained HTML page.

use std::fmt::Write;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;

use rayreel::accuracy::{Parameter, PowerLaw, Report, Row, Subject};
use rayreel::color::Transfer;
use rayreel::output::encode_quickly;
use rayreel::trace::Film;

use super::super::report::in_millions;
use super::Measured;
use super::bars::{self, Bar};
use super::chart::{Chart, ChartMark, Form, Layout, Series};
use super::table::{
    self, cell, describe_frames, describe_precision, describe_reference, error, notes, percent, seconds,
};
use rayreel::drawing::escaped;

const STYLE: &str = include_str!("page.css");
/// Brightness factor of difference pictures.
const BRIGHTER: f64 = 8.0;

/// Returns the HTML page.
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
    page += "<p class=\"dim\">Stars, joined by the dashed line, are the Pareto front. Rings have missed their target. Bars are from the \
             quickest to the slowest of all rounds. Along the dotted line errors fall as n<sup>-1/2</sup>. In the grey area the \
             reference is no better than the picture. Settings that trace the same rays are drawn once.</p>\n";
    page += &table(measured);
    page += &effects(report, transfer)?;
    page += &parameter_charts(report);
    method(&mut page, measured);
    page += "</body>\n</html>\n";
    Ok(page)
}

fn head(page: &mut String, measured: &Measured) {
    let mut line = |text: &str| {
        let _ = writeln!(page, "<p class=\"dim\">{}</p>", escaped(text));
    };
    line(&describe_frames(measured));
    if let Some(changed) = measured.changed.describe() {
        line(&changed);
    }
    line(&measured.machine.describe());
}

/// Returns the figures of the scene's own picture, the reference and their difference.
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
    let bytes = STANDARD.encode(encode_quickly(film, transfer)?);
    let caption = escaped(caption);
    Ok(format!(
        "<figure><img src=\"data:image/png;base64,{bytes}\" alt=\"{caption}\"><figcaption>{caption}</figcaption></figure>\n"
    ))
}

/// Returns the absolute difference of the output values of two films, multiplied by `times`.
fn difference(film: &Film, other: &Film, transfer: Transfer, times: f64) -> Film {
    let pixels = film.pixels().iter().zip(other.pixels()).map(|(pixel, other)| {
        let [values, others] = [*pixel, *other].map(|pixel| DVec3::from(transfer.encode_unrounded(pixel)));
        ((values - others).abs() * times / 255.0).as_vec3()
    });
    Film::from_pixels(film.width(), film.height(), pixels)
}

/// Returns the chart of all settings by time and error.
fn overview(report: &Report) -> Chart<'_> {
    let mark = |row: &Row| ChartMark {
        x: row.seconds.median,
        y: row.error.rms.max(LEAST),
        reach: Some((row.seconds.low, row.seconds.high)),
        form: match row {
            Row { on_front: true, .. } => Form::Star,
            Row { capped: Some(_), .. } => Form::Ring,
            _ => Form::Disc,
        },
        title: format!(
            "{}: {} s, rms {}, max {}",
            row.subject,
            seconds(row.seconds.median),
            error(row.error.rms),
            error(row.error.max)
        ),
        label: match row.subject {
            Subject::Own => Some("own".to_owned()),
            subject if row.on_front => Some(subject.to_string()),
            Subject::Parameter(Parameter::Samples | Parameter::MaxError, value) => Some(value.to_string()),
            _ => None,
        },
    };
    let marks = |rows: &mut dyn Iterator<Item = &Row>| -> Vec<ChartMark> {
        rows.filter(|row| row.same_as.is_none()).map(mark).collect()
    };
    let own = Series {
        name: "the scene's own".to_owned(),
        marks: marks(&mut std::iter::once(report.own())),
        joined: false,
    };
    let settings = Parameter::ALL.into_iter().filter(|parameter| *parameter != Parameter::Effects);
    let parameters = settings.map(|parameter| Series {
        name: parameter.name().to_owned(),
        marks: marks(&mut report.of_parameter(parameter)),
        joined: parameter != Parameter::Precision,
    });
    let series = std::iter::once(own).chain(parameters).filter(|series| !series.marks.is_empty()).collect();
    let mut front: Vec<[f64; 2]> = report
        .rows
        .iter()
        .filter(|row| row.on_front)
        .map(|row| [row.seconds.median, row.error.rms.max(LEAST)])
        .collect();
    front.sort_by(|one, other| one[0].total_cmp(&other[0]));
    Chart {
        title: "Error against time",
        x: "seconds a frame",
        y: "rms error, steps of 8 bits",
        series,
        lines: vec![front],
        guide: Some([report.own().seconds.median, report.own().error.rms.max(LEAST)]),
        floor: Some(report.reference.rms),
        layout: Layout::WIDE,
    }
}

/// Error that is drawn for an error of 0, which has no logarithm.
const LEAST: f64 = 1e-4;

fn table(measured: &Measured) -> String {
    const ALONE: &str = "alone, rms";
    let report = &measured.report;
    let heads: Vec<&str> = table::heads(report).into_iter().chain([ALONE]).collect();
    let line = |tag: &str, class: &str, cells: &mut dyn Iterator<Item = String>| {
        let cells: String = cells.map(|cell| format!("<{tag}>{}</{tag}>", escaped(&cell))).collect();
        format!("<tr{class}>{cells}</tr>\n")
    };
    let mut table = "<h2>Settings</h2>\n<div class=\"wide\"><table class=\"settings\">\n".to_owned();
    table += &line("th", "", &mut heads.iter().map(|head| (*head).to_owned()));
    for row in report.rows.iter().filter(|row| !matches!(row.subject, Subject::Without(_))) {
        let class = if row.on_front { " class=\"front\"" } else { "" };
        table += &line("td", class, &mut heads.iter().map(|head| cell(row, head).replace('*', "★")));
    }
    let precisions: Vec<String> =
        report.of_parameter(Parameter::Precision).map(|row| describe_precision(row, report)).collect();
    let _ = writeln!(table, "</table></div>\n<p>{}</p>", escaped(&precisions.join(" ")));
    for line in notes(report, measured.preset) {
        let _ = writeln!(table, "<p class=\"dim\">{}</p>", escaped(&line.replacen('*', "★", 1)));
    }
    table
        + "<p class=\"dim\">Errors are in steps of 8 bits. Alone: the error due to this parameter only.</p>\n"
}

/// Returns the section on the cost and the worth of each effect.
fn effects(report: &Report, transfer: Transfer) -> anyhow::Result<String> {
    if report.of_parameter(Parameter::Effects).next().is_none() {
        return Ok(String::new());
    }
    let own = report.own();
    let mut bars = Vec::new();
    let mut text =
        "<div class=\"wide\"><table>\n<tr><th>effect</th><th>share of the time</th><th>±</th><th>rays</th>\
                    <th>without it: max</th><th>rms</th><th>off &gt; 1</th></tr>\n"
            .to_owned();
    let mut figures = String::new();
    for row in report.of_parameter(Parameter::Effects) {
        let Subject::Without(effect) = row.subject else { continue };
        let share = row.share();
        // A clamped share of 0 means that the effect takes less time than measurements scatter.
        let price = format!("{}{}", percent(share.median), if share.is_clamped { " †" } else { "" });
        bars.push(Bar {
            name: effect.name().to_owned(),
            share: share.median,
            deviation: share.deviation,
            share_text: price.clone(),
            error: row.alone.rms,
            error_text: error(row.alone.rms),
        });
        let saved = own.rays.total() as f64 - row.rays.total() as f64;
        let cells = [
            effect.name().to_owned(),
            price,
            percent(share.deviation),
            if saved <= -500.0 { format!("-{}", in_millions(-saved)) } else { in_millions(saved.max(0.0)) },
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
    let mark = if bars.iter().any(|bar| bar.share_text.ends_with('†')) { CLAMPED } else { "" };
    let _ = writeln!(text, "</table></div>\n{mark}<div class=\"pictures\">\n{figures}</div>");
    Ok(format!("<h2>Effects</h2>\n{}{text}", bars::svg(&mut bars)))
}

/// Explanation of the mark of clamped shares.
const CLAMPED: &str =
    "<p class=\"dim\">† less than times scatter: without it frames took no less time.</p>\n";

/// Returns the section with a chart of the error for each parameter.
fn parameter_charts(report: &Report) -> String {
    let mut text = String::new();
    for parameter in Parameter::ALL.into_iter().filter(|parameter| *parameter != Parameter::Precision) {
        let marks: Vec<ChartMark> = report
            .of_parameter(parameter)
            .filter_map(|row| match row.subject {
                Subject::Parameter(_, value) if value > 0.0 => Some(ChartMark {
                    x: value,
                    y: row.alone.rms.max(LEAST),
                    reach: None,
                    form: if row.capped.is_some() { Form::Ring } else { Form::Disc },
                    title: format!(
                        "{}: rms {}, {} s",
                        row.subject,
                        error(row.alone.rms),
                        seconds(row.seconds.median)
                    ),
                    label: None,
                }),
                _ => None,
            })
            .collect();
        if marks.len() < 2 {
            continue;
        }
        let law = report.orders.iter().find(|(of, _)| *of == parameter).map(|(_, law)| law);
        let line = |law: &PowerLaw| {
            let at = |mark: Option<&ChartMark>| mark.map(|mark| [mark.x, law.at(mark.x)]);
            at(marks.first()).into_iter().chain(at(marks.last())).collect::<Vec<_>>()
        };
        let caption = law.map_or_else(String::new, |law| {
            format!(": the error falls as n<sup>{:.2} ± {:.2}</sup>", law.exponent, law.uncertainty)
        });
        let guide = marks.first().filter(|_| parameter.converges()).map(|mark| [mark.x, mark.y]);
        let chart = Chart {
            title: parameter.name(),
            x: parameter.name(),
            y: "rms error due to it",
            lines: law.map(line).into_iter().collect(),
            guide,
            series: vec![Series { name: String::new(), marks, joined: true }],
            floor: matches!(parameter, Parameter::Samples | Parameter::MaxError)
                .then_some(report.reference.rms),
            layout: Layout::NARROW,
        };
        let _ = writeln!(
            text,
            "<figure>{}<figcaption>{}{caption}</figcaption></figure>",
            chart.svg(),
            parameter.name()
        );
    }
    if text.is_empty() {
        return text;
    }
    format!(
        "<h2>Parameters</h2>\n<div class=\"charts\">\n{text}</div>\n<p class=\"dim\">No error at all is drawn as 1e-4.</p>\n"
    )
}

fn method(page: &mut String, measured: &Measured) {
    let report = &measured.report;
    let _ = writeln!(
        page,
        "<h2>How it was measured</h2>\n<p>Every setting was rendered {} times, all in turns; × own is the median of the time as a multiple \
         of that of the scene's own settings, rendered right before and after, and times are that multiple of the scene's own median. Pictures were {}: twice the standard error of \
         the mean of those pictures, whose samples are independent. Smooth pictures converge as n<sup>-1.5</sup>, edges as n<sup>-0.75</sup>, and what \
         is sampled in more dimensions, as soft shadows, between that and n<sup>-0.5</sup>.</p>",
        report.rounds,
        escaped(&describe_reference(report))
    );
}
