//! Closed-loop measurements of simulated arms: a PD controller follows smooth moves between random setpoints.

#![allow(dead_code, reason = "each test binary uses a part")]

use arm::{Motor, Parameters, plant};
use identification::{Estimate, Identification, Measurement};

/// Period of the samples \[s\].
pub const PERIOD: f64 = 2.5e-4;
/// Middle and half width of the setpoints of the T-flex \[rad\].
pub const RANGE: [f64; 2] = [1.23, 0.31];

/// Numbers from a seed.
pub struct Random(pub u64);

impl Random {
    pub fn uniform(&mut self) -> f64 {
        arm::random::uniform(&mut self.0)
    }

    /// Standard normal: a sum of twelve uniform draws.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Reference angle and velocity: moves of 0.4 s, a new one every 0.8 s, now and then from end to end.
pub struct Moves {
    random: Random,
    range: [f64; 2],
    from: f64,
    to: f64,
    count: usize,
}

impl Moves {
    const EVERY: usize = 3200;
    const DURATION: f64 = 0.4;

    pub fn new(seed: u64, range: [f64; 2]) -> Self {
        Self {
            random: Random(seed),
            range,
            from: range[0],
            to: range[0],
            count: 0,
        }
    }

    pub fn next(&mut self) -> [f64; 2] {
        let sample = self.count % Self::EVERY;
        if sample == 0 {
            self.from = self.to;
            let place = match (self.count / Self::EVERY) % 8 {
                0 => -1.0,
                1 => 1.0,
                _ => 2.0 * self.random.uniform() - 1.0,
            };
            self.to = self.range[0] + place * self.range[1];
        }
        self.count += 1;
        let x = (sample as f64 * PERIOD / Self::DURATION).min(1.0);
        let way = x.powi(3) * (10.0 - 15.0 * x + 6.0 * x * x);
        let speed = 30.0 * x * x * (1.0 - x).powi(2) / Self::DURATION;
        let distance = self.to - self.from;
        [self.from + distance * way, distance * speed]
    }
}

/// An arm that a PD controller, given its constant torque and gains, moves for some seconds; `noise` is that of the torque, unknown to the
/// measurement \[N·m\]. `step` makes one sample: state, torque → state.
pub fn measure_any<S: Copy>(
    start: S,
    angle_and_velocity: impl Fn(&S) -> [f64; 2],
    step: impl Fn(&S, f64) -> S,
    [bias, proportional, derivative]: [f64; 3],
    seconds: f64,
    (noise, seed): (f64, u64),
    range: [f64; 2],
) -> Measurement {
    let (mut moves, mut random) = (Moves::new(7, range), Random(seed));
    let (mut state, mut angles, mut torques) = (start, Vec::new(), Vec::new());
    for _ in 0..(seconds / PERIOD) as usize {
        let [angle, velocity] = angle_and_velocity(&state);
        let [reference, speed] = moves.next();
        let torque = bias + proportional * (reference - angle) + derivative * (speed - velocity);
        angles.push(angle);
        torques.push(torque);
        state = step(&state, torque + noise * random.normal());
    }
    Measurement::new(PERIOD, angles, torques)
}

/// The arm of the project with parameters φ.
pub fn measure(p: &Parameters, seconds: f64, noise: f64, seed: u64) -> Measurement {
    let start = plant::State {
        angle: RANGE[0],
        velocity: 0.0,
        thermal_load: 0.0,
        hysteresis: 0.0,
    };
    measure_any(
        start,
        |s| [s.angle, s.velocity],
        |s, torque| plant::step(p, &Motor::tflex(), s, torque, 0.0, PERIOD),
        [p.position_torque(RANGE[0]), 60.0, 3.0],
        seconds,
        (noise, seed),
        RANGE,
    )
}

/// φ in the order of the estimates.
pub fn value(p: &Parameters, name: &str) -> f64 {
    let index = || {
        name.split(['[', ']'])
            .nth(1)
            .unwrap()
            .parse::<usize>()
            .unwrap()
            - 1
    };
    match name {
        "arm.inertia" => p.inertia,
        "arm.damping" => p.damping,
        "arm.stiffness" => p.stiffness,
        "arm.offset" => p.offset,
        "arm.hysteresis" => p.hysteresis,
        "arm.cogging_frequency" => p.cogging_frequency,
        _ if name.starts_with("arm.cogging_cos") => p.cogging_cos[index()],
        _ => p.cogging_sin[index()],
    }
}

pub fn estimate<'a>(found: &'a Identification, name: &str) -> &'a Estimate {
    found.estimates.iter().find(|e| e.name == name).unwrap()
}
