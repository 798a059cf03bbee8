//! The visible parts of the table: its bumps where the dice are, the spill, and marks where dice should come to rest.

use super::constraint::Constraint;
use super::{Dice, Draw, Field};
use crate::animation::upright;
use crate::animation::{Form, Look, Material, Prop};
use crate::uneven::relief;
use glam::DVec3;
use plaus_dist::math;
use plaus_sim::WorldError;
use plaus_sim::field::Spline;

/// Corners around a puddle.
const CORNERS: u32 = 48;

/// All scenery, in metres. The table is drawn with its bumps between two corners of a box; if every die has its own
/// table, each place shows the table of the nearest die.
pub(super) fn props(scene: &Dice, draw: &Draw, [low, high]: [DVec3; 2]) -> Result<Vec<Prop>, WorldError> {
    let plan = &scene.plan;
    let mut props = Vec::new();
    let [x, y] = plan.looking.edge;
    let deep = plan.surface.highest();
    // Under the deepest dent, so that it never shows through.
    let thick = 0.02;
    props.push(Prop::block(
        "table",
        Look::FELT,
        upright(DVec3::new(0.0, 0.0, -deep - thick)),
        upright(DVec3::new(x, y, thick)).abs(),
    ));
    let heights: Vec<Spline> =
        draw.tables.iter().map(|table| plan.surface.spline(Field::Height, table)).collect::<Result<_, _>>()?;
    let height = |x: f64, y: f64| {
        let far = |die: usize| {
            let place = plan.places[die].unwrap_or([0.0; 2]);
            math::square(place[0] - x) + math::square(place[1] - y)
        };
        let nearest = (1..heights.len()).fold(0, |best, die| if far(die) < far(best) { die } else { best });
        let offset = scene.offset(draw, nearest);
        heights[nearest].value(x - offset.x, y - offset.y)
    };
    if deep > 0.0 {
        let low = [low.x.max(-x), low.y.max(-y)];
        let high = [high.x.min(x), high.y.min(y)];
        props.push(Prop::new("surface", Look::FELT, relief([low, high], plan.surface.spacing(), height)));
    }
    let spilt = scene.config.spilt;
    if spilt.radius_mm > 0.0 {
        props.push(puddle([spilt.x_mm, spilt.y_mm, spilt.radius_mm].map(|mm| mm * 1e-3), height));
    }
    for (k, demand) in plan.demands.iter().enumerate() {
        if let Constraint::RestAt(at) = &demand.constraint {
            let (centre, wide) = (DVec3::new(at.x_mm, at.y_mm, 0.0) * 1e-3, at.within_mm * 1e-3);
            let half = DVec3::new(wide, wide, deep + 2e-4);
            props.push(Prop::target(format!("target_{}", k + 1), upright(centre), upright(half).abs()));
        }
    }
    Ok(props)
}

/// A thin film over a disc.
fn puddle([x, y, radius]: [f64; 3], height: impl Fn(f64, f64) -> f64) -> Prop {
    let above = |x: f64, y: f64| upright(DVec3::new(x, y, height(x, y) + 1e-4));
    let mut vertices = vec![above(x, y)];
    for k in 0..CORNERS {
        let (sin, cos) = math::sin_cos(std::f64::consts::TAU * f64::from(k) / f64::from(CORNERS));
        vertices.push(above(x + radius * cos, y + radius * sin));
    }
    let triangles = (0..CORNERS).map(|k| [0, 1 + k, 1 + (k + 1) % CORNERS]).collect();
    Prop::new("spilt", Look::new([214, 160, 60], Material::Glass), Form::Mesh { vertices, triangles })
}
