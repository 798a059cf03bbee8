//! First contact with a table.

use super::{MOST_ADVANCES, Search, earliest};
use crate::field::Bounds;
use crate::rigid::part::{ROUNDS, Table};
use crate::shape::Feeler;
use glam::{DMat3, DVec3};

impl Search<'_> {
    pub(super) fn table(&mut self, part: u16, table: &Table) {
        let (spec, path) = (self.spec, &self.body.path);
        // Above the highest that the field can be there is nothing to look at.
        let Some(mut t) = self.approach(DVec3::Z, table.height.range()[1]) else { return };
        let gravity = path.a.length();
        let mut tumble = self.body.tumble(spec);
        let margin = 0.5 * spec.reach;
        let mut window: Option<(DVec3, Bounds)> = None;
        for _ in 0..MOST_ADVANCES {
            let (x, v) = (path.after(t), path.velocity_after(t));
            let (around, bounds) = match window {
                Some((c, b)) if (x - c).truncate().abs().max_element() < 0.9 * margin => (c, b),
                _ => {
                    let far = spec.reach + margin;
                    let Some(b) = table.height.bounds([x.x - far, x.y - far], [x.x + far, x.y + far]) else {
                        // A footprint of thousands of cells: nothing is known about it but its height.
                        return self.coarse(part, t);
                    };
                    window = Some((x, b));
                    (x, b)
                }
            };
            // Not out of the window, nor so long that speeds grow much.
            let speed = v.length() + (gravity * spec.reach).sqrt();
            let room = margin - (x - around).truncate().abs().max_element();
            let mut step = (room / speed).min(spec.reach / speed);
            let top = x.z - spec.reach - bounds.high;
            if top > 0.0 {
                t += earliest(top, v.z, -path.a.z).min(step);
            } else {
                let r = tumble.at(t);
                let w = self.spin_at(t);
                let mut first = None;
                for (k, feeler) in spec.feelers.iter().enumerate() {
                    self.table_feeler((part, k), feeler, table, &bounds, &(x, v, w, r), &mut step, &mut first);
                }
                if step == 0.0 {
                    return self.hit(t, part, first.map_or(0, |(k, _)| k));
                }
                t += step;
            }
            if t >= self.until || t.is_nan() {
                return;
            }
        }
        self.hit(t, part, 0);
    }

    #[allow(clippy::too_many_arguments)]
    #[inline]
    fn table_feeler(
        &self,
        (part, k): (u16, usize),
        feeler: &Feeler,
        table: &Table,
        bounds: &Bounds,
        (x, v, w, r): &(DVec3, DVec3, DVec3, DMat3),
        step: &mut f64,
        first: &mut Option<(usize, f64)>,
    ) {
        let spec = self.spec;
        let turning = self.turning * spec.arms[k];
        let gravity = self.body.path.a;
        let m_low = (turning - gravity.z).max(0.0);
        // Against the highest point around first, at the speed that it can have at most.
        let rise = r.x_axis.z * feeler.centre.x + r.y_axis.z * feeler.centre.y + r.z_axis.z * feeler.centre.z;
        let low = x.z + rise - feeler.radius - bounds.high;
        if low > 0.0 && low + (v.z - self.fastest * spec.arms[k] - 0.5 * m_low * *step) * *step > 0.0 {
            return;
        }
        let arm = *r * feeler.centre;
        let p = *x + arm;
        let pv = *v + w.cross(arm);
        let low = p.z - feeler.radius - bounds.high;
        if low > 0.0 && low + (pv.z - 0.5 * m_low * *step) * *step > 0.0 {
            return;
        }
        let (f, rate) = if feeler.radius > 0.0 {
            let foot = table.foot(p, ROUNDS);
            (foot.distance - feeler.radius, foot.normal.dot(pv))
        } else {
            let (value, slope) = table.height.slope_at(p.x, p.y);
            (p.z - value, pv.z - slope[0] * pv.x - slope[1] * pv.y)
        };
        let f = f - 0.5 * spec.gap;
        let speed = v.length() + self.fastest * spec.arms[k] + gravity.length() * *step;
        let across = (1.0 + bounds.slope * bounds.slope).sqrt();
        let m = m_low.max(0.0) * across + bounds.bend * speed * speed;
        if f > 0.5 * spec.gap && f + (rate - 0.5 * m * *step) * *step > 0.0 {
            return;
        }
        if self.lasts(part, k) {
            return;
        }
        if f <= 0.5 * spec.gap && rate < 0.0 {
            if *step > 0.0 || first.is_none_or(|(_, deepest)| f < deepest) {
                *first = Some((k, f));
            }
            *step = 0.0;
            return;
        }
        let time = earliest(f, rate, m);
        if time < *step {
            *step = time;
        }
    }

    /// A body so large against the grid that its footprint is not looked at: it counts as touching where it comes down to the field's highest value.
    fn coarse(&mut self, part: u16, t: f64) {
        self.hit(t, part, 0);
    }
}
