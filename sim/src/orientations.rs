//! What people's social value orientation (SVO) tells: its distribution, who goes first, and what the other will do.
//!
//! The paper's first claim is that the SVO characterises an interaction better than speed does. Here it is measured on
//! recorded encounters, beside what else is known at the same moment.

use crate::metrics::{recorded_states, svo_series};
use crate::observation_model::ObservationModel;
use crate::statistics::{Mean, Share, area_under_curve, by_group, mean_by_group};
use cede_controller::kinematics::STEP;
use cede_controller::{OrientationFilter, Policy};
use cede_data::encounter::{Encounter, Role};
use cede_data::{Dataset, Distribution};
use rayon::prelude::*;
use serde::Serialize;

/// Bins of the histogram, of 90/[`BINS`] degrees each.
pub const BINS: usize = 18;
/// Steps between two moments before the conflict.
const EVERY: usize = 5;
/// The earliest moment, in steps before the conflict.
const EARLIEST: usize = 60;
/// Speeds (m/s) below this count as this in arrival times.
const CREEP: f32 = 0.5;

/// What is measured on one site.
#[derive(Clone, Debug, Serialize)]
pub struct Study {
    /// Name of the site.
    pub site: String,
    /// Encounters.
    pub encounters: usize,
    /// The drivers' orientations.
    pub drivers: Drivers,
    /// Who goes first, told from one moment before the conflict; the latest moment first.
    pub first: Vec<Moment>,
    /// The other's acceleration over the next step.
    pub acceleration: AccelerationError,
}

/// The drivers' orientations: the mean of a driver's SVO towards the other until the conflict, in degrees. That of the one
/// and that of the other add up to 90.
#[derive(Clone, Debug, Serialize)]
pub struct Drivers {
    /// Of those who went first.
    pub first: Distribution,
    /// How many of those who went first have an orientation in each bin, from 0 to 90 degrees.
    pub histogram: [usize; BINS],
    /// Of the left-turners.
    pub left: Distribution,
    /// Share of those who went first that are egoists: below 45 degrees.
    pub egoists: Option<f64>,
    /// Its Wilson interval.
    pub egoists_interval: Option<[f64; 2]>,
    /// Its bootstrap interval, resampled by recording files.
    pub egoists_interval_by_file: Option<[f64; 2]>,
}

/// How well each score tells who goes first, one moment before the conflict: the area under the curve, 0.5 for a guess.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moment {
    /// Seconds before the first arrival.
    pub before_s: f64,
    /// Encounters that had begun.
    pub n: usize,
    /// The SVO: the ratio of the two arrival times.
    pub svo: Option<f64>,
    /// Its bootstrap interval, resampled by recording files.
    pub svo_interval: Option<[f64; 2]>,
    /// The ratio of the two speeds.
    pub speeds: Option<f64>,
    /// By how much the SVO is better than the speeds; bootstrap interval, resampled by recording files.
    pub svo_over_speeds_interval: Option<[f64; 2]>,
    /// The difference of the two distances.
    pub distances: Option<f64>,
    /// The difference of the two arrival times.
    pub arrivals: Option<f64>,
    /// The left-turner's own arrival time.
    pub own_arrival: Option<f64>,
    /// By how much higher the other's orientation is than the left-turner's, both estimated from what they did.
    pub estimated: Option<f64>,
}

/// Root mean square errors (m/s²) of predictions of the other's acceleration over the next step. Every encounter weighs the
/// same.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AccelerationError {
    /// Steps that were predicted.
    pub n: usize,
    /// Predicted by what the ego's policy expects of the other.
    pub expected: Option<f64>,
    /// Predicted by the policy in the other's seat, as it learned.
    pub seated: Option<f64>,
    /// The same with the other's orientation, as it is estimated.
    pub estimated: Option<f64>,
    /// Predicted to go on as in the last step.
    pub persistent: Option<f64>,
    /// Mean of the estimate's squared error less that of what is expected (m²/s⁴), and its bootstrap interval, resampled by
    /// recording files.
    pub estimated_less_expected: Option<(f64, [f64; 2])>,
    /// The same beside the policy in the other's seat.
    pub estimated_less_seated: Option<(f64, [f64; 2])>,
}

/// One encounter.
struct Case {
    file: (String, u16),
    left_first: bool,
    /// The left-turner's SVO (rad), step by step.
    svo: Vec<f32>,
    /// Scores that are the higher the likelier the left-turner goes first, at each moment; none before the start.
    scores: Vec<Option<Scores>>,
    errors: Errors,
}

#[derive(Clone, Copy)]
struct Scores {
    svo: f64,
    speeds: f64,
    distances: f64,
    arrivals: f64,
    own_arrival: f64,
    estimated: f64,
}

/// The scores of one encounter, and whether the left-turner went first.
type Judged = (Scores, bool);

/// Sums of squared errors (m²/s⁴) over steps.
#[derive(Clone, Copy, Default)]
struct Errors {
    n: usize,
    expected: f64,
    seated: f64,
    estimated: f64,
    persistent: f64,
}

impl Study {
    /// Measures the encounters of `dataset`; accelerations are predicted by `policy`.
    ///
    /// Runs on the threads of the current rayon pool, with the same bits on any number of them. Cost: 14 passes through the
    /// network a recorded step, and 1,000 resamples of every figure.
    #[must_use]
    pub fn of(dataset: &Dataset, policy: &Policy<'_>) -> Self {
        let cases: Vec<Case> = dataset
            .encounters
            .par_iter()
            .map(|encounter| Case::of(encounter, policy))
            .collect();
        Self {
            site: dataset.site.name.clone(),
            encounters: cases.len(),
            drivers: Drivers::of(&cases),
            first: (0..EARLIEST / EVERY)
                .map(|i| Moment::of(&cases, i))
                .collect(),
            acceleration: AccelerationError::of(&cases),
        }
    }
}

impl Case {
    fn of(encounter: &Encounter, policy: &Policy<'_>) -> Self {
        let (estimates, errors) = watch(encounter, policy);
        let svo: Vec<f32> = svo_series(encounter, recorded_states(encounter)).collect();
        let scores = (1..=EARLIEST / EVERY).map(|i| {
            let step = (encounter.steps as usize).checked_sub(i * EVERY)?;
            scores(encounter, step, *svo.get(step)?, *estimates.get(step)?)
        });
        Self {
            file: (encounter.id.site.clone(), encounter.id.file),
            left_first: encounter.first == Role::Left,
            scores: scores.collect(),
            svo,
            errors,
        }
    }

    /// The mean SVO (degrees) of the left-turner until the conflict.
    fn orientation(&self) -> Option<f64> {
        let degrees = self.svo.iter().map(|svo| f64::from(svo.to_degrees()));
        Mean::of(degrees).map(|mean| mean.mean)
    }

    /// The same of the one that went first.
    fn orientation_of_first(&self) -> Option<f64> {
        let left = self.orientation()?;
        Some(if self.left_first { left } else { 90.0 - left })
    }
}

fn scores(encounter: &Encounter, step: usize, svo: f32, estimates: [f32; 2]) -> Option<Scores> {
    let state = |role| {
        let vehicle = encounter.judged(role);
        let sample = vehicle.record.get(step)?;
        Some((vehicle.conflict_s - sample.s, sample.v))
    };
    let ((d, v), (other_d, other_v)) = (state(Role::Left)?, state(Role::Other)?);
    let arrival = |d: f32, v: f32| f64::from(d / v.max(CREEP));
    let [left_shows, other_shows] = estimates;
    Some(Scores {
        svo: -f64::from(svo),
        // Of two at rest neither is faster.
        speeds: if v == 0.0 && other_v == 0.0 {
            core::f64::consts::FRAC_PI_4
        } else {
            f64::from(v).atan2(f64::from(other_v))
        },
        distances: f64::from(other_d - d),
        arrivals: arrival(other_d, other_v) - arrival(d, v),
        own_arrival: -arrival(d, v),
        estimated: f64::from(other_shows - left_shows),
    })
}

/// What each of the two judged vehicles is estimated to show (rad, the left-turner's first), step by step; and how far the
/// predictions of their accelerations were off.
fn watch(encounter: &Encounter, policy: &Policy<'_>) -> (Vec<[f32; 2]>, Errors) {
    let model = ObservationModel::new(encounter);
    let pairs: Vec<_> = model.recorded().collect();
    let mut filters = [OrientationFilter::default(); 2];
    let (mut shown, mut errors) = (Vec::new(), Errors::default());
    for (step, seen) in pairs.as_chunks::<2>().0.iter().enumerate() {
        let mut both = [0.0; 2];
        for (ego, pair) in seen.iter().enumerate() {
            let other = 1 - ego;
            let estimate = filters[other].look(policy, pair, STEP);
            both[other] = estimate.svo;
            let record = &encounter.participants[other].record;
            let (Some(now), Some(last)) = (record.get(step), record.get(step.wrapping_sub(1)))
            else {
                continue;
            };
            let stays = |wanted: f32| wanted.max(-now.v / STEP);
            let [_, expected] = policy.act(pair);
            let [seated, _] = policy.act(&pair.swapped());
            let error = |predicted: f32| f64::from(predicted - now.a).powi(2);
            errors.n += 1;
            errors.expected += error(stays(expected));
            errors.seated += error(stays(seated));
            errors.estimated += error(estimate.acceleration);
            errors.persistent += error(stays(last.a));
        }
        shown.push(both);
    }
    (shown, errors)
}

impl Drivers {
    fn of(cases: &[Case]) -> Self {
        let of_first = || cases.iter().filter_map(Case::orientation_of_first);
        let mut histogram = [0; BINS];
        for degrees in of_first() {
            histogram[((degrees / 90.0 * BINS as f64) as usize).min(BINS - 1)] += 1;
        }
        let egoists = Share::of(of_first().map(|degrees| degrees < 45.0));
        let by_file = cases.iter().filter_map(|case| {
            let egoist = case.orientation_of_first()? < 45.0;
            Some((&case.file, f64::from(u8::from(egoist))))
        });
        Self {
            first: Distribution::of(of_first()),
            histogram,
            left: Distribution::of(cases.iter().filter_map(Case::orientation)),
            egoists: egoists.fraction(),
            egoists_interval: egoists.interval(),
            egoists_interval_by_file: mean_by_group(by_file),
        }
    }
}

impl Moment {
    fn of(cases: &[Case], i: usize) -> Self {
        let there: Vec<(&Case, Scores)> = cases
            .iter()
            .filter_map(|case| Some((case, case.scores[i]?)))
            .collect();
        let all: Vec<Judged> = there
            .iter()
            .map(|(case, s)| (*s, case.left_first))
            .collect();
        let area = |samples: &[Judged], score: fn(&Scores) -> f64| {
            area_under_curve(samples.iter().map(|(scores, left)| (score(scores), *left)))
        };
        let interval = |statistic: &dyn Fn(&[Judged]) -> Option<f64>| {
            let samples = there
                .iter()
                .map(|(case, s)| (&case.file, (*s, case.left_first)));
            by_group(samples, statistic)
        };
        Self {
            before_s: (i + 1) as f64 * EVERY as f64 * f64::from(STEP),
            n: all.len(),
            svo: area(&all, |s| s.svo),
            svo_interval: interval(&|samples| area(samples, |s| s.svo)),
            speeds: area(&all, |s| s.speeds),
            svo_over_speeds_interval: interval(&|samples| {
                Some(area(samples, |s| s.svo)? - area(samples, |s| s.speeds)?)
            }),
            distances: area(&all, |s| s.distances),
            arrivals: area(&all, |s| s.arrivals),
            own_arrival: area(&all, |s| s.own_arrival),
            estimated: area(&all, |s| s.estimated),
        }
    }
}

impl AccelerationError {
    fn of(cases: &[Case]) -> Self {
        let errors = || cases.iter().filter(|case| case.errors.n > 0);
        let per_step =
            |case: &Case, sum: fn(&Errors) -> f64| sum(&case.errors) / case.errors.n as f64;
        let root = |sum: fn(&Errors) -> f64| {
            let mean = Mean::of(errors().map(|case| per_step(case, sum)));
            mean.map(|mean| mean.mean.sqrt())
        };
        let less = |sum: fn(&Errors) -> f64| {
            let mean = Mean::of(errors().map(|case| per_step(case, sum)))?;
            let interval = mean_by_group(errors().map(|case| (&case.file, per_step(case, sum))))?;
            Some((mean.mean, interval))
        };
        Self {
            n: cases.iter().map(|case| case.errors.n).sum(),
            expected: root(|e| e.expected),
            seated: root(|e| e.seated),
            estimated: root(|e| e.estimated),
            persistent: root(|e| e.persistent),
            estimated_less_expected: less(|e| e.estimated - e.expected),
            estimated_less_seated: less(|e| e.estimated - e.seated),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::crossing;
    use cede_controller::policy::embedded;

    fn study(encounters: Vec<Encounter>) -> Study {
        let mut dataset = Dataset::synthetic(1, 0);
        dataset.encounters = encounters;
        Study::of(&dataset, &Policy::new(embedded::words()).unwrap())
    }

    /// Encounters in two files in which the left-turner needs less time than the other if `i` is even.
    fn encounters() -> Vec<Encounter> {
        (0_u8..24)
            .map(|i| {
                let ahead = if i % 2 == 0 { 20.0 } else { 45.0 };
                let mut encounter = crossing([ahead, 6.0], [30.0 + 0.1 * f32::from(i), 6.0]);
                encounter.id.left = u32::from(i);
                encounter.id.file = u16::from(i % 3);
                encounter
            })
            .collect()
    }

    #[test]
    fn at_constant_speeds_the_svo_tells_who_goes_first_and_the_speeds_do_not() {
        let study = study(encounters());
        let moment = &study.first[1];
        assert_eq!((moment.before_s * 10.0).round(), 10.0);
        assert_eq!(
            (moment.n, moment.svo, moment.arrivals),
            (24, Some(1.0), Some(1.0))
        );
        assert_eq!(moment.speeds, Some(0.5));
        assert_eq!(moment.svo_over_speeds_interval, Some([0.5, 0.5]));
    }

    #[test]
    fn who_goes_first_is_an_egoist_and_the_histogram_counts_everybody() {
        let drivers = study(encounters()).drivers;
        assert_eq!(drivers.egoists, Some(1.0));
        assert_eq!(drivers.histogram.iter().sum::<usize>(), 24);
        assert_eq!(drivers.histogram[BINS / 2..].iter().sum::<usize>(), 0);
        assert!(drivers.first.max < 45.0);
    }

    #[test]
    fn errors_are_those_of_all_predicted_steps() {
        let study = study(encounters());
        let error = study.acceleration;
        assert!(error.n > 24 * 40);
        // The record's speeds are constant.
        assert_eq!(error.persistent, Some(0.0));
        assert!(error.expected.unwrap() > 0.0 && error.seated.unwrap() > 0.0);
    }

    #[test]
    fn nothing_to_measure_has_no_figures() {
        let study = study(Vec::new());
        assert_eq!((study.encounters, study.acceleration.n), (0, 0));
        assert!(study.first.iter().all(|moment| moment.svo.is_none()));
    }
}
