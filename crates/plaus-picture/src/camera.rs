//! Viewpoints of pictures.

use crate::drawing::Drawing;
use crate::shade::SUN;
use glam::DVec3;
use plaus_animation::{Animation, Eye, View};
use plaus_export::mesh;

/// An eye and its direction of view.
#[derive(Debug, Clone, Copy)]
pub struct Camera(Eye);

/// How often per second bodies' places are sampled.
const LOOKS: f64 = 60.0;
/// How many times as steep as the animation asks for the view may be.
const STEEPER: [f64; 4] = [1.0, 2.0, 4.0, 8.0];
/// Rounding of a corner of scenery, in m: drawn corners are in single precision.
const CLOSE: f64 = 1e-5;

impl Camera {
    /// Looks at an animation from its best viewpoint, so that everything that should be visible between two times, in
    /// s, fits into a picture `aspect` times as wide as high. If scenery hides bodies at the end, it looks from higher
    /// up, unless the viewpoint is exact.
    #[must_use]
    pub fn of(animation: &Animation, times: [f64; 2], aspect: f64) -> Self {
        Self::of_all(&[(animation, times)], aspect)
    }

    /// One viewpoint for several animations of one world, each between two times of its own, so that pictures of them
    /// can be compared. The direction is that of the first.
    #[must_use]
    pub fn of_all(all: &[(&Animation, [f64; 2])], aspect: f64) -> Self {
        let view = all.iter().find_map(|(animation, _)| animation.view).unwrap_or(View::from(0.3, 0.5, 1.0));
        let frames = all.iter().filter_map(|(one, times)| framed(one, one.view.unwrap_or(view), *times));
        let both = |[a, b]: [DVec3; 2], [c, d]: [DVec3; 2]| [a.min(c), b.max(d)];
        let frame = frames.reduce(both).unwrap_or([DVec3::NEG_ONE, DVec3::ONE]);
        let up = Eye::upwards(view.from);
        let cameras = STEEPER.map(|steeper| {
            let from = DVec3::new(view.from.x, view.from.y * steeper, view.from.z);
            Self(Eye::fitting(frame, from, up, Eye::FIELD, aspect))
        });
        let ends = all.iter().map(|(animation, times)| {
            let places = animation.motion.tracks.iter().map(|track| (track.position(times[1]), track.shape.reach()));
            (Drawing::new(animation), places.collect())
        });
        let ends: Vec<(Drawing<'_>, Vec<(DVec3, f64)>)> = ends.collect();
        let is_seen = |point: DVec3| (0..3).all(|k| frame[0][k] <= point[k] && point[k] <= frame[1][k]);
        let hidden = |camera: &Self| -> usize {
            let is_hidden = |drawing: &Drawing<'_>, at, reach| is_seen(at) && drawing.hides(camera.0.at, at, reach);
            let of_one = |(drawing, places): &(Drawing<'_>, Vec<(DVec3, f64)>)| {
                places.iter().filter(|(at, reach)| is_hidden(drawing, *at, *reach)).count()
            };
            ends.iter().map(of_one).sum()
        };
        let [first, others @ ..] = &cameras;
        if view.exact {
            return *first;
        }
        let better = |best: (usize, Self), camera: &Self| match hidden(camera) {
            fewer if fewer < best.0 => (fewer, *camera),
            _ => best,
        };
        others.iter().fold((hidden(first), *first), better).1
    }
}

/// The corners of a box that holds everything that should be visible between two times.
fn framed(animation: &Animation, view: View, [from, to]: [f64; 2]) -> Option<[DVec3; 2]> {
    let mut frame = view.frame;
    if !view.alone || frame.is_none() {
        for track in &animation.motion.tracks {
            let reach = DVec3::splat(track.shape.reach());
            let steps = ((to - from) * LOOKS).ceil().clamp(1.0, 1e4) as u32;
            for step in 0..=steps {
                let at = track.position(from + (to - from) * f64::from(step) / f64::from(steps));
                let [low, high] = frame.unwrap_or([at; 2]);
                frame = Some([low.min(at - reach), high.max(at + reach)]);
            }
        }
    }
    frame.map(|frame| with_shadows(animation, frame))
}

/// A box, made larger so that the shadows of the scenery that lies in it fall into it too.
fn with_shadows(animation: &Animation, frame: [DVec3; 2]) -> [DVec3; 2] {
    let [mut low, mut high] = frame;
    for prop in &animation.scenery {
        let part = mesh::of_form(&prop.form, prop.look);
        let corners = || part.mesh.positions.iter().map(|corner| DVec3::from_array(corner.map(f64::from)));
        let is_in = |corner: DVec3| corner.cmpge(frame[0] - CLOSE).all() && corner.cmple(frame[1] + CLOSE).all();
        if prop.look.clear().is_none() && corners().all(is_in) {
            for corner in corners() {
                let shadow = corner - SUN * ((corner.y - frame[0].y) / SUN.y);
                (low, high) = (low.min(shadow), high.max(shadow));
            }
        }
    }
    [low, high]
}

impl Camera {
    /// Looks from the direction `from`, so that a box between two corners just fits into a picture `aspect` times as
    /// wide as high. `field` is the vertical field of view in degrees; `up` points upwards in the picture.
    #[must_use]
    pub fn fitting(frame: [DVec3; 2], from: DVec3, up: DVec3, field: f64, aspect: f64) -> Self {
        Self(Eye::fitting(frame, from, up, field, aspect))
    }

    /// The ray through a point of the picture, given by its shares of width and height from the upper left.
    pub(crate) fn ray(&self, across: f64, down: f64, aspect: f64) -> (DVec3, DVec3) {
        (self.0.at, self.0.ray(across, down, aspect))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_animation::{Look, Piece, Prop, Shape, Track};

    fn marble_in_a_cup(high: f64) -> Animation {
        let marble = vec![Piece::resting(0.0, DVec3::new(0.0, 0.01, 0.0))];
        let wall = |k: usize| {
            let out = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z][k];
            let half = DVec3::new(0.02, 0.5 * high, 0.02) - 0.018 * out.abs();
            Prop::block(format!("wall_{k}"), Look::WOOD, 0.022 * out + DVec3::Y * 0.5 * high, half)
        };
        let track = Track::new("marble", Shape::ball(0.01), Look::nth(1), marble);
        let view = View::from(0.3, 0.5, 1.0).only(DVec3::new(-0.2, 0.0, -0.2), DVec3::new(0.2, 0.2, 0.2));
        Animation::new(1.0, vec![track], Vec::new()).with_scenery((0..4).map(wall).collect()).with_view(view)
    }

    /// A marble in a cup is looked at from so high up that it is seen; where nothing hides it, the view is as asked
    /// for.
    #[test]
    fn what_lies_in_a_cup_is_seen() {
        let (cup, dish) = (marble_in_a_cup(0.05), marble_in_a_cup(0.005));
        let [into, over] = [&cup, &dish].map(|animation| Camera::of(animation, [0.0, 1.0], 1.5));
        assert!(!Drawing::new(&cup).hides(into.0.at, DVec3::Y * 0.01, 0.01));
        assert!(Drawing::new(&cup).hides(over.0.at, DVec3::Y * 0.01, 0.01), "the usual view does not show it");
        assert!((over.0.forward + DVec3::new(0.3, 0.5, 1.0).normalize()).length() < 1e-12);
    }

    /// What is the same in two animations is at the same place in both pictures, although one of them goes farther.
    #[test]
    fn animations_of_one_world_are_seen_from_one_place() {
        let rolling = |far: f64| {
            let piece = Piece::ballistic(0.0, DVec3::ZERO, DVec3::X * far, DVec3::ZERO);
            Animation::new(1.0, vec![Track::new("ball", Shape::ball(0.1), Look::nth(1), vec![piece])], Vec::new())
        };
        let (near, far) = (rolling(0.5), rolling(3.0));
        let both = Camera::of_all(&[(&near, [0.0, 1.0]), (&far, [0.0, 1.0])], 1.5);
        let alone = Camera::of(&far, [0.0, 1.0], 1.5);
        assert_eq!(both.0.place(DVec3::ZERO, 1.5), alone.0.place(DVec3::ZERO, 1.5), "the longer one decides");
        assert_ne!(both.0.place(DVec3::ZERO, 1.5), Camera::of(&near, [0.0, 1.0], 1.5).0.place(DVec3::ZERO, 1.5));
        let [across, down] = both.0.place(DVec3::X * 3.0, 1.5).unwrap();
        assert!((0.0..=1.0).contains(&across) && (0.0..=1.0).contains(&down), "{across} {down}");
    }

    /// A plate on a post at the right end of what is shown: its shadow falls farther right, and is in the picture.
    #[test]
    fn shadows_of_scenery_are_in_the_picture() {
        let plate = Prop::block("plate", Look::STONE, DVec3::new(0.4, 0.3, 0.0), DVec3::splat(0.05));
        let view = View::from(0.3, 0.5, 1.0).only(DVec3::new(-0.5, 0.0, -0.3), DVec3::new(0.45, 0.4, 0.3));
        let animation = Animation::new(1.0, Vec::new(), Vec::new()).with_scenery(vec![plate]).with_view(view);
        let camera = Camera::of(&animation, [0.0, 1.0], 1.5);
        let corner = DVec3::new(0.45, 0.35, 0.05);
        let [across, down] = camera.0.place(corner - SUN * (corner.y / SUN.y), 1.5).unwrap();
        assert!((0.0..=1.0).contains(&across) && (0.0..=1.0).contains(&down), "{across} {down}");
    }
}
