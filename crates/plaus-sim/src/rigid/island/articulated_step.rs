//! Steps of bodies on joints that nothing touches, in the coordinates of the joints: what joints hold is together at
//! any length of step, so the steps are as long as the preset's error allows. Loops of joints, dry friction, and limits
//! that are touched take the steps of lasting contact.

use super::sleep;
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{Phase, Pose, RigidBodyState};
use crate::rigid::joints::joint::{JointRowKind, Side};
use crate::rigid::motion::between_ends::StepEnd;
use crate::rigid::scratch::RigidScratch;
use crate::rigid::tolerances::{
    ARTICULATED_PATH_ERROR, CONTACT_MARGIN, JOINT_STEP_ERROR, JOINT_STEP_GROWTH, JOINT_STEP_SAFETY, JOINT_STEP_TRIES,
    JOINT_STEP_TURN, LEAST_SHORTENING, LIMIT_AIMS, LIMIT_GAP, LIMIT_LOOKS, NO_MOTION,
};
use plaus_dist::math;

impl RigidScratch {
    /// Whether nothing but joints acts between bodies of an island, none of them with friction or at a limit; finds
    /// their trees then, with all that a step starts with.
    fn start_articulated(&mut self, world: &RigidWorld) -> bool {
        let touches_nothing = self.touches.is_empty() && self.pairs.is_empty();
        !self.rows.is_empty()
            && touches_nothing
            && !self.has_slack_strings()
            && self.articulated.start(world, &self.places, &self.rows)
    }

    /// Velocity at the start of the parabola on which searches see a body in the step of `h` seconds that has been
    /// taken, and its angular velocity.
    fn seen(&self, place: usize, h: f64) -> Pose {
        let start = self.places[place].start;
        match self.articulated.trees.links.iter().position(|link| link.place == place) {
            Some(k) => {
                let [s, e] = [&self.articulated.begin[k], &self.articulated.end[k]];
                Pose { v: (e.x() - s.x()) / h - (e.velocity() - s.velocity()) * 0.5, ..start }
            }
            None => start,
        }
    }

    /// Whether points that are just leaving would be seen to come back at once.
    fn is_seen_to_return(&self, h: f64) -> bool {
        let comes_back = |before: f64, seen: f64| seen < 0.25 * before;
        self.leaving.iter().any(|(k, t)| {
            comes_back(
                self.places[*k].start.velocity(t.arm).dot(t.normal),
                self.seen(*k, h).velocity(t.arm).dot(t.normal),
            )
        }) || self.parting.iter().any(|([a, b], t)| {
            let [p, q] = [a, b].map(|k| &self.places[*k].start);
            comes_back(t.rate(p, q), t.rate(&self.seen(*a, h), &self.seen(*b, h)))
        })
    }

    /// Takes the next step of an island if only joints act in it; returns whether it did.
    pub(super) fn articulated_step(&mut self, world: &RigidWorld, bodies: &mut [RigidBodyState]) -> bool {
        if !self.start_articulated(world) {
            return false;
        }
        let usual = self.step_length(world);
        if self.hangs_still(world, usual) {
            self.lie_down(world, bodies);
            return true;
        }
        let hint = self.places.iter().map(|p| bodies[p.body].articulated_step).fold(0.0, f64::max);
        let rate = self.articulated.rate(world);
        let longest = if rate > 0.0 { (JOINT_STEP_TURN / rate).min(world.duration) } else { world.duration };
        let most = self.until_key(world, longest);
        let tried = if hint > 0.0 { hint } else { usual };
        let mut h = tried.min(most);
        let mut factor = self.try_articulated(world, h);
        for _ in 0..JOINT_STEP_TRIES {
            if factor >= JOINT_STEP_SAFETY * JOINT_STEP_SAFETY {
                break;
            }
            h *= factor;
            factor = self.try_articulated(world, h);
        }
        // A step that is short because of a key says little about the next.
        let next = if h == most { tried.max(h * factor) } else { h * factor };
        let mut tries = 0;
        while self.is_seen_to_return(h) {
            if tries == JOINT_STEP_TRIES {
                return false;
            }
            (h, tries) = (0.5 * h, tries + 1);
            self.articulated.go(world, &self.places, h, false);
        }
        let Some(h) = self.step_to_limit(world, h) else { return false };
        for p in &self.places {
            bodies[p.body].articulated_step = next;
        }
        self.finish_articulated(world, bodies, h);
        true
    }

    /// Tries a step of `h` seconds; returns by what factor its errors allow it to be longer or want it to be shorter.
    fn try_articulated(&mut self, world: &RigidWorld, h: f64) -> f64 {
        let step = world.accuracy.step;
        let error =
            self.articulated.go(world, &self.places, h, true) / (JOINT_STEP_ERROR * step * step * step * step * h);
        let bend = self.articulated.bend(world, &self.places, h) / (ARTICULATED_PATH_ERROR * step * step * step);
        let shrink = error.sqrt().sqrt().max(math::cbrt(bend));
        (JOINT_STEP_SAFETY / shrink).clamp(LEAST_SHORTENING, JOINT_STEP_GROWTH)
    }

    /// Takes a step of a given length; returns whether only joints act.
    pub(super) fn retake_articulated_step(
        &mut self,
        world: &RigidWorld,
        bodies: &mut [RigidBodyState],
        h: f64,
    ) -> bool {
        if !self.start_articulated(world) {
            return false;
        }
        self.articulated.go(world, &self.places, h, false);
        self.finish_articulated(world, bodies, h);
        true
    }

    /// Whether bodies neither move nor would begin to. `h` is the usual length of a step.
    fn hangs_still(&self, world: &RigidWorld, h: f64) -> bool {
        let most = NO_MOTION * world.gravity_magnitude;
        let is_still = |k: &usize| {
            let p = &self.places[*k];
            world.specs[p.body].drive.as_ref().is_none_or(|drive| drive.is_still(p.clock))
        };
        sleep::is_slow(world, self)
            && h.is_finite()
            && (0..self.places.len()).all(|k| is_still(&k))
            && self.articulated.trees.links.iter().zip(&self.articulated.begin).all(|(link, s)| {
                let reach = world.specs[self.places[link.place].body].bounding_radius;
                s.velocity().length().max(s.w.length() * reach) <= most * h
                    && s.acceleration().length().max(s.alpha.length() * reach) <= most
            })
    }

    /// Shortens the step that has just been taken so that it ends at the first limit that it would pass. `None` if a
    /// limit that is being left is met again at once: it stays touched, and joins the rows.
    fn step_to_limit(&mut self, world: &RigidWorld, h: f64) -> Option<f64> {
        let (whole, mut h) = (h, h);
        for _ in 0..LIMIT_AIMS {
            let mut first = h;
            for k in 0..self.stops.len() {
                let row = self.stops[k];
                let JointRowKind::Stop(side) = row.part else { continue };
                let bond = &world.joints.bonds[row.joint];
                let Some(ends) = self.articulated.about(row.joint) else { continue };
                let (room, _, _) = bond.stop(side, self.start_poses(&row));
                let way = if side == Side::High { -bond.lever } else { bond.lever };
                let at = |part: f64| room + way * between(ends, part, h);
                let Some(late) = first_below(at, LIMIT_GAP * world.stop_gap(bond)) else { continue };
                if late * h < LEAST_SHORTENING * whole && room <= CONTACT_MARGIN * world.stop_gap(bond) {
                    self.stops.remove(k);
                    self.rows.push(row);
                    return None;
                }
                first = first.min(late * h);
            }
            if first == h {
                break;
            }
            h = first;
            self.articulated.go(world, &self.places, h, false);
        }
        Some(h)
    }

    /// Gives the bodies the step of `h` seconds that has been taken.
    fn finish_articulated(&mut self, world: &RigidWorld, bodies: &mut [RigidBodyState], h: f64) {
        self.contacts.clear();
        let links = &self.articulated.trees.links;
        let mut debts: Vec<f64> = links.iter().map(|l| bodies[self.places[l.place].body].energy_debt[0]).collect();
        let ends = self.articulated.ends(world, &self.places, h, &mut debts);
        for (k, ((link, begin), end)) in links.iter().zip(&self.articulated.begin).zip(&ends).enumerate() {
            let index = self.places[link.place].body;
            let body = &mut bodies[index];
            body.energy_debt[1] = debts[k];
            let end = StepEnd { x: end.x, turn: end.turn, motion: [end.v, end.w] };
            body.take_cubic_step(&world.specs[index], [begin.velocity(), begin.w], &end, h);
            body.pair_loads.clear();
            body.list(std::iter::empty());
        }
        for p in &self.places {
            if let Some(drive) = &world.specs[p.body].drive {
                drive.hold(&mut bodies[p.body], h);
            }
        }
    }
}

/// What a joint's coordinate has grown by since the start of a step of `h` seconds, after a part of it.
fn between([[a, u], [b, w]]: [[f64; 2]; 2], part: f64, h: f64) -> f64 {
    let (rise, u, w) = (b - a, u * h, w * h);
    a + part * (u + part * (3.0 * rise - 2.0 * u - w + part * (u + w - 2.0 * rise)))
}

/// The first part of a step after which a distance, which falls below 0 within it, is down at `aim`.
fn first_below(at: impl Fn(f64) -> f64, aim: f64) -> Option<f64> {
    let part = |k: u32| f64::from(k) / f64::from(LIMIT_LOOKS);
    let mut low = 0.0;
    for k in 1..=LIMIT_LOOKS {
        let mut high = part(k);
        if at(high) >= 0.0 || at(high) >= at(low) {
            low = high;
            continue;
        }
        if at(low) <= aim {
            return Some(low);
        }
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (low + high);
            if at(middle) > aim { low = middle } else { high = middle }
        }
        return Some(high);
    }
    None
}

/// Whether a body takes a step, of either kind.
pub(super) fn is_stepping(body: &RigidBodyState) -> bool {
    matches!(body.phase, Phase::Step | Phase::Articulated)
}
