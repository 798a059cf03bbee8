//! Hinges and sliders: limits, friction, springs and motors along their one degree of freedom.

use super::amount::{
    Amount, Angle, Grip, Impulse, Measure, Moment, Place, Push, Restitution, Stiffness, Torsion, Turning, Twisting,
    Velocity, Viscosity,
};
use super::driven::{Going, key_time, track};
use super::values::{Collector, MM, Numbers, Owner, Value};
use crate::scene::ConfigError;
use glam::DVec3;
use plaus_sim::rigid::{self, Start};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most degrees from a hinge's one limit to the other.
const WIDEST: f64 = 340.0;

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
    /// A spring that turns it back. Unset: none.
    #[serde(default)]
    pub spring: Option<HingeSpring>,
    /// A motor that turns it. Unset: none.
    #[serde(default)]
    pub motor: Option<HingeMotor>,
    /// An impact whose impulse on the joint is larger breaks it. Unset: it never breaks.
    #[serde(default)]
    pub breaks_at_n_s: Option<Amount<Impulse>>,
}

/// A slider: the body moves along the axis, and does not turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Slider {
    /// The direction of its axis at the start, of any length but 0.
    pub axis: [f64; 3],
    /// How far the body may move from its start at least and at most, along the axis. Unset: it slides freely.
    #[serde(default)]
    pub limits_mm: Option<[Amount<Place>; 2]>,
    /// Restitution at the limits.
    #[serde(default)]
    pub restitution: Amount<Restitution>,
    /// Force of dry friction, the same under any load.
    #[serde(default)]
    pub friction_n: Amount<Push>,
    /// A spring that pulls it back. Unset: none.
    #[serde(default)]
    pub spring: Option<SliderSpring>,
    /// A motor that moves it. Unset: none.
    #[serde(default)]
    pub motor: Option<SliderMotor>,
    /// An impact whose impulse on the joint is larger breaks it. Unset: it never breaks.
    #[serde(default)]
    pub breaks_at_n_s: Option<Amount<Impulse>>,
}

/// A spring of a hinge, with a damper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HingeSpring {
    /// Torque per angle.
    #[serde(default)]
    pub stiffness_n_m_per_rad: Amount<Torsion>,
    /// The angle from the start at which it does not pull, from −180 to 180. Without limits, the hinge's angle is the
    /// one within half a turn of it.
    #[serde(default)]
    pub rest_deg: Amount<Angle>,
    /// Torque against the motion, per angular velocity.
    #[serde(default)]
    pub damping_n_m_s_per_rad: Amount<Twisting>,
}

/// A spring of a slider, with a damper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SliderSpring {
    /// Force per distance.
    #[serde(default)]
    pub stiffness_n_per_m: Amount<Stiffness>,
    /// The distance from the start at which it does not pull.
    #[serde(default)]
    pub rest_mm: Amount<Place>,
    /// Force against the motion, per speed.
    #[serde(default)]
    pub damping_n_s_per_m: Amount<Viscosity>,
}

/// A motor of a hinge: it holds a speed, or follows keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HingeMotor {
    /// Its greatest torque.
    pub most_n_m: Amount<Grip>,
    /// The angular velocity that it holds. Unset: it follows `keys`.
    #[serde(default)]
    pub speed_deg_s: Option<Amount<Turning>>,
    /// The angle from the start at which times, in order of time. Before the first key and after the last it stands
    /// still. What counts of an angle is the way to it that is less than half a turn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 10_000), extend("default" = []))]
    pub keys: Vec<HingeKey>,
    /// How the angle goes from one key to the next, as for driven bodies.
    #[serde(default)]
    pub between: Going,
    /// Time in which it seeks to make what it lags behind `keys` e times less.
    #[serde(default = "catch_up")]
    pub catch_up_s: Amount<Moment>,
}

/// A motor of a slider: it holds a speed, or follows keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SliderMotor {
    /// Its greatest force.
    pub most_n: Amount<Push>,
    /// The speed that it holds. Unset: it follows `keys`.
    #[serde(default)]
    pub speed_m_s: Option<Amount<Velocity>>,
    /// The distance from the start at which times, in order of time. Before the first key and after the last it stands
    /// still.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 10_000), extend("default" = []))]
    pub keys: Vec<SliderKey>,
    /// How the distance goes from one key to the next, as for driven bodies.
    #[serde(default)]
    pub between: Going,
    /// Time in which it seeks to make what it lags behind `keys` e times less.
    #[serde(default = "catch_up")]
    pub catch_up_s: Amount<Moment>,
}

/// Where a motor turns a hinge at a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HingeKey {
    /// When. It must come after the previous key, whatever is uncertain about the two.
    pub at_s: Amount<Moment>,
    /// The angle from the start.
    pub at_deg: Amount<Angle>,
}

/// Where a motor moves a slider at a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SliderKey {
    /// When. It must come after the previous key, whatever is uncertain about the two.
    pub at_s: Amount<Moment>,
    /// The distance from the start.
    pub at_mm: Amount<Place>,
}

fn catch_up() -> Amount<Moment> {
    Amount::Fixed(0.1)
}

/// A hinge or slider with its numbers as values; coordinates are in degrees or mm.
#[derive(Debug, Clone)]
pub(super) struct Axial {
    slides: bool,
    axis: DVec3,
    limits: Option<[Value; 2]>,
    restitution: Value,
    friction: Value,
    /// Stiffness, rest, damping.
    spring: Option<[Value; 3]>,
    motor: Option<Motor>,
}

#[derive(Debug, Clone)]
struct Motor {
    most: Value,
    speed: Option<Value>,
    keys: Vec<(Value, Value)>,
    between: Going,
    catch_up: Value,
}

/// Reads the numbers of one joint.
struct Reader<'a> {
    collector: &'a mut Collector,
    owner: &'a Owner<'a>,
    kind: &'static str,
}

impl Reader<'_> {
    fn number<M: Measure>(&mut self, key: &str, short: &str, amount: &Amount<M>) -> Result<Value, ConfigError> {
        self.collector.number(self.owner, &format!("kind.{}.{key}", self.kind), short, amount)
    }

    fn wrong(&self, key: &str, message: impl std::fmt::Display) -> ConfigError {
        self.owner.wrong(&format!("kind.{}.{key}", self.kind), message)
    }

    fn axis(&self, axis: [f64; 3]) -> Result<DVec3, ConfigError> {
        let axis = DVec3::from_array(axis);
        let message = "a direction needs a length: [0, 0, 1], for example";
        axis.try_normalize().map(|_| axis).ok_or_else(|| self.wrong("axis", message))
    }

    fn limits<M: Measure>(&mut self, key: &str, limits: &[Amount<M>; 2]) -> Result<[Value; 2], ConfigError> {
        let low = self.number(&format!("{key}[0]"), "least", &limits[0])?;
        let high = self.number(&format!("{key}[1]"), "largest", &limits[1])?;
        let [(least, low_most), (high_least, most)] = [low, high].map(|limit| self.collector.ends(limit));
        if low_most > 0.0 || high_least < 0.0 || low_most >= high_least {
            let message = format!(
                "the limits may be {low_most} and {high_least}: one must be at most 0 and the other at least, as that is where the body starts"
            );
            return Err(self.wrong(key, message));
        }
        if self.kind == "hinge" && (least < -180.0 || most > 180.0 || most - least > WIDEST) {
            let message = format!(
                "the limits may be {least} and {most}: they must be within −180 and 180, and at most {WIDEST} apart"
            );
            return Err(self.wrong(key, message));
        }
        Ok([low, high])
    }

    /// Keys of a motor: their times, and coordinates.
    fn keys<'k, M: Measure>(
        &mut self,
        unit: &str,
        keys: impl Iterator<Item = (&'k Amount<Moment>, &'k Amount<M>)>,
    ) -> Result<Vec<(Value, Value)>, ConfigError> {
        let (mut all, mut before) = (Vec::new(), None);
        for (index, (time, at)) in keys.enumerate() {
            let key = format!("kind.{}.motor.keys[{index}].at_s", self.kind);
            let short = |what: &str| format!("key_{}_{what}", index + 1);
            let time = key_time(self.collector, self.owner, (&key, &short("at")), time, before)?;
            before = Some(time);
            all.push((time, self.number(&format!("motor.keys[{index}].{unit}"), &short("to"), at)?));
        }
        Ok(all)
    }

    /// A motor must have either a speed or keys.
    fn one_goal(&self, speed: &str, has_speed: bool, has_keys: bool) -> Result<(), ConfigError> {
        if has_speed != has_keys {
            return Ok(());
        }
        let which = if has_speed { "not both" } else { "it has neither" };
        Err(self.wrong("motor", format!("a motor holds a speed, `{speed}`, or follows `keys`: {which}")))
    }
}

impl Axial {
    pub(super) fn hinge(collector: &mut Collector, owner: &Owner<'_>, hinge: &Hinge) -> Result<Self, ConfigError> {
        let mut of = Reader { collector, owner, kind: "hinge" };
        let axis = of.axis(hinge.axis)?;
        let limits = hinge.limits_deg.as_ref().map(|limits| of.limits("limits_deg", limits)).transpose()?;
        let restitution = of.number("restitution", "restitution", &hinge.restitution)?;
        let friction = of.number("friction_n_m", "friction", &hinge.friction_n_m)?;
        let spring = match &hinge.spring {
            None => None,
            Some(HingeSpring { stiffness_n_m_per_rad, rest_deg, damping_n_m_s_per_rad }) => {
                let stiffness = of.number("spring.stiffness_n_m_per_rad", "stiffness", stiffness_n_m_per_rad)?;
                let rest = of.number("spring.rest_deg", "rest", rest_deg)?;
                let (least, most) = of.collector.ends(rest);
                if least < -180.0 || most > 180.0 {
                    let message = format!("it may be from {least} to {most}: it must be within −180 and 180");
                    return Err(of.wrong("spring.rest_deg", message));
                }
                let damping = of.number("spring.damping_n_m_s_per_rad", "damping", damping_n_m_s_per_rad)?;
                Some([stiffness, rest, damping])
            }
        };
        let motor = match &hinge.motor {
            None => None,
            Some(HingeMotor { most_n_m, speed_deg_s, keys, between, catch_up_s }) => {
                of.one_goal("speed_deg_s", speed_deg_s.is_some(), !keys.is_empty())?;
                let speed = speed_deg_s.as_ref().map(|speed| of.number("motor.speed_deg_s", "speed", speed));
                Some(Motor {
                    most: of.number("motor.most_n_m", "most", most_n_m)?,
                    speed: speed.transpose()?,
                    keys: of.keys("at_deg", keys.iter().map(|key| (&key.at_s, &key.at_deg)))?,
                    between: *between,
                    catch_up: of.number("motor.catch_up_s", "catch_up", catch_up_s)?,
                })
            }
        };
        Ok(Self { slides: false, axis, limits, restitution, friction, spring, motor })
    }

    pub(super) fn slider(collector: &mut Collector, owner: &Owner<'_>, slider: &Slider) -> Result<Self, ConfigError> {
        let mut of = Reader { collector, owner, kind: "slider" };
        let axis = of.axis(slider.axis)?;
        let limits = slider.limits_mm.as_ref().map(|limits| of.limits("limits_mm", limits)).transpose()?;
        let restitution = of.number("restitution", "restitution", &slider.restitution)?;
        let friction = of.number("friction_n", "friction", &slider.friction_n)?;
        let spring = match &slider.spring {
            None => None,
            Some(SliderSpring { stiffness_n_per_m, rest_mm, damping_n_s_per_m }) => Some([
                of.number("spring.stiffness_n_per_m", "stiffness", stiffness_n_per_m)?,
                of.number("spring.rest_mm", "rest", rest_mm)?,
                of.number("spring.damping_n_s_per_m", "damping", damping_n_s_per_m)?,
            ]),
        };
        let motor = match &slider.motor {
            None => None,
            Some(SliderMotor { most_n, speed_m_s, keys, between, catch_up_s }) => {
                of.one_goal("speed_m_s", speed_m_s.is_some(), !keys.is_empty())?;
                let speed = speed_m_s.as_ref().map(|speed| of.number("motor.speed_m_s", "speed", speed));
                Some(Motor {
                    most: of.number("motor.most_n", "most", most_n)?,
                    speed: speed.transpose()?,
                    keys: of.keys("at_mm", keys.iter().map(|key| (&key.at_s, &key.at_mm)))?,
                    between: *between,
                    catch_up: of.number("motor.catch_up_s", "catch_up", catch_up_s)?,
                })
            }
        };
        Ok(Self { slides: true, axis, limits, restitution, friction, spring, motor })
    }

    /// A coordinate in rad or m.
    fn si(&self, value: Value, numbers: &Numbers<'_>) -> f64 {
        let value = value.of(numbers);
        if self.slides { value * MM } else { value.to_radians() }
    }

    pub(super) fn joint(&self, numbers: &Numbers<'_>, at: DVec3, body: usize, start: &Start) -> rigid::Joint {
        let make = if self.slides { rigid::Joint::slider } else { rigid::Joint::hinge };
        let mut joint = make(at, self.axis, body, start).with_friction(self.friction.of(numbers));
        if let Some(limits) = self.limits {
            joint = joint.with_limits(limits.map(|limit| self.si(limit, numbers)), self.restitution.of(numbers));
        }
        if let Some([stiffness, rest, damping]) = self.spring {
            joint = joint.with_spring(rigid::Spring {
                stiffness: stiffness.of(numbers),
                rest: self.si(rest, numbers),
                damping: damping.of(numbers),
            });
        }
        joint
    }

    pub(super) fn has_motor(&self) -> bool {
        self.motor.is_some()
    }

    pub(super) fn motor(&self, numbers: &Numbers<'_>) -> Option<rigid::Motor> {
        let motor = self.motor.as_ref()?;
        let goal = match motor.speed {
            Some(speed) if self.slides => rigid::MotorGoal::Speed(speed.of(numbers)),
            Some(speed) => rigid::MotorGoal::Speed(speed.of(numbers).to_radians()),
            None => {
                let key = |(time, at): &(Value, Value)| (time.of(numbers), self.si(*at, numbers));
                let keys: Vec<(f64, f64)> = motor.keys.iter().map(key).collect();
                let catch_up = motor.catch_up.of(numbers).max(LEAST_CATCH_UP);
                rigid::MotorGoal::Keys { track: track(motor.between, &keys), catch_up }
            }
        };
        Some(rigid::Motor { goal, most: motor.most.of(numbers).max(f64::MIN_POSITIVE) })
    }
}

/// Least time in s in which a motor catches up: nothing is gained by less.
const LEAST_CATCH_UP: f64 = 1e-3;
