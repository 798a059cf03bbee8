//! Draws without the constraint have the laws that the scene states.

use super::straight::scene;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::spelling::{Drops, Spelling};
use plaus_tests::law::{bound, distance, normal};

const DRAWS: usize = 100_000;

fn draws(scene: &Spelling) -> Vec<Drops> {
    let mut stream = Seed(3).chain(0).at(0, Purpose::START);
    (0..DRAWS).map(|_| scene.start(&mut stream)).collect()
}

/// Largest allowed distance, at a false-alarm rate of 1e-8; there are about 60 such tests below, so less than 1e-6 for
/// all.
fn most(samples: usize) -> f64 {
    bound(1e-8, samples)
}

#[test]
fn the_number_of_balls_is_binomial() {
    let scene = scene(|_| ());
    let counts: Vec<usize> = draws(&scene).iter().map(Drops::active).collect();
    let (mut choose, mut below) = (1.0, 0.0);
    for n in 0..=10 {
        below += choose / 1024.0;
        choose *= (10 - n) as f64 / (n + 1) as f64;
        let seen = counts.iter().filter(|&&count| count <= n).count() as f64 / DRAWS as f64;
        assert!((seen - below).abs() < most(DRAWS), "P(n ≤ {n}) is {seen}, not {below}");
    }
}

#[test]
fn each_coordinate_of_an_offset_is_gaussian() {
    let scene = scene(|_| ());
    let draws = draws(&scene);
    assert_eq!(draws[0].offsets.len(), 48);
    for (vertex, axis) in (0..48).step_by(3).map(|vertex| (vertex, vertex % 3)) {
        let values = draws.iter().map(|draw| draw.offsets[vertex][axis]).collect();
        let gap = distance(values, |x| normal(x / 0.1));
        assert!(gap < most(DRAWS), "vertex {vertex}, axis {axis}: {gap}");
    }
}

#[test]
fn each_drop_position_is_uniform_over_the_rectangle() {
    let scene = scene(|_| ());
    let draws = draws(&scene);
    // The inside is 140 × 100 mm, with partitions 2 mm thick and balls of 12 mm diameter.
    for (axis, [low, high]) in [[7.0, 133.0], [7.0, 93.0]].into_iter().enumerate() {
        let side = &scene.rectangle().sides()[axis];
        assert_eq!((side.low(), side.high()), (low, high));
        for ball in 0..10 {
            let values: Vec<f64> = draws.iter().filter_map(|draw| draw.balls[ball]).map(|at| at[axis]).collect();
            let (count, gap) = (values.len(), distance(values, |x| (x - low) / (high - low)));
            assert!(gap < most(count), "ball {ball}, axis {axis}: {gap}");
        }
    }
}

/// Whether one ball is dropped, another ball's position, and an offset are independent.
#[test]
fn variables_are_uncorrelated() {
    let scene = scene(|_| ());
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); 6];
    for draw in draws(&scene) {
        let sign = |ball: usize| f64::from(u8::from(draw.balls[ball].is_some())) - 0.5;
        let place = |ball: usize, axis: usize, middle: f64| draw.balls[ball].map_or(0.0, |at| at[axis] - middle);
        let row = [sign(0), sign(1), place(2, 0, 70.0), place(2, 1, 50.0), draw.offsets[0][0], draw.offsets[0][1]];
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }
    let norm = |column: &[f64]| column.iter().map(|x| x * x).sum::<f64>().sqrt();
    for a in 0..columns.len() {
        for b in 0..a {
            let product: f64 = columns[a].iter().zip(&columns[b]).map(|(x, y)| x * y).sum();
            let r = product / norm(&columns[a]) / norm(&columns[b]);
            // Six standard errors.
            assert!(r.abs() < 6.0 / (DRAWS as f64).sqrt(), "{a}, {b}: {r}");
        }
    }
}
