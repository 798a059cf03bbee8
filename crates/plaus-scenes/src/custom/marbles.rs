//! Worlds of balls that are simulated as marbles: without orientation, and faster. What such a world may hold, how it
//! is made, and which piece of scenery a surface of it belongs to.

use super::config::{Body, Config};
use super::shapes::Shape;
use super::standing::Standing;
use super::values::Numbers;
use crate::scene::ConfigError;
use glam::DVec3;
use plaus_sim::WorldError;
use plaus_sim::marbles::{MarbleWorld, Marbles};
use plaus_sim::material::Material as Kind;
use plaus_sim::rigid::Start;
use plaus_sim::scenery::{Mesh, Plane, Scenery, Surface};

/// A world of marbles.
#[derive(Debug)]
pub(super) struct Marbled {
    pub(super) world: Marbles,
    /// Of each plane, and of each triangle, which piece of scenery it belongs to.
    planes: Vec<usize>,
    faces: Vec<usize>,
    /// Solid pieces of scenery, each with the planes of its faces: the simulator does not notice a ball that begins
    /// deep inside.
    solids: Vec<(usize, Vec<Plane>)>,
}

/// Refuses what no marble is and does.
pub(super) fn check(config: &Config) -> Result<(), ConfigError> {
    let wrong = |key: String, what: &str| {
        let message = format!("{what}; leave this out, or take `mechanics = \"turning\"`");
        Err(ConfigError::new(format!("world.custom.{key}"), message))
    };
    for (index, body) in config.bodies.iter().enumerate() {
        let key = |key: &str| format!("bodies[{index}].{key}");
        if !matches!(body.shape, Shape::Ball(_)) {
            return wrong(key("shape"), &format!("marbles are balls, and this is a {}", body.shape.name()));
        }
        if let Some(acts) = acts(body) {
            return wrong(key(acts), "marbles feel only gravity and contact, and all of them collide");
        }
    }
    let grips = config.materials.iter().position(|one| one.static_friction.is_some());
    if let Some(index) = grips {
        return wrong(format!("materials[{index}].static_friction"), "marbles have one coefficient of friction");
    }
    if let Some(index) = config.pairs.iter().position(|one| one.static_friction.is_some()) {
        return wrong(format!("pairs[{index}].static_friction"), "marbles have one coefficient of friction");
    }
    if let Some(index) = config.materials.iter().position(|one| !one.scatter.is_unset()) {
        return wrong(format!("materials[{index}].scatter"), "impacts of marbles do not scatter");
    }
    match config {
        Config { driven, .. } if !driven.is_empty() => wrong("driven".into(), "driven bodies cannot push marbles"),
        Config { joints, .. } if !joints.is_empty() => wrong("joints".into(), "marbles cannot be on joints"),
        Config { bottom_mm: Some(_), .. } => wrong("bottom_mm".into(), "marbles are not removed below a height"),
        _ => Ok(()),
    }
}

/// The key of what acts on a body besides gravity and contact.
fn acts(body: &Body) -> Option<&'static str> {
    let plain = Config::default().bodies.swap_remove(0);
    let acts = [
        ("asleep", body.asleep),
        ("appears", body.appears.is_some()),
        ("inertia", body.inertia.is_some()),
        ("gravity_scale", body.gravity_scale != plain.gravity_scale),
        ("damping", body.damping != plain.damping),
        ("angular_damping", body.angular_damping != plain.angular_damping),
        ("force_n", body.force_n != plain.force_n),
        ("no_contact", !body.no_contact.is_empty()),
        ("torque_n_m", body.torque_n_m != plain.torque_n_m),
        ("own_force_n", body.own_force_n != plain.own_force_n),
        ("own_torque_n_m", body.own_torque_n_m != plain.own_torque_n_m),
    ];
    acts.into_iter().find_map(|(key, acts)| acts.then_some(key))
}

/// Refuses scenery that no marble meets.
pub(super) fn check_part(part: &Standing, numbers: &Numbers<'_>) -> Result<(), ConfigError> {
    if part.is_plane() || !part.is_arc() && part.surface(numbers).is_ok() {
        return Ok(());
    }
    let message = "marbles meet planes, meshes, ground by its heights, and boxes and hulls without rounding; take one \
                   of these, or `mechanics = \"turning\"`";
    Err(ConfigError::new(format!("{}.shape", part.key), message))
}

impl Marbled {
    /// `world` with a draw's scenery: the pieces that are there, with their indices.
    pub(super) fn new<'a>(
        world: MarbleWorld,
        parts: impl Iterator<Item = (usize, &'a Standing)>,
        numbers: &Numbers<'_>,
    ) -> Result<Self, WorldError> {
        let (mut planes, mut vertices, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        let ([mut of_planes, mut of_faces], mut solids) = ([Vec::new(), Vec::new()], Vec::new());
        for (index, part) in parts {
            let ((at, turn), material) = (part.pose(numbers), Kind(part.substance as u16));
            let Ok((corners, faces)) = part.surface(numbers) else {
                planes.push(Plane::new(at, turn * DVec3::Z, material)?);
                of_planes.push(index);
                continue;
            };
            let (first, corners) = (vertices.len() as u32, corners.into_iter().map(|corner| at + turn * corner));
            vertices.extend(corners);
            if part.form().is_some() {
                let corner = |k: u32| vertices[(first + k) as usize];
                let plane = |[a, b, c]: &[u32; 3]| {
                    let [a, b, c] = [a, b, c].map(|&k| corner(k));
                    Plane::new(a, (b - a).cross(c - a), material)
                };
                solids.push((index, faces.iter().map(plane).collect::<Result<_, _>>()?));
            }
            of_faces.resize(of_faces.len() + faces.len(), index);
            triangles.extend(faces.into_iter().map(|face| (face.map(|corner| first + corner), material)));
        }
        let reach = world.specs.iter().map(|spec| spec.radius).fold(f64::MIN_POSITIVE, f64::max);
        let scenery = Scenery::new(planes, Mesh::new(vertices, &triangles, 0.0)?, Vec::new(), reach)?;
        let world = Marbles::new(MarbleWorld { scenery, ..world })?;
        Ok(Self { world, planes: of_planes, faces: of_faces, solids })
    }

    /// The first ball whose middle begins inside a solid, that piece of scenery, and the depth in m.
    pub(super) fn buried(&self, starts: &[Start]) -> Option<(usize, usize, f64)> {
        let depth = |planes: &[Plane], x| planes.iter().map(|plane| -plane.distance(x)).fold(f64::INFINITY, f64::min);
        let mut deep = starts.iter().enumerate().flat_map(|(body, start)| {
            self.solids.iter().map(move |(part, planes)| (body, *part, depth(planes, start.position)))
        });
        let (body, part, depth) = deep.find(|(.., depth)| *depth > 0.0)?;
        Some((body, part, self.world.specs()[body].radius + depth))
    }

    /// The piece of scenery that a surface belongs to.
    pub(super) fn part(&self, surface: Surface) -> usize {
        let part = match surface {
            Surface::Plane(plane) => self.planes.get(plane as usize),
            other => self.world.scenery().triangle(other).and_then(|face| self.faces.get(face as usize)),
        };
        // The world has no other surfaces.
        part.copied().unwrap_or_default()
    }
}
