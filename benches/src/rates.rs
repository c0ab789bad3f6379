//! What planning at the feedback's rate buys, and what a late plan costs: closed loops in process.

mod figure;

use std::path::PathBuf;

use arm::Parameters;
use clap::Args;
use control::Settings;

use crate::Failure;
use crate::closed_loop::Loop;
use crate::closed_loop::rates::{self, PENDULUM, Run, SECONDS, TFLEX};
use crate::output::save_figure;
use crate::statistics::aligned;

/// Rates of the plans \[Hz\].
const RATES: [f64; 4] = [20.0, 200.0, 1000.0, 4000.0];
/// How late plans are \[s\].
const LATENCIES: [f64; 3] = [0.01, 0.025, 0.05];
/// Show what planning at up to 4 kHz buys, and what late plans cost
///
/// Closed loops of controller and arm over 10 s, both arms: a setpoint a second, and a push from 2 s to 6 s at rest
/// (1 N.m on the T-flex, 2 N.m on the pendulum). Plans have N = 40 intervals over 2 s, the first one a
/// period long. Then steps of the T-flex by plans that apply some time after their measurement, with the state
/// predicted to that time and without (nmpc.latency, nmpc.models_latency).
///
/// Scores are squared errors summed over the samples; the excess is that of the thermal load over the plans' limit,
/// at the instants of the plans. The pendulum's controller is wrong about the arm by 8 % in stiffness and 3 % in
/// inertia (eq 32), but for "known", the same setpoints with a controller that is right. Nothing here depends on the machine.
#[derive(Args)]
pub struct Options {
    /// Where the figure goes (SVG) [default: dist/benches/rates.svg in the workspace]
    #[arg(long)]
    figure: Option<PathBuf>,
}

/// A closed loop and what it is asked to do.
struct Task {
    name: String,
    settings: Settings,
    arm: Parameters,
    /// Angle at the start \[rad\].
    start: f64,
    /// Setpoint \[rad\] and push \[N·m\] at a time \[s\].
    at: fn(f64) -> [f64; 2],
}

fn tasks() -> [Task; 5] {
    let task = |name: &str, settings, arm, start, at| Task {
        name: name.to_owned(),
        settings,
        arm,
        start,
        at,
    };
    let (tflex, pendulum) = (Parameters::tflex(), Parameters::pendulum());
    let knowing = Settings {
        arm: pendulum,
        ..Settings::pendulum()
    };
    [
        task("T-flex, setpoints", Settings::tflex(), tflex, 1.3, |t| {
            rates::setpoint(&TFLEX, t)
        }),
        task("T-flex, push", Settings::tflex(), tflex, 1.2, |t| {
            rates::push(1.2, 1.0, t)
        }),
        task(
            "pendulum, setpoints",
            Settings::pendulum(),
            pendulum,
            0.785,
            |t| rates::setpoint(&PENDULUM, t),
        ),
        task("pendulum, known", knowing, pendulum, 0.785, |t| {
            rates::setpoint(&PENDULUM, t)
        }),
        task(
            "pendulum, push",
            Settings::pendulum(),
            pendulum,
            0.785,
            |t| rates::push(0.785, 2.0, t),
        ),
    ]
}

impl Task {
    /// What it led to, and (time \[s\], setpoint − θ \[rad\]) of every tenth sample.
    fn run(&self) -> (Run, Vec<(f64, f64)>) {
        let (mut errors, mut sample) = (Vec::new(), 0_u32);
        let closed_loop = Loop::new(&self.settings, self.arm, self.start);
        let run = rates::run(closed_loop, &self.settings, self.at, |time, error| {
            if sample % 10 == 0 {
                errors.push((time, error));
            }
            sample += 1;
        });
        (run, errors)
    }
}

/// Runs all, prints the tables, draws the figure.
pub fn run(options: &Options) -> Result<(), Failure> {
    println!("Planning at the rate of the feedback, N = 40 over 2 s\n");
    let mut rows = vec![
        [
            "",
            "plans",
            "score",
            "to 20 Hz",
            "iterated",
            "iterations",
            "most",
            "excess",
            "violations",
            "unsolved",
        ]
        .map(str::to_owned)
        .to_vec(),
    ];
    let mut pushes = Vec::new();
    for index in 0..tasks().len() {
        let mut paper = f64::NAN;
        for rate in RATES {
            let Some(task) = tasks().into_iter().nth(index) else {
                continue;
            };
            let task = Task {
                settings: rates::every(1.0 / rate, task.settings),
                ..task
            };
            eprint!("\r{:<24}{rate:>6} Hz ", task.name);
            let (run, errors) = task.run();
            if rate == RATES[0] {
                paper = run.score;
            }
            rows.push(vec![
                format!("{}, {rate} Hz", task.name),
                run.plans.to_string(),
                format!("{:.3}", run.score),
                format!("{:.3}", run.score / paper),
                run.iterated.to_string(),
                format!("{:.1}", run.mean_iterations()),
                run.most_iterations.to_string(),
                format!("{:+.1e} A²", run.excess),
                run.violations.to_string(),
                run.unsolved.to_string(),
            ]);
            if task.name.ends_with("push") {
                pushes.push((task.name, rate, errors));
            }
        }
    }
    eprintln!("\r{:40}", "");
    println!("{}\n", aligned(&rows, &[0]));

    println!(
        "T-flex, 1.30 to 1.10 rad, plans at 20 Hz that apply late: distance from the goal in the last second\n"
    );
    let mut rows = vec![
        ["late", "predicted", "not predicted"]
            .map(str::to_owned)
            .to_vec(),
    ];
    let mut late = Vec::new();
    for latency in LATENCIES {
        let [predicted, ignored] = [true, false].map(|models_latency| {
            let mut settings = Settings::tflex();
            settings.nmpc.latency = latency;
            settings.nmpc.models_latency = models_latency;
            let task = Task {
                name: "T-flex, late".to_owned(),
                settings,
                arm: Parameters::tflex(),
                start: 1.3,
                at: |_| [1.1, 0.0],
            };
            task.run().1
        });
        let left = |errors: &[(f64, f64)]| {
            let last = errors.iter().filter(|(time, _)| *time >= SECONDS - 1.0);
            last.fold(0.0, |most: f64, (_, error)| most.max(error.abs()))
        };
        rows.push(vec![
            format!("{} ms", 1e3 * latency),
            format!("{:.1e} rad", left(&predicted)),
            format!("{:.1e} rad", left(&ignored)),
        ]);
        late = vec![
            ("50 ms late, predicted", predicted),
            ("50 ms late, not predicted", ignored),
        ];
    }
    println!("{}\n", aligned(&rows, &[0]));

    let svg = figure::draw(&pushes, &late)?;
    save_figure(options.figure.as_deref(), "rates.svg", &svg)
}
