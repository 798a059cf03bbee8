//! Runs: the same bits whatever the threads, blocks and interruptions; solutions, hits, thinning.

// Helpers outside of `#[test]` functions panic as tests do.

use crate::toys::balls::{Balls, Drops};
use crate::toys::balls_moves::{ChangeAll, Fault, Redrop, Toggle};
use crate::toys::halting::Halting;
use plaus_dist::{LogRatio, Seed, Stream};
use plaus_mcmc::view::lend;
use plaus_mcmc::{
    At, Block, Chain, ChainPulse, Control, Decision, Distinct, Ending, Entry, FirstOfClass, Goal, Hits, Mixture,
    ModelError, Move, Plan, PlanError, Progress, Proposal, Pulse, RunError, Sink, Snapshot, Start, StateOf, Transition,
    run, run_watched,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

type Loads = Vec<u32>;

const PLAN: Plan = Plan {
    seed: Seed(21),
    chains: 3,
    warmup: 100,
    iterations: 900,
    thin: 1,
    block: 64,
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

/// The same, each chain with replicas at four rungs.
const TEMPERED: Plan = Plan { rungs: 4, swap_every: 7, ..PLAN };

/// Keeps everything, and stops the run after a given number of rounds.
#[derive(Default, PartialEq, Debug, Clone)]
struct Log {
    blocks: Vec<Vec<Block<Drops, Loads>>>,
    snapshots: Vec<Vec<Snapshot<Drops, Loads>>>,
    firsts: Vec<FirstOfClass>,
    ends: Vec<u64>,
    stop_after: Option<usize>,
}

impl Sink<Drops, Loads> for Log {
    type Error = String;
    fn block(
        &mut self,
        chain: u32,
        block: Block<Drops, Loads>,
        snapshot: &Snapshot<Drops, Loads>,
    ) -> Result<(), String> {
        let chain = chain as usize;
        self.blocks.resize(self.blocks.len().max(chain + 1), Vec::new());
        self.snapshots.resize(self.snapshots.len().max(chain + 1), Vec::new());
        self.blocks[chain].push(block);
        self.snapshots[chain].push(snapshot.clone());
        Ok(())
    }
    fn round(&mut self, progress: &Progress<'_>) -> Result<Control, String> {
        self.ends.push(progress.end_iteration);
        self.firsts = progress.distinct.firsts().to_vec();
        for (snapshots, (counts, hits)) in self.snapshots.iter().zip(&progress.chains) {
            let last = snapshots.last().unwrap();
            assert_eq!((last.counts.as_slice(), &last.hits), (*counts, hits));
        }
        Ok(if Some(self.ends.len()) == self.stop_after { Control::Stop } else { Control::Continue })
    }
}

impl Log {
    /// The records, without their division into blocks: each draw's iteration and state, and how many proposals were
    /// accepted on the way to it.
    fn draws(&self, chain: usize, thin: u64) -> Vec<(u64, StateOf<Balls>, u32)> {
        let mut draws = Vec::new();
        for block in &self.blocks[chain] {
            assert_eq!(draws.len() as u64, block.first_iteration.div_ceil(thin), "blocks follow each other");
            for Entry { draws: times, accepted, by, class, state } in &block.entries {
                // A state that a swap brought was made by no move.
                assert!(*times > 0 && (by.is_none() || *accepted > 0));
                assert_eq!(*class, balls().class(state.by_ref()));
                for repeat in 0..*times {
                    let accepted = if repeat == 0 { *accepted } else { 0 };
                    draws.push((draws.len() as u64 * thin, state.clone(), accepted));
                }
            }
            assert_eq!(draws.len() as u64, block.end_iteration.div_ceil(thin));
        }
        draws
    }

    fn all_draws(&self, thin: u64) -> Vec<Vec<(u64, StateOf<Balls>, u32)>> {
        (0..self.blocks.len()).map(|chain| self.draws(chain, thin)).collect()
    }

    /// The starts from which the run can continue, as a reader of its records finds them.
    fn starts(&self, plan: Plan) -> Vec<Start<Drops, Loads>> {
        let start = |chain: usize| {
            let mut distinct = Distinct::default();
            for (iteration, state, _) in self.draws(chain, plan.thin) {
                if let Some(class) = balls().class(state.by_ref()).filter(|_| iteration >= plan.counts_from()) {
                    distinct.note(FirstOfClass { iteration, chain: chain as u32, class });
                }
            }
            Start { snapshot: self.snapshots[chain].last().unwrap().clone(), distinct }
        };
        (0..self.blocks.len()).map(start).collect()
    }
}

fn balls() -> Balls {
    Balls::anywhere(6, 4, 1.0, 2.0)
}

fn mixture() -> Mixture<Balls> {
    let moves: Vec<(f64, Box<dyn Move<Balls>>)> = vec![
        (0.5, Box::new(Toggle::RIGHT)),
        (0.2, Box::new(ChangeAll { symmetric: false })),
        (0.3, Box::new(Redrop { fault: Fault::None })),
    ];
    Mixture::new(moves).unwrap()
}

fn go(plan: Plan, starts: Vec<Start<Drops, Loads>>, threads: usize, mut log: Log) -> (Ending, Log) {
    let ending = run(&balls(), &mixture(), plan, starts, threads, &mut log).unwrap();
    log.stop_after = None;
    (ending, log)
}

fn whole(plan: Plan, threads: usize) -> (Ending, Log) {
    go(plan, Vec::new(), threads, Log::default())
}

#[test]
fn the_number_of_threads_changes_nothing() {
    for plan in [PLAN, TEMPERED] {
        let one = whole(plan, 1);
        assert_eq!(one.0, Ending::Complete);
        for threads in [2, 4, 0] {
            assert!(one == whole(plan, threads), "{threads} threads");
        }
        assert_ne!(one.1.draws(0, 1), one.1.draws(1, 1), "chains differ from each other");
        assert!(one != whole(Plan { seed: Seed(22), ..plan }, 1), "seeds differ");
    }
    let climbs: Vec<_> = whole(TEMPERED, 2).1.snapshots.into_iter().filter_map(|mut of| of.pop()?.replicas).collect();
    assert!(climbs.len() == 3 && climbs.iter().all(|one| one.climb().restarts() > 0), "replicas climb");
}

#[test]
fn a_run_resumed_at_any_block_is_the_whole_run() {
    // Blocks that are no multiple of any thinning, so that acceptances are pending at the interruption.
    for plan in [
        Plan { block: 50, ..PLAN },
        Plan { block: 97, thin: 7, ..PLAN },
        Plan { block: 3, thin: 8, iterations: 100, ..PLAN },
        Plan { block: 35, ..TEMPERED },
        Plan { block: 23, thin: 5, ..TEMPERED },
    ] {
        let (ending, all) = whole(plan, 2);
        for rounds in 1..all.ends.len() {
            let (stopped, part) = go(plan, Vec::new(), 1, Log { stop_after: Some(rounds), ..Log::default() });
            assert_eq!(stopped, Ending::Stopped);
            assert_eq!(part.ends, all.ends[..rounds]);
            let starts = part.starts(plan);
            let (again, both) = go(plan, starts, 2, part);
            assert!((again, &both) == (ending, &all), "stopped after {rounds} rounds of {plan:?}");
        }
    }
}

/// A move that stops the run when it is made for the n-th time, in the middle of a block.
struct Interrupt {
    left: AtomicU64,
    pulse: Arc<Pulse>,
}

impl Move<Balls> for Interrupt {
    fn name(&self) -> &str {
        Toggle::RIGHT.name()
    }
    fn propose(&self, at: At<'_, Balls>, drops: &mut Drops, stream: &mut Stream) -> Result<Proposal, ModelError> {
        if self.left.fetch_sub(1, Relaxed) == 1 {
            self.pulse.stop();
        }
        Toggle::RIGHT.propose(at, drops, stream)
    }
    fn log_ratio(&self, step: Transition<'_, Balls>) -> Result<LogRatio, ModelError> {
        Toggle::RIGHT.log_ratio(step)
    }
}

#[test]
fn a_run_stopped_in_the_middle_of_a_block_leaves_the_beginning_of_the_whole_run() {
    let moves =
        |pulse: &Arc<Pulse>, left: u64| Mixture::of(Box::new(Interrupt { left: left.into(), pulse: pulse.clone() }));
    for plan in [PLAN, Plan { thin: 7, ..TEMPERED }, Plan { solutions: Some(40), ..PLAN }, TEMPERED] {
        let go = |starts: Vec<Start<Drops, Loads>>, threads: usize, left: u64, mut log: Log| {
            let pulse = Arc::<Pulse>::default();
            let ended = run_watched(&balls(), &moves(&pulse, left), plan, starts, threads, &mut log, &pulse);
            (ended.unwrap(), log, pulse)
        };
        let (ending, all, pulse) = go(Vec::new(), 2, u64::MAX, Log::default());
        // At the end the counters show what was recorded.
        let last = all.snapshots.iter().map(|of| of.last().unwrap());
        let shown = last.map(|of| ChainPulse { iterations: of.end_iteration, hits: of.hits.count });
        assert_eq!(pulse.chains(), shown.collect::<Vec<_>>());
        assert_eq!(pulse.distinct(), all.firsts.len() as u64);
        for (left, threads) in [(1, 1), (30, 1), (200, 2), (1_100, 1), (1_101, 4), (1_500, 3)] {
            let (stopped, part, _) = go(Vec::new(), threads, left, Log::default());
            if stopped != Ending::Stopped {
                assert!(plan.solutions.is_some() && (stopped, &part) == (ending, &all), "{left} moves were enough");
                continue;
            }
            let rounds = part.ends.len();
            assert!(
                rounds > 0 && part.ends == all.ends[..rounds] && rounds < all.ends.len(),
                "{left}: {:?}",
                part.ends
            );
            let (again, both, _) = go(part.starts(plan), 2, u64::MAX, part);
            assert!((again, &both) == (ending, &all), "stopped after {left} moves of {plan:?}");
        }
    }
}

#[test]
fn a_run_stopped_in_the_middle_of_a_simulation_leaves_the_beginning_of_the_whole_run() {
    for plan in [Plan { block: 5, iterations: 60, warmup: 0, ..PLAN }, Plan { block: 8, iterations: 40, ..TEMPERED }] {
        let (ending, all) = whole(plan, 2);
        let is_beginning = |left: u64, threads: usize, quiet: bool| {
            let (pulse, mut part) = (Arc::<Pulse>::default(), Log::default());
            let target = Halting { balls: balls(), left: left.into(), pulse: Arc::clone(&pulse), quiet };
            let moves = lend::<Halting>(mixture()).unwrap();
            let ended = run_watched(&target, &moves, plan, Vec::new(), threads, &mut part, &pulse).unwrap();
            if ended != Ending::Stopped || part.ends[..] != all.ends[..part.ends.len()] {
                return false;
            }
            let starts = part.starts(plan);
            go(plan, starts, 1, part) == (ending, all.clone())
        };
        // The first simulations are those of the starts. Chains that begin at once may end up in other blocks.
        let late = 2 * u64::from(plan.chains * plan.rungs);
        for left in (1..40).chain([60, 90]) {
            assert!(is_beginning(left, 1 + left as usize % 3, false), "interrupted in simulation {left} of {plan:?}");
        }
        assert!((late..late + 40).any(|left| !is_beginning(left, 1, true)), "the twin is caught");
    }
}

/// Starting a chain takes time too: a request to stop a run of many chains does not wait until all have started.
#[test]
fn a_run_stopped_while_its_chains_start_leaves_nothing() {
    for plan in [PLAN, TEMPERED] {
        let (pulse, mut log) = (Pulse::default(), Log::default());
        pulse.stop();
        let ended = run_watched(&balls(), &mixture(), plan, Vec::new(), 2, &mut log, &pulse);
        assert_eq!(ended.unwrap(), Ending::Stopped);
        assert!(log == Log::default(), "something was recorded");
    }
}

/// What a run that stops at `wanted` solutions must leave, taken from a run that does not stop; solutions of the
/// warm-up count.
fn first_iteration_with(wanted: u64, all: &Log, thin: u64) -> Option<u64> {
    let mut classes = Vec::new();
    let mut recorded: Vec<_> = all.all_draws(thin).into_iter().flatten().collect();
    recorded.sort_by_key(|(iteration, ..)| *iteration);
    recorded.into_iter().find_map(|(iteration, state, _)| {
        classes.extend(balls().class(state.by_ref()).filter(|class| !classes.contains(class)));
        (classes.len() as u64 >= wanted).then_some(iteration)
    })
}

#[test]
fn enough_solutions_end_a_run_at_one_iteration_whatever_the_blocks_and_threads() {
    for (thin, base) in [(1, PLAN), (5, PLAN), (2, TEMPERED)] {
        let (_, all) = whole(Plan { thin, ..base }, 1);
        for wanted in [1, 2, 7, 40] {
            let last = first_iteration_with(wanted, &all, thin).unwrap();
            let expected: Vec<Vec<_>> = all
                .all_draws(thin)
                .into_iter()
                .map(|draws| draws.into_iter().filter(|(iteration, ..)| *iteration <= last).collect())
                .collect();
            for (block, threads) in [(1, 1), (7, 2), (64, 4), (10_000, 2)] {
                let plan = Plan { thin, block, solutions: Some(wanted), ..base };
                let (ending, log) = whole(plan, threads);
                assert_eq!(ending, Ending::EnoughSolutions);
                assert_eq!(log.ends.last(), Some(&(last + 1)), "{plan:?}");
                assert!(log.all_draws(thin) == expected, "{plan:?}");
                assert!(log.firsts.len() as u64 >= wanted && log.firsts.iter().all(|first| first.iteration <= last));

                // It can be continued for more solutions, and is then the same as a run that wanted more from the
                // start.
                let more = Plan { solutions: Some(wanted + 10), ..plan };
                let (ending, longer) = go(more, log.starts(more), threads, log);
                let (direct_ending, direct) = whole(more, 1);
                assert_eq!((ending, longer.ends.last()), (direct_ending, direct.ends.last()));
                assert!(longer.all_draws(thin) == direct.all_draws(thin), "{more:?}");
                assert_eq!(longer.firsts, direct.firsts);
            }
        }
    }
}

#[test]
fn a_run_may_want_no_solutions_or_too_many() {
    let (ending, log) = whole(Plan { solutions: Some(0), ..PLAN }, 1);
    assert_eq!((ending, log.ends.len()), (Ending::EnoughSolutions, 0));
    let (ending, log) = whole(Plan { solutions: Some(1_000_000), ..PLAN }, 1);
    assert_eq!((ending, log.ends.last()), (Ending::Complete, Some(&PLAN.end())));
}

/// A run that looks for solutions counts them from its start on; any other run counts only those of the sampling phase.
#[test]
fn a_run_that_looks_for_solutions_counts_them_from_its_start() {
    let (_, plain) = whole(PLAN, 2);
    assert!(plain.firsts.iter().all(|first| first.iteration >= PLAN.warmup), "{:?}", plain.firsts);
    let (ending, hunting) = whole(Plan { solutions: Some(2), ..PLAN }, 2);
    assert_eq!(ending, Ending::EnoughSolutions);
    assert!(hunting.ends.last().is_some_and(|&end| end <= PLAN.warmup), "{:?}", hunting.ends);
}

/// Hits, counts and thinned records, compared with a chain that is advanced by hand.
#[test]
fn bookkeeping_agrees_with_a_chain_stepped_by_hand() {
    for thin in [1, 2, 7, 100] {
        let (_, log) = whole(Plan { thin, ..PLAN }, 2);
        for index in 0..PLAN.chains {
            let (world, moves) = (balls(), mixture());
            let mut chain = Chain::start(&world, &moves, PLAN.seed.chain(u64::from(index))).unwrap();
            let (mut hits, mut accepted, mut last_by) = (Hits::default(), 0, None);
            let mut draws = vec![(0, chain.state().clone(), 0)];
            let mut bys = vec![None];
            for iteration in 0..PLAN.end() {
                if iteration > 0 {
                    let step = chain.step().unwrap();
                    if step.decision == Decision::Accepted {
                        accepted += 1;
                        last_by = Some(step.move_id);
                    }
                    if iteration % thin == 0 {
                        draws.push((iteration, chain.state().clone(), std::mem::take(&mut accepted)));
                        bys.extend(last_by.take().map(Some));
                    }
                }
                if world.class(chain.state().by_ref()).is_some() {
                    hits.count += 1;
                    hits.first = hits.first.or(Some(iteration));
                }
            }
            assert_eq!(draws.len() as u64, PLAN.end().div_ceil(thin));
            assert!(log.draws(index as usize, thin) == draws, "thin {thin}, chain {index}");
            let entries = log.blocks[index as usize].iter().flat_map(|block| &block.entries);
            let recorded: Vec<_> = entries.filter_map(|entry| entry.by).map(Some).collect();
            assert_eq!(recorded, bys[1..]);
            let snapshot = log.snapshots[index as usize].last().unwrap();
            assert_eq!((snapshot.hits, &*snapshot.counts), (hits, chain.counts()));
            assert_eq!(snapshot.end_iteration, PLAN.end());
            let made: u64 = snapshot.counts.iter().map(plaus_mcmc::MoveCounts::made).sum();
            assert_eq!(made, PLAN.end() - 1, "iteration 0 is the start");
        }
    }
}

#[test]
fn the_first_hit_is_known_even_if_it_is_not_recorded() {
    let (_, log) = whole(Plan { thin: 1000, ..PLAN }, 1);
    for snapshots in &log.snapshots {
        let hits = snapshots.last().unwrap().hits;
        assert!(hits.first.is_some_and(|first| first > 0) && hits.count > 0, "{hits:?}");
    }
    assert_eq!(log.draws(0, 1000).len(), 1);
}

#[test]
fn a_failing_sink_stops_the_run() {
    struct Full;
    impl Sink<Drops, Loads> for Full {
        type Error = String;
        fn block(&mut self, chain: u32, _: Block<Drops, Loads>, _: &Snapshot<Drops, Loads>) -> Result<(), String> {
            if chain == 1 { Err("disk full".to_owned()) } else { Ok(()) }
        }
        fn round(&mut self, _: &Progress<'_>) -> Result<Control, String> {
            Ok(Control::Continue)
        }
    }
    let error = run(&balls(), &mixture(), PLAN, Vec::new(), 1, &mut Full).unwrap_err();
    assert!(matches!(&error, RunError::Sink(text) if text == "disk full"), "{error:?}");
}

#[test]
fn a_plan_or_starts_that_make_no_run_are_refused() {
    let refused = |plan: Plan, starts| match run(&balls(), &mixture(), plan, starts, 1, &mut Log::default()) {
        Err(RunError::Plan(error)) => error,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(Plan { chains: 0, ..PLAN }, Vec::new()), PlanError::Zero("chains"));
    assert_eq!(refused(Plan { thin: 0, ..PLAN }, Vec::new()), PlanError::Zero("thin"));
    assert_eq!(refused(Plan { block: 0, ..PLAN }, Vec::new()), PlanError::Zero("block"));
    let endless = Plan { iterations: u64::MAX, ..PLAN };
    assert_eq!(refused(endless, Vec::new()), PlanError::TooLong(u64::MAX));
    let (_, log) = go(PLAN, Vec::new(), 1, Log { stop_after: Some(1), ..Log::default() });
    let mut starts = log.starts(PLAN);
    starts.pop();
    assert_eq!(refused(PLAN, starts), PlanError::Starts { chains: 3, found: 2 });
    let mut starts = log.starts(PLAN);
    starts[1].snapshot.end_iteration += 1;
    assert_eq!(refused(PLAN, starts), PlanError::Starts { chains: 3, found: 3 });
}
