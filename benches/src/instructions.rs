//! Instructions of a plan, counted by valgrind: a figure that neither load nor clock of the machine moves.

use std::process::Command;

use arm::Instructions;
use clap::Args;
use control::nmpc::plan::PlannerState;
use control::nmpc::planner::Planner;
use control::nmpc::problem::Initial;

use crate::Failure;
use crate::planners::draw::{Uniform, following};
use crate::planners::{ARMS, classes, of, settings};
use crate::statistics::aligned;

/// Seed of the starts, and how many of each kind are planned from.
const SEED: u64 = 1;
const STARTS: usize = 10;
/// Rounds over the starts in the two runs whose difference is counted.
const ROUNDS: [u32; 2] = [1, 5];
/// Kinds of plans.
const KINDS: [&str; 3] = ["closed form", "at a limit, cold", "at a limit, warm"];
/// Instruction sets: every processor's, and AVX2 with FMA.
const SETS: [&str; 2] = ["baseline", "fused"];

/// A workload for valgrind: plans, and nothing printed.
#[derive(Args)]
pub struct Work {
    #[arg(long, value_parser = ARMS)]
    arm: String,
    #[arg(long, value_parser = KINDS)]
    kind: String,
    #[arg(long, value_parser = SETS)]
    set: String,
    #[arg(long)]
    rounds: u32,
}

/// A start with what is known of the plan before it.
struct Task {
    known: PlannerState,
    initial: Initial,
    goal: f64,
}

fn set_up(arm: &str, set: &str) -> Result<Planner, Failure> {
    let mut settings = settings(arm, "riccati")?;
    settings.nmpc.instructions = match set {
        "baseline" => Instructions::Baseline,
        _ => Instructions::Fused,
    };
    of(&settings)
}

/// The first starts of a kind.
fn tasks(planner: &mut Planner, arm: &str, kind: &str) -> Vec<Task> {
    let [random, starved, ..] = classes(arm);
    let closed = kind == KINDS[0];
    let mut uniform = Uniform(SEED);
    let mut tasks = Vec::new();
    // A share of the starts is of the kind; bounded in case a change leaves none.
    for _ in 0..100 * STARTS {
        let class = if closed { &random } else { &starved };
        let (mut initial, goal) = uniform.start(planner.problem(), class);
        let mut known = PlannerState::default();
        planner.set_state(&known);
        let mut iterations = planner.plan(&initial, goal).iterations;
        if kind == KINDS[2] {
            known = planner.state().clone();
            initial = following(planner.latest(), &initial);
            iterations = planner.plan(&initial, goal).iterations;
        }
        if tasks.len() == STARTS {
            break;
        }
        if (iterations == 0) == closed {
            tasks.push(Task {
                known,
                initial,
                goal,
            });
        }
    }
    tasks
}

/// Plans from all starts of a kind, again and again; the iterations of a round.
fn plan_all(planner: &mut Planner, tasks: &[Task], rounds: u32) -> u32 {
    let mut iterations = 0;
    for _ in 0..rounds {
        iterations = 0;
        for task in tasks {
            planner.set_state(&task.known);
            iterations += planner.plan(&task.initial, task.goal).iterations;
        }
    }
    iterations
}

/// What valgrind runs.
pub fn work(work: &Work) -> Result<(), Failure> {
    let mut planner = set_up(&work.arm, &work.set)?;
    let tasks = tasks(&mut planner, &work.arm, &work.kind);
    std::hint::black_box(plan_all(&mut planner, &tasks, work.rounds));
    Ok(())
}

/// Counts and prints.
pub fn run() -> Result<(), Failure> {
    let version = match Command::new("valgrind").arg("--version").output() {
        Ok(output) if output.status.success() => String::from_utf8(output.stdout)?,
        _ => {
            println!("Skipped: valgrind is not installed; it counts the instructions.");
            return Ok(());
        }
    };
    println!(
        "Instructions of a plan by the Riccati solver, N = 40, means of up to {STARTS} starts; {version}"
    );
    let mut rows = vec![
        [
            "arm",
            "plans",
            "iterations",
            "baseline",
            "an iteration",
            "fused",
            "an iteration",
        ]
        .map(str::to_owned)
        .to_vec(),
    ];
    for arm in ARMS {
        for kind in KINDS {
            eprintln!("{arm}, {kind} ...");
            let mut row = vec![arm.to_owned(), kind.to_owned()];
            for set in SETS {
                let mut planner = set_up(arm, set)?;
                let tasks = tasks(&mut planner, arm, kind);
                let iterations = f64::from(plan_all(&mut planner, &tasks, 1));
                let count = tasks.len() as f64;
                if tasks.is_empty() {
                    row.extend(["none".to_owned(), String::new(), String::new()]);
                    continue;
                }
                let [few, many] = [
                    count_of(arm, kind, set, ROUNDS[0])?,
                    count_of(arm, kind, set, ROUNDS[1])?,
                ];
                let a_round = (many - few) as f64 / f64::from(ROUNDS[1] - ROUNDS[0]);
                if set == SETS[0] {
                    row.push(format!("{:.1}", iterations / count));
                }
                row.push(format!("{:.0}", a_round / count));
                row.push(match iterations {
                    0.0 => String::new(),
                    iterations => format!("{:.0}", a_round / iterations),
                });
            }
            rows.push(row);
        }
    }
    println!("{}", aligned(&rows, &[0, 1]));
    Ok(())
}

/// Instructions of this program at some work.
fn count_of(arm: &str, kind: &str, set: &str, rounds: u32) -> Result<u64, Failure> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(std::env::current_exe()?)
        .args(["work", "--arm", arm, "--kind", kind, "--set", set])
        .args(["--rounds", &rounds.to_string()])
        .output()?;
    let said = String::from_utf8_lossy(&output.stderr);
    let collected = said
        .lines()
        .find_map(|line| line.split("Collected :").nth(1));
    let count = collected.and_then(|count| count.trim().parse().ok());
    match count {
        Some(count) if output.status.success() => Ok(count),
        _ => Err(format!("valgrind: {said}").into()),
    }
}
