//! A run's learning curve: scores of its policy during training.

use crate::driving::episodes::Course;
use crate::driving::judge::{Score, judge};
use crate::run::runner::{Report, Run};
use serde::{Deserialize, Serialize};

/// Number of points of a curve, evenly spaced over the run's work.
const POINTS: u64 = 25;

/// The encounters on which the policy is judged during training.
#[derive(Clone, Debug)]
pub struct Panel<'e> {
    /// Encounters that the run learns from.
    pub train: &'e [Course<'e>],
    /// Encounters that it does not learn from.
    pub validation: Vec<Course<'e>>,
}

/// One point of the curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Share of the run's work that is done, in (0, 1].
    pub share: f32,
    /// Updates so far.
    pub updates: u64,
    /// Score on the encounters that the run learns from.
    pub train: Score,
    /// Score on the encounters that it does not learn from, if there are any.
    pub validation: Option<Score>,
}

/// The curve so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The points in order.
    pub points: Vec<Point>,
    updates: u64,
}

impl Curve {
    /// Records a slice of the run's work. Judges the policy if a point of the curve is due.
    ///
    /// A point takes about 0.1 ms per encounter.
    pub fn follow(&mut self, report: &Report, run: &Run<'_>, panel: &Panel<'_>) -> Option<Point> {
        self.updates += report.updates;
        if report.done * POINTS < report.total * (self.points.len() as u64 + 1) {
            return None;
        }
        let view = run.view();
        let validation = !panel.validation.is_empty();
        let point = Point {
            share: report.done as f32 / report.total as f32,
            updates: self.updates,
            train: judge(panel.train, view),
            validation: validation.then(|| judge(&panel.validation, view)),
        };
        self.points.push(point);
        Some(point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::algorithm::Algorithm;
    use crate::run::lessons::Lessons;
    use cede_data::{Dataset, Encounter};

    #[test]
    fn a_curve_has_evenly_spaced_points_and_ends_with_the_last_policy() {
        let dataset = Dataset::synthetic(30, 4);
        let all: Vec<&Encounter> = dataset.encounters.iter().take(30).collect();
        let lessons = Lessons::new(&all[..20], &[]);
        let set = "width = 16\nupdates = 90\nbatch = 64\nrate = 0.01";
        let settings = Algorithm::Bc
            .settings()
            .with(&set.parse().unwrap())
            .unwrap();
        let panel = Panel {
            train: &lessons.courses,
            validation: all[20..].iter().map(|e| Course::new(e)).collect(),
        };
        let mut run = Run::new(settings, &lessons, 1);
        let mut curve = Curve::default();
        while let Some(report) = run.advance() {
            curve.follow(&report, &run, &panel);
        }
        assert_eq!(curve.points.len() as u64, POINTS);
        for (i, point) in curve.points.iter().enumerate() {
            let due = (i + 1) as f32 / POINTS as f32;
            assert!((point.share - due).abs() < 0.012, "{} {due}", point.share);
        }
        let last = curve.points[curve.points.len() - 1];
        assert_eq!((last.share, last.updates), (1.0, 90));
        assert_eq!(last.train, judge(&lessons.courses, run.view()));
        assert_eq!(last.validation, Some(judge(&panel.validation, run.view())));
    }
}
