//! One marble: what it is, and how it moves now.

use crate::error::WorldError;
use crate::material::Material;
use crate::motion::Parabola;
use crate::scenery::Surface;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The constant properties of a marble.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MarbleSpec {
    /// Radius in m.
    pub radius: f64,
    /// Mass in kg.
    pub mass: f64,
    /// Inertia over mass × radius²: 2/5 for a solid sphere, 2/3 for a thin shell.
    pub gyration: f64,
    /// What it is made of.
    pub material: Material,
}

impl MarbleSpec {
    /// A solid sphere.
    #[must_use]
    pub const fn solid(radius: f64, mass: f64, material: Material) -> Self {
        Self { radius, mass, gyration: 0.4, material }
    }

    pub(crate) fn check(&self, body: usize) -> Result<(), WorldError> {
        for (field, value) in [("radius", self.radius), ("mass", self.mass), ("gyration", self.gyration)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(WorldError::BadBody { body, field, value, expected: "a positive, finite number" });
            }
        }
        Ok(())
    }
}

/// How a marble starts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Centre in m.
    pub position: DVec3,
    /// Velocity in m/s.
    pub velocity: DVec3,
    /// Angular velocity in rad/s.
    pub spin: DVec3,
    /// When it is released, in s; before that it is not there.
    pub time: f64,
}

impl Start {
    /// Released at rest at time 0.
    #[must_use]
    pub const fn at_rest(position: DVec3) -> Self {
        Self { position, velocity: DVec3::ZERO, spin: DVec3::ZERO, time: 0.0 }
    }

    pub(crate) fn check(&self, body: usize) -> Result<(), WorldError> {
        let bad = |field, value| Err(WorldError::BadBody { body, field, value, expected: "a finite number" });
        for (field, v) in [("position", self.position), ("velocity", self.velocity), ("spin", self.spin)] {
            if let Some(k) = (0..3).find(|&k| !v[k].is_finite()) {
                return bad(field, v[k]);
            }
        }
        if !(self.time >= 0.0 && self.time.is_finite()) {
            return Err(WorldError::BadBody {
                body,
                field: "start time",
                value: self.time,
                expected: "a finite time ≥ 0",
            });
        }
        Ok(())
    }
}

/// How a marble moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Phase {
    /// Not released yet.
    Waiting,
    /// Free flight.
    Flight,
    /// Slipping over a plane.
    Slide,
    /// Rolling on a plane.
    Roll,
    /// Turning on the spot.
    Spin,
    /// Within a step of lasting contact.
    Step,
    /// At rest until something hits it.
    Rest,
}

/// What happens at the end of a closed form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Ending {
    /// Nothing in particular.
    Plain,
    /// Slip is gone: it rolls.
    Rolls,
    /// The centre has stopped.
    Stops,
    /// The contact point reaches this side of its triangle.
    Leaves(u8),
}

/// Maximum number of surfaces that one marble can be in lasting contact with; it bounces off further ones.
pub(crate) const MOST_CONTACTS: usize = 8;

/// A marble's state: a parabola, a spin that changes linearly, and its lasting contacts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Marble {
    /// Motion of the centre.
    pub path: Parabola,
    /// Angular velocity at the path's clock, in rad/s.
    pub spin: DVec3,
    /// Angular acceleration in rad/s².
    pub spin_rate: DVec3,
    /// How it moves.
    pub phase: Phase,
    /// When the closed form ends by itself, in s.
    pub(crate) expiry: f64,
    pub(crate) ending: Ending,
    /// Normal of the contact of a slide, roll or spin.
    pub(crate) normal: DVec3,
    /// Rate at which the spin about the normal dies, in rad/s².
    pub(crate) drill: f64,
    /// Velocity at the end of a step.
    pub(crate) end_velocity: DVec3,
    /// When it last hit something, and how many impacts came in quick succession.
    last_impact: f64,
    rattles: u8,
    contacts: [Surface; MOST_CONTACTS],
    count: u8,
}

/// An expiry that never comes; finite, so that every format can hold a state.
const NEVER: f64 = f64::MAX;

/// After this many impacts in a row, each within [`Accuracy::rattle`](crate::Accuracy) of the previous one, further
/// ones are plastic. Default 40: more than a row of touching balls makes at once, so that only a collapse with
/// infinitely many impacts in finite time is cut short.
const RATTLES: u8 = 40;

impl Marble {
    /// A marble that waits for its release.
    #[must_use]
    pub fn waiting(start: &Start) -> Self {
        Self {
            path: Parabola { t: start.time, x: start.position, v: start.velocity, a: DVec3::ZERO },
            spin: start.spin,
            spin_rate: DVec3::ZERO,
            phase: Phase::Waiting,
            expiry: start.time,
            ending: Ending::Plain,
            normal: DVec3::ZERO,
            drill: 0.0,
            end_velocity: DVec3::ZERO,
            last_impact: start.time,
            rattles: 0,
            contacts: [Surface::Plane(0); MOST_CONTACTS],
            count: 0,
        }
    }

    /// Surfaces in lasting contact.
    #[inline]
    #[must_use]
    pub fn contacts(&self) -> &[Surface] {
        &self.contacts[..usize::from(self.count)]
    }

    /// All room for contacts; only the first ones are valid.
    pub(super) fn contacts_in_full(&self) -> &[Surface; MOST_CONTACTS] {
        &self.contacts
    }

    /// Adds a lasting contact; false if there is no room left.
    pub(crate) fn add_contact(&mut self, surface: Surface) -> bool {
        if self.contacts().contains(&surface) {
            return true;
        }
        let fits = usize::from(self.count) < MOST_CONTACTS;
        if fits {
            self.contacts[usize::from(self.count)] = surface;
            self.count += 1;
        }
        fits
    }

    /// Keeps the contacts for which `keep` returns what they have become.
    pub(crate) fn revise_contacts(&mut self, mut keep: impl FnMut(Surface) -> Option<Surface>) {
        let old = self.contacts;
        let count = usize::from(self.count);
        self.count = 0;
        for surface in &old[..count] {
            if let Some(surface) = keep(*surface) {
                self.add_contact(surface);
            }
        }
    }

    /// Notes an impact now; it counts as in quick succession if the last one was at most `rattle` ago.
    pub(crate) fn note_impact(&mut self, rattle: f64) {
        self.rattles = if self.path.t - self.last_impact <= rattle { self.rattles.saturating_add(1) } else { 0 };
        self.last_impact = self.path.t;
    }

    /// Whether it was hit at its present time.
    #[inline]
    pub(crate) fn was_hit(&self) -> bool {
        self.path.t == self.last_impact
    }

    /// Whether it rattles: further impacts whose law takes energy are plastic.
    #[inline]
    pub(crate) fn rattles(&self) -> bool {
        self.rattles >= RATTLES
    }

    /// A motion that ends only when something happens to it.
    pub(crate) fn begin(&mut self, phase: Phase, acceleration: DVec3) {
        self.path.a = acceleration;
        self.spin_rate = DVec3::ZERO;
        self.phase = phase;
        self.expiry = NEVER;
        self.ending = Ending::Plain;
        self.drill = 0.0;
    }

    /// Moves to `time`, along the closed form.
    #[inline]
    pub(crate) fn advance(&mut self, time: f64) {
        let dt = time - self.path.t;
        if self.phase == Phase::Step {
            // The velocity of a step is linear between its ends, whatever correction its path carries.
            let whole = self.expiry - self.path.t;
            let part = if time >= self.expiry { 1.0 } else { dt / whole };
            let v = self.path.v + (self.end_velocity - self.path.v) * part;
            self.path.x = self.path.after(dt);
            self.path.v = v;
        } else {
            self.path.x = self.path.after(dt);
            self.path.v = self.path.velocity_after(dt);
        }
        self.spin += self.spin_rate * dt;
        if self.drill > 0.0 {
            let about = self.spin.dot(self.normal);
            let left = (about.abs() - self.drill * dt).max(0.0).copysign(about);
            self.spin += self.normal * (left - about);
        }
        self.path.t = time;
        if time >= self.expiry {
            self.finish();
        }
    }

    /// Sets exactly what holds at the end of a closed form.
    fn finish(&mut self) {
        if self.ending == Ending::Stops {
            self.path.v = DVec3::ZERO;
            self.spin = self.normal * self.spin.dot(self.normal);
        }
    }
}
