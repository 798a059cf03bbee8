//! The moving state of a turning body.

use super::tumble::{Tumble, drift};
use super::{Rigid, Spec};
use crate::motion::Parabola;
use crate::scenery::Surface;
use glam::{DMat3, DQuat, DVec3};
use serde::{Deserialize, Serialize};

/// Where a body starts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Centre of gravity in m.
    pub position: DVec3,
    /// Turns body axes into world axes.
    pub orientation: DQuat,
    /// In m/s.
    pub velocity: DVec3,
    /// Angular velocity in rad/s, in world axes.
    pub spin: DVec3,
    /// When the body appears, in s.
    pub time: f64,
}

impl Start {
    /// At rest and upright at a point at time 0.
    #[must_use]
    pub fn at_rest(position: DVec3) -> Self {
        Self { position, orientation: DQuat::IDENTITY, velocity: DVec3::ZERO, spin: DVec3::ZERO, time: 0.0 }
    }
}

/// What kind of motion a body is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Not released yet.
    Waiting,
    /// Free flight: a parabola and free rotation.
    Flight,
    /// A step of lasting contact: straight, at constant angular velocity.
    Step,
    /// A ball slides or rolls on level ground: a parabola, and an angular velocity that changes evenly.
    Glide,
    /// At rest until something hits it.
    Rest,
    /// Fallen below the world's sink: it takes no further part.
    Gone,
}

/// Velocities of a body.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Motion {
    pub(crate) v: DVec3,
    pub(crate) w: DVec3,
}

/// Most points of a body that may touch fixed parts at once; those beyond are left out. A cuboid in a corner has 7.
pub(crate) const MOST_TOUCHES: usize = 16;

/// A turning body with the closed form of its current motion.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Turning {
    /// Motion of the centre of gravity.
    pub path: Parabola,
    /// Orientation at the clock: turns body axes into world axes.
    pub turn: DQuat,
    /// Angular velocity at the clock in rad/s, in world axes; constant over a step.
    pub spin: DVec3,
    /// Kind of motion.
    pub phase: Phase,
    pub(crate) expiry: f64,
    /// Rate of the angular velocity of a ball that glides, in rad/s².
    pub(crate) spin_rate: DVec3,
    /// Whether it rolls when its slide ends.
    pub(crate) rolls_after: bool,
    /// The line that a ball's centre reaches at the end of its stretch: axis and place.
    pub(crate) line: Option<(u8, f64)>,
    /// Velocities at the start and the end of a step.
    pub(crate) ends: [Motion; 2],
    /// Velocities of the drift of the step that was interrupted last.
    drifted: Motion,
    /// Events since `hurried_from`, all within `accuracy.rattle`.
    hurried: u32,
    hurried_from: f64,
    /// Points that touch fixed parts at the clock.
    touching: [Surface; MOST_TOUCHES],
    touching_count: u8,
    /// Forces in N at the first of the points that a step was made with: where the next begins to look.
    loads: [DVec3; MOST_LOADS],
    /// The clock at which `touching` was found.
    pub(crate) listed: f64,
}

/// Events within the window from which contacts last. Default 16: no chain of real bounces of one body is so fast.
const MOST_HURRIED: u32 = 16;

/// Points whose forces are kept: those of a die on a face.
pub(crate) const MOST_LOADS: usize = 4;

/// A time that never comes; finite, so that every format can hold a state.
pub(crate) const NEVER: f64 = f64::MAX;

const NOWHERE: Surface = Surface::Part { part: u16::MAX, point: u16::MAX };

impl Turning {
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
            ends: [Motion::default(); 2],
            drifted: Motion::default(),
            hurried: 0,
            hurried_from: -NEVER,
            touching: [NOWHERE; MOST_TOUCHES],
            touching_count: 0,
            loads: [DVec3::ZERO; MOST_LOADS],
            listed: -NEVER,
        }
    }

    /// Points that touch fixed parts.
    #[must_use]
    pub fn touching(&self) -> &[Surface] {
        &self.touching[..usize::from(self.touching_count)]
    }

    /// The force at a point at the end of the last step, if it was among those kept.
    pub(super) fn load(&self, surface: Surface) -> DVec3 {
        let at = self.touching().iter().take(MOST_LOADS).position(|&s| s == surface);
        at.filter(|_| self.phase == Phase::Step).map_or(DVec3::ZERO, |k| self.loads[k])
    }

    pub(super) fn set_loads(&mut self, forces: impl Iterator<Item = DVec3>) {
        self.loads = [DVec3::ZERO; MOST_LOADS];
        for (load, force) in self.loads.iter_mut().zip(forces) {
            *load = force;
        }
    }

    pub(super) fn list(&mut self, surfaces: impl Iterator<Item = Surface>) {
        self.touching_count = 0;
        for s in surfaces.take(MOST_TOUCHES) {
            self.touching[usize::from(self.touching_count)] = s;
            self.touching_count += 1;
        }
    }

    /// Velocities `dt` after the clock.
    pub(super) fn motion_after(&self, spec: &Spec, dt: f64) -> Motion {
        match self.phase {
            Phase::Flight => {
                Motion { v: self.path.velocity_after(dt), w: drift(&spec.inertia, self.turn, self.spin, dt).1 }
            }
            Phase::Step => {
                let part = (dt / (self.expiry - self.path.t)).clamp(0.0, 1.0);
                let [a, b] = self.ends;
                Motion { v: a.v.lerp(b.v, part), w: a.w.lerp(b.w, part) }
            }
            Phase::Glide => Motion { v: self.path.velocity_after(dt), w: self.spin + self.spin_rate * dt },
            Phase::Waiting | Phase::Rest | Phase::Gone => Motion { v: self.path.v, w: self.spin },
        }
    }

    /// Velocities within a step: between those of its ends, and with no more energy than lies between those of its ends.
    fn within_step(&self, spec: &Spec, gravity: DVec3, dt: f64) -> Motion {
        let h = self.expiry - self.path.t;
        let (part, m) = ((dt / h).clamp(0.0, 1.0), self.motion_after(spec, dt));
        let turned = |dt: f64| drift_steadily(self.turn, self.spin, dt).0;
        let kinetic = |turn: DQuat, m: &Motion| {
            0.5 * (spec.mass * m.v.length_squared() + m.w.dot(spec.inertia.momentum(turn, m.w)))
        };
        let fallen = spec.mass * gravity.dot(self.path.v);
        let (first, last) = (kinetic(self.turn, &self.ends[0]), kinetic(turned(h), &self.ends[1]) - fallen * h);
        let allowed = (first + (last - first) * part + fallen * dt).max(0.0);
        let now = kinetic(turned(dt), &m);
        if now <= allowed {
            return m;
        }
        let slower = (allowed / now).sqrt();
        Motion { v: m.v * slower, w: m.w * slower }
    }

    /// The rotation of the current motion.
    pub(super) fn tumble(&self, spec: &Spec) -> Tumble {
        match self.phase {
            Phase::Flight => Tumble::free(&spec.inertia, self.turn, self.spin),
            _ => Tumble::steady(self.turn, self.spin),
        }
    }

    pub(super) fn advance(&mut self, spec: &Spec, gravity: DVec3, time: f64) {
        let dt = time - self.path.t;
        self.hurried += 1;
        if time - self.hurried_from > spec.rattle {
            (self.hurried, self.hurried_from) = (0, time);
        }
        if self.phase == Phase::Step {
            self.drifted = Motion { v: self.path.v, w: self.spin };
        }
        if dt != 0.0 {
            let x = self.path.after(dt);
            match self.phase {
                Phase::Flight => {
                    self.path.v = self.path.velocity_after(dt);
                    (self.turn, self.spin) = drift(&spec.inertia, self.turn, self.spin, dt);
                }
                Phase::Step => {
                    let motion = if time >= self.expiry { self.ends[1] } else { self.within_step(spec, gravity, dt) };
                    (self.turn, _) = drift_steadily(self.turn, self.spin, dt);
                    self.ends[0] = motion;
                    (self.path.v, self.spin) = (motion.v, motion.w);
                    // What is left of the step is no longer straight in the same way; settling decides anew.
                    self.expiry = time;
                }
                Phase::Glide => {
                    let motion = self.motion_after(spec, dt);
                    // Only a picture of the ball needs its orientation: the mean angular velocity will do.
                    (self.turn, _) = drift_steadily(self.turn, self.spin + self.spin_rate * (0.5 * dt), dt);
                    (self.path.v, self.spin) = (motion.v, motion.w);
                }
                Phase::Waiting | Phase::Rest | Phase::Gone => {}
            }
            self.path.x = x;
            self.path.t = time;
            if self.phase == Phase::Glide && time >= self.expiry {
                super::glide::end(spec, gravity, self);
            }
        } else if self.phase == Phase::Step {
            let motion = self.ends[0];
            (self.path.v, self.spin) = (motion.v, motion.w);
        }
    }

    /// Whether so much has happened within so little time that its contacts are to last, however fast they part.
    pub(super) fn is_hurried(&self) -> bool {
        self.hurried > MOST_HURRIED
    }

    /// A contact was found on the drift of an interrupted step, but the step's velocities at this time, which lie between those of its ends, do not approach: the body takes the
    /// drift's velocities then. What energy that adds is taken back after the impact, by [`slow_down`](Self::slow_down).
    pub(super) fn take_drift(&mut self) {
        if self.phase == Phase::Step {
            self.set_motion(self.drifted);
        }
    }

    pub(super) fn set_motion(&mut self, motion: Motion) {
        (self.path.v, self.spin) = (motion.v, motion.w);
        self.ends[0] = motion;
    }

    /// Twice the kinetic energy at the clock.
    pub(super) fn vigour(&self, spec: &Spec) -> f64 {
        spec.mass * self.path.v.length_squared() + self.spin.dot(spec.inertia.momentum(self.turn, self.spin))
    }

    /// Scales the velocities.
    pub(super) fn slow_down(&mut self, part: f64) {
        self.set_motion(Motion { v: self.path.v * part, w: self.spin * part });
    }

    /// Starts a phase that lasts until something happens.
    pub(super) fn begin(&mut self, phase: Phase, a: DVec3) {
        self.phase = phase;
        self.path.a = a;
        self.expiry = NEVER;
    }

    pub(super) fn pose(&self) -> Pose {
        Pose { x: self.path.x, r: DMat3::from_quat(self.turn), v: self.path.v, w: self.spin }
    }
}

fn drift_steadily(turn: DQuat, w: DVec3, dt: f64) -> (DQuat, DVec3) {
    ((super::tumble::rotation(w * dt) * turn).normalize(), w)
}

/// Place and velocities at one time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pose {
    pub(crate) x: DVec3,
    pub(crate) r: DMat3,
    pub(crate) v: DVec3,
    pub(crate) w: DVec3,
}

impl Pose {
    /// Velocity of the body's point at `offset` from the centre of gravity.
    #[inline]
    pub(crate) fn velocity(&self, offset: DVec3) -> DVec3 {
        self.v + self.w.cross(offset)
    }
}

impl Rigid {
    /// Place, orientation and velocities of a body at any time within its current motion.
    #[must_use]
    pub fn at(&self, index: usize, body: &Turning, time: f64) -> Turning {
        let mut moved = body.clone();
        moved.advance(&self.specs[index], self.gravity, time);
        moved
    }
}
