//! Shapes of `KHR_implicit_shapes` as a scenario has them.

use super::geoms::{egg, hull};
use super::numbers::number;
use super::things::{Piece, Role, Shape};
use super::write::place;
use crate::custom::{corners, ellipsoid, hull_volume};
use glam::{DQuat, DVec3};
use plaus_dist::math::{cbrt, sin_cos};
use plaus_sim::shape::ConvexHull;
use serde_json::Value;
use std::f64::consts::PI;

/// How thick a plane with ends becomes, in m.
const THICK: f64 = 0.01;
/// Corners of each face of a tapered cylinder, as many as the simulator allows.
const CORNERS: u32 = 12;
/// Angles by which points are turned to get a hull whose faces the simulator can tell apart, and how many are tried.
const TURN: f64 = 0.11;
const TURNS: u32 = 8;

/// A shape of the extension.
pub(super) struct Solid {
    pub(super) shape: Shape,
    /// How far it reaches from its origin, in m.
    pub(super) reach: f64,
    /// What it was replaced by, in words.
    pub(super) replaced: Option<String>,
}

/// Three numbers.
pub(super) fn vector(value: &Value) -> Option<DVec3> {
    let list = value.as_array().filter(|list| list.len() == 3)?;
    let number = |k: usize| list[k].as_f64();
    Some(DVec3::new(number(0)?, number(1)?, number(2)?))
}

/// A shape, in m and along y, as a scenario has it, along z, of something with this role; `Ok(None)` if the extension
/// does not have it. The error says what is wrong with it.
pub(super) fn solid(shape: &Value, scale: DVec3, role: Role) -> Result<Option<Solid>, String> {
    let Some(kind) = shape["type"].as_str() else { return Err("it has no `type`, such as \"box\"".into()) };
    let said = &shape[kind];
    let size = |key: &str, usual: f64| match said[key].as_f64().unwrap_or(usual) {
        size if (0.0..=1e6).contains(&size) => Ok(size),
        size => Err(format!("its {key} is {size}, and must be from 0 to 1e6 m")),
    };
    let scale = scale.abs();
    let is_even = scale.max_element() - scale.min_element() <= 1e-4 * scale.max_element();
    let mm = |metres: f64| number(metres * 1e3);
    let exact = |said: String, volume: f64, reach: f64| {
        Ok(Some(Solid { shape: Shape::Solid { said, volume }, reach, replaced: None }))
    };
    match kind {
        "box" => {
            let edges = vector(&said["size"]).unwrap_or(DVec3::ONE) * scale;
            if !(edges.min_element() > 0.0 && edges.max_element() <= 1e6) {
                return Err("its size must be three positive numbers of at most 1e6 m".into());
            }
            let text = format!("box = {{ size_mm = [{}, {}, {}] }}", mm(edges.x), mm(edges.z), mm(edges.y));
            exact(text, edges.element_product(), 0.5 * edges.length())
        }
        "plane" => plane(said, scale, role),
        "sphere" => {
            let radius = positive(size("radius", 0.5)?, "radius")?;
            if is_even {
                let radius = radius * scale.x;
                let volume = 4.0 / 3.0 * PI * radius * radius * radius;
                return exact(format!("ball = {{ radius_mm = {} }}", mm(radius)), volume, radius);
            }
            let half = radius * DVec3::new(scale.x, scale.z, scale.y);
            ConvexHull::new(&ellipsoid::corners(half), 0.0).map_err(|error| error.to_string())?;
            let (said, replaced) = egg(half);
            let volume = 4.0 / 3.0 * PI * half.element_product();
            let reach = half.max_element() + ellipsoid::error(half);
            Ok(Some(Solid { shape: Shape::Solid { said, volume }, reach, replaced: Some(replaced) }))
        }
        "cylinder" | "capsule" => {
            let [top, bottom] = [size("radiusTop", 0.25)?, size("radiusBottom", 0.25)?];
            let height = positive(size("height", 0.5)?, "height")?;
            positive(top.max(bottom), "radius")?;
            let (is_straight, factor) = (top == bottom, scale.x);
            let [wide, long] = [top.max(bottom) * factor, height * factor];
            let disc = PI * wide * wide;
            let sizes = |length: &str| format!("{{ radius_mm = {}, {length} = {} }}", mm(wide), mm(long));
            match kind {
                "cylinder" if is_even && is_straight => {
                    exact(format!("cylinder = {}", sizes("height_mm")), disc * long, 0.5 * long + wide)
                }
                "cylinder" if is_even && top == 0.0 => {
                    exact(format!("cone = {}", sizes("height_mm")), disc * long / 3.0, 0.5 * long + wide)
                }
                "capsule" if is_even && is_straight => {
                    let volume = disc * (long + 4.0 / 3.0 * wide);
                    exact(format!("capsule = {}", sizes("length_mm")), volume, 0.5 * long + wide)
                }
                "cylinder" => {
                    let points = |turn: f64| {
                        ring(bottom, -0.5 * height, turn).chain(ring(top, 0.5 * height, 0.0)).collect::<Vec<_>>()
                    };
                    let volume = PI / 3.0 * height * (top * top + top * bottom + bottom * bottom);
                    scaled(points, scale, volume, "cylinder")
                }
                _ => {
                    let points =
                        |turn: f64| [around(bottom, -0.5 * height, turn), around(top, 0.5 * height, 0.0)].concat();
                    scaled(points, scale, tapered([bottom, top], height), "capsule")
                }
            }
        }
        _ => Ok(None),
    }
}

fn positive(size: f64, what: &str) -> Result<f64, String> {
    if size > 0.0 { Ok(size) } else { Err(format!("its {what} is 0, and must be more")) }
}

/// A plane, which has no thickness: without ends, all below it is solid; with ends, it becomes a plate.
fn plane(said: &Value, scale: DVec3, role: Role) -> Result<Option<Solid>, String> {
    let edge = |key: &str| said[key].as_f64().filter(|edge| *edge > 0.0);
    let mm = |metres: f64| number(metres * 1e3);
    match (edge("sizeX"), edge("sizeZ")) {
        (Some(x), Some(z)) => {
            let (x, z) = (x * scale.x, z * scale.z);
            if !(x > 0.0 && z > 0.0 && x <= 1e6 && z <= 1e6) {
                return Err("its sizes must be from 0 to 1e6 m".into());
            }
            let said = format!("box = {{ size_mm = [{}, {}, {}] }}", mm(x), mm(z), mm(THICK));
            let shape = Shape::Solid { said, volume: x * z * THICK };
            let at = DVec3::NEG_Z * (0.5 * THICK);
            let shape = Shape::Pieces(vec![Piece { shape, at, turn: DQuat::IDENTITY, density: 1.0 }]);
            let replaced = format!("its plane, which has ends, replaced by a plate {} mm thick below it", mm(THICK));
            Ok(Some(Solid { shape, reach: (x * x + z * z).sqrt(), replaced: Some(replaced) }))
        }
        _ if role != Role::Fixed => Err("it is a plane without ends, and moves: give it sizeX and sizeZ".into()),
        ends => {
            let replaced = (ends != (None, None)).then(|| "its plane, which has ends one way: it has none".to_owned());
            let shape = Shape::Solid { said: "plane = {}".into(), volume: 0.0 };
            Ok(Some(Solid { shape, reach: 0.0, replaced }))
        }
    }
}

/// Points on a circle about y, turned by an angle; one if it has no radius.
fn ring(radius: f64, y: f64, turn: f64) -> impl Iterator<Item = DVec3> {
    (0..if radius > 0.0 { CORNERS } else { 1 }).map(move |k| {
        let (sin, cos) = sin_cos(turn + 2.0 * PI * f64::from(k) / f64::from(CORNERS));
        DVec3::new(radius * cos, y, radius * sin)
    })
}

/// Thirty points on a ball about a point of the y axis, turned by an angle: the middles of an icosahedron's edges.
fn around(radius: f64, y: f64, turn: f64) -> Vec<DVec3> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut points = vec![DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    for k in 0..8_u32 {
        let sign = |bit: u32| if k >> bit & 1 == 0 { 0.5 } else { -0.5 };
        let [a, b, c] = [sign(0), sign(1) * golden, sign(2) * golden * golden];
        points.extend([DVec3::new(a, b, c), DVec3::new(b, c, a), DVec3::new(c, a, b)]);
    }
    let (sin, cos) = sin_cos(turn);
    let turned = |p: &DVec3| DVec3::new(cos * p.x + sin * p.z, p.y, cos * p.z - sin * p.x);
    points.iter().map(|point| DVec3::Y * y + radius * turned(point).normalize()).collect()
}

/// The volume of the hull of two balls: two caps and the part of a cone between the circles at which it touches them.
fn tapered([bottom, top]: [f64; 2], height: f64) -> f64 {
    let (small, large) = (top.min(bottom), top.max(bottom));
    let sin = (large - small) / height;
    if sin >= 1.0 {
        return 4.0 / 3.0 * PI * large * large * large;
    }
    let cos = (1.0 - sin * sin).sqrt();
    let cap = |radius: f64, deep: f64| PI / 3.0 * deep * deep * (3.0 * radius - deep);
    let [a, b] = [large * cos, small * cos];
    let between = height - (large - small) * sin;
    cap(large, large * (1.0 + sin)) + cap(small, small * (1.0 - sin)) + PI / 3.0 * between * (a * a + a * b + b * b)
}

/// The hull of points that a node scales, which then has this volume times that of its scale. The first points may be
/// turned about y, so that no faces are nearly in one plane.
fn scaled(points: impl Fn(f64) -> Vec<DVec3>, scale: DVec3, volume: f64, what: &str) -> Result<Option<Solid>, String> {
    let volume = volume * scale.element_product();
    let mut last = Err("it is flat".to_owned());
    for k in 0..TURNS {
        let points: Vec<DVec3> = points(f64::from(k) * TURN).iter().map(|point| place(*point * scale)).collect();
        let reach = points.iter().map(|point| point.length()).fold(0.0, f64::max);
        let own = hull_volume(&points).map_err(|error| error.to_string())?;
        // It grows about its middle, so that its centre of gravity stays.
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        let more = cbrt(volume / own);
        let points = points.into_iter().map(|point| middle + more * (point - middle)).collect();
        last = of_points(points, volume, reach, what);
        if last.is_ok() {
            break;
        }
    }
    last
}

fn of_points(points: Vec<DVec3>, volume: f64, reach: f64, what: &str) -> Result<Option<Solid>, String> {
    let kept = corners(&points).map_err(|error| error.to_string())?.points;
    // As a scenario has them.
    let written: Vec<DVec3> = kept.iter().map(|point| (*point * 1e9).round() * 1e-9).collect();
    ConvexHull::new(&written, 0.0).map_err(|error| error.to_string())?;
    let far = kept.iter().map(|point| point.length()).fold(0.0, f64::max);
    let replaced = format!(
        "its {what}, replaced by a hull of {} corners with its volume, which stand out by up to {} mm",
        kept.len(),
        number(1e3 * (far - reach).max(0.0))
    );
    let shape = Shape::Solid { said: hull(&kept), volume };
    Ok(Some(Solid { shape, reach: far, replaced: Some(replaced) }))
}
