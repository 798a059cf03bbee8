//! Where a simulation ended.

use crate::failed::Cause;
use crate::model::Features;
use glam::{DQuat, DVec3};
use plaus_mcmc::Failure;
use serde::{Deserialize, Serialize, Serializer};

/// What became of a draw.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(from = "Stored<Done, Vec<Scattered>>")]
pub enum Ending {
    /// It came to its end.
    Done(Done),
    /// Two bodies, or a body and a piece of scenery, would begin inside each other: the draw has probability 0.
    Overlap(Overlap),
    /// The simulation failed: the draw has probability 0.
    Failed(Failed),
    /// Bumps turn a triangle of this piece of scenery over: the draw has probability 0.
    Folded(u32),
}

/// An ending as it is stored. What worlds without scatter store does not depend on whether there is such a thing.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Ending")]
enum Stored<D, S> {
    Done(D),
    Overlap(Overlap),
    Failed(Failed),
    Folded(u32),
    Scattered(D, S),
}

impl Serialize for Ending {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let stored = match self {
            Self::Done(done) if !done.scattered.is_empty() => Stored::Scattered(done, &done.scattered),
            Self::Done(done) => Stored::Done(done),
            Self::Overlap(overlap) => Stored::Overlap(*overlap),
            Self::Failed(failed) => Stored::Failed(*failed),
            Self::Folded(part) => Stored::Folded(*part),
        };
        stored.serialize(serializer)
    }
}

impl From<Stored<Done, Vec<Scattered>>> for Ending {
    fn from(stored: Stored<Done, Vec<Scattered>>) -> Self {
        match stored {
            Stored::Done(done) => Self::Done(done),
            Stored::Overlap(overlap) => Self::Overlap(overlap),
            Stored::Failed(failed) => Self::Failed(failed),
            Stored::Folded(part) => Self::Folded(part),
            Stored::Scattered(done, scattered) => Self::Done(Done { scattered, ..done }),
        }
    }
}

/// How often two things struck each other in impacts that scattered: a body, and another or a piece of scenery, counted
/// on.
pub(super) type Scattered = ([u32; 2], u32);

/// Where everything ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Done {
    /// One for each body that is there.
    pub bodies: Vec<Last>,
    /// What met, each pair once, in the order in which it met first: bodies by their places among all, pieces of
    /// scenery by theirs, counted on.
    pub met: Vec<[u32; 2]>,
    /// What struck what in impacts that scattered, and how often.
    #[serde(skip)]
    pub scattered: Vec<Scattered>,
}

/// Where a body ended.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Last {
    /// Its centre of gravity, in m.
    pub place: DVec3,
    /// How it is turned, as a scenario says it; all 0 if it never appeared.
    pub turn: DQuat,
    /// When it came to rest, in s; `None`: it did not.
    pub rest: Option<f64>,
}

/// How a simulation failed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Failed {
    /// Why.
    pub cause: Cause,
    /// The body whose motion could not go on, or that had the most events.
    pub body: u32,
    /// What it touched: another body, or a piece of scenery, counted on.
    pub other: Option<u32>,
    /// When, in s.
    pub time: f64,
}

impl Failed {
    /// The same with names.
    pub(super) fn named<'a>(&self, name: impl Fn(u32) -> &'a str) -> Failure {
        self.cause.failure(name(self.body), self.other.map(name), self.time)
    }
}

/// Two things that begin inside each other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Overlap {
    /// A body.
    pub body: u32,
    /// Another, or a piece of scenery, counted on.
    pub other: u32,
    /// How deep, in m.
    pub depth: f64,
}

impl Last {
    /// Of a body that never appeared.
    pub(super) const NEVER: Self = Self { place: DVec3::ZERO, turn: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), rest: None };

    /// Whether it ever appeared.
    #[must_use]
    pub fn is_there(&self) -> bool {
        *self != Self::NEVER
    }

    /// Which of its axes is nearest to up: 0 to 2, or 3 to 5 for those that point down.
    fn uppermost(&self) -> i64 {
        let up = self.turn.conjugate() * DVec3::Z;
        let axis = (1..3).fold(0, |best, k| if up[k].abs() > up[best].abs() { k } else { best });
        if up[axis] < 0.0 { axis as i64 + 3 } else { axis as i64 }
    }
}

impl Done {
    /// The features of a solution, for cells of a width in m. Of a ball no axis counts. `there` are the bodies that are
    /// there.
    pub(super) fn features(
        &self,
        features: &mut Features,
        cell: f64,
        is_ball: impl Fn(usize) -> bool,
        there: &[usize],
    ) {
        for (last, &index) in self.bodies.iter().zip(there) {
            (last.place / cell).to_array().iter().for_each(|x| features.place(*x));
            let up = if is_ball(index) { 0 } else { last.uppermost() };
            features.number(if last.is_there() { up } else { -1 });
        }
        self.met.iter().flatten().for_each(|&one| features.number(i64::from(one)));
    }
}
