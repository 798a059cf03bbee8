//! Independent draws by rejection: draws that are kept have the law of the target, whatever the state before. Wrong
//! twins keep too many, or draw from a law other than the prior.

use crate::toys::balls::{Balls, Drops, active, filled};
use plaus_dist::{LogDensity, LogPotential, LogRatio, Seed, Stream};
use plaus_mcmc::check::{OneStep, OneStepReport, Statistic, one_step, rejection};
use plaus_mcmc::{
    At, Chain, ChainError, Decision, Independent, Mixture, ModelError, Move, Proposal, Simulated, StateOf, StateRefOf,
    Target, Transition,
};

const PLAN: OneStep = OneStep { seed: Seed(11), samples: 40_000, steps: 1, cells: 16, false_alarm: 1e-6 };

fn statistics<'a>() -> [Statistic<'a, Drops, Vec<u32>>; 3] {
    [
        Statistic::new("active", |state: &StateOf<Balls>| active(&state.draw) as f64),
        Statistic::new("filled", |state: &StateOf<Balls>| filled(&state.outcome) as f64),
        Statistic::new("sum of places", |state: &StateOf<Balls>| state.draw.iter().flatten().sum()),
    ]
}

fn balls(ln_lambda: f64) -> Balls {
    Balls::anywhere(4, 3, 0.5, ln_lambda)
}

fn stepped(kernel: Box<dyn Move<Balls>>, ln_lambda: f64) -> OneStepReport {
    let balls = balls(ln_lambda);
    let exact = rejection(&balls, balls.most().unwrap());
    one_step(&balls, &Mixture::of(kernel), exact, &statistics(), PLAN).unwrap()
}

/// Draws from a part of the prior only.
struct Few;

impl Move<Balls> for Few {
    fn name(&self) -> &str {
        "few"
    }
    fn propose(&self, at: At<'_, Balls>, draw: &mut Drops, stream: &mut Stream) -> Result<Proposal, ModelError> {
        *draw = at.target.start(stream);
        draw[0] = None;
        Ok(Proposal::Anew)
    }
    fn log_ratio(&self, _: Transition<'_, Balls>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

#[test]
fn the_target_stays_invariant_and_a_draw_from_elsewhere_is_noticed() {
    for ln_lambda in [0.0, 1.0, 3.0] {
        let right = stepped(Box::new(Independent), ln_lambda);
        assert!(right.passed() && right.accepted() > 1000, "{right}");
        let wrong = stepped(Box::new(Few), ln_lambda);
        assert!(!wrong.passed(), "{wrong}");
    }
}

/// Balls that claim a given bound.
struct Claims(Balls, Option<f64>);

impl Target for Claims {
    type Draw = Drops;
    type Outcome = Vec<u32>;
    type Scratch = Vec<u32>;
    fn start(&self, stream: &mut Stream) -> Drops {
        self.0.start(stream)
    }
    fn log_prior(&self, draw: &Drops) -> Result<LogDensity, ModelError> {
        self.0.log_prior(draw)
    }
    fn simulate(
        &self,
        draw: &Drops,
        _: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        loads: &mut Vec<u32>,
    ) -> Result<Simulated<Vec<u32>>, ModelError> {
        self.0.simulate(draw, None, floor, loads)
    }
    fn log_constraint(&self, loads: &Vec<u32>) -> Result<LogPotential, ModelError> {
        self.0.log_constraint(loads)
    }
    fn most(&self) -> Option<LogPotential> {
        Some(LogPotential::new(self.1?).unwrap())
    }
}

/// Kept draws are independent: neither the state before nor a bound that is too high affects them. A bound that is too
/// low, or missing, is an error, and never leads to another law.
#[test]
fn bounds_that_are_too_high_cost_time_alone() {
    let shares = |bound: f64| {
        let target = Claims(balls(1.0), Some(bound));
        let moves = Independent::mixture();
        let mut chain = Chain::start(&target, &moves, Seed(5).chain(0)).unwrap();
        let (mut kept, mut full, mut both, mut last) = (0.0_f64, 0.0_f64, 0.0_f64, false);
        for _ in 0..400_000 {
            if chain.step().unwrap().decision == Decision::Accepted {
                let now = filled(&chain.state().outcome) == 3;
                (kept, full) = (kept + 1.0, full + f64::from(u8::from(now)));
                both += f64::from(u8::from(now && last));
                last = now;
            }
        }
        (kept, full / kept, both / kept)
    };
    let (tight, loose) = (shares(3.0), shares(4.0));
    // A share p of n independent draws deviates by five standard errors once in two million cases.
    let off = |p: f64, n: f64| 5.0 * (p * (1.0 - p) / n).sqrt();
    assert!((tight.1 - loose.1).abs() < off(tight.1, tight.0) + off(tight.1, loose.0), "{tight:?} {loose:?}");
    assert!((tight.0 / loose.0 / std::f64::consts::E - 1.0).abs() < 10.0 / loose.0.sqrt(), "{tight:?} {loose:?}");
    // For independent draws, both of two neighbours are full with the square of the probability (a pair's count has
    // twice the spread).
    assert!((tight.2 - tight.1 * tight.1).abs() < 2.0 * off(tight.1, tight.0), "{tight:?}");
    for bound in [Some(2.0), None] {
        let (target, moves) = (Claims(balls(1.0), bound), Independent::mixture());
        let mut chain = Chain::start(&target, &moves, Seed(5).chain(0)).unwrap();
        let failed = (0..10_000).find_map(|_| chain.step().err());
        assert!(matches!(failed, Some(ChainError::Model { .. })), "{bound:?}");
    }
}
