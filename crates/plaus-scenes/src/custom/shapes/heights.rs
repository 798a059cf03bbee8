//! Ground by its heights.

use super::{Amount, ConfigError, Deserialize, Faces, JsonSchema, Length, Place, Reader, Said, Serialize, Value, What};
use plaus_sim::scenery;

/// Ground by its heights at the points of a square grid, whose middle is at `at_mm`. Beyond the grid there is nothing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Heights {
    /// Heights above `at_mm`: one row for each y, in ascending order, and in a row one height for each x. A square of
    /// the grid is two triangles, cut from its corner of least x and y to the opposite one.
    #[schemars(length(min = 2))]
    pub rows_mm: Vec<Vec<Amount<Place>>>,
    /// Distance between neighbouring points.
    pub spacing_mm: Amount<Length>,
}

impl Said<What> for Heights {
    fn read(&self, reader: &mut Reader<'_>) -> Result<What, ConfigError> {
        let columns = self.rows_mm.first().map_or(0, Vec::len);
        if let Some(j) = self.rows_mm.iter().position(|row| row.len() != columns) {
            let message = format!("{} heights, but the first row has {columns}", self.rows_mm[j].len());
            return Err(reader.wrong(&format!("rows_mm[{j}]"), message));
        }
        let spacing = reader.number("spacing_mm", "spacing", &self.spacing_mm)?;
        let mut rows: Vec<Vec<Value>> = Vec::with_capacity(self.rows_mm.len());
        for (j, row) in self.rows_mm.iter().enumerate() {
            let height = |(i, height)| reader.number(&format!("rows_mm[{j}][{i}]"), &format!("height_{j}_{i}"), height);
            rows.push(row.iter().enumerate().map(height).collect::<Result<_, _>>()?);
        }
        Ok(What::Mesh(Faces::new(reader.is_fixed, move |_, numbers| {
            let metres = |row: &Vec<Value>| row.iter().map(|height| height.metres(numbers)).collect();
            let rows: Vec<Vec<f64>> = rows.iter().map(metres).collect();
            Ok(scenery::Heights::new([spacing.metres(numbers); 2], &rows)?.triangles())
        })))
    }
}
