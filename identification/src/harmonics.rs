//! How many cogging harmonics an arm has, by cross-validation over blocks of time.

use crate::curve::Compressed;
use crate::frequency;
use crate::least_squares::Triangle;
use arm::HARMONICS;

/// A number of harmonics that was tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Number of harmonics.
    pub harmonics: usize,
    /// Their spatial frequency w that fits all rows best \[1/rad\]; 0 without harmonics.
    pub frequency: f64,
    /// Root mean square of the torque that is not explained in the blocks that were left out \[N·m\].
    pub score: f64,
    /// Standard error of the mean square of `score`'s difference to the best candidate's \[(N·m)²\].
    pub error: f64,
}

/// Scores so near to the best one count as equal: what a harmonic gains below that is of no use, and may well be
/// another misfit of the model that happens to depend on the angle.
const EQUAL: f64 = 0.05;
/// Share of the torque below which the compression to splines may feign harmonics.
const FLOOR: f64 = 1e-5;

/// Every number of harmonics from 0 to `most`, the frequency within `range` \[1/rad\], and the one to choose:
/// the fewest whose score is as good as the best one, which is within 5 % of it, or its square within one standard
/// error, or the difference below 1e-5 of the deviation of the torque, `scale` \[N·m\].
///
/// For each candidate every block is predicted by the fit to all others. The frequency is the one that fits all
/// rows: a single number in common lets through next to nothing of the block that is left out.
pub fn choose(
    compressed: &Compressed,
    range: [f64; 2],
    most: usize,
    scale: f64,
) -> (Vec<Candidate>, usize) {
    let mut candidates = Vec::new();
    let mut squares: Vec<Vec<f64>> = Vec::new();
    for harmonics in 0..=most.min(HARMONICS) {
        let frequency = match harmonics {
            0 => 0.0,
            _ => match frequency::scan(compressed, range, harmonics) {
                Some(frequency) => frequency,
                None => break,
            },
        };
        let errors = left_out(&compressed.blocks(frequency, harmonics));
        let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        candidates.push(Candidate {
            harmonics,
            frequency,
            score: mean.sqrt(),
            error: 0.0,
        });
        squares.push(errors);
    }
    let by_score = |a: &usize, b: &usize| candidates[*a].score.total_cmp(&candidates[*b].score);
    let best = (0..candidates.len()).min_by(by_score).unwrap_or(0);
    let least = candidates[best].score;
    for (candidate, errors) in candidates.iter_mut().zip(&squares) {
        candidate.error = standard_error(errors, &squares[best]);
    }
    let good = |c: &Candidate| {
        c.score <= (1.0 + EQUAL) * least + FLOOR * scale
            || c.score.powi(2) - least.powi(2) <= c.error
    };
    let chosen = candidates.iter().position(good).unwrap_or(best);
    (candidates, chosen)
}

/// Mean squared error of each block, predicted by all others.
fn left_out(blocks: &[Triangle]) -> Vec<f64> {
    let predict = |(left, block): (usize, &Triangle)| {
        let mut others = Triangle::empty(block.r().ncols());
        for (i, other) in blocks.iter().enumerate() {
            if i != left {
                others.merge(other);
            }
        }
        // Too little in the others to predict anything: as bad as no prediction.
        let last = block.r().ncols() - 1;
        let error = match others.solve() {
            Ok(fit) => {
                (block.r().columns(0, last) * &fit.x - block.r().column(last)).norm_squared()
            }
            Err(_) => block.r().column(last).norm_squared(),
        };
        error / block.rows().max(1) as f64
    };
    blocks.iter().enumerate().map(predict).collect()
}

/// Of the mean of the differences of two lists.
fn standard_error(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let mean = differences.iter().sum::<f64>() / n;
    let variance: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (variance / n).sqrt()
}
