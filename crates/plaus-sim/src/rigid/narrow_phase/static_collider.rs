//! Fixed parts as the pieces of bodies see them: planes, and pieces in a tree. For a mesh, each piece also knows what
//! is solid beside it.

use super::facets::Facets;
use super::regions::{Region, RegionFace};
use super::seams::{Around, EdgeConvexity, Seams, bounds, ends_at};
use crate::broad::BoxTree;
use crate::error::WorldError;
use crate::rigid::RigidWorldDesc;
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{EDGE_LEAN, ENDLESS_DEPTH, FAR_ABOVE};
use crate::scenery::{Aabb, Face, Mesh, Surface};
use crate::shape::convex_pair::{Both, Mark, Meeting, nearest};
use crate::shape::hull_pair::Feature;
use crate::shape::piece::{Core, Piece, THICK};
use crate::shape::{Convex, Cuboid, On, SLOTS, Within};
use crate::special_case::SpecialCase;
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// Fixed pieces.
#[derive(Debug, Clone)]
pub(crate) struct StaticCollider {
    pub(crate) pieces: Vec<Piece>,
    boxes: Vec<Aabb>,
    tree: BoxTree,
    mesh: Option<Arc<Mesh>>,
    /// How the mesh continues across each triangle's sides.
    convexities: Vec<[EdgeConvexity; 3]>,
    /// The mesh's edges at each triangle's sides.
    edges: Vec<[Option<u32>; 3]>,
    /// The faces of a single convex polyhedron, or of a mesh.
    pub(crate) facets: Facets,
    /// The numbers of the regions that it has faces of.
    pub(super) regions: Vec<u16>,
    /// Where its pieces lie flush with each other or with those of other parts.
    seams: Seams,
    bounds: Aabb,
}

/// What is beyond a side of a triangle, for a ball that comes from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EdgeNeighbour {
    /// A triangle that falls away, or nothing.
    Down,
    /// This triangle, in the same plane.
    Flat(u32),
    /// A triangle that rises.
    Up,
}

impl StaticCollider {
    /// The parts of a world and, behind them, its regions; those that are planes or tables have no pieces.
    pub(crate) fn all(world: &RigidWorldDesc) -> Result<(Vec<Self>, Vec<Region>), WorldError> {
        let mut static_colliders = world.parts.iter().map(Self::new).collect::<Result<Vec<_>, _>>()?;
        let pieces =
            static_colliders.iter().enumerate().flat_map(|(k, s)| s.pieces.iter().map(move |p| (p.clone(), k)));
        let around = Around::new(pieces.collect());
        let least = world.bodies.iter().map(|b| b.shape.size()).fold(f64::INFINITY, f64::min);
        for (k, collider) in static_colliders.iter_mut().enumerate() {
            let is_mesh = collider.mesh.is_some();
            if let Some(mesh) = &collider.mesh {
                let flat = |k: u32, side: usize| match collider.beyond(k, side) {
                    EdgeNeighbour::Flat(next) => Some(next),
                    _ => None,
                };
                collider.facets = Facets::of_mesh(mesh, least, flat);
            }
            collider.seams = Seams::new(&collider.pieces, &around, |owner, _| owner != k || !is_mesh);
        }
        let regions = Region::all(&if SpecialCase::Regions.is_on() {
            flush_faces(&world.parts, &static_colliders)
        } else {
            Vec::new()
        });
        for (k, region) in (0..).zip(&regions) {
            region.parts().for_each(|part| static_colliders[usize::from(part)].regions.push(k));
            let plane = Self::new(&StaticShape::Plane(*region.plane()))?;
            static_colliders.push(Self { bounds: *region.bounds(), ..plane });
        }
        Ok((static_colliders, regions))
    }

    fn new(part: &StaticShape) -> Result<Self, WorldError> {
        let pieces = match part {
            StaticShape::Plane(_) | StaticShape::Table(_) => Vec::new(),
            StaticShape::Block { bounds, .. } => {
                let (min, max) = (bounds.min, bounds.max);
                let end = |end: f64, other: f64, sign: f64| {
                    if end.is_finite() {
                        end
                    } else if other.is_finite() {
                        other + sign * ENDLESS_DEPTH
                    } else {
                        0.5 * sign * ENDLESS_DEPTH
                    }
                };
                let low = DVec3::from_array(std::array::from_fn(|k| end(min[k], max[k], -1.0)));
                let high = DVec3::from_array(std::array::from_fn(|k| end(max[k], min[k], 1.0)));
                let edges = high - low;
                let middle = (low + high) * 0.5;
                vec![Convex::Cuboid(Cuboid::new(edges, 0.0)?).piece(middle, DMat3::IDENTITY)]
            }
            StaticShape::Solid(solid) => {
                let r = DMat3::from_quat(solid.turn.normalize());
                let placed = |p: Piece| Piece { at: solid.at + r * p.at, turn: r * p.turn, ..p };
                solid.shape.pieces().into_iter().map(placed).collect()
            }
            StaticShape::Mesh(mesh) => (0..mesh.len()).filter_map(|k| mesh.triangle(k)).map(Piece::triangle).collect(),
            StaticShape::Arc(arc) => arc.pieces()?,
        };
        let boxes: Vec<Aabb> = pieces.iter().map(bounds).collect();
        let mesh = if let StaticShape::Mesh(mesh) = part { Some(mesh.clone()) } else { None };
        let convexities = mesh
            .iter()
            .flat_map(|m| m.faces.iter().map(|f| [0, 1, 2].map(|side| EdgeConvexity::of(m, f, side))))
            .collect();
        let edge = |m: &Mesh, f: &Face, side: usize| m.edge_between(f.corners[side], f.corners[(side + 1) % 3]);
        let edges = mesh.iter().flat_map(|m| m.faces.iter().map(|f| [0, 1, 2].map(|side| edge(m, f, side)))).collect();
        let facets = if let [piece] = &pieces[..] { Facets::of_piece(piece, 0) } else { Facets::default() };
        // The front of a curved track is before its pieces.
        let front = if let StaticShape::Arc(arc) = part { arc.form().thickness } else { 0.0 };
        let bounds = boxes.iter().fold(Aabb::EMPTY, |all, &b| all.union(b)).grown(front);
        let seams = Seams::default();
        Ok(Self {
            tree: BoxTree::new(&boxes),
            pieces,
            boxes,
            mesh,
            convexities,
            edges,
            facets,
            regions: Vec::new(),
            seams,
            bounds,
        })
    }

    /// The box around the part.
    pub(crate) fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// The pieces whose boxes are within `bounding_radius` of a point.
    pub(crate) fn near(&self, x: DVec3, bounding_radius: f64, found: &mut Vec<u32>) {
        self.tree.within(x, bounding_radius, found);
    }

    /// The pieces whose boxes meet a box.
    pub(crate) fn meeting(&self, around: &Aabb, found: &mut Vec<u32>) {
        self.tree.find(around, found);
    }

    /// Whether a piece does not touch what is within `reach` of a point: its box is farther away; or it is a triangle,
    /// and the point is farther above its plane, or behind it.
    pub(crate) fn is_far(&self, piece: u32, x: DVec3, reach: f64) -> bool {
        let is_off = |mesh: &Mesh| {
            let face = &mesh.faces[piece as usize];
            let height = face.normal.dot(x) - face.offset;
            height > reach || height <= 0.0
        };
        self.mesh().is_some_and(is_off) || self.distance(piece, x) > reach
    }

    /// Distance of a point from a piece's box.
    pub(crate) fn distance(&self, piece: u32, x: DVec3) -> f64 {
        let b = &self.boxes[piece as usize];
        (x - x.clamp(b.min, b.max)).length()
    }

    /// The mesh, if the part is one.
    #[inline]
    pub(crate) fn mesh(&self) -> Option<&Mesh> {
        self.mesh.as_deref()
    }

    /// The outward normal of a triangle; 0 if the part is no mesh.
    pub(crate) fn normal(&self, piece: u32) -> DVec3 {
        self.facet(piece).unwrap_or(DVec3::ZERO)
    }

    /// The sides of a triangle: unit normals in its plane, inward, and their offsets.
    pub(crate) fn sides(&self, piece: u32) -> Option<&[(DVec3, f64); 3]> {
        self.mesh().map(|mesh| &mesh.faces[piece as usize].sides)
    }

    /// What is beyond a side of a triangle.
    pub(crate) fn beyond(&self, piece: u32, side: usize) -> EdgeNeighbour {
        let next = self.mesh().and_then(|mesh| mesh.faces[piece as usize].neighbours[side]);
        match (self.convexities[piece as usize][side], next) {
            (EdgeConvexity::Concave, _) => EdgeNeighbour::Up,
            (EdgeConvexity::Flat, Some(next)) => EdgeNeighbour::Flat(next),
            _ => EdgeNeighbour::Down,
        }
    }

    /// The mesh's edge at a side of a triangle.
    pub(super) fn edge_of(&self, piece: u32, side: usize) -> Option<u32> {
        self.edges[piece as usize][side]
    }

    /// The same if a body can touch the edge, and if this is the first of its triangles.
    pub(crate) fn sharp_edge(&self, piece: u32, side: usize) -> Option<u32> {
        let is_first = || {
            let next = self.mesh().and_then(|mesh| mesh.faces[piece as usize].neighbours[side]);
            next.is_none_or(|next| piece < next)
        };
        let is_sharp = self.convexities[piece as usize][side] == EdgeConvexity::Convex && is_first();
        if is_sharp { self.edge_of(piece, side) } else { None }
    }

    /// Whether a triangle goes on or rises beyond each of its sides.
    pub(super) fn is_hollow(&self, piece: u32) -> bool {
        self.convexities
            .get(piece as usize)
            .is_some_and(|convexities| convexities.iter().all(|&f| f != EdgeConvexity::Convex))
    }

    /// The outward normal of a triangle.
    pub(crate) fn facet(&self, piece: u32) -> Option<DVec3> {
        self.mesh.as_ref().map(|mesh| mesh.faces[piece as usize].normal)
    }

    /// How far the plane of a triangle keeps a piece of a body away from the triangle, if the part is a mesh. The inner
    /// `None` means that the middle of the piece is behind the plane, so that it does not touch the triangle.
    pub(crate) fn over_plane(&self, piece: u32, both: &Both) -> Option<Option<f64>> {
        let n = self.facet(piece)?;
        let base = n.dot(both.second.centre);
        let low = -both.first.support(-n) - both.first.rounding - base;
        Some((n.dot(both.first.centre) > base).then_some(low))
    }

    /// How deep behind a triangle a point still counts as inside the mesh.
    fn thickness(&self, piece: u32) -> f64 {
        THICK * self.pieces[piece as usize].bounding_radius
    }

    /// Calls `each` for the points at which a piece of a body, whose centre of gravity is at `x`, touches a piece of
    /// the part. Corners and rim points over a triangle, or a little below it, touch its plane.
    pub(crate) fn for_touching(
        &self,
        other: u32,
        both: &Both,
        x: DVec3,
        within: impl Into<Within>,
        mut each: impl FnMut(&Meeting),
    ) {
        let within = within.into();
        match self.over_plane(other, both) {
            Some(None) => return,
            Some(Some(low)) if low > within.gap => return,
            _ => {}
        }
        self.for_over(other, both, x, within.gap, &mut each);
        // Its edges are not felt, and corners over it have been found.
        if self.is_hollow(other) {
            return;
        }
        if self.mesh.is_none() && both.are_beyond(within.gap) {
            return;
        }
        let nearest = nearest(both);
        both.touching(&nearest, within, |m| {
            if self.has(other, &m, x, nearest.gap) {
                each(&m);
            }
        });
    }

    /// Calls `each` for the corners and rim points of a body's piece that are over a triangle, or a little below it,
    /// and touch its plane. The shortest way out of a triangle may lead over its edge, where the next triangle is.
    pub(crate) fn for_over(&self, other: u32, both: &Both, x: DVec3, within: f64, each: &mut impl FnMut(&Meeting)) {
        let Some(n) = self.facet(other) else { return };
        let mut over = |c: DVec3, mark: Mark| {
            let m = self.on_facet(n, both, c, mark);
            if m.gap <= within
                && self.is_over(other, both.first.centre + x, m.points[0] + n * both.first.rounding + x)
                && self.is_exposed(other, &m, x)
            {
                each(&m);
            }
        };
        match both.first.core {
            Core::Polyhedron(body) => {
                // Most corners are far above the plane; what rounding may change is left to the closer look.
                let up = both.first.axes.transpose() * n;
                let base = n.dot(both.first.centre - both.second.centre) - both.first.rounding;
                let most = within - base + FAR_ABOVE * both.size();
                for (k, &c) in body.corners.iter().enumerate().filter(|(_, c)| c.dot(up) <= most) {
                    over(c, Mark::Polyhedra(Feature::Corner { of: 0, corner: k as u8, on: On::Face(0) }));
                }
            }
            Core::Discs(discs) => {
                let down = both.first.axes.transpose() * -n;
                for (ring, slot) in (0..2_u8).flat_map(|ring| (0..SLOTS).map(move |slot| (ring, slot))) {
                    if let Some(p) = discs.rim(usize::from(ring), slot, down) {
                        over(p, Mark::Rim { of: 0, ring, slot });
                    }
                }
            }
        }
    }

    /// The meeting of a point of a body's piece, in the piece's axes, with the plane of a triangle that has this
    /// normal.
    fn on_facet(&self, n: DVec3, both: &Both, c: DVec3, mark: Mark) -> Meeting {
        let p = both.first.centre + both.first.axes * c;
        let distance = n.dot(p - both.second.centre);
        let arm = p - n * both.first.rounding;
        Meeting { normal: n, points: [arm, p - n * distance], gap: distance - both.first.rounding, mark }
    }

    /// Whether a point `at` of a body's piece, whose middle is at `middle`, is over a triangle, or less than the mesh's
    /// thickness below it. A point no farther than that beyond a hollow edge, behind the triangle beside it, counts
    /// too. Otherwise a tip that is, by rounding, below one triangle and beyond the edge would be over neither, and
    /// slip through.
    pub(crate) fn is_over(&self, other: u32, middle: DVec3, at: DVec3) -> bool {
        let Some(mesh) = &self.mesh else { return false };
        let (face, thick) = (&mesh.faces[other as usize], self.thickness(other));
        if face.normal.dot(at) - face.offset <= -thick {
            return false;
        }
        let beyond = face.sides.map(|(inward, offset)| offset - inward.dot(at));
        if beyond.iter().all(|&b| b <= EDGE_LEAN * thick) {
            return true;
        }
        (0..3).any(|side| {
            let b = beyond[side];
            if self.convexities[other as usize][side] != EdgeConvexity::Concave || b <= 0.0 || b >= thick {
                return false;
            }
            let is_before = |k: u32| {
                let beside = &mesh.faces[k as usize];
                beside.normal.dot(middle) > beside.offset
            };
            let [from, to] = [face.corners[side], face.corners[(side + 1) % 3]].map(|c| mesh.vertices()[c as usize]);
            let (along, length) = ((to - from).normalize(), (to - from).length());
            let place = along.dot(at - from);
            place >= -b && place <= length + b && face.neighbours[side].is_some_and(is_before)
        })
    }

    /// The rim point with that name, if it is over the triangle or over a neighbour that continues in its plane or
    /// rises from it.
    pub(super) fn rim_again(&self, other: u32, both: &Both, x: DVec3, mark: Mark) -> Option<Meeting> {
        let (mesh, n) = (self.mesh.as_ref()?, self.facet(other)?);
        let (Mark::Rim { of: 0, ring, slot }, Core::Discs(discs)) = (mark, both.first.core) else { return None };
        let down = both.first.axes.transpose() * -n;
        let ring = usize::from(ring);
        let m = self.on_facet(n, both, discs.rim(ring, slot, down).or_else(|| discs.rim(ring, 1, down))?, mark);
        let at = m.points[0] + x;
        let (face, convexities) = (&mesh.faces[other as usize], &self.convexities[other as usize]);
        let stays =
            face.sides.iter().zip(convexities).all(|(side, &f)| f != EdgeConvexity::Convex || side.0.dot(at) >= side.1);
        stays.then_some(m)
    }

    /// Whether no flush piece covers a piece where it is met. `x` is the body's centre of gravity.
    fn is_exposed(&self, piece: u32, m: &Meeting, x: DVec3) -> bool {
        let k = piece as usize;
        self.seams.is_empty() || self.seams.is_real(&self.pieces[k], k, m.points[1] + x, m.normal)
    }

    /// Whether an edge of a body is met where it crosses a side beyond which the mesh goes on in the same plane: what
    /// bears the edge are its ends over the plane, and its crossings of the plane's outline.
    fn crosses_within_a_plane(&self, piece: u32, m: &Meeting, at: DVec3) -> bool {
        if !matches!(m.mark, Mark::Polyhedra(Feature::Edges(..)) | Mark::Edge { of: 1, .. }) {
            return false;
        }
        let Some(mesh) = &self.mesh else { return false };
        let beyond = mesh.faces[piece as usize].sides.map(|(inward, offset)| inward.dot(at) - offset);
        let nearest = (0..3).min_by(|&k, &l| beyond[k].total_cmp(&beyond[l]));
        nearest.is_some_and(|side| self.convexities[piece as usize][side] == EdgeConvexity::Flat)
    }

    /// Whether a meeting is one with the mesh: from outside, and at an edge not leaning into a triangle beside it; that
    /// triangle then has the true meeting. So edges between triangles in one plane, and hollow edges, are not felt.
    /// `x` is the body's centre of gravity, and `lowest` the gap of the nearest points.
    pub(crate) fn has(&self, piece: u32, m: &Meeting, x: DVec3, lowest: f64) -> bool {
        if !self.is_exposed(piece, m, x) {
            return false;
        }
        let Some(mesh) = &self.mesh else { return true };
        let face = &mesh.faces[piece as usize];
        let (n, q) = (m.normal, m.points[1] + x);
        let up = n.dot(face.normal);
        if up < EDGE_LEAN || self.crosses_within_a_plane(piece, m, q) {
            return false;
        }
        if up > 1.0 - EDGE_LEAN * EDGE_LEAN {
            return true;
        }
        let near = |c: &u32| {
            (mesh.vertices()[*c as usize] - q).length() <= EDGE_LEAN * self.pieces[piece as usize].bounding_radius
        };
        let corner = face.corners.iter().copied().find(near);
        if corner.is_some_and(|corner| ends_at(mesh, corner, n, m.gap - lowest)) {
            return true;
        }
        let mut at_edge = false;
        for (side, &(inward, offset)) in face.sides.iter().enumerate() {
            let (from, to) = (face.corners[side], face.corners[(side + 1) % 3]);
            let length = (mesh.vertices()[to as usize] - mesh.vertices()[from as usize]).length();
            if inward.dot(q) - offset > EDGE_LEAN * length {
                continue;
            }
            at_edge = true;
            // A side between triangles in one plane is no side at its ends: there, others are.
            if corner.is_some() && self.convexities[piece as usize][side] == EdgeConvexity::Flat {
                continue;
            }
            let leans_in = |f: &Face| {
                let own = (0..3).find(|&s| f.corners[s] == from && f.corners[(s + 1) % 3] == to);
                let other = (0..3).find(|&s| f.corners[s] == to && f.corners[(s + 1) % 3] == from);
                own.or(other).is_some_and(|s| n.dot(f.sides[s].0) > EDGE_LEAN)
            };
            let beside = face.neighbours[side].map(|k| &mesh.faces[k as usize]);
            if leans_in(face) || beside.is_some_and(leans_in) {
                return false;
            }
        }
        // At a corner, no edge may lead into the body.
        at_edge
            && corner.is_none_or(|corner| {
                let edges = mesh.edges_at_vertex(corner).iter();
                edges.map(|&e| mesh.along_edge(e, corner)).all(|edge| n.dot(edge) <= EDGE_LEAN * edge.length())
            })
    }
}

/// The flat faces of parts that lie flush with others, but for those whose friction changes along them.
fn flush_faces(parts: &[StaticShape], colliders: &[StaticCollider]) -> Vec<RegionFace> {
    let mut faces = Vec::new();
    for (k, (part, collider)) in parts.iter().zip(colliders).enumerate().filter(|(_, (_, c))| !c.seams.is_empty()) {
        if matches!(part, StaticShape::Block { sections, .. } if !sections.is_empty()) {
            continue;
        }
        let of_pieces = || collider.pieces.iter().zip(0..).flat_map(|(piece, n)| Facets::of_piece(piece, n).all);
        let facets = if collider.mesh.is_some() { collider.facets.all.clone() } else { of_pieces().collect() };
        let material = |piece: u32| part.material(Surface::Spot { part: k as u16, piece, point: 0 });
        faces.extend(facets.into_iter().map(|facet| RegionFace::new(k, material(facet.flat.piece), facet)));
    }
    faces
}
