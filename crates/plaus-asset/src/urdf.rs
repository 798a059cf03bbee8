//! Models in URDF, the XML format of robots in ROS: links, and the joints between them.
//!
//! The file does not say whether its root is fixed. Here it stands still if it is called `world`, or if it has no mass
//! together with all that is fixed to it; else it is free. Links pass through each other, as by default in programs
//! that run such models.

use super::AssetError;
use super::mjcf::words::about;
use super::model::{Body, Corners, Geom, Inertial, Joint, JointKind, Mesh, Model, Open, Solid, tensor};
use super::unread::{EVERY, Known, unread};
use super::xml::{Element, Words};
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;

/// In m/s²; the file gives none.
const GRAVITY: f64 = 9.806_65;
/// Of water, in kg/m³, for what has no mass.
const DENSITY: f64 = 1000.0;
/// How many folders up the folder of a package is looked for.
const HIGHEST: usize = 3;

const GROUND: &str = "what it stands on, which no model says: a level floor at height 0";

const KNOWN: Known = Known { root: "robot", read: &READ, is_usual: |_, _| false, is_harmless };

const READ: [(&str, &[&str]); 25] = [
    ("robot", &["name", "version"]),
    ("link", &["name", "type"]),
    ("inertial", &[]),
    ("mass", &["value"]),
    ("inertia", EVERY),
    ("visual", EVERY),
    ("collision", &["name"]),
    ("origin", &["xyz", "rpy"]),
    ("geometry", &[]),
    ("box", &["size"]),
    ("cylinder", &["radius", "length"]),
    ("capsule", &["radius", "length"]),
    ("sphere", &["radius"]),
    ("mesh", &["filename", "scale"]),
    ("material", EVERY),
    ("joint", &["name", "type"]),
    ("parent", &["link"]),
    ("child", &["link"]),
    ("axis", &["xyz"]),
    // What motors may do; there are none.
    ("limit", &["lower", "upper", "effort", "velocity"]),
    ("dynamics", &["friction", "damping"]),
    ("calibration", EVERY),
    ("safety_controller", EVERY),
    ("verbose", EVERY),
    // It is told with what its joint does instead.
    ("mimic", EVERY),
];

fn is_harmless(what: &str) -> bool {
    [" in <transmission>", " in <ros2_control>", " in <sensor>"].iter().any(|end| what.ends_with(end))
}

/// The model with this root; `open` tells which files of packages there are.
pub(super) fn model(root: &Element, open: Open<'_>) -> Result<Model, AssetError> {
    let mut reader = Reader::new(root, open)?;
    let mut world = reader.body("world".into(), 0, (DVec3::ZERO, DQuat::IDENTITY));
    world.geoms.push(ground());
    reader.bodies.push(world);
    let top = reader.top(root)?;
    let mut next = vec![(top, 0, (DVec3::ZERO, DQuat::IDENTITY), None)];
    while let Some((name, parent, pose, by)) = next.pop() {
        let index = reader.link(name, parent, pose, by)?;
        // The first of a list comes first.
        for &joint in reader.below.get(name).into_iter().flatten().rev() {
            next.push((reader.end(joint, "child")?, index, after(pose, origin(joint)?), Some(joint)));
        }
    }
    if let Some(lost) = reader.links.keys().find(|name| !reader.placed.contains_key(*name)) {
        let what = format!("link {lost:?} is not connected to the root: its joints form a loop");
        return Err(root.place.wrong(what));
    }
    // What is fixed to the root, with it, has mass: then it is free.
    let mut is_one = vec![true; reader.bodies.len()];
    for index in 2..is_one.len() {
        let body = &reader.bodies[index];
        is_one[index] = body.joints.is_empty() && is_one[body.parent];
    }
    let is_heavy = |body: &Body| body.mass.is_some_and(|own| own.mass > 0.0);
    if top != "world" && reader.bodies.iter().zip(&is_one).any(|(body, is_one)| *is_one && is_heavy(body)) {
        let (at, axis) = (DVec3::ZERO, DVec3::Z);
        let free = Joint { name: None, kind: JointKind::Free, at, axis, limits: None, friction: 0.0, spring: [0.0; 3] };
        reader.bodies[1].joints.push(free);
    }
    let [left_out, harmless] = unread(root, &KNOWN);
    Ok(Model {
        gravity: DVec3::new(0.0, 0.0, -GRAVITY),
        bodies: reader.bodies,
        meshes: reader.meshes,
        are_hulls: false,
        passes_itself: true,
        left_out: reader.left_out.into_iter().chain(left_out).collect(),
        harmless: [GROUND.to_owned()].into_iter().chain(harmless).collect(),
    })
}

/// A level floor at height 0: what is free would fall for ever.
fn ground() -> Geom {
    Geom {
        name: Some("floor".into()),
        solid: Solid::Plane,
        at: DVec3::ZERO,
        turn: DQuat::IDENTITY,
        mass: None,
        density: DENSITY,
        friction: None,
        collides: true,
        colour: None,
        left_out: None,
    }
}

/// Where something is, and how it is turned.
type Pose = (DVec3, DQuat);

struct Reader<'a, 'o> {
    links: BTreeMap<&'a str, &'a Element>,
    /// The joints below each link.
    below: BTreeMap<&'a str, Vec<&'a Element>>,
    colours: BTreeMap<&'a str, [u8; 3]>,
    placed: BTreeMap<&'a str, usize>,
    bodies: Vec<Body>,
    meshes: Vec<Mesh>,
    left_out: Vec<String>,
    open: Open<'o>,
}

impl<'a, 'o> Reader<'a, 'o> {
    fn new(root: &'a Element, open: Open<'o>) -> Result<Self, AssetError> {
        let mut reader = Self {
            links: BTreeMap::new(),
            below: BTreeMap::new(),
            colours: BTreeMap::new(),
            placed: BTreeMap::new(),
            bodies: Vec::new(),
            meshes: Vec::new(),
            left_out: Vec::new(),
            open,
        };
        for link in root.all("link") {
            if reader.links.insert(named(link, "name")?, link).is_some() {
                return Err(link.place.wrong("another link has this name"));
            }
        }
        for material in root.all("material") {
            if let (Some(name), Some(colour)) = (material.get("name"), colour(material)?) {
                reader.colours.insert(name, colour);
            }
        }
        for joint in root.all("joint") {
            for end in ["parent", "child"] {
                let link = reader.end(joint, end)?;
                if end == "parent" {
                    reader.below.entry(link).or_default().push(joint);
                }
            }
        }
        Ok(reader)
    }

    /// The link at an end of a joint.
    fn end(&self, joint: &'a Element, end: &'a str) -> Result<&'a str, AssetError> {
        let Some(said) = joint.all(end).next() else { return Err(joint.place.wrong(format!("<{end}> is needed"))) };
        let name = named(said, "link")?;
        if self.links.contains_key(name) {
            Ok(name)
        } else {
            Err(said.place.wrong(format!("there is no link {name:?}")))
        }
    }

    /// The only link that is the child of none.
    fn top(&self, root: &'a Element) -> Result<&'a str, AssetError> {
        let children: Vec<&str> = root.all("joint").map(|joint| self.end(joint, "child")).collect::<Result<_, _>>()?;
        let mut tops = self.links.keys().filter(|name| !children.contains(name));
        match (tops.next(), tops.next()) {
            (Some(one), None) => Ok(one),
            (Some(one), Some(other)) => {
                let what = format!("neither {one:?} nor {other:?} is the child of a joint: there must be one root");
                Err(root.place.wrong(what))
            }
            (None, _) => Err(root.place.wrong("every link is the child of a joint: there must be one root")),
        }
    }

    fn body(&self, name: String, parent: usize, (at, turn): Pose) -> Body {
        let (joints, geoms) = (Vec::new(), Vec::new());
        Body { name, parent, at, turn, joints, geoms, mass: None, gravcomp: 0.0, is_mocap: false }
    }

    /// A link, by the joint that holds it; returns its body's index.
    fn link(&mut self, name: &'a str, parent: usize, pose: Pose, by: Option<&Element>) -> Result<usize, AssetError> {
        let index = self.bodies.len();
        let element = self.links[name];
        if self.placed.insert(name, index).is_some() {
            return Err(by.unwrap_or(element).place.wrong(format!("link {name:?} is the child of two joints")));
        }
        let mut body = self.body(name.to_owned(), parent, pose);
        body.joints = by.map_or(Ok(Vec::new()), |joint| self.joint(joint, name, pose))?;
        body.mass = element.all("inertial").next().map(|said| inertial(said, pose)).transpose()?;
        let looks: Vec<&Element> = element.all("visual").collect();
        let solid: Vec<&Element> = element.all("collision").collect();
        // What is only seen has a shape too, if nothing else gives one.
        let (parts, collides) = if solid.is_empty() { (&looks, false) } else { (&solid, true) };
        let colour = looks.iter().find_map(|look| look.all("material").next());
        let colour = match colour {
            Some(said) => colour_of(said, &self.colours)?,
            None => None,
        };
        for part in parts {
            let geom = self.geom(part, name, pose)?;
            // Only what is inertial has mass.
            body.geoms.extend(geom.map(|geom| Geom { collides, colour, mass: Some(0.0), ..geom }));
        }
        if body.mass.is_none_or(|own| own.mass == 0.0) {
            body.mass = None;
        }
        self.bodies.push(body);
        Ok(index)
    }

    /// What a joint lets move, as joints of a body.
    fn joint(&mut self, of: &Element, link: &str, (at, turn): Pose) -> Result<Vec<Joint>, AssetError> {
        let words = words(of);
        let name = words.get("name").map(String::from);
        let kinds = ["fixed", "revolute", "continuous", "prismatic", "floating", "planar"];
        let Some(kind) = words.one_of("type", &kinds)? else { return Err(words.wrong("type", "it is needed")) };
        let axis = part(of, "axis").map_or(Ok(None), |said| said.vector("xyz"))?.unwrap_or(DVec3::X);
        let Some(axis) = axis.try_normalize().map(|axis| turn * axis) else {
            return Err(of.place.wrong("its axis has no direction"));
        };
        let limit = part(of, "limit");
        let bound = |name| limit.as_ref().map_or(Ok(None), |said| said.number(name)).map(|said| said.unwrap_or(0.0));
        let range = [bound("lower")?, bound("upper")?];
        let limits = (kind == "revolute" || kind == "prismatic").then_some(range);
        if limits.is_some_and(|[low, high]| low > high) {
            return Err(of.place.wrong("its lower limit is larger than its upper"));
        }
        if let (Some(by), true) = (part(of, "mimic").as_ref().map(|said| said.get("joint")), kind != "fixed") {
            self.left_out
                .push(format!("{link}: its joint's `mimic` of {}: it moves by itself", by.unwrap_or("another")));
        }
        let dynamics = part(of, "dynamics");
        let lost = |name| dynamics.as_ref().map_or(Ok(None), |said| said.amount(name)).map(|said| said.unwrap_or(0.0));
        let (friction, spring) = (lost("friction")?, [0.0, 0.0, lost("damping")?]);
        let one = |kind| Joint { name: name.clone(), kind, at, axis, limits, friction, spring };
        Ok(match kind {
            "fixed" => Vec::new(),
            "floating" => vec![one(JointKind::Free)],
            "prismatic" => vec![one(JointKind::Slide)],
            "planar" => vec![one(JointKind::Slide), one(JointKind::Slide), one(JointKind::Hinge)],
            _ => vec![one(JointKind::Hinge)],
        })
    }

    /// A shape of a link.
    fn geom(&mut self, of: &Element, link: &str, pose: Pose) -> Result<Option<Geom>, AssetError> {
        let (at, turn) = after(pose, origin(of)?);
        let Some(said) = of.all("geometry").next().and_then(|geometry| geometry.children.first()) else {
            return Err(of.place.wrong("it needs a <geometry> with a shape"));
        };
        let words = words(said);
        let length = |name: &str| match words.number(name)? {
            Some(length) if length > 0.0 => Ok(length),
            _ => Err(words.wrong(name, "a length in m, more than 0, is needed")),
        };
        let solid = match said.tag.as_str() {
            "box" => match words.vector("size")?.filter(|size| size.min_element() > 0.0) {
                Some(size) => Solid::Box(0.5 * size),
                None => return Err(words.wrong("size", "three lengths in m, more than 0, are needed")),
            },
            "cylinder" => Solid::Cylinder(length("radius")?, 0.5 * length("length")?),
            "capsule" => Solid::Capsule(length("radius")?, 0.5 * length("length")?),
            "sphere" => Solid::Ball(length("radius")?),
            "mesh" => Solid::Mesh(self.mesh(&words)?),
            other => {
                self.left_out.push(format!("{link}: its shape, {other}"));
                return Ok(None);
            }
        };
        let name = of.get("name").filter(|name| !name.is_empty()).map(String::from);
        let (mass, density, friction, collides) = (None, DENSITY, None, true);
        let (colour, left_out) = (None, None);
        Ok(Some(Geom { name, solid, at, turn, mass, density, friction, collides, colour, left_out }))
    }

    /// The index of a mesh, which may be one that is known.
    fn mesh(&mut self, words: &Words<'_>) -> Result<usize, AssetError> {
        let Some(name) = words.get("filename") else { return Err(words.wrong("filename", "it is needed")) };
        let scale = words.vector("scale")?.unwrap_or(DVec3::ONE);
        let found = self.meshes.iter().position(|mesh| mesh.name == name && mesh.scale == scale);
        if let Some(known) = found {
            return Ok(known);
        }
        let from = Corners::File(self.path(name).map_err(|why| words.wrong("filename", why))?);
        let (origin, turn) = (DVec3::ZERO, DQuat::IDENTITY);
        self.meshes.push(Mesh { name: name.to_owned(), from, origin, turn, scale });
        Ok(self.meshes.len() - 1)
    }

    /// The path of a file from the model's folder. A package is a folder around the model, or beside one around it.
    fn path(&mut self, name: &str) -> Result<String, String> {
        let Some(inside) = name.strip_prefix("package://").or_else(|| name.strip_prefix("model://")) else {
            return Ok(name.strip_prefix("file://").unwrap_or(name).to_owned());
        };
        let rest = inside.split_once('/').map_or(inside, |(_, rest)| rest);
        let ups = (0..=HIGHEST).map(|up| "../".repeat(up));
        let tried: Vec<String> = ups.flat_map(|up| [format!("{up}{rest}"), format!("{up}{inside}")]).collect();
        let mut why = String::new();
        for path in &tried {
            match (self.open)(path) {
                Ok(_) => return Ok(path.clone()),
                Err(said) if why.is_empty() => why = format!("{path}: {said}"),
                Err(_) => {}
            }
        }
        Err(format!(
            "{name} is not found as {rest} in the model's folder, or up to {HIGHEST} above it ({why}); write the \
             scenario into the folder that holds both"
        ))
    }
}

/// All that an element says.
fn words(of: &Element) -> Words<'_> {
    Words { of, said: of.attributes.clone() }
}

/// What its first part of this tag says.
fn part<'b>(of: &'b Element, tag: &'b str) -> Option<Words<'b>> {
    of.all(tag).next().map(words)
}

fn named<'b>(of: &'b Element, attribute: &str) -> Result<&'b str, AssetError> {
    of.get(attribute).ok_or_else(|| of.place.wrong(format!("<{}> needs `{attribute}`", of.tag)))
}

fn after((at, turn): Pose, (more, by): Pose) -> Pose {
    (at + turn * more, (turn * by).normalize())
}

/// Where something is in what it belongs to: turned about x, then y, then z, which stay where they are.
fn origin(of: &Element) -> Result<Pose, AssetError> {
    let Some(said) = part(of, "origin") else { return Ok((DVec3::ZERO, DQuat::IDENTITY)) };
    let at = said.vector("xyz")?.unwrap_or(DVec3::ZERO);
    let angles = said.vector("rpy")?.unwrap_or(DVec3::ZERO);
    let turn = about(DVec3::Z, angles.z) * about(DVec3::Y, angles.y) * about(DVec3::X, angles.x);
    Ok((at, turn.normalize()))
}

fn inertial(of: &Element, pose: Pose) -> Result<Inertial, AssetError> {
    let mass = part(of, "mass").map_or(Ok(None), |said| said.amount("value"))?;
    let Some(mass) = mass else { return Err(of.place.wrong("<inertial> needs a <mass> with a `value`")) };
    let mut six = [0.0; 6];
    if let Some(said) = part(of, "inertia") {
        for (number, name) in six.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
            *number = said.number(name)?.unwrap_or(0.0);
        }
    }
    let (at, turn) = after(pose, origin(of)?);
    Ok(Inertial { mass, at, tensor: tensor(six, turn) })
}

/// The colour that a material gives.
fn colour(material: &Element) -> Result<Option<[u8; 3]>, AssetError> {
    let said = part(material, "color").map_or(Ok(None), |said| said.numbers("rgba", 3..=4))?;
    let channel = |share: f64| (255.0 * share.clamp(0.0, 1.0)).round() as u8;
    Ok(said.map(|rgba| [0, 1, 2].map(|k| channel(rgba[k]))))
}

/// Its own, or that of the robot's material of its name.
fn colour_of(said: &Element, known: &BTreeMap<&str, [u8; 3]>) -> Result<Option<[u8; 3]>, AssetError> {
    Ok(colour(said)?.or_else(|| said.get("name").and_then(|name| known.get(name)).copied()))
}
