//! The visible parts of the table: its bumps where the dice are, the spill, and marks where dice should come to rest.

use super::constraint::Constraint;
use super::{Dice, Draw, Field};
use crate::animation::upright;
use crate::animation::{Form, Look, Material, Prop};
use crate::uneven::{FINE, relief};
use glam::DVec3;
use plaus_dist::math;
use plaus_sim::WorldError;
use plaus_sim::field::Spline;

/// How far around the dice's paths the table's bumps are drawn, in m.
pub(super) const ROOM: f64 = 0.03;
/// Most rings of a puddle, and most corners around it.
const MOST: [f64; 2] = [64.0, 192.0];
/// How far a puddle is above the table, in m.
const FILM: f64 = 1e-4;

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
    let spacing = plan.surface.spacing();
    let patch = Patch::new([low, high].map(|end| [end.x, end.y]), [x, y], spacing / FINE, deep);
    let height = |x: f64, y: f64| patch.height([x, y], || height(x, y));
    if deep > 0.0 {
        props.push(Prop::new("surface", Look::FELT, relief(patch.ends, spacing, height)));
    }
    let spilt = scene.config.spilt;
    if spilt.radius_mm > 0.0 {
        props.push(puddle([spilt.x_mm, spilt.y_mm, spilt.radius_mm].map(|mm| mm * 1e-3), spacing / FINE, height));
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

/// Where the table is drawn with its bumps. Towards its borders it goes down to the top of the block around it: a step
/// or a gap there would show as a dark line.
struct Patch {
    /// Its least and greatest coordinates.
    ends: [[f64; 2]; 2],
    /// Over which width it goes down at each of them.
    wide: [[f64; 2]; 2],
    /// How far below the table's mean height the block's top is.
    deep: f64,
}

impl Patch {
    /// Between two corners, but not beyond the `edge` of the table; heights are drawn `step` apart.
    fn new([low, high]: [[f64; 2]; 2], edge: [f64; 2], step: f64, deep: f64) -> Self {
        let is_cut = |end: f64, axis: usize| end.abs() > edge[axis];
        let wide = |end: [f64; 2]| [0, 1].map(|axis| if is_cut(end[axis], axis) { step } else { 0.5 * ROOM });
        let within = |end: [f64; 2]| [0, 1].map(|axis| end[axis].clamp(-edge[axis], edge[axis]));
        Self { ends: [within(low), within(high)], wide: [wide(low), wide(high)], deep }
    }

    /// The height that is drawn at a place where the table has that of its `own`.
    fn height(&self, at: [f64; 2], own: impl Fn() -> f64) -> f64 {
        let side = |side: usize, axis: usize| (at[axis] - self.ends[side][axis]).abs() / self.wide[side][axis];
        let is_inside = |axis: usize| at[axis] > self.ends[0][axis] && at[axis] < self.ends[1][axis];
        if self.deep == 0.0 || !is_inside(0) || !is_inside(1) {
            return -self.deep;
        }
        let share = (0..4).map(|k| side(k / 2, k % 2)).fold(1.0, f64::min);
        -self.deep + share * share * (3.0 - 2.0 * share) * (own() + self.deep)
    }
}

/// A thin film over a disc, draped over the table: rings whose corners are about `step` apart.
fn puddle([x, y, radius]: [f64; 3], step: f64, height: impl Fn(f64, f64) -> f64) -> Prop {
    let rings = (radius / step).ceil().clamp(1.0, MOST[0]) as u32;
    let corners = (std::f64::consts::TAU * radius / step).ceil().clamp(48.0, MOST[1]) as u32;
    let above = |x: f64, y: f64| upright(DVec3::new(x, y, height(x, y) + FILM));
    let mut vertices = vec![above(x, y)];
    for (ring, k) in (1..=rings).flat_map(|ring| (0..corners).map(move |k| (ring, k))) {
        let (sin, cos) = math::sin_cos(std::f64::consts::TAU * f64::from(k) / f64::from(corners));
        let out = radius * f64::from(ring) / f64::from(rings);
        vertices.push(above(x + out * cos, y + out * sin));
    }
    let mut triangles = Vec::new();
    for (k, next) in (0..corners).map(|k| (1 + k, 1 + (k + 1) % corners)) {
        triangles.push([0, k, next]);
        for inner in (0..rings - 1).map(|ring| ring * corners) {
            let (inner, outer) = ([k + inner, next + inner], [k + inner + corners, next + inner + corners]);
            triangles.extend([[inner[0], outer[0], outer[1]], [inner[0], outer[1], inner[1]]]);
        }
    }
    Prop::new("spilt", Look::new([214, 160, 60], Material::Glass), Form::Mesh { vertices, triangles })
}
