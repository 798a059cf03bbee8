//! How well the outcomes mix while a run is still being sampled, from a thinned copy of their values, so that the cost
//! stays small however long the run gets.

use crate::error::RunFileError;
use crate::records::{Blocks, Extent};
use crate::{Draw, Outcome};
use plaus_mcmc::diagnose::summarize;
use plaus_mcmc::{Block, Plan, parallel};
use plaus_scenes::{Role, Scene, Stage};
use std::ops::Range;
use std::path::Path;

/// Most values kept for each chain and outcome. If there are more, every other one is dropped, and from then on only
/// half as many are added.
const MOST: usize = 1024;
/// Smallest number of values of a chain and outcome that is worth evaluating.
const LEAST: usize = 32;
/// Number of outcomes evaluated: scenes of many bodies have more, which would cost too much for a quick look.
const OUTCOMES: usize = 16;

/// What is known of the outcomes at one moment of a run. It uses fewer draws than [`Diagnosis`](crate::Diagnosis), at
/// most 1,024 of each chain, and only the first 16 outcomes.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixing {
    /// The largest R̂, and its outcome; `None` for one chain.
    pub rhat: Option<(String, f64)>,
    /// The least effective sample size, of bulk or tail, and its outcome.
    pub ess: (String, f64),
}

/// Thinned values of a scene's outcomes, as the chains record them.
pub(crate) struct Gauge<'a> {
    scene: &'a Stage,
    /// Names of the outcomes, and their numbers among the scalars.
    outcomes: Vec<(String, usize)>,
    /// For each outcome and each chain: every 2^`shift`-th draw from `first` on, where `first` is the first after the
    /// warm-up.
    values: Vec<Vec<Vec<f64>>>,
    shift: u32,
    first: u64,
    thin: u64,
    scalars: Vec<f64>,
    /// Number of the first chain.
    lowest: u32,
}

impl<'a> Gauge<'a> {
    /// A gauge without draws.
    pub(crate) fn new(scene: &'a Stage, plan: &Plan, chains: Range<u32>) -> Self {
        let all = scene.scalars();
        let scalars = vec![0.0; all.len()];
        let outcomes = all.into_iter().enumerate().filter(|(_, scalar)| scalar.role == Role::Outcome);
        let outcomes: Vec<_> = outcomes.take(OUTCOMES).map(|(number, scalar)| (scalar.name, number)).collect();
        let values = vec![vec![Vec::new(); chains.len()]; outcomes.len()];
        let (first, lowest) = (plan.warmup.div_ceil(plan.thin), chains.start);
        Self { scene, outcomes, values, shift: 0, first, thin: plan.thin, scalars, lowest }
    }

    /// Reads what a chain recorded before the run was continued; all chains go equally far.
    pub(crate) fn read(&mut self, path: &Path, extent: Extent) -> Result<(), RunFileError> {
        let draws = extent.end_iteration.div_ceil(self.thin).saturating_sub(self.first);
        while draws >> self.shift >= MOST as u64 {
            self.shift += 1;
        }
        for block in Blocks::open(path, extent)? {
            self.note(extent.chain, &block?);
        }
        Ok(())
    }

    /// Adds a block that a chain recorded.
    pub(crate) fn note(&mut self, chain: u32, block: &Block<Draw, Outcome>) {
        let (first, shift) = (self.first, self.shift);
        let kept_before = |draw: u64| (draw.saturating_sub(first) + (1 << shift) - 1) >> shift;
        let mut next = block.first_iteration.div_ceil(self.thin);
        for entry in &block.entries {
            let times = kept_before(next + entry.draws) - kept_before(next);
            next += entry.draws;
            if times == 0 {
                continue;
            }
            self.scene.write_scalars(entry.state.by_ref(), &mut self.scalars);
            for ((_, number), chains) in self.outcomes.iter().zip(&mut self.values) {
                chains[(chain - self.lowest) as usize]
                    .extend(std::iter::repeat_n(self.scalars[*number], times as usize));
            }
        }
    }

    /// Drops every other value while there are too many; to be called when all chains are equally far.
    pub(crate) fn thin_out(&mut self) {
        let length = |values: &Vec<Vec<Vec<f64>>>| values.first().and_then(|chains| chains.first()).map_or(0, Vec::len);
        while length(&self.values) > MOST {
            self.shift += 1;
            for chain in self.values.iter_mut().flatten() {
                let mut keep = false;
                chain.retain(|_| {
                    keep = !keep;
                    keep
                });
            }
        }
    }

    /// R̂ and effective sample sizes of the outcomes that have moved; `None` if none has, or there are too few
    /// draws.
    pub(crate) fn mixing(&self) -> Option<Mixing> {
        let worth = |chains: &Vec<Vec<f64>>| {
            chains[0].len() >= LEAST && chains.iter().flatten().any(|value| value != &chains[0][0])
        };
        let look = |k: usize| {
            let ((name, _), chains) = (&self.outcomes[k], &self.values[k]);
            let summary = summarize(chains).ok().filter(|_| worth(chains))?;
            Some((name.clone(), summary.rhat, summary.ess_bulk.min(summary.ess_tail)))
        };
        let rows: Vec<_> = parallel::map(self.outcomes.len(), look).into_iter().flatten().collect();
        let rhat = rows.iter().filter_map(|(name, rhat, _)| Some((name, (*rhat)?)));
        let rhat = rhat.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(name, rhat)| (name.clone(), rhat));
        let ess = rows.iter().min_by(|a, b| a.2.total_cmp(&b.2)).map(|(name, _, ess)| (name.clone(), *ess))?;
        Some(Mixing { rhat, ess })
    }
}
