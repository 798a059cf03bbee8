//! A ball alone on the front of a curved track: it slides without friction or with it, or rolls.
//!
//! Its centre is at the distance `a` from the track's axis. With the normal `n` towards the axis and the speed `c`
//! around it, the track pushes with `N = c²/a − g·n` for each unit of mass. A ball of radius r and inertia k m r² slips
//! with `u = v − r ω × n`. Friction is `−µ N û` while it does, and while it rolls what keeps it rolling as the normal
//! turns, `F = (r (ω × ṅ) − g)/(1 + 1/k)` along the track. Its spin follows from `ω̇ = −n × F/(k r)`. These equations
//! are integrated by the Runge–Kutta method of fourth order, and the speed is then corrected so that energy is kept, as
//! for a body that pivots. A step ends where the track ends, and where it pushes no more. What else the ball touches
//! must be left by it, as a floor that the track rises from. Wherever more is going on, RATTLE takes the step.

use crate::rigid::RigidWorld;
use crate::rigid::body_state::RigidBodyState;
use crate::rigid::motion::kinematic::rotation_vector;
use crate::rigid::narrow_phase::contact_point::ContactPoint;
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::tolerances::{
    ARC_END_BISECTIONS, ARC_LEAST_STEP, ARC_SUBSTEPS, CONTACT_MARGIN, GAP_ERROR, KEPT_GAP, NO_PRESSURE,
    PIVOT_ENERGY_ERROR, PIVOT_SLIP, PIVOT_SLOW,
};
use crate::scenery::ArcTrack;
use glam::{DQuat, DVec3, DVec4};

/// How a ball moves along a track.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Regime {
    /// With this coefficient of friction.
    Slides(f64),
    /// With friction up to this coefficient.
    Rolls(f64),
}

/// A ball on a track.
struct OnArc<'w> {
    arc: &'w ArcTrack,
    radius: f64,
    /// Moment of inertia over mass and the square of the radius.
    gyration: f64,
    gravity: DVec3,
    regime: Regime,
}

#[derive(Debug, Clone, Copy)]
struct Motion {
    x: DVec3,
    v: DVec3,
    w: DVec3,
    turn: DQuat,
}

/// What acts on a ball, for each unit of its mass.
struct Push {
    normal: DVec3,
    load: f64,
    friction: DVec3,
}

impl OnArc<'_> {
    fn slip(&self, m: &Motion, normal: DVec3) -> DVec3 {
        (m.v - m.w.cross(normal) * self.radius).reject_from_normalized(normal)
    }

    fn push(&self, m: &Motion) -> Push {
        let (normal, out) = self.arc.normal(m.x);
        let around = m.v.reject_from_normalized(self.arc.axis()).reject_from_normalized(normal);
        let load = around.length_squared() / out - self.gravity.dot(normal);
        let friction = match self.regime {
            Regime::Slides(coefficient) => self.slip(m, normal).normalize_or_zero() * (-coefficient * load.max(0.0)),
            Regime::Rolls(_) => {
                let turned = m.w.cross(around / -out) * self.radius - self.gravity;
                turned.reject_from_normalized(normal) / (1.0 + 1.0 / self.gyration)
            }
        };
        Push { normal, load, friction }
    }

    /// Whether the track pushes, and friction holds what rolls.
    fn holds(&self, push: &Push) -> bool {
        match self.regime {
            Regime::Slides(_) => push.load > 0.0,
            Regime::Rolls(grip) => push.load > 0.0 && push.friction.length() <= grip * push.load,
        }
    }

    /// Rates of change, per component of the quaternion.
    fn rates(&self, m: &Motion) -> (DVec3, DVec3, DVec3, DVec4) {
        let Push { normal, load, friction } = self.push(m);
        let turns = normal.cross(friction) / -(self.gyration * self.radius);
        let turn = DQuat::from_vec4(m.w.extend(0.0)) * m.turn;
        (m.v, self.gravity + normal * load + friction, turns, DVec4::from(turn) * 0.5)
    }

    /// The motion `h` seconds later, nearer to the axis by `rise`.
    fn after(&self, start: &Motion, h: f64, rise: f64) -> Motion {
        let add = |m: &Motion, k: &(DVec3, DVec3, DVec3, DVec4), h: f64| Motion {
            x: m.x + k.0 * h,
            v: m.v + k.1 * h,
            w: m.w + k.2 * h,
            turn: DQuat::from_vec4(DVec4::from(m.turn) + k.3 * h),
        };
        let mut m = *start;
        let part = h / f64::from(ARC_SUBSTEPS);
        for _ in 0..ARC_SUBSTEPS {
            let a = self.rates(&m);
            let b = self.rates(&add(&m, &a, 0.5 * part));
            let c = self.rates(&add(&m, &b, 0.5 * part));
            let d = self.rates(&add(&m, &c, part));
            let mean = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (a + (b + c) * 2.0 + d) / 6.0;
            let turn = (a.3 + (b.3 + c.3) * 2.0 + d.3) / 6.0;
            m = add(&m, &(mean(a.0, b.0, c.0, d.0), mean(a.1, b.1, c.1, d.1), mean(a.2, b.2, c.2, d.2), turn), part);
            m.turn = m.turn.normalize();
        }
        let (normal, out) = self.arc.normal(m.x);
        m.x += normal * (out - self.arc.normal(start.x).1 + rise);
        m.v = m.v.reject_from_normalized(normal);
        if matches!(self.regime, Regime::Rolls(_)) {
            m.w = normal * m.w.dot(normal) + normal.cross(m.v) / self.radius;
        }
        m
    }

    fn kinetic(&self, m: &Motion) -> f64 {
        0.5 * (m.v.length_squared() + self.gyration * self.radius * self.radius * m.w.length_squared())
    }

    /// Corrects the speed so that energy is kept; false if it is too far off. What comes to a stop is left as it is,
    /// and so is what friction brakes. Nothing changes the spin of what slides without friction, nor its way along the
    /// axis but gravity.
    fn keep_energy(&self, start: &Motion, end: &mut Motion) -> bool {
        let work = self.gravity.dot(end.x - start.x);
        let axis = self.arc.axis();
        let apart = if self.regime == Regime::Slides(0.0) { axis * axis.dot(end.v) } else { DVec3::ZERO };
        let spin = if self.regime == Regime::Slides(0.0) {
            0.5 * self.gyration * self.radius * self.radius * end.w.length_squared()
        } else {
            0.0
        };
        let kept = 0.5 * apart.length_squared() + spin;
        let (wanted, found) = (self.kinetic(start) + work - kept, self.kinetic(end) - kept);
        if matches!(self.regime, Regime::Slides(coefficient) if coefficient > 0.0)
            || wanted <= PIVOT_SLOW * self.kinetic(start)
            || found <= 0.0
        {
            return true;
        }
        let factor = (wanted / found).sqrt();
        end.v = apart + (end.v - apart) * factor;
        if self.regime != Regime::Slides(0.0) {
            end.w *= factor;
        }
        (wanted - found).abs() <= PIVOT_ENERGY_ERROR * found
    }

    /// The longest step of at most `h` for which `holds` is true at its end; it is at its start.
    fn longest(&self, start: &Motion, h: f64, holds: impl Fn(&Motion) -> bool) -> f64 {
        if holds(&self.after(start, h, 0.0)) {
            return h;
        }
        let (mut low, mut high) = (0.0, h);
        for _ in 0..ARC_END_BISECTIONS {
            let middle = 0.5 * (low + high);
            if holds(&self.after(start, middle, 0.0)) { low = middle } else { high = middle }
        }
        high
    }
}

/// The time in s that a track's curvature allows a body on it: that of falling as far as the radius of curvature of its
/// path, or of moving as far.
pub(super) fn arc_time(world: &RigidWorld, arc: &ArcTrack, p: &StepPoses, t: &ContactPoint) -> f64 {
    let spec = &world.specs[p.body];
    let radius = if spec.is_ball { arc.form().radius - spec.bounding_radius } else { arc.form().radius };
    let around = |v: DVec3| v.reject_from_normalized(arc.axis()).length();
    let speed = around(p.start.velocity(t.arm)).max(around(p.start.v));
    (radius / world.gravity_magnitude).sqrt().min(radius / speed)
}

impl RigidScratch {
    /// A step that ends where a point that it holds on a curved track reaches an edge of the track.
    pub(super) fn until_arc_end(&self, world: &RigidWorld, h: f64) -> f64 {
        let mut end = h;
        for (k, t) in &self.touches {
            let Some(arc) = world.front(t.surface) else { continue };
            let (p, spec) = (&self.places[*k], &world.specs[self.places[*k].body]);
            let (at, v) =
                if spec.is_ball { (p.start.x, p.start.v) } else { (p.start.x + t.arm, p.start.velocity(t.arm)) };
            let inside = arc.inside(at);
            let falls = inside - arc.inside(at + v * end);
            if falls > inside {
                end = (end * (inside / falls).max(0.0)).max(ARC_LEAST_STEP * h);
            }
        }
        end
    }

    /// Takes a step of at most `h` seconds of a ball that is alone on a curved track; returns whether it does.
    pub(super) fn arc_step(&mut self, world: &RigidWorld, bodies: &mut [RigidBodyState], h: f64) -> bool {
        let Some((on, start, front)) = self.on_arc(world, h) else { return false };
        let place = self.places[0];
        let (spec, touch) = (&world.specs[place.body], self.touches[front].1);
        let first = on.push(&start);
        let none = NO_PRESSURE * spec.gravity_magnitude;
        if first.load <= none && self.touches.len() == 1 && self.leaving.is_empty() {
            // The track does not pull.
            let body = &mut bodies[place.body];
            (body.path.v, body.spin) = (start.v, start.w);
            body.list(std::iter::empty());
            world.fly(place.body, body);
            return true;
        }
        if !on.holds(&first) {
            return false;
        }
        let is_here = |m: &Motion| on.arc.inside(m.x) > 0.0;
        let mut h = if is_here(&start) { on.longest(&start, h, is_here) } else { h };
        h = on.longest(&start, h, |m| on.push(m).load > 0.0);
        let most = 0.5 * spec.gravity_magnitude * h * h;
        let rise = (KEPT_GAP * spec.gap - touch.gap).min(most);
        let mut end = on.after(&start, h, rise);
        let (normal, _) = on.arc.normal(end.x);
        let turns_round = matches!(on.regime, Regime::Slides(coefficient) if coefficient > 0.0)
            && on.slip(&start, first.normal).dot(on.slip(&end, normal)) <= 0.0;
        if place.clock + h <= place.clock || turns_round || !on.keep_energy(&start, &mut end) {
            return false;
        }
        let last = on.push(&end);
        let leaves = last.load <= none;
        if !leaves && !on.holds(&last) {
            return false;
        }
        self.prepare(world, 0.5 * h, |_, p| (p.start.v, p.start.w));
        (self.members[0].v, self.members[0].w) = (end.v, end.w);
        let place = &mut self.places[0];
        place.spin = rotation_vector(start.turn, end.turn) / h;
        (place.end, place.end_turn) = place.drifted(spec, (end.x - start.x) / h, place.spin, h);
        let place = &self.places[0];
        let parts = |(_, t): &(usize, ContactPoint)| {
            let least = t.gap.min(KEPT_GAP * spec.gap) - GAP_ERROR * spec.gap;
            t.surface == touch.surface || world.touch(place.body, &place.end, t.surface).gap >= least
        };
        if self.returns().is_some() || !self.touches.iter().all(parts) {
            return false;
        }
        let passed = (end.v - start.v - spec.gravity * h) * spec.mass;
        self.contacts[front].impulse = (first.normal * first.load + first.friction) * (0.5 * h * spec.mass);
        self.firsts.clone_from(&self.contacts);
        self.contacts[front].impulse = passed - self.contacts[front].impulse;
        self.write(world, bodies, h);
        true
    }

    /// A ball that is alone on a curved track, how it moves, and the number of its point there.
    fn on_arc<'w>(&self, world: &'w RigidWorld, h: f64) -> Option<(OnArc<'w>, Motion, usize)> {
        let ([place], [], [], []) = (&self.places[..], &self.pairs[..], &self.parting[..], &self.rows[..]) else {
            return None;
        };
        if !self.stops.is_empty() {
            return None;
        }
        let mut fronts =
            self.touches.iter().enumerate().filter_map(|(k, t)| Some((k, &t.1, world.front(t.1.surface)?)));
        let ((front, touch, arc), None) = (fronts.next()?, fronts.next()) else { return None };
        let spec = &world.specs[place.body];
        if !spec.is_ball || spec.is_driven() || spec.damping.is_some() || spec.anisotropy != 0.0 {
            return None;
        }
        let law = world.law_at(place.body, touch, place.start.x + touch.arm);
        let rubs = law.rolling != 0.0 || law.spinning != 0.0;
        if rubs || touch.point().is_none() || !(-spec.gap..=CONTACT_MARGIN * spec.gap).contains(&touch.gap) {
            return None;
        }
        // Slow approach is stopped, as in other steps.
        let (v, w) = (place.start.v.reject_from_normalized(touch.normal), place.start.w);
        let slip = (v - w.cross(touch.normal) * spec.bounding_radius).reject_from_normalized(touch.normal).length();
        let slow = world.accuracy.sweep_tolerance.max(PIVOT_SLIP) * spec.gravity_magnitude * h;
        let regime =
            if law.friction == 0.0 || slip > slow { Regime::Slides(law.friction) } else { Regime::Rolls(law.grip()) };
        let radius = spec.bounding_radius;
        let gyration = spec.inertia.moments.x / (spec.mass * radius * radius);
        let start = Motion { x: place.start.x, v, w, turn: place.turn };
        Some((OnArc { arc, radius, gyration, gravity: spec.gravity, regime }, start, front))
    }
}
