//! Where to look: at where things begin, meet, stand and come to rest, not at how far something rolls on.

use super::values::MM;
use crate::animation::{Animation, Form, Prop, Track, View, upright};
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DVec3;

/// Largest number in a viewpoint: 1 km, as for places.
const FARTHEST: f64 = 1e6;

settings! {
    /// From where pictures, videos and galleries look at the world.
    pub struct Viewpoint {
        /// The direction from what is seen to the eye, of any length: `[0, -1, 0.5]` is from the front and above.
        /// Unset, pictures look from higher up where something hides how it ends.
        from: [f64; 3] = [0.3, -1.0, 0.5];
        /// Two opposite corners of a box that should fill the picture. Empty: where things begin, meet, stand and come
        /// to rest, which differs from solution to solution.
        #[schemars(length(max = 2), extend("x-unit" = "mm"))]
        box_mm: Vec<[f64; 3]>;
    }
}

impl Viewpoint {
    /// Refuses directions without a level part, and boxes that are none.
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let wrong = |key: &str, message: &str| Err(ConfigError::new(format!("world.custom.view.{key}"), message));
        let is_place = |number: &f64| number.abs() <= FARTHEST;
        let [x, y, z] = self.from.map(f64::abs);
        if !self.from.iter().all(is_place) || x.max(y) <= 1e-6 * z || x.max(y) < f64::MIN_POSITIVE {
            return wrong("from", "a view from straight above has no up: give it a level part, such as [0, -0.01, 1]");
        }
        match self.box_mm[..] {
            [] => Ok(()),
            [a, b] if a.iter().chain(&b).all(is_place) && a != b => Ok(()),
            _ => wrong("box_mm", "a box has two corners that differ, at most 1,000,000 from the middle of the world"),
        }
    }

    /// The direction of view. The scenario's z points up; an animation's y does.
    fn direction(&self) -> View {
        let is_chosen = self.from != Self::default().from;
        View { from: upright(DVec3::from_array(self.from)), exact: is_chosen, ..View::from(0.0, 0.0, 0.0) }
    }

    /// The view, if it is the same of every animation.
    pub(super) fn fixed(&self) -> Option<View> {
        let [a, b] = self.box_mm[..] else { return None };
        let [a, b] = [a, b].map(|corner| upright(DVec3::from_array(corner)) * MM);
        Some(self.direction().only(a.min(b), a.max(b)))
    }

    /// The view of an animation with its scenery, some of which has no end.
    pub(super) fn of(&self, animation: &Animation, is_endless: impl Fn(&str) -> bool) -> View {
        self.fixed().unwrap_or_else(|| view(animation, self.direction(), is_endless))
    }
}

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

/// The same inside of what stands still, through which something may be fast.
const INNER_LOOKS: f64 = 120.0;

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

fn view(animation: &Animation, from: View, is_endless: impl Fn(&str) -> bool) -> View {
    let mut frame = Frame([DVec3::INFINITY, DVec3::NEG_INFINITY]);
    for track in &animation.motion.tracks {
        frame.add(track.position(0.0), track.shape.reach());
    }
    animation.motion.impacts.iter().filter(|hit| hit.speed >= HEARD).for_each(|hit| frame.add(hit.point, 0.0));
    // Where no body is there, all that stands still is shown.
    let longest =
        if animation.motion.tracks.is_empty() { f64::INFINITY } else { LARGE * frame.diagonal().max_element() };
    for points in animation.scenery.iter().filter(|prop| !is_endless(&prop.name)).filter_map(corners) {
        let mut whole = Frame([DVec3::INFINITY, DVec3::NEG_INFINITY]);
        points.iter().for_each(|&point| whole.add(point, 0.0));
        if whole.diagonal().max_element() <= longest || is_gone_through(animation, &whole) {
            whole.0.iter().for_each(|&corner| frame.add(corner, 0.0));
        }
    }
    let reach = animation.motion.tracks.iter().map(|track| track.shape.reach()).fold(0.0, f64::max);
    let beyond = DVec3::splat((BEYOND * frame.diagonal().length()).max(REACHES * reach));
    let [low, high] = [frame.0[0] - beyond, frame.0[1] + beyond];
    for track in &animation.motion.tracks {
        way(animation, track, LOOKS).for_each(|at| frame.add(at.clamp(low, high), 0.0));
    }
    add_ends(&mut frame, animation);
    if frame.0[0].is_finite() { from.only(frame.0[0], frame.0[1]) } else { from }
}

/// Places of a body from the beginning to the end, so many in a second.
fn way<'a>(animation: &Animation, track: &'a Track, looks: f64) -> impl Iterator<Item = DVec3> + 'a {
    let (duration, steps) =
        (animation.motion.duration, (animation.motion.duration * looks).ceil().clamp(1.0, 1e4) as u32);
    (0..=steps).map(move |step| track.position(duration * f64::from(step) / f64::from(steps)))
}

/// Whether a body's way inside a box is as long as half of that: through a loop or about a bowl.
fn is_gone_through(animation: &Animation, whole: &Frame) -> bool {
    let [low, high] = whole.0;
    animation.motion.tracks.iter().any(|track| {
        let mut inside = Frame([DVec3::INFINITY, DVec3::NEG_INFINITY]);
        let is_in = |at: &DVec3| at.cmpgt(low).all() && at.cmplt(high).all();
        way(animation, track, INNER_LOOKS).filter(is_in).for_each(|at| inside.add(at, 0.0));
        inside.diagonal().max_element() >= 0.5 * whole.diagonal().max_element()
    })
}

/// Adds where bodies come to rest, and the nearest end of a way if none would be seen.
fn add_ends(frame: &mut Frame, animation: &Animation) {
    let ([low, high], far) = (frame.0, FAR * frame.diagonal().length());
    let end = animation.motion.duration;
    let distance = |at: DVec3| (at - at.clamp(low, high)).length();
    let ends: Vec<_> = animation.motion.tracks.iter().map(|track| (track.position(end), track)).collect();
    // The animation may end as soon as the last body is at rest.
    let rests = |track: &Track| track.pieces.last().is_some_and(|piece| piece.rests());
    for (at, track) in ends.iter().filter(|(at, track)| rests(track) && distance(*at) <= far) {
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
            Viewpoint::default().of(&animation, |_| false).frame.unwrap()
        };
        let [low, high] = seen(2.0, 1.1);
        assert!(high.x >= 1.15 && high.y >= 1.0 && low.x <= -0.05, "{low} {high}");
        assert!(high.z < 0.5, "{high}");
        let [_, high] = seen(2.0, 100.0);
        assert!(high.x > 100.0, "what stands far away is seen: {high}");
    }
    /// A ball that comes to rest 3 m from where it began is seen there, also if the animation ends at that moment and
    /// another ball lies still; one that rolls on is, as no other is seen.
    #[test]
    fn where_things_come_to_rest_is_seen() {
        let still = DVec3::ZERO;
        for (speed, until, others) in [(3.0, 1.0, 0), (0.5, 6.0, 0), (0.5, 6.0, 1)] {
            let rest = Piece::ballistic(until, DVec3::X * 3.0, still, still);
            let pieces = vec![Piece::ballistic(0.0, still, DVec3::X * speed, still), rest];
            let track = Track::new("ball", Shape::ball(0.25), Look::STONE, pieces);
            let at = Piece::ballistic(0.0, DVec3::Z, still, still);
            let other = Track::new("other", Shape::ball(0.25), Look::STONE, vec![at]);
            let tracks = std::iter::once(track).chain(vec![other; others]).collect();
            let animation = Animation::new(6.0, tracks, Vec::new());
            let [_, high] = Viewpoint::default().of(&animation, |_| false).frame.unwrap();
            assert!(high.x >= 3.25, "{high}");
        }
    }

    /// A viewpoint of the scenario, z up, is the animation's, y up.
    #[test]
    fn a_viewpoint_looks_where_it_says() {
        let viewpoint = Viewpoint { from: [0.0, -2.0, 1.0], box_mm: vec![[100.0, 0.0, 0.0], [0.0, 200.0, 300.0]] };
        viewpoint.check().unwrap();
        let view = viewpoint.of(&Animation::new(1.0, Vec::new(), Vec::new()), |_| false);
        assert_eq!(view.from, DVec3::new(0.0, 1.0, 2.0));
        let [low, high] = view.frame.unwrap();
        assert!((low - DVec3::new(0.0, 0.0, -0.2)).length() < 1e-12 && view.alone, "{low}");
        assert!((high - DVec3::new(0.1, 0.3, 0.0)).length() < 1e-12, "{high}");
        for bad in [[0.0, 0.0, 1.0], [0.0; 3], [f64::NAN, 1.0, 0.0], [1e9, 0.0, 0.0]] {
            assert!(Viewpoint { from: bad, ..Viewpoint::default() }.check().is_err(), "{bad:?}");
        }
        for bad in [vec![[0.0; 3]], vec![[0.0; 3]; 2], vec![[f64::NAN; 3], [0.0; 3]]] {
            assert!(Viewpoint { box_mm: bad, ..Viewpoint::default() }.check().is_err());
        }
    }
}
