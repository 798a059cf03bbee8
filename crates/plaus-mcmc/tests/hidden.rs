//! Chances of goals with two ways, one of which hides behind the other: the constraint leads most particles to the way
//! that is less likely. In 20 seeds of each case the interval covers the truth, or the verdict says that it cannot
//! tell.

use plaus_dist::{Gaussian, LogDensity, LogPotential, Seed, Stream, math};
use plaus_mcmc::chance::{
    Batches, ChancePulse, Method, Parts, Splitting, Stones, Verdict, count, importance, split, stones,
};
use plaus_mcmc::library::{RedrawOne, Sizes, Step, StepAll};
use plaus_mcmc::{
    Goal, Law, Mixture, ModelError, Recipe, Simulated, SolutionClass, StateRefOf, Target, Var, Variables, Vars, vars,
};
use statrs::distribution::{ContinuousCDF, Normal};
use std::sync::Arc;

/// Independent standard normal numbers under a constraint, which is 0 where the goal is reached.
struct Numbers {
    vars: Vars,
    constraint: fn(&[f64]) -> f64,
}

impl Numbers {
    fn new(count: usize, constraint: fn(&[f64]) -> f64) -> Self {
        let law = || Law::Gaussian(Gaussian::new(0.0, 1.0).unwrap());
        let all = (0..count).map(|k| Var::new(format!("z{k}"), "", law())).collect();
        Self { vars: Vars::new(all), constraint }
    }
}

impl Target for Numbers {
    type Draw = Vec<f64>;
    type Outcome = f64;
    type Scratch = ();
    fn start(&self, stream: &mut Stream) -> Vec<f64> {
        let mut draw = vec![0.0; self.vars.len()];
        self.renew_all(&mut draw, Recipe::Exact, stream);
        draw
    }
    fn log_prior(&self, draw: &Vec<f64>) -> Result<LogDensity, ModelError> {
        Ok(vars::log_prior(self, draw)?)
    }
    fn simulate(
        &self,
        draw: &Vec<f64>,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<f64>, ModelError> {
        Ok(Simulated::Complete((self.constraint)(draw).min(0.0)))
    }
    fn log_constraint(&self, outcome: &f64) -> Result<LogPotential, ModelError> {
        Ok(LogPotential::new(*outcome)?)
    }
}

impl Goal for Numbers {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        (*state.outcome >= 0.0).then(|| SolutionClass::of([0]))
    }
}

impl Variables for Numbers {
    fn vars(&self) -> &Vars {
        &self.vars
    }
    fn get<'a>(&self, draw: &'a Vec<f64>, var: usize) -> Option<&'a [f64]> {
        draw.get(var..=var)
    }
    fn get_mut<'a>(&self, draw: &'a mut Vec<f64>, var: usize) -> Option<&'a mut [f64]> {
        draw.get_mut(var..=var)
    }
}

fn tail(x: f64) -> f64 {
    Normal::new(0.0, 1.0).unwrap().sf(x)
}

/// Two metaballs in a plane; the taller one stands before the way that is more likely (K. Breitung, "The geometry of
/// limit state function graphs and subset simulation", Reliability Engineering & System Safety 182, 2019).
fn metaballs(z: &[f64]) -> f64 {
    let p = 4.0 * math::square(z[0] + 2.0) / 9.0 + z[1] * z[1] / 25.0;
    let q = math::square(z[0] - 2.5) / 4.0 + math::square(z[1] - 0.5) / 25.0;
    -2.0 * (30.0 / (p * p + 1.0) + 20.0 / (q * q + 1.0) - 5.0)
}

/// The probability that metaballs are low, by the midpoint rule.
fn low_metaballs() -> f64 {
    const STEP: f64 = 0.01;
    let density = |x: f64| math::exp(-0.5 * x * x) / (2.0 * std::f64::consts::PI).sqrt();
    let at = |k: i32| (f64::from(k) + 0.5) * STEP;
    let row = |i: i32| {
        let inside = (-800..800).filter(|&j| metaballs(&[at(i), at(j)]) >= 0.0);
        density(at(i)) * inside.map(|j| density(at(j))).sum::<f64>()
    };
    (-800..800).map(row).sum::<f64>() * STEP * STEP
}

/// A tail of slope `gentle` from `far`, and another of slope `steep` from `near`.
fn two_tails([x, y]: [f64; 2], [far, gentle]: [f64; 2], [near, steep]: [f64; 2]) -> f64 {
    (gentle * (x - far)).max(steep * (y - near))
}

fn spot(z: f64, middle: f64, half: f64, scale: f64) -> f64 {
    (half - (z - middle).abs()) / scale
}

/// Name, target, and its probability.
fn cases() -> Vec<(&'static str, Numbers, f64)> {
    let either = |a: f64, b: f64| a + b - a * b;
    let within = |middle: f64, half: f64| tail(middle - half) - tail(middle + half);
    vec![
        ("metaballs", Numbers::new(2, metaballs), low_metaballs()),
        (
            "spot of 9e-4",
            Numbers::new(1, |z| (300.0 * (z[0] - 3.65) / 5.0).max(spot(300.0 * z[0], -450.0, 1.0, 0.01))),
            tail(3.65) + within(-1.5, 1.0 / 300.0),
        ),
        (
            "spot of 1e-4",
            Numbers::new(1, |z| (300.0 * (z[0] - 4.2) / 5.0).max(spot(300.0 * z[0], -450.0, 0.12, 0.01))),
            tail(4.2) + within(-1.5, 0.12 / 300.0),
        ),
        (
            "tail of 5e-4",
            Numbers::new(2, |z| two_tails([z[0], z[1]], [3.72, 8.0], [3.29, 80.0])),
            either(tail(3.72), tail(3.29)),
        ),
        (
            "tail of 1e-5",
            Numbers::new(2, |z| two_tails([z[0], z[1]], [4.75, 10.0], [4.265, 100.0])),
            either(tail(4.75), tail(4.265)),
        ),
        (
            "tail of six numbers",
            Numbers::new(6, |z| {
                let sum = -z.iter().sum::<f64>() / 6.0_f64.sqrt();
                two_tails([z[0], sum], [5.0, 10.0], [4.0, 100.0])
            }),
            // The two are correlated by −1/√6, which makes both at once less likely than 1e-11.
            tail(5.0) + tail(4.0),
        ),
    ]
}

fn verdict(target: &Numbers, seed: u64) -> Verdict {
    let (pulse, seed) = (ChancePulse::default(), Seed(seed));
    let among: Vec<usize> = (0..target.vars.len()).collect();
    let sizes = Sizes::new(1e-3, 1.0);
    let moves = Arc::new(
        Mixture::new(vec![
            (1.0, Box::new(RedrawOne { name: "redraw", among: among.clone(), symmetric: false }) as _),
            (1.0, Box::new(Step::of("step", &among, sizes)) as _),
            (1.0, Box::new(StepAll { name: "step_all", among, sizes }) as _),
        ])
        .unwrap(),
    );
    // What `plaus chance` uses by default.
    let splitting = Splitting { particles: 100, steps: 20, least: 1e-15 };
    let plan = Stones { rungs: 10, swap_every: 2, warmup: 400, iterations: 1600 };
    Verdict::new(
        &Batches {
            counted: (0..16).map(|batch| count(target, Parts::NONE, seed, batch, 500, &pulse).unwrap()).collect(),
            split: (0..16)
                .map(|batch| split((target, &moves), Parts::NONE, seed, batch, splitting, &pulse).unwrap())
                .collect(),
            stones: (0..16).map(|batch| stones(target, &moves, seed, batch, plan, &pulse).unwrap()).collect(),
            weighted: (0..16).map(|batch| importance(target, Parts::NONE, seed, batch, 500, &pulse).unwrap()).collect(),
        },
        0,
    )
}

/// In each case, of `seeds` verdicts: how many cover the truth or cannot tell, and how many are settled.
fn judged(cases: Vec<(&'static str, Numbers, f64)>, seeds: u64) -> Vec<(&'static str, u64, u64)> {
    let judged = |(name, target, truth): (&'static str, Numbers, f64)| {
        let all: Vec<Verdict> = (1..=seeds).map(|seed| verdict(&target, seed)).collect();
        let covers = |one: &&Verdict| one.interval[0] <= truth && truth <= one.interval[1];
        let right = all.iter().filter(|one| !one.is_settled() || covers(one)).count() as u64;
        (name, right, all.iter().filter(|one| one.is_settled()).count() as u64)
    };
    cases.into_iter().map(judged).collect()
}

/// With one way to the goal.
fn plain() -> Vec<(&'static str, Numbers, f64)> {
    vec![
        ("one tail of 1e-5", Numbers::new(2, |z| 10.0 * (z[0] - 4.265)), tail(4.265)),
        ("ten numbers", Numbers::new(10, |z| 10.0 * (z.iter().sum::<f64>() / 10.0_f64.sqrt() - 4.0)), tail(4.0)),
    ]
}

/// Of 20, 18 are right if 95 % are: fewer in one case of thirteen; of 3, all but one.
#[test]
fn a_hidden_way_is_covered_or_the_verdict_cannot_tell() {
    for (name, right, _) in judged(cases(), 3) {
        assert!(right >= 2, "{name}: {right} of 3");
    }
    // A verdict that never settles would pass so far.
    for (name, right, settled) in judged(plain(), 3) {
        assert!(right >= 2 && settled >= 2, "{name}: {right} of 3, {settled} settled");
    }
}

#[test]
#[ignore = "takes minutes: 20 seeds of each case"]
fn hidden_ways_are_covered_in_twenty_seeds() {
    let found = [judged(cases(), 20), judged(plain(), 20)].concat();
    println!("case, right of 20, settled: {found:?}");
    assert!(found.iter().all(|(_, right, _)| *right >= 18), "{found:?}");
    let plain: Vec<_> = plain().iter().map(|(name, ..)| *name).collect();
    assert!(found.iter().all(|(name, _, settled)| *settled >= 16 || !plain.contains(name)), "{found:?}");
}

/// The wrong twin: the interval of a method that climbs, taken alone.
#[test]
fn chains_alone_miss_what_is_hidden() {
    let target = Numbers::new(2, |z| two_tails([z[0], z[1]], [4.75, 10.0], [4.265, 100.0]));
    let one = verdict(&target, 1);
    let stones = one.estimates.iter().find(|one| one.method == Method::Stones).unwrap();
    assert!(stones.interval[1] < tail(4.265) && !one.is_settled(), "{one:?}");
}
