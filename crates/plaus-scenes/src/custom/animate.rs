//! The animation of a recorded motion. The simulator's z points up; an animation's y does.

use super::flight::{Record, part};
use super::plan::{Built, Plan};
use super::standing::Standing;
use super::values::{Drawn, Numbers};
use crate::animation::{Animation, Break, Contact, Impact, Piece, Prop, Track, Turn, UPRIGHT, upright};
use crate::touch::{Toucher, in_order};
use glam::{DQuat, DVec3};
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::{Phase, Rigid, Turning};
use plaus_sim::trace::Trace;

/// Radians that a body in the air turns at most within one piece of its motion, where its moments of inertia differ and
/// it has no closed form of pieces: at 0.1 the straight turn of a piece is off by less than 1e-3.
const TURN: f64 = 0.1;

/// Most pieces of one flight.
const MOST_PIECES: f64 = 2000.0;

/// How far the moments of inertia of a body may differ that turns like a ball: rounding.
const ROUND: f64 = 1e-9;

/// The motion of all bodies, their impacts and contacts.
pub(super) fn motion(plan: &Plan, record: &Record, built: &Built) -> Animation {
    let Record { trace, end, .. } = record;
    let bodies = built.there.iter().map(|&index| &plan.bodies[index]).zip(&built.shapes);
    let tracks = bodies.enumerate().map(|(index, (body, made))| {
        let inertia = made.solid.mass_properties(1.0).inertia;
        let is_round = inertia.max_element() - inertia.min_element() <= ROUND * inertia.max_element();
        let motions = trace.motions.get(index).map_or(&[][..], Vec::as_slice);
        let pieces = pieces(&built.rigid, index, motions, made.axes.conjugate(), (*end, is_round));
        Track::new(body.name.clone(), made.drawn.clone(), body.look, pieces)
    });
    let tracks: Vec<Track> = tracks.collect();
    let body = |index: usize| plan.bodies[built.there[index]].name.clone();
    let name = |other| match other {
        Other::Body(other) => body(other),
        Other::Surface(surface) => plan.parts[part(surface)].name.clone(),
    };
    let impacts = trace.impacts.iter().map(|hit| {
        Impact::new(hit.time, body(hit.body), name(hit.other), upright(hit.point), upright(hit.normal))
            .with_strength(hit.approach, hit.impulse.length())
    });
    let animation = Animation::new(*end, tracks, impacts.collect());
    let contacts = contacts(plan, record, built, &animation);
    let joints = plan.joints.iter().enumerate();
    let broken = joints.filter_map(|(number, bond)| {
        let time = bond.breaks(&built.rigid, number, &built.there, trace)?;
        Some(Break { time, joint: bond.name.clone() })
    });
    let mut breaks: Vec<Break> = broken.collect();
    breaks.sort_by(|a, b| a.time.total_cmp(&b.time));
    animation.with_contacts(contacts).with_breaks(breaks)
}

/// What rolls and slides on what.
fn contacts(plan: &Plan, record: &Record, built: &Built, animation: &Animation) -> Vec<Contact> {
    let (trace, numbers) = (&record.trace, plan.works.numbers(Some(&record.draw)));
    let of_body = |(index, track): (usize, &Track)| {
        let Track { name, shape, pieces, .. } = track;
        let is_held = plan.is_held(built.there[index]);
        let motions = trace.motions.get(index).map_or(&[][..], Vec::as_slice);
        let touches = |piece: usize| {
            // The motion that the piece was made of: the last that had begun.
            let after = motions.partition_point(|motion| motion.path.t <= pieces[piece].start);
            let motion = motions.get(after.checked_sub(1)?)?;
            if !matches!(motion.phase, Phase::Glide | Phase::Step) {
                return None;
            }
            if let Some(&surface) = motion.touching().first() {
                return Some(plan.parts[part(surface)].name.clone());
            }
            if is_held {
                // A joint may move it, so it need not slide on anything.
                return None;
            }
            // What carries it is what it met last.
            let hit =
                animation.impacts.iter().rev().find(|hit| hit.time <= pieces[piece].start && hit.involves(name))?;
            Some(if hit.body == *name { hit.other.clone() } else { hit.body.clone() })
        };
        let mass = plan.mass(built.there[index], &numbers, &built.shapes[index]);
        Toucher { name, shape, mass, pieces, end: animation.duration }.contacts(touches)
    };
    in_order(animation.tracks.iter().enumerate().flat_map(of_body).collect())
}

/// The motions of a body. `axes` turns its scenario's axes into the simulator's body axes.
fn pieces(rigid: &Rigid, index: usize, motions: &[Turning], axes: DQuat, (end, is_round): (f64, bool)) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::with_capacity(motions.len());
    for (k, motion) in motions.iter().enumerate() {
        let until = motions.get(k + 1).map_or(end, |next| next.path.t);
        let span = (until - motion.path.t).max(0.0);
        let turns = matches!(motion.phase, Phase::Flight | Phase::Leg) && !is_round;
        let parts = if turns { (motion.spin.length() * span / TURN).ceil().clamp(1.0, MOST_PIECES) } else { 1.0 };
        for part in 0..parts as u32 {
            let time = motion.path.t + span * f64::from(part) / parts;
            let mut body = rigid.on_its_way(index, motion, time);
            if motion.phase == Phase::Leg && part == 0 {
                // A leg turns with its mean, not as fast as at its start.
                body.spin = motion.spin;
            }
            let piece = piece(&body, axes);
            // Of motions that begin at one time the last is the one that is made.
            if pieces.last().is_some_and(|last| last.start >= piece.start) {
                pieces.pop();
            }
            pieces.push(piece);
        }
    }
    Piece::lead_on(&mut pieces);
    pieces
}

fn piece(body: &Turning, axes: DQuat) -> Piece {
    let moves = !matches!(body.phase, Phase::Rest | Phase::Waiting | Phase::Gone);
    let [v, a, spin] = if moves { [body.path.v, body.path.a, body.spin] } else { [DVec3::ZERO; 3] };
    let turn = Turn { orientation: (UPRIGHT * body.turn * axes).normalize(), spin: upright(spin), own: 0.0 };
    Piece::ballistic(body.path.t, upright(body.path.x), upright(v), upright(a)).turning(turn)
}

/// What stands still. A plane is shown so far in m around the middle of what moves.
pub(super) fn props(plan: &Plan, draw: &Drawn, reach: f64) -> Result<Vec<Prop>, ModelError> {
    let numbers = plan.works.numbers(Some(draw));
    plan.parts.iter().map(|part| prop(part, &numbers, reach)).collect()
}

fn prop(part: &Standing, numbers: &Numbers<'_>, reach: f64) -> Result<Prop, ModelError> {
    let form = part.drawn(numbers, reach).map_err(ModelError::new)?;
    Ok(Prop::new(part.name.clone(), part.look, form))
}

/// How far things move: the largest distance from the origin that a body of the animation is seen at, and 1 m more.
pub(super) fn reach(trace: &Trace<Turning>) -> f64 {
    let places = trace.motions.iter().flatten().map(|motion| motion.path.x.truncate().length());
    let far = places.fold(0.0, f64::max);
    (far + 1.0).min(1e3)
}
