//! The chance that a scenario's requirements are met, in words and as JSON.

use crate::table::{grouped, lay_out, percent, short};
use plaus_mcmc::chance::{Estimate, Method};
use plaus_run::chance::{Answer, Chance, answers};
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
    rows.extend(all.estimates.iter().map(|one| row(format!("  {}", name(one.method)), one)));
    text += &lay_out(&rows);
    text += &verdict(all);
    if !parts.is_empty() {
        let mut rows = vec![["part", "probability", "error", "from", "to", "by"].map(str::to_owned).to_vec()];
        for part in parts {
            let Some(best) = &part.best else { continue };
            let mut cells = row(format!("  {}", part.name), best);
            cells.pop();
            let doubt = if part.disagreements.is_empty() { "" } else { ", not agreed" };
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

/// The answer in a sentence.
fn verdict(all: &Answer) -> String {
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
    let mut text = if all.disagreements.is_empty() {
        let error =
            if best.error > 0.0 { percent(best.error / best.probability) } else { "an unknown error".to_owned() };
        let agreed = if all.estimates.len() > 1 { "; the methods agree" } else { "" };
        format!("\n{}{once}, give or take {error}{agreed}\n", probability(best.probability))
    } else {
        format!("\nat least about {}{once}; the methods disagree\n", probability(best.interval[0]))
    };
    for one in &all.disagreements {
        let (more, less) = (name(one.more), name(one.less));
        let factor = one.factor.map_or(format!("something where {less} finds nothing"), |factor| {
            format!("{} times as much as {less}", short(factor))
        });
        text += &format!(
            "  {more} finds {factor}: a way to the goal was missed, or the search was too short; more --batches will \
             tell\n"
        );
    }
    for &method in &all.lopsided {
        text += &format!("  more than half of what {} found comes from one batch: use more --batches\n", name(method));
    }
    text
}

/// A large number that is known only roughly.
fn often(times: f64) -> String {
    if times < 1e6 { grouped(times.round() as u64) } else { format!("{times:.1e}") }
}
