//! The linear-quadratic part of the problem: an interval's step and cost, heat left out, as linear and
//! quadratic forms, and the Riccati recursion over them. O(N·n³) for n states.
//!
//! # Forms
//! With the state x = (θr−θ_goal, ωr, e, z) and the move u, every quantity of an RK4 stage is a linear
//! form of (x, u): ϑ_j = θr−θ_goal + c_j·h·ωr + (M_j·z)_1 + d_j·h²·u, and so on
//! ([`super::transcription`]). The cost of an interval is the sum of their weighted squares.
//!
//! # Recursion
//! Let V(x) = ½·xᵀPx be the cost to go after the step x⁺ = A·x + B·u of an interval whose own cost is
//! ½·(x, u)ᵀH(x, u). For any policy u = −K·x,
//!
//! ```text
//! H_uu = R + BᵀPB    H_ux = Sᵀ + BᵀPA    P ← Q + AᵀPA − KᵀH_ux − H_uxᵀK + KᵀH_uuK
//! ```
//!
//! and K = H_ux/H_uu is the cheapest one. Terminal rest (eq 27) leaves no choice in the last two intervals:
//! there K is the deadbeat policy, which leads to rest at the goal from any state.

use arm::Arithmetic;

use super::problem::Problem;
use super::rk4::{CURVED, ELAPSED, Interval, QUADRATURE, STAGES};

/// States of the full form: θr−θ_goal, ωr, e and z = (θ−θr, ω−ωr, e_L).
pub const STATES: usize = 6;

/// Step and cost of an interval of `S` states.
#[derive(Clone, Copy, Debug)]
pub struct Form<const S: usize> {
    /// A, by rows.
    pub a: [[f64; S]; S],
    /// B.
    pub b: [f64; S],
    /// Q, by rows.
    pub xx: [[f64; S]; S],
    /// S.
    pub xu: [f64; S],
    /// R.
    pub uu: f64,
}

/// A linear form of (x, u).
#[derive(Clone, Copy)]
struct Row {
    x: [f64; STATES],
    u: f64,
}

impl Row {
    fn unit(state: usize) -> Self {
        let mut x = [0.0; STATES];
        x[state] = 1.0;
        Self { x, u: 0.0 }
    }

    fn plus(self, factor: f64, other: &Self) -> Self {
        Self {
            x: std::array::from_fn(|i| self.x[i] + factor * other.x[i]),
            u: self.u + factor * other.u,
        }
    }
}

impl Form<STATES> {
    /// The forms of `interval`.
    pub fn new(problem: &Problem, interval: &Interval) -> Self {
        let (h, weights) = (interval.length, &problem.weights);
        let reference: [Row; 3] = std::array::from_fn(Row::unit);
        let deviation = |j: usize, of: usize| {
            let mut row = Row::unit(0);
            row.x = [0.0; STATES];
            row.x[3..].copy_from_slice(&interval.deviation[j][of]);
            row
        };
        let move_ = Row {
            x: [0.0; STATES],
            u: 1.0,
        };
        let (mut xx, mut xu, mut uu) = ([[0.0; STATES]; STATES], [0.0; STATES], 0.0);
        let mut charge = |weight: f64, row: &Row| {
            for r in 0..STATES {
                for c in 0..STATES {
                    xx[r][c] += 2.0 * weight * row.x[r] * row.x[c];
                }
                xu[r] += 2.0 * weight * row.x[r] * row.u;
            }
            uu += 2.0 * weight * row.u * row.u;
        };
        let mut integral = reference[2];
        let mut seen = Row::unit(0);
        for j in 0..STAGES {
            let time = ELAPSED[j] * h;
            let distance = reference[0]
                .plus(time, &reference[1])
                .plus(CURVED[j] * h * h, &move_)
                .plus(1.0, &deviation(j, 0));
            let velocity = reference[1].plus(time, &move_).plus(1.0, &deviation(j, 1));
            let share = QUADRATURE[j] * h;
            charge(share * weights.angle, &distance);
            charge(share * weights.velocity, &velocity);
            charge(share * weights.integral, &reference[2].plus(time, &seen));
            charge(share * weights.acceleration, &move_);
            integral = integral.plus(share, &distance);
            seen = distance;
        }
        let next = [
            reference[0]
                .plus(h, &reference[1])
                .plus(0.5 * h * h, &move_),
            reference[1].plus(h, &move_),
            integral,
            deviation(STAGES, 0),
            deviation(STAGES, 1),
            deviation(STAGES, 2),
        ];
        Self {
            a: next.map(|row| row.x),
            b: next.map(|row| row.u),
            xx,
            xu,
            uu,
        }
    }
}

/// Policy of an interval, with what a change of the cost's gradient needs.
#[derive(Clone, Copy, Debug)]
pub struct Policy<const S: usize> {
    /// K of u = −K·x.
    pub gain: [f64; S],
    /// 1/H_uu; 0 where the policy is imposed.
    pub inverse: f64,
}

impl<const S: usize> Form<S> {
    /// One step of the recursion, with the cheapest policy or an `imposed` one: replaces `price` = P after
    /// the interval by P before it. None if there is no cheapest policy.
    #[inline(always)]
    pub fn policy<A: Arithmetic>(
        &self,
        price: &mut [[f64; S]; S],
        imposed: Option<[f64; S]>,
    ) -> Option<Policy<S>> {
        let Self { a, b, xx, xu, uu } = self;
        let (mut pa, mut pb) = ([[0.0; S]; S], [0.0; S]);
        for r in 0..S {
            for i in 0..S {
                for c in 0..S {
                    pa[r][c] = A::mul_add(price[r][i], a[i][c], pa[r][c]);
                }
                pb[r] = A::mul_add(price[r][i], b[i], pb[r]);
            }
        }
        let (mut h_uu, mut h_ux) = (*uu, *xu);
        for i in 0..S {
            h_uu = A::mul_add(b[i], pb[i], h_uu);
            for c in 0..S {
                h_ux[c] = A::mul_add(b[i], pa[i][c], h_ux[c]);
            }
        }
        let (gain, inverse) = match imposed {
            Some(gain) => (gain, 0.0),
            None if h_uu > 0.0 => {
                let inverse = 1.0 / h_uu;
                (h_ux.map(|h| h * inverse), inverse)
            }
            None => return None,
        };
        for r in 0..S {
            // For the cheapest policy h_ux − h_uu·gain is zero.
            let rest = A::mul_add(-h_uu, gain[r], h_ux[r]);
            for c in r..S {
                let mut value = A::mul_add(-gain[c], rest, xx[r][c]);
                value = A::mul_add(-gain[r], h_ux[c], value);
                for i in 0..S {
                    value = A::mul_add(a[i][r], pa[i][c], value);
                }
                (price[r][c], price[c][r]) = (value, value);
            }
        }
        Some(Policy { gain, inverse })
    }
}

/// K of the last two intervals, of lengths `h` and `next`, that leads (θr, ωr) to zero.
pub fn deadbeat(h: f64, next: f64) -> [[f64; 2]; 2] {
    let square = 0.5 * h * (h + next);
    [[1.0 / square, (h + 0.5 * next) / square], [0.0, 1.0 / next]]
}
