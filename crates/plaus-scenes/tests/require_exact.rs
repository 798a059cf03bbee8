//! What chains sample under requirements, compared with weighted draws from the prior: for each group of kinds the
//! means agree within three standard errors. A twin that ignores the requirements is caught.

use plaus_dist::{LogPotential, Purpose, Seed};
use plaus_mcmc::view::Sees;
use plaus_mcmc::{Chain, ChainError, Decision, ModelError, State, StateRefOf, Target};
use plaus_scenes::ball2d::{self, Ball2d};
use plaus_scenes::bowling::{self, Bowling};
use plaus_scenes::require::{Asked, Candidate, Judge, Mark, Require, Tally};
use plaus_scenes::spelling::{self, Spelling};
use plaus_scenes::{Motion, Rules, Scene};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Draws from the prior, and iterations of a chain, for a ball.
const ITERATIONS: u64 = 60_000;
/// Number of stretches of a chain from whose means its standard error is estimated. Each is far longer than the chain's
/// autocorrelation time.
const STRETCHES: usize = 30;

/// Small cases, one for each group of kinds. Scales are wide, so that the prior reaches what is asked for.
const CASES: &[&[&str]] = &[
    &[
        "impact = { nth = 2, when = { at_s = 0.6, within_ms = 30, scale_ms = 60 } }",
        "rests = { when = { to_s = 1.1, scale_ms = 80 } }",
    ],
    &["bounces = { at_least = 3, when = { to_s = 0.98 }, nats_each = 3 }"],
    &[
        "inside = { x_mm = [-40, 60], how = 'always', scale_mm = 40 }",
        "passes = { x_mm = 40, z_mm = 120, within_mm = 20, scale_mm = 50 }",
    ],
    &["rests_at = { x_mm = 150, within_mm = 30, scale_mm = 60 }"],
    &["before = { first = { nth = 2 }, then = { nth = 3 }, by_ms = 240, scale_ms = 60 }"],
    &["apart = { one = { nth = 3 }, other = { nth = 2 }, at_least_ms = 220, at_most_ms = 260, scale_ms = 40 }"],
    &["beats = { every_s = 0.31, within_ms = 20, scale_ms = 50, each = 'impact' }"],
    &["speed = { nth = 3, at_least = 2.2, scale = 0.15 }", "impulse = { nth = 2, at_most = 1.2, scale = 0.3 }"],
    &["air_time = { at_least_s = 1.2, scale_ms = 80 }", "path_length = { at_most_mm = 1100, scale_mm = 80 }"],
    &[
        "any = [{ rests_at = { x_mm = 150, within_mm = 30, scale_mm = 60 } }, { rests_at = { x_mm = -100, within_mm = 30, scale_mm = 40 } }]",
    ],
    &["named = { name = 'to the left', that = { rests_at = { x_mm = -100, within_mm = 30, scale_mm = 40 } } }"],
    &[
        "not = { inside = { x_mm = [0, 80], scale_mm = 30 } }",
        "at_least = { count = 1, of = [{ rests = { when = { to_s = 1.0, scale_ms = 60 } } }, \
         { impact = { nth = 3, when = { from_s = 0.9, scale_ms = 60 } } }] }",
    ],
];

fn ball() -> Ball2d {
    let config = ball2d::Config { collisions: 3, sigma_d: 2.0, tolerance: 2.0, ..ball2d::Config::default() };
    Ball2d::new(&config).unwrap()
}

/// Two pins, either of which the ball may miss.
fn pins() -> Bowling {
    let (pins, constrained) = (vec![7, 10], Some(false));
    Bowling::new(&bowling::Config { pins, leave: vec![7], constrained, ..bowling::Config::default() }).unwrap()
}

/// A box of 15 bins.
fn bins() -> Spelling {
    let (bitmap, balls, constrained) = ("##".to_owned(), 9, Some(false));
    Spelling::new(&spelling::Config { bitmap, balls, constrained, ..spelling::Config::default() }).unwrap()
}

/// The numbers that are compared: the first three of the scene (of a ball, where it comes to rest and two angles), and
/// whether everything that `asked` requires is met.
fn looked_at<S: Scene>(asked: &Asked<S>, state: StateRefOf<'_, Asked<S>>) -> [f64; 4] {
    let mut values = vec![0.0; asked.scene().scalars().len()];
    asked.scene().write_scalars(<Asked<S> as Sees<S>>::state(state), &mut values);
    let marks = match state.outcome.marks() {
        [] => asked.judge(&asked.motion(state.draw).unwrap(), &[]),
        marks => marks.to_vec(),
    };
    [values[0], values[1], values[2], f64::from(u8::from(marks.iter().all(Mark::met)))]
}

/// Means with standard errors, from `draws` of the prior weighted by their constraint.
fn weighed<S: Scene>(scene: &Asked<S>, draws: u64) -> [[f64; 2]; 4] {
    let mut seen: Vec<(f64, [f64; 4])> = Vec::new();
    let mut scratch = Default::default();
    for nth in 0..draws {
        let draw = scene.start(&mut Seed(3).chain(9).at(nth, Purpose::START));
        let state = State::evaluate(scene, draw, &mut scratch).unwrap();
        if !state.log_constraint.is_zero() {
            seen.push((state.log_constraint.value().exp(), looked_at(scene, state.by_ref())));
        }
    }
    let whole: f64 = seen.iter().map(|(weight, _)| weight).sum();
    std::array::from_fn(|k| {
        let mean = seen.iter().map(|(weight, values)| weight * values[k]).sum::<f64>() / whole;
        let squares: f64 = seen.iter().map(|(weight, values)| (weight * (values[k] - mean)).powi(2)).sum();
        [mean, squares.sqrt() / whole]
    })
}

/// The same from a chain of `scene`, whose states are judged as `asked` does.
fn sampled<S: Scene>(scene: &Asked<S>, asked: &Asked<S>, iterations: u64) -> [[f64; 2]; 4] {
    let moves = scene.moves(&Rules::default()).unwrap();
    let mut chain = Chain::start(scene, &moves, Seed(4).chain(0)).unwrap();
    for _ in 0..iterations / 30 {
        chain.step().unwrap();
    }
    let mut stretches = vec![[0.0; 4]; STRETCHES];
    let each = iterations / STRETCHES as u64;
    let mut values = looked_at(asked, chain.state().by_ref());
    for stretch in &mut stretches {
        for _ in 0..each {
            if chain.step().unwrap().decision == Decision::Accepted {
                values = looked_at(asked, chain.state().by_ref());
            }
            (0..4).for_each(|k| stretch[k] += values[k] / each as f64);
        }
    }
    std::array::from_fn(|k| {
        let n = STRETCHES as f64;
        let mean = stretches.iter().map(|stretch| stretch[k]).sum::<f64>() / n;
        let squares: f64 = stretches.iter().map(|stretch| (stretch[k] - mean).powi(2)).sum();
        [mean, (squares / (n - 1.0) / n).sqrt()]
    })
}

fn requirements(texts: &[&str]) -> Vec<Require> {
    texts.iter().map(|text| toml::from_str(text).unwrap()).collect()
}

fn asked(texts: &[&str]) -> Asked<Ball2d> {
    Asked::new(ball(), &requirements(texts)).unwrap()
}

/// The largest difference between the two, in standard errors.
fn apart(one: [[f64; 2]; 4], other: [[f64; 2]; 4]) -> f64 {
    let each = one.iter().zip(other).map(|([a, error], [b, besides])| (a - b).abs() / error.hypot(besides).max(1e-12));
    each.fold(0.0, f64::max)
}

/// How far a chain is from weighted draws of the prior, and how far one half as long is that ignores the
/// requirements, in standard errors.
pub(crate) fn compared<S: Scene>(scene: impl Fn() -> S, texts: &[&str], number: u64) -> [f64; 2] {
    let (full, free) = (Asked::new(scene(), &requirements(texts)).unwrap(), Asked::new(scene(), &[]).unwrap());
    let truth = weighed(&full, number);
    [sampled(&full, &full, number), sampled(&free, &full, number / 2)].map(|found| apart(truth, found))
}

#[test]
fn chains_sample_what_is_required() {
    for texts in CASES {
        let [z, ignorant] = compared(ball, texts, ITERATIONS);
        assert!(z < 3.0, "{texts:?}: {z} standard errors");
        assert!(ignorant > 3.0, "{texts:?}: only {ignorant} standard errors");
    }
}

/// The same for pins and for bins.
#[test]
fn chains_sample_what_is_required_of_pins_and_bins() {
    for (name, [z, ignorant]) in [
        ("leaves", compared(pins, &["leaves = { pins = [7], nats_each = 1.2 }"], 3_000)),
        ("spells", compared(bins, &["spells = { bitmap = '#.#', nats_each = 1.2 }"], 12_000)),
    ] {
        println!("{name}: {z} {ignorant}");
        assert!(z < 3.0, "{name}: {z} standard errors");
        assert!(ignorant > 3.0, "{name}: only {ignorant} standard errors");
    }
}

/// For draws from the prior: how many meet each requirement, and which requirements are never met together.
#[test]
fn a_tally_tells_which_requirements_are_met_and_which_never_together() {
    let early = "impact = { nth = 2, when = { to_s = 0.6 } }";
    let late = "named = { name = 'late', that = { not = { impact = { nth = 2, when = { to_s = 0.7 } } } } }";
    let never = "bounces = { at_least = 4 }";
    let scene = asked(&[early, late, never]);
    let tally = Tally::of_prior(&scene, 1, 2000, |_| true).unwrap();
    let [_, early, late, never] = tally.clauses.as_slice() else { panic!("{tally:?}") };
    assert_eq!((tally.states, tally.all), (2000, 0));
    assert!(early.met > 0 && late.met > 0 && early.met + late.met <= 2000, "{tally:?}");
    // A ball makes three bounces: half a bounce less than required, at two nats per bounce.
    assert_eq!((never.met, never.best), (0, -1.0));
    assert_eq!(tally.never_together(), [["require[0].impact", "late"]]);
}

/// Prefers balls that come to rest more than one diameter to the right, by a factor e². Counts how often it is asked.
#[derive(Debug, Default)]
struct Beyond {
    most: Option<f64>,
    wants_motion: bool,
    /// The wrong twin's answer depends on how often it was asked.
    is_fickle: bool,
    asked: AtomicU64,
}

impl Judge<Ball2d> for Beyond {
    fn most(&self) -> Option<LogPotential> {
        self.most.map(|most| LogPotential::new(most).unwrap())
    }

    fn wants_motion(&self) -> bool {
        self.wants_motion
    }

    fn judge(&self, state: Candidate<'_, Ball2d>, motion: Option<Motion>) -> Result<Mark, ModelError> {
        let asked = self.asked.fetch_add(1, Relaxed);
        assert_eq!(motion.is_some(), self.wants_motion);
        let mut values = vec![0.0; ball().scalars().len()];
        ball().write_scalars(<Asked<Ball2d> as Sees<Ball2d>>::state(state), &mut values);
        let is_beyond = values[0] > 1.0;
        let log = if self.is_fickle { 2.0 * (asked % 2) as f64 } else { 2.0 * f64::from(u8::from(is_beyond)) };
        Ok(Mark { margin: if is_beyond { 0.0 } else { -1.0 }, log })
    }
}

fn judged(texts: &[&str], judge: Beyond) -> (Asked<Ball2d>, Arc<Beyond>) {
    let judge = Arc::new(judge);
    (asked(texts).judged_by(Arc::clone(&judge) as _), judge)
}

#[test]
fn chains_sample_what_a_judge_requires_further() {
    for texts in [CASES[3], &[]] {
        let (scene, _) = judged(texts, Beyond { most: Some(2.0), ..Beyond::default() });
        let truth = weighed(&scene, ITERATIONS);
        let z = apart(truth, sampled(&scene, &scene, ITERATIONS));
        assert!(z < 3.0, "{texts:?}: {z} standard errors");
        let (fickle, _) = judged(texts, Beyond { is_fickle: true, ..Beyond::default() });
        let z = apart(truth, sampled(&fickle, &scene, ITERATIONS));
        assert!(z > 3.0, "{texts:?}: only {z} standard errors");
    }
}

/// Rest places of a chain and whether all is met, and how often the judge was asked.
fn walked(texts: &[&str], judge: Beyond) -> Result<(Vec<[f64; 4]>, u64), ChainError> {
    let (scene, judge) = judged(texts, judge);
    let moves = scene.moves(&Rules::default()).unwrap();
    let mut chain = Chain::start(&scene, &moves, Seed(4).chain(0))?;
    let mut seen = Vec::new();
    for _ in 0..3000 {
        chain.step()?;
        seen.push(looked_at(&scene, chain.state().by_ref()));
    }
    Ok((seen, judge.asked.load(Relaxed)))
}

#[test]
fn a_stated_bound_only_makes_a_judge_be_asked_less_often() {
    for texts in [CASES[3], &[]] {
        let (plain, often) = walked(texts, Beyond::default()).unwrap();
        for wants_motion in [false, true] {
            let (saving, seldom) =
                walked(texts, Beyond { most: Some(2.0), wants_motion, ..Beyond::default() }).unwrap();
            let differ = plain.iter().zip(&saving).position(|(one, other)| one != other);
            assert_eq!(differ, None, "{:?}", differ.map(|at| (plain[at], saving[at])));
            assert!(seldom < often, "{seldom} calls, {often} without a bound");
        }
        assert!(plain.iter().all(|values| values[3] == 0.0 || values[0] > 1.0));
        assert!(plain.iter().any(|values| values[3] == 1.0));
    }
}

#[test]
fn a_judgement_above_the_stated_bound_is_an_error() {
    let error = walked(&[], Beyond { most: Some(1.5), ..Beyond::default() }).unwrap_err().to_string();
    assert!(error.contains("log potential of 2 exceeds its stated bound, 1.5"), "{error}");
}
