//! The convex hull of many points, approximated by as few of them as the simulator allows.

use glam::DVec3;
use plaus_sim::WorldError;
use plaus_sim::shape::ConvexHull;

/// Most corners of a hull that the simulator serves.
const MOST: usize = 64;

/// Points no farther outside than that, over the extent of all, are left out, and points as near to the plane of a face
/// are moved into it: files have seven digits.
const NEAR: f64 = 1e-6;

/// Points that are given up, as a face would get too many corners of them, before those are taken that there are.
const MOST_GIVEN_UP: usize = 400;

/// Rounds in which a point is moved into the planes of up to a few faces: each is exact for one, and for two or three
/// at right angles.
const ROUNDS: usize = 60;

/// The corners of a hull.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Corners {
    pub(crate) points: Vec<DVec3>,
    /// How many points the hull is of.
    pub(crate) of: usize,
    /// How far the farthest of those stands out beyond the face under it.
    pub(crate) out: f64,
}

/// The corners of the hull of some points: all, or where these are too many for the simulator those that stand out
/// farthest, one after the other.
pub(crate) fn corners(all: &[DVec3]) -> Result<Corners, WorldError> {
    let middle = all.iter().fold(DVec3::ZERO, |sum, &p| sum + p) / all.len().max(1) as f64;
    let extent = all.iter().map(|&p| (p - middle).length()).fold(0.0, f64::max);
    let mut points = first_four(all);
    let thickness = NEAR * extent;
    let mut hull = match ConvexHull::new(&points, 0.0) {
        Ok(hull) => hull,
        Err(_) if all.len() >= points.len() => return Err(WorldError::FlatHull { points: all.len(), thickness }),
        Err(error) => return Err(error),
    };
    let mut open: Vec<DVec3> = all.to_vec();
    let mut given_up: Vec<DVec3> = Vec::new();
    while points.len() < MOST && given_up.len() < MOST_GIVEN_UP {
        let faces = faces(&hull);
        let mut farthest: Option<(f64, usize)> = None;
        // What is inside once stays so.
        let mut kept = Vec::with_capacity(open.len());
        for point in open {
            let out = standing_out(&faces, point);
            if out > NEAR * extent {
                if farthest.is_none_or(|(most, _)| out > most) {
                    farthest = Some((out, kept.len()));
                }
                kept.push(point);
            }
        }
        open = kept;
        let Some((_, index)) = farthest else { break };
        let point = open.swap_remove(index);
        points.push(flattened(&faces, point, NEAR * extent));
        match ConvexHull::new(&points, 0.0) {
            Ok(larger) => hull = larger,
            Err(_) => {
                points.pop();
                given_up.push(point);
            }
        }
    }
    // What a later point has put inside is no corner.
    let points: Vec<DVec3> = hull.indices().iter().map(|&index| points[index]).collect();
    let faces = faces(&hull);
    let out = open.iter().chain(&given_up).map(|&point| standing_out(&faces, point)).fold(0.0, f64::max);
    Ok(Corners { points, of: all.len(), out })
}

/// The volume of the hull that is simulated for some points.
pub(crate) fn hull_volume(all: &[DVec3]) -> Result<f64, WorldError> {
    Ok(ConvexHull::new(&corners(all)?.points, 0.0)?.volume())
}

/// Four points that are far from each other, and from one plane.
fn first_four(all: &[DVec3]) -> Vec<DVec3> {
    let far = |of: &dyn Fn(DVec3) -> f64| all.iter().copied().max_by(|&a, &b| of(a).total_cmp(&of(b)));
    let Some(a) = far(&|p| -p.x).filter(|_| all.len() >= 4) else { return all.to_vec() };
    let b = far(&|p| (p - a).length()).unwrap_or(a);
    let c = far(&|p| (p - a).cross(b - a).length()).unwrap_or(a);
    let normal = (b - a).cross(c - a);
    let d = far(&|p| (p - a).dot(normal).abs()).unwrap_or(a);
    vec![a, b, c, d]
}

/// Unit normals of the faces with their distances, along the axes of the points.
pub(crate) fn faces(hull: &ConvexHull) -> Vec<(DVec3, f64)> {
    let plane = |(index, corners): (usize, &[u8])| {
        let normal = hull.turn() * hull.normal(index)?;
        let corner = hull.centre() + hull.turn() * *hull.corners().get(usize::from(*corners.first()?))?;
        Some((normal, normal.dot(corner)))
    };
    hull.faces().enumerate().filter_map(plane).collect()
}

/// How far a point is beyond the face that it is farthest beyond; negative inside.
pub(crate) fn standing_out(faces: &[(DVec3, f64)], point: DVec3) -> f64 {
    faces.iter().map(|(normal, offset)| normal.dot(point) - offset).fold(f64::NEG_INFINITY, f64::max)
}

/// A point, moved into the planes of the faces that it is nearly in.
fn flattened(faces: &[(DVec3, f64)], point: DVec3, near: f64) -> DVec3 {
    let close: Vec<_> = faces.iter().filter(|(normal, offset)| (normal.dot(point) - offset).abs() <= near).collect();
    let mut moved = point;
    for _ in 0..ROUNDS {
        for (normal, offset) in &close {
            moved -= *normal * (normal.dot(moved) - offset);
        }
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use plaus_dist::math::sin_cos;
    use std::f64::consts::TAU;

    fn rounded(points: Vec<DVec3>) -> Vec<DVec3> {
        points.into_iter().map(|p| p.as_vec3().as_dvec3()).collect()
    }

    /// A box at any angle, in the seven digits of a file, has six faces of four corners.
    #[test]
    fn boxes_of_files_are_boxes() {
        let turn = DQuat::from_xyzw(0.3, -0.2, 0.5, 0.7).normalize();
        let side = |k: u32, axis: u32| if k >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let corner = |k| turn * (DVec3::new(3.0, 5.0, 8.0) * DVec3::new(side(k, 0), side(k, 1), side(k, 2)));
        let found = corners(&rounded((0..8).map(corner).collect())).unwrap();
        let hull = ConvexHull::new(&found.points, 0.0).unwrap();
        assert_eq!((hull.corners().len(), hull.faces().count(), found.of), (8, 6, 8));
        assert!((hull.volume() / 960.0 - 1.0).abs() < 1e-5 && found.out < 1e-5);
    }

    /// A finely cut ball keeps 64 corners, and what is cut off is told: a cap over so many has about a thirtieth of the
    /// radius.
    #[test]
    fn what_has_too_many_corners_keeps_the_farthest() {
        let mut points = Vec::new();
        for row in 0..40 {
            for column in 0..40 {
                let (sin, cos) = sin_cos(0.5 * TAU * (f64::from(row) + 0.5) / 40.0);
                let (y, x) = sin_cos(TAU * f64::from(column) / 40.0);
                points.push(DVec3::new(sin * x, sin * y, cos));
            }
        }
        let found = corners(&rounded(points)).unwrap();
        let volume = ConvexHull::new(&found.points, 0.0).unwrap().volume();
        let ball = TAU * 2.0 / 3.0;
        assert!(found.points.len() <= MOST && (0.8..1.0).contains(&(volume / ball)), "{volume} {}", found.out);
        assert!((0.01..0.15).contains(&found.out), "{}", found.out);
    }

    #[test]
    fn what_is_flat_has_no_hull() {
        let flat: Vec<DVec3> = (0..9).map(|k| DVec3::new(f64::from(k % 3), f64::from(k / 3), 0.0)).collect();
        assert!(matches!(corners(&flat), Err(WorldError::FlatHull { .. })));
        assert!(corners(&[DVec3::ZERO]).is_err());
    }
}
