//! How near bodies of revolution are to each other and to balls: by the balls and rings of their skins.

use super::contact_point::PairContactPoint;
use super::spheres::{balls, nearer};
use crate::rigid::BodyDef;
use crate::rigid::body_state::Pose;
use crate::rigid::tolerances::{FOLLOWED_MINIMA, SPHERE_STRIDE};
use crate::shape::{ContactSphere, Ring};
use glam::DVec3;

/// The point of a ring's circle nearest to `d` (both about the ring's body), in body axes.
fn nearest_on_ring(ring: &Ring, d: DVec3) -> DVec3 {
    let flat = DVec3::new(d.x, d.y, 0.0);
    let along = if flat == DVec3::ZERO { DVec3::X } else { flat.normalize() };
    along * ring.circle + DVec3::new(0.0, 0.0, ring.height)
}

/// A body of revolution and a ball; `offset` from the ball's centre to the body's.
pub(super) fn revolved_and_ball(s: &BodyDef, a: &Pose, offset: DVec3, radius: f64) -> PairContactPoint {
    let d = a.r.transpose() * -offset;
    let mut best: Option<(f64, DVec3, f64)> = None;
    let mut consider = |centre: DVec3, r: f64| {
        let gap = (d - centre).length() - r;
        if best.is_none_or(|b| gap < b.0) {
            best = Some((gap, centre, r));
        }
    };
    for f in s.row() {
        consider(f.centre, f.radius);
    }
    for ring in &s.rings {
        consider(nearest_on_ring(ring, d), ring.radius);
    }
    let (_, centre, r) = best.unwrap_or((0.0, DVec3::ZERO, s.bounding_radius));
    balls(offset, [a.r * centre, DVec3::ZERO], [r, radius])
}

/// Two rows of balls about two lines.
struct SphereRows<'r> {
    row: &'r [ContactSphere],
    col: &'r [ContactSphere],
    /// Squared distance of the centres of gravity; products of the line between them with both axes, and of the axes
    /// with each other.
    apart: f64,
    along: [f64; 2],
    cos: f64,
}

impl SphereRows<'_> {
    /// Squared distance of two balls' centres, for choosing among them.
    #[inline]
    fn distance_squared(&self, p: &ContactSphere, q: &ContactSphere) -> f64 {
        let (y, z) = (p.centre.z, q.centre.z);
        self.apart + (y + 2.0 * self.along[0]) * y + (z - 2.0 * (self.along[1] + y * self.cos)) * z
    }

    #[inline]
    fn gap(&self, k: usize, l: usize) -> f64 {
        let (p, q) = (&self.row[k], &self.col[l]);
        self.distance_squared(p, q).max(0.0).sqrt() - p.radius - q.radius
    }

    /// Of the balls of the other row that the first search visits, the one nearest to ball `k` of this row.
    fn nearest_to(&self, k: usize) -> (f64, usize) {
        let p = &self.row[k];
        let mut best = (f64::INFINITY, 0);
        for (l, q) in self.col.iter().enumerate().step_by(SPHERE_STRIDE) {
            // A ball nearer than the best has its centre nearer than this.
            let bounding_radius = best.0 + p.radius + q.radius;
            let square = self.distance_squared(p, q).max(0.0);
            if bounding_radius > 0.0 && square < bounding_radius * bounding_radius {
                best = (square.sqrt() - p.radius - q.radius, l);
            }
        }
        best
    }

    /// Moves to neighbouring balls as long as they are nearer to each other.
    fn follow(&self, (mut f, mut k, mut l): (f64, usize, usize)) -> (usize, usize) {
        for _ in 0..self.row.len() + self.col.len() {
            let (before, now) = ((k, l), f);
            for (i, j) in [
                (k.wrapping_sub(1), l),
                (k + 1, l),
                (k, l.wrapping_sub(1)),
                (k, l + 1),
                (k.wrapping_sub(1), l + 1),
                (k + 1, l.wrapping_sub(1)),
                (k + 1, l + 1),
                (k.wrapping_sub(1), l.wrapping_sub(1)),
            ] {
                if i < self.row.len() && j < self.col.len() {
                    let other = self.gap(i, j);
                    if other < f {
                        (k, l, f) = (i, j, other);
                    }
                }
            }
            if (k, l) == before || f >= now {
                break;
            }
        }
        (k, l)
    }
}

/// Two bodies of revolution; `offset` from the second's centre of gravity to the first's.
pub(super) fn two_revolved([s, t]: [&BodyDef; 2], [a, b]: [&Pose; 2], offset: DVec3) -> PairContactPoint {
    let (e, g) = (a.r.z_axis, b.r.z_axis);
    let rows = SphereRows {
        row: s.row(),
        col: t.row(),
        apart: offset.length_squared(),
        along: [offset.dot(e), offset.dot(g)],
        cos: e.dot(g),
    };
    let mut starts = [(f64::INFINITY, 0, 0); FOLLOWED_MINIMA];
    for k in (0..rows.row.len()).step_by(SPHERE_STRIDE) {
        let (f, l) = rows.nearest_to(k);
        // The best ball for this one, kept if it is among the best few.
        let worst = starts.iter_mut().max_by(|x, y| x.0.total_cmp(&y.0));
        if let Some(worst) = worst
            && f < worst.0
        {
            *worst = (f, k, l);
        }
    }
    starts.sort_by(|x, y| x.0.total_cmp(&y.0));
    let mut best: Option<PairContactPoint> = None;
    for &start in &starts {
        // Balls that the stride left out stand out by a few millimetres at most, so starts that are farther cannot win.
        if !start.0.is_finite() || start.0 > starts[0].0 + 0.2 * (s.size + t.size) {
            continue;
        }
        let (k, l) = rows.follow(start);
        let (p, q) = (&rows.row[k], &rows.col[l]);
        nearer(&mut best, balls(offset, [e * p.centre.z, g * q.centre.z], [p.radius, q.radius]));
    }
    // Rings of each body against the balls of the other.
    let mut best = best.unwrap_or(balls(offset, [DVec3::ZERO; 2], [s.bounding_radius, t.bounding_radius]));
    for (first, spec, pose, other, axis, to) in [(true, s, a, t, g, -offset), (false, t, b, s, e, offset)] {
        // `to` goes from this body to the other; both in this body's axes.
        let turned = pose.r.transpose();
        let (from, along) = (turned * to, turned * axis);
        let [middle, around] = spec.base;
        for f in other.row().iter().step_by(2) {
            let d = from + along * f.centre.z;
            // First the ball around all rings, then the ball around each ring.
            let far = best.gap + f.radius + around;
            let flat = d.x * d.x + d.y * d.y;
            if far <= 0.0 || flat + (d.z - middle) * (d.z - middle) > far * far {
                continue;
            }
            for ring in &spec.rings {
                let near = best.gap + f.radius + ring.radius + ring.circle;
                let up = d.z - ring.height;
                if near <= 0.0 || flat + up * up > near * near {
                    continue;
                }
                let on = nearest_on_ring(ring, d);
                if (d - on).length() - ring.radius - f.radius < best.gap {
                    let centre = axis * f.centre.z;
                    let arms = if first { [pose.r * on, centre] } else { [centre, pose.r * on] };
                    let radii = if first { [ring.radius, f.radius] } else { [f.radius, ring.radius] };
                    best = balls(offset, arms, radii);
                }
            }
        }
    }
    best
}
