//! How well a score tells two groups apart.

/// The area under the curve of the scores `(score, is one)`: the probability that one of the group scores higher than one
/// that is not of it, ties counted half. `None` unless there are both.
///
/// Source: J. A. Hanley and B. J. McNeil, "The meaning and use of the area under a receiver operating characteristic
/// curve" (1982): the Mann–Whitney statistic. Cost: n log n.
#[must_use]
pub fn area_under_curve(scores: impl IntoIterator<Item = (f64, bool)>) -> Option<f64> {
    let mut scores: Vec<(f64, bool)> = scores.into_iter().collect();
    scores.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Pairs in which the one of the group is the higher; and of the others, those that are lower so far.
    let (mut higher, mut lower) = (0.0, 0.0);
    for ties in scores.chunk_by(|a, b| a.0 == b.0) {
        let ones = ties.iter().filter(|(_, one)| *one).count() as f64;
        let others = ties.len() as f64 - ones;
        higher += ones * (lower + 0.5 * others);
        lower += others;
    }
    let pairs = lower * (scores.len() as f64 - lower);
    (pairs > 0.0).then_some(higher / pairs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_perfect_score_a_reversed_one_and_none() {
        let scored = |sign: f64| (0..10).map(move |i| (sign * f64::from(i), i >= 4));
        assert_eq!(area_under_curve(scored(1.0)), Some(1.0));
        assert_eq!(area_under_curve(scored(-1.0)), Some(0.0));
        assert_eq!(area_under_curve(scored(0.0)), Some(0.5));
        assert_eq!(area_under_curve([(1.0, true), (2.0, true)]), None);
    }

    #[test]
    fn it_is_the_share_of_pairs_in_order() {
        // Ones at 2 and 3, others at 1, 2 and 4: of six pairs three are in order, one is tied.
        let scores = [
            (2.0, true),
            (3.0, true),
            (1.0, false),
            (2.0, false),
            (4.0, false),
        ];
        let area = area_under_curve(scores).unwrap();
        assert!((area - 3.5 / 6.0).abs() < 1e-12, "{area}");
    }
}
