//! Simulations that fail: what to call what happened.

use plaus_mcmc::Failure;
use plaus_sim::Outcome;
use plaus_sim::mechanics::Other;
use serde::{Deserialize, Serialize};

/// Why a simulation failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Cause {
    /// The body's motion was no longer finite.
    NotFinite,
    /// The simulator's budget of events was spent.
    OutOfEvents,
    /// The other, a driven body, left it no way.
    Crushed,
    /// The motion of all bodies took more memory than a draw may have.
    TooLong,
    /// The body appeared inside the other.
    Appears,
}

impl Cause {
    /// A failure with this cause, `time` s after the start, of a body that touched another, both by their names.
    pub(crate) fn failure(self, body: &str, other: Option<&str>, time: f64) -> Failure {
        let (why, doing) = match (self, other) {
            (Self::NotFinite, Some(other)) => ("not finite", format!("{body} touches {other}")),
            (Self::NotFinite, None) => ("not finite", body.to_owned()),
            (Self::OutOfEvents, _) => ("out of events", body.to_owned()),
            (Self::Crushed, other) => ("no way out", format!("{} crushes {body}", other.unwrap_or("a driven body"))),
            (Self::Appears, other) => {
                ("no room to appear", format!("{body} appears inside {}", other.unwrap_or("something")))
            }
            (Self::TooLong, _) => ("too many motions to keep", body.to_owned()),
        };
        Failure { body: body.to_owned(), doing, time, cause: why.to_owned() }
    }
}

/// Why a run that ended at this time, in s, failed, if it did. `name` gives what bodies and scenery are called.
pub(crate) fn failure(outcome: Outcome, time: f64, name: impl Fn(Other) -> String) -> Option<Failure> {
    let (cause, body, other) = match outcome {
        Outcome::NotFinite { body, touched } => (Cause::NotFinite, Some(body), touched),
        Outcome::Crushed { body, by } => (Cause::Crushed, Some(body), Some(Other::Body(by))),
        Outcome::OutOfEvents => (Cause::OutOfEvents, None, None),
        Outcome::TimeReached | Outcome::AllAtRest | Outcome::Stopped => return None,
    };
    let body = body.map_or_else(|| "the simulation".to_owned(), |body| name(Other::Body(body)));
    Some(cause.failure(&body, other.map(name).as_deref(), time))
}
