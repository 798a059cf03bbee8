//! Impacts of bodies that joints hold. All bodies that hang together are solved at once, so that no joint is left with
//! a velocity.
//!
//! At the points that are struck, Newton's and Coulomb's laws hold, as they do where several points of a body are
//! struck at once (`simultaneous.rs`). Joints keep their points together, and limits that are touched let nothing
//! through.

use super::simultaneous::{ImpactPoint, resolve_articulated_impact};
use crate::material::Law;
use crate::mechanics::{Impact, Other};
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{Phase, Pose, RigidBodyState, Velocities};
use crate::rigid::joints::constraints::row_contact;
use crate::rigid::joints::joint::{JointRow, JointRowKind, WORLD_POSE};
use crate::rigid::scratch::RigidScratch;
use crate::rigid::solver::contact_constraint::{ContactConstraint, SolverBody};
use crate::rigid::tolerances::CONTACT_MARGIN;
use glam::DVec3;

/// Bodies that hang together, with the rows of the joints between them.
pub(crate) struct Articulation {
    pub(crate) bodies: Vec<usize>,
    poses: Vec<Pose>,
    pub(crate) rows: Vec<JointRow>,
}

impl Articulation {
    /// All bodies that joints connect to these. A driven body passes nothing on.
    pub(crate) fn of(world: &RigidWorld, seeds: &[usize], bodies: &[RigidBodyState]) -> Self {
        let mut all = seeds.to_vec();
        let mut next = 0;
        while let Some(&k) = all.get(next) {
            next += 1;
            if world.specs[k].is_driven() {
                continue;
            }
            for j in world.bonds_of(k, bodies) {
                let joint = &world.joints.bonds[j].joint;
                for other in [Some(joint.body), joint.other].into_iter().flatten() {
                    if !all.contains(&other) {
                        all.push(other);
                    }
                }
            }
        }
        all.sort_unstable();
        let at = |k: usize| all.iter().position(|&other| other == k);
        let mut rows = Vec::new();
        for (a, &k) in all.iter().enumerate() {
            for j in world.bonds_of(k, bodies).filter(|&j| world.joints.bonds[j].joint.body == k) {
                let bond = &world.joints.bonds[j];
                let row = |part| JointRow { joint: j, part, a, b: bond.joint.other.and_then(at) };
                // One of the two is driven, and the other is not part of this articulation.
                if bond.joint.other.is_some_and(|other| at(other).is_none()) {
                    continue;
                }
                rows.extend((0..bond.points.len()).map(|p| row(JointRowKind::Point(p))));
                rows.extend(bond.sides(bodies).map(|side| row(JointRowKind::Stop(side))));
            }
        }
        let poses = all.iter().map(|&k| bodies[k].pose()).collect();
        Self { bodies: all, poses, rows }
    }

    fn at(&self, body: usize) -> usize {
        self.bodies.iter().position(|&k| k == body).unwrap_or(0)
    }
}

impl RigidWorld {
    /// An impact of a body that joints hold, or of its partner: on a fixed part, or between two bodies. `None` if no
    /// joint holds either. Otherwise it returns what an impact of single bodies returns: whether there was one, and
    /// whether their contact lasts.
    pub(crate) fn hit_articulation(
        &self,
        index: usize,
        other: Other,
        linked: bool,
        bodies: &mut [RigidBodyState],
        report: &mut dyn FnMut(&Impact),
    ) -> Option<Option<bool>> {
        let seeds = if let Other::Body(k) = other { vec![index, k] } else { vec![index] };
        if self.joints.bonds.is_empty() || seeds.iter().all(|&k| self.bonds_of(k, bodies).next().is_none()) {
            return None;
        }
        let articulation = Articulation::of(self, &seeds, bodies);
        let member = |k: usize| {
            let pose = bodies[k].pose();
            SolverBody::of(&self.specs[k], &pose.r, pose.v, pose.w)
        };
        let own = member(index);
        let both = if let Other::Body(k) = other { [own, member(k)] } else { [own, own] };
        let mut points = match other {
            Other::Surface(surface) => self.points_on_part(index, &mut bodies[index], surface, &own),
            Other::Body(k) if self.never_touch([index, k], [&bodies[index], &bodies[k]]) => Vec::new(),
            Other::Body(k) => self.points_of_pair([index, k], [&bodies[index], &bodies[k]], &both, linked),
        };
        let is_chattering = seeds.iter().any(|&k| bodies[k].is_chattering());
        if !points.iter().any(ImpactPoint::is_struck) {
            // Found again and again without an approach, so their island has to deal with it.
            let is_stuck = matches!(other, Other::Body(_)) && !linked && is_chattering && !points.is_empty();
            return Some(is_stuck.then_some(true));
        }
        self.scatter(&mut points, &both, index, &mut bodies[index]);
        let struck = self.strike_articulation(&articulation, points, seeds.as_slice(), bodies);
        for k in seeds {
            self.list_touches(k, &mut bodies[k]);
        }
        let (time, x) = (bodies[index].path.t, bodies[index].path.x);
        let mut lasts = true;
        for point in struck.iter().filter(|p| p.joint.is_none()) {
            lasts &= point.lasting;
            point.report(time, index, x, report);
        }
        Some(Some(lasts))
    }

    /// The bodies that hang together with one or two bodies, without these.
    pub(crate) fn articulation_beside(&self, a: u32, b: Option<u32>, bodies: &[RigidBodyState]) -> Vec<u32> {
        let seeds: Vec<usize> = [a].into_iter().chain(b).map(|k| k as usize).collect();
        let all = Articulation::of(self, &seeds, bodies).bodies;
        all.into_iter().filter(|k| !seeds.contains(k)).map(|k| k as u32).collect()
    }

    /// Strikes points of a articulation's bodies together with its joints; gives the bodies their velocities after the
    /// impact, and breaks joints. The points' member indices refer to `seeds`.
    pub(super) fn strike_articulation(
        &self,
        articulation: &Articulation,
        mut points: Vec<ImpactPoint>,
        seeds: &[usize],
        bodies: &mut [RigidBodyState],
    ) -> Vec<ImpactPoint> {
        let member = |(&k, p): (&usize, &Pose)| SolverBody::of(&self.specs[k], &p.r, p.v, p.w);
        let mut members: Vec<SolverBody> = articulation.bodies.iter().zip(&articulation.poses).map(member).collect();
        for p in &mut points {
            p.contact.a = articulation.at(seeds[p.contact.a]);
            p.contact.b = p.contact.b.map(|b| articulation.at(seeds[b]));
        }
        let mut joints: Vec<(usize, ContactConstraint)> = Vec::new();
        for row in &articulation.rows {
            let bond = &self.joints.bonds[row.joint];
            let poses = [&articulation.poses[row.a], row.b.map_or(&WORLD_POSE, |b| &articulation.poses[b])];
            let contact = row_contact(&members, row, &bond.seat(row.part, poses), bond.hold(row.part, 0.0));
            match row.part {
                JointRowKind::Stop(side) => {
                    let (room, rate, restitution) = bond.stop(side, poses);
                    if room <= CONTACT_MARGIN * self.stop_gap(bond) {
                        let settles = self.stop_settle_speed(bond, restitution);
                        let other = Other::Body(bond.joint.body);
                        let law = Law::new(0.0, restitution);
                        points.push(ImpactPoint {
                            joint: Some(row.joint),
                            ..ImpactPoint::new(contact, -rate, &law, settles, false, other)
                        });
                    }
                }
                _ => joints.push((row.joint, contact)),
            }
        }
        let (numbers, mut contacts): (Vec<usize>, Vec<ContactConstraint>) = joints.into_iter().unzip();
        resolve_articulated_impact(&mut points, &mut contacts, &mut members);
        for (&k, m) in articulation.bodies.iter().zip(&members).filter(|(k, _)| !self.specs[**k].is_driven()) {
            bodies[k].set_motion(&self.specs[k], Velocities { v: m.v, w: m.w });
            if !bodies[k].flies() {
                bodies[k].phase = Phase::Step;
            }
        }
        for (k, bond) in self.joints.bonds.iter().enumerate().filter(|(_, b)| b.joint.breaks_at < f64::INFINITY) {
            let held = numbers.iter().zip(&contacts).filter(|(number, _)| **number == k).map(|(_, c)| c.impulse);
            let stopped = points.iter().filter(|p| p.joint == Some(k)).map(|p| p.contact.impulse);
            if held.chain(stopped).sum::<DVec3>().length() > bond.joint.breaks_at {
                self.tear(k, bodies);
            }
        }
        points
    }

    /// Makes joints of an island rebound from a limit that they have reached and still approach. Returns whether there
    /// were any.
    pub(crate) fn strike_stops(&self, group: &RigidScratch, bodies: &mut [RigidBodyState]) -> bool {
        let mut any = false;
        for row in &group.stops {
            let JointRowKind::Stop(side) = row.part else { continue };
            let bond = &self.joints.bonds[row.joint];
            let poses = [bond.joint.body].into_iter().chain(bond.joint.other).map(|k| bodies[k].pose());
            let mut poses = poses.chain([WORLD_POSE]);
            let poses: [Pose; 2] = std::array::from_fn(|_| poses.next().unwrap_or(WORLD_POSE));
            let (room, rate, restitution) = bond.stop(side, [&poses[0], &poses[1]]);
            // Joints that stay at the limit are rows of the island; velocities may have changed since.
            if room > CONTACT_MARGIN * self.stop_gap(bond)
                || bond.struck(rate, restitution) <= self.stop_settle_speed(bond, restitution)
            {
                continue;
            }
            let free =
                [Some(bond.joint.body), bond.joint.other].into_iter().flatten().find(|&k| !self.specs[k].is_driven());
            let articulation = Articulation::of(self, &[free.unwrap_or(bond.joint.body)], bodies);
            self.strike_articulation(&articulation, Vec::new(), &[], bodies);
            any = true;
        }
        any
    }
}
