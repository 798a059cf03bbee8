//! Rigid bodies that are struck by each other and by fixed parts at one instant.

use super::articulated::Articulation;
use super::simultaneous::{ImpactPoint, resolve_articulated_impact};
use crate::links::Links;
use crate::mechanics::{Impact, Meeting};
use crate::rigid::body_state::{NEVER, Phase, Pose, RigidBodyState, Velocities};
use crate::rigid::solver::contact_constraint::SolverBody;
use crate::rigid::tolerances::CONTACT_MARGIN;
use crate::rigid::{BodyDef, RigidWorld};
use crate::scenery::Surface;
use glam::DMat3;

/// Approach, over the fastest speed of any point of the bodies, that is none. Default 1e-10: far above what rounding
/// and the solver of an earlier impact leave, far below any motion.
const GRAZE: f64 = 1e-10;

/// A bound on the speed of all points of a body.
fn fastest(pose: &Pose, spec: &BodyDef) -> f64 {
    pose.v.length() + pose.w.length() * spec.bounding_radius
}

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
        let [p, q] = [0, 1].map(|k| self.pose_at(pair[k], bodies[k], time));
        if self.gap_at_least(pair, [&p, &q]) > within {
            return false;
        }
        let (law, settles) = (self.pair_law(pair), self.pair_settle_speed(pair));
        let chattering = bodies.iter().any(|b| b.is_chattering());
        let least = GRAZE * (fastest(&p, s) + fastest(&q, t));
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
        self.list_touches(index, body);
        // Which point of a ring is lowest depends on the velocities.
        let moves = !spec.rings.is_empty() || body.touching().iter().any(|s| matches!(s, Surface::Spot { .. }));
        let (pose, chattering) = (body.pose(), body.is_chattering());
        let member = SolverBody::of(spec, &pose.r, pose.v, pose.w);
        let least = GRAZE * fastest(&pose, spec);
        let mut struck = None;
        if !body.touching().is_empty() {
            self.for_known_touches(index, body, &pose, |t| {
                let point = self.point_on_part(&t, index, &pose, chattering, &member);
                if struck.is_none() && point.is_some_and(|p| p.is_struck() && p.approach > least) {
                    struck = Some(t.surface);
                }
            });
        }
        if moves && listed != body.path.t {
            body.listed = -NEVER;
        }
        struck
    }

    /// Place, orientation and velocities at a time within the present motion.
    fn pose_at(&self, index: usize, body: &RigidBodyState, time: f64) -> Pose {
        let dt = time - body.path.t;
        if dt == 0.0 && !matches!(body.phase, Phase::Step | Phase::Swing) {
            return body.pose();
        }
        let spec = &self.specs[index];
        let motion = body.motion_after(spec, dt);
        let r = if dt == 0.0 { DMat3::from_quat(body.turn) } else { body.free_rotation(spec).at(dt) };
        Pose { x: body.path.after(dt), r, v: motion.v, w: motion.w }
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
        seeds.sort_unstable();
        seeds.dedup();
        let at = |k: usize| seeds.partition_point(|&other| other < k);
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
                    points.extend(self.points_on_part(k, &mut bodies[k], surface, &members[at(k)]));
                }
                Meeting::Bodies(i, j) => {
                    let linked = links.contains(i as u32, j as u32);
                    let both = [members[at(i)], members[at(j)]];
                    points.extend(self.points_of_pair([i, j], [&bodies[i], &bodies[j]], &both, linked));
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
        for point in struck.iter().filter(|p| p.is_outer) {
            let index = articulation.bodies[point.contact.a];
            point.report(bodies[index].path.t, index, bodies[index].path.x, report);
        }
        true
    }
}
