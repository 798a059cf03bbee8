//! Draws without the constraints have the laws that the configuration states.

use super::plain::scene;
use plaus_dist::{Density, Purpose, Seed, TruncatedGaussian, math};
use plaus_mcmc::Target;
use plaus_scenes::dice::{Draw, Throw};
use plaus_tests::law::{bound, distance, normal};

const DRAWS: usize = 40_000;

/// Largest allowed distance, at a false-alarm rate of 1e-8; there are twenty such tests below, so less than 1e-6 for
/// all.
fn most() -> f64 {
    bound(1e-8, DRAWS)
}

#[test]
fn throws_have_the_stated_laws() {
    let scene = scene(|config| (config.dice, config.throw.z_mm) = (2, 25.0));
    let mut stream = Seed(3).chain(0).at(0, Purpose::START);
    let draws: Vec<Draw> = (0..DRAWS).map(|_| scene.start(&mut stream)).collect();
    let throws: Vec<Throw> = draws.iter().map(|draw| draw.throws[1]).collect();
    // Place and velocity of the second of two dice, 40 mm apart.
    let laws = [(0, -0.15, 0.03), (1, 0.02, 0.03), (3, 0.9, 0.2), (4, 0.0, 0.2), (5, -0.2, 0.2), (6, 0.0, 15.0)];
    for (k, mean, sd) in laws.into_iter().chain([(7, 0.0, 15.0), (8, 0.0, 15.0)]) {
        let gap =
            distance(draws.iter().map(|draw| scene.prior().value(draw, 1, k)).collect(), |x| normal((x - mean) / sd));
        assert!(gap < most(), "number {k}: {gap}");
    }
    // Heights are cut off so that a die of any orientation is clear of the highest bump.
    let low = 0.6e-3 + (7.0 * 3.0_f64.sqrt() + 1.0) * 1e-3 + 1e-4;
    let law = TruncatedGaussian::new(0.025, 0.015, low, f64::INFINITY).unwrap();
    let below = |x: f64| TruncatedGaussian::new(0.025, 0.015, low, x).map_or(0.0, |part| part.log_mass());
    let share = |x: f64| if x > low { math::exp(below(x) - law.log_mass()) } else { 0.0 };
    let gap = distance(throws.iter().map(|throw| throw.position.z).collect(), share);
    assert!(gap < most(), "height: {gap}");
    assert!(law.log_density(&(low - 1e-9)).unwrap().is_zero());
    // For a uniform rotation, each entry of its matrix is uniform on [−1, 1] (Archimedes).
    for (axis, component) in [(0, 0), (0, 2), (1, 1), (2, 0), (2, 2)] {
        let entry = |throw: &Throw| glam::DMat3::from_quat(throw.orientation).col(axis)[component];
        let gap = distance(throws.iter().map(entry).collect(), |x| 0.5 * (x + 1.0));
        assert!(gap < most(), "column {axis}, {component}: {gap}");
    }
    let turned = distance(throws.iter().map(|throw| f64::from(throw.turn)).collect(), |k| (k.floor() + 1.0) / 24.0);
    // A law of 24 steps: the empirical distribution function approaches it from above only.
    assert!(turned < 1.0 / 24.0 + most(), "turns: {turned}");
}

/// The wrong twin draws quaternions uniformly from a cube, not from a ball; the same test catches it.
#[test]
fn orientations_of_a_cube_of_quaternions_are_not_uniform() {
    let mut stream = Seed(3).chain(0).at(1, Purpose::START);
    let mut side = || 2.0 * plaus_dist::open_unit(&mut stream) - 1.0;
    let entry = |_| {
        let q = glam::DQuat::from_xyzw(side(), side(), side(), side()).normalize();
        glam::DMat3::from_quat(q).col(0)[2]
    };
    assert!(distance((0..DRAWS).map(entry).collect(), |x| 0.5 * (x + 1.0)) > most());
}

#[test]
fn dice_on_one_table_do_not_begin_inside_each_other() {
    let scene = scene(|config| (config.dice, config.together, config.throw.apart_mm) = (2, true, 20.0));
    let mut stream = Seed(5).chain(0).at(0, Purpose::START);
    let mut forbidden = 0;
    for _ in 0..200 {
        let draw = scene.start(&mut stream);
        let apart = draw.throws[0].position.distance(draw.throws[1].position);
        let impossible = scene.log_prior(&draw).unwrap().is_zero();
        assert_eq!(impossible, apart < 2.0 * (7.0 * 3.0_f64.sqrt() + 1.1) * 1e-3);
        forbidden += u32::from(impossible);
    }
    assert!(forbidden > 0 && forbidden < 200);
}
