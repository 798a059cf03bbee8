//! Twelve convex polyhedra that fall into a bowl of triangles.

use super::coin::anyhow;
use crate::peer::{Cast, Pose, cast};
use crate::staged::Setting;
use crate::world::{Outcome, Reading};
use glam::DVec3;
use plaus_dist::{Purpose, Seed, Stream, math, open_unit};
use plaus_figures::Result;
use plaus_sim::rigid::{BodySpec, Start, StaticShape};
use plaus_sim::scenery::Mesh;
use plaus_sim::shape::{ConvexHull, Shape};
use plaus_sim::{Law, Material};
use rapier3d_f64::prelude::ColliderBuilder;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

const COUNT: usize = 12;
const CORNERS: usize = 30;
/// Half axes of the ellipsoid on which corners lie, in m.
const HALF: DVec3 = DVec3::new(0.022, 0.018, 0.014);
/// Radius of the bowl in m, and its facets up to the rim and around.
const BOWL: f64 = 0.12;
const FACETS: [usize; 2] = [12, 32];
/// Layers in which a body can end, in m.
const LAYER: f64 = 0.015;
const LAYERS: usize = 8;

pub(crate) struct Bowl;

/// Corners spread over an ellipsoid, each a little off its place.
fn corners() -> Vec<DVec3> {
    let mut stream = Seed(11).chain(0).at(0, Purpose::START);
    let golden = TAU * 0.381_966_011_250_105;
    let corner = |k: usize| {
        let z = 1.0 - (2 * k + 1) as f64 / CORNERS as f64;
        let (s, c) = math::sin_cos(golden * k as f64 + 0.2 * open_unit(&mut stream));
        let r = (1.0 - z * z).sqrt();
        HALF * DVec3::new(r * c, r * s, z)
    };
    (0..CORNERS).map(corner).collect()
}

/// The inside of a half ball, as corners and triangles that face inwards.
fn bowl() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let [up, around] = FACETS;
    let mut points = vec![DVec3::ZERO];
    for i in 1..=up {
        let (s, c) = math::sin_cos(FRAC_PI_2 * i as f64 / up as f64);
        points.extend((0..around).map(|j| {
            let (y, x) = math::sin_cos(TAU * j as f64 / around as f64);
            BOWL * DVec3::new(s * x, s * y, 1.0 - c)
        }));
    }
    let at = |i: usize, j: usize| if i == 0 { 0 } else { (1 + (i - 1) * around + j % around) as u32 };
    let mut triangles = Vec::new();
    for j in 0..around {
        for i in 0..up {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            if i > 0 {
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    (points, triangles)
}

impl Setting for Bowl {
    fn name(&self) -> &'static str {
        "bowl"
    }

    fn title(&self) -> &'static str {
        "Twelve hulls into a bowl"
    }

    fn about(&self) -> String {
        "Twelve convex hulls of 30 corners, about 36 mm across, turned anyhow, from 0.16 m and higher into a bowl of \
         736 triangles and 120 mm radius; friction 0.4, restitution 0.3. Read: the layer, 15 mm high, in which each \
         body ends, 8 where it is out of the bowl; how many are inside."
            .into()
    }

    fn cast(&self) -> Result<Cast> {
        let hull = ConvexHull::new(&corners(), 0.0)?;
        let theirs = cast::hull(hull.corners()).ok_or("corners without a hull")?;
        let (points, triangles) = bowl();
        let faces: Vec<_> = triangles.iter().map(|&t| (t, Material(0))).collect();
        let mesh = Mesh::new(points.clone(), &faces, 0.0)?;
        let spec = BodySpec::solid(Shape::Hull(Arc::new(hull)), 1000.0, Material(0));
        Ok(Cast {
            bodies: vec![(spec, ColliderBuilder::new(theirs)); COUNT],
            parts: vec![
                (StaticShape::Mesh(Arc::new(mesh)), cast::mesh(&points, &triangles)?),
                // What falls beside the bowl ends below it.
                cast::floor(-0.05)?,
            ],
            law: Law::new(0.4, 0.3),
            joints: Vec::new(),
            size: HALF.z,
        })
    }

    fn starts(&self, stream: &mut Stream) -> Vec<Start> {
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(stream);
        let mut three = |most: f64| DVec3::new(between(-most, most), between(-most, most), between(-most, most));
        let start = |k: usize| {
            // Four to a layer.
            let (y, x) = math::sin_cos(FRAC_PI_2 * (k % 4) as f64);
            let place = DVec3::new(0.045 * x, 0.045 * y, 0.16 + 0.06 * (k / 4) as f64);
            let orientation = anyhow(three(3.0));
            Start { position: place + three(0.006), orientation, spin: three(5.0), ..Start::at_rest(place) }
        };
        (0..COUNT).map(start).collect()
    }

    fn readings(&self) -> Vec<Reading> {
        let inside = Reading { name: "inside", categories: COUNT + 1 };
        vec![Reading { name: "layer of a body", categories: LAYERS + 1 }, inside]
    }

    fn read(&self, ends: &[Pose]) -> Outcome {
        let layer = |x: DVec3| {
            let is_in = x.z > 0.0 && x.truncate().length() < BOWL;
            if is_in { ((x.z / LAYER) as usize).min(LAYERS - 1) as u16 } else { LAYERS as u16 }
        };
        let layers: Vec<u16> = ends.iter().map(|(x, _)| layer(*x)).collect();
        let inside = layers.iter().filter(|&&layer| usize::from(layer) < LAYERS).count();
        vec![layers, vec![inside as u16]]
    }

    fn tolerance(&self) -> f64 {
        0.1 * HALF.z
    }

    fn duration(&self) -> f64 {
        6.0
    }

    fn patience(&self) -> f64 {
        3.0
    }
}
