//! Curved tracks.

use super::forms::ArcOf;
use super::solids::MM;
use super::values::{Collector, Numbers, Owner, Value};
use crate::scene::ConfigError;
use glam::{DQuat, DVec3};
use plaus_sim::WorldError;
use plaus_sim::material::Material;
use plaus_sim::rigid::StaticShape;
use plaus_sim::scenery::{ArcForm, ArcTrack};

/// Thickness of a track that says none, over its radius.
const THICKNESS: f64 = 0.05;

/// Longest track in degrees.
const MOST_TURN: f64 = 360.0 * ArcForm::MOST_TURNS;

/// A curved track of a scenario.
#[derive(Debug, Clone)]
pub(super) struct Curved {
    radius: Value,
    angles: [Value; 2],
    width: Value,
    pitch: Value,
    thickness: Option<Value>,
    walls: Value,
}

impl Curved {
    pub(super) fn new(collector: &mut Collector, owner: &Owner<'_>, said: &ArcOf) -> Result<Self, ConfigError> {
        let key = |name: &str| format!("shape.arc.{name}");
        let thickness = match &said.thickness_mm {
            Some(thickness) => Some(collector.number(owner, &key("thickness_mm"), "thickness", thickness)?),
            None => None,
        };
        let curved = Self {
            radius: collector.number(owner, &key("radius_mm"), "radius", &said.radius_mm)?,
            angles: [
                collector.number(owner, &key("from_deg"), "from", &said.from_deg)?,
                collector.number(owner, &key("to_deg"), "to", &said.to_deg)?,
            ],
            width: collector.number(owner, &key("width_mm"), "width", &said.width_mm)?,
            pitch: collector.number(owner, &key("pitch_mm"), "pitch", &said.pitch_mm)?,
            thickness,
            walls: collector.number(owner, &key("walls_mm"), "walls", &said.walls_mm)?,
        };
        match curved.fault(collector) {
            Some((name, message)) => Err(owner.wrong(&key(name), message)),
            None => Ok(curved),
        }
    }

    /// The key of a number that in some draw cannot be beside the others, and why.
    fn fault(&self, collector: &Collector) -> Option<(&'static str, String)> {
        let ends = |value: &Value| collector.ends(*value);
        let (radius, width) = (ends(&self.radius), ends(&self.width));
        if let Some(thickness) = &self.thickness
            && ends(thickness).0 < ArcForm::LEAST_THICKNESS * radius.1
        {
            let (thin, least) = (ends(thickness).0, ArcForm::LEAST_THICKNESS * radius.1);
            return Some(("thickness_mm", format!("{thin} is too thin for this radius: at least {least}")));
        }
        let high = ends(&self.walls).1;
        if collector.least_gap(self.walls, &[self.radius]) <= 0.0 {
            return Some(("walls_mm", format!("{high} reaches the axis: less than the radius, {}", radius.0)));
        }
        let ([first, last], [from, to]) = (self.angles.each_ref().map(ends), self.angles);
        if collector.least_gap(from, &[to]) <= 0.0 {
            let message = format!("{} is not above from_deg, {}: the track goes on from there", last.0, first.1);
            return Some(("to_deg", message));
        }
        let (turn, pitch) = (-collector.least_gap(to, &[from]), ends(&self.pitch));
        if turn > MOST_TURN {
            return Some(("to_deg", format!("a track of {turn} degrees: at most {MOST_TURN}, which is 100 turns")));
        }
        // Of two turns beside each other, each has a wall of its own.
        let wall = self.thickness.as_ref().map_or(THICKNESS * radius.1, |thickness| ends(thickness).1);
        let needed = width.1 + if high > 0.0 { wall } else { 0.0 };
        let least = if pitch.0 <= 0.0 && pitch.1 >= 0.0 { 0.0 } else { pitch.0.abs().min(pitch.1.abs()) };
        // Angles in rad are rounded.
        if turn > 360.0 * (1.0 + f64::EPSILON) && least < needed {
            let message = format!(
                "a track of {turn} degrees meets itself after a turn: at least its width and a wall, {}, or end it at {} degrees",
                needed,
                first.0 + 360.0
            );
            return Some(("pitch_mm", message));
        }
        None
    }

    fn numbers(&self) -> impl Iterator<Item = &Value> {
        [&self.radius, &self.width, &self.pitch, &self.walls].into_iter().chain(&self.angles).chain(&self.thickness)
    }

    /// Whether no draw changes it.
    pub(super) fn is_fixed(&self) -> bool {
        self.numbers().all(|value| value.is_fixed())
    }

    /// Its form in a draw.
    pub(super) fn form(&self, numbers: &Numbers<'_>) -> ArcForm {
        let metres = |value: &Value| value.of(numbers) * MM;
        let radius = metres(&self.radius);
        ArcForm {
            radius,
            angles: [0, 1].map(|k: usize| self.angles[k].of(numbers).to_radians()),
            width: metres(&self.width),
            pitch: metres(&self.pitch),
            thickness: self.thickness.as_ref().map_or(THICKNESS * radius, metres),
            walls: metres(&self.walls),
        }
    }

    /// The simulator's part of a draw.
    pub(super) fn make(
        &self,
        (at, turn): (DVec3, DQuat),
        material: Material,
        numbers: &Numbers<'_>,
    ) -> Result<StaticShape, WorldError> {
        Ok(StaticShape::Arc(ArcTrack::new(self.form(numbers), at, turn, material)?.into()))
    }
}
