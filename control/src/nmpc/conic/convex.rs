//! One convex problem of the sequence in Clarabel's form: minimise ½·xᵀPx + qᵀx subject to
//! A·x + s = b, s in a product of cones. See [`super`] for the problem and its scaling.
//!
//! | variables | count | | rows | count |
//! |---|---|---|---|---|
//! | x, spline coefficients | N − 2 | | upper, then lower bounds of θr_1..θr_{N−1} | 2·(N − 1) |
//! | ζ_1..ζ_N, thermal loads | N | | signs of s | N |
//! | s_1..s_N, slacks | N | | room of ζ below the limit | N |
//! | slack of the torque limit | 1 | | torque limit ([`super::torque_rows`]) | 4·N + 1 |
//! | of the safe sets | 4 or 10 | | | |
//! | | | | of the safe sets ([`super::safe_rows`]) | 8 |
//! | | | | cones of the intervals: y + 1, y − 1, four currents | 6·N |
//! | | | | cones of the safe sets | 6 or 24 |
//!
//! Only what the problem has is there. Without terminal rest x has N elements and θr_N bounds.

mod layout;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DataUpdateError, DefaultSolution, DefaultSolver, SupportedConeT};
use nalgebra::DMatrix;

use super::super::problem::Terminal;
use super::super::rk4::STAGES;
use super::super::rollout::{Rollout, Sensitivity};
use super::super::solver::{TORQUE_PRICE, Task};
use super::super::spline::{free_columns, gather, stencil};
use super::super::transcription::Transcription;
use super::pattern::place;
use super::safe_rows::SafeRows;
use super::torque_rows;

/// Rows of a thermal cone.
const CONE: usize = STAGES + 2;

/// What an answer to the convex problem promises of the true one.
pub struct Promise {
    /// Decrease of the merit.
    pub decrease: f64,
    /// Largest thermal excess \[A²\].
    pub excess: f64,
    /// What true cost and priced true loads miss it by, in units of the cost scale.
    pub misjudged: f64,
}

/// The convex problem: patterns fixed at set-up, values posed around a trajectory.
pub struct Convex {
    horizon: usize,
    /// Spline coefficients, N − 2 or N.
    free: usize,
    /// Nodes with bounds of θr, N − 1 or N.
    bounds: usize,
    /// Thermal loads: N, or none without a limit.
    loads: usize,
    /// Diagonals of P above the main one.
    band: usize,
    /// Rows of the torque limit: 4·N + 1, or none without one.
    torque_rows: usize,
    safe: Option<SafeRows>,
    /// Hessian of the cost without heat \[free × free\].
    hessian: DMatrix<f64>,
    /// W, A² of thermal load per A² of squared current held for the first interval.
    heat_weight: f64,
    p: CscMatrix<f64>,
    a: CscMatrix<f64>,
    q: Vec<f64>,
    b: Vec<f64>,
    sigma: f64,
    damping: f64,
    sensitivity: Sensitivity,
}

impl Convex {
    /// Lays out the convex problem of `transcription`.
    pub fn new(transcription: &Transcription, hessian: DMatrix<f64>) -> Self {
        let problem = transcription.problem();
        let (horizon, free) = (problem.horizon, hessian.nrows());
        // An integral in the cost couples every pair of coefficients, all else only neighbours.
        let band = if problem.weights.integral > 0.0 {
            free - 1
        } else {
            2
        };
        let mut convex = Self {
            horizon,
            free,
            bounds: problem.bounded_nodes(),
            loads: problem.thermal_limit.map_or(0, |_| horizon),
            band,
            torque_rows: problem
                .torque_limit
                .map_or(0, |_| torque_rows::count(horizon)),
            safe: None,
            hessian,
            heat_weight: transcription.interval(0).thermal.weights().iter().sum(),
            p: CscMatrix::zeros((0, 0)),
            a: CscMatrix::zeros((0, 0)),
            q: Vec::new(),
            b: Vec::new(),
            sigma: 0.0,
            damping: 0.0,
            sensitivity: Sensitivity::new(horizon),
        };
        if problem.terminal == Terminal::SafeSet {
            let column = convex.torque_slack() + convex.torque_slacks();
            let row = convex.safe_row();
            let cone = row + SafeRows::LINEAR + CONE * convex.loads;
            let thermal = convex.loads > 0;
            convex.safe = Some(SafeRows::new(horizon, thermal, column, row, cone));
        }
        convex.p = convex.pattern_p();
        convex.a = convex.pattern_a(transcription);
        convex.q = vec![0.0; convex.a.n];
        convex.b = vec![0.0; convex.a.m];
        if convex.torque_slacks() > 0 {
            let slack = convex.torque_slack();
            convex.q[slack] = TORQUE_PRICE * torque_rows::UNIT;
        }
        if let Some(safe) = &convex.safe {
            safe.constants(&mut convex.b);
        }
        convex
    }

    /// Clarabel's P and A.
    pub fn matrices(&self) -> (&CscMatrix<f64>, &CscMatrix<f64>) {
        (&self.p, &self.a)
    }

    /// Clarabel's q and b.
    pub fn vectors(&self) -> (&[f64], &[f64]) {
        (&self.q, &self.b)
    }

    /// Clarabel's cones.
    pub fn cones(&self) -> Vec<SupportedConeT<f64>> {
        let mut cones = vec![SupportedConeT::NonnegativeConeT(self.cone_row(0))];
        cones.extend((0..self.loads).map(|_| SupportedConeT::SecondOrderConeT(CONE)));
        cones.extend(self.safe.iter().flat_map(SafeRows::cones));
        cones
    }

    /// Hands the values as posed to Clarabel.
    pub fn update(&self, clarabel: &mut DefaultSolver<f64>) -> Result<(), DataUpdateError> {
        clarabel.update_data(&self.p.nzval, &self.q, &self.a.nzval, &self.b)
    }

    /// σ, change of the spline's coefficients per unit of x in the problem as posed \[rad\].
    pub fn sigma(&self) -> f64 {
        self.sigma
    }

    /// Poses the problem around `rollout` of `moves`, with steps shortened by `damping`.
    pub fn pose(&mut self, task: &Task<'_>, moves: &[f64], rollout: &Rollout, damping: f64) {
        let transcription = task.transcription;
        let problem = transcription.problem();
        transcription.differentiate(
            problem.weights.thermal,
            moves,
            rollout,
            &mut self.sensitivity,
        );
        self.pose_curvature(task, rollout, damping);

        let gradient = &mut self.q[..self.free];
        gather(transcription, &self.sensitivity, gradient);
        for q in gradient {
            *q *= self.sigma / task.cost_scale;
        }
        let (upper, lower) = self.b.split_at_mut(self.bounds);
        for (k, [lowest, highest]) in task.angle_bounds.iter().enumerate() {
            let angle = rollout.reference_angle[k + 1];
            upper[k] = (highest - angle) / self.sigma;
            lower[k] = (angle - lowest) / self.sigma;
        }
        if let Some(limit) = problem.thermal_limit {
            self.pose_thermal_limit(task, rollout, limit);
        }
        if let Some(limit) = &problem.torque_limit {
            let at = [self.torque_row(), self.torque_slack()];
            let data = (&mut self.a, &mut self.b[..]);
            torque_rows::pose(task, limit, rollout, self.sigma, at, data);
        }
        if let Some((safe, set)) = self.safe.zip(task.safe_set) {
            let unit = self.heat_weight * problem.thermal_limit.unwrap_or(1.0);
            let room = self.last_room_row();
            let data = (&mut self.a, &mut self.b[..]);
            safe.pose(task, set, rollout, [self.sigma, unit], room, data);
        }
    }

    /// P, and with it σ.
    fn pose_curvature(&mut self, task: &Task<'_>, rollout: &Rollout, damping: f64) {
        let problem = task.transcription.problem();
        for m in 0..self.free {
            for place in self.p.colptr[m]..self.p.colptr[m + 1] {
                self.p.nzval[place] = self.hessian[(self.p.rowval[place], m)];
            }
        }
        if problem.weights.thermal > 0.0 {
            self.add_heat_curvature(task, rollout);
        }
        // The diagonal is last in every column.
        let diagonal = self.p.colptr[1..=self.free]
            .iter()
            .map(|end| self.p.nzval[end - 1]);
        let steepest = diagonal.fold(0.0, f64::max);
        let range = problem.angle_upper - problem.angle_lower;
        self.sigma = (task.cost_scale / steepest).sqrt().min(range);
        self.damping = damping;
        let scale = (1.0 + damping) * self.sigma * self.sigma / task.cost_scale;
        for p in &mut self.p.nzval {
            *p *= scale;
        }
    }

    /// Adds the curvature of the cost of heat to the Hessian.
    fn add_heat_curvature(&mut self, task: &Task<'_>, rollout: &Rollout) {
        let motor = &task.transcription.problem().motor;
        let per_current = 2.0 / (motor.torque_constant * motor.torque_constant);
        for k in 0..self.horizon {
            for j in 0..STAGES {
                let slope = self.torque_slope(task, rollout, k, j);
                let price = per_current * self.sensitivity.heat_price[k][j];
                for (right, m) in free_columns(k, self.free) {
                    for (left, row) in free_columns(k, self.free).take_while(|&(_, row)| row <= m) {
                        let place = self.p.colptr[m + 1] - 1 - (m - row);
                        self.p.nzval[place] += price * slope[left] * slope[right];
                    }
                }
            }
        }
    }

    /// Cones, room and slacks of the thermal load.
    fn pose_thermal_limit(&mut self, task: &Task<'_>, rollout: &Rollout, limit: f64) {
        let unit = self.heat_weight * limit;
        let per_torque = 1.0 / (task.transcription.problem().motor.torque_constant * limit.sqrt());
        for k in 0..self.horizon {
            let [load, next] = [rollout.thermal_load[k], rollout.thermal_load[k + 1]];
            let thermal = &task.transcription.interval(k).thermal;
            let (room, cone) = (self.room_row() + k, self.cone_row(k));
            self.b[room] = (task.transcription.interval(k).thermal_limit - next) / unit;
            let heat = (next - thermal.decay() * load) / unit;
            self.b[cone] = heat + 1.0;
            self.b[cone + 1] = heat - 1.0;
            for j in 0..STAGES {
                let weight = 2.0 * (thermal.weights()[j] / self.heat_weight).sqrt() * per_torque;
                self.b[cone + 2 + j] = weight * rollout.stages[k].torque[j];
                let slope = self.torque_slope(task, rollout, k, j);
                for (column, m) in free_columns(k, self.free) {
                    let place = place(&self.a, cone + 2 + j, m);
                    self.a.nzval[place] = -weight * self.sigma * slope[column];
                }
            }
        }
        let slacks = self.free + self.loads;
        self.q[slacks..slacks + self.loads].fill(task.excess_weight * unit);
    }

    /// ∂τ_j/∂(c_{k−1}, c_k, c_{k+1}) of interval `k` \[N·m/rad\].
    fn torque_slope(&self, task: &Task<'_>, rollout: &Rollout, k: usize, j: usize) -> [f64; 3] {
        let transcription = task.transcription;
        let h = transcription.interval(k).length;
        let gradient = transcription.torque_gradient(&rollout.stages[k], h, j);
        let stencil = stencil(transcription, k);
        std::array::from_fn(|column| (0..3).map(|row| gradient[row] * stencil[row][column]).sum())
    }

    /// What the answer `solution` promises, `from` being the trajectory that it started from, and how
    /// far its true trajectory `trial` misses it.
    pub fn promise(
        &self,
        task: &Task<'_>,
        solution: &DefaultSolution<f64>,
        from: &Rollout,
        trial: &Rollout,
    ) -> Promise {
        let x = &solution.x;
        let mut cost_change = 0.0;
        for m in 0..self.free {
            let mut row = 0.0;
            for place in self.p.colptr[m]..self.p.colptr[m + 1] {
                // Off the diagonal an entry stands for two, on it the form takes half.
                let half = if self.p.rowval[place] == m { 0.5 } else { 1.0 };
                row += half * self.p.nzval[place] * x[self.p.rowval[place]];
            }
            cost_change += x[m] * (self.q[m] + row / (1.0 + self.damping));
        }
        let unit = self.heat_weight * task.transcription.problem().thermal_limit.unwrap_or(0.0);
        let (loads, slacks) = x[self.free..self.free + 2 * self.loads].split_at(self.loads);
        let prices = &solution.z[self.room_row()..];
        let mut misjudged = ((trial.cost - from.cost) / task.cost_scale - cost_change).abs();
        for (k, (load, price)) in loads.iter().zip(prices).enumerate() {
            let true_load = (trial.thermal_load[k + 1] - from.thermal_load[k + 1]) / unit;
            misjudged += price * (load - true_load).abs();
        }
        let mut penalty = task.excess_weight * slacks.iter().sum::<f64>() * unit;
        if self.torque_slacks() > 0 {
            penalty += self.q[self.torque_slack()] * x[self.torque_slack()];
        }
        Promise {
            decrease: task.penalty(from) - penalty - cost_change,
            excess: slacks.iter().fold(0.0, |most: f64, s| most.max(*s)) * unit,
            misjudged,
        }
    }
}

#[cfg(test)]
mod tests;
