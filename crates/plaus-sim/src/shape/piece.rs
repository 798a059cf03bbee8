//! Convex pieces: the algorithm that serves all pairs of shapes sees every body and all scenery as made of them.

use super::ContactSphere;
use super::frustum::Discs;
use super::hull::Polyhedron;
use glam::{DMat3, DVec3};
use plaus_dist::math;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Depth behind a triangle, over its reach, down to which points count as in its mesh. Default 0.1.
pub(crate) const THICK: f64 = 0.1;

/// One less the cosine of the angle up to which two normals are the same. Default 1e-12, above rounding.
const SAME_NORMAL: f64 = 1e-12;

/// Points of a rim that are tested over a table with bumps. Default 32.
pub(super) const RIM: usize = 32;

/// The core of a piece about its own origin. The piece is everything within its rounding of the core.
#[derive(Debug, Clone)]
pub(crate) enum Core {
    Polyhedron(Arc<Polyhedron>),
    Discs(Discs),
}

/// A convex piece fixed in a body.
#[derive(Debug, Clone)]
pub(crate) struct Piece {
    pub(crate) core: Core,
    pub(crate) rounding: f64,
    /// Its origin in the body's axes, inside its core or on it, and its own axes as columns.
    pub(crate) at: DVec3,
    pub(crate) turn: DMat3,
    /// Largest distance of its points, including the rounding, from its origin.
    pub(crate) bounding_radius: f64,
}

/// A piece in its place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placed<'p> {
    pub(crate) core: &'p Core,
    pub(crate) rounding: f64,
    pub(crate) centre: DVec3,
    pub(crate) axes: DMat3,
    pub(crate) bounding_radius: f64,
}

impl Core {
    /// Largest distance of a point from its own origin.
    pub(super) fn reach(&self) -> f64 {
        match self {
            Self::Polyhedron(p) => p.bounding_radius,
            Self::Discs(d) => d.reach(),
        }
    }

    /// How far it reaches in a direction.
    #[inline]
    pub(crate) fn support(&self, d: DVec3) -> f64 {
        match self {
            Self::Polyhedron(p) => p.support(d),
            Self::Discs(discs) => discs.support(d),
        }
    }

    /// The point of it that is farthest in a direction.
    pub(crate) fn farthest(&self, d: DVec3) -> DVec3 {
        match self {
            Self::Polyhedron(p) => p.corner(p.farthest(d).0),
            Self::Discs(discs) => discs.farthest(d),
        }
    }

    /// Unit normal out of it at its point nearest to `p`, and the distance of `p` from that point; negative inside.
    #[inline]
    pub(crate) fn project(&self, p: DVec3) -> (DVec3, f64) {
        match self {
            Self::Polyhedron(core) => core.project(p),
            Self::Discs(discs) => discs.project(p),
        }
    }
}

impl Polyhedron {
    /// As [`Core::project`].
    pub(crate) fn project(&self, p: DVec3) -> (DVec3, f64) {
        if let Some(half) = self.half() {
            let out = p - p.clamp(-half, half);
            let distance = out.length();
            if distance > 0.0 {
                return (out / distance, distance);
            }
            // Inside, the way out is through the nearest face.
            let beyond = p.abs() - half;
            let axis =
                if beyond.x >= beyond.y && beyond.x >= beyond.z { 0 } else { 1 + usize::from(beyond.z > beyond.y) };
            return (DVec3::AXES[axis] * 1.0_f64.copysign(p[axis]), beyond[axis]);
        }
        if let [front, _] = &self.faces[..] {
            // For a triangle of a mesh, its plane counts over the triangle and a little below it, from outside.
            let height = front.normal.dot(p) - front.offset;
            if height > -THICK * self.bounding_radius && self.is_over(0, p, 0.0) {
                return (front.normal, height);
            }
        }
        match self.farthest_face(p) {
            Some((face, beyond)) if beyond <= 0.0 && self.has_inside() => (self.face(face).normal, beyond),
            _ => {
                let on = self.nearest(p);
                let (normal, distance, _) = crate::shape::hull_pair::project(self, p, on);
                (normal, distance)
            }
        }
    }
}

impl Piece {
    pub(crate) fn new(core: Core, rounding: f64, at: DVec3, turn: DMat3) -> Self {
        let bounding_radius = core.reach() + rounding;
        Self { core, rounding, at, turn, bounding_radius }
    }

    /// A triangle as a polyhedron of two faces.
    pub(crate) fn triangle(corners: [DVec3; 3]) -> Self {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let core = Polyhedron::new(corners.map(|c| c - middle).to_vec(), &[vec![0, 1, 2], vec![0, 2, 1]]);
        Self::new(Core::Polyhedron(Arc::new(core)), 0.0, middle, DMat3::IDENTITY)
    }

    /// A ball.
    pub(crate) fn ball(radius: f64, at: DVec3) -> Self {
        Self::new(Core::Polyhedron(Arc::new(Polyhedron::point())), radius, at, DMat3::IDENTITY)
    }

    /// Whether a unit normal in its own axes is that of an edge or a corner of a polyhedron.
    pub(crate) fn is_at_edge(&self, normal: DVec3) -> bool {
        match &self.core {
            Core::Polyhedron(p) => p.faces.iter().all(|f| f.normal.dot(normal) < 1.0 - SAME_NORMAL),
            Core::Discs(_) => false,
        }
    }

    /// Largest distance of its points from the body's centre of gravity.
    pub(crate) fn reach_from_body(&self) -> f64 {
        self.rounding
            + match &self.core {
                Core::Polyhedron(p) => {
                    p.corners.iter().map(|&c| (self.at + self.turn * c).length()).fold(0.0, f64::max)
                }
                Core::Discs(discs) => {
                    let seen = self.turn.transpose() * self.at;
                    let rim = |k: usize| {
                        let (out, up) = (seen.truncate().length() + discs.radii[k], seen.z + discs.heights[k]);
                        (out * out + up * up).sqrt()
                    };
                    rim(0).max(rim(1))
                }
            }
    }

    /// Balls of its skin: corners, and points of its rims.
    pub(crate) fn contact_spheres(&self) -> Vec<ContactSphere> {
        let ball = |p: DVec3| ContactSphere { centre: self.at + self.turn * p, radius: self.rounding };
        match &self.core {
            Core::Polyhedron(core) => core.corners.iter().map(|&c| ball(c)).collect(),
            Core::Discs(discs) => {
                let turned = |k: usize| math::sin_cos(TAU * (k as f64 / RIM as f64));
                let rim = |ring: usize| {
                    (0..RIM).filter_map(move |k| {
                        let (s, c) = turned(k);
                        discs.rim(ring, 0, DVec3::new(c, s, 0.0)).filter(|_| discs.radii[ring] > 0.0 || k == 0)
                    })
                };
                rim(0).chain(rim(1)).map(ball).collect()
            }
        }
    }

    /// More balls between those, on edges, faces, caps and sides, so that no point of the skin is farther than about
    /// `spacing` from a ball; at most 16 along a line.
    pub(crate) fn contact_spheres_between(&self, spacing: f64) -> Vec<ContactSphere> {
        let ball = |p: DVec3| ContactSphere { centre: self.at + self.turn * p, radius: self.rounding };
        let parts = |length: f64| (length / spacing).ceil().clamp(1.0, 16.0) as usize;
        match &self.core {
            Core::Polyhedron(core) => core.between(spacing).into_iter().map(ball).collect(),
            Core::Discs(discs) => {
                let ([low, high], [r0, r1]) = (discs.heights, discs.radii);
                let mut points = Vec::new();
                // A segment is one line, seen from any side.
                for k in 0..if r0 == 0.0 && r1 == 0.0 { 1 } else { RIM } {
                    let (s, c) = math::sin_cos(TAU * (k as f64 / RIM as f64));
                    let at = |r: f64, z: f64| DVec3::new(r * c, r * s, z);
                    for (r, z) in [(r0, low), (r1, high)] {
                        let n = if r > 0.0 { parts(r) } else { 1 };
                        points.extend((1..n).map(|i| at(r * (i as f64 / n as f64), z)));
                    }
                    let n = parts(high - low);
                    let along = |i: usize| i as f64 / n as f64;
                    points.extend((1..n).map(|i| at(r0 + (r1 - r0) * along(i), low + (high - low) * along(i))));
                }
                points.into_iter().map(ball).collect()
            }
        }
    }

    /// Where it is about a point, for a piece of a fixed part.
    #[inline]
    pub(crate) fn about(&self, x: DVec3) -> Placed<'_> {
        let Self { core, rounding, at, turn, bounding_radius } = self;
        Placed { core, rounding: *rounding, centre: *at - x, axes: *turn, bounding_radius: *bounding_radius }
    }

    /// Where it is in a body with these axes and this centre.
    #[inline]
    pub(crate) fn placed(&self, axes: &DMat3, centre: DVec3) -> Placed<'_> {
        Placed {
            core: &self.core,
            rounding: self.rounding,
            centre: centre + *axes * self.at,
            axes: *axes * self.turn,
            bounding_radius: self.bounding_radius,
        }
    }
}

impl Placed<'_> {
    /// How far its core reaches in a direction, from the common origin.
    #[inline]
    pub(crate) fn support(&self, d: DVec3) -> f64 {
        self.centre.dot(d) + self.core.support(self.axes.transpose() * d)
    }

    /// The point of its core that is farthest in a direction.
    pub(crate) fn farthest(&self, d: DVec3) -> DVec3 {
        self.centre + self.axes * self.core.farthest(self.axes.transpose() * d)
    }

    /// Unit normal out of its core at the point nearest to `p`, and the distance of `p` from that point.
    #[inline]
    pub(crate) fn project(&self, p: DVec3) -> (DVec3, f64) {
        let (normal, distance) = self.core.project(self.axes.transpose() * (p - self.centre));
        (self.axes * normal, distance)
    }
}
