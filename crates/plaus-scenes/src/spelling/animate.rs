//! The animation of a draw. The simulator's z points up; an animation's y does.

use super::arena::{Arena, GRAVITY};
use super::draw::Drops;
use super::settle::Work;
use super::{Word, props};
use crate::animation::{Animation, Impact, Look, Piece, Shape, Track, View, upright};
use glam::DVec3;
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::Other;
use plaus_sim::scenery::Surface;

pub(super) fn animate(arena: &Arena, word: &Word, draw: &Drops) -> Result<Animation, ModelError> {
    let (mut tracks, mut impacts) = (Vec::new(), Vec::new());
    for (fall, hits) in Work::default().record(arena, draw)? {
        let name = |member: usize| format!("ball_{}", fall.members[member]);
        for (member, way) in fall.ways.iter().enumerate() {
            let piece = |piece: &crate::way::Piece| {
                let path = &piece.path;
                Piece::ballistic(path.t, upright(path.x), upright(path.v), upright(path.a))
            };
            let pieces = way.pieces.iter().map(piece).collect();
            let look = Look::nth(fall.members[member]);
            let shape = Shape::ball(arena.bins().marble);
            tracks.push((fall.members[member], Track::new(name(member), shape, look, pieces)));
        }
        impacts.extend(hits.iter().map(|hit| {
            let other = match hit.other {
                Other::Body(other) => name(other),
                Other::Surface(Surface::Plane(_)) => "wall".into(),
                Other::Surface(Surface::Dome(_)) => "floor".into(),
                Other::Surface(_) => "partition".into(),
            };
            Impact::new(hit.time, name(hit.body), other, upright(hit.point), upright(hit.normal))
                .with_strength(hit.approach, hit.impulse.length())
        }));
    }
    tracks.sort_by_key(|(ball, _)| *ball);
    impacts.sort_by(|a, b| a.time.total_cmp(&b.time));
    let tracks: Vec<Track> = tracks.into_iter().map(|(_, track)| track).collect();
    let last = tracks.iter().filter_map(|track| track.pieces.last()).map(|piece| piece.start);
    // One frame at least, where no ball is dropped.
    let shortest = (2.0 * arena.bins().drop / GRAVITY).sqrt();
    let (x, y) = arena.bins().extent();
    let view = View::from(0.0, 1.0, 0.6).showing(DVec3::ZERO, DVec3::new(x, arena.bins().depth, -y));
    let scenery = props::props(arena, word, draw).map_err(ModelError::new)?;
    Ok(Animation::new(last.fold(shortest, f64::max), tracks, impacts).with_scenery(scenery).with_view(view))
}
