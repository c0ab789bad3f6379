//! Thins a trace for plotting without losing its extremes.

/// Positions of at most about `limit` samples of `values`: the first and the last, and the smallest and the
/// largest of each of equal stretches. All positions if there are no more than `limit`.
pub(super) fn positions(values: &[f64], limit: usize) -> Vec<usize> {
    if values.len() <= limit || limit < 4 {
        return (0..values.len()).collect();
    }
    let stretch = values.len().div_ceil(limit / 2 - 1);
    let mut positions = vec![0];
    for (index, chunk) in values.chunks(stretch).enumerate() {
        let mut low = 0;
        let mut high = 0;
        for (i, value) in chunk.iter().enumerate() {
            if *value < chunk[low] {
                low = i;
            }
            if *value > chunk[high] {
                high = i;
            }
        }
        positions.extend([low.min(high), low.max(high)].map(|i| index * stretch + i));
    }
    positions.push(values.len() - 1);
    positions.dedup();
    positions
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_single_peak_survives() {
        let mut values = vec![0.0; 80_000];
        values[12_345] = 1.0;
        values[54_321] = -1.0;
        let kept = positions(&values, 4000);
        assert!(kept.len() <= 4002 && kept.contains(&12_345) && kept.contains(&54_321));
    }

    proptest! {
        #[test]
        fn positions_are_ordered_few_and_keep_the_extremes(
            values in prop::collection::vec(-1e3..1e3f64, 1..500),
            limit in 4usize..100,
        ) {
            let kept = positions(&values, limit);
            prop_assert!(kept.windows(2).all(|w| w[0] < w[1]));
            prop_assert!(kept.len() <= limit.max(4));
            prop_assert_eq!((kept[0], kept[kept.len() - 1]), (0, values.len() - 1));
            let extreme = |f: fn(f64, f64) -> f64| {
                (values.iter().copied().reduce(f), kept.iter().map(|&i| values[i]).reduce(f))
            };
            let (all, some) = extreme(f64::max);
            prop_assert_eq!(all, some);
            let (all, some) = extreme(f64::min);
            prop_assert_eq!(all, some);
        }
    }
}
