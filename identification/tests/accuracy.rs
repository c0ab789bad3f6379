//! Parameters of simulated arms are found again.

mod common;

use arm::{HARMONICS, Parameters};
use common::*;
use identification::regression::Order;
use identification::{Error, Measurement, Segment, Series, Settings, Timing, identify};

/// Drive noise of the paper: 0.3 mA at 5.57 N·m/A.
const NOISE: f64 = 1.67e-3;

fn errors(p: &Parameters, measurement: &Measurement, settings: &Settings) -> [f64; 6] {
    let found = identify(measurement, settings).unwrap();
    [
        "arm.inertia",
        "arm.stiffness",
        "arm.offset",
        "arm.damping",
        "arm.hysteresis",
        "arm.cogging_frequency",
    ]
    .map(|name| (estimate(&found, name).value / value(p, name) - 1.0).abs())
}

#[test]
fn the_tflex_is_found_within_the_targets() {
    let p = Parameters::tflex();
    let measurement = measure(&p, 60.0, NOISE, 3);
    let [inertia, stiffness, offset, damping, hysteresis, frequency] =
        errors(&p, &measurement, &Settings::default());
    assert!(inertia < 1e-3 && stiffness < 0.01 && offset < 0.01);
    assert!(
        damping < 0.02 && hysteresis < 0.01,
        "{damping} {hysteresis}"
    );
    assert!(frequency < 0.002, "{frequency}");
}

/// The reasons for the defaults: the order of the paper, and torques that are not taken as held.
#[test]
fn smoothing_first_and_late_torques_bias() {
    let p = Parameters::tflex();
    let measurement = measure(&p, 60.0, NOISE, 3);
    let settings = |order| Settings {
        order,
        harmonics: Some(9),
        ..Settings::default()
    };
    let regressors = errors(&p, &measurement, &settings(Order::Regressors));
    let signals = errors(&p, &measurement, &settings(Order::Signals));
    eprintln!(
        "J, k, o, d, C, w, relative errors: regressors {regressors:.5?}, signals {signals:.5?}"
    );
    for i in [0, 1, 2, 4, 5] {
        assert!(
            signals[i] > 2.0 * regressors[i],
            "{i}: {signals:?} {regressors:?}"
        );
    }
    let late = Measurement {
        timing: Timing::Sampled,
        ..measurement
    };
    let damping = errors(&p, &late, &settings(Order::Regressors))[3];
    eprintln!("d by a late torque: {damping:.3}");
    assert!(damping > 0.05, "{damping}");
}

/// An encoder's noise makes steps that the hysteresis must not follow.
#[test]
fn noise_of_the_angle_does_not_build_up_hysteresis() {
    let p = Parameters::tflex();
    let mut measurement = measure(&p, 60.0, NOISE, 3);
    let mut random = Random(9);
    for angle in &mut measurement.segments[0].angle {
        *angle += 2e-6 * random.normal();
    }
    let settings = |hysteresis_taps| Settings {
        harmonics: Some(9),
        hysteresis_taps,
        ..Settings::default()
    };
    let [inertia, stiffness, offset, damping, hysteresis, frequency] =
        errors(&p, &measurement, &settings(None));
    assert!(inertia < 1e-3 && stiffness < 0.01 && offset < 0.02 && frequency < 0.002);
    assert!(
        damping < 0.03 && hysteresis < 0.01,
        "{damping} {hysteresis}"
    );
    let followed = errors(&p, &measurement, &settings(Some(1)))[4];
    assert!(followed > 3.0 * hysteresis.max(0.005), "{followed}");
}

/// Data made by the very formulas of the regression: only rounding is left.
#[test]
fn exact_data_give_exact_parameters() {
    let p = Parameters {
        cogging_frequency: 7.0,
        cogging_cos: [0.3, -0.1, 0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        cogging_sin: [0.1, 0.2, -0.04, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ..Parameters::tflex()
    };
    let angle: Vec<f64> = (0..40_000)
        .map(|k| {
            let t = f64::from(k) * PERIOD;
            0.6 * (2.1 * t).sin() + 0.4 * (5.3 * t).sin() + 0.05 * (31.0 * t).cos()
        })
        .collect();
    let mut z = 0.0;
    let mut torque = vec![0.0; angle.len()];
    for k in 1..angle.len() - 1 {
        z = arm::hysteresis::update(z, angle[k] - angle[k - 1]);
        let alpha = (angle[k + 1] - 2.0 * angle[k] + angle[k - 1]) / (PERIOD * PERIOD);
        let omega = (angle[k + 1] - angle[k - 1]) / (2.0 * PERIOD);
        torque[k] =
            p.inertia * alpha + p.damping * omega + p.hysteresis * z + p.position_torque(angle[k]);
    }
    let measurement = Measurement {
        timing: Timing::Sampled,
        ..Measurement::new(PERIOD, angle, torque)
    };
    let settings = Settings {
        hysteresis_taps: Some(1),
        ..Settings::default()
    };
    let found = identify(&measurement, &settings).unwrap();
    assert_eq!(found.harmonics, 3);
    for e in &found.estimates {
        let error = (e.value - value(&p, &e.name)).abs();
        assert!(error < 1e-6, "{}: {} by {error}", e.name, e.value);
    }
    assert!(found.fit.nrmse < 1e-8, "{:?}", found.fit);
}

#[test]
fn cross_validation_finds_the_number_of_harmonics() {
    for (true_number, amplitude) in [(0, 0.0), (1, 0.05), (2, 0.05), (5, 0.02)] {
        let mut p = Parameters {
            cogging_cos: [0.0; HARMONICS],
            cogging_sin: [0.0; HARMONICS],
            cogging_frequency: 14.0,
            ..Parameters::tflex()
        };
        for i in 0..true_number {
            p.cogging_cos[i] = amplitude;
            p.cogging_sin[i] = -0.7 * amplitude;
        }
        let found = identify(&measure(&p, 30.0, NOISE, 1), &Settings::default()).unwrap();
        let scores = &found.candidates;
        assert_eq!(found.harmonics, true_number, "{scores:?}");
        if true_number > 0 {
            assert!((found.parameters.cogging_frequency / 14.0 - 1.0).abs() < 0.005);
        }
    }
}

/// An arm of another kind: friction that jumps with the direction, no cogging.
#[test]
fn an_arm_with_coulomb_friction_has_no_harmonics() {
    let (inertia, damping, stiffness, offset, friction) = (0.5, 0.4, 6.0, -2.0, 0.3);
    let step = |s: &[f64; 2], torque: f64| {
        let (mut angle, mut velocity) = (s[0], s[1]);
        for _ in 0..10 {
            let h = PERIOD / 10.0;
            let drag = friction * (velocity / 1e-3).tanh();
            velocity +=
                h * (torque - damping * velocity - stiffness * angle - offset - drag) / inertia;
            angle += h * velocity;
        }
        [angle, velocity]
    };
    let run = |seed| {
        measure_any(
            [0.0, 0.0],
            |s| *s,
            step,
            [-2.0, 200.0, 20.0],
            60.0,
            (5e-3, seed),
            [0.0, 0.5],
        )
    };
    let found = identify(&run(1), &Settings::default()).unwrap();
    let p = &found.parameters;
    assert!(found.sticks);
    assert_eq!(found.harmonics, 0, "{:?}", found.candidates);
    for (value, truth, tolerance) in [
        (p.inertia, inertia, 0.01),
        (p.stiffness, stiffness, 0.01),
        (p.offset, offset, 0.01),
        (p.damping, damping, 0.05),
        (p.hysteresis, friction, 0.05),
    ] {
        assert!(
            (value / truth - 1.0).abs() < tolerance,
            "{value} for {truth}"
        );
    }
    let regression = Settings::default().regression(&run(2)).unwrap();
    let validation = Series::new(p, &regression).fit_in_motion();
    assert!(validation.nrmse < 0.02, "{validation:?}");
}

/// Standard errors against the scatter of repetitions.
#[test]
fn sigma_is_the_scatter_over_noise() {
    let p = Parameters {
        cogging_cos: [0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        cogging_sin: [0.0; HARMONICS],
        cogging_frequency: 20.0,
        ..Parameters::tflex()
    };
    let settings = Settings {
        harmonics: Some(1),
        frequency_range: Some([18.0, 22.0]),
        ..Settings::default()
    };
    let runs = 40;
    let mut values: Vec<Vec<f64>> = Vec::new();
    let mut sigmas: Vec<f64> = Vec::new();
    let mut names = Vec::new();
    for seed in 0..runs {
        let found = identify(&measure(&p, 12.0, NOISE, 100 + seed), &settings).unwrap();
        values.resize(found.estimates.len(), Vec::new());
        sigmas.resize(found.estimates.len(), 0.0);
        for (i, e) in found.estimates.iter().enumerate() {
            values[i].push(e.value);
            sigmas[i] += e.sigma / runs as f64;
        }
        names = found.estimates.iter().map(|e| e.name.clone()).collect();
    }
    for ((name, values), sigma) in names.iter().zip(&values).zip(&sigmas) {
        let mean = values.iter().sum::<f64>() / runs as f64;
        let scatter =
            (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (runs - 1) as f64).sqrt();
        // The scatter of 40 has a standard error of 11 %.
        let ratio = sigma / scatter;
        assert!((0.65..1.5).contains(&ratio), "{name}: {ratio}");
    }
}

/// Gaps cut a measurement, each stretch with its own delay and start of the hysteresis.
#[test]
fn gaps_do_not_bias() {
    let p = Parameters::tflex();
    let whole = measure(&p, 60.0, NOISE, 5);
    let Segment { angle, torque, .. } = &whole.segments[0];
    let segment = |first: usize, last: usize| Segment {
        start: first as f64 * PERIOD,
        angle: angle[first..last].to_vec(),
        torque: torque[first..last].to_vec(),
    };
    let cut = Measurement {
        segments: vec![
            segment(0, 81_000),
            segment(81_010, 81_100),
            segment(90_000, 150_123),
            segment(150_200, 240_000),
        ],
        ..whole.clone()
    };
    let [inertia, stiffness, offset, damping, hysteresis, frequency] =
        errors(&p, &cut, &Settings::default());
    assert!(inertia < 1e-3 && stiffness < 0.01 && offset < 0.01 && frequency < 0.002);
    assert!(
        damping < 0.02 && hysteresis < 0.01,
        "{damping} {hysteresis}"
    );
    // Glued together instead, the jumps in angle spoil it.
    let mut glued = Segment::default();
    for s in &cut.segments {
        glued.angle.extend(&s.angle);
        glued.torque.extend(&s.torque);
    }
    let glued = Measurement {
        segments: vec![glued],
        ..whole
    };
    let inertia = errors(&p, &glued, &Settings::default())[0];
    assert!(inertia > 1e-3, "{inertia}");
}

/// Counting the angle the other way round turns odd terms only.
#[test]
fn directions_are_treated_alike() {
    let forward = measure(&Parameters::tflex(), 20.0, NOISE, 2);
    let mut backward = forward.clone();
    for segment in &mut backward.segments {
        segment.angle.iter_mut().for_each(|x| *x = -*x);
        segment.torque.iter_mut().for_each(|x| *x = -*x);
    }
    let settings = Settings {
        harmonics: Some(9),
        ..Settings::default()
    };
    let [f, b] = [&forward, &backward].map(|m| identify(m, &settings).unwrap().parameters);
    for (f, b) in [
        (f.inertia, b.inertia),
        (f.damping, b.damping),
        (f.hysteresis, b.hysteresis),
        (f.stiffness, b.stiffness),
        (f.offset, -b.offset),
        (f.cogging_frequency, b.cogging_frequency),
        (f.cogging_cos[1], -b.cogging_cos[1]),
        (f.cogging_sin[1], b.cogging_sin[1]),
    ] {
        assert!((f - b).abs() < 1e-6 * f.abs(), "{f} {b}");
    }
}

#[test]
fn what_cannot_be_identified_is_refused() {
    let p = Parameters::tflex();
    let good = measure(&p, 20.0, NOISE, 2);
    let refuse = |m: &Measurement| identify(m, &Settings::default()).unwrap_err();
    let samples = 40_000;

    let still = Measurement::new(PERIOD, vec![1.3; samples], vec![3.3; samples]);
    let Error::NotExcited { parameters, .. } = refuse(&still) else {
        panic!()
    };
    assert_eq!(parameters, ["arm.inertia", "arm.damping", "arm.hysteresis"]);

    // Constant speed: velocity and offset look alike.
    let ramp: Vec<f64> = (0..samples).map(|k| 1e-4 * k as f64).collect();
    let Error::NotExcited { parameters, .. } =
        refuse(&Measurement::new(PERIOD, ramp.clone(), ramp))
    else {
        panic!()
    };
    assert_eq!(parameters, ["arm.damping", "arm.offset"]);

    let short = Measurement::new(
        PERIOD,
        good.segments[0].angle[..400].to_vec(),
        good.segments[0].torque[..400].to_vec(),
    );
    assert!(matches!(
        refuse(&short),
        Error::TooShort { samples: 400, .. }
    ));

    let mut reversed = good.clone();
    reversed.segments[0]
        .torque
        .iter_mut()
        .for_each(|t| *t = -*t);
    assert!(matches!(refuse(&reversed), Error::Inertia { value, .. } if value < 0.0));

    let mut broken = good.clone();
    broken.segments[0].torque[77] = f64::NAN;
    assert!(matches!(
        refuse(&broken),
        Error::NotFinite {
            signal: "torque",
            index: 77,
            ..
        }
    ));
    let timeless = Measurement {
        period: 0.0,
        ..good
    };
    assert!(matches!(refuse(&timeless), Error::Period { .. }));
}

/// Moves so small and slow that damping is lost in the noise: said by name, with its σ.
#[test]
fn what_is_lost_in_noise_is_said() {
    let p = Parameters {
        cogging_cos: [0.0; HARMONICS],
        cogging_sin: [0.0; HARMONICS],
        ..Parameters::tflex()
    };
    let found = identify(&measure(&p, 8.0, 1.0, 4), &Settings::default()).unwrap();
    let damping = estimate(&found, "arm.damping");
    assert!(
        !damping.identifiable && damping.sigma > 0.1 * damping.value.abs(),
        "{damping:?}"
    );
    let named = |w: &&String| w.contains("arm.damping") && w.contains("not identifiable");
    assert_eq!(
        found.warnings.iter().filter(named).count(),
        1,
        "{:?}",
        found.warnings
    );
    assert!(estimate(&found, "arm.inertia").identifiable);
}
