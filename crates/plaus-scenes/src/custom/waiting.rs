//! The bodies of a run that have not appeared.

use super::engine::Engine;
use super::late::{Cue, Late};
use super::plan::{Built, Plan};
use super::there::place;
use super::values::Numbers;
use plaus_sim::mechanics::Impact;

/// A body that has not appeared, by its place in the simulator.
#[derive(Debug)]
struct Waiting {
    index: usize,
    late: Late,
    /// How long after its cue, in s.
    after: f64,
    /// When it is due, in s, once its cue has come.
    due: Option<f64>,
}

/// The bodies of a run that have not appeared.
#[derive(Debug, Default)]
pub(super) struct Waitings(Vec<Waiting>);

impl Waitings {
    pub(super) fn new(plan: &Plan, numbers: &Numbers<'_>, there: &[usize]) -> Self {
        let waiting = |(index, &body): (usize, &usize)| {
            let late = plan.bodies[body].late?;
            let after = late.after.of(numbers);
            Some(Waiting { index, late, after, due: (late.cue == Cue::Start).then_some(after) })
        };
        Self(there.iter().enumerate().filter_map(waiting).collect())
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether a body has not appeared.
    pub(super) fn has(&self, index: usize) -> bool {
        self.0.iter().any(|one| one.index == index)
    }

    /// When the next one is due, in s.
    pub(super) fn next(&self) -> Option<f64> {
        self.0.iter().filter_map(|one| one.due).min_by(f64::total_cmp)
    }

    /// Takes one out that is due at this time.
    pub(super) fn take(&mut self, time: f64) -> Option<usize> {
        let due = self.0.iter().position(|one| one.due.is_some_and(|due| due <= time))?;
        Some(self.0.remove(due).index)
    }

    /// Notes an impact.
    pub(super) fn hit(&mut self, impact: &Impact, built: &Built, bodies: usize) {
        if self.is_empty() {
            return;
        }
        let two = [built.there[impact.body], built.number(impact.other, bodies)];
        let is_cue = |cue| match cue {
            Cue::Hit(body, None) => two.contains(&body),
            Cue::Hit(body, Some(other)) => two == [body, other] || two == [other, body],
            Cue::Start | Cue::Rest(_) => false,
        };
        let waiting = self.0.iter_mut().filter(|one| one.due.is_none() && is_cue(one.late.cue));
        waiting.for_each(|one| one.due = Some(impact.time + one.after));
    }

    /// Looks which bodies rest after an event; whether one of those that wait is due before `until`, in s, for which
    /// the run must be stopped.
    pub(super) fn is_due<E: Engine>(&mut self, bodies: &[E::Body], there: &[usize], [time, until]: [f64; 2]) -> bool {
        for one in &mut self.0 {
            if let (Cue::Rest(body), None) = (one.late.cue, one.due)
                && there.contains(&body)
                && let Some(rest) = E::rest(&bodies[place(there, body)])
            {
                one.due = Some(rest.max(time) + one.after);
            }
        }
        self.next().is_some_and(|due| due < until)
    }
}
