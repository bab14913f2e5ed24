//! The progress bar of a training.

use crate::progress;
use cede_train::driving::judge::judge;
use cede_train::run::{Lessons, Report, Run};
use indicatif::ProgressBar;
use std::time::{Duration, Instant};

/// Time between two judgements of the policy.
const JUDGE_EVERY: Duration = Duration::from_secs(5);
/// Number of encounters to judge on.
const JUDGED: usize = 60;

/// Progress on stderr; hidden if stderr is not a terminal.
pub(super) struct Bar<'l> {
    bar: ProgressBar,
    lessons: &'l Lessons<'l>,
    judged: Option<Instant>,
    score: String,
    begun: Instant,
    episodes: u64,
    updates: u64,
}

impl<'l> Bar<'l> {
    pub(super) fn new(lessons: &'l Lessons<'l>) -> Self {
        Self {
            bar: progress::bar(0, "{bar:30} {percent} % {eta} left, {msg}"),
            lessons,
            judged: None,
            score: String::new(),
            begun: Instant::now(),
            episodes: 0,
            updates: 0,
        }
    }

    /// Shows a slice of work. Judges the current policy now and then.
    pub(super) fn show(&mut self, report: &Report, run: &Run<'_>) {
        self.episodes += report.episodes;
        self.updates += report.updates;
        self.bar.set_length(report.total);
        self.bar.set_position(report.done);
        if self.bar.is_hidden() {
            return;
        }
        if self.judged.is_none_or(|last| last.elapsed() > JUDGE_EVERY) {
            let courses = &self.lessons.courses;
            let score = judge(&courses[..courses.len().min(JUDGED)], run.view());
            self.score = format!(
                "priority accuracy {:.0} %, length error {:.2}",
                100.0 * score.priority_accuracy,
                score.length_error
            );
            self.judged = Some(Instant::now());
        }
        let seconds = self.begun.elapsed().as_secs_f64().max(1e-3);
        self.bar.set_message(format!(
            "{:.0} episodes/s, {:.0} updates/s, {}",
            self.episodes as f64 / seconds,
            self.updates as f64 / seconds,
            self.score
        ));
    }

    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
