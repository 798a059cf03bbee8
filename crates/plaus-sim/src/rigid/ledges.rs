//! Polyhedra at the edges and corners of boxes, where the polyhedron need not have a corner.
//!
//! A box is a polyhedron that stands still, so first contact and points of contact are those of two polyhedra. The
//! points of a body on a box are numbered: its corners, then the box's corners on each of its faces, edges and corners,
//! then each of its edges with each of the box's.

use super::body::{Phase, Pose, Start, Turning};
use super::convex::Quest;
use super::detect::Search;
use super::part::{Part, farthest_side};
use super::scratch::TOUCHING;
use super::spec::{Skin, Spec};
use super::touch::Touch;
use super::{BodySpec, Rigid, RigidWorld};
use crate::error::{SurfaceId, WorldError};
use crate::scenery::{Aabb, Surface};
use crate::shape::hull_pair::{Feature, HullPair, Placed};
use crate::shape::{Cuboid, MassProperties, On, Polyhedron, Shape, Within};
use glam::{DMat3, DVec3};

/// A box as a body that stands still.
#[derive(Debug, Clone)]
pub(super) struct Ledge {
    spec: Spec,
    still: Turning,
    core: Polyhedron,
    middle: DVec3,
}

/// Corners and edges of a box.
const CORNERS: usize = 8;
const EDGES: usize = 12;

impl Ledge {
    /// The parts of a world that are boxes, if there are polyhedra that may meet them.
    pub(super) fn all(world: &RigidWorld) -> Result<Vec<Option<Self>>, WorldError> {
        let has_hulls = world.bodies.iter().any(|b| matches!(b.shape, Shape::Hull(_)));
        let of = |(k, part): (usize, &Part)| match part {
            Part::Block { bounds, material, .. } if has_hulls => {
                let edges = bounds.max - bounds.min;
                if !edges.is_finite() {
                    return Err(WorldError::BadSurface {
                        surface: SurfaceId::Part(k),
                        field: "extent along an axis",
                        value: f64::INFINITY,
                        expected: "a finite length in a world with convex polyhedra",
                    });
                }
                let shape = Shape::Cuboid(Cuboid::new(edges, 0.0)?);
                let body =
                    BodySpec { shape, mass: MassProperties { mass: 1.0, inertia: DVec3::ONE }, material: *material };
                let spec = Spec::new(world.bodies.len(), &body, world, f64::INFINITY, world.gravity.length())?;
                let middle = (bounds.min + bounds.max) * 0.5;
                let still = Turning::waiting(&Start::at_rest(middle));
                Ok(Some(Self { spec, still, core: Polyhedron::cuboid(edges * 0.5), middle }))
            }
            _ => Ok(None),
        };
        world.parts.iter().enumerate().map(of).collect()
    }

    fn pair<'s>(&'s self, spec: &'s Spec, pose: &Pose) -> Option<HullPair<'s>> {
        let (core, rounding) = spec.core.as_ref()?;
        let body = Placed { axes: pose.r, core, rounding: *rounding };
        Some(HullPair::new(
            pose.x - self.middle,
            body,
            Placed { axes: DMat3::IDENTITY, core: &self.core, rounding: 0.0 },
        ))
    }
}

/// The number of a point of contact of a body's core.
fn number(core: &Polyhedron, feature: Feature) -> u16 {
    let [corners, faces, edges] = counts(core);
    let number = match feature {
        Feature::Corner { of: 0, corner, .. } => usize::from(corner),
        Feature::Corner { corner, on, .. } => {
            let on = match on {
                On::Face(k) => usize::from(k),
                On::Edge(k) => faces + usize::from(k),
                On::Corner(k) => faces + edges + usize::from(k),
            };
            corners + on * CORNERS + usize::from(corner)
        }
        Feature::Edges(i, j) => corners + (faces + edges + corners) * CORNERS + usize::from(i) * EDGES + usize::from(j),
    };
    number as u16
}

/// The point with that number, if it is not a corner of the body.
fn feature(core: &Polyhedron, number: u16) -> Option<Feature> {
    let [corners, faces, edges] = counts(core);
    let k = usize::from(number).checked_sub(corners)?;
    if let Some(both) = k.checked_sub((faces + edges + corners) * CORNERS) {
        return Some(Feature::Edges((both / EDGES) as u8, (both % EDGES) as u8));
    }
    let (on, corner) = (k / CORNERS, (k % CORNERS) as u8);
    let on = match (on.checked_sub(faces), on.checked_sub(faces + edges)) {
        (_, Some(k)) => On::Corner(k as u8),
        (Some(k), _) => On::Edge(k as u8),
        _ => On::Face(on as u8),
    };
    Some(Feature::Corner { of: 1, corner, on })
}

/// How many corners, faces and edges there are.
fn counts(core: &Polyhedron) -> [usize; 3] {
    [core.corners.len(), core.faces.len(), core.edges.len()]
}

impl Rigid {
    fn ledge(&self, index: usize, part: u16) -> Option<(&Spec, &Ledge)> {
        let spec = &self.specs[index];
        match spec.skin {
            Skin::Hull => Some((spec, self.ledges[usize::from(part)].as_ref()?)),
            _ => None,
        }
    }

    /// Whether a point of a body on a part is not fixed in the body: a corner of a box, a crossing of edges, or any
    /// point at which pieces touch.
    pub(super) fn is_at_ledge(&self, index: usize, t: &Touch) -> bool {
        let Some(point) = t.point() else { return true };
        point >= self.specs[index].hull && self.ledge(index, t.part).is_some()
    }

    /// A point at an edge or a corner of a box, wherever it is.
    pub(super) fn ledge_touch(&self, index: usize, pose: &Pose, part: u16, point: u16) -> Option<Touch> {
        let (spec, ledge) = self.ledge(index, part)?;
        let pair = ledge.pair(spec, pose)?;
        let feature = feature(&spec.core.as_ref()?.0, point)?;
        let out = match feature {
            // Edges, as lines, have no side: take the side on which the box's own faces are.
            Feature::Edges(_, j) => {
                let [f, g] = ledge.core.edge(j).faces.map(|k| ledge.core.face(k).normal);
                f + g
            }
            Feature::Corner { .. } => DVec3::ZERO,
        };
        let meeting = pair.again(feature, out);
        Some(Touch::of_point(part, point, meeting.arms[0], meeting.normal, meeting.gap))
    }

    /// Calls `each` for the points at edges and corners of a box with a gap of at most `within`.
    pub(super) fn for_ledge_touches(
        &self,
        index: usize,
        pose: &Pose,
        part: u16,
        within: Within,
        mut each: impl FnMut(Touch),
    ) {
        let Some((spec, ledge)) = self.ledge(index, part) else { return };
        let (Some(pair), Some((core, _))) = (ledge.pair(spec, pose), &spec.core) else { return };
        pair.touching(&pair.nearest(None), within, |m| {
            if !matches!(m.feature, Feature::Corner { of: 0, .. }) {
                let point = number(core, m.feature);
                each(Touch::of_point(part, point, m.arms[0], m.normal, m.gap));
            }
        });
    }
}

impl Search<'_> {
    /// First contact of a polyhedron with a box.
    pub(super) fn ledge(&mut self, part: u16, bounds: &Aabb, ledge: &Ledge) {
        let (spec, body) = (self.spec, self.body);
        let Some((core, _)) = &spec.core else { return };
        let swept = body.path.bounds(0.0, self.until).grown(spec.reach);
        if !bounds.grown(spec.gap).meets(&swept) {
            return;
        }
        let mut from = 0.0;
        if let Some(side) = farthest_side(bounds, body.path.x) {
            // As for other bodies, the box is behind that side's plane.
            let Some((time, point)) = self.half_space(part, (side.normal, side.offset), Some((bounds, side.axis)))
            else {
                return;
            };
            if self.is_at_side(bounds, &side, time, point) {
                return self.hit(time, part, point);
            }
            from = time;
        }
        let touches = |s: &Surface| matches!(s, Surface::Part { part: p, .. } if *p == part);
        let linked = body.phase == Phase::Step && body.touching().iter().any(touches);
        let start = body.path.t;
        let quest = Quest {
            specs: [spec, &ledge.spec],
            bodies: [body, &ledge.still],
            level: spec.gap,
            // Lasting contacts are known at the clock.
            from: start + if linked { 0.0 } else { from },
            until: start + self.until,
            linked,
            arms: [core.reach, ledge.core.reach],
        };
        let Some(time) = quest.first(|[a, _]| ledge.pair(spec, a)) else { return };
        let after = time - start;
        let mut tumble = body.tumble(spec);
        let r = tumble.at(after);
        let (x, v) = (body.path.after(after), body.path.velocity_after(after));
        let pose = Pose { x, r, v, w: self.spin_at(&tumble, after) };
        let Some(pair) = ledge.pair(spec, &pose) else { return };
        let nearest = pair.nearest(None);
        let mut fastest = (f64::INFINITY, nearest.feature);
        pair.touching(&nearest, TOUCHING * spec.gap, |m| {
            let rate = pose.velocity(m.arms[0]).dot(m.normal);
            if rate < fastest.0 && !self.lasts(part, usize::from(number(core, m.feature))) {
                fastest = (rate, m.feature);
            }
        });
        self.hit(after, part, usize::from(number(core, fastest.1)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{ConvexHull, Solid};

    #[test]
    fn numbers_name_points() {
        let hull = ConvexHull::new(&Solid::Icosahedron.corners(1.0), 0.0).unwrap();
        let mut numbers = std::collections::BTreeSet::new();
        let ons = (0..20).map(On::Face).chain((0..30).map(On::Edge)).chain((0..12).map(On::Corner));
        let corners = ons.flat_map(|on| (0..8).map(move |corner| Feature::Corner { of: 1, corner, on }));
        let edges = (0..30).flat_map(|i| (0..12).map(move |j| Feature::Edges(i, j)));
        for f in corners.chain(edges) {
            let k = number(&hull.core, f);
            assert!(k >= 12 && numbers.insert(k));
            assert_eq!(feature(&hull.core, k), Some(f));
        }
        assert_eq!(numbers.len(), 62 * 8 + 30 * 12);
        assert_eq!(feature(&hull.core, 11), None);
    }
}
