//! The needed effects and their costs, as a table.

use rayreel::Effect;

use super::super::report::in_millions;
use super::cost::Costs;
use super::timeline::PlannedTimeline;

/// Formats a table of the needed effects, with their costs if they were measured, followed by a table of the effects that are not needed.
pub(super) fn draw(timeline: &PlannedTimeline, costs: Option<&Costs>) -> String {
    let (mut needed, mut omitted) = (Vec::new(), Vec::new());
    for needs in timeline.effects() {
        for span in &needs.spans {
            let mut row =
                vec![needs.effect.name().to_owned(), span.describe(), span.need.reason().to_owned()];
            if span.need.is_needed() {
                row.extend(costs.map(|costs| cost_cells(needs.effect, costs)).unwrap_or_default());
                needed.push(row);
            } else {
                omitted.push(row);
            }
        }
    }
    let mut text = String::new();
    if !needed.is_empty() {
        let mut heads = vec!["needed", "frames", "why"];
        if costs.is_some() {
            heads.extend(["rays", "time", "max error", "rms error"]);
        }
        text += &columns(&heads, &needed);
    }
    if !omitted.is_empty() {
        text += "\n";
        text += &columns(&["omitted", "frames", "why"], &omitted);
    }
    text
}

fn cost_cells(effect: Effect, costs: &Costs) -> Vec<String> {
    let Some(cost) = costs.effect(effect) else { return Vec::new() };
    let share = cost.share();
    vec![
        signed(cost.rays),
        format!("{:.0} ±{:.0} %", 100.0 * share.median, 50.0 * (share.high - share.low)),
        format!("{:.1}", cost.error.max),
        format!("{:.2}", cost.error.rms),
    ]
}

/// Formats a saved count. Negative counts were spent.
fn signed(count: f64) -> String {
    match count {
        0.0 => "-".to_owned(),
        few if few.abs() < 1000.0 => format!("{few:.0}"),
        spent if spent < 0.0 => format!("-{}", in_millions(-spent)),
        saved => in_millions(saved),
    }
}

/// Formats a table. The first three columns hold words, aligned to the left; the others hold numbers, aligned to the right.
fn columns(heads: &[&str], rows: &[Vec<String>]) -> String {
    const WORDS: usize = 3;
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
        cells.chain([heads[column].len()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..heads.len()).map(width).collect();
    let line = |cells: Vec<&str>| {
        let cells = cells.iter().zip(&widths).enumerate().map(|(column, (cell, width))| {
            if column < WORDS { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        format!("{}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    };
    let mut text = line(heads.to_vec());
    for row in rows {
        text += &line(row.iter().map(String::as_str).collect());
    }
    text
}
