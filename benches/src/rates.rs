//! What planning at the feedback's rate buys, and what a late plan costs: closed loops in process.

mod figure;
#[path = "../../control/tests/common/mod.rs"]
mod plant;

use std::path::PathBuf;

use arm::Parameters;
use clap::Args;
use control::Settings;
use control::nmpc::plan::PlanStatus;

use self::plant::Loop;
use crate::statistics::aligned;
use crate::{Failure, root};

/// Rates of the plans \[Hz\].
const RATES: [f64; 4] = [20.0, 200.0, 1000.0, 4000.0];
/// How late plans are \[s\].
const LATENCIES: [f64; 3] = [0.01, 0.025, 0.05];
/// Length of a run \[s\].
const SECONDS: f64 = 10.0;
/// A setpoint a second \[rad\].
const TFLEX: [f64; 10] = [1.1, 1.4, 1.0, 1.3, 1.45, 0.96, 1.2, 1.5, 1.0, 1.3];
const PENDULUM: [f64; 10] = [0.1, 1.4, 0.4, 1.5, 0.1, 1.5, 0.8, 1.3, 0.2, 1.5];

/// Show what planning at up to 4 kHz buys, and what late plans cost
///
/// Closed loops of controller and arm over 10 s, both arms: a setpoint a second, and a push from 2 s to 6 s at rest
/// (1 N.m on the T-flex, 2 N.m on the pendulum). Plans have N = 40 intervals over 2 s, the first one a
/// period long. Then steps of the T-flex by plans that apply some time after their measurement, with the state
/// predicted to that time and without (nmpc.latency, nmpc.models_latency).
///
/// Scores are squared errors summed over the samples; the excess is that of the thermal load over the plans' limit,
/// at the instants of the plans. The pendulum's controller is wrong about the arm by 8 % in stiffness and 3 % in
/// inertia (eq 32). Nothing here depends on the machine.
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

/// What 10 s of it led to.
struct Run {
    /// (time \[s\], setpoint − θ \[rad\]) of every tenth sample.
    errors: Vec<(f64, f64)>,
    score: f64,
    plans: u32,
    unsolved: u32,
    iterated: u32,
    iterations: u32,
    most_iterations: u32,
    /// \[A²\]
    excess: f64,
    violations: u32,
}

fn push(time: f64, torque: f64) -> f64 {
    if (2.0..6.0).contains(&time) {
        torque
    } else {
        0.0
    }
}

fn tasks() -> [Task; 4] {
    let task = |name: &str, settings, arm, start, at| Task {
        name: name.to_owned(),
        settings,
        arm,
        start,
        at,
    };
    let (tflex, pendulum) = (Parameters::tflex(), Parameters::pendulum());
    [
        task("T-flex, setpoints", Settings::tflex(), tflex, 1.3, |t| {
            [TFLEX[(t as usize).min(9)], 0.0]
        }),
        task("T-flex, push", Settings::tflex(), tflex, 1.2, |t| {
            [1.2, push(t, 1.0)]
        }),
        task(
            "pendulum, setpoints",
            Settings::pendulum(),
            pendulum,
            0.785,
            |t| [PENDULUM[(t as usize).min(9)], 0.0],
        ),
        task(
            "pendulum, push",
            Settings::pendulum(),
            pendulum,
            0.785,
            |t| [0.785, push(t, 2.0)],
        ),
    ]
}

impl Task {
    fn run(&self) -> Run {
        let settings = &self.settings;
        let limit = settings.nmpc.thermal_share.powi(2) * settings.motor.thermal_limit();
        let mut closed_loop = Loop::new(settings, self.arm, self.start);
        let mut run = Run {
            errors: Vec::new(),
            score: 0.0,
            plans: 0,
            unsolved: 0,
            iterated: 0,
            iterations: 0,
            most_iterations: 0,
            excess: f64::NEG_INFINITY,
            violations: 0,
        };
        for sample in 0..(SECONDS / settings.sample_period).round() as u32 {
            let time = f64::from(sample) * settings.sample_period;
            let [setpoint, push] = (self.at)(time);
            let error = setpoint - closed_loop.motion.angle;
            run.score += error * error;
            if sample % 10 == 0 {
                run.errors.push((time, error));
            }
            let command = closed_loop.step(setpoint, push);
            run.violations += u32::from(closed_loop.violates());
            if command.new_plan {
                run.excess = run.excess.max(command.thermal_load - limit);
                let plan = closed_loop.controller.plan();
                run.plans += 1;
                run.iterated += u32::from(plan.iterations > 0);
                run.iterations += plan.iterations;
                run.most_iterations = run.most_iterations.max(plan.iterations);
                run.unsolved += u32::from(!matches!(
                    plan.status,
                    PlanStatus::Solved | PlanStatus::GoalProjected | PlanStatus::ThermalSlack
                ));
            }
        }
        run
    }

    /// The same, planning at `rate` \[Hz\] over 2 s.
    fn at_rate(mut self, rate: f64) -> Self {
        self.settings.nmpc.period = 1.0 / rate;
        self.settings.nmpc.duration = 2.0;
        self
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
            let task = task.at_rate(rate);
            eprint!("\r{:<24}{rate:>6} Hz ", task.name);
            let run = task.run();
            if rate == RATES[0] {
                paper = run.score;
            }
            rows.push(vec![
                format!("{}, {rate} Hz", task.name),
                run.plans.to_string(),
                format!("{:.3}", run.score),
                format!("{:.3}", run.score / paper),
                run.iterated.to_string(),
                format!(
                    "{:.1}",
                    f64::from(run.iterations) / f64::from(run.iterated.max(1))
                ),
                run.most_iterations.to_string(),
                format!("{:+.1e} A²", run.excess),
                run.violations.to_string(),
                run.unsolved.to_string(),
            ]);
            if task.name.ends_with("push") {
                pushes.push((task.name, rate, run.errors));
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
            task.run().errors
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

    let path = match &options.figure {
        Some(path) => path.clone(),
        None => root()?.join("dist/benches/rates.svg"),
    };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    std::fs::write(&path, figure::draw(&pushes, &late)?)?;
    println!("Figure: {}", path.display());
    Ok(())
}
