//! Impulses of several lasting contacts at once: Newton's method on the residual of Coulomb's law.
//!
//! With the velocity `w` to be removed at a contact and a small compliance `ε`, impulses `f` obey unilateral contact
//! and Coulomb's law exactly where `f = P(f − w/ε)`. `P` is the projection onto the cone that keeps the normal part (De
//! Saxcé & Feng, Math. Comput. Modelling 28 (1998); Alart & Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991)).
//! Momentum ties velocities to impulses. Each round linearises `P` where it is, solves for all velocities at once, and
//! takes the impulses that follow. The velocity left is then `ε` times the change of the impulses, so redundant
//! contacts, stacks and mass ratios of ten thousand converge in a few rounds; Gauss–Seidel needs thousands. The matrix
//! is sparse ([`BlockLu`]).
//!
//! Where contacts slide or wedge, rounds may alternate without end. Then a convex problem replaces the law. A shift
//! `µ |slip|` is added to the velocity along the normal, and held. The same law is then the projection onto the cone
//! itself (De Saxcé & Feng), the impulses are those of least energy, and rounds with a line search always converge
//! (Castro et al., IEEE Trans. Robot. 38 (2022)). The shift is renewed from the slip found until nothing changes
//! (Acary, Cadoux, Lemaréchal & Malick, Z. Angew. Math. Mech. 91 (2011)). In bodies that wedge each other, each shift
//! may overshoot by more than the last; then only a part of the change is taken, which is estimated from the last two
//! (Aitken's relaxation: Küttler & Wall, Comput. Mech. 43 (2008)).

use super::block_lu::BlockLu;
use super::contact_constraint::{ConstraintKind, ContactConstraint, SolverBody};
use super::friction_cone::{ConeProjection, cone, coulomb, guessed, trial};
use super::nncg::Nncg;
use crate::rigid::tolerances::{
    COMPLIANCE_RATIO, CONTACT_COMPLIANCE, CONVEX_ACCURACY, CONVEX_ROUNDS, DRIVEN_MASS_RATIO, FEW_CHANGES,
    FIRST_COMPLIANCE, LAW_ERROR, LEAST_AITKEN_FACTOR, LEAST_COMPLIANCE, LINE_SEARCH_POINTS, LINE_SEARCH_SLOPE,
    LONGEST_CYCLE, LOST_ROUND_CHANGES, MAX_LOST_ROUNDS, MAX_NEWTON_BODIES, MAX_NEWTON_ROUNDS,
    MAX_NEWTON_ROUNDS_WITH_FACES, SHIFT_RENEWALS, TRAPPED_LAW_ERROR, TRAPPED_SHIFT_RENEWALS, VELOCITY_ROUNDING,
};
use glam::{DMat3, DVec3};

/// Work space.
#[derive(Debug, Default)]
pub(crate) struct Newton {
    blocks: BlockLu,
    inertia: Vec<DMat3>,
    /// Velocities of the members that belong to the contacts' impulses.
    starts: Vec<[DVec3; 2]>,
    /// Each contact's projection onto its cone.
    projected: Vec<ConeProjection>,
    /// Added to each contact's normal velocity where cones replace Coulomb's law.
    pub(super) shifts: Vec<f64>,
    /// By how much the slips asked for other shifts when these were renewed, and the part of that which was taken.
    overdue: Vec<f64>,
    part: f64,
    /// The mass used for members that nothing moves.
    immovable: f64,
    /// Whether the plain rule has been given up for a problem of the same step.
    pub(crate) is_hard: bool,
    /// Whether the last problem was not solved by the plain rule, and so only roughly, if at all.
    pub(crate) is_rough: bool,
    /// Whether driven bodies gave way in a problem of the same step.
    pub(crate) gives_way: bool,
    /// Compliance of the convex problem.
    compliance: f64,
    /// Velocities at the contacts, and their changes in a round.
    lines: Vec<[DVec3; 2]>,
    impulses: Vec<DVec3>,
    /// Whether the problem is that of a large island, whose impulses are found by conjugate gradients instead.
    pub(crate) in_rounds: bool,
    /// Whether the problem is that of a time-stepped island: then rounds replace the convex problem.
    pub(crate) is_time_stepped: bool,
    /// How many rounds at most, there.
    pub(crate) rounds_with_faces: u32,
    /// Whether the preset's rounds are too few: many bodies are nearly still, or bear each other in more levels than
    /// rounds carry loads through.
    pub(crate) is_demanding: bool,
    pub(super) nncg: Nncg,
}

impl Newton {
    /// Rounds until no body's velocity changes by more than `enough` in the last one; convergence is quadratic. If that
    /// fails, until no velocity breaks Coulomb's law by more than `coarse`. Returns whether it is solved. In any case,
    /// impulses and velocities are consistent to rounding.
    pub(crate) fn solve(
        &mut self,
        contacts: &mut [ContactConstraint],
        members: &mut [SolverBody],
        enough: f64,
        coarse: f64,
    ) -> bool {
        if members.len() > MAX_NEWTON_BODIES {
            return false;
        }
        let fastest = members.iter().map(|m| m.v.length() + m.w.length() * m.bounding_radius).fold(0.0, f64::max);
        let is_soft = contacts.iter().any(|c| c.compliance > 0.0);
        let (lawless, shifts) =
            if is_soft { (TRAPPED_LAW_ERROR, TRAPPED_SHIFT_RENEWALS) } else { (LAW_ERROR, SHIFT_RENEWALS) };
        let (enough, coarse) = (enough.max(VELOCITY_ROUNDING * fastest), coarse.max(lawless * fastest));
        self.order(contacts, members);
        self.is_rough = self.is_hard || !self.rounds(contacts, members, enough);
        if !self.is_rough {
            return true;
        }
        if self.is_time_stepped {
            self.is_hard = true;
            return false;
        }
        let mut compliance = FIRST_COMPLIANCE;
        for renewal in 0..shifts {
            self.renew_shifts(contacts, members, renewal);
            if !self.convex_relaxation(contacts, members, compliance, CONVEX_ACCURACY * coarse) {
                break;
            }
            if contacts.iter().any(ContactConstraint::is_overpressed) {
                return false;
            }
            if contacts.iter().all(|c| is_lawful(c, members, coarse)) {
                // The plain rule takes few rounds from here, if it converges.
                self.is_rough = !self.rounds(contacts, members, enough);
                return true;
            }
            compliance = (COMPLIANCE_RATIO * compliance).max(LEAST_COMPLIANCE);
        }
        false
    }

    /// Orders the equations of a problem, and notes the members' inertia.
    pub(crate) fn order(&mut self, contacts: &[ContactConstraint], members: &[SolverBody]) {
        self.blocks.order(contacts, members.len());
        self.inertia.clear();
        let heaviest = members.iter().map(mass).filter(|m| m.is_finite()).fold(0.0, f64::max);
        self.immovable = DRIVEN_MASS_RATIO * heaviest;
        let immovable = self.immovable;
        self.inertia.extend(members.iter().map(|m| {
            if is_immovable(m) {
                DMat3::from_diagonal(DVec3::splat(immovable * m.bounding_radius * m.bounding_radius))
            } else {
                m.inverse_inertia.inverse()
            }
        }));
    }

    /// Newton's rounds on Coulomb's law. Returns whether it is solved; if not, nothing is changed.
    fn rounds(&mut self, contacts: &mut [ContactConstraint], members: &mut [SolverBody], enough: f64) -> bool {
        self.save(contacts, members, guessed);
        let (mut went, mut lost) = ([0; LONGEST_CYCLE], 0);
        let most = if self.is_time_stepped { MAX_NEWTON_ROUNDS_WITH_FACES } else { MAX_NEWTON_ROUNDS };
        for _ in 0..most {
            let mut states = 0;
            for p in &self.projected {
                states = p.mixed_into(states);
            }
            if states != went[0] && went[1..].contains(&states) {
                break;
            }
            went.rotate_right(1);
            went[0] = states;
            self.assemble(contacts, members);
            if self.blocks.eliminate().is_none() {
                break;
            }
            self.advance(members, 1.0);
            if !members.iter().all(|m| m.v.is_finite() && m.w.is_finite()) {
                break;
            }
            self.impulses.clear();
            let mut changed = 0;
            for (c, p) in contacts.iter().zip(&mut self.projected) {
                let residual = c.residual(members);
                let lawful = coulomb(c, residual);
                self.impulses.push(lawful.impulse);
                let next = if lawful.reverses(p, c) {
                    let (impulse, stiff) = trial(c, residual, CONTACT_COMPLIANCE);
                    ConeProjection::sticking(c, impulse, stiff)
                } else {
                    lawful
                };
                changed += usize::from(next.state() != p.state());
                *p = next;
            }
            if let Some(change) = self.take_impulses(contacts, members, enough) {
                if change * CONTACT_COMPLIANCE <= enough {
                    return true;
                }
                self.save(contacts, members, guessed);
            }
            lost += usize::from(changed > FEW_CHANGES && changed as f64 > LOST_ROUND_CHANGES * contacts.len() as f64);
            if lost > MAX_LOST_ROUNDS {
                self.is_hard = !self.is_time_stepped;
                break;
            }
        }
        self.restore(members);
        false
    }

    /// Brings the shifts nearer to those of the present slips: all the way at first, later by Aitken's part.
    fn renew_shifts(&mut self, contacts: &[ContactConstraint], members: &[SolverBody], renewal: usize) {
        if renewal == 0 {
            self.shifts.clear();
            self.overdue.clear();
            self.part = 1.0;
        }
        self.shifts.resize(contacts.len(), 0.0);
        self.overdue.resize(contacts.len(), 0.0);
        let (mut along, mut square) = (0.0, 0.0);
        for ((c, &shift), overdue) in contacts.iter().zip(&self.shifts).zip(&mut self.overdue) {
            let residual = c.residual(members) + c.impulse * c.compliance;
            let now = c.friction * (residual - c.normal * residual.dot(c.normal)).length() - shift;
            along -= *overdue * (now - *overdue);
            square += (now - *overdue) * (now - *overdue);
            *overdue = now;
        }
        if renewal >= 2 && square > 0.0 {
            self.part = (self.part * along / square).clamp(LEAST_AITKEN_FACTOR, 1.0);
        }
        for (shift, overdue) in self.shifts.iter_mut().zip(&self.overdue) {
            *shift = (*shift + overdue * self.part).max(0.0);
        }
    }

    /// Solves the convex problem with the present shifts. Returns whether that succeeds; if not, nothing is changed.
    pub(super) fn convex_relaxation(
        &mut self,
        contacts: &mut [ContactConstraint],
        members: &mut [SolverBody],
        compliance: f64,
        enough: f64,
    ) -> bool {
        self.save(contacts, members, coulomb);
        self.compliance = compliance;
        for _ in 0..CONVEX_ROUNDS {
            self.project_onto_cones(contacts, members);
            self.assemble(contacts, members);
            if self.blocks.eliminate().is_none() {
                break;
            }
            let Some(part) = self.line_search(contacts, members) else { break };
            self.advance(members, part);
            self.impulses.clear();
            let shifted = contacts.iter().zip(&self.shifts);
            self.impulses.extend(
                shifted.map(|(c, &shift)| cone(c, c.residual(members) + c.normal * shift, self.compliance).impulse),
            );
            if self.take_impulses(contacts, members, enough).is_some() {
                return true;
            }
        }
        self.restore(members);
        false
    }

    /// Returns to the velocities that belong to the contacts' impulses.
    fn restore(&self, members: &mut [SolverBody]) {
        for (m, start) in members.iter_mut().zip(&self.starts) {
            [m.v, m.w] = *start;
        }
    }

    fn project_onto_cones(&mut self, contacts: &[ContactConstraint], members: &[SolverBody]) {
        for ((c, p), &shift) in contacts.iter().zip(&mut self.projected).zip(&self.shifts) {
            *p = cone(c, c.residual(members) + c.normal * shift, self.compliance);
        }
    }

    /// The fraction of the change at which the energy along it is nearly least; none if the change is not finite.
    fn line_search(&mut self, contacts: &[ContactConstraint], members: &[SolverBody]) -> Option<f64> {
        // Energy of the members along the change: its slope is `first + second · part`.
        let (mut first, mut second) = (0.0, 0.0);
        for (k, (m, inertia)) in members.iter().zip(&self.inertia).enumerate().filter(|(_, (m, _))| !is_immovable(m)) {
            let ([v, w], [v0, w0]) = (self.blocks.solution(k), self.starts[k]);
            first += v.dot(m.v - v0) / m.inverse_mass + w.dot(*inertia * (m.w - w0));
            second += v.length_squared() / m.inverse_mass + w.dot(*inertia * w);
        }
        self.lines.clear();
        for (c, &shift) in contacts.iter().zip(&self.shifts) {
            let change = c.relative(|k| self.blocks.solution(k));
            self.lines.push([c.residual(members) + c.normal * shift, change]);
        }
        let slope = |part: f64| {
            let work = |(c, line): (&ContactConstraint, &[DVec3; 2])| {
                line[1].dot(cone(c, line[0] + line[1] * part, self.compliance).impulse - c.impulse)
            };
            first + second * part - contacts.iter().zip(&self.lines).map(work).sum::<f64>()
        };
        let (mut low, mut high) = ((0.0, slope(0.0)), (1.0, slope(1.0)));
        if !low.1.is_finite() || !high.1.is_finite() {
            return None;
        }
        let enough = LINE_SEARCH_SLOPE * low.1.abs();
        if high.1 <= enough || low.1 >= 0.0 {
            return Some(1.0);
        }
        let mut part = 1.0;
        for _ in 0..LINE_SEARCH_POINTS {
            // Where the chord is zero, but at least a tenth away from both ends.
            let chord = low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1);
            let margin = 0.1 * (high.0 - low.0);
            part = chord.clamp(low.0 + margin, high.0 - margin);
            let there = slope(part);
            if there.abs() <= enough {
                break;
            }
            if there < 0.0 {
                low = (part, there);
            } else {
                high = (part, there);
            }
        }
        Some(part)
    }

    /// Starts anew from impulses and velocities that belong to each other.
    fn save(
        &mut self,
        contacts: &[ContactConstraint],
        members: &[SolverBody],
        project: impl Fn(&ContactConstraint, DVec3) -> ConeProjection,
    ) {
        self.starts.clear();
        self.starts.extend(members.iter().map(|m| [m.v, m.w]));
        self.projected.clear();
        self.projected.extend(contacts.iter().map(|c| project(c, c.residual(members))));
    }

    fn advance(&self, members: &mut [SolverBody], part: f64) {
        for (k, m) in members.iter_mut().enumerate().filter(|(_, m)| !is_immovable(m)) {
            let [v, w] = self.blocks.solution(k);
            m.v += v * part;
            m.w += w * part;
        }
    }

    /// If the velocities that follow from the found impulses are within `enough` of those for which the cones were
    /// evaluated: gives contacts the impulses, and members these velocities, to the last bit. Returns by how much
    /// impulses have changed, as velocities at their contacts.
    fn take_impulses(
        &mut self,
        contacts: &mut [ContactConstraint],
        members: &mut [SolverBody],
        enough: f64,
    ) -> Option<f64> {
        for (m, start) in members.iter_mut().zip(&self.starts) {
            m.last = [m.v, m.w];
            [m.v, m.w] = *start;
        }
        let mut change = 0.0_f64;
        for (c, &impulse) in contacts.iter().zip(&self.impulses) {
            c.push(members, impulse - c.impulse);
            if c.compliance == 0.0 {
                change = change.max((impulse - c.impulse).length() * c.compliance());
            }
        }
        if !members.iter().all(|m| moved(m, m.last) <= enough) {
            for m in members.iter_mut() {
                [m.v, m.w] = m.last;
            }
            return None;
        }
        for (c, &impulse) in contacts.iter_mut().zip(&self.impulses) {
            c.impulse = impulse;
        }
        Some(change)
    }

    fn assemble(&mut self, contacts: &[ContactConstraint], members: &[SolverBody]) {
        self.blocks.clear();
        for (k, ((m, inertia), [v, w])) in members.iter().zip(&self.inertia).zip(&self.starts).enumerate() {
            let mass = if is_immovable(m) { self.immovable } else { mass(m) };
            // The momentum that the change so far takes of what the impulses bring.
            self.blocks.add_body(k, mass, inertia, [(*v - m.v) * mass, *inertia * (*w - m.w)]);
        }
        for (c, p) in contacts.iter().zip(&self.projected) {
            self.blocks.add_contact(c, p.impulse - c.impulse, &p.stiffness);
        }
    }
}

fn is_immovable(m: &SolverBody) -> bool {
    m.inverse_mass == 0.0
}

fn mass(m: &SolverBody) -> f64 {
    1.0 / m.inverse_mass
}

/// By how much a member's velocities differ from these.
fn moved(m: &SolverBody, [v, w]: [DVec3; 2]) -> f64 {
    (m.v - v).length().max((m.w - w).length() * m.bounding_radius)
}

/// Whether a contact's impulse is the one that Coulomb's law requires for a contact that moves like this, up to an
/// error that changes its velocity by `enough`.
fn is_lawful(c: &ContactConstraint, members: &[SolverBody], enough: f64) -> bool {
    let n = c.normal;
    let trial = c.impulse - (c.residual(members) + c.impulse * c.compliance) / c.compliance();
    if c.hold != ConstraintKind::Coulomb {
        return (c.project(trial).0 - c.impulse).length() * c.compliance() <= enough;
    }
    let load = trial.dot(n).max(0.0);
    let across = trial - n * trial.dot(n);
    let lawful = if load > 0.0 { n * load + across.clamp_length_max(c.friction * load) } else { DVec3::ZERO };
    (lawful - c.impulse).length() * c.compliance() <= enough
}
