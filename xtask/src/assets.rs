//! Shapes for the worlds in `scenarios/worlds`, made by rule: no file of anybody else is among them.

use crate::command::{Failure, root};
use std::fmt::Write;

/// A turn by 11.42° whose cosine and sine are exact: the same file on every machine.
const TURN: [f64; 2] = [99.0 / 101.0, 20.0 / 101.0];

/// Number of turns of the spiral's gutter: one and a half times around.
const STEPS: u32 = 47;

/// From the spiral's axis to the centre of the gutter, in mm.
const AROUND: f64 = 90.0;

/// How far the gutter descends with each turn, in mm.
const DOWN: f64 = 2.4;

/// The gutter's inside, from its outer edge over its bottom to its inner edge, and its outside on the way back:
/// distance outwards from its centre, and height, in mm.
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

/// Cosines of a sixteenth of a turn and its multiples, up to a quarter: the same digits on every machine.
const COSINES: [f64; 5] = [1.0, 0.923_879_5, std::f64::consts::FRAC_1_SQRT_2, 0.382_683_4, 0.0];

/// Number of corners around the bowl.
const AROUND_BOWL: u32 = 16;

/// The bowl's outside from its foot up, then its inside down again: distance outwards from its axis, and height, in mm.
const BOWL: [[f64; 2]; 9] = [
    [50.0, 0.0],
    [95.0, 22.0],
    [125.0, 60.0],
    [135.0, 110.0],
    [127.0, 110.0],
    [117.0, 63.0],
    [90.0, 29.0],
    [50.0, 11.0],
    [20.0, 7.0],
];

/// Corners of the cracks in the slab, in mm: a grid of six by four shards in which only the slab's own edges are
/// straight.
const CRACKS: [[[f64; 2]; 7]; 5] = [
    [[-135.0, -90.0], [-96.0, -90.0], [-44.0, -90.0], [-3.0, -90.0], [47.0, -90.0], [93.0, -90.0], [135.0, -90.0]],
    [[-135.0, -55.0], [-101.0, -38.0], [-50.0, -51.0], [11.0, -46.0], [52.0, -46.0], [93.0, -53.0], [135.0, -42.0]],
    [[-135.0, 8.0], [-89.0, 5.0], [-41.0, -10.0], [6.0, 2.0], [41.0, -10.0], [98.0, -1.0], [135.0, 5.0]],
    [[-135.0, 53.0], [-85.0, 54.0], [-47.0, 52.0], [-1.0, 55.0], [53.0, 36.0], [82.0, 39.0], [135.0, 55.0]],
    [[-135.0, 90.0], [-91.0, 90.0], [-42.0, 90.0], [-4.0, 90.0], [45.0, 90.0], [87.0, 90.0], [135.0, 90.0]],
];

/// Half the slab's thickness in mm, and the part of each shard that remains, so that the cracks are open.
const THICK: f64 = 9.0;
const LEFT: f64 = 0.97;

/// Makes the text of a file.
type Make = fn() -> String;

/// The files that worlds name, each with the function that makes it.
const ALL: [(&str, Make); 3] = [("spiral.obj", spiral), ("bowl.obj", bowl), ("slab.obj", slab)];

/// Writes all shapes again.
pub(crate) fn write() -> Result<(), Failure> {
    for (name, make) in ALL {
        let path = root().join("scenarios/worlds").join(name);
        std::fs::write(&path, make()).map_err(Failure::new)?;
        println!("wrote {}", path.display());
    }
    Ok(())
}

/// A bowl on its foot, as an OBJ in mm with z up: closed, its faces outwards.
fn bowl() -> String {
    let mut text = String::from("# A bowl, made by `cargo xtask assets`: mm, z up.\no bowl\n");
    let cosine = |k: u32| {
        let k = k % AROUND_BOWL;
        let k = k.min(AROUND_BOWL - k) as usize;
        if k <= 4 { COSINES[k] } else { -COSINES[8 - k] }
    };
    for [out, up] in BOWL {
        for k in 0..AROUND_BOWL {
            let _ = writeln!(text, "v {:.3} {:.3} {:.3}", out * cosine(k), out * cosine(k + 12), up);
        }
    }
    let [foot, last] = [BOWL[0], BOWL[BOWL.len() - 1]];
    let _ = writeln!(text, "v 0 0 {:.3}\nv 0 0 {:.3}", foot[1], last[1] - 1.0);
    let rows = BOWL.len() as u32;
    let at = |row: u32, k: u32| row * AROUND_BOWL + k % AROUND_BOWL + 1;
    let (under, ground) = (rows * AROUND_BOWL + 1, rows * AROUND_BOWL + 2);
    let mut face = |corners: [u32; 3]| _ = writeln!(text, "f {} {} {}", corners[0], corners[1], corners[2]);
    for k in 0..AROUND_BOWL {
        for row in 0..rows - 1 {
            let [a, b, c, d] = [at(row, k), at(row, k + 1), at(row + 1, k + 1), at(row + 1, k)];
            face([a, b, c]);
            face([a, c, d]);
        }
        face([under, at(0, k + 1), at(0, k)]);
        face([ground, at(rows - 1, k), at(rows - 1, k + 1)]);
    }
    text
}

/// A slab broken into shards with open cracks, as an OBJ in mm with z up; each shard is an object of its own.
fn slab() -> String {
    let mut text = String::from("# A broken slab, made by `cargo xtask assets`: mm, z up.\n");
    let cell = |i: usize, j: usize| vec![CRACKS[j][i], CRACKS[j][i + 1], CRACKS[j + 1][i + 1], CRACKS[j + 1][i]];
    let mut shards: Vec<Vec<[f64; 2]>> = Vec::new();
    for k in 0..24 {
        let shard = cell(k % 6, k / 6);
        // Some are broken once more, from corner to corner.
        match shard[..] {
            [a, b, c, d] if k % 4 == 2 => shards.extend([vec![a, b, c], vec![a, c, d]]),
            _ => shards.push(shard),
        }
    }
    let mut before = 0;
    for (index, shard) in shards.iter().enumerate() {
        let _ = writeln!(text, "o shard_{}", index + 1);
        let n = shard.len();
        let middle = [0, 1].map(|axis| shard.iter().map(|corner| corner[axis]).sum::<f64>() / n as f64);
        for up in [-THICK, THICK] {
            for corner in shard {
                let [x, y] = [0, 1].map(|axis| middle[axis] + LEFT * (corner[axis] - middle[axis]));
                let _ = writeln!(text, "v {x:.3} {y:.3} {up:.3}");
            }
        }
        let at = |k: usize, up: usize| before + up * n + k % n + 1;
        for k in 1..n - 1 {
            let _ = writeln!(text, "f {} {} {}", at(0, 1), at(k, 1), at(k + 1, 1));
            let _ = writeln!(text, "f {} {} {}", at(0, 0), at(k + 1, 0), at(k, 0));
        }
        for k in 0..n {
            let [a, b, c, d] = [at(k, 0), at(k + 1, 0), at(k + 1, 1), at(k, 1)];
            let _ = writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}");
        }
        before += 2 * n;
    }
    text
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
        for (name, make) in ALL {
            let there = std::fs::read_to_string(root().join("scenarios/worlds").join(name)).unwrap_or_default();
            assert!(there == make(), "scenarios/worlds/{name} is another: `cargo xtask assets` makes it");
        }
    }

    /// Closed: each edge is passed once in each direction. Outwards: the volume is positive.
    #[test]
    fn shapes_are_closed_and_face_outwards() {
        ALL.iter().for_each(|(_, make)| is_closed(&make()));
    }

    fn is_closed(text: &str) {
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
