//! A row of the table: one driver on one split.

use super::Drive;
use crate::episode::End;
use crate::metrics::{HORIZONS, Measures};
use crate::statistics::{Mean, Share, mean_by_group};
use cede_data::encounter::EncounterId;
use serde::Serialize;
use std::collections::BTreeSet;

/// A time to collision below this (s) is critical.
const CRITICAL_TTC: f64 = 1.5;

/// A 95 % confidence interval: low and high end.
pub type ConfidenceInterval = [f64; 2];

/// A row of the table. Shares are fractions; what cannot be told from the episodes is `None`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableRow {
    /// Name of the driver.
    pub driver: String,
    /// Name of the site.
    pub site: String,
    /// Name of the split.
    pub split: String,
    /// `joint` or `ego`.
    pub mode: String,
    /// `conflict` or `cleared`.
    pub until: String,
    /// `off` or `on`.
    pub shield: String,
    /// Episodes.
    pub n: usize,
    /// Different encounters among them: in ego mode each gives two episodes.
    pub encounters: usize,
    /// Share of episodes in which the recorded vehicle arrived first.
    pub priority_accuracy: Option<f64>,
    /// Its Wilson interval.
    pub priority_accuracy_interval: Option<ConfidenceInterval>,
    /// Its bootstrap interval, resampled by recording files: samples of a file share vehicles. `None` for one
    /// file.
    pub priority_accuracy_interval_by_file: Option<ConfidenceInterval>,
    /// Mean of |l − l_GT| / l_GT.
    pub episode_length_error: Option<f64>,
    /// Its interval by the normal approximation.
    pub episode_length_error_interval: Option<ConfidenceInterval>,
    /// Its bootstrap interval, resampled by recording files; `None` for one file.
    pub episode_length_error_interval_by_file: Option<ConfidenceInterval>,
    /// Mean of |l − l_GT| in seconds.
    pub episode_length_error_s: Option<f64>,
    /// Episodes that ended in a collision.
    pub collisions: usize,
    /// Wilson interval of their share.
    pub collision_share_interval: Option<ConfidenceInterval>,
    /// Episodes that ended in a time-out.
    pub time_outs: usize,
    /// Wilson interval of their share.
    pub time_out_share_interval: Option<ConfidenceInterval>,
    /// Root mean square position error in metres after 1 s.
    pub position_rmse_1s: Option<f64>,
    /// The same after 3 s.
    pub position_rmse_3s: Option<f64>,
    /// The same after 5 s.
    pub position_rmse_5s: Option<f64>,
    /// The same over whole episodes.
    pub position_rmse: Option<f64>,
    /// Root mean square error of the SVO in radians.
    pub svo_rmse: Option<f64>,
    /// Mean of the PET's error in seconds.
    pub pet_error_s: Option<f64>,
    /// Share of episodes with a time to collision below 1.5 s.
    pub critical_ttc_share: Option<f64>,
    /// Root mean square of the jerk in m/s³.
    pub jerk_rms: Option<f64>,
    /// Share of steps in which the shield overruled the driver, mean over episodes.
    pub shielded_steps: Option<f64>,
    /// Share of episodes in which the vehicle under test arrived before the other; `None` in joint mode.
    pub went_first: Option<f64>,
    /// Its Wilson interval.
    pub went_first_interval: Option<ConfidenceInterval>,
    /// Its bootstrap interval, resampled by recording files; `None` for one file.
    pub went_first_interval_by_file: Option<ConfidenceInterval>,
    /// Mean delay of the vehicle under test beside its record in seconds, at least: see [`Measures::delay_s`].
    pub delay_s: Option<f64>,
    /// Its bootstrap interval, resampled by recording files; `None` for one file.
    pub delay_s_interval_by_file: Option<ConfidenceInterval>,
}

/// The words that name a row.
#[derive(Clone, Copy, Debug)]
pub struct Label<'a> {
    /// Name of the driver.
    pub driver: &'a str,
    /// Name of the site.
    pub site: &'a str,
    /// Name of the split.
    pub split: &'a str,
    /// `joint` or `ego`.
    pub mode: &'a str,
    /// `conflict` or `cleared`.
    pub until: &'a str,
    /// `off` or `on`.
    pub shield: &'a str,
}

impl TableRow {
    /// Gathers `drives` under `label`.
    #[must_use]
    pub fn of(label: Label<'_>, drives: &[Drive<'_>]) -> Self {
        let ended = |end| Share::of(drives.iter().map(|drive| drive.episode.end == end));
        let measures = || drives.iter().map(|drive| &drive.measures);
        let priority = Share::of(measures().map(|m| m.correct));
        let (collisions, time_outs) = (ended(End::Collision), ended(End::TimeOut));
        let length = Mean::of(measures().map(|m| m.length_error));
        let first = Share::of(measures().filter_map(|m| m.went_first));
        let position = |i: usize| rms(measures().filter_map(|m| m.position_error[i]));
        let encounters: BTreeSet<&EncounterId> =
            drives.iter().map(|drive| &drive.encounter.id).collect();
        Self {
            driver: label.driver.to_owned(),
            site: label.site.to_owned(),
            split: label.split.to_owned(),
            mode: label.mode.to_owned(),
            until: label.until.to_owned(),
            shield: label.shield.to_owned(),
            n: drives.len(),
            encounters: encounters.len(),
            priority_accuracy: priority.fraction(),
            priority_accuracy_interval: priority.interval(),
            priority_accuracy_interval_by_file: by_file(drives, |m| {
                Some(f64::from(u8::from(m.correct)))
            }),
            episode_length_error: length.map(|mean| mean.mean),
            // An error is never negative, whatever the normal approximation says.
            episode_length_error_interval: length
                .and_then(Mean::interval)
                .map(|interval| interval.map(|bound| bound.max(0.0))),
            episode_length_error_interval_by_file: by_file(drives, |m| Some(m.length_error)),
            episode_length_error_s: mean(measures().map(|m| m.length_error_s)),
            collisions: collisions.count,
            collision_share_interval: collisions.interval(),
            time_outs: time_outs.count,
            time_out_share_interval: time_outs.interval(),
            position_rmse_1s: position(0),
            position_rmse_3s: position(1),
            position_rmse_5s: position(2),
            position_rmse: rms(measures().map(|m| m.position_rmse)),
            svo_rmse: rms(measures().filter_map(|m| m.svo_rmse)),
            pet_error_s: mean(measures().filter_map(|m| m.pet_error)),
            critical_ttc_share: Share::of(
                measures().map(|m| m.min_ttc.is_some_and(|ttc| ttc < CRITICAL_TTC)),
            )
            .fraction(),
            jerk_rms: rms(measures().filter_map(|m| m.jerk)),
            shielded_steps: mean(measures().map(|m| m.shielded)),
            went_first: first.fraction(),
            went_first_interval: first.interval(),
            went_first_interval_by_file: by_file(drives, |m| {
                m.went_first.map(|first| f64::from(u8::from(first)))
            }),
            delay_s: mean(measures().filter_map(|m| m.delay_s)),
            delay_s_interval_by_file: by_file(drives, |m| m.delay_s),
        }
    }
}

// The fields above name the horizons.
const _: () = assert!(matches!(HORIZONS, [1, 3, 5]));

/// The interval of the mean of a measure, resampled by recording files.
fn by_file(
    drives: &[Drive<'_>],
    measure: impl Fn(&Measures) -> Option<f64>,
) -> Option<ConfidenceInterval> {
    let file = |drive: &Drive<'_>| (drive.encounter.id.site.clone(), drive.encounter.id.file);
    mean_by_group(
        drives
            .iter()
            .filter_map(|drive| Some((file(drive), measure(&drive.measures)?))),
    )
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    Mean::of(values).map(|mean| mean.mean)
}

/// The root of the mean square of root mean squares: every episode weighs the same.
fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    mean(values.map(|x| x * x)).map(f64::sqrt)
}
