//! The animation of a draw. In the simulator z points up, in an animation y.

use super::arena::{Arena, GRAVITY};
use super::draw::Drops;
use super::fall::Fall;
use super::{Word, props};
use crate::animation::{self, Animation, Impact, Look, Motion, Shape, Track, View, upright};
use crate::film::{Figure, impact};
use crate::require::Begun;
use crate::way::Piece;
use glam::DVec3;
use plaus_dist::math::square;
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::Other;
use plaus_sim::scenery::Surface;
use std::sync::Arc;

/// Names of the scenery that a ball can hit.
pub(super) const FIXED: [&str; 6] = ["floor", "partitions", "wall_left", "wall_right", "wall_front", "wall_back"];

/// Name of the wall with this normal.
pub(super) fn wall(normal: DVec3) -> &'static str {
    match (normal.x.abs() > normal.y.abs(), normal.x > 0.0, normal.y > 0.0) {
        (true, true, _) => "wall_left",
        (true, false, _) => "wall_right",
        (false, _, true) => "wall_front",
        (false, _, false) => "wall_back",
    }
}

/// What a marble touches during a piece: if gravity is not all that changes its velocity, the thing that it hit last,
/// or the floor if that is another marble.
fn touches(piece: &animation::Piece, name: &str, hits: &[Impact]) -> Option<String> {
    let free = (piece.acceleration - DVec3::NEG_Y * GRAVITY).length() < 1e-6 * GRAVITY;
    let before = hits.partition_point(|hit| hit.time <= piece.start);
    let last = hits[..before].iter().rev().find(|hit| hit.body == name).filter(|_| !free)?;
    Some(if last.other.starts_with("ball") { "floor".to_owned() } else { last.other.clone() })
}

/// The balls of some groups, which are known before `known`, in s.
pub(super) fn film(arena: &Arena, groups: &[Arc<Fall>], known: f64) -> Begun {
    let (mut figures, mut impacts) = (Vec::new(), Vec::new());
    let radius = arena.bins.marble;
    let mass = 4.0 / 3.0 * std::f64::consts::PI * square(radius) * radius * arena.bins.density;
    for fall in groups {
        let name = |member: usize| format!("ball_{}", fall.members[member]);
        for (&ball, (member, way)) in fall.members.iter().zip(fall.ways.iter().enumerate()) {
            // A ball that has not been dropped waits for its first piece.
            let has_begun = |(k, piece): &(usize, &Piece)| *k == 0 || piece.path.t < known;
            let pieces = way.pieces.iter().enumerate().take_while(has_begun).map(|(_, Piece { path, .. })| {
                animation::Piece::ballistic(path.t, upright(path.x), upright(path.v), upright(path.a))
            });
            let pieces: Vec<animation::Piece> = pieces.collect();
            let last = pieces.last().map_or(0.0, |piece| piece.start);
            let track = Track::new(name(member), Shape::ball(radius), Look::nth(ball), pieces);
            figures.push((ball, last, Figure { track, mass, end: if known.is_finite() { known } else { last } }));
        }
        impacts.extend(fall.impacts.iter().flatten().filter(|hit| hit.time < known).map(|hit| {
            let other = match hit.other {
                Other::Body(other) => name(other),
                Other::Surface(Surface::Plane(_)) => wall(hit.normal).into(),
                Other::Surface(Surface::Dome(_)) => "floor".into(),
                Other::Surface(_) => "partitions".into(),
            };
            impact(hit, [name(hit.body), other], hit.time, DVec3::ZERO)
        }));
    }
    figures.sort_by_key(|(ball, ..)| *ball);
    impacts.sort_by(|a, b| a.time.total_cmp(&b.time));
    // At least one frame, even if no ball is dropped.
    let shortest = (2.0 * arena.bins.drop / GRAVITY).sqrt();
    let duration = figures.iter().fold(shortest, |duration, (_, last, _)| f64::max(duration, *last));
    let figures = figures.into_iter().map(|(.., figure)| figure).collect();
    crate::film::film(figures, impacts, (duration, known, known), |index, piece, figures, impacts| {
        let track = &figures[index].track;
        touches(&track.pieces[piece], &track.name, impacts)
    })
}

/// Balls with their box.
pub(super) fn animate(arena: &Arena, word: &Word, draw: &Drops, balls: Motion) -> Result<Animation, ModelError> {
    let (x, y) = arena.bins.extent();
    let view = View::from(0.0, 1.0, 0.6).showing(DVec3::ZERO, DVec3::new(x, arena.bins.depth, -y));
    let scenery = props::props(arena, word, draw).map_err(ModelError::new)?;
    Ok(Animation::from(balls).with_scenery(scenery).with_view(view))
}
