//! From the axes and units of a stage to those of a GLB: metres, y up.

use super::scene::Scene;
use super::value::word;
use crate::glb::pose;
use crate::{AssetError, Up};
use glam::{DMat4, DQuat, DVec3};

/// Lengths of a unit in m, and masses in kg, that are believed.
const UNITS: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// Units and axes of a stage.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    up: Up,
    /// In m.
    pub(super) length: f64,
    /// In kg.
    pub(super) mass: f64,
}

impl Axes {
    pub(super) fn read(scene: &Scene) -> Result<Self, AssetError> {
        let unit = |key: &str, usual: f64| {
            let Some(value) = scene.metadata(key)? else { return Ok(usual) };
            let said = super::value::numbers(&value).and_then(|all| all.first().copied());
            said.filter(|said| UNITS.contains(said)).ok_or_else(|| {
                let said = said.map_or_else(|| "no number".to_owned(), |said| said.to_string());
                AssetError::Broken(format!("its {key} is {said}: a number from 1e-9 to 1e9 is needed"))
            })
        };
        let up = match scene.metadata("upAxis")?.as_ref().and_then(word).as_deref() {
            None | Some("Y") => Up::Y,
            Some("Z") => Up::Z,
            Some(other) => return Err(AssetError::Broken(format!("its upAxis is {other:?}: Y or Z is needed"))),
        };
        Ok(Self { up, length: unit("metersPerUnit", 0.01)?, mass: unit("kilogramsPerUnit", 1.0)? })
    }

    /// A direction.
    pub(super) fn direction(&self, along: DVec3) -> DVec3 {
        match self.up {
            Up::Y => along,
            Up::Z => DVec3::new(along.x, along.z, -along.y),
        }
    }

    /// A place, in m.
    pub(super) fn place(&self, at: DVec3) -> DVec3 {
        self.length * self.direction(at)
    }

    /// A rotation.
    pub(super) fn turn(&self, turn: DQuat) -> DQuat {
        let axis = self.direction(DVec3::new(turn.x, turn.y, turn.z));
        DQuat::from_xyzw(axis.x, axis.y, axis.z, turn.w)
    }

    /// Sizes along the axes, none of which has a direction.
    pub(super) fn sizes(&self, sizes: DVec3) -> DVec3 {
        match self.up {
            Up::Y => sizes,
            Up::Z => DVec3::new(sizes.x, sizes.z, sizes.y),
        }
    }

    /// The direction that points up.
    pub(super) fn up(&self) -> DVec3 {
        match self.up {
            Up::Y => DVec3::Y,
            Up::Z => DVec3::Z,
        }
    }

    /// A matrix from the axes of a prim to those of the stage, as one between axes of a GLB.
    pub(super) fn matrix(&self, world: &DMat4) -> DMat4 {
        let column = |axis: DVec3| self.direction(world.transform_vector3(self.back(axis))).extend(0.0);
        let at = self.place(world.w_axis.truncate()).extend(1.0);
        DMat4::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z), at)
    }

    /// A direction of the stage that becomes this one.
    fn back(&self, along: DVec3) -> DVec3 {
        match self.up {
            Up::Y => along,
            Up::Z => DVec3::new(along.x, -along.z, along.y),
        }
    }

    /// The axis that a prim names by a letter, as a direction of a GLB.
    pub(super) fn named(&self, letter: &str) -> Option<DVec3> {
        let axis = ["X", "Y", "Z"].iter().position(|known| *known == letter)?;
        Some(self.direction(DVec3::AXES[axis]))
    }
}

/// Where something is and how it is turned, and what is then left of its matrix: scale and shear.
pub(super) fn rigid(matrix: &DMat4) -> (DVec3, DQuat, DMat4) {
    let (at, turn) = pose(matrix);
    (at, turn, DMat4::from_rotation_translation(turn, at).inverse() * *matrix)
}
