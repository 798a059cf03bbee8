//! What a scenario describes, with every number as a value: from it the simulator's world of a draw is made.

use super::bearing::Bearing;
use super::config::Config;
use super::joints::{Bond, Holdable};
use super::late::Late;
use super::marbles::{self, Marbled};
use super::mechanics::Mechanics;
use super::moving::Moving;
use super::names::{Member, check_name, members};
use super::shapes::Made;
use super::standing::Standing;
use super::substances::{self, Substance};
use super::there::There;
use super::values::{Collector, Drawn, MM, Numbers, Owner, Value, Works};
use crate::scene::ConfigError;
use glam::DVec3;
use plaus_sim::marbles::{MarbleSpec, MarbleWorld};
use plaus_sim::material::Material as Kind;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::{BodySpec, RigidWorld, RigidWorldDesc, Start};
use plaus_sim::scenery::Surface;
use plaus_sim::{Accuracy, SurfaceId, WorldError};
use std::collections::{BTreeMap, BTreeSet};

/// Distance between points of a body's skin over a table, over the table's spacing: as for dice.
const SKIN: f64 = 1.0;

/// All of it.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub(super) bodies: Vec<Moving>,
    pub(super) parts: Vec<Standing>,
    pub(super) joints: Vec<Bond>,
    pub(super) substances: Vec<Substance>,
    /// Which two substances, and what of [`Substance::contact`] is said of them.
    pub(super) pairs: Vec<([usize; 2], [Option<Value>; 5])>,
    /// Which table of a draw has the scores of impacts that scatter.
    pub(super) scatter: Option<usize>,
    pub(super) works: Works,
    pub(super) bearing: Bearing,
    pub(super) gravity: f64,
    /// Below which height in m bodies are gone.
    pub(super) bottom: f64,
    pub(super) duration: f64,
    pub(super) accuracy: Accuracy,
    mechanics: Mechanics,
    /// Whether the world is the same for all draws, but for how its bodies start.
    pub(super) is_steady: bool,
    /// The numbers that requirements follow.
    pub(super) followed: Vec<Value>,
}

/// What is made for a draw, or for all.
#[derive(Debug)]
pub(super) struct Built {
    pub(super) world: World,
    /// The bodies that are there, in order: the simulator has no others.
    pub(super) there: Vec<usize>,
    /// The scenery that is there, likewise.
    pub(super) parts: Vec<usize>,
    /// Their shapes.
    pub(super) shapes: Vec<Made>,
}

/// The simulator's world.
#[derive(Debug)]
pub(super) enum World {
    Turning(Box<RigidWorld>),
    Marbles(Box<Marbled>),
}

impl Built {
    /// The index of the piece of scenery that a surface belongs to.
    pub(super) fn part(&self, surface: Surface) -> usize {
        match (&self.world, surface) {
            (World::Marbles(marbles), surface) => marbles.part(surface),
            (_, Surface::Part { part, .. } | Surface::Spot { part, .. }) => self.parts[usize::from(part)],
            // Worlds of turning bodies name no others.
            _ => 0,
        }
    }

    /// The same for a surface that the simulator's errors name.
    pub(super) fn part_of(&self, surface: SurfaceId) -> Option<usize> {
        match surface {
            SurfaceId::Part(index) => self.parts.get(index).copied(),
            SurfaceId::Of(surface) => Some(self.part(surface)),
            SurfaceId::Plane | SurfaceId::Dome | SurfaceId::Table | SurfaceId::ArcTrack => None,
        }
    }

    /// The number of what a body touched: of a body among all, of which there are `bodies`, or of a piece of scenery,
    /// counted on.
    pub(super) fn number(&self, other: Other, bodies: usize) -> usize {
        match other {
            Other::Body(other) => self.there[other],
            Other::Surface(surface) => bodies + self.part(surface),
        }
    }
}

/// Tells those of `bodies` that appear later what makes them, of the others and of what is `fixed`.
fn appearing(
    config: &Config,
    collector: &mut Collector,
    moving: &[Member],
    (bodies, fixed): (&mut [Moving], &[&str]),
    bearing: &mut Bearing,
) -> Result<(), ConfigError> {
    let all: Vec<String> = bodies.iter().map(|body| body.name.clone()).collect();
    // What had appeared where another run ended is there.
    let late = (0..moving.len()).filter(|&index| !bodies[index].has_begun()).collect::<Vec<_>>();
    for (index, member) in late.into_iter().map(|index| (index, &moving[index])) {
        let Some(said) = &config.bodies[member.entry].appears else { continue };
        collector.begin();
        bodies[index].appear(collector, (&member.owner(), index), said, (&all, fixed))?;
        bearing.of[index].extend(collector.used());
        bearing.held.extend(bodies[index].late.iter().flat_map(Late::waits_for).map(|other| [index, other]));
    }
    Ok(())
}

impl Plan {
    /// The plan of a configuration, and its variables.
    pub(super) fn new(config: &Config) -> Result<(Self, Collector), ConfigError> {
        if config.mechanics == Mechanics::Marbles {
            marbles::check(config)?;
        }
        for (index, quantity) in config.quantities.iter().enumerate() {
            check_name(&Owner::new(&quantity.name, &format!("world.custom.quantities[{index}]")))?;
        }
        let mut collector = Collector::new(&config.quantities)?;
        let (kinds, substances, pairs, used) = substances::all(config, &mut collector)?;
        let mut names = BTreeSet::new();
        let fixed = config.fixed.iter().map(|fixed| (fixed.name.as_str(), fixed.count));
        let fixed = members("fixed", fixed, &mut names)?;
        let (mut parts, mut scenery) = (Vec::with_capacity(fixed.len()), Vec::with_capacity(fixed.len()));
        for member in &fixed {
            collector.begin();
            parts.push(Standing::new(&mut collector, member, &config.fixed[member.entry], &kinds, &substances)?);
            scenery.push(collector.used());
        }
        let moving = config.bodies.iter().map(|body| (body.name.as_str(), body.count));
        let moving = members("bodies", moving, &mut names)?;
        let (mut bodies, mut bearing) = (Vec::with_capacity(moving.len()), Bearing::default());
        let called: Vec<&str> = moving.iter().map(|member| member.owner().name).collect();
        let states = config.start_from.states(&called)?;
        for (index, member) in moving.iter().enumerate() {
            collector.begin();
            let body = (index, &config.bodies[member.entry]);
            let mut moving = Moving::new(&mut collector, member, body, &kinds, (&substances, &parts))?;
            if let Some(state) = states.iter().find(|state| state.name == moving.name) {
                moving.begin_as(state, &member.owner(), body.1.within.is_some())?;
            }
            let on = moving.on.iter().flat_map(|on| &scenery[on.part]);
            bearing.of.push(collector.used().into_iter().chain(on.copied()).collect());
            bodies.push(moving);
        }
        bearing.free = bodies.len();
        let driven = config.driven.iter().map(|driven| (driven.name.as_str(), driven.count));
        for member in members("driven", driven, &mut names)? {
            collector.begin();
            let body = (bodies.len(), &config.driven[member.entry]);
            bodies.push(Moving::driven(&mut collector, &member, body, &kinds, &substances)?);
            bearing.of.push(collector.used());
        }
        let fixed: Vec<&str> = parts.iter().map(|part: &Standing| part.name.as_str()).collect();
        appearing(config, &mut collector, &moving, (&mut bodies, &fixed), &mut bearing)?;
        let holdable: Vec<Holdable<'_>> = bodies.iter().map(Moving::holdable).collect();
        let mut joints = Vec::with_capacity(config.joints.len());
        let said = config.joints.iter().map(|joint| (joint.name.as_str(), joint.count));
        for member in members("joints", said, &mut names)? {
            collector.begin();
            let joint = &config.joints[member.entry];
            let bond = Bond::new(&mut collector, &member, joint, (&holdable, &fixed))?;
            bearing.joined(&bond, collector.used());
            joints.push(bond);
        }
        bearing.of.extend(scenery);
        let of_parts = parts.iter().map(|part| part.substance);
        bearing.made_of(bodies.iter().map(|body| body.substance).chain(of_parts), &used);
        let scatter = substances::impacts(&mut collector, &substances);
        bearing.on_all(&collector.used());
        let (gravity, duration, accuracy) = (config.gravity, config.duration_s, config.accuracy.tolerances());
        let bottom = config.bottom_mm.map_or(f64::NEG_INFINITY, |height| height * MM);
        let mut plan = Self {
            bodies,
            parts,
            joints,
            substances,
            pairs,
            scatter,
            works: collector.works(),
            bearing,
            gravity,
            bottom,
            duration,
            accuracy,
            mechanics: config.mechanics,
            is_steady: false,
            followed: Vec::new(),
        };
        plan.check_shapes()?;
        let plan = Self { is_steady: plan.is_steady(), ..plan };
        Ok((plan, collector))
    }

    /// Learns formulas, each with its key, over `quantities`; gives what they come to in the middle of all laws.
    pub(super) fn follow(
        &mut self,
        formulas: &[(String, String)],
        quantities: &BTreeMap<String, Value>,
    ) -> Result<Vec<f64>, ConfigError> {
        let add = |(key, text): &(String, String)| {
            self.works.add(text, quantities).map_err(|message| ConfigError::new(key, message))
        };
        self.followed = formulas.iter().map(add).collect::<Result<_, _>>()?;
        let numbers = self.works.numbers(None);
        Ok(self.followed.iter().map(|value| value.of(&numbers)).collect())
    }

    /// Bodies that do not go their own way: the first.
    pub(super) fn free(&self) -> &[Moving] {
        &self.bodies[..self.bodies.partition_point(|body| body.way.is_none())]
    }

    /// Scenery with random fields, in the order of a draw's tables.
    pub(super) fn random(&self) -> impl Iterator<Item = &Standing> {
        self.parts.iter().filter(|part| part.is_random())
    }

    /// The first piece of scenery of which bumps turn a triangle over, in a draw.
    pub(super) fn folded(&self, draw: &Drawn) -> Result<Option<u32>, WorldError> {
        let numbers = self.works.numbers(Some(draw));
        for (index, part) in self.parts.iter().enumerate() {
            if part.is_folded(&numbers)? {
                return Ok(Some(index as u32));
            }
        }
        Ok(None)
    }

    /// Blames shapes that are none on their keys, and keeps those that no draw changes.
    fn check_shapes(&mut self) -> Result<(), ConfigError> {
        let numbers = self.works.numbers(None);
        let wrong = |key: &str, error: WorldError| match error {
            WorldError::BadProfile(error) => {
                ConfigError::new(format!("{key}.shape.revolution"), error.in_units("mm", MM))
            }
            error => ConfigError::new(format!("{key}.shape"), error),
        };
        let mut reaches = Vec::new();
        for body in &mut self.bodies {
            let made = body.make(&numbers).map_err(|error| wrong(&body.key, error))?;
            if !body.is_ball() {
                reaches.push((body.name.clone(), made.solid.reach()));
            }
            body.kept = Some(made).filter(|_| body.has_fixed_shape());
        }
        for part in &mut self.parts {
            part.check(&numbers).map_err(|error| wrong(&part.key, error))?;
            part.check_bodies(&reaches, &numbers)?;
            if self.mechanics == Mechanics::Marbles {
                marbles::check_part(part, &numbers)?;
            }
        }
        Ok(())
    }

    /// What of bodies and scenery is drawn but not simulated, in words.
    pub(super) fn notes(&self) -> Vec<String> {
        let bodies = self.bodies.iter().map(|body| (&body.name, &body.form));
        let all = bodies.chain(self.parts.iter().filter_map(|part| Some((&part.name, part.form()?))));
        all.filter_map(|(name, form)| Some(format!("{name} is simulated as {}", form.note.as_ref()?))).collect()
    }

    /// Whether the world is the same for all draws, but for how its bodies start.
    pub(super) fn is_steady(&self) -> bool {
        let said = self.pairs.iter().flat_map(|(_, said)| said).flatten();
        let values = |one: &'_ Substance| one.contact.into_iter().chain(one.scatter).chain([one.density]);
        let substances = self.substances.iter().flat_map(values);
        said.copied().chain(substances).all(Value::is_fixed)
            && self.joints.is_empty()
            && self.optional().next().is_none()
            && self.bodies.iter().all(Moving::is_fixed)
            && self.parts.iter().all(|part| part.is_fixed() && part.there == There::Always)
    }

    /// Bodies that are not there in every draw.
    pub(super) fn optional(&self) -> impl Iterator<Item = &Moving> {
        self.bodies.iter().filter(|body| body.there != There::Always)
    }

    /// The bodies that are there in a draw, in order.
    pub(super) fn there(&self, draw: &Drawn) -> Vec<usize> {
        match self.optional().next() {
            None => (0..self.bodies.len()).collect(),
            Some(_) => self.there_with(&self.works.numbers(Some(draw))),
        }
    }

    /// The bodies that are there in a draw, and the scenery, counted on; `None` if they are the same in all draws.
    pub(super) fn present(&self, draw: &Drawn) -> Option<Vec<usize>> {
        let is_certain = |part: &Standing| part.there == There::Always;
        if self.optional().next().is_none() && self.parts.iter().all(is_certain) {
            return None;
        }
        let numbers = self.works.numbers(Some(draw));
        let mut all = self.there_with(&numbers);
        if !self.parts.iter().all(is_certain) {
            all.extend(self.parts_with(&numbers).into_iter().map(|part| self.bodies.len() + part));
        }
        Some(all)
    }

    fn parts_with(&self, numbers: &Numbers<'_>) -> Vec<usize> {
        (0..self.parts.len()).filter(|&index| self.parts[index].there.of(numbers)).collect()
    }

    fn there_with(&self, numbers: &Numbers<'_>) -> Vec<usize> {
        (0..self.bodies.len()).filter(|&index| self.bodies[index].there.of(numbers)).collect()
    }

    /// The simulator's world of a draw.
    pub(super) fn build(&self, numbers: &Numbers<'_>) -> Result<Built, WorldError> {
        let (there, parts) = (self.there_with(numbers), self.parts_with(numbers));
        let bodies = || there.iter().map(|&index| &self.bodies[index]);
        let shapes = bodies().map(|body| body.made(numbers)).collect::<Result<Vec<_>, _>>()?;
        let world = match self.mechanics {
            Mechanics::Turning => World::Turning(Box::new(self.turning(numbers, (&there, &parts), &shapes)?)),
            Mechanics::Marbles => World::Marbles(Box::new(self.marbles(numbers, (&there, &parts), &shapes)?)),
        };
        Ok(Built { world, there, parts, shapes })
    }

    fn turning(
        &self,
        numbers: &Numbers<'_>,
        (there, parts): (&[usize], &[usize]),
        shapes: &[Made],
    ) -> Result<RigidWorld, WorldError> {
        let bodies = || there.iter().map(|&index| &self.bodies[index]);
        let spec = |(body, made): (&Moving, &Made)| {
            let density = self.substances[body.substance].density.of(numbers);
            let (mass, material) = (made.mass_properties(density), Kind(body.substance as u16));
            BodySpec { shape: made.solid.clone(), mass, material }
        };
        let world = RigidWorldDesc {
            bodies: bodies().zip(shapes).map(spec).collect(),
            parts: parts.iter().map(|&part| self.parts[part].make(numbers)).collect::<Result<_, _>>()?,
            laws: self.laws(numbers)?,
            gravity: DVec3::new(0.0, 0.0, -self.gravity),
            accuracy: self.accuracy,
            skin: SKIN,
            sink: self.bottom,
            duration: self.duration,
        };
        let mut rigid = RigidWorld::new(world)?;
        for (index, (body, made)) in bodies().zip(shapes).enumerate() {
            if let Some(way) = &body.way {
                rigid.drive(index, &way.keyframes(numbers, made))?;
            }
            if let Some(forces) = body.acting.forces(numbers, made.axes) {
                rigid.act_on(index, forces)?;
            }
        }
        let mut groups: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (index, body) in bodies().enumerate() {
            body.no_contact.iter().for_each(|group| groups.entry(group).or_default().push(index));
        }
        groups.values().try_for_each(|group| rigid.exclude_contacts(group))?;
        if !self.joints.is_empty() {
            let starts = self.own_starts(numbers, there, shapes);
            for joint in &self.joints {
                joint.join(&mut rigid, numbers, there, &starts)?;
            }
        }
        Ok(rigid)
    }

    fn marbles(
        &self,
        numbers: &Numbers<'_>,
        (there, parts): (&[usize], &[usize]),
        shapes: &[Made],
    ) -> Result<Marbled, WorldError> {
        let spec = |(&index, made): (&usize, &Made)| {
            let material = Kind(self.bodies[index].substance as u16);
            MarbleSpec::solid(made.solid.reach(), self.mass(index, numbers, made), material)
        };
        let world = MarbleWorld {
            specs: there.iter().zip(shapes).map(spec).collect(),
            laws: self.laws(numbers)?,
            gravity: DVec3::new(0.0, 0.0, -self.gravity),
            accuracy: self.accuracy,
            duration: self.duration,
            ..MarbleWorld::default()
        };
        Marbled::new(world, parts.iter().map(|&part| (part, &self.parts[part])), numbers)
    }

    /// What a body, or a piece of scenery counted on, is called.
    pub(super) fn name(&self, index: usize) -> &str {
        let part = || self.parts.get(index - self.bodies.len()).map_or("", |part| &part.name);
        self.bodies.get(index).map_or_else(part, |body| &body.name)
    }

    /// Whether a joint holds a body.
    pub(super) fn is_held(&self, body: usize) -> bool {
        self.joints.iter().any(|joint| joint.holds_body(body))
    }

    /// The mass of a body, in kg.
    pub(super) fn mass(&self, body: usize, numbers: &Numbers<'_>, made: &Made) -> f64 {
        let density = self.substances[self.bodies[body].substance].density.of(numbers);
        made.solid.mass_properties(density).mass
    }

    /// How the bodies start that are there.
    pub(super) fn starts(&self, numbers: &Numbers<'_>, there: &[usize], shapes: &[Made]) -> Vec<Start> {
        let start = |(&index, made): (&usize, &Made)| {
            let start = self.bodies[index].start(numbers, made);
            // What has not appeared is released after the end.
            if self.bodies[index].late.is_some() { Start { time: self.duration + 1.0, ..start } } else { start }
        };
        there.iter().zip(shapes).map(start).collect()
    }
}
