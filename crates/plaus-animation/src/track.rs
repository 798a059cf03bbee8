//! Motion in closed form.

use super::look::Look;
use super::shape::Shape;
use glam::{DQuat, DVec3};
use plaus_dist::math::atan2;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A body and its motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// Stable name, e.g. `ball_0`; unique within an animation.
    pub name: String,
    /// What it looks like, in the body's own frame; shared by all motions of a body, as it may be a mesh.
    pub shape: Arc<Shape>,
    /// Colour and material.
    pub look: Look,
    /// Pieces in order of time; each is valid until the next begins.
    pub pieces: Vec<Piece>,
    /// In the body's own frame, which has its middle where the pieces say, the point that a scenario gives places for:
    /// a pin's foot, say. In m.
    #[serde(default)]
    pub origin: DVec3,
    /// Whether the body is not there before its first piece. Otherwise it waits where that begins.
    #[serde(default)]
    pub late: bool,
}

/// Motion under constant acceleration from `start` on, with rotation according to `turn`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Piece {
    /// Seconds.
    pub start: f64,
    /// Position of the body's origin at `start`.
    pub position: DVec3,
    /// Velocity at `start`.
    pub velocity: DVec3,
    /// Acceleration throughout.
    pub acceleration: DVec3,
    /// Its rotation.
    pub turn: Turn,
}

/// Rotation in closed form: `R(t) = Rot(spin·t) · R(0) · Rot(e₃, own·t)`.
///
/// With `own` = 0 this is any body at constant angular velocity; with `own`, the free symmetric top, which precesses
/// about its angular momentum while it spins about its own third axis.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Turn {
    /// Orientation at the piece's start, from the body's frame to the world's.
    pub orientation: DQuat,
    /// Angular velocity in the world's frame, rad/s.
    pub spin: DVec3,
    /// Rate about the body's own third axis, rad/s.
    pub own: f64,
}

impl Turn {
    /// At rest in an orientation.
    #[must_use]
    pub fn still(orientation: DQuat) -> Self {
        Self { orientation, ..Self::default() }
    }

    /// The same orientation with another constant angular velocity: of those that reach `end` after `t` > 0 seconds,
    /// the one nearest to `spin`. If torques act, this is the mean over the piece, so that a piece ends where the next
    /// begins.
    #[must_use]
    pub fn reaching(self, end: DQuat, t: f64) -> Self {
        let way = end * self.orientation.conjugate();
        let sine = way.xyz().length();
        if sine == 0.0 || self.own != 0.0 {
            return self;
        }
        let (axis, angle) = (way.xyz() / sine, 2.0 * atan2(sine, way.w));
        // The same turn, plus any number of full turns.
        let full = ((self.spin.dot(axis) * t - angle) / TAU).round();
        Self { spin: axis * ((angle + TAU * full) / t), ..self }
    }

    /// Orientation after `t` seconds.
    #[must_use]
    pub fn after(&self, t: f64) -> DQuat {
        let mut turned = self.orientation;
        if self.spin != DVec3::ZERO {
            turned = DQuat::from_scaled_axis(self.spin * t) * turned;
        }
        if self.own != 0.0 {
            turned *= DQuat::from_rotation_z(self.own * t);
        }
        turned.normalize()
    }
}

impl Piece {
    /// Free flight, or any motion under constant acceleration, without turning.
    #[must_use]
    pub fn ballistic(start: f64, position: DVec3, velocity: DVec3, acceleration: DVec3) -> Self {
        Self { start, position, velocity, acceleration, turn: Turn::default() }
    }

    /// At rest.
    #[must_use]
    pub fn resting(start: f64, position: DVec3) -> Self {
        Self::ballistic(start, position, DVec3::ZERO, DVec3::ZERO)
    }

    /// Whether nothing moves.
    #[must_use]
    pub fn rests(&self) -> bool {
        let Self { velocity, acceleration, turn, .. } = self;
        *velocity == DVec3::ZERO && *acceleration == DVec3::ZERO && turn.spin == DVec3::ZERO && turn.own == 0.0
    }

    /// The same, turning.
    #[must_use]
    pub fn turning(self, turn: Turn) -> Self {
        Self { turn, ..self }
    }

    /// Makes each piece that turns end where the next begins. A body's spin may change within a piece, because of
    /// friction or different moments of inertia. But a piece has only one spin, so it gets the one that leads to the
    /// start of the next piece.
    pub fn lead_on(pieces: &mut [Self]) {
        for index in 1..pieces.len() {
            let (next, piece) = (pieces[index], &mut pieces[index - 1]);
            if piece.turn.spin != DVec3::ZERO {
                piece.turn = piece.turn.reaching(next.turn.orientation, next.start - piece.start);
            }
        }
    }

    /// Position at `time`, in s; before the piece begins, the position at its start.
    #[must_use]
    pub fn position(&self, time: f64) -> DVec3 {
        let t = (time - self.start).max(0.0);
        self.position + t * (self.velocity + 0.5 * t * self.acceleration)
    }

    /// Velocity at `time`, in m/s.
    #[must_use]
    pub fn velocity(&self, time: f64) -> DVec3 {
        self.velocity + (time - self.start).max(0.0) * self.acceleration
    }

    /// Orientation at `time`.
    #[must_use]
    pub fn orientation(&self, time: f64) -> DQuat {
        self.turn.after((time - self.start).max(0.0))
    }
}

impl Track {
    /// A body that moves.
    pub fn new(name: impl Into<String>, shape: impl Into<Arc<Shape>>, look: Look, pieces: Vec<Piece>) -> Self {
        Self { name: name.into(), shape: shape.into(), look, pieces, origin: DVec3::ZERO, late: false }
    }

    /// The same, not there before its first piece if `late`.
    #[must_use]
    pub fn appearing(self, late: bool) -> Self {
        Self { late, ..self }
    }

    /// When it appears, in s, if it is not there from the start.
    #[must_use]
    pub fn appears(&self) -> Option<f64> {
        self.pieces.first().filter(|_| self.late).map(|piece| piece.start)
    }

    /// Whether it is there at `time`.
    #[must_use]
    pub fn is_there(&self, time: f64) -> bool {
        self.appears().is_none_or(|appears| appears <= time)
    }

    /// The same with another origin.
    #[must_use]
    pub fn with_origin(self, origin: DVec3) -> Self {
        Self { origin, ..self }
    }

    /// The piece that is valid at `time`: the first for times before it, `None` if there is none.
    #[must_use]
    pub fn piece(&self, time: f64) -> Option<&Piece> {
        let next = self.pieces.partition_point(|piece| piece.start <= time);
        self.pieces.get(next.saturating_sub(1))
    }

    /// Position at `time`; before the first piece, the position at its start.
    #[must_use]
    pub fn position(&self, time: f64) -> DVec3 {
        self.piece(time).map_or(DVec3::ZERO, |piece| piece.position(time))
    }

    /// Orientation at `time`.
    #[must_use]
    pub fn orientation(&self, time: f64) -> DQuat {
        self.piece(time).map_or(DQuat::IDENTITY, |piece| piece.orientation(time))
    }

    /// Whether the body ever has an orientation other than the world's.
    #[must_use]
    pub fn turns(&self) -> bool {
        self.pieces.iter().any(|piece| piece.turn != Turn::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn a_piece_ends_in_the_orientation_asked_for_after_as_many_turns_as_it_had() {
        // Slowed down from 38 rad/s about one axis and pushed about another. It turns by more than half a turn, so the
        // shorter way round is the wrong one.
        let turn = Turn { orientation: DQuat::from_rotation_y(0.3), spin: DVec3::new(38.0, 2.0, -1.0), own: 0.0 };
        let end = DQuat::from_scaled_axis(DVec3::new(36.5, 2.5, -1.0) * 0.14) * turn.orientation;
        for end in [end, -end] {
            let reaching = turn.reaching(end, 0.14);
            assert!(reaching.after(0.14).dot(end).abs() > 1.0 - 1e-14);
            assert!((reaching.spin - DVec3::new(36.5, 2.5, -1.0)).length() < 1e-11, "{}", reaching.spin);
        }
        let still = Turn::still(DQuat::from_rotation_z(1.0));
        assert_eq!(still.reaching(still.orientation, 1.0).after(1.0), still.after(1.0));
    }

    #[test]
    fn a_symmetric_top_turns_about_both_axes() {
        // The body's third axis lies along world x; it precesses a quarter turn about y and spins half a turn about
        // itself.
        let lying = DQuat::from_rotation_y(FRAC_PI_2);
        let turn = Turn { orientation: lying, spin: DVec3::Y * FRAC_PI_2, own: PI };
        let after = turn.after(1.0);
        assert!((after * DVec3::Z - DVec3::NEG_Z).length() < 1e-15);
        assert!((after * DVec3::Y - DVec3::NEG_Y).length() < 1e-15);
        assert_eq!(turn.after(0.0), lying.normalize());
    }

    #[test]
    fn pieces_are_valid_until_the_next_begins() {
        let fall = Piece::ballistic(0.0, DVec3::Y, DVec3::X, DVec3::new(0.0, -2.0, 0.0));
        let rest = Piece::resting(1.0, DVec3::X);
        let track = Track::new("a", Shape::ball(0.1), Look::nth(3), vec![fall, rest]);
        assert_eq!(track.position(-1.0), DVec3::Y);
        assert_eq!(track.position(0.5), DVec3::new(0.5, 0.75, 0.0));
        assert_eq!(fall.velocity(0.5), DVec3::new(1.0, -1.0, 0.0));
        assert_eq!(track.position(7.0), DVec3::X);
        assert!(!track.turns());
    }
}
