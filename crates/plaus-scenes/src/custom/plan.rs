//! What a scenario describes, with every number as a value: from it the simulator's world of a draw is made.

use super::config::{Body, Config, Fixed, Material};
use super::solids::{Form, MM, Made};
use super::values::{Collector, Drawn, Owner, Value, Values, vector};
use crate::animation::Look;
use crate::scenario::nearest;
use crate::scene::ConfigError;
use crate::turns::by_angles;
use glam::{DQuat, DVec3};
use plaus_sim::material::{Law, Laws, Material as Kind};
use plaus_sim::rigid::{BodySpec, Part, Rigid, RigidWorld, SolidPart, Start};
use plaus_sim::scenery::{Aabb, Plane};
use plaus_sim::{Accuracy, WorldError};
use std::collections::BTreeSet;

/// All of it.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub(super) bodies: Vec<Moving>,
    pub(super) parts: Vec<Standing>,
    substances: Vec<Substance>,
    /// Which two substances, and friction, restitution, resistance to rolling and to spinning where they are said.
    pairs: Vec<([usize; 2], [Option<Value>; 4])>,
    gravity: f64,
    pub(super) duration: f64,
    pub(super) accuracy: Accuracy,
    /// Whether the world is the same for all draws, but for how its bodies start.
    pub(super) is_steady: bool,
}

/// A body.
#[derive(Debug, Clone)]
pub(super) struct Moving {
    pub(super) name: String,
    pub(super) look: Look,
    form: Form,
    substance: usize,
    at: Values,
    turn: Turned,
    velocity: Values,
    spin: Values,
    release: Value,
}

/// How something is turned.
#[derive(Debug, Clone)]
enum Turned {
    Angles(Values),
    /// As the orientation of the draw with this index.
    Any(usize),
}

/// A piece of scenery.
#[derive(Debug, Clone)]
pub(super) struct Standing {
    pub(super) name: String,
    pub(super) look: Look,
    /// `None`: a plane.
    pub(super) form: Option<Form>,
    substance: usize,
    pub(super) at: Values,
    pub(super) turn: Values,
}

/// A material: density, friction, restitution, resistance to rolling and to spinning.
#[derive(Debug, Clone)]
struct Substance {
    density: Value,
    contact: [Value; 4],
    look: Option<Look>,
}

/// What is made for a draw, or for all.
#[derive(Debug)]
pub(super) struct Built {
    pub(super) rigid: Rigid,
    pub(super) shapes: Vec<Made>,
}

/// The colour in `#c04030`.
fn colour(owner: &Owner<'_>, text: &str) -> Result<Option<[u8; 3]>, ConfigError> {
    if text.is_empty() {
        return Ok(None);
    }
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii());
    let part = |k: usize| u8::from_str_radix(digits?.get(2 * k..2 * k + 2)?, 16).ok();
    match (part(0), part(1), part(2)) {
        (Some(red), Some(green), Some(blue)) => Ok(Some([red, green, blue])),
        _ => Err(owner.wrong("colour", format!("{text:?} is no colour: write one like \"#c04030\""))),
    }
}

/// Longest name.
const LONGEST: usize = 40;

/// Refuses names that could not be told apart in requirements, tables and files.
fn check_name(owner: &Owner<'_>) -> Result<(), ConfigError> {
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if owner.name.is_empty() || owner.name.len() > LONGEST || !owner.name.chars().all(letter) {
        let must = format!("a name is from 1 to {LONGEST} letters a–z, A–Z, digits, `_` and `-`");
        return Err(owner.wrong("name", format!("{:?}: {must}", owner.name)));
    }
    Ok(())
}

/// Refuses a name that another has.
fn check_unique<'a>(names: &mut BTreeSet<&'a str>, name: &'a str, owner: &Owner<'_>) -> Result<(), ConfigError> {
    check_name(owner)?;
    let message = || format!("there is something called {:?} already", owner.name);
    if names.insert(name) { Ok(()) } else { Err(owner.wrong("name", message())) }
}

impl Plan {
    /// The plan of a configuration, and its variables.
    pub(super) fn new(config: &Config) -> Result<(Self, Collector), ConfigError> {
        let mut names = BTreeSet::new();
        for (index, quantity) in config.quantities.iter().enumerate() {
            check_name(&Owner { name: &quantity.name, key: &format!("world.custom.quantities[{index}]") })?;
        }
        let mut collector = Collector::new(&config.quantities)?;
        let (kinds, substances, pairs) = Self::substances(config, &mut collector)?;
        let mut parts = Vec::with_capacity(config.fixed.len());
        for (index, fixed) in config.fixed.iter().enumerate() {
            let key = format!("world.custom.fixed[{index}]");
            check_unique(&mut names, &fixed.name, &Owner { name: &fixed.name, key: &key })?;
            collector.begin();
            parts.push(Standing::new(&mut collector, &key, fixed, &kinds, &substances)?);
        }
        let mut bodies = Vec::with_capacity(config.bodies.len());
        for (index, body) in config.bodies.iter().enumerate() {
            let key = format!("world.custom.bodies[{index}]");
            check_unique(&mut names, &body.name, &Owner { name: &body.name, key: &key })?;
            collector.begin();
            bodies.push(Moving::new(&mut collector, &key, (index, body), &kinds, &substances)?);
        }
        let (gravity, duration, accuracy) = (config.gravity, config.duration_s, config.accuracy.tolerances());
        let is_steady = false;
        let plan = Self { bodies, parts, substances, pairs, gravity, duration, accuracy, is_steady };
        plan.check_shapes()?;
        let plan = Self { is_steady: plan.is_steady(), ..plan };
        Ok((plan, collector))
    }

    #[expect(clippy::type_complexity, reason = "three lists that only this function's caller takes apart")]
    fn substances(
        config: &Config,
        collector: &mut Collector,
    ) -> Result<(Vec<String>, Vec<Substance>, Vec<([usize; 2], [Option<Value>; 4])>), ConfigError> {
        let plain = Material::default();
        let mut kinds = vec![String::new()];
        let mut substances = vec![Substance::new(collector, &Owner { name: "", key: "" }, &plain)?];
        for (index, material) in config.materials.iter().enumerate() {
            let key = format!("world.custom.materials[{index}]");
            let owner = Owner { name: &material.name, key: &key };
            check_name(&owner)?;
            if kinds.contains(&material.name) {
                return Err(owner.wrong("name", format!("a second material called {:?}", material.name)));
            }
            collector.begin();
            substances.push(Substance::new(collector, &owner, material)?);
            kinds.push(material.name.clone());
        }
        let mut pairs = Vec::with_capacity(config.pairs.len());
        for (index, pair) in config.pairs.iter().enumerate() {
            let key = format!("world.custom.pairs[{index}]");
            let name = pair.between.join("-");
            let owner = Owner { name: &name, key: &key };
            collector.begin();
            let [a, b] = [0, 1].map(|k| substance(&owner, &format!("between[{k}]"), &kinds, &pair.between[k]));
            let two = [a?, b?];
            if pairs.iter().any(|(known, _): &([usize; 2], _)| *known == two || *known == [two[1], two[0]]) {
                return Err(owner.wrong("between", "these two stand in another table of `pairs` already"));
            }
            let friction =
                pair.friction.as_ref().map(|amount| collector.number(&owner, "friction", "friction", amount));
            let restitution =
                pair.restitution.as_ref().map(|amount| collector.number(&owner, "restitution", "restitution", amount));
            let rolling = pair.rolling.as_ref().map(|amount| collector.number(&owner, "rolling", "rolling", amount));
            let spinning =
                pair.spinning.as_ref().map(|amount| collector.number(&owner, "spinning", "spinning", amount));
            let said = [friction.transpose()?, restitution.transpose()?, rolling.transpose()?, spinning.transpose()?];
            pairs.push((two, said));
        }
        Ok((kinds, substances, pairs))
    }

    /// Blames shapes that are none on their keys.
    fn check_shapes(&self) -> Result<(), ConfigError> {
        let bodies = self.bodies.iter().enumerate().map(|(k, body)| (format!("bodies[{k}]"), Some(&body.form)));
        let parts = self.parts.iter().enumerate().map(|(k, part)| (format!("fixed[{k}]"), part.form.as_ref()));
        for (key, form) in bodies.chain(parts) {
            if let Some(Err(error)) = form.map(|form| form.make(None)) {
                return Err(ConfigError::new(format!("world.custom.{key}.shape"), error));
            }
        }
        Ok(())
    }

    fn is_steady(&self) -> bool {
        let said = self.pairs.iter().flat_map(|(_, said)| said).flatten();
        let substances = self.substances.iter().flat_map(|one| one.contact.iter().chain([&one.density]));
        let places = self.parts.iter().flat_map(|part| part.at.iter().chain(&part.turn));
        said.chain(substances).chain(places).all(|value| value.is_fixed())
            && self.bodies.iter().all(|body| body.form.is_fixed())
            && self.parts.iter().all(|part| part.form.as_ref().is_none_or(Form::is_fixed))
    }

    /// The simulator's world of a draw; without one, of values in the middle of their laws.
    pub(super) fn build(&self, draw: Option<&Drawn>) -> Result<Built, WorldError> {
        let shapes = self.bodies.iter().map(|body| body.form.make(draw)).collect::<Result<Vec<_>, _>>()?;
        let spec = |(body, made): (&Moving, &Made)| {
            let density = self.substances[body.substance].density.of(draw);
            BodySpec::solid(made.solid.clone(), density, Kind(body.substance as u16))
        };
        let world = RigidWorld {
            bodies: self.bodies.iter().zip(&shapes).map(spec).collect(),
            parts: self.parts.iter().map(|part| part.make(draw)).collect::<Result<_, _>>()?,
            laws: self.laws(draw)?,
            gravity: DVec3::new(0.0, 0.0, -self.gravity),
            accuracy: self.accuracy,
            skin: 0.5,
            sink: f64::NEG_INFINITY,
            duration: self.duration,
        };
        Ok(Built { rigid: Rigid::new(world)?, shapes })
    }

    /// The mass of a body, in kg.
    pub(super) fn mass(&self, body: usize, draw: Option<&Drawn>, made: &Made) -> f64 {
        let density = self.substances[self.bodies[body].substance].density.of(draw);
        made.solid.mass_properties(density).mass
    }

    fn laws(&self, draw: Option<&Drawn>) -> Result<Laws, WorldError> {
        let count = self.substances.len();
        let mut laws = Laws::new(count as u16, Law::new(0.0, 0.0))?;
        let contact: Vec<[f64; 4]> =
            self.substances.iter().map(|one| one.contact.map(|value| value.of(draw))).collect();
        let mut set = |a: usize, b: usize, said: &[Option<Value>; 4]| {
            let follows = |k: usize| {
                let (one, other) = (contact[a][k], contact[b][k]);
                if k < 2 { (one * other).sqrt() } else { 0.5 * (one + other) }
            };
            let [friction, restitution, rolling, spinning] =
                [0, 1, 2, 3].map(|k| said[k].map_or_else(|| follows(k), |value| value.of(draw)));
            let law = Law::new(friction, restitution).with_resistance(rolling, spinning);
            laws.set(Kind(a as u16), Kind(b as u16), law)
        };
        for b in 0..count {
            for a in 0..=b {
                set(a, b, &[None; 4])?;
            }
        }
        for ([a, b], said) in &self.pairs {
            set(*a, *b, said)?;
        }
        Ok(laws)
    }

    /// How the bodies start.
    pub(super) fn starts(&self, draw: Option<&Drawn>, shapes: &[Made]) -> Vec<Start> {
        let start = |(body, made): (&Moving, &Made)| {
            let turn = match &body.turn {
                Turned::Angles(angles) => by_angles(angles.map(|angle| angle.of(draw))),
                Turned::Any(index) => draw.map_or(DQuat::IDENTITY, |draw| draw.turns[*index]),
            };
            Start {
                position: vector(&body.at, draw) * MM + turn * made.centre,
                orientation: (turn * made.axes).normalize(),
                velocity: vector(&body.velocity, draw),
                spin: vector(&body.spin, draw) * 1.0_f64.to_radians(),
                time: body.release.of(draw),
            }
        };
        self.bodies.iter().zip(shapes).map(start).collect()
    }
}

/// The material of this name.
fn substance(owner: &Owner<'_>, key: &str, kinds: &[String], name: &str) -> Result<usize, ConfigError> {
    kinds.iter().position(|kind| kind == name).ok_or_else(|| {
        let near = nearest(name, kinds.iter().map(String::as_str));
        let near = near.map(|near| format!("did you mean {near:?}? ")).unwrap_or_default();
        let known = kinds[1..].join(", ");
        let there = if known.is_empty() { "there are none".into() } else { format!("there are {known}") };
        owner.wrong(key, format!("there is no material {name:?}; {near}{there}"))
    })
}

impl Substance {
    fn new(collector: &mut Collector, owner: &Owner<'_>, material: &Material) -> Result<Self, ConfigError> {
        let colour = colour(owner, &material.colour)?;
        Ok(Self {
            density: collector.number(owner, "density", "density", &material.density)?,
            contact: [
                collector.number(owner, "friction", "friction", &material.friction)?,
                collector.number(owner, "restitution", "restitution", &material.restitution)?,
                collector.number(owner, "rolling", "rolling", &material.rolling)?,
                collector.number(owner, "spinning", "spinning", &material.spinning)?,
            ],
            look: colour.map(|colour| Look::new(colour, material.finish.material())),
        })
    }

    /// The look of something made of it, with a colour of its own or without.
    fn look(&self, own: Option<[u8; 3]>, otherwise: Look) -> Look {
        let look = self.look.unwrap_or(otherwise);
        own.map_or(look, |colour| Look::new(colour, look.material))
    }
}

impl Standing {
    fn new(
        collector: &mut Collector,
        key: &str,
        fixed: &Fixed,
        kinds: &[String],
        substances: &[Substance],
    ) -> Result<Self, ConfigError> {
        let owner = Owner { name: &fixed.name, key };
        let substance = substance(&owner, "material", kinds, &fixed.material)?;
        let look = substances[substance].look(colour(&owner, &fixed.colour)?, Look::STONE);
        let solid = fixed.shape.solid();
        Ok(Self {
            name: fixed.name.clone(),
            look,
            form: solid.map(|solid| Form::new(collector, &owner, &solid)).transpose()?,
            substance,
            at: collector.three(&owner, "at_mm", ["x", "y", "z"], &fixed.at_mm)?,
            turn: collector.three(&owner, "turn_deg", ["turn_x", "turn_y", "turn_z"], &fixed.turn_deg)?,
        })
    }

    /// How it is turned.
    pub(super) fn turned(&self, draw: Option<&Drawn>) -> DQuat {
        by_angles(self.turn.map(|angle| angle.of(draw)))
    }

    fn make(&self, draw: Option<&Drawn>) -> Result<Part, WorldError> {
        let (at, turn, material) = (vector(&self.at, draw) * MM, self.turned(draw), Kind(self.substance as u16));
        let Some(form) = &self.form else { return Ok(Part::Plane(Plane::new(at, turn * DVec3::Z, material)?)) };
        if let Some(edges) = form.sharp_box(draw).filter(|_| turn == DQuat::IDENTITY) {
            let bounds = Aabb { min: at - 0.5 * edges, max: at + 0.5 * edges };
            return Ok(Part::Block { bounds, material, stretches: Vec::new() });
        }
        let made = form.make(draw)?;
        Ok(Part::Solid(Box::new(SolidPart {
            at: at + turn * made.centre,
            turn: (turn * made.axes).normalize(),
            shape: made.solid,
            material,
        })))
    }
}

impl Moving {
    fn new(
        collector: &mut Collector,
        key: &str,
        (index, body): (usize, &Body),
        kinds: &[String],
        substances: &[Substance],
    ) -> Result<Self, ConfigError> {
        let owner = Owner { name: &body.name, key };
        let substance = substance(&owner, "material", kinds, &body.material)?;
        let look = substances[substance].look(colour(&owner, &body.colour)?, Look::nth(index));
        let at = collector.three(&owner, "at_mm", ["x", "y", "z"], &body.at_mm)?;
        let angles = collector.three(&owner, "turn_deg", ["turn_x", "turn_y", "turn_z"], &body.turn_deg)?;
        let turn = if body.any_turn {
            if angles != [Value::Fixed(0.0); 3] {
                return Err(owner.wrong("any_turn", "turned at random it has no angles: leave `turn_deg` out"));
            }
            Turned::Any(collector.turn(&owner))
        } else {
            Turned::Angles(angles)
        };
        Ok(Self {
            name: body.name.clone(),
            look,
            form: Form::new(collector, &owner, &body.shape)?,
            substance,
            at,
            turn,
            velocity: collector.three(&owner, "velocity_m_s", ["vx", "vy", "vz"], &body.velocity_m_s)?,
            spin: collector.three(&owner, "spin_deg_s", ["wx", "wy", "wz"], &body.spin_deg_s)?,
            release: collector.number(&owner, "release_s", "release", &body.release_s)?,
        })
    }
}
