//! Eyes that look at a world in perspective.

use glam::DVec3;
use plaus_dist::math;

/// An eye, and how it looks. `forward`, `right` and `up` have length 1 and are at right angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eye {
    /// Where it is, in m.
    pub at: DVec3,
    /// The direction of view.
    pub forward: DVec3,
    /// To the right in its picture.
    pub right: DVec3,
    /// Upwards in its picture.
    pub up: DVec3,
    /// Tangent of half the vertical field of view.
    pub half: f64,
}

/// Margin around what should be visible.
const MARGIN: f64 = 1.04;

impl Eye {
    /// The usual vertical field of view in degrees.
    pub const FIELD: f64 = 24.0;

    /// What points upwards in the picture of an eye that looks back along `back`: y, or −z for a view along y.
    #[must_use]
    pub fn upwards(back: DVec3) -> DVec3 {
        let steep = back.with_y(0.0).length() < 1e-6 * back.length();
        if steep { DVec3::NEG_Z } else { DVec3::Y }
    }

    /// Looks from one place at another one, with a vertical field of view in degrees.
    #[must_use]
    pub fn looking(at: DVec3, to: DVec3, field: f64) -> Self {
        let back = at - to;
        Self { at, ..Self::along(back, Self::upwards(back), field) }
    }

    /// Looks from the origin, back along `back`.
    fn along(back: DVec3, up: DVec3, field: f64) -> Self {
        let back = back.normalize();
        let right = up.cross(back).normalize();
        let (sin, cos) = math::sin_cos((0.5 * field).to_radians());
        Self { at: DVec3::ZERO, forward: -back, right, up: back.cross(right), half: sin / cos }
    }

    /// Looks from the direction `from`, so that a box between two corners just fits into a picture `aspect` times as
    /// wide as high. `field` is the vertical field of view in degrees; `up` points upwards in the picture.
    #[must_use]
    pub fn fitting(frame: [DVec3; 2], from: DVec3, up: DVec3, field: f64, aspect: f64) -> Self {
        let eye = Self::along(from, up, field);
        let Self { right, up, half, .. } = eye;
        let back = -eye.forward;
        let corners = (0..8).map(|k| DVec3::new(frame[k & 1].x, frame[k >> 1 & 1].y, frame[k >> 2 & 1].z));
        // The eye is behind the planes through the outermost corners that limit the picture on two opposite sides, and
        // midway between them.
        let sides = |across: DVec3, tangent: f64| {
            let most = |sign: f64| {
                let needed = |r: DVec3| sign * r.dot(across) + tangent * r.dot(back);
                corners.clone().map(needed).fold(f64::NEG_INFINITY, f64::max)
            };
            let (one, other) = (most(1.0), most(-1.0));
            (0.5 * (one - other), 0.5 * (one + other) / tangent)
        };
        let (x, behind) = sides(right, half * aspect / MARGIN);
        let (y, also) = sides(up, half / MARGIN);
        Self { at: x * right + y * up + behind.max(also) * back, ..eye }
    }

    /// Where a point is in a picture `aspect` times as wide as high, by its shares of width and height from the upper
    /// left; `None` if it is not in front of the eye.
    #[must_use]
    pub fn place(&self, point: DVec3, aspect: f64) -> Option<[f64; 2]> {
        let r = point - self.at;
        let far = r.dot(self.forward);
        let (x, y) = (r.dot(self.right) / (self.half * aspect), r.dot(self.up) / self.half);
        (far > 0.0).then(|| [0.5 + 0.5 * x / far, 0.5 - 0.5 * y / far])
    }

    /// The direction, of length 1, of a point of the picture, given by its shares of width and height from the upper
    /// left.
    #[must_use]
    pub fn ray(&self, across: f64, down: f64, aspect: f64) -> DVec3 {
        let (x, y) = ((2.0 * across - 1.0) * self.half * aspect, (1.0 - 2.0 * down) * self.half);
        (self.forward + x * self.right + y * self.up).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of any box, seen from any direction, are within the picture, and touch its margins on both sides of
    /// its width or of its height; on the other sides, the space that is left is the same.
    #[test]
    fn a_box_fills_the_picture_and_is_in_its_middle() {
        let least = 0.5 - 0.5 / MARGIN;
        for (k, aspect) in [(0, 1.0), (1, 16.0 / 9.0), (2, 0.5), (3, 16.0 / 9.0)] {
            let from = [DVec3::new(0.3, 0.5, 1.0), DVec3::new(-1.0, 0.2, 0.4), DVec3::new(0.0, 3.0, 1.0), DVec3::Z][k];
            let frame = [DVec3::new(-2.0, 0.0, -1.0), DVec3::new(9.0, 0.4, 3.0)];
            let eye = Eye::fitting(frame, from, DVec3::Y, Eye::FIELD, aspect);
            let corner = |k: usize| DVec3::new(frame[k & 1].x, frame[k >> 1 & 1].y, frame[k >> 2 & 1].z);
            let places: Vec<[f64; 2]> = (0..8).map(|k| eye.place(corner(k), aspect).unwrap()).collect();
            let room = [0, 1].map(|axis| {
                let low = places.iter().map(|place| place[axis]).fold(f64::INFINITY, f64::min);
                let high = places.iter().map(|place| place[axis]).fold(f64::NEG_INFINITY, f64::max);
                assert!(low > least - 1e-9 && high < 1.0 - least + 1e-9, "{places:?}");
                (low - least).abs() + (1.0 - least - high).abs()
            });
            assert!(room[0].min(room[1]) < 1e-9, "{k}: {room:?} is left");
        }
    }

    /// A ray goes through the points whose place in the picture it is given by; what is looked at is in the middle.
    #[test]
    fn rays_go_through_the_places_of_points() {
        for to in [DVec3::new(0.3, 0.1, -0.4), DVec3::new(0.0, -2.0, 0.0)] {
            let eye = Eye::looking(DVec3::new(0.0, 1.0, 0.0), to, 40.0);
            let [across, down] = eye.place(to, 1.5).unwrap();
            assert!((across - 0.5).abs() < 1e-12 && (down - 0.5).abs() < 1e-12);
            let point = to + DVec3::new(0.1, 0.02, 0.05);
            let [across, down] = eye.place(point, 1.5).unwrap();
            let off = eye.ray(across, down, 1.5) - (point - eye.at).normalize();
            assert!(off.length() < 1e-12, "{off}");
            assert_eq!(eye.place(2.0 * eye.at - to, 1.5), None, "behind");
        }
    }
}
