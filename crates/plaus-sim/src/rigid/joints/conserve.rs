//! What no step changes: energy, but for what springs and dampers give, and of a tree that hangs on nothing, momentum.
//! A step's error in them is taken back, so nothing creeps, however long a run is.
//!
//! The motion of a tree is that of a rigid body with its momentum, and one within the tree. The two share the kinetic
//! energy without a mixed term, and joints allow each by itself. So the first is made that of the start of the step,
//! and the second is scaled to the energy that is left. Where there is hardly any such motion, at a turning point, the
//! next steps give back what is missing.

use super::dynamics::LinkState;
use super::runge_kutta::TreeStep;
use super::tree::{Link, Parent};
use crate::rigid::step_poses::StepPoses;
use crate::rigid::tolerances::ENERGY_SCALING;
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DMat3, DQuat, DVec3};

/// Place and motion of a link's centre of gravity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyMotion {
    pub(crate) x: DVec3,
    pub(crate) turn: DQuat,
    pub(crate) v: DVec3,
    pub(crate) w: DVec3,
}

impl BodyMotion {
    pub(crate) fn of(s: &LinkState) -> Self {
        Self { x: s.x(), turn: s.turn.normalize(), v: s.velocity(), w: s.w }
    }
}

/// Sums over the bodies of a tree.
struct Totals {
    mass: f64,
    x: DVec3,
    v: DVec3,
    kinetic: f64,
    potential: f64,
}

impl Totals {
    fn of(specs: &[&BodyDef], bodies: &[BodyMotion]) -> Self {
        let mut all = Self { mass: 0.0, x: DVec3::ZERO, v: DVec3::ZERO, kinetic: 0.0, potential: 0.0 };
        for (spec, b) in specs.iter().zip(bodies) {
            all.mass += spec.mass;
            all.x += b.x * spec.mass;
            all.v += b.v * spec.mass;
            all.kinetic += kinetic(spec, b);
            all.potential -= spec.mass * spec.gravity.dot(b.x);
        }
        (all.x, all.v) = (all.x / all.mass, all.v / all.mass);
        all
    }

    /// Angular momentum about the centre of gravity.
    fn angular(&self, specs: &[&BodyDef], bodies: &[BodyMotion]) -> DVec3 {
        let of = |(spec, b): (&&BodyDef, &BodyMotion)| {
            spec.inertia.momentum(b.turn, b.w) + (b.x - self.x).cross(b.v - self.v) * spec.mass
        };
        specs.iter().zip(bodies).map(of).sum()
    }

    /// The inverse of the moments of inertia about the centre of gravity, with all joints locked.
    fn locked(&self, specs: &[&BodyDef], bodies: &[BodyMotion]) -> DMat3 {
        let mut all = DMat3::ZERO;
        for (spec, b) in specs.iter().zip(bodies) {
            let (r, m) = (b.x - self.x, spec.mass);
            let far = DMat3::from_diagonal(DVec3::splat(r.length_squared()));
            all += super::tree::turned(b.turn, spec.inertia.moments).1;
            all += (far - DMat3::from_cols(r * r.x, r * r.y, r * r.z)) * m;
        }
        all.inverse()
    }
}

fn kinetic(spec: &BodyDef, b: &BodyMotion) -> f64 {
    0.5 * (spec.mass * b.v.length_squared() + b.w.dot(spec.inertia.momentum(b.turn, b.w)))
}

impl TreeStep {
    /// Where the links are after a step of `h` seconds, with energy and momentum as at its start. `debts` are the
    /// energies that each body's earlier steps have not given back, and then those that are left.
    pub(crate) fn ends(&self, world: &RigidWorld, places: &[StepPoses], h: f64, debts: &mut [f64]) -> Vec<BodyMotion> {
        let mut ends: Vec<BodyMotion> = self.end.iter().map(BodyMotion::of).collect();
        let starts: Vec<BodyMotion> = self.begin.iter().map(BodyMotion::of).collect();
        let spec = |link: &Link| &world.specs[places[link.place].body];
        let specs: Vec<&BodyDef> = self.trees.links.iter().map(spec).collect();
        let mut from = 0;
        while from < ends.len() {
            let is_root = |link: &Link| !matches!(link.parent, Parent::Link(_));
            let rest = self.trees.links[from + 1..].iter();
            let until = from + 1 + rest.take_while(|link| !is_root(link)).count();
            let is_moved = match self.trees.links[from].parent {
                Parent::Driven(k) => {
                    let p = &places[k];
                    !world.specs[p.body].drive.as_ref().is_some_and(|drive| drive.is_still(p.clock))
                }
                _ => false,
            };
            let specs = &specs[from..until];
            let debt = debts[from..until].iter().sum::<f64>() + self.given(from..until);
            debts[from..until].fill(0.0);
            if !is_moved && specs.iter().all(|spec| spec.damping.is_none()) {
                let is_free = self.trees.links[from].parent == Parent::Nothing;
                debts[from] = keep(specs, &starts[from..until], &mut ends[from..until], is_free, (h, debt));
            }
            from = until;
        }
        ends
    }
}

/// Gives a tree the energy of the start of its step of `h` seconds, and what earlier steps owe; one that hangs on
/// nothing its momentum too. Returns the energy that is still missing.
fn keep(
    specs: &[&BodyDef],
    starts: &[BodyMotion],
    ends: &mut [BodyMotion],
    is_free: bool,
    (h, debt): (f64, f64),
) -> f64 {
    let before = Totals::of(specs, starts);
    let mut after = Totals::of(specs, ends);
    // The motion as of one rigid body: velocity of its centre of gravity and angular velocity, as found and as it is to
    // be.
    let (mut found, mut wanted, mut rigid) = ([DVec3::ZERO; 2], [DVec3::ZERO; 2], 0.0);
    if is_free {
        let g = specs[0].gravity;
        let is_even = specs.iter().all(|spec| spec.gravity == g);
        let mut momenta = [after.angular(specs, ends); 2];
        if is_even {
            let shift = before.x + (before.v + g * (0.5 * h)) * h - after.x;
            ends.iter_mut().for_each(|b| b.x += shift);
            after.x += shift;
            after.potential -= after.mass * g.dot(shift);
            momenta[1] = before.angular(specs, starts);
        }
        let inverse = after.locked(specs, ends);
        let v = if is_even { before.v + g * h } else { after.v };
        (found, wanted) = ([after.v, inverse * momenta[0]], [v, inverse * momenta[1]]);
        rigid = 0.5 * (after.mass * v.length_squared() + momenta[1].dot(wanted[1]));
    }
    for b in &mut *ends {
        b.v -= found[0] + found[1].cross(b.x - after.x);
        b.w -= found[1];
    }
    let within: f64 = specs.iter().zip(&*ends).map(|(spec, b)| kinetic(spec, b)).sum();
    let left = before.kinetic + before.potential + debt - after.potential - rigid;
    let scale = if within > ENERGY_SCALING * ENERGY_SCALING * (before.kinetic + rigid) {
        (left / within).max(0.0).sqrt().clamp(1.0 - ENERGY_SCALING, 1.0 + ENERGY_SCALING)
    } else {
        1.0
    };
    for b in ends {
        b.v = b.v * scale + wanted[0] + wanted[1].cross(b.x - after.x);
        b.w = b.w * scale + wanted[1];
    }
    left - within * scale * scale
}
