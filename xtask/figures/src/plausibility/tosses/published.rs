//! Tosses of a real cube, as published.

use crate::Result;
use glam::{DQuat, DVec3};
use plaus_sim::material::Material;
use plaus_sim::rigid::{BodySpec, Start};
use plaus_sim::shape::{Cuboid, MassProperties, Shape};

/// Edge of the cube in m, its mass in kg, its moment of inertia about any axis in kg m²: `BLOCK_HALF_WIDTH` and
/// `params_processed/experiment.json` of the publication, where the moment is given in kg half widths².
pub(super) const WIDTH: f64 = 0.1048;
const MASS: f64 = 0.37;
const MOMENT: f64 = 0.295_000_29 * 0.0524 * 0.0524;

/// Coefficients given by the authors.
pub(super) const FRICTION: f64 = 0.18;
pub(super) const RESTITUTION: f64 = 0.125;

/// Gravity used by the authors, in m/s²; time between frames in s.
pub(super) const GRAVITY: f64 = 9.81;
const FRAME: f64 = 1.0 / 148.0;

/// The table; its source is stated beside it.
const TABLE: &str = include_str!("../../../data/tosses/tosses.csv");

/// One toss: its first state, the pose in which it lay at the end, and since when.
#[derive(Debug, Clone, Copy)]
pub(super) struct Toss {
    /// As published: the velocity is the mean over the frame before.
    pub(super) start: Start,
    pub(super) end: DVec3,
    pub(super) end_turn: DQuat,
    /// When it came to rest, in s; it was followed for ten more frames.
    pub(super) rest: f64,
}

impl Toss {
    /// The start with its velocity at the time of the frame. The published velocities are differences of positions, so
    /// they are means over the 1/148 s before. In free fall the velocity at the frame is faster downwards by half of
    /// what gravity adds in that time.
    pub(super) fn at_the_frame(&self) -> Start {
        Start { velocity: self.start.velocity - DVec3::Z * (0.5 * GRAVITY * FRAME), ..self.start }
    }
}

/// All tosses.
pub(super) fn tosses() -> Result<Vec<Toss>> {
    TABLE.lines().skip(1).map(|line| toss(line).ok_or_else(|| format!("not a toss: {line}").into())).collect()
}

fn toss(line: &str) -> Option<Toss> {
    let n: Vec<f64> = line.split(',').map(|n| n.parse().ok()).collect::<Option<_>>()?;
    if n.len() != 22 {
        return None;
    }
    let vec = |k: usize| DVec3::new(n[k], n[k + 1], n[k + 2]);
    let turn = |k: usize| DQuat::from_xyzw(n[k + 1], n[k + 2], n[k + 3], n[k]).normalize();
    let orientation = turn(5);
    // Angular velocity is given in the body's axes.
    let start = Start {
        position: vec(2),
        orientation,
        velocity: vec(9),
        spin: orientation * vec(12),
        ..Start::at_rest(vec(2))
    };
    Some(Toss { start, end: vec(15), end_turn: turn(18), rest: n[1] - 10.0 * FRAME })
}

/// The cube: sharp corners, the stated mass and moment.
pub(super) fn cube(material: Material) -> Result<BodySpec> {
    let mass = MassProperties { mass: MASS, inertia: DVec3::splat(MOMENT) };
    Ok(BodySpec { shape: Shape::Cuboid(Cuboid::new(DVec3::splat(WIDTH), 0.0)?), mass, material })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_tosses_start_in_the_air_and_end_on_a_face() {
        let tosses = tosses().expect("a sound table");
        assert_eq!(tosses.len(), 570);
        for (k, toss) in tosses.iter().enumerate() {
            let low = |x: DVec3, turn: DQuat| {
                let up = (turn.conjugate() * DVec3::Z).abs();
                x.z - 0.5 * WIDTH * (up.x + up.y + up.z)
            };
            assert!(low(toss.start.position, toss.start.orientation) > 0.0, "toss {k} starts below the floor");
            // Markers place the floor a millimetre too high, as the authors remark.
            assert!(low(toss.end, toss.end_turn).abs() < 0.004, "toss {k} ends above the floor");
            let up = (toss.end_turn.conjugate() * DVec3::Z).abs().max_element();
            assert!(up > 0.998, "toss {k} does not end on a face: {up}");
            assert!((0.2..4.0).contains(&toss.rest), "toss {k} takes {} s", toss.rest);
        }
    }
}
