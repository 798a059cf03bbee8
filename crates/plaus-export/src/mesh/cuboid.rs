//! Boxes with rounded edges, and the pips of dice.

use super::Mesh;
use glam::{DVec2, DVec3};

/// Radius of the edges, as a share of half the shortest side.
const ROUND: f64 = 0.2;
/// Tangents of 0°, 15°, 30° and 45°: places of the grid on a face that divide its rounded edge evenly.
const TANGENTS: [f64; 4] = [0.0, 0.267_949_192_431_122_7, 0.577_350_269_189_625_8, 1.0];
/// Where pips are, as a share of half the side.
const PLACE: f64 = 0.46;
/// How far pips stand out, as a share of half the side: far enough not to flicker, but too little to notice.
const LIFT: f64 = 0.004;

/// The three axes of a face: across, up, and outwards.
fn faces() -> [[DVec3; 3]; 6] {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    [[y, z, x], [z, y, -x], [z, x, y], [x, z, -y], [x, y, z], [y, x, -z]]
}

/// A box by half its sides, with rounded edges.
pub(super) fn rounded(half: DVec3) -> Mesh {
    let round = ROUND * half.min_element();
    let inner = half - DVec3::splat(round);
    let mut mesh = Mesh::default();
    for (number, [across, up, out]) in faces().into_iter().enumerate() {
        let corner = DVec2::new((number % 3) as f64 / 3.0, (number / 3) as f64 / 2.0);
        let lines = |axis: DVec3| {
            let inner = inner.dot(axis.abs());
            let low = TANGENTS.iter().rev().map(move |tangent| -inner - round * tangent);
            low.chain(TANGENTS.iter().map(move |tangent| inner + round * tangent)).collect::<Vec<f64>>()
        };
        let (columns, rows) = (lines(across), lines(up));
        let first = mesh.positions.len() as u32;
        for row in &rows {
            for column in &columns {
                let face = *column * across + *row * up + half.dot(out.abs()) * out;
                let core = face.clamp(-inner, inner);
                let normal = (face - core).normalize();
                let place = core + round * normal;
                let shares =
                    DVec2::new(place.dot(across) / half.dot(across.abs()), -place.dot(up) / half.dot(up.abs()));
                let uv = corner + (0.5 * (shares + DVec2::ONE)) / DVec2::new(3.0, 2.0);
                mesh.corner(place, normal, uv);
            }
        }
        let width = columns.len() as u32;
        for row in 0..rows.len() as u32 - 1 {
            for column in 0..width - 1 {
                let a = first + row * width + column;
                mesh.triangles.push([a, a + 1, a + width + 1]);
                mesh.triangles.push([a, a + width + 1, a + width]);
            }
        }
    }
    mesh
}

/// Pips on the faces +x, −x, +y, −y, +z, −z.
pub(super) fn pips(half: DVec3, counts: &[u8; 6]) -> Mesh {
    let mut mesh = Mesh::default();
    for ([across, up, out], &count) in faces().into_iter().zip(counts) {
        let (right, above) = (half.dot(across.abs()) * PLACE, half.dot(up.abs()) * PLACE);
        let radius = 0.3 * right.min(above) * if count == 1 { 1.5 } else { 1.0 };
        for (x, y) in places(count) {
            let centre = half.dot(out.abs()) * (1.0 + LIFT) * out + x * right * across + y * above * up;
            mesh.spot(centre, out, radius);
        }
    }
    mesh
}

/// Places of a number of pips, from −1 to 1.
fn places(count: u8) -> Vec<(f64, f64)> {
    let mut places = Vec::new();
    if count % 2 == 1 {
        places.push((0.0, 0.0));
    }
    let pairs = [(1.0, 1.0), (-1.0, 1.0), (-1.0, 0.0)];
    for &(x, y) in pairs.iter().take(usize::from(count / 2)) {
        places.extend([(x, y), (-x, -y)]);
    }
    places
}
