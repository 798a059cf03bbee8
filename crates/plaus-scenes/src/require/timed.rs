//! The times asked for and the times found: for plots and marks on a timeline, not for decisions.

use super::event::{Event, What};
use super::probe::Probe;
use super::when::{When, Window};

/// A time that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Timed {
    /// The event in words: `first impact of ball with bell`, `beat 2`.
    pub what: String,
    /// When it may be.
    pub wanted: Window,
    /// When it happened, in s; `None` if it never did.
    pub found: Option<f64>,
}

impl Timed {
    /// An event of a motion that is known to its end.
    pub(super) fn of_event(event: &Event, when: &When, probe: &Probe<'_>) -> Self {
        Self { what: words(event, probe), wanted: when.window(), found: known(event, probe) }
    }
}

/// When an event happens, if it does.
pub(super) fn known(event: &Event, probe: &Probe<'_>) -> Option<f64> {
    Some(event.time(probe).low).filter(|time| time.is_finite())
}

/// An event in words.
pub(super) fn words(event: &Event, probe: &Probe<'_>) -> String {
    let named = |before: &str, name: &str| if name.is_empty() { String::new() } else { format!(" {before} {name}") };
    let whose = named("of", probe.name(&event.body));
    match (event.what, event.nth) {
        (What::Rest, _) => format!("rest{whose}"),
        (What::Fall, _) => format!("fall{whose}"),
        (_, 1) => format!("first impact{whose}{}", named("with", &event.with)),
        (_, -1) => format!("last impact{whose}{}", named("with", &event.with)),
        (_, nth) if nth > 0 => format!("impact {nth}{whose}{}", named("with", &event.with)),
        (_, nth) => format!("last impact but {}{whose}{}", -nth - 1, named("with", &event.with)),
    }
}
