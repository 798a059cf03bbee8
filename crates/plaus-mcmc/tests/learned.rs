//! A move that learns in the warm-up where the target is. After the warm-up it is frozen; it continues with the same
//! bits, agrees with a closed form, and is better than moves that do not learn.

use plaus_dist::{Gaussian, LogDensity, LogPotential, Seed, Stream, math};
use plaus_mcmc::diagnose::integrated_autocorrelation_time;
use plaus_mcmc::library::{Learned, RedrawAll, Sizes, StepAll};
use plaus_mcmc::{
    Chain, Law, Mixture, ModelError, Move, MoveId, Recipe, Simulated, StateRefOf, Target, Var, Variables, Vars, vars,
};

/// Two numbers x and y, standard normal under the prior. x should be near 2, and y near x, both with standard deviation
/// 0.2.
struct Near(Vars);

impl Near {
    fn new() -> Self {
        let number =
            |name: &'static str| Var::new(name, "", Law::Gaussian(Gaussian::new(0.0, 1.0).unwrap())).column(1.0);
        Self(Vars::new(vec![number("x"), number("y")]))
    }
}

impl Variables for Near {
    fn vars(&self) -> &Vars {
        &self.0
    }

    fn get<'a>(&self, draw: &'a [f64; 2], var: usize) -> Option<&'a [f64]> {
        Some(std::slice::from_ref(&draw[var]))
    }

    fn get_mut<'a>(&self, draw: &'a mut [f64; 2], var: usize) -> Option<&'a mut [f64]> {
        Some(std::slice::from_mut(&mut draw[var]))
    }
}

impl Target for Near {
    type Draw = [f64; 2];
    type Outcome = [f64; 2];
    type Scratch = ();

    fn start(&self, stream: &mut Stream) -> [f64; 2] {
        let mut draw = [0.0; 2];
        self.renew_all(&mut draw, Recipe::Exact, stream);
        draw
    }

    fn log_prior(&self, draw: &[f64; 2]) -> Result<LogDensity, ModelError> {
        Ok(vars::log_prior(self, draw)?)
    }

    fn simulate(
        &self,
        draw: &[f64; 2],
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<[f64; 2]>, ModelError> {
        Ok(Simulated::Complete(*draw))
    }

    fn log_constraint(&self, [x, y]: &[f64; 2]) -> Result<LogPotential, ModelError> {
        Ok(LogPotential::new(-0.5 * (math::square((x - 2.0) / 0.2) + math::square((y - x) / 0.2)))?)
    }
}

const WARMUP: u64 = 4000;
const SAMPLED: u64 = 40_000;

/// Weights of the first two moves; steps of all variables have weight 0.5.
fn moves(near: &Near, anew: f64, learned: f64) -> Mixture<Near> {
    let all: [(f64, Box<dyn Move<Near>>); 3] = [
        (anew, Box::new(RedrawAll::exact("redraw_all"))),
        (learned, Box::new(Learned::of("learned", near.vars()))),
        (0.5, Box::new(StepAll { name: "step_all", among: vec![0, 1], sizes: Sizes::new(1e-3, 1.0) })),
    ];
    Mixture::new(all.into()).unwrap()
}

/// Values of x and y after the warm-up, and the accepted share of the mixture's first move.
fn sampled(near: &Near, moves: &Mixture<Near>) -> ([Vec<f64>; 2], f64) {
    let mut chain = Chain::start(near, moves, Seed(2).chain(0)).unwrap().adapting(WARMUP);
    while chain.iteration() < WARMUP {
        chain.step().unwrap();
    }
    let before = chain.counts()[0];
    let mut values = [Vec::new(), Vec::new()];
    for _ in 0..SAMPLED {
        chain.step().unwrap();
        values.iter_mut().zip(chain.state().draw).for_each(|(all, x)| all.push(x));
    }
    (values, chain.counts()[0].since(&before).acceptance())
}

/// The target is Gaussian, with precision [[51, −25], [−25, 26]] and mean (1300, 1250) / 701.
#[test]
fn learnt_proposals_agree_with_a_closed_form_and_gain_more() {
    let near = Near::new();
    let (anew, with_anew) = sampled(&near, &moves(&near, 0.5, 0.0));
    let (learnt, with_learnt) = sampled(&near, &moves(&near, 0.0, 0.5));
    assert!(with_anew < 0.05 && with_learnt > 0.4, "accepted {with_anew} {with_learnt}");
    let time = |x: &[f64]| integrated_autocorrelation_time(&[x]).unwrap().unwrap().tau;
    let times = |values: &[Vec<f64>; 2]| values.each_ref().map(|x| time(x));
    let (of_anew, of_learnt) = (times(&anew), times(&learnt));
    for (k, mean, variance) in [(0, 1300.0 / 701.0, 26.0 / 701.0), (1, 1250.0 / 701.0, 51.0 / 701.0)] {
        println!("autocorrelation time of {}: {} anew, {} learnt", ["x", "y"][k], of_anew[k], of_learnt[k]);
        assert!(of_anew[k] > 2.0 * of_learnt[k]);
        let found = learnt[k].iter().sum::<f64>() / SAMPLED as f64;
        let error = (variance * of_learnt[k] / SAMPLED as f64).sqrt();
        assert!((found - mean).abs() < 5.0 * error, "{found} for {mean}, standard error {error}");
    }
}

/// What a chain has learnt is part of its scales, whether it is interrupted in the warm-up, at its end or after it.
#[test]
fn it_goes_on_with_the_same_bits_and_is_frozen() {
    let (near, end) = (Near::new(), WARMUP + 500);
    let moves = moves(&near, 0.0, 0.5);
    let whole = |stops: &[u64]| {
        let mut chain = Chain::start(&near, &moves, Seed(3).chain(0)).unwrap().adapting(WARMUP);
        let mut fits = Vec::new();
        while chain.iteration() < end {
            if stops.contains(&chain.iteration()) {
                let (scales, state) = (chain.scales().unwrap().clone(), chain.state().clone());
                assert!(scales.fit(&moves));
                let (at, counts) = (chain.iteration(), chain.counts().to_vec());
                chain = Chain::resume(&near, &moves, Seed(3).chain(0), at, state, counts).with_scales(scales);
            }
            chain.step().unwrap();
            if chain.iteration() >= WARMUP {
                fits.push(chain.scales().unwrap().learned(MoveId(0)).unwrap().clone());
            }
        }
        assert!(fits[0].fits()[0].is_some() && fits.iter().all(|fit| *fit == fits[0]));
        (chain.state().clone(), chain.scales().unwrap().clone(), chain.counts().to_vec())
    };
    assert_eq!(whole(&[]), whole(&[1, 1500, WARMUP / 2 + 77, WARMUP - 1, WARMUP, WARMUP + 9]));
}
