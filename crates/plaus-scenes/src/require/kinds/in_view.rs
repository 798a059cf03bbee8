//! What a camera sees.

use crate::animation::{Eye, Shape, Track, upright};
use crate::require::cast::Cast;
use crate::require::kinds::{Ask, How};
use crate::require::looks::Looks;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{FAR, Reach};
use crate::require::sight::{Cone, Sight};
use crate::require::timed::Timed;
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DVec3;
use plaus_dist::math;
use std::f64::consts::TAU;

/// Points of a body's surface that are looked at.
const POINTS: u32 = 128;

/// Beside what is hidden, directions that are tried at one angle.
const ROUND: u32 = 8;
/// By what the angle then grows, and its end in degrees.
const WIDER: f64 = 1.25;
const WIDEST: f64 = 60.0;

settings! {
    /// A camera sees a body: it is in the picture, and no other body and no scenery hides it. Glass and marks hide
    /// nothing.
    pub struct InView {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// The camera. Unset: the one that looks at the world's `view`, which must then have a `box_mm`. Pictures may
        /// look from higher up, and leave room for shadows.
        camera: Option<Camera>;
        /// Width of the picture over its height.
        aspect: f64 = 16.0 / 9.0, 0.1..=10.0;
        /// How much of the side that faces the camera must be seen, as a part of it, judged at 128 points of the
        /// surface. Unset: half; with `how = "never"`, none of it may be seen.
        #[schemars(extend("x-example" = 0.9))]
        at_least: Option<f64>, 0.01..=1.0;
        /// How broad an edge of the picture does not count, as a part of its width and height.
        edge: f64 = 0.0, 0.0..=0.45;
        /// Whether at some time of the window, always, never, or at the end. A window is looked at frame by frame,
        /// `when.fps` a second; at a time that `when` gives, all but `never` mean the same.
        how: How;
        /// How much less than `at_least` costs one nat, as a part of the side that faces the camera.
        scale: f64 = 0.1, 1e-6..=1e3;
        /// How many degrees beside the picture, or behind what hides it, cost one more nat.
        scale_deg: f64 = 2.0, 1e-3..=1e4, "degree";
        /// The time, or the window of time.
        when: When;
    }

    /// Where a camera is and looks. z points up in its picture; y, if it looks straight down or up.
    pub struct Camera {
        /// Its place.
        #[schemars(extend("x-unit" = "mm"))]
        at_mm: [f64; 3] = [0.0, -2000.0, 1000.0];
        /// A place in the middle of its picture.
        #[schemars(extend("x-unit" = "mm"))]
        look_at_mm: [f64; 3] = [0.0, 0.0, 0.0];
        /// Its vertical field of view.
        fov_deg: f64 = 24.0, 1.0..=170.0, "degree";
    }
}

/// Points of a shape's surface, each for an equally large part of it, with normals.
fn points(shape: &Shape) -> Vec<[DVec3; 2]> {
    let (corners, faces) = shape.surface();
    let mut sum = 0.0;
    let faces = faces.iter().filter_map(|face| {
        let [a, b, c] = face.map(|corner| corners.get(corner as usize).copied().unwrap_or_default());
        let twice = (b - a).cross(c - a);
        sum += twice.length();
        (twice != DVec3::ZERO).then(|| (sum, [a, b - a, c - a], twice.normalize()))
    });
    let faces: Vec<(f64, [DVec3; 3], DVec3)> = faces.collect();
    let one = |k: u32| {
        let share = (f64::from(k) + 0.5) / f64::from(POINTS);
        let (_, [corner, a, b], normal) = *faces.get(faces.partition_point(|face| face.0 < share * sum))?;
        // A sequence that fills the square evenly (Roberts 2018), folded into the triangle.
        let [u, v] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2].map(|step| (0.5 + f64::from(k) * step).fract());
        let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
        Some([corner + u * a + v * b, normal])
    };
    (0..POINTS).filter_map(one).collect()
}

/// Half the angle in rad at which a ball appears.
fn appears(eye: &Eye, centre: DVec3, radius: f64) -> f64 {
    math::asin((radius / centre.distance(eye.at)).min(1.0))
}

/// A body that is looked at.
struct Seen<'a> {
    probe: &'a Probe<'a>,
    track: &'a Track,
    eye: Eye,
    points: Vec<[DVec3; 2]>,
}

impl InView {
    /// The eye, if it is given, or the scene has a view that is the same in every motion.
    fn eye(&self, cast: &Cast) -> Option<Eye> {
        let [at, to] = match &self.camera {
            Some(camera) => [camera.at_mm, camera.look_at_mm].map(|place| upright(1e-3 * DVec3::from_array(place))),
            None => {
                let view = cast.view?;
                return Some(Eye::fitting(view.frame?, view.from, Eye::upwards(view.from), Eye::FIELD, self.aspect));
            }
        };
        Some(Eye::looking(at, to, self.camera.as_ref()?.fov_deg))
    }

    fn least(&self) -> f64 {
        self.at_least.unwrap_or(if self.how == How::Never { 0.01 } else { 0.5 })
    }

    /// Tangents of half the fields of view of what counts of the picture.
    fn halves(&self, eye: &Eye) -> [f64; 2] {
        [self.aspect, 1.0].map(|times| eye.half * times * (1.0 - 2.0 * self.edge))
    }

    fn is_in_picture(&self, eye: &Eye, point: DVec3) -> bool {
        let r = point - eye.at;
        let ([x, y], far) = ([r.dot(eye.right), r.dot(eye.up)], r.dot(eye.forward));
        let [width, height] = self.halves(eye);
        far > 0.0 && x.abs() <= width * far && y.abs() <= height * far
    }

    /// How many degrees a ball lies beside the picture.
    fn beside(&self, eye: &Eye, centre: DVec3, radius: f64) -> f64 {
        let r = centre - eye.at;
        let far = r.dot(eye.forward);
        let nearest = |along: DVec3, most: f64| match r.dot(along) {
            x if far > 0.0 => (x / far).clamp(-most, most),
            0.0 => 0.0,
            x => most.copysign(x),
        };
        let [width, height] = self.halves(eye);
        let edge = eye.forward + nearest(eye.right, width) * eye.right + nearest(eye.up, height) * eye.up;
        let angle = math::atan2(edge.cross(r).length(), edge.dot(r));
        (angle - appears(eye, centre, radius)).max(0.0).to_degrees()
    }

    /// How much of the side that faces the eye is seen, as a part of it.
    fn share(&self, seen: &Seen<'_>, time: f64) -> f64 {
        let Seen { probe, track, eye, points } = seen;
        let (at, turn) = (track.position(time), track.orientation(time));
        let sight = Sight::of(probe, time, track, &Cone::to_ball(eye.at, at, track.shape.reach()));
        let [mut all, mut visible] = [0.0; 2];
        for [point, normal] in points {
            let point = at + turn * *point;
            let back = eye.at - point;
            let facing = (turn * *normal).dot(back);
            if facing > 0.0 {
                let far = back.length();
                let size = facing / (far * far * far);
                all += size;
                let is_seen = self.is_in_picture(eye, point) && (sight.is_empty() || sight.is_clear(eye.at, point));
                visible += if is_seen { size } else { 0.0 };
            }
        }
        if all > 0.0 { visible / all } else { 0.0 }
    }

    /// How many degrees beside a body that is hidden nothing is in the way.
    fn behind(&self, seen: &Seen<'_>, time: f64) -> f64 {
        let Seen { probe, track, eye, .. } = seen;
        let at = track.position(time);
        let sight = Sight::of(probe, time, track, &Cone::about(eye.at, at));
        let axis = (at - eye.at).normalize_or(eye.forward);
        let ([across, other], far) = (<[DVec3; 2]>::from(axis.any_orthonormal_pair()), at.distance(eye.at));
        let (first, mut turn) = (appears(eye, at, track.shape.reach()), 0.0);
        let mut angle = first;
        while angle < WIDEST.to_radians() {
            let (sin, cos) = math::sin_cos(angle);
            let is_clear = |k: u32| {
                let (y, x) = math::sin_cos(TAU * (f64::from(k) + turn) / f64::from(ROUND));
                sight.is_clear(eye.at, eye.at + far * (cos * axis + sin * (x * across + y * other)))
            };
            if (0..ROUND).any(is_clear) {
                return (angle - first).to_degrees();
            }
            (angle, turn) = (angle * WIDER, 0.5 - turn);
        }
        WIDEST
    }

    /// The margin at one time. What is not there hides nothing: it may only be less.
    fn margin(&self, seen: &Seen<'_>, time: f64) -> f64 {
        let Seen { track, eye, .. } = seen;
        if !track.is_there(time) {
            return -FAR;
        }
        let share = self.share(seen, time);
        let margin = (share - self.least()) / self.scale;
        if share > 0.0 {
            return margin;
        }
        let beside = self.beside(eye, track.position(time), track.shape.reach());
        let lacking = if beside > 0.0 { beside } else { self.behind(seen, time) };
        (margin - lacking / self.scale_deg).max(-FAR)
    }

    /// The known times at which it is looked at, and whether these are all.
    fn moments(&self, probe: &Probe<'_>) -> (Vec<f64>, bool) {
        if !self.when.is_set() {
            return if probe.is_whole() { (vec![probe.end()], true) } else { (Vec::new(), false) };
        }
        let window = self.when.moments();
        let Some([from, to]) = probe.seen(window) else { return (Vec::new(), false) };
        let frame = |time: f64| time * self.when.fps;
        let frames = (frame(from).floor() as u64 + 1..frame(to).ceil() as u64).map(|k| k as f64 / self.when.fps);
        let mut times: Vec<f64> = std::iter::once(from).chain(frames).chain((to > from).then_some(to)).collect();
        times.retain(|time| *time < probe.known());
        (times, probe.sees_all(window))
    }

    fn seen<'a>(&self, probe: &'a Probe<'a>) -> Option<Seen<'a>> {
        let (track, eye) = (probe.track(&self.body)?, self.eye(probe.cast())?);
        Some(Seen { probe, track, eye, points: points(&track.shape) })
    }
}

impl Ask for InView {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        self.when.check(place)?;
        if let Some(camera) = &self.camera {
            let is_place = |place: [f64; 3]| place.iter().all(|x| x.abs() <= 1e6);
            if !is_place(camera.at_mm) || !is_place(camera.look_at_mm) {
                return Err(place.at("camera").wrong("a place beyond 1e6 mm"));
            }
            let apart = (DVec3::from_array(camera.at_mm) - DVec3::from_array(camera.look_at_mm)).length();
            if apart < 1e-3 {
                return Err(place.at("camera").wrong("it is where it looks: move `at_mm` away from `look_at_mm`"));
            }
        } else if place.cast().view.is_none_or(|view| view.frame.is_none()) {
            return Err(place.at("camera").wrong(
                "the scene's view differs from solution to solution: give a camera, such as { at_mm = [0, -2000, 1000], \
                 look_at_mm = [0, 0, 0] }, or [world.custom.view] a `box_mm`",
            ));
        }
        let window = self.when.moments();
        if self.how == How::AtEnd && self.when.is_set() && window.from < window.to {
            let message =
                "in a window, `how` is \"sometimes\", \"always\" or \"never\"; without `when`, it is at the end";
            return Err(place.at("how").wrong(message));
        }
        Ok(())
    }

    /// A body that is not there is never seen.
    fn subject(&self) -> Option<&str> {
        (self.how != How::Never).then_some(&self.body)
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let probe = probe.turned();
        let best = (1.0 - self.least()) / self.scale;
        let Some(seen) = self.seen(&probe) else {
            return match (probe.is_whole(), self.how) {
                (true, How::Never) => Reach::certain(1.0),
                (true, _) => Reach::NEVER,
                (false, How::Never) => Reach::between(-FAR, best).opposite(),
                (false, _) => Reach::between(-FAR, best),
            };
        };
        let (times, are_all) = self.moments(&probe);
        let margins = times.into_iter().map(|time| self.margin(&seen, time));
        let most = match self.how {
            How::Always => margins.fold(best, f64::min),
            _ if are_all => margins.fold(-FAR, f64::max),
            _ => best,
        };
        // Of a motion that is known in part, the scenery is not.
        let reach = Reach::between(if probe.is_whole() { most } else { -FAR }, most);
        if self.how == How::Never { reach.opposite() } else { reach }
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        if self.how != How::Sometimes {
            return Vec::new();
        }
        let is_seen = |seen: &Seen<'_>| self.moments(probe).0.into_iter().find(|time| self.margin(seen, *time) >= 0.0);
        let found = self.seen(probe).as_ref().and_then(is_seen);
        vec![Timed { what: format!("{} in view", probe.name(&self.body)), wanted: self.when.window(), found }]
    }

    fn looks(&self) -> Looks {
        let looks = if self.when.is_set() { Looks::after(self.when.moments()).or_impacts() } else { Looks::default() };
        looks.and_scenery()
    }
}
