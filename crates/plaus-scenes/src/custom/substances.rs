//! What things are made of, with every number as a value.

use super::amount::{self, Amount, Measure};
use super::config::{Config, Material, Pair};
use super::finish::Finish;
use super::names::{check_name, colour};
use super::values::{Collector, Owner, Value};
use crate::animation::{self, Look};
use crate::scenario::nearest;
use crate::scene::ConfigError;
use crate::uneven::SCATTER;

/// A material.
#[derive(Debug, Clone)]
pub(super) struct Substance {
    pub(super) density: Value,
    /// Friction, restitution, resistance to rolling and to spinning, static friction.
    pub(super) contact: [Value; 5],
    /// How its impacts scatter: the tilt of the normal in degrees, and the part of the restitution.
    pub(super) scatter: [Value; 2],
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
fn static_friction(
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

/// What is said of a pair, in the order of [`Substance::contact`].
fn contact_of_pair(
    collector: &mut Collector,
    owner: &Owner<'_>,
    pair: &Pair,
) -> Result<[Option<Value>; 5], ConfigError> {
    fn number<M: Measure>(
        collector: &mut Collector,
        owner: &Owner<'_>,
        key: &str,
        said: &Option<Amount<M>>,
    ) -> Result<Option<Value>, ConfigError> {
        said.as_ref().map(|amount| collector.number(owner, key, key, amount)).transpose()
    }
    let friction = number(collector, owner, "friction", &pair.friction)?;
    let restitution = number(collector, owner, "restitution", &pair.restitution)?;
    let rolling = number(collector, owner, "rolling", &pair.rolling)?;
    let spinning = number(collector, owner, "spinning", &pair.spinning)?;
    let grip = match friction {
        Some(sliding) => static_friction(collector, owner, &pair.static_friction, sliding)?.or(friction),
        None if pair.static_friction.is_some() => {
            return Err(owner.wrong("static_friction", "set `friction` too, which it must not be below"));
        }
        None => None,
    };
    Ok([friction, restitution, rolling, spinning, grip])
}

impl Substance {
    pub(super) fn new(collector: &mut Collector, owner: &Owner<'_>, material: &Material) -> Result<Self, ConfigError> {
        let colour = colour(owner, &material.colour)?;
        let density = collector.number(owner, "density", "density", &material.density)?;
        let friction = collector.number(owner, "friction", "friction", &material.friction)?;
        let restitution = collector.number(owner, "restitution", "restitution", &material.restitution)?;
        let rolling = collector.number(owner, "rolling", "rolling", &material.rolling)?;
        let spinning = material.spinning.as_ref();
        let spinning =
            spinning.map(|spinning| collector.number(owner, "spinning", "spinning", spinning)).transpose()?;
        let grip = static_friction(collector, owner, &material.static_friction, friction)?;
        Ok(Self {
            density,
            contact: [friction, restitution, rolling, spinning.unwrap_or(rolling), grip.unwrap_or(friction)],
            scatter: [
                collector.number(owner, "scatter.normal_deg", "scatter_normal", &material.scatter.normal_deg)?,
                collector.number(owner, "scatter.restitution", "scatter_restitution", &material.scatter.restitution)?,
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

/// The scores of impacts, if those of any material scatter: their place among the tables of a draw.
pub(super) fn impacts(collector: &mut Collector, substances: &[Substance]) -> Option<usize> {
    collector.used();
    let scatters = |one: &Substance| one.scatter.iter().any(|value| *value != Value::Fixed(0.0));
    substances.iter().any(scatters).then(|| {
        collector.begin();
        collector.table(SCATTER.into())
    })
}

/// Names of materials; the materials; what is said of pairs; and the variables on which what each does depends.
#[expect(clippy::type_complexity, reason = "four lists that only this function's caller takes apart")]
pub(super) fn all(
    config: &Config,
    collector: &mut Collector,
) -> Result<(Vec<String>, Vec<Substance>, Vec<([usize; 2], [Option<Value>; 5])>, Vec<Vec<usize>>), ConfigError> {
    collector.used();
    let plain = Material::default();
    let mut kinds = vec![String::new()];
    let mut substances = vec![Substance::new(collector, &Owner::new("", ""), &plain)?];
    let mut used = vec![Vec::new()];
    for (index, material) in config.materials.iter().enumerate() {
        let key = format!("world.custom.materials[{index}]");
        let owner = Owner::new(&material.name, &key);
        check_name(&owner)?;
        if kinds.contains(&material.name) {
            return Err(owner.wrong("name", format!("there is already a material called {:?}", material.name)));
        }
        collector.begin();
        substances.push(Substance::new(collector, &owner, material)?);
        used.push(collector.used());
        kinds.push(material.name.clone());
    }
    let mut pairs = Vec::with_capacity(config.pairs.len());
    for (index, pair) in config.pairs.iter().enumerate() {
        let key = format!("world.custom.pairs[{index}]");
        let name = pair.between.join("-");
        let owner = Owner::new(&name, &key);
        collector.begin();
        let [a, b] = [0, 1].map(|k| substance(&owner, &format!("between[{k}]"), &kinds, &pair.between[k]));
        let two = [a?, b?];
        if pairs.iter().any(|(known, _): &([usize; 2], _)| *known == two || *known == [two[1], two[0]]) {
            return Err(owner.wrong("between", "these two are already in another table of `pairs`"));
        }
        let said = contact_of_pair(collector, &owner, pair)?;
        let vars = collector.used();
        two.iter().for_each(|&one| used[one].extend(&vars));
        pairs.push((two, said));
    }
    Ok((kinds, substances, pairs, used))
}
