//! A thick coin tossed onto a floor.

use crate::peer::cast::{cylinder, floor};
use crate::peer::{Cast, Pose};
use crate::staged::Setting;
use crate::world::{Outcome, Reading};
use glam::{DQuat, DVec3};
use plaus_dist::{Stream, open_unit};
use plaus_figures::Result;
use plaus_sim::rigid::{BodySpec, Start};
use plaus_sim::shape::Frustum;
use plaus_sim::{Law, Material};

const RADIUS: f64 = 0.012;
/// Thickness over diameter: thick enough to end on its edge now and then.
const RATIO: f64 = 0.35;

pub(crate) struct Coin;

impl Setting for Coin {
    fn name(&self) -> &'static str {
        "coin"
    }

    fn title(&self) -> &'static str {
        "A thick coin"
    }

    fn about(&self) -> String {
        format!(
            "A cylinder of radius 12 mm and {RATIO} of its diameter thick, from 0.2 to 0.4 m, at up to 0.5 m/s and \
             30 rad/s an axis, at a random orientation, onto a floor with friction 0.3 and restitution 0.4; ours has a \
             resistance to rolling of 0.05 besides, which the peer does not know. Read: heads, tails or \
             edge."
        )
    }

    fn cast(&self) -> Result<Cast> {
        let height = 2.0 * RADIUS * RATIO;
        let spec = BodySpec::solid(Frustum::cylinder(RADIUS, height)?.into(), 8000.0, Material(0));
        Ok(Cast {
            bodies: vec![(spec, cylinder(RADIUS, height))],
            parts: vec![floor(0.0)?],
            law: Law::new(0.3, 0.4).with_resistance(0.05, 0.05),
            joints: Vec::new(),
            size: 0.5 * height,
        })
    }

    fn starts(&self, stream: &mut Stream) -> Vec<Start> {
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(stream);
        let mut three = |most: f64| DVec3::new(between(-most, most), between(-most, most), between(-most, most));
        let (velocity, spin, place, turn) = (three(0.5), three(30.0), three(0.1), three(3.0));
        let position = DVec3::new(0.0, 0.0, 0.3 + place.z);
        vec![Start { position, velocity, spin, orientation: anyhow(turn), time: 0.0 }]
    }

    fn readings(&self) -> Vec<Reading> {
        vec![Reading { name: "side up", categories: 3 }]
    }

    fn read(&self, ends: &[Pose]) -> Outcome {
        let up = (ends[0].1 * DVec3::Z).z;
        vec![vec![if up > 0.7 { 0 } else { u16::from(up > -0.7) + 1 }]]
    }

    fn tolerance(&self) -> f64 {
        0.1 * RADIUS
    }

    fn duration(&self) -> f64 {
        10.0
    }
}

/// A rotation by a vector of angles: its axis and angle.
pub(super) fn anyhow(angles: DVec3) -> DQuat {
    DQuat::from_scaled_axis(angles)
}
