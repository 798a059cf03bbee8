//! What things are made of, with every number as a value.

use super::config::{Finish, Material};
use super::names::colour;
use super::values::{Collector, Owner, Value};
use crate::animation::{self, Look};
use crate::scenario::nearest;
use crate::scene::ConfigError;

/// A material: density, friction, restitution, resistance to rolling and to spinning.
#[derive(Debug, Clone)]
pub(super) struct Substance {
    pub(super) density: Value,
    pub(super) contact: [Value; 4],
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

impl Substance {
    pub(super) fn new(collector: &mut Collector, owner: &Owner<'_>, material: &Material) -> Result<Self, ConfigError> {
        let colour = colour(owner, &material.colour)?;
        Ok(Self {
            density: collector.number(owner, "density", "density", &material.density)?,
            contact: [
                collector.number(owner, "friction", "friction", &material.friction)?,
                collector.number(owner, "restitution", "restitution", &material.restitution)?,
                collector.number(owner, "rolling", "rolling", &material.rolling)?,
                collector.number(owner, "spinning", "spinning", &material.spinning)?,
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
