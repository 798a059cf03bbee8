//! One ball on one plane: sliding, rolling, spinning and rest in closed form.
//!
//! With normal load g_n = −g·n and k = I/(m r²), the slip `u = v − r ω × n` obeys `u' = g_t − (1 + 1/k) μ g_n û`. It
//! keeps its direction if the tangential gravity g_t vanishes or is parallel to it; then the path is a parabola until
//! `|u| = 0` (on a level plane with k = 2/5 at `t = 2|u|/(7 μ g)`). Rolling obeys `v' = g_t/(1+k)`, minus `c g_n/(1+k)`
//! along the motion for a rolling resistance c, which stops it. Everything else (a curved path on an incline) is left
//! to steps.
//!
//! Deviation: rolling resistance acts only while rolling, not while sliding, as is usual in billiards models (Leckie &
//! Greenspan 2006). One exception: if the resistance c is at least µ, a ball that slides without turning does not begin
//! to turn, because friction's torque µ g_n r does not exceed the resistance.

use crate::material::Law;
use glam::DVec3;

/// Directions count as parallel, and slip as zero, up to this fraction. Dimensionless; 1e-12: a few thousand rounding
/// errors.
pub(crate) const PARALLEL: f64 = 1e-12;

/// The forces of one ball on one plane, per unit mass.
pub(crate) struct Slope {
    pub(crate) normal: DVec3,
    pub(crate) load: f64,
    pub(crate) downhill: DVec3,
    friction: f64,
    /// The coefficient of friction while it does not slide.
    grip: f64,
    rolling: f64,
    spinning: f64,
    gyration: f64,
    pub(crate) radius: f64,
    /// Whether friction cannot make the ball turn if it does not turn yet.
    holds: bool,
}

/// How a ball moves on a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Slides,
    Rolls,
    /// Turns on the spot.
    Spins,
    Rests,
}

/// What happens at the end of a closed form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// Nothing in particular.
    Plain,
    /// Slip is gone: it rolls.
    Rolls,
    /// The centre has stopped.
    Stops,
}

/// A closed form.
pub(crate) struct Going {
    pub(crate) kind: Kind,
    pub(crate) acceleration: DVec3,
    /// Rate of the angular velocity across the normal.
    pub(crate) spin_rate: DVec3,
    pub(crate) lasts: f64,
    pub(crate) end: End,
}

impl Going {
    fn endless(kind: Kind, acceleration: DVec3, spin_rate: DVec3) -> Self {
        Self { kind, acceleration, spin_rate, lasts: f64::INFINITY, end: End::Plain }
    }
}

impl Slope {
    /// A plane under a ball with `gyration` I/(m r²). A pull along the plane of up to the fraction `level` of gravity
    /// counts as none. `None` if the plane does not carry the ball.
    pub(crate) fn new(
        normal: DVec3,
        gravity: DVec3,
        law: &Law,
        [gyration, radius]: [f64; 2],
        level: f64,
    ) -> Option<Self> {
        let load = -gravity.dot(normal);
        if load <= 0.0 {
            return None;
        }
        let mut downhill = gravity + normal * load;
        if downhill.length() <= level * gravity.length() {
            downhill = DVec3::ZERO;
        }
        let Law { friction, rolling, spinning, .. } = *law;
        let holds = law.holds_from_turning();
        Some(Self { normal, load, downhill, friction, grip: law.grip(), rolling, spinning, gyration, radius, holds })
    }

    /// Inertia of the ball over m r².
    pub(crate) fn gyration(&self) -> f64 {
        self.gyration
    }

    /// Velocity of the ball's lowest point.
    pub(crate) fn slip(&self, v: DVec3, spin: DVec3) -> DVec3 {
        v - spin.cross(self.normal) * self.radius
    }

    /// The spin of a ball that rolls at this velocity and spins as given.
    pub(crate) fn rolling(&self, v: DVec3, spin: DVec3) -> DVec3 {
        self.normal.cross(v) / self.radius + self.normal * spin.dot(self.normal)
    }

    /// Velocity after friction has stopped the slip at once.
    pub(crate) fn caught(&self, v: DVec3, spin: DVec3) -> DVec3 {
        v - self.slip(v, spin) * (self.gyration / (1.0 + self.gyration))
    }

    /// How far the lowest point slides until friction has stopped it, on level ground; infinite without friction.
    pub(crate) fn skid(&self, v: DVec3, spin: DVec3) -> f64 {
        self.slip(v, spin).length_squared() / (2.0 * (1.0 + 1.0 / self.gyration) * self.friction * self.load)
    }

    /// Whether friction under this load keeps a ball rolling, whichever way it goes.
    pub(crate) fn grips(&self, load: f64) -> bool {
        let needed = (self.downhill.length() * self.gyration + self.rolling * self.load) / (1.0 + self.gyration);
        needed <= self.grip * load
    }

    /// Whether there is friction.
    pub(crate) fn is_rough(&self) -> bool {
        self.friction > 0.0
    }

    /// How a ball with this velocity along the plane goes on; if it rolls, its spin becomes exactly that of rolling.
    /// `None` if there is no closed form.
    pub(crate) fn going(&self, v: DVec3, spin: &mut DVec3) -> Option<Going> {
        let surface_speed = spin.cross(self.normal) * self.radius;
        let slip = v - surface_speed;
        let slips = slip.length() > PARALLEL * (v.length() + surface_speed.length());
        if slips && self.friction > 0.0 {
            return if self.holds && surface_speed == DVec3::ZERO { self.drag(slip) } else { self.slide(slip) };
        }
        if self.friction == 0.0 {
            return Some(self.frictionless(v, *spin));
        }
        // Rolls: make the spin exactly that of rolling.
        *spin = self.rolling(v, *spin);
        self.roll(v, *spin)
    }

    fn frictionless(&self, v: DVec3, spin: DVec3) -> Going {
        let still = v == DVec3::ZERO && self.downhill == DVec3::ZERO;
        let spins = spin != DVec3::ZERO;
        Going::endless(
            if !still {
                Kind::Slides
            } else if spins {
                Kind::Spins
            } else {
                Kind::Rests
            },
            self.downhill,
            DVec3::ZERO,
        )
    }

    fn slide(&self, slip: DVec3) -> Option<Going> {
        let speed = slip.length();
        let along = slip / speed;
        if self.downhill.cross(along).length() > PARALLEL * self.downhill.length() {
            return None;
        }
        let drag = self.friction * self.load;
        let rate = self.downhill.dot(along) - (1.0 + 1.0 / self.gyration) * drag;
        let mut going = Going::endless(
            Kind::Slides,
            self.downhill - along * drag,
            self.normal.cross(along) * (drag / (self.gyration * self.radius)),
        );
        if rate < 0.0 {
            going.lasts = -speed / rate;
            going.end = End::Rolls;
        }
        Some(going)
    }

    /// Slides without turning.
    fn drag(&self, slip: DVec3) -> Option<Going> {
        let speed = slip.length();
        let along = slip / speed;
        if self.downhill.cross(along).length() > PARALLEL * self.downhill.length() {
            return None;
        }
        let rate = self.downhill.dot(along) - self.friction * self.load;
        let mut going = Going::endless(Kind::Slides, along * rate, DVec3::ZERO);
        if rate < 0.0 {
            going.lasts = -speed / rate;
            going.end = End::Stops;
        }
        Some(going)
    }

    fn roll(&self, v: DVec3, spin: DVec3) -> Option<Going> {
        let (speed, steepness) = (v.length(), self.downhill.length());
        let resistance = self.rolling * self.load;
        if speed == 0.0 {
            if steepness <= resistance.min(self.grip * self.load) || steepness == 0.0 {
                return Some(self.stand(spin));
            }
            if self.holds && steepness > self.grip * self.load {
                return self.drag(self.downhill);
            }
            return self.roll_along(self.downhill / steepness, 0.0);
        }
        let along = v / speed;
        if self.downhill.cross(along).length() > PARALLEL * steepness {
            // Without resistance the path may curve and still be a parabola.
            let needed = steepness * self.gyration / (1.0 + self.gyration);
            let free = self.rolling == 0.0 && needed <= self.grip * self.load;
            let acceleration = self.downhill / (1.0 + self.gyration);
            return free
                .then(|| Going::endless(Kind::Rolls, acceleration, self.normal.cross(acceleration) / self.radius));
        }
        self.roll_along(along, speed)
    }

    /// Rolling in direction `along` with the pull parallel to it.
    fn roll_along(&self, along: DVec3, speed: f64) -> Option<Going> {
        let downhill = self.downhill.dot(along);
        let rate = (downhill - self.rolling * self.load) / (1.0 + self.gyration);
        let friction = rate - downhill;
        if friction.abs() > self.grip * self.load {
            // Rolling would need more friction than is available: from rest on a steep slope the ball slides down at
            // once.
            let slides = downhill > (1.0 + 1.0 / self.gyration) * self.grip * self.load;
            return if slides { self.slide(along) } else { None };
        }
        let acceleration = along * rate;
        let mut going = Going::endless(Kind::Rolls, acceleration, self.normal.cross(acceleration) / self.radius);
        if rate < 0.0 {
            going.lasts = -speed / rate;
            going.end = End::Stops;
        }
        Some(going)
    }

    fn stand(&self, spin: DVec3) -> Going {
        let about = spin.dot(self.normal).abs();
        if about == 0.0 {
            return Going::endless(Kind::Rests, DVec3::ZERO, DVec3::ZERO);
        }
        let mut going = Going::endless(Kind::Spins, DVec3::ZERO, DVec3::ZERO);
        if self.spinning > 0.0 {
            going.lasts = about / self.drill();
        }
        going
    }

    /// Rate at which resistance slows a spin about the normal.
    pub(crate) fn drill(&self) -> f64 {
        self.spinning * self.load / (self.gyration * self.radius)
    }
}
