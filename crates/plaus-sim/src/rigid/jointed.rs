//! Joints within the steps of lasting contact: rows beside those of contacts, which hold under any load.
//!
//! The impulses of the first kick bring together what a joint holds at the end of the drift, to within [`CLOSED`] of
//! the gap at which bodies touch, wherever it was before. So nothing drifts apart, however long the run. The impulses
//! of the second kick remove the velocity between the joint's points. This method is RATTLE (Andersen, J. Comput. Phys.
//! 52 (1983)), of second order, and symplectic as long as steps are equal. Both bodies get their impulses at one point,
//! so linear and angular momentum stay constant to rounding. Half way through a step, the points of a joint are apart
//! by the sag of a curve, `(ω h)²/8` of its arm.
//!
//! A hinge holds two points of its axis, a weld three; their redundant parts share the load. Dry friction is a row of
//! limited size along one direction, at a lever from the axis. A limit is a contact without friction there.

use super::Rigid;
use super::body::{Pose, Turning};
use super::coulomb::{Contact, Hold, Member, response};
use super::joint::{Bond, FIXED, Part, Row, Seat};
use super::scratch::{KEEP, PUSH, Place, RigidScratch, SHORTEST, TOUCHING};
use super::touch::to_middle;
use glam::{DMat3, DVec3};

/// Distance that a step may leave between the points that a joint holds together, over the gap at which its bodies
/// touch. Default 1e-3; the solver's error is smaller.
pub(super) const CLOSED: f64 = 1e-3;

/// Passes over the end of a step with joints: each leaves about half of the angle that the step turns by.
pub(super) const PASSES_OF_JOINTS: usize = 12;

/// Length of a step with joints over that of other steps. Default 0.25: at the standard preset, a joint is then apart
/// by about a thousandth of its arm half way through a step.
pub(super) const SWING: f64 = 0.25;

/// How often a step that would pass a limit is aimed at the limit again.
const AIMS: usize = 8;

/// How near to a limit a step aims, over the gap. Default 0.5: below [`KEEP`], so that the limit then counts as
/// touched.
const AIMED: f64 = 0.5;

/// What a step of `h` seconds leaves of the offset between a joint's points. It closes as fast as a fall through it
/// would, without gravity within a step of the usual length: what is in the way is pushed aside no faster.
fn left_apart(strength: f64, apart: DVec3, h: f64, nominal: f64) -> DVec3 {
    let far = apart.length();
    let speed = if strength > 0.0 { (2.0 * strength * far).sqrt() } else { far / nominal };
    if far <= speed * h { DVec3::ZERO } else { apart * (1.0 - speed * h / far) }
}

/// A row of a joint between members, or a member and the fixed world.
pub(super) fn row_contact(members: &[Member], row: &Row, seat: &Seat, hold: Hold) -> Contact {
    let response = |k: usize, arm: DVec3| response(members[k].inverse_mass, &members[k].inverse_inertia, arm);
    let other = row.b.map_or(DMat3::ZERO, |b| response(b, seat.arms[1]));
    let k = response(row.a, seat.arms[0]) + other;
    let mut contact = Contact::new(row.a, row.b, seat.arms, seat.normal, 0.0, k);
    contact.hold = hold;
    contact
}

impl Bond {
    /// Where a row is when its bodies are in these places; both get their impulse at one point.
    pub(super) fn seat(&self, part: Part, poses: [&Pose; 2]) -> Seat {
        let seat = match part {
            Part::Point(k) => Seat { normal: DVec3::Z, ..self.point(k, poses) },
            Part::Brake | Part::Stop { is_high: false } => self.lever(poses),
            Part::Stop { is_high: true } => {
                let seat = self.lever(poses);
                Seat { normal: -seat.normal, ..seat }
            }
        };
        Seat { arms: to_middle(seat.arms, poses.map(|p| p.x)), ..seat }
    }

    /// Which impulses a row may have within this many seconds.
    pub(super) fn hold(&self, part: Part, time: f64) -> Hold {
        match part {
            Part::Point(_) => Hold::Point,
            Part::Brake => Hold::Brake(self.hinge().map_or(0.0, |h| h.friction) * time / self.lever),
            Part::Stop { .. } => Hold::Coulomb,
        }
    }

    /// The distance to a limit and its rate of change, at the lever, and the restitution there.
    pub(super) fn stop(&self, is_high: bool, poses: [&Pose; 2]) -> (f64, f64, f64) {
        let rate = self.rate(poses) * self.lever;
        let restitution = self.hinge().map_or(0.0, |h| h.restitution);
        (self.room(is_high, poses), if is_high { -rate } else { rate }, restitution)
    }
}

impl Rigid {
    /// Gap at which a limit of a joint is touched.
    pub(super) fn stop_gap(&self, bond: &Bond) -> f64 {
        self.specs[bond.joint.body].gap
    }

    /// Rebound speed at its lever up to which a joint stays at a limit.
    pub(super) fn stop_settle_speed(&self, bond: &Bond, restitution: f64) -> f64 {
        let settle = (self.accuracy.settle * (1.0 - restitution)).max((2.0 * self.accuracy.gap).sqrt());
        settle * self.specs[bond.joint.body].speed
    }
}

impl RigidScratch {
    /// The poses of a joint's bodies, taken from their places by `pose`.
    fn poses<'p>(&'p self, row: &Row, pose: impl Fn(&'p Place) -> &'p Pose) -> [&'p Pose; 2] {
        [pose(&self.places[row.a]), row.b.map_or(&FIXED, |b| pose(&self.places[b]))]
    }

    /// Finds the rows of the joints that hold a group's bodies: all of their points, their brakes, and the limits that
    /// stay touched. All other limits are put in `stops`.
    pub(super) fn gather_joints(&mut self, world: &Rigid, group: &[u32], bodies: &[Turning]) {
        let (mut rows, mut stops) = (std::mem::take(&mut self.rows), std::mem::take(&mut self.stops));
        let at = |k: usize| self.places.iter().position(|p| p.body == k);
        for &k in group {
            for j in world.bonds_of(k as usize, bodies) {
                let bond = &world.joints.bonds[j];
                let Some(a) = at(k as usize).filter(|_| bond.joint.body == k as usize) else { continue };
                let row = |part| Row { joint: j, part, a, b: bond.joint.other.and_then(at) };
                rows.extend((0..bond.points.len()).map(|k| row(Part::Point(k))));
                if bond.hinge().is_some_and(|h| h.friction > 0.0) {
                    rows.push(row(Part::Brake));
                }
                if bond.limits().is_some() {
                    for is_high in [false, true] {
                        let stop = row(Part::Stop { is_high });
                        let (room, rate, e) = bond.stop(is_high, self.poses(&stop, |p| &p.start));
                        let limit = world.stop_settle_speed(bond, e);
                        let lasts = room <= TOUCHING * world.stop_gap(bond) && rate <= limit && -rate * e <= limit;
                        if lasts { &mut rows } else { &mut stops }.push(stop);
                    }
                }
            }
        }
        (self.rows, self.stops) = (rows, stops);
    }

    /// How large the error at the ends of a step may be where joints hold, in m.
    pub(super) fn most_apart(&self, world: &Rigid) -> f64 {
        let gap = |row: &Row| self.closed * world.stop_gap(&world.joints.bonds[row.joint]);
        self.rows.iter().map(gap).fold(f64::INFINITY, f64::min)
    }

    /// Adds the rows of joints to the contacts of members at their starts; brakes act for `time` seconds.
    pub(super) fn prepare_joints(&mut self, world: &Rigid, time: f64) {
        for row in &self.rows {
            let bond = &world.joints.bonds[row.joint];
            let seat = bond.seat(row.part, self.poses(row, |p| &p.start));
            self.contacts.push(row_contact(&self.members, row, &seat, bond.hold(row.part, time)));
        }
    }

    /// Says what each row has to achieve over a drift of `h` seconds that ends at `ends`: its points must meet there.
    /// Returns the largest error, over the allowed one.
    pub(super) fn aim_joints(&mut self, world: &Rigid, h: f64, ends: impl Fn(&Place, &Member) -> Pose) -> f64 {
        let first = self.contacts.len() - self.rows.len();
        let mut worst = 0.0_f64;
        let nominal = self.nominal;
        for (c, row) in self.contacts[first..].iter_mut().zip(&self.rows) {
            let bond = &world.joints.bonds[row.joint];
            let end = |k: usize| ends(&self.places[k], &self.members[k]);
            let ends = [end(row.a), row.b.map_or(FIXED, end)];
            let ends = [&ends[0], &ends[1]];
            let gap = world.stop_gap(bond);
            match row.part {
                Part::Point(k) => {
                    let starts = [&self.places[row.a].start, row.b.map_or(&FIXED, |b| &self.places[b].start)];
                    let left = left_apart(world.strength, bond.point(k, starts).apart, h.abs(), nominal);
                    let apart = bond.point(k, ends).apart - left;
                    if c.soft == 0.0 {
                        worst = worst.max(apart.length() / (self.closed * gap));
                    }
                    c.bias = apart / h - c.velocity(&self.members);
                }
                Part::Stop { is_high } => {
                    let starts = [row.a].into_iter().chain(row.b).map(|k| &self.places[k].start);
                    let mut starts = starts.chain([&FIXED]);
                    let room = bond.room(is_high, std::array::from_fn(|_| starts.next().unwrap_or(&FIXED)));
                    let spec = &world.specs[bond.joint.body];
                    c.target = ((KEEP * gap - room) / h).min(PUSH * world.accuracy.settle * spec.speed);
                    let mean = (bond.room(is_high, ends) - room) / h;
                    c.bias = c.normal * (mean - c.velocity(&self.members).dot(c.normal));
                }
                Part::Brake => {}
            }
        }
        worst
    }

    /// How far the points of a row are apart at the start.
    pub(super) fn apart(&self, world: &Rigid, row: &Row) -> f64 {
        let Part::Point(k) = row.part else { return 0.0 };
        world.joints.bonds[row.joint].point(k, self.poses(row, |p| &p.start)).apart.length()
    }

    /// Shortens a step after whose drift a joint's points are apart by more than the gap at which its bodies touch: it
    /// is too long for the passes.
    pub(super) fn tears(&self, world: &Rigid, h: f64) -> Option<f64> {
        let first = self.contacts.len() - self.rows.len();
        let is_torn = |(c, row): (&Contact, &Row)| {
            let (bond, Part::Point(k)) = (&world.joints.bonds[row.joint], row.part) else { return false };
            let [start, end] =
                [self.poses(row, |p| &p.start), self.poses(row, |p| &p.end)].map(|p| bond.point(k, p).apart);
            let left = left_apart(world.strength, start, h.abs(), self.nominal);
            c.soft == 0.0 && (end - left).length() > world.stop_gap(bond)
        };
        self.contacts[first..].iter().zip(&self.rows).any(is_torn).then_some(0.5)
    }

    /// A row of a joint at the end of a drift, and whether it goes on: a limit goes on if it is still touched. `time`
    /// is how long a brake acts.
    pub(super) fn row_at_end(&self, world: &Rigid, row: &Row, time: f64) -> (Contact, bool) {
        let bond = &world.joints.bonds[row.joint];
        let poses = self.poses(row, |p| &p.end);
        let contact = row_contact(&self.members, row, &bond.seat(row.part, poses), bond.hold(row.part, time));
        let goes_on = match row.part {
            Part::Stop { is_high } => bond.room(is_high, poses) <= TOUCHING * world.stop_gap(bond),
            _ => true,
        };
        (contact, goes_on)
    }

    /// Shortens a step so that it ends at the first limit that it would pass. Within a step, the room is nearly a
    /// parabola in time.
    pub(super) fn until_stop(&mut self, world: &Rigid, mut h: f64) -> f64 {
        if self.stops.is_empty() {
            return h;
        }
        self.closed = CLOSED;
        let whole = h;
        for _ in 0..AIMS {
            self.drift(world, h);
            let (mut first, mut back) = (h, None);
            for (k, row) in self.stops.iter().enumerate() {
                let Part::Stop { is_high } = row.part else { continue };
                let bond = &world.joints.bonds[row.joint];
                let aim = AIMED * world.stop_gap(bond);
                let (room, rate, _) = bond.stop(is_high, self.poses(row, |p| &p.start));
                let end = bond.room(is_high, self.poses(row, |p| &p.end));
                if end >= 0.0 {
                    continue;
                }
                let is_touched = room <= TOUCHING * world.stop_gap(bond);
                // room + rate t + bend t² reaches the aim, for the last time before the end.
                let (room, bend) = (room - aim, ((end - room) / h - rate) / h);
                let root = (rate * rate - 4.0 * bend * room).max(0.0).sqrt();
                let late = if rate > 0.0 { -(rate + root) / (2.0 * bend) } else { 2.0 * room / (root - rate) };
                let late = if late > 0.0 && late < h { late } else { 0.5 * h };
                if is_touched && late < SHORTEST * whole {
                    back = Some(k);
                }
                first = first.min(late);
            }
            if let Some(k) = back {
                // It is just being left, and something presses it back at once: it stays touched.
                let row = self.stops.remove(k);
                self.rows.push(row);
                continue;
            }
            if first == h {
                break;
            }
            h = first;
        }
        h
    }

    /// Notes what the impulses of joints between two bodies add to their angular momenta during the step.
    pub(super) fn pass_joints(&self, bodies: &mut [Turning], h: f64) {
        let first = self.contacts.len() - self.rows.len();
        for ((c, early), row) in self.contacts[first..].iter().zip(&self.firsts[first..]).zip(&self.rows) {
            if let Some(b) = row.b {
                self.pass(bodies, [row.a, b], early.impulse + c.impulse, h, f64::INFINITY);
            }
        }
    }
}
