//! Every shape in every scenery, and every pair of shapes: nothing tunnels, nothing gets stuck or becomes NaN, energy
//! does not grow. The example `shapes` makes thousands of throws.

use crate::common::zoo::{Body, Fate, Place, throw};
use plaus_sim::{Accuracy, Outcome, Preset};

/// Energy that a step may add by its error, over the whole: at the standard preset, a thousandth.
const GAIN: f64 = 1e-3;

/// Depth over the size that a body may have on its way. Between two looks at lasting contact, an eighth of a step, it
/// may move by a fifth of its size; the next look comes half way at worst.
const DEEP: f64 = 0.1;

/// No body that is said to rest is in the ground by more than the gap at which bodies touch.
fn check(fate: &Fate, what: &str) {
    assert!(fate.out < 0.0, "{what}: {fate:?}");
    assert!(matches!(fate.outcome, Outcome::AllAtRest | Outcome::TimeReached), "{what}: {fate:?}");
    assert!(fate.gain < GAIN, "{what}: {fate:?}");
    assert!(fate.deep < DEEP, "{what}: {fate:?}");
    let gap = Accuracy::preset(Preset::Standard).gap;
    assert!(fate.outcome != Outcome::AllAtRest || fate.left <= gap, "{what}: {fate:?}");
}

/// Number of throws of each, from `PLAUS_THROWS`.
fn throws() -> u64 {
    std::env::var("PLAUS_THROWS").ok().and_then(|n| n.parse().ok()).unwrap_or(1)
}

#[test]
fn every_shape_stays_in_every_place() {
    for (i, body) in Body::ALL.into_iter().enumerate() {
        // All places if there are many throws; otherwise each body into one place.
        for (j, place) in Place::ALL.into_iter().enumerate().filter(|(j, _)| throws() > 1 || j % 6 == i % 6) {
            for k in 0..throws() {
                let k = 4 * j as u64 + k + i as u64;
                let fate = throw(&[body], place, k, Preset::Standard, 0.5);
                check(&fate, &format!("{body:?} {place:?} throw {k}"));
            }
        }
    }
}

#[test]
fn every_pair_of_shapes_meets() {
    for (i, a) in Body::ALL.into_iter().enumerate() {
        // All pairs if there are many throws; otherwise neighbours in the list.
        for (j, b) in Body::ALL.into_iter().enumerate().filter(|(j, _)| throws() > 1 || *j == (i + 4) % 13) {
            let place = [Place::Planes, Place::HollowBall][(i + j) % 2];
            let k = (13 * i + j) as u64;
            let fate = throw(&[a, b], place, k, Preset::Standard, 0.4);
            check(&fate, &format!("{a:?} {b:?} throw {k}"));
        }
    }
}

/// The tip of a cone slides along a hollow edge of a mesh, by a rounding error below one of its sides: the other side
/// holds it. In both of these throws it went through once.
#[test]
fn a_tip_does_not_slip_through_a_hollow_edge() {
    for k in [1, 5] {
        let fate = throw(&[Body::Cone], Place::Mesh, k, Preset::Standard, 3.0);
        check(&fate, &format!("throw {k}"));
        assert_eq!(fate.outcome, Outcome::AllAtRest, "throw {k}");
    }
}

/// A body whose deepest points come out of an overlap is tested for other points that come down meanwhile. Without
/// this, a coin went 3.7 times half its thickness into the ground, and a cuboid 1.3 times its size.
#[test]
fn points_that_come_down_while_the_deepest_leave_are_seen() {
    for (body, place, k) in [
        (Body::Coin, Place::Planes, 2),
        (Body::Coin, Place::Solids, 2),
        (Body::Cuboid, Place::Solids, 6),
        (Body::Cuboid, Place::Solids, 11),
        (Body::Rounded, Place::Solids, 5),
        (Body::Rounded, Place::Solids, 15),
    ] {
        check(&throw(&[body], place, k, Preset::Standard, 3.0), &format!("{body:?} {place:?} throw {k}"));
    }
}
