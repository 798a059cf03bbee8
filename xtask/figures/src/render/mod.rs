//! Pictures of an animation at one moment: rays traced through its bodies and scenery, with soft shadows.
//!
//! Everything follows from the animation and the size of the picture, bit for bit: rays are jittered by a hash of their pixel, not by chance.

mod bvh;
mod camera;
mod prims;
mod shade;

pub use camera::Camera;

use crate::Result;
use bvh::Bvh;
use glam::DVec3;
use plaus_scenes::Animation;
use rayon::prelude::*;
use resvg::tiny_skia::{ColorU8, Pixmap};
use shade::Shader;

/// How far below the bottom of what is to be seen the table lies, in metres: bowls touch the bottom.
const SUNK: f64 = 2e-4;

/// A picture's size, and how many rays are averaged in a pixel.
#[derive(Debug, Clone, Copy)]
pub struct Quality {
    pub width: u32,
    pub height: u32,
    pub rays: u32,
}

/// The picture of `animation` at `time` seconds.
pub fn render(animation: &Animation, time: f64, camera: &Camera, quality: Quality) -> Result<Pixmap> {
    let Quality { width, height, rays } = quality;
    let things = prims::of(animation, time);
    // On the bottom of what is to be seen, where that is known: a scenery may reach deeper than one looks.
    let framed = animation.view.and_then(|view| view.frame).map(|[a, b]| a.y.min(b.y) - SUNK);
    let ground = framed.unwrap_or_else(|| prims::lowest(&things));
    let shader = Shader { bvh: Bvh::new(things), ground };
    let rows: Vec<Vec<ColorU8>> = (0..height)
        .into_par_iter()
        .map(|y| (0..width).map(|x| pixel(&shader, camera, (x, y), (width, height), rays)).collect())
        .collect();
    let mut image = Pixmap::new(width, height).ok_or("a picture without pixels")?;
    for (place, colour) in image.pixels_mut().iter_mut().zip(rows.into_iter().flatten()) {
        *place = colour.premultiply();
    }
    Ok(image)
}

fn pixel(shader: &Shader, camera: &Camera, at: (u32, u32), size: (u32, u32), rays: u32) -> ColorU8 {
    let mut sum = DVec3::ZERO;
    for ray in 0..rays {
        let noise = Noise::new(at, ray, rays);
        let [dx, dy] = noise.pair(0);
        let across = (f64::from(at.0) + dx) / f64::from(size.0);
        let down = (f64::from(at.1) + dy) / f64::from(size.1);
        let (from, along) = camera.ray(across, down, f64::from(size.0) / f64::from(size.1));
        sum += shader.light(from, along, &noise);
    }
    let [r, g, b] = (sum / f64::from(rays)).to_array().map(shade::to_srgb);
    ColorU8::from_rgba(r, g, b, 255)
}

/// Numbers in [0, 1) for one ray of a pixel, spread evenly over the rays of the pixel.
pub(crate) struct Noise {
    /// Where in the pixel's sequence, and by how much the pixel's sequence is shifted.
    index: u32,
    shift: u64,
}

impl Noise {
    fn new((x, y): (u32, u32), ray: u32, _rays: u32) -> Self {
        let mut shift = (u64::from(x) << 32 | u64::from(y)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        shift = (shift ^ (shift >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        Self { index: ray, shift: shift ^ (shift >> 32) }
    }

    /// Two numbers for the purpose `which`.
    pub(crate) fn pair(&self, which: u32) -> [f64; 2] {
        // The R2 sequence (Roberts 2018): multiples of the powers of the plastic number's inverse, shifted pixel by pixel.
        const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
        [0, 1].map(|axis| {
            let shift = self.shift.rotate_left(17 * which + 29 * axis as u32) >> 40;
            let value = f64::from(self.index) * STEPS[axis] + shift as f64 / 16_777_216.0;
            value - value.floor()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_scenes::animation::{Look, Piece, Prop, Shape, Track};

    /// A ball of radius 1 hovers over a plate, seen from above: it covers π/16 of a square of side 4, its colour is red, its shadow is darker than the plate.
    #[test]
    fn a_ball_covers_its_disc_and_casts_a_shadow() {
        let red = Look { colour: plaus_scenes::animation::Colour([220, 30, 30]), ..Look::STONE };
        let ball = Track::new("ball", Shape::ball(1.0), red, vec![Piece::resting(0.0, DVec3::new(0.0, 1.5, 0.0))]);
        let plate = Prop::block("plate", Look::STONE, DVec3::new(0.0, -0.5, 0.0), DVec3::new(9.0, 0.5, 9.0));
        let animation = Animation::new(1.0, vec![ball], Vec::new()).with_scenery(vec![plate]);
        // From so far away that perspective does nothing.
        let frame = [DVec3::new(-2.0, 0.0, -2.0), DVec3::new(2.0, 0.0, 2.0)];
        let camera = Camera::fitting(frame, DVec3::Y, DVec3::NEG_Z, 0.2, 1.0);
        let image = render(&animation, 0.0, &camera, Quality { width: 200, height: 200, rays: 4 }).unwrap();
        let colours: Vec<[u8; 3]> = image.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect();
        let red = colours.iter().filter(|c| c[0] > c[1] + 60).count() as f64 / 40_000.0;
        // The frame keeps a margin of 4% and 2% on each side.
        let expected = std::f64::consts::PI / 16.0 / (1.06 * 1.06);
        assert!((red / expected - 1.0).abs() < 0.06, "{red} of the picture is red, not {expected}");
        let grey = |c: &&[u8; 3]| c[0].abs_diff(c[2]) < 25;
        let (dark, bright) =
            (colours.iter().filter(grey).map(|c| c[1]).min(), colours.iter().filter(grey).map(|c| c[1]).max());
        assert!(dark.unwrap() + 40 < bright.unwrap(), "{dark:?} {bright:?}: no shadow");
    }
}
