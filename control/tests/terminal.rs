//! What plans owe that end in a safe set instead of at rest (appendix B), and what happens to those that may
//! end anywhere (sec 2.4.2).

mod nmpc_arms;
#[path = "nmpc_arms/starts.rs"]
mod starts;

use control::nmpc::plan::PlanStatus;
use control::nmpc::problem::Terminal;
use control::nmpc::settings::Method;
use nmpc_arms::{Arm, pendulum, tflex};
use starts::{Uniform, following, within};

fn with(arm: &Arm, terminal: Terminal, horizon: i32) -> Arm {
    let mut arm = arm.clone();
    arm.settings.terminal = terminal;
    arm.settings.horizon = horizon;
    arm.settings.solver = Method::Clarabel;
    arm
}

#[test]
fn explore() {
    for (name, arm) in [("pendulum", pendulum()), ("tflex", tflex())] {
        for horizon in [5, 10, 20, 40] {
            let begin = std::time::Instant::now();
            let rest = with(&arm, Terminal::RestAtGoal, horizon);
            let safe = with(&arm, Terminal::SafeSet, horizon);
            let (mut equality, mut planner) = (rest.planner(), safe.planner());
            let problem = *planner.problem();
            let mut uniform = Uniform(17);
            let class = within("hot", [0.6, 0.995]);
            let (mut infeasible, mut not_safe) = (0, 0);
            let (mut worst_angle, mut worst_load) = (0.0_f64, 0.0_f64);
            let mut counts = [0; 10];
            let mut plans = 0;
            let mut unsettled = 0;
            for _ in 0..50 {
                let (mut initial, goal) = uniform.start(&problem, &class);
                equality.set_state(&Default::default());
                planner.set_state(&Default::default());
                let plan = equality.plan(&initial, goal);
                infeasible += i32::from(!matches!(plan.status, PlanStatus::Solved));
                let mut first = true;
                let mut settled = false;
                for _ in 0..200 {
                    let plan = planner.plan(&initial, goal);
                    plans += 1;
                    counts[plan.status as usize] += 1;
                    if first && plan.status != PlanStatus::Solved {
                        not_safe += 1;
                        break;
                    }
                    first = false;
                    initial = following(plan, &initial);
                    worst_angle = worst_angle
                        .max(initial.reference_angle - problem.angle_upper)
                        .max(problem.angle_lower - initial.reference_angle);
                    worst_load =
                        worst_load.max(initial.thermal_load - problem.thermal_limit.unwrap());
                    if (initial.angle - goal).abs() < 1e-3 && initial.velocity.abs() < 1e-3 {
                        settled = true;
                        break;
                    }
                }
                unsettled += i32::from(!settled);
            }
            println!(
                "{name} N={horizon}: equality infeasible {infeasible}, safe infeasible {not_safe} of 50; statuses {counts:?}, {plans} plans, angle {worst_angle:.1e}, load {worst_load:.1e}, unsettled {unsettled}, {:?}",
                begin.elapsed()
            );
        }
    }
}
