//! Pictures of animations for figures.

pub use plaus_picture::{Camera, Quality};

use crate::Result;
use plaus_picture::Renderer;
use plaus_scenes::Animation;
use resvg::tiny_skia::{ColorU8, Pixmap};

/// The picture of `animation` at `time` seconds.
pub fn render(animation: &Animation, time: f64, camera: &Camera, quality: Quality) -> Result<Pixmap> {
    let image = Renderer::new(animation, *camera, quality).at(time);
    let mut map = Pixmap::new(image.width(), image.height()).ok_or("a picture without pixels")?;
    for (place, &[r, g, b]) in map.pixels_mut().iter_mut().zip(image.pixels()) {
        *place = ColorU8::from_rgba(r, g, b, 255).premultiply();
    }
    Ok(map)
}
