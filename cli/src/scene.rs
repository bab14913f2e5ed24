//! A drawing of a site from above: its map, the vehicles' tracks, and the conflict points.

use crate::plural::Count;
use cede_controller::ConflictKind;
use cede_data::lanelet::{Lanelet, LineKind, Map, Regulation, RegulationKind};
use cede_data::{Dataset, Manoeuvre};
use std::fmt::Write as _;

/// Pixels per metre.
const SCALE: f64 = 8.0;
/// Margin around the scene, m.
const MARGIN: f64 = 3.0;
/// Height of the legend below it, m.
const LEGEND: f64 = 11.0;
/// Without a map, as much of the tracks' traffic is drawn, m.
const WITHOUT_MAP: f64 = 1.0;

/// The meanings of the colours, in the order of the legend.
const MANOEUVRES: [(Manoeuvre, &str, &str); 4] = [
    (Manoeuvre::Left, "left", "#c2410c"),
    (Manoeuvre::Straight, "straight", "#1d4ed8"),
    (Manoeuvre::Right, "right", "#0f766e"),
    (Manoeuvre::Unknown, "other", "#71717a"),
];

/// The drawing, as SVG.
pub(crate) fn svg(dataset: &Dataset) -> String {
    let view = View::of(dataset);
    let mut svg = view.header();
    if let Some(map) = &dataset.map {
        lanes(&mut svg, &view, map);
        rights(&mut svg, &view, map);
    }
    tracks(&mut svg, &view, dataset);
    if let Some(map) = &dataset.map {
        arrows(&mut svg, &view, map);
    }
    conflict_points(&mut svg, &view, dataset);
    legend(&mut svg, &view, dataset);
    svg + "</svg>\n"
}

/// The visible part of the plane: metres, north up.
struct View {
    low: [f64; 2],
    high: [f64; 2],
}

impl View {
    fn of(dataset: &Dataset) -> Self {
        let of_map = dataset
            .map
            .iter()
            .flat_map(|map| map.lanelets.iter().flat_map(Lanelet::outline));
        let tracks = dataset.recordings.iter().flat_map(|r| &r.tracks);
        let of_tracks = tracks.flat_map(|t| t.states.iter().map(|s| [s.x, s.y]));
        let nothing = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let bounds = |points: &mut dyn Iterator<Item = [f64; 2]>| {
            points.fold(nothing, |(low, high), p| {
                (
                    [low[0].min(p[0]), low[1].min(p[1])],
                    [high[0].max(p[0]), high[1].max(p[1])],
                )
            })
        };
        let (mut low, mut high) = bounds(&mut of_tracks.into_iter());
        if dataset.map.is_some() {
            (low, high) = bounds(&mut of_map.into_iter());
        }
        if low[0] > high[0] {
            (low, high) = ([0.0; 2], [WITHOUT_MAP; 2]);
        }
        Self {
            low: low.map(|c| c - MARGIN),
            high: high.map(|c| c + MARGIN),
        }
    }

    fn size(&self) -> [f64; 2] {
        [
            (self.high[0] - self.low[0]) * SCALE,
            (self.high[1] - self.low[1]) * SCALE,
        ]
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.low[0]) * SCALE, (self.high[1] - y) * SCALE]
    }

    fn path(&self, points: impl IntoIterator<Item = [f64; 2]>) -> String {
        let mut path = String::new();
        for (i, point) in points.into_iter().enumerate() {
            let [x, y] = self.at(point);
            let _ = write!(path, "{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
        }
        path
    }

    fn header(&self) -> String {
        let [width, height] = self.size();
        let total = height + LEGEND * SCALE;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{total:.0}\" \
             viewBox=\"0 0 {width:.0} {total:.0}\" font-family=\"system-ui, sans-serif\" font-size=\"15\">\n\
             <clipPath id=\"view\"><rect width=\"{width:.0}\" height=\"{height:.0}\"/></clipPath>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fafaf9\"/>\n"
        )
    }
}

fn lanes(svg: &mut String, view: &View, map: &Map) {
    for lane in &map.lanelets {
        let path = view.path(lane.outline());
        let _ = writeln!(svg, "<path d=\"{path}Z\" fill=\"#e7e5e4\"/>");
    }
    for line in &map.lines {
        let path = view.path(line.points.iter().copied());
        let style = match line.kind {
            LineKind::Edge => "stroke=\"#78716c\" stroke-width=\"2\"",
            LineKind::Solid => "stroke=\"#ffffff\" stroke-width=\"1.6\"",
            LineKind::Dashed => {
                "stroke=\"#ffffff\" stroke-width=\"1.6\" stroke-dasharray=\"12 12\""
            }
            LineKind::Stop => "stroke=\"#dc2626\" stroke-width=\"3\"",
            LineKind::Crosswalk => "stroke=\"#ffffff\" stroke-width=\"1.6\"",
        };
        let _ = writeln!(svg, "<path d=\"{path}\" fill=\"none\" {style}/>");
    }
}

/// Colours of the lanes that have the right of way, that give way, and where everybody stops.
const FIRST: &str = "#86efac";
const YIELDING: &str = "#fca5a5";
const ALL_STOP: &str = "#fde047";

/// The lanes of all regulations.
fn rights(svg: &mut String, view: &View, map: &Map) {
    svg.push_str("<g fill-opacity=\"0.7\">\n");
    let lanes = |regulation: &Regulation| {
        let yielding = match regulation.kind {
            RegulationKind::AllWayStop => ALL_STOP,
            RegulationKind::RightOfWay => YIELDING,
        };
        let first = regulation
            .first
            .clone()
            .into_iter()
            .map(|lane| (lane, FIRST));
        let yielding = regulation
            .yielding
            .clone()
            .into_iter()
            .map(move |lane| (lane, yielding));
        first.chain(yielding).collect::<Vec<_>>()
    };
    for (lane, colour) in map.regulations.iter().flat_map(lanes) {
        let path = view.path(map.lanelets[lane].outline());
        let _ = writeln!(svg, "<path d=\"{path}Z\" fill=\"{colour}\"/>");
    }
    svg.push_str("</g>\n");
}

/// An arrow from each lane that gives way to each that it gives way to; broken where no sign says so.
fn arrows(svg: &mut String, view: &View, map: &Map) {
    svg.push_str(
        "<marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"8\" \
         markerHeight=\"8\" orient=\"auto\"><path d=\"M0 0L8 4L0 8Z\" fill=\"#b91c1c\"/></marker>\n",
    );
    for regulation in &map.regulations {
        for (yielding, first) in regulation.pairs() {
            let [from, to] = [yielding, first].map(|lane| map.lanelets[lane].middle());
            let path = view.path([from, to]);
            let dash = if regulation.sign.is_some() {
                ""
            } else {
                " stroke-dasharray=\"5 4\""
            };
            let _ = writeln!(
                svg,
                "<path d=\"{path}\" stroke=\"#b91c1c\" stroke-width=\"1.3\" marker-end=\"url(#tip)\"{dash}/>"
            );
        }
    }
}

fn tracks(svg: &mut String, view: &View, dataset: &Dataset) {
    for (manoeuvre, _, colour) in MANOEUVRES {
        let _ = writeln!(
            svg,
            "<g clip-path=\"url(#view)\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.2\" stroke-opacity=\"0.35\">"
        );
        let all = dataset.recordings.iter().flat_map(|r| &r.tracks);
        for track in all.filter(|track| dataset.site.manoeuvre(track) == manoeuvre) {
            // Five states per second are enough at this scale.
            let path = view.path(track.states.iter().step_by(2).map(|s| [s.x, s.y]));
            let _ = writeln!(svg, "<path d=\"{path}\"/>");
        }
        svg.push_str("</g>\n");
    }
}

fn conflict_points(svg: &mut String, view: &View, dataset: &Dataset) {
    for encounter in &dataset.encounters {
        let point = encounter.conflict_point;
        let [x, y] = view.at([f64::from(point.x), f64::from(point.y)]);
        let fill = if encounter.kind == ConflictKind::Crossing {
            "#18181b"
        } else {
            "#facc15"
        };
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{fill}\" stroke=\"#ffffff\" stroke-width=\"0.8\"/>"
        );
    }
}

fn legend(svg: &mut String, view: &View, dataset: &Dataset) {
    let [width, top] = view.size();
    let (mut line, mut x) = (top + 0.25 * LEGEND * SCALE, MARGIN * SCALE);
    let mut entry = |mark: String, label: &str| {
        let wide = 50.0 + 8.0 * label.len() as f64;
        if x + wide > width && x > MARGIN * SCALE {
            (x, line) = (MARGIN * SCALE, line + 24.0);
        }
        let _ = writeln!(
            svg,
            "<g transform=\"translate({x:.0} {line:.0})\">{mark}<text x=\"30\" y=\"5\" fill=\"#27272a\">{label}</text></g>"
        );
        x += wide;
    };
    for (_, name, colour) in MANOEUVRES {
        entry(
            format!("<path d=\"M0 0H22\" stroke=\"{colour}\" stroke-width=\"3\"/>"),
            name,
        );
    }
    let dot =
        |fill: &str| format!("<circle cx=\"11\" r=\"5\" fill=\"{fill}\" stroke=\"#a1a1aa\"/>");
    entry(dot("#18181b"), "conflict point, crossing");
    entry(dot("#facc15"), "conflict point, merging");
    entry(
        "<path d=\"M0 0H22\" stroke=\"#dc2626\" stroke-width=\"3\"/>".to_owned(),
        "stop line",
    );
    if dataset
        .map
        .as_ref()
        .is_some_and(|map| !map.regulations.is_empty())
    {
        let lane =
            |fill: &str| format!("<rect y=\"-6\" width=\"22\" height=\"12\" fill=\"{fill}\"/>");
        entry(lane(FIRST), "right of way");
        entry(lane(YIELDING), "gives way along the arrow");
        entry(lane(ALL_STOP), "all-way stop");
    }
    let ten = 10.0 * SCALE;
    entry(
        format!("<path d=\"M0 -4v8M0 0h{ten:.0}m0 -4v8\" stroke=\"#27272a\"/>"),
        "",
    );
    let title = format!(
        "{}: {}, {}; the scale is 10 m",
        dataset.site.name,
        Count(dataset.encounters.len(), "encounter"),
        Count(dataset.recordings.len(), "recording")
    );
    let _ = writeln!(
        svg,
        "<text x=\"{:.0}\" y=\"{:.0}\" fill=\"#52525b\">{title}</text>",
        MARGIN * SCALE,
        line + 26.0
    );
}
