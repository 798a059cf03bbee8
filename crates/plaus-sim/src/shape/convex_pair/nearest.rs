//! The nearest points of two pieces.

use super::edge::{End, on_edge, on_rim};
use super::{Both, Mark, Meeting};
use crate::shape::frustum::Discs;
use crate::shape::hull::{Edge, MOST_CORNERS, Polyhedron};
use crate::shape::hull_pair::{self, HullPair};
use crate::shape::piece::{Core, Placed};
use crate::special_case::SpecialCase;
use glam::DVec3;

/// Distance over the size below which cores count as touching, because the direction between their nearest points is
/// then meaningless. Default 1e-11.
const TOUCHING: f64 = 1e-11;

/// Slack over the size within which points count as equally low. Default 1e-12.
const SLACK: f64 = 1e-12;

/// Distance over the size by which nearest points may be farther apart than the planes that separate the cores. Default
/// 1e-10, above rounding.
const PROVED: f64 = 1e-10;

/// Maximum number of rounds of turning the way out of an overlap.
const ROUNDS: usize = 40;

/// Least distance over the size to which overlapping cores are moved apart. Default 1e-5: their nearest points are then
/// known to 1e-10 of it.
const ASIDE: f64 = 1e-5;

/// Overlap over the size up to which the best direction examined is taken, if it is the normal of a face and the
/// other's lowest point is over that face. No way out nearby is then shorter, and ways out elsewhere are shorter by
/// less than this. Default 1e-4.
const SHALLOW: f64 = 1e-4;

/// Change of a direction below which it counts as found.
const FOUND: f64 = 1e-10;

/// The nearest points of two pieces. For cores that overlap, the points along the shortest way out found from several
/// directions.
pub(crate) fn nearest(both: &Both) -> Meeting {
    nearest_from(both, None, DVec3::ZERO)
}

/// The same, if at a pose nearby these elements were the nearest, with this normal.
pub(crate) fn nearest_from(both: &Both, last: Option<Mark>, normal: DVec3) -> Meeting {
    match (both.first.core, both.second.core) {
        // A ball and a box: the distance of a point, in closed form.
        (Core::Polyhedron(a), Core::Polyhedron(b))
            if SpecialCase::BallAndBox.is_on() && a.is_point() && b.half().is_some() =>
        {
            both.at_point(0, both.first.centre, Mark::Corner { of: 0, corner: 0 })
        }
        (Core::Polyhedron(a), Core::Polyhedron(b))
            if SpecialCase::BallAndBox.is_on() && b.is_point() && a.half().is_some() =>
        {
            both.at_point(1, both.second.centre, Mark::Corner { of: 1, corner: 0 })
        }
        (Core::Polyhedron(_), Core::Polyhedron(_)) => {
            let pair = polyhedra(both);
            pair.map_or_else(
                || both.at_point(0, both.first.centre, Mark::Nearest),
                |p| {
                    let guess = last.and_then(|mark| match mark {
                        Mark::Polyhedra(feature) => Some((feature, normal)),
                        _ => None,
                    });
                    in_common(both, p.nearest(guess))
                },
            )
        }
        _ => match searched(both) {
            Searched::Nearest(m) => m,
            Searched::Overlap(search) => search.deepest(),
        },
    }
}

/// The result of a search.
enum Searched<'b, 'p> {
    Nearest(Meeting),
    /// The cores overlap; this was examined.
    Overlap(Search<'b, 'p>),
}

/// The nearest points of cores that are not both polyhedra, or what the search has seen.
fn searched<'b, 'p>(both: &'b Both<'p>) -> Searched<'b, 'p> {
    match (both.first.core, both.second.core) {
        (Core::Discs(_), Core::Discs(_)) => two_of_discs(both),
        (Core::Discs(_), _) => with_polyhedron(both, 0),
        _ => with_polyhedron(both, 1),
    }
}

/// Both as polyhedra, if they are.
pub(super) fn polyhedra<'p>(both: &Both<'p>) -> Option<HullPair<'p>> {
    let placed = |p: &Placed<'p>| match p.core {
        Core::Polyhedron(core) => Some(hull_pair::Placed { axes: p.axes, core, rounding: p.rounding }),
        Core::Discs(_) => None,
    };
    Some(HullPair::new(both.first.centre - both.second.centre, placed(&both.first)?, placed(&both.second)?))
}

/// A meeting of polyhedra, whose arms are about their own centres, moved to the common origin.
pub(super) fn in_common(both: &Both, m: hull_pair::Meeting) -> Meeting {
    let points = [both.first.centre + m.arms[0], both.second.centre + m.arms[1]];
    Meeting { normal: m.normal, points, gap: m.gap, mark: Mark::Polyhedra(m.feature) }
}

/// The results so far: the nearest points of cores, and the direction that keeps the cores farthest apart.
struct Search<'b, 'p> {
    both: &'b Both<'p>,
    near: Option<Meeting>,
    far: (f64, DVec3),
}

impl Search<'_, '_> {
    fn distance(&self) -> f64 {
        self.near.map_or(f64::INFINITY, |m| m.gap + self.both.roundings())
    }

    /// A point of the core `of` and its projection on the other.
    fn consider(&mut self, of: usize, p: DVec3, mark: Mark) {
        let m = self.both.at_point(of, p, mark);
        if self.near.is_none_or(|n| m.gap < n.gap) {
            self.near = Some(m);
        }
    }

    /// Examines a direction towards the first core.
    fn along(&mut self, normal: DVec3) {
        let apart = self.both.apart(normal);
        if apart > self.far.0 {
            self.far = (apart, normal);
        }
    }

    /// The answer if cores overlap: the best of the ways out that start from the best directions examined and from the
    /// direction between the centres.
    fn deepest(mut self) -> Meeting {
        if let Some(m) = self.near {
            self.along(m.normal);
            // Its own normal must be the way out, because a point at an edge is just as near to another side.
            let apart = self.both.apart(m.normal);
            if m.gap + self.both.roundings() <= self.far.0.min(apart) + SLACK * self.both.size() {
                return m;
            }
        }
        let (apart, normal) = self.far;
        let (mut best, off) = self.at(normal, apart, Mark::Nearest);
        let size = self.both.size();
        if -apart <= SHALLOW * size && off <= PROVED * size {
            return best;
        }
        self.along_edges();
        let normal = self.far.1;
        let centres = (self.both.first.centre - self.both.second.centre).try_normalize();
        let starts = [Some(normal), self.near.map(|m| m.normal), centres];
        for start in starts.into_iter().flatten() {
            if let Some(m) = self.way_out(start)
                && m.gap > best.gap
            {
                best = m;
            }
        }
        best
    }

    /// Examines the normals that an edge of a polyhedron and the side of a core of discs have in common.
    fn along_edges(&mut self) {
        for of in 0..2 {
            let (own, other) = (self.both.piece(of), self.both.piece(1 - of));
            let (Core::Discs(core), Core::Polyhedron(hull)) = (own.core, other.core) else { continue };
            let Some(slope) = side_slope(core) else { continue };
            let slope = if of == 0 { -slope } else { slope };
            for edge in &hull.edges {
                for n in unit_with([own.axes.z_axis, other.axes * edge.along], [slope, 0.0]).into_iter().flatten() {
                    self.along(n);
                }
            }
        }
    }

    /// The shortest way out near a direction. If cores are moved apart along a direction by more than they overlap,
    /// they have nearest points. Along the line between these points they overlap less, or equally if it is the same
    /// direction. This is the proximal-point method, because the moved cores are kept apart by the largest of
    /// `apart(n) + shift n·direction`.
    fn way_out(&self, start: DVec3) -> Option<Meeting> {
        let (mut n, mut found) = (start, None);
        for _ in 0..ROUNDS {
            let shift = n * (-2.0 * self.both.apart(n)).max(ASIDE * self.both.size());
            let moved = Placed { centre: self.both.first.centre + shift, ..self.both.first };
            let moved = Both { first: moved, second: self.both.second };
            let Searched::Nearest(m) = searched(&moved) else { break };
            if !is_proved(&moved, &m) {
                // Just behind a triangle of a mesh, what is nearest is its front.
                break;
            }
            let (along, turned) = (m.normal.dot(shift), (m.normal - n).length());
            found = Some(Meeting { points: [m.points[0] - shift, m.points[1]], gap: m.gap - along, ..m });
            n = m.normal;
            if turned < FOUND {
                break;
            }
        }
        found.map(|m| Meeting { mark: Mark::Nearest, ..m })
    }

    /// Points that have a direction as their normal; of equally low points of the first core, one that is over the
    /// second, if one is seen. Also returns how far they are off the skins.
    fn at(&self, normal: DVec3, apart: f64, mark: Mark) -> (Meeting, f64) {
        let (p, q) = (self.both.first.farthest(-normal), self.both.second.farthest(normal));
        // If one core is flat there and the other has a point, the point determines the place.
        let (on_p, on_q) = (p - normal * apart, q + normal * apart);
        let off = |of: usize, x: DVec3| self.both.piece(of).project(x).1.abs();
        let (off_p, off_q) = (off(1, on_p), off(0, on_q));
        if off_p <= off_q {
            (self.both.meeting([p, on_p], normal, apart, mark), off_p)
        } else {
            (self.both.meeting([on_q, q], normal, apart, mark), off_q)
        }
    }
}

/// A core of discs, the first (0) or the second (1), and a polyhedron.
fn with_polyhedron<'b, 'p>(both: &'b Both<'p>, discs: usize) -> Searched<'b, 'p> {
    let (own, other) = (both.piece(discs), both.piece(1 - discs));
    let (Core::Discs(core), Core::Polyhedron(hull)) = (own.core, other.core) else {
        return Searched::Nearest(both.at_point(0, both.first.centre, Mark::Nearest));
    };
    let mut search = Search { both, near: None, far: (f64::NEG_INFINITY, DVec3::Z) };
    let (size, sign) = (both.size(), if discs == 0 { 1.0 } else { -1.0 });
    for face in &hull.faces {
        search.along(other.axes * face.normal * sign);
    }
    // A point over a face is proved by the plane of the face, whatever corners and edges are.
    let (apart, normal) = search.far;
    if apart > TOUCHING * size
        && let Some(m) = over_face(both, discs, core, normal, apart)
    {
        return Searched::Nearest(m);
    }
    if apart > TOUCHING * size || !is_across_a_face(own, other, hull) {
        let ends = ends(own, other, hull);
        let mut best = 0;
        for (k, end) in ends[..hull.corners.len()].iter().enumerate() {
            if end.distance < ends[best].distance {
                best = k;
            }
        }
        let world = |p: DVec3| own.centre + own.axes * p;
        search.consider(1 - discs, world(ends[best].at), Mark::Corner { of: (1 - discs) as u8, corner: best as u8 });
        let into = own.axes.transpose() * other.axes;
        for (k, e) in hull.edges.iter().enumerate() {
            let both_ends = e.ends.map(|c| &ends[usize::from(c)]);
            if let Some(p) = on_edge(own.core, both_ends, into * e.along, e.length, search.distance()) {
                search.consider(1 - discs, world(p), Mark::Edge { of: (1 - discs) as u8, edge: k as u8, at: 0 });
            }
        }
        // Apart from each other and not nearest over a face, they are nearest at a corner or an edge. If that is not
        // proved, the core of discs goes through a face and no corner or edge is inside it.
        if search.distance() > TOUCHING * size
            && let Some(m) = search.near
            && is_proved(both, &m)
        {
            return Searched::Nearest(m);
        }
    }
    for cap in [own.axes.z_axis, -own.axes.z_axis] {
        if core.radii[usize::from(cap == own.axes.z_axis)] > 0.0 {
            search.along(cap * -sign);
        }
    }
    Searched::Overlap(search)
}

/// Whether the ball around a core of discs reaches a polyhedron, and none of its edges: what is not on one side of that
/// face's plane goes through the face.
fn is_across_a_face(own: &Placed, other: &Placed, hull: &Polyhedron) -> bool {
    let centre = other.axes.transpose() * (own.centre - other.centre);
    let reach = own.core.reach();
    let is_beyond = |e: &Edge| {
        let from = centre - hull.corner(e.ends[0]);
        (from - e.along * from.dot(e.along).clamp(0.0, e.length)).length_squared() > reach * reach
    };
    !hull.faces.is_empty() && hull.edges.iter().all(is_beyond) && hull.project(centre).1 < reach
}

/// Corners of a polyhedron as a core of discs sees them.
pub(super) fn ends(own: &Placed, other: &Placed, hull: &Polyhedron) -> [End; MOST_CORNERS] {
    let turned = own.axes.transpose();
    let (into, centre) = (turned * other.axes, turned * (other.centre - own.centre));
    let mut ends = [End { at: DVec3::ZERO, out: DVec3::Z, distance: f64::INFINITY }; MOST_CORNERS];
    for (end, corner) in ends.iter_mut().zip(&hull.corners) {
        let at = centre + into * *corner;
        let (out, distance) = own.core.project(at);
        *end = End { at, out, distance };
    }
    ends
}

/// The meeting of a core of discs with the face of a polyhedron, if one of the core's lowest points is over it.
/// `normal` is the face's normal, towards the first.
fn over_face(both: &Both, discs: usize, core: &Discs, normal: DVec3, apart: f64) -> Option<Meeting> {
    let own = both.piece(discs);
    let down = if discs == 0 { -normal } else { normal };
    let own_down = own.axes.transpose() * down;
    let level = core.support(own_down) - SLACK * both.size();
    let rims = (0..2).flat_map(|ring| (0..crate::shape::frustum::SLOTS).map(move |slot| (ring, slot)));
    for (ring, slot) in rims {
        let Some(p) = core.rim(ring, slot, own_down) else { continue };
        if p.dot(own_down) < level {
            continue;
        }
        let m = both.at_point(discs, own.centre + own.axes * p, Mark::Rim { of: discs as u8, ring: ring as u8, slot });
        if m.gap + both.roundings() <= apart + SLACK * both.size() {
            return Some(m);
        }
    }
    None
}

/// Two cores of discs.
fn two_of_discs<'b, 'p>(both: &'b Both<'p>) -> Searched<'b, 'p> {
    let mut search = Search { both, near: None, far: (f64::NEG_INFINITY, DVec3::Z) };
    for of in 0..2 {
        let (own, other) = (both.piece(of), both.piece(1 - of));
        let Core::Discs(core) = own.core else { continue };
        let turned = other.axes.transpose();
        let (into, centre) = (turned * own.axes, turned * (own.centre - other.centre));
        for ring in 0..2 {
            if ring == 1 && core.heights[0] == core.heights[1] && core.radii[0] == core.radii[1] {
                continue;
            }
            on_rim(
                other.core,
                core,
                ring,
                |p| centre + into * p,
                |d| into * d,
                |p| {
                    search.consider(of, other.centre + other.axes * p, Mark::Nearest);
                },
            );
        }
        let sign = if of == 0 { -1.0 } else { 1.0 };
        for (ring, axis) in [(1, own.axes.z_axis), (0, -own.axes.z_axis)] {
            if core.radii[ring] > 0.0 {
                search.along(axis * sign);
            }
        }
    }
    for normal in side_normals(both).into_iter().flatten() {
        search.along(normal);
    }
    let size = both.size();
    let distance = search.distance();
    if distance <= TOUCHING * size {
        return Searched::Overlap(search);
    }
    let (apart, normal) = search.far;
    match search.near {
        Some(m) if is_proved(both, &m) => Searched::Nearest(m),
        // The sides cross at points that are on no rim.
        _ if apart > TOUCHING * size => Searched::Nearest(crossing_sides(both, normal, apart)),
        _ => Searched::Overlap(search),
    }
}

/// Whether the plane across the line between two points keeps the cores as far apart as the points are.
fn is_proved(both: &Both, m: &Meeting) -> bool {
    m.gap + both.roundings() <= both.apart(m.normal) + PROVED * both.size()
}

/// Component along the axis of the normals of a core's side. Segments have sides too: of radius 0.
fn side_slope(discs: &Discs) -> Option<f64> {
    discs.slope().or((discs.heights[0] < discs.heights[1]).then_some(0.0))
}

/// The directions, towards the first, that are normals of the sides of both cores at once.
fn side_normals(both: &Both) -> [Option<DVec3>; 2] {
    let (Core::Discs(a), Core::Discs(b)) = (both.first.core, both.second.core) else { return [None; 2] };
    let (Some(u), Some(v)) = (side_slope(a), side_slope(b)) else { return [None; 2] };
    // The normal n is −(side's normal of the first), and the side's normal of the second.
    unit_with([both.first.axes.z_axis, both.second.axes.z_axis], [-u, v])
}

/// The unit vectors with these components along two unit vectors.
fn unit_with([e, g]: [DVec3; 2], [u, v]: [f64; 2]) -> [Option<DVec3>; 2] {
    let cosine = e.dot(g);
    let across = e.cross(g);
    let sine = across.length_squared();
    if sine < 1e-14 {
        return [None; 2];
    }
    let (x, y) = ((u - cosine * v) / sine, (v - cosine * u) / sine);
    let flat = e * x + g * y;
    let rest = 1.0 - flat.length_squared();
    if rest < 0.0 {
        return [None; 2];
    }
    let out = across * (rest / sine).sqrt();
    [Some(flat + out), Some(flat - out)]
}

/// Points of two sides along their common normal: where the lines on the sides with that normal cross.
fn crossing_sides(both: &Both, normal: DVec3, apart: f64) -> Meeting {
    let line = |piece: &Placed, out: DVec3| {
        let Core::Discs(core) = piece.core else { return [piece.centre; 2] };
        let down = piece.axes.transpose() * out;
        [0, 1].map(|ring| {
            let p = core.rim(ring, 0, down).unwrap_or(DVec3::new(0.0, 0.0, core.heights[ring]));
            piece.centre + piece.axes * p
        })
    };
    let ([p, q], [r, s]) = (line(&both.first, -normal), line(&both.second, normal));
    let (e, g, between) = (q - p, s - r, p - r);
    let (ee, gg, eg) = (e.length_squared(), g.length_squared(), e.dot(g));
    let determinant = ee * gg - eg * eg;
    let t = if determinant > 0.0 { (eg * between.dot(g) - gg * between.dot(e)) / determinant } else { 0.0 };
    let on = p + e * t.clamp(0.0, 1.0);
    both.meeting([on, on - normal * apart], normal, apart, Mark::Nearest)
}
