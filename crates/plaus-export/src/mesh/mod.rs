//! Triangles of shapes and scenery.

mod cuboid;
mod lathe;
mod scenery;

use glam::{DQuat, DVec2, DVec3, Vec3};
use plaus_animation::{Form, Look, Material, Shape};
use plaus_dist::math::sin_cos;
use std::f64::consts::TAU;

/// Triangles with one normal for each corner; metres, counter-clockwise as seen from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Corners.
    pub positions: Vec<[f32; 3]>,
    /// A unit vector for each corner.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates for each corner, from the upper left as in glTF. Bodies of revolution: once around, and from
    /// the lower end to the upper. Boxes that move: their six faces in three columns and two rows. Spots: a disc in the
    /// unit square. Scenery: metres.
    pub uvs: Vec<[f32; 2]>,
    /// Three corners each.
    pub triangles: Vec<[u32; 3]>,
}

/// A part of one colour and material.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Colour and material.
    pub look: Look,
    /// Its triangles.
    pub mesh: Mesh,
}

/// Dark enough to be a hole.
const HOLE: Look = Look::new([28, 26, 30], Material::Matte);

/// The parts of a body, in its own frame.
#[must_use]
pub fn of_shape(shape: &Shape, look: Look) -> Vec<Part> {
    match shape {
        Shape::Sphere { radius, holes } => {
            let mut parts = vec![Part { look, mesh: lathe::sphere(*radius) }];
            if *holes {
                parts.push(Part { look: HOLE, mesh: finger_holes(*radius) });
            }
            parts
        }
        Shape::Disc { radius, thickness } => coin(*radius, *thickness, look),
        Shape::Cuboid { half, pips } => {
            let mut parts = vec![Part { look, mesh: cuboid::rounded(*half) }];
            if let Some(pips) = pips {
                parts.push(Part { look: contrast(look), mesh: cuboid::pips(*half, pips) });
            }
            parts
        }
        Shape::Revolution { profile, stripes } => lathe::striped(profile, stripes, look),
        Shape::Solid { vertices, triangles } => vec![Part { look, mesh: scenery::flat(vertices, triangles) }],
    }
}

/// A part of the scenery, in the world's frame.
#[must_use]
pub fn of_form(form: &Form, look: Look) -> Part {
    Part { look, mesh: scenery::mesh(form) }
}

impl Mesh {
    fn corner(&mut self, position: DVec3, normal: DVec3, uv: DVec2) -> u32 {
        self.positions.push(position.as_vec3().to_array());
        self.normals.push(normal.normalize_or(DVec3::Z).as_vec3().to_array());
        self.uvs.push(uv.as_vec2().to_array());
        self.positions.len() as u32 - 1
    }

    /// Moves all of it, and then turns it about the origin.
    pub(crate) fn moved(&mut self, by: DVec3, turn: DQuat) {
        if (by, turn) == (DVec3::ZERO, DQuat::IDENTITY) {
            return;
        }
        let each = |list: &mut Vec<[f32; 3]>, by: DVec3| {
            list.iter_mut()
                .for_each(|one| *one = (turn * (Vec3::from_array(*one).as_dvec3() + by)).as_vec3().to_array());
        };
        each(&mut self.positions, by);
        each(&mut self.normals, DVec3::ZERO);
    }

    /// A round spot on a surface: its middle, the surface's normal there, and the spot's radius.
    fn spot(&mut self, centre: DVec3, normal: DVec3, radius: f64) {
        const CORNERS: u32 = 20;
        let (right, up) = normal.any_orthonormal_pair();
        let first = self.corner(centre, normal, DVec2::splat(0.5));
        for k in 0..CORNERS {
            let (sin, cos) = sin_cos(TAU * f64::from(k) / f64::from(CORNERS));
            let uv = 0.5 * DVec2::new(1.0 + cos, 1.0 - sin);
            self.corner(centre + radius * (cos * right + sin * up), normal, uv);
        }
        self.triangles.extend((0..CORNERS).map(|k| [first, first + 1 + k, first + 1 + (k + 1) % CORNERS]));
    }
}

/// Three holes about the third axis.
fn finger_holes(radius: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for (x, y, size) in [(-0.16, 0.12, 0.1), (0.16, 0.12, 0.1), (0.0, -0.3, 0.12)] {
        let normal = DVec3::new(x, y, 1.0).normalize();
        // The spot's rim must be outside the ball, or it would be hidden.
        mesh.spot(normal * radius * 1.006, normal, size * radius);
    }
    mesh
}

/// A coin with a ring of a lighter colour on both faces.
fn coin(radius: f64, thickness: f64, look: Look) -> Vec<Part> {
    let lighter = look.colour.0.map(|channel| 255 - (255 - channel) / 2);
    let mut faces = Mesh::default();
    for side in [1.0, -1.0] {
        faces.spot(DVec3::Z * side * thickness * 0.505, DVec3::Z * side, 0.55 * radius);
    }
    let face = Part { look: Look::new(lighter, look.material), mesh: faces };
    vec![Part { look, mesh: lathe::coin(radius, thickness) }, face]
}

/// A look that is readable on a colour.
fn contrast(look: Look) -> Look {
    let [r, g, b] = look.colour.0.map(u32::from);
    let bright = 2 * r + 5 * g + b > 8 * 110;
    Look::new(if bright { [30, 30, 36] } else { [246, 244, 238] }, Material::Matte)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use plaus_animation::Stripe;

    fn volume(mesh: &Mesh) -> f64 {
        let corner = |index: u32| Vec3::from(mesh.positions[index as usize]).as_dvec3();
        let six: f64 = mesh.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c)))).sum();
        six / 6.0
    }

    fn faces_outwards(mesh: &Mesh) {
        for &[a, b, c] in &mesh.triangles {
            let [p, q, r] = [a, b, c].map(|index| Vec3::from(mesh.positions[index as usize]));
            let normal: Vec3 = [a, b, c].map(|index| Vec3::from(mesh.normals[index as usize])).into_iter().sum();
            let face = (q - p).cross(r - p);
            assert!(face.dot(normal) > 0.0, "{p} {q} {r}");
        }
        assert_eq!(mesh.uvs.len(), mesh.positions.len());
        assert!(mesh.uvs.as_flattened().iter().all(|part| part.is_finite()));
        assert!(mesh.normals.iter().all(|normal| (Vec3::from(*normal).length() - 1.0).abs() < 1e-5));
    }

    #[test]
    fn solids_are_closed_face_outwards_and_have_about_their_volume() {
        let cylinder = vec![[0.0, 0.0], [0.5, 0.0], [0.5, 2.0], [0.0, 2.0]];
        let stripe = Stripe { from: 0.5, to: 1.0, look: HOLE };
        let corner = Shape::Solid {
            vertices: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        };
        let cases = [
            (Shape::ball(1.0), TAU * 2.0 / 3.0, 0.03),
            (Shape::Disc { radius: 1.0, thickness: 0.5 }, TAU * 0.25, 0.1),
            (Shape::Cuboid { half: DVec3::new(0.5, 1.0, 1.5), pips: None }, 6.0, 0.05),
            (Shape::Revolution { profile: cylinder.clone(), stripes: vec![] }, TAU * 0.25, 0.02),
            (Shape::Revolution { profile: cylinder, stripes: vec![stripe] }, TAU * 0.25, 0.02),
            (corner, 1.0 / 6.0, 1e-6),
        ];
        for (shape, expected, tolerance) in cases {
            let parts = of_shape(&shape, Look::IVORY);
            let solids = if matches!(shape, Shape::Disc { .. }) { &parts[..1] } else { &parts[..] };
            parts.iter().for_each(|part| faces_outwards(&part.mesh));
            let found: f64 = solids.iter().map(|part| volume(&part.mesh)).sum();
            assert!((found / expected - 1.0).abs() < tolerance, "{shape:?}: {found}, expected {expected}");
        }
    }

    #[test]
    fn dice_have_twenty_one_pips() {
        let parts = of_shape(&Shape::die(0.016), Look::IVORY);
        faces_outwards(&parts[1].mesh);
        assert_eq!(parts[1].mesh.triangles.len(), 21 * 20);
    }

    #[test]
    fn scenery_faces_outwards() {
        let block = Form::Block { centre: DVec3::X, half: DVec3::ONE, orientation: glam::DQuat::IDENTITY };
        let mesh = of_form(&block, Look::WOOD).mesh;
        faces_outwards(&mesh);
        assert!((volume(&mesh) - 8.0).abs() < 1e-5);
        let plane = Form::Plane { centre: DVec3::ZERO, normal: DVec3::Y, half: 2.0 };
        let heights = vec![0.0, 0.1, 0.0, 0.3, 0.2, 0.0];
        let field = Form::Heightfield { origin: DVec3::ZERO, step: [0.5, 0.5], columns: 3, heights };
        let triangle = Form::Mesh { vertices: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]] };
        for (form, triangles) in [(plane, 2), (field, 4), (triangle, 1)] {
            let mesh = of_form(&form, Look::WOOD).mesh;
            faces_outwards(&mesh);
            assert_eq!(mesh.triangles.len(), triangles, "{form:?}");
        }
    }
}
