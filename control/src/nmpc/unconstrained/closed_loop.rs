//! Intervals whose moves follow a policy: what makes the recursions along a plan short.

use arm::{Arithmetic, LANES, Vector};

use crate::nmpc::linear_quadratic::{Form, Policy, STATES};

/// What an interval does to (θr, ωr, e) where its move follows the policy u = −K·x + v.
#[derive(Clone, Copy, Debug)]
pub struct ClosedLoop {
    /// A − B·K, and B in the last lane \[3 × 4\].
    pub step: [[f64; LANES]; 3],
    /// K.
    pub gain: [f64; LANES],
    /// 1/H_uu; 0 where the policy is imposed.
    pub inverse: f64,
}

impl ClosedLoop {
    /// From the step of an interval and its policy.
    pub fn new(form: &Form<STATES>, policy: &Policy<STATES>) -> Self {
        let Policy { gain, inverse } = policy;
        let row = |r: usize| {
            let by_state = |c: usize| form.a[r][c] - form.b[r] * gain[c];
            [by_state(0), by_state(1), by_state(2), form.b[r]]
        };
        Self {
            step: [0, 1, 2].map(row),
            gain: [gain[0], gain[1], gain[2], 0.0],
            inverse: *inverse,
        }
    }

    /// From the `gradient` of the interval's own cost in (θr, ωr, e, u) and that of the cost to go after it, that of
    /// the cost to go before it in (θr, ωr, e, v).
    #[inline(always)]
    pub fn back<A: Arithmetic>(&self, gradient: A::Vector, after: A::Vector) -> A::Vector {
        let [angle, velocity, integral, _] = after.lanes().map(A::Vector::splat);
        let [.., by_move] = gradient.lanes();
        let [by_angle, by_velocity, by_integral] = self.step.each_ref().map(A::Vector::new);
        let own = A::Vector::splat(by_move).neg_mul_add(A::Vector::new(&self.gain), gradient);
        let through = integral.mul_add(by_integral, own);
        velocity.mul_add(by_velocity, angle.mul_add(by_angle, through))
    }
}
