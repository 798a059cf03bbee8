//! What slides over a seam of two flush parts is braked by µ g, whatever its shape: its contacts' friction has no
//! moment about the vertical, as their loads have none about the way it goes.

use super::Verdict;
use super::form::{Form, Kind};
use super::run::{Ran, run};
use super::world::{Fixed, G, Mover, Saying, World};
use crate::laws::worlds::Dice;
use glam::{DQuat, DVec3};
use plaus_sim::{Accuracy, Law, Outcome, Preset};
use std::f64::consts::TAU;

/// A world, and where the first body must come to rest.
#[derive(Debug, Clone)]
pub struct Slide {
    pub world: World,
    pub end: DVec3,
    /// In m.
    pub way: f64,
    pub off: f64,
    pub says: String,
}

/// Error of a cuboid that slides to rest on a plane, of its way: its row in `docs/validation/accuracy.md`.
fn of_table(preset: Preset) -> f64 {
    match preset {
        Preset::Draft => 6.5e-5,
        Preset::Standard => 6.4e-5,
        Preset::Fine => 1.0e-6,
        Preset::Reference => 6.4e-7,
    }
}

/// The table's row is of one cuboid; others slide by up to so many times as far off. Default 10.
const OTHERS: f64 = 10.0;

const EVENTS: u64 = 20_000;

/// A body that slides over level ground: its friction is so low that it does not tip.
fn slider(dice: &mut Dice) -> (Form, f64) {
    let form = Form::random(dice.of(&Kind::STAND), 0.03 * dice.of_any_size(0.3, 3.0), dice);
    let (_, centre, _) = form.shape();
    let high = centre.z - form.foot();
    let friction = dice.between(0.1, 0.5).min(0.5 * form.base() / high);
    (form, friction)
}

fn sliding(form: Form, friction: f64, before: f64, dice: &mut Dice) -> (Mover, DVec3, f64) {
    let base = form.base();
    let way = base * dice.between(2.0, 6.0);
    let heading = DQuat::from_rotation_z(dice.between(-0.7, 0.7)) * DVec3::X;
    let from = heading * (-before * way) + DVec3::Y * (base * dice.between(-1.0, 1.0));
    let mut mover = Mover::standing(form, from);
    mover.turn = DQuat::from_rotation_z(dice.between(0.0, TAU));
    mover.velocity = heading * (2.0 * friction * G * way).sqrt();
    let (_, centre, _) = mover.form.shape();
    let end = mover.at + mover.turn * centre + heading * way;
    (mover, end, way)
}

fn finished(
    mover: Mover,
    fixed: Vec<Fixed>,
    more: Vec<Mover>,
    law: Law,
    (end, way): (DVec3, f64),
    says: String,
    preset: Preset,
) -> Slide {
    let accuracy = Accuracy::preset(preset);
    let size = mover.form.shape().0.size();
    // A body slower than the preset's speed of rest may be stopped where it is.
    let stopped = accuracy.rest_speed * accuracy.rest_speed * size / (2.0 * law.friction);
    // Where a body stops within a step, the step's curve is off by as much as it bends.
    let bend = law.friction * accuracy.step * accuracy.step * size / 8.0;
    let off = stopped + bend + OTHERS * of_table(preset) * way + 4.0 * accuracy.gap * size;
    let wanted = vec![format!(
        "rests_at = {{ body = \"body_0\", x_mm = {}, y_mm = {}, within_mm = {} }}",
        1e3 * end.x,
        1e3 * end.y,
        // The least that a scenario may ask for.
        (1e3 * off).max(0.001)
    )];
    let movers = [vec![mover], more].concat();
    let world = World { movers, fixed, law, gravity: G, preset, until: 10.0, wanted };
    Slide { world, end, way, off, says }
}

/// Over the seam at x = 0.
pub fn slide(seed: u64, preset: Preset) -> Slide {
    let mut dice = Dice::new(109, seed);
    let (form, friction) = slider(&mut dice);
    let before = dice.between(0.2, 0.8);
    let (mover, end, way) = sliding(form, friction, before, &mut dice);
    let wide = 4.0 * (way + mover.form.shape().0.reach());
    let edges = DVec3::new(2.0 * wide, wide, 0.1 * wide);
    let at = DVec3::Z * (-0.5 * edges.z);
    let law = Law::new(friction, dice.of(&[0.0, 0.5]));
    let says = [Saying::Blocks, Saying::Quarters, Saying::Meshes, Saying::Halves, Saying::Mesh];
    let (fixed, more, says) = match dice.of(&[0, 1, 2, 3, 4, 5, 6]) {
        k @ 0..5 => (says[k].parts(at, edges, DQuat::IDENTITY, 0.5), Vec::new(), format!("{:?}", says[k])),
        5 => {
            let half = edges.with_x(wide);
            let hull = |x: f64| Fixed::Solid {
                form: Form::Hull(Form::corners(half)),
                at: at + DVec3::X * (x * wide),
                turn: DQuat::IDENTITY,
            };
            (vec![hull(-0.5), hull(0.5)], Vec::new(), "hulls".into())
        }
        _ => {
            // Planks that could move, which friction under them holds: they are heavier, and lie on a floor.
            let half = edges.with_x(wide);
            let plank = |x: f64| Mover {
                at: at + DVec3::X * (x * wide),
                ..Mover::standing(Form::Cuboid { edges: half, rounding: 0.0 }, DVec3::ZERO)
            };
            (vec![Fixed::Plane(-edges.z)], vec![plank(-0.5), plank(0.5)], "moving planks".into())
        }
    };
    finished(mover, fixed, more, law, (end, way), says, preset)
}

/// On one part, without a seam.
pub fn plain(seed: u64, preset: Preset) -> Slide {
    let mut dice = Dice::new(113, seed);
    let (form, friction) = slider(&mut dice);
    let (mover, end, way) = sliding(form, friction, 0.5, &mut dice);
    let wide = 4.0 * (way + mover.form.shape().0.reach());
    let edges = DVec3::new(2.0 * wide, wide, 0.1 * wide);
    let at = DVec3::Z * (-0.5 * edges.z);
    let law = Law::new(friction, dice.of(&[0.0, 0.5]));
    let says = [Saying::Block, Saying::Quarter, Saying::Hull, Saying::Mesh];
    let (fixed, says) = match dice.of(&[0, 1, 2, 3, 4, 5]) {
        k @ 0..4 => (says[k].parts(at, edges, DQuat::IDENTITY, 0.5), format!("{:?}", says[k])),
        4 => (vec![Fixed::Table { level: 0.0, bumps: 0.0, spacing: 0.02 }], "table".into()),
        _ => (vec![Fixed::Plane(0.0)], "plane".into()),
    };
    finished(mover, fixed, Vec::new(), law, (end, way), says, preset)
}

/// How far from its place the first body came to rest, in m; infinite if the run has no end.
fn off(slide: &Slide, ran: &Ran) -> f64 {
    let ended = matches!(ran.record.outcome, Outcome::AllAtRest | Outcome::TimeReached);
    match ran.record.moments[0].last() {
        Some(last) if ended => (last.x - slide.end).length(),
        _ => f64::INFINITY,
    }
}

fn told(slide: &Slide, ran: &Ran, off: f64) -> String {
    let events = ran.record.events;
    format!(
        "{} on {}, e {}: {:?} after {events} events, off by {off:.2e} m ({:.1e} allowed) after {:.3} m",
        slide.world.movers[0].form.told(),
        slide.says,
        slide.world.law.restitution,
        ran.record.outcome,
        slide.off,
        slide.way
    )
}

pub fn examine(seed: u64, preset: Preset) -> Option<Verdict> {
    let slide = slide(seed, preset);
    let ran = run(&slide.world, super::meet::DEEP, EVENTS).ok()?;
    let off = off(&slide, &ran);
    // Friction that is smaller by a fiftieth.
    let heading = slide.world.movers[0].velocity.normalize();
    let farther = Slide { end: slide.end + heading * (slide.way / 49.0), ..slide.clone() };
    let twin = (off <= slide.off).then(|| self::off(&farther, &ran) > slide.off);
    Some(Verdict { worst: off / slide.off, found: told(&slide, &ran, off), twin, world: slide.world })
}

/// Errors below this, of the way, are rounding: a thousand events' worth.
const ROUNDING: f64 = 1e-12;

/// Whether this preset is at least as near to the closed form as the next coarser one. Both may come near to it by
/// chance, so what a preset may be off by counts as near.
pub fn order(seed: u64, preset: Preset) -> Option<Verdict> {
    let coarser = match preset {
        Preset::Draft | Preset::Standard => return None,
        Preset::Fine => Preset::Standard,
        Preset::Reference => Preset::Fine,
    };
    let [here, there] = [preset, coarser].map(|preset| {
        let slide = plain(seed, preset);
        let events = if preset == Preset::Reference { 5 * EVENTS } else { EVENTS };
        let ran = run(&slide.world, super::meet::DEEP, events).ok()?;
        let off = off(&slide, &ran);
        Some((told(&slide, &ran, off), off, slide))
    });
    let ((told, off, slide), (_, before, _)) = (here?, there?);
    let allowed = before.max(slide.off) + ROUNDING * slide.way;
    let found = format!("{told}; {before:.2e} m at {}", coarser.name());
    // The presets' names changed about: refused where they differ.
    let twin = (before > 2.0 * slide.off).then(|| before > off.max(slide.off));
    Some(Verdict { worst: off / allowed, found, twin, world: slide.world })
}
