//! One marble on one plane: sliding, rolling, spinning and rest in closed form.
//!
//! With normal load g_n = −g·n and k = I/(m r²), the slip `u = v − r ω × n` obeys `u' = g_t − (1 + 1/k) μ g_n û`. It
//! keeps its direction if the tangential gravity g_t vanishes or is parallel to it; then the path is a parabola until
//! `|u| = 0` (on a level plane with k = 2/5 at `t = 2|u|/(7 μ g)`). Rolling obeys `v' = g_t/(1+k)`, minus `c g_n/(1+k)`
//! along the motion for a rolling resistance c, which stops it. Everything else (a curved path on an incline) is left
//! to `step`.
//!
//! Deviation: rolling resistance acts only while rolling, not while sliding, as is usual in billiards models (Leckie &
//! Greenspan 2006). One exception: if the resistance c is at least µ, a ball that slides without turning does not begin
//! to turn, because friction's torque µ g_n r does not exceed the resistance.

use super::Marbles;
use super::body::{Ending, Marble, Phase};
use crate::roots::fall_of_quadratic;
use crate::scenery::Surface;
use glam::DVec3;

/// Directions count as parallel, and slip or tangential gravity as zero, up to this fraction. Dimensionless; 1e-12: a
/// few thousand rounding errors.
const PARALLEL: f64 = 1e-12;

/// The forces of one marble on one plane, per unit mass.
struct Plane {
    normal: DVec3,
    load: f64,
    pull: DVec3,
    friction: f64,
    rolling: f64,
    spinning: f64,
    gyration: f64,
    radius: f64,
    /// Whether friction cannot make the ball turn if it does not turn yet.
    holds: bool,
}

/// Gives the marble a closed form if there is one; false if it needs steps. Its only contact must be `surface`.
pub(crate) fn begin(world: &Marbles, index: usize, body: &mut Marble, surface: Surface) -> bool {
    let normal = match surface {
        Surface::Plane(k) => world.scenery.planes()[k as usize].normal,
        Surface::Face(k) => world.scenery.mesh().faces[k as usize].normal,
        _ => return false,
    };
    let load = -world.gravity.dot(normal);
    if load <= 0.0 {
        return false;
    }
    let mut pull = world.gravity + normal * load;
    if pull.length() <= PARALLEL * world.strength {
        pull = DVec3::ZERO;
    }
    let (spec, law) = (&world.specs[index], world.surface_law(index, surface));
    let plane = Plane {
        normal,
        load,
        pull,
        friction: law.friction,
        rolling: law.rolling,
        spinning: law.spinning,
        gyration: spec.gyration,
        radius: spec.radius,
        holds: law.holds_from_turning(),
    };
    body.path.v -= normal * body.path.v.dot(normal);
    let found = plane.motion(body);
    let Some(motion) = found else { return false };
    plane.apply(body, &motion);
    if let Surface::Face(k) = surface {
        leave_face(world, k, body, spec.radius);
    }
    body.expiry > body.path.t
}

struct Motion {
    phase: Phase,
    acceleration: DVec3,
    spin_rate: DVec3,
    lasts: f64,
    ending: Ending,
}

impl Motion {
    fn endless(phase: Phase, acceleration: DVec3, spin_rate: DVec3) -> Self {
        Self { phase, acceleration, spin_rate, lasts: f64::INFINITY, ending: Ending::Plain }
    }
}

impl Plane {
    fn motion(&self, body: &mut Marble) -> Option<Motion> {
        let v = body.path.v;
        let surface_speed = body.spin.cross(self.normal) * self.radius;
        let slip = v - surface_speed;
        let slips = slip.length() > PARALLEL * (v.length() + surface_speed.length());
        if slips && self.friction > 0.0 {
            return if self.holds && surface_speed == DVec3::ZERO { self.drag(slip) } else { self.slide(slip) };
        }
        if self.friction == 0.0 {
            return Some(self.frictionless(v, body));
        }
        // Rolls: make the spin exactly that of rolling.
        body.spin = self.normal.cross(v) / self.radius + self.normal * body.spin.dot(self.normal);
        self.roll(v, body)
    }

    fn frictionless(&self, v: DVec3, body: &Marble) -> Motion {
        let still = v == DVec3::ZERO && self.pull == DVec3::ZERO;
        let spins = body.spin != DVec3::ZERO;
        Motion::endless(
            if !still {
                Phase::Slide
            } else if spins {
                Phase::Spin
            } else {
                Phase::Rest
            },
            self.pull,
            DVec3::ZERO,
        )
    }

    fn slide(&self, slip: DVec3) -> Option<Motion> {
        let speed = slip.length();
        let along = slip / speed;
        if self.pull.cross(along).length() > PARALLEL * self.pull.length() {
            return None;
        }
        let drag = self.friction * self.load;
        let rate = self.pull.dot(along) - (1.0 + 1.0 / self.gyration) * drag;
        let mut motion = Motion::endless(
            Phase::Slide,
            self.pull - along * drag,
            self.normal.cross(along) * (drag / (self.gyration * self.radius)),
        );
        if rate < 0.0 {
            motion.lasts = -speed / rate;
            motion.ending = Ending::Rolls;
        }
        Some(motion)
    }

    /// Slides without turning.
    fn drag(&self, slip: DVec3) -> Option<Motion> {
        let speed = slip.length();
        let along = slip / speed;
        if self.pull.cross(along).length() > PARALLEL * self.pull.length() {
            return None;
        }
        let rate = self.pull.dot(along) - self.friction * self.load;
        let mut motion = Motion::endless(Phase::Slide, along * rate, DVec3::ZERO);
        if rate < 0.0 {
            motion.lasts = -speed / rate;
            motion.ending = Ending::Stops;
        }
        Some(motion)
    }

    fn roll(&self, v: DVec3, body: &Marble) -> Option<Motion> {
        let (speed, steepness) = (v.length(), self.pull.length());
        let resistance = self.rolling * self.load;
        if speed == 0.0 {
            if steepness <= resistance.min(self.friction * self.load) || steepness == 0.0 {
                return Some(self.stand(body));
            }
            if self.holds {
                return self.drag(self.pull);
            }
            return self.roll_along(self.pull / steepness, 0.0);
        }
        let along = v / speed;
        if self.pull.cross(along).length() > PARALLEL * steepness {
            // Without resistance the path may curve and still be a parabola.
            let needed = steepness * self.gyration / (1.0 + self.gyration);
            let free = self.rolling == 0.0 && needed <= self.friction * self.load;
            let acceleration = self.pull / (1.0 + self.gyration);
            return free
                .then(|| Motion::endless(Phase::Roll, acceleration, self.normal.cross(acceleration) / self.radius));
        }
        self.roll_along(along, speed)
    }

    /// Rolling in direction `along` with the pull parallel to it.
    fn roll_along(&self, along: DVec3, speed: f64) -> Option<Motion> {
        let pull = self.pull.dot(along);
        let rate = (pull - self.rolling * self.load) / (1.0 + self.gyration);
        let friction = rate - pull;
        if friction.abs() > self.friction * self.load {
            // Rolling would need more friction than is available: from rest on a steep slope the ball slides down at
            // once.
            let slides = pull > (1.0 + 1.0 / self.gyration) * self.friction * self.load;
            return if slides { self.slide(along) } else { None };
        }
        let acceleration = along * rate;
        let mut motion = Motion::endless(Phase::Roll, acceleration, self.normal.cross(acceleration) / self.radius);
        if rate < 0.0 {
            motion.lasts = -speed / rate;
            motion.ending = Ending::Stops;
        }
        Some(motion)
    }

    fn stand(&self, body: &Marble) -> Motion {
        let about = body.spin.dot(self.normal).abs();
        if about == 0.0 {
            return Motion::endless(Phase::Rest, DVec3::ZERO, DVec3::ZERO);
        }
        let mut motion = Motion::endless(Phase::Spin, DVec3::ZERO, DVec3::ZERO);
        if self.spinning > 0.0 {
            motion.lasts = about / self.drill();
        }
        motion
    }

    /// Rate at which resistance slows a spin about the normal.
    fn drill(&self) -> f64 {
        self.spinning * self.load / (self.gyration * self.radius)
    }

    fn apply(&self, body: &mut Marble, motion: &Motion) {
        body.begin(motion.phase, motion.acceleration);
        body.spin_rate = motion.spin_rate;
        body.normal = self.normal;
        body.drill = self.drill();
        body.expiry = (body.path.t + motion.lasts).min(f64::MAX);
        body.ending = motion.ending;
        if motion.phase == Phase::Rest {
            (body.path.v, body.spin) = (DVec3::ZERO, DVec3::ZERO);
        }
    }
}

/// Ends the motion where the contact point reaches a side of its triangle.
fn leave_face(world: &Marbles, k: u32, body: &mut Marble, radius: f64) {
    if matches!(body.phase, Phase::Rest | Phase::Spin) {
        return;
    }
    let face = &world.scenery.mesh().faces[k as usize];
    let foot = body.path.x - face.normal * radius;
    for (side, (inward, offset)) in face.sides.iter().enumerate() {
        let c = [inward.dot(foot) - offset, inward.dot(body.path.v), 0.5 * inward.dot(body.path.a)];
        if let Some(dt) = fall_of_quadratic(c, body.expiry - body.path.t) {
            body.expiry = body.path.t + dt;
            body.ending = Ending::Leaves(side as u8);
        }
    }
}
