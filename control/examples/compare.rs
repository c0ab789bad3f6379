use std::time::Instant;
use arm::{Limits, Motor, Parameters};
use control::nmpc::planner::*;
use control::nmpc::problem::*;
use control::nmpc::settings::*;
struct U(u64);
impl U { fn w(&mut self, a: f64, b: f64) -> f64 { self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15); let mut z = self.0; z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9); z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB); z ^= z >> 31; a + (b - a) * ((z >> 11) as f64 / (1_u64 << 53) as f64) } }
fn main() {
    let n: usize = std::env::args().nth(1).map_or(200, |s| s.parse().unwrap());
    let reference = std::env::args().nth(2).is_some();
    for pend in [true, false] {
        let (settings, arm, motor, limits, fb) = if pend {
            (Settings { weights: Weights { angle: 1.0, velocity: 1e-3, integral: 0.0, thermal: 0.0, acceleration: 1e-4 }, ..Settings::default() }, Parameters::pendulum_mismodelled(), Motor::pendulum(), Limits::pendulum(), FeedbackModel { inertia: 1.0, gain_angle: 100.0, gain_velocity: 14.4914, gain_integral: 0.0 })
        } else { (Settings::default(), Parameters::tflex(), Motor::tflex(), Limits::tflex(), FeedbackModel { inertia: 0.0818, gain_angle: 31.62, gain_velocity: 2.756, gain_integral: 0.0 }) };
        let make = |m| Planner::new(&Settings { solver: m, ..settings }, &arm, &motor, &limits, &fb).map_err(|e| e[0].to_string()).unwrap();
        let (mut a, mut b) = (make(Method::Riccati), make(Method::Clarabel));
        let tl = (settings.thermal_share * motor.continuous_current).powi(2);
        for (class, loads) in [("random", [0.0, 0.95]), ("starved", [0.97, 0.998]), ("over .2%", [1.0, 1.002]), ("over 50%", [1.0, 1.5])] {
            let mut u = U(7);
            let (mut times, mut iters, mut bad, mut worst, mut fast, mut worse, mut tb) = (vec![], vec![0; 60], 0, 0.0_f64, 0, 0, vec![]);
            let mut worst_case = (0.0, 0);
            let mut warmt = vec![]; let mut warmi = vec![0; 60];
            for case in 0..n {
                let (lo, hi) = (limits.angle_lower + settings.angle_margin, limits.angle_upper - settings.angle_margin);
                let (angle, goal) = (u.w(lo, hi), u.w(lo, hi));
                let velocity = u.w(lo - hi, hi - lo);
                let load = u.w(loads[0], loads[1]) * tl;
                let init = Initial { angle: angle + u.w(-2e-3, 2e-3), velocity: velocity + u.w(-2e-2, 2e-2), reference_angle: angle, reference_velocity: velocity, thermal_load: load, ..Initial::default() };
                if let Ok(only) = std::env::var("CASE") { if only != format!("{}{}{}", if pend {"p"} else {"t"}, class.chars().nth(if class.len()>8 {5} else {0}).unwrap(), case) { continue; } a.set_state(&Default::default()); println!("{class} {case} {:?} {:?}", a.plan(&init, goal).status, init); continue; }
                let mut best = f64::INFINITY;
                for _ in 0..5 { a.set_state(&Default::default()); let t = Instant::now(); a.plan(&init, goal); best = best.min(t.elapsed().as_secs_f64()); }
                let pa = a.latest().clone();
                times.push(best);
                if best > worst_case.0 { worst_case = (best, case); }
                if pa.iterations == 0 { fast += 1; } else { iters[pa.iterations.min(59) as usize] += 1; }
                if !matches!(pa.status, PlanStatus::Solved | PlanStatus::GoalProjected | PlanStatus::ThermalSlack | PlanStatus::AngleSlack) { bad += 1; if bad < 4 { println!("   case {case} {:?} it {} excess {:e}", pa.status, pa.iterations, pa.trajectory.excess); } }
                if pa.iterations > 0 && reference {
                    b.set_state(&Default::default());
                    let t = Instant::now();
                    let pb = b.plan(&init, goal);
                    tb.push(t.elapsed().as_secs_f64());
                    let rho = 1e3;
                    let scale = { let mut s = make(Method::Riccati); let mut hot = init; hot.thermal_load = 0.0; let p = s.plan(&hot, goal); p.trajectory.cost.max(1e-9) };
                    let (ma, mb) = (pa.trajectory.cost / scale + rho * pa.trajectory.total_excess, pb.trajectory.cost / scale + rho * pb.trajectory.total_excess);
                    let rel = (ma - mb) / mb.abs().max(1.0);
                    if rel > 2e-6 { worse += 1; if worse < 6 { println!("   case {case}: {:?} {:?} cost {:.9} {:.9} merit rel {rel:.2e} it {} / {} excess {:.2e} {:.2e}", pa.status, pb.status, pa.trajectory.cost, pb.trajectory.cost, pa.iterations, pb.iterations, pa.trajectory.excess, pb.trajectory.excess); } }
                    worst = worst.max(rel);
                }
                // warm next
                a.set_state(&Default::default()); a.plan(&init, goal);
                let st = a.state().clone();
                let p = a.latest().clone();
                let next = Initial { angle: p.trajectory.angle[1], velocity: p.trajectory.reference_velocity[1] , reference_angle: p.trajectory.reference_angle[1], reference_velocity: p.trajectory.reference_velocity[1], thermal_load: p.trajectory.thermal_load[1], ..init };
                let mut best = f64::INFINITY;
                for _ in 0..5 { a.set_state(&st); let t = Instant::now(); a.plan(&next, goal); best = best.min(t.elapsed().as_secs_f64()); }
                if a.latest().iterations > 0 { warmt.push(best); warmi[a.latest().iterations.min(59) as usize] += 1; }
            }
            times.sort_by(f64::total_cmp); tb.sort_by(f64::total_cmp); warmt.sort_by(f64::total_cmp);
            let q = |v: &Vec<f64>, p: f64| v.get(((v.len() as f64 * p) as usize).min(v.len().max(1) - 1)).copied().unwrap_or(0.0) * 1e6;
            println!("{} {class}: median {:.1} p99 {:.1} max {:.1} us (case {}); fast {fast} bad {bad} worse {worse} worst rel {worst:.2e}; clarabel med {:.0}", if pend { "pendulum" } else { "tflex" }, q(&times, 0.5), q(&times, 0.99), q(&times, 1.0), worst_case.1, q(&tb, 0.5));
            println!("    iterations {:?}", iters.iter().enumerate().filter(|x| *x.1 > 0).collect::<Vec<_>>());
            println!("    warm active: {} median {:.1} max {:.1}, its {:?}", warmt.len(), q(&warmt, 0.5), q(&warmt, 1.0), warmi.iter().enumerate().filter(|x| *x.1 > 0).collect::<Vec<_>>());
        }
    }
}
