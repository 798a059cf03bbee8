//! The animation of a recorded motion. The simulator's z points up; an animation's y does.

use super::plan::{Built, Plan, part};
use super::solids::Made;
use super::standing::Standing;
use super::values::{Drawn, Numbers};
use crate::animation::{Break, Piece, Prop, Track, UPRIGHT};
use crate::film::{Figure, Pieces, begun, impact, met_last};
use crate::require::Begun;
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

/// The motion of the bodies that are there, their impacts and contacts, of a trace that is known before `known` and
/// ends at `end`, in s.
pub(super) fn film(plan: &Plan, draw: &Drawn, built: &Built, trace: &Trace<Turning>, [end, known]: [f64; 2]) -> Begun {
    let numbers = plan.works.numbers(Some(draw));
    let body = |index: usize| &plan.bodies[built.there[index]];
    let mut turns = known;
    let figure = |(index, made): (usize, &Made)| {
        let inertia = made.solid.mass_properties(1.0).inertia;
        let is_round = inertia.max_element() - inertia.min_element() <= ROUND * inertia.max_element();
        let motions = trace.motions.get(index).map_or(&[][..], Vec::as_slice);
        let (motions, turning) = begun(motions, known);
        turns = turns.min(turning);
        let pieces = pieces(&built.rigid, index, motions, made.axes.conjugate(), (end.min(known), is_round));
        let track = Track::new(body(index).name.clone(), made.drawn.clone(), body(index).look, pieces);
        Figure { track, mass: plan.mass(built.there[index], &numbers, made), end }
    };
    let figures: Vec<Figure> = built.shapes.iter().enumerate().map(figure).collect();
    let name = |other| match other {
        Other::Body(other) => body(other).name.clone(),
        Other::Surface(surface) => plan.parts[part(surface)].name.clone(),
    };
    let hits = trace.impacts.iter().filter(|hit| hit.time < known);
    let impacts =
        hits.map(|hit| impact(hit, [body(hit.body).name.clone(), name(hit.other)], hit.time, DVec3::ZERO)).collect();
    let mut film = crate::film::film(figures, impacts, (end, known, turns), |index, piece, figures, impacts| {
        let (track, motions) = (&figures[index].track, trace.motions.get(index)?);
        // The motion that the piece was made of: the last that had begun.
        let after = motions.partition_point(|motion| motion.path.t <= track.pieces[piece].start);
        let motion = motions.get(after.checked_sub(1)?)?;
        if !matches!(motion.phase, Phase::Glide | Phase::Step) {
            return None;
        }
        if let Some(&surface) = motion.touching().first() {
            return Some(plan.parts[part(surface)].name.clone());
        }
        // What carries it is what it met last; what is held by a joint need not slide on anything.
        if plan.is_held(built.there[index]) { None } else { met_last(track, piece, impacts).next().cloned() }
    });
    film.motion = film.motion.with_breaks(breaks(plan, built, trace, known));
    film
}

/// The joints that break before `known`, in order of time.
fn breaks(plan: &Plan, built: &Built, trace: &Trace<Turning>, known: f64) -> Vec<Break> {
    let joints = plan.joints.iter().enumerate();
    let broken = joints.filter_map(|(number, bond)| {
        let time = bond.breaks(&built.rigid, number, &built.there, trace)?;
        (time < known).then(|| Break { time, joint: bond.name.clone() })
    });
    let mut breaks: Vec<Break> = broken.collect();
    breaks.sort_by(|a, b| a.time.total_cmp(&b.time));
    breaks
}

/// The motions of a body. `axes` turns its scenario's axes into the simulator's body axes.
fn pieces(rigid: &Rigid, index: usize, motions: &[Turning], axes: DQuat, (end, is_round): (f64, bool)) -> Vec<Piece> {
    let mut pieces = Pieces::default();
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
            pieces.add(&body, (body.path.t, body.path.x), UPRIGHT * body.turn * axes, 0.0);
        }
    }
    Piece::lead_on(&mut pieces.0);
    pieces.0
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
