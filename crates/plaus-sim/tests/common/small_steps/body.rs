//! One body over a level floor at height 0: corners, sharp or rounded, and rings.

use super::impact::{friction_of, impulse};
use glam::{DMat2, DMat3, DQuat, DVec3};

/// The parts of a body that can touch a floor, each at its lowest point. On a ring or a ball this is not always the
/// same point of the body. But the velocity there is that of the body, and the height changes accordingly.
#[derive(Debug, Clone, Copy)]
pub enum Knob {
    /// Centre relative to the centre of gravity, in the body's axes, and radius; 0 for a sharp corner.
    Ball(DVec3, f64),
    /// About the body's z axis: height over the centre of gravity, radius of the circle, radius of the section.
    Ring(f64, f64, f64),
}

impl Knob {
    /// From the centre of gravity to the lowest point, in world axes.
    pub fn arm(&self, r: &DMat3) -> DVec3 {
        match *self {
            Self::Ball(centre, radius) => *r * centre - DVec3::Z * radius,
            Self::Ring(height, circle, radius) => {
                let axis = r.z_axis;
                // Across the axis and downwards; any such direction if the axis is upright.
                let down = (axis * axis.z - DVec3::Z).normalize_or(r.x_axis);
                axis * height + down * circle - DVec3::Z * radius
            }
        }
    }

    fn reach(&self) -> f64 {
        match *self {
            Self::Ball(centre, radius) => centre.length() + radius,
            Self::Ring(height, circle, radius) => (height * height + circle * circle).sqrt() + radius,
        }
    }
}

/// The constant properties.
#[derive(Debug, Clone)]
pub struct Solid {
    pub mass: f64,
    pub inertia: DVec3,
    pub knobs: Vec<Knob>,
    pub friction: f64,
    pub restitution: f64,
    pub gravity: DVec3,
}

/// Place and momentum.
#[derive(Debug, Clone, Copy)]
pub struct State {
    pub time: f64,
    pub x: DVec3,
    pub turn: DQuat,
    pub v: DVec3,
    /// Angular momentum about the centre of gravity, in world axes.
    pub spin: DVec3,
}

/// A run in steps of one length.
#[derive(Debug)]
pub struct Run<'s> {
    solid: &'s Solid,
    pub state: State,
    /// Impulses at the corners in the last step: the initial guess for the next one.
    loads: Vec<DVec3>,
    closed: Vec<bool>,
    /// Rebound speed below which a corner stays, in m/s.
    pub settle: f64,
    /// Distance up to which a corner counts as on the floor, in m.
    touch: f64,
    pub impacts: u64,
}

/// Rebound speed below which a corner stays, over √(g·size): thirty times less than at the simulator's finest preset.
const SETTLE: f64 = 1e-5;

/// Maximum number of sweeps of a step, and the change of impulse over the weight's at which they end.
const SWEEPS: usize = 400;
const CHANGE: f64 = 1e-11;

/// Speed over √(g·size) below which a body that its corners carry is left where it is: the error of the sweeps.
const STILL: f64 = 1e-9;

impl<'s> Run<'s> {
    pub fn new(solid: &'s Solid, state: State) -> Self {
        let size = solid.knobs.iter().map(Knob::reach).fold(0.0, f64::max);
        let n = solid.knobs.len();
        let settle = SETTLE * (solid.gravity.length() * size).sqrt();
        let mut run = Self {
            solid,
            state,
            loads: vec![DVec3::ZERO; n],
            closed: vec![false; n],
            settle,
            touch: 1e-9 * size,
            impacts: 0,
        };
        run.close();
        run
    }

    fn inverse_inertia(&self, turn: DQuat) -> DMat3 {
        let r = DMat3::from_quat(turn);
        r * DMat3::from_diagonal(1.0 / self.solid.inertia) * r.transpose()
    }

    pub fn angular_velocity(&self) -> DVec3 {
        self.inverse_inertia(self.state.turn) * self.state.spin
    }

    /// Goes on until a time.
    pub fn go(&mut self, until: f64, dt: f64) {
        while self.state.time < until - 1e-3 * dt {
            if self.is_still() {
                self.state.time = until;
                break;
            }
            self.step(dt.min(until - self.state.time));
        }
    }

    fn is_still(&self) -> bool {
        let speed = self.state.v.length() + self.angular_velocity().length() * self.touch * 1e9;
        let limit = STILL / SETTLE * self.settle;
        self.closed.iter().filter(|c| **c).count() > 2 && speed < limit
    }

    /// One step, cut short if a corner comes down.
    fn step(&mut self, dt: f64) {
        let before = (self.state, self.loads.clone(), self.closed.clone());
        let again = |run: &mut Self, dt: f64| {
            run.state = before.0;
            run.loads.clone_from(&before.1);
            run.closed.clone_from(&before.2);
            run.advance(dt);
            run.opening()
        };
        if !again(self, dt) {
            return;
        }
        let (mut low, mut high) = (0.0, dt);
        while high - low > 1e-13 {
            let middle = 0.5 * (low + high);
            if again(self, middle) { high = middle } else { low = middle }
        }
        again(self, high);
        self.collide();
    }

    /// Whether a corner that was not on the floor is now below it and moving down.
    fn opening(&self) -> bool {
        let r = DMat3::from_quat(self.state.turn);
        let inverse = self.inverse_inertia(self.state.turn);
        (0..self.solid.knobs.len()).filter(|&k| !self.closed[k]).any(|k| {
            let arm = self.solid.knobs[k].arm(&r);
            self.state.x.z + arm.z < 0.0 && self.velocity(&inverse, arm).z < 0.0
        })
    }

    /// Moreau's step over the closed corners.
    fn advance(&mut self, dt: f64) {
        let (s, solid) = (self.state, self.solid);
        let r = DMat3::from_quat(s.turn);
        let inverse = self.inverse_inertia(s.turn);
        let mut now = Velocity { v: s.v + solid.gravity * dt, spin: s.spin };
        let points: Vec<(usize, DVec3, DMat3)> = (0..solid.knobs.len())
            .filter(|&k| self.closed[k])
            .map(|k| (k, solid.knobs[k].arm(&r)))
            .map(|(k, arm)| (k, arm, response(solid.mass, &inverse, arm)))
            .collect();
        for (k, arm, _) in &points {
            now.push(solid.mass, *arm, self.loads[*k]);
        }
        for _ in 0..SWEEPS {
            let mut change = 0.0_f64;
            for (k, arm, response) in &points {
                let u = now.at(&inverse, *arm);
                let old = self.loads[*k];
                let new = project(response, u, old, solid.friction);
                now.push(solid.mass, *arm, new - old);
                self.loads[*k] = new;
                change = change.max((new - old).length());
            }
            if change <= CHANGE * solid.mass * solid.gravity.length() * dt {
                break;
            }
        }
        let mean = if points.is_empty() { 0.5 * (s.v + now.v) } else { now.v };
        self.state = State {
            time: s.time + dt,
            x: s.x + mean * dt,
            turn: self.turned(s.turn, now.spin, dt),
            v: now.v,
            spin: now.spin,
        };
        self.keep_on_the_floor(&points);
    }

    /// Rotation with a constant angular momentum, by the classical scheme of fourth order.
    fn turned(&self, turn: DQuat, spin: DVec3, dt: f64) -> DQuat {
        let rate = |q: DQuat| {
            let w = self.inverse_inertia(q.normalize()) * spin;
            DQuat::from_xyzw(w.x, w.y, w.z, 0.0) * q * 0.5
        };
        let a = rate(turn);
        let b = rate(turn + a * (0.5 * dt));
        let c = rate(turn + b * (0.5 * dt));
        let d = rate(turn + c * dt);
        (turn + (a + b * 2.0 + c * 2.0 + d) * (dt / 6.0)).normalize()
    }

    /// Corners that carry stay at height 0: the steps' error of position is removed, and momentum is unchanged.
    fn keep_on_the_floor(&mut self, points: &[(usize, DVec3, DMat3)]) {
        let solid = self.solid;
        for _ in 0..20 {
            let mut worst = 0.0_f64;
            for (k, ..) in points.iter().filter(|p| self.loads[p.0].z > 0.0) {
                let arm = solid.knobs[*k].arm(&DMat3::from_quat(self.state.turn));
                let gap = self.state.x.z + arm.z;
                worst = worst.max(gap.abs());
                let inverse = self.inverse_inertia(self.state.turn);
                let push = DVec3::Z * (-gap / response(solid.mass, &inverse, arm).z_axis.z);
                self.state.x += push / solid.mass;
                let turn = inverse * arm.cross(push);
                self.state.turn = (DQuat::from_scaled_axis(turn) * self.state.turn).normalize();
            }
            if worst <= 0.01 * self.touch {
                break;
            }
        }
        for (k, ..) in points {
            // A corner that has left may come down again.
            let arm = solid.knobs[*k].arm(&DMat3::from_quat(self.state.turn));
            if self.state.x.z + arm.z > self.touch && self.loads[*k].z == 0.0 {
                self.closed[*k] = false;
            }
        }
    }

    /// Impacts of the corners on the floor, the fastest first, until none approaches.
    fn collide(&mut self) {
        let solid = self.solid;
        let r = DMat3::from_quat(self.state.turn);
        let inverse = self.inverse_inertia(self.state.turn);
        for _ in 0..1000 {
            let touching = (0..solid.knobs.len()).filter_map(|k| {
                let arm = solid.knobs[k].arm(&r);
                let u = self.velocity(&inverse, arm);
                (self.state.x.z + arm.z <= self.touch).then_some((k, arm, u))
            });
            let Some((k, arm, u)) =
                touching.min_by(|a, b| a.2.z.total_cmp(&b.2.z)).filter(|p| p.2.z < -1e-3 * self.settle)
            else {
                break;
            };
            let lasts = solid.restitution * -u.z <= self.settle;
            let e = if lasts { 0.0 } else { solid.restitution };
            let push = impulse(&response(solid.mass, &inverse, arm), u, e, solid.friction);
            self.state.v += push / solid.mass;
            self.state.spin += arm.cross(push);
            self.impacts += 1;
            self.closed[k] = lasts;
        }
        self.close();
    }

    /// Slow corners on the floor stay there; those that part fast enough fly.
    fn close(&mut self) {
        let (r, inverse) = (DMat3::from_quat(self.state.turn), self.inverse_inertia(self.state.turn));
        for k in 0..self.solid.knobs.len() {
            let arm = self.solid.knobs[k].arm(&r);
            let near = self.state.x.z + arm.z <= self.touch;
            self.closed[k] = near && self.velocity(&inverse, arm).z <= self.settle;
            if !self.closed[k] {
                self.loads[k] = DVec3::ZERO;
            }
        }
    }

    fn velocity(&self, inverse: &DMat3, arm: DVec3) -> DVec3 {
        self.state.v + (*inverse * self.state.spin).cross(arm)
    }

    pub fn energy(&self) -> f64 {
        let w = self.angular_velocity();
        0.5 * (self.solid.mass * self.state.v.length_squared() + w.dot(self.state.spin))
            - self.solid.mass * self.solid.gravity.dot(self.state.x)
    }
}

struct Velocity {
    v: DVec3,
    spin: DVec3,
}

impl Velocity {
    fn at(&self, inverse: &DMat3, arm: DVec3) -> DVec3 {
        self.v + (*inverse * self.spin).cross(arm)
    }

    fn push(&mut self, mass: f64, arm: DVec3, impulse: DVec3) {
        self.v += impulse / mass;
        self.spin += arm.cross(impulse);
    }
}

/// Velocity at a point per impulse there.
fn response(mass: f64, inverse: &DMat3, arm: DVec3) -> DMat3 {
    let column = |e: DVec3| e / mass + (*inverse * arm.cross(e)).cross(arm);
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}

/// The impulse at one point, with the others given, so that it does not approach and its friction obeys Coulomb's law.
fn project(k: &DMat3, u: DVec3, old: DVec3, friction: f64) -> DVec3 {
    // Velocity without this point's impulse.
    let free = u - *k * old;
    let flat = DMat2::from_cols(k.x_axis.truncate(), k.y_axis.truncate());
    let across = k.z_axis.truncate();
    let mut new = old;
    for _ in 0..50 {
        let normal = (-(free.z + across.dot(new.truncate())) / k.z_axis.z).max(0.0);
        let rub = friction_of(&flat, free.truncate() + across * normal, friction * normal);
        let next = rub.extend(normal);
        let change = (next - new).length();
        new = next;
        if change <= 1e-13 * new.length() {
            break;
        }
    }
    new
}
