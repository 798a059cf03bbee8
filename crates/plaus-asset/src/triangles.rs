//! Triangles over shared corners.

use super::AssetError;
use glam::{DQuat, DVec3};
use std::collections::BTreeMap;

/// Triangles over shared corners: no two corners have the same place.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Triangles {
    /// Places, in the file's unit.
    pub corners: Vec<DVec3>,
    /// Indices of three corners each, anticlockwise as seen from outside.
    pub faces: Vec<[u32; 3]>,
}

/// Which axis of a file points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Up {
    /// Its y axis: −z is away.
    Y,
    /// Its z axis.
    Z,
}

impl Triangles {
    /// The volume that they enclose, where corners run anticlockwise seen from outside; if they run the other way, it
    /// is below 0.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let corner = |index: u32| self.corners.get(index as usize).copied().unwrap_or_default();
        let cone = |face: &[u32; 3]| corner(face[0]).dot(corner(face[1]).cross(corner(face[2]))) / 6.0;
        self.faces.iter().map(cone).sum()
    }

    /// Triangles over corners, several of which may have the same place, for example where surfaces of different
    /// materials meet; such corners are merged.
    ///
    /// # Errors
    /// [`AssetError::NotFinite`] for a corner of the object `name` that is not finite, [`AssetError::Broken`] for an
    /// index beyond the corners.
    pub fn new(name: &str, corners: &[DVec3], faces: &[[u32; 3]]) -> Result<Self, AssetError> {
        if let Some(corner) = corners.iter().position(|corner| !corner.is_finite()) {
            return Err(AssetError::NotFinite { object: name.to_owned(), corner });
        }
        let mut joined = Joined::default();
        for (index, face) in faces.iter().enumerate() {
            let mut renamed = [0; 3];
            for (place, corner) in renamed.iter_mut().zip(face) {
                let found = corners.get(*corner as usize).ok_or_else(|| {
                    AssetError::Broken(format!(
                        "triangle {index} of {name:?} names corner {corner}, which does not exist"
                    ))
                })?;
                *place = joined.corner(*found);
            }
            joined.triangles.faces.push(renamed);
        }
        Ok(joined.triangles)
    }

    /// Several combined into one.
    pub(super) fn joined(all: impl Iterator<Item = Self>) -> Self {
        let mut joined = Joined::default();
        for one in all {
            let names: Vec<u32> = one.corners.iter().map(|&corner| joined.corner(corner)).collect();
            joined.triangles.faces.extend(one.faces.iter().map(|face| face.map(|corner| names[corner as usize])));
        }
        joined.triangles
    }

    /// The same triangles with moved corners.
    #[must_use]
    pub fn moved(&self, to: impl Fn(DVec3) -> DVec3) -> Self {
        Self { corners: self.corners.iter().map(|&corner| to(corner)).collect(), faces: self.faces.clone() }
    }

    /// The same along axes in which z points up.
    #[must_use]
    pub fn upright(&self, up: Up) -> Self {
        self.moved(|corner| upright(corner, up))
    }

    /// The least and the greatest coordinates of the corners; infinite if there are none.
    #[must_use]
    pub fn ends(&self) -> [DVec3; 2] {
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        self.corners.iter().fold(none, |[low, high], &corner| [low.min(corner), high.max(corner)])
    }
}

/// A place along axes in which z points up.
#[must_use]
pub fn upright(place: DVec3, up: Up) -> DVec3 {
    match up {
        Up::Y => DVec3::new(place.x, -place.z, place.y),
        Up::Z => place,
    }
}

/// A rotation, expressed along axes in which z points up.
#[must_use]
pub fn upright_turn(turn: DQuat, up: Up) -> DQuat {
    let axis = upright(DVec3::new(turn.x, turn.y, turn.z), up);
    DQuat::from_xyzw(axis.x, axis.y, axis.z, turn.w)
}

/// Triangles whose corners are distinguished by their places.
#[derive(Debug, Default)]
struct Joined {
    triangles: Triangles,
    known: BTreeMap<[u64; 3], u32>,
}

impl Joined {
    fn corner(&mut self, place: DVec3) -> u32 {
        // −0 is the same place as 0.
        let bits = (place + DVec3::ZERO).to_array().map(f64::to_bits);
        let next = self.triangles.corners.len() as u32;
        let index = *self.known.entry(bits).or_insert(next);
        if index == next {
            self.triangles.corners.push(place);
        }
        index
    }
}
