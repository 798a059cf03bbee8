//! Draws without the constraint have the laws of the paper's appendix A.1, with the errata of MODEL.md applied.

use super::straight::scene;
use plaus_dist::{Purpose, Seed, math};
use plaus_mcmc::Target;
use plaus_scenes::bowling::{Quantity, Shot};
use std::f64::consts::FRAC_1_SQRT_2;

const DRAWS: usize = 100_000;

/// The largest distance between an empirical and a given distribution function exceeds this with probability 1e-7 at most (Dvoretzky, Kiefer, Wolfowitz, Massart), whatever the
/// law. Nine such tests below: 1e-6 for all.
fn most() -> f64 {
    (math::ln(2.0 / 1e-7) / (2.0 * DRAWS as f64)).sqrt()
}

fn distance(mut values: Vec<f64>, cdf: impl Fn(f64) -> f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let count = values.len() as f64;
    let gap = |(index, x): (usize, &f64)| {
        let at = cdf(*x);
        (at - index as f64 / count).abs().max((at - (index + 1) as f64 / count).abs())
    };
    values.iter().enumerate().map(gap).fold(0.0, f64::max)
}

fn normal(z: f64) -> f64 {
    0.5 * math::erfc(-z * FRAC_1_SQRT_2)
}

#[test]
fn every_variable_has_its_law() {
    let scene = scene(|_| ());
    let mut stream = Seed(3).chain(0).at(0, Purpose::START);
    let draws: Vec<Shot> = (0..DRAWS).map(|_| scene.start(&mut stream)).collect();
    let check = |name: &str, value: &dyn Fn(&Shot) -> f64, cdf: &dyn Fn(f64) -> f64| {
        let gap = distance(draws.iter().map(value).collect(), cdf);
        assert!(gap < most(), "{name}: {gap}");
    };
    let width = 41.5 * 0.0254;
    check("radius", &|draw| draw.get(Quantity::Radius), &|x| (x - 0.088) / 0.022);
    check("density", &|draw| draw.get(Quantity::Density), &|x| (x - 1152.0) / 288.0);
    check("across", &|draw| draw.get(Quantity::Across), &|x| x / width + 0.5);
    check("speed", &|draw| draw.get(Quantity::Speed), &|x| normal(x - 7.0));
    check("drift", &|draw| draw.get(Quantity::Drift), &|x| normal(x / 0.1));
    check("twist", &|draw| draw.get(Quantity::Twist), &|x| normal(x / 0.2));
    check("pin 1", &|draw| draw.pins[0][0], &normal);
    check("pin 10", &|draw| draw.pins[9][1], &normal);
    // Given the radius, the height is N(1.1, 0.1) largest radii, above it: its distribution function at itself is uniform.
    let height = |draw: &Shot| {
        let z = |x: f64| (x - 0.121) / 0.011;
        let below = normal(z(draw.get(Quantity::Radius)));
        (normal(z(draw.get(Quantity::Height))) - below) / (1.0 - below)
    };
    check("height", &height, &|x| x);
    for draw in &draws {
        assert!(draw.get(Quantity::Roll) == 0.0 && draw.get(Quantity::Hook) == 0.0);
        assert_eq!(draw.get(Quantity::Gyration), 0.4_f64.sqrt());
    }
}

/// The printed sum over pins grows with every pin that is near its spot, however far another is; a product does not.
#[test]
fn pins_are_independent() {
    let scene = scene(|_| ());
    let mut draw = scene.start(&mut Seed(3).chain(0).at(0, Purpose::START));
    let log = |draw: &Shot| scene.log_prior(draw).unwrap().value();
    draw.pins.fill([0.0; 2]);
    let here = log(&draw);
    draw.pins[4] = [3.0, 0.0];
    assert!((here - log(&draw) - 4.5).abs() < 1e-9);
    draw.pins[7] = [0.0, 2.0];
    assert!((here - log(&draw) - 6.5).abs() < 1e-9);
}
