//! `flexarm identify` from files: what is read, what is refused and why, what is written.
#![cfg(target_os = "linux")]

mod common;

use common::cli::*;
use std::fmt::Write;
use std::fs;
use std::path::Path;

const PERIOD: f64 = 1e-3;

const IDENTIFY: [&str; 7] = [
    "identify",
    "--measurement",
    "m.csv",
    "--torque-timing",
    "sampled",
    "-o",
    "out",
];

/// Angle and torque of an arm J = 0.2, d = 0.1, k = 3, o = −1, without friction and cogging: exact but for a
/// small noise.
fn signals(samples: usize) -> Vec<[f64; 3]> {
    (0..samples)
        .map(|k| {
            let t = k as f64 * PERIOD;
            let (mut angle, mut velocity, mut acceleration) = (0.2, 0.0, 0.0);
            for (amplitude, omega) in [(0.5, 2.0), (0.2, 7.3), (0.05, 17.1)] {
                let (sin, cos) = f64::sin_cos(omega * t);
                angle += amplitude * sin;
                velocity += amplitude * omega * cos;
                acceleration -= amplitude * omega * omega * sin;
            }
            let noise = 1e-3 * ((k * 7919 % 1009) as f64 / 504.0 - 1.0);
            let torque = 0.2 * acceleration + 0.1 * velocity + 3.0 * angle - 1.0 + noise;
            [t, angle, torque]
        })
        .collect()
}

fn csv(header: &str, rows: impl IntoIterator<Item = Vec<f64>>) -> String {
    let mut text = format!("{header}\n");
    for row in rows {
        let row: Vec<String> = row.iter().map(|v| format!("{v:?}")).collect();
        let _ = writeln!(text, "{}", row.join(","));
    }
    text
}

fn plain(samples: usize) -> String {
    csv(
        "time,angle,torque",
        signals(samples).into_iter().map(|r| r.to_vec()),
    )
}

/// Identifies `text`; the value of each parameter, or the message.
fn identify(text: &str, more: &[&str]) -> Result<Vec<(String, f64)>, String> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("m.csv"), text).unwrap();
    let output = flexarm(folder.path(), &[&IDENTIFY, more].concat());
    if !output.status.success() {
        assert_eq!(output.status.code(), Some(2), "{}", errors(&output));
        assert!(
            !folder.path().join("out").exists(),
            "a refusal leaves nothing"
        );
        return Err(errors(&output));
    }
    let names: Vec<_> = fs::read_dir(folder.path().join("out"))
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(names.len(), 3, "{names:?}");
    Ok(parameters(&folder.path().join("out")))
}

fn parameters(out: &Path) -> Vec<(String, f64)> {
    let json = fs::read_to_string(out.join("identification.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let list = json["parameters"].as_array().unwrap();
    list.iter()
        .map(|p| {
            (
                p["name"].as_str().unwrap().to_owned(),
                p["value"].as_f64().unwrap(),
            )
        })
        .collect()
}

fn assert_found(found: &[(String, f64)]) {
    let truth = [
        ("arm.inertia", 0.2, 1e-3),
        ("arm.damping", 0.1, 2e-3),
        ("arm.stiffness", 3.0, 1e-2),
        ("arm.offset", -1.0, 3e-3),
        ("arm.hysteresis", 0.0, 1e-3),
    ];
    assert_eq!(found.len(), truth.len(), "no harmonics: {found:?}");
    for ((name, value), (expected, truth, tolerance)) in found.iter().zip(truth) {
        assert_eq!(name, expected);
        assert!((value - truth).abs() < tolerance, "{name}: {value}");
    }
}

#[test]
fn torque_current_degrees_and_other_names_mean_the_same() {
    assert_found(&identify(&plain(12_000), &[]).unwrap());
    let converted = signals(12_000)
        .into_iter()
        .map(|[t, angle, torque]| vec![7.0, angle.to_degrees(), torque / 5.57, 100.0 + t]);
    let text = csv("other,Encoder1,Iq,seconds", converted);
    let options = [
        "--torque-constant",
        "5.57",
        "--angle-unit",
        "deg",
        "--column",
        "angle=Encoder1",
        "--column",
        "current=Iq",
        "--column",
        "time=seconds",
    ];
    assert_found(&identify(&text, &options).unwrap());
}

#[test]
fn rounded_times_and_gaps_are_understood() {
    let rows = signals(14_000).into_iter().enumerate();
    let kept = rows.filter(|(k, _)| !(5000..5700).contains(k));
    let rounded = kept.map(|(k, [t, angle, torque])| {
        // 0.2 ms of rounding, and a start far from zero.
        let jitter = [0.0, 1e-4, -1e-4][k % 3];
        vec![1e4 + t + jitter, angle, torque]
    });
    assert_found(&identify(&csv("time,angle,torque", rounded), &[]).unwrap());
}

#[test]
fn mistakes_are_named_with_file_line_and_column() {
    let good = plain(3000);
    let change = |line: usize, to: &str| {
        let mut lines: Vec<&str> = good.lines().collect();
        lines[line - 1] = to;
        lines.join("\n")
    };
    for (text, message) in [
        (String::new(), "m.csv:1: no column time; there are: "),
        (
            good.replacen("angle", "phi", 1),
            "m.csv:1: no column angle; there are: time, phi, torque",
        ),
        (
            good.replacen("torque", "tau", 1),
            "m.csv:1: no column torque or current; there are: time, angle, tau",
        ),
        (
            good.replacen("torque", "current", 1),
            "m.csv:1: column current needs --torque-constant, in N.m/A",
        ),
        ("time,angle,torque\n".to_owned(), "m.csv:1: no rows"),
        (
            change(7, "0.005,NaN,1"),
            r#"m.csv:7: angle = "NaN": expected a finite number"#,
        ),
        (
            change(7, "0.005,0.1,"),
            r#"m.csv:7: torque = "": expected a finite number"#,
        ),
        (
            change(7, "0.005,1"),
            "m.csv:7: 2 values, but the header names 3 columns",
        ),
        (
            change(7, "0.004,0.1,1"),
            "m.csv:7: time = 0.004 s does not come after 0.004 s: times must increase",
        ),
        (
            change(7, "0.0045,0.1,1"),
            "m.csv:7: time = 0.0045 s comes 5.000e-4 s after 0.004 s: times must be multiples of the period, 1.000e-3 s, apart",
        ),
    ] {
        let found = identify(&text, &[]).unwrap_err();
        assert_eq!(found, format!("error: {message}\n"));
    }
}

#[test]
fn wrong_units_are_recognised() {
    let rows = || signals(3000).into_iter();
    let degrees = csv(
        "time,angle,torque",
        rows().map(|[t, a, torque]| vec![t, a.to_degrees(), torque]),
    );
    let message = identify(&degrees, &[]).unwrap_err();
    assert!(
        message.contains("are these degrees (--angle-unit deg)?"),
        "{message}"
    );
    let milliseconds = csv(
        "time,angle,torque",
        rows().map(|[t, a, torque]| vec![1e3 * t, a, torque]),
    );
    let message = identify(&milliseconds, &[]).unwrap_err();
    assert!(message.contains("is time not in s?"), "{message}");
    let still = csv("time,angle,torque", rows().map(|[t, a, _]| vec![t, a, 1.5]));
    let message = identify(&still, &[]).unwrap_err();
    assert_eq!(message, "error: m.csv: torque is 1.5 N.m all the time\n");
    let reversed = csv(
        "time,angle,torque",
        rows().map(|[t, a, torque]| vec![t, -a, torque]),
    );
    let message = identify(&reversed, &[]).unwrap_err();
    assert!(message.contains("opposite signs"), "{message}");
}

#[test]
fn too_little_is_refused_by_name() {
    let message = identify(&plain(100), &[]).unwrap_err();
    assert!(
        message.starts_with("error: m.csv: the measurement is too short: 100 samples of 0.001 s"),
        "{message}"
    );
    let rest = signals(3000)
        .into_iter()
        .map(|[t, _, torque]| vec![t, 0.3, torque]);
    let message = identify(&csv("time,angle,torque", rest), &[]).unwrap_err();
    assert!(
        message.contains("tell arm.inertia, arm.damping, arm.hysteresis apart"),
        "{message}"
    );
}

#[test]
fn options_are_checked() {
    let good = plain(3000);
    for (more, message) in [
        (
            &["--frequency-range", "5", "2"][..],
            "--frequency-range = 5 2: expected two positive numbers in 1/rad, the lower one first",
        ),
        (
            &["--column", "angel=angle"][..],
            "--column = angel=angle: expected one of time, angle, torque, current, reference, feedforward_torque, \
             feedback_torque",
        ),
        (
            &["--column", "angle=phi"][..],
            "m.csv:1: no column phi; there are: time, angle, torque",
        ),
        (
            &["--harmonics", "10"][..],
            "invalid value '10' for '--harmonics <N>'",
        ),
        (
            &["--lower", "1"][..],
            "'--measurement <CSV>' cannot be used with '--lower <RAD>'",
        ),
        (&["--seed", "1"][..], "cannot be used with '--seed <N>'"),
        (
            &["--controller", "c.fmu"][..],
            "cannot be used with '--controller <FMU>'",
        ),
        (
            &["--torque-constant", "3"][..],
            "m.csv:1: column torque is a torque, which --torque-constant = 3 N.m/A has no use for",
        ),
        (
            &["--harmonics", "0", "--frequency-range", "5", "6"][..],
            "--harmonics = 0: expected at least 1 with --frequency-range",
        ),
        (
            &["--frequency-range", "1e4", "2e4"][..],
            "m.csv: the range of cogging frequencies, 10000 to 20000 1/rad, is beyond",
        ),
    ] {
        let found = identify(&good, more).unwrap_err();
        assert!(found.contains(message), "{found}");
    }
}

/// How a measurement is read means nothing to experiments.
#[test]
fn experiments_take_no_options_of_measurements() {
    let folder = folder();
    for option in [
        "--validation",
        "--torque-constant",
        "--angle-unit",
        "--torque-timing",
        "--column",
    ] {
        let value = match option {
            "--angle-unit" => "deg",
            "--torque-timing" => "sampled",
            "--torque-constant" => "3",
            _ => "a=b",
        };
        let pair = ["identify", "--plant", "p.fmu", "--controller", "c.fmu"];
        let output = flexarm(folder.path(), &[&pair[..], &[option, value]].concat());
        assert_eq!(output.status.code(), Some(2));
        let found = errors(&output);
        let expected = format!("'--plant <FMU>' cannot be used with '{option} ");
        assert!(found.contains(&expected), "{found}");
    }
}

/// A parameter at its bound has its error, and every number of the file is one.
#[test]
fn numbers_are_written_with_their_errors() {
    let folder = tempfile::tempdir().unwrap();
    let rows = signals(12_000).into_iter().map(|[t, angle, torque]| {
        // Damping turned round.
        let (mut velocity, h) = (0.0, 1e-6);
        for (amplitude, omega) in [(0.5, 2.0), (0.2, 7.3), (0.05, 17.1)] {
            velocity +=
                amplitude * (f64::sin(omega * (t + h)) - f64::sin(omega * (t - h))) / (2.0 * h);
        }
        vec![t, angle, torque - 0.3 * velocity]
    });
    let kept = rows
        .enumerate()
        .filter(|(k, _)| !(6000..6010).contains(k) && !(6030..6100).contains(k));
    let text = csv("time,angle,torque", kept.map(|(_, row)| row));
    fs::write(folder.path().join("m.csv"), text).unwrap();
    let output = flexarm(folder.path(), &IDENTIFY);
    assert!(output.status.success(), "{}", errors(&output));
    let found = errors(&output);
    assert!(
        found.contains("arm.damping is not identifiable from this measurement: it would be -2.0"),
        "{found}"
    );
    assert!(
        found.contains("20 of 11920 samples do not count, since 1 of 3 stretches are shorter"),
        "{found}"
    );
    let text = fs::read_to_string(folder.path().join("out/identification.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let damping = &json["parameters"][1];
    assert_eq!(
        (&damping["value"], &damping["identifiable"]),
        (&0.0.into(), &false.into())
    );
    assert!(damping["sigma"].as_f64().unwrap() > 0.0);
    // What there is none of, rather than a number that is none.
    for line in text.lines().filter(|line| line.contains("null")) {
        let absent = ["tracking_rms_rad", "validation", "feedback_alone", "tube"];
        assert!(absent.iter().any(|name| line.contains(name)), "{line}");
    }
}

/// A controller that cannot follow a profile, and a range the wrong way round.
#[test]
fn experiments_need_our_controller_and_a_range() {
    let folder = folder();
    let run = |lower: &str, upper: &str| {
        let arguments = [
            "identify",
            "--plant",
            "p.fmu",
            "--controller",
            "c.fmu",
            "--connections",
            "m.toml",
            "--lower",
            lower,
            "--upper",
            upper,
            "-o",
            "out",
        ];
        let output = flexarm(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(!folder.path().join("out").exists());
        errors(&output)
    };
    let message = run("0", "1");
    assert!(
        message.contains("controller has no variable reference.source")
            && message.contains("FlexArmController"),
        "{message}"
    );
    let message = run("1", "0");
    assert_eq!(
        message,
        "error: --upper = 0: expected an angle in rad above --lower = 1\n"
    );
}
