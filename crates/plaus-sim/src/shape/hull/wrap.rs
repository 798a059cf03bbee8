//! The faces of a convex hull, by gift wrapping: from each edge of a face already found, the plane is turned about the
//! edge until it meets the first other point.
//!
//! Source: Chand & Kapur, "An algorithm for convex polytopes", J. ACM 17 (1970). Deviation: all points within [`FLAT`]
//! of a face's plane belong to it, so that faces that are flat up to rounding stay whole; the result is checked to be a
//! closed surface.

use crate::error::WorldError;
use glam::{DVec2, DVec3};
use std::collections::BTreeSet;

/// Distance from a plane or from another point up to which points count as on it, over the extent of all points.
/// Default 1e-9: far above rounding, far below what can be seen.
pub(super) const FLAT: f64 = 1e-9;

/// The points, with values that belong to all of them.
struct Cloud<'p> {
    points: &'p [DVec3],
    /// One point for each distinct place.
    distinct: Vec<usize>,
    near: f64,
}

/// The faces of the hull of some points: loops of their indices, anticlockwise as seen from outside.
pub(super) fn faces(points: &[DVec3]) -> Result<Vec<Vec<usize>>, WorldError> {
    let middle = points.iter().fold(DVec3::ZERO, |sum, &p| sum + p) / points.len() as f64;
    let extent = points.iter().map(|&p| (p - middle).length()).fold(0.0, f64::max);
    let near = FLAT * extent;
    let mut distinct: Vec<usize> = Vec::new();
    for (k, &p) in points.iter().enumerate() {
        if distinct.iter().all(|&j| (points[j] - p).length() > near) {
            distinct.push(k);
        }
    }
    let cloud = Cloud { points, distinct, near };
    if cloud.distinct.len() < 4 {
        return Err(WorldError::FewPoints { points: cloud.distinct.len() });
    }
    let first = cloud.seed(extent).ok_or(WorldError::FlatHull { points: points.len(), thickness: near })?;
    let mut edges = BTreeSet::new();
    let mut faces = vec![first];
    let mut next = 0;
    while next < faces.len() {
        let face = faces[next].clone();
        for (a, b) in around(&face) {
            if !edges.insert((a, b)) {
                return Err(WorldError::UnclearHull { point: a });
            }
        }
        next += 1;
        let normal = newell(points, &face);
        for (a, b) in around(&face) {
            let is_known = faces.iter().any(|f| around(f).any(|e| e == (b, a)));
            if is_known {
                continue;
            }
            let beyond = cloud.wrap([a, b], normal);
            // A closed surface of n corners has at most 2n − 4 faces.
            if !around(&beyond).any(|e| e == (b, a)) || faces.len() > 2 * cloud.distinct.len() {
                return Err(WorldError::UnclearHull { point: a });
            }
            faces.push(beyond);
        }
    }
    let corners: BTreeSet<usize> = faces.iter().flatten().copied().collect();
    if 2 * (corners.len() + faces.len()) != edges.len() + 4 {
        return Err(WorldError::UnclearHull { point: faces[0][0] });
    }
    for face in &faces {
        let (normal, on) = (newell(points, face), points[face[0]]);
        // Twice, because the plane was found from only a few of its points.
        if let Some(&point) = cloud.distinct.iter().find(|&&k| (points[k] - on).dot(normal) > 2.0 * near) {
            return Err(WorldError::UnclearHull { point });
        }
    }
    Ok(faces)
}

/// The sides of a loop, as pairs of indices.
pub(super) fn around(face: &[usize]) -> impl Iterator<Item = (usize, usize)> + '_ {
    face.iter().zip(face.iter().cycle().skip(1)).map(|(&a, &b)| (a, b))
}

/// The unit normal of a loop: the mean over its triangles, weighted with their areas (Newell).
pub(super) fn newell(points: &[DVec3], face: &[usize]) -> DVec3 {
    let first = points[face[0]];
    around(face).fold(DVec3::ZERO, |sum, (a, b)| sum + (points[a] - first).cross(points[b] - first)).normalize_or_zero()
}

impl Cloud<'_> {
    /// A face at the first of the points along x: among the planes through it that have all points on one side, the
    /// plane through the largest triangle.
    fn seed(&self, extent: f64) -> Option<Vec<usize>> {
        let at = |k: usize| self.points[k];
        let order = |a: DVec3, b: DVec3| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z));
        let corner = *self.distinct.iter().min_by(|&&a, &&b| order(at(a), at(b)))?;
        let mut best: Option<(f64, DVec3)> = None;
        for (n, &i) in self.distinct.iter().enumerate() {
            for &j in &self.distinct[n + 1..] {
                let cross = (at(i) - at(corner)).cross(at(j) - at(corner));
                let area = cross.length();
                // Needles have no direction of their own.
                if area <= FLAT * extent * extent || best.is_some_and(|(most, _)| area <= most) {
                    continue;
                }
                let normal = cross / area;
                let (mut above, mut below) = (false, false);
                for &k in &self.distinct {
                    let height = (at(k) - at(corner)).dot(normal);
                    above |= height > self.near;
                    below |= height < -self.near;
                    if above && below {
                        break;
                    }
                }
                if above != below {
                    best = Some((area, if above { -normal } else { normal }));
                }
            }
        }
        let (_, normal) = best?;
        Some(self.face(normal, at(corner)))
    }

    /// The face beyond the edge from `a` to `b` of a face with this normal.
    fn wrap(&self, [a, b]: [usize; 2], normal: DVec3) -> Vec<usize> {
        let (from, along) = (self.points[a], (self.points[b] - self.points[a]).normalize());
        let out = along.cross(normal);
        // Across the edge: outwards in the face's plane, and down from that plane.
        let across = |k: usize| {
            let w = self.points[k] - from;
            DVec2::new(w.dot(out), (-w.dot(normal)).max(0.0))
        };
        let normal_through = |p: DVec2| ((out * p.x - normal * p.y) / p.length()).cross(along);
        let others = || self.distinct.iter().copied().filter(|&k| k != a && k != b && across(k).length() > self.near);
        let Some(mut first) = others().next() else { return Vec::new() };
        for k in others() {
            // The least angle from `out` downwards.
            if across(k).perp_dot(across(first)) > 0.0 {
                first = k;
            }
        }
        // Among the points in that plane, the farthest from the edge gives the most exact plane.
        let plane = normal_through(across(first));
        for k in others() {
            let is_in = (self.points[k] - from).dot(plane).abs() <= self.near;
            if is_in && across(k).length_squared() > across(first).length_squared() {
                first = k;
            }
        }
        self.face(normal_through(across(first)), from)
    }

    /// The hull of the points in a plane, anticlockwise about its normal; points on its sides are left out (Andrew's
    /// monotone chain).
    fn face(&self, normal: DVec3, on: DVec3) -> Vec<usize> {
        let (u, v) = normal.any_orthonormal_pair();
        let (u, v) = if u.cross(v).dot(normal) > 0.0 { (u, v) } else { (v, u) };
        let mut flat: Vec<(DVec2, usize)> = Vec::new();
        for &k in &self.distinct {
            let p = self.points[k] - on;
            if p.dot(normal).abs() <= self.near {
                flat.push((DVec2::new(p.dot(u), p.dot(v)), k));
            }
        }
        flat.sort_by(|(p, j), (q, k)| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(j.cmp(k)));
        let mut hull: Vec<(DVec2, usize)> = Vec::new();
        let mut chain = |points: &mut dyn Iterator<Item = &(DVec2, usize)>| {
            let bottom = hull.len();
            for &(p, k) in points {
                while hull.len() >= bottom + 2 {
                    let (q, r) = (hull[hull.len() - 1].0, hull[hull.len() - 2].0);
                    if (q - r).perp_dot(p - r) > self.near * (p - r).length() {
                        break;
                    }
                    hull.pop();
                }
                hull.push((p, k));
            }
            hull.pop();
        };
        chain(&mut flat.iter());
        chain(&mut flat.iter().rev());
        hull.into_iter().map(|(_, k)| k).collect()
    }
}
