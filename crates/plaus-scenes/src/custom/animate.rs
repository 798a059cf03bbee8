//! The animation of a recorded motion. The simulator's z points up; an animation's y does.

use super::Custom;
use super::engine::Engine;
use super::plan::{Built, Plan};
use super::shapes::Made;
use super::standing::Standing;
use super::values::{Drawn, Numbers};
use crate::animation::{Animation, Break, Left, Motion, Prop, Track};
use crate::film::{self, Figure, impact};
use crate::loads::{self, Span};
use crate::require::Begun;
use glam::DVec3;
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::Start;
use plaus_sim::trace::Trace;
use std::iter;

/// The motion of the bodies that are there, their impacts and contacts, of a trace that is known before `known` and
/// ends at `end`, in s, in which `spans` bore load.
pub(super) fn film<E: Engine>(
    plan: &Plan,
    draw: &Drawn,
    (engine, built): (&E, &Built),
    (trace, spans): (&Trace<E::Body>, &[Span]),
    [end, known]: [f64; 2],
) -> Begun {
    let numbers = plan.works.numbers(Some(draw));
    let body = |index: usize| &plan.bodies[built.there[index]];
    let mut turns = known;
    let figure = |(index, made): (usize, &Made)| {
        let motions = trace.motions.get(index).map_or(&[][..], Vec::as_slice);
        let (motions, turning) = E::begun(motions, known);
        turns = turns.min(turning);
        let pieces = engine.pieces(index, motions, made, end.min(known));
        let track = Track::new(body(index).name.clone(), made.drawn.clone(), body(index).look, pieces)
            .with_origin(made.origin())
            .appearing(body(index).late.is_some());
        Figure { track, mass: plan.mass(built.there[index], &numbers, made), end }
    };
    let figures: Vec<Figure> = built.shapes.iter().enumerate().map(figure).collect();
    let name = |other| match other {
        Other::Body(other) => body(other).name.clone(),
        Other::Surface(surface) => plan.parts[built.part(surface)].name.clone(),
    };
    let hits = trace.impacts.iter().filter(|hit| hit.time < known);
    let impacts =
        hits.map(|hit| impact(hit, [body(hit.body).name.clone(), name(hit.other)], hit.time, DVec3::ZERO)).collect();
    let named = |number: u32| match (number as usize).checked_sub(built.shapes.len()) {
        Some(part) => plan.parts[part].name.clone(),
        None => body(number as usize).name.clone(),
    };
    let contacts = loads::contacts(spans, &figures, named, [end, known]);
    let mut film = film::with_contacts(figures, impacts, (end, known, turns), contacts, known);
    film.motion.numbers = plan.followed.iter().map(|value| value.of(&numbers)).collect();
    // What has not appeared has no motion.
    film.motion.tracks.retain(|track| !track.pieces.is_empty());
    film.motion = film.motion.with_breaks(breaks(plan, (engine, built), trace, known));
    film
}

/// The joints that break before `known`, in order of time.
fn breaks<E: Engine>(plan: &Plan, (engine, built): (&E, &Built), trace: &Trace<E::Body>, known: f64) -> Vec<Break> {
    let joints = plan.joints.iter().enumerate();
    let broken = joints.filter_map(|(number, bond)| {
        let time = bond.breaks(engine, number, &built.there, trace)?;
        (time < known).then(|| Break { time, joint: bond.name.clone() })
    });
    let mut breaks: Vec<Break> = broken.collect();
    breaks.sort_by(|a, b| a.time.total_cmp(&b.time));
    breaks
}

impl Custom {
    /// What stands still around a motion.
    pub(super) fn scenery_around(&self, draw: &Drawn, motion: &Motion) -> Result<Vec<Prop>, ModelError> {
        let places = motion.tracks.iter().flat_map(|track| &track.pieces).map(|piece| piece.position.length());
        props(&self.plan, draw, shown(places.fold(0.0, f64::max)))
    }

    /// The animation of a draw, with where bodies are left at `end`, in s, or before.
    pub(super) fn animated(&self, draw: &Drawn, end: f64) -> Result<Animation, ModelError> {
        let work = self.simulated(draw)?;
        let Some((record, built)) = work.known(draw) else {
            return Err(ModelError::new("nothing was recorded: a bug"));
        };
        let scenery = props(&self.plan, draw, record.reach())?;
        let mut animation = Animation::from(record.film(&self.plan, built)).with_scenery(scenery);
        let rods = self.plan.rods(draw, built, &animation.motion.tracks);
        let strings = record.strings(&self.plan, built, &animation.motion.tracks);
        animation.motion.tracks.extend(rods.into_iter().chain(strings));
        let is_endless = |name: &str| self.plan.parts.iter().any(|part| part.name == name && part.is_endless());
        let view = self.config.view.of(&animation, is_endless);
        Ok(animation.with_view(view).with_left(record.left(&self.plan, built, end.min(record.end))))
    }
}

/// How the bodies that are there are left at a time, in s: those that are released by then, and follow no keyframes.
pub(super) fn left<E: Engine>(
    plan: &Plan,
    (engine, built): (&E, &Built),
    trace: &Trace<E::Body>,
    time: f64,
) -> Vec<Left> {
    let one = |(index, made): (usize, &Made)| {
        let (body, motions) = (&plan.bodies[built.there[index]], trace.motions.get(index)?);
        let begun = motions.partition_point(|motion| E::path(motion).t <= time);
        let motion = motions.get(begun.checked_sub(1)?).filter(|_| body.way.is_none())?;
        let Start { position, orientation, velocity, spin, .. } = engine.state_at(index, motion, time);
        let orientation = (orientation * made.axes.conjugate()).normalize();
        let position = position - orientation * made.centre;
        Some(Left { name: body.name.clone(), time, position, orientation, velocity, spin })
    };
    built.shapes.iter().enumerate().filter_map(one).collect()
}

/// What stands still. A plane is shown so far in m around the middle of what moves.
fn props(plan: &Plan, draw: &Drawn, reach: f64) -> Result<Vec<Prop>, ModelError> {
    let numbers = plan.works.numbers(Some(draw));
    let there = plan.parts.iter().filter(|part| part.there.of(&numbers));
    there.map(|part| prop(part, &numbers, reach)).collect()
}

fn prop(part: &Standing, numbers: &Numbers<'_>, reach: f64) -> Result<Prop, ModelError> {
    let form = part.drawn(numbers, reach).map_err(ModelError::new)?;
    Ok(Prop::new(part.name.clone(), part.look, form))
}

/// How far ground without an end is drawn: 1 m farther than the largest distance from the origin that a body of the
/// animation is seen at, or up to twice that.
pub(super) fn reach<E: Engine>(trace: &Trace<E::Body>) -> f64 {
    let places = trace.motions.iter().flatten().map(|motion| E::path(motion).x.truncate().length());
    shown(places.fold(0.0, f64::max))
}

/// The same of the largest distance from the origin: a power of two, so that most motions of a world have the same
/// ground.
fn shown(far: f64) -> f64 {
    let mut doubled = iter::successors(Some(2.0), |half| Some(2.0 * half));
    doubled.find(|half| far + 1.0 <= *half || *half >= 1e3).unwrap_or(1e3)
}
