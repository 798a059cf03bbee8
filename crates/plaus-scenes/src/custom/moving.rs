//! What moves, with every number as a value.

use super::acting::Acting;
use super::config::Body;
use super::driven::{Driven, Way};
use super::inertia::Weight;
use super::joints::Holdable;
use super::late::{Appears, Late};
use super::names::{Member, colour};
use super::shapes::{Form, Made, Reader, Round};
use super::standing::Standing;
use super::start_from::BodyState;
use super::substances::{Substance, substance};
use super::surface::On;
use super::there::There;
use super::values::{Collector, MM, Numbers, Owner, Value, Values, vector};
use super::within::Within;
use crate::animation::{self, Look};
use crate::scene::ConfigError;
use crate::turns::by_angles;
use glam::{DQuat, DVec3};
use plaus_sim::WorldError;
use plaus_sim::rigid::Start;
use std::sync::Arc;

/// A body.
#[derive(Debug, Clone)]
pub(super) struct Moving {
    pub(super) name: String,
    /// Its table in the file.
    pub(super) key: String,
    pub(super) look: Look,
    pub(super) form: Form,
    /// Where its mass is, if that does not follow from its shape.
    weight: Option<Weight>,
    /// Whether it is a box with a die's pips.
    pub(super) pips: bool,
    /// The directions along its own axes that point up where each of its numbers is read, if they are marked.
    pub(super) marks: Vec<DVec3>,
    /// Its shape where no draw changes it.
    pub(super) kept: Option<Made>,
    pub(super) substance: usize,
    at: Values,
    /// On which piece of scenery it starts; `at` is then added.
    pub(super) on: Option<On>,
    turn: Turned,
    /// The place and the turn of its own keys where it starts from a file: those that joints are said for.
    own: Option<(Values, Turned)>,
    velocity: Values,
    spin: Values,
    release: Value,
    /// What makes it appear.
    pub(super) late: Option<Late>,
    pub(super) acting: Acting,
    pub(super) there: There,
    /// The groups in which it passes through others.
    pub(super) no_contact: Vec<String>,
    /// Its way, if it goes its own. Those that do come last.
    pub(super) way: Option<Way>,
}

/// How a body is released.
#[derive(Debug, Clone, Copy)]
pub(super) struct Release {
    pub(super) at: Values,
    pub(super) turn: Turned,
    pub(super) velocity: Values,
    pub(super) spin: Values,
    pub(super) time: Value,
}

/// How something is turned.
#[derive(Debug, Clone, Copy)]
pub(super) enum Turned {
    Angles(Values),
    /// As the orientation of the draw with this index.
    Any(usize),
    /// As a file says.
    Known(DQuat),
}

impl Moving {
    pub(super) fn new(
        collector: &mut Collector,
        member: &Member,
        (index, body): (usize, &Body),
        kinds: &[String],
        (substances, parts): (&[Substance], &[Standing]),
    ) -> Result<Self, ConfigError> {
        let owner = member.owner();
        let substance = substance(&owner, "material", kinds, &body.material)?;
        let look = substances[substance].look(colour(&owner, &body.colour)?, Look::nth(index));
        let at = collector.three(&owner, "at_mm", ["x", "y", "z"], &body.at_mm)?;
        let (at, on) = match &body.within {
            Some(Within::Surface(surface)) => (at, Some(On::new(collector, &owner, surface, parts)?)),
            Some(region) => (region.place(collector, &owner, &at)?, None),
            None => (at, None),
        };
        let angles = collector.three(&owner, "turn_deg", ["turn_x", "turn_y", "turn_z"], &body.turn_deg)?;
        let turn = if body.any_turn {
            if angles != [Value::Fixed(0.0); 3] {
                return Err(owner.wrong("any_turn", "a random orientation needs no angles: leave out `turn_deg`"));
            }
            Turned::Any(collector.turn(&owner))
        } else {
            Turned::Angles(angles)
        };
        let form = body.shape.read(&mut Reader::new(collector, &owner))?;
        if body.pips && form.cuboid.is_none() {
            return Err(owner.wrong("pips", "only a box has a die's pips"));
        }
        let marks = marks(&owner, body, &form)?;
        let of = (&form, body.pips, substances[substance].density);
        let weight = body.inertia.as_ref().map(|said| Weight::new(collector, &owner, said, of)).transpose()?;
        let velocity = collector.three(&owner, "velocity_m_s", ["vx", "vy", "vz"], &body.velocity_m_s)?;
        let spin = collector.three(&owner, "spin_deg_s", ["wx", "wy", "wz"], &body.spin_deg_s)?;
        let release = collector.number(&owner, "release_s", "release", &body.release_s)?;
        Ok(Self {
            name: owner.name.to_owned(),
            key: member.key.clone(),
            look,
            form,
            weight,
            pips: body.pips,
            marks,
            kept: None,
            substance,
            at,
            on,
            turn,
            own: None,
            velocity,
            spin,
            release,
            late: None,
            acting: Acting::new(collector, &owner, body, [velocity, spin])?,
            there: There::new(collector, &owner, body.present.as_ref())?,
            no_contact: body.no_contact.clone(),
            way: None,
        })
    }

    /// Makes it appear only when something has happened; `things` are the names of all bodies and all scenery.
    pub(super) fn appear(
        &mut self,
        collector: &mut Collector,
        (owner, index): (&Owner<'_>, usize),
        said: &Appears,
        things: (&[String], &[&str]),
    ) -> Result<(), ConfigError> {
        let after = Late::wait(collector, owner, said, self.release)?;
        self.late = Some(Late::new((owner, index), (said, after), things)?);
        Ok(())
    }

    pub(super) fn holdable(&self) -> Holdable<'_> {
        let is_ready = !self.acting.is_asleep && self.release == Value::Fixed(0.0) && self.late.is_none();
        let is_certain = self.there == There::Always;
        Holdable { name: &self.name, is_driven: self.way.is_some(), is_ready, is_certain }
    }

    pub(super) fn driven(
        collector: &mut Collector,
        member: &Member,
        (index, body): (usize, &Driven),
        kinds: &[String],
        substances: &[Substance],
    ) -> Result<Self, ConfigError> {
        let owner = member.owner();
        let substance = substance(&owner, "material", kinds, &body.material)?;
        let look = substances[substance].look(colour(&owner, &body.colour)?, Look::nth(index));
        let form = body.shape.read(&mut Reader::new(collector, &owner))?;
        let way = Way::new(collector, &owner, body)?;
        let (at, turn) = way.first();
        let [velocity, spin] = [[Value::Fixed(0.0); 3]; 2];
        let (name, key, turn) = (owner.name.to_owned(), member.key.clone(), Turned::Angles(turn));
        let (release, acting, kept) = (Value::Fixed(0.0), Acting::default(), None);
        let there = There::new(collector, &owner, body.present.as_ref())?;
        let (way, on, pips) = (Some(way), None, false);
        Ok(Self {
            name,
            key,
            look,
            form,
            weight: None,
            pips,
            marks: Vec::new(),
            kept,
            substance,
            at,
            on,
            turn,
            own: None,
            velocity,
            spin,
            release,
            late: None,
            acting,
            there,
            no_contact: body.no_contact.clone(),
            way,
        })
    }

    pub(super) fn made(&self, numbers: &Numbers<'_>) -> Result<Made, WorldError> {
        self.kept.clone().map_or_else(|| self.make(numbers), Ok)
    }

    /// Its shape: about its centre of gravity, or about its origin where keys say where that is.
    pub(super) fn make(&self, numbers: &Numbers<'_>) -> Result<Made, WorldError> {
        let mut made = self.form.make(numbers)?;
        if self.pips
            && let animation::Shape::Cuboid { pips, .. } = Arc::make_mut(&mut made.drawn)
        {
            *pips = Some(animation::Shape::PIPS);
        }
        if self.way.is_some() {
            return made.about_origin();
        }
        match &self.weight {
            Some(weight) => weight.of(made, numbers),
            None => Ok(made),
        }
    }

    /// Whether its shape, with its mass, is the same for all draws.
    pub(super) fn has_fixed_shape(&self) -> bool {
        self.form.is_fixed && self.weight.as_ref().is_none_or(Weight::is_fixed)
    }

    /// Whether it is the same for all draws, but for how it starts.
    pub(super) fn is_fixed(&self) -> bool {
        self.has_fixed_shape() && self.acting.is_fixed() && self.way.as_ref().is_none_or(Way::is_fixed)
    }

    /// Where it starts, in m.
    pub(super) fn begins(&self, numbers: &Numbers<'_>) -> DVec3 {
        let at = vector(&self.at, numbers) * MM;
        self.on.as_ref().map_or(at, |on| on.place(numbers) + at)
    }

    /// Makes it begin as a file says, in place of its own keys: none of these may be uncertain.
    pub(super) fn begin_as(
        &mut self,
        state: &BodyState,
        owner: &Owner<'_>,
        is_within: bool,
    ) -> Result<(), ConfigError> {
        let Self { at, turn, velocity, spin, .. } = &*self;
        let is_drawn = |values: &Values| !values.iter().all(|value| value.is_fixed());
        let drawn = match turn {
            _ if is_within => Some("within"),
            _ if is_drawn(at) => Some("at_mm"),
            Turned::Any(_) => Some("any_turn"),
            Turned::Angles(angles) if is_drawn(angles) => Some("turn_deg"),
            _ if is_drawn(velocity) => Some("velocity_m_s"),
            _ => is_drawn(spin).then_some("spin_deg_s"),
        };
        if let Some(key) = drawn {
            let message =
                format!("{} starts as `start_from` says, so this cannot be uncertain: leave it out", self.name);
            return Err(owner.wrong(key, message));
        }
        let Some(known) = state.quaternion() else { return Ok(()) };
        self.own = Some((self.at, self.turn));
        (self.at, self.turn) = (BodyState::values(state.at_mm), Turned::Known(known));
        (self.velocity, self.spin) = (BodyState::values(state.velocity_m_s), BodyState::values(state.spin_deg_s));
        // One that moves there has been hit.
        self.acting.is_asleep &= [state.velocity_m_s, state.spin_deg_s] == [[0.0; 3]; 2];
        Ok(())
    }

    /// Whether it starts as `start_from` says.
    pub(super) fn has_begun(&self) -> bool {
        self.own.is_some()
    }

    /// How it starts by its own keys.
    pub(super) fn own_start(&self, numbers: &Numbers<'_>, made: &Made) -> Start {
        let Some((at, turn)) = self.own else { return self.start(numbers, made) };
        Self { at, turn, own: None, ..self.clone() }.start(numbers, made)
    }

    /// How it starts.
    pub(super) fn start(&self, numbers: &Numbers<'_>, made: &Made) -> Start {
        let turn = match &self.turn {
            Turned::Angles(angles) => by_angles(angles.map(|angle| angle.of(numbers))),
            Turned::Any(index) => numbers.turn(*index),
            Turned::Known(turn) => *turn,
        };
        let turn = self.on.as_ref().and_then(|on| on.along(numbers)).map_or(turn, |along| along * turn);
        Start {
            position: self.begins(numbers) + turn * made.centre,
            orientation: (turn * made.axes).normalize(),
            velocity: vector(&self.velocity, numbers),
            spin: vector(&self.spin, numbers) * 1.0_f64.to_radians(),
            time: self.release.of(numbers),
        }
    }

    /// How it is released.
    pub(super) fn release(&self) -> Release {
        let Self { at, turn, velocity, spin, release: time, .. } = *self;
        Release { at, turn, velocity, spin, time }
    }

    /// Whether no axis of it is told from another.
    pub(super) fn is_ball(&self) -> bool {
        self.form.round == Round::Ball && self.weight.is_none()
    }
}

/// The directions that point up where each number of a body is read.
fn marks(owner: &Owner<'_>, body: &Body, form: &Form) -> Result<Vec<DVec3>, ConfigError> {
    let said: Vec<DVec3> = body.faces.iter().map(|face| DVec3::from_array(*face).normalize_or_zero()).collect();
    let wrong = |message: &str| Err(owner.wrong("faces", message));
    match &form.marks[..] {
        own if said.is_empty() => Ok(own.to_vec()),
        [_, ..] => wrong("a die has its own numbers: leave out `faces`, or give its corners as a `hull`"),
        [] if form.round == Round::Ball => wrong("a ball has no faces"),
        _ if body.pips => wrong("a box with `pips` has its own numbers"),
        _ if said.contains(&DVec3::ZERO) => wrong("a direction must be finite and not 0"),
        // To rounding: one of the two would never be read.
        _ if said.iter().enumerate().any(|(k, a)| said[..k].iter().any(|b| a.distance(*b) < 1e-9)) => {
            wrong("two faces have the same direction")
        }
        _ => Ok(said),
    }
}
