//! Outcomes on their way to another process, which evaluates a requirement for them: scalars and draw, from which
//! everything else follows.

use crate::errors::RunError;
use crate::outcome::{KIND, Numbers, Outcome};
use crate::scenario::Scenario;
use plaus_run::{Draw, codec};
use plaus_scenes::{Scene, Stage};
use pyo3::prelude::*;
use std::sync::Arc;

/// Opens parcels of one scenario: makes outcomes from what [`Outcome::pack`] gave.
#[pyclass(frozen, module = "plaus._plaus")]
pub(crate) struct Parcels {
    scene: Arc<Stage>,
    names: Arc<[String]>,
}

#[pymethods]
impl Parcels {
    #[new]
    fn new(scenario: &Bound<'_, Scenario>) -> PyResult<Self> {
        let made = scenario.get().recipe.scenario.stage();
        let scene = made.map_err(|error| RunError::new_err(error.to_string()))?;
        let names = scene.scalars().into_iter().map(|scalar| scalar.name).collect();
        Ok(Self { scene: Arc::new(scene), names })
    }

    /// The outcome in a parcel.
    fn open(&self, parcel: &[u8]) -> PyResult<Outcome> {
        let (numbers, draw) =
            codec::decode::<(Numbers, Draw)>(KIND, parcel).map_err(|error| RunError::new_err(error.to_string()))?;
        Ok(Outcome::new(&self.scene, &self.names, numbers, draw))
    }
}
