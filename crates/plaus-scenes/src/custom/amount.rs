//! A number of a scenario that may be uncertain: fixed, given by a law, the value of a named quantity, or computed.

use super::domain::Domain;
use super::laws::LawOf;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::marker::PhantomData;

/// What a number measures: its unit, the ends of what may be written, and what it may come to by a law.
pub trait Measure: 'static {
    /// Its unit; empty for pure numbers.
    const UNIT: &'static str;
    /// The least number that may be written.
    const LEAST: f64;
    /// The largest.
    const MOST: f64;
    /// What it may be at all.
    const DOMAIN: Domain;
}

macro_rules! measures {
    ($($(#[$doc:meta])* $name:ident: $unit:literal, $least:literal to $most:literal, $domain:ident;)+) => {
        $($(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub enum $name {}

        impl Measure for $name {
            const UNIT: &'static str = $unit;
            const LEAST: f64 = $least;
            const MOST: f64 = $most;
            const DOMAIN: Domain = Domain::$domain;
        })+
    };
}

measures! {
    /// A coordinate.
    Place: "mm", -1e6 to 1e6, Any;
    /// A length of a body.
    Length: "mm", 1e-3 to 1e6, NotNegative;
    /// A length that may be zero.
    Rounding: "mm", 0.0 to 1e6, NotNegative;
    /// An angle.
    Angle: "degree", -36000.0 to 36000.0, Turn;
    /// A component of a velocity.
    Velocity: "m/s", -1e4 to 1e4, Any;
    /// A component of an angular velocity.
    Turning: "degree/s", -1e6 to 1e6, Any;
    /// A time.
    Moment: "s", 0.0 to 1e4, NotNegative;
    /// Mass over volume.
    Density: "kg/m³", 1e-3 to 1e6, NotNegative;
    /// A coefficient of friction or of resistance.
    Friction: "", 0.0 to 1e3, NotNegative;
    /// A coefficient of restitution.
    Restitution: "", 0.0 to 1.0, Share;
    /// How likely a body is there; or, if it is uncertain, a value from which that follows.
    Chance: "", 0.0 to 1.0, Any;
    /// A part of the world's gravity.
    Scale: "", -1e3 to 1e3, Any;
    /// A component of a force.
    Force: "N", -1e6 to 1e6, Any;
    /// A component of a torque.
    Torque: "N m", -1e6 to 1e6, Any;
    /// The size of a force.
    Push: "N", 0.0 to 1e9, NotNegative;
    /// Force per distance.
    Stiffness: "N/m", 0.0 to 1e9, NotNegative;
    /// Torque per angle.
    Torsion: "N m/rad", 0.0 to 1e9, NotNegative;
    /// Force per speed.
    Viscosity: "N s/m", 0.0 to 1e9, NotNegative;
    /// Torque per angular velocity.
    Twisting: "N m s/rad", 0.0 to 1e9, NotNegative;
    /// The size of a torque.
    Grip: "N m", 0.0 to 1e6, NotNegative;
    /// An impulse.
    Impulse: "N s", 1e-9 to 1e9, NotNegative;
    /// A rate at which something is lost.
    Rate: "1/s", 0.0 to 1e3, NotNegative;
    /// A moment of inertia.
    Inert: "kg m²", 1e-18 to 1e12, NotNegative;
    /// A density over another.
    Factor: "", 1e-6 to 1e6, NotNegative;
    /// A standard deviation of a direction.
    Tilt: "degree", 0.0 to 20.0, NotNegative;
    /// A standard deviation over a mean.
    Spread: "", 0.0 to 1.0, NotNegative;
    /// A number whose unit is not known here.
    Plain: "", -1e9 to 1e9, Plain;
}

/// A number: fixed, uncertain, named elsewhere, or computed.
#[derive(Debug)]
pub enum Amount<M> {
    /// Always this.
    Fixed(f64),
    /// The quantity with this name, or the value of this formula.
    Said(String),
    /// Drawn from a law of its own.
    Law(Box<LawOf>, PhantomData<fn() -> M>),
}

pub(super) fn water() -> Amount<Density> {
    1000.0.into()
}

impl<M> Amount<M> {
    /// Of a law.
    #[must_use]
    pub fn of(law: LawOf) -> Self {
        Self::Law(Box::new(law), PhantomData)
    }
}

impl<M> Default for Amount<M> {
    fn default() -> Self {
        Self::Fixed(0.0)
    }
}

impl<M> From<f64> for Amount<M> {
    fn from(value: f64) -> Self {
        Self::Fixed(value)
    }
}

impl<M> Clone for Amount<M> {
    fn clone(&self) -> Self {
        match self {
            Self::Fixed(value) => Self::Fixed(*value),
            Self::Said(name) => Self::Said(name.clone()),
            Self::Law(law, _) => Self::Law(law.clone(), PhantomData),
        }
    }
}

impl<M> PartialEq for Amount<M> {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Fixed(a), Self::Fixed(b)) => a == b,
            (Self::Said(a), Self::Said(b)) => a == b,
            (Self::Law(a, _), Self::Law(b, _)) => a == b,
            _ => false,
        }
    }
}

impl<M> Serialize for Amount<M> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Fixed(value) => serializer.serialize_f64(*value),
            Self::Said(name) => serializer.serialize_str(name),
            Self::Law(law, _) => law.serialize(serializer),
        }
    }
}

impl<'de, M> Deserialize<'de> for Amount<M> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        /// The same without the measure.
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Fixed(f64),
            Said(String),
            Law(LawOf),
        }
        Ok(match Written::deserialize(deserializer)? {
            Written::Fixed(value) => Self::Fixed(value),
            Written::Said(name) => Self::Said(name),
            Written::Law(law) => Self::of(law),
        })
    }
}

#[cfg(feature = "schema")]
impl<M: Measure> schemars::JsonSchema for Amount<M> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Amount".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let mut schema = schemars::json_schema!({
            "anyOf": [
                { "type": "number", "minimum": M::LEAST, "maximum": M::MOST },
                { "type": "string", "description": "The name of one of the `quantities`, or arithmetic with them." },
                generator.subschema_for::<LawOf>(),
            ],
        });
        if !M::UNIT.is_empty() {
            schema.insert("x-unit".into(), M::UNIT.into());
        }
        schema
    }
}
