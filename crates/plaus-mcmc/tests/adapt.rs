//! Scales adapted in the warm-up reach the wanted acceptance, no longer change after it, and leave the target
//! invariant. A twin that never stops adapting does not leave it invariant.

use plaus_dist::{
    Density, Gaussian, LogDensity, LogPotential, LogRatio, Purpose, Sample, Seed, Stream, math, open_unit,
};
use plaus_mcmc::check::{OneStep, Statistic, one_step};
use plaus_mcmc::diagnose::integrated_autocorrelation_time;
use plaus_mcmc::{
    At, Block, Chain, Control, Decision, Distinct, Goal, Mixture, ModelError, Move, MoveId, Plan, Progress, Proposal,
    Redraw, Replicas, Scale, Scales, Simulated, Sink, Snapshot, SolutionClass, Start, State, StateRefOf, Target,
    Transition, run,
};

/// A number. Its prior is Gaussian, or exponential, which forbids negative values. The constraint is Gaussian around 0.
#[derive(Clone, Copy)]
struct Number {
    prior: Prior,
    /// Standard deviation of the constraint.
    narrow: f64,
    /// Smaller numbers are solutions.
    within: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Prior {
    Gaussian,
    Exponential,
}

const GAUSSIAN: Number = Number { prior: Prior::Gaussian, narrow: f64::INFINITY, within: 0.1 };
const EXPONENTIAL: Number = Number { prior: Prior::Exponential, ..GAUSSIAN };

impl Target for Number {
    type Draw = f64;
    type Outcome = f64;
    type Scratch = ();
    fn start(&self, stream: &mut Stream) -> f64 {
        match self.prior {
            Prior::Gaussian => Gaussian::new(0.0, 1.0).unwrap().sample(stream),
            Prior::Exponential => -math::ln(open_unit(stream)),
        }
    }
    fn log_prior(&self, draw: &f64) -> Result<LogDensity, ModelError> {
        match self.prior {
            Prior::Gaussian => Ok(Gaussian::new(0.0, 1.0).unwrap().log_density(draw)?),
            Prior::Exponential if *draw < 0.0 => Ok(LogDensity::ZERO),
            Prior::Exponential => Ok(LogDensity::new(-draw)?),
        }
    }
    fn simulate(
        &self,
        draw: &f64,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<f64>, ModelError> {
        Ok(Simulated::Complete(*draw))
    }
    fn log_constraint(&self, outcome: &f64) -> Result<LogPotential, ModelError> {
        Ok(LogPotential::new(-0.5 * math::square(outcome / self.narrow))?)
    }
}

impl Goal for Number {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        (state.draw.abs() < self.within).then(|| SolutionClass::of([(state.draw * 1e3) as i64]))
    }
}

/// A Gaussian step, symmetric.
#[derive(Clone, Copy)]
struct Walk {
    size: f64,
    target: f64,
}

impl Move<Number> for Walk {
    fn name(&self) -> &str {
        "walk"
    }
    fn propose(&self, _: At<'_, Number>, x: &mut f64, stream: &mut Stream) -> Result<Proposal, ModelError> {
        *x += self.size * Gaussian::new(0.0, 1.0).unwrap().sample(stream);
        Ok(Proposal::SYMMETRIC)
    }
    fn log_ratio(&self, _: Transition<'_, Number>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
    fn scales(&self) -> Vec<Scale> {
        vec![Scale { name: "size", start: self.size, least: 1e-4, most: 1e4, target: self.target }]
    }
    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Number>>> {
        Some(Box::new(Self { size: values[0].unwrap_or(self.size), ..*self }))
    }
}

fn walking(size: f64) -> Mixture<Number> {
    Mixture::of(Box::new(Walk { size, target: Scale::ONE }))
}

fn size(scales: Option<&Scales>) -> f64 {
    scales.unwrap().values(MoveId(0))[0].unwrap()
}

/// A chain that adapts in the iterations before `until`; the share it accepts in the `count` iterations after them, and
/// the autocorrelation time of these decisions.
fn adapted(start: f64, target: f64, seed: u64, until: u64, count: u64) -> (Scales, f64, f64) {
    let moves = Mixture::of(Box::new(Walk { size: start, target }) as Box<dyn Move<Number>>);
    let mut chain = Chain::start(&GAUSSIAN, &moves, Seed(seed).chain(0)).unwrap().adapting(until);
    for _ in 1..until {
        chain.step().unwrap();
    }
    let frozen = chain.scales().unwrap().clone();
    let accepts: Vec<f64> =
        (0..count).map(|_| f64::from(u8::from(chain.step().unwrap().decision == Decision::Accepted))).collect();
    let after = chain.scales().unwrap();
    assert!(frozen.are_frozen() && after.values(MoveId(0)) == frozen.values(MoveId(0)));
    assert_eq!(after.adapted(MoveId(0))[0].tried(), count, "counted since the warm-up");
    let tau = integrated_autocorrelation_time(&[&accepts]).unwrap().unwrap().tau;
    (frozen, accepts.iter().sum::<f64>() / count as f64, tau)
}

/// The mean of `ln s` over the n proposals of the warm-up's second half solves *acceptance = target* up to an error.
/// The effect of this error on the acceptance has variance τ p (1 − p)/n whatever the slope (Polyak and Juditsky 1992),
/// where τ is the decisions' autocorrelation time. The measured share of m proposals adds τ p (1 − p)/m. Eight chains
/// with a false-alarm rate of 1e-6 together: 5.4 standard deviations.
#[test]
fn a_gaussian_is_accepted_as_often_as_wanted() {
    let (until, count) = (20_000, 20_000);
    for target in [Scale::ONE, Scale::MANY] {
        for (seed, start) in [(0, 1e-3), (1, 0.1), (2, 1.0), (3, 1e3)] {
            let (scales, share, tau) = adapted(start, target, seed, until, count);
            let variance = tau * target * (1.0 - target) * (2.0 / until as f64 + 1.0 / count as f64);
            let allowed = 5.4 * variance.sqrt();
            println!("from {start}: {:.3}, accepted {share:.4} for {target} ± {allowed:.4}", size(Some(&scales)));
            assert!((share - target).abs() < allowed, "from {start}: {share} for {target} ± {allowed}");
            // A target higher by 0.1 would be told apart.
            assert!((share - (target + 0.1)).abs() > allowed);
        }
    }
    // A step of s standard deviations is accepted with probability 2/π atan(2/s): 0.44 for s = 2.4.
    let exact = 2.0 / math::tan(0.5 * std::f64::consts::PI * Scale::ONE);
    let (scales, ..) = adapted(0.01, Scale::ONE, 9, 100_000, 100);
    assert!((size(Some(&scales)) / exact - 1.0).abs() < 0.1, "{} for {exact}", size(Some(&scales)));
}

#[test]
fn without_a_warm_up_nothing_is_adapted() {
    let moves = walking(0.3);
    let begun = |until| Chain::start(&GAUSSIAN, &moves, Seed(1).chain(0)).unwrap().adapting(until);
    for until in [0, 1] {
        let (mut plain, mut adapting) = (Chain::start(&GAUSSIAN, &moves, Seed(1).chain(0)).unwrap(), begun(until));
        assert!(adapting.scales().is_none());
        (0..200).for_each(|_| assert_eq!(plain.step().unwrap(), adapting.step().unwrap()));
        assert_eq!(plain.state(), adapting.state());
    }
    // One iteration is too few to learn from, so the move stays as configured.
    let mut short = begun(2);
    short.step().unwrap();
    assert!(short.scales().unwrap().are_frozen());
    assert_eq!(short.scales().unwrap().values(MoveId(0)), [None]);
}

/// Records are made by the moves at the frozen scales, which leave the target invariant.
#[test]
fn frozen_scales_leave_the_target_invariant() {
    for number in [GAUSSIAN, EXPONENTIAL, Number { narrow: 0.5, ..GAUSSIAN }] {
        let moves = walking(30.0);
        let mut chain = Chain::start(&number, &moves, Seed(3).chain(0)).unwrap().adapting(2000);
        for _ in 1..2000 {
            chain.step().unwrap();
        }
        let kernel = moves.at(chain.scales().unwrap());
        let mut twin =
            Chain::resume(&number, &kernel, Seed(3).chain(0), 1999, chain.state().clone(), vec![<_>::default()]);
        (0..100).for_each(|_| assert_eq!(twin.step().unwrap(), chain.step().unwrap()));
        assert_eq!(twin.state(), chain.state());
        let sd = (1.0 / (1.0 + 1.0 / math::square(number.narrow))).sqrt();
        let exact = |stream: &mut Stream| {
            let draw = if number.prior == Prior::Gaussian { sd * number.start(stream) } else { number.start(stream) };
            State::evaluate(&number, draw, &mut ())
        };
        let statistic = Statistic::new("x", |state: &State<f64, f64>| state.draw);
        let report = one_step(&number, &kernel, exact, &[statistic], OneStep { samples: 40_000, ..OneStep::default() });
        let report = report.unwrap();
        assert!(report.passed(), "{report}");
    }
}

/// Steps from an exact draw, by a walk whose scale begins at 1 and keeps adapting with this gain. At the end of the
/// exponential density half of the steps are refused. So the scale depends on where the chain is: short steps there,
/// long ones far out.
fn wandered(gain: f64, steps: u64, sample: u64) -> f64 {
    let streams = Seed(17).chain(sample);
    let draw = EXPONENTIAL.start(&mut streams.at(0, Purpose(100)));
    let mut state = State::evaluate(&EXPONENTIAL, draw, &mut ()).unwrap();
    let mut log = 0.0;
    for step in 0..steps {
        let moves = walking(math::exp(log));
        let mut chain = Chain::resume(&EXPONENTIAL, &moves, streams, step, state, vec![<_>::default()]);
        let accepted = chain.step().unwrap().decision == Decision::Accepted;
        log += gain * (f64::from(u8::from(accepted)) - Scale::ONE);
        state = chain.state().clone();
    }
    state.draw
}

/// Compared with the exact distribution function, by Dvoretzky, Kiefer and Wolfowitz with Massart's constant: P(D > ε)
/// ≤ 2 exp(−2 n ε²).
#[test]
fn adapting_for_ever_is_biased_and_caught() {
    const SAMPLES: u64 = 20_000;
    let distance = |gain: f64| {
        let mut ends: Vec<f64> = (0..SAMPLES).map(|sample| wandered(gain, 30, sample)).collect();
        ends.sort_by(f64::total_cmp);
        let n = SAMPLES as f64;
        let off = |(k, x): (usize, &f64)| {
            let exact = 1.0 - math::exp(-x);
            (exact - k as f64 / n).abs().max((exact - (k + 1) as f64 / n).abs())
        };
        ends.iter().enumerate().map(off).fold(0.0, f64::max)
    };
    let allowed = (math::ln(2e6) / (2.0 * SAMPLES as f64)).sqrt();
    let (still, adapting) = (distance(0.0), distance(0.5));
    println!("without gain {still:.4}, with a gain that stays {adapting:.4}, allowed {allowed:.4}");
    assert!(still <= allowed, "{still} above {allowed}");
    assert!(adapting > allowed, "not caught: {adapting} within {allowed}");
}

/// Keeps the last snapshots; stops after some rounds.
#[derive(Default)]
struct Last {
    snapshots: Vec<Snapshot<f64, f64>>,
    draws: Vec<Vec<f64>>,
    stop_after: Option<usize>,
}

impl Sink<f64, f64> for Last {
    type Error = std::convert::Infallible;
    fn block(&mut self, chain: u32, block: Block<f64, f64>, snapshot: &Snapshot<f64, f64>) -> Result<(), Self::Error> {
        let chain = chain as usize;
        if self.draws.len() <= chain {
            self.draws.push(Vec::new());
            self.snapshots.push(snapshot.clone());
        }
        self.snapshots[chain] = snapshot.clone();
        for entry in block.entries {
            self.draws[chain].extend(std::iter::repeat_n(entry.state.draw, entry.draws as usize));
        }
        Ok(())
    }
    fn round(&mut self, _: &Progress<'_>) -> Result<Control, Self::Error> {
        self.stop_after = self.stop_after.map(|left| left - 1);
        if self.stop_after == Some(0) {
            self.stop_after = None;
            return Ok(Control::Stop);
        }
        Ok(Control::Continue)
    }
}

const PLAN: Plan = Plan {
    seed: Seed(8),
    chains: 3,
    warmup: 400,
    iterations: 300,
    thin: 1,
    block: 64,
    solutions: None,
    rungs: 1,
    adapt_rungs: false,
    swap_every: 7,
    adapt: true,
    weigh: false,
    settle: false,
    climbs: 0,
    sampled: false,
};

/// Whatever the number of threads and the interruptions, and with replicas too. A longer run keeps the scales.
#[test]
fn adapted_runs_have_the_same_bits() {
    let number = Number { narrow: 0.05, ..GAUSSIAN };
    let moves = walking(3.0);
    for plan in [PLAN, Plan { rungs: 4, ..PLAN }] {
        let whole = |plan: Plan, threads: usize| {
            let mut last = Last::default();
            run(&number, &moves, plan, Vec::new(), threads, &mut last).unwrap();
            last
        };
        let (one, three) = (whole(plan, 1), whole(plan, 3));
        assert_eq!((&one.snapshots, &one.draws), (&three.snapshots, &three.draws));
        let sizes: Vec<f64> = one.snapshots.iter().map(|snapshot| size(snapshot.scales.as_ref())).collect();
        assert!(sizes[0] != sizes[1] && sizes.iter().all(|size| *size < 1.0), "{sizes:?}");
        assert!(whole(Plan { adapt: false, ..plan }, 1).draws != one.draws);

        let mut parts = Last { stop_after: Some(45), ..Last::default() };
        run(&number, &moves, plan, Vec::new(), 1, &mut parts).unwrap();
        let cut = parts.snapshots[0].scales.clone().unwrap();
        let end = parts.snapshots[0].end_iteration;
        assert!((64..400).contains(&end) && !cut.are_frozen(), "stopped while it adapts: {end}");
        let starts = |from: &Last| -> Vec<Start<f64, f64>> {
            from.snapshots.iter().map(|one| Start { snapshot: one.clone(), distinct: Distinct::default() }).collect()
        };
        run(&number, &moves, plan, starts(&parts), 2, &mut parts).unwrap();
        assert_eq!((&one.snapshots, &one.draws), (&parts.snapshots, &parts.draws));

        let longer = Plan { iterations: 900, ..plan };
        run(&number, &moves, longer, starts(&parts), 2, &mut parts).unwrap();
        assert_eq!(whole(longer, 1).draws, parts.draws);
        let kept: Vec<f64> = parts.snapshots.iter().map(|snapshot| size(snapshot.scales.as_ref())).collect();
        assert_eq!(kept, sizes);
    }
}

fn whole(number: &Number, moves: &Mixture<Number>, plan: Plan, threads: usize) -> Last {
    let mut last = Last::default();
    run(number, moves, plan, Vec::new(), threads, &mut last).unwrap();
    last
}

fn ends(last: &Last) -> Vec<u64> {
    last.snapshots.iter().map(|one| one.scales.as_ref().unwrap().until()).collect()
}

/// A warm-up ends at one of four times, each chain's at its own, and the chain then stands still until the longest time
/// is over. After that it is a chain with the frozen scale. A longest time does not change when it ends, as long as the
/// four times are the same. It does not end before half of it follows the first solution, or if steps are rarely
/// tried, unless other moves make nearly all iterations.
#[test]
fn a_warm_up_ends_when_its_scales_have_settled() {
    let (number, plan) = (Number { narrow: 0.05, ..GAUSSIAN }, Plan { warmup: 4096, settle: true, ..PLAN });
    let mixed = |share: f64| {
        let moves: [(f64, Box<dyn Move<Number>>); 2] =
            [(share, Box::new(Walk { size: 1e3, target: Scale::ONE })), (1.0 - share, Box::new(Redraw))];
        Mixture::new(moves.into()).unwrap()
    };
    let moves = walking(1e3);
    let last = whole(&number, &moves, plan, 1);
    for (until, (draws, snapshot)) in ends(&last).into_iter().zip(last.draws.iter().zip(&last.snapshots)) {
        assert!([256, 512, 1024, 2048].contains(&until), "{until}");
        let still = &draws[until as usize - 1..plan.warmup as usize];
        assert!(still.iter().all(|draw| *draw == still[0]), "it stands still");
        assert_eq!(draws.len() as u64, plan.end());
        assert_eq!(snapshot.counts[0].made(), plan.iterations + until - 1);
        // 2.4 standard deviations are best; the mean of half a warm-up has an error of about 0.2 in its logarithm.
        let size = size(snapshot.scales.as_ref()) / 0.05;
        assert!((1.0..6.0).contains(&size), "{size}");
        let kernel = moves.at(snapshot.scales.as_ref().unwrap());
        let start = State::evaluate(&number, still[0], &mut ()).unwrap();
        let chain = last.draws.iter().position(|other| other == draws).unwrap() as u64;
        let counts = vec![<_>::default()];
        let mut twin = Chain::resume(&number, &kernel, plan.seed.chain(chain), plan.warmup - 1, start, counts);
        for draw in &draws[plan.warmup as usize..] {
            twin.step().unwrap();
            assert_eq!(twin.state().draw, *draw);
        }
    }
    let all = |number: &Number, moves: &Mixture<Number>, plan: Plan| ends(&whole(number, moves, plan, 1));
    assert_eq!(all(&number, &moves, Plan { settle: false, ..plan }), [4096; 3]);
    assert_eq!(all(&Number { within: 0.0, ..number }, &moves, plan), [4096; 3], "no solution");
    // In 60 iterations only two halves have the 16 steps that tell anything.
    assert_eq!(all(&number, &moves, Plan { warmup: 60, ..plan }), [60; 3]);
    // Sixteen steps in each of two halves take 107 iterations at least, and about 213.
    let rarely = all(&number, &mixed(0.3), Plan { warmup: 256, ..plan });
    assert!(rarely.iter().all(|until| *until >= 128), "three in ten iterations: {rarely:?}");
    let hardly = all(&number, &mixed(0.02), Plan { warmup: 256, ..plan });
    assert!(hardly.iter().all(|until| *until < 128), "hardly ever: {hardly:?}");
}

/// Runs whose warm-up ends early have the same bits for any number of threads, blocks and interruptions: while scales
/// are adapted, while a chain stands still, and after that; with replicas, whose ladder settles too, and with learnt
/// weights.
#[test]
fn settled_runs_have_the_same_bits() {
    let number = Number { narrow: 0.05, ..GAUSSIAN };
    let kinds: [(f64, Box<dyn Move<Number>>); 2] =
        [(0.7, Box::new(Walk { size: 3.0, target: Scale::ONE })), (0.3, Box::new(Redraw))];
    let moves = Mixture::new(kinds.into()).unwrap();
    let base = Plan { warmup: 3000, settle: true, ..PLAN };
    for plan in
        [base, Plan { rungs: 4, ..base }, Plan { rungs: 2, adapt_rungs: true, ..base }, Plan { weigh: true, ..base }]
    {
        let one = whole(&number, &moves, plan, 1);
        let until = ends(&one);
        assert!(until.iter().any(|until| *until < 3000), "{until:?}");
        let other = whole(&number, &moves, Plan { block: 500, ..plan }, 3);
        assert_eq!((&one.snapshots, &one.draws), (&other.snapshots, &other.draws));
        let mut parts = Last::default();
        let (mut still, mut starts) = (false, Vec::new());
        for rounds in [20, 21, 10, 5, usize::MAX] {
            parts.stop_after = Some(rounds);
            run(&number, &moves, plan, starts, 2, &mut parts).unwrap();
            let end = parts.snapshots[0].end_iteration;
            still |= (until.iter().min().unwrap()..&3000).contains(&&end);
            let start = |one: &Snapshot<f64, f64>| Start { snapshot: one.clone(), distinct: Distinct::default() };
            starts = parts.snapshots.iter().map(start).collect();
        }
        assert!(still, "stopped while a chain stands still");
        assert_eq!((&one.snapshots, &one.draws), (&parts.snapshots, &parts.draws));
    }
}

/// Each rung has its own scale, although replicas wander: the colder the rung, the shorter the steps.
#[test]
fn every_rung_has_its_scale() {
    let number = Number { narrow: 0.05, ..GAUSSIAN };
    let (moves, fresh) = (walking(3.0), Mixture::of(Box::new(Redraw) as Box<dyn Move<Number>>));
    let tempering = plaus_mcmc::Tempering { rungs: 4, swap_every: 3, warmup: 4000, adapt_rungs: false };
    let course = plaus_mcmc::Course { target: &number, moves: &moves, fresh: &fresh, tempering };
    let mut replicas = Replicas::start(course, Seed(4), 0).unwrap().adapting(4000);
    replicas.advance(6000, |_, _| ()).unwrap();
    let snapshot = replicas.snapshot();
    assert!(replicas.climb().restarts() > 10 && snapshot.fits(4, 1));
    assert!(snapshot.scales[0].is_none(), "the first rung draws anew");
    let sizes: Vec<f64> = snapshot.scales[1..].iter().map(|scales| size(scales.as_ref())).collect();
    assert!(sizes.windows(2).all(|pair| pair[0] > pair[1]), "{sizes:?}");
}
