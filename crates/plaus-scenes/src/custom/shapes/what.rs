//! What stands still.

use super::arc::Curved;
use super::form::Shared;
use super::table::Uneven;
use super::{ConfigError, Form, MM, Numbers, Owner, Value, WorldError, vector};
use crate::custom::bumpy::{Bumpy, Surface, SurfaceBumps, block};
use crate::custom::values::Collector;
use plaus_sim::scenery::Mesh;
use std::sync::Arc;

/// Makes a surface of a draw's numbers, with triangles no larger than asked for.
type Plain = dyn Fn(f64, &Numbers<'_>) -> Result<Surface, WorldError> + Send + Sync;

/// What a piece of scenery is: one kind for each way to simulate it.
#[derive(Debug, Clone)]
pub(in crate::custom) enum What {
    Plane,
    Table(Uneven),
    Solid(Form),
    Arc(Curved),
    Mesh(Faces),
}

impl From<Form> for What {
    fn from(form: Form) -> Self {
        Self::Solid(form)
    }
}

/// Triangles, with random bumps where there are any, and the mesh where no draw changes it.
#[derive(Debug, Clone)]
pub(in crate::custom) struct Faces {
    pub(super) plain: Shared<Plain>,
    /// Whether no draw changes them, but for bumps.
    pub(super) is_plain_fixed: bool,
    /// Whether they are from a file.
    pub(in crate::custom) is_file: bool,
    pub(in crate::custom) bumps: Option<Bumpy>,
    pub(in crate::custom) kept: Option<Arc<Mesh>>,
}

impl Faces {
    /// Without bumps. `plain` gives corners in m and triangles, of which none needs a longer edge than so many m.
    pub(super) fn new(
        is_fixed: bool,
        plain: impl Fn(f64, &Numbers<'_>) -> Result<Surface, WorldError> + Send + Sync + 'static,
    ) -> Self {
        Self { plain: Shared(Arc::new(plain)), is_plain_fixed: is_fixed, is_file: false, bumps: None, kept: None }
    }

    pub(in crate::custom) fn is_fixed(&self) -> bool {
        self.bumps.is_none() && self.is_plain_fixed
    }

    /// Keeps what no draw changes of a surface with bumps.
    pub(in crate::custom) fn keep(&mut self, numbers: &Numbers<'_>) -> Result<(), WorldError> {
        let Some(bumps) = self.bumps.as_mut().filter(|_| self.is_plain_fixed) else { return Ok(()) };
        bumps.keep(|longest| (self.plain.0)(longest, numbers), numbers)
    }

    /// Corners in m, and triangles; the second is whether bumps turn one over.
    pub(in crate::custom) fn of(&self, numbers: &Numbers<'_>) -> Result<(Surface, bool), WorldError> {
        match &self.bumps {
            Some(bumps) => bumps.surface(|longest| (self.plain.0)(longest, numbers), numbers),
            None => Ok(((self.plain.0)(f64::INFINITY, numbers)?, false)),
        }
    }
}

impl What {
    /// The same with random bumps, where it can have any.
    pub(in crate::custom) fn with_bumps(
        self,
        collector: &mut Collector,
        owner: &Owner<'_>,
        said: &SurfaceBumps,
    ) -> Result<Self, ConfigError> {
        let faces = match self {
            Self::Mesh(faces) => faces,
            Self::Solid(Form { cuboid: Some((size, Value::Fixed(0.0))), is_fixed, .. }) => {
                Faces::new(is_fixed, move |longest, numbers| Ok(block(vector(&size, numbers) * MM, longest)))
            }
            Self::Plane | Self::Table(_) => {
                let message = "a mesh, a box and ground by its heights have bumps; a plane with bumps, at any angle, is \
                               `shape = { table = { bumps_mm = 1, spacing_mm = 20 } }`";
                return Err(owner.wrong("bumps", message));
            }
            Self::Solid(_) | Self::Arc(_) => {
                let message = "only a mesh, a box without rounding, and ground by its heights have bumps";
                return Err(owner.wrong("bumps", message));
            }
        };
        Ok(Self::Mesh(Faces { bumps: Some(Bumpy::new(collector, owner, said)?), ..faces }))
    }
}
