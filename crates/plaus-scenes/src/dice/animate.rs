//! The animation of a draw. In the simulator z points up, in an animation y.

use super::fall::{Recorded, Seen};
use super::{Dice, Draw, props};
use crate::animation::{Animation, Look, Piece, Shape, Track, UPRIGHT, View, upright};
use crate::film::{Figure, Pieces, begun, impact};
use crate::require::Begun;
use glam::DVec3;
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld};

/// Longest piece, in s, of the flight of a body that does not turn at constant angular velocity.
const WOBBLE: f64 = 0.004;

/// Recorded dice with their table.
pub(super) fn animate(scene: &Dice, draw: &Draw, recorded: &[Recorded]) -> Result<Animation, ModelError> {
    let [low, high] = extent(scene, draw, recorded);
    let room = DVec3::new(props::ROOM, props::ROOM, 0.0);
    let [low, high] = [low - room, high + room];
    let scenery = props::props(scene, draw, [low, high]).map_err(ModelError::new)?;
    let view = View::from(-0.25, 0.75, 1.0).showing(upright(low.with_z(0.0)), upright(high));
    let seen: Vec<Seen> = recorded.iter().map(Recorded::seen).collect();
    let motion = film(scene, draw, &seen, f64::INFINITY)?.motion;
    Ok(Animation::from(motion).with_scenery(scenery).with_view(view))
}

/// The corners of a box that contains the paths of the dice's centres, in the simulator's axes.
fn extent(scene: &Dice, draw: &Draw, recorded: &[Recorded]) -> [DVec3; 2] {
    let dice = recorded.iter().flat_map(|Recorded { members, trace }| members.iter().zip(&trace.motions));
    let places = dice.flat_map(|(&die, motions)| {
        let offset = scene.offset(draw, die);
        motions.iter().map(move |motion| motion.path.x + offset)
    });
    let nowhere = [DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)];
    places.fold(nowhere, |[low, high], x| [low.min(x), high.max(x)])
}

/// The dice alone, as far as they were recorded, which is known before `known`, in s.
pub(super) fn film(scene: &Dice, draw: &Draw, seen: &[Seen<'_>], known: f64) -> Result<Begun, ModelError> {
    // Such a body does not turn at constant velocity, so its pose is asked for at times in between.
    let wobbles = scene.plan.rotations.len() != 24;
    let free = wobbles.then(|| scene.plan.free_world()).transpose()?;
    let half = scene.plan.cuboid.half();
    let mass = 8.0 * half.x * half.y * half.z * scene.plan.density;
    let (mut figures, mut impacts, mut turns) = (Vec::new(), Vec::new(), known);
    for (members, trace) in seen {
        let name = |k: usize| format!("die_{}", members[k] + 1);
        for (k, (&die, motions)) in members.iter().zip(&trace.motions).enumerate() {
            let (motions, turning) = begun(motions, known);
            turns = if wobbles { turns.min(turning) } else { turns };
            let pieces = pieces(scene, draw, free.as_ref(), die, motions);
            let last = pieces.last().map_or(0.0, |piece| piece.start);
            let shape = Shape::Cuboid { half, pips: Some(Shape::PIPS) };
            let look = if scene.config.dice == 1 { Look::IVORY } else { Look::nth(die) };
            let track = Track::new(name(k), shape, look, pieces);
            figures.push((
                die,
                last,
                Figure { track, mass, end: if known.is_finite() { known } else { last } },
                motions,
            ));
        }
        impacts.extend(trace.impacts.iter().filter(|hit| hit.time < known).map(|hit| {
            let other = match hit.other {
                Other::Body(other) => name(other),
                Other::Surface(_) => "table".into(),
            };
            impact(hit, [name(hit.body), other], hit.time, scene.offset(draw, members[hit.body]))
        }));
    }
    figures.sort_by_key(|(die, ..)| *die);
    impacts.sort_by(|a, b| a.time.total_cmp(&b.time));
    // At least one frame.
    let duration = figures.iter().fold(0.04, |duration, (_, last, ..)| f64::max(duration, *last));
    let (figures, motions): (Vec<Figure>, Vec<&[RigidBodyState]>) =
        figures.into_iter().map(|(.., figure, motions)| (figure, motions)).unzip();
    Ok(crate::film::film(figures, impacts, (duration, known, turns), |index, piece, figures, _| {
        let (time, motions) = (f64::max(figures[index].track.pieces[piece].start, 0.0), motions[index]);
        let motion = motions[..motions.partition_point(|motion| motion.path.t <= time)].last()?;
        matches!(motion.phase, Phase::Glide | Phase::Step).then(|| "table".to_owned())
    }))
}

/// The motions of one die as pieces, with the orientation of its pips. A die that wobbles gets many pieces, which
/// `free` computes.
fn pieces(scene: &Dice, draw: &Draw, free: Option<&RigidWorld>, die: usize, motions: &[RigidBodyState]) -> Vec<Piece> {
    let pips = &scene.plan.rotations[usize::from(draw.throws[die].turn)];
    let offset = scene.offset(draw, die);
    let mut pieces = Pieces::default();
    let mut add = |body: &RigidBodyState| {
        pieces.add(body, (body.path.t, body.path.x + offset), UPRIGHT * pips.pips(body.turn), 0.0)
    };
    for (k, motion) in motions.iter().enumerate() {
        add(motion);
        let until = motions.get(k + 1).map_or(motion.path.t, |next| next.path.t);
        if let Some(free) = free.filter(|_| matches!(motion.phase, Phase::Flight | Phase::Step)) {
            let parts = ((until - motion.path.t) / WOBBLE).ceil().min(1e5) as u32;
            for part in 1..parts {
                let time = motion.path.t + (until - motion.path.t) * f64::from(part) / f64::from(parts);
                add(&free.on_its_way(0, motion, time));
            }
        }
    }
    pieces.0
}
