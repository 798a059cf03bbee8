//! What things are made of, with every number as a value.

use super::amount::{self, Amount};
use super::config::{Finish, Material};
use super::names::colour;
use super::values::{Collector, Owner, Value};
use crate::animation::{self, Look};
use crate::scenario::nearest;
use crate::scene::ConfigError;

/// A material: density; friction, restitution, resistance to rolling and to spinning, static friction.
#[derive(Debug, Clone)]
pub(super) struct Substance {
    pub(super) density: Value,
    pub(super) contact: [Value; 5],
    look: Option<Look>,
    called: String,
    /// What it says without a colour, unless that is the default.
    finish: Option<animation::Material>,
}

/// The material of this name.
pub(super) fn substance(owner: &Owner<'_>, key: &str, kinds: &[String], name: &str) -> Result<usize, ConfigError> {
    kinds.iter().position(|kind| kind == name).ok_or_else(|| {
        let near = nearest(name, kinds.iter().map(String::as_str));
        let near = near.map(|near| format!("did you mean {near:?}? ")).unwrap_or_default();
        let known = kinds[1..].join(", ");
        let there = if known.is_empty() { "there are none".into() } else { format!("known: {known}") };
        owner.wrong(key, format!("there is no material {name:?}; {near}{there}"))
    })
}

/// The static friction that is said, which must be at least `sliding`.
pub(super) fn static_friction(
    collector: &mut Collector,
    owner: &Owner<'_>,
    said: &Option<Amount<amount::Friction>>,
    sliding: Value,
) -> Result<Option<Value>, ConfigError> {
    let Some(said) = said else { return Ok(None) };
    let value = collector.number(owner, "static_friction", "static_friction", said)?;
    if collector.least_gap(sliding, &[value]) >= 0.0 {
        return Ok(Some(value));
    }
    let (least, most) = (collector.ends(value).0, collector.ends(sliding).1);
    let message = format!(
        "it may be {least} where `friction` is {most}: it must be as large at least in every draw, such as {most}, or \
         1.2 times the quantity that both name"
    );
    Err(owner.wrong("static_friction", message))
}

impl Substance {
    pub(super) fn new(collector: &mut Collector, owner: &Owner<'_>, material: &Material) -> Result<Self, ConfigError> {
        let colour = colour(owner, &material.colour)?;
        let density = collector.number(owner, "density", "density", &material.density)?;
        let friction = collector.number(owner, "friction", "friction", &material.friction)?;
        Ok(Self {
            density,
            contact: [
                friction,
                collector.number(owner, "restitution", "restitution", &material.restitution)?,
                collector.number(owner, "rolling", "rolling", &material.rolling)?,
                collector.number(owner, "spinning", "spinning", &material.spinning)?,
                static_friction(collector, owner, &material.static_friction, friction)?.unwrap_or(friction),
            ],
            called: material.name.clone(),
            look: colour.map(|colour| Look::new(colour, material.finish.material())),
            finish: Some(material.finish).filter(|finish| *finish != Finish::default()).map(Finish::material),
        })
    }

    /// The look of something made of it, with a colour of its own or without.
    pub(super) fn look(&self, own: Option<[u8; 3]>, otherwise: Look) -> Look {
        let look = self.look.unwrap_or(Look { material: self.finish.unwrap_or(otherwise.material), ..otherwise });
        own.map_or(look, |colour| Look::new(colour, look.material)).called(&self.called)
    }
}
