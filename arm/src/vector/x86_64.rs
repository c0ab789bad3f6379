//! [`Vector`] in the instructions of x86-64: one register of AVX2 with FMA, two of SSE2.

use std::arch::x86_64::*;
use std::ops::{Add, Mul, Sub};

use super::{LANES, Vector, sealed};

/// One register of AVX2, with fused multiply-add.
///
/// Only [`crate::Instructions::run`] can name it, through the arithmetic that it picks once the processor has
/// said that it has AVX2 and FMA: that is what every `unsafe` below relies on.
#[derive(Clone, Copy, Debug)]
pub struct Wide(__m256d);

/// Two registers of SSE2, which every x86-64 processor has: that is what every `unsafe` below relies on.
#[derive(Clone, Copy, Debug)]
pub struct Pair([__m128d; 2]);

impl Pair {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(__m128d, __m128d) -> __m128d) -> Self {
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }
}

macro_rules! operator {
    ($operator:ident, $method:ident, $wide:ident, $pair:ident) => {
        impl $operator for Wide {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see `Wide`.
                Self(unsafe { $wide(self.0, other.0) })
            }
        }

        impl $operator for Pair {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see `Pair`.
                self.zip(other, |a, b| unsafe { $pair(a, b) })
            }
        }
    };
}

operator!(Add, add, _mm256_add_pd, _mm_add_pd);
operator!(Sub, sub, _mm256_sub_pd, _mm_sub_pd);
operator!(Mul, mul, _mm256_mul_pd, _mm_mul_pd);

impl sealed::Sealed for Wide {}
impl sealed::Sealed for Pair {}

impl Vector for Wide {
    #[inline(always)]
    fn new(lanes: &[f64; LANES]) -> Self {
        // SAFETY: see `Wide`; the pointer is to four numbers.
        Self(unsafe { _mm256_loadu_pd(lanes.as_ptr()) })
    }

    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see `Wide`.
        Self(unsafe { _mm256_set1_pd(x) })
    }

    #[inline(always)]
    fn lanes(self) -> [f64; LANES] {
        let mut lanes = [0.0; LANES];
        // SAFETY: see `Wide`; the pointer is to four numbers.
        unsafe { _mm256_storeu_pd(lanes.as_mut_ptr(), self.0) };
        lanes
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: see `Wide`.
        Self(unsafe { _mm256_fmadd_pd(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        // SAFETY: see `Wide`.
        Self(unsafe { _mm256_fmsub_pd(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: see `Wide`.
        Self(unsafe { _mm256_fnmadd_pd(self.0, b.0, c.0) })
    }

    #[inline(always)]
    fn over(self, b: Self) -> Self {
        // SAFETY: see `Wide`.
        Self(unsafe { _mm256_div_pd(self.0, b.0) })
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        // SAFETY: see `Wide`.
        Self(unsafe { _mm256_max_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        // SAFETY: see `Wide`.
        Self(unsafe { _mm256_min_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: see `Wide`.
        unsafe {
            let low = _mm256_castpd256_pd128(self.0);
            let half = _mm_add_pd(low, _mm256_extractf128_pd::<1>(self.0));
            _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)))
        }
    }

    #[inline(always)]
    fn sums([a, b, c, d]: [Self; LANES]) -> Self {
        // SAFETY: see `Wide`.
        unsafe {
            // Lanes (0 + 2, 1 + 3) of a and c, and of b and d.
            let halves = |x: Self, y: Self| {
                let low = _mm256_permute2f128_pd::<0x20>(x.0, y.0);
                let high = _mm256_permute2f128_pd::<0x31>(x.0, y.0);
                _mm256_add_pd(low, high)
            };
            let (ac, bd) = (halves(a, c), halves(b, d));
            let even = _mm256_unpacklo_pd(ac, bd);
            Self(_mm256_add_pd(even, _mm256_unpackhi_pd(ac, bd)))
        }
    }

    #[inline(always)]
    fn any_beyond(self, limit: f64) -> bool {
        // SAFETY: see `Wide`.
        unsafe {
            let magnitude = _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0);
            let beyond = _mm256_cmp_pd::<_CMP_GT_OQ>(magnitude, _mm256_set1_pd(limit));
            _mm256_movemask_pd(beyond) != 0
        }
    }

    #[inline(always)]
    fn turned(turns: Self, sin: Self, cos: Self) -> [Self; 2] {
        // SAFETY: see `Wide`.
        unsafe {
            // Odd quadrants swap sine and cosine; signs by the second bit of the quadrant.
            let quadrant = _mm256_castpd_si256(turns.0);
            let odd = _mm256_castsi256_pd(_mm256_slli_epi64::<63>(quadrant));
            let next = _mm256_add_epi64(quadrant, _mm256_set1_epi64x(1));
            let signed = |x: __m256d, quadrant: __m256i| {
                let second = _mm256_castsi256_pd(_mm256_slli_epi64::<62>(quadrant));
                Self(_mm256_xor_pd(
                    x,
                    _mm256_and_pd(second, _mm256_set1_pd(-0.0)),
                ))
            };
            [
                signed(_mm256_blendv_pd(sin.0, cos.0, odd), quadrant),
                signed(_mm256_blendv_pd(cos.0, sin.0, odd), next),
            ]
        }
    }
}

impl Vector for Pair {
    #[inline(always)]
    fn new(lanes: &[f64; LANES]) -> Self {
        let lanes = lanes.as_ptr();
        // SAFETY: see `Pair`; the pointers are to two of four numbers each.
        Self(unsafe { [_mm_loadu_pd(lanes), _mm_loadu_pd(lanes.add(2))] })
    }

    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see `Pair`.
        Self([unsafe { _mm_set1_pd(x) }; 2])
    }

    #[inline(always)]
    fn lanes(self) -> [f64; LANES] {
        let mut lanes = [0.0; LANES];
        let (low, high) = lanes.split_at_mut(2);
        // SAFETY: see `Pair`; the pointers are to two numbers each.
        unsafe {
            _mm_storeu_pd(low.as_mut_ptr(), self.0[0]);
            _mm_storeu_pd(high.as_mut_ptr(), self.0[1]);
        }
        lanes
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self * b - c
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        c - self * b
    }

    #[inline(always)]
    fn over(self, b: Self) -> Self {
        // SAFETY: see `Pair`.
        self.zip(b, |a, b| unsafe { _mm_div_pd(a, b) })
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        // SAFETY: see `Pair`.
        self.zip(other, |a, b| unsafe { _mm_max_pd(a, b) })
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        // SAFETY: see `Pair`.
        self.zip(other, |a, b| unsafe { _mm_min_pd(a, b) })
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: see `Pair`.
        unsafe {
            let half = _mm_add_pd(self.0[0], self.0[1]);
            _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)))
        }
    }

    #[inline(always)]
    fn sums([a, b, c, d]: [Self; LANES]) -> Self {
        // SAFETY: see `Pair`.
        unsafe {
            let pair = |a: Self, b: Self| {
                let (a, b) = (_mm_add_pd(a.0[0], a.0[1]), _mm_add_pd(b.0[0], b.0[1]));
                _mm_add_pd(_mm_unpacklo_pd(a, b), _mm_unpackhi_pd(a, b))
            };
            Self([pair(a, b), pair(c, d)])
        }
    }

    #[inline(always)]
    fn any_beyond(self, limit: f64) -> bool {
        // SAFETY: see `Pair`.
        unsafe {
            let (sign, limit) = (_mm_set1_pd(-0.0), _mm_set1_pd(limit));
            let beyond = |x| _mm_cmpgt_pd(_mm_andnot_pd(sign, x), limit);
            _mm_movemask_pd(_mm_or_pd(beyond(self.0[0]), beyond(self.0[1]))) != 0
        }
    }

    #[inline(always)]
    fn turned(turns: Self, sin: Self, cos: Self) -> [Self; 2] {
        let mut turned = [sin, cos];
        for half in 0..2 {
            // SAFETY: see `Pair`.
            unsafe {
                // Odd quadrants swap sine and cosine; signs by the second bit of the quadrant.
                let quadrant = _mm_castpd_si128(turns.0[half]);
                let one = _mm_set1_epi64x(1);
                let odd = _mm_sub_epi64(_mm_setzero_si128(), _mm_and_si128(quadrant, one));
                let (sin, cos) = (sin.0[half], cos.0[half]);
                let swap = _mm_and_pd(_mm_xor_pd(sin, cos), _mm_castsi128_pd(odd));
                let signed = |x: __m128d, quadrant: __m128i| {
                    let second = _mm_castsi128_pd(_mm_slli_epi64::<62>(quadrant));
                    _mm_xor_pd(x, _mm_and_pd(second, _mm_set1_pd(-0.0)))
                };
                turned[0].0[half] = signed(_mm_xor_pd(sin, swap), quadrant);
                turned[1].0[half] = signed(_mm_xor_pd(cos, swap), _mm_add_epi64(quadrant, one));
            }
        }
        turned
    }
}
