//! A replay as a picture: on the left the map, on the right speeds over time.

use crate::scene::{CAR, CROSSING, LORRY, Replay, Scene, Step, WALKER};
use cede_controller::{Footprint, PathId, Pose};
use std::fmt::{Error, Write};

const WIDTH: f32 = 960.0;
const HEIGHT: f32 = 380.0;
/// Pixels of a metre on the map, whose middle is at `MIDDLE`.
const SCALE: f32 = 2.7;
const MIDDLE: [f32; 2] = [200.0, 215.0];
/// The chart, in pixels: left, top, right, bottom; and its ends in m/s.
const CHART: [f32; 4] = [440.0, 60.0, 940.0, 320.0];
const FASTEST: f32 = 14.0;

const ROAD: &str = "#c9c9c4";
const EGO: &str = "#1f6feb";
const SHIELD: &str = "#d1242f";
const OTHER: &str = "#57606a";

/// The picture as SVG.
pub(crate) fn of(scene: &Scene, replay: &Replay) -> Result<String, Error> {
    let mut svg = String::new();
    write!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13"><rect width="{WIDTH}" height="{HEIGHT}" fill="white"/><text x="16" y="24" font-size="15" font-weight="bold">{}</text>"#,
        scene.title
    )?;
    map(&mut svg, scene, replay)?;
    chart(&mut svg, &replay.steps)?;
    writeln!(
        svg,
        r#"<text x="16" y="{}">{}</text></svg>"#,
        HEIGHT - 14.0,
        replay.turning_point
    )?;
    Ok(svg)
}

fn map(svg: &mut String, scene: &Scene, replay: &Replay) -> Result<(), Error> {
    for path in (0..2).map(PathId::new) {
        let points = replay
            .junction
            .polyline(path)
            .map_or(&[][..], |line| line.points());
        write!(
            svg,
            r#"<polyline fill="none" stroke="{ROAD}" stroke-width="{}" points=""#,
            3.6 * SCALE
        )?;
        for point in points {
            let [x, y] = pixels(point.x, point.y);
            write!(svg, "{x:.1},{y:.1} ")?;
        }
        svg.write_str("\"/>")?;
    }
    if let Some(pose) = scene.lorry {
        body(svg, pose, LORRY, "#8a6d3b", 1.0)?;
    }
    let last = replay.steps.len().saturating_sub(1).max(1) as f32;
    for (i, step) in replay.steps.iter().enumerate().step_by(10) {
        let opacity = 0.2 + 0.8 * i as f32 / last;
        let pose = |path, s| replay.junction.polyline(path).map(|line| line.pose(s));
        let color = if step.shielded { SHIELD } else { EGO };
        if let Some(pose) = pose(PathId::new(0), step.ego.s) {
            body(svg, pose, CAR, color, opacity)?;
        }
        if let Some((path, at)) = step.other
            && let Some(pose) = pose(path, at.s)
        {
            let opacity = if step.seen { opacity } else { 0.15 };
            let size = if path == CROSSING { WALKER } else { CAR };
            body(svg, pose, size, OTHER, opacity)?;
        }
    }
    Ok(())
}

fn pixels(x: f32, y: f32) -> [f32; 2] {
    let [left, top] = MIDDLE;
    [left + SCALE * x, top - SCALE * y]
}

fn body(
    svg: &mut String,
    pose: Pose,
    size: Footprint,
    color: &str,
    opacity: f32,
) -> Result<(), Error> {
    let [x, y] = pixels(pose.position.x, pose.position.y);
    // One on foot would hardly be seen.
    let (length, width) = (SCALE * size.length.max(1.5), SCALE * size.width.max(1.5));
    let degrees = -pose.direction.y.atan2(pose.direction.x).to_degrees();
    write!(
        svg,
        r#"<rect x="{:.1}" y="{:.1}" width="{length:.1}" height="{width:.1}" fill="{color}" fill-opacity="{opacity:.2}" transform="translate({x:.1} {y:.1}) rotate({degrees:.1})"/>"#,
        -0.5 * length,
        -0.5 * width
    )
}

fn chart(svg: &mut String, steps: &[Step]) -> Result<(), Error> {
    let [left, top, right, bottom] = CHART;
    let end = steps.last().map_or(1.0, |step| step.time.max(1.0));
    let at = |time: f32, speed: f32| {
        let speed = speed.min(FASTEST);
        (
            left + (right - left) * time / end,
            bottom - (bottom - top) * speed / FASTEST,
        )
    };
    for step in steps.iter().filter(|step| step.shielded) {
        let (x, _) = at(step.time, 0.0);
        let wide = (right - left) * 0.1 / end;
        write!(
            svg,
            r#"<rect x="{x:.1}" y="{top}" width="{wide:.2}" height="{}" fill="{SHIELD}" fill-opacity="0.12"/>"#,
            bottom - top
        )?;
    }
    for speed in [0.0, 4.0, 8.0, 12.0] {
        let (_, y) = at(0.0, speed);
        write!(
            svg,
            r##"<line x1="{left}" x2="{right}" y1="{y:.1}" y2="{y:.1}" stroke="#ddd"/><text x="{}" y="{:.1}" text-anchor="end">{speed}</text>"##,
            left - 6.0,
            y + 4.0
        )?;
    }
    let mut curve = |color: &str, dash: &str, speed: &dyn Fn(&Step) -> Option<f32>| {
        write!(
            svg,
            r#"<polyline fill="none" stroke="{color}" stroke-width="2" stroke-dasharray="{dash}" points=""#
        )?;
        for (step, speed) in steps.iter().filter_map(|step| Some((step, speed(step)?))) {
            let (x, y) = at(step.time, speed);
            write!(svg, "{x:.1},{y:.1} ")?;
        }
        svg.write_str("\"/>")
    };
    curve("#999999", "4 3", &|step| Some(step.allowed))?;
    curve(OTHER, "", &|step| step.other.map(|(_, at)| at.v))?;
    curve(EGO, "", &|step| Some(step.ego.v))?;
    write!(
        svg,
        r##"<text x="{left}" y="{}" fill="{EGO}">ego, m/s</text><text x="{}" y="{}" fill="{OTHER}">other</text><text x="{}" y="{}" fill="#888">limits and bends</text><text x="{}" y="{}" fill="{SHIELD}">the shield decides</text><text x="{right}" y="{}" text-anchor="end">{end:.0} s</text>"##,
        top - 10.0,
        left + 80.0,
        top - 10.0,
        left + 140.0,
        top - 10.0,
        left + 270.0,
        top - 10.0,
        bottom + 18.0
    )
}
