//! A contact of bodies in an island, and the impulse there that obeys Coulomb's law while all other impulses stay as
//! they are.

use super::slip::Stiction;
use super::slip::{Slip, SlipProblem};
use crate::material::Law;
use crate::rigid::BodyDef;
use crate::rigid::tolerances::{CONE_EDGE, WEDGED_RESPONSE};
use glam::{DMat3, DVec3};

/// A body while its contacts are solved.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SolverBody {
    pub(crate) inverse_mass: f64,
    pub(crate) inverse_inertia: DMat3,
    pub(crate) v: DVec3,
    pub(crate) w: DVec3,
    /// Largest distance of a point from the centre of gravity.
    pub(crate) bounding_radius: f64,
    /// Velocities one round ago.
    pub(crate) last: [DVec3; 2],
}

impl SolverBody {
    /// Its speed, or that of its farthest point about the centre of gravity if that is faster, in m/s.
    pub(crate) fn fastest(&self) -> f64 {
        self.v.length().max(self.w.length() * self.bounding_radius)
    }
}

/// Which impulses a contact may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ConstraintKind {
    /// Those within Coulomb's cone about the normal.
    Coulomb,
    /// Any: a point of a joint.
    Point,
    /// Any across the normal: a point of a slider.
    Across,
    /// Along the normal, in either direction, at most this large in N s: dry friction or a motor.
    DryFriction(f64),
}

/// A contact between a member and a fixed part or another member.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactConstraint {
    pub(crate) a: usize,
    pub(crate) b: Option<usize>,
    pub(crate) arms: [DVec3; 2],
    /// Unit normal towards `a`.
    pub(crate) normal: DVec3,
    pub(crate) friction: f64,
    /// What decides on its friction, where surfaces that do not slide have another one.
    pub(crate) stiction: Option<Stiction>,
    pub(crate) hold: ConstraintKind,
    /// How a driven body presses here; none if it does not.
    pub(crate) force_limit: Option<ForceLimit>,
    /// Velocity that it gives way by per impulse; 0 unless a driven body leaves others no way.
    pub(crate) compliance: f64,
    /// Least normal velocity after solving.
    pub(crate) target: f64,
    /// Added to the velocity at the point to get the velocity that counts: for example its mean over a drift.
    pub(crate) bias: DVec3,
    /// The direction of slip that friction opposes as long as the contact slides that way; if none, friction opposes
    /// the slip that is left.
    pub(crate) held_slip: Option<DVec3>,
    /// Velocity change per impulse.
    pub(crate) k: DMat3,
    k_inverse: DMat3,
    kn: DVec3,
    along: f64,
    /// An upper bound on the response across the normal.
    stiff: f64,
    /// Impulse on `a` so far.
    pub(crate) impulse: DVec3,
    slip: Option<Slip>,
    /// Whether its impulse is a solution of shortly before, which tells whether it is open, sticks or slides.
    pub(crate) is_known: bool,
    /// Whether it slid when it was last solved.
    slides: bool,
    /// Whether it obeyed Coulomb's law after that, including the direction of its slip.
    pub(crate) is_right: bool,
}

/// How accurately a slip's direction is sought: the angle in radians by which it may be off, and the number of rounds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlipSearch {
    pub(crate) turn: f64,
    pub(crate) rounds: u32,
}

impl ContactConstraint {
    pub(crate) fn new(a: usize, b: Option<usize>, arms: [DVec3; 2], normal: DVec3, friction: f64, k: DMat3) -> Self {
        let kn = k * normal;
        let along = normal.dot(kn);
        let stiff = k.x_axis.x + k.y_axis.y + k.z_axis.z - along;
        let k_inverse = k.inverse();
        Self { friction, k, k_inverse, kn, along, stiff, ..Self::blank(a, b, arms, normal) }
    }

    /// The same contact with the friction of a law for surfaces that slide and for those that do not; `before` is the
    /// velocity there up to now, which counts as none up to `still`.
    #[inline]
    pub(crate) fn gripping(mut self, law: &Law, still: f64, before: impl FnOnce(&Self) -> DVec3) -> Self {
        if law.static_friction > law.friction {
            let (friction, slip) = ([law.friction, law.static_friction], self.slip_of(before(&self)));
            self.stiction = Some(Stiction { friction, slip, slip_after: slip, still });
        }
        self
    }

    /// The coefficients of friction while it slides, and while it does not.
    pub(crate) fn frictions(&self) -> [f64; 2] {
        self.stiction.map_or([self.friction; 2], |stiction| stiction.friction)
    }

    /// The part of a velocity across the normal.
    fn slip_of(&self, u: DVec3) -> DVec3 {
        u - self.normal * u.dot(self.normal)
    }

    /// The slip that counts.
    pub(super) fn slip(&self, members: &[SolverBody]) -> DVec3 {
        self.slip_of(self.velocity(members) + self.bias)
    }

    /// A contact that has been solved, of which only the impulse matters.
    pub(crate) fn told(a: usize, b: Option<usize>, arms: [DVec3; 2], normal: DVec3, impulse: DVec3) -> Self {
        Self { impulse, is_known: true, is_right: true, ..Self::blank(a, b, arms, normal) }
    }

    /// A contact without friction and response, as it is before it is solved.
    fn blank(a: usize, b: Option<usize>, arms: [DVec3; 2], normal: DVec3) -> Self {
        Self {
            a,
            b,
            arms,
            normal,
            friction: 0.0,
            stiction: None,
            hold: ConstraintKind::Coulomb,
            force_limit: None,
            compliance: 0.0,
            target: 0.0,
            bias: DVec3::ZERO,
            held_slip: None,
            k: DMat3::ZERO,
            k_inverse: DMat3::ZERO,
            kn: DVec3::ZERO,
            along: 0.0,
            stiff: 0.0,
            impulse: DVec3::ZERO,
            slip: None,
            is_known: false,
            slides: false,
            is_right: false,
        }
    }

    /// Lets it give way, if a driven body presses here, from no impulse on.
    pub(super) fn give_way(&mut self, members: &mut [SolverBody]) {
        self.push(members, -self.impulse);
        self.impulse = DVec3::ZERO;
        if let Some(force_limit) = self.force_limit.filter(|_| self.compliance == 0.0) {
            let held_slip = self.held_slip;
            self.soften(force_limit.compliance);
            (self.held_slip, self.force_limit) = (held_slip, Some(force_limit));
        }
    }

    /// Whether it seeks to part what it keeps out of each other.
    pub(crate) fn pushes_out(&self) -> bool {
        self.hold == ConstraintKind::Coulomb && self.target > 0.0
    }

    /// Lets it give way by this velocity per impulse.
    pub(crate) fn soften(&mut self, compliance: f64) {
        let k = self.k + DMat3::from_diagonal(DVec3::splat(compliance));
        let Self { hold, target, bias, stiction, .. } = *self;
        let fresh = Self::new(self.a, self.b, self.arms, self.normal, self.friction, k);
        *self = Self { hold, target, bias, stiction, compliance, ..fresh };
    }

    /// Whether a driven body presses here that does not give way yet.
    pub(super) fn can_give_way(&self) -> bool {
        self.force_limit.is_some() && self.compliance == 0.0
    }

    /// Whether a driven body pressed here so hard, before, that it may have to give way again.
    pub(crate) fn is_hard_pressed(&self) -> bool {
        self.force_limit.is_some_and(|p| self.impulse.length_squared() > 0.25 * p.most * p.most)
    }

    /// Whether a driven body presses harder here than it can.
    pub(super) fn is_overpressed(&self) -> bool {
        self.force_limit.is_some_and(|p| self.compliance == 0.0 && self.impulse.length_squared() > p.most * p.most)
    }

    /// Mean velocity change per impulse.
    pub(crate) fn compliance(&self) -> f64 {
        (self.along + self.stiff) * (1.0 / 3.0)
    }

    /// Velocity change per impulse.
    pub(crate) fn response(&self) -> DMat3 {
        self.k
    }

    /// Relative velocity at the contact.
    #[inline]
    pub(crate) fn velocity(&self, members: &[SolverBody]) -> DVec3 {
        self.relative(|k| [members[k].v, members[k].w])
    }

    /// The same for members with these velocities.
    #[inline]
    pub(crate) fn relative(&self, of: impl Fn(usize) -> [DVec3; 2]) -> DVec3 {
        let at = |k: usize, arm: DVec3| {
            let [v, w] = of(k);
            v + w.cross(arm)
        };
        let u = at(self.a, self.arms[0]);
        self.b.map_or(u, |b| u - at(b, self.arms[1]))
    }

    /// The velocity at the contact that must be removed: the slip, and the difference between the normal velocity and
    /// its target.
    #[inline]
    pub(super) fn residual(&self, members: &[SolverBody]) -> DVec3 {
        self.velocity(members) + self.bias - self.normal * self.target
    }

    #[inline]
    pub(crate) fn push(&self, members: &mut [SolverBody], impulse: DVec3) {
        let a = &mut members[self.a];
        a.v += impulse * a.inverse_mass;
        a.w += a.inverse_inertia * self.arms[0].cross(impulse);
        if let Some(b) = self.b {
            let b = &mut members[b];
            b.v -= impulse * b.inverse_mass;
            b.w -= b.inverse_inertia * self.arms[1].cross(impulse);
        }
    }

    /// Gives this contact the impulse that it needs while all others stay as they are. Returns the resulting change of
    /// velocity.
    #[inline]
    pub(crate) fn solve(&mut self, members: &mut [SolverBody], look: SlipSearch) -> f64 {
        let u = self.velocity(members) + self.bias + self.impulse * self.compliance;
        let n = self.normal;
        let wanted = n * self.target - u;
        if self.hold != ConstraintKind::Coulomb {
            self.is_right = true;
            let free = match self.hold {
                ConstraintKind::DryFriction(_) => n * (wanted.dot(n) / self.along),
                ConstraintKind::Across => {
                    let (all, along) = (self.k_inverse * wanted, self.k_inverse * n);
                    all - along * (all.dot(n) / along.dot(n))
                }
                _ => self.k_inverse * wanted,
            };
            let next = self.project(self.impulse + free).0;
            let change = next - self.impulse;
            self.push(members, change);
            self.impulse = next;
            return change.length() * self.along;
        }
        if self.impulse == DVec3::ZERO && wanted.dot(n) <= 0.0 {
            self.is_right = true;
            return 0.0;
        }
        let next = self.sliding_as_held(u).or_else(|| self.still_sliding(u, look)).unwrap_or_else(|| {
            // It sticks if the impulse that leaves no slip lies in the cone; otherwise it slides.
            let next = self.impulse + self.k_inverse * wanted;
            let load = next.dot(n);
            let across = (next - n * load).length_squared();
            self.slides = load <= 0.0 || across > self.friction * self.friction * load * load;
            self.is_right = true;
            if self.slides { self.sliding(u - self.k * self.impulse, look) } else { next }
        });
        let change = next - self.impulse;
        self.push(members, change);
        self.impulse = next;
        change.length() * self.along
    }

    /// The nearest impulse that a joint's contact allows, and whether the contact gives way along its normal.
    pub(crate) fn project(&self, impulse: DVec3) -> (DVec3, bool) {
        match self.hold {
            ConstraintKind::DryFriction(most) => {
                let along = impulse.dot(self.normal);
                (self.normal * along.clamp(-most, most), along.abs() > most)
            }
            ConstraintKind::Across => (impulse - self.normal * impulse.dot(self.normal), false),
            _ => (impulse, false),
        }
    }

    /// The unit vector of its slip, if it slides under load.
    pub(crate) fn slip_direction(&self) -> Option<DVec3> {
        let load = self.impulse.dot(self.normal);
        let across = self.impulse - self.normal * load;
        if self.slides && load > 0.0 { (-across).try_normalize() } else { None }
    }

    /// Friction, if the impulse is at the edge of its cone, which means that the contact slides.
    pub(super) fn friction_at_edge(&self) -> Option<DVec3> {
        let load = self.impulse.dot(self.normal);
        let across = self.impulse - self.normal * load;
        (load > 0.0 && across.length() >= self.friction * load * (1.0 - CONE_EDGE)).then_some(across)
    }

    /// Notes that its impulse is a solution, and whether it slides.
    pub(super) fn note_solved(&mut self) {
        self.slides = self.hold == ConstraintKind::Coulomb && self.friction_at_edge().is_some();
        (self.is_right, self.is_known) = (true, true);
    }

    /// Makes friction oppose slip in this direction as long as there is any.
    pub(crate) fn hold_slip(&mut self, direction: Option<DVec3>) {
        let n = self.normal;
        self.held_slip = direction.and_then(|d| (d - n * d.dot(n)).try_normalize());
    }

    /// The impulse against the held slip, if that slip goes on.
    fn sliding_as_held(&mut self, u: DVec3) -> Option<DVec3> {
        let s = self.held_slip?;
        let free = u - self.k * self.impulse;
        let missing = self.target - free.dot(self.normal);
        (self.slides, self.is_right) = (true, true);
        if missing <= 0.0 {
            return Some(DVec3::ZERO);
        }
        let gain = self.along - self.friction * self.kn.dot(s);
        if gain > WEDGED_RESPONSE * self.along {
            let next = (self.normal - s * self.friction) * (missing / gain);
            if (free + self.k * next).dot(s) > 0.0 {
                return Some(next);
            }
        }
        // It comes to a stop or turns round.
        self.held_slip = None;
        None
    }

    /// The impulse of a contact that slid when it was last solved and goes on sliding; Coulomb's law holds with it.
    #[inline]
    fn still_sliding(&mut self, u: DVec3, look: SlipSearch) -> Option<DVec3> {
        let mut slip = self.slip.filter(|_| self.slides)?;
        let free = u - self.k * self.impulse;
        let missing = self.target - free.dot(self.normal);
        self.is_right = true;
        if missing <= 0.0 {
            return Some(DVec3::ZERO);
        }
        let slide = slip.slide(free, &self.asked(missing, look)).filter(|s| s.goes_on)?;
        (self.slip, self.is_right) = (Some(slip), slide.is_right);
        Some((self.normal - slide.slip * self.friction) * slide.load)
    }

    fn asked(&self, missing: f64, SlipSearch { turn, rounds }: SlipSearch) -> SlipProblem {
        SlipProblem { friction: self.friction, missing, along: self.along, stiff: self.stiff, turn, rounds }
    }

    /// The impulse after which a contact with velocity `free` that cannot stick obeys Coulomb's law: friction opposes
    /// the slip that is left.
    fn sliding(&mut self, free: DVec3, look: SlipSearch) -> DVec3 {
        let n = self.normal;
        let missing = self.target - free.dot(n);
        if missing <= 0.0 {
            return DVec3::ZERO;
        }
        if self.slip.is_none() && self.friction > 0.0 {
            let across = free - n * free.dot(n) + (self.kn - n * self.along) * (missing / self.along);
            self.slip = Slip::new(across, n, &self.k, self.kn);
        }
        let asked = self.asked(missing, look);
        let Some(slip) = &mut self.slip else { return n * (missing / self.along) };
        let Some(slide) = slip.slide(free, &asked) else { return self.wedged(free, missing) };
        self.is_right = slide.is_right;
        (n - slide.slip * self.friction) * slide.load
    }

    /// The sticking impulse if the cone allows its normal part, otherwise an impulse without friction: neither gains
    /// energy.
    fn wedged(&self, free: DVec3, missing: f64) -> DVec3 {
        let n = self.normal;
        let stick = self.k_inverse * (n * missing - (free - n * free.dot(n)));
        let load = stick.dot(n);
        let side = stick - n * load;
        if load > 0.0 && side.length() <= self.friction * load { stick } else { n * (missing / self.along) }
    }
}

/// How hard a driven body presses at a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForceLimit {
    /// Largest impulse in N s.
    pub(super) most: f64,
    /// Velocity per impulse by which the contact gives way if a larger one would be needed.
    pub(crate) compliance: f64,
}

/// The matrix that gives the cross product of this vector with another.
#[inline]
pub(crate) fn cross(r: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, r.z, -r.y), DVec3::new(-r.z, 0.0, r.x), DVec3::new(r.y, -r.x, 0.0))
}

/// Velocity change at `arm` per impulse there, in world axes.
#[inline]
pub(crate) fn response(inverse_mass: f64, inverse_inertia: &DMat3, arm: DVec3) -> DMat3 {
    let cross = cross(arm);
    DMat3::from_diagonal(DVec3::splat(inverse_mass)) - cross * *inverse_inertia * cross
}

/// A point of contact of two members.
pub(crate) fn pair_contact(
    members: &[SolverBody],
    [a, b]: [usize; 2],
    arms: [DVec3; 2],
    normal: DVec3,
    friction: f64,
) -> ContactConstraint {
    let (m, n) = (&members[a], &members[b]);
    let k =
        response(m.inverse_mass, &m.inverse_inertia, arms[0]) + response(n.inverse_mass, &n.inverse_inertia, arms[1]);
    ContactConstraint::new(a, Some(b), arms, normal, friction, k)
}

impl SolverBody {
    /// A body as the solver sees it, with these velocities.
    pub(crate) fn of(spec: &BodyDef, r: &DMat3, v: DVec3, w: DVec3) -> SolverBody {
        let (inverse_mass, inverse_inertia) =
            if spec.is_driven() { (0.0, DMat3::ZERO) } else { (1.0 / spec.mass, spec.inertia.inverse(r)) };
        SolverBody {
            inverse_mass,
            inverse_inertia,
            v,
            w,
            bounding_radius: spec.bounding_radius,
            last: [DVec3::ZERO; 2],
        }
    }
}
