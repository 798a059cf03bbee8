//! Several shapes joined into one body.

use super::{
    Amount, Angle, ConfigError, Convex, Deserialize, EachFile, Factor, Form, JsonSchema, MM, Made, Place, Reader,
    Round, Said, Serialize, Value, Values, WorldError, vector,
};
use crate::turns::by_angles;

/// Several shapes joined into one body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Compound {
    /// Its pieces. Where they overlap, their masses add up.
    #[schemars(length(min = 1, max = 256))]
    pub pieces: Vec<Piece>,
}

/// A piece of a compound.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Piece {
    /// Its shape.
    pub shape: Convex,
    /// Where its middle is in the compound.
    #[serde(default)]
    pub at_mm: [Amount<Place>; 3],
    /// How it is turned in the compound: about the x axis, then about y, then about z.
    #[serde(default)]
    pub turn_deg: [Amount<Angle>; 3],
    /// Its density, relative to that of the material.
    #[serde(default = "one")]
    pub density: Amount<Factor>,
}

fn one() -> Amount<Factor> {
    1.0.into()
}

/// A piece with its numbers as values.
struct Placed {
    form: Form,
    at: Values,
    turn: Values,
    density: Value,
}

impl Said for Compound {
    fn for_files(&mut self, key: &str, each: EachFile<'_>) -> Result<(), ConfigError> {
        let mut pieces = self.pieces.iter_mut().enumerate();
        pieces.try_for_each(|(index, piece)| piece.shape.for_files(&format!("{key}.pieces[{index}].shape"), each))
    }

    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let mut pieces = Vec::with_capacity(self.pieces.len());
        for (index, piece) in self.pieces.iter().enumerate() {
            let own = &mut reader.within(&format!("pieces[{index}]"), &format!("piece_{}_", index + 1));
            let placed = Placed {
                form: piece.shape.read(own)?,
                at: own.three("at_mm", "", &piece.at_mm)?,
                turn: own.three("turn_deg", "turn_", &piece.turn_deg)?,
                density: own.number("density", "density", &piece.density)?,
            };
            let is_fixed = own.is_fixed && placed.form.is_fixed;
            reader.is_fixed &= is_fixed;
            pieces.push(placed);
        }
        let notes: Vec<&str> = pieces.iter().filter_map(|piece| piece.form.note.as_deref()).collect();
        let note = (!notes.is_empty()).then(|| notes.join("; "));
        let roundings = pieces.iter().flat_map(|piece| &piece.form.roundings).copied().collect();
        let form = reader.form(Round::Not, move |numbers| {
            let made = pieces.iter().map(|Placed { form, at, turn, density }| {
                let turn = by_angles(turn.map(|angle| angle.of(numbers)));
                Ok((form.make(numbers)?, vector(at, numbers) * MM, turn, density.of(numbers)))
            });
            Made::joined(made.collect::<Result<Vec<_>, WorldError>>()?)
        });
        Ok(Form { note, roundings, ..form })
    }
}
