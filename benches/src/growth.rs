//! How the cost of a plan grows with the number of intervals.

mod figure;

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use control::nmpc::plan::{PlanStatus, PlannerState};
use control::nmpc::planner::Planner;
use control::nmpc::problem::Initial;

use crate::Failure;
use crate::machine;
use crate::output::save_figure;
use crate::planners::draw::Uniform;
use crate::planners::{ARMS, classes, of, settings};
use crate::statistics::{Durations, aligned, time};

/// N, numbers of intervals; the horizon stays 2 s.
const HORIZONS: [i32; 6] = [10, 20, 40, 80, 160, 320];
const SECONDS: f64 = 2.0;
/// Who solves what, and how often each plan is made.
const SOLVERS: [(&str, u32); 2] = [("riccati", 20), ("clarabel", 3)];
/// Starts that are drawn in search of such as stay what they are for every N.
const DRAWN: u32 = 400;

/// Measure how plans get dearer with the number of intervals N
///
/// N = 10, 20, 40, 80, 160, 320. The horizon stays 2 s and the period shrinks, so that it is the same motion in
/// ever finer steps. Starts are drawn once; only those are used that for every N are solved in closed form, or
/// for every N end at a limit. They have no tracking error, so the feedback, which RK4 cannot follow at N = 10,
/// is left out of the model; it changes nothing.
///
/// Prints medians over the starts of the least time of several calls: of a plan, of an interval and, where plans
/// are iterated, of an iteration's share of an interval. Exponents of plan and iteration over N are fitted in
/// log-log; 1 is linear. Draws them too.
#[derive(Args)]
pub struct Options {
    /// Starts of each kind and arm
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..))]
    count: u32,
    /// Seed of the starts
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Where the figure goes (SVG) [default: dist/benches/growth.svg in the workspace]
    #[arg(long)]
    figure: Option<PathBuf>,
}

/// Starts of one kind, by one solver.
struct Curve {
    arm: &'static str,
    /// What the plans are.
    kind: String,
    points: Vec<Point>,
}

/// Medians over the starts.
struct Point {
    horizon: i32,
    plan: Duration,
    /// Iterations, and what one takes; none in closed form.
    iteration: Option<(u32, Duration)>,
}

impl Curve {
    /// (N, µs a plan).
    fn plans(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        let point = |p: &Point| (f64::from(p.horizon), micros(p.plan));
        self.points.iter().map(point)
    }

    /// (N, µs an iteration); none in closed form.
    fn iterations(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        let point = |p: &Point| Some((f64::from(p.horizon), micros(p.iteration?.1)));
        self.points.iter().filter_map(point)
    }
}

fn micros(duration: Duration) -> f64 {
    1e6 * duration.as_secs_f64()
}

/// Measures, prints and draws.
pub fn run(options: &Options) -> Result<(), Failure> {
    let mut curves = Vec::new();
    for arm in ARMS {
        eprintln!("{arm}: looking for starts ...");
        let [closed, limited] = starts(arm, options)?;
        let count = limited.len();
        for (solver, repeats) in SOLVERS {
            eprintln!("{arm}: {solver} ...");
            if solver == SOLVERS[0].0 {
                curves.push(curve(
                    arm,
                    solver,
                    "closed form".to_owned(),
                    &closed,
                    repeats,
                )?);
            }
            let kind = format!("at a limit, {solver}");
            curves.push(curve(arm, solver, kind, &limited, repeats)?);
        }
        eprintln!(
            "{arm}: {} starts in closed form, {count} at a limit",
            closed.len()
        );
    }
    println!("{}", machine());
    println!("A plan over {SECONDS} s in N intervals, cold; medians over the starts\n");
    println!("{}", aligned(&table(&curves), &[0, 1]));
    let svg = figure::draw(&curves)?;
    save_figure(options.figure.as_deref(), "growth.svg", &svg)
}

/// A planner of N intervals over the same horizon.
fn planner(arm: &str, solver: &str, horizon: i32) -> Result<Planner, Failure> {
    let mut settings = settings(arm, solver)?;
    settings.nmpc.horizon = horizon;
    settings.nmpc.period = SECONDS / f64::from(horizon);
    settings.nmpc.models_feedback = false;
    of(&settings)
}

type Start = (Initial, f64);

/// Starts that for every N are planned in closed form, and such that for every N are iterated.
fn starts(arm: &str, options: &Options) -> Result<[Vec<Start>; 2], Failure> {
    let mut planners = Vec::new();
    for horizon in HORIZONS {
        planners.push(planner(arm, SOLVERS[0].0, horizon)?);
    }
    let [random, starved, ..] = classes(arm);
    let mut found = [Vec::new(), Vec::new()];
    for (class, kind) in [(random, 0), (starved, 1)] {
        let mut uniform = Uniform(options.seed);
        for _ in 0..DRAWN {
            let (mut initial, goal) = uniform.start(planners[0].problem(), &class);
            (initial.angle, initial.velocity) =
                (initial.reference_angle, initial.reference_velocity);
            let same = planners.iter_mut().all(|planner| {
                planner.set_state(&PlannerState::default());
                let plan = planner.plan(&initial, goal);
                plan.status == PlanStatus::Solved && (plan.iterations > 0) == (kind == 1)
            });
            if same && found[kind].len() < options.count as usize {
                found[kind].push((initial, goal));
            }
        }
        if found[kind].is_empty() {
            return Err(format!(
                "no start of the {arm} stays {} for every N",
                ["in closed form", "at a limit"][kind]
            )
            .into());
        }
    }
    Ok(found)
}

fn curve(
    arm: &'static str,
    solver: &str,
    kind: String,
    starts: &[Start],
    repeats: u32,
) -> Result<Curve, Failure> {
    let mut points = Vec::new();
    for horizon in HORIZONS {
        let mut planner = planner(arm, solver, horizon)?;
        let (mut plans, mut each, mut counts) = (Vec::new(), Vec::new(), Vec::new());
        for (initial, goal) in starts {
            let (mut best, mut iterations) = (Duration::MAX, 0);
            for _ in 0..repeats {
                planner.set_state(&PlannerState::default());
                let duration;
                (duration, iterations) = time(|| planner.plan(initial, *goal).iterations);
                best = best.min(duration);
            }
            plans.push(best);
            counts.push(iterations);
            each.push(best / iterations.max(1));
        }
        counts.sort_unstable();
        let iterations = counts[counts.len() / 2];
        points.push(Point {
            horizon,
            plan: Durations::new(plans).quantile(0.5),
            iteration: (iterations > 0).then(|| (iterations, Durations::new(each).quantile(0.5))),
        });
    }
    Ok(Curve { arm, kind, points })
}

fn table(curves: &[Curve]) -> Vec<Vec<String>> {
    let head = [
        "arm",
        "plans",
        "N",
        "us a plan",
        "us an interval",
        "iterations",
        "us an iteration and interval",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for curve in curves {
        for point in &curve.points {
            let n = f64::from(point.horizon);
            let plan = micros(point.plan);
            let [iterations, each] = match point.iteration {
                Some((count, each)) => [count.to_string(), format!("{:.3}", micros(each) / n)],
                None => [String::new(), String::new()],
            };
            rows.push(vec![
                curve.arm.to_owned(),
                curve.kind.clone(),
                point.horizon.to_string(),
                format!("{plan:.2}"),
                format!("{:.3}", plan / n),
                iterations,
                each,
            ]);
        }
        let text = |exponent: Option<f64>| exponent.map_or(String::new(), |p| format!("{p:.2}"));
        rows.push(vec![
            curve.arm.to_owned(),
            curve.kind.clone(),
            "exponent".to_owned(),
            text(exponent(curve.plans())),
            String::new(),
            String::new(),
            text(exponent(curve.iterations())),
        ]);
    }
    rows
}

/// p of y ~ x^p by least squares in log-log; none for fewer than two points.
fn exponent(points: impl Iterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    let logs = points.map(|(x, y)| (x.ln(), y.ln()));
    let count = logs.clone().count() as f64;
    if count < 2.0 {
        return None;
    }
    let mean = |of: fn((f64, f64)) -> f64| logs.clone().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let sums = logs.clone().fold((0.0, 0.0), |(xy, xx), (a, b)| {
        (xy + (a - x) * (b - y), xx + (a - x) * (a - x))
    });
    Some(sums.0 / sums.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_powers() {
        let cubic = [1.0, 2.0, 5.0_f64].map(|x| (x, 7.0 * x.powi(3)));
        let found = exponent(cubic.into_iter());
        assert!(found.is_some_and(|p| (p - 3.0).abs() < 1e-12));
        assert_eq!(exponent([(1.0, 1.0)].into_iter()), None);
    }
}
