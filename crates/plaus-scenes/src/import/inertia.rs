//! Where the mass of bodies is: what of it follows from their shapes is not said.

use super::ImportError;
use super::numbers::number;
use super::things::{Inertia, Thing, Things};
use super::write::angles;
use crate::custom::{self, Placed};
use crate::files::Files;
use crate::registry::World;
use crate::scenario::Scenario;
use glam::{DMat3, DVec3};
use plaus_sim::shape::MassProperties;

/// How far, in radii of gyration and their squares, what a file says may be from what follows from shapes and count as
/// the same: numbers in single precision, and millionths of a millimetre.
const SAME: f64 = 1e-5;

/// By how much one moment may be larger than the sum of the two others: rounding in single precision.
const ROUNDING: f64 = 1e-6;

impl Things<'_> {
    /// Forgets what files say of where the mass of bodies is if it follows from their shapes, or if no solid has it,
    /// which is told.
    pub(super) fn check_inertias(&mut self, path: &str, files: &dyn Files) -> Result<(), ImportError> {
        let bodies: Vec<usize> = self.bodies().collect();
        for &index in &bodies {
            let thing = &mut self.all[index];
            let why = thing.inertia.moments.and_then(|(moments, _)| wrong(moments));
            if let Some(why) = why {
                thing.inertia.moments = None;
                self.left_out
                    .push(format!("{}: its moments of inertia: {why}; those of its shapes are used", thing.name));
            }
        }
        if bodies.iter().all(|&index| self.all[index].inertia == Inertia::default()) {
            return Ok(());
        }
        let mut plain = self.clone();
        plain.all.iter_mut().for_each(|thing| thing.inertia = Inertia::default());
        let placed = |scenario: &Scenario| match &scenario.world {
            World::Custom(config) => custom::placed(config),
            _ => Ok(Vec::new()),
        };
        let read = Scenario::read_and(path, &plain.text(path), &[], files, placed).map_err(ImportError::Scenario)?;
        for (index, natural) in bodies.into_iter().zip(read.1) {
            let thing = &mut self.all[index];
            // As a scenario has them.
            if thing.inertia.is_of(&natural) {
                thing.inertia = Inertia::default();
            }
        }
        Ok(())
    }
}

/// Why these are the moments of no solid.
fn wrong(moments: DVec3) -> Option<String> {
    let said = moments.to_array().map(exact).join(" ");
    let most = moments.max_element();
    match () {
        () if !moments.is_finite() => Some("one is infinite".into()),
        () if moments.min_element() <= 0.0 => Some(format!("{said} kg m² are not all more than 0")),
        () if most > (moments.element_sum() - most) * (1.0 + ROUNDING) => {
            Some(format!("of {said} kg m² one is more than the sum of the two others"))
        }
        () => None,
    }
}

/// A number of any size as a scenario has it, with nine digits.
fn exact(value: f64) -> String {
    format!("{value:.8e}").parse::<f64>().unwrap_or(value).to_string()
}

impl Inertia {
    /// Whether this is what a body has anyway.
    fn is_of(&self, natural: &Placed) -> bool {
        let square = natural.tensor.to_cols_array().iter().map(|x| x.abs()).fold(0.0, f64::max) / natural.mass;
        let off = self.centre.map_or(0.0, |centre| centre.distance(natural.centre)) / square.sqrt();
        let tensor = |(moments, axes)| custom::tensor(moments, axes);
        let far: DMat3 = self.moments.map_or(DMat3::ZERO, |own| tensor(own) - natural.tensor);
        let far = far.to_cols_array().iter().map(|x| x.abs()).fold(0.0, f64::max) / (natural.mass * square);
        off <= SAME && far <= SAME
    }
}

impl Thing {
    /// The key of where its mass is.
    pub(super) fn mass_line(&self) -> Option<String> {
        let Inertia { centre, moments } = self.inertia;
        let centre = centre.map(|centre| {
            let said = (centre * 1e3).to_array().map(number).join(", ");
            format!("centre_mm = [{said}]")
        });
        let moments = moments.map(|(moments, axes)| {
            // Rounding makes none of them too large.
            let most = moments.max_element();
            let moments = moments.min(DVec3::splat(most.min((moments.element_sum() - most) * (1.0 - 1e-8))));
            let said = moments.to_array().map(exact).join(", ");
            let axes = angles(axes).map(number).join(", ");
            format!("moments_kg_m2 = [{said}], axes_deg = [{axes}]")
        });
        let all: Vec<String> = centre.into_iter().chain(moments).collect();
        (!all.is_empty()).then(|| format!("inertia = {{ {} }}", all.join(", ")))
    }
}

/// The centre and the tensor of what several have together, each with a mass, a centre and a tensor about it.
pub(super) fn together(all: &[(f64, DVec3, DMat3)]) -> Inertia {
    let mass: f64 = all.iter().map(|one| one.0).sum();
    let centre = all.iter().map(|(mass, at, _)| *mass * *at).sum::<DVec3>() / mass;
    let about = |(mass, at, tensor): &(f64, DVec3, DMat3)| {
        let arm = *at - centre;
        let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
        *tensor + (DMat3::IDENTITY * arm.length_squared() - outer) * *mass
    };
    let tensor = all.iter().map(about).fold(DMat3::ZERO, |sum, one| sum + one);
    let has_moments = all.iter().all(|(_, _, tensor)| *tensor != DMat3::ZERO);
    Inertia { centre: Some(centre), moments: has_moments.then(|| MassProperties::principal(tensor)) }
}
