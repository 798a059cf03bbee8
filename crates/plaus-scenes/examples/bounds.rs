//! What bounds chains of bowling: how fast any chain could make independent solutions, beside draws of the prior.
//!
//!     cargo run --release -p plaus-scenes --example bounds -- scenarios/bowling-strike.toml [SOLUTIONS] [TRIES]
//!
//! Solutions are made by rejection from the prior, so they are exact and independent. Each is then changed in several
//! ways, TRIES times each. A change counts as kept if a chain would accept it and it is still a solution. Candidates
//! are stopped as soon as they are certain to be rejected. Work is simulated events.
//!
//! Let h be the probability that a ball's release is a solution with pins set anew. Whatever law q proposes releases
//! from, with pins set anew, N proposals are worth at most N (∫ p h)² / ∫ p² h / q independent solutions (importance
//! sampling; a Metropolis chain that makes only such moves is worth less). The best q is p √h, which gives
//! 1 / (E h^(−½))² solutions for each proposal, with the mean over solutions. Here h is estimated with the pins of the
//! solution among the tries, so that it is never 0, and the bound rather too high.
//!
//! A chain that makes one kind of step has the correlation 1 − E Δ² / 2 from one iteration to the next, where Δ is a
//! jump in units of a variable's deviation among solutions, and 0 if the step is rejected. With this correlation r,
//! (1 − r) / (1 + r) independent draws come from an iteration if the variable moves like a first-order process. Numbers
//! are means over the variables that move.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod shared;

use plaus_dist::stream::below;
use plaus_dist::{LogPotential, LogRatio, Purpose, Seed, Stream, math, open_unit};
use plaus_mcmc::library::{Sizes, StepAll};
use plaus_mcmc::vars::renew;
use plaus_mcmc::{At, Goal, Move, Proposal, Recipe, Simulated, State, StateOf, Target, Variables};
use plaus_scenes::bowling::Bowling;
use plaus_scenes::{Scenario, World};
use shared::seconds;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// How candidates ended.
#[derive(Default)]
struct Tried {
    tries: u64,
    kept: u64,
    /// Sum over those kept of the mean squared jump of the variables, each relative to its variance among solutions.
    jumps: f64,
    work: u64,
    /// The part of the work that rejected candidates took.
    rejected: u64,
    seconds: f64,
}

impl Tried {
    fn share(&self) -> f64 {
        self.kept as f64 / self.tries as f64
    }
}

struct Bounds<'a> {
    scene: &'a Bowling,
    most: f64,
    ball: Vec<usize>,
    pins: Vec<usize>,
    solutions: Vec<StateOf<Bowling>>,
    tries: u64,
    /// Of each number among the solutions.
    variances: Vec<f64>,
    stream: Stream,
    work: <Bowling as Target>::Scratch,
}

impl Bounds<'_> {
    /// The state of a draw, if its constraint exceeds its bound times a uniform number, and the inverse of `ratio`.
    fn kept(&mut self, draw: <Bowling as Target>::Draw, ratio: LogRatio) -> Result<Option<StateOf<Bowling>>> {
        let log_prior = self.scene.log_prior(&draw)?;
        let floor = math::ln(open_unit(&mut self.stream)) + self.most - ratio.value();
        if log_prior.is_zero() || floor >= self.most {
            return Ok(None);
        }
        let floor = LogPotential::new(floor)?;
        let Simulated::Complete(outcome) = self.scene.simulate(&draw, None, floor, &mut self.work)? else {
            return Ok(None);
        };
        let log_constraint = self.scene.log_constraint(&outcome)?;
        Ok((log_constraint > floor).then_some(State { draw, outcome, log_prior, log_constraint }))
    }

    fn is_solution(&self, state: &StateOf<Bowling>) -> bool {
        self.scene.class(state.by_ref()).is_some()
    }

    /// Draws from the prior until there are so many solutions; also counts the draws of the target.
    fn draw(&mut self, wanted: usize) -> Result<(Tried, u64)> {
        let (mut tried, mut of_target) = (Tried::default(), 0);
        let (begin, before) = (seconds(), self.scene.work());
        while self.solutions.len() < wanted {
            tried.tries += 1;
            let draw = self.scene.start(&mut self.stream);
            let Some(state) = self.kept(draw, LogRatio::ONE)? else { continue };
            of_target += 1;
            if self.is_solution(&state) {
                tried.kept += 1;
                self.solutions.push(state);
            }
        }
        (tried.work, tried.seconds) = (self.scene.work() - before, seconds() - begin);
        Ok((tried, of_target))
    }

    /// Changes every solution in one way; also returns how often each was kept.
    fn change(
        &mut self,
        change: &dyn Fn(&mut Self, usize, &mut Shot) -> Result<LogRatio>,
    ) -> Result<(Tried, Vec<u64>)> {
        let (mut tried, mut each) = (Tried::default(), Vec::new());
        let (begin, before) = (seconds(), self.scene.work());
        for solution in 0..self.solutions.len() {
            let mut kept = 0;
            for _ in 0..self.tries {
                let mut draw = self.solutions[solution].draw.clone();
                let ratio = change(self, solution, &mut draw)?;
                let before = self.scene.work();
                let state = self.kept(draw, ratio)?;
                tried.rejected += if state.is_none() { self.scene.work() - before } else { 0 };
                if let Some(state) = state.filter(|state| self.is_solution(state)) {
                    kept += 1;
                    tried.jumps += self.jump(&self.solutions[solution].draw, &state.draw);
                }
            }
            each.push(kept);
        }
        tried.tries = self.tries * self.solutions.len() as u64;
        tried.kept = each.iter().sum();
        (tried.work, tried.seconds) = (self.scene.work() - before, seconds() - begin);
        Ok((tried, each))
    }

    /// The mean, over the numbers that differ, of squared jumps relative to the variances among solutions.
    fn jump(&self, from: &Shot, to: &Shot) -> f64 {
        let jumps = numbers(from).zip(numbers(to)).zip(&self.variances).filter(|((from, to), _)| from != to);
        let (sum, count) = jumps.fold((0.0, 0), |(sum, count), ((from, to), variance)| {
            (sum + math::square(to - from) / variance, count + 1)
        });
        sum / f64::from(count.max(1))
    }

    fn renew(&mut self, vars: &[usize], draw: &mut Shot) {
        vars.iter().for_each(|&var| renew(self.scene, draw, var, Recipe::Exact, &mut self.stream));
    }

    /// A step of one size of these variables.
    fn step(&mut self, vars: &[usize], size: f64, solution: usize, draw: &mut Shot) -> Result<LogRatio> {
        let step = StepAll { name: "step", among: vars.to_vec(), sizes: Sizes::new(size, size) };
        let from = &self.solutions[solution];
        let Proposal::Candidate { log_ratio, .. } = step.propose(At::new(self.scene, from), draw, &mut self.stream)?
        else {
            return Ok(LogRatio::ONE);
        };
        let to = self.scene.log_prior(draw)?;
        Ok(if to.is_zero() { LogRatio::ZERO } else { log_ratio.times(LogRatio::of(to, from.log_prior)?)? })
    }

    fn report(&mut self, wanted: usize) -> Result<()> {
        let (prior, of_target) = self.draw(wanted)?;
        let count = self.solutions.len() as f64;
        let all: Vec<Vec<f64>> = self.solutions.iter().map(|state| numbers(&state.draw).collect()).collect();
        self.variances = (0..all[0].len())
            .map(|k| {
                let mean = all.iter().map(|row| row[k]).sum::<f64>() / count;
                all.iter().map(|row| math::square(row[k] - mean)).sum::<f64>() / (count - 1.0)
            })
            .collect();
        let (draws, work) = (1.0 / prior.share(), prior.work as f64 / prior.kept as f64);
        println!("prior: one solution in {draws:.0} draws, {work:.0} events, {:.4} s", prior.seconds / wanted as f64);
        let share = prior.kept as f64 / of_target as f64;
        println!("of the target, {share:.3} are solutions");
        let (ball, pins) = (self.ball.clone(), self.pins.clone());

        let (fresh, each) = self.change(&|this, _, draw| {
            this.renew(&pins, draw);
            Ok(LogRatio::ONE)
        })?;
        let all = (self.tries + 1) as f64;
        let root = each.iter().map(|&kept| (all / (kept + 1) as f64).sqrt()).sum::<f64>() / each.len() as f64;
        let bound = 1.0 / (root * root);
        let cost = (1 + fresh.work / fresh.tries) as f64;
        let misses = fresh.rejected as f64 / (fresh.tries - fresh.kept).max(1) as f64;
        println!(
            "\npins set anew, release kept: {:.3} are solutions, {cost:.0} events each, {misses:.0} of one rejected",
            fresh.share()
        );
        println!(
            "so chains that draw releases anew make at most {bound:.3} independent solutions an iteration: {:.2} times \
             the prior's for its work",
            bound / cost * work
        );
        let target = share.min(bound);
        println!("of those in the target, at most {target:.3}: {:.2} times", target / cost * work);

        println!("\n| change | size | kept | effective draws an iteration | times the prior's |");
        println!("| --- | --- | --- | --- | --- |");
        let row = |this: &mut Self, name: &str, vars: &[usize], size: f64| -> Result<()> {
            let (tried, _) = this.change(&|this, solution, draw| this.step(vars, size, solution, draw))?;
            let correlation = (1.0 - 0.5 * tried.jumps / tried.tries as f64).max(0.0);
            let effective = (1.0 - correlation) / (1.0 + correlation);
            let times = effective * work * tried.tries as f64 / (tried.work + tried.tries) as f64;
            println!("| {name} | {size} | {:.3} | {effective:.4} | {times:.2} |", tried.share());
            Ok(())
        };
        for size in [0.03, 0.1, 0.3, 0.6, 1.0] {
            row(self, "all pins", &pins, size)?;
            row(self, "release", &ball, size)?;
            row(self, "all", &[ball.as_slice(), &pins].concat(), size)?;
        }
        for count in [1, 2, 4].into_iter().filter(|&count| count < pins.len()) {
            let (tried, _) = self.change(&|this, _, draw| {
                let mut left = pins.clone();
                let chosen: Vec<usize> =
                    (0..count).map(|_| left.swap_remove(below(&mut this.stream, left.len()))).collect();
                this.renew(&chosen, draw);
                Ok(LogRatio::ONE)
            })?;
            println!("pins set anew, {count} of {}: {:.3} stay solutions", pins.len(), tried.share());
        }
        Ok(())
    }
}

type Shot = <Bowling as Target>::Draw;

/// All numbers of a draw.
fn numbers(draw: &Shot) -> impl Iterator<Item = f64> {
    draw.ball.iter().copied().chain(draw.pins.iter().flatten().copied())
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap_or_else(|| "scenarios/bowling-strike.toml".into());
    let solutions = args.next().map_or(Ok(10), |text| text.parse())?;
    let tries = args.next().map_or(Ok(4), |text| text.parse())?;
    let scenario = Scenario::read(&path, &std::fs::read_to_string(&path)?, &args.collect::<Vec<_>>())?;
    let World::Bowling(config) = &scenario.world else { return Err("this is about bowling".into()) };
    let scene = Bowling::new(config)?;
    let most = scene.most().ok_or("no bound of the constraint is known")?.value();
    let (ball, pins) = (scene.vars().which(|var| var.member.is_none()), scene.vars().named(&["offset"]));
    let stream = Seed(1).chain(0).at(0, Purpose(100));
    println!("{path}: {solutions} solutions, {tries} tries each");
    let work = <Bowling as Target>::Scratch::default();
    let (solved, variances) = (Vec::new(), Vec::new());
    Bounds { scene: &scene, most, ball, pins, solutions: solved, tries, variances, stream, work }.report(solutions)
}
