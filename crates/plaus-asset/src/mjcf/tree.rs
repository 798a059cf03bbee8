//! The bodies of a model, from its tree to places in the world.

use super::settings::{Settings, colour};
use super::words::upwards;
use crate::AssetError;
use crate::model::{Body, Geom, Inertial, Joint, JointKind, Solid, tensor};
use crate::xml::{Element, Words};
use glam::{DQuat, DVec3};

/// Of water, as in MuJoCo.
const DENSITY: f64 = 1000.0;

/// All bodies.
pub(super) fn bodies(root: &Element, settings: &Settings) -> Result<Vec<Body>, AssetError> {
    let world = Body {
        name: "world".into(),
        parent: 0,
        at: DVec3::ZERO,
        turn: DQuat::IDENTITY,
        joints: Vec::new(),
        geoms: Vec::new(),
        mass: None,
        gravcomp: 0.0,
        is_mocap: false,
    };
    let mut tree = Tree { settings, bodies: vec![world], copies: 0 };
    for section in root.all("worldbody") {
        let within = Within { pose: (DVec3::ZERO, DQuat::IDENTITY), class: section.get("childclass"), suffix: "" };
        tree.inside(section, 0, within)?;
    }
    Ok(tree.bodies)
}

/// Where something is, and how it is turned.
type Pose = (DVec3, DQuat);

fn after((at, turn): Pose, (more, by): Pose) -> Pose {
    (at + turn * more, (turn * by).normalize())
}

/// Most elements that replicas may add.
const MOST_COPIES: usize = 50_000;

struct Tree<'a> {
    settings: &'a Settings,
    bodies: Vec<Body>,
    /// Elements within replicas so far.
    copies: usize,
}

/// What holds for all that belongs to something: where that is in the world, the class of elements that name none, and
/// what is added to names.
#[derive(Clone, Copy)]
struct Within<'b> {
    pose: Pose,
    class: Option<&'b str>,
    suffix: &'b str,
}

impl<'a> Tree<'a> {
    /// Reads what belongs to a body: its own element, or a frame.
    fn inside(&mut self, of: &Element, body: usize, within: Within<'_>) -> Result<(), AssetError> {
        let Within { pose, class, suffix } = within;
        let named = |name: Option<String>| name.map(|name| name + suffix);
        for child in &of.children {
            if !suffix.is_empty() {
                self.copies += 1;
                if self.copies > MOST_COPIES {
                    let what = format!("more than {MOST_COPIES} elements in replicas: make `count` smaller");
                    return Err(child.place.wrong(what));
                }
            }
            let words = |class| self.settings.classes.words(child, class);
            match child.tag.as_str() {
                "geom" => {
                    let geom = self.geom(&words(class)?, pose)?;
                    self.bodies[body].geoms.push(Geom { name: named(geom.name), ..geom });
                }
                "joint" | "freejoint" if body == 0 => return Err(child.place.wrong("the world cannot have a joint")),
                "joint" | "freejoint" => {
                    let joint = self.joint(&words(class)?, pose)?;
                    if joint.kind == JointKind::Free && self.bodies[body].parent != 0 {
                        return Err(child.place.wrong("only a body that belongs to the world can be free"));
                    }
                    self.bodies[body].joints.push(Joint { name: named(joint.name), ..joint });
                }
                "inertial" if !self.settings.mass_from_shapes => {
                    self.bodies[body].mass = Some(inertial(&words(None)?, self.settings, pose)?);
                }
                "frame" => {
                    let words = words(None)?;
                    let inner = after(pose, words.pose(&self.settings.angles)?);
                    self.inside(child, body, Within { pose: inner, class: words.get("childclass").or(class), suffix })?;
                }
                "replicate" => self.replicas(child, body, within)?,
                "body" => {
                    let words = words(None)?;
                    let (at, turn) = after(pose, words.pose(&self.settings.angles)?);
                    let index = self.bodies.len();
                    self.bodies.push(Body {
                        name: named(words.get("name").map(String::from)).unwrap_or_else(|| format!("body_{index}")),
                        parent: body,
                        at,
                        turn,
                        joints: Vec::new(),
                        geoms: Vec::new(),
                        mass: None,
                        gravcomp: words.number("gravcomp")?.unwrap_or(0.0),
                        is_mocap: words.one_of("mocap", &["true", "false"])? == Some("true"),
                    });
                    let class = words.get("childclass").or(class);
                    self.inside(child, index, Within { pose: (at, turn), class, suffix })?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Several times what is inside: each copy is turned by `euler` once more than the one before it, and moved from it
    /// by `offset` along its axes. Names get the number of the copy, with as many digits as `count`.
    fn replicas(&mut self, of: &Element, body: usize, within: Within<'_>) -> Result<(), AssetError> {
        let words = self.settings.classes.words(of, None)?;
        let count = words.number("count")?.filter(|count| (1.0..=1e5).contains(count) && count.fract() == 0.0);
        let Some(count) = count else { return Err(words.wrong("count", "a whole number from 1 to 100000 is needed")) };
        let count = count as u32;
        let offset = words.vector("offset")?.unwrap_or(DVec3::ZERO);
        let euler = words.vector("euler")?.unwrap_or(DVec3::ZERO);
        let (separator, digits) = (words.get("sep").unwrap_or(""), count.to_string().len());
        let class = words.get("childclass").or(within.class);
        let mut at = DVec3::ZERO;
        for nth in 0..count {
            let turn = self.settings.angles.euler(&(euler * f64::from(nth)).to_array());
            let suffix = format!("{separator}{nth:0digits$}{}", within.suffix);
            self.inside(of, body, Within { pose: after(within.pose, (at, turn)), class, suffix: &suffix })?;
            at += turn * offset;
        }
        Ok(())
    }

    fn joint(&self, words: &Words<'_>, pose: Pose) -> Result<Joint, AssetError> {
        let kind = match words.one_of("type", &["hinge", "slide", "ball", "free"])? {
            _ if words.of.tag == "freejoint" => JointKind::Free,
            Some("slide") => JointKind::Slide,
            Some("ball") => JointKind::Ball,
            Some("free") => JointKind::Free,
            _ => JointKind::Hinge,
        };
        let Some(axis) = words.vector("axis")?.unwrap_or(DVec3::Z).try_normalize() else {
            return Err(words.wrong("axis", "it has no direction"));
        };
        let range = words.numbers("range", 2..=2)?;
        let is_limited = match words.one_of("limited", &["true", "false", "auto"])? {
            Some("true") => true,
            Some("false") => false,
            _ => self.settings.auto_limits,
        };
        let unit = if matches!(kind, JointKind::Hinge | JointKind::Ball) { self.settings.angles.unit } else { 1.0 };
        let start = if kind == JointKind::Ball { 0.0 } else { words.number("ref")?.unwrap_or(0.0) };
        let limits = range.filter(|_| is_limited).map(|range| [0, 1].map(|k| (range[k] - start) * unit));
        if limits.is_some_and(|[low, high]| low > high) {
            return Err(words.wrong("range", "the first number must not be larger than the second"));
        }
        Ok(Joint {
            name: words.get("name").map(String::from),
            kind,
            at: pose.0 + pose.1 * words.vector("pos")?.unwrap_or(DVec3::ZERO),
            axis: pose.1 * axis,
            limits,
            friction: words.amount("frictionloss")?.unwrap_or(0.0),
            spring: [
                words.amount("stiffness")?.unwrap_or(0.0),
                (words.number("springref")?.unwrap_or(0.0) - start) * unit,
                words.amount("damping")?.unwrap_or(0.0),
            ],
        })
    }

    fn geom(&self, words: &Words<'_>, pose: Pose) -> Result<Geom, AssetError> {
        let kinds = ["plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf"];
        let kind = words.one_of("type", &kinds)?.unwrap_or("sphere");
        let size = words.numbers("size", 1..=3)?.unwrap_or_default();
        let ends =
            words.numbers("fromto", 6..=6)?.filter(|_| matches!(kind, "capsule" | "cylinder" | "box" | "ellipsoid"));
        let (own, size) = match ends {
            Some(ends) => {
                let [from, to] = [0, 3].map(|k| DVec3::from_slice(&ends[k..]));
                let along = from - to;
                let Some(axis) = along.try_normalize() else {
                    return Err(words.wrong("fromto", "the two ends are in the same place"));
                };
                let (wide, half) = (size.first().copied().unwrap_or(0.0), 0.5 * along.length());
                let size = if matches!(kind, "box" | "ellipsoid") { vec![wide, wide, half] } else { vec![wide, half] };
                ((0.5 * (from + to), upwards(axis)), size)
            }
            None => (words.pose(&self.settings.angles)?, size),
        };
        let (at, turn) = after(pose, own);
        let condim = words.number("condim")?.unwrap_or(3.0);
        let bits = |name: &str| words.number(name).map(|bits| bits.unwrap_or(1.0) != 0.0);
        let material = words.get("material").and_then(|name| self.settings.colours.get(name)).copied();
        let friction = words.numbers("friction", 1..=3)?.map_or(1.0, |friction| friction[0]);
        Ok(Geom {
            name: words.get("name").map(String::from),
            solid: self.solid(words, kind, &size)?,
            at,
            turn,
            mass: words.amount("mass")?,
            density: words.amount("density")?.unwrap_or(DENSITY),
            friction: Some(if condim == 1.0 { 0.0 } else { friction.max(0.0) }),
            collides: bits("contype")? | bits("conaffinity")?,
            colour: colour(words)?.or(material),
            left_out: (words.get("mesh").is_some() && kind != "mesh")
                .then(|| format!("the {kind} that is to be fitted to its mesh: the mesh is used itself")),
        })
    }

    fn solid(&self, words: &Words<'_>, kind: &str, size: &[f64]) -> Result<Solid, AssetError> {
        if let Some(name) = words.get("mesh").filter(|_| !matches!(kind, "hfield" | "sdf" | "plane")) {
            let found = self.settings.meshes.iter().position(|mesh| mesh.name == name);
            return found.map(Solid::Mesh).ok_or_else(|| words.wrong("mesh", format!("there is no mesh {name:?}")));
        }
        let needed = match kind {
            "sphere" => 1,
            "capsule" | "cylinder" => 2,
            "box" | "ellipsoid" => 3,
            _ => 0,
        };
        if size.len() < needed || size.iter().take(needed).any(|size| *size <= 0.0) {
            return Err(words.wrong("size", format!("a {kind} needs {needed} positive numbers")));
        }
        Ok(match kind {
            "plane" => Solid::Plane,
            "sphere" => Solid::Ball(size[0]),
            "capsule" => Solid::Capsule(size[0], size[1]),
            "cylinder" => Solid::Cylinder(size[0], size[1]),
            "box" => Solid::Box(DVec3::from_slice(size)),
            "ellipsoid" => Solid::Ellipsoid(DVec3::from_slice(size)),
            "mesh" => return Err(words.wrong("mesh", "a mesh needs its name")),
            other => Solid::Other(other.to_owned()),
        })
    }
}

fn inertial(words: &Words<'_>, settings: &Settings, pose: Pose) -> Result<Inertial, AssetError> {
    let Some(mass) = words.amount("mass")? else { return Err(words.wrong("mass", "it is needed")) };
    let (at, turn) = after(pose, words.pose(&settings.angles)?);
    let moments = match words.numbers("diaginertia", 3..=3)? {
        Some(moments) => Some(moments),
        None => words.numbers("fullinertia", 6..=6)?,
    };
    let mut six = [0.0; 6];
    six.iter_mut().zip(moments.unwrap_or_default()).for_each(|(number, said)| *number = said);
    Ok(Inertial { mass, at, tensor: tensor(six, turn) })
}
