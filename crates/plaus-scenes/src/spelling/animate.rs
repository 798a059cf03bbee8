//! The animation of a draw. In the simulator z points up, in an animation y.

use super::arena::{Arena, GRAVITY};
use super::draw::Drops;
use super::reuse::Work;
use super::{Word, props};
use crate::animation::{Animation, Impact, Look, Piece, Shape, Track, View, upright};
use crate::touch::{Toucher, in_order};
use glam::DVec3;
use plaus_dist::math::square;
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::Other;
use plaus_sim::scenery::Surface;

/// Names of the scenery that a ball can hit.
pub(super) const FIXED: [&str; 6] = ["floor", "partitions", "wall_left", "wall_right", "wall_front", "wall_back"];

/// Name of the wall with this normal.
fn wall(normal: DVec3) -> &'static str {
    match (normal.x.abs() > normal.y.abs(), normal.x > 0.0, normal.y > 0.0) {
        (true, true, _) => "wall_left",
        (true, false, _) => "wall_right",
        (false, _, true) => "wall_front",
        (false, _, false) => "wall_back",
    }
}

/// What a marble touches during a piece: if gravity is not all that changes its velocity, the thing that it hit last,
/// or the floor if that is another marble.
fn touches(piece: &Piece, name: &str, hits: &[Impact]) -> Option<String> {
    let free = (piece.acceleration - DVec3::NEG_Y * GRAVITY).length() < 1e-6 * GRAVITY;
    let before = hits.partition_point(|hit| hit.time <= piece.start);
    let last = hits[..before].iter().rev().find(|hit| hit.body == name).filter(|_| !free)?;
    Some(if last.other.starts_with("ball") { "floor".to_owned() } else { last.other.clone() })
}

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
                Other::Surface(Surface::Plane(_)) => wall(hit.normal).into(),
                Other::Surface(Surface::Dome(_)) => "floor".into(),
                Other::Surface(_) => "partitions".into(),
            };
            Impact::new(hit.time, name(hit.body), other, upright(hit.point), upright(hit.normal))
                .with_strength(hit.approach, hit.impulse.length())
        }));
    }
    tracks.sort_by_key(|(ball, _)| *ball);
    impacts.sort_by(|a, b| a.time.total_cmp(&b.time));
    let tracks: Vec<Track> = tracks.into_iter().map(|(_, track)| track).collect();
    let radius = arena.bins().marble;
    let mass = 4.0 / 3.0 * std::f64::consts::PI * square(radius) * radius * arena.bins().density;
    let contacts = tracks.iter().flat_map(|Track { name, shape, pieces, .. }| {
        let end = pieces.last().map_or(0.0, |piece| piece.start);
        Toucher { name, shape, mass, pieces, end }.contacts(|piece| touches(&pieces[piece], name, &impacts))
    });
    let contacts = in_order(contacts.collect());
    let last = tracks.iter().filter_map(|track| track.pieces.last()).map(|piece| piece.start);
    // At least one frame, even if no ball is dropped.
    let shortest = (2.0 * arena.bins().drop / GRAVITY).sqrt();
    let (x, y) = arena.bins().extent();
    let view = View::from(0.0, 1.0, 0.6).showing(DVec3::ZERO, DVec3::new(x, arena.bins().depth, -y));
    let scenery = props::props(arena, word, draw).map_err(ModelError::new)?;
    Ok(Animation::new(last.fold(shortest, f64::max), tracks, impacts)
        .with_contacts(contacts)
        .with_scenery(scenery)
        .with_view(view))
}
