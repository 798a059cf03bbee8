//! First contact with a half space for a few balls that turn about one axis: for cuboids in the air if all their
//! moments of inertia are equal, and for any body in a step.
//!
//! The height of each ball over the plane is the height of the centre of gravity, a parabola, plus a sine. The sines
//! are found once. Each look takes one sine and cosine for all of them, and each sine's own amplitude bounds its
//! acceleration.

use super::static_search::StaticTimeOfImpact;
use crate::rigid::motion::free_rotation::Sines;
use crate::rigid::tolerances::{MAX_CORNERS, MAX_STATIC_ADVANCES};
use crate::roots::earliest;
use glam::DVec3;
use plaus_dist::math;

/// Height of a ball over the plane, minus that of the centre of gravity and minus the ball's radius:
/// `fixed + cos · cos(ωt) + sin · sin(ωt)`.
#[derive(Debug, Clone, Copy, Default)]
struct Height {
    fixed: f64,
    cos: f64,
    sin: f64,
    /// Largest acceleration towards the plane, gravity's included.
    m: f64,
    /// Number of the ball.
    ball: usize,
}

impl StaticTimeOfImpact<'_> {
    /// As [`half_space`](Self::half_space), within these times; `None` if this method does not apply.
    pub(crate) fn corners(
        &self,
        part: u16,
        (n, offset): (DVec3, f64),
        [mut t, until]: [f64; 2],
    ) -> Option<Option<(f64, usize)>> {
        let (spec, path) = (self.spec, &self.body.path);
        let balls = &spec.contact_spheres[..spec.hull];
        if balls.len() > MAX_CORNERS || !spec.rings.is_empty() {
            return None;
        }
        let free_rotation = self.body.free_rotation(spec);
        let Sines { rate: turning, fixed, cos, sin } = free_rotation.sines(n)?;
        let gravity = -n.dot(path.a);
        let mut heights = [Height::default(); MAX_CORNERS];
        for (k, (height, ball)) in heights.iter_mut().zip(balls).enumerate() {
            let (c, s) = (cos.dot(ball.centre), sin.dot(ball.centre));
            let m = (gravity + turning * turning * (c * c + s * s).sqrt()).max(0.0);
            *height = Height { fixed: fixed.dot(ball.centre) - ball.radius, cos: c, sin: s, m, ball: k };
        }
        let heights = &mut heights[..balls.len()];
        let (half, above) = (0.5 * spec.gap, n.dot(path.x) - offset - 0.5 * spec.gap);
        let along = n.dot(path.v);
        for _ in 0..MAX_STATIC_ADVANCES {
            let (s, c) = math::sin_cos(turning * t);
            let middle = above + (along - 0.5 * gravity * t) * t;
            let fall = along - gravity * t;
            let mut step = until - t;
            let (mut first, mut is_now) = (None, false);
            for (place, h) in heights.iter().enumerate() {
                let f = middle + h.fixed + h.cos * c + h.sin * s;
                let rate = fall + (h.sin * c - h.cos * s) * turning;
                if (f > 0.0 && f + (rate - 0.5 * h.m * step) * step > 0.0) || self.lasts(part, h.ball) {
                    continue;
                }
                if f <= half && rate < 0.0 {
                    // The deepest counts.
                    if !is_now || first.is_none_or(|(_, deepest)| f < deepest) {
                        first = Some((place, f));
                    }
                    (step, is_now) = (0.0, true);
                } else {
                    let time = earliest(f, rate, h.m);
                    if time < step {
                        (step, first) = (time, Some((place, f)));
                    }
                }
            }
            let Some((nearest, _)) = first else { return Some(None) };
            if step == 0.0 {
                return Some(Some((t, heights[nearest].ball)));
            }
            // It is examined first at the next look: most others outlast its step.
            heights.swap(0, nearest);
            t += step;
            if t >= until || t.is_nan() {
                return Some(None);
            }
        }
        Some(Some((t, 0)))
    }
}
