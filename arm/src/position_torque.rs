//! g(θ) and its derivatives (eq 12), for several angles at once.
//!
//! One sine and cosine a piece; those of the higher harmonics follow from Chebyshev's recursion,
//! cos (i+1)x = 2·cos x·cos ix − cos (i−1)x, and likewise the sines. Sine and cosine are computed here, so that
//! several angles share vector instructions.

use crate::arithmetic::{Arithmetic, Separate};
use crate::elementary;
use crate::parameters::{HARMONICS, Parameters};
use crate::vector::{LANES, Vector};

/// Arguments beyond which the reduction to one quadrant loses digits.
const LARGEST_ARGUMENT: f64 = 1e5;
/// π/2 in three parts; products of the first two with a quadrant's number are exact.
const HALF_PI: [f64; 3] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_795_950_6e-21,
];
/// Added and taken away again, it rounds to a whole number, which the last bits of the sum then hold.
const ROUNDING: f64 = 6_755_399_441_055_744.0; // 1.5·2⁵²
/// Minimax coefficients of (sin r − r)/r³ in r² for |r| ≤ π/4.
const SIN: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];
/// Minimax coefficients of (cos r − 1 + r²/2)/r⁴ in r² for |r| ≤ π/4.
const COS: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sines and cosines, within 1e-15.
#[inline(always)]
fn sin_cos<A: Arithmetic, const M: usize>(x: [A::Vector; M]) -> [[A::Vector; M]; 2] {
    let splat = A::Vector::splat;
    let (mut sin, mut cos) = (x, x);
    let mut large = false;
    for m in 0..M {
        large |= x[m].any_beyond(LARGEST_ARGUMENT);
    }
    if large {
        for m in 0..M {
            let [s, c] = large_sin_cos(x[m].lanes());
            (sin[m], cos[m]) = (A::Vector::new(&s), A::Vector::new(&c));
        }
        return [sin, cos];
    }
    let (mut turns, mut r, mut z) = (x, x, x);
    for m in 0..M {
        turns[m] = x[m].mul_add(splat(std::f64::consts::FRAC_2_PI), splat(ROUNDING));
        let n = turns[m] - splat(ROUNDING);
        r[m] = n.neg_mul_add(splat(HALF_PI[0]), x[m]);
        r[m] = n.neg_mul_add(splat(HALF_PI[1]), r[m]);
        r[m] = n.neg_mul_add(splat(HALF_PI[2]), r[m]);
        z[m] = r[m] * r[m];
        (sin[m], cos[m]) = (splat(SIN[5]), splat(COS[5]));
    }
    for i in (0..5).rev() {
        for m in 0..M {
            sin[m] = sin[m].mul_add(z[m], splat(SIN[i]));
            cos[m] = cos[m].mul_add(z[m], splat(COS[i]));
        }
    }
    for m in 0..M {
        let s = (r[m] * z[m]).mul_add(sin[m], r[m]);
        let c = (z[m] * z[m]).mul_add(cos[m], z[m].mul_add(splat(-0.5), splat(1.0)));
        [sin[m], cos[m]] = A::Vector::turned(turns[m], s, c);
    }
    [sin, cos]
}

#[cold]
fn large_sin_cos(x: [f64; LANES]) -> [[f64; LANES]; 2] {
    [x.map(elementary::sin), x.map(elementary::cos)]
}

/// g and its derivatives with respect to θ, the first `D` of them, ready for evaluation.
#[derive(Clone, Copy, Debug)]
pub struct PositionTorque<const D: usize> {
    stiffness: f64,
    offset: f64,
    frequency: f64,
    /// Pairs of harmonics after the first one, the highest that is present among them.
    pairs: usize,
    /// What cos iwθ and sin iwθ count for in each derivative, the same in all lanes.
    waves: [[[[f64; LANES]; 2]; D]; HARMONICS],
}

impl<const D: usize> PositionTorque<D> {
    /// Of an arm.
    pub fn new(arm: &Parameters) -> Self {
        let mut waves = [[[[0.0; LANES]; 2]; D]; HARMONICS];
        for (i, of_harmonic) in waves.iter_mut().enumerate() {
            let frequency = (i + 1) as f64 * arm.cogging_frequency;
            let [mut cos, mut sin] = [arm.cogging_cos[i], arm.cogging_sin[i]];
            for wave in of_harmonic {
                *wave = [[cos; LANES], [sin; LANES]];
                (cos, sin) = (frequency * sin, -frequency * cos);
            }
        }
        Self {
            stiffness: arm.stiffness,
            offset: arm.offset,
            frequency: arm.cogging_frequency,
            pairs: arm.harmonics() / 2,
            waves,
        }
    }

    /// The first `E` derivatives, g itself the first, at the angles of `M` vectors. Each step waits for the
    /// one before; with two vectors there is work to do meanwhile.
    #[inline(always)]
    pub fn derivatives<A: Arithmetic, const M: usize, const E: usize>(
        &self,
        angle: [A::Vector; M],
    ) -> [[A::Vector; M]; E] {
        const { assert!(1 <= E && E <= D) };
        let splat = A::Vector::splat;
        let (mut scaled, mut sums) = (angle, [[splat(0.0); M]; E]);
        for m in 0..M {
            scaled[m] = splat(self.frequency) * angle[m];
        }
        let [sin, cos] = sin_cos::<A, M>(scaled);
        let (first, others) = self
            .waves
            .split_first_chunk::<1>()
            .unwrap_or((&[[[[0.0; LANES]; 2]; D]], &[]));
        let (others, _) = others.as_chunks::<2>();
        for m in 0..M {
            let mut sum = [splat(0.0); E];
            sum[0] = splat(self.stiffness).mul_add(angle[m], splat(self.offset));
            if E > 1 {
                sum[1] = splat(self.stiffness);
            }
            let mut odd = [cos[m], sin[m]];
            let mut even = [splat(1.0), splat(0.0)];
            let twice = cos[m] + cos[m];
            add::<A, D, E>(&first[0], odd, &mut sum);
            // Even and odd harmonics in turn, each from the two before.
            for [waves_even, waves_odd] in others.iter().take(self.pairs) {
                even = [0, 1].map(|of| twice.mul_sub(odd[of], even[of]));
                add::<A, D, E>(waves_even, even, &mut sum);
                odd = [0, 1].map(|of| twice.mul_sub(even[of], odd[of]));
                add::<A, D, E>(waves_odd, odd, &mut sum);
            }
            for e in 0..E {
                sums[e][m] = sum[e];
            }
        }
        sums
    }
}

/// Adds what a harmonic of the given cosine and sine counts for.
#[inline(always)]
fn add<A: Arithmetic, const D: usize, const E: usize>(
    waves: &[[[f64; LANES]; 2]; D],
    [cos, sin]: [A::Vector; 2],
    sums: &mut [A::Vector; E],
) {
    for (sum, [by_cos, by_sin]) in sums.iter_mut().zip(waves) {
        *sum = A::Vector::new(by_cos).mul_add(cos, *sum);
        *sum = A::Vector::new(by_sin).mul_add(sin, *sum);
    }
}

impl Parameters {
    /// g(θ): torque that holds the arm at `angle`, hysteresis excluded \[N·m\] (eq 12).
    pub fn position_torque(&self, angle: f64) -> f64 {
        let [value] = self.at(angle);
        value
    }

    /// g and its first D − 1 derivatives at `angle` \[N·m, N·m/rad, N·m/rad²\].
    pub(crate) fn at<const D: usize>(&self, angle: f64) -> [f64; D] {
        let angles = [<Separate as Arithmetic>::Vector::splat(angle)];
        let vectors = PositionTorque::<D>::new(self).derivatives::<Separate, 1, D>(angles);
        vectors.map(|[vector]| vector.lanes()[0])
    }

    /// Number of the highest harmonic that is present.
    pub fn harmonics(&self) -> usize {
        let mut pairs = self.cogging_cos.iter().zip(&self.cogging_sin);
        let highest = pairs.rposition(|(a, b)| *a != 0.0 || *b != 0.0);
        highest.map_or(0, |index| index + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::{Instructions, Kernel};
    use proptest::prelude::*;

    struct SinCos([f64; 4]);

    impl Kernel for SinCos {
        type Output = [[f64; 4]; 2];

        #[inline(always)]
        fn run<A: Arithmetic>(self) -> [[f64; 4]; 2] {
            sin_cos::<A, 1>([A::Vector::new(&self.0)]).map(|[vector]| vector.lanes())
        }
    }

    /// φ of a plausible size with all harmonics present.
    fn any_parameters() -> impl Strategy<Value = Parameters> {
        let amplitudes = || prop::array::uniform9(-0.3..0.3);
        (0.0..20.0, -5.0..5.0, -5.0..5.0, amplitudes(), amplitudes()).prop_map(
            |(cogging_frequency, stiffness, offset, cogging_cos, cogging_sin)| Parameters {
                stiffness,
                offset,
                cogging_frequency,
                cogging_cos,
                cogging_sin,
                ..Parameters::tflex()
            },
        )
    }

    proptest! {
        #[test]
        fn sine_and_cosine_agree_with_the_platforms(
            x in prop::array::uniform4(prop_oneof![-7.0..7.0_f64, -2e5..2e5_f64, Just(0.0)]), fused: bool,
        ) {
            let instructions = if fused { Instructions::Fused } else { Instructions::Baseline };
            let [sin, cos] = instructions.run(SinCos(x));
            for l in 0..4 {
                prop_assert!((sin[l] - x[l].sin()).abs() <= 1e-15, "sin {}: {}", x[l], sin[l]);
                prop_assert!((cos[l] - x[l].cos()).abs() <= 1e-15, "cos {}: {}", x[l], cos[l]);
            }
        }

        #[test]
        fn recursion_agrees_with_the_direct_sum(p in any_parameters(), angle in -3.0..3.0_f64) {
            let direct: f64 = (1..=HARMONICS).map(|i| {
                let (sin, cos) = (i as f64 * p.cogging_frequency * angle).sin_cos();
                p.cogging_cos[i - 1] * cos + p.cogging_sin[i - 1] * sin
            }).sum::<f64>() + p.stiffness * angle + p.offset;
            prop_assert!((p.position_torque(angle) - direct).abs() < 1e-12);
        }

        #[test]
        fn lanes_are_single_angles_to_the_bit(
            p in any_parameters(), angles in prop::array::uniform4(-3.0..3.0_f64),
        ) {
            let angle = <Separate as Arithmetic>::Vector::new(&angles);
            let vectors = PositionTorque::<3>::new(&p).derivatives::<Separate, 2, 3>([angle; 2]);
            for l in 0..4 {
                let single = p.at::<3>(angles[l]);
                prop_assert_eq!(vectors.map(|[vector, _]| vector.lanes()[l]), single);
                prop_assert_eq!(vectors.map(|[_, vector]| vector.lanes()[l]), single);
            }
        }

        #[test]
        fn derivatives_agree_with_differences(p in any_parameters(), angle in -3.0..3.0_f64) {
            let h = 1e-5;
            let [_, slope, curvature] = p.at::<3>(angle);
            let [above, slope_above, _] = p.at::<3>(angle + h);
            let [below, slope_below, _] = p.at::<3>(angle - h);
            // Third and fourth derivatives reach Σ|a_i|·(i·w)^n, hence the relative scale.
            let scale = p.cogging_frequency.powi(3).max(1.0);
            prop_assert!(((above - below) / (2.0 * h) - slope).abs() < 1e-6 * scale);
            let difference = (slope_above - slope_below) / (2.0 * h);
            prop_assert!((difference - curvature).abs() < 1e-6 * scale * 10.0);
        }
    }

    #[test]
    fn sine_and_cosine_of_what_is_no_number_are_none() {
        for x in [f64::NAN, f64::INFINITY] {
            let [sin, cos] = Instructions::Baseline.run(SinCos([0.0, x, 1.0, 2.0]));
            assert!(sin[1].is_nan() && cos[1].is_nan());
        }
    }

    #[test]
    fn absent_harmonics_are_not_counted() {
        assert_eq!(Parameters::tflex().harmonics(), 9);
        assert_eq!(Parameters::pendulum().harmonics(), 1);
    }
}
