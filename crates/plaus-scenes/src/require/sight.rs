//! What hides things from an eye at one time: bodies and scenery as they are drawn, but for what one sees through.

use super::probe::Probe;
use crate::animation::{Form, Shape, Track};
use glam::{DQuat, DVec3};
use plaus_sim::roots::roots_of_quadratic;

/// How near to its end nothing is in the way of a line of sight, in m: things that touch what is looked at.
const CLOSE: f64 = 1e-5;

/// Lines of sight from one point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cone {
    apex: DVec3,
    /// Of length 1.
    axis: DVec3,
    /// Of the angle between the axis and the outermost lines.
    sin: f64,
    cos: f64,
    /// No line is longer, in m.
    far: f64,
}

impl Cone {
    /// All to the points of a ball.
    pub(super) fn to_ball(apex: DVec3, centre: DVec3, radius: f64) -> Self {
        let to = centre - apex;
        let far = to.length() + radius;
        let (sin, cos) = match radius / to.length() {
            sin if sin < 1.0 => (sin, (1.0 - sin * sin).sqrt()),
            _ => (0.0, -1.0),
        };
        Self { apex, axis: to.normalize_or(DVec3::X), sin, cos, far }
    }

    /// All that are at most at a right angle to the direction of a point, and no longer than the way there.
    pub(super) fn about(apex: DVec3, point: DVec3) -> Self {
        let to = point - apex;
        Self { apex, axis: to.normalize_or(DVec3::X), sin: 1.0, cos: 0.0, far: to.length() }
    }

    /// Whether a line may meet a ball.
    fn may_meet(&self, centre: DVec3, radius: f64) -> bool {
        let to = centre - self.apex;
        let along = to.dot(self.axis);
        let across = (to - along * self.axis).length();
        let near = to.length() - radius;
        near <= self.far && (near <= 0.0 || across * self.cos - along * self.sin <= radius * (1.0 + 1e-9))
    }
}

/// Something at a place that is in the way.
#[derive(Debug, Clone)]
enum Thing {
    /// Centre, radius.
    Ball(DVec3, f64),
    /// Centre, half its edges, turn.
    Box(DVec3, DVec3, DQuat),
    /// Distances from the third axis and heights along it of an outline from end to end, place, turn.
    Round(Vec<[f64; 2]>, DVec3, DQuat),
    Triangle([DVec3; 3]),
}

/// All that may be in the way of some lines of sight.
#[derive(Debug, Default)]
pub(super) struct Sight(Vec<Thing>);

impl Sight {
    /// What of a motion's bodies and its scenery may be in the way at a time, in s, but for one body. Planes hide
    /// nothing: what there is lies on the side from which they are seen.
    pub(super) fn of(probe: &Probe<'_>, time: f64, but: &Track, cone: &Cone) -> Self {
        let mut sight = Self::default();
        let tracks = probe.motion().tracks.iter();
        for track in tracks.filter(|track| track.name != but.name && track.look.clear().is_none()) {
            if track.is_there(time) && cone.may_meet(track.position(time), track.shape.reach()) {
                sight.add_shape(&track.shape, (track.position(time), track.orientation(time)), cone);
            }
        }
        for prop in probe.scenery().iter().filter(|prop| prop.look.clear().is_none()) {
            sight.add_form(&prop.form, cone);
        }
        sight
    }

    fn add_shape(&mut self, shape: &Shape, (at, turn): (DVec3, DQuat), cone: &Cone) {
        match shape {
            Shape::Sphere { radius, .. } => self.0.push(Thing::Ball(at, *radius)),
            Shape::Cuboid { half, .. } => self.0.push(Thing::Box(at, *half, turn)),
            Shape::Disc { radius, thickness } => {
                let half = 0.5 * thickness;
                self.0.push(Thing::Round(closed(&[[*radius, -half], [*radius, half]]), at, turn));
            }
            Shape::Revolution { profile, .. } => self.0.push(Thing::Round(closed(profile), at, turn)),
            Shape::Solid { vertices, triangles } => {
                let placed: Vec<DVec3> = vertices.iter().map(|vertex| at + turn * *vertex).collect();
                self.add_triangles(&placed, triangles, cone);
            }
        }
    }

    fn add_form(&mut self, form: &Form, cone: &Cone) {
        match form {
            Form::Plane { .. } => {}
            Form::Block { centre, half, orientation } if cone.may_meet(*centre, half.length()) => {
                self.0.push(Thing::Box(*centre, *half, *orientation));
            }
            Form::Block { .. } => {}
            Form::Mesh { vertices, triangles } => self.add_triangles(vertices, triangles, cone),
            Form::Heightfield { origin, step, columns, heights } => {
                let columns = (*columns as usize).max(1);
                let corner = |k: usize| {
                    *origin + DVec3::new((k % columns) as f64 * step[0], heights[k], (k / columns) as f64 * step[1])
                };
                for row in 1..heights.len() / columns {
                    for column in 1..columns {
                        let [a, b] = [(row - 1) * columns + column - 1, row * columns + column - 1];
                        self.add_triangle([a, b, b + 1].map(corner), cone);
                        self.add_triangle([a, b + 1, a + 1].map(corner), cone);
                    }
                }
            }
        }
    }

    fn add_triangles(&mut self, vertices: &[DVec3], triangles: &[[u32; 3]], cone: &Cone) {
        for corners in triangles {
            if let [Some(a), Some(b), Some(c)] = corners.map(|corner| vertices.get(corner as usize).copied()) {
                self.add_triangle([a, b, c], cone);
            }
        }
    }

    fn add_triangle(&mut self, corners: [DVec3; 3], cone: &Cone) {
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let reach = corners.into_iter().map(|corner| corner.distance_squared(middle)).fold(0.0, f64::max).sqrt();
        if cone.may_meet(middle, reach) {
            self.0.push(Thing::Triangle(corners));
        }
    }

    /// Whether nothing may be in the way.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether nothing is in the way from one point to another.
    pub(super) fn is_clear(&self, from: DVec3, to: DVec3) -> bool {
        let length = from.distance(to);
        let along = (to - from) * ((length - CLOSE).max(0.0) / length.max(f64::MIN_POSITIVE));
        self.first(from, along).is_none()
    }

    /// The share of a way after which something is in it; `None` if nothing is.
    fn first(&self, from: DVec3, along: DVec3) -> Option<f64> {
        let shares = self.0.iter().filter_map(|thing| thing.first(from, along));
        shares.filter(|share| (0.0..=1.0).contains(share)).min_by(f64::total_cmp)
    }
}

/// An outline of a solid of revolution with the middles of its ends.
fn closed(outline: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let end = |end: Option<&[f64; 2]>| end.map(|end| [0.0, end[1]]);
    end(outline.first()).into_iter().chain(outline.iter().copied()).chain(end(outline.last())).collect()
}

impl Thing {
    /// The least share, from 0 on, of a way after which it passes the surface; it may be beyond the end.
    fn first(&self, from: DVec3, along: DVec3) -> Option<f64> {
        match self {
            Self::Ball(centre, radius) => {
                let from = from - *centre;
                let squares = [from.length_squared() - radius * radius, 2.0 * from.dot(along), along.length_squared()];
                roots_of_quadratic(squares)?.into_iter().find(|share| *share >= 0.0)
            }
            Self::Box(centre, half, turn) => {
                let back = turn.conjugate();
                through_box(back * (from - *centre), back * along, *half)?.into_iter().find(|share| *share >= 0.0)
            }
            Self::Round(outline, centre, turn) => {
                let back = turn.conjugate();
                let (from, along) = (back * (from - *centre), back * along);
                let pairs = outline.windows(2).filter_map(|pair| through_ring(from, along, [pair[0], pair[1]]));
                pairs.min_by(f64::total_cmp)
            }
            Self::Triangle([a, b, c]) => through_triangle(from, along, [*a, *b - *a, *c - *a]),
        }
    }
}

/// Where a line enters a box about the origin, and where it leaves it.
fn through_box(from: DVec3, along: DVec3, half: DVec3) -> Option<[f64; 2]> {
    let [mut enters, mut leaves] = [f64::NEG_INFINITY, f64::INFINITY];
    for axis in 0..3 {
        let (p, v, half) = (from[axis], along[axis], half[axis]);
        if v == 0.0 {
            if p.abs() > half {
                return None;
            }
            continue;
        }
        let [a, b] = [(-half - p) / v, (half - p) / v];
        enters = enters.max(a.min(b));
        leaves = leaves.min(a.max(b));
    }
    (enters <= leaves).then_some([enters, leaves])
}

/// Where a line first passes the ring between two points of an outline turned about the third axis.
fn through_ring(from: DVec3, along: DVec3, [[r0, z0], [r1, z1]]: [[f64; 2]; 2]) -> Option<f64> {
    if z0 == z1 {
        let share = (z0 - from.z) / along.z;
        let radius = (from + share * along).truncate().length();
        return (share >= 0.0 && (r0.min(r1)..=r0.max(r1)).contains(&radius)).then_some(share);
    }
    // The radius at the line's height is r + s times the share.
    let slope = (r1 - r0) / (z1 - z0);
    let (r, s) = (r0 + slope * (from.z - z0), slope * along.z);
    let (p, v) = (from.truncate(), along.truncate());
    let squares = [p.length_squared() - r * r, 2.0 * (p.dot(v) - r * s), v.length_squared() - s * s];
    let on_ring = |share: &f64| {
        let z = from.z + share * along.z;
        *share >= 0.0 && (z0.min(z1)..=z0.max(z1)).contains(&z)
    };
    roots_of_quadratic(squares)?.into_iter().find(on_ring)
}

/// Where a line passes a triangle, given by a corner and the edges from it (Möller & Trumbore 1997).
fn through_triangle(from: DVec3, along: DVec3, [corner, a, b]: [DVec3; 3]) -> Option<f64> {
    let p = along.cross(b);
    let det = a.dot(p);
    if det == 0.0 {
        return None;
    }
    let to = from - corner;
    let u = to.dot(p) / det;
    let q = to.cross(a);
    let v = along.dot(q) / det;
    let share = b.dot(q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && share >= 0.0).then_some(share)
}
