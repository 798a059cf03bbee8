//! Parallel tempering samples every rung exactly, and crosses what the target's own moves cannot.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod toys;

use plaus_dist::{Seed, math};
use plaus_mcmc::view::lend;
use plaus_mcmc::{Ladder, Mixture, Replicas, Tempered, diagnose};
use toys::ring::{Redraw, Ring, Walk};

type Rung<'a> = Tempered<'a, Ring>;

/// Nine places in two arcs with forbidden places between them: steps never lead from one arc to the other.
fn rungs<'a>(ring: &'a Ring, ladder: &Ladder) -> (Vec<Rung<'a>>, Vec<Mixture<Rung<'a>>>) {
    let rungs = ladder.betas().iter().map(|&beta| Tempered::new(ring, beta).unwrap()).collect();
    let moves = ladder.betas().iter().map(|&beta| {
        let mixture =
            if beta == 0.0 { Mixture::of(Box::new(Redraw { symmetric: false })) } else { Mixture::of(Box::new(Walk)) };
        lend::<Rung<'a>>(mixture).unwrap()
    });
    (rungs, moves.collect())
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
    let ring = Ring::of_nine(4.0);
    let ladder = Ladder::new(vec![0.0, 0.2, 0.5, 1.0]).unwrap();
    let (rungs, moves) = rungs(&ring, &ladder);
    let mut seen = vec![vec![Vec::new(); 4]; rungs.len()];
    for repeat in 0..4 {
        let mut replicas = Replicas::start(&rungs, &moves, Seed(repeat), 0).unwrap();
        for round in 0..30_000 {
            replicas.round(2).unwrap();
            if round >= 100 {
                for (rung, seen) in seen.iter_mut().enumerate() {
                    seen[repeat as usize].push(replicas.rung(rung).unwrap().draw);
                }
            }
        }
        assert!(replicas.restarts() > 1000 && replicas.round_trips() > 1000, "{}", replicas.restarts());
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
            // 28 comparisons at 5 standard errors: 2e-5 altogether.
            let z = (summary.mean - expected) / summary.mcse_mean;
            assert!(
                z.abs() < 5.0,
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
    let ring = Ring::of_nine(4.0);
    let (rungs, moves) = rungs(&ring, &Ladder::even(5));
    let walk = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut replicas = Replicas::start(&rungs, &moves, Seed(3), 10).unwrap();
            let states = (0..500).map(|_| {
                replicas.round(3).unwrap();
                (0..5).map(|rung| replicas.rung(rung).unwrap().clone()).collect::<Vec<_>>()
            });
            states.collect::<Vec<_>>()
        })
    };
    assert!(walk(1) == walk(3));
}

#[test]
fn adaptation_evens_out_rejections() {
    let ring = Ring::of_nine(12.0);
    let rejected = |ladder: &Ladder| {
        let (rungs, moves) = rungs(&ring, ladder);
        let mut replicas = Replicas::start(&rungs, &moves, Seed(8), 0).unwrap();
        (0..20_000).for_each(|_| replicas.round(3).unwrap());
        replicas.rejected()
    };
    let spread = |shares: &[f64]| {
        let most = shares.iter().copied().fold(0.0, f64::max);
        most - shares.iter().copied().fold(1.0, f64::min)
    };
    let mut ladder = Ladder::even(6);
    let before = rejected(&ladder);
    for _ in 0..4 {
        ladder = ladder.adapted(&rejected(&ladder), 6);
    }
    let after = rejected(&ladder);
    assert!(spread(&after) < 0.5 * spread(&before), "{before:?} became {after:?} at {ladder:?}");
    // The barrier belongs to the target, not to the ladder.
    assert!((Ladder::barrier(&after) - Ladder::barrier(&before)).abs() < 0.5, "{before:?} {after:?}");
}

#[test]
fn no_rungs_no_replicas() {
    let nothing: (Vec<Rung>, Vec<Mixture<Rung>>) = (Vec::new(), Vec::new());
    assert!(Replicas::start(&nothing.0, &nothing.1, Seed(1), 0).is_err());
}
