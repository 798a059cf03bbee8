//! Solids of revolution.

use super::{Amount, ConfigError, Deserialize, Form, JsonSchema, Length, Made, Reader, Round, Said, Serialize};
use plaus_sim::shape::Profile;

/// A solid of revolution: a flat foot with a rounded rim, a smooth curve through the points of its outline, and a top
/// that is part of a ball.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Revolution {
    /// Radius of the foot's flat.
    pub foot_mm: Amount<Length>,
    /// Rounding of the foot's rim.
    pub rim_mm: Amount<Length>,
    /// Heights above the foot and radii there, from low to high.
    #[schemars(length(min = 3, max = 100))]
    pub outline_mm: Vec<[Amount<Length>; 2]>,
    /// Height of the top. It is part of a ball: half a ball of the last radius where there is room for it, else a
    /// flatter part of a larger one.
    pub top_mm: Amount<Length>,
}

impl Said for Revolution {
    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let foot = reader.number("foot_mm", "foot", &self.foot_mm)?;
        let rim = reader.number("rim_mm", "rim", &self.rim_mm)?;
        let mut outline = Vec::with_capacity(self.outline_mm.len());
        for (index, [height, radius]) in self.outline_mm.iter().enumerate() {
            outline.push([
                reader.number(&format!("outline_mm[{index}][0]"), &format!("height_{index}"), height)?,
                reader.number(&format!("outline_mm[{index}][1]"), &format!("radius_{index}"), radius)?,
            ]);
        }
        let top = reader.number("top_mm", "top", &self.top_mm)?;
        Ok(reader.form(Round::Turned, move |numbers| {
            Made::revolution(&Profile {
                foot: foot.metres(numbers),
                rim: rim.metres(numbers),
                points: outline.iter().map(|point| point.map(|value| value.metres(numbers))).collect(),
                top: top.metres(numbers),
            })
        }))
    }
}
