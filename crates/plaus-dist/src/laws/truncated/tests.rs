use super::*;
use crate::Gaussian;
use crate::testing::{KS_LIMIT, Z_LIMIT, draws, integrate, ks, ks_two, stored, stream, z_score};
use proptest::prelude::*;
use rand::RngExt;
use std::f64::consts::LN_2;

const INF: f64 = f64::INFINITY;

fn law(mean: f64, sd: f64, low: f64, high: f64) -> TruncatedGaussian {
    TruncatedGaussian::new(mean, sd, low, high).unwrap()
}

/// One of each kind: wide and narrow about the mean, from the mean on, either tail near and far, wide and narrow.
fn kinds() -> Vec<TruncatedGaussian> {
    vec![
        law(0.9, 0.2, 0.0, 1.0),
        law(0.5, 2.0, 0.0, 1.0),
        law(0.0, 1.0, -INF, INF),
        law(3.0, 2.0, 3.0, INF),
        law(-1.0, 2.0, 0.0, INF),
        law(0.0, 1.0, 0.1, 3.0),
        law(0.0, 1.0, -8.0, -5.0),
        law(0.0, 1.0, 40.0, INF),
        law(0.0, 1.0, 40.0, 40.01),
        law(1.0, 1e-3, -INF, 0.9),
    ]
}

/// Past these ends the density is below e^−45 of its peak.
fn reach(law: &TruncatedGaussian) -> (f64, f64) {
    let near = law.mean.clamp(law.low, law.high);
    let far = law.sd * f64::min(12.0, 45.0 * law.sd / (near - law.mean).abs());
    (law.low.max(near - far), law.high.min(near + far))
}

#[test]
fn densities_are_normalised_and_without_their_mass_they_are_not() {
    for law in kinds() {
        let (low, high) = reach(&law);
        let mass = integrate(low, high, |x| math::exp(law.log_density(&x).unwrap().value()));
        // The integrand falls by at most e^−72 over 200 panels, which five points follow to 1e-13, and e^−45 is cut
        // off; the nodes at x ≈ 0.9 are rounded by 1e-16, which at 100 sd with sd = 1e-3 is 1e-11 of the density there.
        assert!((mass - 1.0).abs() < 1e-11, "{law:?}: {mass}");
        let twin = Gaussian::new(law.mean, law.sd).unwrap();
        let kept = integrate(low, high, |x| math::exp(twin.log_density(&x).unwrap().value()));
        assert_eq!((kept - 1.0).abs() < 1e-11, law.low == -INF && law.high == INF);
    }
}

#[test]
fn log_mass_agrees_with_mpmath() {
    // mpmath at 50 digits; at 10⁸ its asymptote −a²/2 − ln(a √2π).
    let table = [
        (-0.5, 0.25, -1.237_292_501_322_450_3),
        (0.1, 3.0, -0.779_092_366_806_418_2),
        (-4.0, 9.0, -3.167_174_337_748_938e-_5),
        (1.0, INF, -1.841_021_645_009_263_6),
        (-INF, -3.0, -6.607_726_221_510_349),
        (2.0, 2.001, -9.827_693_812_103_586),
        (10.0, INF, -53.231_285_150_512_47),
        (40.0, INF, -804.608_442_013_753_8),
        (40.0, 40.001, -807.846_627_311_413_5),
        (100.0, INF, -5_005.524_208_694_205),
        (1e8, INF, -5_000_000_000_000_019.3),
    ];
    for (low, high, expected) in table {
        let mass = law(0.0, 1.0, low, high).log_mass();
        // Ten roundings of the terms, the largest of which is the log itself.
        assert!((mass - expected).abs() < 1e-14 * (1.0 + expected.abs()), "[{low}, {high}]: {mass} {expected}");
    }
}

#[test]
fn the_two_ways_to_the_integral_meet() {
    // The fall over the interval crosses ½, where quadrature hands over to error functions; cut in two, each part is
    // the quadrature's.
    for near in [1e-9, 0.5, 3.0, 40.0, 1e6] {
        let width = 1.0 / (near + (near * near + 1.0_f64).sqrt());
        for stretch in [0.99, 1.0, 1.01, 1.5] {
            let (middle, end) = (near + 0.5 * stretch * width, near + stretch * width);
            let whole = law(0.0, 1.0, near, end).log_mass();
            let parts = math::ln_add_exp(law(0.0, 1.0, near, middle).log_mass(), law(0.0, 1.0, middle, end).log_mass());
            // Relative, because the mass at 10⁶ sd is e^(−5·10¹¹).
            assert!(((whole - parts) / whole).abs() < 1e-13, "{near} {stretch}: {whole} {parts}");
        }
    }
}

/// P(X ≤ x), as the quotient of two masses.
fn cdf(law: &TruncatedGaussian, x: f64) -> f64 {
    match TruncatedGaussian::new(law.mean, law.sd, law.low, x) {
        Ok(part) => math::exp(part.log_mass() - law.log_mass()),
        Err(_) => 0.0,
    }
}

#[test]
fn draws_agree_with_the_density_and_clamped_ones_do_not() {
    for (seed, law) in (0..).zip(kinds()) {
        let x = draws(&law, 100_000, 900 + seed);
        assert!(x.iter().all(|x| (law.low..=law.high).contains(x)));
        assert!(ks(x.into_iter(), |x| cdf(&law, x)) < KS_LIMIT, "{law:?}");
        // The wrong twin: whatever is outside moved to the nearest end.
        let clamped = draws(&Gaussian::new(law.mean, law.sd).unwrap(), 100_000, 900 + seed);
        let misfit = ks(clamped.into_iter().map(|x| x.clamp(law.low, law.high)), |x| cdf(&law, x));
        assert_eq!(misfit < KS_LIMIT, law.low == -INF && law.high == INF, "{law:?}: {misfit}");
    }
}

/// E[uniform density / density] = 1 under the density itself; leaving out the mass multiplies it by that mass.
#[test]
fn draws_reveal_a_density_without_its_mass() {
    let (law, uniform) = (law(0.9, 0.2, 0.5, 1.0), crate::Uniform::new(0.5, 1.0).unwrap());
    let twin = Gaussian::new(0.9, 0.2).unwrap();
    let x = draws(&law, 100_000, 920);
    let log_uniform = uniform.log_density(&0.5).unwrap().value();
    let ratio = |density: &dyn Density<f64>, x: &f64| math::exp(log_uniform - density.log_density(x).unwrap().value());
    // E[ratio²] = ∫ uniform²/density.
    let second = integrate(0.5, 1.0, |x| 2.0 * ratio(&law, &x));
    let sd = (second - 1.0).sqrt();
    assert!(z_score(x.iter().map(|x| ratio(&law, x)), 1.0, sd).abs() < Z_LIMIT);
    assert!(z_score(x.iter().map(|x| ratio(&twin, x)), 1.0, sd).abs() > Z_LIMIT);
}

#[test]
fn draws_agree_with_rand_distr_by_rejection() {
    let mut stream = stream(930);
    let source = rand_distr::Normal::new(-1.0, 2.0).unwrap();
    let theirs = std::iter::repeat_with(|| stream.sample(source)).filter(|x| (0.0..=4.0).contains(x)).take(100_000);
    assert!(ks_two(draws(&law(-1.0, 2.0, 0.0, 4.0), 100_000, 931), theirs.collect()) < KS_LIMIT);
}

#[test]
fn mirrored_laws_are_mirror_images() {
    for law in kinds() {
        let image = TruncatedGaussian::new(-law.mean, law.sd, -law.high, -law.low).unwrap();
        let (low, high) = reach(&law);
        for part in 0..=8 {
            let x = (low + (high - low) * f64::from(part) / 8.0).clamp(law.low, law.high);
            assert_eq!(law.log_density(&x).unwrap(), image.log_density(&-x).unwrap());
        }
    }
}

#[test]
fn extremes_stay_values() {
    for sd in [1e-300, 1.0, 1e300] {
        // 10⁸ sd out the law is exponential of rate 10⁸/sd: density 10⁸/sd at the end, to 1e-16.
        let end = if sd > 1e290 { 1e300 } else { 1e8 * sd };
        let law = law(0.0, sd, end, INF);
        let near = end / sd;
        assert!(law.log_mass().is_finite());
        if near > 1.0 {
            let peak = law.log_density(&end).unwrap().value();
            assert!((peak - (math::ln(near) - math::ln(sd))).abs() < 1e-11, "{peak}");
        }
        let x = law.sample(&mut stream(940));
        assert!(x.is_finite() && x >= end && law.log_density(&x).unwrap().value().is_finite());
        assert!(law.log_density(&INF).unwrap().is_zero());
        assert!(law.log_density(&-INF).unwrap().is_zero());
        assert!(law.log_density(&f64::NAN).is_err());
    }
    // An interval of 1e-12 sd, 30 sd out, is all but uniform: its fall is 3e-11.
    let sliver = law(0.0, 1.0, 30.0, 30.0 + 1e-12);
    let width = sliver.high - sliver.low;
    assert!((sliver.log_density(&30.0).unwrap().value() + math::ln(width)).abs() < 1e-10);
    // Half the Gaussian.
    assert!((law(5.0, 1e-300, 5.0, INF).log_mass() + LN_2).abs() < 1e-15);
}

#[test]
fn empty_and_massless_intervals_are_refused_also_from_storage() {
    let refused = [
        (0.0, 1.0, 1.0, 1.0),
        (0.0, 1.0, 2.0, 1.0),
        (0.0, 1.0, INF, INF),
        (0.0, 1.0, -INF, -INF),
        (0.0, 1.0, f64::NAN, 1.0),
        (0.0, 1.0, 0.0, f64::NAN),
        (f64::NAN, 1.0, 0.0, 1.0),
        (0.0, -1.0, 0.0, 1.0),
        (0.0, 1.0, 1e155, INF),
        (0.0, 1e-300, 1e300, INF),
        (0.0, 1e300, 0.0, 1e-10),
    ];
    for (mean, sd, low, high) in refused {
        assert!(TruncatedGaussian::new(mean, sd, low, high).is_err(), "{mean} {sd} {low} {high}");
        let fields = [("mean", mean), ("sd", sd), ("low", low), ("high", high)];
        assert!(TruncatedGaussian::deserialize(stored(&fields)).is_err());
    }
    let fields = [("mean", 0.9), ("sd", 0.2), ("low", 0.0), ("high", INF)];
    assert_eq!(TruncatedGaussian::deserialize(stored(&fields)).unwrap(), law(0.9, 0.2, 0.0, INF));
}

proptest! {
    #[test]
    fn whatever_is_built_gives_values_and_draws_inside(
        shift in -1e6..1e6_f64,
        exponent in -280..270_i32,
        below in -200.0..200.0_f64,
        exponent_of_width in -20..20_i32,
        seed: u64,
    ) {
        let sd = math::powi(10.0, exponent);
        let mean = shift * sd;
        let low = mean + below * sd;
        let built = TruncatedGaussian::new(mean, sd, low, low + sd * math::powi(10.0, exponent_of_width));
        prop_assume!(built.is_ok());
        let law = built.unwrap();
        prop_assert!(law.log_mass() <= 1e-13 && law.log_mass().is_finite());
        let x = law.sample(&mut stream(seed));
        prop_assert!(law.low <= x && x <= law.high);
        prop_assert!(law.log_density(&x).unwrap().value().is_finite());
    }
}

#[test]
fn values_are_pinned() {
    let bits: Vec<u64> = kinds().iter().map(|law| draws(law, 1, 5)[0].to_bits()).collect();
    assert_eq!(
        bits,
        [
            4_606_903_448_130_463_365,
            4_601_916_014_106_225_834,
            4_608_094_910_754_368_057,
            4_617_771_763_938_776_348,
            4_606_781_085_317_501_336,
            4_603_982_162_756_021_240,
            13_840_820_222_273_188_594,
            4_630_828_468_271_362_269,
            4_630_826_892_258_804_355,
            4_606_281_643_769_104_113,
        ]
    );
}
