//! Bounds of g_φ(θ) that hold between any two samples of it, and from them the pessimistic affine torque
//! limit of appendix C.3.
//!
//! # What holds between samples
//! g is sampled at the ends of cells of width δ. For any affine l the difference g − l has the curvature of
//! g, so within a cell it misses the smaller of its values at the ends by `max|g''|·δ²/8` at most, with
//! `|g''| ≤ Σ (i·w)²·√(a_i² + b_i²)` (eq 12). Bounds of the samples become bounds of g by that margin.
//!
//! # The tightest affine pair
//! Among the affine functions below all samples the mean gap is least for the one that is highest at the
//! middle of the range: the edge of the lower convex hull that passes there. Mirrored, the upper one.

use arm::{Parameters, elementary};

/// Cells per period of the highest cogging harmonic, and in all, at least.
const CELLS: [f64; 2] = [1024.0, 4096.0];

/// An affine function of the angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Affine {
    /// \[N·m/rad\]
    pub slope: f64,
    /// Value at the angle zero \[N·m\].
    pub offset: f64,
}

impl Affine {
    /// The value at `angle` \[rad\] \[N·m\].
    pub fn at(&self, angle: f64) -> f64 {
        self.slope.mul_add(angle, self.offset)
    }
}

/// Torque that a plan may use, with the pessimistic bounds that stand for g (appendix C.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimit {
    /// τ_max \[N·m\].
    pub most: f64,
    /// Nowhere above g.
    pub lower: Affine,
    /// Nowhere below g.
    pub upper: Affine,
}

impl TorqueLimit {
    /// What the torque is beyond the limit for certain bounds of g at `angle`, `moving` being d·ωr + J·u;
    /// negative: within \[N·m\].
    pub fn excess(&self, angle: f64, moving: f64) -> f64 {
        let above = self.upper.at(angle) + moving;
        let below = -(self.lower.at(angle) + moving);
        above.max(below) - self.most
    }

    /// The largest interval of `[lower, upper]` where the arm can be held within the limit \[rad\]; none: it
    /// cannot.
    pub fn rest_interval(&self, mut lower: f64, mut upper: f64) -> Option<[f64; 2]> {
        for Affine { slope, offset } in [
            self.upper,
            Affine {
                slope: -self.lower.slope,
                offset: -self.lower.offset,
            },
        ] {
            let root = (self.most - offset) / slope;
            if slope > 0.0 {
                upper = upper.min(root);
            } else if slope < 0.0 {
                lower = lower.max(root);
            } else if offset > self.most {
                return None;
            }
        }
        (lower <= upper).then_some([lower, upper])
    }

    /// The least τ_max with which the arm can be held somewhere in `[lower, upper]` \[N·m\].
    pub fn least(&self, lower: f64, upper: f64) -> f64 {
        let needed = |angle: f64| self.upper.at(angle).max(-self.lower.at(angle));
        // Convex and piecewise affine: least at an end or where the two pieces meet.
        let meet = -(self.upper.offset + self.lower.offset) / (self.upper.slope + self.lower.slope);
        let inner = if meet > lower && meet < upper {
            needed(meet)
        } else {
            f64::INFINITY
        };
        needed(lower).min(needed(upper)).min(inner)
    }
}

/// g over a range of angles.
pub struct Scan {
    /// (θ, g(θ)) at the ends of the cells, in rising order.
    samples: Vec<[f64; 2]>,
    /// What g may miss an affine bound of the samples by \[N·m\].
    margin: f64,
}

impl Scan {
    /// Samples g of `arm` over `[lower, upper]` \[rad\], lower < upper.
    pub fn new(arm: &Parameters, lower: f64, upper: f64) -> Self {
        let w = arm.cogging_frequency;
        let periods = (upper - lower) * w * arm.harmonics() as f64 / std::f64::consts::TAU;
        let [per_period, least] = CELLS;
        let cells = (per_period * periods).clamp(least, 1e5) as usize;
        let width = (upper - lower) / cells as f64;
        let amplitudes = arm.cogging_cos.iter().zip(&arm.cogging_sin);
        let bend = amplitudes.enumerate().map(|(i, (a, b))| {
            let frequency = (i + 1) as f64 * w;
            frequency * frequency * elementary::hypot(*a, *b)
        });
        let sample = |i: usize| {
            // The last one is the end itself, not what rounding makes of it.
            let angle = if i == cells {
                upper
            } else {
                lower + width * i as f64
            };
            [angle, arm.position_torque(angle)]
        };
        Self {
            samples: (0..=cells).map(sample).collect(),
            margin: bend.sum::<f64>() * width * width / 8.0,
        }
    }

    /// Numbers that g is nowhere below, and nowhere above \[N·m\].
    pub fn extremes(&self) -> [f64; 2] {
        let torques = self.samples.iter().map(|sample| sample[1]);
        let [least, most] = torques.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, m], g| {
            [l.min(g), m.max(g)]
        });
        [least - self.margin, most + self.margin]
    }

    /// The tightest affine functions that are nowhere above g, and nowhere below.
    pub fn affine_bounds(&self) -> [Affine; 2] {
        [1.0, -1.0].map(|sign| {
            let mut bound = self.highest_below(sign);
            bound.offset -= self.margin;
            Affine {
                slope: sign * bound.slope,
                offset: sign * bound.offset,
            }
        })
    }

    /// The edge above the middle of the lower convex hull of the samples of `sign`·g.
    fn highest_below(&self, sign: f64) -> Affine {
        let mut hull: Vec<[f64; 2]> = Vec::new();
        for &[angle, torque] in &self.samples {
            let new = [angle, sign * torque];
            while let [.., a, b] = hull[..] {
                let left_turn =
                    (b[0] - a[0]) * (new[1] - a[1]) - (b[1] - a[1]) * (new[0] - a[0]) > 0.0;
                if left_turn {
                    break;
                }
                hull.pop();
            }
            hull.push(new);
        }
        let [first, last] = [hull[0][0], hull[hull.len() - 1][0]];
        let middle = 0.5 * (first + last);
        let right = hull.partition_point(|point| point[0] < middle).max(1);
        let (a, b) = (hull[right - 1], hull[right]);
        let slope = (b[1] - a[1]) / (b[0] - a[0]);
        // Rounding of the edge must not lift it above a sample.
        let offset = self.samples.iter().map(|s| sign * s[1] - slope * s[0]);
        Affine {
            slope,
            offset: offset.fold(f64::INFINITY, f64::min),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_arm() -> impl Strategy<Value = Parameters> {
        let amplitude = || prop::array::uniform9(-0.5..0.5);
        (amplitude(), amplitude(), -3.0..3.0, -2.0..2.0, 0.0..12.0).prop_map(
            |(cogging_cos, cogging_sin, stiffness, offset, cogging_frequency)| Parameters {
                cogging_cos,
                cogging_sin,
                stiffness,
                offset,
                cogging_frequency,
                ..Parameters::tflex()
            },
        )
    }

    proptest! {
        #[test]
        fn bounds_are_never_violated(arm in any_arm(), lower in -2.0..1.0, range in 0.1..2.0) {
            let upper = lower + range;
            let scan = Scan::new(&arm, lower, upper);
            let ([below, above], [least, most]) = (scan.affine_bounds(), scan.extremes());
            // Between the samples: a number of steps that shares no factor with that of the cells.
            for i in 0..=7919 {
                let angle = lower + range * f64::from(i) / 7919.0;
                let torque = arm.position_torque(angle);
                prop_assert!(below.at(angle) <= torque + 1e-12 && torque <= above.at(angle) + 1e-12);
                prop_assert!(least <= torque && torque <= most);
            }
        }

        /// No affine function with another slope is higher at the middle and below all samples.
        #[test]
        fn no_affine_bound_is_tighter(arm in any_arm(), lower in -2.0..1.0, range in 0.1..2.0, turn in -5.0..5.0) {
            let upper = lower + range;
            let scan = Scan::new(&arm, lower, upper);
            let [below, above] = scan.affine_bounds();
            let middle = 0.5 * (lower + upper);
            for (sign, bound) in [(1.0, below), (-1.0, above)] {
                let slope = sign * bound.slope + turn;
                let offsets = scan.samples.iter().map(|s| sign * s[1] - slope * s[0]);
                let highest = slope * middle + offsets.fold(f64::INFINITY, f64::min) - scan.margin;
                prop_assert!(highest <= sign * bound.at(middle) + 1e-9);
            }
        }

        #[test]
        fn the_rest_interval_is_where_the_limit_is_kept(
            arm in any_arm(), most in 0.1..4.0, lower in -2.0..1.0, range in 0.1..2.0,
        ) {
            let upper = lower + range;
            let [low, high] = Scan::new(&arm, lower, upper).affine_bounds();
            let limit = TorqueLimit { most, lower: low, upper: high };
            let interval = limit.rest_interval(lower, upper);
            prop_assert_eq!(interval.is_some(), limit.least(lower, upper) <= most);
            for i in 0..=500 {
                let angle = f64::min(lower + range * f64::from(i) / 500.0, upper);
                let kept = limit.excess(angle, 0.0);
                prop_assume!(kept.abs() > 1e-9);
                let inside = interval.is_some_and(|[from, to]| (from..=to).contains(&angle));
                prop_assert_eq!(kept < 0.0, inside);
            }
        }
    }

    /// Without cogging the bounds are g itself.
    #[test]
    fn an_affine_torque_is_its_own_bound() {
        let arm = Parameters {
            cogging_cos: [0.0; 9],
            cogging_sin: [0.0; 9],
            stiffness: 3.0,
            offset: -1.0,
            ..Parameters::tflex()
        };
        for bound in Scan::new(&arm, -1.0, 2.0).affine_bounds() {
            assert!((bound.slope - 3.0).abs() < 1e-12 && (bound.offset + 1.0).abs() < 1e-12);
        }
    }
}
