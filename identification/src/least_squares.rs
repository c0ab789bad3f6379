//! Linear least squares by QR factorisation, with what the residual says about its errors.

use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Ratio of singular values, columns scaled to length one, below which columns count as dependent.
const DEPENDENT: f64 = 1e-9;
/// Rows that are factorised at a time: they stay in the cache.
const CHUNK: usize = 2048;

/// R of the QR factorisation of `[A b]`, with which every least-squares question about columns of A is answered.
#[derive(Clone, Debug)]
pub struct Triangle {
    r: DMatrix<f64>,
    rows: usize,
}

impl Triangle {
    /// No rows yet of `columns` columns, b included.
    pub fn empty(columns: usize) -> Self {
        Self {
            r: DMatrix::zeros(0, columns),
            rows: 0,
        }
    }

    /// Of all `rows` of `[A b]`.
    pub fn of(rows: &DMatrix<f64>) -> Self {
        let mut triangle = Self::empty(rows.ncols());
        let mut first = 0;
        while first < rows.nrows() {
            let count = CHUNK.min(rows.nrows() - first);
            triangle.add(rows.rows(first, count).into_owned());
            first += count;
        }
        triangle
    }

    /// Takes in further rows of `[A b]`.
    pub fn add(&mut self, rows: DMatrix<f64>) {
        self.rows += rows.nrows();
        self.stack(&rows);
    }

    /// Takes in the rows of another one.
    pub fn merge(&mut self, other: &Self) {
        self.rows += other.rows;
        self.stack(&other.r);
    }

    fn stack(&mut self, below: &DMatrix<f64>) {
        let (above, columns) = (self.r.nrows(), self.r.ncols());
        let mut all = DMatrix::zeros(above + below.nrows(), columns);
        all.rows_mut(0, above).copy_from(&self.r);
        all.rows_mut(above, below.nrows()).copy_from(below);
        self.r = all.qr().r();
    }

    /// Rows that were taken in.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// R itself, upper triangular or with fewer rows.
    pub fn r(&self) -> &DMatrix<f64> {
        &self.r
    }

    /// The same rows with columns `A·map`, b kept.
    pub fn mapped(&self, map: &DMatrix<f64>) -> Self {
        let last = self.r.ncols() - 1;
        let mut r = DMatrix::zeros(self.r.nrows(), map.ncols() + 1);
        r.columns_mut(0, map.ncols())
            .copy_from(&(self.r.columns(0, last) * map));
        r.set_column(map.ncols(), &self.r.column(last));
        Self {
            r: r.qr().r(),
            rows: self.rows,
        }
    }

    /// min ‖A·x − b‖², without x: also where columns of A depend on each other.
    pub fn residual(&self) -> f64 {
        let last = self.r.ncols() - 1;
        if self.r.nrows() > last {
            self.r[(last, last)].powi(2)
        } else {
            0.0
        }
    }

    /// x that minimises ‖A·x − b‖.
    ///
    /// # Errors
    /// The columns that depend on each other.
    pub fn solve(&self) -> Result<Solution, Dependent> {
        let n = self.r.ncols() - 1;
        let scale: Vec<f64> = (0..n).map(|c| self.r.column(c).norm()).collect();
        let empty: Vec<usize> = (0..n).filter(|&c| scale[c] == 0.0).collect();
        if !empty.is_empty() || self.r.nrows() < n {
            let columns = if empty.is_empty() {
                (0..n).collect()
            } else {
                empty
            };
            return Err(Dependent {
                columns,
                condition: f64::INFINITY,
            });
        }
        let mut r = self.r.view((0, 0), (n, n)).upper_triangle();
        for c in 0..n {
            r.column_mut(c).unscale_mut(scale[c]);
        }
        let svd = r.clone().svd(false, true);
        let largest = svd.singular_values.max();
        let (weakest, smallest) = svd.singular_values.argmin();
        let condition = largest / smallest;
        if !condition.is_finite() || condition >= 1.0 / DEPENDENT {
            let columns = svd.v_t.map_or((0..n).collect(), |v| {
                let direction = v.row(weakest);
                let most = direction.amax();
                (0..n)
                    .filter(|&c| direction[c].abs() > 0.1 * most)
                    .collect()
            });
            return Err(Dependent { columns, condition });
        }
        let b = self.r.view((0, n), (n, 1)).column(0).into_owned();
        let mut x = r
            .solve_upper_triangular(&b)
            .unwrap_or_else(|| DVector::zeros(n));
        for c in 0..n {
            x[c] /= scale[c];
        }
        Ok(Solution {
            x,
            condition,
            residual: self.residual(),
        })
    }
}

/// Least squares solved.
#[derive(Clone, Debug)]
pub struct Solution {
    /// x.
    pub x: DVector<f64>,
    /// Condition number of A with columns of length one.
    pub condition: f64,
    /// ‖A·x − b‖².
    pub residual: f64,
}

/// Columns that do not determine their coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct Dependent {
    /// The columns that take part.
    pub columns: Vec<usize>,
    /// Condition number of A with columns of length one.
    pub condition: f64,
}

/// Covariance of x from the residual r = b − A·x, which may be correlated over up to `lags` rows of one stretch.
///
/// (AᵀA)⁻¹·S·(AᵀA)⁻¹ with S = Σ_l (1 − l/(lags + 1))·Σ_t (g_t·g_{t+l}ᵀ + g_{t+l}·g_tᵀ), g_t = a_t·r_t: the
/// estimate of Newey and West (Econometrica 55, 1987), times n/(n − columns). None if A is singular.
pub fn covariance(
    a: &DMatrix<f64>,
    residual: &DVector<f64>,
    stretches: &[Range<usize>],
    lags: usize,
) -> Option<DMatrix<f64>> {
    let (n, p) = a.shape();
    let scale: Vec<f64> = (0..p).map(|c| a.column(c).norm()).collect();
    let mut scaled = a.clone();
    for c in 0..p {
        scaled.column_mut(c).unscale_mut(scale[c]);
    }
    let mut with_zero = DMatrix::zeros(n, p + 1);
    with_zero.columns_mut(0, p).copy_from(&scaled);
    let triangle = Triangle::of(&with_zero);
    let r = triangle.r.view((0, 0), (p, p)).upper_triangle();
    // q_t = R⁻ᵀ·a_t is a row of Q, so that S stays well scaled.
    let inverse = r.try_inverse()?;
    let mut moments = &scaled * &inverse;
    for (t, value) in residual.iter().enumerate() {
        moments.row_mut(t).scale_mut(*value);
    }
    let transposed = moments.transpose();
    let mut s = DMatrix::zeros(p, p);
    for stretch in stretches {
        let length = stretch.len();
        for lag in 0..=lags.min(length.saturating_sub(1)) {
            let early = transposed.columns(stretch.start, length - lag);
            let late = transposed.columns(stretch.start + lag, length - lag);
            let product = early * late.transpose();
            if lag == 0 {
                s += product;
            } else {
                let weight = 1.0 - lag as f64 / (lags + 1) as f64;
                s += (&product + product.transpose()) * weight;
            }
        }
    }
    let correction = n as f64 / n.saturating_sub(p).max(1) as f64;
    let mut covariance = &inverse * s * inverse.transpose() * correction;
    for c in 0..p {
        for d in 0..p {
            covariance[(c, d)] /= scale[c] * scale[d];
        }
    }
    Some(covariance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn matrix(rows: usize, columns: usize) -> impl Strategy<Value = DMatrix<f64>> {
        prop::collection::vec(-1.0..1.0_f64, rows * columns)
            .prop_map(move |v| DMatrix::from_vec(rows, columns, v))
    }

    proptest! {
        /// The normal equations, Aᵀ(A·x − b) = 0, and the residual by its definition.
        #[test]
        fn solutions_satisfy_the_normal_equations(rows in matrix(40, 5), scale in 1e-3..1e3_f64) {
            let mut rows = rows;
            rows.column_mut(1).scale_mut(scale);
            let (a, b) = (rows.columns(0, 4).into_owned(), rows.column(4).into_owned());
            let solution = Triangle::of(&rows).solve().unwrap();
            let residual = &a * &solution.x - &b;
            for c in 0..4 {
                let column = a.column(c);
                prop_assert!((column.dot(&residual)).abs() < 1e-12 * column.norm() * b.norm().max(1.0));
            }
            prop_assert!((residual.norm_squared() - solution.residual).abs() < 1e-12);
        }

        /// Any order and grouping of the rows gives one answer.
        #[test]
        fn triangles_merge(rows in matrix(60, 4), cut in 1..59_usize) {
            let whole = Triangle::of(&rows).solve().unwrap();
            let mut merged = Triangle::of(&rows.rows(cut, 60 - cut).into_owned());
            merged.merge(&Triangle::of(&rows.rows(0, cut).into_owned()));
            prop_assert_eq!(merged.rows(), 60);
            let merged = merged.solve().unwrap();
            prop_assert!((whole.x - merged.x).amax() < 1e-9 * whole.condition);
            prop_assert!((whole.residual - merged.residual).abs() < 1e-12);
        }

        #[test]
        fn mapped_columns_are_columns(rows in matrix(30, 5), map in matrix(4, 2)) {
            let mut direct = DMatrix::zeros(30, 3);
            direct.columns_mut(0, 2).copy_from(&(rows.columns(0, 4) * &map));
            direct.set_column(2, &rows.column(4));
            let a = Triangle::of(&rows).mapped(&map).residual();
            prop_assert!((a - Triangle::of(&direct).residual()).abs() < 1e-12);
        }
    }

    #[test]
    fn dependent_columns_are_named() {
        let rows = DMatrix::from_fn(50, 5, |r, c| match c {
            0 => (r as f64).sin(),
            1 => r as f64,
            2 => 1.0,
            3 => 30.0 - r as f64,
            _ => (r as f64).cos(),
        });
        let dependent = Triangle::of(&rows).solve().unwrap_err();
        assert_eq!(dependent.columns, [1, 2, 3]);
        let mut still = rows.clone();
        still.column_mut(0).fill(0.0);
        assert_eq!(Triangle::of(&still).solve().unwrap_err().columns, [0]);
    }

    /// Standard normal: a sum of twelve uniform draws.
    fn normal(state: &mut u64) -> f64 {
        (0..12).map(|_| arm::random::uniform(state)).sum::<f64>() - 6.0
    }

    /// Against the scatter of 400 repetitions: coloured noise and regressors, where the formula for white
    /// noise is wrong by a factor of two.
    #[test]
    fn standard_errors_are_the_scatter_of_repetitions() {
        let (n, colour) = (1500, 20);
        let a = DMatrix::from_fn(
            n,
            2,
            |t, c| {
                if c == 0 { 1.0 } else { (t as f64 / 90.0).sin() }
            },
        );
        let mut noise = 1;
        let (mut sum, mut squares, mut claimed, mut white) = ([0.0; 2], [0.0; 2], [0.0; 2], 0.0);
        let runs = 400;
        for _ in 0..runs {
            let raw: Vec<f64> = (0..n + colour).map(|_| normal(&mut noise)).collect();
            let b = DVector::from_fn(n, |t, _| raw[t..t + colour].iter().sum::<f64>());
            let mut rows = DMatrix::zeros(n, 3);
            rows.columns_mut(0, 2).copy_from(&a);
            rows.set_column(2, &b);
            let solution = Triangle::of(&rows).solve().unwrap();
            let residual = &b - &a * &solution.x;
            let stretch: Range<usize> = 0..n;
            let covariance =
                covariance(&a, &residual, std::slice::from_ref(&stretch), 4 * colour).unwrap();
            for c in 0..2 {
                sum[c] += solution.x[c];
                squares[c] += solution.x[c].powi(2);
                claimed[c] += covariance[(c, c)].sqrt() / f64::from(runs);
            }
            white += (solution.residual / n as f64 / n as f64).sqrt() / f64::from(runs);
        }
        for c in 0..2 {
            let runs = f64::from(runs);
            let scatter = (squares[c] / runs - (sum[c] / runs).powi(2)).sqrt();
            let ratio = claimed[c] / scatter;
            assert!((0.8..1.15).contains(&ratio), "{c}: {ratio}");
        }
        assert!(white < 0.5 * claimed[0]);
    }
}
