//! Compares with an independent method for the distance: alternating projections.

use super::*;
use glam::DQuat;
use plaus_dist::math;
use proptest::prelude::*;

const EIGHTH: f64 = std::f64::consts::FRAC_PI_8;

fn cuboid(core: [f64; 3], turn: [f64; 4], rounding: f64) -> Placed {
    let turn = DQuat::from_array(turn).normalize();
    Placed { axes: DMat3::from_quat(turn), core: DVec3::from(core), rounding }
}

/// The point of a core nearest to `p`, about the core's centre.
fn onto(c: &Placed, p: DVec3) -> DVec3 {
    c.axes * (c.axes.transpose() * p).clamp(-c.core, c.core)
}

/// How far a core reaches along a direction, from its centre.
fn reach(c: &Placed, d: DVec3) -> f64 {
    (c.axes.transpose() * d).abs().dot(c.core)
}

/// Whether two cores have a point in common, by the vertices of their intersection: points where three of their twelve
/// face planes meet inside all the others. A vertex counts if it is within `slack` of the faces. Planes more parallel
/// than a determinant of 1e-9 give no vertex, because its error would be rounding over that determinant.
fn overlap(a: &Placed, b: &Placed, offset: DVec3, slack: f64) -> bool {
    let planes: Vec<(DVec3, f64)> = [(a, offset), (b, DVec3::ZERO)]
        .into_iter()
        .flat_map(|(c, centre)| {
            (0..6).map(move |f| {
                let normal = c.axes.col(f / 2) * if f % 2 == 0 { 1.0 } else { -1.0 };
                (normal, normal.dot(centre) + c.core[f / 2])
            })
        })
        .collect();
    let meets = |i: usize, j: usize, k: usize| {
        let [(p, x), (q, y), (r, z)] = [i, j, k].map(|f| planes[f]);
        let det = p.dot(q.cross(r));
        let vertex = (q.cross(r) * x + r.cross(p) * y + p.cross(q) * z) / det;
        det.abs() > 1e-9 && planes.iter().all(|(n, h)| n.dot(vertex) <= h + slack)
    };
    (0..12).any(|i| (i + 1..12).any(|j| (j + 1..12).any(|k| meets(i, j, k))))
}

fn places() -> impl Strategy<Value = (Placed, Placed, DVec3)> {
    let core = || prop::array::uniform3(0.2..1.0_f64);
    let turn = || prop::array::uniform4(-1.0..1.0_f64).prop_filter("a turn", |q| q.iter().any(|x| x.abs() > 0.1));
    (core(), turn(), core(), turn(), prop::array::uniform3(-2.5..2.5_f64), 0.0..0.2_f64)
        .prop_map(|(c, q, d, r, x, rounding)| (cuboid(c, q, rounding), cuboid(d, r, 0.0), DVec3::from(x)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// The least distance proves itself. Two points of the cores are that far apart, so it is not larger; a slab of
    /// that width fits between them, so it is not smaller. Lengths are up to 5, so rounding is 1e-15 per operation; the
    /// bounds leave room for a few hundred.
    #[test]
    fn the_distance_is_the_least((a, b, offset) in places()) {
        let pair = CuboidPair::new(offset, a, b);
        let nearest = pair.nearest();
        let distance = nearest.gap + a.rounding;
        let normal = nearest.normal;
        prop_assert!((normal.length() - 1.0).abs() < 1e-14);
        let width = normal.dot(offset) - reach(&a, normal) - reach(&b, normal);
        prop_assert!((width - distance).abs() < 1e-12, "{width} for {distance}: {nearest:?}");
        if distance > 0.0 {
            // The points lie on both skins, and are separated along the normal.
            let (p, q) = (nearest.arms[0] + normal * a.rounding, nearest.arms[1]);
            prop_assert!((onto(&a, p) - p).length() < 1e-13 && (onto(&b, q) - q).length() < 1e-13);
            // Where edges cross at a small angle, the place is known to rounding over the square of its sine.
            let sine_squared = match nearest.feature {
                Feature::Edges(e, f) => pair.sine_squared(usize::from(e.axis), usize::from(f.axis)),
                Feature::Corner { .. } => 1.0,
            };
            prop_assert!((offset + p - q - normal * distance).length() < 1e-14 / sine_squared + 1e-13, "{nearest:?}");
        } else {
            prop_assert!(overlap(&a, &b, offset, 1e-6), "{distance}: {nearest:?}");
        }
    }

    /// Seen from the other cuboid, everything is reversed, to the last bit.
    #[test]
    fn exchange_negates((a, b, offset) in places()) {
        let (one, two) = (CuboidPair::new(offset, a, b).nearest(), CuboidPair::new(-offset, b, a).nearest());
        prop_assert!((one.gap - two.gap).abs() <= 1e-14 && (one.normal + two.normal).length() < 1e-9, "{one:?} {two:?}");
    }

    /// Moved out along the normal by their overlap, cuboids just touch; moved by less, along the normal or any other
    /// direction, they do not part.
    #[test]
    fn overlaps_are_as_deep_as_they_say((a, b, offset) in places(), way in prop::array::uniform3(-1.0..1.0_f64)) {
        let nearest = CuboidPair::new(offset, a, b).nearest();
        let depth = -(nearest.gap + a.rounding);
        let way = DVec3::from(way).normalize_or(DVec3::Z);
        if depth > 1e-6 {
            let moved = |by: DVec3| overlap(&a, &b, offset + by * depth, 1e-12);
            prop_assert!(!moved(nearest.normal * 1.001) && moved(nearest.normal * 0.999) && moved(way * 0.999), "{nearest:?}");
        }
    }

    /// Every point of contact has the gap, and its feature the rate, that result from moving the cuboids a little.
    #[test]
    fn rates_of_gaps_are_right(
        (a, b, offset) in places(),
        v in prop::array::uniform3(-1.0..1.0_f64),
        w in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let pair = CuboidPair::new(offset, a, b);
        let nearest = pair.nearest();
        if nearest.gap < 1e-3 {
            return Ok(());
        }
        let (v, w) = (DVec3::from(v), DVec3::from(w));
        let h = 1e-6;
        let moved = |h: f64| {
            let turn = DMat3::from_quat(DQuat::from_scaled_axis(w * h));
            let turned = Placed { axes: turn * a.axes, ..a };
            CuboidPair::new(offset + v * h, turned, b).again(nearest.feature, nearest.normal)
        };
        let rate = (v + w.cross(nearest.arms[0])).dot(nearest.normal);
        let (after, before) = (moved(h), moved(-h));
        // Central differences: third derivatives are at most about 1/gap² ≤ 1e6 times h², rounding 1e-15/h.
        prop_assert!(((after.gap - before.gap) / (2.0 * h) - rate).abs() < 1e-5, "{} for {rate}", (after.gap - before.gap) / (2.0 * h));
        let turning = pair.turning(nearest.feature, nearest.normal, [w, DVec3::ZERO]);
        let is_inside = |region: [i8; 3]| region.iter().filter(|&&s| s != 0).count() == 1;
        if matches!(nearest.feature, Feature::Corner { region, .. } if is_inside(region)) {
            prop_assert!(((after.normal - before.normal) / (2.0 * h) - turning).length() < 1e-5);
        }
    }
}

/// A die on another, turned by 45°: the octagon of their faces. Not turned and moved by half an edge: the rectangle.
#[test]
fn faces_touch_at_the_corners_of_their_overlap() {
    let lower = cuboid([1.0, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0], 0.0);
    let count = |upper: Placed, offset: DVec3| {
        let pair = CuboidPair::new(offset, upper, lower);
        let mut points = Vec::new();
        pair.touching(&pair.nearest(), 1e-5, |m| {
            assert!((m.normal - DVec3::Z).length() < 1e-12 && (m.gap - 1e-6).abs() < 1e-12, "{m:?}");
            points.push(m.arms[1]);
        });
        points
    };
    let turned =
        count(cuboid([1.0, 1.0, 1.0], [0.0, 0.0, math::sin(EIGHTH), math::cos(EIGHTH)], 0.0), DVec3::Z * (2.0 + 1e-6));
    assert_eq!(turned.len(), 8);
    // An octagon of this square and the square turned by 45°: circumradius √(1 + (√2 − 1)²).
    let radius = (1.0 + (2.0_f64.sqrt() - 1.0) * (2.0_f64.sqrt() - 1.0)).sqrt();
    assert!(turned.iter().all(|p| (p.truncate().length() - radius).abs() < 1e-12), "{turned:?}");
    let half = count(lower, DVec3::new(1.0, 0.0, 2.0 + 1e-6));
    for corner in [(0.0, 1.0), (0.0, -1.0), (1.0, 1.0), (1.0, -1.0)] {
        assert!(half.iter().any(|p| (p.truncate() - glam::DVec2::from(corner)).length() < 1e-9), "{half:?}");
    }
    // Exactly on top of each other: four places.
    let flush = count(lower, DVec3::new(0.0, 0.0, 2.0 + 1e-6));
    assert!(flush.iter().all(|p| (p.truncate().abs() - 1.0).length() < 1e-9) && flush.len() >= 4, "{flush:?}");
}

/// Two ridges that cross at right angles; a corner over the middle of a face.
#[test]
fn ridges_cross_in_one_point() {
    let (s, c) = (math::sin(EIGHTH), math::cos(EIGHTH));
    let ridge = cuboid([1.0, 1.0, 1.0], [s, 0.0, 0.0, c], 0.1);
    let across = cuboid([1.0, 1.0, 1.0], [0.0, s, 0.0, c], 0.1);
    let pair = CuboidPair::new(DVec3::new(0.2, 0.3, 2.0 * 2.0_f64.sqrt() + 0.5), ridge, across);
    let nearest = pair.nearest();
    assert!(matches!(nearest.feature, Feature::Edges(..)) && (nearest.gap - 0.3).abs() < 1e-14, "{nearest:?}");
    let mut count = 0;
    pair.touching(&nearest, 0.31, |_| count += 1);
    assert_eq!(count, 1);
    let pair = CuboidPair::new(DVec3::new(0.2, 0.3, 2.0 * 2.0_f64.sqrt() - 0.01), ridge, across);
    assert!((pair.nearest().gap + 0.21).abs() < 1e-14);
}
