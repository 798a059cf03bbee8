//! The moving state of a rigid body.

use super::BodyDef;
use super::motion::free_rotation::{FreeRotation, LEFT_OUT, drift, drift_within, rotation};
pub(crate) use super::pose::Pose;
use super::pose::Start;
use super::scattered::ScatteredImpacts;
use super::tolerances::{CHATTER_EVENTS, MAX_STATIC_CONTACTS, WARM_STARTED_CONTACTS};
use crate::motion::Parabola;
use crate::scenery::Surface;
use glam::{DMat3, DQuat, DVec3};
use serde::{Deserialize, Serialize};

/// What kind of motion a body is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Not released yet.
    Waiting,
    /// Free flight: a parabola and free rotation.
    Flight,
    /// A step of lasting contact: straight, with free rotation.
    Step,
    /// A ball slides or rolls on level ground: a parabola, and an angular velocity that changes at a constant rate.
    Glide,
    /// At rest until something hits it.
    Rest,
    /// Fallen below the world's sink: it takes no further part.
    Gone,
    /// Driven: follows keyframes.
    Driven,
    /// A step of bodies on joints that nothing touches: on cubics between its ends.
    Articulated,
    /// Free flight with damping or a torque, in legs: a parabola and free rotation that stray from the closed form by
    /// less than half of the gap at which bodies touch.
    Leg,
}

/// Velocities of a body.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Velocities {
    pub(crate) v: DVec3,
    pub(crate) w: DVec3,
}

/// What contact changes: a velocity in m/s, and an angular momentum about the centre of gravity in kg m²/s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Momentum {
    pub(crate) v: DVec3,
    pub(crate) l: DVec3,
}

/// The force in N on a body at a point of contact with another one, at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct PairLoad {
    pub(super) other: u32,
    /// The name of the point ([`PairTouch::name`](crate::rigid::narrow_phase::contact_point::PairContactPoint::name)).
    pub(super) name: u64,
    pub(super) force: DVec3,
}

/// A rigid body with the closed form of its current motion.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RigidBodyState {
    /// Motion of the centre of gravity; of a driven body, of its origin, as far as searches for a contact see it.
    pub path: Parabola,
    /// Orientation at the clock: turns body axes into world axes.
    pub turn: DQuat,
    /// Angular velocity at the clock in rad/s, in world axes. Within a step it is that of the drift, within a leg the
    /// mean.
    pub spin: DVec3,
    /// Kind of motion.
    pub phase: Phase,
    pub(crate) expiry: f64,
    /// Rate of change of a gliding ball's angular velocity, in rad/s².
    pub(crate) spin_rate: DVec3,
    /// Whether the ball rolls when its slide ends.
    pub(crate) rolls_after: bool,
    /// The line that a ball's centre reaches at the end of its section of ground: axis and position.
    pub(crate) line: Option<(u8, f64)>,
    /// Velocity and angular momentum at the start and the end of a step; for a leg, at its start.
    pub(crate) ends: [Momentum; 2],
    /// Orientation at the end of a step of bodies on joints.
    #[serde(default)]
    pub(crate) end_turn: DQuat,
    /// The length in s that the next step on joints is to have; 0 if it is not known.
    #[serde(default)]
    pub(crate) articulated_step: f64,
    /// Energy in J that steps on joints still have to give back, at the start and at the end of the step.
    #[serde(default)]
    pub(crate) energy_debt: [f64; 2],
    /// Four times what is added to the angular momentum in the middle of a step; nothing is added at its ends. Impulses
    /// between two bodies that pass each other act where both are at that time, so that their total angular momentum is
    /// kept.
    pub(crate) angular_momentum_transport: DVec3,
    /// Whether it will sleep from its release on.
    pub(super) sleeps: bool,
    /// Which of its joints are torn, one bit each.
    #[serde(default)]
    pub(super) torn: u32,
    /// How far the strings on its drums are wound: [`Drum::turned`](super::Drum::turned) when its motion began.
    #[serde(default)]
    pub(super) wound: Vec<f64>,
    /// The driven body that has left it no way.
    #[serde(default)]
    pub(super) crushed_by: Option<u32>,
    /// How often it struck each thing in impacts that scatter.
    #[serde(default)]
    pub(super) scattered: ScatteredImpacts,
    /// Bodies of higher index that it met within a step without an approach of the momenta, at `deferred_at`.
    #[serde(default)]
    deferred: Vec<u32>,
    #[serde(default)]
    deferred_at: f64,
    /// How far beyond touching points belonged to the contacts of its island when that last settled, over the size.
    #[serde(default)]
    pub(super) mid_step_drift: f64,
    /// The time-stepped island with which it takes its step: one more than the index of its first member; 0 for none.
    #[serde(default)]
    pub(super) time_step_island: u32,
    /// Whether that step begins and ends without any motion.
    #[serde(default)]
    pub(super) stays: bool,
    /// Events since `chatter_from`, all within `accuracy.rattle`.
    chatter_events: u32,
    chatter_from: f64,
    /// Points that touch fixed parts at the clock.
    touching: [Surface; MAX_STATIC_CONTACTS],
    touching_count: u8,
    /// Forces in N at the first few of the points with which a step was made: the initial guess for the next step.
    loads: [DVec3; WARM_STARTED_CONTACTS],
    /// Forces at the points of contact with bodies of higher index, likewise.
    #[serde(default)]
    pub(super) pair_loads: Vec<PairLoad>,
    /// The clock at which `touching` was found.
    pub(crate) listed: f64,
}

/// A time that never comes; finite, so that every format can hold a state.
pub(crate) const NEVER: f64 = f64::MAX;

const NOWHERE: Surface = Surface::Part { part: u16::MAX, point: u16::MAX };

impl RigidBodyState {
    pub(super) fn waiting(start: &Start) -> Self {
        let path = Parabola { t: start.time, x: start.position, v: start.velocity, a: DVec3::ZERO };
        Self {
            path,
            turn: start.orientation.normalize(),
            spin: start.spin,
            phase: Phase::Waiting,
            expiry: start.time,
            spin_rate: DVec3::ZERO,
            rolls_after: false,
            line: None,
            ends: [Momentum::default(); 2],
            end_turn: DQuat::IDENTITY,
            articulated_step: 0.0,
            energy_debt: [0.0; 2],
            angular_momentum_transport: DVec3::ZERO,
            sleeps: false,
            torn: 0,
            wound: Vec::new(),
            crushed_by: None,
            scattered: ScatteredImpacts::default(),
            deferred: Vec::new(),
            deferred_at: -NEVER,
            mid_step_drift: 0.0,
            time_step_island: 0,
            stays: false,
            chatter_events: 0,
            chatter_from: -NEVER,
            touching: [NOWHERE; MAX_STATIC_CONTACTS],
            touching_count: 0,
            loads: [DVec3::ZERO; WARM_STARTED_CONTACTS],
            pair_loads: Vec::new(),
            listed: -NEVER,
        }
    }

    /// Points that touch fixed parts; of flush faces as [`super::RigidWorld::user_surface`] says.
    #[must_use]
    pub fn touching(&self) -> &[Surface] {
        &self.touching[..usize::from(self.touching_count)]
    }

    /// The force at a point at the end of the last step, if it was kept.
    pub(super) fn load(&self, surface: Surface) -> Option<DVec3> {
        let at = self.touching().iter().take(WARM_STARTED_CONTACTS).position(|&s| s == surface);
        at.filter(|_| self.phase == Phase::Step).map(|k| self.loads[k])
    }

    /// The force at a point of contact with another body at the end of the last step, if there was one.
    pub(super) fn pair_load(&self, other: usize, name: u64) -> Option<DVec3> {
        let is_it = |l: &&PairLoad| l.other as usize == other && l.name == name;
        let found = if self.phase == Phase::Step { self.pair_loads.iter().find(is_it) } else { None };
        found.map(|l| l.force)
    }

    /// Notes that it has met a body of higher index without an approach of the momenta: at this time, their contact
    /// lasts.
    pub(super) fn defer_pair(&mut self, other: usize) {
        if self.deferred_at != self.path.t {
            self.deferred.clear();
            self.deferred_at = self.path.t;
        }
        self.deferred.push(other as u32);
    }

    /// Whether it has met this body in that way at its clock.
    pub(super) fn is_pair_deferred(&self, other: usize) -> bool {
        self.deferred_at == self.path.t && self.deferred.contains(&(other as u32))
    }

    pub(super) fn set_loads(&mut self, forces: impl Iterator<Item = DVec3>) {
        self.loads = [DVec3::ZERO; WARM_STARTED_CONTACTS];
        for (load, force) in self.loads.iter_mut().zip(forces) {
            *load = force;
        }
    }

    pub(super) fn list(&mut self, surfaces: impl Iterator<Item = Surface>) {
        self.touching_count = 0;
        for s in surfaces.take(MAX_STATIC_CONTACTS) {
            self.touching[usize::from(self.touching_count)] = s;
            self.touching_count += 1;
        }
    }

    /// Velocities `dt` after the clock.
    ///
    /// Within a step, the impulses of its contacts act evenly over time. So a quantity that frictionless contacts
    /// cannot change is kept at every time, and Coulomb's law holds up to every time. No energy is made, because
    /// kinetic energy is convex.
    pub(super) fn motion_after(&self, spec: &BodyDef, dt: f64) -> Velocities {
        match self.phase {
            Phase::Step => {
                let now = self.within_step(spec, dt);
                let turn = if dt == 0.0 { self.turn } else { self.stepped(spec, dt).0 };
                Velocities { v: now.v, w: spec.inertia.spin(turn, now.l) }
            }
            Phase::Leg => {
                let now = self.within_leg(spec, dt);
                Velocities { v: now.v, w: spec.inertia.spin(drift(&spec.inertia, self.turn, self.spin, dt).0, now.l) }
            }
            Phase::Articulated => {
                let [v, w] = self.cubic_motion(spec, dt);
                Velocities { v, w }
            }
            Phase::Driven => match &spec.drive {
                Some(drive) => Velocities { v: drive.velocity(self.path.t, dt), w: drive.spin(self.path.t, dt) },
                None => Velocities { v: self.path.v, w: self.spin },
            },
            Phase::Flight | Phase::Glide => {
                Velocities { v: self.path.velocity_after(dt), w: self.drift_spin(spec, dt) }
            }
            Phase::Waiting | Phase::Rest | Phase::Gone => Velocities { v: self.path.v, w: self.spin },
        }
    }

    /// Orientation and angular velocity of the drift `dt` after the clock of a body that turns freely.
    pub(super) fn stepped(&self, spec: &BodyDef, dt: f64) -> (DQuat, DVec3) {
        let left_out = if self.time_step_island == 0 { LEFT_OUT } else { spec.turn_error };
        drift_within(&spec.inertia, self.turn, self.spin, dt, left_out)
    }

    /// Velocity and angular momentum `dt` after the start of a step.
    fn within_step(&self, spec: &BodyDef, dt: f64) -> Momentum {
        let [a, b] = self.ends;
        if dt <= 0.0 {
            return a;
        }
        let part = dt / (self.expiry - self.path.t);
        if part >= 1.0 {
            return b;
        }
        if let Some(damping) = &spec.damping {
            // Damping takes what it takes in flight, whatever the contacts do.
            let [now, all] = [dt, self.expiry - self.path.t].map(|dt| spec.damped(damping, &a, self.turn, dt));
            let l = now.l + (b.l - all.l) * part + self.angular_momentum_transport * (part * (1.0 - part));
            return Momentum { v: now.v + (b.v - all.v) * part, l };
        }
        Momentum {
            v: a.v.lerp(b.v, part),
            l: a.l.lerp(b.l, part) + self.angular_momentum_transport * (part * (1.0 - part)),
        }
    }

    /// Angular velocity along the actual path, `dt` after the clock.
    pub(super) fn drift_spin(&self, spec: &BodyDef, dt: f64) -> DVec3 {
        match self.phase {
            Phase::Flight | Phase::Leg | Phase::Step if spec.anisotropy != 0.0 => self.stepped(spec, dt).1,
            Phase::Glide => self.spin + self.spin_rate * dt,
            _ => self.keyed_spin(spec, dt),
        }
    }

    /// The same where it does not turn freely: that of a driven body changes between keys, that of a body on joints
    /// within a step.
    pub(super) fn keyed_spin(&self, spec: &BodyDef, dt: f64) -> DVec3 {
        match (self.phase, &spec.drive) {
            (Phase::Driven, Some(drive)) => drive.spin(self.path.t, dt),
            (Phase::Articulated, _) => self.cubic_motion(spec, dt)[1],
            _ => self.spin,
        }
    }

    /// Whether its quaternion is on a cubic.
    pub(super) fn is_keyed(&self) -> bool {
        matches!(self.phase, Phase::Driven | Phase::Articulated)
    }

    /// Whether it turns freely, in flight or within a step.
    pub(super) fn turns_freely(&self) -> bool {
        matches!(self.phase, Phase::Flight | Phase::Leg | Phase::Step)
    }

    /// An upper bound on its angular speed within its current motion, up to a time. Where it is
    /// [keyed](Self::is_keyed), its square also bounds the acceleration of any point over its distance from the origin.
    pub(super) fn fastest(&self, spec: &BodyDef, until: f64) -> f64 {
        if let Some(drive) = &spec.drive
            && self.phase == Phase::Driven
        {
            return drive.fastest([self.path.t, until]);
        }
        if self.phase == Phase::Articulated {
            return self.cubic_turns(spec).fastest([0.0, until.min(self.expiry) - self.path.t]);
        }
        if spec.anisotropy == 0.0 || !self.turns_freely() {
            return self.spin.length();
        }
        spec.inertia.fastest(self.turn, self.spin, until - self.path.t)
    }

    /// Whether both take the same step of a time-stepped island.
    pub(super) fn shares_time_step_with(&self, other: &Self) -> bool {
        let step = |b: &Self| (b.time_step_island, b.path.t, b.expiry);
        self.time_step_island != 0 && step(self) == step(other)
    }

    /// Whether it touches nothing.
    pub(super) fn flies(&self) -> bool {
        matches!(self.phase, Phase::Flight | Phase::Leg)
    }

    /// The rotation of the current motion.
    pub(super) fn free_rotation(&self, spec: &BodyDef) -> FreeRotation {
        if let Some(drive) = &spec.drive
            && self.phase == Phase::Driven
        {
            drive.free_rotation(self.path.t)
        } else if self.phase == Phase::Articulated {
            FreeRotation::keyed(self.cubic_turns(spec), 0.0)
        } else if self.turns_freely() {
            FreeRotation::free(&spec.inertia, self.turn, self.spin, spec.turn_error)
        } else {
            FreeRotation::steady(self.turn, self.spin)
        }
    }

    /// Where it is at a time within its current motion, whose rotation this is.
    pub(super) fn pose_at(&self, spec: &BodyDef, rotation: &mut FreeRotation, time: f64) -> Pose {
        let dt = time - self.path.t;
        let r = rotation.at(dt);
        let w = rotation.spin().unwrap_or_else(|| self.drift_spin(spec, dt));
        Pose { x: self.path.after(dt), r, v: self.path.velocity_after(dt), w }
    }

    pub(super) fn advance(&mut self, spec: &BodyDef, time: f64) {
        if let Some(drive) = &spec.drive {
            return drive.follow(self, time);
        }
        let dt = time - self.path.t;
        // It is no event of the body when one leg follows another.
        self.chatter_events += u32::from(self.phase != Phase::Leg || time < self.expiry);
        if time - self.chatter_from > spec.rattle {
            (self.chatter_events, self.chatter_from) = (0, time);
        }
        if self.phase == Phase::Articulated {
            self.follow_cubic(spec, time);
        } else if dt != 0.0 {
            let x = self.path.after(dt);
            match self.phase {
                Phase::Flight => {
                    self.path.v = self.path.velocity_after(dt);
                    (self.turn, self.spin) = drift(&spec.inertia, self.turn, self.spin, dt);
                }
                Phase::Leg => self.follow_leg(spec, dt),
                Phase::Step => {
                    (self.turn, _) = self.stepped(spec, dt);
                    let now = if time >= self.expiry { self.ends[1] } else { self.within_step(spec, dt) };
                    self.ends[0] = now;
                    (self.path.v, self.spin) = (now.v, spec.inertia.spin(self.turn, now.l));
                    // The rest of the step is no longer straight in the same way; settling decides anew.
                    self.expiry = time;
                }
                Phase::Glide => {
                    let motion = self.motion_after(spec, dt);
                    // Only a picture of the ball needs its orientation, so the mean angular velocity is good enough.
                    self.turn = (rotation((self.spin + self.spin_rate * (0.5 * dt)) * dt) * self.turn).normalize();
                    (self.path.v, self.spin) = (motion.v, motion.w);
                }
                Phase::Waiting | Phase::Driven | Phase::Rest | Phase::Gone | Phase::Articulated => {}
            }
            self.path.x = x;
            self.path.t = time;
            if self.phase == Phase::Glide && time >= self.expiry {
                self.end_section(spec);
            }
        } else if matches!(self.phase, Phase::Step | Phase::Leg) {
            self.go_back(spec);
        }
    }

    /// Takes back the velocities that it had before its step or leg.
    pub(super) fn go_back(&mut self, spec: &BodyDef) {
        let now = self.ends[0];
        (self.path.v, self.spin) = (now.v, spec.inertia.spin(self.turn, now.l));
    }

    /// Whether so much has happened in so little time that its contacts count as lasting, however fast they part.
    pub(super) fn is_chattering(&self) -> bool {
        self.chatter_events > CHATTER_EVENTS
    }

    /// Gives the body velocities at its clock.
    pub(super) fn set_motion(&mut self, spec: &BodyDef, motion: Velocities) {
        (self.path.v, self.spin) = (motion.v, motion.w);
        self.ends[0] = Momentum { v: motion.v, l: spec.inertia.momentum(self.turn, motion.w) };
    }

    /// Starts a phase that lasts until something happens.
    pub(super) fn begin(&mut self, phase: Phase, a: DVec3) {
        self.phase = phase;
        (self.time_step_island, self.stays) = (0, false);
        self.path.a = a;
        self.expiry = NEVER;
    }

    /// Sleeps where it is.
    pub(super) fn lie_still(&mut self) {
        (self.path.v, self.spin) = (DVec3::ZERO, DVec3::ZERO);
        self.ends = [Momentum::default(); 2];
        self.begin(Phase::Rest, DVec3::ZERO);
    }

    pub(super) fn pose(&self) -> Pose {
        Pose { x: self.path.x, r: DMat3::from_quat(self.turn), v: self.path.v, w: self.spin }
    }
}
