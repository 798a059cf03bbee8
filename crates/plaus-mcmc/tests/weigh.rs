//! Weights of moves, learnt in the warm-up from what moves gain for their work, and kept from then on. They are the
//! same wherever a chain was interrupted, and the target stays invariant.

use plaus_dist::{Gaussian, LogDensity, LogPotential, Seed, Stream, math};
use plaus_mcmc::diagnose::integrated_autocorrelation_time;
use plaus_mcmc::library::{RedrawAll, Sizes, StepAll};
use plaus_mcmc::{
    Chain, Law, Mixture, ModelError, Move, Recipe, Simulated, StateRefOf, Target, Var, Variables, Vars, vars,
};
use std::cell::Cell;

thread_local! {
    static WORK: Cell<u64> = const { Cell::new(0) };
}

/// Three numbers, standard normal under the prior; each should be near 2, with standard deviation 0.2. A simulation
/// costs 99, but 9 if the memory already holds the last two numbers.
struct Costly(Vars);

impl Costly {
    fn new() -> Self {
        let number =
            |name: &'static str| Var::new(name, "", Law::Gaussian(Gaussian::new(0.0, 1.0).unwrap())).column(1.0);
        Self(Vars::new(vec![number("x"), number("y"), number("z")]))
    }
}

impl Variables for Costly {
    fn vars(&self) -> &Vars {
        &self.0
    }

    fn get<'a>(&self, draw: &'a [f64; 3], var: usize) -> Option<&'a [f64]> {
        Some(std::slice::from_ref(&draw[var]))
    }

    fn get_mut<'a>(&self, draw: &'a mut [f64; 3], var: usize) -> Option<&'a mut [f64]> {
        Some(std::slice::from_mut(&mut draw[var]))
    }
}

/// What memory holds: the current state's numbers, and the candidate's.
#[derive(Default)]
struct Memory {
    current: Option<[f64; 3]>,
    candidate: Option<[f64; 3]>,
}

impl Target for Costly {
    type Draw = [f64; 3];
    type Outcome = [f64; 3];
    type Scratch = Memory;

    fn start(&self, stream: &mut Stream) -> [f64; 3] {
        let mut draw = [0.0; 3];
        self.renew_all(&mut draw, Recipe::Exact, stream);
        draw
    }

    fn log_prior(&self, draw: &[f64; 3]) -> Result<LogDensity, ModelError> {
        Ok(vars::log_prior(self, draw)?)
    }

    fn simulate(
        &self,
        draw: &[f64; 3],
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        memory: &mut Memory,
    ) -> Result<Simulated<[f64; 3]>, ModelError> {
        let is_known = memory.current.is_some_and(|known| known[1..] == draw[1..]);
        WORK.set(WORK.get() + if is_known { 9 } else { 99 });
        memory.candidate = Some(*draw);
        Ok(Simulated::Complete(*draw))
    }

    fn log_constraint(&self, numbers: &[f64; 3]) -> Result<LogPotential, ModelError> {
        Ok(LogPotential::new(-0.5 * numbers.iter().map(|x| math::square((x - 2.0) / 0.2)).sum::<f64>())?)
    }

    fn decided(&self, accepted: bool, memory: &mut Memory) {
        if accepted {
            memory.current = memory.candidate;
        }
    }

    fn work(&self) -> u64 {
        WORK.get()
    }

    fn numbers(&self, state: StateRefOf<'_, Self>) -> Vec<f64> {
        state.draw.to_vec()
    }
}

const WARMUP: u64 = 4000;
const SAMPLED: u64 = 40_000;

/// Mostly a move that is hardly ever accepted. Steps of the first number cost little, those of the others much.
fn moves() -> Mixture<Costly> {
    let step = |name, among| Box::new(StepAll { name, among, sizes: Sizes::new(1e-3, 1.0) });
    let all: [(f64, Box<dyn Move<Costly>>); 3] = [
        (0.7, Box::new(RedrawAll::exact("redraw_all"))),
        (0.2, step("step_first", vec![0])),
        (0.1, step("step_others", vec![1, 2])),
    ];
    Mixture::new(all.into()).unwrap()
}

/// Values after the warm-up, the work per value, and the moves' probabilities.
fn sampled(weighs: bool) -> ([Vec<f64>; 3], f64, Option<Vec<f64>>) {
    let (costly, moves) = (Costly::new(), moves());
    let started = Chain::start(&costly, &moves, Seed(2).chain(0)).unwrap();
    let mut chain = if weighs { started.weighing(WARMUP) } else { started.adapting(WARMUP) };
    while chain.iteration() < WARMUP {
        chain.step().unwrap();
    }
    let (mut values, begun) = ([const { Vec::new() }; 3], WORK.get());
    for _ in 0..SAMPLED {
        chain.step().unwrap();
        values.iter_mut().zip(chain.state().draw).for_each(|(all, x)| all.push(x));
    }
    let work = (WORK.get() - begun) as f64 / SAMPLED as f64;
    (values, work, chain.scales().and_then(plaus_mcmc::Scales::probabilities))
}

/// Each number is Gaussian, with mean 50/26 and variance 1/26.
#[test]
fn work_goes_where_it_gains_most_and_the_target_stays_invariant() {
    let time = |x: &[f64]| integrated_autocorrelation_time(&[x]).unwrap().unwrap().tau;
    let worst = |values: &[Vec<f64>; 3]| values.iter().map(|x| time(x)).fold(0.0, f64::max);
    let ((plain, cost, none), (weighed, work, learnt)) = (sampled(false), sampled(true));
    let (learnt, before, after) = (learnt.unwrap(), cost * worst(&plain), work * worst(&weighed));
    println!("{learnt:?}: work for an independent value {before} before, {after} after");
    assert!(none.is_none() && learnt[0] < 0.4 && before > 1.5 * after, "{learnt:?} {before} {after}");
    for x in &weighed {
        let found = x.iter().sum::<f64>() / SAMPLED as f64;
        let error = (time(x) / 26.0 / SAMPLED as f64).sqrt();
        assert!((found - 50.0 / 26.0).abs() < 5.0 * error, "{found}, standard error {error}");
    }
}

/// What is learnt does not depend on what the memory happens to hold: after an interruption it holds nothing.
#[test]
fn it_goes_on_with_the_same_bits_and_is_frozen() {
    let (costly, end) = (Costly::new(), WARMUP + 500);
    let moves = moves();
    let whole = |stops: &[u64]| {
        let mut chain = Chain::start(&costly, &moves, Seed(3).chain(0)).unwrap().weighing(WARMUP);
        let mut learnt = Vec::new();
        while chain.iteration() < end {
            if stops.contains(&chain.iteration()) {
                let (scales, state) = (chain.scales().unwrap().clone(), chain.state().clone());
                assert!(scales.fit(&moves));
                let (at, counts) = (chain.iteration(), chain.counts().to_vec());
                chain = Chain::resume(&costly, &moves, Seed(3).chain(0), at, state, counts).with_scales(scales);
            }
            chain.step().unwrap();
            let probabilities = chain.scales().unwrap().probabilities();
            assert_eq!(probabilities.is_some(), chain.iteration() + 1 >= WARMUP);
            learnt.extend(probabilities);
        }
        assert!(learnt.iter().all(|one| *one == learnt[0]));
        (chain.state().clone(), chain.scales().unwrap().clone(), chain.counts().to_vec())
    };
    let stops: Vec<u64> = (1100..1130).chain([1, 1500, WARMUP / 2 + 77, WARMUP - 1, WARMUP, WARMUP + 9]).collect();
    assert_eq!(whole(&[]), whole(&stops));
}
