//! How far bodies are from each other and from scenery where they start.

use super::RigidWorld;
use super::body_definition::BodyDef;
use super::body_state::RigidBodyState;
use super::pose::Start;
use crate::broad::BoxTree;
use crate::mechanics::Other;
use crate::scenery::Aabb;
use glam::DVec3;

/// How far a body is from another, or from a part of the scenery, at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// The body.
    pub body: usize,
    /// The other.
    pub other: Other,
    /// Unit normal towards the body: the way out of the other.
    pub normal: DVec3,
    /// The distance in m; negative where they overlap.
    pub gap: f64,
}

impl RigidWorld {
    /// Where bodies that start so are nearer than `within`, in m, to others that appear at the same time, or to parts.
    /// Bodies that a joint holds together are left out, and so are driven bodies beside each other or parts.
    #[must_use]
    pub fn separations(&self, starts: &[Start], within: f64) -> Vec<Separation> {
        let bodies: Vec<RigidBodyState> = starts.iter().enumerate().map(|(k, start)| self.waiting(k, start)).collect();
        let mut found = Vec::new();
        for [j, k] in self.starting_together(&bodies, within) {
            let [a, b] = [j, k].map(|index| bodies[index].pose());
            let touch = self.pair_touch([j, k], [&a, &b]);
            found.push(Separation { body: j, other: Other::Body(k), normal: touch.normal, gap: touch.gap });
        }
        for (body, state) in bodies.iter().enumerate().filter(|&(k, _)| !self.specs[k].is_driven()) {
            self.for_touches(body, &state.pose(), within, |t| {
                found.push(Separation {
                    body,
                    other: Other::Surface(self.user_surface(t.surface, state.path.x + t.arm)),
                    normal: t.normal,
                    gap: t.gap,
                });
            });
        }
        found.retain(|one| one.gap < within);
        found
    }

    /// Pairs of bodies that appear at the same time with bounds nearer than `within`, and of which not both are driven
    /// nor a joint holds one to the other.
    pub(super) fn starting_together(&self, bodies: &[RigidBodyState], within: f64) -> Vec<[usize; 2]> {
        let around = |(body, spec): (&RigidBodyState, &BodyDef)| {
            Aabb::around([body.path.x]).grown(spec.bounding_radius + 0.5 * within)
        };
        let boxes: Vec<Aabb> = bodies.iter().zip(&self.specs).map(around).collect();
        let (mut tree, mut near, mut pairs) = (BoxTree::default(), Vec::new(), Vec::new());
        for (k, body) in bodies.iter().enumerate() {
            tree.meeting(&boxes, &boxes[k], &mut near);
            let is_driven = |j: usize| self.specs[j].is_driven();
            let earlier = near.iter().map(|&j| j as usize).filter(|&j| j < k && bodies[j].path.t == body.path.t);
            let are_apart = |j: usize| !(is_driven(j) && is_driven(k) || self.never_touch([j, k], [&bodies[j], body]));
            pairs.extend(earlier.filter(|&j| are_apart(j)).map(|j| [j, k]));
        }
        pairs
    }
}
