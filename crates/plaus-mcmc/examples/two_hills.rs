//! Your own target with your own moves: sampled by four chains, diagnosed, and checked. The check catches a wrong move.
//!
//! `cargo run --release -p plaus-mcmc --example two_hills`
#![allow(clippy::print_stdout)]

use plaus_dist::{Density, Gaussian, LogDensity, LogPotential, LogRatio, Sample, Seed, Stream, Uniform, math};
use plaus_mcmc::check::{OneStep, Ratios, Statistic, one_step, prior, ratios, rejection};
use plaus_mcmc::{
    At, Block, Control, Goal, Mixture, ModelError, Move, Plan, Progress, Proposal, Simulated, Sink, Snapshot,
    SolutionClass, StateOf, StateRefOf, Target, Transition, diagnose, run,
};

/// A marble is thrown with some strength. It lands according to a made-up law, and should land near one of two hills at
/// ±2.
struct TwoHills {
    strength: Gaussian,
    hill: Gaussian,
}

impl Target for TwoHills {
    type Draw = f64;
    type Outcome = f64;
    type Scratch = ();

    fn start(&self, stream: &mut Stream) -> f64 {
        self.strength.sample(stream)
    }

    fn log_prior(&self, strength: &f64) -> Result<LogDensity, ModelError> {
        Ok(self.strength.log_density(strength)?)
    }

    /// The "simulation". It is cheap here; an expensive one would stop as soon as it knows that `floor` is out of reach.
    fn simulate(
        &self,
        strength: &f64,
        _current: Option<StateRefOf<'_, Self>>,
        _floor: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<f64>, ModelError> {
        Ok(Simulated::Complete(strength * strength.abs()))
    }

    fn log_constraint(&self, landing: &f64) -> Result<LogPotential, ModelError> {
        let near = |hill: f64| -> Result<f64, ModelError> { Ok(self.hill.log_density(&(landing - hill))?.value()) };
        Ok(LogPotential::new(math::ln_add_exp(near(-2.0)?, near(2.0)?))?)
    }
}

impl Goal for TwoHills {
    /// A throw satisfies the constraint within half a unit of a hill; solutions at different hills are distinct.
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        let hit = (state.outcome.abs() - 2.0).abs() < 0.5;
        hit.then(|| SolutionClass::of([state.outcome.signum() as i64]))
    }
}

/// Throws the other way: its own reverse, and symmetric.
struct Mirror;

impl Move<TwoHills> for Mirror {
    fn name(&self) -> &str {
        "mirror"
    }
    fn propose(&self, _: At<'_, TwoHills>, strength: &mut f64, _: &mut Stream) -> Result<Proposal, ModelError> {
        *strength = -*strength;
        Ok(Proposal::SYMMETRIC)
    }
    fn log_ratio(&self, _: Transition<'_, TwoHills>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

/// Multiplies the strength by exp(u), with u uniform around 0. A symmetric law of u is not a symmetric proposal:
/// stretching makes the density thinner, so the ratio is the factor itself, |to| / |from|. That is easy to forget.
struct StretchMove {
    log_factor: Uniform,
    forgets_the_ratio: bool,
}

impl StretchMove {
    fn ratio(&self, from: f64, to: f64) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(if self.forgets_the_ratio { 0.0 } else { math::ln((to / from).abs()) })?)
    }
}

impl Move<TwoHills> for StretchMove {
    fn name(&self) -> &str {
        "stretch"
    }
    fn propose(&self, at: At<'_, TwoHills>, strength: &mut f64, stream: &mut Stream) -> Result<Proposal, ModelError> {
        *strength *= math::exp(self.log_factor.sample(stream));
        Ok(Proposal::with_ratio(self.ratio(*at.state.draw, *strength)?))
    }
    fn log_ratio(&self, step: Transition<'_, TwoHills>) -> Result<LogRatio, ModelError> {
        self.ratio(*step.from.draw, *step.to.draw)
    }
}

/// Keeps the strength of every recorded draw of the sampling phase, chain by chain.
struct Strengths {
    warmup: u64,
    chains: Vec<Vec<f64>>,
}

impl Sink<f64, f64> for Strengths {
    type Error = std::convert::Infallible;

    fn block(&mut self, chain: u32, block: Block<f64, f64>, _: &Snapshot<f64, f64>) -> Result<(), Self::Error> {
        // One block is all warm-up here, because the block length divides it.
        if block.first_iteration >= self.warmup {
            let draws = block.entries.iter().flat_map(|e| std::iter::repeat_n(e.state.draw, e.draws as usize));
            self.chains[chain as usize].extend(draws);
        }
        Ok(())
    }

    fn round(&mut self, progress: &Progress<'_>) -> Result<Control, Self::Error> {
        if progress.end_iteration.is_multiple_of(5_000) {
            println!("{:>6} iterations, {} kinds of solution", progress.end_iteration, progress.distinct.count());
        }
        Ok(Control::Continue)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let target = TwoHills { strength: Gaussian::new(0.0, 1.0)?, hill: Gaussian::new(0.0, 0.3)? };
    let stretch = |forgets_the_ratio| -> Result<Box<dyn Move<TwoHills>>, Box<dyn std::error::Error>> {
        Ok(Box::new(StretchMove { log_factor: Uniform::new(-0.7, 0.7)?, forgets_the_ratio }))
    };

    // Sample.
    let moves = Mixture::new(vec![(0.8, stretch(false)?), (0.2, Box::new(Mirror))])?;
    let plan = Plan {
        seed: Seed(1),
        chains: 4,
        warmup: 1_000,
        iterations: 19_000,
        thin: 1,
        block: 1_000,
        solutions: None,
        rungs: 1,
        adapt_rungs: false,
        swap_every: 1,
        adapt: false,
        weigh: false,
        settle: false,
        climbs: 0,
        sampled: false,
    };
    let mut strengths = Strengths { warmup: plan.warmup, chains: vec![Vec::new(); 4] };
    run(&target, &moves, plan, Vec::new(), 0, &mut strengths)?;

    // Diagnose.
    let row = diagnose::summarize(&strengths.chains)?;
    println!("\nstrength: mean {:.3} ± {:.3}, sd {:.3}", row.mean, row.mcse_mean, row.sd);
    println!("R-hat {:.4}, ESS bulk {:.0}, tail {:.0}\n", row.rhat.unwrap_or(f64::NAN), row.ess_bulk, row.ess_tail);

    // Check, with a right and with a wrong move. Both are consistent with themselves, but only the right one samples
    // the target.
    let bound = LogPotential::new(math::ln_add_exp(0.0, 0.0) + target.hill.log_density(&0.0)?.value())?;
    for forgets_the_ratio in [false, true] {
        println!("== stretch{} ==", if forgets_the_ratio { ", its ratio forgotten" } else { "" });
        let kernel = stretch(forgets_the_ratio)?;
        print!("{}", ratios(&target, kernel.as_ref(), prior(&target), Ratios::default())?);
        let strength = Statistic::new("|strength|", |state: &StateOf<TwoHills>| state.draw.abs());
        // The stretch is rarely accepted, so one step moves the law by little: ten show it far more clearly.
        let plan = OneStep { steps: 10, ..OneStep::default() };
        let report = one_step(&target, &Mixture::of(kernel), rejection(&target, bound), &[strength], plan)?;
        println!("{report}");
        if report.passed() == forgets_the_ratio {
            return Err("the check came out wrong".into());
        }
    }
    Ok(())
}
