//! Curved tracks: the inside of an arc of a cylinder, for loops, quarter pipes, half pipes and bends.

use crate::error::{SurfaceId, WorldError};
use crate::material::Material;
use crate::shape::piece::Piece;
use crate::shape::{Convex, ConvexHull};
use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math;
use std::f64::consts::{PI, TAU};

/// Pieces of a whole turn of the back: 128. More are rounder and cost memory.
const FACES_PER_TURN: f64 = 128.0;

/// How far the pieces behind the front at least are from it, over the radius: 3e-4. No body may touch them across the
/// track; at its edges, where they are felt, a body stands that much lower.
const RECESS: f64 = 3e-4;

/// How far from a whole turn counts as one, in rad: rounding.
const WHOLE: f64 = 1e-9;

/// The form of a curved track. Along its own axes, the cylinder's axis is y, and angles are counted about it from x
/// towards z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArcForm {
    /// Radius in m of the cylinder on whose inside bodies move.
    pub radius: f64,
    /// Where it begins and ends, in rad; at −π/2 the track is below its axis.
    pub angles: [f64; 2],
    /// Its extent along y in m. It begins with its middle at y = 0.
    pub width: f64,
    /// How far in m along y its middle goes in a turn.
    pub pitch: f64,
    /// Thickness in m of what is solid behind it, and of its walls.
    pub thickness: f64,
    /// Height in m of walls along its sides, above the front; 0 for none.
    pub walls: f64,
}

/// A curved track in its place. The front is exactly the cylinder; the back, the sides and the ends are those of convex
/// pieces.
#[derive(Debug, Clone)]
pub struct ArcTrack {
    form: ArcForm,
    at: DVec3,
    turn: DMat3,
    back: DMat3,
    pub(crate) material: Material,
}

impl ArcForm {
    /// Most turns of a track. More would have too many pieces behind them.
    pub const MOST_TURNS: f64 = 100.0;

    /// Least thickness over the radius. It has to hold the pieces behind the front.
    pub const LEAST_THICKNESS: f64 = 5e-3;

    fn check(&self) -> Result<(), WorldError> {
        let bad = |field, value, expected| {
            Err(WorldError::BadSurface { surface: SurfaceId::ArcTrack, field, value, expected })
        };
        for (field, value) in [("radius", self.radius), ("width", self.width), ("thickness", self.thickness)] {
            if !(value > 0.0 && value.is_finite()) {
                return bad(field, value, "a positive length");
            }
        }
        if !(self.walls >= 0.0 && self.walls < self.radius) {
            return bad("height of its walls", self.walls, "at least 0 and less than the radius");
        }
        if self.thickness < Self::LEAST_THICKNESS * self.radius {
            return bad("thickness", self.thickness, "at least a two-hundredth of the radius");
        }
        let (turn, pitch) = (self.angles[1] - self.angles[0], self.pitch);
        if !(turn > 0.0 && turn <= Self::MOST_TURNS * TAU) {
            return bad("angle from its beginning to its end, in rad", turn, "a positive one of at most 100 turns");
        }
        if !pitch.is_finite() {
            return bad("pitch", pitch, "a finite number");
        }
        let wall = if self.walls > 0.0 { self.thickness } else { 0.0 };
        if turn > TAU + WHOLE && pitch.abs() < self.width + wall {
            return bad("pitch of more than one turn", pitch, "at least the width and a wall: the turns would overlap");
        }
        Ok(())
    }

    /// Whether it is a ring without ends.
    fn is_closed(&self) -> bool {
        self.pitch == 0.0 && (self.angles[1] - self.angles[0] - TAU).abs() <= WHOLE
    }

    /// How far its middle goes along y per radian, in m.
    fn shift(&self) -> f64 {
        self.pitch / TAU
    }

    /// Corners and triangles of the solid, as it is drawn, along its own axes about a point of its axis. Its corners
    /// are on the cylinder, so faces of the front are nearer to the axis by up to 3e-4 of the radius.
    ///
    /// # Errors
    /// [`WorldError::BadSurface`] naming the number at fault.
    pub fn solid(&self) -> Result<(Vec<DVec3>, Vec<[u32; 3]>), WorldError> {
        self.check()?;
        let section = self.section();
        let corners = (0..self.rows()).flat_map(|row| section.iter().map(move |&corner| self.at(row, corner)));
        Ok((corners.collect(), self.triangles()))
    }

    fn steps(&self) -> usize {
        ((self.angles[1] - self.angles[0]) * (FACES_PER_TURN / TAU) - WHOLE).ceil().max(2.0) as usize
    }

    /// Corners of a section across the track: distances from the axis, and places along it from the track's middle. The
    /// first two are those of the front.
    fn section(&self) -> Vec<[f64; 2]> {
        let (radius, back, half) = (self.radius, self.radius + self.thickness, 0.5 * self.width);
        if self.walls == 0.0 {
            return vec![[radius, -half], [radius, half], [back, half], [back, -half]];
        }
        let (top, side) = (radius - self.walls, half + self.thickness);
        let right = [[radius, half], [top, half], [top, side], [back, side]];
        let left = [[back, -side], [top, -side], [top, -half]];
        [&[[radius, -half]], &right[..], &left[..]].concat()
    }

    /// How many sections there are.
    fn rows(&self) -> usize {
        if self.is_closed() { self.steps() } else { self.steps() + 1 }
    }

    /// A point of a section.
    fn at(&self, row: usize, [out, side]: [f64; 2]) -> DVec3 {
        let turn = (self.angles[1] - self.angles[0]) * (row as f64 / self.steps() as f64);
        let (s, c) = math::sin_cos(self.angles[0] + turn);
        DVec3::new(out * c, self.shift() * turn + side, out * s)
    }

    fn triangles(&self) -> Vec<[u32; 3]> {
        let (steps, corners) = (self.steps() as u32, self.section().len() as u32);
        let mut triangles = Vec::new();
        let mut quad = |[a, b, c, d]: [u32; 4]| triangles.extend([[a, b, c], [a, c, d]]);
        for k in 0..steps {
            let (i, j) = (corners * k, corners * ((k + 1) % self.rows() as u32));
            for side in 0..corners {
                let next = (side + 1) % corners;
                quad([i + side, j + side, j + next, i + next]);
            }
        }
        if !self.is_closed() {
            let faces = if corners == 4 { vec![[0, 1, 2, 3]] } else { vec![[0, 1, 4, 5], [1, 2, 3, 4], [5, 6, 7, 0]] };
            for [a, b, c, d] in faces {
                quad([a, b, c, d]);
                quad([d, c, b, a].map(|corner| corners * steps + corner));
            }
        }
        triangles
    }

    /// How far inside its edges a point in front of it is, in m along the track or across it; negative beside it.
    fn inside(&self, p: DVec3) -> f64 {
        let half = 0.5 * self.width;
        let [from, to] = self.angles;
        if self.is_closed() {
            return half - p.y.abs();
        }
        let shift = self.shift();
        let across = self.radius / (self.radius * self.radius + shift * shift).sqrt();
        let angle = math::atan2(p.z, p.x);
        // Each time that it comes by here, and half a turn beyond its ends.
        let (first, last) = (((from - angle - PI) / TAU).ceil(), ((to - angle + PI) / TAU).floor());
        let mut best = f64::NEG_INFINITY;
        let mut turns = first;
        while turns <= last {
            let at = angle + TAU * turns;
            let along = (at - from).min(to - at) * self.radius;
            let beside = (half - (p.y - shift * (at - from)).abs()) * across;
            best = best.max(along.min(beside));
            turns += 1.0;
        }
        best
    }
}

impl ArcTrack {
    /// A track with a point of its axis at `at`, in m, whose axes `turn` turns into those of the world.
    ///
    /// # Errors
    /// [`WorldError::BadSurface`] naming the number at fault.
    pub fn new(form: ArcForm, at: DVec3, turn: DQuat, material: Material) -> Result<Self, WorldError> {
        form.check()?;
        let turn = DMat3::from_quat(turn.normalize());
        if !(at.is_finite() && turn.is_finite()) {
            let (field, expected) = ("place or turn", "finite numbers");
            let value = f64::NAN;
            return Err(WorldError::BadSurface { surface: SurfaceId::ArcTrack, field, value, expected });
        }
        Ok(Self { form, at, turn, back: turn.transpose(), material })
    }

    /// The convex pieces behind the front, in their places.
    pub(crate) fn pieces(&self) -> Result<Vec<Piece>, WorldError> {
        let form = &self.form;
        let half = 0.5 * (form.angles[1] - form.angles[0]) / form.steps() as f64;
        let front = form.radius * (1.0 + RECESS) / math::sin_cos(half).1;
        let (back, edge, side) = (form.radius + form.thickness, 0.5 * form.width, 0.5 * form.width + form.thickness);
        let mut bars = vec![[front, back, -edge, edge]];
        if form.walls > 0.0 {
            bars.extend([[edge, side], [-side, -edge]].map(|[a, b]| [form.radius - form.walls, back, a, b]));
        }
        let piece = |(k, [low, high, a, b]): (usize, [f64; 4])| {
            let rows = [k, (k + 1) % form.rows()];
            let corners = [[low, a], [low, b], [high, a], [high, b]];
            let corners: Vec<DVec3> = rows.iter().flat_map(|&row| corners.map(|corner| form.at(row, corner))).collect();
            let hull = ConvexHull::new(&corners, 0.0)?;
            let (at, axes) = (self.at + self.turn * hull.centre(), self.turn * DMat3::from_quat(hull.turn()));
            Ok(Convex::Hull(hull.into()).piece(at, axes))
        };
        bars.into_iter().flat_map(|bar| (0..form.steps()).map(move |k| (k, bar))).map(piece).collect()
    }

    /// Its form.
    #[must_use]
    pub fn form(&self) -> &ArcForm {
        &self.form
    }

    /// The unit vector along the cylinder's axis.
    pub(crate) fn axis(&self) -> DVec3 {
        self.turn.y_axis
    }

    /// A place along the track's own axes.
    #[inline]
    pub(crate) fn place(&self, p: DVec3) -> DVec3 {
        self.back * (p - self.at)
    }

    /// A direction along the track's own axes.
    #[inline]
    pub(crate) fn way(&self, way: DVec3) -> DVec3 {
        self.back * way
    }

    /// Unit normal out of the front below a point, towards the axis, and the point's distance from the axis.
    #[inline]
    pub(crate) fn normal(&self, p: DVec3) -> (DVec3, f64) {
        let p = self.place(p).with_y(0.0);
        let out = p.length();
        let normal = if out > 0.0 { p / -out } else { DVec3::Z };
        (self.turn * normal, out)
    }

    /// How far inside the track's edges a point in front of it is, in m; negative beside it.
    pub(crate) fn inside(&self, p: DVec3) -> f64 {
        self.form.inside(self.place(p))
    }

    /// Whether a point with this velocity, at this gap from the front, is over the track, or within `edge` of an edge
    /// and not on its way out: so what rolls on over an end is held no longer. What is deeper than half of the
    /// thickness, or than its distance from an edge, has come from elsewhere.
    pub(crate) fn is_on(&self, (p, v): (DVec3, DVec3), gap: f64, edge: f64) -> bool {
        let (inside, speed) = (self.inside(p), v.length());
        let is_before = gap >= -edge || gap > -0.5 * self.form.thickness && -gap <= inside;
        let goes_on = || speed == 0.0 || self.inside(p + v * (edge / speed)) >= inside;
        is_before && (inside > edge || inside >= -edge && goes_on())
    }

    /// Whether all that is within `reach` of a point, as long as it is in front of the track, can touch nothing else of
    /// it.
    pub(crate) fn covers(&self, p: DVec3, reach: f64) -> bool {
        let (_, out) = self.normal(p);
        // Half of the distance from the axis: seen from there, the ball around the point is at most 60° wide.
        out <= self.form.radius
            && reach < 0.5 * out
            && self.inside(p) > reach * (self.form.radius / (out - reach)).max(1.0) * (1.0 + self.slant())
    }

    /// How far the track's middle goes along the axis, over its way around it.
    fn slant(&self) -> f64 {
        (self.form.shift() / self.form.radius).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form() -> ArcForm {
        ArcForm { radius: 0.2, angles: [-0.5 * PI, 1.5 * PI], width: 0.06, pitch: 0.08, thickness: 0.01, walls: 0.0 }
    }

    /// The volume of a triangulated solid, by the divergence theorem.
    fn volume(corners: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let six = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| corners[k as usize]);
            a.dot(b.cross(c))
        };
        triangles.iter().map(six).sum::<f64>() / 6.0
    }

    #[test]
    fn the_solid_is_closed_and_has_its_volume() {
        for (pitch, angles) in [(0.08, [-0.5 * PI, 1.5 * PI]), (0.0, [0.0, TAU]), (0.0, [-1.0, 0.5])] {
            let form = ArcForm { pitch, angles, ..form() };
            let (corners, triangles) = form.solid().unwrap();
            let ring = 0.5 * (angles[1] - angles[0]) * (0.21 * 0.21 - 0.2 * 0.2) * form.width;
            // Chords: less by 1 − sin(2h)/(2h) of half a step h; 4e-4 at 128 faces a turn.
            assert!((volume(&corners, &triangles) / ring - 1.0).abs() < 5e-4);
            let (corners, more) = ArcForm { walls: 0.02, ..form }.solid().unwrap();
            let walls = (angles[1] - angles[0]) * (0.21 * 0.21 - 0.18 * 0.18) * 0.01;
            // Where the sides are twisted, halves of a face across the track are not in one plane: as much again.
            assert!((volume(&corners, &more) / (ring + walls) - 1.0).abs() < 1.2e-3);
            for faces in [triangles, more] {
                let sides = faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
                let mut edges: Vec<[u32; 2]> = sides.collect();
                edges.sort_unstable();
                assert!(edges.iter().all(|&[a, b]| edges.binary_search(&[b, a]).is_ok()));
            }
        }
    }

    #[test]
    fn a_point_is_as_far_inside_as_the_nearest_edge() {
        let form = form();
        let at = |angle: f64, y: f64| {
            let (s, c) = math::sin_cos(angle);
            DVec3::new(0.15 * c, y, 0.15 * s)
        };
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        let tilt = 0.2 / (0.2_f64 * 0.2 + (0.08 / TAU) * (0.08 / TAU)).sqrt();
        close(form.inside(at(0.0, 0.02)), 0.03 * tilt);
        close(form.inside(at(0.0, 0.0)), 0.01 * tilt);
        close(form.inside(at(-0.5 * PI + 0.01, 0.0)), 0.002);
        close(form.inside(at(-0.5 * PI - 0.01, 0.08)), 0.002);
        close(form.inside(at(-0.5 * PI - 0.01, 0.0)), -0.002);
    }

    #[test]
    fn bad_numbers_are_named() {
        let bad = [
            ArcForm { radius: 0.0, ..form() },
            ArcForm { width: f64::NAN, ..form() },
            ArcForm { thickness: 1e-6, ..form() },
            ArcForm { angles: [1.0, 1.0], ..form() },
            ArcForm { angles: [0.0, 7.0], pitch: 0.05, ..form() },
            ArcForm { pitch: f64::INFINITY, ..form() },
            ArcForm { walls: 0.2, ..form() },
        ];
        for form in bad {
            assert!(ArcTrack::new(form, DVec3::ZERO, DQuat::IDENTITY, Material(0)).is_err(), "{form:?}");
        }
    }
}
