//! Angles where the arm may rest, and the nearest of them to a setpoint.
//!
//! A goal must be a rest point that can be held for ever: within the reference's bounds (eq 25), and with
//! g(θ)²/Ki² below the thermal limit (eq 26), or within the torque limit of the linear model (appendix C.3).
//! Other setpoints have no plan, so the planner aims at the nearest goal instead.

use super::problem::Problem;

/// Cells per period of the highest cogging harmonic in the search for ends of admissible intervals.
const CELLS_PER_PERIOD: f64 = 32.0;
/// Angles of locally least torque that are kept.
const CALM: usize = 8;

/// The admissible rest points.
#[derive(Clone, Debug)]
pub struct RestPoints {
    /// Disjoint closed intervals in rising order \[rad\]; never empty.
    intervals: Vec<[f64; 2]>,
    /// Where holding the arm takes locally least torque \[rad\].
    calm: Vec<f64>,
}

impl RestPoints {
    /// Finds the rest points of `problem`. Where the limit admits none, the one of least torque remains.
    pub fn new(problem: &Problem) -> Self {
        let (lower, upper) = (problem.angle_lower, problem.angle_upper);
        if let Some(torque) = &problem.torque_limit {
            // None is refused at set-up.
            let interval = torque.rest_interval(lower, upper);
            return Self {
                intervals: vec![interval.unwrap_or([lower, upper])],
                calm: Vec::new(),
            };
        }
        let limit = problem.thermal_limit_after(problem.longest);
        if limit.is_infinite() {
            return Self {
                intervals: vec![[lower, upper]],
                calm: Vec::new(),
            };
        }
        let most = limit.sqrt() * problem.motor.torque_constant;
        let torque = |angle: f64| problem.arm.position_torque(angle).abs();
        let highest = problem.arm.cogging_frequency * arm::HARMONICS as f64;
        let periods = (upper - lower) * highest / std::f64::consts::TAU;
        let cells = (CELLS_PER_PERIOD * periods).clamp(256.0, 1e5) as usize;
        let angle = |i: usize| lower + (upper - lower) * i as f64 / cells as f64;

        let mut intervals: Vec<[f64; 2]> = Vec::new();
        let torques: Vec<f64> = (0..=cells).map(|i| torque(angle(i))).collect();
        let mut begin = (torques[0] <= most).then_some(lower);
        for i in 1..=cells {
            let [left, right] = [angle(i - 1), angle(i)];
            match (begin, torques[i] <= most) {
                (None, true) => begin = Some(crossing(right, left, |x| torque(x) <= most)),
                (Some(start), false) => {
                    intervals.push([start, crossing(left, right, |x| torque(x) <= most)]);
                    begin = None;
                }
                _ => {}
            }
        }
        intervals.extend(begin.map(|start| [start, upper]));
        let least = |&i: &usize| {
            (i == 0 || torques[i] < torques[i - 1]) && (i == cells || torques[i] <= torques[i + 1])
        };
        let mut calm: Vec<usize> = (0..=cells).filter(least).collect();
        calm.sort_by(|&a, &b| torques[a].total_cmp(&torques[b]));
        calm.truncate(CALM);
        let calm: Vec<f64> = calm.into_iter().map(angle).collect();
        if intervals.is_empty() {
            let calmest = calm.first().copied().unwrap_or(lower);
            intervals.push([calmest, calmest]);
        }
        Self { intervals, calm }
    }

    /// Disjoint closed intervals of rest points in rising order \[rad\].
    pub fn intervals(&self) -> &[[f64; 2]] {
        &self.intervals
    }

    /// Where holding the arm takes less torque than anywhere near \[rad\]: the calmest such angles within the
    /// reference's bounds, the calmest first. None where nothing limits the load.
    pub fn calm(&self) -> &[f64] {
        &self.calm
    }

    /// The rest point nearest to `setpoint` \[rad\], and the number of its interval.
    pub fn nearest(&self, setpoint: f64) -> (f64, usize) {
        let mut best = (self.intervals[0][0], 0);
        for (index, &[lower, upper]) in self.intervals.iter().enumerate() {
            let candidate = setpoint.max(lower).min(upper);
            if (candidate - setpoint).abs() < (best.0 - setpoint).abs() {
                best = (candidate, index);
            }
        }
        best
    }
}

/// Last angle on the way from `inside` to `outside` where `admits` holds, by bisection.
fn crossing(mut inside: f64, mut outside: f64, admits: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        if admits(middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::super::settings::Settings;
    use super::*;
    use arm::{Limits, Motor, Parameters};
    use proptest::prelude::*;

    fn problem(thermal_share: f64) -> Problem {
        let settings = Settings {
            thermal_share,
            ..Settings::default()
        };
        let feedback = super::super::problem::FeedbackModel {
            inertia: 1.0,
            gain_angle: 0.0,
            gain_velocity: 0.0,
            gain_integral: 0.0,
            sample_period: 0.0,
        };
        let (arm, motor) = (Parameters::pendulum(), Motor::pendulum());
        settings
            .problem(&arm, &motor, &Limits::pendulum(), &feedback)
            .expect("admissible settings")
    }

    #[test]
    fn setpoints_inside_the_margin_move_to_its_edge() {
        let rest = RestPoints::new(&problem(0.85));
        assert_eq!(rest.nearest(0.0), (0.02, 0));
        assert_eq!(rest.nearest(2.0).0, Limits::pendulum().angle_upper - 0.02);
        assert_eq!(rest.nearest(0.5).0, 0.5);
    }

    proptest! {
        #[test]
        fn rest_points_can_be_held(share in 1e-3..1.0, setpoint in -1.0..3.0) {
            let problem = problem(share);
            let points = RestPoints::new(&problem);
            let (rest, index) = points.nearest(setpoint);
            let [from, to] = points.intervals()[index];
            prop_assert!((from..=to).contains(&rest));
            prop_assert!(problem.angle_lower <= rest && rest <= problem.angle_upper);
            let heat = |angle| (problem.arm.position_torque(angle) / problem.motor.torque_constant).powi(2);
            let limit = problem.thermal_limit.expect("limited");
            prop_assert!(heat(rest) <= limit * (1.0 + 1e-12));
            // Nothing nearer is admissible, to the resolution of this scan.
            for i in 1..200 {
                let between = rest + (setpoint - rest) * f64::from(i) / 200.0;
                let admissible = heat(between) <= limit && problem.angle_lower <= between
                    && between <= problem.angle_upper;
                prop_assert!(!admissible || (between - rest).abs() < 1e-9, "{between} is nearer");
            }
        }
    }

    #[test]
    fn nowhere_near_a_calm_angle_is_calmer() {
        let problem = super::super::examples::tflex();
        let torque = |angle: f64| problem.arm.position_torque(angle).abs();
        let points = RestPoints::new(&problem);
        // Figure 8 of the paper, between the bounds: two valleys.
        let [first, second] = points.calm() else {
            panic!("{:?}", points.calm())
        };
        assert!((first - 0.97).abs() < 5e-3 && (second - 1.307).abs() < 5e-3);
        for angle in [first, second] {
            assert!(torque(*angle) <= torque(angle - 5e-3).min(torque(angle + 5e-3)));
        }
        assert!(torque(*first) < torque(*second));
    }

    #[test]
    fn without_any_admissible_point_the_least_torque_remains() {
        let mut problem = problem(1e-3);
        problem.arm.offset = 5.0;
        let rest = RestPoints::new(&problem).nearest(1.0).0;
        let least = (0..=1000)
            .map(|i| {
                problem.angle_lower
                    + (problem.angle_upper - problem.angle_lower) * f64::from(i) / 1000.0
            })
            .map(|angle| problem.arm.position_torque(angle).abs())
            .fold(f64::INFINITY, f64::min);
        assert!((problem.arm.position_torque(rest).abs() - least).abs() < 1e-2);
    }
}
