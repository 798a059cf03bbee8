//! All points at which two pieces touch, each with a name that finds it again at other poses.

use super::edge::{on_edge, on_rim};
use super::nearest::{ends, in_common, nearest, polyhedra};
use super::{Both, Mark, Meeting};
use crate::shape::Within;
use crate::shape::frustum::{Discs, SLOTS};
use crate::shape::hull::Polyhedron;
use crate::shape::piece::{Core, Placed};
use glam::DVec3;

/// Cosine of the largest angle between a point's own normal and that of the nearest points. Default ½; points with a
/// larger angle belong to sides that do not face each other.
const FACING: f64 = 0.5;

/// Cosine of the lean up to which a disc counts as lying flat on what it touches, so that edges across its rim are
/// examined. Default 0.99; a disc that leans more touches at its lowest point.
const FLAT: f64 = 0.99;

/// Largest sine of the slope of an axis against the plane of contact with which a core lies on its side: ½.
const LYING: f64 = 0.5;

/// Sine of the angle below which a normal counts as along an axis. Default 1e-6: rounding of turns.
const ALONG: f64 = 1e-6;

/// The same of a normal that is an axis but for rounding. Default 1e-12: the normal of a point that is beside an edge
/// by rounding leans by up to 1e-6, and what slides by a metre would rise by that many metres.
const EXACTLY_ALONG: f64 = 1e-12;

/// Distance over the size within which two points of contact count as one. Default 1e-4.
const SAME: f64 = 1e-4;

/// Of two such points the nearer counts if it is nearer by at least this fraction of that distance. Default 1e-6, so
/// that rounding decides nothing.
const CLOSER: f64 = 1e-6;

/// Points of contact so far.
struct Found {
    points: Vec<Meeting>,
    /// The largest gap of a point, and the nearest points' normal.
    within: f64,
    normal: DVec3,
    /// Distance within which points count as one.
    same: f64,
}

impl Found {
    fn take(&mut self, m: Meeting) {
        if m.gap > self.within || m.normal.dot(self.normal) <= FACING {
            return;
        }
        let same = self.same;
        let known = self.points.iter_mut().find(|f| (f.points[0] - m.points[0]).length_squared() <= same * same);
        match known {
            None => self.points.push(m),
            Some(known) if m.gap < known.gap - CLOSER * same => *known = m,
            Some(_) => {}
        }
    }

    /// Whether three points are as near as the nearest. Then the pieces lie flat on each other, and rounding decides
    /// which point is nearest: at the next pose it may be another one.
    fn is_flat(&self, gap: f64) -> bool {
        self.points.iter().filter(|f| f.gap <= gap + CLOSER * self.same).count() >= 3
    }
}

/// A face of the sharp polyhedron `of`, by its normal towards the first piece and how far its plane is from the origin
/// along that; and the end of the disc that lies level with it, by the disc's axis and how far that end is along it.
pub(super) struct LevelFace {
    of: usize,
    normal: DVec3,
    height: f64,
    axis: DVec3,
    end: f64,
}

impl Both<'_> {
    /// Calls `each` for the points `within` a gap, given the nearest points.
    pub(crate) fn touching(&self, nearest: &Meeting, within: impl Into<Within>, mut each: impl FnMut(Meeting)) {
        let within = within.into();
        if nearest.gap > within.gap {
            return;
        }
        if let Some(pair) = polyhedra(self) {
            let arms = [nearest.points[0] - self.first.centre, nearest.points[1] - self.second.centre];
            let Mark::Polyhedra(feature) = nearest.mark else { return each(*nearest) };
            let known = crate::shape::hull_pair::Meeting { normal: nearest.normal, arms, gap: nearest.gap, feature };
            return pair.touching(&known, within, |m| each(in_common(self, m)));
        }
        let within = within.gap;
        let same = SAME * self.first.bounding_radius.min(self.second.bounding_radius).max(f64::MIN_POSITIVE);
        let level = self.level_face(within);
        let nearest = &level.as_ref().map_or(*nearest, |face| self.on_level(face, *nearest));
        let mut found = Found { points: Vec::new(), within, normal: nearest.normal, same };
        let mut take = |m: Meeting| {
            if m.gap <= within {
                found.take(level.as_ref().map_or(m, |face| self.on_level(face, m)));
            }
        };
        for of in 0..2 {
            match self.piece(of).core {
                Core::Polyhedron(hull) => self.of_polyhedron(of, hull, nearest, within, &mut take),
                Core::Discs(discs) => self.of_rims(of, discs, nearest, within, &mut take),
            }
        }
        self.crossing_rims(nearest.normal, &mut take);
        self.crossing_sides(nearest.normal, &mut take);
        if nearest.mark != Mark::Nearest || !found.is_flat(nearest.gap) {
            found.take(*nearest);
        }
        found.points.into_iter().for_each(each);
    }

    /// The point with that name at this pose. `towards` is its normal at a pose nearby.
    pub(crate) fn again(&self, mark: Mark, towards: DVec3) -> Meeting {
        let again = match mark {
            Mark::Nearest | Mark::Over { .. } => None,
            Mark::Polyhedra(feature) => polyhedra(self).map(|pair| in_common(self, pair.again(feature, towards))),
            Mark::Corner { of, corner } => {
                self.corner(usize::from(of), corner).map(|p| self.at_point(usize::from(of), p, mark))
            }
            Mark::Rim { of, ring, slot } => self.rim(usize::from(of), ring, slot, towards),
            Mark::Edge { of, edge, at } => self.edge(usize::from(of), edge, at),
            Mark::Rims { rings, side } => self.rims(rings, side, towards),
            Mark::Side { of, ring, at } => self.side(usize::from(of), ring, at, towards),
        };
        let again = again.unwrap_or_else(|| nearest(self));
        let level = self.level_face(f64::INFINITY).filter(|face| face.normal.cross(towards).length() <= ALONG);
        level.map_or(again, |face| self.on_level(&face, again))
    }

    /// The same meeting along the face that a disc lies level with, if there is one `within` of it.
    pub(crate) fn level(&self, m: Meeting, within: f64) -> Meeting {
        self.level_face(within).map_or(m, |face| self.on_level(&face, m))
    }

    /// The face of a polyhedron that the other piece, a disc, lies level with: on the side of the face, and no deeper
    /// than `within`. What is rounded has no edge to run into.
    pub(super) fn level_face(&self, within: f64) -> Option<LevelFace> {
        let of = (0..2).find(|&k| self.hull(k).is_some_and(Polyhedron::has_inside))?;
        let (piece, other, sign) = (self.piece(of), self.piece(1 - of), if of == 0 { -1.0 } else { 1.0 });
        let (hull, discs, axis) = (self.hull(of)?, self.discs(1 - of)?, other.axes.z_axis);
        if self.roundings() > 0.0 {
            return None;
        }
        let normals = hull.faces.iter().map(|face| piece.axes * face.normal * sign);
        let normal = normals
            .filter(|n| n.dot(axis).abs() > FLAT && self.apart(*n).abs() <= within)
            .max_by(|a, b| self.apart(*a).total_cmp(&self.apart(*b)))?;
        let ring = usize::from(normal.dot(axis) * sign < 0.0);
        let height = sign * piece.support(normal * sign);
        Some(LevelFace { of, normal, height, axis, end: axis.dot(other.centre) + discs.heights[ring] })
    }

    /// A point of a disc that is beside the edge of a face that the disc lies level with, by less than a gap, counts as
    /// over the face, as a corner of a polyhedron does: it does not run into the edge.
    fn on_level(&self, face: &LevelFace, m: Meeting) -> Meeting {
        let (n, axis) = (face.normal, face.axis);
        if n.dot(m.normal) < -FACING || [n, axis].iter().any(|axis| axis.cross(m.normal).length() <= EXACTLY_ALONG) {
            return m;
        }
        let own = m.points[1 - face.of];
        let own = own - axis * (axis.dot(own) - face.end);
        let over = n.dot(own) - face.height;
        let foot = own - n * over;
        let (points, gap) = if face.of == 1 { ([own, foot], over) } else { ([foot, own], -over) };
        Meeting { normal: n, points, gap, ..m }
    }

    /// A piece's polyhedron.
    fn hull(&self, of: usize) -> Option<&Polyhedron> {
        match self.piece(of).core {
            Core::Polyhedron(hull) => Some(hull),
            Core::Discs(_) => None,
        }
    }

    fn discs(&self, of: usize) -> Option<&Discs> {
        match self.piece(of).core {
            Core::Discs(discs) => Some(discs),
            Core::Polyhedron(_) => None,
        }
    }

    fn corner(&self, of: usize, corner: u8) -> Option<DVec3> {
        let piece = self.piece(of);
        Some(piece.centre + piece.axes * self.hull(of)?.corner(corner))
    }

    /// A point of a rim. The lowest point is the one nearest to the other's core, whatever `towards` is: that is the
    /// normal at a pose nearby, along whose axis a rim would have no lowest point.
    fn rim(&self, of: usize, ring: u8, slot: u8, towards: DVec3) -> Option<Meeting> {
        let (piece, discs) = (self.piece(of), self.discs(of)?);
        let mark = Mark::Rim { of: of as u8, ring, slot };
        let down = piece.axes.transpose() * if of == 0 { -towards } else { towards };
        if slot > 0 || discs.radii[usize::from(ring)] == 0.0 {
            let p = discs.rim(usize::from(ring), slot, down)?;
            return Some(self.at_point(of, piece.centre + piece.axes * p, mark));
        }
        let other = self.piece(1 - of);
        let turned = other.axes.transpose();
        let (into, centre) = (turned * piece.axes, turned * (piece.centre - other.centre));
        let mut best: Option<Meeting> = None;
        on_rim(
            other.core,
            discs,
            usize::from(ring),
            |p| centre + into * p,
            |d| into * d,
            |p| {
                let m = self.at_point(of, other.centre + other.axes * p, mark);
                if best.is_none_or(|b| m.gap < b.gap) {
                    best = Some(m);
                }
            },
        );
        best
    }

    fn of_rims(&self, of: usize, discs: &Discs, nearest: &Meeting, within: f64, take: &mut impl FnMut(Meeting)) {
        let is_disc = discs.heights[0] == discs.heights[1] && discs.radii[0] == discs.radii[1];
        let piece = self.piece(of);
        let down = piece.axes.transpose() * if of == 0 { -nearest.normal } else { nearest.normal };
        let (own, other) = (nearest.normal * if of == 0 { 1.0 } else { -1.0 }, self.piece(1 - of));
        let level = other.support(own) + within + self.roundings() - own.dot(piece.centre);
        for ring in 0..if is_disc { 1 } else { 2_u8 } {
            // The plane across the normal that holds the other core: anything beyond it is farther away.
            let k = usize::from(ring);
            if -discs.radii[k] * down.truncate().length() - discs.heights[k] * down.z > level {
                continue;
            }
            for slot in 0..SLOTS {
                if discs.rim(usize::from(ring), slot, down).is_some()
                    && let Some(m) = self.rim(of, ring, slot, nearest.normal)
                {
                    take(m);
                }
            }
        }
    }

    fn of_polyhedron(
        &self,
        of: usize,
        hull: &Polyhedron,
        nearest: &Meeting,
        within: f64,
        take: &mut impl FnMut(Meeting),
    ) {
        let (piece, other) = (self.piece(of), self.piece(1 - of));
        let Core::Discs(discs) = other.core else { return };
        let seen = ends(other, piece, hull);
        let bounding_radius = within + self.roundings();
        for (k, end) in seen[..hull.corners.len()].iter().enumerate() {
            if end.distance <= bounding_radius {
                let mark = Mark::Corner { of: of as u8, corner: k as u8 };
                take(self.at_point(of, other.centre + other.axes * end.at, mark));
            }
        }
        let into = other.axes.transpose() * piece.axes;
        let is_flat = other.axes.z_axis.dot(nearest.normal).abs() > FLAT;
        let up = other.axes.z_axis.dot(if of == 0 { nearest.normal } else { -nearest.normal }) > 0.0;
        for (k, e) in hull.edges.iter().enumerate() {
            let mark = |at: u8| Mark::Edge { of: of as u8, edge: k as u8, at };
            let both_ends = e.ends.map(|c| &seen[usize::from(c)]);
            if let Some(p) = on_edge(other.core, both_ends, into * e.along, e.length, bounding_radius) {
                take(self.at_point(of, other.centre + other.axes * p, mark(0)));
            }
            if is_flat && both_ends.iter().any(|end| end.distance > 0.0) {
                // The upper disc faces objects above it.
                let ring = if up { 1 } else { 0 };
                for side in 0..2 {
                    if let Some(p) = across_rim(discs, ring, side, both_ends[0].at, into * e.along, e.length) {
                        let p = other.centre + other.axes * p;
                        take(self.on_disc(of, ring, p, mark(1 + 2 * ring as u8 + side)));
                    }
                }
            }
        }
    }

    /// A point of an edge over a core of discs.
    fn edge(&self, of: usize, edge: u8, at: u8) -> Option<Meeting> {
        let (piece, other, hull) = (self.piece(of), self.piece(1 - of), self.hull(of)?);
        let discs = self.discs(1 - of)?;
        let seen = ends(other, piece, hull);
        let e = hull.edge(edge);
        let both_ends = e.ends.map(|c| &seen[usize::from(c)]);
        let along = other.axes.transpose() * (piece.axes * e.along);
        let world = |p: DVec3| other.centre + other.axes * p;
        let mark = Mark::Edge { of: of as u8, edge, at };
        if at == 0 {
            let ends = || if both_ends[0].distance < both_ends[1].distance { both_ends[0].at } else { both_ends[1].at };
            let p = on_edge(other.core, both_ends, along, e.length, f64::INFINITY).unwrap_or_else(ends);
            return Some(self.at_point(of, world(p), mark));
        }
        let ring = usize::from((at - 1) / 2);
        let p = across_rim(discs, ring, (at - 1) % 2, both_ends[0].at, along, e.length)?;
        Some(self.on_disc(of, ring, world(p), mark))
    }

    /// Crossings of rims that face each other.
    fn crossing_rims(&self, normal: DVec3, take: &mut impl FnMut(Meeting)) {
        let lean = |p: &Placed| p.axes.z_axis.dot(normal);
        let (a, b) = (lean(&self.first), lean(&self.second));
        if a.abs() > FLAT && b.abs() > FLAT {
            let rings = [u8::from(a < 0.0), u8::from(b > 0.0)];
            for side in 0..2 {
                if let Some(m) = self.rims(rings, side, normal) {
                    take(m);
                }
            }
        }
    }

    fn rims(&self, rings: [u8; 2], side: u8, normal: DVec3) -> Option<Meeting> {
        let (a, b) = (self.discs(0)?, self.discs(1)?);
        let middle = |p: &Placed, d: &Discs, ring: u8| p.centre + p.axes.z_axis * d.heights[usize::from(ring)];
        let (r, s) = (a.radii[usize::from(rings[0])], b.radii[usize::from(rings[1])]);
        // The first core's own axis: the points are then the same, whatever the normal is.
        let axis = self.first.axes.z_axis;
        let normal = if axis.dot(normal) < 0.0 { -axis } else { axis };
        let (from, to) = (middle(&self.first, a, rings[0]), middle(&self.second, b, rings[1]));
        let between = (to - from) - normal * normal.dot(to - from);
        let distance = between.length();
        if r == 0.0 || s == 0.0 || distance >= r + s || distance <= (r - s).abs() {
            return None;
        }
        let along = (distance * distance + r * r - s * s) / (2.0 * distance);
        let off = (r * r - along * along).max(0.0).sqrt() * if side == 0 { 1.0 } else { -1.0 };
        let towards = between / distance;
        let turned = self.first.axes.transpose() * (towards * along + normal.cross(towards) * off);
        let p = self.first.centre + self.first.axes * a.rim(usize::from(rings[0]), 0, turned)?;
        Some(self.on_disc(0, usize::from(rings[1]), p, Mark::Rims { rings, side }))
    }

    /// Where the side of a core that lies on the other's disc crosses that disc's rim: a log whose ends are beyond the
    /// stump that it lies on touches it with neither.
    fn crossing_sides(&self, normal: DVec3, take: &mut impl FnMut(Meeting)) {
        for of in 0..2 {
            let other = self.piece(1 - of).axes.z_axis.dot(if of == 0 { normal } else { -normal });
            if other.abs() > FLAT && self.piece(of).axes.z_axis.dot(normal).abs() < LYING {
                let ring = u8::from(other > 0.0);
                (0..2).filter_map(|at| self.side(of, ring, at, normal)).for_each(&mut *take);
            }
        }
    }

    fn side(&self, of: usize, ring: u8, at: u8, towards: DVec3) -> Option<Meeting> {
        let (own, other, core) = (self.piece(of), self.piece(1 - of), self.discs(of)?);
        // The other core's own axis: the point is then the same, whatever the normal is.
        let axis = other.axes.z_axis;
        let towards = if axis.dot(towards) < 0.0 { -axis } else { axis };
        let down = own.axes.transpose() * if of == 0 { -towards } else { towards };
        let ends = [core.rim(0, 0, down)?, core.rim(1, 0, down)?];
        let into = other.axes.transpose();
        let [from, to] = ends.map(|p| into * (own.centre + own.axes * p - other.centre));
        let (length, ring) = ((to - from).length(), usize::from(ring));
        let p = across_rim(self.discs(1 - of)?, ring, at, from, (to - from) / length, length)?;
        let mark = Mark::Side { of: of as u8, ring: ring as u8, at };
        Some(self.on_disc(of, ring, other.centre + other.axes * p, mark))
    }

    /// A point of the piece `of` on the cylinder over the other's rim. A little inside the other, its side is as near
    /// as its disc; the disc is meant.
    fn on_disc(&self, of: usize, ring: usize, p: DVec3, mark: Mark) -> Meeting {
        let m = self.at_point(of, p, mark);
        let other = self.piece(1 - of);
        let Core::Discs(discs) = other.core else { return m };
        let (axis, sign) = (other.axes.z_axis, if of == 0 { 1.0 } else { -1.0 });
        let up = if ring == 1 { axis } else { -axis };
        let distance = up.dot(p - other.centre - axis * discs.heights[ring]);
        let is_shallow =
            distance <= 0.0 && -distance <= SAME * self.first.bounding_radius.min(self.second.bounding_radius);
        if m.normal.dot(up) * sign > FACING || !is_shallow {
            return m;
        }
        let projection = p - up * distance;
        self.meeting(if of == 0 { [p, projection] } else { [projection, p] }, up * sign, distance, mark)
    }
}

/// Where an edge crosses the cylinder over a rim, in the discs' axes.
fn across_rim(discs: &Discs, ring: usize, side: u8, from: DVec3, along: DVec3, length: f64) -> Option<DVec3> {
    let (p, d) = (from.truncate(), along.truncate());
    let (a, b, c) = (d.length_squared(), p.dot(d), p.length_squared() - discs.radii[ring] * discs.radii[ring]);
    let root = b * b - a * c;
    if root <= 0.0 || a == 0.0 {
        return None;
    }
    let t = if side == 0 { (-b - root.sqrt()) / a } else { (-b + root.sqrt()) / a };
    (t > 0.0 && t < length).then(|| from + along * t)
}
