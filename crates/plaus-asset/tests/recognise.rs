//! Meshes of solids are recognised, in any size, place, orientation and tessellation; meshes that are nearly solids are
//! not.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use glam::{DQuat, DVec3};
use plaus_asset::Triangles;
use plaus_asset::recognise::{Recognised, Solid, TOLERANCE, recognised};
use plaus_dist::math::{powf, sin_cos};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Half the distance from 1 to the next number in single precision, in which files have their numbers.
const SINGLE: f64 = 1.0 / (1 << 24) as f64;

/// Uniform random numbers (splitmix64).
struct Numbers(u64);

impl Numbers {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Each of the lengths between equally often as any other one times a constant.
    fn length(&mut self, low: f64, high: f64) -> f64 {
        low * powf(high / low, self.within(0.0, 1.0))
    }

    fn below(&mut self, count: u32) -> u32 {
        (self.within(0.0, f64::from(count)) as u32).min(count - 1)
    }

    fn turn(&mut self) -> DQuat {
        loop {
            let [x, y, z, w] = [0; 4].map(|_| self.within(-1.0, 1.0));
            let turn = DQuat::from_xyzw(x, y, z, w);
            if (0.1..1.0).contains(&turn.length()) {
                return turn.normalize();
            }
        }
    }
}

/// A mesh that is being made; corners may be in one place.
#[derive(Default, Clone)]
struct Mesh(Vec<DVec3>, Vec<[u32; 3]>);

impl Mesh {
    /// A surface of revolution about z, whose profile goes upwards; rings without radius are one corner, unless flat
    /// ends are left without it.
    fn turned(profile: &[(f64, f64)], sides: u32) -> Self {
        let mut made = Self::default();
        let ring = |made: &mut Self, &(radius, z): &(f64, f64)| -> Vec<u32> {
            let count = if radius == 0.0 { 1 } else { sides };
            (0..count)
                .map(|k| {
                    let (sin, cos) = sin_cos(TAU * f64::from(k) / f64::from(sides));
                    made.0.push(DVec3::new(radius * cos, radius * sin, z));
                    made.0.len() as u32 - 1
                })
                .collect()
        };
        let rings: Vec<Vec<u32>> = profile.iter().map(|at| ring(&mut made, at)).collect();
        for pair in rings.windows(2) {
            for k in 0..sides as usize {
                let of = |ring: &Vec<u32>, k: usize| ring[k % ring.len()];
                let [a, b] = [of(&pair[0], k), of(&pair[0], k + 1)];
                let [c, d] = [of(&pair[1], k + 1), of(&pair[1], k)];
                if a != b {
                    made.1.push([a, b, c]);
                }
                if c != d {
                    made.1.push([a, c, d]);
                }
            }
        }
        // An end that is open is closed by triangles from one corner of its rim.
        for (ring, upward) in [(rings.first().unwrap(), false), (rings.last().unwrap(), true)] {
            for k in 1..ring.len().max(1) - usize::from(ring.len() > 1) {
                let [a, b, c] = [ring[0], ring[k], ring[k + 1]];
                made.1.push(if upward { [a, b, c] } else { [a, c, b] });
            }
        }
        made
    }

    /// The rings of a ball's surface, from one height to another: `rings` bands from pole to pole.
    fn bands(radius: f64, rings: u32) -> Vec<(f64, f64)> {
        let ring = |k: u32| {
            let (sin, cos) = sin_cos(PI * f64::from(k) / f64::from(rings));
            (if k == 0 || k == rings { 0.0 } else { radius * sin }, -radius * cos)
        };
        (0..=rings).map(ring).collect()
    }

    fn cube(size: DVec3, cuts: u32) -> Self {
        let mut made = Self::default();
        for (axis, side) in (0..3).flat_map(|axis| [(axis, -0.5), (axis, 0.5)]) {
            for (i, j) in (0..cuts).flat_map(|i| (0..cuts).map(move |j| (i, j))) {
                let corner = |i: u32, j: u32| {
                    let mut at = DVec3::splat(side);
                    at[(axis + 1) % 3] = f64::from(i) / f64::from(cuts) - 0.5;
                    at[(axis + 2) % 3] = f64::from(j) / f64::from(cuts) - 0.5;
                    at * size
                };
                let first = made.0.len() as u32;
                made.0.extend([corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
                let faces = [[0, 1, 2], [0, 2, 3]].map(|face| face.map(|k| first + k));
                made.1.extend(faces.map(|[a, b, c]| if side > 0.0 { [a, b, c] } else { [a, c, b] }));
            }
        }
        made
    }

    fn icosphere(radius: f64, cuts: u32) -> Self {
        let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
        let signs = [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let ring = |k: usize| {
            signs.map(|(a, b)| {
                let mut at = [0.0; 3];
                at[k] = a;
                at[(k + 1) % 3] = b * golden;
                at
            })
        };
        let mut made = Self((0..3).flat_map(ring).map(DVec3::from_array).collect(), Vec::new());
        let near = |a: DVec3, b: DVec3| a.distance(b) < 2.1;
        for a in 0..12 {
            for b in 0..a {
                for c in 0..b {
                    let [p, q, r] = [a, b, c].map(|k| made.0[k]);
                    if near(p, q) && near(q, r) && near(r, p) {
                        let outward = (q - p).cross(r - p).dot(p) > 0.0;
                        made.1.push(if outward { [a, b, c] } else { [a, c, b] }.map(|k| k as u32));
                    }
                }
            }
        }
        for _ in 0..cuts {
            for face in std::mem::take(&mut made.1) {
                let [a, b, c] = face.map(|k| made.0[k as usize]);
                let first = made.0.len() as u32;
                made.0.extend([0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)]);
                let [x, y, z] = [first, first + 1, first + 2];
                made.1.extend([[face[0], x, z], [x, face[1], y], [z, y, face[2]], [x, y, z]]);
            }
        }
        made.0.iter_mut().for_each(|at| *at = radius * at.normalize());
        made
    }

    fn moved(mut self, mut by: impl FnMut(DVec3) -> DVec3) -> Self {
        self.0.iter_mut().for_each(|at| *at = by(*at));
        self
    }

    /// As a file has it: in single precision, with corners of one place joined.
    fn read(&self) -> Triangles {
        let single = self.0.iter().map(|at| at.as_vec3().as_dvec3()).collect::<Vec<_>>();
        Triangles::new("mesh", &single, &self.1).unwrap()
    }
}

const KINDS: [&str; 5] = ["ball", "box", "cylinder", "cone", "capsule"];

/// A solid, and a mesh of it about its middle with its axis along z, whose sides are `sides`, from 8 to 128.
fn solid(kind: &str, numbers: &mut Numbers, sides: u32) -> (Solid, Mesh) {
    // From a coin to a rod.
    let [wide, high] = [(); 2].map(|()| numbers.length(0.03, 1.0));
    let has_centre = numbers.below(2) == 0;
    let end = |z: f64| has_centre.then_some((0.0, z));
    match kind {
        "ball" if numbers.below(2) == 0 => (Solid::Ball { radius: wide }, Mesh::icosphere(wide, 1 + numbers.below(4))),
        "ball" => (Solid::Ball { radius: wide }, Mesh::turned(&Mesh::bands(wide, sides / 2), sides)),
        "box" => {
            let size = DVec3::new(wide, high, numbers.length(0.03, 1.0));
            (Solid::Box { size }, Mesh::cube(size, 1 + numbers.below(3)))
        }
        "cylinder" => {
            let rings = 1 + numbers.below(3);
            let side = (0..=rings).map(|k| (wide, high * (f64::from(k) / f64::from(rings) - 0.5)));
            let profile = end(-0.5 * high).into_iter().chain(side).chain(end(0.5 * high));
            (Solid::Cylinder { radius: wide, height: high }, Mesh::turned(&profile.collect::<Vec<_>>(), sides))
        }
        "cone" => {
            let profile = end(-0.5 * high).into_iter().chain([(wide, -0.5 * high), (0.0, 0.5 * high)]);
            (Solid::Cone { radius: wide, height: high }, Mesh::turned(&profile.collect::<Vec<_>>(), sides))
        }
        _ => {
            let bands = Mesh::bands(wide, 2 * (sides / 4));
            let half = bands.len() / 2;
            let low = bands[..=half].iter().map(|&(radius, z)| (radius, z - 0.5 * high));
            let top = bands[half..].iter().map(|&(radius, z)| (radius, z + 0.5 * high));
            let profile = low.chain(top).collect::<Vec<_>>();
            (Solid::Capsule { radius: wide, length: high }, Mesh::turned(&profile, sides))
        }
    }
}

/// Sizes in any order, as a box does not say which of its edges is which.
fn sizes(solid: &Solid) -> [f64; 3] {
    let mut sizes = match *solid {
        Solid::Ball { radius } => [radius; 3],
        Solid::Box { size } => size.to_array(),
        Solid::Cylinder { radius, height } | Solid::Cone { radius, height } => [radius, radius, height],
        Solid::Capsule { radius, length } => [radius, radius, length],
    };
    if matches!(solid, Solid::Box { .. }) {
        sizes.sort_by(f64::total_cmp);
    }
    sizes
}

/// A place and size: what makes of a mesh of about 1 one of 1 to 1,000, turned in any way or not at all, about a point
/// that is up to three times its size from the origin.
fn pose(numbers: &mut Numbers) -> (f64, DQuat, DVec3) {
    let scale = numbers.length(1e-3, 1.0);
    let turn = if numbers.below(4) == 0 { DQuat::IDENTITY } else { numbers.turn() };
    let at = DVec3::from_array([0; 3].map(|_| numbers.within(-3.0, 3.0) * scale));
    (scale, turn, at)
}

/// The law, for each kind of solid: it is recognised, where it is and as it is turned, to the rounding of the file.
#[test]
fn solids_are_recognised() {
    let mut table: BTreeMap<&str, (u32, f64, f64)> = BTreeMap::new();
    for seed in 0..1000 {
        let mut numbers = Numbers(seed);
        let kind = KINDS[numbers.below(5) as usize];
        let sides = 8 + numbers.below(121);
        let (truth, mesh) = solid(kind, &mut numbers, sides);
        let (scale, turn, at) = pose(&mut numbers);
        let mesh = mesh.moved(|place| at + scale * (turn * place)).read();
        let found = recognised(&mesh, TOLERANCE).unwrap_or_else(|| panic!("{seed}: {truth:?} of {sides} sides"));
        assert_eq!(found.solid.name(), kind, "{seed}: {truth:?} of {sides} sides is {found:?}");
        // Places up to six from the origin are rounded; the corners of a thin end are known by what is as thin.
        let rounding = 64.0 * SINGLE * 6.0 * scale;
        for (own, true_size) in sizes(&found.solid).iter().zip(sizes(&truth)) {
            assert!((own - scale * true_size).abs() < rounding, "{seed}: {truth:?} times {scale} is {found:?}");
        }
        assert!(found.at.distance(at) < rounding, "{seed}: {truth:?} is at {at}, not {found:?}");
        assert!(found.off < rounding && found.off <= TOLERANCE * found.solid.least(), "{seed}: {found:?}");
        let axis = (turn.inverse() * found.turn) * DVec3::Z;
        let length = sizes(&truth)[2].min(sizes(&truth)[0]) * scale;
        match kind {
            "cone" => assert!(length * (axis - DVec3::Z).length() < rounding, "{seed}: {axis} of {truth:?}"),
            "cylinder" | "capsule" => assert!(length * (axis.abs() - DVec3::Z).length() < rounding, "{seed}: {axis}"),
            _ => {}
        }
        let (count, off, chord) = table.entry(kind).or_default();
        (*count, *off) = (*count + 1, off.max(found.off / found.solid.least()));
        *chord = chord.max(found.gap / found.solid.least());
    }
    for (kind, (count, off, chord)) in &table {
        println!(
            "{kind}: {count} of {count} recognised; corners off by {off:.1e} of the least extent, faces by {chord:.3}"
        );
        assert!(*count > 150);
    }
}

/// What corners are off by decides: just within the tolerance a mesh is recognised, beyond it it is not.
#[test]
fn corners_that_are_off_by_more_than_the_tolerance_are_not_those_of_a_solid() {
    for seed in 0..500 {
        let mut numbers = Numbers(seed);
        let kind = KINDS[numbers.below(5) as usize];
        let sides = 8 + numbers.below(121);
        let (truth, mesh) = solid(kind, &mut numbers, sides);
        let (scale, turn, at) = pose(&mut numbers);
        // In and out along a direction from the middle, by no more than this; the axes that follow from the mesh take
        // up a part of it, or add as much.
        let mut rough = |share: f64| {
            let most = share * TOLERANCE * truth.least();
            let mut off = BTreeMap::new();
            let rough = mesh.clone().moved(|place| {
                let by = *off.entry(place.to_array().map(f64::to_bits)).or_insert_with(|| numbers.within(-most, most));
                at + scale * (turn * (place + by * place.normalize_or_zero()))
            });
            recognised(&rough.read(), TOLERANCE)
        };
        let name = |found: Option<Recognised>| found.map(|found| found.solid.name());
        assert_eq!(name(rough(0.2)), Some(kind), "{seed}: {truth:?}");
        assert_eq!(rough(30.0), None, "{seed}: {truth:?}");
    }
}

/// A wrong twin of a solid.
fn wrong(what: &str, numbers: &mut Numbers, sides: u32) -> Mesh {
    let [wide, high] = [(); 2].map(|()| numbers.length(0.1, 1.0));
    // What is drawn out by 3 % is a capsule within the tolerance.
    let more = 1.0 + numbers.length(24.0 * TOLERANCE, 1.0);
    match what {
        "ellipsoid" => {
            let axis = numbers.below(3) as usize;
            let mut by = DVec3::ONE;
            by[axis] = if numbers.below(2) == 0 { more } else { 1.0 / more };
            Mesh::turned(&Mesh::bands(wide, sides / 2), sides).moved(|place| by * place)
        }
        "dented box" => {
            let size = DVec3::new(wide, high, numbers.length(0.1, 1.0));
            let by = numbers.within(3.0 * TOLERANCE, 0.3) * size.min_element();
            let corner = 0.5 * size;
            let inward = -DVec3::ONE.normalize() * by;
            Mesh::cube(size, 1).moved(|place| if place.distance(corner) < 1e-9 { place + inward } else { place })
        }
        "frustum" => {
            let top = wide / (1.0 + 2.0 * (more - 1.0));
            let wide = (wide, top);
            Mesh::turned(&[(wide.0, -0.5 * high), (wide.1, 0.5 * high)], sides)
        }
        "prism" => {
            let sides = 3 + 2 * numbers.below(2);
            let high = numbers.length(0.03, 1.0);
            Mesh::turned(&[(wide, -0.5 * high), (wide, 0.5 * high)], sides)
        }
        "prism of six or seven" => Mesh::turned(&[(wide, -0.5 * high), (wide, 0.5 * high)], 6 + numbers.below(2)),
        "pyramid" => Mesh::turned(&[(wide, -0.5 * high), (0.0, 0.5 * high)], 3 + numbers.below(5)),
        "cup" => {
            let mut mesh = Mesh::turned(&[(wide, -0.5 * high), (wide, 0.5 * high)], sides);
            mesh.1.truncate(mesh.1.len() - (sides as usize - 2));
            mesh
        }
        "half ball" => {
            let bands = Mesh::bands(wide, 2 * (sides / 4));
            Mesh::turned(&bands[..=bands.len() / 2], sides)
        }
        "box without a face" => {
            let mut mesh = Mesh::cube(DVec3::new(wide, high, numbers.length(0.1, 1.0)), 1);
            mesh.1.truncate(10);
            mesh
        }
        "bevelled cylinder" => {
            let cut = numbers.within(0.1, 0.4) * wide.min(high);
            let [side, end] = [wide - cut, 0.5 * high - cut];
            Mesh::turned(&[(side, -0.5 * high), (wide, -end), (wide, end), (side, 0.5 * high)], sides)
        }
        "icosahedron" => Mesh::icosphere(wide, 0),
        _ => {
            // A tube.
            let [low, top] = [-0.5 * high, 0.5 * high];
            let inner = numbers.within(0.2, 0.95) * wide;
            Mesh::turned(&[(inner, top), (inner, low), (wide, low), (wide, top), (inner, top)], sides)
        }
    }
}

#[test]
fn what_is_nearly_a_solid_is_none() {
    const WRONG: [&str; 12] = [
        "ellipsoid",
        "dented box",
        "frustum",
        "prism",
        "prism of six or seven",
        "pyramid",
        "cup",
        "half ball",
        "box without a face",
        "bevelled cylinder",
        "icosahedron",
        "tube",
    ];
    for seed in 0..1200 {
        let what = WRONG[seed as usize % WRONG.len()];
        let mut numbers = Numbers(seed);
        let sides = 8 + numbers.below(121);
        let (scale, turn, at) = pose(&mut numbers);
        let mesh = wrong(what, &mut numbers, sides).moved(|place| at + scale * (turn * place)).read();
        let found = recognised(&mesh, TOLERANCE);
        assert_eq!(found, None, "{seed}: a {what} of {sides} sides");
    }
}

/// A wider tolerance takes what a narrow one refuses, and says by how much it is off.
#[test]
fn the_deviation_is_told() {
    let egg = Mesh::turned(&Mesh::bands(1.0, 16), 32).moved(|place| place * DVec3::new(1.0, 1.0, 0.9)).read();
    assert_eq!(recognised(&egg, TOLERANCE), None);
    let found = recognised(&egg, 0.05).unwrap();
    assert!(matches!(found.solid, Solid::Ball { .. }));
    // Between a radius of 0.9 and one of 1 a ball is at best off by 0.05.
    assert!((0.05..0.1).contains(&found.off), "{found:?}");
    for flat in [Mesh::default(), Mesh::cube(DVec3::new(1.0, 1.0, 0.0), 1), Mesh::cube(DVec3::ZERO, 1)] {
        assert_eq!(recognised(&flat.read(), TOLERANCE), None);
    }
}
