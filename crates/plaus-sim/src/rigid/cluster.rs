//! Impacts of bodies that joints hold. All bodies that hang together are solved at once, so that no joint is left with
//! a velocity.
//!
//! At the points that are struck, Newton's and Coulomb's laws hold, as they do where several points of a body are
//! struck at once (`strike.rs`). Joints keep their points together, and limits that are touched let nothing through.

use super::Rigid;
use super::body::{Motion, Phase, Pose, Turning};
use super::coulomb::{Contact, Member};
use super::joint::{FIXED, Part, Row};
use super::jointed::row_contact;
use super::scratch::{RigidScratch, TOUCHING};
use super::strike::{Point, strike_joined};
use crate::material::Law;
use crate::mechanics::{Impact, Other};
use glam::DVec3;

/// Bodies that hang together, with the rows of the joints between them.
pub(super) struct Cluster {
    pub(super) bodies: Vec<usize>,
    poses: Vec<Pose>,
    pub(super) rows: Vec<Row>,
}

impl Cluster {
    /// All bodies that joints connect to these. A driven body passes nothing on.
    pub(super) fn of(world: &Rigid, seeds: &[usize], bodies: &[Turning]) -> Self {
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
                let row = |part| Row { joint: j, part, a, b: bond.joint.other.and_then(at) };
                // One of the two is driven, and the other is not part of this cluster.
                if bond.joint.other.is_some_and(|other| at(other).is_none()) {
                    continue;
                }
                rows.extend((0..bond.points.len()).map(|p| row(Part::Point(p))));
                if bond.limits().is_some() {
                    rows.extend([false, true].map(|is_high| row(Part::Stop { is_high })));
                }
            }
        }
        let poses = all.iter().map(|&k| bodies[k].pose()).collect();
        Self { bodies: all, poses, rows }
    }

    fn at(&self, body: usize) -> usize {
        self.bodies.iter().position(|&k| k == body).unwrap_or(0)
    }
}

impl Rigid {
    /// An impact of a body that joints hold, or of its partner: on a fixed part, or between two bodies. `None` if no
    /// joint holds either. Otherwise it returns what an impact of single bodies returns: whether there was one, and
    /// whether their contact lasts.
    pub(super) fn hit_cluster(
        &self,
        index: usize,
        other: Other,
        linked: bool,
        bodies: &mut [Turning],
        report: &mut dyn FnMut(&Impact),
    ) -> Option<Option<bool>> {
        let seeds = if let Other::Body(k) = other { vec![index, k] } else { vec![index] };
        if self.joints.bonds.is_empty() || seeds.iter().all(|&k| self.bonds_of(k, bodies).next().is_none()) {
            return None;
        }
        let cluster = Cluster::of(self, &seeds, bodies);
        let member = |k: usize| {
            let pose = bodies[k].pose();
            RigidScratch::member(&self.specs[k], &pose.r, pose.v, pose.w)
        };
        let own = member(index);
        let points = match other {
            Other::Surface(surface) => self.points_on_part(index, &mut bodies[index], surface, &own),
            Other::Body(k) if self.is_joined([index, k], [&bodies[index], &bodies[k]]) => Vec::new(),
            Other::Body(k) => self.points_of_pair([index, k], [&bodies[index], &bodies[k]], &[own, member(k)], linked),
        };
        let is_hurried = seeds.iter().any(|&k| bodies[k].is_hurried());
        if !points.iter().any(Point::is_struck) {
            // Found again and again without an approach, so their group has to deal with it.
            let is_stuck = matches!(other, Other::Body(_)) && !linked && is_hurried && !points.is_empty();
            return Some(is_stuck.then_some(true));
        }
        let struck = self.strike_cluster(&cluster, points, seeds.as_slice(), bodies);
        for k in seeds {
            self.list_touches(k, &mut bodies[k]);
        }
        let (time, x) = (bodies[index].path.t, bodies[index].path.x);
        let mut lasts = true;
        for point in struck.iter().filter(|p| p.is_outer) {
            lasts &= point.lasting;
            point.report(time, index, x, report);
        }
        Some(Some(lasts))
    }

    /// The bodies that hang together with one or two bodies, without these.
    pub(super) fn cluster_beside(&self, a: u32, b: Option<u32>, bodies: &[Turning]) -> Vec<u32> {
        let seeds: Vec<usize> = [a].into_iter().chain(b).map(|k| k as usize).collect();
        let all = Cluster::of(self, &seeds, bodies).bodies;
        all.into_iter().filter(|k| !seeds.contains(k)).map(|k| k as u32).collect()
    }

    /// Strikes points of a cluster's bodies together with its joints; gives the bodies their velocities after the
    /// impact, and breaks welds. The points' member indices refer to `seeds`.
    pub(super) fn strike_cluster(
        &self,
        cluster: &Cluster,
        mut points: Vec<Point>,
        seeds: &[usize],
        bodies: &mut [Turning],
    ) -> Vec<Point> {
        let member = |(&k, p): (&usize, &Pose)| RigidScratch::member(&self.specs[k], &p.r, p.v, p.w);
        let mut members: Vec<Member> = cluster.bodies.iter().zip(&cluster.poses).map(member).collect();
        for p in &mut points {
            p.contact.a = cluster.at(seeds[p.contact.a]);
            p.contact.b = p.contact.b.map(|b| cluster.at(seeds[b]));
        }
        let mut joints: Vec<(usize, Contact)> = Vec::new();
        for row in &cluster.rows {
            let bond = &self.joints.bonds[row.joint];
            let poses = [&cluster.poses[row.a], row.b.map_or(&FIXED, |b| &cluster.poses[b])];
            let contact = row_contact(&members, row, &bond.seat(row.part, poses), bond.hold(row.part, 0.0));
            match row.part {
                Part::Stop { is_high } => {
                    let (room, rate, restitution) = bond.stop(is_high, poses);
                    if room <= TOUCHING * self.stop_gap(bond) {
                        let settles = self.stop_settle_speed(bond, restitution);
                        let other = Other::Body(bond.joint.body);
                        let law = Law::new(0.0, restitution);
                        points
                            .push(Point { is_outer: false, ..Point::new(contact, -rate, &law, settles, false, other) });
                    }
                }
                _ => joints.push((row.joint, contact)),
            }
        }
        let (numbers, mut contacts): (Vec<usize>, Vec<Contact>) = joints.into_iter().unzip();
        strike_joined(&mut points, &mut contacts, &mut members);
        for (&k, m) in cluster.bodies.iter().zip(&members).filter(|(k, _)| !self.specs[**k].is_driven()) {
            bodies[k].set_motion(&self.specs[k], Motion { v: m.v, w: m.w });
            if !bodies[k].flies() {
                bodies[k].phase = Phase::Step;
            }
        }
        for (k, bond) in self.joints.bonds.iter().enumerate().filter(|(_, b)| b.breaks_at() < f64::INFINITY) {
            let parts = numbers.iter().zip(&contacts).filter(|(number, _)| **number == k);
            let impulse: DVec3 = parts.map(|(_, c)| c.impulse).sum();
            if impulse.length() > bond.breaks_at() {
                self.tear(k, bodies);
            }
        }
        points
    }

    /// Makes joints of a group rebound from a limit that they have reached and still approach. Returns whether there
    /// were any.
    pub(super) fn strike_stops(&self, group: &RigidScratch, bodies: &mut [Turning]) -> bool {
        let mut any = false;
        for row in &group.stops {
            let Part::Stop { is_high } = row.part else { continue };
            let bond = &self.joints.bonds[row.joint];
            let poses = [bond.joint.body].into_iter().chain(bond.joint.other).map(|k| bodies[k].pose());
            let mut poses = poses.chain([FIXED]);
            let poses: [Pose; 2] = std::array::from_fn(|_| poses.next().unwrap_or(FIXED));
            let (room, rate, restitution) = bond.stop(is_high, [&poses[0], &poses[1]]);
            // Joints that stay at the limit are rows of the group; velocities may have changed since.
            if room > TOUCHING * self.stop_gap(bond) || -rate * restitution <= self.stop_settle_speed(bond, restitution)
            {
                continue;
            }
            let cluster = Cluster::of(self, &[bond.joint.body], bodies);
            self.strike_cluster(&cluster, Vec::new(), &[], bodies);
            any = true;
        }
        any
    }
}
