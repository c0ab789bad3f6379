//! What the linear model costs and saves beside the nonlinear one, and what it cannot see.

use std::time::Duration;

use arm::Parameters;
use clap::Args;
use control::Settings;
use control::nmpc::plan::{PlanStatus, PlannerState};
use control::nmpc::planner::Planner;
use control::nmpc::problem::{Initial, Model};
use control::nmpc::rollout::Rollout;
use control::nmpc::solver::THERMAL_TOLERANCE;
use control::nmpc::transcription::Transcription;

use crate::Failure;
use crate::closed_loop::Loop;
use crate::closed_loop::rates::{PENDULUM, SECONDS, TFLEX, setpoint};
use crate::planners::draw::{RANDOM, Uniform};
use crate::planners::{ARMS, of, settings};
use crate::statistics::{Durations, aligned, text, time};

/// Show what the quadratic programme of appendix C gives beside the nonlinear problem
///
/// Closed loops of controller and arm over 10 s, a setpoint a second: squared error summed over the samples, the worst
/// share of the motor's thermal limit, samples beyond a limit, plans neither solved nor of the least excess. Then cold plans from random starts: the
/// cost of what is planned, in the nonlinear model and relative to that of the first row, on the starts that all rows
/// but the last solve within the thermal limit; and the time of a call, the least of three.
///
/// The linear model knows no heat. With the thermal limit on it keeps to the torque that the motor gives for ever; in
/// the last row that limit is off and the peak torque alone is kept.
#[derive(Args)]
pub struct Options {
    /// Cold plans of each row
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..))]
    count: u32,
    /// Seed of the starts
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Model, solver, and whether the plans keep the thermal limit.
const ROWS: [(&str, Model, &str, bool); 4] = [
    ("nonlinear, riccati", Model::Nonlinear, "riccati", true),
    ("nonlinear, clarabel", Model::Nonlinear, "clarabel", true),
    ("qp, clarabel", Model::Qp, "clarabel", true),
    ("qp, clarabel, peak torque", Model::Qp, "clarabel", false),
];

fn controller(arm: &str, row: usize) -> Result<Settings, Failure> {
    let (_, model, solver, thermal_limit) = ROWS[row];
    let mut settings = settings(arm, solver)?;
    settings.nmpc.model = model;
    settings.nmpc.thermal_limit = thermal_limit;
    Ok(settings)
}

/// What a closed loop led to.
struct Tracked {
    /// Σ (goal − θ)² over the samples \[rad²\].
    score: f64,
    /// Largest share of the motor's thermal limit.
    fraction: f64,
    violations: u32,
    unsolved: u32,
}

fn track(arm: &str, settings: &Settings) -> Tracked {
    let (plant, start, sequence) = if arm == "tflex" {
        (Parameters::tflex(), 1.3, TFLEX)
    } else {
        (
            Parameters::pendulum(),
            std::f64::consts::FRAC_PI_4,
            PENDULUM,
        )
    };
    let mut closed_loop = Loop::new(settings, plant, start);
    let mut tracked = Tracked {
        score: 0.0,
        fraction: 0.0,
        violations: 0,
        unsolved: 0,
    };
    for sample in 0..(SECONDS / settings.sample_period).round() as u32 {
        let [goal, _] = setpoint(&sequence, f64::from(sample) * settings.sample_period);
        tracked.score += (goal - closed_loop.motion.angle).powi(2);
        let command = closed_loop.step(goal, 0.0);
        let fraction = closed_loop.motion.thermal_load / settings.motor.thermal_limit();
        tracked.fraction = tracked.fraction.max(fraction);
        tracked.violations += u32::from(closed_loop.violates());
        let solved = matches!(
            command.plan_status,
            PlanStatus::Solved | PlanStatus::GoalProjected | PlanStatus::ThermalSlack
        );
        tracked.unsolved += u32::from(command.new_plan && !solved);
    }
    tracked
}

/// A cold plan.
struct Cold {
    /// In the nonlinear model; none: not solved, or beyond the thermal limit there.
    cost: Option<f64>,
    best: Duration,
}

/// Plans from every start.
fn plan(planner: &mut Planner, model: &mut Transcription, starts: &[(Initial, f64)]) -> Vec<Cold> {
    let mut rollout = Rollout::new(model.problem().horizon);
    let nothing = PlannerState::default();
    let of_start = |(initial, goal): &(Initial, f64)| {
        let calls = (0..3).map(|_| {
            planner.set_state(&nothing);
            time(|| planner.plan(initial, *goal).iterations).0
        });
        let best = calls.min().unwrap_or_default();
        let plan = planner.latest();
        model.set(*initial, *goal);
        model.roll_out(&plan.moves, &mut rollout);
        let kept = plan.status == PlanStatus::Solved && rollout.excess <= THERMAL_TOLERANCE;
        Cold {
            cost: kept.then_some(rollout.cost),
            best,
        }
    };
    starts.iter().map(of_start).collect()
}

/// Measures all and prints the tables.
pub fn run(options: &Options) -> Result<(), Failure> {
    println!(
        "Models of the plan, N = 40, {} cold plans each\n",
        options.count
    );
    for arm in ARMS {
        let settings: Vec<Settings> = (0..ROWS.len())
            .map(|row| controller(arm, row))
            .collect::<Result<_, _>>()?;
        let mut planners: Vec<Planner> = settings.iter().map(of).collect::<Result<_, _>>()?;
        let problem = *planners[0].problem();
        let mut model = Transcription::new(problem, settings[0].nmpc.instructions);
        let mut uniform = Uniform(options.seed);
        let starts: Vec<_> = (0..options.count)
            .map(|_| uniform.start(&problem, &RANDOM))
            .collect();
        let plans: Vec<Vec<Cold>> = planners
            .iter_mut()
            .map(|planner| plan(planner, &mut model, &starts))
            .collect();
        let compared: Vec<usize> = (0..starts.len())
            .filter(|&i| plans[..3].iter().all(|row| row[i].cost.is_some()))
            .collect();

        let mut rows = vec![
            [
                arm,
                "squared error",
                "thermal load",
                "violations",
                "unsolved",
                "plans kept",
                "cost, mean",
                "cost, worst",
                "median",
                "max",
            ]
            .map(str::to_owned)
            .to_vec(),
        ];
        for (row, settings) in settings.iter().enumerate() {
            eprint!("\r{arm}, {:<30}", ROWS[row].0);
            let tracked = track(arm, settings);
            let kept = plans[row].iter().filter(|plan| plan.cost.is_some()).count();
            let ratios = compared
                .iter()
                .filter_map(|&i| Some(plans[row][i].cost? / plans[0][i].cost?));
            let (sum, worst, n) = ratios.fold((0.0, 0.0, 0), |(sum, worst, n), ratio| {
                (sum + ratio, f64::max(worst, ratio), n + 1)
            });
            let times = Durations::new(plans[row].iter().map(|plan| plan.best).collect());
            rows.push(vec![
                ROWS[row].0.to_owned(),
                format!("{:.1}", tracked.score),
                format!("{:.3}", tracked.fraction),
                tracked.violations.to_string(),
                tracked.unsolved.to_string(),
                kept.to_string(),
                format!("{:.4}", sum / f64::from(n.max(1))),
                format!("{worst:.4}"),
                text(times.quantile(0.5)),
                text(times.quantile(1.0)),
            ]);
        }
        eprintln!("\r{:40}", "");
        println!("{}\n", aligned(&rows, &[0]));
    }
    Ok(())
}
