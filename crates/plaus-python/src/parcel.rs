//! Outcomes on their way to another process, which asks a requirement about them: numbers and draw, from which all else
//! follows.

use crate::errors::RunError;
use crate::outcome::{KIND, Numbers, Outcome};
use crate::scenario::Scenario;
use plaus_mcmc::Target;
use plaus_run::codec;
use plaus_scenes::{Scene, Visitor};
use pyo3::prelude::*;
use std::sync::Arc;

/// Makes outcomes of a scenario's scene from what [`Outcome::pack`] gave.
trait Unpack: Send + Sync {
    fn unpack(&self, parcel: &[u8]) -> PyResult<Outcome>;
}

struct OfScene<S> {
    scene: Arc<S>,
    names: Arc<[String]>,
}

impl<S: Scene> Unpack for OfScene<S> {
    fn unpack(&self, parcel: &[u8]) -> PyResult<Outcome> {
        let opened = codec::decode::<(Numbers, <S as Target>::Draw)>(KIND, parcel);
        let (numbers, draw) = opened.map_err(|error| RunError::new_err(error.to_string()))?;
        Ok(Outcome::new(&self.scene, &self.names, numbers, draw))
    }
}

/// Opens parcels of one scenario.
#[pyclass(frozen, module = "plaus._plaus")]
pub(crate) struct Parcels(Box<dyn Unpack>);

#[pymethods]
impl Parcels {
    #[new]
    fn new(scenario: &Bound<'_, Scenario>) -> PyResult<Self> {
        struct Build;
        impl Visitor for Build {
            type Output = Box<dyn Unpack>;
            fn visit<S: Scene>(self, scene: S) -> Self::Output {
                let names = scene.scalars().into_iter().map(|scalar| scalar.name).collect();
                Box::new(OfScene { scene: Arc::new(scene), names })
            }
        }
        let made = scenario.get().recipe.scenario.visit(Build);
        made.map(Self).map_err(|error| RunError::new_err(error.to_string()))
    }

    /// The outcome in a parcel.
    fn open(&self, parcel: &[u8]) -> PyResult<Outcome> {
        self.0.unpack(parcel)
    }
}
