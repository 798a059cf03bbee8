//! The move that favours variables of unmet requirements: a chain of it alone agrees with weighted draws of the prior,
//! and a twin that forgets how likely it chooses a variable does not.

use crate::custom_cases::CASES;
use crate::custom_exact::{LIMIT, apart, sampled_by, scenario, weighed};
use plaus_dist::{LogPotential, Seed};
use plaus_mcmc::{At, Chain, Mixture, ModelError, Move, Proposal, Target, Transition};
use plaus_scenes::require::{Candidate, Judge, Mark};
use plaus_scenes::{AnyScene, Motion, Rules, Scene, Stage};
use std::sync::Arc;

/// The move `unmet` without the ratio of its choice, which depends on the state.
struct Blind(Mixture<Stage>);

impl Blind {
    fn right(&self) -> &dyn Move<Stage> {
        self.0.iter().find(|(_, kernel)| kernel.name() == "unmet").unwrap().1
    }
}

impl Move<Stage> for Blind {
    fn name(&self) -> &'static str {
        "unmet"
    }

    fn propose(
        &self,
        at: At<'_, Stage>,
        draw: &mut <Stage as Target>::Draw,
        stream: &mut plaus_dist::Stream,
    ) -> Result<Proposal, ModelError> {
        let proposal = self.right().propose(at, draw, stream)?;
        let Proposal::Candidate { log_ratio, path, .. } = proposal else { return Ok(proposal) };
        let chosen = self.right().log_ratio_after(at.to(at.state, path))?;
        Ok(Proposal::with_ratio(log_ratio.times(chosen)?))
    }

    fn log_ratio(&self, step: Transition<'_, Stage>) -> Result<plaus_dist::LogRatio, ModelError> {
        self.right().log_ratio(step)
    }
}

/// A chain of `unmet` alone samples what is described and required. Without the ratio of its choice it is caught: it
/// leaves what is missed too fast.
#[test]
fn a_choice_without_its_ratio_is_caught() {
    let case = CASES.iter().find(|[.., required]| required.contains("other_1', x_mm")).unwrap();
    let alone = "weights = { unmet = 1, redraw_all = 0, redraw_body = 0, redraw_any = 0, step_any = 0, step_all = 0 }";
    let world = format!("{alone}\n{}", case[0]);
    let stage = scenario(&[&world, case[1], case[2]]).stage().unwrap();
    let moves = || stage.moves(&Rules::default()).unwrap();
    let truth = weighed(&stage);
    let z = apart(&truth, &sampled_by(&stage, &moves()));
    assert!(z < LIMIT, "{z} standard errors");
    let z = apart(&truth, &sampled_by(&stage, &moves().with(Box::new(Blind(moves())))));
    assert!(z > LIMIT, "a choice without its ratio is only {z} standard errors off");
}

/// Is never met, and weighs nothing.
#[derive(Debug)]
struct Never;

impl Judge<AnyScene> for Never {
    fn most(&self) -> Option<LogPotential> {
        Some(LogPotential::ONE)
    }

    fn wants_motion(&self) -> bool {
        false
    }

    fn judge(&self, _: Candidate<'_, AnyScene>, _: Option<Motion>) -> Result<Mark, ModelError> {
        Ok(Mark { margin: -1.0, log: 0.0 })
    }
}

/// A judge names no bodies, so what it says does not change which bodies the move favours.
#[test]
fn a_judge_has_no_say_in_what_is_favoured() {
    let case = CASES.iter().find(|[.., required]| required.contains("other_1', x_mm")).unwrap();
    let world = format!("weights = {{ unmet = 4, redraw_any = 1 }}\n{}", case[0]);
    let stage = || scenario(&[&world, case[1], case[2]]).stage().unwrap();
    let walked = |stage: Stage| {
        let moves = stage.moves(&Rules::default()).unwrap();
        let mut chain = Chain::start(&stage, &moves, Seed(4).chain(0)).unwrap();
        let step = |_| {
            chain.step().unwrap();
            let state = chain.state();
            (state.draw.clone(), state.outcome.marks()[0].met())
        };
        (0..600).map(step).collect::<Vec<_>>()
    };
    let alone = walked(stage());
    assert!(alone == walked(stage().judged_by(Arc::new(Never))));
    assert!(alone.iter().any(|(_, met)| *met) && alone.iter().any(|(_, met)| !met));
}
