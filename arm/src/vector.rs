//! Four numbers side by side: one instruction, or two, where the processor has them.
//!
//! Operations act on each lane alone, in the order that is written; sums and products over the lanes have
//! one order everywhere. What a [`Vector`] computes does therefore not depend on how wide the registers are.

use std::ops::{Add, Mul, Sub};

#[cfg(any(test, not(target_arch = "x86_64")))]
pub(crate) mod plain;
#[cfg(target_arch = "x86_64")]
pub(crate) mod x86_64;

/// Lanes of a vector.
pub const LANES: usize = 4;

/// Four numbers side by side.
pub trait Vector:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + sealed::Sealed
{
    /// From the numbers of the lanes.
    fn new(lanes: &[f64; LANES]) -> Self;

    /// The same number in all lanes.
    fn splat(x: f64) -> Self;

    /// The numbers of the lanes.
    fn lanes(self) -> [f64; LANES];

    /// self·b + c, with the arithmetic's roundings.
    fn mul_add(self, b: Self, c: Self) -> Self;

    /// self·b − c, with the arithmetic's roundings.
    fn mul_sub(self, b: Self, c: Self) -> Self;

    /// c − self·b, with the arithmetic's roundings.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;

    /// self/b.
    fn over(self, b: Self) -> Self;

    /// The larger of two; `other` where one of them is no number.
    fn larger(self, other: Self) -> Self;

    /// The smaller of two; `other` where one of them is no number.
    fn smaller(self, other: Self) -> Self;

    /// Sum over the lanes, added as (0 + 2) + (1 + 3).
    fn sum(self) -> f64;

    /// In lanes 0, 1, 2, 3 the sums over the lanes of the four vectors, added as (0 + 2) + (1 + 3).
    fn sums(of: [Self; LANES]) -> Self;

    /// Whether a magnitude is above `limit`.
    fn any_beyond(self, limit: f64) -> bool;

    /// Sine and cosine after as many quarter turns as the last two bits of `turns` say.
    fn turned(turns: Self, sin: Self, cos: Self) -> [Self; 2];
}

pub(crate) mod sealed {
    /// Kernels choose among vectors, nobody adds to them: some are only sound where the processor was asked.
    pub trait Sealed {}
}

#[cfg(test)]
mod tests {
    use super::plain::Plain;
    use super::*;
    use crate::arithmetic::{Arithmetic, Instructions, Kernel};
    use proptest::prelude::*;

    /// All operations on three vectors, as lanes.
    struct Operations([[f64; LANES]; 3]);

    fn operate<V: Vector>(lanes: [[f64; LANES]; 3]) -> Vec<[f64; LANES]> {
        let [a, b, c] = lanes.map(|lanes| V::new(&lanes));
        let splat = V::splat(lanes[0][0]);
        let results = [
            a + b,
            a - b,
            a * b,
            a.over(b),
            a.mul_add(b, c),
            a.mul_sub(b, c),
            a.neg_mul_add(b, c),
            a.larger(b),
            a.smaller(b),
            splat,
            V::splat(a.sum()),
            V::sums([a, b, c, splat]),
        ];
        let beyond = V::splat(f64::from(u8::from(a.any_beyond(9.0))));
        let turned = (0..4_u8).flat_map(|turns| {
            let turns = lanes[2].map(|c| 6_755_399_441_055_744.0 + f64::from(turns) + c.round());
            V::turned(V::new(&turns), a, b)
        });
        let all = results.into_iter().chain([beyond]).chain(turned);
        all.map(V::lanes).collect()
    }

    impl Kernel for Operations {
        type Output = Vec<[f64; LANES]>;

        #[inline(always)]
        fn run<A: Arithmetic>(self) -> Vec<[f64; LANES]> {
            operate::<A::Vector>(self.0)
        }
    }

    fn bits(lanes: Vec<[f64; LANES]>) -> Vec<[u64; LANES]> {
        lanes.into_iter().map(|x| x.map(f64::to_bits)).collect()
    }

    proptest! {
        /// The processor's vectors are plain Rust to the bit.
        #[test]
        fn vectors_are_plain_to_the_bit(
            lanes in prop::array::uniform3(prop::array::uniform4(-10.0..10.0_f64)),
        ) {
            let baseline = Instructions::Baseline.run(Operations(lanes));
            prop_assert_eq!(bits(baseline), bits(operate::<Plain<false>>(lanes)));
            if Instructions::best() == Instructions::Fused {
                let fused = Instructions::Fused.run(Operations(lanes));
                prop_assert_eq!(bits(fused), bits(operate::<Plain<true>>(lanes)));
            }
        }
    }

    #[test]
    fn what_is_no_number_gives_way_and_is_not_beyond() {
        let nan = Plain::<false>::splat(f64::NAN);
        assert_eq!(nan.larger(Plain::splat(1.0)).lanes(), [1.0; LANES]);
        assert_eq!(nan.smaller(Plain::splat(1.0)).lanes(), [1.0; LANES]);
        assert!(!nan.any_beyond(1.0));
    }
}
