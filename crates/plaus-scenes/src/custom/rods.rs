//! What is drawn of joints: rods and strings from them to what they hold.

use super::plan::{Built, Plan};
use super::solids::Made;
use super::values::{Drawn, Numbers};
use crate::animation::{Shape, Track};
use glam::{DQuat, DVec3};
use plaus_dist::math::sin_cos;
use plaus_sim::rigid::Start;
use std::f64::consts::TAU;

/// Sides of a drawn rod.
const SIDES: u32 = 8;

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
            let Some(radius) = bond.drawn else { return Vec::new() };
            let ends = bond.anchors(&numbers, &built.there, &starts);
            let rod = |(nth, (body, anchor)): (usize, (usize, DVec3))| {
                let end = built.shapes[body].axes * anchor;
                let name = if nth == 0 { bond.name.clone() } else { format!("{}_to", bond.name) };
                let track = tracks.iter().find(|track| track.name == self.bodies[built.there[body]].name)?;
                (end.length() > radius).then(|| Track { name, shape: rod(end, radius), ..track.clone() })
            };
            ends.into_iter().enumerate().filter_map(rod).collect()
        };
        self.joints.iter().flat_map(of).collect()
    }
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
