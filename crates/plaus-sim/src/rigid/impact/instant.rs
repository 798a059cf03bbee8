//! Rigid bodies that are struck by each other and by fixed parts at one instant.

use super::articulated::Articulation;
use super::scatter::partner;
use super::simultaneous::{ImpactPoint, resolve_articulated_impact};
use crate::links::Links;
use crate::mechanics::{Impact, Mechanics, Meeting};
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{NEVER, Phase, Pose, RigidBodyState, Velocities};
use crate::rigid::narrow_phase::contact_point::ContactPoint;
use crate::rigid::solver::contact_constraint::SolverBody;
use crate::rigid::tolerances::{CONTACT_MARGIN, GRAZE};
use crate::scenery::Surface;
use glam::DMat3;

impl RigidWorld {
    /// Whether two bodies touch and approach each other at a time, so that they strike each other.
    pub(crate) fn pair_strikes(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2], linked: bool, time: f64) -> bool {
        let within = CONTACT_MARGIN * self.pair_gap(pair);
        let [s, t] = pair.map(|k| &self.specs[k]);
        let apart =
            (bodies[0].path.at(time) - bodies[1].path.at(time)).length() - s.bounding_radius - t.bounding_radius;
        if apart > within || self.ignores(pair, bodies) {
            return false;
        }
        let [p, q] = [0, 1].map(|k| self.pose_of_momenta(pair[k], bodies[k], time));
        if !self.may_be_within(pair, [&p, &q], within) {
            return false;
        }
        let (law, settles) = (self.pair_law(pair), self.pair_settle_speed(pair));
        let chattering = bodies.iter().any(|b| b.is_chattering());
        let least = GRAZE * (p.fastest(s) + q.fastest(t));
        let mut is_struck = false;
        self.for_pair_touches(pair, [&p, &q], within, |touch| {
            let approach = -touch.rate(&p, &q);
            is_struck |= approach > least && !(linked && ImpactPoint::lasts(approach, law, settles, chattering));
        });
        is_struck
    }

    /// A point at which a body strikes a fixed part at its clock.
    pub(crate) fn struck_surface(&self, index: usize, body: &mut RigidBodyState) -> Option<Surface> {
        let spec = &self.specs[index];
        if spec.is_driven() || body.time_step_island != 0 || body.phase == Phase::Rest {
            return None;
        }
        let listed = body.listed;
        let (pose, chattering) = (body.pose(), body.is_chattering());
        let member = SolverBody::of(spec, &pose.r, pose.v, pose.w);
        let least = GRAZE * pose.fastest(spec);
        let mut struck = None;
        let look = |t: ContactPoint| {
            let point = self.point_on_part(&t, index, &pose, chattering, &member);
            if struck.is_none() && point.is_some_and(|p| p.is_struck() && p.approach > least) {
                struck = Some(t.surface);
            }
        };
        // Which point of a ring is lowest depends on the velocities, which an impact changes: it is not worth noting.
        if !spec.rings.is_empty() && listed != body.path.t {
            self.for_touches(index, &pose, CONTACT_MARGIN * spec.gap, look);
            return struck;
        }
        self.list_touches(index, body);
        if !body.touching().is_empty() {
            self.for_known_touches(index, body, &pose, look);
        }
        if body.touching().iter().any(|s| matches!(s, Surface::Spot { .. })) && listed != body.path.t {
            body.listed = -NEVER;
        }
        struck
    }

    /// Place and orientation at a time within the present motion, with the velocities that the body would have if that
    /// ended there.
    fn pose_of_momenta(&self, index: usize, body: &RigidBodyState, time: f64) -> Pose {
        let (spec, dt) = (&self.specs[index], time - body.path.t);
        let x = body.path.after(dt);
        if dt == 0.0 && !matches!(body.phase, Phase::Step | Phase::Articulated) {
            return Pose { x, ..body.pose() };
        }
        let r = if dt == 0.0 { DMat3::from_quat(body.turn) } else { body.free_rotation(spec).at(dt) };
        let Velocities { v, w } = body.motion_after(spec, dt);
        Pose { x, r, v, w }
    }

    /// Strikes bodies, with all that joints hold to them, at all points of these meetings at once; returns false, with
    /// nothing changed, if the impulses were not found.
    pub(crate) fn hit_together(
        &self,
        meetings: &[Meeting],
        bodies: &mut [RigidBodyState],
        links: &mut Links,
        report: &mut dyn FnMut(&Impact),
    ) -> bool {
        let mut seeds: Vec<usize> = meetings.iter().flat_map(|m| m.bodies()).collect();
        // Labels play no part in the order in which impulses are found.
        seeds.sort_unstable_by(|&i, &j| self.order([i as u32, j as u32], [&bodies[i], &bodies[j]]));
        seeds.dedup();
        let at = |k: usize| seeds.iter().position(|&other| other == k).unwrap_or(0);
        let mut members: Vec<_> = seeds
            .iter()
            .map(|&k| {
                let pose = bodies[k].pose();
                SolverBody::of(&self.specs[k], &pose.r, pose.v, pose.w)
            })
            .collect();
        let mut points: Vec<ImpactPoint> = Vec::new();
        let mut lasting = Vec::new();
        for &meeting in meetings {
            let first = points.len();
            match meeting {
                Meeting::Surface(k, surface) => {
                    let own = members[at(k)];
                    points.extend(self.points_on_part(k, &mut bodies[k], surface, &own));
                    self.scatter(&mut points[first..], &[own], k, &mut bodies[k]);
                }
                Meeting::Bodies(i, j) => {
                    let linked = links.contains(i as u32, j as u32);
                    let both = [members[at(i)], members[at(j)]];
                    points.extend(self.points_of_pair([i, j], [&bodies[i], &bodies[j]], &both, linked));
                    self.scatter(&mut points[first..], &both, i, &mut bodies[i]);
                    if !points[first..].is_empty() && points[first..].iter().all(|p| p.lasting) {
                        lasting.push([i, j]);
                    }
                }
            }
            let ends: Vec<usize> = meeting.bodies().map(at).collect();
            for p in &mut points[first..] {
                p.contact.a = ends[0];
                p.contact.b = p.contact.b.map(|_| ends[ends.len() - 1]);
            }
        }
        let articulation = Articulation::of(self, &seeds, bodies);
        let struck = if articulation.rows.is_empty() {
            if !resolve_articulated_impact(&mut points, &mut [], &mut members) {
                let scattered = points.iter().filter(|p| p.is_scattered);
                scattered.for_each(|p| bodies[seeds[p.contact.a]].scattered.take_back(partner(p.other)));
                return false;
            }
            for (&k, m) in seeds.iter().zip(&members).filter(|(k, _)| !self.specs[**k].is_driven()) {
                bodies[k].set_motion(&self.specs[k], Velocities { v: m.v, w: m.w });
                if !bodies[k].flies() {
                    bodies[k].phase = Phase::Step;
                }
            }
            points
        } else {
            self.strike_articulation(&articulation, points, &seeds, bodies)
        };
        for &k in seeds.iter().filter(|&&k| !self.specs[k].is_driven()) {
            self.list_touches(k, &mut bodies[k]);
        }
        for [i, j] in lasting {
            links.insert(i as u32, j as u32);
        }
        let all = if articulation.rows.is_empty() { &seeds } else { &articulation.bodies };
        for point in struck.iter().filter(|p| p.joint.is_none()) {
            let index = all[point.contact.a];
            point.report(bodies[index].path.t, index, bodies[index].path.x, report);
        }
        true
    }
}
