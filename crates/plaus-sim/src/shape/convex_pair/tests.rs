//! Pairs of pieces at random poses, tested by the proof of nearest points and by a search over directions.

use super::{Both, Mark, nearest};
use crate::shape::frustum::Discs;
use crate::shape::piece::{Core, Piece, Placed};
use crate::shape::{ConvexHull, Polyhedron, Solid};
use glam::{DMat3, DQuat, DVec3};
use std::sync::Arc;

/// Numbers that fill [0, 1) evenly.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }

    fn turn(&mut self) -> DQuat {
        let v = self.vector();
        DQuat::from_xyzw(v.x, v.y, v.z, 2.0 * self.next() - 1.0).normalize()
    }
}

fn kinds() -> Vec<(&'static str, Piece)> {
    let discs = |heights, radii, rounding| {
        Piece::new(Core::Discs(Discs::new(heights, radii)), rounding, DVec3::ZERO, DMat3::IDENTITY)
    };
    let hull = |core: Polyhedron, rounding| {
        Piece::new(Core::Polyhedron(Arc::new(core)), rounding, DVec3::ZERO, DMat3::IDENTITY)
    };
    let rock = ConvexHull::new(&Solid::Icosahedron.corners(0.5), 0.0).unwrap();
    let triangle = vec![DVec3::new(0.6, 0.0, 0.0), DVec3::new(-0.3, 0.4, 0.0), DVec3::new(-0.3, -0.4, 0.0)];
    vec![
        ("cylinder", discs([-0.4, 0.4], [0.3, 0.3], 0.0)),
        ("coin", discs([-0.02, 0.02], [0.5, 0.5], 0.0)),
        ("cone", discs([-0.3, 0.5], [0.4, 0.0], 0.0)),
        ("capsule", discs([-0.4, 0.4], [0.0, 0.0], 0.2)),
        ("disc", discs([0.0, 0.0], [0.4, 0.4], 0.05)),
        ("rounded frustum", discs([-0.2, 0.3], [0.5, 0.2], 0.05)),
        ("ball", Piece::ball(0.3, DVec3::ZERO)),
        ("box", hull(Polyhedron::cuboid(DVec3::new(0.5, 0.3, 0.2)), 0.0)),
        ("hull", hull(rock.core.clone(), 0.03)),
        ("triangle", hull(Polyhedron::new(triangle, &[vec![0, 1, 2], vec![0, 2, 1]]), 0.0)),
    ]
}

/// The direction in which two pieces are farthest apart, by climbing from a start: a lower bound on their distance.
fn climbed(both: &Both, start: DVec3) -> f64 {
    let (mut n, mut best, mut step) = (start, both.apart(start), 0.3);
    while step > 1e-7 {
        let (u, v) = n.any_orthonormal_pair();
        let mut better = false;
        for (x, y) in
            [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.7, 0.7), (-0.7, 0.7), (0.7, -0.7), (-0.7, -0.7)]
        {
            let m = (n + (u * x + v * y) * step).normalize();
            let apart = both.apart(m);
            if apart > best {
                (n, best, better) = (m, apart, true);
            }
        }
        if !better {
            step *= 0.5;
        }
    }
    best
}

/// Poses of each pair, from `PLAUS_POSES`.
fn poses() -> u32 {
    std::env::var("PLAUS_POSES").ok().and_then(|n| n.parse().ok()).unwrap_or(30)
}

/// Of many poses, every so many overlaps are climbed out of: that takes a hundred times as long as the rest.
const CLIMBED: u32 = 100;

/// Where pieces are apart, the points called nearest are proved nearest: the planes across the normal keep the cores as
/// far apart as the points are, to 1e-9 of their size. The points are on the skins.
#[test]
fn nearest_points_are_proved() {
    let (kinds, poses) = (kinds(), poses());
    let mut numbers = Numbers(5);
    let (mut apart, mut within, mut faults) = (0, 0, Vec::new());
    for (i, (one, a)) in kinds.iter().enumerate() {
        for (j, (other, b)) in kinds.iter().enumerate() {
            for pose in 0..poses {
                let turns = [DMat3::from_quat(numbers.turn()), DMat3::from_quat(numbers.turn())];
                let centre = numbers.vector() * (0.4 + 1.2 * numbers.next());
                let both = Both { first: a.placed(&turns[0], centre), second: b.placed(&turns[1], DVec3::ZERO) };
                let m = nearest(&both);
                let (size, distance) = (both.size(), m.gap + both.roundings());
                let kept = both.apart(m.normal);
                assert!((m.normal.length() - 1.0).abs() < 1e-12);
                let case = || format!("{one} and {other}, pose {pose}: {distance} for {kept}");
                if distance > 1e-6 {
                    apart += 1;
                    if (distance - kept).abs() >= 1e-9 * size {
                        faults.push(case());
                    }
                    for of in 0..2 {
                        let on = both.piece(of).project(m.points[of]).1 - both.piece(of).rounding;
                        if on.abs() >= 1e-9 * size {
                            faults.push(format!("{}, {on} off the skin", case()));
                        }
                    }
                } else if i != 6 && j != 6 && i < 9 && j < 9 {
                    within += 1;
                    if (distance - kept).abs() > 1e-9 * size {
                        faults.push(case());
                    }
                    if poses > CLIMBED && pose % CLIMBED != 0 {
                        continue;
                    }
                    // Overlapping: no direction climbed to from it, or from some others, keeps them much less deep.
                    let starts = [m.normal, numbers.vector().normalize(), centre.normalize()];
                    let best = starts.into_iter().map(|n| climbed(&both, n)).fold(f64::NEG_INFINITY, f64::max);
                    // Where pieces are deep in each other, another direction may be better; pieces in contact are never
                    // that deep. Climbing ends within 1e-8 of a kink.
                    let allowed = 1e-7 * size + if best > -0.02 * size { 0.0 } else { 0.3 * -best };
                    if distance < best - allowed {
                        faults.push(format!("{}, but {best}", case()));
                    }
                }
            }
        }
    }
    assert!(faults.is_empty(), "{} faults in {apart} + {within}:\n{}", faults.len(), faults.join("\n"));
    assert!(apart > 1000 && within > 250, "{apart} {within}");
}

/// However deep a capsule is in a box, the way out is the shortest of all: its normal is that of a face of the sum of
/// box and segment, so of a face of the box, or it is across an edge and the segment.
#[test]
fn a_capsule_in_a_box_is_as_deep_as_the_sum_of_both_says() {
    let (kinds, mut numbers) = (kinds(), Numbers(31));
    let (capsule, cuboid) = (&kinds[3].1, &kinds[7].1);
    let mut deep = 0;
    for pose in 0..2000 {
        let turns = [DMat3::from_quat(numbers.turn()), DMat3::from_quat(numbers.turn())];
        let both = Both {
            first: capsule.placed(&turns[0], numbers.vector() * 0.3),
            second: cuboid.placed(&turns[1], DVec3::ZERO),
        };
        let (axis, sides) = (turns[0].z_axis, [turns[1].x_axis, turns[1].y_axis, turns[1].z_axis]);
        let normals = sides.into_iter().chain(sides.map(|s| s.cross(axis).normalize()));
        let truth = normals.flat_map(|n| [both.apart(n), both.apart(-n)]).fold(f64::NEG_INFINITY, f64::max);
        if truth < -1e-3 {
            deep += 1;
            let depth = nearest(&both).gap + both.roundings();
            assert!((depth - truth).abs() < 1e-9, "pose {pose}: {depth} for {truth}");
        }
    }
    assert!(deep > 1000, "{deep}");
}

/// Discs that go through a triangle are never told to be apart from it: if a distance is told, a plane proves it. Of
/// these poses, some were told so when a way out could end behind the triangle.
#[test]
fn what_goes_through_a_triangle_is_not_apart_from_it() {
    let (kinds, mut numbers) = (kinds(), Numbers(37));
    let mut faults = Vec::new();
    for pose in 0..30_000 {
        let (other, b) = &kinds[pose % 6];
        let turns = [DMat3::from_quat(numbers.turn()), DMat3::from_quat(numbers.turn())];
        let (triangle, centre) = (&kinds[9].1, numbers.vector() * (0.4 + 1.2 * numbers.next()));
        let [first, second] = if pose % 12 < 6 { [triangle, b] } else { [b, triangle] };
        let both = Both { first: first.placed(&turns[0], centre), second: second.placed(&turns[1], DVec3::ZERO) };
        let m = nearest(&both);
        let (distance, kept) = (m.gap + both.roundings(), both.apart(m.normal));
        if distance > 1e-6 && (distance - kept).abs() > 1e-9 {
            faults.push(format!("pose {pose}, {other}: {distance} for {kept}"));
        }
    }
    assert!(faults.is_empty(), "{faults:?}");
}

/// A point of contact found again at the same pose is the same point. All points have at most the gap asked for, and
/// one of them has the least gap.
#[test]
fn points_of_contact_are_found_again() {
    let kinds = kinds();
    let mut numbers = Numbers(11);
    let mut most = 0;
    // A triangle belongs to a mesh, which is always the second and is seen from outside.
    for (one, a) in &kinds[..9] {
        for (other, b) in &kinds {
            for flat in [true, false] {
                for _ in 0..20 {
                    // Many lie flat on each other.
                    let turn = if flat { DMat3::IDENTITY } else { DMat3::from_quat(numbers.turn()) };
                    let turns = [turn, DMat3::from_quat(DQuat::from_rotation_z(6.0 * numbers.next()))];
                    let side = numbers.vector() * 0.3;
                    let mut both = Both {
                        first: a.placed(&turns[0], DVec3::new(side.x, side.y, 1.5)),
                        second: b.placed(&turns[1], DVec3::ZERO),
                    };
                    let above = nearest(&both);
                    both.first = Placed { centre: both.first.centre - above.normal * (above.gap - 1e-4), ..both.first };
                    let m = nearest(&both);
                    let (mut least, mut count) = (f64::INFINITY, 0);
                    both.touching(&m, 2e-4, |t| {
                        count += 1;
                        least = least.min(t.gap);
                        let again = both.again(t.mark, t.normal);
                        assert!(
                            t.gap <= 2e-4 && (again.gap - t.gap).abs() < 1e-12,
                            "{one} on {other}: {t:?} {again:?}"
                        );
                        assert!((again.points[0] - t.points[0]).length() < 1e-9, "{one} on {other}: {t:?} {again:?}");
                    });
                    most = most.max(count);
                    // For two polyhedra, a corner beside a face by less than `within` counts as over it, and crossings
                    // of edges that near to a corner are left to the corner; so does a disc level with a face.
                    let is_level = both.level_face(2e-4).is_some();
                    let off = if is_level || matches!(m.mark, Mark::Polyhedra(_)) { 2e-4 } else { 1e-8 };
                    assert!(count > 0 && (least - m.gap).abs() < off, "{one} on {other}: {least} for {m:?}");
                }
            }
        }
    }
    assert!(most >= 4, "{most}");
}

/// Cylinders that lie on the rim of an upright one: a rim's lowest point is found again where it was, also if it is
/// looked for along the axis of the upright one, which is the normal at its middle.
#[test]
fn the_lowest_point_of_a_rim_is_found_again_along_its_axis() {
    let (can, mut numbers, mut seen) = (&kinds()[0].1, Numbers(31), [0; 2]);
    for case in 0..300 {
        let tilt = DQuat::from_rotation_y(1.2 + 0.3 * numbers.next());
        let turns = [DMat3::from_quat(DQuat::from_rotation_z(6.0 * numbers.next()) * tilt), DMat3::IDENTITY];
        let shift = DVec3::new(0.6 * numbers.next() - 0.3, 0.6 * numbers.next() - 0.3, 1.5);
        let mut both = Both { first: can.placed(&turns[0], shift), second: can.placed(&turns[1], DVec3::ZERO) };
        let above = nearest(&both);
        both.first = Placed { centre: both.first.centre - above.normal * (above.gap - 1e-4), ..both.first };
        both.touching(&nearest(&both), 2e-4, |m| {
            let Mark::Rim { of, slot: 0, .. } = m.mark else { return };
            seen[usize::from(of)] += 1;
            let again = both.again(m.mark, DVec3::Z);
            assert!((again.points[0] - m.points[0]).length() < 1e-9, "{case}: {m:?} {again:?}");
        });
    }
    assert!(seen.iter().all(|&n| n > 20), "{seen:?}");
}

/// A point in the plane of a triangle is as far from it as from its nearest side.
#[test]
fn a_point_beside_a_triangle_is_not_on_it() {
    let triangle = &kinds()[9].1;
    for (x, y, distance) in [(-2.3, 0.1, 2.0), (1.6, 0.0, 1.0), (0.0, 0.0, 0.0)] {
        let found = triangle.placed(&DMat3::IDENTITY, DVec3::ZERO).project(DVec3::new(x, y, 0.0)).1;
        assert!((found - distance).abs() < 1e-12, "{x}, {y}: {found}");
    }
}

/// Cylinders that stand on each other, a little apart or slightly overlapping, wherever their rims cross. All points of
/// contact are along the axis, including the crossings. A point at a rim is as near to the side as to the disc.
#[test]
fn discs_that_lie_on_each_other_meet_along_their_axis() {
    let (kinds, mut numbers) = (kinds(), Numbers(23));
    let can = &kinds[0].1;
    for case in 0..300 {
        let gap = [1e-7, 0.0, -1e-9, -1e-7, -1e-6][case % 5];
        let turned = |by: f64| DMat3::from_quat(DQuat::from_rotation_z(by));
        let (aside, angle) = (0.02 + 0.56 * numbers.next(), 6.0 * numbers.next());
        let shift = turned(angle) * DVec3::X * aside + DVec3::Z * (0.8 + gap);
        let both = Both {
            first: can.placed(&turned(6.0 * numbers.next()), shift),
            second: can.placed(&turned(6.0 * numbers.next()), DVec3::ZERO),
        };
        let known = nearest(&both);
        let mut found = Vec::new();
        both.touching(&known, 1e-5, |m| found.push(m));
        assert!((known.gap - gap).abs() < 1e-12 && known.normal.z > 1.0 - 1e-9, "{case}: {known:?}");
        let crossings = found.iter().filter(|m| matches!(m.mark, Mark::Rims { .. })).count();
        assert_eq!(crossings, 2, "{case}: {found:?}");
        for m in &found {
            assert!((m.gap - gap).abs() < 1e-12 && m.normal.z > 1.0 - 1e-9, "{case}: {m:?}");
            assert!(m.mark != Mark::Nearest || found.len() < 4, "{case}: {m:?}");
            let again = both.again(m.mark, m.normal);
            assert!((again.points[0] - m.points[0]).length() < 1e-9 && again.normal.z > 0.9, "{case}: {again:?}");
        }
    }
}

/// A cylinder that hangs over an edge of a box, a little apart or slightly overlapping: the two points where the edge
/// crosses its rim are points of contact, along its axis. No gap is 0 here: a normal would then be rounding.
#[test]
fn a_disc_meets_an_edge_at_both_ends_of_its_chord() {
    let (kinds, mut numbers) = (kinds(), Numbers(29));
    let (can, cuboid) = (&kinds[0].1, &kinds[7].1);
    for case in 0..300 {
        let gap = [1e-7, 1e-9, -1e-9, -1e-7, -1e-6][case % 5];
        let (turned, aside) = (DMat3::from_quat(numbers.turn()), 0.05 + 0.2 * numbers.next());
        let spun = DMat3::from_quat(DQuat::from_rotation_z(6.0 * numbers.next()));
        let ring = if case % 2 == 0 { 1.0 } else { -1.0 };
        let shift = turned * DVec3::new(0.5 - aside, 0.0, -ring * (0.6 + gap));
        let [a, b] = [can.placed(&(turned * spun), shift), cuboid.placed(&turned, DVec3::ZERO)];
        for (both, towards) in [(Both { first: a, second: b }, -ring), (Both { first: b, second: a }, ring)] {
            let known = nearest(&both);
            let mut found = Vec::new();
            both.touching(&known, 1e-5, |m| found.push(m));
            for side in [-1.0, 1.0] {
                let end = turned * DVec3::new(0.5, side * (0.09 - aside * aside).sqrt(), -ring * 0.2);
                assert!(found.iter().any(|m| (m.points[0] - end).length() < 1e-5), "{case}: {end} {found:?}");
            }
            for m in &found {
                let along = m.normal.dot(turned.z_axis) * towards;
                assert!((m.gap - gap).abs() < 1e-12 && along > 1.0 - 1e-9, "{case}: {m:?}");
                let again = both.again(m.mark, m.normal);
                assert!((again.points[0] - m.points[0]).length() < 1e-9 && again.normal.dot(m.normal) > 0.9);
            }
        }
    }
}
