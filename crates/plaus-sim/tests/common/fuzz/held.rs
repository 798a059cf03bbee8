//! What is dropped on a support that holds its centre of gravity stays on it, at the height that follows from the two
//! shapes.

use super::Verdict;
use super::form::{Form, Kind};
use super::run::{Ran, run};
use super::world::{Fixed, G, Mover, Saying, World};
use crate::laws::worlds::Dice;
use glam::{DQuat, DVec3};
use plaus_sim::{Law, Outcome, Preset};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A world, and where the first body's centre of gravity must end.
#[derive(Debug, Clone)]
pub struct Drop {
    pub world: World,
    pub end: DVec3,
    /// How far off it may be, upwards or downwards, and sideways, in m.
    pub off: [f64; 2],
    pub says: String,
}

/// Gaps of the preset between the support and what lies on it: a body touches at half of one, and in each round of a
/// step's end is put back to within it. Twice that, for what lies on one that lies on something.
const GAPS: f64 = 2.0;

const EVENTS: f64 = 20_000.0;

/// How a body lies.
fn lying(dice: &mut Dice, s: f64) -> (Form, DQuat, f64) {
    // One in four lies on its side.
    match dice.of(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]) {
        k @ 0..9 => {
            let form = Form::random(Kind::STAND[k], s, dice);
            let base = form.base();
            (form, DQuat::IDENTITY, base)
        }
        k => {
            let kind = [Kind::Ball, Kind::Cylinder, Kind::Capsule][k - 9];
            let form = Form::random(kind, s, dice);
            let along = match &form {
                Form::Frustum { height, .. } => 0.5 * height,
                _ => f64::INFINITY,
            };
            (form, DQuat::from_rotation_x(FRAC_PI_2), along)
        }
    }
}

/// A level support whose top is at height 0 and holds a disc of a radius about the z axis; and whether it moves.
fn support(dice: &mut Dice, s: f64) -> (Vec<Fixed>, Vec<Mover>, f64, String) {
    let edges = DVec3::new(dice.between(0.3, 1.0), dice.between(0.3, 1.0), dice.between(0.3, 1.0)) * (2.0 * s);
    let at = DVec3::Z * (-0.5 * edges.z);
    let base = 0.5 * edges.x.min(edges.y);
    let turned = DQuat::from_rotation_z(dice.between(0.0, TAU));
    let [r, h] = [0.5 * edges.x, edges.z];
    let round = |radii: [f64; 2]| Form::Frustum { radii, height: h, rounding: 0.0 };
    let solid = |form: Form| vec![Fixed::Solid { form, at, turn: turned }];
    let floor = vec![Fixed::Plane(-edges.z)];
    let stands = |form: Form| {
        let mover = Mover { at, turn: turned, ..Mover::standing(form, DVec3::ZERO) };
        (floor.clone(), vec![mover])
    };
    let cuboid = |rounding: f64| Form::Cuboid { edges, rounding };
    match dice.of(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]) {
        k @ 0..3 => {
            let saying = Saying::ALL[3 * (dice.of(&[0, 1, 2]) as usize) % 8 + k % 2];
            (saying.parts(at, edges, DQuat::IDENTITY, dice.between(0.2, 0.8)), Vec::new(), base, format!("{saying:?}"))
        }
        3 => {
            let saying = dice.of(&Saying::ALL);
            (saying.parts(at, edges, turned, dice.between(0.2, 0.8)), Vec::new(), base, format!("turned {saying:?}"))
        }
        4 => (solid(round([r; 2])), Vec::new(), r, "cylinder".into()),
        // Scenarios have no frusta.
        5 => {
            let coin = Form::Frustum { radii: [r; 2], height: 0.2 * h, rounding: 0.0 };
            let at = DVec3::Z * (-0.1 * h);
            (vec![Fixed::Solid { form: coin, at, turn: turned }], Vec::new(), r, "coin".into())
        }
        6 => {
            let form = Form::prism(dice.of(&[3, 5, 8]), r, h);
            let base = form.base();
            (solid(form), Vec::new(), base, "prism".into())
        }
        7 => (vec![Fixed::Plane(0.0)], Vec::new(), f64::INFINITY, "plane".into()),
        8 => {
            let table = Fixed::Table { level: 0.0, bumps: 0.0, spacing: 0.02 };
            (vec![table], Vec::new(), f64::INFINITY, "table".into())
        }
        9 => {
            let (fixed, movers) = stands(cuboid(0.0));
            (fixed, movers, base, "moving box".into())
        }
        10 => {
            let (fixed, movers) = stands(cuboid(0.1 * edges.min_element()));
            (fixed, movers, base - 0.1 * edges.min_element(), "moving rounded box".into())
        }
        _ => {
            let (fixed, movers) = stands(round([r; 2]));
            (fixed, movers, r, "moving cylinder".into())
        }
    }
}

/// A body just over a support, level, or tilted by so little that it cannot topple.
pub fn drop(seed: u64, preset: Preset) -> Drop {
    let mut dice = Dice::new(107, seed);
    let half = dice.of_any_size(1.0 / 30.0, 30.0).sqrt();
    let [s, t] = [0.03 * half, 0.03 / half];
    let (form, lies, along) = lying(&mut dice, s);
    let (fixed, mut movers, base, says) = support(&mut dice, t);
    let inner = base.min(along);
    let inner = if inner.is_finite() { inner } else { s };
    // The centre of gravity is within the support, and within the face, by half of the smaller one's radius.
    let way = DQuat::from_rotation_z(dice.between(0.0, TAU)) * DVec3::X;
    let aside = way * (dice.between(0.0, 0.5) * inner);
    let (shape, centre, _) = form.shape();
    let radius = match &form {
        Form::Ball(r) => *r,
        Form::Frustum { radii, rounding, .. } => radii[0] + rounding,
        _ => 0.0,
    };
    let on_side = lies != DQuat::IDENTITY;
    let [low, high] = if on_side { [radius; 2] } else { [-form.foot(), centre.z - form.foot()] };
    // It may rise by `inner²/(8 high)` until it topples over an edge at half of `inner` from its centre of gravity.
    let is_tilted = !on_side && dice.of(&[true, false]);
    let limit = inner * inner / (8.0 * high);
    let fall = if is_tilted { 0.1 * limit } else { 0.1 * s.min(t) };
    let tilt = if is_tilted { 0.1 * inner / (2.0 * high) } else { 0.0 };
    let tilted = DQuat::from_axis_angle(DQuat::from_rotation_z(dice.between(0.0, TAU)) * DVec3::X, tilt);
    let turn = (tilted * DQuat::from_rotation_z(dice.between(0.0, TAU)) * lies).normalize();
    let lift = shape.reach() * tilt;
    let end = aside + DVec3::Z * high;
    // The centre of gravity is where it would be if it were level.
    let place = if on_side { aside + DVec3::Z * low } else { end - turn * centre };
    let first = Mover { at: place + DVec3::Z * (fall + lift), turn, velocity: DVec3::ZERO, spin: DVec3::ZERO, form };
    let first_rough = first.form.rough();
    movers.insert(0, first);
    let gap = plaus_sim::Accuracy::preset(preset).gap;
    let sizes: f64 = movers.iter().map(|m| m.form.shape().0.size()).sum();
    let height = GAPS * gap * sizes + first_rough;
    // A level fall has no reason to go sideways but rounding and gaps that differ. A tilted one rocks: each time it
    // comes down, it may slide by a part of its fall, and turn by a part of its tilt.
    let sideways = if is_tilted { (2.0 * lift + fall).min(0.4 * inner) } else { 10.0 * height + 1e-9 * end.length() };
    let law = Law::new(0.8, 0.0).with_resistance(0.02, 0.02);
    let z = end.z * 1e3;
    let wanted = vec![format!(
        "inside = {{ body = \"body_0\", z_mm = [{}, {}], how = \"at_end\" }}",
        z - 1e3 * height,
        z + 1e3 * height
    )];
    let world = World { movers, fixed, law, gravity: G, preset, until: 2.0, wanted };
    Drop { world, end, off: [height, sideways], says }
}

pub fn examine(seed: u64, preset: Preset) -> Option<Verdict> {
    let drop = drop(seed, preset);
    let ran = run(&drop.world, super::meet::DEEP, EVENTS as u64).ok()?;
    let worst = off(&drop, &ran, drop.end);
    let last = ran.record.moments[0].last()?;
    let form = &drop.world.movers[0].form;
    let found = format!(
        "{} on {}: {:?} after {} events, off by {:.2e} m upwards ({:.1e} allowed) and {:.2e} m sideways ({:.1e} \
         allowed), turned by {:.1e} rad",
        form.told(),
        drop.says,
        ran.record.outcome,
        ran.record.events,
        last.x.z - drop.end.z,
        drop.off[0],
        (last.x - drop.end).with_z(0.0).length(),
        drop.off[1],
        (last.turn.mul_vec3(DVec3::Z)).angle_between(drop.world.starts()[0].orientation * DVec3::Z),
    );
    // As if the support were lower by a fiftieth of the body's size.
    let size = drop.world.sizes()[0];
    let is_at_rest = ran.record.outcome == Outcome::AllAtRest;
    let twin = (worst <= 1.0 && is_at_rest).then(|| off(&drop, &ran, drop.end - DVec3::Z * (0.02 * size)) > 1.0);
    Some(Verdict { worst, found, twin, world: drop.world })
}

/// In units of what is allowed. What still rocks as time is over may be as high as where it was let go: a tall body on
/// a small base loses about `3 α²` of its energy each time it comes down, `α` being its base over twice its height
/// (Housner, Bull. Seism. Soc. Am. 53 (1963)).
fn off(drop: &Drop, ran: &Ran, end: DVec3) -> f64 {
    let Some(last) = ran.record.moments[0].last() else { return f64::INFINITY };
    let rocks = match ran.record.outcome {
        Outcome::AllAtRest => 0.0,
        Outcome::TimeReached => drop.world.starts()[0].position.z - drop.end.z,
        _ => return f64::INFINITY,
    };
    let d = last.x - end;
    let high = if d.z > 0.0 { drop.off[0] + rocks } else { drop.off[0] };
    (d.z.abs() / high).max(d.with_z(0.0).length() / drop.off[1])
}
