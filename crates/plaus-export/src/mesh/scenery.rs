//! Scenery.

use super::Mesh;
use glam::{DQuat, DVec2, DVec3};
use plaus_animation::Form;

pub(super) fn mesh(form: &Form) -> Mesh {
    match form {
        Form::Block { centre, half, orientation } => block(*centre, *half, *orientation),
        Form::Plane { centre, normal, half } => {
            let mut mesh = Mesh::default();
            let (right, up) = normal.any_orthonormal_pair();
            quad(&mut mesh, *centre, right * *half, up * *half);
            mesh
        }
        Form::Mesh { vertices, triangles } => flat(vertices, triangles),
        Form::Heightfield { origin, step, columns, heights } => field(*origin, *step, *columns as usize, heights),
    }
}

/// Corners with a normal of their own for each triangle: edges stay sharp.
pub(super) fn flat(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Mesh {
    let mut mesh = Mesh::default();
    for triangle in triangles {
        let [Some(a), Some(b), Some(c)] = triangle.map(|index| vertices.get(index as usize).copied()) else { continue };
        let normal = (b - a).cross(c - a);
        if normal.length_squared() > 0.0 {
            let corners = [a, b, c].map(|corner| mesh.corner(corner, normal, across(corner, normal)));
            mesh.triangles.push(corners);
        }
    }
    mesh
}

/// Metres across the plane of the two axes that the normal leans to least.
fn across(place: DVec3, normal: DVec3) -> DVec2 {
    let lean = normal.abs();
    if lean.y >= lean.x && lean.y >= lean.z {
        DVec2::new(place.x, place.z)
    } else if lean.x >= lean.z {
        DVec2::new(place.z, -place.y)
    } else {
        DVec2::new(place.x, -place.y)
    }
}

/// A rectangle with two of its half sides; seen from where their cross product points to.
fn quad(mesh: &mut Mesh, centre: DVec3, right: DVec3, up: DVec3) {
    let normal = right.cross(up);
    let (width, height) = (2.0 * right.length(), 2.0 * up.length());
    let corners = [
        (-right - up, DVec2::new(0.0, height)),
        (right - up, DVec2::new(width, height)),
        (right + up, DVec2::new(width, 0.0)),
        (-right + up, DVec2::ZERO),
    ];
    let [a, b, c, d] = corners.map(|(corner, uv)| mesh.corner(centre + corner, normal, uv));
    mesh.triangles.extend([[a, b, c], [a, c, d]]);
}

fn block(centre: DVec3, half: DVec3, orientation: DQuat) -> Mesh {
    let mut mesh = Mesh::default();
    let [x, y, z] = [DVec3::X * half.x, DVec3::Y * half.y, DVec3::Z * half.z].map(|side| orientation * side);
    for [out, right, up] in [[x, y, z], [y, z, x], [z, x, y]] {
        quad(&mut mesh, centre + out, right, up);
        quad(&mut mesh, centre - out, up, right);
    }
    mesh
}

fn field(origin: DVec3, [dx, dz]: [f64; 2], columns: usize, heights: &[f64]) -> Mesh {
    let mut mesh = Mesh::default();
    if columns < 2 {
        return mesh;
    }
    let rows = heights.len() / columns;
    let height = |column: usize, row: usize| heights[row.min(rows - 1) * columns + column.min(columns - 1)];
    for row in 0..rows {
        for column in 0..columns {
            let slope_x = (height(column + 1, row) - height(column.saturating_sub(1), row)) / (2.0 * dx);
            let slope_z = (height(column, row + 1) - height(column, row.saturating_sub(1))) / (2.0 * dz);
            let place = DVec3::new(column as f64 * dx, height(column, row), row as f64 * dz);
            mesh.corner(origin + place, DVec3::new(-slope_x, 1.0, -slope_z), DVec2::new(place.x, place.z));
        }
    }
    for row in 1..rows {
        for column in 1..columns {
            let [a, b] = [(row - 1) * columns + column - 1, row * columns + column - 1].map(|corner| corner as u32);
            mesh.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
    }
    mesh
}
