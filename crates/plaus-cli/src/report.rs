//! What is reported about a finished run.

use crate::progress::acceptance;
use crate::table::{amount, counted, grouped, lay_out, percent, rounded, short};
use plaus_mcmc::{FailureKind, Failures, Ladder};
use plaus_run::{Beside, Diagnosis, Finding, Manifest};
use plaus_scenes::Role;
use serde_json::{Value, json};
use std::mem::discriminant;

/// How many findings of one kind are shown where there are many.
const MOST_OF_A_KIND: usize = 3;

/// The line that says what a run is. It always names the seed.
pub(crate) fn headline(manifest: &Manifest) -> String {
    let plan = &manifest.plan;
    let thin = if plan.thin > 1 { format!(", one in {} recorded", plan.thin) } else { String::new() };
    let rule = if manifest.exact { "exact" } else { "not exact" };
    let rungs = if plan.rungs > 1 { format!(", {} rungs each", plan.rungs) } else { String::new() };
    let up_to = if plan.adapt && plan.settle { "up to " } else { "" };
    let warmup = match plan.warmup - plan.climbs {
        0 => String::new(),
        warmup => format!(" after {up_to}{} of warm-up", grouped(warmup)),
    };
    format!(
        "{} ({}): seed {}, {}{rungs}{}{warmup}{thin}, {rule} acceptance (`plaus explain exact`)",
        manifest.scene,
        manifest.scenario.file,
        plan.seed,
        if let Some(shard) = manifest.shard {
            let chains = manifest.chains();
            format!("piece {shard}: chains {} to {}", chains.start, chains.end.saturating_sub(1))
        } else if plan.chains == 1 {
            "1 chain".to_owned()
        } else {
            format!("{} chains", plan.chains)
        },
        match plan.is_endless() {
            true =>
                plan.enough().map_or(String::new(), |some| format!(" until there are {},", counted(some, "solution"))),
            false => format!(" of {} iterations", grouped(plan.iterations)),
        },
    )
}

/// How draws are made, if a trial decided it, or they are independent.
pub(crate) fn way(manifest: &Manifest) -> Option<String> {
    let way = manifest.way.as_ref()?;
    Some(match (way.independent, way.climbs) {
        (true, _) => format!("sampling by independent draws from the prior: {}", way.why),
        (_, true) => format!(
            "searching by climbs, one solution each, without statistical weight; `--exact` asks for sampled ones \
             (`plaus explain climbs`): {}",
            way.why
        ),
        _ => format!("sampling by chains: {}", way.why),
    })
}

/// The warning about an acceptance rule without a guarantee.
pub(crate) fn warning(manifest: &Manifest) -> Option<String> {
    let on: Vec<&str> = manifest.acceptance_rule.iter().filter(|(_, on)| **on).map(|(flag, _)| flag.as_str()).collect();
    let flags = on.join(", ");
    (!manifest.exact).then(|| {
        format!(
        "warning: the acceptance rule is the paper's as printed ({flags}). Such a chain has no guaranteed stationary \
         law, and it is unknown what it converges to, if it does. Set sampler.rules.preset = \"exact\" to sample the \
         stated law"
        )
    })
}

/// The table of at most `most` scalars. Outcomes are chosen before random variables, and are shown after them.
pub(crate) fn scalar_table(diagnosis: &Diagnosis, most: usize) -> String {
    let head = ["", "mean", "sd", "MCSE", "ESS bulk", "ESS tail", "ESS/1000 it", "R-hat"];
    let mut rows: Vec<Vec<String>> = Vec::new();
    let outcomes = diagnosis.scalars.iter().filter(|row| row.scalar.role == Role::Outcome).count().min(most);
    for (role, title) in [(Role::Draw, "variables of the draw"), (Role::Outcome, "outcomes")] {
        let room = if role == Role::Outcome { outcomes } else { most - outcomes };
        let mut of_role = diagnosis.scalars.iter().filter(|row| row.scalar.role == role).take(room).peekable();
        if of_role.peek().is_none() {
            continue;
        }
        let mut heading = head.map(str::to_owned).to_vec();
        heading[0] = title.to_owned();
        rows.push(heading);
        for row in of_role {
            let unit = if row.scalar.unit.is_empty() { String::new() } else { format!(" ({})", row.scalar.unit) };
            let without = match row.without_value {
                0.0 => String::new(),
                share => format!(", no value in {}", percent(share)),
            };
            let mut cells = vec![format!("  {}{unit}{without}", row.scalar.name)];
            match &row.summary {
                Some(s) => {
                    let per_1000 = row.ess_per_1000.map_or("-".to_owned(), short);
                    let rhat = s.rhat.map_or("-".to_owned(), |rhat| format!("{rhat:.4}"));
                    cells.extend([s.mean, s.sd, s.mcse_mean].map(short));
                    cells.extend([s.ess_bulk, s.ess_tail].map(rounded));
                    cells.extend([per_1000, rhat]);
                }
                None => cells.extend(std::iter::repeat_n("-".to_owned(), head.len() - 1)),
            }
            rows.push(cells);
        }
    }
    lay_out(&rows)
}

/// Each move's acceptance, over all chains and per chain where there are few; also, on average over chains, how often
/// it is made since the warm-up, where that was learnt there.
pub(crate) fn move_table(manifest: &Manifest, diagnosis: &Diagnosis) -> String {
    let tally = &diagnosis.tally;
    let few = tally.chains.len() <= 8;
    let mut rows = vec![vec!["move".to_owned(), "tried".to_owned(), "accepted".to_owned()]];
    if few {
        rows[0].extend(tally.chains.iter().map(|one| format!("chain {}", one.chain)));
    }
    let learnt: Vec<&[f64]> =
        tally.chains.iter().map(|one| one.weights.as_slice()).filter(|weights| !weights.is_empty()).collect();
    if !learnt.is_empty() {
        rows[0].push("learnt weight".to_owned());
    }
    for (index, (name, count)) in manifest.moves.iter().zip(&tally.counts).enumerate() {
        let mut row = vec![format!("  {name}"), grouped(count.made()), percent(count.acceptance())];
        if few {
            let of = |chain: &plaus_run::tally::ChainTally| {
                chain.counts.get(index).map_or("-".to_owned(), |count| percent(count.acceptance()))
            };
            row.extend(tally.chains.iter().map(of));
        }
        if !learnt.is_empty() {
            let sum: f64 = learnt.iter().filter_map(|weights| weights.get(index)).sum();
            row.push(percent(sum / learnt.len() as f64));
        }
        rows.push(row);
    }
    lay_out(&rows)
}

/// The adapted scales, with the share accepted at each, and for each chain where there are few. Empty for chains that
/// adapt nothing.
pub(crate) fn scale_table(diagnosis: &Diagnosis) -> String {
    let chains = &diagnosis.tally.chains;
    let Some(first) = chains.first().filter(|chain| !chain.scales.is_empty()) else { return String::new() };
    let shown = if chains.len() <= 8 { chains.as_slice() } else { &[] };
    let title = match diagnosis.tally.learnt_in() {
        Some((least, most)) if least == most => format!("scales, kept since the warm-up of {}", grouped(most)),
        Some((least, most)) => format!("scales, kept since the warm-up of {} to {}", grouped(least), grouped(most)),
        None => "scales, still being adapted".to_owned(),
    };
    let mut rows = vec![vec![title, "goal".to_owned(), "accepted".to_owned()]];
    rows[0].extend(shown.iter().map(|one| format!("chain {}", one.chain)));
    for (index, scale) in first.scales.iter().enumerate() {
        let all = || chains.iter().filter_map(|chain| chain.scales.get(index));
        let (tried, accepted) = (all().map(|one| one.tried).sum::<u64>(), all().map(|one| one.accepted).sum::<u64>());
        let share = if tried == 0 { "-".to_owned() } else { percent(accepted as f64 / tried as f64) };
        let mut row = vec![format!("  {} {}", scale.kernel, scale.scale), percent(scale.target), share];
        let value = |chain: &plaus_run::tally::ChainTally| {
            chain.scales.get(index).and_then(|one| one.value).map_or("as configured".to_owned(), short)
        };
        row.extend(shown.iter().map(value));
        rows.push(row);
    }
    lay_out(&rows) + "\n"
}

/// First hit, share of satisfying draws, number of distinct solutions.
pub(crate) fn solutions(manifest: &Manifest, diagnosis: &Diagnosis) -> String {
    let tally = &diagnosis.tally;
    let firsts: Vec<u64> = tally.chains.iter().filter_map(|chain| chain.hits.first).collect();
    let (Some(first), Some(last)) = (firsts.iter().min(), firsts.iter().max()) else {
        return "no iteration satisfied the constraint\n".to_owned();
    };
    let all = match tally.chains.len() - firsts.len() {
        0 => format!("all chains by iteration {}", grouped(*last)),
        none => format!("{none} of {} chains found none", tally.chains.len()),
    };
    let satisfying: u64 = tally.chains.iter().map(|chain| chain.satisfying_draws).sum();
    let share = satisfying as f64 / (diagnosis.recorded * tally.chains.len() as u64) as f64;
    let note = if share.is_finite() {
        format!("{} of the sampled draws are solutions; ", percent(share))
    } else {
        String::new()
    };
    let (first, distinct) = (grouped(*first), counted(tally.distinct, "distinct solution"));
    let plan = manifest.plan;
    let differ = if plan.enough().is_some() { "clearly different" } else { "different in kind" };
    let early = match tally.while_adapting {
        _ if manifest.is_independent() => "; independent draws from the prior".to_owned(),
        early @ 1.. if plan.climbs > 0 => format!("; {} of them found by climbs, not weighted", grouped(early)),
        0 => String::new(),
        1 if tally.distinct == 1 => "; found in the warm-up, which statistics leave out".to_owned(),
        early if early == tally.distinct => "; all first met in the warm-up, which statistics leave out".to_owned(),
        early => format!("; {} of them found in the warm-up; statistics leave these out", grouped(early)),
    };
    format!(
        "first solution at iteration {first}, {all}\n{note}{distinct} ({differ}: `plaus explain distinct`){early}\n"
    )
}

/// Which draws failed, in one line; empty if none did.
pub(crate) fn failures(failures: &Failures) -> String {
    if failures.failed() == 0 { String::new() } else { format!("{failures}\n") }
}

/// That all draws are the same, if nothing in the world is uncertain.
pub(crate) fn certain(diagnosis: &Diagnosis) -> &'static str {
    let is_fixed = |row: &plaus_run::diagnosis::ScalarDiagnosis| {
        row.scalar.role == Role::Outcome && row.summary.as_ref().is_some_and(|summary| summary.sd == 0.0)
    };
    match diagnosis.draws > 1 && diagnosis.scalars.iter().all(is_fixed) {
        true => "every draw is the same animation: nothing in this world is uncertain (`plaus check` says more)\n",
        false => "",
    }
}

/// How many independent solutions there are, and how many come in a minute, over `seconds` if given.
pub(crate) fn independent(diagnosis: &Diagnosis, seconds: Option<f64>) -> String {
    let Some(found) = &diagnosis.independent else { return String::new() };
    let minute = seconds.filter(|&seconds| seconds > 0.0).map(|seconds| 60.0 * found.ess / seconds);
    let pace = minute.map(|minute| format!(", {} a minute", amount(minute))).unwrap_or_default();
    let ess = amount(found.ess);
    match &found.scalar {
        Some(worst) => {
            format!("{ess} independent solutions{pace} (by {worst}, which mixes worst: `plaus explain independent`)\n")
        }
        None => format!("{ess} independent solutions{pace} (each drawn by itself: `plaus explain independent`)\n"),
    }
}

/// The findings, the worst of each kind first. Of a kind with many, the worst three.
pub(crate) fn findings(all: &[Finding]) -> String {
    let mut rest: Vec<&Finding> = all.iter().collect();
    rest.sort_by(|a, b| b.severity().total_cmp(&a.severity()));
    let mut text = String::new();
    while let Some(first) = rest.first() {
        let kind = discriminant(*first);
        let (same, others): (Vec<_>, Vec<_>) = rest.iter().partition(|finding| discriminant(**finding) == kind);
        let shown = if same.len() > MOST_OF_A_KIND + 1 { MOST_OF_A_KIND } else { same.len() };
        text.extend(same[..shown].iter().map(|finding| format!("  {finding}\n")));
        if let more @ 1.. = same.len() - shown {
            text += &format!("  and {} more of this kind (all: --json)\n", grouped(more as u64));
        }
        rest = others;
    }
    text
}

/// How the exact draws compare with the chains: a finding, if there is one, and otherwise a note.
pub(crate) fn beside(beside: &Beside) -> (String, String) {
    let (kept, draws) = (grouped(beside.kept), grouped(beside.draws));
    let Some(missed) = &beside.missed else {
        return (
            String::new(),
            match beside.says_something() {
                true => {
                    format!(
                        "the chains reached every region that {kept} exact draws lie in ({draws} draws from the prior \
                         were made)\n"
                    )
                }
                false => format!(
                    "of {draws} draws from the prior, {kept} count as exact draws: too few to tell whether all chains \
                     missed something\n"
                ),
            },
        );
    };
    let range = match missed.between {
        [Some(low), Some(high)] => format!("between {} and {}", short(low), short(high)),
        [Some(low), None] => format!("above {}", short(low)),
        [None, Some(high)] => format!("up to {}", short(high)),
        [None, None] => "anywhere".to_owned(),
    };
    let finding = format!(
        "  {}: {} of {kept} exact draws ({draws} draws from the prior were made) lie {range}; the chains spent only {} \
         of the time there: they missed something\n",
        missed.scalar,
        percent(missed.kept),
        percent(missed.chains),
    );
    (finding, String::new())
}

/// Restarts of tempered chains and the quality of their ladder, over `seconds` if given. Empty for chains that are not
/// tempered.
pub(crate) fn tempering(manifest: &Manifest, diagnosis: &Diagnosis, seconds: Option<f64>) -> String {
    let all: Vec<_> = diagnosis.tally.chains.iter().filter_map(|chain| chain.tempering.as_ref()).collect();
    if all.is_empty() {
        return String::new();
    }
    let restarts: u64 = all.iter().map(|one| one.restarts).sum();
    let trips: u64 = all.iter().map(|one| one.round_trips).sum();
    let shares = || all.iter().flat_map(|one| one.rejected.iter().copied());
    let (low, high) = (shares().fold(1.0, f64::min), shares().fold(0.0, f64::max));
    let barrier = all.iter().map(|one| one.barrier).sum::<f64>() / all.len() as f64;
    let minute = seconds.filter(|&seconds| seconds > 0.0);
    let pace =
        minute.map(|seconds| format!(", {} a minute", short(60.0 * restarts as f64 / seconds))).unwrap_or_default();
    let sizes = || all.iter().map(|one| one.betas.len());
    let (fewest, most) = (sizes().min().unwrap_or(0), sizes().max().unwrap_or(0));
    let rungs = if fewest == most { most.to_string() } else { format!("{fewest} to {most}") };
    let best = Ladder::best_rungs(barrier);
    let advice = if restarts == 0 && diagnosis.iterations > 0 {
        format!("; it did not pay: without it, {most} times as many chains cost the same")
    } else if fewest < best && !manifest.plan.adapt_rungs {
        format!("; about {best} rungs would serve better (`--set adapt_rungs=true` lets the warm-up choose)")
    } else {
        String::new()
    };
    format!(
        "tempering: {} restarts from fresh draws{pace}, {} round trips; barrier {} over {rungs} rungs, {} to {} of the \
         swaps rejected{advice}\n",
        grouped(restarts),
        grouped(trips),
        short(barrier),
        percent(low),
        percent(high),
    )
}

/// Failures as JSON: how many of how many draws, and each kind with its first.
pub(crate) fn failures_to_json(failures: &Failures) -> Value {
    let kind = |kind: &FailureKind| {
        let FailureKind { count, first, .. } = kind;
        json!({
            "count": count,
            "body": first.body,
            "cause": first.cause,
            "first": first.to_string(),
            "time_s": first.time,
        })
    };
    let kinds: Vec<Value> = failures.kinds().into_iter().map(kind).collect();
    json!({ "simulated": failures.simulated, "failed": failures.failed(), "kinds": kinds })
}

/// The diagnosis as JSON.
#[must_use]
pub fn to_json(manifest: &Manifest, diagnosis: &Diagnosis) -> Value {
    let tally = &diagnosis.tally;
    let chain = |tally: &plaus_run::tally::ChainTally| {
        json!({
            "chain": tally.chain,
            "hits": tally.hits.count,
            "first_hit": tally.hits.first,
            "satisfying_draws": tally.satisfying_draws,
            "distinct": tally.distinct,
            "acceptance": acceptance(&manifest.moves, &tally.counts),
            "failed": tally.failures.failed(),
            "tempering": tally.tempering,
            "scales": tally.scales,
            "learnt_in": tally.learnt_in,
            "weights": tally.weights,
        })
    };
    json!({
        "scene": manifest.scene,
        "seed": manifest.plan.seed,
        "exact_acceptance": manifest.exact,
        "scenario_hash": manifest.scenario.hash,
        "way": manifest.way,
        "failures": failures_to_json(&tally.failures),
        "iterations": diagnosis.iterations,
        "recorded_draws": diagnosis.recorded,
        "draws": diagnosis.draws,
        "stride": diagnosis.stride,
        "scalars": diagnosis.scalars,
        "independent": diagnosis.independent,
        "first_hit": tally.first_hit(),
        "distinct": tally.distinct,
        "distinct_while_adapting": tally.while_adapting,
        "best_sample": tally.best().map(|sample| sample.to_string()),
        "acceptance": acceptance(&manifest.moves, &tally.counts),
        "moves": manifest.moves.iter().zip(&tally.counts).map(|(name, count)| (name.clone(), json!(count))).collect::<Value>(),
        "chains": tally.chains.iter().map(chain).collect::<Vec<_>>(),
        "findings": diagnosis.findings,
        "healthy": diagnosis.is_healthy(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run that mixes badly has a finding or two for each of its variables: the worst of each kind say enough.
    #[test]
    fn findings_of_a_kind_are_cut_short() {
        let rhat = |k: u32| Finding::Rhat { scalar: format!("r{k}"), rhat: 1.1 + f64::from(k), is_independent: false };
        let ess = |k: u32| Finding::Ess { scalar: format!("e{k}"), kind: "bulk", ess: f64::from(k), needed: 400.0 };
        let all: Vec<_> = (0..40).flat_map(|k| [rhat(k), ess(k + 1)]).chain([Finding::NoSatisfyingSample]).collect();
        let text = findings(&all);
        let starts: Vec<_> = text.lines().map(|line| line.split(':').next().unwrap_or_default().trim()).collect();
        let more = "and 37 more of this kind (all";
        assert_eq!(starts, ["no sample satisfies the constraint", "e1", "e2", "e3", more, "r39", "r38", "r37", more]);
        // Four are shown whole: a line that says "one more" would save nothing.
        assert_eq!(findings(&all[..8]).lines().count(), 8);
        assert_eq!(findings(&[]), "");
    }
}
