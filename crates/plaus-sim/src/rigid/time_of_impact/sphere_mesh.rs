//! When a ball first touches the triangles of a mesh: in closed form, as for marbles.

use super::static_search::StaticTimeOfImpact;
use crate::detect::{Stretch, sphere_on_mesh};
use crate::rigid::body_state::Phase;
use crate::rigid::narrow_phase::contact_id::ContactId;
use crate::rigid::narrow_phase::sphere_mesh::mark;
use crate::rigid::narrow_phase::static_collider::StaticCollider;
use crate::rigid::tolerances::{APPROACH_ROUNDING, EDGE_LEAN, MESH_LOOKAHEAD};
use crate::scenery::{Edge, Face, Mesh, Surface};
use crate::shape::On;
use glam::DVec3;

/// A quick test for what a ball cannot reach within a stretch. The square of a distance has at least the second
/// derivative −2 · distance · acceleration.
struct StaysOff<'s> {
    stretch: &'s Stretch<'s>,
    square: f64,
    time: f64,
    /// Acceleration times the square of the time, and the longest way.
    gravity: f64,
    pub(crate) way: f64,
}

impl<'s> StaysOff<'s> {
    fn new(stretch: &'s Stretch<'s>, radius: f64, time: f64) -> Self {
        let gravity = stretch.path.a.length() * time * time;
        Self { stretch, square: radius * radius, time, gravity, way: stretch.v.length() * time + 0.5 * gravity }
    }

    /// For a distance whose square is this, and changes at this rate.
    fn is_off(&self, squared: f64, rate: f64) -> bool {
        squared - self.square + (rate * self.time).min(0.0) > (squared.sqrt() + self.way) * self.gravity
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
    let is_over = || face.sides.iter().all(|&(inward, offset)| inward.dot(there) - offset >= -EDGE_LEAN * radius);
    (is_near && is_over()).then_some(stretch.from + latest)
}

impl StaticTimeOfImpact<'_> {
    /// First contact of a ball with a mesh.
    pub(crate) fn ball(&mut self, part: u16, collider: &StaticCollider, mesh: &Mesh) {
        let (spec, body) = (self.spec, self.body);
        let (path, radius) = (&body.path, spec.bounding_radius + spec.gap);
        let gravity = (path.a.length() * radius).sqrt();
        let (mut near, mut from, mut window) = (Vec::new(), 0.0, MESH_LOOKAHEAD[0]);
        while from < self.until {
            let speed = path.velocity_after(from).length();
            let end = (from + window * radius / (speed + gravity)).min(self.until);
            let stretch = Stretch::new(path, from);
            let stays_off = StaysOff::new(&stretch, radius, end - from);
            collider.near(stretch.x, (radius + stays_off.way) * (1.0 + 1e-9), &mut near);
            window = if near.is_empty() { 2.0 * window } else { (2.0 * window).min(MESH_LOOKAHEAD[1]) };
            let mut first: Option<(f64, ContactId)> = None;
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
                        && !self.is_held(part, collider, surface, time)
                    {
                        first = Some((time, ContactId { own: 0, other, mark: mark(on) }));
                    }
                };
                consider(Surface::Face(other), On::Face(0));
                for side in 0..3_u8 {
                    if let Some(edge) = collider.sharp_edge(other, usize::from(side))
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
            if let Some((time, id)) = first {
                return self.strikes(time, id.surface(part));
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
        let slowest = if self.body.phase == Phase::Step { -self.slow } else { -APPROACH_ROUNDING * path.v.length() };
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
    fn is_held(&self, part: u16, collider: &StaticCollider, surface: Surface, time: f64) -> bool {
        let (path, is_face) = (&self.body.path, matches!(surface, Surface::Face(_)));
        if path.t + time <= path.t && (self.body.phase == Phase::Step || !is_face) {
            // What is touched now has been dealt with, or it is not a part of the surface that can be touched there.
            return true;
        }
        let Some(mesh) = collider.mesh().filter(|_| matches!(self.body.phase, Phase::Step | Phase::Glide)) else {
            return false;
        };
        let is_it = |s: &Surface| match *s {
            Surface::Spot { part: p, piece, point } if p == part => {
                collider.surface_of(mesh, ContactId::of_surface(piece, point)).is_some_and(|held| {
                    held == surface
                        || (mesh.normal(held, path.x) - mesh.normal(surface, path.after(time))).length() <= EDGE_LEAN
                })
            }
            _ => false,
        };
        self.body.touching().iter().any(is_it)
    }
}
