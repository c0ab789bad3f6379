//! The moves of linear policies as a linear form of the start: no recursion is left for the sample.

use arm::{Arithmetic, LANES, Vector};

use crate::nmpc::linear_quadratic::{Form, Policy, STATES};

/// What policies answer to any start.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The moves for every unit of the state at the start, four side by side \[⌈N/4⌉ × 6 × 4\].
    of_units: Vec<[[f64; LANES]; STATES]>,
}

impl Answer {
    /// Of `policies` for the intervals of `forms` \[N\]. O(N).
    pub fn new(forms: &[Form<STATES>], policies: &[Policy<STATES>]) -> Self {
        let dot = |row: &[f64; STATES], x: &[f64; STATES]| -> f64 {
            row.iter().zip(x).map(|(a, b)| a * b).sum()
        };
        let mut of_units = vec![[[0.0; LANES]; STATES]; forms.len().div_ceil(LANES)];
        for unit in 0..STATES {
            let mut x = [0.0; STATES];
            x[unit] = 1.0;
            for (k, (form, policy)) in forms.iter().zip(policies).enumerate() {
                let u = -dot(&policy.gain, &x);
                of_units[k / LANES][unit][k % LANES] = u;
                x = std::array::from_fn(|i| dot(&form.a[i], &x) + form.b[i] * u);
            }
        }
        Self { of_units }
    }

    /// Writes the `moves` \[N\] from `start`.
    #[inline(always)]
    pub fn write<A: Arithmetic>(&self, start: [f64; STATES], moves: &mut [f64]) {
        let start = start.map(A::Vector::splat);
        let (whole, rest) = moves.as_chunks_mut();
        let (of_whole, of_rest) = self.of_units.split_at(whole.len());
        for (moves, of_units) in whole.iter_mut().zip(of_whole) {
            *moves = combined::<A>(of_units, &start);
        }
        for of_units in of_rest {
            rest.copy_from_slice(&combined::<A>(of_units, &start)[..rest.len()]);
        }
    }
}

/// Σ x_i·of_units_i, `x` the same in all lanes.
#[inline(always)]
fn combined<A: Arithmetic>(
    of_units: &[[f64; LANES]; STATES],
    x: &[A::Vector; STATES],
) -> [f64; LANES] {
    let vector = A::Vector::new;
    let [a, b, c, d, e, f] = of_units;
    let reference = vector(c).mul_add(x[2], vector(b).mul_add(x[1], vector(a) * x[0]));
    let deviation = vector(f).mul_add(x[5], vector(e).mul_add(x[4], vector(d) * x[3]));
    (reference + deviation).lanes()
}
