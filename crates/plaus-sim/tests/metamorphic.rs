//! Worlds that must behave the same to the last bit.

use crate::common::*;
use glam::DVec3;
use plaus_sim::marbles::{Marble, MarbleSpec, MarbleWorld, Marbles, Start};
use plaus_sim::scenery::{Aabb, Dome, Mesh, Plane, Scenery};
use plaus_sim::{Accuracy, Law, Laws, Outcome, Scratch};

/// Balls of several sizes over a floor with walls, a bowl and a tetrahedron; every length is multiplied by `scale`.
fn garden(scale: f64, order: &[usize]) -> (Marbles, Vec<Start>) {
    let radii = [0.25, 0.125, 0.1875, 0.25, 0.3125];
    let x = [-1.0, -0.4, 0.1, 0.7, 1.4];
    let spec = |k: usize| MarbleSpec::solid(radii[k] * scale, 1.0 + 0.5 * radii[k], M);
    let start = |k: usize| Start::at_rest(DVec3::new(x[k], 0.03 * k as f64, 1.5 + 0.2 * radii[k]) * scale);
    let plane = |p: DVec3, n: DVec3| Plane::new(p * scale, n, M).unwrap();
    let planes = vec![plane(DVec3::ZERO, DVec3::Z), plane(-3.0 * DVec3::X, DVec3::X), plane(3.0 * DVec3::X, -DVec3::X)];
    let clip = Aabb { min: DVec3::new(0.2, -2.0, -1.0) * scale, max: DVec3::new(3.0, 2.0, 1.0) * scale };
    let bowl = Dome::new(DVec3::new(1.2, 0.1, 2.0) * scale, 2.0 * scale, true, clip, M).unwrap();
    let corners = [(-1.5, -0.5, 0.0), (0.0, -0.5, 0.0), (-0.75, 0.75, 0.0), (-0.75, 0.0, 0.5)]
        .map(|(x, y, z)| DVec3::new(x, y, z) * scale);
    let sides = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]].map(|t| (t, M));
    let mesh = Mesh::new(corners.to_vec(), &sides, 0.0).unwrap();
    let world = MarbleWorld {
        specs: order.iter().map(|&k| spec(k)).collect(),
        laws: Laws::uniform(Law::new(0.3, 0.6).with_resistance(0.01, 0.01)).unwrap(),
        scenery: Scenery::new(planes, mesh, vec![bowl], 0.5 * scale).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -G),
        accuracy: Accuracy::default(),
        duration: 64.0,
    };
    (Marbles::new(world).unwrap(), order.iter().map(|&k| start(k)).collect())
}

#[test]
fn lengths_times_four_and_times_times_two_scale_every_bit() {
    let order = [0, 1, 2, 3, 4];
    let ((small, a), (large, b)) = (garden(1.0, &order), garden(4.0, &order));
    for until in [0.5, 1.0, 2.0, 4.0, 8.0] {
        let ((p, first, s), (q, second, t)) = (run(&small, &a, until), run(&large, &b, 2.0 * until));
        assert_eq!(first, second);
        assert_eq!(s.counts(), t.counts());
        for (a, b) in p.iter().zip(&q) {
            assert_eq!(a.path.x * 4.0, b.path.x, "at {until}");
            assert_eq!(a.path.v * 2.0, b.path.v, "at {until}");
            assert_eq!(a.spin * 0.5, b.spin, "at {until}");
            assert_eq!(a.phase, b.phase);
        }
    }
}

#[test]
fn relabelling_permutes_the_result() {
    let plain = garden(1.0, &[0, 1, 2, 3, 4]);
    for order in [[4, 3, 2, 1, 0], [2, 0, 4, 1, 3]] {
        let shuffled = garden(1.0, &order);
        for until in [1.0, 2.0, 8.0] {
            let (p, _, s) = run(&plain.0, &plain.1, until);
            let (q, _, t) = run(&shuffled.0, &shuffled.1, until);
            assert_eq!(s.counts().impacts, t.counts().impacts);
            for (k, &label) in order.iter().enumerate() {
                assert_eq!(p[label].path, q[k].path, "ball {label} at {until}");
                assert_eq!(p[label].spin, q[k].spin);
            }
        }
    }
}

#[test]
#[cfg_attr(target_family = "wasm", ignore = "needs threads")]
fn repeats_and_threads_give_the_same_bits() {
    let (world, starts) = garden(1.0, &[0, 1, 2, 3, 4]);
    let once = run(&world, &starts, 8.0).0;
    let again = std::thread::scope(|s| {
        let runs: Vec<_> = (0..4).map(|_| s.spawn(|| run(&world, &starts, 8.0).0)).collect();
        runs.into_iter().map(|r| r.join().unwrap()).collect::<Vec<Vec<Marble>>>()
    });
    assert!(again.iter().all(|bodies| *bodies == once));
    // A scratch that has served another world is as good as a new one.
    let mut scratch = Scratch::default();
    let (other, others) = garden(4.0, &[3, 1]);
    other.run(&mut other.state(&others).unwrap(), &mut scratch, 3.0, &mut ()).unwrap();
    let mut state = world.state(&starts).unwrap();
    world.run(&mut state, &mut scratch, 8.0, &mut ()).unwrap();
    assert_eq!(state.bodies(), run(&world, &starts, 8.0).2.bodies());
}

#[test]
fn elastic_frictionless_runs_go_back() {
    let specs = vec![unit_ball(); 4];
    let mut world = World::new(specs, Law::new(0.0, 1.0)).floor();
    for (p, n) in [(-2.0, DVec3::X), (2.0, -DVec3::X)] {
        world.planes.push(Plane::new(DVec3::X * p, n, M).unwrap());
    }
    let world = world.build();
    let x = [-1.2, -0.5, 0.3, 1.1];
    let starts: Vec<Start> = (0..4)
        .map(|k| {
            moving(
                DVec3::new(x[k], 0.02 * k as f64, 1.0 + 0.3 * k as f64),
                DVec3::new(0.5 - 0.3 * k as f64, 0.0, 0.0),
                DVec3::ZERO,
            )
        })
        .collect();
    let (there, outcome, state) = run(&world, &starts, 2.0);
    assert_eq!(outcome, Outcome::TimeReached);
    assert!(state.counts().impacts >= 8, "{:?}", state.counts());
    let turned: Vec<Start> = there.iter().map(|b| moving(b.path.x, -b.path.v, DVec3::ZERO)).collect();
    let (back, _, _) = run(&world, &turned, 2.0);
    for (b, s) in back.iter().zip(&starts) {
        // Each collision of curved bodies multiplies rounding by about 2 d / r: ten of them by about 10⁵.
        assert!((b.path.x - s.position).length() < 1e-9, "{} for {}", b.path.x, s.position);
        assert!((b.path.v + s.velocity).length() < 1e-9);
    }
}
