//! Directional and adjoint derivatives of x' = (u − x)/τ and twice = 2·u.

use crate::session::*;
use crate::toy::{BIAS, GAIN, SAMPLED, SAMPLES, TAU, TWICE, U, X};

const DER_X: u32 = 3;

fn session(version: Version) -> Session {
    Session::new(version, Kind::ModelExchange)
}

fn close(a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} {b}");
    }
}

/// Jacobian rows [x', 2u], columns [x, u]: [[−1/τ, 1/τ], [0, 2]], in every mode that has states.
#[test]
fn products_with_the_jacobian() {
    for version in BOTH {
        for interface in [Kind::ModelExchange, Kind::CoSimulation] {
            let s = Session::new(version, interface);
            assert_eq!(s.set(TAU, 4.0), OK);
            s.initialize(0.0, None);
            let mut out = [9.0; 2];
            let references: [&[u32]; 2] = [&[DER_X, TWICE], &[X, U]];
            assert_eq!(s.directional(references, &[1.0, 0.0], &mut out), OK);
            close(&out, &[-0.25, 0.0]);
            assert_eq!(s.directional(references, &[2.0, 10.0], &mut out), OK);
            close(&out, &[2.0, 20.0]);
            if version == Version::Fmi3 {
                assert_eq!(s.adjoint(references, &[2.0, 10.0], &mut out), OK);
                close(&out, &[-0.5, 20.5]);
            }
            // The order is the importer's, a state is known and unknown at once, nothing is legal.
            assert_eq!(
                s.directional([&[X, TWICE], &[U, X]], &[3.0, 5.0], &mut out),
                OK
            );
            close(&out, &[5.0, 6.0]);
            assert_eq!(s.directional([&[], &[]], &[], &mut []), OK);
        }
    }
}

/// Before the unit is set up parameters are known too: x = bias, x' = (u − bias)/τ.
#[test]
fn initial_unknowns_by_parameters() {
    for version in BOTH {
        let s = session(version);
        assert_eq!(s.set_reals(&[TAU, BIAS, U], &[4.0, 3.0, 1.0]), OK);
        assert_eq!(s.enter_initialization(0.0, None), OK);
        let mut out = [9.0; 2];
        assert_eq!(
            s.directional([&[X, DER_X], &[BIAS, TAU]], &[1.0, 0.0], &mut out),
            OK
        );
        close(&out, &[1.0, -0.25]);
        assert_eq!(
            s.directional([&[X, DER_X], &[BIAS, TAU]], &[0.0, 1.0], &mut out),
            OK
        );
        close(&out, &[0.0, 0.125]);
        assert_eq!(s.directional([&[DER_X], &[U]], &[1.0], &mut out[..1]), OK);
        close(&out[..1], &[0.25]);
        // Later they are fixed, and the differences have left no trace.
        assert_eq!(s.exit_initialization(), OK);
        assert_eq!(s.directional([&[DER_X], &[X]], &[1.0], &mut out[..1]), OK);
        close(&out[..1], &[-0.25]);
        assert_eq!(
            s.directional([&[DER_X], &[TAU]], &[1.0], &mut out[..1]),
            ERROR
        );
        s.assert_error(&["tau is no known in Event Mode"]);
    }
}

#[test]
fn what_has_no_derivative_is_refused_by_name() {
    for version in BOTH {
        let s = session(version);
        s.initialize(0.0, None);
        let mut out = [0.0; 4];
        for (references, n, message) in [
            (
                [&[SAMPLES][..], &[U][..]],
                1,
                "samples is no unknown in Event Mode",
            ),
            ([&[U][..], &[U][..]], 1, "u is no unknown in Event Mode"),
            (
                [&[X][..], &[SAMPLED][..]],
                1,
                "sampled is no known in Event Mode",
            ),
            ([&[X][..], &[GAIN][..]], 1, "gain is no known in Event Mode"),
            ([&[X][..], &[99][..]], 1, "value reference 99 is unknown"),
        ] {
            assert_eq!(s.directional(references, &[1.0], &mut out[..n]), ERROR);
            s.assert_error(&[message]);
        }
        if version == Version::Fmi3 {
            assert_eq!(
                s.directional([&[X], &[U]], &[1.0, 2.0], &mut out[..1]),
                ERROR
            );
            s.assert_error(&["2 values for 1 knowns"]);
            assert_eq!(s.adjoint([&[X], &[U]], &[1.0], &mut out[..2]), ERROR);
            s.assert_error(&["2 values for 1 knowns"]);
        }
    }
}
