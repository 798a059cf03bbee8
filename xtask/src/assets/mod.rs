//! Shapes for the worlds in `scenarios/worlds`, made by rule: no file of anybody else is among them.

mod solid;

use crate::command::{Failure, root};
use solid::{Solid, glb, obj};

/// A turn by 11.42° whose cosine and sine are exact: the same file on every machine.
const TURN: [f64; 2] = [99.0 / 101.0, 20.0 / 101.0];

/// Number of turns of the spiral's gutter: one and a half times around.
const STEPS: u32 = 47;

/// From the spiral's axis to the centre of the gutter, in mm.
const AROUND: f64 = 90.0;

/// How far the gutter descends with each turn, in mm.
const DOWN: f64 = 2.4;

/// Half the length of the straight gutter, in mm.
const HALF_TRACK: f64 = 300.0;

/// A gutter's inside, from its outer edge over its bottom to its inner edge, and its outside on the way back: distance
/// outwards from its centre, and height, in mm.
const GUTTER: [[f64; 2]; 10] = [
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

/// Number of corners around round things.
const ROUND: u32 = 16;

/// Bowl and cup: the outside from the foot up, then the inside down again: distance outwards from the axis, and height,
/// in mm.
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
const CUP: [[f64; 2]; 6] = [[22.0, 0.0], [26.0, 30.0], [30.0, 64.0], [27.0, 64.0], [23.0, 30.0], [17.0, 6.0]];

/// Basketball's hoop: from its axis to the middle of the rod, and the rod's radius, in mm.
const HOOP: [f64; 2] = [233.0, 9.0];
/// Half the board's thickness, width and height, in mm; how far behind and above the hoop's middle it is.
const BOARD: [f64; 3] = [15.0, 900.0, 525.0];
const BOARD_AT: [f64; 2] = [400.0, 375.0];

/// Half the length and width of a billiard table between its cushions, how thick its bed is; radii of the pockets, in
/// mm: at the corners, and in the middle of the long sides.
const BED: [f64; 3] = [1000.0, 500.0, 60.0];
const POCKETS: [f64; 2] = [75.0, 60.0];

/// The vase's outside: distance from the axis, and height, at the edges between its rows of shards, in mm; its wall.
const VASE: [[f64; 2]; 6] = [[42.0, 0.0], [46.0, 10.0], [64.0, 60.0], [66.0, 110.0], [46.0, 155.0], [38.0, 190.0]];
const WALL: f64 = 8.0;
/// The foot is cut into shards around a hole of this radius, in mm.
const HOLE: f64 = 8.0;
/// How many sixteenths of a turn each shard of a row takes, and by how many each row is turned.
const WEDGES: [u32; 6] = [3, 3, 2, 3, 3, 2];
const ROWS_TURNED: [u32; 5] = [0, 2, 5, 1, 4];
/// The part of each shard that remains, so that the cracks are open.
const LEFT: f64 = 0.97;

/// Makes a file.
type Make = fn() -> Vec<u8>;

/// The files that worlds name, each with the function that makes it.
const ALL: [(&str, Make); 6] = [
    ("spiral.obj", || obj("A gutter in a spiral", &[spiral()])),
    ("run.obj", || obj("A straight gutter, and a cup", &[track(), lathe("cup", &CUP, 0.0)])),
    ("bowl.obj", || obj("A bowl", &[lathe("bowl", &BOWL, 1.0)])),
    ("hoop.obj", || obj("A hoop and its board", &[hoop(), board()])),
    ("bed.obj", || obj("The bed of a billiard table", &[bed()])),
    ("vase.glb", || glb(&vase())),
];

/// Writes all shapes again.
pub(crate) fn write() -> Result<(), Failure> {
    for (name, make) in ALL {
        let path = root().join("scenarios/worlds").join(name);
        std::fs::write(&path, make()).map_err(Failure::new)?;
        println!("wrote {}", path.display());
    }
    Ok(())
}

/// Cosine and sine of so many sixteenths of a turn.
fn round(k: u32) -> [f64; 2] {
    [k, k + 12].map(|k| {
        let k = k % ROUND;
        let k = k.min(ROUND - k) as usize;
        if k <= 4 { COSINES[k] } else { -COSINES[8 - k] }
    })
}

/// A gutter in a spiral.
fn spiral() -> Solid {
    let ([mut x, mut y], mut rings) = ([1.0, 0.0], Vec::new());
    for step in 0..=STEPS {
        let down = DOWN * f64::from(step);
        rings.push(GUTTER.map(|[out, up]| [(AROUND + out) * x, (AROUND + out) * y, up - down]).to_vec());
        [x, y] = [x * TURN[0] - y * TURN[1], x * TURN[1] + y * TURN[0]];
    }
    Solid::swept("spiral", &rings)
}

/// A straight gutter along x.
fn track() -> Solid {
    let ring = |x: f64| GUTTER.map(|[out, up]| [x, out, up]).to_vec();
    Solid::swept("track", &[ring(-HALF_TRACK), ring(HALF_TRACK)])
}

/// What a profile makes that is turned about the z axis. Its first and its last point are joined to the axis, the
/// latter `deeper` mm farther down.
fn lathe(name: &str, profile: &[[f64; 2]], deeper: f64) -> Solid {
    let ring = |[out, up]: &[f64; 2]| (0..ROUND).map(round).map(|[x, y]| [out * x, out * y, *up]).collect();
    let rings: Vec<Vec<[f64; 3]>> = profile.iter().map(ring).collect();
    let [foot, last] = [profile[0], profile[profile.len() - 1]];
    Solid::between(name, &rings, [[0.0, 0.0, foot[1]], [0.0, 0.0, last[1] - deeper]])
}

/// A hoop about the z axis.
fn hoop() -> Solid {
    let [wide, thick] = HOOP;
    let ring = |k: u32| {
        let ([x, y], rod) = (round(k), (0..8).map(|j| round(2 * j)));
        rod.map(|[out, up]| [(wide + thick * out) * x, (wide + thick * out) * y, thick * up]).collect()
    };
    Solid::looped("rim", &(0..ROUND).map(ring).collect::<Vec<_>>())
}

/// The board behind the hoop.
fn board() -> Solid {
    let ([thick, wide, high], [behind, above]) = (BOARD, BOARD_AT);
    let corners = [[-wide, -high], [wide, -high], [wide, high], [-wide, high]];
    let ring = |x: f64| corners.map(|[y, z]| [x, y, above + z]).to_vec();
    Solid::swept("board", &[ring(behind - thick), ring(behind + thick)])
}

/// The bed of a billiard table, with six bites for pockets; its top is at height 0.
fn bed() -> Solid {
    let ([long, wide, thick], [corner, middle]) = (BED, POCKETS);
    // Half of the edge at positive y, from the left end to the middle.
    let mut edge: Vec<[f64; 2]> = (0..=4)
        .map(|k| [COSINES[4 - k], COSINES[k]])
        .map(|[sine, cosine]| [corner * sine - long, wide - corner * cosine])
        .collect();
    edge.extend((0..=4).map(|k| [-middle * COSINES[k], wide - middle * COSINES[4 - k]]));
    let other: Vec<[f64; 2]> = edge.iter().rev().skip(1).map(|[x, y]| [-x, *y]).collect();
    let ring = |[x, y]: &[f64; 2]| vec![[*x, *y, 0.0], [*x, -y, 0.0], [*x, -y, -thick], [*x, *y, -thick]];
    Solid::swept("bed", &edge.iter().chain(&other).map(ring).collect::<Vec<_>>())
}

/// A vase broken into thirty shards with open cracks.
fn vase() -> Vec<Solid> {
    let mut shards = Vec::new();
    for (row, turned) in ROWS_TURNED.into_iter().enumerate() {
        let [low, high] = [VASE[row], VASE[row + 1]];
        let inner = |[out, _]: [f64; 2]| if row == 0 { HOLE } else { out - WALL };
        let mut begin = turned;
        for wide in WEDGES {
            let ring = |k: u32| {
                let [x, y] = round(k);
                let at = |out: f64, up: f64| [out * x, out * y, up];
                vec![at(low[0], low[1]), at(high[0], high[1]), at(inner(high), high[1]), at(inner(low), low[1])]
            };
            let rings: Vec<Vec<[f64; 3]>> = (begin..=begin + wide).map(ring).collect();
            shards.push(Solid::swept(&format!("shard_{}", shards.len() + 1), &rings).shrunk(LEFT));
            begin += wide;
        }
    }
    shards
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_in_the_folder_are_those_that_are_made() {
        for (name, make) in ALL {
            let there = std::fs::read(root().join("scenarios/worlds").join(name)).unwrap_or_default();
            assert!(there == make(), "scenarios/worlds/{name} is another: `cargo xtask assets` makes it");
        }
    }

    /// Closed: each edge is passed once in each direction. Outwards: the volume is positive.
    #[test]
    fn shapes_are_closed_and_face_outwards() {
        let others = [spiral(), track(), lathe("cup", &CUP, 0.0), lathe("bowl", &BOWL, 1.0), hoop(), board(), bed()];
        for solid in others.iter().chain(&vase()) {
            let mut edges = std::collections::BTreeSet::new();
            for face in &solid.faces {
                for k in 0..3 {
                    assert!(edges.insert((face[k], face[(k + 1) % 3])), "{}: an edge twice", solid.name);
                }
            }
            assert!(edges.iter().all(|&(from, to)| edges.contains(&(to, from))), "{} is open", solid.name);
            assert!(solid.volume() > 0.0, "{}", solid.name);
        }
    }

    #[test]
    fn the_vase_has_thirty_shards() {
        assert_eq!(vase().len(), 30);
    }
}
