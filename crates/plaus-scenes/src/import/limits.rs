//! Joints of `KHR_physics_rigid_bodies`: what their limits, one axis at a time or several together, hold.

use super::axes::Along;
use super::numbers::number;
use super::physics::BODIES;
use super::things::{Held, Role, Things};
use super::write::place;
use glam::{DQuat, DVec3};
use plaus_asset::glb::{Glb, Node};
use plaus_dist::math::atan2;
use serde_json::Value;
use std::collections::BTreeMap;

/// Frames that are farther apart than this at the start, in m, or turned by more, in radians, are told.
const APART: f64 = 1e-4;
const TURNED: f64 = 1e-3;

/// What limits say of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Axis {
    Free,
    /// From the first number to the second, if they are given, alone or together with other axes.
    Within(Option<f64>, Option<f64>, bool),
    Fixed(f64),
}

impl Axis {
    fn is_fixed(self) -> bool {
        matches!(self, Self::Fixed(_))
    }
}

/// All limits of a joint.
#[derive(Debug)]
struct Limits {
    linear: [Axis; 3],
    angular: [Axis; 3],
    /// Springs of the linear axes, and of the angular ones: stiffness, rest, damping.
    springs: [[[f64; 3]; 3]; 2],
    is_soft: bool,
}

impl Limits {
    fn read(joint: &Value) -> Self {
        let mut limits =
            Self { linear: [Axis::Free; 3], angular: [Axis::Free; 3], springs: [[[0.0; 3]; 3]; 2], is_soft: false };
        for limit in joint["limits"].as_array().into_iter().flatten() {
            if let Some(stiffness) = limit["stiffness"].as_f64() {
                let damping = limit["damping"].as_f64().unwrap_or(0.0);
                match (limit["min"].as_f64(), limit["max"].as_f64()) {
                    // What is held softly in one place has a spring.
                    (Some(a), Some(b)) if a == b => {
                        for (key, springs) in ["linearAxes", "angularAxes"].into_iter().zip(&mut limits.springs) {
                            for axis in axes_of(limit, key) {
                                springs[axis] = [stiffness, a, damping];
                            }
                        }
                    }
                    _ => limits.is_soft = true,
                }
                continue;
            }
            let (min, max) = (limit["min"].as_f64(), limit["max"].as_f64());
            for (key, all) in [("linearAxes", &mut limits.linear), ("angularAxes", &mut limits.angular)] {
                let axes = axes_of(limit, key);
                let axis = match (min, max) {
                    // Of several axes together, the length is meant.
                    (Some(a), Some(b)) if a == b && (axes.len() == 1 || a == 0.0) => Axis::Fixed(a),
                    (None, None) => continue,
                    _ => Axis::Within(min, max, axes.len() > 1),
                };
                for index in axes {
                    if !all[index].is_fixed() {
                        all[index] = axis;
                    }
                }
            }
        }
        limits
    }
}

/// The axes that a limit is about.
fn axes_of(limit: &Value, key: &str) -> Vec<usize> {
    let all = limit[key].as_array().into_iter().flatten();
    all.filter_map(|axis| usize::try_from(axis.as_u64()?).ok().filter(|axis| *axis < 3)).collect()
}

/// What a drive does along an axis that it may: a spring, or a motor. `None` if it is another kind of drive.
fn drive(said: &Value) -> Option<Along> {
    let number = |key: &str| said[key].as_f64().unwrap_or(0.0);
    let [stiffness, damping, speed] = ["stiffness", "damping", "velocityTarget"].map(number);
    let most = said["maxForce"].as_f64();
    let is_force = said["mode"].as_str().unwrap_or("force") == "force";
    match (is_force, most) {
        (true, None) if speed == 0.0 && (stiffness > 0.0 || damping > 0.0) => {
            Some(Along { spring: [stiffness, number("positionTarget"), damping], ..Along::default() })
        }
        (true, Some(most)) if stiffness == 0.0 && damping > 0.0 && most > 0.0 => {
            Some(Along { motor: Some([speed, most]), ..Along::default() })
        }
        _ => None,
    }
}

/// What a joint becomes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Weld,
    /// About one of the axes, or along it.
    Hinge(usize),
    Slider(usize),
    Ball,
    Nothing,
}

impl Limits {
    /// What a scenario has for it, and what is then wrong.
    fn kind(&self) -> (Kind, Vec<String>) {
        let count = |axes: [Axis; 3]| axes.iter().filter(|axis| axis.is_fixed()).count();
        let mut wrong = Vec::new();
        let soft = if self.is_soft { " (its soft limits are no limits here)" } else { "" };
        let kind = match (count(self.linear), count(self.angular)) {
            (3, 3) => Kind::Weld,
            (3, 2) => Kind::Hinge((0..3).find(|&axis| !self.angular[axis].is_fixed()).unwrap_or(0)),
            (3, fixed) => {
                let is_limited = self.angular.iter().any(|axis| *axis != Axis::Free);
                if is_limited {
                    let what =
                        if fixed == 1 { "that it does not turn about one axis, and its limits" } else { "its limits" };
                    wrong.push(format!("{what}: a ball joint{soft}"));
                }
                Kind::Ball
            }
            (2, 3) => Kind::Slider((0..3).find(|&axis| !self.linear[axis].is_fixed()).unwrap_or(0)),
            (0, 0) if self.linear == [Axis::Free; 3] && self.angular == [Axis::Free; 3] => {
                wrong.push(format!("it holds nothing{soft}"));
                Kind::Nothing
            }
            (linear, angular) => {
                wrong.push(format!(
                    "it fixes {linear} of 3 places and {angular} of 3 angles, and there is no such joint: it holds \
                     nothing{soft}"
                ));
                Kind::Nothing
            }
        };
        if self.is_soft && wrong.is_empty() {
            wrong.push("its soft limits: they are no limits here".into());
        }
        let read = |linear: usize, axis: usize| match kind {
            Kind::Hinge(own) => linear == 1 && axis == own,
            Kind::Slider(own) => linear == 0 && axis == own,
            _ => false,
        };
        let springs = self.springs.iter().enumerate().flat_map(|(k, all)| all.iter().enumerate().map(move |s| (k, s)));
        if springs.into_iter().any(|(k, (axis, spring))| spring[0] > 0.0 && !read(k, axis)) {
            wrong.push("its springs, but for that along the axis of a hinge or slider".into());
        }
        (kind, wrong)
    }
}

/// Where a node belongs: the thing that moves it, if any.
pub(super) type Owners = BTreeMap<usize, Option<usize>>;

/// Adds the joints of a file. `owners` has, for each node, the thing that it moves with, or none if it stands still;
/// nodes of things that were left out are missing. `standing` has the scenery that each node is, or belongs to.
pub(super) fn joints(
    file: &Glb,
    nodes: &[Node],
    (owners, standing): (&Owners, &BTreeMap<usize, usize>),
    things: &mut Things<'_>,
) {
    let by_index: BTreeMap<usize, &Node> = nodes.iter().map(|node| (node.index, node)).collect();
    let index = |value: &Value| value.as_u64().and_then(|index| usize::try_from(index).ok());
    let mut apart = Vec::new();
    let all = file.extension(BODIES)["physicsJoints"].as_array().map_or(&[][..], Vec::as_slice);
    for node in nodes {
        let said = &node.extensions[BODIES]["joint"];
        if said.is_null() {
            continue;
        }
        let mut leave = |what: String| things.left_out.push(format!("{}: its joint: {what}", node.name));
        let Some(other) = index(&said["connectedNode"]).and_then(|index| by_index.get(&index).copied()) else {
            leave("its `connectedNode` is no node of the scene: it holds nothing".into());
            continue;
        };
        let Some(joint) = index(&said["joint"]).and_then(|index| all.get(index)) else {
            leave(format!("its `joint` is none of the {} `physicsJoints`: it holds nothing", all.len()));
            continue;
        };
        let (Some(&mine), Some(&its)) = (owners.get(&node.index), owners.get(&other.index)) else {
            leave("what it holds has no shape, and is left out: it holds nothing".into());
            continue;
        };
        if mine == its {
            things.harmless.push(format!("{}: its joint: both its ends are in one thing", node.name));
            continue;
        }
        let stands = standing.get(if its.is_some() { &node.index } else { &other.index }).copied();
        one(Ends { node, other, mine, its, stands }, joint, said, &mut apart, things);
    }
    keep_apart(&apart, things);
}

/// A body, the scenery that a joint holds it to and keeps it from touching, and the joint's name.
type Apart = (usize, usize, String);

/// Leaves out scenery that a joint keeps all from touching that could, which changes nothing; and tells of other such
/// scenery.
fn keep_apart(apart: &[Apart], things: &mut Things<'_>) {
    let moves = |role: Role| matches!(role, Role::Body | Role::Driven);
    let moving: Vec<usize> = (0..things.all.len()).filter(|&index| moves(things.all[index].role)).collect();
    for (_, scenery, name) in apart {
        if things.all[*scenery].role != Role::Fixed {
            continue;
        }
        let is_kept = |body: &usize| apart.iter().any(|(held, of, _)| held == body && of == scenery);
        let thing = &things.all[*scenery].name;
        if moving.iter().all(is_kept) {
            things.notes.push(format!("{thing}: left out, as joints keep all from it that could touch it"));
            (things.all[*scenery].role, things.all[*scenery].stands) = (Role::Gone, true);
        } else {
            let text = format!("{name}: its joint: that what it holds does not touch {thing}: here it may");
            things.left_out.push(text);
        }
    }
}

/// The two ends of a joint, with the things that they move with.
struct Ends<'a> {
    node: &'a Node,
    other: &'a Node,
    mine: Option<usize>,
    its: Option<usize>,
    /// The scenery that one of them belongs to.
    stands: Option<usize>,
}

/// The springs and drives of a joint along its axis; what else drives it is added to `wrong`.
fn along(kind: Kind, limits: &Limits, joint: &Value, wrong: &mut Vec<String>) -> Along {
    let mut along = match kind {
        Kind::Slider(axis) => Along { slides: true, spring: limits.springs[0][axis], ..Along::default() },
        Kind::Hinge(axis) => Along { spring: limits.springs[1][axis], ..Along::default() },
        _ => Along::default(),
    };
    for said in joint["drives"].as_array().into_iter().flatten() {
        let axis = said["axis"].as_u64().and_then(|axis| usize::try_from(axis).ok()).filter(|axis| *axis < 3);
        let of = said["type"].as_str().unwrap_or("unknown");
        let is_ours = match kind {
            Kind::Hinge(own) => of == "angular" && axis == Some(own),
            Kind::Slider(own) => of == "linear" && axis == Some(own),
            _ => false,
        };
        let is_free = |drive: &Along| match drive.motor {
            Some(_) => along.motor.is_none(),
            None => along.spring == [0.0; 3],
        };
        match drive(said).filter(|drive| is_ours && is_free(drive)) {
            Some(Along { spring, motor, .. }) => {
                if motor.is_none() {
                    along.spring = spring;
                }
                along.motor = along.motor.or(motor);
                if motor.is_some() {
                    wrong.push(format!("the damping of its {of} drive: it holds its speed up to its greatest force"));
                }
            }
            None => wrong.push(format!(
                "its {of} drive of {}: nothing drives it here",
                axis.map_or("no axis", |axis| ["x", "y", "z"][axis])
            )),
        }
    }
    along
}

fn one(ends: Ends<'_>, joint: &Value, said: &Value, apart: &mut Vec<Apart>, things: &mut Things<'_>) {
    let Ends { node, other, mine, its, stands } = ends;
    let limits = Limits::read(joint);
    let (kind, mut wrong) = limits.kind();
    let mut along = along(kind, &limits, joint, &mut wrong);
    let moves = |thing: Option<usize>| thing.filter(|&index| things.all[index].role == Role::Body);
    // Angles are those of the other node about the axes of the node of the joint.
    let (body, to, sign) = match (moves(its), moves(mine)) {
        (Some(body), _) => (body, mine, 1.0),
        (None, Some(body)) => (body, its, -1.0),
        (None, None) => {
            things.harmless.push(format!("{}: its joint: neither of its ends is moved by forces", node.name));
            return;
        }
    };
    let offset = node.turn.inverse() * (other.at - node.at);
    let kind = match kind {
        Kind::Nothing => None,
        Kind::Weld => Some("{ weld = {} }".to_owned()),
        Kind::Ball => Some("{ ball = {} }".to_owned()),
        Kind::Hinge(axis) | Kind::Slider(axis) => {
            let (angle, off) = twist(node.turn.inverse() * other.turn, axis);
            if !along.slides && off > TURNED {
                wrong.push(format!(
                    "its two frames, which the file turns together by {} degrees",
                    number(off.to_degrees())
                ));
            }
            let (start, all) = if along.slides { (offset[axis], limits.linear) } else { (angle, limits.angular) };
            along.spring[1] -= start;
            along.limits = match all[axis] {
                Axis::Within(min, max, false) => Some([
                    min.map_or(f64::NEG_INFINITY, |min| min - start),
                    max.map_or(f64::INFINITY, |max| max - start),
                ]),
                Axis::Within(..) => {
                    let (what, does) = if along.slides { ("places", "slides") } else { ("angles", "turns") };
                    wrong.push(format!("limits of several {what} together: it {does} freely"));
                    None
                }
                _ => None,
            };
            Some(along.joint(place(node.turn * DVec3::AXES[axis]) * sign, &mut wrong))
        }
    };
    let enabled = said["enableCollision"].as_bool().unwrap_or(false);
    // What is driven gives way where a limit is reached, so a joint with limits is held to the fixed world.
    let can_be_driven = kind.as_ref().is_some_and(|kind| !kind.contains("limits_"));
    let to = to.or_else(|| stands.filter(|&stands| can_be_driven && things.hold_still(stands)));
    match (&kind, to) {
        (None, Some(_)) if !enabled => wrong.push("that its two bodies do not touch".into()),
        (Some(_), Some(_)) if enabled => wrong.push("that its two ends may touch".into()),
        (Some(_), None) if !enabled => apart.extend(stands.map(|stands| (body, stands, node.name.clone()))),
        _ => {}
    }
    things.left_out.extend(wrong.into_iter().map(|what| format!("{}: its joint: {what}", node.name)));
    let Some(kind) = kind else { return };
    let gap = (0..3).map(|axis| match limits.linear[axis] {
        Axis::Fixed(at) => offset[axis] - at,
        _ => 0.0,
    });
    let gap = gap.map(|gap| gap * gap).sum::<f64>().sqrt();
    if gap > APART {
        things.left_out.push(format!(
            "{}: its joint: its two frames, {} mm from where the file holds them: they are held as they begin",
            node.name,
            number(1e3 * gap)
        ));
    }
    things.joints.push(Held { name: node.name.clone(), body, to, at: place(other.at) * 1e3, kind });
}

/// The angle of a rotation about one of the axes, and how far it is from a rotation about that axis alone.
fn twist(turn: DQuat, axis: usize) -> (f64, f64) {
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let along = turn.to_array()[axis];
    let angle = 2.0 * atan2(along, turn.w);
    let off =
        2.0 * atan2((1.0 - along * along - turn.w * turn.w).max(0.0).sqrt(), (along * along + turn.w * turn.w).sqrt());
    (angle, off)
}
