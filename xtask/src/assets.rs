//! Shapes that worlds of `scenarios/worlds` name, made by rule: no file of anybody else's is among them.

use crate::command::{Failure, root};
use std::fmt::Write;

/// A turn by 11.42° whose cosine and sine are exact: the same file on every machine.
const TURN: [f64; 2] = [99.0 / 101.0, 20.0 / 101.0];

/// Turns of the spiral's gutter: one and a half times around.
const STEPS: u32 = 47;

/// From the spiral's axis to the middle of the gutter, in mm.
const AROUND: f64 = 90.0;

/// How far the gutter comes down with each turn, in mm.
const DOWN: f64 = 2.4;

/// The gutter's inside, from its outer edge over its ground to its inner edge, and its outside on the way back:
/// outwards from its middle and up, in mm.
const PROFILE: [[f64; 2]; 10] = [
    [20.0, 14.0],
    [14.0, -2.0],
    [0.0, -8.0],
    [-12.0, -4.0],
    [-17.0, 6.0],
    [-20.0, 6.0],
    [-15.0, -7.0],
    [0.0, -12.0],
    [17.0, -5.0],
    [23.0, 14.0],
];

/// Writes all shapes anew.
pub(crate) fn write() -> Result<(), Failure> {
    let path = root().join("scenarios/worlds/spiral.obj");
    std::fs::write(&path, spiral()).map_err(Failure::new)?;
    println!("wrote {}", path.display());
    Ok(())
}

/// A gutter in a spiral, as an OBJ in mm with z up: closed, its faces outwards.
fn spiral() -> String {
    let mut text = String::from("# A gutter in a spiral, made by `cargo xtask assets`: mm, z up.\no spiral\n");
    let [mut x, mut y] = [1.0, 0.0];
    for step in 0..=STEPS {
        for [out, up] in PROFILE {
            let (distance, height) = (AROUND + out, up - DOWN * f64::from(step));
            let _ = writeln!(text, "v {:.3} {:.3} {:.3}", distance * x, distance * y, height);
        }
        [x, y] = [x * TURN[0] - y * TURN[1], x * TURN[1] + y * TURN[0]];
    }
    let points = PROFILE.len() as u32;
    let at = |step: u32, point: u32| step * points + point % points + 1;
    let mut face = |corners: [u32; 3]| _ = writeln!(text, "f {} {} {}", corners[0], corners[1], corners[2]);
    for step in 0..STEPS {
        for point in 0..points {
            let [a, b] = [at(step, point), at(step, point + 1)];
            let [c, d] = [at(step + 1, point + 1), at(step + 1, point)];
            face([a, c, b]);
            face([a, d, c]);
        }
    }
    // Both ends: strips between the inside and the outside.
    for point in 0..points / 2 - 1 {
        let [near, far] = [point, points - 1 - point];
        for [step, reversed] in [[0, 1], [STEPS, 0]] {
            let [a, b, c, d] = [at(step, near), at(step, near + 1), at(step, far - 1), at(step, far)];
            if reversed == 1 {
                face([a, b, c]);
                face([a, c, d]);
            } else {
                face([a, c, b]);
                face([a, d, c]);
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_in_the_folder_are_those_that_are_made() {
        let there = std::fs::read_to_string(root().join("scenarios/worlds/spiral.obj")).unwrap_or_default();
        assert!(there == spiral(), "scenarios/worlds/spiral.obj is another: `cargo xtask assets` makes it");
    }

    /// Closed: each edge is gone along once in each direction. Outwards: the volume is positive.
    #[test]
    fn the_spiral_is_closed_and_faces_outwards() {
        let text = spiral();
        let numbers =
            |line: &str| -> Vec<f64> { line.split(' ').skip(1).filter_map(|word| word.parse().ok()).collect() };
        let corners: Vec<Vec<f64>> = text.lines().filter(|line| line.starts_with("v ")).map(numbers).collect();
        let faces: Vec<Vec<f64>> = text.lines().filter(|line| line.starts_with("f ")).map(numbers).collect();
        let mut edges = std::collections::BTreeSet::new();
        let mut volume = 0.0;
        for face in &faces {
            for k in 0..3 {
                assert!(edges.insert((face[k] as u32, face[(k + 1) % 3] as u32)), "an edge twice in one direction");
            }
            let [a, b, c] = [0, 1, 2].map(|k| &corners[face[k] as usize - 1]);
            volume += a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]);
        }
        assert!(edges.iter().all(|&(from, to)| edges.contains(&(to, from))), "an edge without a neighbour");
        assert!(volume > 0.0, "{volume}");
    }
}
