//! An interval of the linearised problem, and the Riccati recursion over its structure.

use arm::Arithmetic;

use super::LOAD;
use crate::nmpc::linear_quadratic::Policy;

/// An interval around the rollout: the step
///
/// ```text
/// dθr⁺ = dθr + h·dωr + h²/2·du      dωr⁺ = dωr + h·du
/// dT⁺  = t_θ·dθr + t_ω·dωr + a·dT + t_u·du
/// de⁺  = e_θ·dθr + e_ω·dωr + de + e_u·du
/// ```
///
/// whose structure the recursion makes use of, the gradient of the cost, and the policy.
#[derive(Clone, Copy, Debug)]
pub struct Linear<const S: usize> {
    /// h \[s\].
    pub h: f64,
    /// t_θ, t_ω and a.
    pub load: [f64; 3],
    /// e_θ and e_ω.
    pub integral: [f64; 2],
    /// ∂x⁺/∂u = (h²/2, h, t_u, e_u).
    pub by_move: [f64; S],
    /// Gradient of the cost in x.
    pub gradient: [f64; S],
    /// Gradient of the cost in u.
    pub gradient_by_move: f64,
    /// The policy of the interval's move.
    pub policy: Policy<S>,
    /// A − B·K, by rows: the step in closed loop.
    pub closed: [[f64; S]; S],
    /// Gradient of the cost in x in closed loop.
    pub closed_gradient: [f64; S],
}

/// Curvature of an interval's cost: the parts Q, S and R of H; of Q only the upper triangle counts.
pub struct Curvature<const S: usize> {
    /// Q, by rows.
    pub xx: [[f64; S]; S],
    /// S.
    pub xu: [f64; S],
    /// R.
    pub uu: f64,
}

impl<const S: usize> Linear<S> {
    /// Aᵀ·p, the transpose of ∂x⁺/∂x times a column.
    #[inline(always)]
    pub fn transposed<A: Arithmetic>(&self, p: &[f64; S]) -> [f64; S] {
        let mut product = *p;
        product[0] = A::mul_add(self.load[0], p[LOAD], p[0]);
        product[1] = A::mul_add(self.load[1], p[LOAD], A::mul_add(self.h, p[0], p[1]));
        product[LOAD] = self.load[2] * p[LOAD];
        if S > LOAD + 1 {
            product[0] = A::mul_add(self.integral[0], p[S - 1], product[0]);
            product[1] = A::mul_add(self.integral[1], p[S - 1], product[1]);
        }
        product
    }

    /// One step of the recursion, as [`Form::policy`] does it for any A.
    #[inline(always)]
    pub fn recur<A: Arithmetic>(
        &mut self,
        own: &Curvature<S>,
        price: &mut [[f64; S]; S],
        imposed: Option<&[f64; S]>,
    ) -> bool {
        // Rows of P are its columns: (P·A)ᵀ by rows.
        let (mut ap, mut pb) = ([[0.0; S]; S], [0.0; S]);
        for r in 0..S {
            ap[r] = self.transposed::<A>(&price[r]);
            for i in 0..S {
                pb[r] = A::mul_add(price[r][i], self.by_move[i], pb[r]);
            }
        }
        let mut h_uu = own.uu;
        let mut h_ux = self.transposed::<A>(&pb);
        for i in 0..S {
            h_uu = A::mul_add(self.by_move[i], pb[i], h_uu);
            h_ux[i] += own.xu[i];
        }
        if imposed.is_none() && h_uu <= 0.0 {
            return false;
        }
        let inverse = 1.0 / h_uu;
        // Column c of P·A, then of AᵀPA.
        for c in 0..S {
            let column = self.transposed::<A>(&std::array::from_fn(|r| ap[r][c]));
            for r in 0..=c {
                price[r][c] = own.xx[r][c] + column[r];
            }
        }
        let (gain, inverse) = match imposed {
            None => (h_ux.map(|h| h * inverse), inverse),
            Some(gain) => (*gain, 0.0),
        };
        for c in 0..S {
            for r in 0..=c {
                let mut value = A::mul_add(-gain[r], h_ux[c], price[r][c]);
                if imposed.is_some() {
                    // For the cheapest policy this rest is zero.
                    let rest = A::mul_add(-h_uu, gain[r], h_ux[r]);
                    value = A::mul_add(-gain[c], rest, value);
                }
                price[r][c] = value;
                price[c][r] = value;
            }
        }
        self.policy = Policy { gain, inverse };
        self.closed = self.transition();
        for c in 0..S {
            self.closed_gradient[c] = A::mul_add(-gain[c], self.gradient_by_move, self.gradient[c]);
            for r in 0..S {
                self.closed[r][c] = A::mul_add(-self.by_move[r], gain[c], self.closed[r][c]);
            }
        }
        true
    }

    /// ∂x⁺/∂x, by rows.
    #[inline(always)]
    fn transition(&self) -> [[f64; S]; S] {
        let mut rows = [[0.0; S]; S];
        (rows[0][0], rows[0][1], rows[1][1]) = (1.0, self.h, 1.0);
        rows[LOAD][..=LOAD].copy_from_slice(&self.load);
        if S > LOAD + 1 {
            rows[S - 1][..2].copy_from_slice(&self.integral);
            rows[S - 1][S - 1] = 1.0;
        }
        rows
    }
}
