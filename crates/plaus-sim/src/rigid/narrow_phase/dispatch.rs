//! Dispatch: which algorithm is responsible for two bodies. An algorithm knows how far apart they are, when they first
//! touch, and all points at which they touch.
//!
//! A new algorithm is a line here, and an answer in each of the functions below. The compiler asks for both.

use super::capsules::capsule_gap;
use super::contact_point::PairContactPoint;
use super::revolution::{revolved_and_ball, two_revolved};
use super::spheres::{balls, swapped};
use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::rigid::{RigidWorld, ShapeKind};
use crate::shape::Within;
use crate::special_case::SpecialCase;
use glam::DVec3;
use std::cmp::Ordering;

/// How the points of contact of two bodies are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PairAlgorithm {
    /// Two balls.
    Balls,
    /// Balls and rings of a body of revolution against a ball.
    RevolvedAndBall,
    /// Balls and rings of two bodies of revolution.
    Revolved,
    /// Convex pieces of any kind, exactly: all pairs that have no algorithm of their own.
    Pieces,
}

impl PairAlgorithm {
    pub(crate) fn of(a: &ShapeKind, b: &ShapeKind) -> Self {
        use ShapeKind::{Ball, Revolved};
        match (a, b) {
            (Ball, Ball) if SpecialCase::Balls.is_on() => Self::Balls,
            (Ball, Revolved) | (Revolved, Ball) if SpecialCase::RevolvedAndBall.is_on() => Self::RevolvedAndBall,
            (Revolved, Revolved) if SpecialCase::Revolved.is_on() => Self::Revolved,
            _ => Self::Pieces,
        }
    }
}

impl RigidWorld {
    #[inline]
    pub(crate) fn pair_algorithm(&self, [i, j]: [usize; 2]) -> PairAlgorithm {
        PairAlgorithm::of(&self.specs[i].skin, &self.specs[j].skin)
    }

    /// Whether the pieces of two bodies are compared the other way round: the same way whichever body is listed first,
    /// so that points of contact are the same to the last bit. Two of a kind are compared as they are listed.
    pub(crate) fn is_turned(&self, pair: [usize; 2]) -> bool {
        let [s, t] = pair.map(|k| &self.specs[k]);
        let order = s.bounding_radius.total_cmp(&t.bounding_radius).then_with(|| s.mass.total_cmp(&t.mass));
        order == Ordering::Greater
    }

    /// The nearest points of two bodies.
    pub(crate) fn pair_touch(&self, pair: [usize; 2], poses: [&Pose; 2]) -> PairContactPoint {
        let [i, j] = pair;
        let [a, b] = poses;
        let (s, t) = (&self.specs[i], &self.specs[j]);
        let offset = a.x - b.x;
        match self.pair_algorithm(pair) {
            PairAlgorithm::Balls => balls(offset, [DVec3::ZERO; 2], [s.bounding_radius, t.bounding_radius]),
            PairAlgorithm::RevolvedAndBall if s.is_ball => swapped(revolved_and_ball(t, b, -offset, s.bounding_radius)),
            PairAlgorithm::RevolvedAndBall => revolved_and_ball(s, a, offset, t.bounding_radius),
            PairAlgorithm::Revolved => two_revolved([s, t], poses, offset),
            PairAlgorithm::Pieces if self.is_turned(pair) => swapped(self.nearest_pieces([j, i], [b, a])),
            PairAlgorithm::Pieces => self.nearest_pieces(pair, poses),
        }
    }

    /// Whether two bodies may be within a gap of each other, found in a part of the time of their nearest points.
    pub(crate) fn may_be_within(&self, pair: [usize; 2], poses: [&Pose; 2], within: f64) -> bool {
        match self.pair_algorithm(pair) {
            PairAlgorithm::Pieces => {
                !SpecialCase::MayBeWithin.is_on() || self.pieces_may_be_within(pair, poses, within)
            }
            PairAlgorithm::Balls => self.pair_touch(pair, poses).gap <= within,
            _ => !SpecialCase::Capsules.is_on() || capsule_gap(pair.map(|k| &self.specs[k]), poses) <= within,
        }
    }

    /// First time in `[from, until]` at which two bodies touch while approaching; for bodies in lasting contact
    /// (`linked`), at points that are not part of it. Round bodies have only one point.
    pub(crate) fn first_pair(
        &self,
        pair: [usize; 2],
        bodies: [&RigidBodyState; 2],
        [from, until]: [f64; 2],
        linked: bool,
    ) -> Option<f64> {
        match self.pair_algorithm(pair) {
            PairAlgorithm::Pieces => self.first_of_pieces(pair, bodies, [from, until], linked),
            PairAlgorithm::Balls | PairAlgorithm::RevolvedAndBall | PairAlgorithm::Revolved if linked => None,
            PairAlgorithm::Balls | PairAlgorithm::RevolvedAndBall | PairAlgorithm::Revolved => {
                self.first_of_spheres(pair, bodies, from, until)
            }
        }
    }

    /// Calls `each` for the points at which two bodies touch: all such points if both have faces, otherwise the nearest
    /// points.
    pub(crate) fn for_pair_touches(
        &self,
        pair: [usize; 2],
        poses: [&Pose; 2],
        within: impl Into<Within>,
        mut each: impl FnMut(PairContactPoint),
    ) {
        self.for_all_pair_touches(pair, poses, within.into(), &mut each);
    }

    /// One copy in the program for all that is done with the points.
    fn for_all_pair_touches(
        &self,
        pair: [usize; 2],
        poses: [&Pose; 2],
        within: Within,
        each: &mut dyn FnMut(PairContactPoint),
    ) {
        let ([i, j], [a, b]) = (pair, poses);
        match self.pair_algorithm(pair) {
            PairAlgorithm::Pieces if self.is_turned(pair) => {
                self.for_touching_pieces([j, i], [b, a], within, |touch| each(swapped(touch)));
            }
            PairAlgorithm::Pieces => self.for_touching_pieces(pair, poses, within, each),
            PairAlgorithm::Balls | PairAlgorithm::RevolvedAndBall | PairAlgorithm::Revolved => {
                let touch = self.pair_touch(pair, poses);
                if touch.gap <= within.gap {
                    each(touch);
                }
            }
        }
    }

    /// The same point of contact at other poses.
    pub(crate) fn pair_again(&self, pair: [usize; 2], poses: [&Pose; 2], touch: &PairContactPoint) -> PairContactPoint {
        let ([i, j], [a, b]) = (pair, poses);
        match touch.id {
            Some(id) if self.is_turned(pair) => swapped(self.pieces_again([j, i], [b, a], id, -touch.normal)),
            Some(id) => self.pieces_again(pair, poses, id, touch.normal),
            None => self.pair_touch(pair, poses),
        }
    }
}
