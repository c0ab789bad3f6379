//! g(θ) and its derivatives (eq 12), for several angles at once.
//!
//! One sine and cosine a piece; the angle-addition theorems give those of the higher harmonics. Sine and
//! cosine are computed here and not by the platform's library, so that the same arithmetic gives the same
//! bits on every platform, and so that several angles share vector instructions.

use crate::arithmetic::{Arithmetic, Separate};
use crate::parameters::Parameters;

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

/// Sine and cosine, within 1e-15.
#[inline(always)]
fn sin_cos<A: Arithmetic, const L: usize>(x: [f64; L]) -> [[f64; L]; 2] {
    if x.iter().any(|x| x.abs() > LARGEST_ARGUMENT) {
        return large_sin_cos(x);
    }
    let (mut sin, mut cos) = ([0.0; L], [0.0; L]);
    for l in 0..L {
        let shifted = A::mul_add(x[l], std::f64::consts::FRAC_2_PI, ROUNDING);
        let quadrant = shifted.to_bits();
        let n = shifted - ROUNDING;
        let r = A::mul_add(-n, HALF_PI[0], x[l]);
        let r = A::mul_add(-n, HALF_PI[1], r);
        let r = A::mul_add(-n, HALF_PI[2], r);
        let z = r * r;
        let horner = |c: &[f64; 6]| {
            let high = A::mul_add(A::mul_add(c[5], z, c[4]), z, c[3]);
            A::mul_add(A::mul_add(A::mul_add(high, z, c[2]), z, c[1]), z, c[0])
        };
        let s = A::mul_add(r * z, horner(&SIN), r);
        let c = A::mul_add(z * z, horner(&COS), A::mul_add(-0.5, z, 1.0));
        // Odd quadrants swap sine and cosine; signs by the second bit of the quadrant.
        let odd = 0u64.wrapping_sub(quadrant & 1);
        let (s, c) = (s.to_bits(), c.to_bits());
        let swap = (s ^ c) & odd;
        sin[l] = f64::from_bits(s ^ swap ^ ((quadrant & 2) << 62));
        cos[l] = f64::from_bits(c ^ swap ^ ((quadrant.wrapping_add(1) & 2) << 62));
    }
    [sin, cos]
}

#[cold]
fn large_sin_cos<const L: usize>(x: [f64; L]) -> [[f64; L]; 2] {
    [x.map(f64::sin), x.map(f64::cos)]
}

impl Parameters {
    /// g(θ): torque that holds the arm at `angle`, hysteresis excluded \[N·m\] (eq 12).
    pub fn position_torque(&self, angle: f64) -> f64 {
        self.position_torque_derivatives(angle)[0]
    }

    /// g, dg/dθ and d²g/dθ² at `angle` \[N·m, N·m/rad, N·m/rad²\].
    pub fn position_torque_derivatives(&self, angle: f64) -> [f64; 3] {
        let lanes = self.position_torque_lanes::<Separate, 1>(self.harmonics(), [angle]);
        lanes.map(|[value]| value)
    }

    /// Number of the highest harmonic that is present.
    pub fn harmonics(&self) -> usize {
        let mut pairs = self.cogging_cos.iter().zip(&self.cogging_sin);
        let highest = pairs.rposition(|(a, b)| *a != 0.0 || *b != 0.0);
        highest.map_or(0, |index| index + 1)
    }

    /// g, dg/dθ and d²g/dθ² at several angles, the first `harmonics` taken in.
    #[inline(always)]
    pub fn position_torque_lanes<A: Arithmetic, const L: usize>(
        &self,
        harmonics: usize,
        angle: [f64; L],
    ) -> [[f64; L]; 3] {
        let w = self.cogging_frequency;
        let [sin, cos] = sin_cos::<A, L>(angle.map(|angle| w * angle));
        let (mut sin_i, mut cos_i) = (sin, cos);
        let mut value = angle.map(|angle| A::mul_add(self.stiffness, angle, self.offset));
        let (mut slope, mut curvature) = ([self.stiffness; L], [0.0; L]);
        let mut frequency = w;
        let present = self.cogging_cos.iter().zip(&self.cogging_sin);
        for (&a, &b) in present.take(harmonics) {
            let square = -frequency * frequency;
            for l in 0..L {
                let (s, c) = (sin_i[l], cos_i[l]);
                let wave = A::mul_add(a, c, b * s);
                let change = A::mul_add(b, c, -(a * s));
                value[l] += wave;
                slope[l] = A::mul_add(frequency, change, slope[l]);
                curvature[l] = A::mul_add(square, wave, curvature[l]);
                sin_i[l] = A::mul_add(s, cos[l], c * sin[l]);
                cos_i[l] = A::mul_add(c, cos[l], -(s * sin[l]));
            }
            frequency += w;
        }
        [value, slope, curvature]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::{Instructions, Kernel};
    use crate::parameters::HARMONICS;
    use proptest::prelude::*;

    struct SinCos([f64; 4]);

    impl Kernel for SinCos {
        type Output = [[f64; 4]; 2];

        #[inline(always)]
        fn run<A: Arithmetic>(self) -> [[f64; 4]; 2] {
            sin_cos::<A, 4>(self.0)
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
            let lanes = p.position_torque_lanes::<Separate, 4>(p.harmonics(), angles);
            for l in 0..4 {
                let single = p.position_torque_derivatives(angles[l]);
                prop_assert_eq!(lanes.map(|lane| lane[l]), single);
            }
        }

        #[test]
        fn derivatives_agree_with_differences(p in any_parameters(), angle in -3.0..3.0_f64) {
            let h = 1e-5;
            let [_, slope, curvature] = p.position_torque_derivatives(angle);
            let [above, slope_above, _] = p.position_torque_derivatives(angle + h);
            let [below, slope_below, _] = p.position_torque_derivatives(angle - h);
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
            let [sin, cos] = sin_cos::<Separate, 1>([x]);
            assert!(sin[0].is_nan() && cos[0].is_nan());
        }
    }

    #[test]
    fn absent_harmonics_are_not_counted() {
        assert_eq!(Parameters::tflex().harmonics(), 9);
        assert_eq!(Parameters::pendulum().harmonics(), 1);
    }
}
