//! The flat foot of a body of revolution over an edge or a corner of a box. The rim of the foot meets the box as a
//! ring, at its point nearest to the box. An edge that crosses the foot touches the disc within the rim: where it
//! leaves the disc, or at the box's corner under the disc.

use crate::rigid::tolerances::LEANING_RIM;
use crate::scenery::Aabb;
use crate::shape::Ring;
use glam::{DMat3, DVec3};

/// Number of points of a foot over a box: two ends for each edge.
pub(crate) const FOOT_POINTS: usize = 24;

/// One end of what an edge of a box has under a foot.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FootPoint {
    /// From the centre of gravity to the skin, in world axes.
    pub(crate) arm: DVec3,
    pub(crate) normal: DVec3,
    pub(crate) gap: f64,
    /// Whether the edge crosses the disc.
    crosses: bool,
    /// Least sine of the angle by which the foot's axis leans out of one of the edge's two faces; below 0, one of these
    /// faces looks away from the foot.
    pub(crate) facing: f64,
    /// Half the chord that the edge cuts off the disc, in m; infinite at a corner of the box, which does not run around
    /// the rim.
    pub(crate) half_chord: f64,
}

impl FootPoint {
    /// One of [`FOOT_POINTS`] of a body with this place and these axes; `None` if the box has no such edge, or the edge
    /// is parallel to the body's axis. Far from the disc it is the point of the rim nearest to the edge.
    pub(crate) fn new(bounds: &Aabb, ring: &Ring, x: DVec3, r: &DMat3, number: usize) -> Option<Self> {
        let (end, edge) = (number % 2, number / 2);
        let axis = edge / 4;
        let across = [((axis + 1) % 3, edge % 2 == 0), ((axis + 2) % 3, edge / 2 % 2 == 0)];
        let (z, mut base, mut facing) = (r.z_axis, DVec3::ZERO, f64::INFINITY);
        for (k, is_upper) in across {
            base[k] = if is_upper { bounds.max[k] } else { bounds.min[k] };
            facing = facing.min(if is_upper { z[k] } else { -z[k] });
        }
        // As seen from above the foot, the edge is the line `from + along · s`, where `s` is its coordinate.
        let middle = x + z * ring.height;
        let flat = |d: DVec3| d - z * z.dot(d);
        let (from, along) = (flat(base - middle), flat(DVec3::AXES[axis]));
        let square = along.length_squared();
        if !from.is_finite() || square < LEANING_RIM * LEANING_RIM {
            return None;
        }
        let near = -from.dot(along) / square;
        let half = ((ring.circle * ring.circle - (from + along * near).length_squared()) / square).max(0.0).sqrt();
        let [low, high] = [bounds.min[axis], bounds.max[axis]];
        let crosses = half > 0.0 && near - half < high && near + half > low;
        let at_rim = if end == 0 { near - half } else { near + half };
        let at = at_rim.clamp(low, high);
        let half_chord = if at == at_rim { half * square.sqrt() } else { f64::INFINITY };
        let (out, height) = (from + along * at, z.dot(middle - base) - z[axis] * at);
        let (distance, up) = (out.length(), z * ring.height);
        let on = if distance > ring.circle { out * (ring.circle / distance) } else { out };
        let apart = on - out + z * height;
        let (normal, gap) =
            if crosses || height <= 0.0 { (z, height) } else { (apart.normalize_or(z), apart.length()) };
        let (arm, gap) = (up + on - normal * ring.radius, gap - ring.radius);
        Some(Self { arm, normal, gap, crosses, facing, half_chord })
    }

    /// Calls `each` for the numbers of the points on edges whose lines are within `reach` of the middle of the disc.
    pub(crate) fn for_near_edges(bounds: &Aabb, middle: DVec3, reach: f64, mut each: impl FnMut(usize)) {
        let (low, high) = ((bounds.min - middle).abs(), (bounds.max - middle).abs());
        let near: [[bool; 2]; 3] = std::array::from_fn(|k| [high[k] <= reach, low[k] <= reach]);
        if near.iter().filter(|sides| sides[0] || sides[1]).count() < 2 {
            return;
        }
        for axis in 0..3 {
            let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
            for edge in (0..4).filter(|edge| near[j][edge % 2] && near[k][edge / 2]) {
                each(2 * (4 * axis + edge));
                each(2 * (4 * axis + edge) + 1);
            }
        }
    }

    /// Whether the edge is under the disc; within a lean that counts as level, where the foot stands on a face.
    pub(crate) fn is_under(&self, ring: &Ring) -> bool {
        self.is_beside(ring) && self.facing >= -LEANING_RIM
    }

    /// Whether it is under the disc, or would be if the body turned.
    pub(crate) fn is_beside(&self, ring: &Ring) -> bool {
        self.crosses && self.gap > -ring.circle
    }
}
