use arm::thermal;
use proptest::prelude::*;

use super::super::examples::{pendulum, tflex};
use super::super::problem::Terminal;
use super::super::rest::RestPoints;
use super::*;
use crate::Reference;

/// What braking leads to.
struct Stop {
    /// Where it ends.
    angle: f64,
    velocity: f64,
    /// Least and largest angle on the way.
    angles: [f64; 2],
    /// Largest magnitude of the torque \[N·m\].
    torque: f64,
    /// Largest thermal load, on the way and for ever after \[A²\].
    load: f64,
}

/// Simulates the braking by small steps of eqs 20 and 21.
fn stop(problem: &Problem, set: &SafeSet, angle: f64, velocity: f64, load: f64) -> Stop {
    const STEPS: u32 = 400;
    let mut moves = vec![0.0; SafeSet::stopping_intervals(problem.horizon)];
    set.brake(angle, velocity, std::iter::repeat(set.interval), &mut moves);
    let (arm, motor) = (&problem.arm, &problem.motor);
    let h = set.interval / f64::from(STEPS);
    let mut stop = Stop {
        angle,
        velocity,
        angles: [angle; 2],
        torque: 0.0,
        load,
    };
    let mut load = load;
    for &acceleration in &moves {
        for _ in 0..STEPS {
            let reference = Reference {
                angle: stop.angle,
                velocity: stop.velocity,
                acceleration,
            };
            let middle = reference.advanced(0.5 * h);
            let torque = arm.position_torque(middle.angle)
                + arm.damping * middle.velocity
                + arm.inertia * acceleration;
            load = thermal::update(motor, load, torque, h);
            let next = reference.advanced(h);
            (stop.angle, stop.velocity) = (next.angle, next.velocity);
            stop.angles = [
                stop.angles[0].min(next.angle),
                stop.angles[1].max(next.angle),
            ];
            stop.torque = stop.torque.max(torque.abs());
            stop.load = stop.load.max(load);
        }
    }
    // Held there for ever the load approaches that of the holding current.
    let holding = arm.position_torque(stop.angle) / motor.torque_constant;
    stop.load = stop.load.max(holding * holding);
    stop
}

/// A problem, with damping, a weak motor, or one for which the arm itself is nearly too heavy, and its first
/// set.
fn example(
    flexure: bool,
    damping: f64,
    peak: Option<f64>,
    heavy: Option<f64>,
    horizon: usize,
) -> (Problem, SafeSet) {
    let mut problem = if flexure { tflex() } else { pendulum() };
    problem.terminal = Terminal::SafeSet;
    problem.horizon = horizon;
    problem.arm.damping += damping;
    if let Some(peak) = peak {
        problem.motor.peak_torque = peak;
    }
    if let Some(part) = heavy {
        let scan = Scan::new(&problem.arm, problem.angle_lower, problem.angle_upper);
        let [least, most] = scan.extremes();
        let current = most.max(-least) / problem.motor.torque_constant;
        problem.thermal_limit = Some(part * current * current);
        // So that limits count within the time of braking.
        problem.motor.thermal_time_constant = 2.0;
    }
    let [lower, upper] = RestPoints::new(&problem).intervals()[0];
    (problem, SafeSet::new(&problem, lower, upper))
}

fn any_example() -> impl Strategy<Value = (Problem, SafeSet)> {
    let peak = prop_oneof![Just(None), (4.0..20.0).prop_map(Some)];
    let heavy = prop_oneof![Just(None), (0.3..1.5).prop_map(Some)];
    (
        any::<bool>(),
        prop_oneof![Just(0.0), 0.0..1.0],
        peak,
        heavy,
        2..60_usize,
    )
        .prop_map(|(flexure, damping, peak, heavy, horizon)| {
            example(flexure, damping, peak, heavy, horizon)
        })
        .prop_filter("rest somewhere", |(_, set)| set.upper > set.lower + 1e-6)
}

/// The largest velocity towards the bound of `side` for which `is_safe` holds, by bisection.
fn fastest(is_safe: impl Fn(f64) -> bool) -> f64 {
    let mut between = [0.0, 1e3];
    for _ in 0..60 {
        let middle = 0.5 * (between[0] + between[1]);
        between[usize::from(!is_safe(middle))] = middle;
    }
    between[0]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// From every state in the sets, and most of all from their boundary, braking keeps every limit.
    #[test]
    fn states_in_the_sets_can_be_stopped(
        (problem, set) in any_example(), place in 0.0..1.0, part in prop_oneof![Just(1.0), 0.0..1.0],
        budget in prop_oneof![Just(0.0), 0.0..1.0], up: bool,
    ) {
        let angle = set.lower + place * (set.upper - set.lower);
        let sign = if up { 1.0 } else { -1.0 };
        let limit = set.thermal_limit;
        let is_safe = |v: f64| {
            set.kinetic_excess(angle, sign * v) <= 0.0 && set.heat(angle, sign * v) <= limit
        };
        let velocity = part * sign * fastest(is_safe);
        // The hottest load in the set, or a cooler one.
        let load = (limit - set.heat(angle, velocity)) * (1.0 - budget);
        let stop = stop(&problem, &set, angle, velocity, load);
        prop_assert!(stop.velocity.abs() < 1e-9, "{}", stop.velocity);
        prop_assert!(stop.angles[0] >= set.lower - 1e-9 && stop.angles[1] <= set.upper + 1e-9);
        prop_assert!(stop.load <= limit + 1e-9, "{} over", stop.load - limit);
        prop_assert!(stop.torque <= problem.motor.peak_torque * (1.0 + 1e-9) , "{}", stop.torque);
    }

    /// One interval of braking later the kinetic set is still kept.
    #[test]
    fn braking_stays_in_the_kinetic_set((problem, set) in any_example(), place in 0.0..1.0, part in 0.0..1.0, up: bool) {
        let angle = set.lower + place * (set.upper - set.lower);
        let sign = if up { 1.0 } else { -1.0 };
        let velocity = part * sign * fastest(|v| set.kinetic_excess(angle, sign * v) <= 0.0);
        let mut moves = [0.0];
        set.brake(angle, velocity, std::iter::once(set.interval), &mut moves);
        let next = Reference { angle, velocity, acceleration: moves[0] }.advanced(set.interval);
        prop_assert!(set.kinetic_excess(next.angle, next.velocity) <= 1e-12 * (1.0 + problem.angle_upper));
    }

    /// The sets are convex, as a solver needs them: between two states in them there is none outside.
    #[test]
    fn the_sets_are_convex(
        (_, set) in any_example(), places in (0.0..1.0, 0.0..1.0), parts in (-1.0..1.0, -1.0..1.0), mix in 0.0..1.0,
    ) {
        let state = |place: f64, part: f64| {
            let angle = set.lower + place * (set.upper - set.lower);
            let sign = f64::signum(part);
            let velocity = part * fastest(|v| set.kinetic_excess(angle, sign * v) <= 0.0);
            [angle, velocity, set.thermal_limit - set.heat(angle, velocity)]
        };
        let (a, b) = (state(places.0, parts.0), state(places.1, parts.1));
        let between: [f64; 3] = std::array::from_fn(|i| mix * a[i] + (1.0 - mix) * b[i]);
        prop_assert!(set.kinetic_excess(between[0], between[1]) <= 1e-9);
        let allowed = set.thermal_limit - set.heat(between[0], between[1]);
        prop_assert!(between[2] <= allowed + 1e-9);
    }
}

/// The paper's sets, eqs 41 and 46, for an arm that is nothing but inertia and intervals that are nothing
/// beside the time of braking.
#[test]
fn for_a_bare_inertia_they_are_the_papers() {
    let mut problem = tflex();
    problem.arm = arm::Parameters {
        inertia: 2.0,
        damping: 0.0,
        stiffness: 0.0,
        offset: 0.0,
        hysteresis: 0.0,
        cogging_frequency: 0.0,
        cogging_cos: [0.0; 9],
        cogging_sin: [0.0; 9],
    };
    problem.motor.peak_torque = 10.0;
    problem.motor.thermal_time_constant = 1e6;
    (problem.period, problem.longest, problem.horizon) = (1e-6, 1e-6, 4_000_000);
    let set = SafeSet::new(&problem, 0.0, 1.0);
    let angle = 0.4;
    let fastest = fastest(|v| set.kinetic_excess(angle, v) <= 0.0);
    assert!((0.5 * 2.0 * fastest * fastest - 10.0 * (1.0 - angle)).abs() < 1e-4);
    let velocity: f64 = 1.5;
    let per_torque = problem.motor.torque_constant.powi(-2) / 1e6;
    let expected = 0.5 * velocity.powi(3) / (1.0 - angle) * 2.0 * 2.0 * per_torque;
    assert!((set.heat(angle, velocity) - expected).abs() < 1e-5 * expected);
    // And mirrored.
    assert!((set.heat(1.0 - angle, -velocity) - expected).abs() < 1e-5 * expected);
}

/// Damping that a motor at its limit must work against while the arm coasts to its stop.
#[test]
fn damping_heats_a_motor_that_holds_at_its_limit() {
    let mut problem = pendulum();
    problem.terminal = Terminal::SafeSet;
    problem.arm = arm::Parameters {
        inertia: 0.3,
        damping: 1.0,
        stiffness: 0.0,
        offset: 2.0,
        cogging_cos: [0.0; 9],
        ..problem.arm
    };
    // A little more than what holding takes.
    let holding: f64 = 2.0 / problem.motor.torque_constant;
    problem.thermal_limit = Some(holding * holding * (1.0 + 1e-9));
    let set = SafeSet::new(&problem, problem.angle_lower, problem.angle_upper);
    let (angle, velocity) = (0.3, 0.3);
    assert_eq!(set.kinetic_excess(angle, velocity), 0.0);
    let load = set.thermal_limit - set.heat(angle, velocity);
    let stop = stop(&problem, &set, angle, velocity, load);
    let heated = stop.load - load;
    assert!(stop.load <= set.thermal_limit + 1e-9);
    // The damping's share of the heat is no small one.
    assert!(heated > 0.3 * set.heat(angle, velocity), "{heated}");
    problem.arm.damping = 0.0;
    let undamped = SafeSet::new(&problem, problem.angle_lower, problem.angle_upper);
    assert!(undamped.heat(angle, velocity) < 0.5 * heated);
}
