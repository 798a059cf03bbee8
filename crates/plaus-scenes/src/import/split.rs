//! Hollow things that move become several convex pieces.

use super::geoms::{FINE, hull, to};
use super::numbers::{number, shortest};
use super::things::{Piece, Shape, Thing, Things};
use crate::custom::{corners, faces, hull_volume, standing_out};
use glam::{DQuat, DVec3};
use plaus_asset::Triangles;
use plaus_asset::pieces::{Surface, pieces};
use plaus_sim::shape::ConvexHull;

/// Between which shares of its hull a mesh encloses to be cut into pieces: less is no volume, such as a sheet; what is
/// more is nearly convex, and pieces take their time.
const HOLLOW: [f64; 2] = [1e-3, 0.9];

/// How far a mesh may stand out of its pieces without a word, in m: what coordinates in a scenario are rounded to.
const LACK: f64 = 1e-6;

/// A convex piece of a mesh, in m.
struct Part {
    points: Vec<DVec3>,
    hull: ConvexHull,
}

/// The hull of some points, whose corners are as a scenario has them: to a nanometre, or finer where that much decides
/// on the faces.
fn part(points: &[DVec3]) -> Option<Part> {
    let kept = corners(points).ok()?.points;
    FINE.iter().find_map(|&fine| {
        let read = |at: f64| 1e-3 * to(1e3 * at, fine);
        let points: Vec<DVec3> = kept.iter().map(|point| DVec3::from(point.to_array().map(read))).collect();
        let hull = ConvexHull::new(&points, 0.0).ok()?;
        Some(Part { points, hull })
    })
}

/// Points of the surface of a hull: corners, the middles of faces, and half-way between.
fn surface(hull: &ConvexHull) -> Vec<DVec3> {
    let place = |corner: DVec3| hull.centre() + hull.turn() * corner;
    let mut points: Vec<DVec3> = hull.corners().iter().map(|&corner| place(corner)).collect();
    for face in hull.faces() {
        let own: Vec<DVec3> =
            face.iter().filter_map(|&index| hull.corners().get(usize::from(index)).copied()).collect();
        let middle = own.iter().sum::<DVec3>() / own.len().max(1) as f64;
        points.push(place(middle));
        let next = own.iter().skip(1).chain(own.first());
        points.extend(own.iter().zip(next).flat_map(|(&a, &b)| [0.5 * (a + b), 0.5 * (a + middle)].map(place)));
    }
    points
}

/// A hollow mesh as convex pieces, which overlap a little. Lengths are in the unit of the mesh.
#[derive(Debug, Clone)]
pub struct Cut {
    /// The corners of each piece.
    pub pieces: Vec<Vec<DVec3>>,
    /// The volume of each piece.
    pub volumes: Vec<f64>,
    /// How far the pieces stand out of the mesh at most, at their corners and in between.
    pub out: f64,
    /// How far the mesh stands out of the pieces at most.
    pub lacks: f64,
}

/// A mesh that encloses less than 90 % of its convex hull as convex pieces; none of other meshes, and of those that
/// enclose nothing. Its faces are anticlockwise as seen from outside.
#[must_use]
pub fn cut(mesh: &Triangles) -> Option<Cut> {
    cut_of(mesh, mesh.volume(), hull_volume(&mesh.corners).ok()?)
}

/// As [`cut`], for a mesh that encloses `own`, and its hull `whole`.
fn cut_of(mesh: &Triangles, own: f64, whole: f64) -> Option<Cut> {
    if !(HOLLOW[0] * whole..HOLLOW[1] * whole).contains(&own) {
        return None;
    }
    let parts: Vec<Part> = pieces(mesh).iter().filter_map(|points| part(points)).collect();
    let outside = Surface::new(mesh).filter(|_| parts.len() > 1)?;
    let out = parts.iter().flat_map(|part| surface(&part.hull)).map(|point| outside.outside(point));
    let out = out.fold(0.0, f64::max);
    let planes: Vec<_> = parts.iter().map(|part| faces(&part.hull)).collect();
    let beyond =
        |point: DVec3| planes.iter().map(|faces| standing_out(faces, point)).fold(f64::INFINITY, f64::min).max(0.0);
    let lacks = mesh.corners.iter().map(|&corner| beyond(corner)).fold(0.0, f64::max);
    let volumes = parts.iter().map(|part| part.hull.volume()).collect();
    Some(Cut { pieces: parts.into_iter().map(|part| part.points).collect(), volumes, out, lacks })
}

impl Things<'_> {
    /// Cuts the mesh of a thing, which encloses less than its hull, into convex pieces; tells how far these are off.
    /// `own` is the volume that the mesh encloses, `whole` that of its hull, in m³.
    pub(super) fn split(&mut self, thing: &mut Thing, own: f64, whole: f64) -> bool {
        let Shape::File { object } = &thing.shape else { return false };
        let mesh = self.triangles(object.as_deref()).moved(|corner| corner * 1e-3);
        let Some(Cut { pieces, volumes, out, lacks }) = cut_of(&mesh, own, whole) else { return false };
        let mm = |off: f64| format!("up to {} mm", number(shortest(1e3 * off, 10.0 * off)));
        let lacks =
            if lacks > LACK { format!(", and from which it stands out by {}", mm(lacks)) } else { String::new() };
        self.left_out.push(format!(
            "{}: its mesh, which is hollow: what moves are {} convex pieces, which stand out of it by {}{lacks}",
            thing.name,
            pieces.len(),
            mm(out)
        ));
        // Pieces overlap: together they have the mass of the mesh.
        let density = shortest(own / volumes.iter().sum::<f64>(), 1e-6);
        let piece = |(points, volume): (Vec<DVec3>, f64)| Piece {
            shape: Shape::Solid { said: hull(&points), volume },
            at: DVec3::ZERO,
            turn: DQuat::IDENTITY,
            density,
        };
        thing.shape = Shape::Pieces(pieces.into_iter().zip(volumes).map(piece).collect());
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_dist::math::{cos, sin};
    use std::f64::consts::TAU;

    /// A ring of 32 by 12 corners about the z axis, 2.5 times `size` across.
    fn ring(size: f64) -> Triangles {
        let [around, across] = [32_u32, 12];
        let corner = |number: u32| {
            let angle = |turn: u32, of: u32| TAU * f64::from(turn) / f64::from(of);
            let (long, short) = (angle(number / across, around), angle(number % across, across));
            let far = 1.0 + 0.25 * cos(short);
            size * DVec3::new(far * cos(long), far * sin(long), 0.25 * sin(short))
        };
        let faces = (0..around * across).flat_map(|number| {
            let (ring, side) = (number / across, number % across);
            let at = |ring: u32, side: u32| (ring % around) * across + side % across;
            let [a, b, c, d] = [at(ring, side), at(ring + 1, side), at(ring + 1, side + 1), at(ring, side + 1)];
            [[a, b, c], [a, c, d]]
        });
        Triangles { corners: (0..around * across).map(corner).collect(), faces: faces.collect() }
    }

    #[test]
    fn no_piece_is_lost_whatever_the_size() {
        for size in [0.02, 1.0, 50.0] {
            let found = cut(&ring(size)).unwrap();
            assert_eq!(found.pieces.len(), found.volumes.len());
            for piece in &found.pieces {
                let text = hull(piece);
                let numbers = text.split(|c: char| !"-.0123456789".contains(c)).filter_map(|n| n.parse::<f64>().ok());
                let read: Vec<f64> = numbers.map(|mm| 1e-3 * mm).collect();
                assert_eq!(read, piece.iter().flat_map(|point| point.to_array()).collect::<Vec<_>>());
            }
            // The voxels that it is cut by are 1/64 of its largest extent.
            assert!(found.lacks < 2.5 * size / 64.0, "{size}: {} pieces lack {}", found.pieces.len(), found.lacks);
        }
    }
}
