//! The animation of a draw. The simulator's z points up; an animation's y does.

use super::arena::{Arena, GRAVITY};
use super::draw::Drops;
use super::settle::Work;
use crate::animation::{Animation, Impact, Piece, Track};
use glam::DVec3;
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::Other;
use plaus_sim::scenery::Surface;

pub(super) fn animate(arena: &Arena, draw: &Drops) -> Result<Animation, ModelError> {
    let (mut tracks, mut impacts) = (Vec::new(), Vec::new());
    for (fall, hits) in Work::default().record(arena, draw)? {
        let name = |member: usize| format!("ball_{}", fall.members[member]);
        for (member, way) in fall.ways.iter().enumerate() {
            let piece = |piece: &super::fall::Piece| Piece {
                start: piece.path.t,
                position: upright(piece.path.x),
                velocity: upright(piece.path.v),
                acceleration: upright(piece.path.a),
            };
            tracks.push((
                fall.members[member],
                Track { name: name(member), pieces: way.pieces.iter().map(piece).collect() },
            ));
        }
        impacts.extend(hits.iter().map(|hit| Impact {
            time: hit.time,
            body: name(hit.body),
            other: match hit.other {
                Other::Body(other) => name(other),
                Other::Surface(Surface::Plane(_)) => "wall".into(),
                Other::Surface(Surface::Dome(_)) => "floor".into(),
                Other::Surface(_) => "partition".into(),
            },
            point: upright(hit.point),
            normal: upright(hit.normal),
        }));
    }
    tracks.sort_by_key(|(ball, _)| *ball);
    impacts.sort_by(|a, b| a.time.total_cmp(&b.time));
    let tracks: Vec<Track> = tracks.into_iter().map(|(_, track)| track).collect();
    let last = tracks.iter().filter_map(|track| track.pieces.last()).map(|piece| piece.start);
    // One frame at least, where no ball is dropped.
    let shortest = (2.0 * arena.bins().drop / GRAVITY).sqrt();
    Ok(Animation { duration: last.fold(shortest, f64::max), tracks, impacts })
}

fn upright(v: DVec3) -> DVec3 {
    DVec3::new(v.x, v.z, -v.y)
}
