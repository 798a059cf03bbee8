//! Impacts of rigid bodies, at one point or at several at once.
//!
//! A body that strikes at one point obeys Stronge's law ([`stronge_impulse`](crate::resolve::stronge_impulse)). Where
//! several points of one body on fixed parts, or of one pair of bodies, are struck at one instant, they are resolved at
//! once: their order plays no part, and a symmetric impact stays symmetric. A point that touches and is driven into its
//! partner by an impact elsewhere is struck next. Each point then parts at its restitution times its approach (Newton's
//! rule), points that touch without approach do not approach afterwards, and impulses lie in Coulomb's cones: Moreau,
//! "Unilateral contact and dry friction in finite freedom dynamics" (1988), solved to rounding. Deviation: Newton's
//! rule can make energy where points slide, so the restitutions are multiplied by the largest factor with which energy
//! does not grow. With factor 0, friction and contact only take energy.
//!
//! The same holds for several pairs that are struck at one instant and share bodies (`instant.rs`). Pairs that touch
//! without approach are no part of it: what an impact drives together is struck next, as it passes from body to body.
//! So the balls of a cradle pass it on.

use crate::material::{Law, Scatter};
use crate::mechanics::{Impact, Other};
use crate::resolve::{ContactMatrix, stronge_impulse_with_grip};
use crate::rigid::solver::contact_constraint::{ContactConstraint, SolverBody};
use crate::rigid::solver::force_limit::limit_driven;
use crate::rigid::solver::newton::Newton;
use crate::rigid::solver::{SolverTolerance, gauss_seidel, solve};
use crate::rigid::tolerances::{
    GRAZE, IMPACT_SOLVED, MAX_IMPACT_SWEEPS, NO_IMPACT_ENERGY, RESTITUTION_GIVEN_UP, RESTITUTION_HALVINGS,
    UNSTRUCK_APPROACH,
};
use glam::{DMat3, DVec3};
use std::cell::Cell;

/// A point that an impact may strike.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImpactPoint {
    pub(crate) contact: ContactConstraint,
    /// The restitution with which it parts.
    pub(crate) restitution: f64,
    /// Slower approach is left to lasting contact.
    pub(crate) least: f64,
    /// Normal relative speed before the impact, in m/s; negative if the gap opens.
    pub(crate) approach: f64,
    /// Whether the contact lasts from here on.
    pub(crate) lasting: bool,
    pub(crate) other: Other,
    /// The joint whose limit it is; none for a contact.
    pub(super) joint: Option<usize>,
    /// Rebound speed in m/s up to which the contact lasts, and how its law scatters.
    pub(super) settles: f64,
    pub(super) scatter: Scatter,
    /// Whether it has a restitution of its own, and perhaps a normal.
    pub(super) is_scattered: bool,
    /// The normal of this impact, if that is another one than that of the surfaces.
    pub(super) tilted: Option<DVec3>,
    /// Its place among the points of an impact with such normals.
    pub(super) number: usize,
}

impl ImpactPoint {
    /// A point with this approach. `settles` is the rebound speed up to which a contact of its bodies lasts.
    /// `chattering` says whether it lasts however fast the bodies part, unless nothing is lost in an impact: such
    /// impacts may go on for ever, or the bodies may part in the end.
    pub(crate) fn new(
        contact: ContactConstraint,
        approach: f64,
        law: &Law,
        settles: f64,
        chattering: bool,
        other: Other,
    ) -> Self {
        let lasting = Self::lasts(approach, law, settles, chattering);
        let restitution = if lasting { 0.0 } else { law.restitution };
        let least = if lasting { UNSTRUCK_APPROACH * settles } else { 0.0 };
        Self {
            contact,
            restitution,
            least,
            approach,
            lasting,
            other,
            joint: None,
            settles,
            scatter: law.scatter,
            is_scattered: false,
            tilted: None,
            number: 0,
        }
    }

    /// Whether a contact lasts after an impact.
    pub(crate) fn lasts(approach: f64, law: &Law, settles: f64, chattering: bool) -> bool {
        law.restitution * approach <= settles || chattering && law.restitution < 1.0
    }

    /// Reports the impulse, if the point was struck.
    pub(crate) fn report(&self, time: f64, body: usize, x: DVec3, report: &mut dyn FnMut(&Impact)) {
        let c = &self.contact;
        if c.impulse != DVec3::ZERO {
            let (point, lasting) = (x + c.arms[0], self.lasting);
            report(&Impact {
                time,
                body,
                other: self.other,
                point,
                normal: c.normal,
                impulse: c.impulse,
                approach: self.approach,
                lasting,
            });
        }
    }

    pub(super) fn is_struck(&self) -> bool {
        self.approach > self.least
    }
}

/// The same, over the fastest of all speeds, where several pairs are struck: the order of bodies must not be seen.
/// Default 1e-15.
const FINELY_SOLVED: f64 = 1e-15;

/// The same where sweeps have come to an end: if a further one changes more, impulses have not been found. Default
/// 1e-9.
const ROUGHLY_SOLVED: f64 = 1e-9;

/// Impulses of an impact at the points that touch, of which at least one is struck. The members come with the
/// velocities before it and leave with those after it. `turn` is the preset's `slip_turn`.
pub(super) fn resolve_impact(points: &mut [ImpactPoint], members: &mut [SolverBody], turn: f64) {
    if points.iter().any(|p| p.tilted.is_some()) {
        resolve_tilted(points, &mut [], members, |points, _, members| {
            resolve_untilted(points, members, turn);
            true
        });
    } else {
        resolve_untilted(points, members, turn);
    }
}

fn resolve_untilted(points: &mut [ImpactPoint], members: &mut [SolverBody], turn: f64) {
    // The fastest first: labels of bodies and points play no part.
    points.sort_by(|p, q| q.approach.total_cmp(&p.approach));
    if points.iter().filter(|p| p.is_struck()).count() == 1 {
        let first = &mut points[0];
        let u = first.contact.velocity(members);
        first.contact.impulse = impulse(&first.contact, u, first.restitution, turn);
        let struck = first.contact;
        struck.push(members, struck.impulse);
    } else {
        resolve_simultaneous_impact(points, &mut [], members);
    }
}

/// A contact about another normal, before it is solved; `u` is the velocity there up to now.
fn about(contact: &ContactConstraint, normal: DVec3, u: DVec3) -> ContactConstraint {
    let ContactConstraint { a, b, arms, friction, stiction, .. } = *contact;
    let mut fresh = ContactConstraint::new(a, b, arms, normal, friction, contact.response());
    fresh.stiction = stiction;
    if let Some(stiction) = &mut fresh.stiction {
        let slip = u - normal * u.dot(normal);
        (stiction.slip, stiction.slip_after) = (slip, slip);
    }
    fresh
}

/// Resolves an impact at points of which some have normals of their own: first about these, then, where bodies still
/// approach, about those of the surfaces. `resolve` resolves an impact about given normals and says whether it could;
/// if not, velocities are of no use. It may change the order of the points.
pub(super) fn resolve_tilted(
    points: &mut [ImpactPoint],
    joints: &mut [ContactConstraint],
    members: &mut [SolverBody],
    mut resolve: impl FnMut(&mut [ImpactPoint], &mut [ContactConstraint], &mut [SolverBody]) -> bool,
) -> bool {
    let before: Vec<(ContactConstraint, f64)> = points.iter().map(|p| (p.contact, p.approach)).collect();
    let mut sums = vec![DVec3::ZERO; points.len()];
    let mut held = vec![DVec3::ZERO; joints.len()];
    points.iter_mut().zip(0..).for_each(|(p, number)| p.number = number);
    let fastest = members.iter().map(SolverBody::fastest).fold(0.0, f64::max);
    let mut is_resolved = true;
    for is_tilted in [true, false] {
        for p in &mut *points {
            let (contact, _) = &before[p.number];
            let (u, normal) = (contact.velocity(members), p.tilted.filter(|_| is_tilted).unwrap_or(contact.normal));
            (p.contact, p.approach) = (about(contact, normal, u), -u.dot(normal));
        }
        joints.iter_mut().for_each(|joint| joint.impulse = DVec3::ZERO);
        let is_due = |p: &ImpactPoint| {
            if is_tilted { p.is_struck() } else { p.tilted.is_some() && p.approach > GRAZE * fastest }
        };
        if points.iter().any(is_due) {
            is_resolved = resolve(points, joints, members);
            points.iter().for_each(|p| sums[p.number] += p.contact.impulse);
            held.iter_mut().zip(&*joints).for_each(|(sum, joint)| *sum += joint.impulse);
        }
        if !is_resolved {
            break;
        }
    }
    for p in points {
        (p.contact, p.approach) = before[p.number];
        p.contact.impulse = sums[p.number];
    }
    joints.iter_mut().zip(held).for_each(|(joint, sum)| joint.impulse = sum);
    is_resolved
}

/// The same for members that joints hold; the joints' rows keep their velocities at 0. Returns false if the impulses of
/// several pairs were not found, as may happen where one body is far heavier than another.
pub(super) fn resolve_articulated_impact(
    points: &mut [ImpactPoint],
    joints: &mut [ContactConstraint],
    members: &mut [SolverBody],
) -> bool {
    if points.iter().any(|p| p.tilted.is_some()) {
        return resolve_tilted(points, joints, members, |points, joints, members| {
            points.sort_by(|p, q| q.approach.total_cmp(&p.approach));
            resolve_simultaneous_impact(points, joints, members)
        });
    }
    points.sort_by(|p, q| q.approach.total_cmp(&p.approach));
    resolve_simultaneous_impact(points, joints, members)
}

fn resolve_simultaneous_impact(
    points: &mut [ImpactPoint],
    joints: &mut [ContactConstraint],
    members: &mut [SolverBody],
) -> bool {
    let start: Vec<SolverBody> = members.to_vec();
    let before: Vec<DVec3> = points.iter().map(|p| p.contact.velocity(members)).collect();
    let fastest = before.iter().map(|u| u.length()).fold(0.0, f64::max);
    let mut contacts: Vec<ContactConstraint> = points.iter().map(|p| p.contact).chain(joints.iter().copied()).collect();
    let mut newton = Newton::default();
    let ends = |p: &ImpactPoint| (p.contact.a, p.contact.b);
    let is_of_many = joints.is_empty() && points.iter().any(|p| ends(p) != ends(&points[0]));
    let scale = start.iter().map(SolverBody::fastest).fold(fastest, f64::max);
    let is_solved = Cell::new(true);
    let mut makes_energy = |part: f64, members: &mut [SolverBody]| {
        members.copy_from_slice(&start);
        for (c, p) in contacts.iter_mut().zip(&*points) {
            *c = p.contact;
            c.impulse = DVec3::ZERO;
            c.target = if p.is_struck() { part * p.restitution * p.approach } else { 0.0 };
        }
        contacts[points.len()..].copy_from_slice(joints);
        limit_driven(&mut contacts, members, 0.0, fastest);
        newton.is_hard = false;
        solve(
            &mut contacts,
            members,
            &mut newton,
            SolverTolerance::new(IMPACT_SOLVED * fastest, fastest),
            MAX_IMPACT_SWEEPS,
        );
        if is_of_many {
            let [fine, rough] = [FINELY_SOLVED, ROUGHLY_SOLVED].map(|part| SolverTolerance::new(part * scale, scale));
            let solved = gauss_seidel(&mut contacts, members, fine, MAX_IMPACT_SWEEPS)
                || gauss_seidel(&mut contacts, members, rough, 1);
            is_solved.set(solved);
        }
        let (mut energy, mut scale) = (0.0, 0.0);
        for (c, u) in contacts.iter().zip(&before) {
            energy += 0.5 * c.impulse.dot(*u + c.velocity(members));
            scale += c.impulse.length() * fastest;
        }
        energy > NO_IMPACT_ENERGY * scale
    };
    let is_joined = !joints.is_empty();
    let makes = makes_energy(1.0, members);
    if makes && is_solved.get() && (!is_joined || makes_energy(1.0 - RESTITUTION_GIVEN_UP, members)) {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..RESTITUTION_HALVINGS {
            let middle = 0.5 * (low + high);
            if makes_energy(middle, members) { high = middle } else { low = middle }
        }
        makes_energy(low, members);
    }
    let (of_points, of_joints) = contacts.split_at(points.len());
    joints.copy_from_slice(of_joints);
    for (p, c) in points.iter_mut().zip(of_points) {
        p.contact = *c;
    }
    is_solved.get()
}

/// Impulse at one point in world axes. The tangents follow the slip, so that an impact in a plane stays in that plane.
fn impulse(contact: &ContactConstraint, u: DVec3, restitution: f64, turn: f64) -> DVec3 {
    let n = contact.normal;
    let slip = u - n * u.dot(n);
    let speed = slip.length();
    let first = if speed > 0.0 { slip / speed } else { n.any_orthonormal_vector() };
    let frame = DMat3::from_cols(first, n.cross(first), n);
    let local = ContactMatrix(frame.transpose() * contact.response() * frame);
    frame * stronge_impulse_with_grip(&local, frame.transpose() * u, restitution, contact.frictions(), turn)
}
