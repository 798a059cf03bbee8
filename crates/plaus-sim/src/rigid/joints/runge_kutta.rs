//! Steps of trees of joints: the Runge–Kutta method of fifth order of Dormand and Prince (J. Comput. Appl. Math. 6
//! (1980)), whose error is known from a method of fourth order on the same slopes.

use super::axis::Spring;
use super::dynamics::{Ask, LinkState};
use super::joint::JointRow;
use super::tree::{Freedom, JointTrees, Link};
use crate::rigid::RigidWorld;
use crate::rigid::step_poses::StepPoses;
use crate::rigid::tolerances::JOINT_VELOCITY_ERROR;

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
