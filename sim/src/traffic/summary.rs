//! The traffic of some recordings, in numbers.

use super::{Kind, Outcome, Ride, Settings};
use crate::statistics::mean_by_group;
use serde::Serialize;

/// The traffic of some recordings, in numbers. Shares are fractions; lists of two are 95 % intervals by bootstrap over the
/// recordings, `None` with fewer than two.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The site.
    pub site: String,
    /// What drives.
    pub driver: Kind,
    /// The share that was to be driven.
    pub share: f64,
    /// Recordings.
    pub recordings: usize,
    /// Vehicles, without those that were left out.
    pub vehicles: usize,
    /// Vehicles that were driven for a step at least.
    pub driven: usize,
    /// Vehicles that were to be driven and never were: their shield was not ready, or their way is no path of a junction.
    pub refused: usize,
    /// Vehicles that came to the end of their record.
    pub arrived: usize,
    /// Of the driven ones, those that were taken away because they did not.
    pub stuck: usize,
    /// The same of the others.
    pub others_stuck: usize,
    /// Seconds later than in their records that the driven ones arrived, on average.
    pub delay_s: Option<f64>,
    /// Its interval.
    pub delay_interval_s: Option<[f64; 2]>,
    /// The same of the others.
    pub others_delay_s: Option<f64>,
    /// The longest time (s) that a driven one stood.
    pub longest_wait_s: f32,
    /// Pairs that touched, one of them driven at least.
    pub collisions: usize,
    /// Of these, those in which the driven one stood or was hit from behind.
    pub struck: usize,
    /// Of the collisions, those of two that were driven.
    pub both_driven: usize,
    /// Pairs of others that touched.
    pub others_touched: usize,
    /// Vehicles that were left out, because their way is no path of a junction.
    pub left_out: usize,
    /// How often the driven ones began to brake harder than 4 m/s², per kilometre.
    pub hard_brakes_per_km: Option<f64>,
    /// Root mean square of their jerk (m/s³).
    pub jerk_rms: Option<f64>,
    /// Their highest lateral acceleration (m/s²).
    pub lateral_acceleration_max: f32,
    /// The share of their steps in which the shield decided.
    pub shielded_share: Option<f64>,
    /// The share of their steps without a safe plan.
    pub no_plan_share: Option<f64>,
}

impl Summary {
    /// `outcomes` at `site` with `settings`.
    #[must_use]
    pub fn of(site: &str, settings: &Settings<'_>, outcomes: &[Outcome]) -> Self {
        let rides = || {
            outcomes
                .iter()
                .flat_map(|it| it.rides.iter().map(move |ride| (it.file, ride)))
        };
        let is_driven = |ride: &Ride| ride.driven > 0;
        let driven = || rides().filter(move |(_, ride)| is_driven(ride));
        let others = || rides().filter(move |(_, ride)| !is_driven(ride));
        let delays = |all: &mut dyn Iterator<Item = (u16, &Ride)>| -> Vec<(u16, f64)> {
            all.filter_map(|(file, ride)| Some((file, f64::from(ride.arrived?))))
                .collect()
        };
        let (delay, others_delay) = (delays(&mut driven()), delays(&mut others()));
        let total = |of: &dyn Fn(&Ride) -> f64| driven().map(|(_, ride)| of(ride)).sum::<f64>();
        let most =
            |of: &dyn Fn(&Ride) -> f32| driven().map(|(_, ride)| of(ride)).fold(0.0, f32::max);
        let steps = total(&|ride| f64::from(ride.driven));
        let share = |part: f64| (steps > 0.0).then(|| part / steps);
        let kilometres = 1e-3 * total(&|ride| f64::from(ride.distance));
        let all_steps = total(&|ride| f64::from(ride.steps));
        let collisions = || outcomes.iter().flat_map(|it| &it.collisions);
        Self {
            site: site.to_owned(),
            driver: settings.kind,
            share: settings.share,
            recordings: outcomes.len(),
            vehicles: rides().filter(|(_, ride)| ride.steps > 0).count(),
            driven: driven().count(),
            refused: others()
                .filter(|(_, ride)| ride.chosen && ride.steps > 0)
                .count(),
            arrived: rides().filter(|(_, ride)| ride.arrived.is_some()).count(),
            stuck: driven().filter(|(_, ride)| ride.stuck).count(),
            others_stuck: others().filter(|(_, ride)| ride.stuck).count(),
            delay_s: mean(&delay),
            delay_interval_s: mean_by_group(delay.iter().copied()),
            others_delay_s: mean(&others_delay),
            longest_wait_s: most(&|ride| ride.wait),
            collisions: collisions().count(),
            struck: collisions().filter(|collision| collision.struck).count(),
            both_driven: collisions().filter(|collision| collision.both).count(),
            others_touched: outcomes.iter().map(|it| it.others_touched).sum(),
            left_out: outcomes.iter().map(|it| it.left_out).sum(),
            hard_brakes_per_km: (kilometres > 0.0)
                .then(|| total(&|ride| f64::from(ride.hard_brakes)) / kilometres),
            jerk_rms: (all_steps > 0.0).then(|| (total(&|ride| ride.jerk) / all_steps).sqrt()),
            lateral_acceleration_max: most(&|ride| ride.lateral),
            shielded_share: share(total(&|ride| f64::from(ride.shielded))),
            no_plan_share: share(total(&|ride| f64::from(ride.unplanned))),
        }
    }
}

fn mean(values: &[(u16, f64)]) -> Option<f64> {
    let sum: f64 = values.iter().map(|(_, value)| value).sum();
    (!values.is_empty()).then(|| sum / values.len() as f64)
}
