//! Curved tracks.

use super::{
    Amount, Angle, Collector, ConfigError, Deserialize, JsonSchema, Length, Numbers, Place, Reader, Rounding, Said,
    Serialize, Value, What, WorldError,
};
use glam::{DQuat, DVec3};
use plaus_sim::material::Material;
use plaus_sim::rigid::StaticShape;
use plaus_sim::scenery::{ArcForm, ArcTrack};

/// A curved track: the inside of an arc of a cylinder, exactly round. Its axis is the y axis through `at_mm`; angles
/// are counted about it from x towards z, so that the track is lowest at −90, and what comes along x goes up from
/// there. Its back, sides and ends are solid too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArcOf {
    /// Radius of the cylinder.
    pub radius_mm: Amount<Length>,
    /// Angle at which the track begins.
    pub from_deg: Amount<Angle>,
    /// Angle at which it ends: a larger one.
    pub to_deg: Amount<Angle>,
    /// Its extent along y. Where it begins, its middle is at the y of `at_mm`.
    pub width_mm: Amount<Length>,
    /// How far it moves along y in a turn, so that a loop ends beside its beginning. A track of more than one turn
    /// needs at least its width, and a wall's thickness where it has walls.
    #[serde(default)]
    pub pitch_mm: Amount<Place>,
    /// Thickness of what is solid behind it, and of its walls. Unset: a twentieth of the radius.
    #[serde(default)]
    pub thickness_mm: Option<Amount<Length>>,
    /// Height of walls along its sides, less than the radius; 0 for none. They lead what rolls along a track with a
    /// pitch.
    #[serde(default)]
    pub walls_mm: Amount<Rounding>,
}

/// Thickness of a track that says none, over its radius.
const THICKNESS: f64 = 0.05;

/// Longest track in degrees.
const MOST_TURN: f64 = 360.0 * ArcForm::MOST_TURNS;

/// A curved track of a scenario.
#[derive(Debug, Clone)]
pub(in crate::custom) struct Curved {
    radius: Value,
    angles: [Value; 2],
    width: Value,
    pitch: Value,
    thickness: Option<Value>,
    walls: Value,
    /// Whether no draw changes it.
    pub(in crate::custom) is_fixed: bool,
}

impl Said<What> for ArcOf {
    fn read(&self, reader: &mut Reader<'_>) -> Result<What, ConfigError> {
        let thickness = self.thickness_mm.as_ref();
        let thickness = thickness.map(|said| reader.number("thickness_mm", "thickness", said)).transpose()?;
        let curved = Curved {
            radius: reader.number("radius_mm", "radius", &self.radius_mm)?,
            angles: [reader.number("from_deg", "from", &self.from_deg)?, reader.number("to_deg", "to", &self.to_deg)?],
            width: reader.number("width_mm", "width", &self.width_mm)?,
            pitch: reader.number("pitch_mm", "pitch", &self.pitch_mm)?,
            thickness,
            walls: reader.number("walls_mm", "walls", &self.walls_mm)?,
            is_fixed: reader.is_fixed,
        };
        match curved.fault(reader.collector) {
            Some((name, message)) => Err(reader.wrong(name, message)),
            None => Ok(What::Arc(curved)),
        }
    }
}

impl Curved {
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

    /// Its form in a draw.
    pub(in crate::custom) fn form(&self, numbers: &Numbers<'_>) -> ArcForm {
        let radius = self.radius.metres(numbers);
        ArcForm {
            radius,
            angles: [0, 1].map(|k: usize| self.angles[k].of(numbers).to_radians()),
            width: self.width.metres(numbers),
            pitch: self.pitch.metres(numbers),
            thickness: self.thickness.map_or(THICKNESS * radius, |thickness| thickness.metres(numbers)),
            walls: self.walls.metres(numbers),
        }
    }

    /// The simulator's part of a draw.
    pub(in crate::custom) fn make(
        &self,
        (at, turn): (DVec3, DQuat),
        material: Material,
        numbers: &Numbers<'_>,
    ) -> Result<StaticShape, WorldError> {
        Ok(StaticShape::Arc(ArcTrack::new(self.form(numbers), at, turn, material)?.into()))
    }
}
