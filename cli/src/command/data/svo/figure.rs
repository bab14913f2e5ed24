//! The figure: for each site, the orientations of those who went first, and how early each score tells who that is.

use crate::failure::Failure;
use cede_data::output;
use cede_sim::orientations::{BINS, Moment, Study};
use std::fmt::Write as _;
use std::path::Path;

/// Size of a chart, and its margins, as the report's.
const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 220.0;
const LEFT: f64 = 46.0;
const RIGHT: f64 = 10.0;
const TOP: f64 = 46.0;
const BOTTOM: f64 = 36.0;
/// Height of the legend above the charts.
const LEGEND: f64 = 34.0;

/// The report's colours, in light and in dark.
const STYLE: &str = "\
svg{background:#fcfcfb;color:#1c1917}text{fill:#6b6763}.title{fill:#1c1917;font-weight:600}\
.grid{stroke:#e3e0dc}.bar{fill:#2563eb}.s0,.s1,.s2,.s3,.s4{fill:none;stroke-width:1.8}\
.s0{stroke:#2563eb}.s1{stroke:#d97706}.s2{stroke:#059669}.s3{stroke:#db2777}.s4{stroke:#7c3aed}\
@media(prefers-color-scheme:dark){svg{background:#16171a}text{fill:#9b9ba3}.title{fill:#ececec}\
.grid{stroke:#313238}.bar{fill:#6ea0ff}\
.s0{stroke:#6ea0ff}.s1{stroke:#f0a033}.s2{stroke:#34c98f}.s3{stroke:#f472b6}.s4{stroke:#a78bfa}}";

type Score = fn(&Moment) -> Option<f64>;

/// What the lines are.
const LINES: [(&str, Score); 5] = [
    ("SVO", |m| m.svo),
    ("speeds", |m| m.speeds),
    ("distances", |m| m.distances),
    ("own arrival", |m| m.own_arrival),
    ("estimated orientations", |m| m.estimated),
];

/// Writes the figure to `path`.
pub(super) fn write(path: &Path, studies: &[Study]) -> Result<(), Failure> {
    let svg = svg(studies);
    output::write(path, |out| out.write_all(svg.as_bytes()))?;
    Ok(())
}

fn svg(studies: &[Study]) -> String {
    let (width, height) = (2.0 * WIDTH, LEGEND + HEIGHT * studies.len() as f64);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"system-ui, sans-serif\" font-size=\"12\" role=\"img\" \
         aria-label=\"Social value orientation of those who went first, and how early it tells who that is\">\n\
         <style>{STYLE}</style>\n"
    );
    legend(&mut svg);
    for (row, study) in studies.iter().enumerate() {
        let top = LEGEND + HEIGHT * row as f64;
        for (column, chart) in [histogram as fn(&mut String, &Study), curves]
            .iter()
            .enumerate()
        {
            let _ = writeln!(
                svg,
                "<g transform=\"translate({} {top})\">",
                WIDTH * column as f64
            );
            chart(&mut svg, study);
            svg.push_str("</g>\n");
        }
    }
    svg + "</svg>\n"
}

fn legend(svg: &mut String) {
    let mut x = WIDTH + LEFT;
    for (i, (name, _)) in LINES.iter().enumerate() {
        let _ = writeln!(
            svg,
            "<path class=\"s{i}\" d=\"M{x} 20h16\"/><text x=\"{}\" y=\"24\">{name}</text>",
            x + 21.0
        );
        x += 34.0 + 6.0 * name.len() as f64;
    }
}

/// One chart: places of values, with both axes from `low` to `high`.
struct Axes {
    x: [f64; 2],
    y: [f64; 2],
}

impl Axes {
    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        (
            LEFT + share(x, self.x) * (WIDTH - LEFT - RIGHT),
            HEIGHT - BOTTOM - share(y, self.y) * (HEIGHT - TOP - BOTTOM),
        )
    }

    /// Title, grid and labels.
    fn draw(&self, svg: &mut String, title: &str, labels: [&str; 2], xs: &[f64], ys: &[f64]) {
        let [across, up] = labels;
        let _ = writeln!(
            svg,
            "<text class=\"title\" x=\"{LEFT}\" y=\"18\">{title}</text>\
             <text x=\"6\" y=\"36\">{up}</text>\
             <text x=\"{}\" y=\"{}\" text-anchor=\"end\">{across}</text>",
            WIDTH - RIGHT,
            HEIGHT - 5.0
        );
        for &y in ys {
            let (x0, at) = self.at(self.x[0], y);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{x0} {at:.1}H{}\"/>\
                 <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{y}</text>",
                WIDTH - RIGHT,
                x0 - 7.0,
                at + 4.0
            );
        }
        for &x in xs {
            let (at, y0) = self.at(x, self.y[0]);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {y0:.1}v4\"/>\
                 <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{x}</text>",
                y0 + 17.0
            );
        }
    }
}

fn histogram(svg: &mut String, study: &Study) {
    let counts = &study.drivers.histogram;
    let percent = |count: usize| 100.0 * count as f64 / study.drivers.first.n.max(1) as f64;
    let highest = counts
        .iter()
        .map(|&count| percent(count))
        .fold(0.0, f64::max);
    let top = 10.0 * (highest / 10.0).ceil().max(1.0);
    let axes = Axes {
        x: [0.0, 90.0],
        y: [0.0, top],
    };
    let title = format!(
        "{}: who went first, n = {}",
        study.site, study.drivers.first.n
    );
    axes.draw(
        svg,
        &title,
        ["mean SVO until the conflict, °", "%"],
        &[0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0],
        &[0.0, 0.5 * top, top],
    );
    let wide = 90.0 / BINS as f64;
    for (bin, &count) in counts.iter().enumerate() {
        let (x0, y1) = axes.at(wide * bin as f64, percent(count));
        let (x1, y0) = axes.at(wide * (bin + 1) as f64, 0.0);
        let _ = writeln!(
            svg,
            "<rect class=\"bar\" x=\"{:.1}\" y=\"{y1:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
            x0 + 1.0,
            x1 - x0 - 2.0,
            y0 - y1
        );
    }
}

fn curves(svg: &mut String, study: &Study) {
    let axes = Axes {
        x: [6.0, 0.0],
        y: [0.2, 1.0],
    };
    let title = format!("{}: who goes first", study.site);
    axes.draw(
        svg,
        &title,
        ["seconds before the conflict", "area under the curve"],
        &[6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0],
        &[0.2, 0.4, 0.5, 0.6, 0.8, 1.0],
    );
    for (i, (_, score)) in LINES.iter().enumerate() {
        let points = study
            .first
            .iter()
            .filter_map(|moment| Some((moment.before_s, score(moment)?)));
        let mut path = String::new();
        for (x, y) in points {
            let (x, y) = axes.at(x, y.max(0.2));
            let _ = write!(
                path,
                "{}{x:.1} {y:.1}",
                if path.is_empty() { "M" } else { "L" }
            );
        }
        let _ = writeln!(svg, "<path class=\"s{i}\" d=\"{path}\"/>");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cede_controller::Policy;
    use cede_controller::policy::embedded;
    use cede_data::Dataset;

    #[test]
    fn the_figure_has_both_charts_of_every_site() {
        let dataset = Dataset::synthetic(60, 1);
        let policy = Policy::new(embedded::words()).unwrap();
        let study = Study::of(&dataset, &policy);
        let svg = svg(&[study.clone(), study]);
        assert_eq!(svg.matches("class=\"bar\"").count(), 2 * BINS);
        assert_eq!(svg.matches("class=\"s").count(), 3 * LINES.len());
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
