//! The table of pairs: which row is responsible for two bodies. A row knows how far apart they are, when they first
//! touch, and all points at which they touch.
//!
//! A new row is a line here, and an answer in each of the functions below. The compiler asks for both.

use super::body::{Pose, Turning};
use super::pair::{balls, swapped};
use super::revolved::{revolved_and_ball, two_revolved};
use super::touch::PairTouch;
use super::{Rigid, Skin};
use crate::shape::Within;
use glam::DVec3;

/// A row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Row {
    /// Two balls.
    Balls,
    /// Balls and rings of a body of revolution against a ball.
    RevolvedAndBall,
    /// Balls and rings of two bodies of revolution.
    Revolved,
    /// Convex pieces of any kind, exactly: all pairs that have no row of their own.
    Pieces,
}

impl Row {
    pub(super) fn of(a: &Skin, b: &Skin) -> Self {
        use Skin::{Ball, Convex, Revolved};
        match (a, b) {
            (Ball, Ball) => Self::Balls,
            (Ball, Revolved) | (Revolved, Ball) => Self::RevolvedAndBall,
            (Revolved, Revolved) => Self::Revolved,
            (Convex { .. }, _) | (_, Convex { .. }) => Self::Pieces,
        }
    }
}

impl Rigid {
    #[inline]
    pub(super) fn row(&self, [i, j]: [usize; 2]) -> Row {
        Row::of(&self.specs[i].skin, &self.specs[j].skin)
    }

    /// The nearest points of two bodies.
    pub(super) fn pair_touch(&self, pair: [usize; 2], poses: [&Pose; 2]) -> PairTouch {
        let [i, j] = pair;
        let [a, b] = poses;
        let (s, t) = (&self.specs[i], &self.specs[j]);
        let offset = a.x - b.x;
        match self.row(pair) {
            Row::Balls => balls(offset, [DVec3::ZERO; 2], [s.reach, t.reach]),
            Row::RevolvedAndBall if s.is_ball => swapped(revolved_and_ball(t, b, -offset, s.reach)),
            Row::RevolvedAndBall => revolved_and_ball(s, a, offset, t.reach),
            Row::Revolved => two_revolved([s, t], poses, offset),
            Row::Pieces => self.nearest_pieces(pair, poses),
        }
    }

    /// A lower bound on the gap of two bodies that is found in a part of the time of their nearest points.
    pub(super) fn gap_at_least(&self, pair: [usize; 2], poses: [&Pose; 2]) -> f64 {
        match self.row(pair) {
            Row::Pieces => self.pieces_at_least(pair, poses),
            _ => self.pair_touch(pair, poses).gap,
        }
    }

    /// First time in `[from, until]` at which two bodies touch while approaching.
    pub(super) fn first_pair(&self, pair: [usize; 2], bodies: [&Turning; 2], from: f64, until: f64) -> Option<f64> {
        match self.row(pair) {
            Row::Pieces => self.first_of_pieces(pair, bodies, [from, until], false),
            Row::Balls | Row::RevolvedAndBall | Row::Revolved => self.first_of_feelers(pair, bodies, from, until),
        }
    }

    /// The same for bodies in lasting contact, at points that are not part of it. Round bodies have only one point.
    pub(super) fn first_new(&self, pair: [usize; 2], bodies: [&Turning; 2], from: f64, until: f64) -> Option<f64> {
        match self.row(pair) {
            Row::Pieces => self.first_of_pieces(pair, bodies, [from, until], true),
            Row::Balls | Row::RevolvedAndBall | Row::Revolved => None,
        }
    }

    /// Calls `each` for the points at which two bodies touch: all such points if both have faces, otherwise the nearest
    /// points.
    pub(super) fn for_pair_touches(
        &self,
        pair: [usize; 2],
        poses: [&Pose; 2],
        within: impl Into<Within>,
        mut each: impl FnMut(PairTouch),
    ) {
        let within = within.into();
        match self.row(pair) {
            Row::Pieces => self.for_touching_pieces(pair, poses, within, each),
            Row::Balls | Row::RevolvedAndBall | Row::Revolved => {
                let touch = self.pair_touch(pair, poses);
                if touch.gap <= within.gap {
                    each(touch);
                }
            }
        }
    }

    /// The same point of contact at other poses.
    pub(super) fn pair_again(&self, pair: [usize; 2], poses: [&Pose; 2], touch: &PairTouch) -> PairTouch {
        match touch.spot {
            Some(spot) => self.pieces_again(pair, poses, spot, touch.normal),
            None => self.pair_touch(pair, poses),
        }
    }
}
