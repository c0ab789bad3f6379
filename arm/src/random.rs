//! Numbers from a seed, the same on every machine: SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number
//! generators, 2014). For the noise of a drive, the setpoints of an experiment, and tests.

/// What the state advances by: 2⁶⁴ divided by the golden ratio.
pub const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// Finaliser: bits that depend on all bits of a state.
pub const fn mix(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^ (bits >> 31)
}

/// The next number of the sequence whose state begins with the seed, uniform in [0, 1).
pub fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(GOLDEN);
    (mix(*state) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the reference implementation (Vigna, splitmix64.c) with seed 1234567.
    #[test]
    fn the_sequence_is_that_of_the_reference() {
        let state = |k: u64| mix(1_234_567_u64.wrapping_add(k.wrapping_mul(GOLDEN)));
        let expected = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
        ];
        assert_eq!([state(1), state(2), state(3)], expected);
        let mut seed = 1_234_567;
        assert_eq!(
            uniform(&mut seed),
            (expected[0] >> 11) as f64 / 2f64.powi(53)
        );
    }
}
