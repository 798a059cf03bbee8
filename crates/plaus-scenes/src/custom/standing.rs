//! What stands still: planes, tables, solids, and meshes of files.

use super::config::Fixed;
use super::drawn::mesh;
use super::forms::Still;
use super::from_file::Loaded;
use super::names::{Member, colour};
use super::solids::{Form, MM, opened};
use super::substances::{Substance, substance};
use super::tables::Uneven;
use super::values::{Collector, Numbers, Value, Values, vector};
use crate::animation::{self, Look, UPRIGHT, upright};
use crate::scene::ConfigError;
use crate::turns::by_angles;
use glam::{DQuat, DVec3};
use plaus_sim::WorldError;
use plaus_sim::material::Material as Kind;
use plaus_sim::rigid::{Part, SolidPart};
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
    substance: usize,
    at: Values,
    turn: Values,
}

/// What it is.
#[derive(Debug, Clone)]
enum What {
    Plane,
    Table(Uneven),
    Solid(Form),
    /// The triangles of a file, how many millimetres its unit is, and the mesh where no draw changes it.
    Mesh(Arc<Loaded>, Value, Option<Arc<Mesh>>),
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
        let what = match (&fixed.shape, fixed.shape.solid()) {
            (_, Some(solid)) => What::Solid(Form::new(collector, &owner, &solid)?),
            (Still::Mesh(file), None) => {
                let (loaded, unit) = opened(collector, &owner, "shape.mesh", "", file)?;
                What::Mesh(loaded, unit, None)
            }
            (Still::Table(table), None) => What::Table(Uneven::new(collector, &owner, table)?),
            (_, None) => What::Plane,
        };
        let at = collector.three(&owner, "at_mm", ["x", "y", "z"], &fixed.at_mm)?;
        let turn = collector.three(&owner, "turn_deg", ["turn_x", "turn_y", "turn_z"], &fixed.turn_deg)?;
        if matches!(what, What::Table(_)) && turn != [Value::Fixed(0.0); 3] {
            return Err(owner.wrong("turn_deg", "a table with bumps is level and cannot be turned: leave this out"));
        }
        Ok(Self { name: owner.name.to_owned(), key: member.key.clone(), look, what, substance, at, turn })
    }

    /// Whether no draw changes it.
    pub(super) fn is_fixed(&self) -> bool {
        let is_fixed = match &self.what {
            What::Plane => true,
            What::Table(_) => false,
            What::Solid(form) => form.is_fixed(),
            What::Mesh(_, unit, _) => unit.is_fixed(),
        };
        is_fixed && self.at.iter().chain(&self.turn).all(|value| value.is_fixed())
    }

    /// Its bumps, and where it is.
    pub(super) fn table(&self) -> Option<(&Uneven, &Values)> {
        if let What::Table(table) = &self.what { Some((table, &self.at)) } else { None }
    }

    /// Tries its shape, and keeps the mesh of one that no draw changes.
    pub(super) fn check(&mut self, numbers: &Numbers<'_>) -> Result<(), WorldError> {
        if let What::Solid(form) = &self.what {
            return form.make(numbers).map(drop);
        }
        let keeps = self.is_fixed();
        if let Some(made) = self.mesh(numbers)?
            && let What::Mesh(_, _, kept) = &mut self.what
        {
            *kept = Some(made).filter(|_| keeps);
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

    /// What is drawn of it but not simulated, in words.
    pub(super) fn note(&self) -> Option<String> {
        if let What::Solid(form) = &self.what { form.note() } else { None }
    }

    /// Where it is, in m, and how it is turned.
    fn pose(&self, numbers: &Numbers<'_>) -> (DVec3, DQuat) {
        (vector(&self.at, numbers) * MM, by_angles(self.turn.map(|angle| angle.of(numbers))))
    }

    /// The corners of a file's triangles where they are in a draw, in m.
    fn corners(&self, loaded: &Loaded, unit: Value, numbers: &Numbers<'_>) -> Vec<DVec3> {
        let ((at, turn), unit) = (self.pose(numbers), unit.of(numbers) * MM);
        loaded.triangles.corners.iter().map(|&corner| at + turn * (corner * unit)).collect()
    }

    fn mesh(&self, numbers: &Numbers<'_>) -> Result<Option<Arc<Mesh>>, WorldError> {
        let What::Mesh(loaded, unit, kept) = &self.what else { return Ok(None) };
        if let Some(kept) = kept {
            return Ok(Some(Arc::clone(kept)));
        }
        let material = Kind(self.substance as u16);
        let faces: Vec<_> = loaded.triangles.faces.iter().map(|&face| (face, material)).collect();
        Ok(Some(Arc::new(Mesh::new(self.corners(loaded, *unit, numbers), &faces, 0.0)?)))
    }

    /// The simulator's part of a draw.
    pub(super) fn make(&self, numbers: &Numbers<'_>) -> Result<Part, WorldError> {
        if let Some(mesh) = self.mesh(numbers)? {
            return Ok(Part::Mesh(mesh));
        }
        let ((at, turn), material) = (self.pose(numbers), Kind(self.substance as u16));
        let form = match &self.what {
            What::Solid(form) => form,
            What::Table(table) => return table.make(at, material, numbers),
            What::Plane | What::Mesh(..) => return Ok(Part::Plane(Plane::new(at, turn * DVec3::Z, material)?)),
        };
        if let Some(edges) = form.sharp_box(numbers).filter(|_| turn == DQuat::IDENTITY) {
            let bounds = Aabb { min: at - 0.5 * edges, max: at + 0.5 * edges };
            return Ok(Part::Block { bounds, material, sections: Vec::new() });
        }
        let made = form.make(numbers)?;
        Ok(Part::Solid(Box::new(SolidPart {
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
            What::Table(table) => table.drawn(at, reach, numbers)?,
            What::Mesh(loaded, unit, _) => {
                let vertices = self.corners(loaded, *unit, numbers).into_iter().map(upright).collect();
                animation::Form::Mesh { vertices, triangles: loaded.triangles.faces.clone() }
            }
            What::Solid(form) => match form.sharp_box(numbers) {
                Some(edges) => animation::Form::Block {
                    centre: upright(at),
                    half: 0.5 * edges,
                    orientation: (UPRIGHT * turn).normalize(),
                },
                None => {
                    let made = form.make(numbers)?;
                    let (vertices, triangles) = mesh(&made.drawn);
                    let place = |vertex: DVec3| upright(at + turn * (vertex + made.centre));
                    animation::Form::Mesh { vertices: vertices.into_iter().map(place).collect(), triangles }
                }
            },
        })
    }
}
