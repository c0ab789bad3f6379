//! The constraint matrix, entry by entry.

use clarabel::algebra::CscMatrix;

/// Entries of a matrix in any order.
#[derive(Default)]
pub struct Entries(Vec<(usize, usize, f64)>);

impl Entries {
    /// Adds the entry of a `row` and a `column`.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.0.push((column, row, value));
    }

    /// The matrix; zeros stay, as places to be filled.
    pub fn matrix(mut self, rows: usize, columns: usize) -> CscMatrix<f64> {
        self.0.sort_by_key(|&(column, row, _)| (column, row));
        let mut starts = vec![0; columns + 1];
        for &(column, ..) in &self.0 {
            starts[column + 1] += 1;
        }
        for column in 0..columns {
            starts[column + 1] += starts[column];
        }
        let (indices, values) = self.0.iter().map(|&(_, row, value)| (row, value)).unzip();
        CscMatrix::new(rows, columns, starts, indices, values)
    }
}

/// Where the entry of a `row` and a `column` is among the values of a matrix that has it.
pub fn place(matrix: &CscMatrix<f64>, row: usize, column: usize) -> usize {
    let start = matrix.colptr[column];
    start + matrix.rowval[start..matrix.colptr[column + 1]].partition_point(|&r| r < row)
}
