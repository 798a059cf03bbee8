//! Two cuboids: how far apart they are, where they are nearest, and all the points at which they touch.
//!
//! A rounded cuboid is its core (a smaller, sharp cuboid) and everything within its rounding of the core, so only cores
//! are examined.
//!
//! Cores that are apart are best separated along a face's normal or along the cross product of two edges. If not, the
//! nearest point of one of them is a corner. So the distance is exact after fifteen axes and the distances of sixteen
//! corners from the other cuboid: there is no iteration, and no tolerance at which one would end. If cores overlap, the
//! axis of least overlap gives the depth.
//!
//! The points of contact are those of the usual clipping of two support features: corners near a face of the other
//! cuboid, and crossings of edges. Each is named by its [`Feature`], so that it can be followed to another pose
//! ([`CuboidPair::again`]) with the exact geometry of that feature.
//!
//! Sources: axes: Gottschalk, Lin & Manocha, "OBBTree", SIGGRAPH 1996; corner regions: Ericson, *Real-Time Collision
//! Detection* (2005), §5.1.4 and 5.1.9.

mod manifold;
mod nearest;
#[cfg(test)]
mod tests;

use glam::{DMat3, DVec3};

/// A cuboid in its place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placed {
    /// Its axes in the world, as columns.
    pub(crate) axes: DMat3,
    /// Half the edges of its core in m.
    pub(crate) core: DVec3,
    /// Radius of its edges and corners in m.
    pub(crate) rounding: f64,
}

/// Two cuboids, with values that several queries share.
#[derive(Debug)]
pub(crate) struct CuboidPair {
    cuboids: [Placed; 2],
    /// From the second centre to the first.
    offset: DVec3,
    /// The other's centre relative to its own, in its own axes, negated for the first: where each sees the other's
    /// centre.
    other: [DVec3; 2],
    /// Axes of the second in those of the first, as columns, and the transpose.
    across: [DMat3; 2],
}

/// An edge: its axis and the lower of its two corners. Bit k of a corner tells the side along axis k.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Edge {
    pub(crate) axis: u8,
    pub(crate) corner: u8,
}

/// The parts of two cuboids that meet at a point of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Feature {
    /// A corner of the cuboid `of` (0 or 1), and the nearest part of the other: `region` tells the sides that the
    /// corner is beyond, along each axis. One side is a face, two are an edge, three a corner.
    Corner { of: u8, corner: u8, region: [i8; 3] },
    /// An edge of each.
    Edges(Edge, Edge),
}

impl Feature {
    /// A number that no other feature has.
    pub(crate) fn number(self) -> u64 {
        let parts = match self {
            Self::Corner { of, corner, region: [x, y, z] } => [0, of, corner, x as u8, y as u8, z as u8],
            Self::Edges(a, b) => [1, a.axis, a.corner, b.axis, b.corner, 0],
        };
        parts.into_iter().fold(0, |number, part| number << 8 | u64::from(part))
    }
}

/// A point of contact, or of least distance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Meeting<F = Feature> {
    /// Unit normal towards the first.
    pub(crate) normal: DVec3,
    /// From each centre to its skin.
    pub(crate) arms: [DVec3; 2],
    pub(crate) gap: f64,
    pub(crate) feature: F,
}

/// Sine of the angle between edges below which they count as parallel. Default 1e-7: the crossing of edges more
/// parallel than that lies within 1e-7 of their length of their corners, and its normal would be exact to 1e-9 only.
const PARALLEL: f64 = 1e-7;

/// The point of a core with these sides, in body axes.
#[inline]
fn corner_at(core: DVec3, corner: u8) -> DVec3 {
    let side = |k: usize| if corner >> k & 1 == 1 { core[k] } else { -core[k] };
    DVec3::new(side(0), side(1), side(2))
}

impl Feature {
    /// The corners of each cuboid that span the feature, bit k for corner k.
    pub(crate) fn corners(self) -> [u8; 2] {
        match self {
            Self::Corner { of, corner, region } => {
                let spans = |c: u8| (0..3).all(|k| region[k] == 0 || (region[k] > 0) == (c >> k & 1 == 1));
                let other = (0..8).filter(|&c| spans(c)).fold(0, |mask, c| mask | 1 << c);
                if of == 0 { [1 << corner, other] } else { [other, 1 << corner] }
            }
            Self::Edges(a, b) => [a, b].map(|e| 1 << e.corner | 1 << (e.corner | 1 << e.axis)),
        }
    }
}

impl CuboidPair {
    /// Two cuboids; `offset` points from the centre of the second to that of the first.
    #[inline]
    pub(crate) fn new(offset: DVec3, a: Placed, b: Placed) -> Self {
        let (ta, tb) = (a.axes.transpose(), b.axes.transpose());
        let across = ta * b.axes;
        Self { cuboids: [a, b], offset, other: [-(ta * offset), tb * offset], across: [across, across.transpose()] }
    }

    /// Both roundings together, in m.
    pub(crate) fn roundings(&self) -> f64 {
        self.cuboids[0].rounding + self.cuboids[1].rounding
    }

    /// A corner of the cuboid `of`, in the axes of the other about its centre.
    #[inline]
    fn corner_seen(&self, of: usize, corner: u8) -> DVec3 {
        self.other[1 - of] + self.across[1 - of] * corner_at(self.cuboids[of].core, corner)
    }

    /// The meeting of core points `p` and `q` (about their centres) along a normal.
    fn meeting(&self, [p, q]: [DVec3; 2], normal: DVec3, distance: f64, feature: Feature) -> Meeting {
        let [a, b] = &self.cuboids;
        let arms = [p - normal * a.rounding, q + normal * b.rounding];
        Meeting { normal, arms, gap: distance - self.roundings(), feature }
    }

    /// The meeting of a corner with a region of the other cuboid, wherever they are now.
    fn at_corner(&self, of: usize, corner: u8, region: [i8; 3]) -> Meeting {
        let (own, other) = (&self.cuboids[of], &self.cuboids[1 - of]);
        let seen = self.corner_seen(of, corner);
        let mut on = seen.clamp(-other.core, other.core);
        let mut away = DVec3::ZERO;
        let mut top = (f64::NEG_INFINITY, 0);
        for k in 0..3 {
            if region[k] != 0 {
                let side = f64::from(region[k]);
                on[k] = side * other.core[k];
                let beyond = side * (seen[k] - on[k]);
                away[k] = side * beyond.max(0.0);
                if beyond > top.0 {
                    top = (beyond, k);
                }
            }
        }
        let sides = region.iter().filter(|&&s| s != 0).count();
        let length = away.length();
        let (normal, distance) = if sides > 1 && length > 0.0 {
            (away / length, length)
        } else {
            // A face, or inside the sides of an edge or corner: the way out is through the nearest side.
            (DVec3::AXES[top.1] * f64::from(region[top.1]), top.0)
        };
        // The foot on a face lies straight below the corner.
        if sides == 1 || length == 0.0 {
            on = seen - normal * distance;
        }
        let (p, q, normal) = (own.axes * corner_at(own.core, corner), other.axes * on, other.axes * normal);
        let feature = Feature::Corner { of: of as u8, corner, region };
        if of == 0 {
            self.meeting([p, q], normal, distance, feature)
        } else {
            self.meeting([q, p], -normal, distance, feature)
        }
    }

    /// The square of the sine between axis `i` of the first and axis `j` of the second, without cancellation. Both
    /// sides give the same bits.
    #[inline]
    fn sine_squared(&self, i: usize, j: usize) -> f64 {
        let part = |c: DVec3, i: usize| {
            let (k, l) = ((i + 1) % 3, (i + 2) % 3);
            c[k] * c[k] + c[l] * c[l]
        };
        0.5 * (part(self.across[0].col(j), i) + part(self.across[1].col(i), j))
    }

    /// The meeting of two edges as lines, its normal on the side of `towards`; also how far along each edge it lies
    /// from the middle.
    fn at_edges(&self, a: Edge, b: Edge, towards: DVec3) -> (Meeting, [f64; 2]) {
        let [first, second] = &self.cuboids;
        let (i, j) = (usize::from(a.axis), usize::from(b.axis));
        let (e, g) = (first.axes.col(i), second.axes.col(j));
        let middle = |cuboid: &Placed, edge: Edge| {
            let mut corner = corner_at(cuboid.core, edge.corner);
            corner[usize::from(edge.axis)] = 0.0;
            cuboid.axes * corner
        };
        let (p, q) = (middle(first, a), middle(second, b));
        let between = self.offset + (p - q);
        let (sine, cosine) = (self.sine_squared(i, j), self.across[0].col(j)[i]);
        let cross = e.cross(g);
        let normal = if sine < PARALLEL * PARALLEL {
            towards
        } else {
            cross * (if cross.dot(towards) < 0.0 { -1.0 } else { 1.0 } / cross.length())
        };
        let (along_e, along_g) = (between.dot(e), between.dot(g));
        let s = (cosine * along_g - along_e) / sine;
        let t = (along_g - cosine * along_e) / sine;
        let places = [s, t];
        let (s, t) = (clamped(s, first.core[i]), clamped(t, second.core[j]));
        let meeting = self.meeting([p + e * s, q + g * t], normal, normal.dot(between), Feature::Edges(a, b));
        (meeting, places)
    }

    /// From the second centre to the first, along a direction.
    pub(crate) fn offset_along(&self, direction: DVec3) -> f64 {
        self.offset.dot(direction)
    }

    /// Where the corners of a core are along two directions, about its centre.
    #[inline]
    pub(crate) fn corners_along(&self, of: usize, first: DVec3, second: DVec3) -> [(f64, f64); 8] {
        let Placed { axes, core, .. } = &self.cuboids[of];
        let lever = |d: DVec3| DVec3::new(axes.x_axis.dot(d), axes.y_axis.dot(d), axes.z_axis.dot(d)) * *core;
        let (p, q) = (lever(first), lever(second));
        std::array::from_fn(|c| (corner_at(p, c as u8).element_sum(), corner_at(q, c as u8).element_sum()))
    }

    /// The same feature's point at this pose. `towards` is its normal at a pose nearby.
    pub(crate) fn again(&self, feature: Feature, towards: DVec3) -> Meeting {
        match feature {
            Feature::Corner { of, corner, region } => self.at_corner(usize::from(of), corner, region),
            Feature::Edges(a, b) => self.at_edges(a, b, towards).0,
        }
    }

    /// Rate of a feature's normal while the cuboids turn at these angular velocities. If edges are almost parallel,
    /// only the first edge's rate counts; if corners meet, the rate is 0.
    pub(crate) fn turning(&self, feature: Feature, normal: DVec3, spins: [DVec3; 2]) -> DVec3 {
        // A normal across an edge stays across it.
        let kept_across = |e: DVec3, w: DVec3| -normal.dot(w.cross(e));
        match feature {
            Feature::Corner { of, region, .. } => {
                let k = 1 - usize::from(of);
                match region.iter().filter(|&&s| s != 0).count() {
                    1 => spins[k].cross(normal),
                    2 => {
                        let axis = region.iter().position(|&s| s == 0).unwrap_or(0);
                        let e = self.cuboids[k].axes.col(axis);
                        e * kept_across(e, spins[k])
                    }
                    _ => DVec3::ZERO,
                }
            }
            Feature::Edges(a, b) => {
                let (i, j) = (usize::from(a.axis), usize::from(b.axis));
                let (e, g) = (self.cuboids[0].axes.col(i), self.cuboids[1].axes.col(j));
                let (x, y) = (kept_across(e, spins[0]), kept_across(g, spins[1]));
                let (sine, c) = (self.sine_squared(i, j), self.across[0].col(j)[i]);
                if sine < NEARLY_PARALLEL * NEARLY_PARALLEL {
                    return e * x;
                }
                e * ((x - c * y) / sine) + g * ((y - c * x) / sine)
            }
        }
    }
}

/// Sine below which the normal of two edges turns too fast to be followed. Default 0.1: the normal turns at up to the
/// cuboids' angular speeds over this.
const NEARLY_PARALLEL: f64 = 0.1;

/// Within ±`most`; NaN gives the middle.
fn clamped(x: f64, most: f64) -> f64 {
    if x.is_nan() { 0.0 } else { x.clamp(-most, most) }
}
