//! Changes to a state between two runs: bodies are kicked, taken out, and put in.

use super::RigidWorld;
use super::body_state::{Phase, RigidBodyState, Velocities};
use super::pose::Start;
use super::scattered::ScatteredImpacts;
use crate::error::WorldError;
use crate::queue::{Event, Happening};
use crate::state::State;
use glam::DVec3;

impl RigidWorld {
    /// Gives a body an impulse in N s at its centre of gravity, and an angular impulse in N m s, at the state's time. A
    /// body that sleeps or rests wakes. For a body that has not been released, they are added to its start.
    ///
    /// # Errors
    /// [`WorldError::BadBody`] for a body that is not there, is gone or is driven, and for numbers that are not finite.
    pub fn kick(
        &self,
        state: &mut State<RigidBodyState>,
        index: usize,
        impulse: DVec3,
        angular: DVec3,
    ) -> Result<(), WorldError> {
        self.check_edited(state, index)?;
        if let Some(value) = crate::rigid::not_finite([impulse.to_array(), angular.to_array()].concat()) {
            return Err(bad(index, "impulse", value, "finite numbers"));
        }
        if state.bodies[index].phase == Phase::Gone {
            return Err(bad(index, "index of what is kicked", index as f64, "a body that is not gone"));
        }
        let (spec, time) = (&self.specs[index], state.time);
        let body = &mut state.bodies[index];
        let is_waiting = body.phase == Phase::Waiting;
        if !is_waiting {
            body.advance(spec, time);
        }
        let v = body.path.v + impulse / spec.mass;
        let w = body.spin + spec.inertia.spin(body.turn, angular);
        body.set_motion(spec, Velocities { v, w });
        if !is_waiting {
            self.wake(state, index);
        }
        Ok(())
    }

    /// Takes a body out at the state's time. Bodies that rested on it wake, and its joints no longer hold.
    ///
    /// # Errors
    /// [`WorldError::BadBody`] for a body that is not there or is driven.
    pub fn remove(&self, state: &mut State<RigidBodyState>, index: usize) -> Result<(), WorldError> {
        self.check_edited(state, index)?;
        let time = state.time;
        let neighbours: Vec<usize> = state.links.of(index as u32).map(|k| k as usize).collect();
        state.links.retain(|link| !link.contains(&(index as u32)));
        for k in neighbours.into_iter().filter(|&k| !self.specs[k].is_driven()) {
            state.bodies[k].advance(&self.specs[k], time);
            self.wake(state, k);
        }
        let body = &mut state.bodies[index];
        if body.phase != Phase::Waiting {
            body.advance(&self.specs[index], time);
        }
        body.lie_still();
        body.phase = Phase::Gone;
        state.interrupt(index, Event { time: f64::INFINITY, happening: Happening::End });
        Ok(())
    }

    /// Puts a body in anew, wherever it was, even if it had been taken out: it is released as its start says. A world
    /// holds all bodies that are ever put in, so take out those that come later.
    ///
    /// # Errors
    /// [`WorldError`] if its start lies before the state's time, is not finite, or overlaps scenery, or if it is
    /// released at the state's time and overlaps a body that is there; [`WorldError::BadBody`] for a body that is not
    /// there, is driven or has joints. The state is then unchanged.
    pub fn put(&self, state: &mut State<RigidBodyState>, index: usize, start: &Start) -> Result<(), WorldError> {
        self.check_edited(state, index)?;
        if !self.joints.of(index).is_empty() {
            return Err(bad(index, "index of what is put in", index as f64, "a body without joints"));
        }
        self.check_start(index, start)?;
        if start.time < state.time {
            return Err(bad(index, "start time", start.time, "a time not before that of the state"));
        }
        let mut body = RigidBodyState::waiting(start);
        let is_there = |b: &RigidBodyState| !matches!(b.phase, Phase::Waiting | Phase::Gone);
        for (k, other) in state.bodies.iter().enumerate() {
            if k == index || start.time > state.time || !is_there(other) {
                continue;
            }
            let there = self.at(k, other, start.time);
            let (pair, both) = if k < index { ([k, index], [&there, &body]) } else { ([index, k], [&body, &there]) };
            let depth = -self.gap(pair, both);
            if depth > crate::rigid::tolerances::START_OVERLAP * self.specs[k].size.min(self.specs[index].size) {
                return Err(WorldError::BodiesOverlap { a: pair[0], b: pair[1], depth });
            }
        }
        self.remove(state, index)?;
        // Its impacts are counted on: no two have the same name.
        body.scattered = std::mem::take(&mut state.bodies[index].scattered);
        state.bodies[index] = body;
        let time = start.time.min(self.duration);
        state.interrupt(index, Event { time, happening: Happening::Expiry });
        Ok(())
    }

    fn check_edited(&self, state: &State<RigidBodyState>, index: usize) -> Result<(), WorldError> {
        if state.bodies.len() != self.specs.len() {
            return Err(WorldError::WrongState { state: state.bodies.len(), world: self.specs.len() });
        }
        match self.specs.get(index) {
            Some(spec) if !spec.is_driven() => Ok(()),
            _ => Err(bad(index, "index", index as f64, "a body of the world without keyframes")),
        }
    }

    /// Makes a body and the bodies that it touches decide anew, at the state's time, how they go on.
    fn wake(&self, state: &mut State<RigidBodyState>, index: usize) {
        let body = &mut state.bodies[index];
        if !body.flies() && body.phase != Phase::Gone {
            body.phase = Phase::Step;
            let motion = Velocities { v: body.path.v, w: body.spin };
            body.set_motion(&self.specs[index], motion);
            body.expiry = body.path.t;
            self.list_touches(index, body);
        }
        let time = state.time;
        state.interrupt(index, Event { time, happening: Happening::Expiry });
    }
}

fn bad(body: usize, field: &'static str, value: f64, expected: &'static str) -> WorldError {
    WorldError::BadBody { body, field, value, expected }
}

impl RigidBodyState {
    /// A copy for a recording: without the forces at its points of contact, which only its next step begins with, and
    /// without its number of impacts. In a large island of many facets the forces take ten times as much as all the
    /// rest.
    #[must_use]
    pub fn recorded(&self) -> Self {
        let mut kept = self.clone();
        kept.pair_loads = Vec::new();
        kept.scattered = ScatteredImpacts::default();
        kept
    }
}
