//! A target under a requirement has the right law, and the requirement is rarely asked. Wrong twins: a requirement
//! whose answer does not depend on the state alone, and one that exceeds its stated bound.

// Helpers outside of `#[test]` functions panic as tests do.

use crate::toys::ring::{Redraw, Ring, Walk};
use plaus_dist::{LogPotential, Seed};
use plaus_mcmc::check::{OneStep, OneStepReport, Statistic, one_step, rejection};
use plaus_mcmc::{Chain, Goal, Judged, Mark, Mixture, ModelError, Required, Requirement, State, StateRefOf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

const PLAN: OneStep = OneStep { seed: Seed(21), samples: 40_000, steps: 1, cells: 16, false_alarm: 1e-6 };

/// Prefers places beyond the fifth, by a factor e; counts how often it is asked.
#[derive(Default)]
struct Beyond {
    most: Option<f64>,
    asked: AtomicU64,
    /// The wrong twin's answer depends on how often it was asked.
    fickle: bool,
}

impl Requirement<Ring> for &Beyond {
    fn most(&self) -> Option<LogPotential> {
        self.most.map(|most| LogPotential::new(most).unwrap())
    }

    fn judge(&self, _: &Ring, state: StateRefOf<'_, Ring>, (): &()) -> Result<Mark, ModelError> {
        let asked = self.asked.fetch_add(1, Relaxed);
        let met = *state.draw > 5;
        let log = if self.fickle { (asked % 2) as f64 } else { f64::from(u8::from(met)) };
        Ok(Mark { log: LogPotential::new(log)?, met })
    }
}

fn mixture() -> Mixture<Ring> {
    Mixture::new(vec![(0.5, Box::new(Walk) as _), (0.5, Box::new(Redraw { symmetric: false }) as _)]).unwrap()
}

fn stepped(beyond: &Beyond) -> OneStepReport {
    let ring = Ring::of_nine(1.0);
    let required = Required::new(&ring, beyond);
    let moves = Required::moves(&mixture());
    let place = Statistic::new("place", |state: &State<usize, Judged<usize>>| state.draw as f64);
    let bound = LogPotential::new(2.0).unwrap();
    one_step(&required, &moves, rejection(&required, bound), &[place], PLAN).unwrap()
}

#[test]
fn a_step_leaves_the_law_of_both_invariant() {
    for most in [None, Some(1.0), Some(1.5)] {
        let report = stepped(&Beyond { most, ..Beyond::default() });
        assert!(report.passed(), "{report}");
    }
    let fickle = stepped(&Beyond { fickle: true, ..Beyond::default() });
    assert!(!fickle.passed(), "{fickle}");
}

/// Places and whether they satisfy the constraint, and how often the requirement was asked.
fn walked(beyond: &Beyond) -> (Vec<(usize, bool)>, u64) {
    let ring = Ring::of_nine(1.0);
    let required = Required::new(&ring, beyond);
    let moves = Required::moves(&mixture());
    let mut chain = Chain::start(&required, &moves, Seed(4).chain(0)).unwrap();
    let mut seen = Vec::new();
    for _ in 0..5000 {
        chain.step().unwrap();
        seen.push((chain.state().draw, required.class(chain.state().by_ref()).is_some()));
    }
    (seen, beyond.asked.load(Relaxed))
}

#[test]
fn a_stated_bound_only_makes_the_requirement_be_asked_less_often() {
    let (plain, often) = walked(&Beyond::default());
    let (saving, seldom) = walked(&Beyond { most: Some(1.0), ..Beyond::default() });
    assert_eq!(plain, saving);
    assert!(seldom < often, "{seldom} calls, {often} without a bound");
    assert!(plain.iter().all(|&(place, satisfied)| satisfied == (place > 5 && place.is_multiple_of(2))));
    assert!(plain.iter().any(|state| state.1));
}

#[test]
fn a_judgement_above_the_stated_bound_is_an_error() {
    let ring = Ring::of_nine(1.0);
    let beyond = Beyond { most: Some(0.5), ..Beyond::default() };
    let required = Required::new(&ring, &beyond);
    let moves = Required::moves(&mixture());
    let walk = || -> Result<(), plaus_mcmc::ChainError> {
        let mut chain = Chain::start(&required, &moves, Seed(4).chain(0))?;
        (0..5000).try_for_each(|_| chain.step().map(drop))
    };
    let error = walk().unwrap_err().to_string();
    assert!(error.contains("log potential of 1 exceeds its stated bound, 0.5"), "{error}");
}
