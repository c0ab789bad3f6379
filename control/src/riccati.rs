//! The continuous algebraic Riccati equation (sec 3.2.2).
//!
//! For dx/dt = A·x + B·u and the cost ∫ xᵀ·Q·x + uᵀ·R·u dt, the state feedback u = −K·x is optimal with
//!
//! ```text
//! Aᵀ·S + S·A − S·G·S + Q = 0      G = B·R⁻¹·Bᵀ      K = R⁻¹·Bᵀ·S
//! ```
//!
//! where S is the solution that makes A − B·K stable. The columns of [I; S] span the stable subspace of
//! the Hamiltonian matrix H = [A, −G; −Q, −Aᵀ], which is the null space of sign(H) + I (Roberts,
//! Int. J. Control 32, 1980). Newton steps (Kleinman, IEEE Trans. Automatic Control 13, 1968) polish it.

use std::fmt;

use nalgebra::{Cholesky, DMatrix, DVector, Schur, SymmetricEigen};

/// Stabilising solution of a Riccati equation with n states and m inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// S, n×n, symmetric: xᵀ·S·x is the cost to go.
    pub cost_to_go: DMatrix<f64>,
    /// K, m×n.
    pub gain: DMatrix<f64>,
}

/// Why a Riccati equation has no usable solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsolvable {
    /// The matrices do not fit each other, or hold a value that is not finite.
    Shape,
    /// Q is not symmetric and positive semidefinite.
    StateWeight,
    /// R is not symmetric and positive definite.
    InputWeight,
    /// (A, B) is not stabilisable, or Q does not see a mode of A on the imaginary axis.
    NotStabilisable,
}

impl fmt::Display for Unsolvable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Shape => "the matrices do not fit each other or hold a value that is not finite",
            Self::StateWeight => "the state weight is not symmetric and positive semidefinite",
            Self::InputWeight => "the input weight is not symmetric and positive definite",
            Self::NotStabilisable => {
                "the inputs cannot stabilise the system or the weights do not see all of it"
            }
        })
    }
}

impl std::error::Error for Unsolvable {}

/// Residual of the Riccati equation, relative to its factors, that is accepted.
const RESIDUAL: f64 = 1e-12;
/// Bound on the iterations of the sign function; 10 to 15 are usual.
const SIGN_ITERATIONS: usize = 100;
/// Bound on the Newton steps; one or two reach machine precision.
const NEWTON_STEPS: usize = 10;

/// Solves the Riccati equation for A (n×n), B (n×m), Q (n×n), R (m×m).
///
/// # Errors
/// [`Unsolvable`] if the data are unfit or no stabilising solution exists; a solution that is returned
/// satisfies the equation to a relative residual of 1e-12 and makes A − B·K stable.
pub fn solve(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<Solution, Unsolvable> {
    let (n, m) = b.shape();
    let fits = n > 0 && m > 0 && a.shape() == (n, n) && q.shape() == (n, n) && r.shape() == (m, m);
    if !fits || ![a, b, q, r].iter().all(|x| x.iter().all(|v| v.is_finite())) {
        return Err(Unsolvable::Shape);
    }
    if !is_positive_semidefinite(q) {
        return Err(Unsolvable::StateWeight);
    }
    if *r != r.transpose() {
        return Err(Unsolvable::InputWeight);
    }
    let r = Cholesky::new(r.clone()).ok_or(Unsolvable::InputWeight)?;
    let equation = Equation {
        a,
        q,
        g: b * r.solve(&b.transpose()),
    };
    let first = equation
        .stable_subspace()
        .ok_or(Unsolvable::NotStabilisable)?;
    let cost_to_go = equation.polish(first);
    let gain = r.solve(&(b.transpose() * &cost_to_go));
    let solved = equation.residual(&cost_to_go) <= RESIDUAL && is_stable(a - b * &gain);
    solved
        .then_some(Solution { cost_to_go, gain })
        .ok_or(Unsolvable::NotStabilisable)
}

struct Equation<'a> {
    a: &'a DMatrix<f64>,
    q: &'a DMatrix<f64>,
    /// G, n×n.
    g: DMatrix<f64>,
}

impl Equation<'_> {
    /// S from the matrix sign function of H.
    fn stable_subspace(&self) -> Option<DMatrix<f64>> {
        let n = self.a.nrows();
        // With S = scale·S' the two off-diagonal blocks get equal size.
        let scale = match (self.q.norm() / self.g.norm()).sqrt() {
            ratio if ratio.is_finite() && ratio > 0.0 => ratio,
            _ => 1.0,
        };
        let mut h = DMatrix::zeros(2 * n, 2 * n);
        h.view_mut((0, 0), (n, n)).copy_from(self.a);
        h.view_mut((0, n), (n, n)).copy_from(&(&self.g * -scale));
        h.view_mut((n, 0), (n, n)).copy_from(&(self.q / -scale));
        h.view_mut((n, n), (n, n)).copy_from(&-self.a.transpose());
        let projector = sign(h)? + DMatrix::identity(2 * n, 2 * n);
        // (sign(H) + I)·[I; S'] = 0 in the least-squares sense.
        let qr = projector.columns(n, n).into_owned().qr();
        let right = -(qr.q().transpose() * projector.columns(0, n));
        let solution = qr.r().solve_upper_triangular(&right)?;
        let symmetric = (&solution + solution.transpose()) * (0.5 * scale);
        symmetric.iter().all(|v| v.is_finite()).then_some(symmetric)
    }

    /// Newton steps from `s` for as long as they lower the residual.
    fn polish(&self, mut s: DMatrix<f64>) -> DMatrix<f64> {
        let mut residual = self.residual(&s);
        for _ in 0..NEWTON_STEPS {
            let closed_loop = self.a - &self.g * &s;
            let right = -(self.q + &s * &self.g * &s);
            let Some(next) = lyapunov(&closed_loop, &right) else {
                break;
            };
            let next_residual = self.residual(&next);
            if next_residual.is_nan() || next_residual >= residual {
                break;
            }
            (s, residual) = (next, next_residual);
        }
        s
    }

    /// ‖Aᵀ·S + S·A − S·G·S + Q‖, relative to the norms of the factors.
    fn residual(&self, s: &DMatrix<f64>) -> f64 {
        let linear = self.a.transpose() * s;
        let defect = (&linear + linear.transpose() - s * &self.g * s + self.q).norm();
        let norm = s.norm();
        let size = (2.0 * self.a.norm() + self.g.norm() * norm) * norm + self.q.norm();
        if size == 0.0 { 0.0 } else { defect / size }
    }
}

/// sign(H) by Newton's iteration with determinant scaling, to a power of two; None if H has eigenvalues on
/// the imaginary axis.
fn sign(mut h: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let order = h.nrows() as f64;
    let mut last_change = f64::INFINITY;
    for _ in 0..SIGN_ITERATIONS {
        let lu = h.clone().lu();
        let inverse = lu.try_inverse()?;
        let determinant = lu.determinant();
        if !determinant.is_finite() || determinant == 0.0 {
            return None;
        }
        // About |det|^(1/order), as a power of two: exact to scale by, and the same on every machine.
        let exponent = ((determinant.to_bits() >> 52) & 0x7ff) as i32 - 1023;
        let power = (f64::from(exponent) / order).round() as i64;
        let mu = f64::from_bits(((1023 + power) as u64) << 52);
        let next = (&h / mu + inverse * mu) * 0.5;
        let change = (&next - &h).norm() / next.norm();
        h = next;
        // Convergence is quadratic: once small, a change that does not shrink any more is rounding.
        if change <= 1e-10 || (change <= 1e-3 && change >= last_change) {
            return Some(h);
        }
        last_change = change;
    }
    None
}

/// X of Aᵀ·X + X·A = C, by its Kronecker form; A and C are n×n with n small.
fn lyapunov(a: &DMatrix<f64>, c: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let eye = DMatrix::<f64>::identity(n, n);
    let at = a.transpose();
    let system = eye.kronecker(&at) + at.kronecker(&eye);
    let x = system
        .lu()
        .solve(&DVector::from_column_slice(c.as_slice()))?;
    let x = DMatrix::from_column_slice(n, n, x.as_slice());
    Some((&x + x.transpose()) * 0.5)
}

fn is_positive_semidefinite(q: &DMatrix<f64>) -> bool {
    let tolerance = 1e-12 * q.norm();
    (q - q.transpose()).norm() <= tolerance
        && SymmetricEigen::try_new(q.clone(), f64::EPSILON, 0)
            .is_some_and(|e| e.eigenvalues.min() >= -tolerance)
}

/// Whether all eigenvalues have negative real parts, by more than rounding.
fn is_stable(a: DMatrix<f64>) -> bool {
    let margin = 1e-13 * a.norm();
    Schur::try_new(a, f64::EPSILON, 10_000)
        .is_some_and(|s| s.complex_eigenvalues().iter().all(|e| e.re < -margin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn scalar(a: f64, b: f64, q: f64, r: f64) -> Result<Solution, Unsolvable> {
        let one = |v| DMatrix::from_element(1, 1, v);
        solve(&one(a), &one(b), &one(q), &one(r))
    }

    /// 2·a·s − s²·b²/r + q = 0.
    #[test]
    fn scalar_equation_has_its_closed_form() {
        for (a, b, q, r) in [
            (1.0, 2.0, 3.0, 0.5),
            (-4.0, 0.1, 1.0, 1e-4),
            (0.0, 1.0, 1.0, 1.0),
        ] {
            let g: f64 = b * b / r;
            let s = (a + f64::sqrt(a * a + g * q)) / g;
            let solution = scalar(a, b, q, r).unwrap();
            assert!((solution.cost_to_go[0] / s - 1.0).abs() < 1e-13);
            assert!((solution.gain[0] / (b * s / r) - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn what_cannot_be_solved_is_refused() {
        assert_eq!(scalar(1.0, 0.0, 1.0, 1.0), Err(Unsolvable::NotStabilisable));
        // An integrator that costs nothing need not be brought to rest.
        assert_eq!(scalar(0.0, 1.0, 0.0, 1.0), Err(Unsolvable::NotStabilisable));
        assert_eq!(scalar(1.0, 1.0, -1.0, 1.0), Err(Unsolvable::StateWeight));
        assert_eq!(scalar(1.0, 1.0, 1.0, 0.0), Err(Unsolvable::InputWeight));
        assert_eq!(scalar(f64::NAN, 1.0, 1.0, 1.0), Err(Unsolvable::Shape));
    }

    /// An unstable mode that the weight does not see is still stabilised: with Q = 0 it is mirrored.
    #[test]
    fn unstable_mode_without_weight_is_mirrored() {
        let solution = scalar(2.0, 1.0, 0.0, 1.0).unwrap();
        assert!((solution.gain[0] - 4.0).abs() < 1e-12);
    }

    /// A, B, Q, R of random order 1 to 6 with 1 or 2 inputs.
    fn any_system() -> impl Strategy<Value = [DMatrix<f64>; 4]> {
        (1..=6_usize, 1..=2_usize).prop_flat_map(|(n, m)| {
            let entries = |count| prop::collection::vec(-1.0..1.0, count);
            (entries(n * n), entries(n * m), entries(n * n), -4.0..1.0).prop_map(
                move |(a, b, c, decade)| {
                    let c = DMatrix::from_vec(n, n, c);
                    [
                        DMatrix::from_vec(n, n, a),
                        DMatrix::from_vec(n, m, b),
                        c.transpose() * &c + DMatrix::identity(n, n) * 1e-3,
                        DMatrix::identity(m, m) * f64::powf(10.0, decade),
                    ]
                },
            )
        })
    }

    proptest! {
        #[test]
        fn random_systems_are_solved_and_stabilised([a, b, q, r] in any_system()) {
            // Nearly uncontrollable draws have no solution of moderate size.
            let n = a.nrows();
            let mut blocks = vec![b.clone()];
            for i in 1..n {
                blocks.push(&a * &blocks[i - 1]);
            }
            let columns: Vec<_> = blocks.iter().flat_map(|k| k.column_iter()).collect();
            let controllability = DMatrix::from_columns(&columns);
            prop_assume!(controllability.svd(false, false).singular_values.min() > 1e-3);

            let Solution { cost_to_go: s, gain } = solve(&a, &b, &q, &r).unwrap();
            let residual = a.transpose() * &s + &s * &a - gain.transpose() * &r * &gain + &q;
            let size = q.norm() + (a.norm() + (&b * &gain).norm()) * s.norm();
            prop_assert!(residual.norm() < 1e-9 * size, "{}", residual.norm() / size);
            prop_assert_eq!(&s, &s.transpose());
            let slowest = (&a - &b * &gain).complex_eigenvalues().iter().map(|e| e.re).fold(f64::MIN, f64::max);
            prop_assert!(slowest < 0.0);
        }

        /// No gain in the neighbourhood costs less: trace of the cost under K ± δ.
        #[test]
        fn solution_is_a_minimum([a, b, q, r] in any_system(), row in 0..6_usize, delta in 1e-3..1e-2) {
            let Ok(Solution { cost_to_go, gain }) = solve(&a, &b, &q, &r) else { return Ok(()) };
            let mut other = gain.clone();
            other[row % gain.len()] += delta * (1.0 + gain.norm());
            let closed_loop = &a - &b * &other;
            prop_assume!(is_stable(closed_loop.clone()));
            let right = -(&q + other.transpose() * &r * &other);
            let cost = lyapunov(&closed_loop, &right).unwrap().trace();
            prop_assert!(cost >= cost_to_go.trace() * (1.0 - 1e-9));
        }
    }
}
