//! Where the mass of a body is, if that does not follow from its shape: a loaded die, a hollow ball.

use super::amount::{Amount, Angle, Inert, Place};
use super::shapes::{Form, Made, Round};
use super::values::{Collector, MM, Numbers, Owner, Value, Values, vector};
use crate::animation;
use crate::scene::ConfigError;
use crate::turns::by_angles;
use glam::{DMat3, DQuat, DVec3};
use plaus_sim::WorldError;
use plaus_sim::shape::{Compound, Shape as Solid};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Moments that differ by less, over the largest, are equal: rounding.
const ROUNDING: f64 = 1e-9;

/// Where the mass of a body is. What the body weighs still follows from its shape and density.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Inertia {
    /// Its centre of gravity, along its own axes, from the point that `at_mm` places. Unset: that of its shape.
    #[serde(default)]
    pub centre_mm: Option<[Amount<Place>; 3]>,
    /// Its principal moments of inertia about the centre of gravity, none more than the sum of the two others. Unset:
    /// those of its shape about the shape's own centre of gravity.
    #[serde(default)]
    pub moments_kg_m2: Option<[Amount<Inert>; 3]>,
    /// How the axes of these moments are turned against its own: about its x axis, then about y, then about z.
    #[serde(default)]
    pub axes_deg: [Amount<Angle>; 3],
}

/// The same with its numbers as values.
#[derive(Debug, Clone)]
pub(super) struct Weight {
    centre: Option<Values>,
    moments: Option<(Values, Values)>,
    density: Value,
}

/// Where the mass of a body is: its centre of gravity in m, from its origin and along its own axes, and its tensor of
/// inertia about that in kg m², along the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placed {
    pub(crate) centre: DVec3,
    /// In kg.
    pub(crate) mass: f64,
    pub(crate) tensor: DMat3,
}

impl Weight {
    /// At the key `inertia` of a body with this shape and density.
    pub(super) fn new(
        collector: &mut Collector,
        owner: &Owner<'_>,
        said: &Inertia,
        (form, has_pips, density): (&Form, bool, Value),
    ) -> Result<Self, ConfigError> {
        let Inertia { centre_mm, moments_kg_m2, axes_deg } = said;
        if form.round == Round::Turned {
            return Err(owner.wrong("inertia", "a solid of revolution has that of its shape"));
        }
        if has_pips && centre_mm.is_some() {
            let message = "a box with `pips` has its centre of gravity in its middle: mark its faces by `faces`";
            return Err(owner.wrong("inertia.centre_mm", message));
        }
        if moments_kg_m2.is_none() && *axes_deg != [0.0, 0.0, 0.0].map(Amount::from) {
            return Err(owner.wrong("inertia.axes_deg", "these are the axes of `moments_kg_m2`, which are missing"));
        }
        let mut places = |key: &str, said| collector.three(owner, key, ["centre_x", "centre_y", "centre_z"], said);
        let centre = centre_mm.as_ref().map(|said| places("inertia.centre_mm", said)).transpose()?;
        let mut moments = None;
        if let Some(said) = moments_kg_m2 {
            let key = "inertia.moments_kg_m2";
            let three = collector.three(owner, key, ["moment_x", "moment_y", "moment_z"], said)?;
            for (k, one) in three.iter().enumerate() {
                let (others, most) = ([three[(k + 1) % 3], three[(k + 2) % 3]], collector.ends(*one).1);
                if collector.least_gap(*one, &others) < -ROUNDING * most {
                    let message = format!("up to {most}, and must not be more than the sum of the two others");
                    return Err(owner.wrong(&format!("{key}[{k}]"), message));
                }
            }
            let names = ["axes_x", "axes_y", "axes_z"];
            moments = Some((three, collector.three(owner, "inertia.axes_deg", names, axes_deg)?));
        }
        Ok(Self { centre, moments, density })
    }

    pub(super) fn is_fixed(&self) -> bool {
        let moments = self.moments.iter().flat_map(|(moments, axes)| moments.iter().chain(axes));
        let all = self.centre.iter().flatten().chain(moments.chain([&self.density]));
        all.into_iter().all(|value| value.is_fixed())
    }

    /// A body with its mass there.
    pub(super) fn of(&self, made: Made, numbers: &Numbers<'_>) -> Result<Made, WorldError> {
        let centre = self.centre.as_ref().map_or(made.centre, |centre| vector(centre, numbers) * MM);
        let (moments, axes) = match &self.moments {
            Some((moments, axes)) => {
                (vector(moments, numbers) / self.density.of(numbers), by_angles(axes.map(|angle| angle.of(numbers))))
            }
            None => (made.mass_properties(1.0).inertia, made.axes),
        };
        let is_even = moments.max_element() - moments.min_element() <= ROUNDING * moments.max_element();
        let is_ball = matches!(made.solid, Solid::Ball(_));
        if centre == made.centre && (if is_ball { is_even } else { axes == made.axes }) {
            return Ok(Made { moments: Some(moments), ..made });
        }
        let solid = Compound::new(&made.members())?.weighted(centre, axes, moments)?.into();
        let drawn = if centre == made.centre {
            made.drawn
        } else {
            let (vertices, triangles) = made.drawn.surface();
            let vertices = vertices.into_iter().map(|vertex| vertex + made.centre - centre).collect();
            animation::Shape::Solid { vertices, triangles }.into()
        };
        Ok(Made { solid, centre, axes, drawn, moments: Some(moments) })
    }
}

/// A tensor of inertia with these principal moments about axes that are turned like this.
pub(crate) fn tensor(moments: DVec3, axes: DQuat) -> DMat3 {
    let axes = DMat3::from_quat(axes);
    axes * DMat3::from_diagonal(moments) * axes.transpose()
}
