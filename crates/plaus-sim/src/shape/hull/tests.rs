//! Compares with closed forms, and with sums over a lattice, which do not use faces.

use super::integrals::outer;
use super::*;
use crate::shape::{Cuboid, Shape};
use proptest::prelude::*;

fn hull(points: &[DVec3], rounding: f64) -> ConvexHull {
    ConvexHull::new(points, rounding).unwrap()
}

/// Rounding of sums of a few dozen terms.
fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-14 * b.abs()
}

/// Edge 1: volume, moment over mass. Textbook.
#[test]
fn regular_solids_have_their_moments() {
    let (r2, r5) = (2.0_f64.sqrt(), 5.0_f64.sqrt());
    for (solid, volume, moment) in [
        (Solid::Tetrahedron, r2 / 12.0, 0.05),
        (Solid::Cube, 1.0, 1.0 / 6.0),
        (Solid::Octahedron, r2 / 3.0, 0.1),
        (Solid::Dodecahedron, (15.0 + 7.0 * r5) / 4.0, (95.0 + 39.0 * r5) / 300.0),
        (Solid::Icosahedron, 5.0 * (3.0 + r5) / 12.0, (3.0 + r5) / 20.0),
    ] {
        let body = hull(&solid.corners(1.0), 0.0);
        assert_eq!(
            (body.faces().count(), body.edges().count()),
            (solid.faces(), body.corners().len() + solid.faces() - 2)
        );
        let mass = body.mass_properties(3.0);
        assert!(close(mass.mass, 3.0 * volume), "{solid:?}: {mass:?}");
        assert!(close(mass.inertia.x, moment * mass.mass), "{solid:?}: {mass:?}");
        // Equal to the bit, and along the given axes: free rotation is uniform.
        assert!(mass.inertia.x == mass.inertia.y && mass.inertia.y == mass.inertia.z);
        assert_eq!(body.turn(), DQuat::IDENTITY);
        assert!(
            body.edges().all(|[a, b]| close((body.corners()[a as usize] - body.corners()[b as usize]).length(), 1.0))
        );
    }
}

#[test]
fn a_cuboid_is_the_hull_of_its_corners() {
    for (edges, rounding) in [(DVec3::new(1.0, 2.0, 3.0), 0.0), (DVec3::new(0.7, 0.4, 0.4), 0.05), (DVec3::ONE, 0.3)] {
        let cuboid = Cuboid::new(edges, rounding).unwrap();
        let body = hull(&cuboid.corners(), rounding);
        let (p, q) = (body.mass_properties(2.0), cuboid.mass_properties(2.0));
        assert!(close(p.mass, q.mass) && (0..3).all(|k| close(p.inertia[k], q.inertia[k])), "{p:?} {q:?}");
        let (own, other) = (Shape::Hull(body.clone().into()), Shape::Cuboid(cuboid));
        assert!(close(own.reach(), other.reach()) && close(own.size(), other.size()));
        assert_eq!(body.core.corners, Polyhedron::cuboid(cuboid.half() - rounding).corners);
        assert_eq!(body.turn(), DQuat::IDENTITY);
    }
}

/// For any tetrahedron, about its middle: `V/20 Σ v vᵀ`.
#[test]
fn axes_are_principal_and_reported() {
    let points = [[0.3, 0.1, -0.2], [1.4, 0.2, 0.1], [0.2, 0.9, 0.3], [0.5, 0.4, 2.0]].map(DVec3::from);
    let body = hull(&points, 0.0);
    let middle = (points[0] + points[1] + points[2] + points[3]) * 0.25;
    assert!((body.centre() - middle).length() < 1e-15);
    let volume = (points[1] - points[0]).cross(points[2] - points[0]).dot(points[3] - points[0]) / 6.0;
    assert!(close(body.volume(), volume));
    let about = points.iter().fold(DMat3::ZERO, |s, &p| s + outer(p - middle, p - middle)) * (volume / 20.0);
    let trace = about.x_axis.x + about.y_axis.y + about.z_axis.z;
    let turn = DMat3::from_quat(body.turn());
    let back = turn * DMat3::from_diagonal(body.mass_properties(1.0).inertia) * turn.transpose();
    let tensor = DMat3::from_diagonal(DVec3::splat(trace)) - about;
    assert!((0..3).all(|k| (back.col(k) - tensor.col(k)).length() < 1e-15), "{back} for {tensor}");
    for (corner, &k) in body.corners().iter().zip(body.indices()) {
        assert!((body.centre() + body.turn() * *corner - points[k]).length() < 1e-15);
    }
}

/// A lattice of cells whose middles are in the body. Each cell on the skin is wrong by at most half of it, at random,
/// so 64³ cells are exact to well below 1e-3.
#[test]
fn rounding_agrees_with_a_plain_sum() {
    let points =
        [[1.0, 0.1, 0.0], [-0.6, 0.8, 0.1], [-0.5, -0.9, 0.0], [0.1, 0.2, 1.1], [0.2, 0.1, -0.7]].map(DVec3::from);
    let body = hull(&points, 0.25);
    let (n, most) = (64, body.reach());
    let step = 2.0 * most / f64::from(n);
    let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
    for k in 0..n * n * n {
        let x = DVec3::new(f64::from(k % n), f64::from(k / n % n), f64::from(k / n / n));
        let x = (x + 0.5) * step - most;
        let inside = body.core.farthest_face(x).unwrap().1 <= 0.0;
        let near = || match body.core.nearest(x) {
            On::Face(k) => body.core.face(k).normal.dot(x) - body.core.face(k).offset <= 0.25,
            _ => body.core.nearest_edge(x).1 <= 0.25 * 0.25,
        };
        if inside || near() {
            volume += 1.0;
            first += x;
            second += outer(x, x);
        }
    }
    let cell = step * step * step;
    assert!((volume * cell / body.volume() - 1.0).abs() < 1e-3, "{} {}", volume * cell, body.volume());
    assert!((first * cell / body.volume()).length() < 1e-3, "{first}");
    let inertia = body.mass_properties(1.0).inertia;
    for k in 0..3 {
        let about = (second.col((k + 1) % 3)[(k + 1) % 3] + second.col((k + 2) % 3)[(k + 2) % 3]) * cell;
        assert!((about / inertia[k] - 1.0).abs() < 2e-3, "{about} {inertia}");
        assert!((second.col(k)[(k + 1) % 3] * cell).abs() < 1e-3 * inertia[k], "{second}");
    }
}

#[test]
fn points_inside_or_on_a_face_do_no_harm() {
    let cube = Solid::Cube.corners(2.0);
    let mut points = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.3, 1.0, -0.2), DVec3::new(1.0, 1.0, 0.5)];
    points.extend(&cube);
    points.extend([cube[3], cube[3] + DVec3::splat(1e-13)]);
    let body = hull(&points, 0.0);
    assert_eq!(body.core.corners, cube);
    assert!(body.faces().all(|f| f.len() == 4));
    assert_eq!(body.indices(), [4, 5, 6, 7, 8, 9, 10, 11]);
}

#[test]
fn bad_points_are_named() {
    let cube = Solid::Cube.corners(1.0);
    let with = |point| [&cube[..], &[point]].concat();
    let err = |points: &[DVec3]| ConvexHull::new(points, 0.0).unwrap_err();
    assert!(matches!(err(&with(DVec3::new(0.0, f64::NAN, 0.0))), WorldError::BadPoint { point: 8, .. }));
    assert!(matches!(err(&with(DVec3::X * f64::INFINITY)), WorldError::BadPoint { point: 8, .. }));
    assert!(matches!(err(&cube[..3]), WorldError::FewPoints { points: 3 }));
    assert!(matches!(err(&[cube[0], cube[1], cube[2], cube[0]]), WorldError::FewPoints { points: 3 }));
    let flat: Vec<DVec3> = (0..9).map(|k| DVec3::new(f64::from(k % 3), f64::from(k / 3), f64::from(k))).collect();
    assert!(matches!(err(&flat), WorldError::FlatHull { points: 9, .. }), "{}", err(&flat));
    let line: Vec<DVec3> = (0..5).map(|k| DVec3::splat(f64::from(k))).collect();
    assert!(matches!(err(&line), WorldError::FlatHull { points: 5, .. }));
    for rounding in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(ConvexHull::new(&cube, rounding), Err(WorldError::BadNumber { field: "rounding", .. })));
    }
    let prism: Vec<DVec3> =
        (0..26).map(|k| (DQuat::from_rotation_z(0.5 * f64::from(k / 2)) * DVec3::X).with_z(f64::from(k % 2))).collect();
    assert!(matches!(err(&prism), WorldError::LargeHull { what: "corners of a face", .. }), "{}", err(&prism));
}

fn clouds() -> impl Strategy<Value = Vec<DVec3>> {
    prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64).prop_map(DVec3::from), 4..24)
}

proptest! {
    #![proptest_config(ProptestConfig {
        rng_seed: proptest::test_runner::RngSeed::Fixed(3),
        failure_persistence: None,
        ..ProptestConfig::with_cases(300)
    })]

    /// Every point is behind every face, every corner is a point, and scaling by powers of two scales all numbers to
    /// the bit.
    #[test]
    fn hulls_hold_their_points(points in clouds()) {
        let body = hull(&points, 0.0);
        for &p in &points {
            let seen = body.turn().conjugate() * (p - body.centre());
            prop_assert!(body.core.farthest_face(seen).unwrap().1 < 1e-9);
        }
        for f in &body.core.faces {
            let is_on_it = |&k| (f.normal.dot(body.core.corner(k)) - f.offset).abs() < 2e-9;
            prop_assert!(f.offset > 0.0 && f.corners.iter().all(is_on_it));
        }
        let large = hull(&points.iter().map(|&p| p * 4.0).collect::<Vec<_>>(), 0.0);
        prop_assert_eq!(large.turn(), body.turn());
        prop_assert_eq!(large.corners(), body.corners().iter().map(|&c| c * 4.0).collect::<Vec<_>>());
        prop_assert_eq!(large.mass_properties(1.0).inertia, body.mass_properties(1.0).inertia * 1024.0);
    }

    /// What is nearest to a point outside is no farther than any point of the surface that is tried: corners, and
    /// points on faces and edges. The part that is nearest to the opposite point is farther.
    #[test]
    fn nothing_is_nearer_than_the_nearest_part(
        points in clouds(),
        from in prop::array::uniform3(-2.0..2.0_f64).prop_map(DVec3::from),
        shares in prop::collection::vec(0.0..1.0_f64, 64),
    ) {
        let core = &hull(&points, 0.0).core;
        prop_assume!(core.farthest_face(from).unwrap().1 > 0.0 && core.farthest_face(-from).unwrap().1 > 0.0);
        let on = |on: On| match on {
            On::Face(k) => from - core.face(k).normal * (core.face(k).normal.dot(from) - core.face(k).offset),
            On::Edge(k) => {
                let e = &core.edges[usize::from(k)];
                let corner = core.corner(e.ends[0]);
                corner + e.along * (from - corner).dot(e.along).clamp(0.0, e.length)
            }
            On::Corner(k) => core.corner(k),
        };
        let away = (on(core.nearest(from)) - from).length();
        let mut share = shares.iter().cycle();
        let mut next = || share.next().unwrap();
        for face in &core.faces {
            let corner = |k: usize| core.corner(face.corners[k % face.corners.len()]);
            for k in 0..face.corners.len() {
                let (a, b, c) = (corner(0), corner(k), corner(k + 1));
                let (on_edge, on_face) = (b + (c - b) * next(), a + (b - a + (c - b) * next()) * next());
                for tried in [b, on_edge, on_face] {
                    prop_assert!((tried - from).length() >= away - 1e-9, "{tried} is nearer to {from}");
                }
            }
        }
        prop_assert!((on(core.nearest(-from)) - from).length() > away);
    }
}
