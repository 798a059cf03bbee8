//! Golden traces: short chains, iteration by iteration, bit for bit. They hold on every machine, compiler and
//! optimisation level. A mismatch means that runs of earlier versions no longer have the same bits.
//! `cargo xtask golden --bless` writes them anew.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "golden/simulator.rs"]
pub(crate) mod simulator;

use plaus_dist::Seed;
use plaus_mcmc::{Chain, Decision, Goal};
use plaus_run::codec::{Kind, decode, encode};
use plaus_scenes::{AnyScene, Rules, Scenario, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const TRACE: Kind = Kind::new(*b"gold", 1, "a golden trace");

/// Name of the trace, scenario, overrides, iterations.
type Case = (&'static str, &'static str, &'static [&'static str], u64);

const CASES: &[Case] = &[
    ("ball2d", "ball2d.toml", &[], 400),
    ("ball2d-paper", "ball2d.toml", &["world.ball2d.moves=paper"], 400),
    ("ball2d-as-printed", "ball2d.toml", &["sampler.rules.preset=as-printed"], 400),
    ("ball2d-64-bounces", "ball2d.toml", &["world.ball2d.collisions=64", "world.ball2d.downward=mirror"], 100),
    ("bowling-strike", "bowling-strike.toml", &[], 12),
    ("bowling-paper", "bowling-leave-6-7.toml", &["moves=paper", "preset=as-printed"], 12),
    ("bowling-spare", "bowling-spare-6-7.toml", &[], 12),
    ("bowling-regulation", "bowling-spare-7-10.toml", &[], 12),
    ("bowling-regulation-paper", "bowling-spare-7-10-paper.toml", &[], 12),
    ("spelling-hi", "spelling-hi.toml", &[], 300),
    ("spelling-hi-paper", "spelling-hi.toml", &["world.spelling.moves=paper"], 300),
    (
        "spelling-hi-as-printed",
        "spelling-hi.toml",
        &["world.spelling.moves=paper", "sampler.rules.preset=as-printed"],
        300,
    ),
    ("spelling-acm", "spelling-acm.toml", &[], 100),
    (
        "spelling-queue",
        "spelling-hi.toml",
        &["text=A7", "ln_lambda=5", "order=queue", "vertices=interior", "count=balls", "accuracy=fine"],
        60,
    ),
    ("dice-one", "dice-one.toml", &[], 100),
    ("dice-one-paper", "dice-one.toml", &["moves=paper", "preset=as-printed"], 60),
    ("dice-one-spilt", "dice-one.toml", &["spilt.radius_mm=60", "edge_x_mm=10", "rounding_mm=0", "accuracy=fine"], 40),
    ("dice-six", "dice-six.toml", &[], 60),
    ("dice-six-together", "dice-six-together.toml", &[], 12),
];

/// The result of one iteration.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Row {
    move_id: u16,
    decision: Decision,
    log_prior: f64,
    log_constraint: f64,
    class: Option<u64>,
    scalars: Vec<f64>,
}

/// The start, every iteration, and the last state's animation.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Trace {
    scalars: Vec<String>,
    rows: Vec<Row>,
    /// Time, body and place of every impact.
    impacts: Vec<(f64, String, [f64; 3])>,
    /// Every body's place at 32 times over the animation.
    places: Vec<[f64; 3]>,
}

pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

struct Record {
    rules: Rules,
    seed: u64,
    iterations: u64,
}

impl Record {
    fn of(&self, scene: &AnyScene) -> Trace {
        let moves = scene.moves(&self.rules).unwrap();
        let mut chain = Chain::start(scene, &moves, Seed(self.seed).chain(0)).unwrap();
        let names: Vec<String> = scene.scalars().into_iter().map(|scalar| scalar.name).collect();
        let row = |chain: &Chain<'_, AnyScene>, move_id, decision| {
            let state = chain.state();
            let mut scalars = vec![0.0; names.len()];
            scene.write_scalars(state.by_ref(), &mut scalars);
            let class = scene.class(state.by_ref()).map(|class| class.0);
            let (log_prior, log_constraint) = (state.log_prior.value(), state.log_constraint.value());
            Row { move_id, decision, log_prior, log_constraint, class, scalars }
        };
        let mut rows = vec![row(&chain, u16::MAX, Decision::Accepted)];
        for _ in 0..self.iterations {
            let step = chain.step().unwrap();
            rows.push(row(&chain, step.move_id.0, step.decision));
        }
        let animation = scene.animate(&chain.state().draw).unwrap();
        let impacts =
            animation.motion.impacts.iter().map(|impact| (impact.time, impact.body.clone(), impact.point.to_array()));
        let times = (0..32).map(|k| animation.motion.duration * f64::from(k) / 31.0);
        let places = times.flat_map(|t| animation.motion.tracks.iter().map(move |track| track.position(t).to_array()));
        Trace { impacts: impacts.collect(), places: places.collect(), rows, scalars: names }
    }
}

fn record(&(_, file, overrides, iterations): &Case) -> Trace {
    let path = root().join("scenarios").join(file);
    let text = std::fs::read_to_string(&path).unwrap();
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let scenario = Scenario::read(file, &text, &overrides).unwrap();
    let record = Record { rules: scenario.sampler.rules, seed: scenario.sampler.seed, iterations };
    record.of(&scenario.world.scene().unwrap())
}

/// A named value that is compared bit by bit, and how it is shown.
type Field = (String, Vec<u8>, String);

fn number(name: impl Into<String>, value: f64) -> Field {
    (name.into(), value.to_bits().to_le_bytes().into(), format!("{value:?} ({:#018x})", value.to_bits()))
}

fn words(name: impl Into<String>, value: impl std::fmt::Debug) -> Field {
    let shown = format!("{value:?}");
    (name.into(), shown.clone().into_bytes(), shown)
}

fn fields(row: &Row, names: &[String]) -> Vec<Field> {
    let Row { move_id, decision, log_prior, log_constraint, class, scalars } = row;
    let scalars = names.iter().zip(scalars).map(|(name, &value)| number(name, value));
    [words("move", move_id), words("verdict", decision)]
        .into_iter()
        .chain(scalars)
        .chain([number("log_prior", *log_prior), number("log_constraint", *log_constraint), words("class", class)])
        .collect()
}

/// Every value in a trace, in the order in which it was made, each with its place.
fn all_fields(trace: &Trace) -> Vec<(String, Field)> {
    let mut all = vec![("the start".to_owned(), words("scalars", &trace.scalars))];
    for (iteration, row) in trace.rows.iter().enumerate() {
        all.extend(fields(row, &trace.scalars).into_iter().map(|field| (format!("iteration {iteration}"), field)));
    }
    let axes = |point: &[f64; 3]| ["x", "y", "z"].into_iter().zip(*point).collect::<Vec<_>>();
    for (k, (time, body, point)) in trace.impacts.iter().enumerate() {
        let place = format!("the last state's animation, impact {k}");
        all.push((place.clone(), number("time", *time)));
        all.push((place.clone(), words("body", body)));
        all.extend(axes(point).into_iter().map(|(axis, value)| (place.clone(), number(axis, value))));
    }
    for (k, point) in trace.places.iter().enumerate() {
        let place = format!("the last state's animation, place {k}");
        all.extend(axes(point).into_iter().map(|(axis, value)| (place.clone(), number(axis, value))));
    }
    all
}

/// The first difference, in words.
fn difference(stored: &Trace, fresh: &Trace) -> Option<String> {
    let (stored, fresh) = (all_fields(stored), all_fields(fresh));
    for ((place, (name, bytes, shown)), (now_place, (now_name, now_bytes, now))) in stored.iter().zip(&fresh) {
        if place != now_place || name != now_name {
            return Some(format!("{place}, {name}: now there is {now_place}, {now_name} instead"));
        }
        if bytes != now_bytes {
            return Some(format!("{place}, {name}: stored {shown}, now {now}"));
        }
    }
    (stored.len() != fresh.len()).then(|| format!("{} values are stored, now there are {}", stored.len(), fresh.len()))
}

fn file(name: &str) -> PathBuf {
    root().join("tests/golden").join(format!("{name}.trace"))
}

#[test]
fn golden_traces_have_the_same_bits() {
    compare();
}

/// Compares every trace with a fresh run, or writes it anew.
pub(crate) fn compare() {
    let bless = std::env::var_os("PLAUS_BLESS").is_some_and(|set| !set.is_empty());
    let mut wrong = Vec::new();
    // Each trace on a thread of its own, all at once.
    let fresh: Vec<Trace> = std::thread::scope(|scope| {
        let all: Vec<_> = CASES.iter().map(|case| scope.spawn(|| record(case))).collect();
        all.into_iter().map(|one| one.join().unwrap()).collect()
    });
    for (case, fresh) in CASES.iter().zip(fresh) {
        let path = file(case.0);
        if bless {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, encode(TRACE, &fresh).unwrap()).unwrap();
            continue;
        }
        let stored = std::fs::read(&path).map_err(|error| error.to_string());
        let stored = stored.and_then(|bytes| decode::<Trace>(TRACE, &bytes).map_err(|error| error.to_string()));
        let found = match stored {
            Ok(stored) => difference(&stored, &fresh),
            Err(error) => Some(error),
        };
        wrong.extend(found.map(|what| format!("tests/golden/{}.trace: {what}", case.0)));
    }
    assert!(
        wrong.is_empty(),
        "{}\n\nThe same scenario and seed no longer give the same bits. Where that is meant: cargo xtask golden --bless",
        wrong.join("\n")
    );
}

#[test]
fn every_scenario_has_a_golden_trace_and_every_trace_a_case() {
    let names = |folder: &str, ending: &str| -> BTreeSet<String> {
        let files = std::fs::read_dir(root().join(folder)).unwrap();
        let files = files.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        files.filter_map(|name| name.strip_suffix(ending).map(str::to_owned)).collect()
    };
    let covered: BTreeSet<String> = CASES.iter().map(|case| case.1.trim_end_matches(".toml").to_owned()).collect();
    assert_eq!(names("scenarios", ".toml"), covered, "scenarios, and those with a golden trace");
    let cases: BTreeSet<String> = CASES.iter().map(|case| case.0.to_owned()).collect();
    assert_eq!(names("tests/golden", ".trace"), cases, "stored traces, and those that a case makes");
}

#[test]
fn a_difference_is_named_by_iteration_and_field() {
    let case = &CASES[0];
    let stored = record(case);
    let mut fresh = stored.clone();
    assert_eq!(difference(&stored, &fresh), None);
    let value = &mut fresh.rows[17].scalars[1];
    *value = f64::from_bits(value.to_bits() ^ 1);
    let said = difference(&stored, &fresh).unwrap();
    assert!(said.starts_with(&format!("iteration 17, {}: stored ", stored.scalars[1])), "{said}");
    fresh = stored.clone();
    fresh.places.pop();
    assert!(difference(&stored, &fresh).is_some());
}
