//! Random-looking heights, the same everywhere: for tests, examples, benches and comparisons, which include this file.
#![allow(unreachable_pub, reason = "some of them are programs")]

/// Approximately Gaussian, within ±3.5: the sum of four uniforms from a hash of the address.
pub fn noise(i: i64, j: i64) -> f64 {
    let mut h = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (j as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    h ^= h >> 31;
    h = h.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h ^= h >> 29;
    let u = |k: u32| f64::from((h >> (16 * k)) as u16) / 65535.0 - 0.5;
    (u(0) + u(1) + u(2) + u(3)) * 3.0_f64.sqrt()
}
