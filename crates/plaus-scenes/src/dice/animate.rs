//! The animation of a draw. In the simulator z points up, in an animation y.

use super::fall::Recorded;
use super::throwing::Work;
use super::{Dice, Draw, props};
use crate::animation::{Animation, Impact, Look, Piece, Shape, Track, Turn, UPRIGHT, View, upright};
use crate::touch::{Toucher, in_order};
use glam::DVec3;
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::{Phase, Rigid, Turning};
use std::borrow::Borrow;

/// Pips of the faces +x, −x, +y, −y, +z, −z.
const PIPS: [u8; 6] = [3, 4, 2, 5, 1, 6];

/// Longest piece, in s, of the flight of a body that does not turn at constant angular velocity.
const WOBBLE: f64 = 0.004;

pub(super) fn animate(scene: &Dice, draw: &Draw) -> Result<Animation, ModelError> {
    let recorded = Work::default().record(&scene.plan, draw, scene.plan.longest)?;
    let (motion, [low, high]) = motion(scene, draw, &recorded)?;
    let room = DVec3::new(props::ROOM, props::ROOM, 0.0);
    let [low, high] = [low - room, high + room];
    let scenery = props::props(scene, draw, [low, high]).map_err(ModelError::new)?;
    let view = View::from(-0.25, 0.75, 1.0).showing(upright(low.with_z(0.0)), upright(high));
    Ok(motion.with_scenery(scenery).with_view(view))
}

/// The dice alone, as recorded, and the corners of a box that contains the paths of their centres, in the simulator's
/// axes.
pub(super) fn motion(
    scene: &Dice,
    draw: &Draw,
    recorded: &[impl Borrow<Recorded>],
) -> Result<(Animation, [DVec3; 2]), ModelError> {
    // Such a body does not turn at constant velocity, so its pose is asked for at times in between.
    let wobbles = scene.plan.rotations.len() != 24;
    let free = wobbles.then(|| scene.plan.free_world()).transpose()?;
    let (mut tracks, mut impacts, mut duration) = (Vec::new(), Vec::new(), 0.0_f64);
    let (mut contacts, half) = (Vec::new(), scene.plan.cuboid.half());
    let mass = 8.0 * half.x * half.y * half.z * scene.plan.density;
    let mut extent = [DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)];
    for Recorded { members, trace } in recorded.iter().map(Borrow::borrow) {
        let name = |k: usize| format!("die_{}", members[k] + 1);
        for (k, (&die, motions)) in members.iter().zip(&trace.motions).enumerate() {
            let (pieces, offset) = (pieces(scene, draw, free.as_ref(), die, motions), scene.offset(draw, die));
            for motion in motions {
                let x = motion.path.x + offset;
                extent = [extent[0].min(x), extent[1].max(x)];
            }
            duration = pieces.last().map_or(duration, |piece| duration.max(piece.start));
            let shape = Shape::Cuboid { half: scene.plan.cuboid.half(), pips: Some(PIPS) };
            let look = if scene.config.dice == 1 { Look::IVORY } else { Look::nth(die) };
            let touches = |piece: usize| {
                let time = f64::max(pieces[piece].start, 0.0);
                let motion = motions[..motions.partition_point(|motion| motion.path.t <= time)].last()?;
                matches!(motion.phase, Phase::Glide | Phase::Step).then(|| "table".to_owned())
            };
            let end = pieces.last().map_or(0.0, |piece| piece.start);
            let toucher = Toucher { name: &name(k), shape: &shape, mass, pieces: &pieces, end };
            contacts.extend(toucher.contacts(touches));
            tracks.push((die, Track::new(name(k), shape, look, pieces)));
        }
        impacts.extend(trace.impacts.iter().map(|hit| {
            let other = match hit.other {
                Other::Body(other) => name(other),
                Other::Surface(_) => "table".into(),
            };
            let point = hit.point + scene.offset(draw, members[hit.body]);
            Impact::new(hit.time, name(hit.body), other, upright(point), upright(hit.normal))
                .with_strength(hit.approach, hit.impulse.length())
        }));
    }
    tracks.sort_by_key(|(die, _)| *die);
    let tracks = tracks.into_iter().map(|(_, track)| track).collect();
    impacts.sort_by(|a, b| a.time.total_cmp(&b.time));
    // At least one frame.
    let duration = duration.max(0.04);
    Ok((Animation::new(duration, tracks, impacts).with_contacts(in_order(contacts)), extent))
}

/// The motions of one die as pieces, with the orientation of its pips. A die that wobbles gets many pieces, which
/// `free` computes.
fn pieces(scene: &Dice, draw: &Draw, free: Option<&Rigid>, die: usize, motions: &[Turning]) -> Vec<Piece> {
    let pips = &scene.plan.rotations[usize::from(draw.throws[die].turn)];
    let offset = scene.offset(draw, die);
    let mut pieces: Vec<Piece> = Vec::with_capacity(motions.len());
    let mut add = |body: &Turning| {
        let moves = !matches!(body.phase, Phase::Rest | Phase::Waiting);
        let (velocity, spin) = if moves { (body.path.v, body.spin) } else { (DVec3::ZERO, DVec3::ZERO) };
        let a = if moves { body.path.a } else { DVec3::ZERO };
        let turn = Turn { orientation: (UPRIGHT * pips.pips(body.turn)).normalize(), spin: upright(spin), own: 0.0 };
        let piece =
            Piece::ballistic(body.path.t, upright(body.path.x + offset), upright(velocity), upright(a)).turning(turn);
        // Of motions that begin at the same time only the last takes effect.
        if pieces.last().is_some_and(|last| last.start == piece.start) {
            pieces.pop();
        }
        pieces.push(piece);
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
    pieces
}
