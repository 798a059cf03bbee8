//! The animation of a draw. The simulator's z points up; an animation's y does.

use super::throwing::Work;
use super::{Dice, Draw, props};
use crate::animation::{Animation, Impact, Look, Piece, Shape, Track, Turn, UPRIGHT, View, upright};
use glam::DVec3;
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::{Phase, Rigid, Turning};

/// Pips of the faces +x, −x, +y, −y, +z, −z.
const PIPS: [u8; 6] = [3, 4, 2, 5, 1, 6];

/// Longest piece, in s, of the flight of a body that does not turn at constant angular velocity.
const WOBBLE: f64 = 0.004;

pub(super) fn animate(scene: &Dice, draw: &Draw) -> Result<Animation, ModelError> {
    let (mut tracks, mut impacts, mut duration) = (Vec::new(), Vec::new(), 0.0_f64);
    let mut extent = [DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)];
    for (world, trace) in Work::default().record(&scene.plan, draw)? {
        let first = tracks.len();
        let name = |die: usize| format!("die_{}", first + die + 1);
        for (die, motions) in trace.motions.iter().enumerate() {
            let (pieces, offset) =
                (pieces(scene, draw, &world, (first, die), motions), scene.offset(draw, first + die));
            for motion in motions {
                let x = motion.path.x + offset;
                extent = [extent[0].min(x), extent[1].max(x)];
            }
            duration = pieces.last().map_or(duration, |piece| duration.max(piece.start));
            let shape = Shape::Cuboid { half: scene.plan.cuboid.half(), pips: Some(PIPS) };
            let look = if scene.config.dice == 1 { Look::IVORY } else { Look::nth(first + die) };
            tracks.push(Track::new(name(die), shape, look, pieces));
        }
        impacts.extend(trace.impacts.iter().map(|hit| {
            let other = match hit.other {
                Other::Body(other) => name(other),
                Other::Surface(_) => "table".into(),
            };
            let point = hit.point + scene.offset(draw, first + hit.body);
            Impact::new(hit.time, name(hit.body), other, upright(point), upright(hit.normal))
                .with_strength(hit.approach, hit.impulse.length())
        }));
    }
    impacts.sort_by(|a, b| a.time.total_cmp(&b.time));
    // One frame at least.
    let duration = duration.max(0.04);
    let room = DVec3::new(0.03, 0.03, 0.0);
    let [low, high] = [extent[0] - room, extent[1] + room];
    let scenery = props::props(scene, draw, [low, high]).map_err(ModelError::new)?;
    let view = View::from(-0.25, 0.75, 1.0).showing(upright(low.with_z(0.0)), upright(high));
    Ok(Animation::new(duration, tracks, impacts).with_scenery(scenery).with_view(view))
}

/// One die's motions as pieces, with the orientation of its pips.
fn pieces(scene: &Dice, draw: &Draw, world: &Rigid, (first, die): (usize, usize), motions: &[Turning]) -> Vec<Piece> {
    let pips = &scene.plan.rotations[usize::from(draw.throws[first + die].turn)];
    let offset = scene.offset(draw, first + die);
    let wobbles = scene.plan.rotations.len() != 24;
    let mut pieces: Vec<Piece> = Vec::with_capacity(motions.len());
    let mut add = |body: &Turning| {
        let moves = !matches!(body.phase, Phase::Rest | Phase::Waiting);
        let (velocity, spin) = if moves { (body.path.v, body.spin) } else { (DVec3::ZERO, DVec3::ZERO) };
        let a = if moves { body.path.a } else { DVec3::ZERO };
        let turn = Turn { orientation: (UPRIGHT * pips.pips(body.turn)).normalize(), spin: upright(spin), own: 0.0 };
        let piece =
            Piece::ballistic(body.path.t, upright(body.path.x + offset), upright(velocity), upright(a)).turning(turn);
        // Of motions that begin at one time the last is the one that is made.
        if pieces.last().is_some_and(|last| last.start == piece.start) {
            pieces.pop();
        }
        pieces.push(piece);
    };
    for (k, body) in motions.iter().enumerate() {
        add(body);
        let until = motions.get(k + 1).map_or(body.path.t, |next| next.path.t);
        if wobbles && body.phase == Phase::Flight {
            let parts = ((until - body.path.t) / WOBBLE).ceil().min(1e5) as u32;
            for part in 1..parts {
                let time = body.path.t + (until - body.path.t) * f64::from(part) / f64::from(parts);
                add(&world.at(die, body, time));
            }
        }
    }
    pieces
}
