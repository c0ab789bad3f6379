//! g(θ) and its derivatives (eq 12), for several angles at once.
//!
//! One sine and cosine a piece; the sums of the higher harmonics are polynomials in cos 2x, with 1, sin 2x, cos x
//! and sin x as factors, by Horner's rule: half the harmonics is their degree. Sine and cosine are computed here, so
//! that several angles share vector instructions. A single angle takes the harmonics one after the other.

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

/// Powers of cos 2x in the polynomials: half the harmonics, and one.
const POWERS: usize = HARMONICS / 2 + 1;
/// What the polynomials of degree n in cos 2x belong to: cos 2nx = T_n, sin 2nx = sin 2x·U_{n−1},
/// cos (2n+1)x = cos x·V_n and sin (2n+1)x = sin x·W_n, Chebyshev's four kinds \[4 × n × power\].
const CHEBYSHEV: [[[f64; POWERS]; POWERS]; 4] = [
    chebyshev(1.0, [0.0, 1.0]),
    chebyshev(0.0, [1.0, 0.0]),
    chebyshev(1.0, [-1.0, 2.0]),
    chebyshev(1.0, [1.0, 2.0]),
];

/// Coefficients of P_n from those of P_0 and P_1 by P_{n+1} = 2y·P_n − P_{n−1}.
const fn chebyshev(first: f64, second: [f64; 2]) -> [[f64; POWERS]; POWERS] {
    let mut of = [[0.0; POWERS]; POWERS];
    of[0][0] = first;
    (of[1][0], of[1][1]) = (second[0], second[1]);
    let mut n = 2;
    while n < POWERS {
        let mut power = 0;
        while power <= n {
            let raised = if power > 0 { of[n - 1][power - 1] } else { 0.0 };
            of[n][power] = 2.0 * raised - of[n - 2][power];
            power += 1;
        }
        n += 1;
    }
    of
}

/// g and its derivatives with respect to θ, the first `D` of them, ready for evaluation.
#[derive(Clone, Copy, Debug)]
pub struct PositionTorque<const D: usize> {
    stiffness: f64,
    frequency: f64,
    /// Whether there is no harmonic above the first.
    plain: bool,
    /// What the powers of cos 2wθ count for in each derivative, times 1, sin 2wθ, cos wθ and sin wθ, the same in
    /// all lanes.
    powers: [[[[f64; LANES]; 4]; D]; POWERS],
}

impl<const D: usize> PositionTorque<D> {
    /// Of an arm.
    pub fn new(arm: &Parameters) -> Self {
        let mut powers = [[[[0.0; LANES]; 4]; D]; POWERS];
        let mut add = |power: usize, d: usize, of: usize, what: f64| {
            let lanes: &mut [f64; LANES] = &mut powers[power][d][of];
            *lanes = lanes.map(|sum| sum + what);
        };
        let waves = arm.cogging_cos.iter().zip(&arm.cogging_sin);
        for (i, (&cos, &sin)) in (1..).zip(waves).take(arm.harmonics()) {
            let (frequency, odd) = (i as f64 * arm.cogging_frequency, 2 * (i % 2));
            let mut wave = [cos, sin];
            for d in 0..D {
                for (of, amplitude) in wave.into_iter().enumerate() {
                    let polynomial = &CHEBYSHEV[odd + of][i / 2];
                    for (power, coefficient) in polynomial.iter().enumerate().take(i / 2 + 1) {
                        add(power, d, odd + of, amplitude * coefficient);
                    }
                }
                wave = [frequency * wave[1], -frequency * wave[0]];
            }
        }
        add(0, 0, 0, arm.offset);
        if D > 1 {
            add(0, 1, 0, arm.stiffness);
        }
        Self {
            stiffness: arm.stiffness,
            frequency: arm.cogging_frequency,
            plain: arm.harmonics() <= 1,
            powers,
        }
    }

    /// The first `E` derivatives, g itself the first, at the angles of `M` vectors. Each step of a sine waits for the
    /// one before; with two vectors there is work to do meanwhile.
    #[inline(always)]
    pub fn derivatives<A: Arithmetic, const M: usize, const E: usize>(
        &self,
        angle: [A::Vector; M],
    ) -> [[A::Vector; M]; E] {
        const { assert!(1 <= E && E <= D) };
        let (vector, splat) = (A::Vector::new, A::Vector::splat);
        let (mut scaled, mut sums) = (angle, [[splat(0.0); M]; E]);
        for m in 0..M {
            scaled[m] = splat(self.frequency) * angle[m];
        }
        let [sin, cos] = sin_cos::<A, M>(scaled);
        for m in 0..M {
            let [lowest, .., highest] = &self.powers;
            let mut polynomials = [[splat(0.0); 4]; E];
            if self.plain {
                for e in 0..E {
                    polynomials[e] = lowest[e].each_ref().map(vector);
                }
            } else {
                let twice = cos[m] + cos[m];
                let (sin_double, cos_double) = (twice * sin[m], twice.mul_sub(cos[m], splat(1.0)));
                for e in 0..E {
                    let mut polynomial = highest[e].each_ref().map(vector);
                    for power in (0..POWERS - 1).rev() {
                        for of in 0..4 {
                            let coefficient = vector(&self.powers[power][e][of]);
                            polynomial[of] = polynomial[of].mul_add(cos_double, coefficient);
                        }
                    }
                    polynomial[0] = polynomial[1].mul_add(sin_double, polynomial[0]);
                    polynomials[e] = polynomial;
                }
            }
            for e in 0..E {
                let [even, _, by_cos, by_sin] = polynomials[e];
                sums[e][m] = by_cos.mul_add(cos[m], by_sin.mul_add(sin[m], even));
            }
            sums[0][m] = splat(self.stiffness).mul_add(angle[m], sums[0][m]);
        }
        sums
    }
}

impl Parameters {
    /// g(θ): torque that holds the arm at `angle`, hysteresis excluded \[N·m\] (eq 12).
    pub fn position_torque(&self, angle: f64) -> f64 {
        let [value] = self.at(angle);
        value
    }

    /// g and its first D − 1 derivatives at `angle` \[N·m, N·m/rad, N·m/rad²\].
    ///
    /// For a single angle no polynomial is worth its coefficients: Chebyshev's recursion
    /// cos (i+1)x = 2·cos x·cos ix − cos (i−1)x, and likewise for the sines, needs none.
    pub(crate) fn at<const D: usize>(&self, angle: f64) -> [f64; D] {
        let scaled = <Separate as Arithmetic>::Vector::splat(self.cogging_frequency * angle);
        let [[sin], [cos]] = sin_cos::<Separate, 1>([scaled]);
        let first = [cos.lanes()[0], sin.lanes()[0]];
        let mut sums = [0.0; D];
        for (sum, straight) in sums
            .iter_mut()
            .zip([self.offset + self.stiffness * angle, self.stiffness])
        {
            *sum = straight;
        }
        // cos ix and sin ix, and those of the harmonic before.
        let (mut wave, mut before) = (first, [1.0, 0.0]);
        let amplitudes = self.cogging_cos.iter().zip(&self.cogging_sin);
        for (i, (&by_cos, &by_sin)) in (1..).zip(amplitudes).take(self.harmonics()) {
            let frequency = f64::from(i) * self.cogging_frequency;
            let (mut by_cos, mut by_sin) = (by_cos, by_sin);
            for sum in &mut sums {
                *sum += by_cos * wave[0] + by_sin * wave[1];
                (by_cos, by_sin) = (frequency * by_sin, -frequency * by_cos);
            }
            let next = [0, 1].map(|of| 2.0 * first[0] * wave[of] - before[of]);
            (before, wave) = (wave, next);
        }
        sums
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

    /// g and two derivatives at four angles, twice side by side.
    struct Derivatives(PositionTorque<3>, [f64; 4]);

    impl Kernel for Derivatives {
        type Output = [[[f64; 4]; 2]; 3];

        #[inline(always)]
        fn run<A: Arithmetic>(self) -> [[[f64; 4]; 2]; 3] {
            let angle = A::Vector::new(&self.1);
            let vectors = self.0.derivatives::<A, 2, 3>([angle; 2]);
            vectors.map(|pair| pair.map(|vector| vector.lanes()))
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
        fn polynomials_agree_with_the_recursion(
            mut p in any_parameters(), harmonics in 0..=HARMONICS, angles in prop::array::uniform4(-3.0..3.0_f64), fused: bool,
        ) {
            p.cogging_cos[harmonics..].fill(0.0);
            p.cogging_sin[harmonics..].fill(0.0);
            let instructions = if fused { Instructions::Fused } else { Instructions::Baseline };
            let pair = instructions.run(Derivatives(PositionTorque::new(&p), angles));
            for l in 0..4 {
                let single = p.at::<3>(angles[l]);
                for (e, expected) in single.into_iter().enumerate() {
                    // Σ|a_i|·(i·w)^e, and what is lost of x.
                    let size = 10.0 * (9.0 * p.cogging_frequency).max(1.0).powi(e as i32);
                    for lanes in pair[e] {
                        prop_assert!((lanes[l] - expected).abs() < 1e-13 * size, "{e}: {} {expected}", lanes[l]);
                    }
                }
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
