//! The jitter of rays: a hash of their pixel, without chance.

/// Numbers in [0, 1) for one ray of a pixel, spread evenly over the rays of the pixel.
pub(crate) struct Noise {
    /// The index in the pixel's sequence, and the shift of that sequence.
    index: u32,
    shift: u64,
}

impl Noise {
    pub(crate) fn new((x, y): (u32, u32), ray: u32) -> Self {
        let mut shift = (u64::from(x) << 32 | u64::from(y)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        shift = (shift ^ (shift >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        Self { index: ray, shift: shift ^ (shift >> 32) }
    }

    /// Two numbers for the purpose `which`.
    pub(crate) fn pair(&self, which: u32) -> [f64; 2] {
        // The R2 sequence (Roberts 2018): multiples of the powers of the plastic number's inverse, shifted pixel by
        // pixel.
        const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
        [0, 1].map(|axis| {
            let shift = self.shift.rotate_left(17 * which + 29 * axis as u32) >> 40;
            let value = f64::from(self.index) * STEPS[axis] + shift as f64 / 16_777_216.0;
            value - value.floor()
        })
    }
}
