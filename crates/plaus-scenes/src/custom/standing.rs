//! What stands still: planes, tables, solids, curved tracks, meshes of files, and ground by its heights; the latter two
//! with bumps.

use super::bumpy::Surface;
use super::config::Fixed;
use super::names::{Member, colour};
use super::shapes::{Faces, Form, Reader, What};
use super::substances::{Substance, substance};
use super::there::There;
use super::values::{Collector, MM, Numbers, Value, Values, vector};
use crate::animation::{self, Look, UPRIGHT, upright};
use crate::scene::ConfigError;
use crate::turns::by_angles;
use crate::uneven::Field;
use glam::{DQuat, DVec3};
use plaus_sim::WorldError;
use plaus_sim::material::Material as Kind;
use plaus_sim::rigid::{StaticShape, StaticSolid};
use plaus_sim::scenery::{Aabb, Mesh, Plane};
use std::sync::Arc;

/// A piece of scenery.
#[derive(Debug, Clone)]
pub(super) struct Standing {
    pub(super) name: String,
    /// Its table in the file.
    pub(super) key: String,
    pub(super) look: Look,
    what: What,
    pub(super) substance: usize,
    at: Values,
    turn: Values,
    pub(super) there: There,
}

/// Random fields of a piece of scenery.
pub(super) struct Random {
    /// The properties.
    pub(super) fields: Vec<Field>,
    /// Whether their control points fill space, and not only the table's plane.
    pub(super) is_deep: bool,
    /// Distance of control points in m.
    pub(super) spacing: f64,
}

impl Standing {
    pub(super) fn new(
        collector: &mut Collector,
        member: &Member,
        fixed: &Fixed,
        kinds: &[String],
        substances: &[Substance],
    ) -> Result<Self, ConfigError> {
        let owner = member.owner();
        let substance = substance(&owner, "material", kinds, &fixed.material)?;
        let look = substances[substance].look(colour(&owner, &fixed.colour)?, Look::quiet(member.entry));
        let what = fixed.shape.read(&mut Reader::new(collector, &owner))?;
        let what = match &fixed.bumps {
            Some(bumps) => what.with_bumps(collector, &owner, bumps)?,
            None => what,
        };
        let at = collector.three(&owner, "at_mm", ["x", "y", "z"], &fixed.at_mm)?;
        let turn = collector.three(&owner, "turn_deg", ["turn_x", "turn_y", "turn_z"], &fixed.turn_deg)?;
        let there = There::new(collector, &owner, fixed.present.as_ref())?;
        Ok(Self { name: owner.name.to_owned(), key: member.key.clone(), look, what, substance, at, turn, there })
    }

    /// Whether no draw changes it.
    pub(super) fn is_fixed(&self) -> bool {
        let has_fixed_shape = self.is_plane() || self.has_fixed_faces();
        has_fixed_shape && self.at.iter().chain(&self.turn).all(|value| value.is_fixed())
    }

    /// Its random fields, if it has any.
    pub(super) fn random(&self, numbers: &Numbers<'_>) -> Option<Random> {
        let (fields, is_deep, spacing) = match &self.what {
            What::Table(table) => (table.fields().collect(), false, table.spacing(numbers)),
            What::Mesh(Faces { bumps: Some(bumps), .. }) => (vec![Field::Height], true, bumps.spacing(numbers)),
            _ => return None,
        };
        Some(Random { fields, is_deep, spacing })
    }

    /// Whether it has random fields.
    pub(super) fn is_random(&self) -> bool {
        matches!(&self.what, What::Table(_) | What::Mesh(Faces { bumps: Some(_), .. }))
    }

    /// Whether its bumps turn a triangle over, in a draw.
    pub(super) fn is_folded(&self, numbers: &Numbers<'_>) -> Result<bool, WorldError> {
        match &self.what {
            What::Mesh(faces) if faces.bumps.is_some() => Ok(faces.of(numbers)?.1),
            _ => Ok(false),
        }
    }

    /// Tries its shape, and keeps the mesh of one that no draw changes.
    pub(super) fn check(&mut self, numbers: &Numbers<'_>) -> Result<(), WorldError> {
        match &self.what {
            What::Solid(form) => return form.make(numbers).map(drop),
            What::Arc(_) => return self.make(numbers).map(drop),
            _ => {}
        }
        let keeps = self.is_fixed();
        if let What::Mesh(faces) = &mut self.what {
            faces.keep(numbers)?;
        }
        if let Some(made) = self.mesh(numbers)?
            && let What::Mesh(faces) = &mut self.what
        {
            faces.kept = Some(made).filter(|_| keeps);
        }
        Ok(())
    }

    /// Refuses bodies that its bumps are too fine for: how far these reach, in m, with their names.
    pub(super) fn check_bodies(&self, bodies: &[(String, f64)], numbers: &Numbers<'_>) -> Result<(), ConfigError> {
        let What::Table(table) = &self.what else { return Ok(()) };
        let Some((name, least)) =
            bodies.iter().find_map(|(name, reach)| Some((name, table.too_fine(*reach, numbers)?)))
        else {
            return Ok(());
        };
        let message = format!("too fine for a body as large as {name:?}: at least {least:.3} mm");
        Err(ConfigError::new(format!("{}.shape.table.spacing_mm", self.key), message))
    }

    /// Where it is, in m, and how it is turned.
    pub(super) fn pose(&self, numbers: &Numbers<'_>) -> (DVec3, DQuat) {
        (vector(&self.at, numbers) * MM, by_angles(self.turn.map(|angle| angle.of(numbers))))
    }

    /// Whether no draw changes its faces, but for where it is and how it is turned.
    pub(super) fn has_fixed_faces(&self) -> bool {
        match &self.what {
            What::Solid(form) => form.is_fixed,
            What::Mesh(faces) => faces.is_fixed(),
            What::Arc(curved) => curved.is_fixed,
            What::Plane | What::Table(_) => false,
        }
    }

    /// Corners and triangles of its surface in m, about its place and along its axes.
    ///
    /// # Errors
    /// Why there are none that are all of its surface.
    pub(super) fn surface(&self, numbers: &Numbers<'_>) -> Result<Surface, String> {
        match &self.what {
            What::Mesh(faces) => faces.of(numbers).map(|(surface, _)| surface).map_err(|error| error.to_string()),
            What::Arc(curved) => curved.form(numbers).solid().map_err(|error| error.to_string()),
            What::Solid(form) if form.is_angular => {
                let made = form.make(numbers).map_err(|error| error.to_string())?;
                let (corners, faces) = made.drawn.surface();
                Ok((corners.into_iter().map(|corner| corner + made.centre).collect(), faces))
            }
            What::Plane | What::Table(_) => Err("its surface has no end: give a box, a hull or a mesh".into()),
            What::Solid(_) => Err(
                "only a mesh, a box without rounding, or a hull without rounding and with certain points has places \
                     on its surface"
                    .into(),
            ),
        }
    }

    /// Its triangles, likewise.
    ///
    /// # Errors
    /// As [`Standing::surface`].
    pub(super) fn faces(&self, numbers: &Numbers<'_>) -> Result<Vec<[DVec3; 3]>, String> {
        let (corners, faces) = self.surface(numbers)?;
        Ok(faces.into_iter().map(|face| face.map(|corner| corners[corner as usize])).collect())
    }

    /// The solid that it is, unless it is a plane, a table or triangles.
    pub(super) fn form(&self) -> Option<&Form> {
        if let What::Solid(form) = &self.what { Some(form) } else { None }
    }

    /// Whether it goes on without an end.
    pub(super) fn is_endless(&self) -> bool {
        matches!(self.what, What::Plane | What::Table(_))
    }

    /// Whether it is a curved track.
    pub(super) fn is_arc(&self) -> bool {
        matches!(self.what, What::Arc(_))
    }

    /// Whether it is a mesh of triangles from a file.
    pub(super) fn is_mesh(&self) -> bool {
        matches!(&self.what, What::Mesh(faces) if faces.is_file)
    }

    /// Whether it is a level plane, whatever the draw.
    pub(super) fn is_level(&self) -> bool {
        self.is_plane() && self.turn[..2].iter().all(|angle| *angle == Value::Fixed(0.0))
    }

    /// Whether it is a plane.
    pub(super) fn is_plane(&self) -> bool {
        matches!(self.what, What::Plane)
    }

    /// Triangles where they are in a draw, with their corners in m.
    fn placed(&self, faces: &Faces, numbers: &Numbers<'_>) -> Result<Surface, WorldError> {
        let ((at, turn), ((mut corners, faces), _)) = (self.pose(numbers), faces.of(numbers)?);
        corners.iter_mut().for_each(|corner| *corner = at + turn * *corner);
        Ok((corners, faces))
    }

    /// Where it is, in m, and how it is turned where that is said at all.
    fn lies(&self, numbers: &Numbers<'_>) -> (DVec3, Option<DQuat>) {
        let (at, turn) = self.pose(numbers);
        (at, (self.turn != [Value::Fixed(0.0); 3]).then_some(turn))
    }

    fn mesh(&self, numbers: &Numbers<'_>) -> Result<Option<Arc<Mesh>>, WorldError> {
        let What::Mesh(faces) = &self.what else { return Ok(None) };
        if let Some(kept) = &faces.kept {
            return Ok(Some(Arc::clone(kept)));
        }
        let (corners, faces) = self.placed(faces, numbers)?;
        let faces: Vec<_> = faces.into_iter().map(|face| (face, Kind(self.substance as u16))).collect();
        Ok(Some(Arc::new(Mesh::new(corners, &faces, 0.0)?)))
    }

    /// The simulator's part of a draw.
    pub(super) fn make(&self, numbers: &Numbers<'_>) -> Result<StaticShape, WorldError> {
        if let Some(mesh) = self.mesh(numbers)? {
            return Ok(StaticShape::Mesh(mesh));
        }
        let ((at, turn), material) = (self.pose(numbers), Kind(self.substance as u16));
        let form = match &self.what {
            What::Solid(form) => form,
            What::Table(table) => return table.make(self.lies(numbers), material, numbers),
            What::Arc(curved) => return curved.make((at, turn), material, numbers),
            What::Plane | What::Mesh(_) => return Ok(StaticShape::Plane(Plane::new(at, turn * DVec3::Z, material)?)),
        };
        if let Some(edges) = form.sharp_box(numbers).filter(|_| turn == DQuat::IDENTITY) {
            let bounds = Aabb { min: at - 0.5 * edges, max: at + 0.5 * edges };
            return Ok(StaticShape::Block { bounds, material, sections: Vec::new() });
        }
        let made = form.make(numbers)?;
        Ok(StaticShape::Solid(Box::new(StaticSolid {
            at: at + turn * made.centre,
            turn: (turn * made.axes).normalize(),
            shape: made.solid,
            material,
        })))
    }

    /// As it is drawn; a plane so far in m around the middle of what moves.
    pub(super) fn drawn(&self, numbers: &Numbers<'_>, reach: f64) -> Result<animation::Form, WorldError> {
        let (at, turn) = self.pose(numbers);
        Ok(match &self.what {
            What::Plane => {
                animation::Form::Plane { centre: upright(at), normal: upright(turn * DVec3::Z), half: reach }
            }
            What::Table(table) => table.drawn(self.lies(numbers), reach, numbers)?,
            What::Mesh(faces) => {
                let (corners, triangles) = self.placed(faces, numbers)?;
                animation::Form::Mesh { vertices: corners.into_iter().map(upright).collect(), triangles }
            }
            What::Arc(curved) => {
                let (corners, triangles) = curved.form(numbers).solid()?;
                let vertices = corners.into_iter().map(|corner| upright(at + turn * corner)).collect();
                animation::Form::Mesh { vertices, triangles }
            }
            What::Solid(form) => match form.sharp_box(numbers) {
                Some(edges) => animation::Form::Block {
                    centre: upright(at),
                    half: 0.5 * edges,
                    orientation: (UPRIGHT * turn).normalize(),
                },
                None => {
                    let made = form.make(numbers)?;
                    let (vertices, triangles) = made.drawn.surface();
                    let place = |vertex: DVec3| upright(at + turn * (vertex + made.centre));
                    animation::Form::Mesh { vertices: vertices.into_iter().map(place).collect(), triangles }
                }
            },
        })
    }
}
