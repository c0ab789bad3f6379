//! Plans from thousands of seeded starts: who is not solved, how many iterations it takes, what the worst
//! costs.

mod report;

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use control::nmpc::plan::{PlanStatus, PlannerState};
use control::nmpc::planner::Planner;
use control::nmpc::problem::Initial;

use crate::Failure;
use crate::planners::draw::{Uniform, following};
use crate::planners::{ARMS, SOLVERS, classes, planner};
use crate::statistics::time;

/// Plan from thousands of seeded starts of each class, cold and one period later
///
/// Random starts; starved ones, a thermal budget of 0.2 to 3 % left (on the T-flex, whose motor is strong, flung
/// away from the goal at 8 to 16 rad/s); over the thermal limit by up to 0.2 %; far over it, by up to 50 %.
/// Each start is planned cold, knowing nothing; then warm: one period later along that plan; and once more
/// with the setpoint moved in the meantime.
///
/// Prints every status, the iterations as a histogram, the time per start (the least of the repeats: what the
/// plan itself takes) beside that of all single calls (what this machine makes of it), and the worst start of
/// each class as requests that `flexarm-benches serve` repeats. Fails if any plan was left unsolved: a fallback,
/// or not converged, even if its excess is nearly the least, or allowed beyond the angle bounds although it began within.
#[derive(Args)]
pub struct Options {
    /// Starts of each class and arm
    #[arg(long, default_value_t = 5000, value_parser = clap::value_parser!(u32).range(1..))]
    pub count: u32,
    /// Seed of the starts; each class has its own stream
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Calls per plan
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..))]
    pub repeats: u32,
    /// Who solves
    #[arg(long, default_value = "riccati", value_parser = SOLVERS)]
    pub solver: String,
    /// Which arms
    #[arg(long, num_args = 1.., default_values = ARMS, value_parser = ARMS)]
    pub arms: Vec<String>,
    /// File for every plan that is unsolved or above 250 µs, as requests for `flexarm-benches serve`
    #[arg(long, value_name = "FILE")]
    pub save: Option<PathBuf>,
}

/// A start and what came of it.
struct Record {
    /// Start and goal of the cold plan before.
    before: Option<(Initial, f64)>,
    initial: Initial,
    goal: f64,
    status: PlanStatus,
    iterations: u32,
    converged: bool,
    /// Whether it was allowed to leave the angle bounds although it began within.
    widened: bool,
    best: Duration,
}

impl Record {
    /// Whether the plan is the optimum within the bounds, not a fallback or what was left when iterations ended.
    fn is_solved(&self) -> bool {
        use PlanStatus::{AngleSlack, GoalProjected, Solved, ThermalSlack};
        let of_status = matches!(
            self.status,
            Solved | GoalProjected | ThermalSlack | AngleSlack
        );
        of_status && self.converged && !self.widened
    }
}

/// What the plans of each start know, in this order.
const KNOWLEDGE: [&str; 3] = ["cold", "warm", "moved"];

/// All plans of an arm and class that know as much.
struct Group {
    arm: String,
    class: &'static str,
    knowledge: &'static str,
    records: Vec<Record>,
    calls: Vec<Duration>,
}

/// Measures all and reports.
pub fn run(options: &Options) -> Result<(), Failure> {
    let mut groups = Vec::new();
    for arm in &options.arms {
        let mut planner = planner(arm, &options.solver)?;
        for (stream, class) in classes(arm).iter().enumerate() {
            eprintln!("{arm}: {} starts, class {} ...", options.count, class.name);
            // Far apart: SplitMix64 walks in steps of its own.
            let mut uniform = Uniform(options.seed ^ ((stream as u64 + 1) << 32));
            let mut goals = Uniform(!options.seed ^ ((stream as u64 + 1) << 32));
            let [mut cold, mut warm, mut moved] = KNOWLEDGE.map(|knowledge| Group {
                arm: arm.clone(),
                class: class.name,
                knowledge,
                records: Vec::new(),
                calls: Vec::new(),
            });
            for _ in 0..options.count {
                let (initial, goal) = uniform.start(planner.problem(), class);
                let nothing = PlannerState::default();
                cold.measure(&mut planner, &nothing, None, initial, goal, options.repeats);
                let known = planner.state().clone();
                let next = following(planner.latest(), &initial);
                let (_, other) = goals.start(planner.problem(), class);
                let before = Some((initial, goal));
                for (group, goal) in [(&mut warm, goal), (&mut moved, other)] {
                    group.measure(&mut planner, &known, before, next, goal, options.repeats);
                }
            }
            groups.extend([cold, warm, moved]);
        }
    }
    report::print(options, &groups)
}

impl Group {
    /// Plans from `initial`, again and again knowing what is `known` of the plan `before`.
    fn measure(
        &mut self,
        planner: &mut Planner,
        known: &PlannerState,
        before: Option<(Initial, f64)>,
        initial: Initial,
        goal: f64,
        repeats: u32,
    ) {
        let mut best = Duration::MAX;
        for _ in 0..repeats {
            planner.set_state(known);
            let (duration, _) = time(|| planner.plan(&initial, goal).iterations);
            best = best.min(duration);
            self.calls.push(duration);
        }
        let (plan, problem) = (planner.latest(), planner.problem());
        let inside = problem.admits_angle(initial.reference_angle);
        self.records.push(Record {
            before,
            initial,
            goal,
            status: plan.status,
            iterations: plan.iterations,
            // `AngleSlack` also stands for an unfinished plan. Only a Riccati solve that converged leaves
            // multipliers.
            converged: plan.iterations == 0
                || plan.convex_problems > 0
                || planner.state().multipliers.known,
            widened: inside && planner.widened_bounds(),
            best,
        });
    }
}
