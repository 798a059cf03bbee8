//! What is drawn of joints: rods and strings from them to what they hold.

use super::engine::Engine;
use super::plan::{Built, Plan};
use super::shapes::Made;
use super::values::{Drawn, Numbers};
use crate::animation::{Piece, Shape, Track, Turn, upright};
use glam::{DQuat, DVec3};
use plaus_dist::math::sin_cos;
use plaus_sim::rigid::Start;
use plaus_sim::trace::Trace;
use std::f64::consts::TAU;

/// Sides of a drawn rod.
const SIDES: u32 = 8;

/// Least time in s between two places of a string that is drawn, and the most of them: of long motions, places are
/// farther between.
const BETWEEN: f64 = 1.0 / 120.0;
const MOST_PLACES: f64 = 3600.0;

/// How many rods a string is drawn as: its free part becomes longer and shorter, and rods do not.
const RODS: u32 = 16;

impl Plan {
    /// How the bodies that are there start by their own keys, which joints go by.
    pub(super) fn own_starts(&self, numbers: &Numbers<'_>, there: &[usize], shapes: &[Made]) -> Vec<Start> {
        there.iter().zip(shapes).map(|(&index, made)| self.bodies[index].own_start(numbers, made)).collect()
    }

    /// The rods of a draw, which move with their bodies; `tracks` are those of the bodies that appeared.
    pub(super) fn rods(&self, draw: &Drawn, built: &Built, tracks: &[Track]) -> Vec<Track> {
        let numbers = self.works.numbers(Some(draw));
        let starts = self.own_starts(&numbers, &built.there, &built.shapes);
        let of = |bond: &super::joints::Bond| {
            let Some(radius) = bond.drawn.filter(|_| !bond.is_string()) else { return Vec::new() };
            let ends = bond.anchors(&numbers, &built.there, &starts);
            let rod = |(nth, (body, anchor)): (usize, (usize, DVec3))| {
                let end = built.shapes[body].axes * anchor;
                let name = if nth == 0 { bond.name.clone() } else { format!("{}_to", bond.name) };
                let track = tracks.iter().find(|track| track.name == self.bodies[built.there[body]].name)?;
                (end.length() > radius).then(|| Track { name, shape: rod(end, radius).into(), ..track.clone() })
            };
            ends.into_iter().enumerate().filter_map(rod).collect()
        };
        self.joints.iter().flat_map(of).collect()
    }
}

/// The rods as which strings are drawn, which move along with their ends; `tracks` are those of the bodies that
/// appeared. Of a string that is broken, what is left moves with its first body.
pub(super) fn strings<E: Engine>(
    plan: &Plan,
    (engine, built): (&E, &Built),
    trace: &Trace<E::Body>,
    tracks: &[Track],
    end: f64,
) -> Vec<Track> {
    let mut all = Vec::new();
    for (number, bond) in plan.joints.iter().enumerate() {
        let Some(radius) = bond.drawn.filter(|_| bond.is_string()) else { continue };
        let name = &plan.bodies[bond.body].name;
        let Some(track) = tracks.iter().find(|track| track.name == *name) else { continue };
        let broken = bond.breaks(engine, number, &built.there, trace).unwrap_or(f64::INFINITY);
        let between = BETWEEN.max(end / MOST_PLACES);
        let count = (end / between).ceil().max(1.0);
        let times: Vec<f64> = (0..=count as u32).map(|k| (f64::from(k) * between).min(end)).collect();
        let place = |time: f64| {
            let held = time.min(broken);
            let [from, to] = engine.string(number, trace, held)?.map(upright);
            let turn = track.orientation(time) * track.orientation(held).conjugate();
            let moved =
                |x: DVec3| if time > held { track.position(time) + turn * (x - track.position(held)) } else { x };
            Some([moved(from), moved(to)])
        };
        let places: Vec<[DVec3; 2]> = times.iter().map_while(|&time| place(time)).collect();
        let longest = places.iter().map(|[from, to]| (*to - *from).length()).fold(0.0, f64::max);
        let part = longest / f64::from(RODS);
        if part > 0.0 {
            let rods = (0..RODS).map(|k| {
                let name = if k == 0 { bond.name.clone() } else { format!("{}_rod_{}", bond.name, k + 1) };
                let share = f64::from(k) / f64::from(RODS - 1);
                let pieces = pieces(&times, &places, (part, share));
                Track { name, shape: rod(DVec3::Z * part, radius).into(), pieces, origin: DVec3::ZERO, ..track.clone() }
            });
            all.extend(rods);
        }
    }
    all
}

/// The motion of a rod of this length: of the way along which it can lie between the ends of a string, it begins after
/// this share.
fn pieces(times: &[f64], places: &[[DVec3; 2]], (part, share): (f64, f64)) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::with_capacity(places.len());
    let mut last = (DVec3::Z, DQuat::IDENTITY);
    for (&time, [from, to]) in times.iter().zip(places) {
        let way = *to - *from;
        let along = way.try_normalize().unwrap_or(last.0);
        let turn = (DQuat::from_rotation_arc(last.0, along) * last.1).normalize();
        let position = *from + along * ((way.length() - part) * share);
        last = (along, turn);
        if let Some(piece) = pieces.last_mut() {
            let dt = time - piece.start;
            if dt <= 0.0 {
                continue;
            }
            piece.velocity = (position - piece.position) / dt;
            piece.turn = piece.turn.reaching(turn, dt);
        }
        pieces.push(Piece::resting(time, position).turning(Turn::still(turn)));
    }
    pieces.dedup_by(|next, piece| next.rests() && piece.rests());
    pieces
}

/// A rod from the origin to a point.
fn rod(end: DVec3, radius: f64) -> Shape {
    let turn = DQuat::from_rotation_arc(DVec3::Z, end.normalize());
    let corner = |k: u32| {
        let (sin, cos) = sin_cos(TAU * f64::from(k / 2) / f64::from(SIDES));
        turn * DVec3::new(radius * cos, radius * sin, if k.is_multiple_of(2) { 0.0 } else { end.length() })
    };
    let vertices = (0..2 * SIDES).map(corner).collect();
    let side = |k: u32| {
        let [a, b, c, d] = [2 * k, 2 * k + 1, (2 * k + 2) % (2 * SIDES), (2 * k + 3) % (2 * SIDES)];
        [[a, c, b], [b, c, d]]
    };
    let ends = (1..SIDES - 1).flat_map(|k| [[0, 2 * k + 2, 2 * k], [1, 2 * k + 1, 2 * k + 3]]);
    Shape::Solid { vertices, triangles: (0..SIDES).flat_map(side).chain(ends).collect() }
}
