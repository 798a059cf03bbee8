//! The trial that decides whether chains or independent draws from the prior give independent solutions faster.
//!
//! A trial is a function of scenario and seed alone: it counts the work of simulations and uses no clock. So every
//! piece of a run, and the same run begun again, comes to the same result, which is stored in the manifest.

use crate::diagnosis::worth_of;
use crate::error::Error;
use crate::way::Way;
use plaus_dist::Seed;
use plaus_mcmc::{Chain, ChainError, Decision, Goal, Mixture, Plan, Pulse, Target, Tried, parallel, try_draws};
use plaus_scenes::scenario::Method;
use plaus_scenes::{Role, Scenario, Scene, Stage};

/// Draws from the prior between two checks of their result.
const AT_A_TIME: u64 = 32;
/// A trial that finds too few solutions makes one draw from the prior for this many of the run's iterations, within
/// bounds.
const ONE_FOR: u64 = 50;
const DRAWS: [u64; 2] = [64, 2048];
/// The same where only some solutions are asked for, because these should be found soon: the most draws between two
/// checks (at first as many as were made before), the largest number of draws, and the work after which no more are
/// made.
const AT_A_TIME_FOR_SOME: u64 = 8;
const DRAWS_FOR_SOME: u64 = 400;
const WORK_FOR_SOME: u64 = 300_000;
/// Number of solutions with which that trial ends: the prior then gives others as often, which are exact and
/// independent.
const ENOUGH_FOR_SOME: u64 = 2;
/// Number of solutions that a trial looks for; their rate is then known to within about a half.
const ENOUGH: u64 = 4;
/// If the prior needs fewer draws than this for a solution, no chain is tried. In `bowling-strike`, where chains mix
/// best of all scenes that come with plaus, they need about eight iterations for an independent solution.
const FEW: f64 = 8.0;
/// Number of independent solutions that the prior would give in as many simulations as a trial gives to chains after
/// their warm-up. Chains that never reach a solution seem to make one or two each.
const RIVAL: f64 = 12.0;
/// Chains of a trial.
const CHAINS: u32 = 4;
/// Least number of iterations of each, in its warm-up and after it: moves cannot adapt in fewer.
const LEAST: f64 = 64.0;
/// The part of the run's iterations that the trial of chains may use.
const SHARE: f64 = 0.15;

/// Whether a trial decides how a run's draws are made: if the scenario asks for one, or leaves the method open.
pub(crate) fn decides(scenario: &Scenario) -> bool {
    scenario.method() == Method::Auto
}

/// Whether a run looks for some solutions that need not be sampled.
pub(crate) fn looks_for_some(plan: &Plan) -> bool {
    plan.enough().is_some() && !plan.sampled
}

/// Decides by a trial, on the current pool of threads.
///
/// # Errors
/// [`Error`] if the model fails, or `pulse` was stopped.
pub(crate) fn tried(scenario: &Scenario, plan: Plan, scene: &Stage, pulse: &Pulse) -> Result<Way, Error> {
    if looks_for_some(&plan) {
        return tried_for_some(&plan, scene, pulse);
    }
    let because = |independent, why: String| Ok(Way { independent, climbs: false, why });
    if scene.most().is_none() {
        return because(false, "no bound on the constraint is known, as draws from the prior need".to_owned());
    }
    let total = plan.end().saturating_mul(u64::from(plan.chains));
    let most = (total / ONE_FOR).clamp(DRAWS[0], DRAWS[1]);
    let mut found = Tried::default();
    while found.draws < most && found.kept < ENOUGH {
        go_on(pulse)?;
        let made = try_draws(scene, plan.seed, found.draws..found.draws + AT_A_TIME.min(most - found.draws));
        go_on(pulse)?;
        found = found.and(made.map_err(|error| Error::Sampling(error.to_string()))?);
    }
    let Tried { draws, kept, work } = found;
    if kept == 0 {
        return because(false, format!("none of {draws} draws from the prior gives a solution"));
    }
    let one_in = draws as f64 / kept as f64;
    let seen = format!("{kept} of {draws} draws from the prior give a solution");
    if one_in <= FEW {
        return because(true, format!("{seen}, in fewer draws than chains need iterations"));
    }
    let iterations = (RIVAL * one_in / f64::from(CHAINS)).max(LEAST).ceil();
    let room = SHARE * total as f64 / f64::from(CHAINS);
    if 2.0 * iterations > room {
        return because(false, format!("{seen}; trying chains as well would take too much of this run"));
    }
    // If it can be afforded, as long a warm-up as the run's: what moves learn in a short one may not pay yet.
    let warmup = (plan.warmup as f64).clamp(iterations, room - iterations);
    let moves = scene.moves(&scenario.sampler.rules)?;
    let lengths = [warmup, iterations].map(|number| number as u64);
    let rival = Trial::of(&Course { scene, moves: &moves, plan, lengths, pulse })?;
    let (by_prior, by_chains) = ((draws + work) as f64 / kept as f64, rival.work / rival.independent);
    let of_chains = if by_chains.is_finite() { format!("{by_chains:.0}") } else { "more than were tried".into() };
    let why =
        format!("{seen}, or one for {by_prior:.0} simulated events; a trial of chains needed {of_chains} for one");
    because(by_prior <= by_chains, why)
}

/// Decides for a run that looks for some solutions: draws of the prior if they give solutions soon enough, else climbs,
/// each of which begins with a draw of the prior too.
fn tried_for_some(plan: &Plan, scene: &Stage, pulse: &Pulse) -> Result<Way, Error> {
    let climbing = |why: String| Ok(Way { independent: false, climbs: true, why });
    if scene.most().is_none() {
        return climbing("no bound on the constraint is known, as draws from the prior need".to_owned());
    }
    let enough = plan.solutions.unwrap_or(1).clamp(1, ENOUGH_FOR_SOME);
    let mut found = Tried::default();
    while found.draws < DRAWS_FOR_SOME && found.work < WORK_FOR_SOME && found.kept < enough {
        go_on(pulse)?;
        let next = found.draws.clamp(1, AT_A_TIME_FOR_SOME);
        let made = try_draws(scene, plan.seed, found.draws..found.draws + next);
        go_on(pulse)?;
        found = found.and(made.map_err(|error| Error::Sampling(error.to_string()))?);
    }
    let Tried { draws, kept, .. } = found;
    let seen = match kept {
        0 => format!("none of {draws} draws from the prior gives a solution"),
        1 => format!("1 of {draws} draws from the prior gives a solution"),
        _ => format!("{kept} of {draws} draws from the prior give a solution"),
    };
    match kept >= enough {
        true => Ok(Way { independent: true, climbs: false, why: seen }),
        false => climbing(seen),
    }
}

fn go_on(pulse: &Pulse) -> Result<(), Error> {
    let message = "stopped during the trial of methods";
    if pulse.is_stopped() { Err(Error::Request(message.to_owned())) } else { Ok(()) }
}

/// The result of chains in a trial.
struct Trial {
    /// Number of independent solutions.
    independent: f64,
    /// The work that they took: simulated events, and one for each iteration.
    work: f64,
}

impl Trial {
    /// Runs its chains.
    fn of(course: &Course<'_>) -> Result<Self, Error> {
        let walked = parallel::try_map(CHAINS as usize, |chain| course.walk(chain as u32));
        go_on(course.pulse)?;
        let walked = walked.map_err(|error| Error::Sampling(error.to_string()))?;
        let work = walked.iter().map(|one| one.work).sum::<u64>() as f64;
        let (satisfied, columns): (Vec<_>, Vec<_>) = walked.into_iter().map(|one| (one.satisfied, one.columns)).unzip();
        let variables = columns.first().map_or(0, Vec::len);
        let of_variable = |var: usize| columns.iter().map(|chain| chain[var].clone()).collect::<Vec<_>>();
        let worth = (0..variables).filter_map(|var| worth_of(&of_variable(var), &satisfied));
        Ok(Self { independent: worth.reduce(f64::min).unwrap_or(0.0), work })
    }
}

/// What the chains of a trial share.
struct Course<'a> {
    scene: &'a Stage,
    moves: &'a Mixture<Stage>,
    plan: Plan,
    /// Iterations of the warm-up, and after it.
    lengths: [u64; 2],
    pulse: &'a Pulse,
}

/// What is kept from a chain after its warm-up.
struct Walked {
    /// For each variable of the draw and each iteration.
    columns: Vec<Vec<f64>>,
    satisfied: Vec<bool>,
    work: u64,
}

impl Course<'_> {
    fn walk(&self, chain: u32) -> Result<Walked, ChainError> {
        // Seeds of runs are below 2⁶³, so no run has these chains.
        let streams = Seed(!self.plan.seed.0).chain(u64::from(chain));
        let mut chain = Chain::start(self.scene, self.moves, streams)?;
        let [warmup, counting] = self.lengths;
        if self.plan.adapt {
            let until = warmup;
            chain = if self.plan.weigh { chain.weighing(until) } else { chain.adapting(until) };
        }
        let scalars = self.scene.scalars();
        let variables: Vec<usize> = (0..scalars.len()).filter(|&k| scalars[k].role == Role::Draw).collect();
        let mut values = vec![0.0; scalars.len()];
        let mut walked = Walked { columns: vec![Vec::new(); variables.len()], satisfied: Vec::new(), work: 0 };
        let mut is_hit = false;
        for iteration in 1..=warmup + counting {
            if self.pulse.is_stopped() {
                break; // the whole trial is dropped
            }
            let before = self.scene.work();
            let decision = chain.step()?.decision;
            if iteration <= warmup {
                continue;
            }
            walked.work += 1 + self.scene.work() - before;
            if decision == Decision::Accepted || walked.satisfied.is_empty() {
                self.scene.write_scalars(chain.state().by_ref(), &mut values);
                is_hit = self.scene.class(chain.state().by_ref()).is_some();
            }
            walked.columns.iter_mut().zip(&variables).for_each(|(column, &var)| column.push(values[var]));
            walked.satisfied.push(is_hit);
        }
        Ok(walked)
    }
}
