//! The law of contact at a point: friction and restitution, the gap at which bodies touch, the speed up to which a
//! contact lasts.

use super::contact_point::ContactPoint;
use crate::material::Law;
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{KEPT_GAP, PUSH_OUT_SPEED};
use crate::rigid::{BodyDef, RigidWorld};
use glam::DVec3;

impl RigidWorld {
    /// The law at a point of contact.
    #[inline]
    pub(crate) fn law_at(&self, index: usize, t: &ContactPoint, point: DVec3) -> Law {
        let part = &self.parts[usize::from(t.part)];
        let law = self.laws.of(self.specs[index].material, part.material(t.surface));
        match part {
            StaticShape::Table(table) => table.law(point, law),
            StaticShape::Block { sections, .. } => {
                let here = sections.iter().rev().find(|s| point.y >= s.from);
                here.and_then(|s| s.friction).map_or(*law, |friction| law.rubbing(friction))
            }
            _ => *law,
        }
    }

    /// Speed of slip in m/s up to which a body does not slide: what a static solution may leave.
    #[inline]
    pub(crate) fn still(&self, index: usize) -> f64 {
        self.accuracy.rest_residual * self.accuracy.step * self.specs[index].speed
    }

    /// Rebound speed up to which a contact counts as lasting.
    #[inline]
    pub(crate) fn settle_speed(&self, spec: &BodyDef, law: &Law) -> f64 {
        self.slowest_bounce(law) * spec.speed
    }

    /// Rebound speed over `√(g · size)` up to which a contact counts as lasting. A bounce no higher than the gap at
    /// which bodies touch is not counted as one, however elastic.
    #[inline]
    pub(super) fn slowest_bounce(&self, law: &Law) -> f64 {
        (self.accuracy.settle * (1.0 - law.restitution)).max((2.0 * self.accuracy.gap).sqrt())
    }
}

impl RigidWorld {
    /// Gap at which two bodies touch.
    pub(crate) fn pair_gap(&self, [i, j]: [usize; 2]) -> f64 {
        self.specs[i].gap.min(self.specs[j].gap)
    }

    pub(crate) fn pair_law(&self, [i, j]: [usize; 2]) -> &Law {
        self.laws.of(self.specs[i].material, self.specs[j].material)
    }

    /// Rebound speed up to which a contact of two bodies lasts.
    pub(crate) fn pair_settle_speed(&self, [i, j]: [usize; 2]) -> f64 {
        self.slowest_bounce(self.pair_law([i, j])) * self.specs[i].speed.min(self.specs[j].speed)
    }

    /// The wanted gap at a point of contact of two bodies at the end of a step of `h` seconds: an overlap is undone at
    /// a limited speed.
    pub(crate) fn pair_goal(&self, [i, j]: [usize; 2], gap: f64, h: f64) -> f64 {
        let fastest = PUSH_OUT_SPEED * self.accuracy.settle * self.specs[i].speed.min(self.specs[j].speed);
        (KEPT_GAP * self.pair_gap([i, j])).min(gap + fastest * h)
    }
}
