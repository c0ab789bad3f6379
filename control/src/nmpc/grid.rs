//! The shooting nodes in time, and what a plan looks like from the nodes of a later one.
//!
//! Plans follow each other by h_0, the period, while intervals may be longer: nodes of two plans coincide
//! only where all intervals are equal. Moves are therefore averaged over the new intervals, which keeps the
//! velocity at every new node and with it rest at the end; multipliers are those of the nearest old node.

use super::problem::Problem;
use super::solver::Multipliers;

/// The shooting nodes of a problem.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Time of the nodes from the start of a plan \[N + 1\] \[s\].
    nodes: Vec<f64>,
    /// Whether all intervals are equally long.
    even: bool,
    /// For the nodes 1..N: the node that is nearest one period later \[N\].
    later: Vec<usize>,
}

impl Grid {
    /// The grid of `problem`. O(N²), at set-up.
    pub fn new(problem: &Problem) -> Self {
        let mut nodes = vec![0.0; problem.horizon + 1];
        for k in 0..problem.horizon {
            nodes[k + 1] = nodes[k] + problem.interval_length(k);
        }
        let nearest = |time: f64| {
            let distance = |k: &usize| (nodes[*k] - time).abs();
            (1..nodes.len())
                .min_by(|a, b| distance(a).total_cmp(&distance(b)))
                .unwrap_or_default()
        };
        let later = nodes[1..].iter().map(|t| nearest(t + problem.period));
        Self {
            later: later.collect(),
            even: problem.is_even(),
            nodes,
        }
    }

    /// Time of the nodes from the start of a plan \[N + 1\] \[s\].
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// Time when interval `k` begins, those after the last one being as long as that \[s\].
    fn begin(&self, k: usize) -> f64 {
        let last = self.nodes.len() - 1;
        let longest = self.nodes[last] - self.nodes[last - 1];
        self.nodes[k.min(last)] + k.saturating_sub(last) as f64 * longest
    }

    /// Time that `moves` take, those after the last interval being as long as that \[s\].
    pub fn duration_of(&self, moves: &[f64]) -> f64 {
        self.begin(moves.len())
    }

    /// The one of `moves` that is in force `ago` \[s\] after the plan began; none after their end. O(moves).
    pub fn move_at(&self, moves: &[f64], ago: f64) -> Option<f64> {
        // An instant that misses a node by rounding belongs to the interval after it.
        let begun = |k: &usize| self.begin(k + 1) <= ago * (1.0 + 1e-9);
        moves
            .get((0..moves.len()).take_while(begun).count())
            .copied()
    }

    /// Number of intervals in `ago` \[s\], if all are equally long and that is a whole one.
    fn whole_intervals(&self, ago: f64) -> Option<usize> {
        let intervals = ago / self.nodes[1];
        let whole = intervals.round();
        (self.even && (intervals - whole).abs() <= 1e-9 * intervals).then_some(whole as usize)
    }

    /// Velocity that the `moves` of a plan made `ago` \[s\] still add up to \[rad/s\]. O(moves).
    pub fn gain_left(&self, moves: &[f64], ago: f64) -> f64 {
        let left = |k: usize| self.begin(k + 1) - self.begin(k).max(ago);
        let gains = moves.iter().enumerate().map(|(k, u)| u * left(k).max(0.0));
        gains.sum()
    }

    /// The `moves` of a plan made `ago` \[s\], at least N, averaged over the intervals of a plan made now
    /// \[N\]; zero after their end. O(moves).
    pub fn shifted(&self, moves: &[f64], ago: f64, out: &mut [f64]) {
        if let Some(intervals) = self.whole_intervals(ago) {
            // The nodes of the two plans coincide.
            let left = moves.get(intervals..).unwrap_or_default();
            let common = left.len().min(out.len());
            out[..common].copy_from_slice(&left[..common]);
            out[common..].fill(0.0);
            return;
        }
        let mut old = 0;
        for (u, now) in out.iter_mut().zip(self.nodes.windows(2)) {
            let (from, to) = (now[0] + ago, now[1] + ago);
            let mut gained = 0.0;
            while old < moves.len() {
                let end = self.begin(old + 1);
                let shared = end.min(to) - self.begin(old).max(from);
                gained += moves[old] * shared.max(0.0);
                if end > to {
                    break;
                }
                old += 1;
            }
            *u = gained / (to - from);
        }
    }

    /// Moves multipliers on by one period.
    pub fn shift(&self, multipliers: &mut Multipliers) {
        for family in [
            &mut multipliers.thermal,
            &mut multipliers.lower,
            &mut multipliers.upper,
        ] {
            if self.even {
                family.copy_within(1.., 0);
                continue;
            }
            // In place: no node comes from an earlier one.
            for i in 0..family.len() {
                family[i] = family[self.later[i].min(family.len()) - 1];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{any_moves, pendulum};
    use super::*;
    use proptest::prelude::*;

    fn growing(period: f64, growth: f64, longest: f64) -> Problem {
        Problem {
            period,
            growth,
            longest,
            ..pendulum()
        }
    }

    proptest! {
        #[test]
        fn a_plan_of_equal_intervals_shifts_by_whole_ones(moves in any_moves(40), periods in 0..45_usize) {
            let grid = Grid::new(&pendulum());
            let mut shifted = vec![0.0; 40];
            grid.shifted(&moves, periods as f64 * 0.05, &mut shifted);
            for (k, u) in shifted.iter().enumerate() {
                let expected = moves.get(k + periods).unwrap_or(&0.0);
                prop_assert_eq!(u, expected, "{}", k);
            }
        }

        #[test]
        fn moves_follow_each_other(
            moves in any_moves(50), growth in 1.0..1.5_f64, longest in 1e-3..0.1, share in 0.0..1.0,
        ) {
            let grid = Grid::new(&growing(1e-3, growth, longest));
            for (k, u) in moves.iter().enumerate() {
                let (from, to) = (grid.begin(k), grid.begin(k + 1));
                prop_assert_eq!(grid.move_at(&moves, from + 0.99 * share * (to - from)), Some(*u));
            }
            prop_assert_eq!(grid.move_at(&moves, grid.duration_of(&moves)), None);
        }

        /// Velocity at every new node is that of the old plan at the same time.
        #[test]
        fn a_shifted_plan_keeps_the_velocity(
            moves in any_moves(40), growth in 1.0..1.5_f64, longest in 1e-3..0.1, ago in 0.0..0.5,
        ) {
            let grid = Grid::new(&growing(1e-3, growth, longest));
            let velocity = |moves: &[f64], time: f64| -> f64 {
                let intervals = grid.nodes().windows(2).zip(moves);
                intervals.map(|(node, u)| u * (time.min(node[1]) - node[0]).max(0.0)).sum()
            };
            let mut shifted = vec![0.0; 40];
            grid.shifted(&moves, ago, &mut shifted);
            for &time in grid.nodes() {
                let gained = velocity(&moves, time + ago) - velocity(&moves, ago);
                prop_assert!((velocity(&shifted, time) - gained).abs() < 1e-10);
            }
            let all = velocity(&moves, f64::INFINITY);
            prop_assert!((grid.gain_left(&moves, ago) - all + velocity(&moves, ago)).abs() < 1e-10);
        }

        /// Moves beyond the horizon last as long as the last interval, and come into sight in time.
        #[test]
        fn moves_after_the_end_follow(moves in any_moves(60), periods in 0..65_usize) {
            let grid = Grid::new(&pendulum());
            prop_assert!((grid.duration_of(&moves) - 3.0).abs() < 1e-12);
            let mut shifted = vec![0.0; 40];
            grid.shifted(&moves, periods as f64 * 0.05, &mut shifted);
            for (k, u) in shifted.iter().enumerate() {
                let expected = moves.get(k + periods).unwrap_or(&0.0);
                prop_assert_eq!(u, expected, "{}", k);
            }
            let left: f64 = moves.iter().skip(periods).map(|u| 0.05 * u).sum();
            prop_assert!((grid.gain_left(&moves, periods as f64 * 0.05) - left).abs() < 1e-10);
        }
    }

    #[test]
    fn multipliers_come_from_the_nearest_node() {
        let mut multipliers = Multipliers::new(40);
        for (i, thermal) in multipliers.thermal.iter_mut().enumerate() {
            *thermal = (i + 1) as f64;
        }
        multipliers.upper[38] = 7.0;
        let mut even = multipliers.clone();
        Grid::new(&pendulum()).shift(&mut even);
        assert_eq!(even.thermal[..3], [2.0, 3.0, 4.0]);
        assert_eq!(even.thermal[38..], [40.0, 40.0]);
        assert_eq!(even.upper[37..], [7.0, 7.0]);
        // Where an interval is much longer than a period the nearest node is the same one.
        Grid::new(&growing(1e-3, 1.5, 0.1)).shift(&mut multipliers);
        assert_eq!(multipliers.thermal[0], 2.0);
        assert_eq!(multipliers.thermal[20], 21.0);
    }
}
