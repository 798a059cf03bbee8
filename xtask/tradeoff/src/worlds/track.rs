//! A ball that rolls down a winding track of 20,000 triangles.

use crate::peer::{Cast, Pose, cast};
use crate::staged::Setting;
use crate::world::{Outcome, Reading};
use glam::{DQuat, DVec3};
use plaus_dist::{Stream, math, open_unit};
use plaus_figures::Result;
use plaus_sim::rigid::{BodySpec, Start, StaticShape};
use plaus_sim::scenery::Heights;
use plaus_sim::shape::Shape;
use plaus_sim::{Law, Material};
use std::sync::Arc;

const RADIUS: f64 = 0.01;
/// Cells along the track and across it: two triangles each.
const CELLS: [usize; 2] = [1000, 10];
/// Distance of points along the track and across it, in m.
const SPACING: [f64; 2] = [0.004, 0.008];
/// The track falls by this much of its length; its bottom winds by this much to each side, so often in a metre; and its
/// cross section has this radius of curvature. Lengths in m.
const FALL: f64 = 0.04;
const WINDING: f64 = 0.012;
const RATE: f64 = 10.0;
const HOLLOW: f64 = 0.06;
/// Strips along the track and across it in which the ball can end.
const STRIP: f64 = 0.05;
const STRIPS: usize = 80;

pub(crate) struct Track;

/// Height of the surface that the triangles follow, `x` along the track.
fn height(x: f64, y: f64) -> f64 {
    let off = y - WINDING * math::sin_cos(RATE * x).0;
    0.5 * off * off / HOLLOW - FALL * x
}

fn start_of_track() -> f64 {
    -0.5 * CELLS[0] as f64 * SPACING[0]
}

fn heights() -> Result<Heights> {
    let at = |k: usize, axis: usize| (k as f64 - 0.5 * CELLS[axis] as f64) * SPACING[axis];
    let row = |j: usize| (0..=CELLS[0]).map(|i| height(at(i, 0), at(j, 1))).collect();
    Ok(Heights::new(SPACING, &(0..=CELLS[1]).map(row).collect::<Vec<_>>())?)
}

impl Setting for Track {
    fn name(&self) -> &'static str {
        "track"
    }

    fn title(&self) -> &'static str {
        "A ball on a track"
    }

    fn about(&self) -> String {
        "A ball of radius 10 mm rolls from rest down a winding, hollow track of 20,000 triangles, 4 m long, that falls \
         by 4 %; it is let go up to 15 mm off the middle, 1 mm above the track; friction 0.3, restitution 0.2, no \
         resistance to rolling. Read: where along the track it is after 5 s, in strips of 50 mm; on which side of it."
            .into()
    }

    fn cast(&self) -> Result<Cast> {
        let heights = heights()?;
        let (corners, triangles) = heights.triangles();
        let mesh = heights.mesh(DVec3::ZERO, DQuat::IDENTITY, Material(0))?;
        let ball = BodySpec::solid(Shape::Ball(RADIUS), 2500.0, Material(0));
        Ok(Cast {
            bodies: vec![(ball, rapier3d_f64::prelude::ColliderBuilder::ball(RADIUS))],
            parts: vec![(StaticShape::Mesh(Arc::new(mesh)), cast::mesh(&corners, &triangles)?)],
            law: Law::new(0.3, 0.2),
            joints: Vec::new(),
            size: RADIUS,
        })
    }

    fn starts(&self, stream: &mut Stream) -> Vec<Start> {
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(stream);
        let x = start_of_track() + between(0.05, 0.1);
        let y = WINDING * math::sin_cos(RATE * x).0 + between(-0.015, 0.015);
        // The surface is no steeper across than a quarter: 1.1 radii above it are free of it.
        vec![Start::at_rest(DVec3::new(x, y, height(x, y) + 1.1 * RADIUS + 0.0005))]
    }

    fn readings(&self) -> Vec<Reading> {
        vec![Reading { name: "place along", categories: STRIPS }, Reading { name: "side", categories: 2 }]
    }

    fn read(&self, ends: &[Pose]) -> Outcome {
        let at = ends[0].0;
        let strip = (((at.x - start_of_track()) / STRIP).max(0.0) as usize).min(STRIPS - 1);
        let side = at.y > WINDING * math::sin_cos(RATE * at.x).0;
        vec![vec![strip as u16], vec![u16::from(side)]]
    }

    fn tolerance(&self) -> f64 {
        0.1 * RADIUS
    }

    fn duration(&self) -> f64 {
        5.0
    }
}
