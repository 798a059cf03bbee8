//! Joints between bodies, or between a body and the fixed world.

use super::amount::{Amount, Impulse, Place};
use super::axes::{Axial, Hinge, Slider};
use super::engine::Engine;
use super::names::{Member, numbered};
use super::strings::{Cord, StringJoint};
use super::there::place;
use super::values::{Collector, MM, Numbers, Owner, Value, Values, vector};
use crate::animation::{self, AxisKind, upright};
use crate::scenario::nearest;
use crate::scene::ConfigError;
use glam::DVec3;
use plaus_sim::WorldError;
use plaus_sim::rigid::{self, AxisJoint, MotorGoal, RigidWorld, Start};
use plaus_sim::trace::Trace;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A joint that holds a body to another one, or to the fixed world. The two never collide with each other, unless it is
/// a string.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Makes an array of this many, as for bodies. In the names of `body` and `to`, `{i}` is replaced by 0 for the
    /// first and 1 for the next, and `{i+1}` by one more. Unset: only one.
    #[serde(default)]
    #[schemars(range(min = 1, max = 4096))]
    pub count: Option<u32>,
    /// The name of the body that it holds.
    pub body: String,
    /// The name of the body that it holds it to. Unset, or the name of a piece of scenery: the fixed world.
    #[serde(default)]
    pub to: String,
    /// Where it is at the start.
    #[serde(default)]
    pub at_mm: [Amount<Place>; 3],
    /// What it holds.
    pub kind: JointKind,
    /// Radius of a rod or string that is drawn from it to the centre of gravity of each body that it holds, and touches
    /// nothing; of a string, along its free part. Unset: nothing is drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = null, "minimum" = 1e-3, "maximum" = 1e6, "x-unit" = "mm"))]
    pub drawn_mm: Option<f64>,
}

/// What a joint holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// A point; all rotations are free.
    Ball(Bare),
    /// An axis, about which it turns.
    Hinge(Hinge),
    /// All but the way along an axis.
    Slider(Slider),
    /// Everything.
    Weld(Bare),
    /// A distance that is not exceeded.
    String(StringJoint),
}

/// A ball joint or a weld.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bare {
    /// An impact whose impulse on the joint is larger breaks it. Unset: it never breaks.
    #[serde(default)]
    pub breaks_at_n_s: Option<Amount<Impulse>>,
}

/// What a joint may hold, as far as joints care.
#[derive(Debug, Clone, Copy)]
pub(super) struct Holdable<'a> {
    pub(super) name: &'a str,
    pub(super) is_driven: bool,
    /// Whether it is awake and there from the start.
    pub(super) is_ready: bool,
    /// Whether it is there in every draw.
    pub(super) is_certain: bool,
}

/// A joint with its numbers as values.
#[derive(Debug, Clone)]
pub(super) struct Bond {
    pub(super) name: String,
    pub(super) body: usize,
    other: Option<usize>,
    at: Values,
    holds: Holds,
    breaks_at: Option<Value>,
    /// Radius of what is drawn of it, in m.
    pub(super) drawn: Option<f64>,
}

#[derive(Debug, Clone)]
enum Holds {
    Point,
    Axis(Box<Axial>),
    All,
    String(Box<Cord>),
}

impl Bond {
    /// The joint of a table, between some of `bodies`; `fixed` are the names of what stands still.
    pub(super) fn new(
        collector: &mut Collector,
        member: &Member,
        joint: &Joint,
        (bodies, fixed): (&[Holdable<'_>], &[&str]),
    ) -> Result<Self, ConfigError> {
        let owner = member.owner();
        let find = |key: &str, text: &str| {
            let name = numbered(text, owner.nth).unwrap_or_else(|| text.to_owned());
            let found = bodies.iter().position(|body| body.name == name);
            if found.is_some() || (key == "to" && (name.is_empty() || fixed.contains(&name.as_str()))) {
                return Ok(found);
            }
            let near = nearest(&name, bodies.iter().map(|body| body.name));
            let near = near.map(|near| format!("; did you mean {near:?}?")).unwrap_or_default();
            Err(owner.wrong(key, format!("there is no body {name:?}{near}")))
        };
        let Some(body) = find("body", &joint.body)? else { return Err(owner.wrong("body", "must be a body")) };
        let other = find("to", &joint.to)?;
        if other == Some(body) {
            return Err(owner.wrong("to", format!("{:?} cannot be held to itself", joint.to)));
        }
        let ends = || [Some(body), other].into_iter().flatten().map(|index| &bodies[index]);
        if ends().all(|body| body.is_driven) {
            return Err(owner.wrong("body", "a driven body follows its keyframes: a joint must hold another body"));
        }
        if let Some(body) = ends().find(|body| !body.is_ready) {
            let message = format!("{:?} is asleep or released later: a joint cannot hold it", body.name);
            return Err(owner.wrong("body", message));
        }
        if let Some(body) = ends().find(|body| !body.is_certain) {
            let message = format!("{:?} is not there in every draw (`present`): a joint cannot hold it", body.name);
            return Err(owner.wrong("body", message));
        }
        let at = collector.three(&owner, "at_mm", ["x", "y", "z"], &joint.at_mm)?;
        let name = owner.name.to_owned();
        let holds = Holds::new(collector, &owner, &joint.kind, &at)?;
        let (kind, breaks) = match &joint.kind {
            JointKind::Ball(Bare { breaks_at_n_s }) => ("ball", breaks_at_n_s),
            JointKind::Hinge(Hinge { breaks_at_n_s, .. }) => ("hinge", breaks_at_n_s),
            JointKind::Slider(Slider { breaks_at_n_s, .. }) => ("slider", breaks_at_n_s),
            JointKind::Weld(Bare { breaks_at_n_s }) => ("weld", breaks_at_n_s),
            JointKind::String(StringJoint { breaks_at_n_s, .. }) => ("string", breaks_at_n_s),
        };
        let key = format!("kind.{kind}.breaks_at_n_s");
        let breaks = breaks.as_ref().map(|amount| collector.number(&owner, &key, "breaks_at", amount));
        let drawn = joint.drawn_mm.map(|radius| radius * MM);
        Ok(Self { name, body, other, at, holds, breaks_at: breaks.transpose()?, drawn })
    }

    /// When it breaks in a motion, if it does; `number` is its own, and `there` are the bodies that are there.
    pub(super) fn breaks<E: Engine>(
        &self,
        engine: &E,
        number: usize,
        there: &[usize],
        trace: &Trace<E::Body>,
    ) -> Option<f64> {
        let mut motions = trace.motions.get(place(there, self.body))?.iter();
        motions.find(|motion| engine.is_broken(number, motion)).map(|motion| E::path(motion).t)
    }

    /// Adds it to the world of a draw, where `starts` are those of the bodies that are there.
    pub(super) fn join(
        &self,
        world: &mut RigidWorld,
        numbers: &Numbers<'_>,
        there: &[usize],
        starts: &[Start],
    ) -> Result<(), WorldError> {
        let number = world.join(self.joint(numbers, there, starts))?;
        let Holds::Axis(axial) = &self.holds else { return Ok(()) };
        axial.motor(numbers).map_or(Ok(()), |motor| world.power(number, &motor))
    }

    pub(super) fn is_string(&self) -> bool {
        matches!(self.holds, Holds::String(_))
    }

    /// The bodies that it holds together, if they are two.
    pub(super) fn pair(&self) -> Option<[usize; 2]> {
        self.other.map(|other| [self.body, other])
    }

    /// Whether it holds this body.
    pub(super) fn holds_body(&self, body: usize) -> bool {
        self.body == body || self.other == Some(body)
    }

    /// The bodies that it holds, by their places among those that are there, each with where it is in m in the body's
    /// own axes about the middle of the simulator's shape.
    pub(super) fn anchors(&self, numbers: &Numbers<'_>, there: &[usize], starts: &[Start]) -> Vec<(usize, DVec3)> {
        let joint = self.joint(numbers, there, starts);
        let bodies = [Some(joint.body), joint.other].into_iter().zip(joint.frames);
        bodies.filter_map(|(body, frame)| Some((body?, frame.at))).collect()
    }

    /// It as other simulators have it, between places of the bodies that are there; adds what they cannot have, as are
    /// strings. It goes by how bodies start by their own keys, and then by how they do start.
    pub(super) fn told(
        &self,
        numbers: &Numbers<'_>,
        there: &[usize],
        [own, starts]: [&[Start]; 2],
        left_out: &mut Vec<String>,
    ) -> Option<animation::Joint> {
        let joint = self.joint(numbers, there, own);
        let start = &starts[joint.body];
        let has_moved = *start != own[joint.body] || joint.other.is_some_and(|other| starts[other] != own[other]);
        let mut leave = |is_so: bool, what: &str| {
            if is_so {
                left_out.push(format!("{}: {what}", self.name));
            }
        };
        leave(joint.breaks_at.is_finite(), "that it breaks");
        let along = upright(start.orientation * (joint.frames[0].turn * DVec3::Z));
        let mut axis = |axis: AxisJoint| {
            leave(axis.friction > 0.0, "its friction");
            leave(axis.limits.is_some() && axis.restitution > 0.0, "its restitution");
            let motor = if let Holds::Axis(axial) = &self.holds { axial.motor(numbers) } else { None };
            let motor = motor.and_then(|motor| match motor.goal {
                MotorGoal::Speed(speed) => Some([speed, motor.most]),
                MotorGoal::Keys { .. } => None,
            });
            let has_keys = matches!(&self.holds, Holds::Axis(axial) if motor.is_none() && axial.has_motor());
            leave(has_keys, "its motor, which follows keys");
            let counts = axis.limits.is_some() || axis.spring.is_some();
            leave(
                has_moved && counts,
                "that its limits and spring count from where its bodies were before `start_from`",
            );
            let spring = axis.spring.map(|spring| [spring.stiffness, spring.rest, spring.damping]);
            animation::Axis { along, limits: axis.limits, spring, motor }
        };
        let axis = match joint.kind {
            rigid::JointKind::Ball => AxisKind::Ball,
            rigid::JointKind::Weld => AxisKind::Weld,
            rigid::JointKind::Hinge(of) => AxisKind::Hinge(axis(of)),
            rigid::JointKind::Slider(of) => AxisKind::Slider(axis(of)),
            rigid::JointKind::String(_) => {
                left_out.push(format!("{}: it is a string", self.name));
                return None;
            }
        };
        let at = match has_moved {
            true => start.position + start.orientation * joint.frames[0].at,
            false => vector(&self.at, numbers) * MM,
        };
        let at = upright(at);
        Some(animation::Joint { name: self.name.clone(), body: joint.body, other: joint.other, at, axis })
    }

    fn joint(&self, numbers: &Numbers<'_>, there: &[usize], starts: &[Start]) -> rigid::Joint {
        let body = place(there, self.body);
        let (at, start) = (vector(&self.at, numbers) * MM, &starts[body]);
        let joint = match &self.holds {
            Holds::Point => rigid::Joint::ball(at, body, start),
            Holds::Axis(axial) => axial.joint(numbers, at, body, start),
            Holds::All => rigid::Joint::weld(at, body, start),
            Holds::String(cord) => cord.joint(numbers, at, body, start),
        };
        let breaks_at = self.breaks_at.map_or(f64::INFINITY, |impulse| impulse.of(numbers).max(f64::MIN_POSITIVE));
        let joint = joint.that_breaks_at(breaks_at);
        match self.other.map(|other| place(there, other)) {
            Some(other) => joint.to(other, &starts[other]),
            None => joint,
        }
    }
}

impl Holds {
    fn new(collector: &mut Collector, owner: &Owner<'_>, kind: &JointKind, at: &Values) -> Result<Self, ConfigError> {
        Ok(match kind {
            JointKind::Ball(_) => Self::Point,
            JointKind::Hinge(hinge) => Self::Axis(Box::new(Axial::hinge(collector, owner, hinge)?)),
            JointKind::Slider(slider) => Self::Axis(Box::new(Axial::slider(collector, owner, slider)?)),
            JointKind::Weld(_) => Self::All,
            JointKind::String(string) => Self::String(Box::new(Cord::new(collector, owner, string, at)?)),
        })
    }
}
