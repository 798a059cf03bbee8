//! The animation of a draw: a disc over a table, with the random normal at each bounce shown as a small slanted plate.

use super::flight::{self, Table};
use super::{Config, GRAVITY, Normals};
use crate::animation::{Animation, Form, Impact, Look, Material, Piece, Prop, Shape, Track, View};
use glam::{DQuat, DVec3};
use plaus_mcmc::ModelError;

/// Half the lengths of the slanted plates, in D.
const PLATE: DVec3 = DVec3::new(0.22, 0.02, 0.45);
/// Thickness of the coin that shows the ball, in D.
const THICK: f64 = 0.3;
/// Density in kg/m³ of the ball as shown, that of rubber; only the impulses of its impacts depend on it.
pub(super) const DENSITY: f64 = 1100.0;
/// How far the table reaches beyond drop and target, in D.
const MARGIN: f64 = 4.0;
/// Half the table's thickness and half its depth, in D.
const TABLE: [f64; 2] = [0.2, 1.5];

pub(super) fn animate(config: &Config, table: &Table, draw: &Normals) -> Result<Animation, ModelError> {
    let size = config.diameter_m;
    let height = config.drop_height;
    // With lengths in D and gravity 1, the unit of time is √(D/g), that of speed √(D·g).
    let (second, speed) = ((size / GRAVITY).sqrt(), (size * GRAVITY).sqrt());
    let gravity = DVec3::new(0.0, -GRAVITY, 0.0);
    let mass = DENSITY * 0.25 * std::f64::consts::PI * THICK * size * size * size;
    // Collisions are the point's at the ball's bottom; the body's origin is its middle.
    let middle = |x: f64, y: f64| DVec3::new(x * size, (y + 0.5) * size, 0.0);
    let mut pieces = vec![Piece::ballistic(0.0, middle(0.0, height), DVec3::ZERO, gravity)];
    let (mut impacts, mut scenery) = (Vec::new(), scenery(config));
    let mut time = (2.0 * height).sqrt();
    let mut incoming = flight::fallen(height);
    let rest = flight::fly(table, height, draw.directions(), |x, normal, bounce| {
        let start = time * second;
        pieces.push(Piece::ballistic(start, middle(x, 0.0), (bounce.velocity * speed).extend(0.0), gravity));
        let approach = -incoming.dot(normal) * speed;
        let (point, name) = (DVec3::new(x * size, 0.0, 0.0), format!("normal_{}", impacts.len()));
        let impulse = mass * (bounce.velocity - incoming).length() * speed;
        impacts.push(Impact::new(start, "ball_0", "table", point, normal.extend(0.0)).with_strength(approach, impulse));
        scenery.push(plate(name, point, normal.extend(0.0), size));
        time += 2.0 * bounce.velocity.y;
        incoming = flight::landing(bounce.velocity);
    });
    let x = rest.ok_or_else(|| ModelError::new("a downward normal rejects this draw: it has no animation"))?;
    pieces.push(Piece::resting(time * second, middle(x, 0.0)));
    let shape = Shape::Disc { radius: 0.5 * size, thickness: THICK * size };
    let ball = Track::new("ball_0", shape, Look::nth(0), pieces);
    let wide = DVec3::new(MARGIN, 2.0 * TABLE[0] + 0.01, TABLE[1]) * size;
    let (left, right) = (config.target.min(0.0) * size, config.target.max(0.0) * size);
    let view = View::from(0.3, 0.3, 1.0)
        .showing(DVec3::X * left - wide, DVec3::new(right + wide.x, (height + 1.0) * size, wide.z));
    Ok(Animation::new(time * second, vec![ball], impacts).with_scenery(scenery).with_view(view))
}

/// Table and target, in metres.
fn scenery(config: &Config) -> Vec<Prop> {
    let size = config.diameter_m;
    let (low, high) = (config.target.min(0.0) - MARGIN, config.target.max(0.0) + MARGIN);
    let (middle, half) = (0.5 * (low + high) * size, 0.5 * (high - low) * size);
    let [thick, deep] = TABLE.map(|length| length * size);
    vec![
        Prop::block("table", Look::WOOD, DVec3::new(middle, -thick - 0.01 * size, 0.0), DVec3::new(half, thick, deep)),
        Prop::target(
            "target",
            DVec3::new(config.target * size, 0.005 * size, 0.0),
            DVec3::new(config.tolerance.min(2.0) * size, 0.01 * size, 1.2 * size),
        ),
    ]
}

/// A plate whose upper face goes through `point` and has the given normal.
fn plate(name: String, point: DVec3, normal: DVec3, size: f64) -> Prop {
    let half = PLATE * size;
    let orientation = DQuat::from_rotation_arc(DVec3::Y, normal);
    let look = Look::new([150, 100, 60], Material::Matte);
    Prop::new(name, look, Form::Block { centre: point - half.y * normal, half, orientation })
}
