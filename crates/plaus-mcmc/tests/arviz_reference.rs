//! Diagnostics against ArviZ's own values on stored draws (`arviz/reference.json`, made by `arviz/make_reference.py`).
//!
//! Tolerance: both sides evaluate the same formulas in doubles, in another order and with another Fourier transform.
//! Ranks, R̂, and bulk and tail ESS agree to 1e-14. Numbers computed from the draws themselves carry the draws'
//! rounding: the case `far from zero` lies 10⁶ standard deviations out, and 10⁶ · 2⁻⁵² ≈ 2e-10 is the largest deviation
//! found (run with `--nocapture`). Hence 1e-9 relative. Every wrong twin deviates by more than 1e-3.

use plaus_mcmc::diagnose::{self, Summary};
use serde_json::Value;

const TOLERANCE: f64 = 1e-9;

struct Case {
    name: String,
    draws: Vec<Vec<f64>>,
    reference: Value,
}

/// JSON holds NaN and the infinities as text.
fn number(value: &Value) -> f64 {
    value.as_f64().or_else(|| value.as_str().and_then(|text| text.parse().ok())).expect("a number")
}

fn cases() -> Vec<Case> {
    let text = include_str!("arviz/reference.json");
    let file: Value = serde_json::from_str(text).expect("the reference is JSON");
    let row = |row: &Value| row.as_array().expect("a chain").iter().map(number).collect();
    let case = |case: &Value| Case {
        name: case["name"].as_str().expect("a name").to_owned(),
        draws: case["draws"].as_array().expect("chains").iter().map(row).collect(),
        reference: case["reference"].clone(),
    };
    file["cases"].as_array().expect("cases").iter().map(case).collect()
}

fn case(name: &str) -> Case {
    cases().into_iter().find(|case| case.name == name).expect("a stored case")
}

/// 0 if both are the same, NaN and infinities included.
fn deviation(found: f64, reference: f64) -> f64 {
    if found == reference || (found.is_nan() && reference.is_nan()) {
        return 0.0;
    }
    let relative = (found - reference).abs() / reference.abs();
    if relative.is_nan() { f64::INFINITY } else { relative }
}

fn fields(row: &Summary) -> [(&'static str, f64); 11] {
    [
        ("mean", row.mean),
        ("sd", row.sd),
        ("q05", row.q05),
        ("median", row.median),
        ("q95", row.q95),
        ("rhat", row.rhat.unwrap_or(f64::NAN)),
        ("ess_bulk", row.ess_bulk),
        ("ess_tail", row.ess_tail),
        ("ess_mean", row.ess_mean),
        ("mcse_mean", row.mcse_mean),
        ("mcse_sd", row.mcse_sd),
    ]
}

/// Documented deviation: the standard deviation of equal draws is exactly 0; ArviZ divides 0 by 0.
fn expected(case: &Case, field: &str) -> f64 {
    if case.name == "constant" && matches!(field, "sd" | "mcse_sd") { 0.0 } else { number(&case.reference[field]) }
}

#[test]
fn every_statistic_agrees_with_arviz() {
    let mut worst = std::collections::BTreeMap::new();
    for case in cases() {
        let row = diagnose::summarize(&case.draws).expect("the draws are finite");
        for (field, found) in fields(&row) {
            let reference = expected(&case, field);
            // A mean near 0 carries the rounding of the draws, which is larger than its own.
            let off = if field == "mean" {
                (found - reference).abs() / (row.sd + found.abs())
            } else {
                deviation(found, reference)
            };
            assert!(off <= TOLERANCE, "{}: {field} = {found}, ArviZ {reference}", case.name);
            let largest = worst.entry(field).or_insert((0.0, String::new()));
            if off > largest.0 {
                *largest = (off, case.name.clone());
            }
        }
    }
    println!("largest relative deviations from ArviZ: {worst:#?}");
}

#[test]
fn autocorrelations_agree_with_arviz() {
    let mut worst: f64 = 0.0;
    for case in cases() {
        // Equal draws have no correlation; ArviZ divides rounding errors by rounding errors.
        let Some(found) = diagnose::autocorrelation(&case.draws[0], 19).expect("the draws are finite") else {
            assert!(case.name.contains("constant"), "{}", case.name);
            continue;
        };
        let reference = case.reference["autocorrelation"].as_array().expect("correlations");
        assert_eq!(found.len(), reference.len());
        for (lag, (found, reference)) in found.iter().zip(reference).enumerate() {
            let off = (found - number(reference)).abs();
            // Absolute: correlations are of the order of one.
            assert!(off < TOLERANCE, "{} lag {lag}: {found}, ArviZ {reference}", case.name);
            worst = worst.max(off);
        }
    }
    println!("largest deviation of a correlation: {worst:e}");
}

#[test]
fn autocorrelation_times_agree_with_emcee() {
    let mut compared = 0;
    for case in cases() {
        let Some(reference) = case.reference["emcee_time"].as_f64() else { continue };
        let found = diagnose::integrated_autocorrelation_time(&case.draws).expect("the draws are finite");
        let tau = found.expect("the draws differ").tau;
        assert!(deviation(tau, reference) <= TOLERANCE, "{}: {tau}, emcee {reference}", case.name);
        compared += 1;
    }
    assert!(compared >= 2);
}

/// R̂ of 1992: neither split, nor ranked, nor folded.
fn plain_rhat(chains: &[Vec<f64>]) -> f64 {
    let moments = |x: &[f64]| {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        (mean, x.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (x.len() as f64 - 1.0))
    };
    let n = chains[0].len() as f64;
    let (means, variances): (Vec<f64>, Vec<f64>) = chains.iter().map(|chain| moments(chain)).unzip();
    ((n * moments(&means).1 / moments(&variances).0 + n - 1.0) / n).sqrt()
}

/// Wrong twins: the values of easier formulas must not pass for the reference.
#[test]
fn easier_formulas_are_caught() {
    let told_apart = |name: &str, field: &str, wrong: f64| {
        let off = deviation(wrong, number(&case(name).reference[field]));
        assert!(off > 1e6 * TOLERANCE, "{name}: {field} = {wrong} passes for ArviZ's");
    };
    // All chains drift alike, or spread alike, so only halves or folding show it.
    told_apart("drifting", "rhat", plain_rhat(&case("drifting").draws));
    told_apart("wider", "rhat", plain_rhat(&case("wider").draws));
    // Without ranks, heavy tails are misjudged.
    for name in ["cauchy", "cauchy walk"] {
        told_apart(name, "ess_bulk", diagnose::ess_mean(&case(name).draws).expect("the draws are finite"));
    }
    // One tail instead of both.
    told_apart("bimodal", "ess_tail", diagnose::ess_bulk(&case("bimodal").draws).expect("the draws are finite"));
    // Whole chains instead of halves: each half is passed as a chain, which is then split once more.
    let drifting = case("drifting").draws;
    let quarters: Vec<&[f64]> = drifting.iter().flat_map(|chain| [&chain[..125], &chain[125..]]).collect();
    told_apart("drifting", "ess_bulk", diagnose::ess_bulk(&quarters).expect("the draws are finite"));
    // Draws counted as if independent.
    let row = diagnose::summarize(&case("ar1 0.9").draws).expect("the draws are finite");
    told_apart("ar1 0.9", "mcse_mean", row.sd / 1000_f64.sqrt());
}
