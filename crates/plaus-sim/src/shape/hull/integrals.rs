//! Volume and moments of a rounded convex polyhedron, exactly.
//!
//! The rounded body is the polyhedron, a slab over every face, a wedge of a cylinder along every edge and a sector of a
//! ball at every corner (Steiner's decomposition). The polyhedron is a sum of tetrahedra (Mirtich, "Fast and accurate
//! computation of polyhedral mass properties", J. Graphics Tools 1 (1996), gives the same integrals by projection).
//! Over a corner's sector, whose directions fill a spherical polygon, integrals of degree one and two follow from arcs
//! of great circles by the divergence theorem; its solid angle is the corner's defect, `2π − Σ` of the faces' angles.

use super::polyhedron::Polyhedron;
use glam::{DMat3, DVec3};
use plaus_dist::math;
use std::f64::consts::TAU;

/// `∫ dV`, `∫ x dV` and `∫ x xᵀ dV`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moments {
    pub(super) volume: f64,
    pub(super) first: DVec3,
    pub(super) second: DMat3,
}

pub(crate) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

fn both(a: DVec3, b: DVec3) -> DMat3 {
    outer(a, b) + outer(b, a)
}

/// The mean of `x xᵀ` over a simplex with `n` corners is this over `n (n + 1)`.
fn spread(corners: &[DVec3]) -> DMat3 {
    let sum = corners.iter().fold(DVec3::ZERO, |s, &c| s + c);
    corners.iter().fold(outer(sum, sum), |s, &c| s + outer(c, c))
}

impl Moments {
    fn add(&mut self, volume: f64, first: DVec3, second: DMat3) {
        self.volume += volume;
        self.first += first;
        self.second += second;
    }

    /// For a polyhedron whose origin is inside or near, grown by `r`.
    pub(super) fn of(body: &Polyhedron, r: f64) -> Self {
        let mut sum = Self { volume: 0.0, first: DVec3::ZERO, second: DMat3::ZERO };
        let mut angles = vec![0.0; body.corners.len()];
        for face in &body.faces {
            let n = face.normal;
            let corner = |k: usize| body.corner(face.corners[k % face.corners.len()]);
            let a = corner(0);
            for k in 1..face.corners.len() - 1 {
                let (b, c) = (corner(k), corner(k + 1));
                let determinant = a.dot(b.cross(c));
                let (middle, spread) = (a + b + c, spread(&[a, b, c]));
                // The tetrahedron from the origin, then the slab over the triangle.
                sum.add(determinant / 6.0, middle * (determinant / 24.0), spread * (determinant / 120.0));
                let area = 0.5 * (b - a).cross(c - a).dot(n);
                let first = middle * (area / 3.0);
                sum.add(
                    area * r,
                    first * r + n * (0.5 * r * r * area),
                    spread * (area * r / 12.0)
                        + both(first, n) * (0.5 * r * r)
                        + outer(n, n) * (area * r * r * r / 3.0),
                );
            }
            for (k, &at) in face.corners.iter().enumerate() {
                let (p, q) = (corner(k + 1) - corner(k), corner(k + face.corners.len() - 1) - corner(k));
                angles[usize::from(at)] += math::atan2(p.cross(q).length(), p.dot(q));
            }
        }
        if r > 0.0 {
            sum.round(body, r, &angles);
        }
        sum
    }

    /// Wedges and sectors.
    fn round(&mut self, body: &Polyhedron, r: f64, angles: &[f64]) {
        let (r2, r3) = (r * r, r * r * r);
        // For each corner, over the directions u in its sector: −2 ∫ u, and −6 times the traceless part of ∫ u uᵀ.
        let mut directions = vec![(DVec3::ZERO, DMat3::ZERO); body.corners.len()];
        for e in &body.edges {
            let [p, q] = e.ends.map(|k| body.corner(k));
            let [n, m] = e.faces.map(|k| body.face(k).normal);
            let angle = math::atan2(n.cross(m).length(), n.dot(m));
            // Over the arc between the normals: ∫ u, and ∫ u uᵀ about its middle.
            let (half, middle) = (0.5 * angle, (n + m).normalize());
            let arc = middle * (2.0 * math::sin(half));
            let across = e.along.cross(middle);
            let turned = (DMat3::IDENTITY - outer(e.along, e.along)) * half
                + (outer(middle, middle) - outer(across, across)) * (0.5 * math::sin(angle));
            let line = (p + q) * (0.5 * e.length);
            let along = spread(&[p, q]) * (e.length / 6.0);
            self.add(
                0.5 * r2 * angle * e.length,
                line * (0.5 * r2 * angle) + arc * (r3 / 3.0 * e.length),
                along * (0.5 * r2 * angle) + both(line, arc) * (r3 / 3.0) + turned * (0.25 * r2 * r2 * e.length),
            );
            // The sectors at both ends lie on the other side of the arc's plane.
            for (end, out) in [(e.ends[0], e.along), (e.ends[1], -e.along)] {
                let (first, second) = &mut directions[usize::from(end)];
                *first += out * angle;
                *second += both(out, arc);
            }
        }
        for ((&v, angles), (first, second)) in body.corners.iter().zip(angles).zip(directions) {
            let solid = TAU - angles;
            let u = first * -0.5;
            let squares = DMat3::IDENTITY * (solid / 3.0) - second * (1.0 / 6.0);
            self.add(
                solid * r3 / 3.0,
                v * (solid * r3 / 3.0) + u * (0.25 * r2 * r2),
                outer(v, v) * (solid * r3 / 3.0) + both(v, u) * (0.25 * r2 * r2) + squares * (0.2 * r2 * r3),
            );
        }
    }

    /// The inertia tensor of unit density about the centre of gravity, and that centre.
    pub(super) fn central(&self) -> (DVec3, DMat3) {
        let centre = self.first / self.volume;
        let about = self.second - outer(centre, centre) * self.volume;
        let trace = about.x_axis.x + about.y_axis.y + about.z_axis.z;
        (centre, DMat3::from_diagonal(DVec3::splat(trace)) - about)
    }
}
