//! The table of `cede verify beyond` as a picture.

use super::Line;
use cede_sim::campaign::beyond::{Count, Temper};
use std::fmt::Write;

/// Widths (px) of the names of rows, and of the bars of one temper.
const NAMES: f64 = 236.0;
const BARS: f64 = 300.0;
/// Between the bars and what stands beside them, for the share in figures.
const FIGURES: f64 = 52.0;
/// Heights (px) of what stands above, of a row and of a bar in it.
const HEAD: f64 = 92.0;
const ROW: f64 = 24.0;
const BAR: f64 = 5.0;

/// Colours: without a guard, the plain rule, the shield.
const FILLS: [&str; 3] = ["#d0d5db", "#8c959f", "#1f6feb"];
const GUARDS: [&str; 3] = ["no guard", "plain rule", "shield"];

/// Shares of encounters that end in a collision: a row for each deviation, hostile others beside gentle ones, three bars
/// each.
pub(super) fn svg(lines: &[Line]) -> String {
    let tempers = [
        (Temper::Hostile, "hostile others"),
        (Temper::Gentle, "gentle others"),
    ];
    let rows = lines.len() / tempers.len();
    let width = NAMES + tempers.len() as f64 * (BARS + FIGURES) + 16.0;
    let height = HEAD + rows as f64 * ROW + 20.0;
    let most = lines.iter().flat_map(|line| line.counts).map(share);
    let most = most.fold(0.01, f64::max);
    let n = lines.first().map_or(0, |line| line.counts[2].encounters);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"#1f2328\">\
         <title>Collisions if one number of the contract does not hold</title>\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\
         <text x=\"16\" y=\"24\" font-size=\"15\" font-weight=\"600\">Collisions if one number of the contract does not hold</text>\
         <text x=\"16\" y=\"44\" fill=\"#57606a\">Share of {n} encounters of two vehicles, in %; the figure is the shield's</text>"
    );
    for (i, (guard, fill)) in GUARDS.iter().zip(FILLS).enumerate() {
        let x = NAMES + 110.0 * i as f64;
        let _ = write!(
            text,
            "<rect x=\"{x}\" y=\"55\" width=\"14\" height=\"8\" fill=\"{fill}\"/><text x=\"{}\" y=\"63\">{guard}</text>",
            x + 20.0
        );
    }
    for (column, (temper, title)) in tempers.into_iter().enumerate() {
        let left = NAMES + column as f64 * (BARS + FIGURES);
        let _ = write!(
            text,
            "<text x=\"{left}\" y=\"84\" font-weight=\"600\">{title}</text>"
        );
        for (row, line) in lines
            .iter()
            .filter(|line| line.temper == temper)
            .enumerate()
        {
            let top = HEAD + row as f64 * ROW;
            if column == 0 {
                let _ = write!(
                    text,
                    "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
                    NAMES - 12.0,
                    top + 12.0,
                    line.row.name
                );
            }
            bars(&mut text, line, [left, top], BARS / most);
        }
    }
    text.push_str("</svg>\n");
    text
}

/// The three bars of one row, `scale` px for a share of 1.
fn bars(text: &mut String, line: &Line, [left, top]: [f64; 2], scale: f64) {
    for (i, (count, fill)) in line.counts.into_iter().zip(FILLS).enumerate() {
        let (y, width) = (top + i as f64 * (BAR + 0.5), scale * share(count));
        let _ = write!(
            text,
            "<rect x=\"{left}\" y=\"{y}\" width=\"{width:.1}\" height=\"{BAR}\" fill=\"{fill}\"/>"
        );
    }
    let shielded = share(line.counts[2]);
    let longest = line.counts.map(share).into_iter().fold(0.0, f64::max);
    let figure = if shielded == 0.0 {
        "0".to_owned()
    } else {
        format!("{:.1}", 100.0 * shielded)
    };
    let _ = write!(
        text,
        "<text x=\"{:.1}\" y=\"{}\" fill=\"{}\">{figure}</text>",
        left + scale * longest + 6.0,
        top + 13.0,
        FILLS[2]
    );
}

fn share(count: Count) -> f64 {
    count.share().fraction().unwrap_or_default()
}
