//! Regions: faces of fixed parts that lie flush in one plane. To a body well inside its outline a region is one half
//! space, so that it slides over floorboards, tiles and the two halves of a table as over one board.
//!
//! A region is a part of its own behind those of the user: a plane, which is there for bodies inside the outline alone.
//! For these the faces are not there. Contacts are told as those of the part under the point.

use super::facets::{Facet, INSIDE, Side};
use crate::broad::BoxTree;
use crate::material::Material;
use crate::rigid::BodyDef;
use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::rigid::tolerances::FLUSH_DISTANCE;
use crate::roots::fall_of_quadratic;
use crate::scenery::{Aabb, Plane};
use glam::DVec3;

/// How far apart the planes of flush faces may be, over the reach of the faces: rounding of their places. Default 1e-9;
/// at more, a body would step from one plane to the other.
const SAME_PLANE: f64 = 1e-9;

/// Flush faces.
#[derive(Debug, Clone)]
pub(crate) struct Region {
    plane: Plane,
    /// The parts of the faces' sides at which no other face of the region lies.
    outline: Vec<Side>,
    faces: Vec<RegionFace>,
    /// The parts that have faces of it, with the pieces of each, in ascending order.
    members: Vec<(u16, Vec<u32>)>,
    bounds: Aabb,
    /// How far beyond a side of a face a point still counts as on it.
    slack: f64,
}

/// A face of a part.
#[derive(Debug, Clone)]
pub(super) struct RegionFace {
    part: u16,
    material: Material,
    facet: Facet,
    reach: f64,
}

impl RegionFace {
    pub(super) fn new(part: usize, material: Material, facet: Facet) -> Self {
        let bounds = Aabb::around(facet.sides.iter().map(|side| side.ends[0]));
        Self { part: part as u16, material, reach: 0.5 * (bounds.max - bounds.min).length(), facet }
    }

    fn bounds(&self) -> Aabb {
        Aabb::around(self.facet.sides.iter().map(|side| side.ends[0]))
    }

    /// How far inside its sides a point is.
    fn inside(&self, x: DVec3) -> f64 {
        self.facet.sides.iter().map(|side| side.inside(x)).fold(f64::INFINITY, f64::min)
    }

    fn slack(&self, other: &Self) -> f64 {
        FLUSH_DISTANCE * self.reach.min(other.reach)
    }

    fn is_coplanar(&self, other: &Self) -> bool {
        let (a, b) = (&self.facet.flat, &other.facet.flat);
        let off = |side: &Side| b.distance(side.ends[0]).abs();
        let most = SAME_PLANE * (self.reach + other.reach);
        self.material == other.material
            && a.normal.dot(b.normal) > 0.0
            && self.facet.sides.iter().all(|s| off(s) <= most)
    }

    /// Where along a side another face lies at it or over it, as fractions of the side's length.
    fn covered(&self, side: &Side, other: &Self) -> Option<[f64; 2]> {
        let (slack, [from, to]) = (self.slack(other), side.ends.map(|end| end - side.inward * self.slack(other)));
        let mut span = [0.0_f64, 1.0];
        for line in &other.facet.sides {
            let (start, end) = (line.inside(from) + 0.5 * slack, line.inside(to) + 0.5 * slack);
            if start < 0.0 && end < 0.0 {
                return None;
            }
            if start < 0.0 {
                span[0] = span[0].max(start / (start - end));
            } else if end < 0.0 {
                span[1] = span[1].min(start / (start - end));
            }
        }
        // Two faces that meet at a corner alone do not lie at each other.
        ((span[1] - span[0]) * (to - from).length() > 2.0 * slack).then_some(span)
    }
}

impl Region {
    /// All regions of at least two of some faces.
    pub(super) fn all(faces: &[RegionFace]) -> Vec<Self> {
        let boxes: Vec<Aabb> =
            faces.iter().map(|face| face.bounds().grown(2.0 * FLUSH_DISTANCE * face.reach)).collect();
        let tree = BoxTree::new(&boxes);
        let (mut near, mut beside) = (Vec::new(), vec![Vec::new(); faces.len()]);
        for (k, face) in faces.iter().enumerate() {
            tree.find(&boxes[k], &mut near);
            for &j in near.iter().filter(|&&j| j as usize != k) {
                let other: &RegionFace = &faces[j as usize];
                if face.is_coplanar(other) && face.facet.sides.iter().any(|side| face.covered(side, other).is_some()) {
                    beside[k].push(j as usize);
                    beside[j as usize].push(k);
                }
            }
        }
        let (mut is_taken, mut regions) = (vec![false; faces.len()], Vec::new());
        for first in 0..faces.len() {
            let mut members = vec![first];
            let mut next = 0;
            while let Some(&k) = members.get(next) {
                next += 1;
                if !std::mem::replace(&mut is_taken[k], true) {
                    members.extend(beside[k].iter().copied().filter(|&j| !is_taken[j]));
                }
            }
            members.sort_unstable();
            members.dedup();
            if members.len() > 1 && members[0] == first {
                regions.extend(Self::new(members.iter().map(|&k| faces[k].clone()).collect()));
            }
        }
        regions
    }

    fn new(faces: Vec<RegionFace>) -> Option<Self> {
        let first = faces.first()?;
        let flat = first.facet.flat;
        let plane = Plane { normal: flat.normal, offset: flat.offset, material: first.material };
        let mut outline = Vec::new();
        for (k, face) in faces.iter().enumerate() {
            for side in &face.facet.sides {
                let others = faces.iter().enumerate().filter(|&(j, _)| j != k);
                let mut covered: Vec<[f64; 2]> = others.filter_map(|(_, other)| face.covered(side, other)).collect();
                covered.sort_by(|a, b| a[0].total_cmp(&b[0]));
                let (mut open, [from, to]) = (0.0, side.ends);
                let least = 2.0 * FLUSH_DISTANCE * face.reach / (to - from).length();
                for [start, end] in covered.into_iter().chain([[1.0, 1.0]]) {
                    if start - open > least {
                        outline.push(Side { ends: [open, start].map(|at| from + (to - from) * at), ..*side });
                    }
                    open = f64::max(open, end);
                }
            }
        }
        let bounds = faces.iter().fold(Aabb::EMPTY, |all, face| all.union(face.bounds()));
        let slack = FLUSH_DISTANCE * faces.iter().map(|face| face.reach).fold(f64::INFINITY, f64::min);
        let mut members: Vec<(u16, Vec<u32>)> = Vec::new();
        for face in &faces {
            match members.iter_mut().find(|(part, _)| *part == face.part) {
                Some((_, pieces)) => pieces.extend(&face.facet.pieces),
                None => members.push((face.part, face.facet.pieces.clone())),
            }
        }
        members.iter_mut().for_each(|(_, pieces)| pieces.sort_unstable());
        (!outline.is_empty()).then_some(Self { plane, outline, faces, members, bounds, slack })
    }

    pub(crate) fn plane(&self) -> &Plane {
        &self.plane
    }

    pub(crate) fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// The parts that have faces of it.
    pub(super) fn parts(&self) -> impl Iterator<Item = u16> {
        self.members.iter().map(|(part, _)| *part)
    }

    /// The pieces of a part that have faces of the region, in ascending order.
    pub(super) fn pieces(&self, part: u16) -> &[u32] {
        self.members.iter().find(|(of, _)| *of == part).map_or(&[], |(_, pieces)| pieces)
    }

    fn is_over(&self, x: DVec3) -> bool {
        self.plane.distance(x) >= 0.0 && self.faces.iter().any(|face| face.inside(x) >= -self.slack)
    }

    /// Whether a body is over the region, well inside its outline: inside a side's line, or with the sphere around it
    /// off the side.
    pub(super) fn is_below(&self, spec: &BodyDef, pose: &Pose) -> bool {
        let reach = spec.bounding_radius + INSIDE * spec.gap;
        let is_off = |side: &Side| side.away(self.plane.normal, pose.x).length() >= reach;
        !spec.is_ball
            && self.outline.iter().all(|side| is_off(side) || side.is_inside(spec, pose))
            && self.is_over(pose.x)
    }

    /// Until when after its clock a body is, at most `until`; `None` if it is not.
    pub(super) fn until(&self, spec: &BodyDef, body: &RigidBodyState, until: f64) -> Option<f64> {
        let (path, pose) = (&body.path, body.pose());
        if spec.is_ball || !self.is_over(path.x) {
            return None;
        }
        let (reach, fastest) = (spec.bounding_radius + INSIDE * spec.gap, body.fastest(spec, path.t + until));
        self.outline.iter().try_fold(until, |end, side| {
            let away = side.away(self.plane.normal, path.x);
            let room = away.length() - reach;
            let off = (room >= 0.0).then(|| {
                let way = away.normalize();
                fall_of_quadratic([room, way.dot(path.v), 0.5 * way.dot(path.a)], end).unwrap_or(end)
            });
            let inside = || side.inside_until(spec, (body, &pose), fastest, end);
            if off == Some(end) {
                return off;
            }
            off.into_iter().chain(inside()).reduce(f64::max)
        })
    }

    /// The part of the face under a point, or nearest to it.
    pub(super) fn part_at(&self, x: DVec3) -> Option<u16> {
        self.faces.iter().max_by(|a, b| a.inside(x).total_cmp(&b.inside(x))).map(|face| face.part)
    }
}
