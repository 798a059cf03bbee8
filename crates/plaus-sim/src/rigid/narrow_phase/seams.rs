//! Seams of convex pieces that lie flush, of one body or of all fixed parts: a face that another piece covers is not
//! felt, nor is an edge of it (internal edges: what slides over two flush blocks must not trip where they meet).
//!
//! The normal of a contact has a share of the normals of all faces that meet at its point. The contact is real if each
//! of these faces is exposed there: some place of it nearby is in no other piece. If some are covered, what covers them
//! is felt in its place where it lies flush with the faces that are exposed; if it rises over one of these, the corner
//! is hollow, and the contact is real. So a wall on a floor is felt down to its foot, and so is the floor up to the
//! wall, but of two flush blocks only the tops are.

use crate::broad::BoxTree;
use crate::rigid::BodyDef;
use crate::rigid::body_state::Pose;
use crate::rigid::tolerances::{EDGE_LEAN, FLUSH_DISTANCE, FLUSH_FACE_DISTANCE, LEAST_NORMAL_SHARE};
use crate::scenery::{Aabb, Face, Mesh};
use crate::shape::convex_pair::Meeting;
use crate::shape::convex_pair::{Both, nearest};
use crate::shape::piece::{Core, Piece};
use crate::shape::{Polyhedron, PolyhedronFace};
use glam::{DMat3, DVec3};

/// Which pieces lie flush, in the axes of their body or of the world.
#[derive(Debug, Clone, Default)]
pub(crate) struct Seams {
    /// Pieces that others lie at.
    others: Vec<Piece>,
    /// For each piece, those that lie at it; empty if no piece has any.
    beside: Vec<Vec<u32>>,
}

/// Pieces among which flush ones are looked for.
pub(crate) struct Around {
    pieces: Vec<(Piece, usize)>,
    tree: BoxTree,
}

impl Around {
    /// Pieces, each with the number of what it belongs to.
    pub(crate) fn new(pieces: Vec<(Piece, usize)>) -> Self {
        let boxes: Vec<Aabb> = pieces.iter().map(|(piece, _)| bounds(piece)).collect();
        Self { tree: BoxTree::new(&boxes), pieces }
    }
}

impl Seams {
    /// The seams of `pieces` with those around that are `felt`, by what they belong to and their place in the list.
    /// Only sharp polyhedra have any: a rounding leaves a groove.
    pub(crate) fn new(pieces: &[Piece], around: &Around, felt: impl Fn(usize, usize) -> bool) -> Self {
        let mut seams = Self::default();
        let mut number = vec![None; around.pieces.len()];
        let mut near = Vec::new();
        for (k, piece) in pieces.iter().enumerate().filter(|(_, piece)| sharp(piece).is_some()) {
            let bounding_radius = FLUSH_DISTANCE * piece.bounding_radius;
            around.tree.find(&bounds(piece).grown(bounding_radius), &mut near);
            for &j in &near {
                let (j, (other, owner)) = (j as usize, &around.pieces[j as usize]);
                if !felt(*owner, j) || is_same(piece, other) || !are_flush(piece, other) {
                    continue;
                }
                let next = seams.others.len() as u32;
                let at = *number[j].get_or_insert(next);
                if at == next {
                    seams.others.push(other.clone());
                }
                seams.beside.resize(pieces.len(), Vec::new());
                seams.beside[k].push(at);
            }
        }
        seams
    }

    /// The seams of a body's own pieces.
    pub(crate) fn within(pieces: &[Piece]) -> Self {
        if pieces.len() < 2 {
            return Self::default();
        }
        Self::new(pieces, &Around::new(pieces.iter().map(|p| (p.clone(), 0)).collect()), |_, _| true)
    }

    /// Whether no pieces lie flush.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.beside.is_empty()
    }

    /// Whether a contact at `q` on a piece, with a normal out of the piece, is one with the union of all pieces.
    pub(crate) fn is_real(&self, piece: &Piece, index: usize, q: DVec3, normal: DVec3) -> bool {
        let (Some(beside), Some(core)) = (self.beside.get(index), sharp(piece)) else { return true };
        let slack = |other: &Piece| FLUSH_DISTANCE * piece.bounding_radius.min(other.bounding_radius);
        let beside: Vec<&Piece> = beside.iter().map(|&k| &self.others[k as usize]).collect();
        let is_near = |other: &&&Piece| depth(other, q) > -3.0 * slack(other);
        if !beside.iter().any(|other| is_near(&other)) {
            return true;
        }
        let turned = piece.turn.transpose();
        let (seen, n) = (turned * (q - piece.at), turned * normal);
        let at = FLUSH_DISTANCE * piece.bounding_radius;
        let steps = |share: f64| if share > 1.0 - LEAST_NORMAL_SHARE { &FACE_STEPS[..] } else { &FACE_STEPS[..1] };
        if !core.has_inside() {
            let share = n.dot(core.face(0).normal);
            let is_open = |p: DVec3| {
                let p = piece.at + piece.turn * p;
                !beside.iter().any(|other| covers(other, p, piece.turn * core.face(0).normal, 0.5 * slack(other)))
            };
            let is_covered = |step: &f64| is_exposed(core, 0, seen, step * at, is_open) == Some(false);
            if share > LEAST_NORMAL_SHARE && steps(share).iter().all(is_covered) {
                return false;
            }
            let is_surface =
                |p: DVec3| beside.iter().any(|o| depth(o, piece.at + piece.turn * p).abs() <= 0.1 * slack(o));
            return share > 1.0 - LEAST_NORMAL_SHARE || !goes_on(core, seen, n, at, is_surface);
        }
        let is_outside = |p: DVec3| {
            let p = piece.at + piece.turn * p;
            beside.iter().all(|other| depth(other, p) < -0.5 * slack(other))
        };
        // Whether something beside the piece rises over the plane of a face: the corner between them is hollow.
        let is_hollow = |face: &PolyhedronFace| {
            let normal = piece.turn * face.normal;
            let rises = |other: &&Piece| {
                let height = other.placed(&DMat3::IDENTITY, DVec3::ZERO).support(normal) - normal.dot(piece.at);
                height > face.offset + slack(other)
            };
            beside.iter().filter(is_near).any(rises)
        };
        let (mut is_covered, mut is_open, mut is_in_hollow) = (false, false, false);
        for (k, face) in core.faces.iter().enumerate() {
            let share = n.dot(face.normal);
            if share <= LEAST_NORMAL_SHARE || (face.normal.dot(seen) - face.offset).abs() > at {
                continue;
            }
            if steps(share).iter().any(|step| is_exposed(core, k as u8, seen, step * at, is_outside) == Some(true)) {
                is_open = true;
                is_in_hollow = is_in_hollow || is_hollow(face);
            } else {
                is_covered = true;
            }
        }
        !is_covered || is_open && is_in_hollow
    }
}

/// How far from a point with a face's normal places of the face are looked at, over the distance at which pieces are
/// flush. A point at an edge or a corner of a face has only the first.
const FACE_STEPS: [f64; 3] = [1.0, 30.0, FLUSH_FACE_DISTANCE / FLUSH_DISTANCE];

/// Whether a place of a face near `q` is in the open; `None` if no place looked at is on the face.
fn is_exposed(core: &Polyhedron, face: u8, q: DVec3, step: f64, is_outside: impl Fn(DVec3) -> bool) -> Option<bool> {
    let f = core.face(face);
    let along = (core.corner(f.corners[1]) - core.corner(f.corners[0])).normalize();
    let across = f.normal.cross(along);
    let projection = q - f.normal * (f.normal.dot(q) - f.offset);
    [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (0.7, 0.7), (-0.7, 0.7), (-0.7, -0.7), (0.7, -0.7)]
        .into_iter()
        .map(|(x, y)| projection + (along * x + across * y) * step)
        .filter(|&p| core.is_over(face, p, 0.0))
        .map(is_outside)
        .reduce(|one, other| one || other)
}

/// Whether a piece lies on a triangle at a point of it: a solid there, or a triangle that faces it. Beside a triangle,
/// in its plane, [`depth`] does not tell how far away it is.
fn covers(other: &Piece, p: DVec3, normal: DVec3, slack: f64) -> bool {
    let Some(core) = sharp(other).filter(|core| !core.has_inside()) else { return depth(other, p) >= -slack };
    let (face, seen) = (core.face(0), other.turn.transpose() * (p - other.at));
    let faces_it = (other.turn * face.normal).dot(normal) < LEAST_NORMAL_SHARE - 1.0;
    faces_it && (face.normal.dot(seen) - face.offset).abs() <= slack && core.is_over(0, seen, slack)
}

/// Whether a triangle's surface goes on, in another piece, beyond the side over which a normal leans.
fn goes_on(core: &Polyhedron, q: DVec3, n: DVec3, step: f64, is_surface: impl Fn(DVec3) -> bool) -> bool {
    let front = core.face(0);
    let corners = &front.corners;
    (0..corners.len()).any(|k| {
        let (from, to) = (core.corner(corners[k]), core.corner(corners[(k + 1) % corners.len()]));
        let out = (to - from).cross(front.normal).normalize();
        n.dot(out) > LEAST_NORMAL_SHARE && out.dot(q - from).abs() <= step && is_surface(q + out * step)
    })
}

/// Whether two sharp pieces touch, and neither is in the other: pieces that go through each other have hollow corners.
fn are_flush(a: &Piece, b: &Piece) -> bool {
    let placed = |piece| Piece::placed(piece, &DMat3::IDENTITY, DVec3::ZERO);
    let slack = FLUSH_DISTANCE * a.bounding_radius.min(b.bounding_radius);
    sharp(b).is_some() && nearest(&Both { first: placed(a), second: placed(b) }).gap.abs() <= slack
}

/// Whether both are one piece.
fn is_same(a: &Piece, b: &Piece) -> bool {
    a.at == b.at
        && a.turn == b.turn
        && matches!((&a.core, &b.core), (Core::Polyhedron(p), Core::Polyhedron(q)) if p == q)
}

/// How deep a point is in a piece, in m; negative outside.
fn depth(piece: &Piece, p: DVec3) -> f64 {
    -piece.placed(&DMat3::IDENTITY, DVec3::ZERO).project(p).1
}

/// The core of a polyhedron without rounding.
fn sharp(piece: &Piece) -> Option<&Polyhedron> {
    match &piece.core {
        Core::Polyhedron(core) if piece.rounding == 0.0 && core.faces.len() >= 2 => Some(core),
        _ => None,
    }
}

/// The box around a piece.
pub(crate) fn bounds(piece: &Piece) -> Aabb {
    let placed = piece.placed(&DMat3::IDENTITY, DVec3::ZERO);
    let bounding_radius = |axis: usize| placed.support(DVec3::AXES[axis]) + piece.rounding;
    let low = |axis: usize| -placed.support(-DVec3::AXES[axis]) - piece.rounding;
    Aabb {
        min: DVec3::new(low(0), low(1), low(2)),
        max: DVec3::new(bounding_radius(0), bounding_radius(1), bounding_radius(2)),
    }
}

/// Whether a point of pieces of two bodies, about the first body's centre of gravity, is no point of a seam of either.
pub(crate) fn are_real([s, t]: [&BodyDef; 2], [a, b]: [&Pose; 2], [own, other]: [usize; 2], m: &Meeting) -> bool {
    let is_real = |spec: &BodyDef, r: &DMat3, k: usize, q: DVec3, n: DVec3| {
        spec.seams.is_empty() || spec.seams.is_real(&spec.pieces[k], k, r.transpose() * q, r.transpose() * n)
    };
    is_real(s, &a.r, own, m.points[0], -m.normal) && is_real(t, &b.r, other, m.points[1] - (b.x - a.x), m.normal)
}

/// How a mesh continues across a side of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum EdgeConvexity {
    /// Away from a body over the triangle, or not at all.
    Convex,
    /// In the same plane.
    Flat,
    /// Towards a body over the triangle: the edge is hollow.
    Concave,
}

impl EdgeConvexity {
    pub(super) fn of(mesh: &Mesh, face: &Face, side: usize) -> Self {
        let Some(beside) = face.neighbours[side].map(|k| &mesh.faces[k as usize]) else { return Self::Convex };
        let [from, to] = [face.corners[side], face.corners[(side + 1) % 3]];
        let far = beside.corners.into_iter().find(|&c| c != from && c != to).unwrap_or(from);
        let at = |c: u32| mesh.vertices()[c as usize];
        let rise = (face.normal.dot(at(far)) - face.offset) / (at(far) - at(from)).length();
        if rise > EDGE_LEAN {
            Self::Concave
        } else if rise < -EDGE_LEAN {
            Self::Convex
        } else {
            Self::Flat
        }
    }
}

/// Whether edges that lead from a corner of a mesh into a body end at that corner, and are no deeper in the body's face
/// with this normal than `deeper` metres more than the corner: so a face of the body lies along them.
pub(super) fn ends_at(mesh: &Mesh, corner: u32, n: DVec3, deeper: f64) -> bool {
    let edges = || mesh.edges_at_vertex(corner).iter().map(|&e| mesh.along_edge(e, corner));
    let goes_on = |edge: DVec3| {
        let straight = (EDGE_LEAN - 1.0) * edge.length();
        edges().any(|other| other.dot(edge) < straight * other.length())
    };
    deeper > 0.0
        && edges().all(|edge| {
            let (rise, lean) = (n.dot(edge), EDGE_LEAN * edge.length());
            rise <= lean || rise <= lean + deeper && !goes_on(edge)
        })
}
