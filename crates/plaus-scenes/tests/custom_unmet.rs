//! The move that favours variables of unmet requirements: a chain of it alone agrees with weighted draws of the prior,
//! and a twin that forgets how likely it chooses a variable does not.

use crate::custom_cases::CASES;
use crate::custom_exact::{LIMIT, apart, sampled_by, scenario, weighed};
use plaus_mcmc::{At, Mixture, ModelError, Move, Proposal, Target, Transition};
use plaus_scenes::{Rules, Scene, Stage};

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
