//! A ball among the triangles of a mesh: where it touches them, and when it first does. Both are known in closed form,
//! as for marbles; the row of convex pieces finds the same points far more slowly.

use super::body::Phase;
use super::detect::Search;
use super::still::{LEAN, Still};
use super::touch::{Spot, Touch};
use crate::detect::{Stretch, sphere_on_mesh};
use crate::scenery::{Edge, Face, Mesh, Surface};
use crate::shape::On;
use crate::shape::convex_pair::{Mark, Meeting};
use crate::shape::hull_pair::Feature;
use glam::DVec3;

/// Distance, over the radius, for which the triangles ahead are collected at first. Default 0.25; then twice as far
/// each time, up to 4 if there are any.
const AHEAD: [f64; 2] = [0.25, 4.0];

/// Approach over the speed that is lost in rounding. Default 1e-12.
const UNFELT: f64 = 1e-12;

/// The name of what a ball touches on a triangle.
fn mark(on: On) -> Mark {
    Mark::Polyhedra(Feature::Corner { of: 0, corner: 0, on })
}

/// What a ball touches under this name.
fn on(mark: Mark) -> Option<On> {
    match mark {
        Mark::Polyhedra(Feature::Corner { of: 0, on, .. }) => Some(on),
        _ => None,
    }
}

/// A meeting of a ball with a part of a triangle, about the ball's centre.
fn meeting(on: On, normal: DVec3, distance: f64, radius: f64) -> Meeting {
    let points = [normal * -radius, normal * -distance];
    Meeting { normal, points, gap: distance - radius, mark: mark(on) }
}

/// From a triangle's corner, or from the line along its side, to `x`; and whether the foot is between the side's ends.
fn offset(mesh: &Mesh, face: &Face, on: On, x: DVec3) -> (DVec3, bool) {
    let corner = |k: usize| mesh.vertices()[face.corners[k % 3] as usize];
    match on {
        On::Face(_) => (face.normal * (face.normal.dot(x) - face.offset), true),
        On::Corner(k) => (x - corner(usize::from(k)), true),
        On::Edge(side) => {
            let from = corner(usize::from(side));
            let (offset, way) = (x - from, corner(usize::from(side) + 1) - from);
            let part = offset.dot(way) / way.length_squared();
            (offset - way * part, part > 0.0 && part < 1.0)
        }
    }
}

impl Still {
    /// The nearest point of a triangle to a ball with its centre at `x`, if they are within `within` and the point is
    /// one of the mesh; about the ball's centre.
    pub(super) fn under_ball(&self, k: u32, x: DVec3, radius: f64, within: f64) -> Option<Meeting> {
        let mesh = self.mesh()?;
        let face = &mesh.faces[k as usize];
        let height = face.normal.dot(x) - face.offset;
        if height <= 0.0 || height - radius > within {
            return None;
        }
        if self.is_over(k, x, x) {
            return Some(meeting(On::Face(0), face.normal, height, radius));
        }
        let mut best = (On::Corner(0), DVec3::ZERO, f64::INFINITY);
        for side in 0..3 {
            for on in [On::Corner(side), On::Edge(side)] {
                let (offset, is_beside) = offset(mesh, face, on, x);
                if is_beside && offset.length_squared() < best.2 {
                    best = (on, offset, offset.length_squared());
                }
            }
        }
        let (on, offset, distance) = (best.0, best.1, best.2.sqrt());
        if distance - radius > within || distance == 0.0 {
            return None;
        }
        let found = meeting(on, offset / distance, distance, radius);
        self.has(k, &found, x).then_some(found)
    }

    /// The point under this name, about the centre of a ball at `x`.
    pub(super) fn ball_again(&self, spot: Spot, x: DVec3, radius: f64) -> Option<Meeting> {
        let (mesh, on) = (self.mesh()?, on(spot.mark)?);
        let face = &mesh.faces[spot.other as usize];
        if on == On::Face(0) {
            return Some(meeting(on, face.normal, face.normal.dot(x) - face.offset, radius));
        }
        let offset = offset(mesh, face, on, x).0;
        let distance = offset.length_squared().sqrt();
        (distance > 0.0).then(|| meeting(on, offset / distance, distance, radius))
    }

    /// The triangle that a ball touches inside its sides, under this name.
    pub(super) fn face_of(&self, spot: Spot) -> Option<u32> {
        (self.mesh().is_some() && on(spot.mark) == Some(On::Face(0))).then_some(spot.other)
    }

    /// The name under which a ball touches a side of a triangle.
    pub(super) fn side(&self, k: u32, side: usize) -> Spot {
        Spot { own: 0, other: k, mark: mark(On::Edge(side as u8)) }
    }

    /// A ball, with its centre at `x`, on the plane of a triangle.
    pub(super) fn face_under(&self, part: u16, k: u32, x: DVec3, radius: f64) -> Touch {
        let (n, surface) = (self.normal(k), Spot { own: 0, other: k, mark: mark(On::Face(0)) }.surface(part));
        let gap = self.mesh().map_or(f64::INFINITY, |mesh| n.dot(x) - mesh.faces[k as usize].offset - radius);
        Touch { surface, part, arm: n * -radius, normal: n, gap }
    }

    /// The direction of the edge that a ball touches under this name, and the triangles at it.
    pub(super) fn edge_under(&self, spot: Spot) -> Option<(DVec3, [Option<u32>; 2])> {
        let (mesh, On::Edge(side)) = (self.mesh()?, on(spot.mark)?) else { return None };
        let edge = &mesh.edges[self.edge_of(spot.other, usize::from(side))? as usize];
        Some((edge.direction, edge.faces))
    }

    /// The part of the mesh that a ball touches under this name.
    fn surface_of(&self, mesh: &Mesh, spot: Spot) -> Option<Surface> {
        let corners = mesh.faces[spot.other as usize].corners;
        match on(spot.mark)? {
            On::Face(_) => Some(Surface::Face(spot.other)),
            On::Edge(side) => self.edge_of(spot.other, usize::from(side)).map(Surface::Edge),
            On::Corner(k) => corners.get(usize::from(k)).map(|&c| Surface::Vertex(c)),
        }
    }
}

/// A quick test for what a ball cannot reach within a stretch. The square of a distance has at least the second
/// derivative −2 · distance · acceleration.
struct StaysOff<'s> {
    stretch: &'s Stretch<'s>,
    square: f64,
    time: f64,
    /// Acceleration times the square of the time, and the longest way.
    pull: f64,
    way: f64,
}

impl<'s> StaysOff<'s> {
    fn new(stretch: &'s Stretch<'s>, radius: f64, time: f64) -> Self {
        let pull = stretch.path.a.length() * time * time;
        Self { stretch, square: radius * radius, time, pull, way: stretch.v.length() * time + 0.5 * pull }
    }

    /// For a distance whose square is this, and changes at this rate.
    fn is_off(&self, squared: f64, rate: f64) -> bool {
        squared - self.square + (rate * self.time).min(0.0) > (squared.sqrt() + self.way) * self.pull
    }

    fn point(&self, p: DVec3) -> bool {
        let offset = self.stretch.x - p;
        self.is_off(offset.length_squared(), 2.0 * offset.dot(self.stretch.v))
    }

    fn line(&self, edge: &Edge) -> bool {
        let (offset, d) = (self.stretch.x - edge.origin, edge.direction);
        let across = offset - d * offset.dot(d);
        self.is_off(across.length_squared(), 2.0 * across.dot(self.stretch.v))
    }
}

/// When a ball in a straight step, at first beside a triangle, comes over it while it approaches its plane and is
/// nearer than its radius: where a step has taken it too far over an edge.
fn entry(face: &Face, stretch: &Stretch, radius: f64) -> Option<f64> {
    let (x, v) = (stretch.x, stretch.v);
    let mut latest = 0.0_f64;
    for (inward, offset) in face.sides {
        let (inside, rate) = (inward.dot(x) - offset, inward.dot(v));
        if inside < 0.0 {
            latest = latest.max(if rate > 0.0 { -inside / rate } else { f64::INFINITY });
        }
    }
    let there = x + v * latest;
    let height = face.normal.dot(there) - face.offset;
    let is_near = latest > 0.0 && latest.is_finite() && height > 0.0 && height <= radius && face.normal.dot(v) < 0.0;
    let is_over = || face.sides.iter().all(|&(inward, offset)| inward.dot(there) - offset >= -LEAN * radius);
    (is_near && is_over()).then_some(stretch.from + latest)
}

impl Search<'_> {
    /// First contact of a ball with a mesh.
    pub(super) fn ball(&mut self, part: u16, still: &Still, mesh: &Mesh) {
        let (spec, body) = (self.spec, self.body);
        let (path, radius) = (&body.path, spec.reach + spec.gap);
        let pull = (path.a.length() * radius).sqrt();
        let (mut near, mut from, mut window) = (Vec::new(), 0.0, AHEAD[0]);
        while from < self.until {
            let speed = path.velocity_after(from).length();
            let end = (from + window * radius / (speed + pull)).min(self.until);
            let stretch = Stretch::new(path, from);
            let stays_off = StaysOff::new(&stretch, radius, end - from);
            still.near(stretch.x, (radius + stays_off.way) * (1.0 + 1e-9), &mut near);
            window = if near.is_empty() { 2.0 * window } else { (2.0 * window).min(AHEAD[1]) };
            let mut first: Option<(f64, Spot)> = None;
            for &other in &near {
                let mut consider = |surface: Surface, on: On| {
                    let limit = first.map_or(end, |f| f.0);
                    let touched = || sphere_on_mesh(mesh, surface, &stretch, radius, limit);
                    let entered = || match surface {
                        Surface::Face(k) if body.phase == Phase::Step => {
                            entry(&mesh.faces[k as usize], &stretch, radius)
                        }
                        _ => None,
                    };
                    let approached = |time| self.approached(mesh, surface, time);
                    if let Some(time) = touched().or_else(entered).and_then(approached)
                        && time <= limit
                        && first.is_none_or(|f| time < f.0)
                        && !self.is_held(part, still, surface, time)
                    {
                        first = Some((time, Spot { own: 0, other, mark: mark(on) }));
                    }
                };
                consider(Surface::Face(other), On::Face(0));
                for side in 0..3_u8 {
                    if let Some(edge) = still.sharp_edge(other, usize::from(side))
                        && !stays_off.line(&mesh.edges[edge as usize])
                    {
                        consider(Surface::Edge(edge), On::Edge(side));
                    }
                    let corner = mesh.faces[other as usize].corners[usize::from(side)];
                    // Each corner once: with the first of its triangles.
                    if mesh.vertex_active[corner as usize]
                        && mesh.around_vertex(corner).first() == Some(&other)
                        && !stays_off.point(mesh.vertices()[corner as usize])
                    {
                        consider(Surface::Vertex(corner), On::Corner(side));
                    }
                }
            }
            if let Some((time, spot)) = first {
                return self.strikes(time, spot.surface(part));
            }
            from = end;
        }
    }

    /// When the ball, which has reached a part of a mesh on its way, approaches it by more than rounding. A step's way
    /// leads between its ends; its velocity may approach only later, or not at all, or so slowly that nothing is
    /// struck: then the step's end has to deal with it.
    fn approached(&self, mesh: &Mesh, surface: Surface, time: f64) -> Option<f64> {
        let (path, n) = (&self.body.path, mesh.normal(surface, self.body.path.after(time)));
        let (first, change) = if self.body.phase == Phase::Step {
            let [first, last] = self.body.ends.map(|end| end.v.dot(n));
            (first, (last - first) / (self.body.expiry - path.t))
        } else {
            (path.v.dot(n), path.a.dot(n))
        };
        let slowest = if self.body.phase == Phase::Step { -self.slow } else { -UNFELT * path.v.length() };
        if first + change * time <= slowest {
            return Some(time);
        }
        let later = (slowest - first) / change;
        let is_over = || match surface {
            Surface::Face(k) => mesh.faces[k as usize].inside(path.after(later)) >= 0.0,
            _ => true,
        };
        (change < 0.0 && later > time && is_over()).then_some(later)
    }

    /// Whether a part of a mesh, reached at a time, is in lasting contact with the ball, or touched along the normal of
    /// one that is: an edge where a triangle ends or begins, a triangle in the same plane, or the one from which a step
    /// turns a ball over an edge.
    fn is_held(&self, part: u16, still: &Still, surface: Surface, time: f64) -> bool {
        let (path, is_face) = (&self.body.path, matches!(surface, Surface::Face(_)));
        if path.t + time <= path.t && (self.body.phase == Phase::Step || !is_face) {
            // What is touched now has been dealt with, or it is not a part of the surface that can be touched there.
            return true;
        }
        let Some(mesh) = still.mesh().filter(|_| matches!(self.body.phase, Phase::Step | Phase::Glide)) else {
            return false;
        };
        let is_it = |s: &Surface| match *s {
            Surface::Spot { part: p, piece, point } if p == part => {
                still.surface_of(mesh, Spot::of_surface(piece, point)).is_some_and(|held| {
                    held == surface
                        || (mesh.normal(held, path.x) - mesh.normal(surface, path.after(time))).length() <= LEAN
                })
            }
            _ => false,
        };
        self.body.touching().iter().any(is_it)
    }
}
