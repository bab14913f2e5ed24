//! Confidence intervals that know that samples belong together.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// Resamples; the ends of a 95 % interval are the 25th value from either end.
const RESAMPLES: usize = 1000;

/// The 95 % percentile interval of the mean of `samples`, resampled by their groups: samples of one group are
/// drawn together, because they are not independent. `None` for fewer than two groups.
///
/// Source: A. C. Davison and D. V. Hinkley, "Bootstrap Methods and their Application" (1997), section 3.8.
/// The same bits on every machine. Cost: 1,000 times the number of groups.
#[must_use]
pub fn mean_by_group<G: Ord>(samples: impl IntoIterator<Item = (G, f64)>) -> Option<[f64; 2]> {
    let mut groups: BTreeMap<G, (f64, f64)> = BTreeMap::new();
    for (group, value) in samples {
        let (sum, n) = groups.entry(group).or_default();
        *sum += value;
        *n += 1.0;
    }
    let groups: Vec<(f64, f64)> = groups.into_values().collect();
    resampled(groups.len(), |drawn| {
        let all = drawn.iter().map(|&group| groups[group]);
        let (sum, n) = all.fold((0.0, 0.0), |all, group| (all.0 + group.0, all.1 + group.1));
        Some(sum / n)
    })
}

/// The same of any `statistic` of the samples; a resample in which it is not defined is left out.
///
/// The same bits on every machine. Cost: 1,000 times the statistic's.
#[must_use]
pub fn by_group<G: Ord, S: Clone>(
    samples: impl IntoIterator<Item = (G, S)>,
    statistic: impl Fn(&[S]) -> Option<f64>,
) -> Option<[f64; 2]> {
    let mut groups: BTreeMap<G, Vec<S>> = BTreeMap::new();
    for (group, sample) in samples {
        groups.entry(group).or_default().push(sample);
    }
    let groups: Vec<Vec<S>> = groups.into_values().collect();
    resampled(groups.len(), |drawn| {
        let all: Vec<S> = drawn
            .iter()
            .flat_map(|&group| groups[group].clone())
            .collect();
        statistic(&all)
    })
}

/// The 95 % percentile interval of what `statistic` makes of `groups` groups drawn with replacement.
fn resampled(groups: usize, statistic: impl Fn(&[usize]) -> Option<f64>) -> Option<[f64; 2]> {
    if groups < 2 {
        return None;
    }
    let mut random = Pcg64::seed_from_u64(0);
    let mut drawn = vec![0; groups];
    let mut values = Vec::with_capacity(RESAMPLES);
    for _ in 0..RESAMPLES {
        drawn.fill_with(|| random.random_range(0..groups));
        values.extend(statistic(&drawn));
    }
    values.sort_by(f64::total_cmp);
    let tail = values.len() / 40;
    let last = values.len().checked_sub(1 + tail)?;
    Some([values[tail], values[last]])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Groups of `size` equal samples, as many as samples suffice for.
    fn width(size: usize) -> f64 {
        let value = |group: usize| f64::from(u8::from(group.is_multiple_of(2)));
        let samples = (0..400).map(|i| (i / size, value(i / size)));
        let [low, high] = mean_by_group(samples).unwrap();
        assert!(low < 0.5 && high > 0.5, "{low} {high}");
        high - low
    }

    #[test]
    fn independent_samples_have_the_interval_of_the_normal_approximation() {
        assert!((width(1) - 2.0 * 1.96 * (0.25_f64 / 400.0).sqrt()).abs() < 0.01);
    }

    #[test]
    fn samples_that_agree_within_their_groups_count_as_one_a_group() {
        assert!((width(10) - 2.0 * 1.96 * (0.25_f64 / 40.0).sqrt()).abs() < 0.04);
    }

    #[test]
    fn any_statistic_has_the_interval_of_its_mean() {
        let samples = || (0..400).map(|i| (i / 10, f64::from(u8::from((i / 10) % 2 == 0))));
        let mean = |values: &[f64]| Some(values.iter().sum::<f64>() / values.len() as f64);
        assert_eq!(by_group(samples(), mean), mean_by_group(samples()));
        assert_eq!(by_group(samples(), |_| None), None);
    }

    #[test]
    fn one_group_has_no_interval() {
        assert_eq!(mean_by_group([(1, 0.3), (1, 0.5)]), None);
        assert_eq!(mean_by_group::<u8>([]), None);
    }
}
