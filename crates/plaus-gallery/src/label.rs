//! Facts about a sample that travel with its animation.

use plaus_export::Label;
use plaus_run::Manifest;
use plaus_run::replay::Replay;
use serde_json::{Map, Value, json};

/// Name and facts of a sample.
#[must_use]
pub fn of(manifest: &Manifest, replay: &Replay) -> Label {
    let facts = [
        ("plaus", json!(manifest.plaus)),
        ("scene", json!(manifest.scene)),
        ("scenario", json!(manifest.scenario.file)),
        ("scenario_hash", json!(manifest.scenario.hash)),
        ("seed", json!(manifest.plan.seed)),
    ];
    let facts = facts.into_iter().map(|(name, value)| (name.to_owned(), value)).chain(self::facts(replay));
    Label {
        name: format!("{}_{}", manifest.name(), replay.sample.to_string().replace(':', "_")),
        facts: facts.collect(),
    }
}

/// Facts about a sample alone.
#[must_use]
pub fn facts(replay: &Replay) -> Map<String, Value> {
    let scalars: Map<String, Value> = replay.scalars.iter().map(|(name, value)| (name.clone(), json!(value))).collect();
    let facts = json!({
        "sample": replay.sample.to_string(),
        "chain": replay.sample.chain,
        "draw": replay.sample.draw,
        "iteration": replay.iteration,
        "log_p": replay.log_p,
        "log_prior": replay.log_prior,
        "log_constraint": replay.log_constraint,
        "satisfied": replay.satisfied,
        "scalars": scalars,
        "duration": replay.animation.motion.duration,
    });
    let mut facts = match facts {
        Value::Object(facts) => facts,
        _ => Map::new(),
    };
    if let Some(recorded) = replay.recorded {
        facts.insert("accuracy".to_owned(), json!(recorded.accuracy.name()));
        facts.insert("recorded_log_p".to_owned(), json!(recorded.log_p));
        facts.insert("recorded_satisfied".to_owned(), json!(recorded.satisfied));
    }
    if !replay.sample.phase.is_sampling() {
        facts.insert("phase".to_owned(), json!(replay.sample.phase));
    }
    facts
}
