//! Hollow things that move become several convex pieces.

use super::geoms::hull;
use super::numbers::{number, shortest};
use super::things::{Piece, Shape, Thing, Things};
use crate::custom::{corners, faces, standing_out};
use glam::{DQuat, DVec3};
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

fn part(points: &[DVec3]) -> Option<Part> {
    let kept = corners(points).ok()?.points;
    // As a scenario has them.
    let points: Vec<DVec3> = kept.iter().map(|point| (*point * 1e9).round() * 1e-9).collect();
    let hull = ConvexHull::new(&points, 0.0).ok()?;
    Some(Part { points, hull })
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

impl Things<'_> {
    /// Cuts the mesh of a thing, which encloses less than its hull, into convex pieces; tells how far these are off.
    /// `own` is the volume that the mesh encloses, `whole` that of its hull, in m³.
    pub(super) fn split(&mut self, thing: &mut Thing, own: f64, whole: f64) -> bool {
        let Shape::File { object } = &thing.shape else { return false };
        if !(HOLLOW[0] * whole..HOLLOW[1] * whole).contains(&own) {
            return false;
        }
        let mesh = self.triangles(object.as_deref()).moved(|corner| corner * 1e-3);
        let parts: Vec<Part> = pieces(&mesh).iter().filter_map(|points| part(points)).collect();
        let Some(outside) = Surface::new(&mesh).filter(|_| parts.len() > 1) else { return false };
        let all: f64 = parts.iter().map(|part| part.hull.volume()).sum();
        let out = parts.iter().flat_map(|part| surface(&part.hull)).map(|point| outside.outside(point));
        let out = out.fold(0.0, f64::max);
        let planes: Vec<_> = parts.iter().map(|part| faces(&part.hull)).collect();
        let beyond =
            |point: DVec3| planes.iter().map(|faces| standing_out(faces, point)).fold(f64::INFINITY, f64::min).max(0.0);
        let lacks = mesh.corners.iter().map(|&corner| beyond(corner)).fold(0.0, f64::max);
        let mm = |off: f64| format!("up to {} mm", number(shortest(1e3 * off, 10.0 * off)));
        let lacks =
            if lacks > LACK { format!(", and from which it stands out by {}", mm(lacks)) } else { String::new() };
        self.left_out.push(format!(
            "{}: its mesh, which is hollow: what moves are {} convex pieces, which stand out of it by {}{lacks}",
            thing.name,
            parts.len(),
            mm(out)
        ));
        // Pieces overlap: together they have the mass of the mesh.
        let density = shortest(own / all, 1e-6);
        let piece = |part: Part| Piece {
            shape: Shape::Solid { said: hull(&part.points), volume: part.hull.volume() },
            at: DVec3::ZERO,
            turn: DQuat::IDENTITY,
            density,
        };
        thing.shape = Shape::Pieces(parts.into_iter().map(piece).collect());
        true
    }
}
