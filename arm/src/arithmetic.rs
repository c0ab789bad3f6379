//! How floating point arithmetic is done: one source, compiled once for every processor of the platform
//! and once for its fused multiply-add and wide vectors.
//!
//! A [`Kernel`] is written for any [`Arithmetic`]; [`Instructions::run`] picks at run time. Results of the
//! two differ in the last bits, because a fused multiply-add rounds once where two instructions round twice.

use crate::vector::Vector;
#[cfg(not(target_arch = "x86_64"))]
use crate::vector::plain::Plain;
#[cfg(target_arch = "x86_64")]
use crate::vector::x86_64::{Pair, Wide};

/// Multiply-add with one or with two roundings.
pub trait Arithmetic: Copy {
    /// Four numbers with this multiply-add.
    type Vector: Vector;

    /// a·b + c.
    fn mul_add(a: f64, b: f64, c: f64) -> f64;
}

/// Two roundings: the same bits on every machine.
#[derive(Clone, Copy, Debug)]
pub struct Separate;

/// One rounding. Private: on x86-64 it takes instructions that only [`Instructions::run`] asks for.
#[derive(Clone, Copy, Debug)]
struct Fused;

impl Arithmetic for Separate {
    #[cfg(target_arch = "x86_64")]
    type Vector = Pair;
    #[cfg(not(target_arch = "x86_64"))]
    type Vector = Plain<false>;

    #[inline(always)]
    fn mul_add(a: f64, b: f64, c: f64) -> f64 {
        a * b + c
    }
}

impl Arithmetic for Fused {
    #[cfg(target_arch = "x86_64")]
    type Vector = Wide;
    #[cfg(not(target_arch = "x86_64"))]
    type Vector = Plain<true>;

    #[inline(always)]
    fn mul_add(a: f64, b: f64, c: f64) -> f64 {
        a.mul_add(b, c)
    }
}

/// Work that is worth compiling for several processors.
pub trait Kernel {
    /// What comes out.
    type Output;

    /// Does the work. Implementations and all they call are `#[inline(always)]`: only what is inlined is
    /// compiled for the wider instructions.
    fn run<A: Arithmetic>(self) -> Self::Output;
}

/// Instructions that kernels are run with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// Those of every processor of the platform, without fused multiply-add: bit-reproducible.
    Baseline,
    /// Fused multiply-add: AVX2 and FMA on x86-64, part of the baseline on aarch64.
    Fused,
}

impl Instructions {
    /// The best that this machine has.
    pub fn best() -> Self {
        Self::Fused.available()
    }

    /// What [`Self::run`] uses for these on this machine.
    pub fn available(self) -> Self {
        match self {
            Self::Fused if has_fused() => Self::Fused,
            _ => Self::Baseline,
        }
    }

    /// Runs a kernel; where the machine lacks [`Self::Fused`], with [`Self::Baseline`].
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.available() {
            Self::Fused => run_fused(kernel),
            Self::Baseline => kernel.run::<Separate>(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[inline]
fn has_fused() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

#[cfg(target_arch = "x86_64")]
#[inline]
fn run_fused<K: Kernel>(kernel: K) -> K::Output {
    #[target_feature(enable = "avx2,fma")]
    fn run<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<Fused>()
    }
    // SAFETY: only called where `has_fused` said that the processor has AVX2 and FMA.
    unsafe { run(kernel) }
}

#[cfg(not(target_arch = "x86_64"))]
#[inline]
fn has_fused() -> bool {
    cfg!(target_arch = "aarch64")
}

#[cfg(not(target_arch = "x86_64"))]
#[inline]
fn run_fused<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Fused>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// a·b + c where the product does not fit a double.
    struct Product;

    impl Kernel for Product {
        type Output = f64;

        #[inline(always)]
        fn run<A: Arithmetic>(self) -> f64 {
            let a = 1.0 + f64::EPSILON;
            A::mul_add(a, a, -(1.0 + 2.0 * f64::EPSILON))
        }
    }

    #[test]
    fn one_rounding_keeps_what_two_lose() {
        assert_eq!(Instructions::Baseline.run(Product), 0.0);
        let expected = if Instructions::best() == Instructions::Fused {
            f64::EPSILON * f64::EPSILON
        } else {
            0.0
        };
        assert_eq!(Instructions::Fused.run(Product), expected);
    }
}
