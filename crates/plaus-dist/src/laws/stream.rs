//! Keyed random streams: every random number is a pure function of (seed, chain, iteration, purpose).
//!
//! No generator is carried from one iteration to the next, so a chain resumes from its state and an iteration number
//! alone, a simulation that stops early cannot shift later randomness, and the number of threads cannot matter.
//!
//! The seed and the chain are hashed with BLAKE3 into a 256-bit chain key once. The state of the xoshiro256++ generator
//! of one iteration and purpose is that key, offset by a counter and passed through the SplitMix64 finaliser word by
//! word; xoshiro's authors recommend SplitMix64 for seeding (Blackman & Vigna, "Scrambled linear pseudorandom number
//! generators", ACM TOMS 47, 2021).
//!
//! ```
//! use plaus_dist::{Seed, Purpose};
//! use rand::RngExt;
//! let chain = Seed(7).chain(0);
//! let a: f64 = chain.at(12, Purpose::PROPOSE).random();
//! let b: f64 = chain.at(12, Purpose::PROPOSE).random();
//! let c: f64 = chain.at(12, Purpose::ACCEPT).random();
//! assert_eq!(a, b);
//! assert_ne!(a, c);
//! ```

use rand::Rng;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The generator every sampler in the project draws from.
pub type Stream = Xoshiro256PlusPlus;

/// Seed of a whole run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Seed(pub u64);

impl fmt::Display for Seed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// What the random numbers are for; two purposes never share a number.
///
/// The crates above define their own purposes as constants; values below 16 are the chain's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Purpose(pub u16);

impl Purpose {
    /// The first state of a chain.
    pub const START: Self = Self(0);
    /// Choosing a move and proposing a candidate.
    pub const PROPOSE: Self = Self(1);
    /// The uniform of the accept step.
    pub const ACCEPT: Self = Self(2);
    /// Swaps between tempered chains.
    pub const SWAP: Self = Self(3);
}

impl Seed {
    /// The streams of one chain.
    #[must_use]
    pub fn chain(self, chain: u64) -> ChainStreams {
        let mut hasher = blake3::Hasher::new_derive_key("plaus 2026-11 random streams: seed, chain");
        hasher.update(&self.0.to_le_bytes());
        hasher.update(&chain.to_le_bytes());
        let bytes = *hasher.finalize().as_bytes();
        let word = |i: usize| u64::from_le_bytes(std::array::from_fn(|b| bytes[8 * i + b]));
        ChainStreams { key: std::array::from_fn(word) }
    }
}

/// The streams of one chain of one seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChainStreams {
    key: [u64; 4],
}

impl ChainStreams {
    /// The stream of one iteration and purpose, from its beginning. Iterations up to 2⁴⁸ have streams of their own.
    #[must_use]
    #[inline]
    pub fn at(&self, iteration: u64, purpose: Purpose) -> Stream {
        let counter = (iteration << 16) | u64::from(purpose.0);
        let mut state = [0; 32];
        for (word, key) in state.chunks_exact_mut(8).zip(self.key) {
            word.copy_from_slice(&split_mix(key.wrapping_add(counter.wrapping_mul(GOLDEN))).to_le_bytes());
        }
        Stream::from_seed(state)
    }
}

/// 2⁶⁴ / golden ratio, odd: SplitMix64's increment.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's finaliser: a bijection of 64 bits in which every input bit reaches every output bit.
#[inline]
fn split_mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Uniform on (0, 1): 2⁵² equally spaced values, both ends excluded, so its logarithm is finite.
#[inline]
pub fn open_unit(stream: &mut impl Rng) -> f64 {
    ((stream.next_u64() >> 12) as f64 + 0.5) * (1.0 / 4_503_599_627_370_496.0)
}

/// Uniform on the whole numbers 0 .. `count`, to within 2⁻⁶⁴ · `count` of each one's probability; 0 where `count` is 0.
#[inline]
pub fn below(stream: &mut impl Rng, count: usize) -> usize {
    ((u128::from(stream.next_u64()) * count as u128) >> 64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_differ_by_every_part_of_the_key() {
        let first = |seed, chain, iteration, purpose| Seed(seed).chain(chain).at(iteration, purpose).next_u64();
        let base = first(1, 2, 3, Purpose::PROPOSE);
        assert_ne!(base, first(2, 2, 3, Purpose::PROPOSE));
        assert_ne!(base, first(1, 3, 3, Purpose::PROPOSE));
        assert_ne!(base, first(1, 2, 4, Purpose::PROPOSE));
        assert_ne!(base, first(1, 2, 3, Purpose::ACCEPT));
        assert_eq!(base, first(1, 2, 3, Purpose::PROPOSE));
    }

    /// Value stability: these bits are what every stored run and golden trace rests on.
    #[test]
    fn values_are_pinned() {
        let mut stream = Seed(42).chain(1).at(7, Purpose::PROPOSE);
        assert_eq!([stream.next_u64(), stream.next_u64()], [14_949_280_411_015_701_079, 17_190_473_814_623_078_715]);
    }

    #[test]
    fn open_unit_stays_inside() {
        struct Fixed(u64);
        impl rand::rand_core::TryRng for Fixed {
            type Error = std::convert::Infallible;
            fn try_next_u32(&mut self) -> Result<u32, Self::Error> {
                Ok(self.0 as u32)
            }
            fn try_next_u64(&mut self) -> Result<u64, Self::Error> {
                Ok(self.0)
            }
            fn try_fill_bytes(&mut self, dest: &mut [u8]) -> Result<(), Self::Error> {
                dest.fill(self.0 as u8);
                Ok(())
            }
        }
        assert!(open_unit(&mut Fixed(0)) > 0.0);
        assert!(open_unit(&mut Fixed(u64::MAX)) < 1.0);
    }

    /// First outputs over consecutive iterations are uniform: χ² over 256 cells of 2²⁰ draws, false-alarm rate 1e-6.
    #[test]
    fn consecutive_iterations_look_independent() {
        let streams = Seed(3).chain(5);
        let mut counts = [0_u32; 256];
        let mut agree = 0_u32;
        let mut last = 0_u64;
        for iteration in 0..(1 << 20) {
            let value = streams.at(iteration, Purpose::ACCEPT).next_u64();
            counts[(value >> 56) as usize] += 1;
            agree += (value ^ last).count_ones();
            last = value;
        }
        let expected = f64::from(1 << 20) / 256.0;
        let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - expected) * (f64::from(c) - expected) / expected).sum();
        // 99.9999% point of χ² with 255 degrees of freedom (Wilson–Hilferty): 375.6.
        assert!(chi2 < 375.6, "chi2 {chi2}");
        // Differing bits between neighbours: 2²⁶ fair coins, mean 2²⁵, standard deviation √(2²⁶ / 4) = 4096.
        let deviation = (f64::from(agree) - 33_554_432.0) / 4096.0;
        assert!(deviation.abs() < 4.9, "deviation {deviation}");
    }
}
