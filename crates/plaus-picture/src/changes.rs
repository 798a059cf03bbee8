//! What has moved between two frames, and which pixels that can change.

use crate::shade::{CREVICE, SOFT, SUN};
use glam::{DMat3, DVec3};

/// Where a body is: its place, its axes, and the box around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    pub(crate) at: DVec3,
    pub(crate) turned: DMat3,
    pub(crate) bounds: [DVec3; 2],
}

/// Room around boxes for rounding, in m.
const ROOM: f64 = 1e-6;

/// The boxes around all that moved, before and after.
#[derive(Debug)]
pub(crate) struct Changes {
    boxes: Vec<[DVec3; 2]>,
    /// Around all of them.
    all: [DVec3; 2],
    sun: DVec3,
}

fn around([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> [DVec3; 2] {
    [a.min(c), b.max(d)]
}

impl Changes {
    /// What differs between the poses of all bodies at two times.
    pub(crate) fn between(before: &[Pose], after: &[Pose]) -> Self {
        let moved = before.iter().zip(after).filter(|(a, b)| a != b);
        let boxes: Vec<_> =
            moved.map(|(a, b)| around(a.bounds, b.bounds)).map(|[low, high]| [low - ROOM, high + ROOM]).collect();
        let all = boxes.iter().copied().reduce(around).unwrap_or([DVec3::INFINITY, DVec3::NEG_INFINITY]);
        Self { boxes, all, sun: SUN.normalize() }
    }

    /// Whether they can change the light that comes back along a ray that ended on a surface after `far`, or went on to
    /// the sky: if something came into its way, or left it; if it shades that surface, or did; or is close to it.
    pub(crate) fn touch(&self, from: DVec3, along: DVec3, far: f64) -> bool {
        let (inverse, at) = (along.recip(), from + far * along);
        let reaches = |[low, high]: &[DVec3; 2]| {
            if meets([*low, *high], from, inverse, far) {
                return true;
            }
            if !far.is_finite() {
                return false;
            }
            let (middle, half) = (0.5 * (*low + *high) - at, 0.5 * (*high - *low));
            let is_close = (middle.abs() - half).max(DVec3::ZERO).length_squared() <= CREVICE * CREVICE;
            // How far away, towards the sun, it ends: rays to the edge of the sun's disc are so much off there.
            let ends = middle.dot(self.sun) + half.dot(self.sun.abs());
            let wide = DVec3::splat(SOFT * ends);
            is_close || (ends > 0.0 && meets([*low - wide, *high + wide], at, self.sun.recip(), f64::INFINITY))
        };
        !self.boxes.is_empty() && reaches(&self.all) && self.boxes.iter().any(reaches)
    }
}

/// Whether a ray meets a box within a distance.
fn meets([low, high]: [DVec3; 2], from: DVec3, inverse: DVec3, most: f64) -> bool {
    let (a, b) = ((low - from) * inverse, (high - from) * inverse);
    a.min(b).max_element().max(0.0) <= a.max(b).min_element().min(most)
}
