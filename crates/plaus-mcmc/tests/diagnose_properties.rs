//! Properties of the diagnostics: invariances, hostile input, and chains whose autocorrelation time is known exactly.

use plaus_dist::{Purpose, Seed, Stream, math, open_unit};
use plaus_mcmc::diagnose::{self, DiagnoseError, Summary};
use proptest::prelude::*;

/// 2 to 5 chains of 4 to 60 draws; whole numbers, many of them equal.
fn whole_chains() -> impl Strategy<Value = Vec<Vec<f64>>> {
    (2_usize..6, 4_usize..61).prop_flat_map(|(chains, draws)| {
        let draw = (-20_i32..=20).prop_map(f64::from);
        proptest::collection::vec(proptest::collection::vec(draw, draws), chains)
    })
}

fn map(chains: &[Vec<f64>], f: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
    chains.iter().map(|chain| chain.iter().map(|&x| f(x)).collect()).collect()
}

fn numbers(row: &Summary) -> [f64; 6] {
    [row.rhat.unwrap_or(-1.0), row.ess_bulk, row.ess_tail, row.ess_mean, row.mcse_mean, row.mcse_sd]
}

proptest! {
    // A failing case belongs in a test of its own, not in a file beside this one.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Ranks do not change under a monotone transformation, so exactly the same bits come out.
    #[test]
    fn the_bulk_is_invariant_under_monotone_transformations(chains in whole_chains()) {
        let bulk = diagnose::ess_bulk(&chains);
        prop_assert_eq!(bulk, diagnose::ess_bulk(&map(&chains, |x| x * x * x)));
        prop_assert_eq!(bulk, diagnose::ess_bulk(&map(&chains, |x| math::exp(10.0 * x))));
        prop_assert_eq!(bulk, diagnose::ess_bulk(&map(&chains, |x| math::atan(x) * 1e-300)));
    }

    /// Ranks and distances from the median depend neither on the unit nor on the sign.
    #[test]
    fn rhat_is_invariant_under_change_of_unit(chains in whole_chains()) {
        let rhat = diagnose::rhat(&chains);
        prop_assert_eq!(rhat, diagnose::rhat(&map(&chains, |x| x * -0.125)));
        prop_assert_eq!(rhat, diagnose::rhat(&map(&chains, |x| x + 4096.0)));
    }

    /// The order of the chains does not matter, to the last bit.
    #[test]
    fn chains_have_no_order(chains in whole_chains(), turn in 0_usize..5, other in 0_usize..5) {
        let mut turned = chains.clone();
        let count = turned.len();
        turned.rotate_left(turn % count);
        turned.swap(0, other % count);
        prop_assert_eq!(diagnose::summarize(&chains), diagnose::summarize(&turned));
        let time = diagnose::integrated_autocorrelation_time;
        prop_assert_eq!(time(&chains), time(&turned));
    }

    /// Bounds that hold for any draws.
    #[test]
    fn ranges_are_kept(chains in whole_chains()) {
        let row = diagnose::summarize(&chains).map_err(|error| TestCaseError::fail(error.to_string()))?;
        let most = row.chains as f64 * row.draws_per_chain as f64;
        for ess in [row.ess_bulk, row.ess_tail, row.ess_mean] {
            prop_assert!(ess > 0.0 && ess <= most * math::log10(most) * (1.0 + 1e-12), "{}", ess);
        }
        prop_assert!(row.q05 <= row.median + 1e-12 && row.median <= row.q95 + 1e-12);
        prop_assert!(row.sd >= 0.0 && row.mcse_mean >= 0.0 && row.mcse_sd >= 0.0);
        let time = row.autocorrelation_time;
        prop_assert!(time.is_none_or(|time| time.tau > 0.0 && time.window < row.draws_per_chain));
    }

    /// Any bits and any shape give a row without NaN or a typed error, never a panic.
    #[test]
    fn hostile_draws_do_not_panic(chains in proptest::collection::vec(proptest::collection::vec(
        prop_oneof![8 => -1e3..1e3, 2 => Just(0.0), 1 => any::<f64>()], 0..9), 0..5)) {
        let lengths = |n: usize| chains.iter().all(|chain| chain.len() == n);
        let sound = chains.first().is_some_and(|chain| chain.len() >= 4 && lengths(chain.len()))
            && chains.iter().flatten().all(|x: &f64| x.is_finite());
        let row = diagnose::summarize(&chains);
        prop_assert_eq!(row.is_ok(), sound, "{:?}", row);
        if let Ok(row) = row {
            prop_assert!(numbers(&row).iter().all(|x| !x.is_nan()), "{:?}", row);
        }
        for chain in &chains {
            let _ = diagnose::autocorrelation(chain, 3);
        }
    }
}

/// A stationary Gaussian chain with correlation ρᵗ at lag t.
fn ar1(rho: f64, draws: usize, chain: u64) -> Vec<f64> {
    let mut stream: Stream = Seed(20_210_101).chain(chain).at(0, Purpose::START);
    let step = (1.0 - rho * rho).sqrt();
    let mut x = diagnose::normal_quantile(open_unit(&mut stream));
    let mut next = || {
        x = rho * x + step * diagnose::normal_quantile(open_unit(&mut stream));
        x
    };
    (0..draws).map(|_| next()).collect()
}

/// τ = (1 + ρ) / (1 − ρ) by both rules; the τ of a wrong ρ is refused.
///
/// Standard error of a τ summed to lag M over N draws: τ √(2 (2M + 1) / N) (Sokal 1997, section 3). For ρ < 0 the
/// spectrum's value at frequency 0, which is τ, is replaced by its largest value, 1/τ. That gives a bound, because the
/// sharp end of the window leaks. Geyer's rule sums about as far. On fixed seeds, four standard errors are allowed,
/// plus the share e⁻⁵ that the window leaves out.
#[test]
fn the_time_of_an_autoregression_is_found() {
    const DRAWS: usize = 100_000;
    let exact = |rho: f64| (1.0 + rho) / (1.0 - rho);
    for (key, rho) in [(0, -0.5), (10, 0.0), (20, 0.5), (30, 0.9)] {
        let chains: Vec<Vec<f64>> = (0..4).map(|chain| ar1(rho, DRAWS, key + chain)).collect();
        let total = 4.0 * DRAWS as f64;
        let time = diagnose::integrated_autocorrelation_time(&chains).ok().flatten().expect("the draws differ");
        let by_geyer = total / diagnose::ess_mean(&chains).expect("the draws are finite");
        let largest = exact(rho.abs());
        let allowed = 4.0 * largest * (2.0 * (2.0 * time.window as f64 + 1.0) / total).sqrt() + 0.007 * exact(rho);
        for (rule, tau) in [("Sokal", time.tau), ("Geyer", by_geyer)] {
            println!("rho {rho}, {rule}: {tau:.4} for {:.4} within {allowed:.4}", exact(rho));
            assert!((tau - exact(rho)).abs() <= allowed, "rho {rho}, {rule}: {tau} for {}", exact(rho));
            // The wrong twin: half the remaining distance to ρ = 1.
            assert!((tau - exact((1.0 + rho) / 2.0)).abs() > allowed, "rho {rho}, {rule}: the wrong time passes");
        }
        assert!(time.settled);
    }
}

/// Strongly anticorrelated neighbours: τ = 1/19 is below the bound 1/log₁₀ N, and both rules return the bound.
#[test]
fn the_time_has_a_least_value() {
    let chains: Vec<Vec<f64>> = (0..4).map(|chain| ar1(-0.9, 10_000, 40 + chain)).collect();
    let bound = 1.0 / math::log10(40_000.0);
    let time = diagnose::integrated_autocorrelation_time(&chains).ok().flatten();
    assert!(time.is_some_and(|time| time.tau == bound), "{time:?}");
    assert_eq!(diagnose::ess_mean(&chains), Ok(40_000.0 / bound));
}

/// Known coverage: the mean of an autoregression is within 1.96 `mcse_mean` of the truth in 95% of 400 runs, and within
/// 1.96 naive errors in far fewer.
#[test]
fn the_error_of_the_mean_covers() {
    let mut covered = [0; 2];
    for run in 0..400 {
        let chains: Vec<Vec<f64>> = (0..4).map(|chain| ar1(0.8, 500, 1000 + 4 * run + chain)).collect();
        let row = diagnose::summarize(&chains).expect("the draws are finite");
        for (count, error) in covered.iter_mut().zip([row.mcse_mean, row.sd / 2000_f64.sqrt()]) {
            *count += u32::from(row.mean.abs() <= 1.96 * error);
        }
    }
    // 380 ± 4.4 (binomial). Four of those are allowed, and as much again for the noise of the error itself, because τ
    // is known to only about 12%.
    assert!((345..=398).contains(&covered[0]), "{covered:?}");
    // The naive error is three times too small: coverage 49%.
    assert!(covered[1] < 245, "{covered:?}");
}

#[test]
fn errors_say_what_is_wrong() {
    let error = diagnose::rhat(&[vec![1.0; 9], vec![1.0; 8]]).expect_err("ragged chains");
    assert_eq!(error, DiagnoseError::UnequalLengths { chain: 1, expected: 9, found: 8 });
    assert_eq!(error.to_string(), "chain 1 holds 8 draws, chain 0 holds 9: chains must be equally long");
    let error = diagnose::autocorrelation(&[1.0, f64::NAN, 2.0, 3.0], 1).expect_err("not a number");
    assert_eq!(error.to_string(), "draw 1 of chain 0 is NaN: diagnostics need finite draws");
}
