//! Steps of trees of joints: the Runge–Kutta method of fifth order of Dormand and Prince (J. Comput. Appl. Math. 6
//! (1980)), whose error is known from a method of fourth order on the same slopes.
//!
//! What no step changes: energy, but for what springs and dampers give, and of a tree that hangs on nothing, momentum.
//! A step's error in them is taken back, so nothing creeps, however long a run is.
//!
//! The motion of a tree is that of a rigid body with its momentum, and one within the tree. The two share the kinetic
//! energy without a mixed term, and joints allow each by itself. So the first is made that of the start of the step,
//! and the second is scaled to the energy that is left. Where there is hardly any such motion, at a turning point, the
//! next steps give back what is missing.

use super::axis::Spring;
use super::dynamics::{Ask, LinkState};
use super::joint::JointRow;
use super::tree::{Freedom, JointTrees, Link, Parent};
use crate::rigid::step_poses::StepPoses;
use crate::rigid::tolerances::{ENERGY_SCALING, JOINT_VELOCITY_ERROR};
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DMat3, DQuat, DVec3};

/// Parts of the step at which slopes are taken.
const TIMES: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];

/// How the earlier slopes make each stage; the last is the end of the step.
const STAGES: [[f64; 6]; 7] = [
    [0.0; 6],
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// The difference of the method of fifth order from that of fourth.
const ERRORS: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Largest of `t (t − 1/2) (t − 1)` between 0 and 1.
const PARABOLA_ERROR: f64 = 0.048_112_522_432_468_82;

/// Error of an orientation on a cubic half way through a turn of one radian: half of it to the fourth over 384, twice.
const QUATERNION_ERROR: f64 = 1.0 / 3072.0;

/// The trees of an island in a step.
#[derive(Debug, Default)]
pub(crate) struct TreeStep {
    pub(crate) trees: JointTrees,
    /// The links at the start, and at the end.
    pub(crate) begin: Vec<LinkState>,
    pub(crate) end: Vec<LinkState>,
    /// Coordinates and rates at the start, within a stage, and at the end.
    y: Vec<f64>,
    trial: Vec<f64>,
    slopes: [Vec<f64>; 7],
    /// How far, over a body's size, an error of each coordinate or rate puts a point at most.
    weights: Vec<f64>,
    /// The least size of a body of the trees.
    pub(crate) size: f64,
}

impl TreeStep {
    /// Finds an island's trees, their state at the start of a step, and its slopes. Velocities that do not fit the
    /// joints are changed as by impulses there. Returns false if these are no trees.
    pub(crate) fn start(&mut self, world: &RigidWorld, places: &[StepPoses], rows: &[JointRow]) -> bool {
        if !self.trees.find(world, places, rows) {
            return false;
        }
        self.trees.read(places, &mut self.y);
        self.trees.place(world, places, &self.y, 0.0, &mut self.begin);
        if !self.fits(world, places) {
            self.trees.solve(world, places, Ask::Velocities, 0.0, &mut self.begin);
            self.trees.take_velocities(&self.begin, &mut self.y);
            self.trees.place(world, places, &self.y, 0.0, &mut self.begin);
        }
        self.trees.solve(world, places, Ask::Accelerations, 0.0, &mut self.begin);
        let n = self.y.len();
        self.slopes.iter_mut().for_each(|slope| slope.resize(n, 0.0));
        self.trees.slopes(&self.y, &self.begin, &mut self.slopes[0]);
        self.weigh(world, places);
        true
    }

    /// Whether the bodies move as their joints let them.
    fn fits(&self, world: &RigidWorld, places: &[StepPoses]) -> bool {
        let (mut off, mut fastest) = (0.0_f64, 0.0_f64);
        for (link, s) in self.trees.links.iter().zip(&self.begin) {
            let p = &places[link.place];
            let reach = world.specs[p.body].bounding_radius;
            let [v, w] = [s.velocity() - p.start.v, s.w - p.start.w];
            off = off.max(v.length_squared()).max(w.length_squared() * reach * reach);
            fastest = fastest.max(p.start.v.length_squared()).max(p.start.w.length_squared() * reach * reach);
        }
        off <= JOINT_VELOCITY_ERROR * JOINT_VELOCITY_ERROR * fastest
    }

    /// How fast the trees swing or turn, in 1/s.
    pub(crate) fn rate(&self, world: &RigidWorld) -> f64 {
        let links = self.trees.links.iter().zip(&self.begin);
        let square = |link: &Link| world.gravity_magnitude / link.reach;
        let swings = links.map(|(l, s)| s.w.length_squared().max(s.alpha.length()).max(square(l))).fold(0.0, f64::max);
        // A spring's rate of oscillation and a damper's of decay, if all else gave way; those of several add up.
        let springs = self.trees.links.iter().zip(&self.begin).filter_map(|(l, s)| Some((l.spring.as_ref()?, s.d)));
        let of = |(spring, d): (&Spring, f64)| spring.stiffness * d + spring.damping * d * (spring.damping * d);
        (swings + springs.map(of).sum::<f64>()).sqrt()
    }

    fn weigh(&mut self, world: &RigidWorld, places: &[StepPoses]) {
        self.size = places.iter().map(|p| world.specs[p.body].span).fold(f64::INFINITY, f64::min);
        let (rate, size) = (self.rate(world), self.size);
        let time = if rate > 0.0 { 1.0 / rate } else { 0.0 };
        self.weights.clear();
        self.weights.resize(self.y.len(), 0.0);
        for link in &self.trees.links {
            let [q, u] = [link.at[0], self.trees.counts[0] + link.at[1]];
            let far = link.reach / size;
            let mut set = |at: usize, count: usize, weight: f64| self.weights[at..at + count].fill(weight);
            match link.freedom {
                Freedom::All => {
                    set(q, 3, 1.0 / size);
                    set(q + 3, 4, 2.0 * far);
                    set(u, 3, time / size);
                    set(u + 3, 3, far * time);
                }
                Freedom::Axis { slides, .. } => {
                    let far = if slides { 1.0 / size } else { far };
                    set(q, 1, far);
                    set(u, 1, far * time);
                }
                Freedom::Ball => {
                    set(q, 4, 2.0 * far);
                    set(u, 3, far * time);
                }
                Freedom::Weld => {}
            }
        }
    }

    /// Takes a step of `h` seconds from the start; leaves the links at its end. If `wants_error`, returns its error in
    /// sizes.
    pub(crate) fn go(&mut self, world: &RigidWorld, places: &[StepPoses], h: f64, wants_error: bool) -> f64 {
        let n = self.y.len();
        self.trial.resize(n, 0.0);
        for stage in 1..7 {
            let (weights, (earlier, later)) = (&STAGES[stage], self.slopes.split_at_mut(stage));
            for (i, trial) in self.trial.iter_mut().enumerate() {
                let sum: f64 = weights.iter().zip(&*earlier).map(|(weight, slope)| weight * slope[i]).sum();
                *trial = self.y[i] + h * sum;
            }
            let t = TIMES[stage] * h;
            self.trees.place(world, places, &self.trial, t, &mut self.end);
            if stage < 6 || wants_error {
                self.trees.solve(world, places, Ask::Accelerations, t, &mut self.end);
                self.trees.slopes(&self.trial, &self.end, &mut later[0]);
            }
        }
        if !wants_error {
            return 0.0;
        }
        let off = |i: usize| ERRORS.iter().zip(&self.slopes).map(|(weight, slope)| weight * slope[i]).sum::<f64>();
        (0..n).map(|i| (h * off(i) * self.weights[i]).abs()).fold(0.0, f64::max)
    }

    /// How far, in sizes, a parabola through the start, the middle and the end of the step is from the cubics that the
    /// bodies follow; at least how far turning takes their points from their cubics.
    pub(crate) fn bend(&self, world: &RigidWorld, places: &[StepPoses], h: f64) -> f64 {
        let mut worst = 0.0_f64;
        for (link, (s, e)) in self.trees.links.iter().zip(self.begin.iter().zip(&self.end)) {
            let centre = ((s.x() - e.x()) * 2.0 + (s.velocity() + e.velocity()) * h).length() * PARABOLA_ERROR;
            let turn = s.w.length_squared().max(e.w.length_squared()) * (h * h);
            let skin = world.specs[places[link.place].body].bounding_radius * turn * turn * QUATERNION_ERROR;
            worst = worst.max(centre).max(skin);
        }
        worst / self.size
    }

    /// What springs and dampers have given these links since the start of the step, in J.
    pub(super) fn given(&self, links: std::ops::Range<usize>) -> f64 {
        let of = |link: &Link| {
            let Some(Spring { stiffness, rest, damping }) = link.spring else { return 0.0 };
            let [q, left] = [self.trial[link.at[0]], rest - self.trial[link.at[0]]];
            let work = if damping > 0.0 { self.trial[link.at[0] + 1] } else { 0.0 };
            0.5 * stiffness * q * (rest + left) + work
        };
        self.trees.links[links].iter().map(of).sum()
    }

    /// What the coordinate of a hinge or slider has grown by since the start of the step, and its rate, at the start
    /// and at the end.
    pub(crate) fn about(&self, joint: usize) -> Option<[[f64; 2]; 2]> {
        let link = self.trees.links.iter().find(|link| link.joint.is_some_and(|j| j.0 == joint))?;
        let sign = link.joint?.1;
        let of = |y: &[f64]| [y[link.at[0]] * sign, y[self.trees.counts[0] + link.at[1]] * sign];
        Some([of(&self.y), of(&self.trial)])
    }
}

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
