//! [`Vector`] in plain Rust: for processors without one of their own here, and what those are tested against.

use std::ops::{Add, Mul, Sub};

use super::{LANES, Vector, sealed};

/// [`Vector`] in plain Rust, with fused multiply-add or without.
#[derive(Clone, Copy, Debug)]
pub struct Plain<const FUSED: bool>([f64; LANES]);

impl<const FUSED: bool> Plain<FUSED> {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|l| f(self.0[l], other.0[l])))
    }
}

impl<const FUSED: bool> Add for Plain<FUSED> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const FUSED: bool> Sub for Plain<FUSED> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const FUSED: bool> Mul for Plain<FUSED> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<const FUSED: bool> sealed::Sealed for Plain<FUSED> {}

impl<const FUSED: bool> Vector for Plain<FUSED> {
    #[inline(always)]
    fn new(lanes: &[f64; LANES]) -> Self {
        Self(*lanes)
    }

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; LANES])
    }

    #[inline(always)]
    fn lanes(self) -> [f64; LANES] {
        self.0
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        if FUSED {
            Self(std::array::from_fn(|l| self.0[l].mul_add(b.0[l], c.0[l])))
        } else {
            self * b + c
        }
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        if FUSED {
            Self(std::array::from_fn(|l| self.0[l].mul_add(b.0[l], -c.0[l])))
        } else {
            self * b - c
        }
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        if FUSED {
            Self(std::array::from_fn(|l| {
                (-self.0[l]).mul_add(b.0[l], c.0[l])
            }))
        } else {
            c - self * b
        }
    }

    #[inline(always)]
    fn over(self, b: Self) -> Self {
        self.zip(b, |a, b| a / b)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        (self.0[0] + self.0[2]) + (self.0[1] + self.0[3])
    }

    #[inline(always)]
    fn sums(of: [Self; LANES]) -> Self {
        Self(of.map(Self::sum))
    }

    #[inline(always)]
    fn any_beyond(self, limit: f64) -> bool {
        self.0.iter().any(|x| x.abs() > limit)
    }

    #[inline(always)]
    fn turned(turns: Self, sin: Self, cos: Self) -> [Self; 2] {
        let mut turned = [sin, cos];
        for l in 0..LANES {
            let quadrant = turns.0[l].to_bits();
            // Odd quadrants swap sine and cosine; signs by the second bit of the quadrant.
            let odd = 0u64.wrapping_sub(quadrant & 1);
            let (s, c) = (sin.0[l].to_bits(), cos.0[l].to_bits());
            let swap = (s ^ c) & odd;
            turned[0].0[l] = f64::from_bits(s ^ swap ^ ((quadrant & 2) << 62));
            turned[1].0[l] = f64::from_bits(c ^ swap ^ ((quadrant.wrapping_add(1) & 2) << 62));
        }
        turned
    }
}
