//! Where to look: at where things begin, meet, stand and come to rest, not at how far something rolls on.

use crate::animation::{Animation, Form, Prop, Track, View};
use glam::DVec3;

/// Approach in m/s of the impacts that are to be seen: one that is heard. What rolls away has none any more.
const HEARD: f64 = 0.2;

/// What stands still is to be seen where it is at most so many times as long as what happens.
const LARGE: f64 = 8.0;

/// How far beyond that ways are followed: as a part of its diagonal, and in reaches of the largest body.
const BEYOND: f64 = 0.2;
const REACHES: f64 = 6.0;

/// How far away the place of rest of a body may be that is to be seen, in diagonals of what happens before. Of bodies
/// that all roll on, the nearest is seen as far away as that.
const FAR: f64 = 8.0;

/// Places of a way that are looked at, a second.
const LOOKS: f64 = 20.0;

/// Way in m within one look up to which a body is at rest.
const STILL: f64 = 1e-9;

/// A box that grows.
#[derive(Debug, Clone, Copy)]
struct Frame([DVec3; 2]);

impl Frame {
    fn add(&mut self, point: DVec3, reach: f64) {
        let [low, high] = self.0;
        self.0 = [low.min(point - DVec3::splat(reach)), high.max(point + DVec3::splat(reach))];
    }

    fn diagonal(&self) -> DVec3 {
        (self.0[1] - self.0[0]).max(DVec3::ZERO)
    }
}

/// The view of an animation with its scenery, some of which has no end.
pub(super) fn view(animation: &Animation, is_endless: impl Fn(&str) -> bool) -> View {
    let mut frame = Frame([DVec3::INFINITY, DVec3::NEG_INFINITY]);
    for track in &animation.tracks {
        frame.add(track.position(0.0), track.shape.reach());
    }
    animation.impacts.iter().filter(|hit| hit.speed >= HEARD).for_each(|hit| frame.add(hit.point, 0.0));
    // Where no body is there, all that stands still is shown.
    let longest = if animation.tracks.is_empty() { f64::INFINITY } else { LARGE * frame.diagonal().max_element() };
    for points in animation.scenery.iter().filter(|prop| !is_endless(&prop.name)).filter_map(corners) {
        let mut whole = Frame([DVec3::INFINITY, DVec3::NEG_INFINITY]);
        points.iter().for_each(|&point| whole.add(point, 0.0));
        if whole.diagonal().max_element() <= longest {
            whole.0.iter().for_each(|&corner| frame.add(corner, 0.0));
        }
    }
    let reach = animation.tracks.iter().map(|track| track.shape.reach()).fold(0.0, f64::max);
    let beyond = DVec3::splat((BEYOND * frame.diagonal().length()).max(REACHES * reach));
    let [low, high] = [frame.0[0] - beyond, frame.0[1] + beyond];
    for track in &animation.tracks {
        let steps = (animation.duration * LOOKS).ceil().clamp(1.0, 1e4) as u32;
        for step in 0..=steps {
            let at = track.position(animation.duration * f64::from(step) / f64::from(steps));
            frame.add(at.clamp(low, high), 0.0);
        }
    }
    add_ends(&mut frame, animation);
    let view = View::from(0.3, 0.5, 1.0);
    if frame.0[0].is_finite() { view.only(frame.0[0], frame.0[1]) } else { view }
}

/// Adds where bodies come to rest, and the nearest end of a way if none would be seen.
fn add_ends(frame: &mut Frame, animation: &Animation) {
    let ([low, high], far) = (frame.0, FAR * frame.diagonal().length());
    let end = animation.duration;
    let distance = |at: DVec3| (at - at.clamp(low, high)).length();
    let ends: Vec<_> = animation.tracks.iter().map(|track| (track.position(end), track)).collect();
    let rests = |at: DVec3, track: &Track| (track.position(end - 1.0 / LOOKS) - at).length() < STILL;
    for (at, track) in ends.iter().filter(|(at, track)| rests(*at, track) && distance(*at) <= far) {
        frame.add(*at, track.shape.reach());
    }
    let nearest = ends.iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
    if let Some((at, track)) = nearest.filter(|(at, _)| distance(*at) <= far) {
        frame.add(*at, track.shape.reach());
    }
}

/// Points that hold what stands still, of what has an end.
fn corners(prop: &Prop) -> Option<Vec<DVec3>> {
    match &prop.form {
        Form::Block { centre, half, orientation } => {
            let side = |k: u32, axis: u32| if k >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let corner = |k| *centre + *orientation * (*half * DVec3::new(side(k, 0), side(k, 1), side(k, 2)));
            Some((0..8).map(corner).collect())
        }
        Form::Mesh { vertices, .. } => Some(vertices.clone()),
        Form::Plane { .. } | Form::Heightfield { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::animation::{Impact, Look, Piece, Shape};

    /// A ball that hits a post 1 m away and rolls 50 m to the side: the post is seen, the end of the way is not.
    #[test]
    fn what_rolls_away_makes_the_rest_no_smaller() {
        let still = DVec3::ZERO;
        let pieces = vec![
            Piece::ballistic(0.0, still, DVec3::X, still),
            Piece::ballistic(1.0, DVec3::X, DVec3::new(0.0, 0.0, 5.0), still),
        ];
        let track = Track::new("ball", Shape::ball(0.05), Look::STONE, pieces);
        let hit = |speed| vec![Impact::new(1.0, "ball", "post", DVec3::X, DVec3::X).with_strength(speed, 1.0)];
        let post = |x| Prop::block("post", Look::STONE, DVec3::new(x, 0.5, 0.0), DVec3::new(0.05, 0.5, 0.05));
        let seen = |speed, x| {
            let animation = Animation::new(11.0, vec![track.clone()], hit(speed)).with_scenery(vec![post(x)]);
            view(&animation, |_| false).frame.unwrap()
        };
        let [low, high] = seen(2.0, 1.1);
        assert!(high.x >= 1.15 && high.y >= 1.0 && low.x <= -0.05, "{low} {high}");
        assert!(high.z < 0.5, "{high}");
        let [_, high] = seen(2.0, 100.0);
        assert!(high.x > 100.0, "what stands far away is seen: {high}");
    }
    /// A ball that comes to rest 3 m from where it began is seen there; one that rolls on is, as no other is seen.
    #[test]
    fn where_things_come_to_rest_is_seen() {
        let still = DVec3::ZERO;
        for (speed, until) in [(3.0, 1.0), (0.5, 6.0)] {
            let rest = Piece::ballistic(until, DVec3::X * 3.0, still, still);
            let pieces = vec![Piece::ballistic(0.0, still, DVec3::X * speed, still), rest];
            let track = Track::new("ball", Shape::ball(0.25), Look::STONE, pieces);
            let [_, high] = view(&Animation::new(6.0, vec![track], Vec::new()), |_| false).frame.unwrap();
            assert!(high.x >= 3.25, "{high}");
        }
    }
}
