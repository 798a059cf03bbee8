//! The same tosses, simulated: where they end, compared with the real cube.

use super::published::{self, Toss, WIDTH};
use crate::Result;
use crate::stats::Estimate;
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::material::{Law, Laws, Material};
use plaus_sim::rigid::{RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::{Accuracy, Outcome, Preset, Scratch};
use rayon::prelude::*;

/// Longest time to rest, in s: the real cube took 0.4 to 3.
const LONGEST: f64 = 20.0;

/// Conditions of all tosses.
#[derive(Debug, Clone, Copy)]
pub(super) struct Conditions {
    pub(super) preset: Preset,
    pub(super) friction: f64,
    pub(super) restitution: f64,
    /// Velocities as published, instead of those at the frame.
    pub(super) as_given: bool,
}

impl Conditions {
    pub(super) fn of(preset: Preset) -> Self {
        Self { preset, friction: published::FRICTION, restitution: published::RESTITUTION, as_given: false }
    }
}

/// Where a toss ended.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) x: DVec3,
    pub(super) turn: DQuat,
    pub(super) is_at_rest: bool,
    /// When it came to rest, in s.
    pub(super) time: f64,
}

impl End {
    /// Which face is up: an axis of the cube, and whether it points up or down.
    fn face(turn: DQuat) -> (usize, bool) {
        let up = turn.conjugate() * DVec3::Z;
        let axis = up.abs().max_position();
        (axis, up[axis] > 0.0)
    }

    pub(super) fn has_the_face_of(&self, toss: &Toss) -> bool {
        Self::face(self.turn) == Self::face(toss.end_turn)
    }

    /// Offset from the real end, along the floor, in widths.
    pub(super) fn off(&self, toss: &Toss) -> DVec3 {
        (self.x - toss.end).with_z(0.0) / WIDTH
    }

    /// Angle between the two orientations, in degrees.
    pub(super) fn turned(&self, toss: &Toss) -> f64 {
        let between = self.turn * toss.end_turn.conjugate();
        2.0 * math::atan2(between.xyz().length(), between.w.abs()).to_degrees()
    }
}

/// A floor, and the cube over it.
fn world(c: Conditions) -> Result<RigidWorld> {
    let material = Material(0);
    Ok(RigidWorld::new(RigidWorldDesc {
        bodies: vec![published::cube(material)?],
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, material)?)],
        laws: Laws::uniform(Law::new(c.friction, c.restitution))?,
        gravity: DVec3::Z * -published::GRAVITY,
        accuracy: Accuracy::preset(c.preset),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: LONGEST,
    })?)
}

/// All tosses under the same conditions; `change` is applied to each start.
pub(super) fn ends(tosses: &[Toss], c: Conditions, change: impl Fn(usize, Start) -> Start + Sync) -> Result<Vec<End>> {
    let one = |(k, toss): (usize, &Toss)| -> Result<End> {
        let world = world(c)?;
        let mut state = world.state(&[change(k, if c.as_given { toss.start } else { toss.at_the_frame() })])?;
        let outcome = world
            .run(&mut state, &mut Scratch::default(), LONGEST, &mut ())
            .map_err(|fault| format!("toss {k}: {fault:?}"))?;
        let body = world.at(0, &state.bodies()[0], state.time());
        let is_at_rest = outcome == Outcome::AllAtRest;
        Ok(End { x: body.path.x, turn: body.turn, is_at_rest, time: state.time() })
    };
    // Errors of a world cannot be passed from thread to thread directly.
    let told = |found: Result<End>| found.map_err(|error| error.to_string());
    Ok(tosses.par_iter().enumerate().map(|toss| told(one(toss))).collect::<std::result::Result<_, _>>()?)
}

/// Means over all tosses, each with its standard error.
pub(super) struct Summary {
    /// Distance from the real end, in percent of the width.
    pub(super) off: Estimate,
    /// Median distance from the real end, in percent of the width.
    pub(super) median: f64,
    /// Share with the same face up.
    pub(super) same: Estimate,
    /// Angle from the real end, in degrees: of all tosses, and of those with the same face up.
    pub(super) turned: [Estimate; 2],
    /// Distance along the floor from start to end, in widths.
    pub(super) travel: Estimate,
    /// Time to rest, in s.
    pub(super) time: Estimate,
    /// Tosses that did not come to rest.
    pub(super) restless: usize,
}

impl Summary {
    pub(super) fn of(tosses: &[Toss], ends: &[End]) -> Self {
        let pairs = || tosses.iter().zip(ends);
        let mut off: Vec<f64> = pairs().map(|(toss, end)| 100.0 * end.off(toss).length()).collect();
        let same: Vec<_> = pairs().filter(|(toss, end)| end.has_the_face_of(toss)).collect();
        let turned = |(toss, end): (&Toss, &End)| end.turned(toss);
        let travel = |(toss, end): (&Toss, &End)| (end.x - toss.start.position).with_z(0.0).length() / WIDTH;
        let mean_off = Estimate::mean(&off);
        off.sort_by(f64::total_cmp);
        Self {
            off: mean_off,
            median: off[off.len() / 2],
            same: Estimate::of(same.len(), tosses.len()),
            turned: [
                Estimate::mean(&pairs().map(turned).collect::<Vec<_>>()),
                Estimate::mean(&same.into_iter().map(turned).collect::<Vec<_>>()),
            ],
            travel: Estimate::mean(&pairs().map(travel).collect::<Vec<_>>()),
            time: Estimate::mean(&ends.iter().map(|end| end.time).collect::<Vec<_>>()),
            restless: ends.iter().filter(|end| !end.is_at_rest).count(),
        }
    }

    /// Cells of a table, without the name.
    pub(super) fn cells(&self) -> Vec<String> {
        let same = Estimate { value: 100.0 * self.same.value, error: 100.0 * self.same.error };
        vec![
            self.off.shown(),
            format!("{:.1}", self.median),
            same.shown(),
            self.turned[0].shown(),
            self.turned[1].shown(),
            self.travel.shown(),
            self.time.shown(),
            format!("{}", self.restless),
        ]
    }
}
