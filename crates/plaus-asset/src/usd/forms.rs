//! Shapes of prims: meshes, and solids of UsdGeom.

use super::axes::Axes;
use super::scene::Scene;
use crate::{AssetError, MOST_TRIANGLES};
use glam::{DMat3, DMat4, DQuat, DVec3};
use plaus_dist::math::sin_cos;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Sides of a round solid that is drawn as a mesh, and rings of half a ball.
const SIDES: u32 = 48;
const RINGS: u32 = 12;

/// How much, as a share, a scale may shear, or differ along the axes, and count as one that does not.
const EVEN: f64 = 1e-6;

/// Triangles over corners.
pub(super) type Mesh = (Vec<DVec3>, Vec<[u32; 3]>);

/// A shape in m, y up, along the axes of its prim without their scale.
#[derive(Debug)]
pub(super) struct Form {
    /// A solid of `KHR_implicit_shapes`, in place of a mesh.
    pub(super) solid: Option<Value>,
    pub(super) mesh: Option<Mesh>,
    /// Where it is, how it is turned, and what scales it.
    pub(super) at: DVec3,
    pub(super) turn: DQuat,
    pub(super) scale: DVec3,
    /// How far it reaches from the prim's place.
    pub(super) reach: f64,
}

impl Form {
    fn of_mesh(mesh: Mesh) -> Self {
        let reach = mesh.0.iter().map(|corner| corner.length()).fold(0.0, f64::max);
        let (at, turn, scale) = (DVec3::ZERO, DQuat::IDENTITY, DVec3::ONE);
        Self { solid: None, mesh: Some(mesh), at, turn, scale, reach }
    }

    fn of_solid(solid: Value, reach: f64) -> Self {
        let (at, turn, scale) = (DVec3::ZERO, DQuat::IDENTITY, DVec3::ONE);
        Self { solid: Some(solid), mesh: None, at, turn, scale, reach }
    }
}

/// A solid, in m.
#[derive(Debug, Clone, Copy)]
enum Solid {
    Cube(f64),
    Sphere(f64),
    /// Radii at the bottom and the top, height, and axis.
    Cylinder([f64; 2], f64, DVec3),
    Capsule([f64; 2], f64, DVec3),
    /// Width, length, normal, and the direction of the width.
    Plane([f64; 2], DVec3, DVec3),
}

/// Kinds of prims with a shape that is read.
pub(super) fn is_form(kind: &str) -> bool {
    matches!(kind, "Mesh" | "Cube" | "Sphere" | "Cylinder" | "Cylinder_1" | "Capsule" | "Capsule_1" | "Cone" | "Plane")
}

/// Kinds of prims with a shape that is not read.
pub(super) fn is_other_form(kind: &str) -> bool {
    matches!(
        kind,
        "Points" | "BasisCurves" | "NurbsCurves" | "HermiteCurves" | "NurbsPatch" | "PointInstancer" | "TetMesh"
    )
}

/// The shape of a prim of which the matrix leaves `rest` beyond its pose; as a solid, if it may and can be one. None
/// if it is flat or empty.
pub(super) fn form(
    scene: &Scene,
    prim: usize,
    axes: &Axes,
    rest: &DMat4,
    as_solid: bool,
) -> Result<Option<Form>, AssetError> {
    let linear = DMat3::from_mat4(*rest);
    if !linear.is_finite() || linear.determinant().abs() < 1e-24 {
        return Ok(None);
    }
    if scene.prims[prim].kind == "Mesh" {
        let (corners, faces) = mesh(scene, prim, axes)?;
        return Ok((!faces.is_empty()).then(|| Form::of_mesh(scaled((corners, faces), &linear))));
    }
    let solid = solid(scene, prim, axes)?;
    let scale = DVec3::new(linear.x_axis.x, linear.y_axis.y, linear.z_axis.z);
    let shear = (linear - DMat3::from_diagonal(scale)).to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
    if as_solid && shear <= EVEN * scale.abs().max_element() {
        return Ok(Some(solid.placed(scale)));
    }
    Ok(Some(Form::of_mesh(scaled(solid.drawn(), &linear))))
}

fn scaled((corners, mut faces): Mesh, by: &DMat3) -> Mesh {
    if by.determinant() < 0.0 {
        faces.iter_mut().for_each(|face| face.swap(1, 2));
    }
    (corners.into_iter().map(|corner| *by * corner).collect(), faces)
}

/// The triangles of a mesh: its polygons as fans, but for holes.
fn mesh(scene: &Scene, prim: usize, axes: &Axes) -> Result<Mesh, AssetError> {
    let own = &scene.prims[prim];
    let points = scene.numbers(prim, "points")?.unwrap_or_default();
    let whole = |name: &str| -> Result<Vec<usize>, AssetError> {
        let all = scene.numbers(prim, name)?.unwrap_or_default();
        let index = |number: f64| (number >= 0.0).then_some(number as usize);
        let found: Option<Vec<usize>> = all.into_iter().map(index).collect();
        found.ok_or_else(|| own.wrong(format!("{name}: a number is below 0")))
    };
    let (counts, indices) = (whole("faceVertexCounts")?, whole("faceVertexIndices")?);
    let holes: BTreeSet<usize> = whole("holeIndices")?.into_iter().collect();
    let corners: Vec<DVec3> = points.chunks_exact(3).map(|p| axes.place(DVec3::from_slice(p))).collect();
    if let Some(corner) = corners.iter().position(|corner| !corner.is_finite()) {
        return Err(own.wrong(format!("points: corner {corner} is not finite")));
    }
    if counts.iter().try_fold(0_usize, |sum, &count| sum.checked_add(count)) != Some(indices.len()) {
        let what = format!("faceVertexCounts: they must add up to the {} faceVertexIndices", indices.len());
        return Err(own.wrong(what));
    }
    if let Some(index) = indices.iter().find(|&&index| index >= corners.len()) {
        return Err(own.wrong(format!("faceVertexIndices: corner {index} does not exist: it has {}", corners.len())));
    }
    let is_left = scene.word(prim, "orientation")?.as_deref() == Some("leftHanded");
    let mut faces = Vec::new();
    let mut start = 0;
    for (face, &count) in counts.iter().enumerate() {
        let polygon = &indices[start..start + count];
        start += count;
        if holes.contains(&face) {
            continue;
        }
        for k in 2..count {
            let [a, b, c] = [polygon[0], polygon[k - 1], polygon[k]].map(|index| index as u32);
            faces.push(if is_left { [a, c, b] } else { [a, b, c] });
        }
        if faces.len() > MOST_TRIANGLES {
            return Err(AssetError::TooMany { triangles: faces.len() });
        }
    }
    Ok((corners, faces))
}

fn solid(scene: &Scene, prim: usize, axes: &Axes) -> Result<Solid, AssetError> {
    let own = &scene.prims[prim];
    let size = |name: &str, usual: f64| -> Result<f64, AssetError> {
        let size = scene.number(prim, name)?.unwrap_or(usual);
        if size.is_finite() && size >= 0.0 {
            Ok(size * axes.length)
        } else {
            Err(own.wrong(format!("{name} is {size}, and must be a length")))
        }
    };
    let axis = scene.word(prim, "axis")?.unwrap_or_else(|| "Z".into());
    let across = axes.direction(if axis == "X" { DVec3::Z } else { DVec3::X });
    let axis = axes.named(&axis).ok_or_else(|| own.wrong(format!("axis is {axis:?}: X, Y or Z is needed")))?;
    let radii =
        |usual: f64| -> Result<[f64; 2], AssetError> { Ok([size("radiusBottom", usual)?, size("radiusTop", usual)?]) };
    Ok(match own.kind.as_str() {
        "Cube" => Solid::Cube(size("size", 2.0)?),
        "Sphere" => Solid::Sphere(size("radius", 1.0)?),
        "Cylinder" => Solid::Cylinder([size("radius", 1.0)?; 2], size("height", 2.0)?, axis),
        "Cylinder_1" => Solid::Cylinder(radii(1.0)?, size("height", 2.0)?, axis),
        "Cone" => Solid::Cylinder([size("radius", 1.0)?, 0.0], size("height", 2.0)?, axis),
        "Capsule" => Solid::Capsule([size("radius", 0.5)?; 2], size("height", 1.0)?, axis),
        "Capsule_1" => Solid::Capsule(radii(0.5)?, size("height", 1.0)?, axis),
        _ => Solid::Plane([size("width", 2.0)?, size("length", 2.0)?], axis, across),
    })
}

impl Solid {
    fn axis(self) -> DVec3 {
        match self {
            Self::Cylinder(_, _, axis) | Self::Capsule(_, _, axis) | Self::Plane(_, axis, _) => axis,
            Self::Cube(_) | Self::Sphere(_) => DVec3::Y,
        }
    }

    /// As a solid of the extension, along y, in what scales it.
    fn placed(self, scale: DVec3) -> Form {
        if let Self::Cube(edge) = self {
            let size = edge * scale.abs();
            return Form::of_solid(json!({ "type": "box", "box": { "size": size.to_array() } }), 0.5 * size.length());
        }
        let turn = DQuat::from_rotation_arc(DVec3::Y, (self.axis() * scale).normalize_or(DVec3::Y));
        let mut scale = (turn.inverse() * scale).abs();
        let mut factor = 1.0;
        if scale.max_element() - scale.min_element() <= EVEN * scale.max_element() {
            (factor, scale) = (scale.x, DVec3::ONE);
        }
        let round = |kind: &str, [bottom, top]: [f64; 2], height: f64| {
            let said = json!({ "radiusBottom": factor * bottom, "radiusTop": factor * top, "height": factor * height });
            (json!({ "type": kind, kind: said }), bottom.max(top) + 0.5 * height)
        };
        let (solid, reach) = match self {
            Self::Sphere(radius) => (json!({ "type": "sphere", "sphere": { "radius": factor * radius } }), radius),
            Self::Cylinder(radii, height, _) => round("cylinder", radii, height),
            Self::Capsule(radii, height, _) => round("capsule", radii, height),
            // As a collider it has no ends.
            Self::Plane(..) | Self::Cube(_) => (json!({ "type": "plane", "plane": {} }), 0.0),
        };
        let reach = reach * factor * scale.max_element();
        Form { turn, scale, ..Form::of_solid(solid, reach) }
    }

    /// As a mesh.
    fn drawn(self) -> Mesh {
        let arc = |radius: f64, middle: f64, from: u32, to: u32| {
            (from..=to).map(move |ring| {
                let (sin, cos) = sin_cos(PI * (f64::from(ring) / f64::from(2 * RINGS) - 0.5));
                let is_pole = ring == 0 || ring == 2 * RINGS;
                (if is_pole { 0.0 } else { radius * cos }, middle + radius * sin)
            })
        };
        let (corners, faces) = match self {
            Self::Cube(edge) => return cuboid(edge),
            Self::Plane([width, length], axis, across) => return sheet(width, length, axis, across),
            Self::Sphere(radius) => turned(&arc(radius, 0.0, 0, 2 * RINGS).collect::<Vec<_>>()),
            Self::Cylinder([bottom, top], height, _) => {
                let half = 0.5 * height;
                turned(&[(0.0, -half), (bottom, -half), (top, half), (0.0, half)])
            }
            Self::Capsule([bottom, top], height, _) => {
                let half = 0.5 * height;
                let lower = arc(bottom, -half, 0, RINGS);
                turned(&lower.chain(arc(top, half, RINGS, 2 * RINGS)).collect::<Vec<_>>())
            }
        };
        let turn = DQuat::from_rotation_arc(DVec3::Y, self.axis());
        (corners.into_iter().map(|corner| turn * corner).collect(), faces)
    }
}

/// The surface that a line of radii and heights, from below, has when it goes round y.
fn turned(line: &[(f64, f64)]) -> Mesh {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    let mut rings: Vec<(u32, u32)> = Vec::new();
    for &(radius, height) in line {
        let count = if radius > 0.0 { SIDES } else { 1 };
        rings.push((corners.len() as u32, count));
        corners.extend((0..count).map(|k| {
            let (sin, cos) = sin_cos(2.0 * PI * f64::from(k) / f64::from(SIDES));
            DVec3::new(radius * cos, height, radius * sin)
        }));
    }
    for pair in rings.windows(2) {
        let [(low, few), (high, many)] = [pair[0], pair[1]];
        for k in 0..SIDES {
            let next = (k + 1) % SIDES;
            let corner = |start: u32, count: u32, k: u32| start + if count > 1 { k } else { 0 };
            let [a, b] = [k, next].map(|k| corner(low, few, k));
            let [c, d] = [k, next].map(|k| corner(high, many, k));
            faces.extend([[a, c, b], [b, c, d]].into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
        }
    }
    (corners, faces)
}

fn cuboid(edge: f64) -> Mesh {
    let half = 0.5 * edge;
    let sign = |k: u32, bit: u32| if k >> bit & 1 == 1 { half } else { -half };
    let corners = (0..8).map(|k| DVec3::new(sign(k, 0), sign(k, 1), sign(k, 2))).collect();
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    (corners, sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// A rectangle that is seen from where `axis` points.
fn sheet(width: f64, length: f64, axis: DVec3, across: DVec3) -> Mesh {
    let along = axis.cross(across);
    let corner = |x: f64, y: f64| 0.5 * (x * width * across + y * length * along);
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    (corners, vec![[0, 1, 2], [0, 2, 3]])
}

/// The least and the most coordinates of the corners of a mesh.
pub(super) fn ends((corners, _): &Mesh) -> (DVec3, DVec3) {
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    corners.iter().fold(none, |(low, high), &corner| (low.min(corner), high.max(corner)))
}

/// A box, or a ball, around a mesh.
pub(super) fn around(mesh: &Mesh, is_ball: bool) -> Form {
    let ((low, high), corners) = (ends(mesh), &mesh.0);
    let (at, size) = (0.5 * (low + high), high - low);
    let (solid, reach) = if is_ball {
        let radius = corners.iter().map(|corner| corner.distance(at)).fold(0.0, f64::max);
        (json!({ "type": "sphere", "sphere": { "radius": radius } }), radius)
    } else {
        (json!({ "type": "box", "box": { "size": size.to_array() } }), 0.5 * size.length())
    };
    Form { at, ..Form::of_solid(solid, at.length() + reach) }
}
