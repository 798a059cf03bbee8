//! Concave meshes in convex pieces.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use glam::DVec3;
use plaus_asset::Triangles;
use plaus_asset::pieces::{Surface, pieces};

/// An L of two bars, 2 × 2 × 0.5 with a width of 0.5.
fn angle() -> Triangles {
    let profile = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.5], [0.5, 0.5], [0.5, 2.0], [0.0, 2.0]];
    let corners: Vec<DVec3> = [0.0, 0.5].into_iter().flat_map(|z| profile.map(|[x, y]| DVec3::new(x, y, z))).collect();
    let sides = (0..6).flat_map(|i| {
        let j = (i + 1) % 6;
        [[i, j, j + 6], [i, j + 6, i + 6]]
    });
    let ends = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    let ends = ends.into_iter().flat_map(|[a, b, c]| [[a, c, b], [a + 6, b + 6, c + 6]]);
    Triangles::new("angle", &corners, &sides.chain(ends).collect::<Vec<[u32; 3]>>()).unwrap()
}

/// Each piece of an L lies in about one of its bars: no piece reaches from the end of one to the end of the other, as
/// the hull of all does. Their points are on the mesh, and they are all of it.
#[test]
fn pieces_are_parts_of_the_mesh() {
    let mesh = angle();
    let surface = Surface::new(&mesh).unwrap();
    let all = pieces(&mesh);
    assert!((2..=32).contains(&all.len()), "{}", all.len());
    let mut ends = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for piece in &all {
        let far = |axis: usize| piece.iter().map(|point| point[axis]).fold(0.0, f64::max);
        // A voxel is 1/64 of the size, 2; one of the cuts may lie in it.
        assert!(far(0).min(far(1)) < 0.5 + 3.0 * 2.0 / 64.0, "{piece:?}");
        for point in piece {
            assert!(surface.outside(*point) < 1e-9, "{point}");
            ends = [ends[0].min(*point), ends[1].max(*point)];
        }
    }
    let [low, high] = mesh.ends();
    assert!(ends[0].distance(low) < 1e-9 && ends[1].distance(high) < 1e-9, "{ends:?}");
    assert!(pieces(&Triangles::default()).is_empty() && Surface::new(&Triangles::default()).is_none());
}

#[test]
fn outside_is_outside() {
    let surface = Surface::new(&angle()).unwrap();
    for (at, truth) in [
        ([0.25, 0.25, 0.25], 0.0),
        ([1.9, 0.4, 0.1], 0.0),
        ([1.0, 1.0, 0.25], 0.5),
        ([0.75, 1.5, 0.25], 0.25),
        ([1.0, -3.0, 0.25], 3.0),
        ([2.0, 2.0, 0.5], 1.5),
    ] {
        let out = surface.outside(DVec3::from_array(at));
        assert!((out - truth).abs() < 1e-9, "{at:?}: {out}, not {truth}");
    }
}
