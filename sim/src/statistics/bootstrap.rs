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
    if groups.len() < 2 {
        return None;
    }
    let mut random = Pcg64::seed_from_u64(0);
    let mut mean = || {
        let drawn = (0..groups.len()).map(|_| groups[random.random_range(0..groups.len())]);
        let (sum, n) = drawn.fold((0.0, 0.0), |all, group| (all.0 + group.0, all.1 + group.1));
        sum / n
    };
    let mut means: Vec<f64> = (0..RESAMPLES).map(|_| mean()).collect();
    means.sort_by(f64::total_cmp);
    let tail = RESAMPLES / 40;
    Some([means[tail], means[RESAMPLES - 1 - tail]])
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
    fn one_group_has_no_interval() {
        assert_eq!(mean_by_group([(1, 0.3), (1, 0.5)]), None);
        assert_eq!(mean_by_group::<u8>([]), None);
    }
}
