//! The chance that a scenario's requirements are met, in words and as JSON.

use crate::table::{grouped, lay_out, short};
use plaus_mcmc::chance::{Disagreement, Doubt, Estimate, Method, Verdict};
use plaus_run::chance::{Chance, answers};
use serde_json::{Value, json};

/// What `plaus chance --json` prints.
#[must_use]
pub fn to_json(chance: &Chance) -> Value {
    let (done, due) = chance.done();
    json!({
        "scene": chance.scene,
        "scenario": chance.scenario.file,
        "scenario_hash": chance.scenario.hash,
        "asking": chance.asking,
        "methods": chance.methods,
        "why": chance.why,
        "batches_done": done,
        "batches_due": due,
        "answers": answers(chance),
    })
}

/// A probability, or its error: small ones with three digits too.
fn probability(number: f64) -> String {
    match number {
        small if (1e-4..1e-3).contains(&small) => format!("{small:.6}"),
        small if (1e-3..1e-2).contains(&small) => format!("{small:.5}"),
        other => short(other),
    }
}

fn name(method: Method) -> &'static str {
    match method {
        Method::Counting => "counting",
        Method::Splitting => "splitting",
        Method::Stones => "stones",
        Method::Importance => "importance",
    }
}

/// What `plaus chance` prints.
#[must_use]
pub fn in_words(chance: &Chance) -> String {
    let answers = answers(chance);
    let Some((all, parts)) = answers.split_first() else { return String::new() };
    let mut text = format!("{} ({}): how likely is what is asked for?\n", chance.scene, chance.scenario.file);
    text += &format!("{}\n\n", chance.why);
    let mut rows = vec![["method", "probability", "error", "from", "to", "simulations"].map(str::to_owned).to_vec()];
    rows.extend(all.verdict.estimates.iter().map(|one| row(format!("  {}", name(one.method)), one)));
    text += &lay_out(&rows);
    text += &conclusion(&all.verdict);
    if !parts.is_empty() {
        let mut rows = vec![["part", "probability", "error", "from", "to", "by"].map(str::to_owned).to_vec()];
        for part in parts {
            let Some(best) = &part.verdict.best else { continue };
            let mut cells = row(format!("  {}", part.name), best);
            cells.pop();
            let doubt = if part.verdict.is_settled() { "" } else { ", not settled" };
            cells.push(format!("{}{doubt}", name(best.method)));
            rows.push(cells);
        }
        text += &format!("\n{}", lay_out(&rows));
    }
    text
}

fn row(name: String, one: &Estimate) -> Vec<String> {
    let [from, to] = one.interval;
    let numbers = [one.probability, one.error, from, to].map(probability);
    std::iter::once(name).chain(numbers).chain([grouped(one.simulations)]).collect()
}

/// The answer in a sentence, and what speaks against it.
fn conclusion(all: &Verdict) -> String {
    if all.estimates.is_empty() {
        return "\nno batch is finished yet: it needs more time\n".to_owned();
    }
    let Some(best) = all.best.filter(|best| best.probability > 0.0) else {
        let most = all.estimates.first().map(|one| one.interval[1]);
        let most = most.map(|most| format!(": less often than {}, by counting", probability(most))).unwrap_or_default();
        return format!("\nnothing met it{most}\n");
    };
    let once =
        if best.probability < 0.5 { format!(", once in {}", often(1.0 / best.probability)) } else { String::new() };
    if all.is_settled() {
        let agreed = if all.agrees() { "; the methods agree" } else { "" };
        let [low, high] = all.interval.map(probability);
        return format!("\n{}{once}; 95 % interval {low} to {high}{agreed}\n", probability(best.probability));
    }
    let mut text = format!(
        "\nat least about {}; it cannot tell how much more (largest estimate {}{once})\n",
        probability(best.interval[0]),
        probability(best.probability)
    );
    all.doubts.iter().for_each(|doubt| text += &format!("  {}\n", reason(doubt)));
    text + "  more --batches may settle it\n"
}

/// A reason not to trust the answer.
fn reason(doubt: &Doubt) -> String {
    match *doubt {
        Doubt::Disagreement(Disagreement { less, more, factor }) => {
            let (less, more) = (name(less), name(more));
            let found = factor.map_or(format!("something where {less} finds nothing"), |factor| {
                format!("{} times as much as {less}", short(factor))
            });
            format!(
                "the methods disagree: {more} finds {found}; {less} missed a way to the goal, or searched too little"
            )
        }
        Doubt::FewBatches { method, effective, of } => {
            format!("what {} found rests on {} of its {of} batches", name(method), short(effective))
        }
        Doubt::FewHits { effective } => {
            format!("what importance sampling found rests on {} hits of equal weight", short(effective))
        }
        Doubt::FewAncestors { ancestors } => {
            format!("the particles that reached the goal descend from {} in the mean: too few", short(ancestors))
        }
    }
}

/// A large number that is known only roughly.
fn often(times: f64) -> String {
    if times < 1e6 { grouped(times.round() as u64) } else { format!("{times:.1e}") }
}
