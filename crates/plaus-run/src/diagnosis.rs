//! Whether a run has converged: the diagnostics of every scalar, the variables of the draw first.

use crate::error::RunFileError;
use crate::read::RunReader;
use crate::sample_id::ChainPhase;
use crate::streamed::Moments;
use crate::tally::{ChainTally, Tally};
use plaus_mcmc::diagnose::{DiagnoseError, Summary, ess_where, summarize};
use plaus_mcmc::parallel;
use plaus_scenes::{Role, Scalar, Scene};
use serde::Serialize;
use std::fmt;

/// Numbers held in memory at once while scalars are read. For longer runs, and for runs with very many chains, ranks
/// use only every n-th draw.
const HELD: u64 = 1 << 25;
/// Rank-normalised R̂ above this says that the chains disagree (Vehtari et al. 2021).
pub const MAX_RHAT: f64 = 1.01;
/// Effective draws a chain needs for its diagnostics to be trusted (Vehtari et al. 2021).
pub const MIN_ESS_PER_CHAIN: f64 = 100.0;

/// What was found about a run.
#[derive(Debug, Clone, Serialize)]
pub struct Diagnosis {
    /// Iterations of the sampling phase, of each chain.
    pub iterations: u64,
    /// Draws recorded in the sampling phase, of each chain.
    pub recorded: u64,
    /// Draws used, of each chain: every `stride`-th.
    pub draws: u64,
    /// 1 if all draws are used.
    pub stride: u64,
    /// For each scalar; those of the draw come first.
    pub scalars: Vec<ScalarDiagnosis>,
    /// How many independent solutions there are. `None` if there are none; for chains also if there are fewer than two,
    /// or nothing in them ever moved.
    pub independent: Option<Independent>,
    /// Totals over the records.
    pub tally: Tally,
    /// What speaks against trusting the run.
    pub findings: Vec<Finding>,
}

/// The number of independent solutions: how many independent draws of the target, given that they satisfy the
/// constraint, would locate the centre of one variable as well as the run's solutions do. The variable is the one of
/// the draw that mixes worst.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Independent {
    /// How many.
    pub ess: f64,
    /// The variable; `None` if each solution was drawn independently, so that all kept ones count.
    pub scalar: Option<String>,
}

/// What was found about a scalar.
#[derive(Debug, Clone, Serialize)]
pub struct ScalarDiagnosis {
    /// The scalar.
    #[serde(flatten)]
    pub scalar: Scalar,
    /// Mean, standard deviation, errors, effective draws; `None` if `trouble` says why.
    pub summary: Option<Summary>,
    /// Why there is no summary.
    pub trouble: Option<String>,
    /// Effective draws (bulk) per 1,000 iterations.
    pub ess_per_1000: Option<f64>,
    /// Share of the draws in which it has no value: a time of rest that never came, the end of a body that was not
    /// there. Then there is no summary.
    pub without_value: f64,
}

/// Something that speaks against trusting a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "finding", rename_all = "snake_case")]
pub enum Finding {
    /// No iteration of any chain satisfied the constraint.
    NoSatisfyingSample,
    /// The chains disagree.
    Rhat {
        /// The scalar.
        scalar: String,
        /// R̂.
        rhat: f64,
        /// Whether the draws are independent: then there are only too few of them.
        #[serde(skip)]
        is_independent: bool,
    },
    /// Too few effective draws.
    Ess {
        /// The scalar.
        scalar: String,
        /// `bulk` or `tail`.
        kind: &'static str,
        /// The effective draws.
        ess: f64,
        /// The effective draws that are needed.
        needed: f64,
    },
    /// A variable of the draw never moved.
    Stuck {
        /// The scalar.
        scalar: String,
    },
    /// No diagnostics could be computed.
    Undiagnosed {
        /// The scalar.
        scalar: String,
        /// Why.
        reason: String,
    },
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSatisfyingSample => f.write_str("no sample satisfies the constraint"),
            Self::Rhat { scalar, rhat, is_independent } => {
                let why = match is_independent {
                    true => "the draws are independent, but too few for statistics",
                    false => "the chains do not agree yet",
                };
                write!(f, "{scalar}: R-hat {rhat:.4} is above {MAX_RHAT}: {why}")
            }
            Self::Ess { scalar, kind, ess, needed } => {
                write!(
                    f,
                    "{scalar}: {ess:.0} effective draws ({kind}), but at least {needed:.0} are needed: more iterations, or moves that mix better"
                )
            }
            Self::Stuck { scalar } => write!(f, "{scalar}: never changed"),
            Self::Undiagnosed { scalar, reason } => write!(f, "{scalar}: {reason}"),
        }
    }
}

impl Finding {
    /// Puts findings of one kind in order, the worst first: R̂, or what effective draws fall short by, as a ratio.
    pub fn severity(&self) -> f64 {
        match self {
            Self::NoSatisfyingSample => f64::INFINITY,
            Self::Rhat { rhat, .. } => *rhat,
            Self::Ess { ess, needed, .. } => needed / ess,
            Self::Stuck { .. } | Self::Undiagnosed { .. } => 0.0,
        }
    }
}

impl Diagnosis {
    /// The part of `done` iterations of each chain, since its start, that came after the warm-up. Iterations of the
    /// warm-up in which a chain only stood still do not count.
    #[must_use]
    pub fn share_after_warmup(&self, done: u64, warmup: u64) -> f64 {
        let stood = |chain: &ChainTally| chain.learnt_in.map_or(0, |learnt| done.min(warmup).saturating_sub(learnt));
        let stood: u64 = self.tally.chains.iter().map(stood).sum();
        let chains = self.tally.chains.len() as u64;
        (chains * self.iterations) as f64 / (chains * done).saturating_sub(stood).max(1) as f64
    }

    /// Diagnoses the sampling phase of a run from every draw, or from every n-th if that would be more than `most` in
    /// each chain, or more than memory allows. Means and standard deviations always use all draws.
    ///
    /// # Errors
    /// [`RunFileError`] if the records are damaged.
    pub fn of(run: &RunReader<'_>, most: Option<u64>) -> Result<Self, RunFileError> {
        let recorded = run.draws(ChainPhase::Sampling);
        let room = (HELD / run.chains().len().max(1) as u64).max(1);
        let stride = recorded.div_ceil(most.map_or(room, |most| most.clamp(1, room))).max(1);
        let iterations = run.iterations().saturating_sub(run.run().manifest().plan.warmup);
        let (mut scalars, mut independent) = (Vec::new(), None::<Independent>);
        let satisfied = satisfied(run, stride)?;
        let all = run.scene().scalars();
        let width = (HELD / (run.chains().len() as u64 * recorded.div_ceil(stride)).max(1)).max(1);
        for from in (0..all.len()).step_by(usize::try_from(width).unwrap_or(usize::MAX)) {
            let some = &all[from..all.len().min(from.saturating_add(width as usize))];
            let (columns, moments) = streamed(run, from, some.len(), stride)?;
            let shown: Vec<usize> = (0..some.len()).filter(|&k| some[k].role != Role::Detail).collect();
            let looked_at = parallel::map(shown.len(), |nth| {
                let k = shown[nth];
                let (scalar, chains) = (&some[k], &columns[k]);
                let ess = (scalar.role == Role::Draw).then(|| worth_of(chains, &satisfied)).flatten();
                let solutions = ess.map(|ess| Independent { ess, scalar: Some(scalar.name.clone()) });
                (solutions, diagnose(scalar, chains, iterations, (stride > 1).then_some(moments[k])))
            });
            let (fewest, diagnosed): (Vec<_>, Vec<_>) = looked_at.into_iter().unzip();
            let fewest = fewest.into_iter().flatten().chain(independent);
            independent = fewest.reduce(|a, b| if b.ess < a.ess { b } else { a });
            scalars.extend(diagnosed);
        }
        if run.run().manifest().is_independent() {
            let kept = kept(run)?;
            independent = (kept > 0).then_some(Independent { ess: kept as f64, scalar: None });
        }
        variables_first(&mut scalars);
        let tally = Tally::of(run)?;
        let findings = findings(&scalars, &tally, run.run().manifest().is_independent());
        let draws = recorded.div_ceil(stride);
        Ok(Self { iterations, recorded, draws, stride, scalars, independent, tally, findings })
    }

    /// Whether nothing speaks against the run.
    #[must_use]
    pub fn is_healthy(&self) -> bool {
        self.findings.is_empty()
    }
}

/// Puts variables of the draw before outcomes.
fn variables_first(scalars: &mut [ScalarDiagnosis]) {
    scalars.sort_by_key(|scalar| scalar.scalar.role != Role::Draw);
}

/// The number of independent solutions that these values of one variable are worth, from the values and satisfaction of
/// each chain's draws; `None` if that is unknown. Never more than there are solutions, however short the run.
pub(crate) fn worth_of(chains: &[Vec<f64>], satisfied: &[Vec<bool>]) -> Option<f64> {
    let solutions = satisfied.iter().flatten().filter(|&&is| is).count();
    Some(ess_where(chains, satisfied).ok()??.min(solutions as f64))
}

/// Number of recorded solutions that were drawn independently in the sampling phase, over all chains.
fn kept(run: &RunReader<'_>) -> Result<u64, RunFileError> {
    let chain = |chain| -> Result<u64, RunFileError> {
        let mut kept = 0;
        run.walk(chain, ChainPhase::Sampling, |repeats| -> Result<(), RunFileError> {
            kept += u64::from(repeats.accepted > 0 && repeats.entry.class.is_some());
            Ok(())
        })?;
        Ok(kept)
    };
    Ok(run.each_chain(chain)?.into_iter().sum())
}

/// For each chain and each draw, whether it satisfies the constraint.
fn satisfied(run: &RunReader<'_>, stride: u64) -> Result<Vec<Vec<bool>>, RunFileError> {
    let chain = |chain| -> Result<Vec<bool>, RunFileError> {
        let mut column = Vec::new();
        run.walk(chain, ChainPhase::Sampling, |repeats| -> Result<(), RunFileError> {
            let times = (repeats.draw + repeats.draws).div_ceil(stride) - repeats.draw.div_ceil(stride);
            column.extend(std::iter::repeat_n(repeats.entry.class.is_some(), times as usize));
            Ok(())
        })?;
        Ok(column)
    };
    run.each_chain(chain)
}

/// The values of `count` scalars from number `from` on: for each scalar, each chain and each draw.
///
/// # Errors
/// [`RunFileError`] if the records are damaged.
pub fn columns(
    run: &RunReader<'_>,
    from: usize,
    count: usize,
    stride: u64,
) -> Result<Vec<Vec<Vec<f64>>>, RunFileError> {
    Ok(streamed(run, from, count, stride)?.0)
}

/// For each scalar, each chain and each draw.
type Columns = Vec<Vec<Vec<f64>>>;

/// Like [`columns`]; also gives the moments of all draws of each scalar if only some draws are asked for.
fn streamed(
    run: &RunReader<'_>,
    from: usize,
    count: usize,
    stride: u64,
) -> Result<(Columns, Vec<Moments>), RunFileError> {
    let width = run.scene().scalars().len();
    let chain = |chain| -> Result<(Vec<Vec<f64>>, Vec<Moments>), RunFileError> {
        let (mut columns, mut moments) = (vec![Vec::new(); count], vec![Moments::default(); count]);
        let mut values = vec![0.0; width];
        run.walk(chain, ChainPhase::Sampling, |repeats| -> Result<(), RunFileError> {
            let times = (repeats.draw + repeats.draws).div_ceil(stride) - repeats.draw.div_ceil(stride);
            if times > 0 || stride > 1 {
                run.scene().write_scalars(repeats.entry.state.by_ref(), &mut values);
                for (column, &value) in columns.iter_mut().zip(&values[from..]) {
                    column.extend(std::iter::repeat_n(value, times as usize));
                }
            }
            if stride > 1 {
                let noted = moments.iter_mut().zip(&values[from..]);
                noted.for_each(|(moments, &value)| moments.note(value, repeats.draws));
            }
            Ok(())
        })?;
        Ok((columns, moments))
    };
    let chains: Vec<(Vec<Vec<f64>>, Vec<Moments>)> = run.each_chain(chain)?;
    let (mut scalars, mut all): (Columns, _) = (vec![Vec::new(); count], vec![Moments::default(); count]);
    for (chain, moments) in chains {
        scalars.iter_mut().zip(chain).for_each(|(scalar, column)| scalar.push(column));
        all.iter_mut().zip(&moments).for_each(|(all, moments)| all.join(moments));
    }
    Ok((scalars, all))
}

/// `all` holds the moments of all draws, if `chains` holds only some of them.
fn diagnose(scalar: &Scalar, chains: &[Vec<f64>], iterations: u64, all: Option<Moments>) -> ScalarDiagnosis {
    let mut summary: Result<Summary, DiagnoseError> = summarize(chains);
    if let (Ok(summary), Some(all)) = (&mut summary, all) {
        (summary.mean, summary.sd) = (all.mean(), all.sd().unwrap_or(0.0));
    }
    let thousands = iterations as f64 * chains.len() as f64 / 1000.0;
    let ess_per_1000 = summary.as_ref().ok().map(|summary| summary.ess_bulk / thousands);
    let draws: usize = chains.iter().map(Vec::len).sum();
    let without = chains.iter().flatten().filter(|value| value.is_nan()).count();
    let without_value = without as f64 / draws.max(1) as f64;
    let trouble = match without {
        0 => summary.as_ref().err().map(ToString::to_string),
        _ => Some(format!("it has no value in {without} of {draws} draws")),
    };
    ScalarDiagnosis { scalar: scalar.clone(), summary: summary.ok(), trouble, ess_per_1000, without_value }
}

fn findings(scalars: &[ScalarDiagnosis], tally: &Tally, is_independent: bool) -> Vec<Finding> {
    let none = (!tally.is_satisfied()).then_some(Finding::NoSatisfyingSample);
    none.into_iter().chain(scalars.iter().flat_map(|row| against(row, is_independent))).collect()
}

/// Findings about one scalar.
fn against(row: &ScalarDiagnosis, is_independent: bool) -> Vec<Finding> {
    let scalar = || row.scalar.name.clone();
    let Some(summary) = &row.summary else {
        if row.scalar.role == Role::Outcome && row.without_value > 0.0 {
            return Vec::new();
        }
        return vec![Finding::Undiagnosed { scalar: scalar(), reason: row.trouble.clone().unwrap_or_default() }];
    };
    if summary.sd == 0.0 {
        // An outcome may be the same in all samples; a variable of the draw must not be.
        let stuck = row.scalar.role == Role::Draw;
        return stuck.then(|| Finding::Stuck { scalar: scalar() }).into_iter().collect();
    }
    let needed = MIN_ESS_PER_CHAIN * summary.chains as f64;
    let rhat = summary.rhat.filter(|&rhat| rhat > MAX_RHAT);
    let rhat = rhat.map(|rhat| Finding::Rhat { scalar: scalar(), rhat, is_independent });
    let few =
        |(kind, ess): (&'static str, f64)| (ess < needed).then(|| Finding::Ess { scalar: scalar(), kind, ess, needed });
    let ess = [("bulk", summary.ess_bulk), ("tail", summary.ess_tail)];
    rhat.into_iter().chain(ess.into_iter().filter_map(few)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A body that is not there ends nowhere, which speaks against no chain. A variable always has a value, and an
    /// infinite outcome is an error.
    #[test]
    fn an_outcome_may_have_no_value() {
        let of = |role, value: f64| {
            let column: Vec<f64> = (0..100).map(|k| if k % 4 == 0 { value } else { f64::from(k) }).collect();
            diagnose(&Scalar::new("ball.rest", "s", role, None), &[column], 100, None)
        };
        let row = of(Role::Outcome, f64::NAN);
        assert_eq!((row.without_value, against(&row, false)), (0.25, Vec::new()));
        assert_eq!(row.trouble.as_deref(), Some("it has no value in 25 of 100 draws"));
        for (role, value) in [(Role::Draw, f64::NAN), (Role::Outcome, f64::INFINITY)] {
            assert!(matches!(against(&of(role, value), false)[..], [Finding::Undiagnosed { .. }]), "{role:?} {value}");
        }
    }
}
