//! Totals over the records of a run.

use crate::error::RunFileError;
use crate::noted;
use crate::read::{Repeats, RunReader};
use crate::sample_id::{ChainPhase, SampleId};
use plaus_mcmc::{Climb, Distinct, Failures, FirstOfClass, Hits, Ladder, MoveCounts, MoveId, Scales, SolutionClass};
use serde::Serialize;

/// Totals over one chain's records.
#[derive(Debug, Clone, Serialize)]
pub struct ChainTally {
    /// Its number.
    pub chain: u32,
    /// Satisfying iterations, and the first of them.
    pub hits: Hits,
    /// How often each move ended in each way.
    pub counts: Vec<MoveCounts>,
    /// How many draws it simulated, on all rungs, and which of them failed.
    pub failures: Failures,
    /// Draws of the sampling phase that satisfy the constraint.
    pub satisfying_draws: u64,
    /// Number of distinct solutions recorded by this chain, where solutions count.
    pub distinct: u64,
    /// The likeliest satisfying draw, with its log p.
    pub best: Option<(SampleId, f64)>,
    /// How its replicas fared, if there are more than one.
    pub tempering: Option<TemperingTally>,
    /// The scales of its moves, if it adapts any.
    pub scales: Vec<ScaleTally>,
    /// Number of iterations in which its moves learnt, once that is over; it then stands still for the rest of the
    /// warm-up. `None` if they learn nothing.
    pub learnt_in: Option<u64>,
    /// The probabilities of its moves, if they were learnt in the warm-up; empty otherwise, and during the warm-up.
    pub weights: Vec<f64>,
}

/// The value to which a scale was adapted.
#[derive(Debug, Clone, Serialize)]
pub struct ScaleTally {
    /// The move.
    #[serde(rename = "move")]
    pub kernel: String,
    /// Its scale.
    pub scale: &'static str,
    /// Whether the warm-up is over, so that it no longer changes.
    pub frozen: bool,
    /// Its value; `None` if it was tried too rarely in the warm-up, so that the move stays as configured.
    pub value: Option<f64>,
    /// The share of proposals that should be accepted.
    pub target: f64,
    /// Number of proposals made with it: since the warm-up, or during the warm-up while it lasts.
    pub tried: u64,
    /// Number of those that were accepted.
    pub accepted: u64,
}

fn scales(run: &RunReader<'_>, scales: &Scales) -> Vec<ScaleTally> {
    // An open run has a scenario that makes a scene, and moves.
    let Ok(moves) = run.run().manifest().mixture(run.scene()) else { return Vec::new() };
    let mut all = Vec::new();
    for (id, (_, kernel)) in (0..).map(MoveId).zip(moves.iter()) {
        let adapted = scales.values(id).into_iter().zip(scales.adapted(id));
        all.extend(kernel.scales().iter().zip(adapted).map(|(scale, (value, adapted))| ScaleTally {
            kernel: kernel.name().to_owned(),
            scale: scale.name,
            frozen: scales.are_frozen(),
            value,
            target: scale.target,
            tried: adapted.tried(),
            accepted: adapted.accepted(),
        }));
    }
    all
}

/// How the replicas of one chain fared.
#[derive(Debug, Clone, Serialize)]
pub struct TemperingTally {
    /// Inverse temperatures of the rungs.
    pub betas: Vec<f64>,
    /// Share of swaps rejected between each rung and the next.
    pub rejected: Vec<f64>,
    /// Their sum.
    pub barrier: f64,
    /// States that reached the target's rung from the first one since the warm-up.
    pub restarts: u64,
    /// Replicas that reached the first rung from the target's since the warm-up.
    pub round_trips: u64,
}

impl TemperingTally {
    fn of(climb: &Climb) -> Self {
        let rejected = climb.rejected();
        Self {
            betas: climb.ladder().betas().to_vec(),
            barrier: Ladder::barrier(&rejected),
            rejected,
            restarts: climb.restarts(),
            round_trips: climb.round_trips(),
        }
    }
}

/// Totals over the records of all chains.
#[derive(Debug, Clone, Serialize)]
pub struct Tally {
    /// One tally for each chain.
    pub chains: Vec<ChainTally>,
    /// Number of distinct solutions recorded by all chains together, where solutions count: see
    /// [`crate::solutions::distinct`].
    pub distinct: u64,
    /// Number of those first recorded in the warm-up.
    pub while_adapting: u64,
    /// Counts of each move over all chains.
    pub counts: Vec<MoveCounts>,
    /// How many draws all chains simulated, and which of them failed.
    pub failures: Failures,
}

impl Tally {
    /// Reads all records once.
    ///
    /// # Errors
    /// [`RunFileError`] if they are damaged.
    pub fn of(run: &RunReader<'_>) -> Result<Self, RunFileError> {
        let parts: Vec<(ChainTally, Distinct)> = run.each_chain(|chain| tally(run, chain))?;
        let distinct = noted::taken(parts.iter().flat_map(|(_, distinct)| distinct.sightings()).collect());
        let warmup = run.run().manifest().plan.warmup;
        let while_adapting = distinct.firsts().iter().filter(|first| first.iteration < warmup).count() as u64;
        let mut counts = vec![MoveCounts::default(); run.run().manifest().moves.len()];
        for (chain, _) in &parts {
            counts.iter_mut().zip(&chain.counts).for_each(|(sum, count)| sum.add(count));
        }
        let mut failures = Failures::default();
        parts.iter().for_each(|(chain, _)| failures.add(&chain.failures));
        let chains = parts.into_iter().map(|(chain, _)| chain).collect();
        Ok(Self { chains, distinct: distinct.count(), while_adapting, counts, failures })
    }

    /// The earliest iteration at which any chain satisfied the constraint.
    #[must_use]
    pub fn first_hit(&self) -> Option<u64> {
        self.chains.iter().filter_map(|chain| chain.hits.first).min()
    }

    /// The fewest and the most iterations of a chain in which moves learnt; `None` if none has learnt yet.
    #[must_use]
    pub fn learnt_in(&self) -> Option<(u64, u64)> {
        let all = || self.chains.iter().filter_map(|chain| chain.learnt_in);
        all().min().zip(all().max())
    }

    /// Whether any iteration of any chain satisfied the constraint.
    #[must_use]
    pub fn is_satisfied(&self) -> bool {
        self.first_hit().is_some() || self.distinct > 0
    }

    /// The likeliest satisfying draw of the sampling phase; if it has none, that of the warm-up, if solutions count
    /// there.
    #[must_use]
    pub fn best(&self) -> Option<SampleId> {
        let best = self.chains.iter().filter_map(|chain| chain.best);
        best.reduce(|best, next| if (next.0.phase, next.1) > (best.0.phase, best.1) { next } else { best })
            .map(|(sample, _)| sample)
    }
}

/// When a chain first recorded each class of solutions.
///
/// # Errors
/// [`RunFileError`] if its records are damaged.
pub(crate) fn firsts(run: &RunReader<'_>, chain: u32) -> Result<Distinct, RunFileError> {
    let mut distinct = Distinct::apart(1.0);
    for &phase in run.counted() {
        run.walk(chain, phase, |repeats| -> Result<(), RunFileError> {
            if let Some(class) = repeats.entry.class {
                note(&mut distinct, run, (chain, phase), class, &repeats);
            }
            Ok(())
        })?;
    }
    Ok(distinct)
}

fn note(
    distinct: &mut Distinct,
    run: &RunReader<'_>,
    (chain, phase): (u32, ChainPhase),
    class: SolutionClass,
    repeats: &Repeats<'_>,
) {
    // Where the warm-up counts too, an entry was noted once, at its beginning.
    if !repeats.begins && run.run().manifest().plan.counts_from() == 0 {
        return;
    }
    let first = FirstOfClass { iteration: run.iteration_of(phase, repeats.draw), chain, class };
    noted::note(distinct, first, &repeats.entry.state, run.run().manifest().plan, run.scene());
}

fn tally(run: &RunReader<'_>, chain: u32) -> Result<(ChainTally, Distinct), RunFileError> {
    let snapshot = run.snapshot(chain);
    let mut tally = ChainTally {
        chain,
        hits: snapshot.map(|snapshot| snapshot.hits).unwrap_or_default(),
        counts: snapshot.map(|snapshot| snapshot.counts.clone()).unwrap_or_default(),
        failures: snapshot.map(|snapshot| snapshot.failures.clone()).unwrap_or_default(),
        satisfying_draws: 0,
        distinct: 0,
        best: None,
        tempering: snapshot
            .and_then(|snapshot| snapshot.replicas.as_ref())
            .map(|replicas| TemperingTally::of(replicas.climb())),
        scales: snapshot
            .and_then(|snapshot| snapshot.scales.as_ref())
            .map_or_else(Vec::new, |adapted| scales(run, adapted)),
        learnt_in: snapshot
            .and_then(|snapshot| snapshot.scales.as_ref())
            .filter(|scales| scales.are_frozen())
            .map(Scales::until),
        weights: snapshot
            .and_then(|snapshot| snapshot.scales.as_ref())
            .and_then(Scales::probabilities)
            .unwrap_or_default(),
    };
    let mut distinct = Distinct::apart(1.0);
    for &phase in run.counted() {
        // More is known about a draw of the sampling phase than about one made while moves were adapted.
        let before = tally.best.take();
        run.walk(chain, phase, |repeats| -> Result<(), RunFileError> {
            let Some(class) = repeats.entry.class else { return Ok(()) };
            note(&mut distinct, run, (chain, phase), class, &repeats);
            tally.satisfying_draws += if phase.is_sampling() { repeats.draws } else { 0 };
            let log_p = repeats.entry.state.log_p().value();
            if tally.best.is_none_or(|(_, best)| log_p > best) {
                tally.best = Some((SampleId { chain, phase, draw: repeats.draw }, log_p));
            }
            Ok(())
        })?;
        tally.best = tally.best.or(before);
    }
    tally.distinct = distinct.count();
    Ok((tally, distinct))
}
