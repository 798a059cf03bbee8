//! Meshes that are balls, boxes, cylinders, cones or capsules become these.

use super::numbers::{number, shortest};
use super::things::{Count, Piece, Role, Shape, Thing, Things};
use super::write::angles;
use crate::turns::by_angles;
use glam::{DQuat, DVec3};
use plaus_asset::recognise::{Recognised, Solid, TOLERANCE, recognised};

/// How far a size may be rounded, as a share of the mesh's size: files have 7 digits.
pub(super) const ROUNDED: f64 = 1e-6;
/// The same of an angle, in degrees.
const ROUNDED_DEG: f64 = 1e-5;
/// A recognised mesh is as far off as the file's numbers are rounded if it is no farther off than this share of its
/// least extent.
const EXACT: f64 = 1e-4;
/// The least share of its solid's volume that scenery encloses: a room, whose faces point inwards, encloses less than
/// nothing.
const FILLED: f64 = 0.5;

/// A recognised shape, where it is in its mesh, in mm, and how it is turned there.
struct Found {
    shape: Shape,
    at: DVec3,
    turn: DQuat,
    /// How far the two are apart at most, in mm, if that is more than rounding.
    off: Option<f64>,
}

/// A shape as a scenario has it, from sizes in mm.
fn said(solid: &Solid, size: f64) -> String {
    let mm = |length: f64| number(shortest(length, ROUNDED * size));
    match solid {
        Solid::Ball { radius } => format!("ball = {{ radius_mm = {} }}", mm(*radius)),
        Solid::Box { size } => format!("box = {{ size_mm = [{}, {}, {}] }}", mm(size.x), mm(size.y), mm(size.z)),
        Solid::Cylinder { radius, height } | Solid::Cone { radius, height } => {
            format!("{} = {{ radius_mm = {}, height_mm = {} }}", solid.name(), mm(*radius), mm(*height))
        }
        Solid::Capsule { radius, length } => {
            format!("capsule = {{ radius_mm = {}, length_mm = {} }}", mm(*radius), mm(*length))
        }
    }
}

impl Things<'_> {
    fn find(&mut self, object: Option<&str>, role: Role, name: &str) -> Option<Found> {
        let mesh = self.triangles(object);
        let Recognised { solid, at, turn, off, gap } = recognised(&mesh, TOLERANCE)?;
        let shape = Shape::File { object: object.map(String::from) };
        if role == Role::Fixed && self.enclosed(&shape) < FILLED * solid.volume() * 1e-9 {
            return None;
        }
        let [low, high] = mesh.ends();
        let size = (high - low).max_element();
        let far = off.max(gap);
        let off = (far > EXACT * solid.least()).then_some(far);
        *self.recognised.kinds.entry(solid.name()).or_default() += 1;
        if let Some(off) = off.filter(|off| self.recognised.farthest.as_ref().is_none_or(|(most, _)| off > most)) {
            self.recognised.farthest = Some((off, name.to_owned()));
        }
        let at = DVec3::from_array(at.to_array().map(|x| shortest(x, ROUNDED * size)));
        let turn = rounded(turn);
        Some(Found { shape: Shape::Solid { said: said(&solid, size), volume: solid.volume() * 1e-9 }, at, turn, off })
    }

    /// Replaces the mesh of a thing, and those of its pieces, by solids where they are such.
    pub(super) fn recognise(&mut self, thing: &mut Thing) {
        match &mut thing.shape {
            Shape::File { object } => {
                let Some(found) = self.find(object.as_deref(), thing.role, &thing.name) else { return };
                thing.remark =
                    found.off.map(|off| format!("its mesh is this to {} mm", number(shortest(off, 0.01 * off))));
                if thing.role == Role::Driven {
                    let piece = Piece { shape: found.shape, at: found.at * 1e-3, turn: found.turn, density: 1.0 };
                    thing.shape = Shape::of_pieces(vec![piece]);
                } else {
                    thing.at += thing.turn * found.at;
                    thing.turn = rounded(thing.turn * found.turn);
                    thing.shape = found.shape;
                }
            }
            Shape::Pieces(pieces) => {
                for piece in pieces {
                    let Shape::File { object } = &piece.shape else { continue };
                    let Some(found) = self.find(object.as_deref(), thing.role, &thing.name) else { continue };
                    piece.at += piece.turn * found.at * 1e-3;
                    piece.turn = rounded(piece.turn * found.turn);
                    piece.shape = found.shape;
                }
            }
            Shape::Hull { .. } | Shape::Solid { .. } => {}
        }
    }

    /// Tells what was recognised.
    pub(super) fn tell_recognised(&mut self) {
        let Count { kinds, farthest } = std::mem::take(&mut self.recognised);
        if kinds.is_empty() {
            return;
        }
        let plural = |kind: &str, count: usize| match (kind, count) {
            (_, 1) => format!("1 {kind}"),
            ("box", _) => format!("{count} boxes"),
            _ => format!("{count} {kind}s"),
        };
        let list: Vec<String> = kinds.iter().map(|(kind, &count)| plural(kind, count)).collect();
        let off = farthest.map_or_else(String::new, |(off, name)| {
            format!(", up to {} mm from their surfaces ({name})", number(shortest(off, 0.01 * off)))
        });
        self.notes.push(format!(
            "meshes are taken for what they are to within {}% of their least extent: {}{off}",
            100.0 * TOLERANCE,
            list.join(", ")
        ));
    }
}

/// A rotation with short angles.
fn rounded(turn: DQuat) -> DQuat {
    by_angles(angles(turn).map(|angle| shortest(angle, ROUNDED_DEG)))
}
