//! Joints between bodies, or between a body and the fixed world.

use super::amount::{Amount, Angle, Grip, Impulse, Place, Restitution};
use super::engine::Engine;
use super::forms::Plane as Nothing;
use super::names::{Member, numbered};
use super::solids::MM;
use super::there::place;
use super::values::{Collector, Numbers, Owner, Value, Values, vector};
use crate::scenario::nearest;
use crate::scene::ConfigError;
use glam::DVec3;
use plaus_sim::rigid::{self, Start};
use plaus_sim::trace::Trace;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most degrees from a hinge's one limit to the other.
const WIDEST: f64 = 340.0;

/// A joint that holds a body to another one, or to the fixed world. The two never collide with each other.
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
}

/// What a joint holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// A point; all rotations are free.
    Ball(Nothing),
    /// An axis, about which it turns.
    Hinge(Hinge),
    /// Everything, until it breaks.
    Weld(Weld),
}

/// A hinge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hinge {
    /// The direction of its axis at the start, of any length but 0.
    pub axis: [f64; 3],
    /// The least and the largest angle by which the body may turn from its start, anticlockwise about the axis. Unset:
    /// it turns freely.
    #[serde(default)]
    pub limits_deg: Option<[Amount<Angle>; 2]>,
    /// Restitution at the limits.
    #[serde(default)]
    pub restitution: Amount<Restitution>,
    /// Torque of dry friction, the same under any load.
    #[serde(default)]
    pub friction_n_m: Amount<Grip>,
}

/// A weld.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Weld {
    /// An impact whose impulse on the weld is larger breaks it. Unset: it never breaks.
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
    body: usize,
    other: Option<usize>,
    at: Values,
    holds: Holds,
}

#[derive(Debug, Clone)]
enum Holds {
    Point,
    Axis { axis: DVec3, limits: Option<[Value; 2]>, restitution: Value, friction: Value },
    All { breaks_at: Option<Value> },
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
        Ok(Self { name, body, other, at, holds: Holds::new(collector, &owner, &joint.kind)? })
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

    /// The bodies that it holds together, if they are two.
    pub(super) fn pair(&self) -> Option<[usize; 2]> {
        self.other.map(|other| [self.body, other])
    }

    /// Whether it holds this body.
    pub(super) fn holds_body(&self, body: usize) -> bool {
        self.body == body || self.other == Some(body)
    }

    /// The simulator's joint of a draw, where `starts` are those of the bodies that are there.
    pub(super) fn joint(&self, numbers: &Numbers<'_>, there: &[usize], starts: &[Start]) -> rigid::Joint {
        let body = place(there, self.body);
        let (at, start) = (vector(&self.at, numbers) * MM, &starts[body]);
        let joint = match &self.holds {
            Holds::Point => rigid::Joint::ball(at, body, start),
            Holds::Axis { axis, limits, restitution, friction } => {
                let hinge = rigid::Joint::hinge(at, *axis, body, start).with_friction(friction.of(numbers));
                match limits {
                    Some(limits) => {
                        let limits = limits.map(|limit| limit.of(numbers).to_radians());
                        hinge.with_limits(limits, restitution.of(numbers))
                    }
                    None => hinge,
                }
            }
            Holds::All { breaks_at } => {
                let weld = rigid::Joint::weld(at, body, start);
                match breaks_at {
                    Some(impulse) => weld.that_breaks_at(impulse.of(numbers).max(f64::MIN_POSITIVE)),
                    None => weld,
                }
            }
        };
        match self.other.map(|other| place(there, other)) {
            Some(other) => joint.to(other, &starts[other]),
            None => joint,
        }
    }
}

impl Holds {
    fn new(collector: &mut Collector, owner: &Owner<'_>, kind: &JointKind) -> Result<Self, ConfigError> {
        Ok(match kind {
            JointKind::Ball(Nothing {}) => Self::Point,
            JointKind::Hinge(hinge) => {
                let axis = DVec3::from_array(hinge.axis);
                if axis.try_normalize().is_none() {
                    return Err(owner.wrong("kind.hinge.axis", "a direction needs a length: [0, 0, 1], for example"));
                }
                let limits = hinge.limits_deg.as_ref().map(|limits| Self::limits(collector, owner, limits));
                let (key, short) = ("kind.hinge.restitution", "restitution");
                Self::Axis {
                    axis,
                    limits: limits.transpose()?,
                    restitution: collector.number(owner, key, short, &hinge.restitution)?,
                    friction: collector.number(owner, "kind.hinge.friction_n_m", "friction", &hinge.friction_n_m)?,
                }
            }
            JointKind::Weld(weld) => {
                let number = |amount| collector.number(owner, "kind.weld.breaks_at_n_s", "breaks_at", amount);
                Self::All { breaks_at: weld.breaks_at_n_s.as_ref().map(number).transpose()? }
            }
        })
    }

    fn limits(
        collector: &mut Collector,
        owner: &Owner<'_>,
        limits: &[Amount<Angle>; 2],
    ) -> Result<[Value; 2], ConfigError> {
        let key = |k: usize| format!("kind.hinge.limits_deg[{k}]");
        let low = collector.number(owner, &key(0), "least", &limits[0])?;
        let high = collector.number(owner, &key(1), "largest", &limits[1])?;
        let ([least, low_most], [high_least, most]) = (collector.ends(low).into(), collector.ends(high).into());
        if low_most > 0.0 || high_least < 0.0 || low_most >= high_least {
            let message = format!(
                "the limits may be {low_most} and {high_least}: one must be at most 0 and the other at least, as that is where the body starts"
            );
            return Err(owner.wrong("kind.hinge.limits_deg", message));
        }
        if least < -180.0 || most > 180.0 || most - least > WIDEST {
            let message = format!(
                "the limits may be {least} and {most}: they must be within −180 and 180, and at most {WIDEST} apart"
            );
            return Err(owner.wrong("kind.hinge.limits_deg", message));
        }
        Ok([low, high])
    }
}
