//! How a viewer sees a solution: where its bodies go, whatever time they take, and how they end, as parts of the size
//! of what is seen.

use crate::animation::{Animation, Motion, Shape, Track};
use crate::require::Cast;
use crate::scene::Scene;
use crate::uneven::SCATTER;
use glam::{DMat3, DVec3};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{Law, Look, SolutionClass, StateRefOf};
use std::sync::OnceLock;

/// How far apart bodies must be to look clearly different, as a part of the diagonal of what is seen: about the width
/// of a finger on a screen.
const CLEAR: f64 = 0.03;

/// Points of a way that are compared, at equal shares of its length.
const POINTS: usize = 24;

/// Numbers of each thing that is compared: a way; an end.
const WIDTH: usize = 3 * POINTS;

/// Draws of the prior that show what is seen, and tries to find them.
const REFERENCES: usize = 3;
const TRIES: u64 = 50;

/// Looks at each piece of a motion, and pieces of a way that are looked at.
const LOOKS: usize = 4;
const PIECES: usize = 1024;

/// How solutions of a scene are told apart.
#[derive(Debug, Clone)]
pub(crate) struct Screen {
    /// How many times as large as usual differences must be: in cells, and as they are seen.
    pub(crate) scale: f64,
    /// What is seen, once it is asked for.
    seen: OnceLock<Option<Seen>>,
}

impl Screen {
    pub(crate) fn of(scale: f64) -> Self {
        Self { scale, seen: OnceLock::new() }
    }

    /// How a solution looks.
    pub(crate) fn look<S: Scene>(&self, scene: &S, state: StateRefOf<'_, S>, cast: &Cast) -> Look {
        let seen = self.seen.get_or_init(|| Seen::of(scene));
        let motion = seen.and_then(|seen| Some((seen, scene.motion(state.draw).ok()?)));
        let look = motion.map_or_else(Look::default, |(seen, motion)| seen.look(&motion, cast, self.scale));
        Look { release: release(scene, state, cast), ..look }
    }
}

/// What is seen of a scene: a box.
#[derive(Debug, Clone, Copy)]
struct Seen {
    low: DVec3,
    high: DVec3,
}

impl Seen {
    /// What is seen of a middling one of some draws of the prior, always the same ones; `None` if no draw can be
    /// simulated.
    fn of<S: Scene>(scene: &S) -> Option<Self> {
        let streams = Seed(0).chain(1 << 62 | 2);
        let mut all: Vec<Self> = Vec::new();
        for number in 0..TRIES {
            let draw = scene.start(&mut streams.at(number, Purpose::START));
            if scene.log_prior(&draw).is_ok_and(|density| !density.is_zero())
                && let Ok(animation) = scene.animate(&draw)
            {
                all.push(Self::of_one(&animation));
            }
            if all.len() == REFERENCES {
                break;
            }
        }
        all.sort_by(|a, b| a.size().total_cmp(&b.size()));
        all.get(all.len() / 2).copied().filter(|seen| seen.size() > 0.0 && seen.size().is_finite())
    }

    fn of_one(animation: &Animation) -> Self {
        let frame = animation.view.and_then(|view| view.frame);
        let [low, high] = frame.unwrap_or([DVec3::INFINITY, DVec3::NEG_INFINITY]);
        let mut seen = Self { low, high };
        if frame.is_none() {
            let reach = |track: &Track| DVec3::splat(track.shape.reach());
            for (track, point) in animation.motion.tracks.iter().flat_map(|track| {
                let ends = [0.0, 0.5, 1.0].map(|share| (track, track.position(share * animation.motion.duration)));
                ends.into_iter()
            }) {
                (seen.low, seen.high) = (seen.low.min(point - reach(track)), seen.high.max(point + reach(track)));
            }
        }
        seen
    }

    /// Its diagonal.
    fn size(&self) -> f64 {
        (self.high - self.low).length()
    }

    /// How a motion looks in which clear differences are `scale` times as large as usual.
    fn look(&self, motion: &Motion, cast: &Cast, scale: f64) -> Look {
        let unit = 1.0 / (CLEAR * scale * self.size());
        let mut seen = vec![0.0; 2 * WIDTH * cast.bodies.len()];
        for (name, place) in cast.bodies.iter().zip(seen.chunks_mut(2 * WIDTH)) {
            let Some(track) = motion.tracks.iter().find(|track| track.name == *name) else { continue };
            let (way, end) = place.split_at_mut(WIDTH);
            let points = self.way(track, motion.duration);
            let spread = unit / (POINTS as f64).sqrt();
            way.chunks_mut(3).zip(points).for_each(|(place, point)| write(place, point * spread));
            write(&mut end[..3], self.clamped(track.position(motion.duration)) * unit);
            if !matches!(*track.shape, Shape::Sphere { holes: false, .. }) {
                // The root mean square of how far turning takes the points of a ball of the body's reach.
                let turned = DMat3::from_quat(track.orientation(motion.duration));
                let arm = unit * track.shape.reach() / 3.0_f64.sqrt();
                let axes = [turned.x_axis, turned.y_axis, turned.z_axis];
                end[3..].chunks_mut(3).zip(axes).for_each(|(place, axis)| write(place, axis * arm));
            }
        }
        Look { release: None, seen, width: WIDTH as u32 }
    }

    /// The nearest point that is within half a size of what is seen: what happens farther off is not looked at.
    fn clamped(&self, point: DVec3) -> DVec3 {
        let beyond = DVec3::splat(0.5 * self.size());
        point.clamp(self.low - beyond, self.high + beyond)
    }

    /// Points of a body's way at equal shares of its length.
    fn way(&self, track: &Track, end: f64) -> Vec<DVec3> {
        let starts: Vec<f64> = track.pieces.iter().map(|piece| piece.start).filter(|&start| start < end).collect();
        let stride = starts.len().div_ceil(PIECES).max(1);
        let mut starts: Vec<f64> = starts.into_iter().step_by(stride).chain([end]).collect();
        starts[0] = starts[0].max(0.0);
        let looks = starts.windows(2).flat_map(|pair| {
            let part = move |look| pair[0] + (pair[1] - pair[0]) * look as f64 / LOOKS as f64;
            (0..LOOKS).map(part)
        });
        let points: Vec<DVec3> = looks.chain([end]).map(|time| self.clamped(track.position(time))).collect();
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).length());
        }
        let whole = lengths[lengths.len() - 1];
        let at = |share: f64| {
            let wanted = share * whole;
            let next = lengths.partition_point(|&length| length < wanted).clamp(1, points.len().max(2) - 1);
            let Some(&after) = points.get(next) else { return points[0] };
            let step = lengths[next] - lengths[next - 1];
            let part = if step > 0.0 { ((wanted - lengths[next - 1]) / step).clamp(0.0, 1.0) } else { 0.0 };
            points[next - 1].lerp(after, part)
        };
        (0..POINTS).map(|point| at(point as f64 / (POINTS - 1) as f64)).collect()
    }
}

fn write(place: &mut [f32], point: DVec3) {
    place.copy_from_slice(&point.as_vec3().to_array());
}

/// A number for the values with which bodies begin: those that are named after a body, or all where none is. `None` if
/// these are not numbers alone, or none of them is sure to differ from draw to draw.
fn release<S: Scene>(scene: &S, state: StateRefOf<'_, S>, cast: &Cast) -> Option<u64> {
    let of_body = |name: &str| {
        let mut heads = name.match_indices('.').map(|(dot, _)| &name[..dot]);
        heads.any(|head| cast.bodies.iter().any(|body| body == head))
    };
    let vars = scene.vars();
    if !vars.which(|var| var.name == SCATTER).is_empty() {
        return None; // bodies that begin alike go other ways
    }
    let (all, named) = (vars.which(|_| true), vars.which(|var| of_body(&var.name)));
    let (mut class, mut is_continuous) = (SolutionClass::EMPTY, false);
    for var in if named.is_empty() { all } else { named } {
        let Some(values) = scene.get(state.draw, var) else {
            if !vars.get(var).optional {
                return None; // an orientation, or a table
            }
            class = class.with(-1);
            continue;
        };
        is_continuous |= !matches!(vars.get(var).law, Law::Fixed(_) | Law::Number(_) | Law::Own);
        class = values.iter().fold(class, |class, value| class.with(value.to_bits().cast_signed()));
    }
    is_continuous.then_some(class.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::animation::{Look as Paint, Piece};

    fn ball(end: DVec3, seconds: f64) -> Motion {
        let pieces = vec![Piece::ballistic(0.0, DVec3::ZERO, end / seconds, DVec3::ZERO), Piece::resting(seconds, end)];
        let track = Track::new("ball", Shape::ball(0.1), Paint::nth(0), pieces);
        Motion::new(10.0, vec![track], vec![])
    }

    /// A way counts, not the time that it takes, nor how far something goes on outside of what is seen.
    #[test]
    fn ways_and_ends_count_as_parts_of_what_is_seen() {
        let seen = Seen { low: DVec3::ZERO, high: DVec3::new(1.0, 0.0, 0.0) };
        let cast = Cast { bodies: vec!["ball".to_owned()], ..Cast::default() };
        let look = |end: [f64; 3], seconds| seen.look(&ball(DVec3::from(end), seconds), &cast, 1.0);
        let distance = |a: [f64; 3], b: [f64; 3]| look(a, 1.0).distance(&look(b, 1.0));
        assert!(look([1.0, 0.0, 0.0], 1.0).distance(&look([1.0, 0.0, 0.0], 7.0)) < 1e-5);
        let near = distance([1.0, 0.0, 0.0], [1.0, 0.0, 0.9 * CLEAR]);
        assert!((near - 0.9).abs() < 1e-4, "{near}");
        assert!(distance([1.0, 0.0, 0.0], [1.0, 0.0, 1.1 * CLEAR]) > 1.0);
        assert!(distance([100.0, 0.0, 0.0], [200.0, 0.0, 0.0]) < 1e-4);
        // Twice as much must differ.
        let wide = |end| seen.look(&ball(DVec3::from(end), 1.0), &cast, 2.0);
        let half = wide([1.0, 0.0, 0.0]).distance(&wide([1.0, 0.0, CLEAR]));
        assert!((half - 0.5).abs() < 1e-4, "{half}");
        // What is not there is seen at no place, the same in all.
        let none = Motion::new(10.0, vec![], vec![]);
        assert_eq!(seen.look(&none, &cast, 1.0).distance(&seen.look(&none, &cast, 1.0)), 0.0);
    }
}
