//! First contact with a table.

use super::static_search::StaticTimeOfImpact;
use crate::field::Bounds;
use crate::rigid::body_state::Phase;
use crate::rigid::static_shape::Table;
use crate::rigid::tolerances::{
    CONTACT_MARGIN, MAX_STATIC_ADVANCES, MAX_STATIC_CONTACTS, PROJECTION_ROUNDS, TABLE_LOOKAHEAD,
};
use crate::roots::earliest;
use crate::shape::ContactSphere;
use glam::{DMat3, DVec3};

/// Place, velocity, angular velocity, axes and acceleration of a body, along the table's axes.
type At = (DVec3, DVec3, DVec3, DMat3, DVec3);

impl StaticTimeOfImpact<'_> {
    pub(crate) fn table(&mut self, part: u16, table: &Table) {
        let (spec, path) = (self.spec, &table.path(&self.body.path));
        // Above the greatest height that the field can have, there is nothing to examine.
        let Some(mut t) = self.approach(table.up(), table.level() + table.height.range()[1], 0.0, self.until) else {
            return;
        };
        let gravity = path.a.length();
        let mut free_rotation = self.body.free_rotation(spec);
        let mut window: Option<(f64, Bounds)> = None;
        let unlisted = self.unlisted(table);
        let lasts = |k: usize| unlisted.binary_search(&k).is_ok();
        // The point that was nearest at the last look is examined first: most others outlast its step.
        let mut lead = 0;
        for _ in 0..MAX_STATIC_ADVANCES {
            if t >= self.until || t.is_nan() {
                return;
            }
            let (x, v) = (path.after(t), path.velocity_after(t));
            // The step is limited so that speeds cannot grow much.
            let speed = v.length() + (gravity * spec.bounding_radius).sqrt();
            let (end, bounds) = match window {
                Some((end, b)) if t < end => (end, b),
                _ => {
                    let end = (t + TABLE_LOOKAHEAD * spec.bounding_radius / speed).min(self.until);
                    let over = path.bounds(t, end).grown(spec.bounding_radius * (1.0 + 1e-9));
                    let Some(b) = table.height.bounds([over.min.x, over.min.y], [over.max.x, over.max.y]) else {
                        // A footprint of thousands of cells: only its range of heights is known.
                        return self.coarse(part, t);
                    };
                    window = Some((end, b));
                    (end, b)
                }
            };
            let mut step = end - t;
            let top = x.z - spec.bounding_radius - bounds.high;
            if top > 0.0 {
                t += earliest(top, v.z, -path.a.z).min(step);
            } else {
                let r = table.axes(free_rotation.at(t));
                let w = table.way(self.spin_at(&free_rotation, t));
                let mut first = None;
                let at = (x, v, w, r, path.a);
                if !lasts(lead) {
                    self.table_feeler(
                        (part, lead),
                        &spec.contact_spheres[lead],
                        table,
                        &bounds,
                        &at,
                        &mut step,
                        &mut first,
                    );
                }
                let up = DVec3::new(r.x_axis.z, r.y_axis.z, r.z_axis.z);
                let mut level = self.level(&at, bounds.high, step);
                for (k, sphere) in spec.contact_spheres.iter().enumerate() {
                    if up.dot(sphere.centre) - sphere.radius > level || k == lead || lasts(k) {
                        continue;
                    }
                    let before = step;
                    self.table_feeler((part, k), sphere, table, &bounds, &at, &mut step, &mut first);
                    if step < before {
                        level = self.level(&at, bounds.high, step);
                    }
                }
                if step == 0.0 {
                    return self.hit(t, part, first.map_or(0, |(k, _)| k));
                }
                lead = first.map_or(lead, |(k, _)| k);
                t += step;
            }
        }
        self.hit(t, part, 0);
    }

    /// The points of a step that touch the table, in ascending order, if there are more than a body can list: all of
    /// them belong to its lasting contact. The rim of a cylinder has more.
    fn unlisted(&self, table: &Table) -> Vec<usize> {
        if self.body.phase != Phase::Step || self.body.touching().len() < MAX_STATIC_CONTACTS {
            return Vec::new();
        }
        let (x, r) = (table.place(self.body.path.x), table.axes(self.body.pose().r));
        let touches = |k: &usize| {
            let sphere = &self.spec.contact_spheres[*k];
            let projection =
                table.own_projection(x + r * sphere.centre, if sphere.radius > 0.0 { PROJECTION_ROUNDS } else { 0 });
            projection.distance - sphere.radius <= CONTACT_MARGIN * self.spec.gap
        };
        (0..self.spec.contact_spheres.len()).filter(touches).collect()
    }

    /// Height over the centre of gravity up to which a point of the body might come down to `high` within a step, at
    /// the highest possible speed.
    fn level(&self, (x, v, .., a): &At, high: f64, step: f64) -> f64 {
        let bounding_radius = self.spec.bounding_radius;
        let acceleration = (self.turning * bounding_radius - a.z).max(0.0);
        high - x.z + ((self.fastest * bounding_radius - v.z + 0.5 * acceleration * step) * step).max(0.0)
    }

    #[allow(clippy::too_many_arguments)]
    #[inline]
    fn table_feeler(
        &self,
        (part, k): (u16, usize),
        sphere: &ContactSphere,
        table: &Table,
        bounds: &Bounds,
        (x, v, w, r, a): &At,
        step: &mut f64,
        first: &mut Option<(usize, f64)>,
    ) {
        let spec = self.spec;
        let turning = self.turning * spec.arms[k];
        let gravity = *a;
        let m_low = (turning - gravity.z).max(0.0);
        let arm = *r * sphere.centre;
        let p = *x + arm;
        let pv = *v + w.cross(arm);
        let low = p.z - sphere.radius - bounds.high;
        if low > 0.0 && low + (pv.z - 0.5 * m_low * *step) * *step > 0.0 {
            return;
        }
        let (f, rate) = if sphere.radius > 0.0 {
            let projection = table.own_projection(p, PROJECTION_ROUNDS);
            (projection.distance - sphere.radius, projection.normal.dot(pv))
        } else {
            let (value, slope) = table.height.slope_at(p.x, p.y);
            (p.z - value, pv.z - slope[0] * pv.x - slope[1] * pv.y)
        };
        let f = f - 0.5 * spec.gap;
        // The path of a corner over the surface is measured in the horizontal plane, that of a ball along the surface.
        let (way, sideways) = if sphere.radius > 0.0 {
            (pv.length(), gravity.length())
        } else {
            (pv.truncate().length(), gravity.truncate().length())
        };
        let speed = way + (turning + sideways) * *step;
        let across = (1.0 + bounds.slope * bounds.slope).sqrt();
        let acceleration = if sphere.radius > 0.0 { gravity.length() } else { bounds.slope * sideways - gravity.z };
        let m = (turning * across + acceleration).max(0.0) + bounds.bend * speed * speed;
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
            *first = Some((k, f));
        }
    }

    /// For a body so large compared with the grid that its footprint is not examined: it counts as touching when it
    /// comes down to the field's greatest height.
    fn coarse(&mut self, part: u16, t: f64) {
        self.hit(t, part, 0);
    }
}
