//! The world at a motion's start, for physics engines: the draft extensions `KHR_physics_rigid_bodies` and
//! `KHR_implicit_shapes`.

use super::blob::pushed;
use super::shared::Writer;
use glam::{DQuat, DVec3};
use plaus_animation::{Axis, AxisKind, Collider, Joint, Physics, Rigid, Solid};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

const BODIES: &str = "KHR_physics_rigid_bodies";
const SHAPES: &str = "KHR_implicit_shapes";

/// How the values of two materials combine: what a material has if it has this value with itself, and what two have.
#[derive(Clone, Copy, PartialEq)]
enum Rule {
    Multiply,
    Average,
    Minimum,
    Maximum,
}

/// Rules in order of rank: of two, the one of the higher rank holds.
const RANKS: [Rule; 4] = [Rule::Average, Rule::Minimum, Rule::Maximum, Rule::Multiply];

/// How far friction and restitution of a pair may be off: a millionth.
const OFF: f64 = 1e-6;

impl Rule {
    fn name(self) -> &'static str {
        match self {
            Self::Multiply => "multiply",
            Self::Average => "average",
            Self::Minimum => "minimum",
            Self::Maximum => "maximum",
        }
    }

    fn own(self, with_itself: f64) -> f64 {
        if self == Self::Multiply { with_itself.sqrt() } else { with_itself }
    }

    fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Multiply => a * b,
            Self::Average => 0.5 * (a + b),
            Self::Minimum => a.min(b),
            Self::Maximum => a.max(b),
        }
    }
}

/// Rules of materials that give the most pairs of them what the tables say, and the pairs that get something else.
fn rules(tables: &[&[Vec<f64>]]) -> (Vec<Rule>, Vec<[usize; 2]>) {
    let count = tables[0].len();
    let wrong = |rules: &[Rule]| -> Vec<[usize; 2]> {
        let is_off = |table: &&[Vec<f64>], a: usize, b: usize| {
            let rule = RANKS.into_iter().find(|rule| [rules[a], rules[b]].contains(rule)).unwrap_or(Rule::Multiply);
            (rule.of(rules[a].own(table[a][a]), rules[b].own(table[b][b])) - table[a][b]).abs() > OFF
        };
        let pairs = (0..count).flat_map(|a| (0..a).map(move |b| [a, b]));
        pairs.filter(|&[a, b]| tables.iter().any(|table| is_off(table, a, b))).collect()
    };
    let mut best = vec![Rule::Multiply; count];
    let mut off = wrong(&best);
    for all in RANKS {
        let other = vec![all; count];
        let others = wrong(&other);
        if others.len() < off.len() {
            (best, off) = (other, others);
        }
    }
    // Then one at a time, as long as that helps.
    while let Some((other, others)) = (!off.is_empty()).then_some(()).and_then(|()| {
        let changes = (0..count).flat_map(|k| RANKS.into_iter().map(move |rule| (k, rule)));
        changes.into_iter().find_map(|(k, rule)| {
            let mut other = best.clone();
            other[k] = rule;
            let others = wrong(&other);
            (others.len() < off.len()).then_some((other, others))
        })
    }) {
        (best, off) = (other, others);
    }
    (best, off)
}

/// The materials of what there is.
struct Materials {
    used: Vec<usize>,
    /// Friction, restitution and static friction of pairs of them.
    tables: [Vec<Vec<f64>>; 3],
    rules: [(Vec<Rule>, Vec<[usize; 2]>); 2],
}

impl Materials {
    fn of(world: &Physics) -> Self {
        let bodies = world.bodies.iter().map(|body| body.material);
        let used: BTreeSet<usize> = bodies.chain(world.scenery.iter().map(|one| one.material)).collect();
        let used: Vec<usize> = used.into_iter().collect();
        let row = |a: usize, k: usize| used.iter().map(|&b| world.laws[a][b][k]).collect();
        let tables = [0, 1, 2].map(|k| used.iter().map(|&a| row(a, k)).collect::<Vec<Vec<f64>>>());
        let rules = [rules(&[&tables[0], &tables[2]]), rules(&[&tables[1]])];
        Self { used, tables, rules }
    }

    fn index(&self, material: usize) -> Option<usize> {
        self.used.iter().position(|one| *one == material)
    }

    fn list(&self) -> Vec<Value> {
        let one = |k: usize| {
            let value = |of: usize| self.rules[of % 2].0[k].own(self.tables[of][k][k]);
            json!({ "staticFriction": value(2), "dynamicFriction": value(0), "restitution": value(1),
                    "frictionCombine": self.rules[0].0[k].name(), "restitutionCombine": self.rules[1].0[k].name() })
        };
        (0..self.used.len()).map(one).collect()
    }
}

/// The lists of the extensions.
#[derive(Default)]
struct Lists {
    shapes: Vec<Value>,
    joints: Vec<Value>,
}

impl Writer {
    /// Adds the world at the start of the clip that was added last, which must be the only one.
    pub fn add_physics(&mut self, world: &Physics) {
        let materials = Materials::of(world);
        let systems = systems(world);
        let mut lists = Lists::default();
        let node_of = |name: &str| {
            let bodies = self.bodies.iter().map(|thing| (&thing.what.name, thing.node));
            let mut all = bodies.chain(self.props.iter().map(|thing| (&thing.what.name, thing.node)));
            all.find_map(|(own, node)| (own == name).then_some(node))
        };
        let of_bodies: Vec<Option<usize>> = world.bodies.iter().map(|body| node_of(&body.name)).collect();
        let of_scenery: Vec<Option<usize>> = world.scenery.iter().map(|one| node_of(&one.name)).collect();
        for (index, (body, node)) in world.bodies.iter().zip(&of_bodies).enumerate() {
            let Some(node) = *node else { continue };
            self.said(node)["motion"] = motion(body);
            let mut collider = json!({ "physicsMaterial": materials.index(body.material) });
            if let Some(filter) = systems.get(index).copied().flatten() {
                collider["collisionFilter"] = filter.into();
            }
            self.colliders(node, &body.colliders, (DVec3::ZERO, DQuat::IDENTITY), &collider, &mut lists);
        }
        for (still, node) in world.scenery.iter().zip(of_scenery) {
            let Some(node) = node else { continue };
            let collider = json!({ "physicsMaterial": materials.index(still.material) });
            let place = world.place_of(&still.name).unwrap_or_default();
            self.colliders(node, &still.colliders, place, &collider, &mut lists);
        }
        for joint in &world.joints {
            self.joint(joint, world, &of_bodies, &mut lists);
        }
        let materials = materials.list();
        let all =
            [("physicsMaterials", materials), ("collisionFilters", filters(world)), ("physicsJoints", lists.joints)];
        let all = all.into_iter().filter(|(_, list)| !list.is_empty());
        let all: Map<String, Value> = all.map(|(name, list)| (name.to_owned(), list.into())).collect();
        self.document.extensions.insert(BODIES.into(), all.into());
        if !lists.shapes.is_empty() {
            self.document.extensions.insert(SHAPES.into(), json!({ "shapes": lists.shapes }));
        }
    }

    /// What the extension says of a node.
    fn said(&mut self, node: usize) -> &mut Value {
        &mut self.document.nodes[node]["extensions"][BODIES]
    }

    /// A node below another, or at the root.
    fn child(&mut self, above: Option<usize>, name: String, (at, turn): (DVec3, DQuat)) -> usize {
        let node = json!({ "name": name, "translation": at.to_array(), "rotation": turn.to_array() });
        let node = pushed(&mut self.document.nodes, node);
        match above {
            Some(above) => match &mut self.document.nodes[above]["children"] {
                Value::Array(children) => children.push(node.into()),
                none => *none = json!([node]),
            },
            None => self.extra.push(node),
        }
        node
    }

    /// The colliders of a node whose place their places are not relative to.
    fn colliders(
        &mut self,
        node: usize,
        all: &[Collider],
        (at, turn): (DVec3, DQuat),
        collider: &Value,
        lists: &mut Lists,
    ) {
        let back = turn.conjugate();
        let name = self.document.nodes[node]["name"].as_str().unwrap_or_default().to_owned();
        for (index, one) in all.iter().enumerate() {
            let place = (back * (one.at - at), (back * one.turn).normalize());
            let is_here = all.len() == 1 && place.0.length() < 1e-12 && place.1.w.abs() > 1.0 - 1e-15;
            let own = if is_here { node } else { self.child(Some(node), format!("{name}_part_{}", index + 1), place) };
            let geometry = self.geometry(own, &one.solid, &name, lists);
            let mut collider = collider.clone();
            collider["geometry"] = geometry;
            self.said(own)["collider"] = collider;
        }
    }

    fn geometry(&mut self, node: usize, solid: &Solid, name: &str, lists: &mut Lists) -> Value {
        let shape = |kind: &str, said: Value| {
            let mut shape = json!({ "type": kind });
            shape[kind] = said;
            shape
        };
        let shape = match solid {
            Solid::Drawn => return json!({ "node": node }),
            Solid::Hull(corners, triangles) => {
                // The mesh that is drawn may be another; this one is not drawn.
                let mesh = self.document.surface(name, corners, triangles);
                let hidden = json!({ "name": format!("{name}_hull"), "mesh": mesh });
                return json!({ "node": pushed(&mut self.document.nodes, hidden), "convexHull": true });
            }
            Solid::Ball(radius) => shape("sphere", json!({ "radius": radius })),
            Solid::Box(edges) => shape("box", json!({ "size": edges.to_array() })),
            Solid::Cylinder([bottom, top], height) => {
                shape("cylinder", json!({ "radiusBottom": bottom, "radiusTop": top, "height": height }))
            }
            Solid::Capsule(radius, height) => {
                shape("capsule", json!({ "radiusBottom": radius, "radiusTop": radius, "height": height }))
            }
            Solid::Plane => shape("plane", json!({})),
        };
        let known = lists.shapes.iter().position(|known| *known == shape);
        json!({ "shape": known.unwrap_or_else(|| pushed(&mut lists.shapes, shape)) })
    }

    /// A joint: of the frames of a body and of what it is held to, whose z is its axis. Coordinates are those of the
    /// body's frame as seen from the other.
    fn joint(&mut self, joint: &Joint, world: &Physics, nodes: &[Option<usize>], lists: &mut Lists) {
        let (none, kept) = (json!([0, 1, 2]), |key: &str, axes: Value| json!({ key: axes, "min": 0, "max": 0 }));
        let (along, said) = match &joint.axis {
            AxisKind::Weld => {
                (DVec3::Z, json!({ "limits": [kept("linearAxes", none.clone()), kept("angularAxes", none)] }))
            }
            AxisKind::Ball => (DVec3::Z, json!({ "limits": [kept("linearAxes", none)] })),
            AxisKind::Hinge(axis) => {
                let limits = vec![kept("linearAxes", none), kept("angularAxes", json!([0, 1]))];
                (axis.along, axial(axis, "angular", limits))
            }
            AxisKind::Slider(axis) => {
                let limits = vec![kept("linearAxes", json!([0, 1])), kept("angularAxes", none)];
                (axis.along, axial(axis, "linear", limits))
            }
        };
        let turn = DQuat::from_rotation_arc(DVec3::Z, along);
        let mut frame = |of: Option<usize>, name: String| {
            let (at, back) = of
                .map_or((DVec3::ZERO, DQuat::IDENTITY), |of| (world.bodies[of].at, world.bodies[of].turn.conjugate()));
            self.child(of.and_then(|of| nodes[of]), name, (back * (joint.at - at), (back * turn).normalize()))
        };
        let body = frame(Some(joint.body), format!("{}_end", joint.name));
        let other = frame(joint.other, joint.name.clone());
        let index = pushed(&mut lists.joints, said);
        self.said(other)["joint"] = json!({ "connectedNode": body, "joint": index });
    }
}

/// Limits and drives of a hinge or a slider.
fn axial(axis: &Axis, of: &str, mut limits: Vec<Value>) -> Value {
    if let Some([least, most]) = axis.limits {
        let mut limit = json!({ "min": least, "max": most });
        limit[format!("{of}Axes")] = json!([2]);
        limits.push(limit);
    }
    let drive = |said: [(&str, f64); 3]| {
        let mut drive = json!({ "type": of, "mode": "force", "axis": 2 });
        said.into_iter().for_each(|(key, value)| drive[key] = value.into());
        drive
    };
    let spring = axis.spring.map(|[stiffness, rest, damping]| {
        drive([("stiffness", stiffness), ("positionTarget", rest), ("damping", damping)])
    });
    // It has all of its force where it is off its speed by a thousandth of a unit.
    let motor =
        axis.motor.map(|[speed, most]| drive([("velocityTarget", speed), ("maxForce", most), ("damping", 1e3 * most)]));
    let drives: Vec<Value> = spring.into_iter().chain(motor).collect();
    if drives.is_empty() { json!({ "limits": limits }) } else { json!({ "limits": limits, "drives": drives }) }
}

fn motion(body: &Rigid) -> Value {
    if body.is_driven {
        return json!({ "isKinematic": true });
    }
    let back = body.turn.conjugate();
    let mut motion = json!({
        "mass": body.mass,
        "centerOfMass": [0.0, 0.0, 0.0],
        "inertiaDiagonal": body.moments.to_array(),
        "inertiaOrientation": body.axes.to_array(),
        "linearVelocity": (back * body.velocity).to_array(),
        "angularVelocity": (back * body.spin).to_array(),
    });
    if body.gravity != 1.0 {
        motion["gravityFactor"] = body.gravity.into();
    }
    motion
}

/// The groups of bodies that pass through each other in which each body is, and the distinct ones of these.
fn memberships(world: &Physics) -> (Vec<Vec<usize>>, Vec<Vec<usize>>) {
    let groups = |body: usize| -> Vec<usize> {
        (0..world.no_contact.len()).filter(|&group| world.no_contact[group].contains(&body)).collect()
    };
    let all: Vec<Vec<usize>> = (0..world.bodies.len()).map(groups).collect();
    let distinct: BTreeSet<Vec<usize>> = all.iter().filter(|groups| !groups.is_empty()).cloned().collect();
    (all, distinct.into_iter().collect())
}

/// The filter of each body.
fn systems(world: &Physics) -> Vec<Option<usize>> {
    let (all, distinct) = memberships(world);
    all.iter().map(|groups| distinct.iter().position(|one| one == groups)).collect()
}

/// A system of its own for all bodies that are in the same groups: it does not collide with those that share one.
fn filters(world: &Physics) -> Vec<Value> {
    let distinct = memberships(world).1;
    let name = |index: usize| format!("passes_{}", index + 1);
    let filter = |(index, groups): (usize, &Vec<usize>)| {
        let shares = |other: &Vec<usize>| other.iter().any(|group| groups.contains(group));
        let others = (0..distinct.len()).filter(|&other| shares(&distinct[other])).map(name);
        json!({ "collisionSystems": [name(index)], "notCollideWithSystems": others.collect::<Vec<_>>() })
    };
    distinct.iter().enumerate().map(filter).collect()
}

/// How many pairs of materials have a friction or restitution that a file cannot say, since these follow from values of
/// each.
#[must_use]
pub fn other_pairs(world: &Physics) -> usize {
    let materials = Materials::of(world);
    materials.rules.into_iter().flat_map(|(_, off)| off).collect::<BTreeSet<_>>().len()
}
