//! Parallel tempering samples every rung exactly, and crosses gaps that the target's own moves cannot.

use crate::toys::ring::{Redraw, Ring, Walk};
use plaus_dist::{Seed, math};
use plaus_mcmc::{Course, Ladder, Mixture, Replicas, Tempering, diagnose};

/// Moves of all rungs but the first, and of the first.
struct Moves(Mixture<Ring>, Mixture<Ring>);

impl Moves {
    fn new() -> Self {
        Self(Mixture::of(Box::new(Walk)), Mixture::of(Box::new(Redraw { symmetric: false })))
    }

    /// Nine places in two arcs with forbidden places between them: steps never lead from one arc to the other.
    fn course<'a>(&'a self, ring: &'a Ring, rungs: u32, swap_every: u64, warmup: u64) -> Course<'a, Ring> {
        let tempering = Tempering { rungs, swap_every, warmup, adapt_rungs: false };
        Course { target: ring, moves: &self.0, fresh: &self.1, tempering }
    }
}

/// Advances by this many iterations.
fn go_on(replicas: &mut Replicas<'_, Ring>, iterations: u64) {
    replicas.advance(replicas.iteration() + iterations, |_, _| ()).unwrap();
}

/// The law of a rung.
fn law(ring: &Ring, beta: f64) -> Vec<f64> {
    let weight = |place: usize| {
        let wish = f64::from(u8::from(place.is_multiple_of(2)));
        ring.probability(place) * math::exp(beta * ring.goal.ln_lambda() * wish)
    };
    let total: f64 = ring.all().into_iter().map(weight).sum();
    ring.all().into_iter().map(|place| weight(place) / total).collect()
}

#[test]
fn every_rung_has_its_law() {
    let (ring, moves) = (Ring::of_nine(4.0), Moves::new());
    // Without a warm-up the ladder is even, and stays so.
    let course = moves.course(&ring, 4, 2, 0);
    let ladder = Ladder::even(4);
    let mut seen = vec![vec![Vec::new(); 4]; 4];
    for repeat in 0..4 {
        let mut replicas = Replicas::start(course, Seed(repeat), 0).unwrap();
        go_on(&mut replicas, 200);
        for _ in 0..30_000 {
            go_on(&mut replicas, 2);
            for (rung, seen) in seen.iter_mut().enumerate() {
                seen[repeat as usize].push(replicas.rung(rung).unwrap().draw);
            }
        }
        let climb = replicas.climb();
        assert_eq!(climb.ladder(), &ladder);
        assert!(climb.restarts() > 1000 && climb.round_trips() > 1000, "{}", climb.restarts());
    }
    for (rung, chains) in seen.iter().enumerate() {
        for (place, expected) in law(&ring, ladder.betas()[rung]).into_iter().enumerate() {
            let at = |chain: &Vec<usize>| chain.iter().map(|&seen| f64::from(u8::from(seen == place))).collect();
            let columns: Vec<Vec<f64>> = chains.iter().map(at).collect();
            if expected == 0.0 {
                assert!(columns.iter().flatten().all(|&at| at == 0.0));
                continue;
            }
            let summary = diagnose::summarize(&columns).unwrap();
            // 28 comparisons at 5.5 standard errors: a false-alarm rate of 1e-6 altogether.
            let z = (summary.mean - expected) / summary.mcse_mean;
            assert!(
                z.abs() < 5.5,
                "rung {rung}, place {place}: {} ± {}, not {expected}",
                summary.mean,
                summary.mcse_mean
            );
            assert!(summary.mcse_mean < 0.02, "± {} proves nothing", summary.mcse_mean);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_states_on_any_number_of_threads() {
    let (ring, moves) = (Ring::of_nine(4.0), Moves::new());
    let walk = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut replicas = Replicas::start(moves.course(&ring, 5, 3, 600), Seed(3), 10).unwrap();
            let states = (0..500).map(|_| {
                go_on(&mut replicas, 3);
                replicas.snapshot()
            });
            states.collect::<Vec<_>>()
        })
    };
    assert!(walk(1) == walk(3));
}

#[test]
fn replicas_go_on_from_any_iteration_as_if_never_stopped() {
    let (ring, moves) = (Ring::of_nine(4.0), Moves::new());
    let course = moves.course(&ring, 5, 4, 300);
    let mut whole = Replicas::start(course, Seed(5), 2).unwrap();
    let mut parted = Replicas::start(course, Seed(5), 2).unwrap();
    for stretch in (1..60).cycle().take(100) {
        go_on(&mut whole, stretch);
        go_on(&mut parted, stretch);
        let snapshot = parted.snapshot();
        assert!(snapshot.fits(5, 1) && !snapshot.fits(4, 1) && !snapshot.fits(5, 2));
        parted = Replicas::resume(course, Seed(5), 2, parted.iteration(), snapshot);
        assert!(parted.snapshot() == whole.snapshot(), "after iteration {}", whole.iteration());
    }
    assert!(whole.climb().restarts() > 0);
}

#[test]
fn adaptation_in_the_warm_up_evens_out_rejections() {
    let (ring, moves) = (Ring::of_nine(12.0), Moves::new());
    let rejected = |warmup: u64| {
        let mut replicas = Replicas::start(moves.course(&ring, 6, 3, warmup), Seed(8), 0).unwrap();
        go_on(&mut replicas, warmup + 60_000);
        replicas.climb().rejected()
    };
    let spread = |shares: &[f64]| {
        let most = shares.iter().copied().fold(0.0, f64::max);
        most - shares.iter().copied().fold(1.0, f64::min)
    };
    let (before, after) = (rejected(0), rejected(20_000));
    assert!(spread(&after) < 0.5 * spread(&before), "{before:?} became {after:?}");
    // The barrier is a property of the target, not of the ladder.
    assert!((Ladder::barrier(&after) - Ladder::barrier(&before)).abs() < 0.5, "{before:?} {after:?}");
}

/// A ladder of `rungs` rungs that sizes itself in 6,000 iterations.
fn sizing<'a>(moves: &'a Moves, ring: &'a Ring, rungs: u32) -> Course<'a, Ring> {
    let course = moves.course(ring, rungs, 3, 6_000);
    Course { tempering: Tempering { adapt_rungs: true, ..course.tempering }, ..course }
}

#[test]
fn a_ladder_sizes_itself_whatever_it_begins_with() {
    let (ring, moves) = (Ring::of_nine(12.0), Moves::new());
    for rungs in [2, 5, 30] {
        let mut replicas = Replicas::start(sizing(&moves, &ring, rungs), Seed(4), 0).unwrap();
        go_on(&mut replicas, 6_000);
        let size = replicas.climb().ladder().betas().len();
        go_on(&mut replicas, 60_000);
        let climb = replicas.climb();
        assert_eq!(climb.ladder().betas().len(), size, "the ladder changed after the warm-up");
        // The barrier, a sum of rejected shares, is known to within 0.5 (see the test above), so the size is known to
        // within 1.
        let best = Ladder::best_rungs(Ladder::barrier(&climb.rejected()));
        assert!(size.abs_diff(best) <= 1, "{rungs} rungs became {size}, and {best} are best");
        assert!(climb.restarts() > 1000, "{rungs}: {} restarts", climb.restarts());
    }
}

#[test]
fn a_ladder_that_sized_itself_samples_the_target() {
    let (ring, moves) = (Ring::of_nine(4.0), Moves::new());
    let chain = |seed| {
        let mut replicas = Replicas::start(sizing(&moves, &ring, 9), Seed(seed), 0).unwrap();
        go_on(&mut replicas, 6_000);
        let mut seen = Vec::new();
        for _ in 0..30_000 {
            go_on(&mut replicas, 2);
            seen.push(replicas.top().state().draw);
        }
        seen
    };
    let seen: Vec<Vec<usize>> = (20..24).map(chain).collect();
    let worst = |beta: f64| {
        let z = |(place, expected): (usize, f64)| {
            let at = |chain: &Vec<usize>| chain.iter().map(|&seen| f64::from(u8::from(seen == place))).collect();
            let columns: Vec<Vec<f64>> = seen.iter().map(at).collect();
            if expected == 0.0 {
                return if columns.iter().flatten().all(|&at| at == 0.0) { 0.0 } else { f64::INFINITY };
            }
            let summary = diagnose::summarize(&columns).unwrap();
            ((summary.mean - expected) / summary.mcse_mean).abs()
        };
        law(&ring, beta).into_iter().enumerate().map(z).fold(0.0, f64::max)
    };
    // Nine comparisons at 5.4 standard errors: a false-alarm rate of 1e-6 altogether. The law of the rung below is told
    // apart.
    assert!(worst(1.0) < 5.4, "{}", worst(1.0));
    assert!(worst(0.8) > 5.4, "{}", worst(0.8));
}

#[test]
fn a_ladder_sizes_itself_alike_whatever_the_interruptions_and_threads() {
    let (ring, moves) = (Ring::of_nine(12.0), Moves::new());
    let course = sizing(&moves, &ring, 3);
    let mut whole = Replicas::start(course, Seed(7), 0).unwrap();
    let mut parted = Replicas::start(course, Seed(7), 0).unwrap();
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for stretch in (1..90).cycle().take(180) {
        go_on(&mut whole, stretch);
        alone.install(|| go_on(&mut parted, stretch));
        let snapshot = parted.snapshot();
        let rungs = snapshot.climb().ladder().betas().len() as u32;
        assert!(snapshot.fits(rungs, 1) && !snapshot.fits(rungs + 1, 1));
        parted = Replicas::resume(course, Seed(7), 0, parted.iteration(), snapshot);
        assert!(parted.snapshot() == whole.snapshot(), "after iteration {}", whole.iteration());
    }
    assert!(whole.iteration() > 6_000 && whole.climb().ladder().betas().len() != 3);
}
