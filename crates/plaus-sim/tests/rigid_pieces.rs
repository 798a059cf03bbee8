//! Every shape in every scenery, and every pair of shapes: nothing tunnels, nothing is stuck or no number, energy does
//! not grow. Thousands of throws: the example `shapes`.

use crate::common::zoo::{Body, Place, throw};
use plaus_sim::{Outcome, Preset};

/// Energy gained over the whole by which a step may err: that of the standard preset, a thousandth.
const GAIN: f64 = 1e-3;

/// Throws of each, by `PLAUS_THROWS`.
fn throws() -> u64 {
    std::env::var("PLAUS_THROWS").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

#[test]
fn every_shape_stays_in_every_place() {
    for (i, body) in Body::ALL.into_iter().enumerate() {
        // All places where many are thrown; else each body into one.
        for (j, place) in Place::ALL.into_iter().enumerate().filter(|(j, _)| throws() > 1 || j % 6 == i % 6) {
            for k in 0..throws() {
                let k = 4 * j as u64 + k + i as u64;
                let fate = throw(&[body], place, k, Preset::Standard, 0.5);
                assert!(fate.out < 0.0, "{body:?} {place:?} throw {k}: {fate:?}");
                assert!(
                    matches!(fate.outcome, Outcome::AllAtRest | Outcome::TimeReached),
                    "{body:?} {place:?} throw {k}: {fate:?}"
                );
                assert!(fate.gain < GAIN, "{body:?} {place:?} throw {k}: {fate:?}");
            }
        }
    }
}

#[test]
fn every_pair_of_shapes_meets() {
    for (i, a) in Body::ALL.into_iter().enumerate() {
        // All pairs where many are thrown; else neighbours in the list.
        for (j, b) in Body::ALL.into_iter().enumerate().filter(|(j, _)| throws() > 1 || *j == (i + 4) % 13) {
            let place = [Place::Planes, Place::HollowBall][(i + j) % 2];
            let k = (13 * i + j) as u64;
            let fate = throw(&[a, b], place, k, Preset::Standard, 0.4);
            assert!(fate.out < 0.0, "{a:?} {b:?} throw {k}: {fate:?}");
            assert!(
                matches!(fate.outcome, Outcome::AllAtRest | Outcome::TimeReached),
                "{a:?} {b:?} throw {k}: {fate:?}"
            );
            assert!(fate.gain < GAIN, "{a:?} {b:?} throw {k}: {fate:?}");
        }
    }
}
