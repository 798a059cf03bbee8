//! Draws without the constraint have the laws of the paper's appendix A.1, with the paper's errors
//! corrected.

use super::straight::scene;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::bowling::{Quantity, Shot};
use plaus_tests::law::{bound, distance, normal};

const DRAWS: usize = 100_000;

/// Largest allowed distance, at a false-alarm rate of 1e-7; there are nine such tests below, so 1e-6 for all.
fn most() -> f64 {
    bound(1e-7, DRAWS)
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
    // Given the radius, the height is N(1.1, 0.1) in units of the largest radius, cut off below the radius. Its own
    // distribution function at the drawn height is uniform.
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

/// The printed sum over pins is large if any pins are near their spots, however far away another pin is; a product is
/// not.
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
