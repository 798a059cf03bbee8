//! Distances prove themselves: points on both surfaces, along a direction that keeps the bodies just as far apart.

use super::*;
use crate::shape::{ConvexHull, Solid};
use glam::DQuat;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn turn() -> impl Strategy<Value = DMat3> {
    let q = prop::array::uniform4(-1.0..1.0_f64).prop_filter("a turn", |q| q.iter().any(|x| x.abs() > 0.1));
    q.prop_map(|q| DMat3::from_quat(DQuat::from_array(q).normalize()))
}

/// Random, regular, and balls.
fn cores() -> impl Strategy<Value = Polyhedron> {
    let cloud = prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64).prop_map(DVec3::from), 5..20);
    let random = cloud.prop_filter_map("a hull", |points| Some(ConvexHull::new(&points, 0.0).ok()?.core));
    let regular = (0..5_usize).prop_map(|k| ConvexHull::new(&Solid::ALL[k].corners(1.0), 0.0).unwrap().core);
    prop_oneof![4 => random, 2 => regular, 1 => Just(Polyhedron::point())]
}

fn offset() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-2.5..2.5_f64).prop_map(DVec3::from)
}

/// Whether a point, about the centre of a core, is on its skin, except for rounding.
fn is_on_skin(placed: &Placed, p: DVec3) -> bool {
    let p = placed.axes.transpose() * p;
    match placed.core.farthest_face(p) {
        Some((_, beyond)) => beyond.abs() < 1e-12,
        None => p.length() < 1e-14,
    }
}

fn cases(cases: u32, seed: u64) -> ProptestConfig {
    ProptestConfig { rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..ProptestConfig::with_cases(cases) }
}

proptest! {
    #![proptest_config(cases(1500, 5))]

    #[test]
    fn distances_are_proved(a in cores(), b in cores(), r in turn(), s in turn(), offset in offset()) {
        let (p, q) = (Placed { axes: r, core: &a, rounding: 0.0 }, Placed { axes: s, core: &b, rounding: 0.0 });
        let pair = HullPair::new(offset, p, q);
        let m = pair.nearest(None);
        prop_assert!((m.normal.length() - 1.0).abs() < 1e-14);
        prop_assert!((m.gap - pair.apart(m.normal)).abs() < 1e-12, "{m:?}: planes {} apart", pair.apart(m.normal));
        if m.gap > 0.0 {
            prop_assert!(is_on_skin(&p, m.arms[0]) && is_on_skin(&q, m.arms[1]), "{m:?}");
            prop_assert!((offset + m.arms[0] - m.arms[1] - m.normal * m.gap).length() < 1e-12, "{m:?}");
        } else {
            // The shortest way out: moved along it, the bodies just touch, and none of many directions parts them
            // sooner.
            let out = HullPair::new(offset - m.normal * m.gap, p, q);
            prop_assert!(out.nearest(None).gap.abs() < 1e-10, "{m:?}: {:?}", out.nearest(None));
            for k in 0..200 {
                let z = (f64::from(k) + 0.5) / 100.0 - 1.0;
                let (sin, cos) = plaus_dist::math::sin_cos(2.4 * f64::from(k));
                let direction = (DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt()).with_z(z);
                prop_assert!(pair.apart(direction) <= m.gap + 1e-12, "{m:?}: {direction}");
            }
        }
        // Seen from the other polyhedron, everything is reversed.
        let back = HullPair::new(-offset, q, p).nearest(None);
        prop_assert!((back.gap - m.gap).abs() < 1e-12, "{m:?} {back:?}");
    }

    /// The features that were nearest at a nearby pose make no difference.
    #[test]
    fn guesses_do_not_matter(
        a in cores(),
        b in cores(),
        r in turn(),
        s in turn(),
        offset in offset(),
        w in offset(),
        h in 0.0..0.2_f64,
    ) {
        let turned = |h: f64| DMat3::from_quat(DQuat::from_scaled_axis(w * h)) * r;
        let place = |h: f64| Placed { axes: turned(h), core: &a, rounding: 0.01 };
        let other = Placed { axes: s, core: &b, rounding: 0.0 };
        let before = HullPair::new(offset, place(0.0), other).nearest(None);
        let pair = HullPair::new(offset * (1.0 - h), place(h), other);
        let (guessed, searched) = (pair.nearest(Some((before.feature, before.normal))), pair.nearest(None));
        prop_assert!((guessed.gap - searched.gap).abs() < 1e-11, "{guessed:?} {searched:?}");
    }

    /// A cuboid, whose support function is a closed form, and the hull of its corners, whose is a search.
    #[test]
    fn a_cuboid_is_the_hull_of_its_corners(
        c in prop::array::uniform3(0.2..1.0_f64),
        d in cores(),
        r in turn(),
        s in turn(),
        offset in offset(),
    ) {
        let cuboid = Polyhedron::cuboid(DVec3::from(c));
        let hull = ConvexHull::new(&cuboid.corners, 0.0).unwrap().core;
        let gap = |first: &Polyhedron| {
            let placed = [Placed { axes: r, core: first, rounding: 0.0 }, Placed { axes: s, core: &d, rounding: 0.0 }];
            HullPair::new(offset, placed[0], placed[1]).nearest(None).gap
        };
        let (x, y) = (gap(&cuboid), gap(&hull));
        prop_assert!((x - y).abs() < 1e-12, "{x} {y}");
    }

    /// Every point of contact has the gap and the rate that result from moving the bodies a little.
    #[test]
    fn rates_of_gaps_are_right(
        a in cores(),
        b in cores(),
        r in turn(),
        s in turn(),
        offset in offset(),
        v in offset(),
        w in offset(),
    ) {
        let turned = |h: f64| DMat3::from_quat(DQuat::from_scaled_axis(w * h)) * r;
        let place = |h: f64| Placed { axes: turned(h), core: &a, rounding: 0.0 };
        let other = Placed { axes: s, core: &b, rounding: 0.0 };
        let nearest = HullPair::new(offset, place(0.0), other).nearest(None);
        if nearest.gap < 1e-2 {
            return Ok(());
        }
        let h = 1e-6;
        let moved = |h: f64| HullPair::new(offset + v * h, place(h), other).again(nearest.feature, nearest.normal);
        let rate = (v + w.cross(nearest.arms[0])).dot(nearest.normal);
        let (after, before) = (moved(h), moved(-h));
        // Central differences: third derivatives are at most about (speed/gap)² ≤ 1e7 times h², rounding 1e-15/h.
        prop_assert!(((after.gap - before.gap) / (2.0 * h) - rate).abs() < 1e-4, "{} for {rate}", (after.gap - before.gap) / (2.0 * h));
    }
}

fn solid(solid: Solid) -> Polyhedron {
    ConvexHull::new(&solid.corners(1.0), 0.0).unwrap().core
}

fn points(pair: &HullPair, within: f64) -> Vec<Meeting> {
    let mut points = Vec::new();
    pair.touching(&pair.nearest(None), within, |m| points.push(m));
    points
}

/// A cube on another, turned by 45°: the octagon of their faces. A pentagon on the square: corners over the square, and
/// crossings of the sides.
#[test]
fn faces_touch_at_the_corners_of_their_overlap() {
    let cube = solid(Solid::Cube);
    let place = |core, axes| Placed { axes, core, rounding: 0.0 };
    let lower = place(&cube, DMat3::IDENTITY);
    let eighth = DMat3::from_rotation_z(std::f64::consts::FRAC_PI_4);
    let octagon = points(&HullPair::new(DVec3::Z * (1.0 + 1e-6), place(&cube, eighth), lower), 1e-5);
    assert_eq!(octagon.len(), 8);
    assert!(octagon.iter().all(|m| (m.normal - DVec3::Z).length() < 1e-12 && (m.gap - 1e-6).abs() < 1e-12));
    let flush = points(&HullPair::new(DVec3::Z * (1.0 + 1e-6), lower, lower), 1e-5);
    assert!(flush.len() >= 4 && flush.iter().all(|m| (m.arms[1].truncate().abs() - 0.5).length() < 1e-9), "{flush:?}");
    // A pentagon of the dodecahedron, one of whose corners hangs over the edge of a cube.
    let dodecahedron = solid(Solid::Dodecahedron);
    let face = &dodecahedron.faces[0];
    let down = DMat3::from_quat(DQuat::from_rotation_arc(face.normal, -DVec3::Z));
    let corner = down * dodecahedron.corner(face.corners[0]);
    let out = corner.truncate().normalize();
    let level = DMat3::from_rotation_z(-plaus_dist::math::atan2(out.y, out.x)) * down;
    let height = face.offset + 0.5 + 1e-6;
    let hangs = points(&HullPair::new(DVec3::new(0.0, 0.0, height), place(&dodecahedron, level), lower), 1e-5);
    // Circumradius 0.85 of a pentagon with edge 1: the corner at +x is beyond the edge, those at ±144° hardly; the
    // square's corners are outside or inside.
    let inside = |m: &&Meeting| m.arms[1].x.abs() < 0.5 + 1e-9 && m.arms[1].y.abs() < 0.5 + 1e-9;
    assert!(hangs.iter().all(|m| inside(&m) && (m.gap - 1e-6).abs() < 1e-12), "{hangs:?}");
    assert!((5..=9).contains(&hangs.len()), "{}", hangs.len());
}

/// A ball over a face, an edge and a corner of a cube, and a ball with its middle inside the cube.
#[test]
fn balls_are_points_with_a_rounding() {
    let (cube, point) = (solid(Solid::Cube), Polyhedron::point());
    let gap = |x: DVec3| {
        let ball = Placed { axes: DMat3::IDENTITY, core: &point, rounding: 0.2 };
        let m = HullPair::new(x, ball, Placed { axes: DMat3::IDENTITY, core: &cube, rounding: 0.0 }).nearest(None);
        (m.gap, m.normal)
    };
    let check = |x: DVec3, distance: f64, normal: DVec3| {
        let (g, n) = gap(x);
        assert!((g - (distance - 0.2)).abs() < 1e-15 && (n - normal).length() < 1e-14, "{g} {n} at {x}");
    };
    check(DVec3::new(0.1, 0.2, 0.9), 0.4, DVec3::Z);
    check(DVec3::new(0.1, 0.8, 0.9), 0.5, DVec3::new(0.0, 0.6, 0.8));
    check(DVec3::splat(0.6), 0.1 * 3.0_f64.sqrt(), DVec3::ONE.normalize());
    check(DVec3::new(0.1, -0.4, 0.2), -0.1, -DVec3::Y);
}

/// A ball that is about to touch a tetrahedron does so at its nearest point only. Beyond an edge of it, a point can be
/// above one face alone and yet not over that face.
#[test]
fn balls_touch_sharp_edges_where_they_are_nearest() {
    let (tetrahedron, point) = (solid(Solid::Tetrahedron), Polyhedron::point());
    let placed = |core, rounding| Placed { axes: DMat3::IDENTITY, core, rounding };
    let mut at_edges = 0;
    for k in 0..4000 {
        let [x, y, z] = [0.754_877, 0.569_840, 0.438_579].map(|step: f64| 3.0 * (step * f64::from(k)).fract() - 1.5);
        let pair = |radius| HullPair::new(DVec3::new(x, y, z), placed(&point, radius), placed(&tetrahedron, 0.0));
        let distance = pair(0.0).nearest(None).gap;
        if distance < 0.05 {
            continue;
        }
        let pair = pair(distance * (1.0 - 1e-9));
        let (nearest, found) = (pair.nearest(None), points(&pair, 1e-8));
        assert!(found.len() == 1 && (found[0].normal - nearest.normal).length() < 1e-9, "{nearest:?}: {found:?}");
        let faces = tetrahedron.faces.iter().filter(|face| face.normal.dot(DVec3::new(x, y, z)) > face.offset).count();
        at_edges += usize::from(faces == 1 && tetrahedron.faces.iter().all(|f| f.normal.dot(nearest.normal) < 0.999));
    }
    assert!(at_edges > 100, "{at_edges}");
}
