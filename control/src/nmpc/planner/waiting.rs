//! A first guess for a start above the thermal limit: wait where the arm takes little torque.
//!
//! The load falls soonest if the arm goes where holding it takes little torque, waits there, and leaves for
//! the goal as late as it can. The optimum without inequalities goes to the goal at once, and iterations
//! from it would put off the departure interval by interval.
//!
//! # Movements
//! Over a distance d, in the time t, from the velocity v to rest, ∫u² is least for the velocities
//!
//! ```text
//! ωr = 6·d/t·s·(1−s) + v·(1−s)·(1−3·s)     s = time/t     ∫u² = 4·(3·d² − 3·d·v·t + v²·t²)/t³
//! ```
//!
//! A shorter one takes more torque but leaves more of the time for the place where less is held: t is the
//! one with the least J²·∫u² + Δ·t, Δ being the difference of g² between the two places.

use super::super::transcription::Transcription;

/// Least that the first movement counts as sparing, in units of what the second one does: a start that takes less
/// torque than the place is left at leisure.
const LEISURE: f64 = 0.1;

/// A movement to rest.
#[derive(Clone, Copy, Debug)]
struct Movement {
    /// \[rad\]
    distance: f64,
    /// At the start \[rad/s\].
    velocity: f64,
    /// \[s\]
    duration: f64,
}

impl Movement {
    /// The one with the least heat among those of `durations` \[s\], where being at rest spares `spared`
    /// \[(N·m)²\]; none if there are no durations.
    fn cheapest(
        [distance, velocity]: [f64; 2],
        inertia: f64,
        spared: f64,
        durations: impl Iterator<Item = f64>,
    ) -> Option<Self> {
        let with = |duration| Self {
            distance,
            velocity,
            duration,
        };
        let heat = |t: f64| inertia * inertia * with(t).effort() + spared * t;
        let heats = durations.map(|duration| (heat(duration), duration));
        let (_, duration) = heats.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(with(duration))
    }

    /// ∫u² \[rad²/s³\].
    fn effort(&self) -> f64 {
        let (d, t) = (self.distance, self.duration);
        let stopped = self.velocity * t;
        4.0 * (3.0 * d * (d - stopped) + stopped * stopped) / (t * t * t)
    }

    /// Velocity at `time` from the start; zero afterwards \[rad/s\].
    fn speed(&self, time: f64) -> f64 {
        let s = (time / self.duration).min(1.0);
        let cruise = 6.0 * self.distance / self.duration * s;
        (1.0 - s) * (cruise + self.velocity * (1.0 - 3.0 * s))
    }
}

/// Fills `moves` \[N\], for the intervals between `nodes` \[s\], with a movement to `place` \[rad\], a wait there and a
/// movement to the goal; false if that would spare nothing, or N is too small. O(N).
pub fn wait(transcription: &Transcription, place: f64, nodes: &[f64], moves: &mut [f64]) -> bool {
    let (problem, initial) = (transcription.problem(), transcription.initial());
    let goal = transcription.goal();
    let square = |angle: f64| problem.arm.position_torque(angle).powi(2);
    let (angle, velocity) = (initial.reference_angle, initial.reference_velocity);
    let waiting = square(place);
    let spared_late = square(goal) - waiting;
    if spared_late <= 0.0 {
        return false;
    }
    let spared_early = (square(angle) - waiting).max(LEISURE * spared_late);
    let (middle, last) = (moves.len() / 2, moves.len());
    let end = nodes[last];
    // At least two intervals, at most half the horizon each.
    let early = nodes.iter().take(middle + 1).skip(2).copied();
    let late = nodes[middle..=last].iter().map(|time| end - time);
    let late = late.take((last - middle).saturating_sub(1));
    let inertia = problem.arm.inertia;
    let arriving = Movement::cheapest([place - angle, velocity], inertia, spared_early, early);
    let leaving = Movement::cheapest([goal - place, 0.0], inertia, spared_late, late);
    let Some((arriving, leaving)) = arriving.zip(leaving) else {
        return false;
    };
    // From rest to rest a movement is the same forwards and backwards.
    let speed = |time: f64| arriving.speed(time) + leaving.speed(end - time);
    for (u, node) in moves.iter_mut().zip(nodes.windows(2)) {
        *u = (speed(node[1]) - speed(node[0])) / (node[1] - node[0]);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::super::examples::{pendulum, tflex};
    use super::super::super::grid::Grid;
    use super::super::super::problem::{Initial, Problem};
    use super::super::super::rollout::Rollout;
    use super::*;
    use arm::Instructions;
    use proptest::prelude::*;

    proptest! {
        /// As sums over fine steps tell.
        #[test]
        fn a_movement_covers_its_distance_with_the_effort_it_says(
            distance in -1.0..1.0_f64, velocity in -5.0..5.0_f64, duration in 0.1..2.0_f64,
        ) {
            let movement = Movement { distance, velocity, duration };
            let steps = 10_000;
            let h = duration / f64::from(steps);
            let speeds: Vec<f64> = (0..=steps).map(|i| movement.speed(f64::from(i) * h)).collect();
            let covered: f64 = speeds.windows(2).map(|v| 0.5 * h * (v[0] + v[1])).sum();
            let effort: f64 = speeds.windows(2).map(|v| (v[1] - v[0]).powi(2) / h).sum();
            prop_assert!((covered - distance).abs() < 1e-6);
            prop_assert!((effort - movement.effort()).abs() < 1e-6 * effort);
            prop_assert_eq!(speeds[0], velocity);
            prop_assert_eq!(movement.speed(duration), 0.0);
            prop_assert_eq!(movement.speed(2.0 * duration), 0.0);
        }

        /// No other duration of those offered takes less.
        #[test]
        fn the_cheapest_duration_is_taken(distance in -1.0..1.0_f64, velocity in -5.0..5.0_f64, spared in 1e-3..10.0_f64) {
            let durations = || (1..=20).map(|i| 0.05 * f64::from(i));
            let cheapest = Movement::cheapest([distance, velocity], 0.1, spared, durations()).expect("durations");
            let heat = |t: f64| 1e-2 * Movement { distance, velocity, duration: t }.effort() + spared * t;
            prop_assert!(durations().all(|t| heat(cheapest.duration) <= heat(t)));
        }
    }

    /// A wait of `transcription` at `place`, rolled out; none if it spares nothing.
    fn rolled_out(
        transcription: &mut Transcription,
        angle: f64,
        goal: f64,
        place: f64,
    ) -> Option<Rollout> {
        let horizon = transcription.problem().horizon;
        let initial = Initial {
            angle,
            reference_angle: angle,
            thermal_load: 15.0,
            ..Initial::default()
        };
        transcription.set(initial, goal);
        let grid = Grid::new(transcription.problem());
        let mut moves = vec![f64::NAN; horizon];
        wait(transcription, place, grid.nodes(), &mut moves).then(|| {
            transcription.end_at_rest(&mut moves);
            let mut rollout = Rollout::new(horizon);
            transcription.roll_out(&moves, &mut rollout);
            rollout
        })
    }

    #[test]
    fn the_arm_waits_where_it_is_told_to_and_ends_at_the_goal() {
        let mut transcription = Transcription::new(tflex(), Instructions::Baseline);
        let rollout = rolled_out(&mut transcription, 1.05, 1.3, 0.97).expect("spares torque");
        let angle = &rollout.reference_angle;
        let waits = angle.iter().filter(|angle| (*angle - 0.97).abs() < 1e-2);
        assert!(waits.count() > 20, "{angle:?}");
        assert!((angle[40] - 1.3).abs() < 1e-12);
        assert!(rollout.reference_velocity[40].abs() < 1e-12);
    }

    #[test]
    fn no_waiting_where_the_goal_takes_less_torque() {
        let mut transcription = Transcription::new(tflex(), Instructions::Baseline);
        assert!(rolled_out(&mut transcription, 1.05, 0.97, 1.307).is_none());
    }

    #[test]
    fn too_few_intervals_leave_no_time_to_wait() {
        for horizon in 2..6 {
            let problem = Problem {
                horizon,
                ..pendulum()
            };
            let [calm, hot] = [0.5, 1.4];
            let torque = |angle: f64| problem.arm.position_torque(angle).abs();
            assert!(torque(calm) < torque(hot));
            let mut transcription = Transcription::new(problem, Instructions::Baseline);
            let rollout = rolled_out(&mut transcription, hot, hot, calm);
            assert_eq!(rollout.is_some(), horizon >= 4);
            assert!(rollout.is_none_or(|rollout| rollout.is_finite()));
        }
    }
}
