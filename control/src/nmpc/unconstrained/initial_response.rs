//! The moves of linear policies as a linear form of the start: no recursion is left for the sample.

use arm::{Arithmetic, LANES, Vector};

use crate::nmpc::linear_quadratic::{Form, Policy, STATES};

/// The moves from any start.
#[derive(Clone, Debug)]
pub struct InitialResponse {
    /// ∂u/∂x_0, four moves side by side \[⌈N/4⌉ × 6 × 4\].
    by_start: Vec<[[f64; LANES]; STATES]>,
}

impl InitialResponse {
    /// Of `policies` for the intervals of `forms` \[N\]. O(N).
    pub fn new(forms: &[Form<STATES>], policies: &[Policy<STATES>]) -> Self {
        let dot = |row: &[f64; STATES], x: &[f64; STATES]| -> f64 {
            row.iter().zip(x).map(|(a, b)| a * b).sum()
        };
        let mut by_start = vec![[[0.0; LANES]; STATES]; forms.len().div_ceil(LANES)];
        for state in 0..STATES {
            let mut x = [0.0; STATES];
            x[state] = 1.0;
            for (k, (form, policy)) in forms.iter().zip(policies).enumerate() {
                let u = -dot(&policy.gain, &x);
                by_start[k / LANES][state][k % LANES] = u;
                x = std::array::from_fn(|i| dot(&form.a[i], &x) + form.b[i] * u);
            }
        }
        Self { by_start }
    }

    /// Writes the `moves` \[N\] from `start`.
    #[inline(always)]
    pub fn write<A: Arithmetic>(&self, start: [f64; STATES], moves: &mut [f64]) {
        let start = start.map(A::Vector::splat);
        let (whole, rest) = moves.as_chunks_mut();
        let (by_whole, by_rest) = self.by_start.split_at(whole.len());
        for (moves, by_start) in whole.iter_mut().zip(by_whole) {
            *moves = combined::<A>(by_start, &start);
        }
        for by_start in by_rest {
            rest.copy_from_slice(&combined::<A>(by_start, &start)[..rest.len()]);
        }
    }
}

/// ∂u/∂x_0·x_0, `x` the same in all lanes.
#[inline(always)]
fn combined<A: Arithmetic>(
    by_start: &[[f64; LANES]; STATES],
    x: &[A::Vector; STATES],
) -> [f64; LANES] {
    let vector = A::Vector::new;
    let [a, b, c, d, e, f] = by_start;
    let reference = vector(c).mul_add(x[2], vector(b).mul_add(x[1], vector(a) * x[0]));
    let deviation = vector(f).mul_add(x[5], vector(e).mul_add(x[4], vector(d) * x[3]));
    (reference + deviation).lanes()
}
