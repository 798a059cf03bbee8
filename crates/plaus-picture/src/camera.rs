//! Viewpoints of pictures.

use glam::DVec3;
use plaus_animation::{Animation, View};
use plaus_dist::math;

/// An eye and its direction of view.
#[derive(Debug, Clone, Copy)]
pub struct Camera {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Tangent of half the vertical field of view.
    half: f64,
}

/// Margin around what should be visible.
const MARGIN: f64 = 1.04;
/// How often per second bodies' places are sampled.
const LOOKS: f64 = 60.0;
/// Usual vertical field of view in degrees.
const FIELD: f64 = 24.0;

impl Camera {
    /// Looks at an animation from its best viewpoint, so that everything that should be visible between two times, in
    /// s, fits into a picture `aspect` times as wide as high.
    #[must_use]
    pub fn of(animation: &Animation, [from, to]: [f64; 2], aspect: f64) -> Self {
        let view = animation.view.unwrap_or(View::from(0.3, 0.5, 1.0));
        let mut frame = view.frame;
        if !view.alone || frame.is_none() {
            for track in &animation.tracks {
                let reach = DVec3::splat(track.shape.reach());
                let steps = ((to - from) * LOOKS).ceil().clamp(1.0, 1e4) as u32;
                for step in 0..=steps {
                    let at = track.position(from + (to - from) * f64::from(step) / f64::from(steps));
                    let [low, high] = frame.unwrap_or([at; 2]);
                    frame = Some([low.min(at - reach), high.max(at + reach)]);
                }
            }
        }
        let steep = view.from.with_y(0.0).length() < 1e-6 * view.from.length();
        let up = if steep { DVec3::NEG_Z } else { DVec3::Y };
        Self::fitting(frame.unwrap_or([DVec3::NEG_ONE, DVec3::ONE]), view.from, up, FIELD, aspect)
    }

    /// Looks from the direction `from`, so that a box between two corners just fits into a picture `aspect` times as
    /// wide as high. `field` is the vertical field of view in degrees; `up` points upwards in the picture.
    #[must_use]
    pub fn fitting(frame: [DVec3; 2], from: DVec3, up: DVec3, field: f64, aspect: f64) -> Self {
        let back = from.normalize();
        let right = up.cross(back).normalize();
        let up = back.cross(right);
        let (sin, cos) = math::sin_cos((0.5 * field).to_radians());
        let half = sin / cos;
        let centre = 0.5 * (frame[0] + frame[1]);
        let corner = |k: usize| DVec3::new(frame[k & 1].x, frame[k >> 1 & 1].y, frame[k >> 2 & 1].z) - centre;
        // Each corner must be as far behind the eye as its offset needs.
        let needed =
            |r: DVec3| r.dot(back) + MARGIN * (r.dot(right).abs() / (half * aspect)).max(r.dot(up).abs() / half);
        let distance = (0..8).map(|k| needed(corner(k))).fold(0.0, f64::max);
        Self { eye: centre + distance * back, forward: -back, right, up, half }
    }

    /// The ray through a point of the picture, given by its shares of width and height from the upper left.
    pub(crate) fn ray(&self, across: f64, down: f64, aspect: f64) -> (DVec3, DVec3) {
        let (x, y) = ((2.0 * across - 1.0) * self.half * aspect, (1.0 - 2.0 * down) * self.half);
        (self.eye, (self.forward + x * self.right + y * self.up).normalize())
    }
}
