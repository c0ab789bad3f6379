//! What a measurement does not show is said: bounds, ranges of frequencies, samples that do not count.

mod common;

use arm::{HARMONICS, Parameters};
use common::{estimate, measure};
use identification::{Error, Identification, Measurement, Segment, Settings, identify};

/// The T-flex without cogging.
fn plain() -> Parameters {
    Parameters {
        cogging_cos: [0.0; HARMONICS],
        cogging_sin: [0.0; HARMONICS],
        ..Parameters::tflex()
    }
}

fn assert_said(found: &Identification, parts: &[&str]) {
    let warnings = &found.warnings;
    let said = |w: &String| parts.iter().all(|part| w.contains(part));
    assert!(warnings.iter().any(said), "{parts:?} not in {warnings:?}");
}

/// A torque that pushes the way the arm moves: damping would be below zero.
#[test]
fn damping_at_its_bound_has_its_sigma() {
    let p = plain();
    let mut measurement = measure(&p, 20.0, 0.05, 3);
    let Segment { angle, torque, .. } = &mut measurement.segments[0];
    for (k, torque) in torque.iter_mut().enumerate() {
        let ahead = angle[(k + 1).min(angle.len() - 1)];
        *torque -= 2.0 * p.damping * (ahead - angle[k]) / common::PERIOD;
    }
    let found = identify(&measurement, &Settings::default()).unwrap();
    let damping = estimate(&found, "arm.damping");
    assert_eq!(damping.value, 0.0);
    assert!(damping.sigma > 0.0 && !damping.identifiable, "{damping:?}");
    let value = "it would be -1.6"; // −d, as −1.6…e−2
    assert_said(
        &found,
        &["arm.damping", value, "N.m.s/rad (sigma ", "its bound, 0"],
    );
    assert_eq!(found.parameters.damping, 0.0);
}

#[test]
fn frequencies_that_are_not_shown_are_not_searched_in_silence() {
    let p = Parameters {
        cogging_cos: [0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        cogging_frequency: 20.0,
        ..plain()
    };
    let measurement = measure(&p, 20.0, 1e-3, 4);
    let with = |range: [f64; 2], harmonics| {
        let settings = Settings {
            harmonics,
            frequency_range: Some(range),
            ..Settings::default()
        };
        identify(&measurement, &settings)
    };
    for harmonics in [None, Some(1), Some(9)] {
        let refused = with([1e4, 2e4], harmonics).unwrap_err();
        let Error::FrequencyRange { finest, span, .. } = refused else {
            panic!("{refused}")
        };
        assert!((20.0..1e4).contains(&finest) && (0.6..0.7).contains(&span));
        let message = refused.to_string();
        assert!(message.contains("10000 to 20000 1/rad"), "{message}");
    }
    let found = with([18.0, 1e5], Some(1)).unwrap();
    assert!((found.parameters.cogging_frequency - 20.0).abs() < 0.1);
    assert_said(&found, &["searched up to", "instead of 100000 1/rad"]);
    let found = with([0.5, 22.0], Some(1)).unwrap();
    assert_said(
        &found,
        &["from 0.5 1/rad on", "less than a quarter of a period"],
    );
    let found = with([19.99, 19.990_01], Some(1)).unwrap();
    assert_said(
        &found,
        &["arm.cogging_frequency", "narrower than its sigma"],
    );
    let found = with([15.0, 18.0], Some(1)).unwrap();
    assert_said(&found, &["18.000000 1/rad is an end of the range"]);
    let found = with([18.0, 22.0], Some(1)).unwrap();
    let named = |w: &&String| w.contains("range") || w.contains("searched");
    assert_eq!(found.warnings.iter().find(named), None);
}

#[test]
fn samples_that_do_not_count_are_counted() {
    let whole = measure(&plain(), 20.0, 1e-3, 5);
    let Segment { angle, torque, .. } = &whole.segments[0];
    let segment = |first: usize, last: usize| Segment {
        start: first as f64 * common::PERIOD,
        angle: angle[first..last].to_vec(),
        torque: torque[first..last].to_vec(),
    };
    let still = Segment {
        start: 21.0,
        angle: vec![1.2; 200],
        torque: vec![0.5; 200],
    };
    let cut = Measurement {
        segments: vec![
            segment(0, 40_000),
            segment(40_010, 40_100),
            segment(40_200, 80_000),
            still,
        ],
        ..whole.clone()
    };
    let found = identify(&cut, &Settings::default()).unwrap();
    let of = "of 80090 samples do not count";
    assert_said(
        &found,
        &[
            "90 of",
            of,
            "1 of 4 stretches are shorter than the 103 samples",
        ],
    );
    assert_said(
        &found,
        &[
            "200 of",
            of,
            "1 of 4 stretches end before the arm has moved 0.14 rad",
        ],
    );
    assert_said(&found, &[of, "2 of 4 stretches begin to count once"]);
    let found = identify(&whole, &Settings::default()).unwrap();
    assert!(!found.warnings.iter().any(|w| w.contains("count")));
}

/// Values whose squares overflow are refused rather than passed on as no numbers.
#[test]
fn results_are_numbers() {
    let mut measurement = measure(&plain(), 10.0, 1e-3, 5);
    for torque in &mut measurement.segments[0].torque {
        *torque *= 1e200;
    }
    let error = identify(&measurement, &Settings::default()).unwrap_err();
    assert!(matches!(error, Error::Result { .. }), "{error}");
}
