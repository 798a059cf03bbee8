//! Ground by its heights.

use super::forms::Heights;
use super::solids::MM;
use super::values::{Collector, Numbers, Owner, Value};
use crate::scene::ConfigError;
use plaus_sim::{WorldError, scenery};

/// A height field of a scenario: distances of its points, and its heights, row by row.
#[derive(Debug, Clone)]
pub(super) struct Hilly {
    spacing: Value,
    rows: Vec<Vec<Value>>,
}

impl Hilly {
    pub(super) fn new(collector: &mut Collector, owner: &Owner<'_>, said: &Heights) -> Result<Self, ConfigError> {
        let key = |j: usize| format!("shape.heights.rows_mm[{j}]");
        let columns = said.rows_mm.first().map_or(0, Vec::len);
        if let Some(j) = said.rows_mm.iter().position(|row| row.len() != columns) {
            let message = format!("{} heights, but the first row has {columns}", said.rows_mm[j].len());
            return Err(owner.wrong(&key(j), message));
        }
        let spacing = collector.number(owner, "shape.heights.spacing_mm", "spacing", &said.spacing_mm)?;
        let mut rows = Vec::with_capacity(said.rows_mm.len());
        for (j, row) in said.rows_mm.iter().enumerate() {
            let height =
                |(i, height)| collector.number(owner, &format!("{}[{i}]", key(j)), &format!("height_{j}_{i}"), height);
            rows.push(row.iter().enumerate().map(height).collect::<Result<_, _>>()?);
        }
        Ok(Self { spacing, rows })
    }

    /// Whether no draw changes it.
    pub(super) fn is_fixed(&self) -> bool {
        self.spacing.is_fixed() && self.rows.iter().flatten().all(|height| height.is_fixed())
    }

    /// The surface in a draw.
    pub(super) fn surface(&self, numbers: &Numbers<'_>) -> Result<scenery::Heights, WorldError> {
        let metres = |row: &Vec<Value>| row.iter().map(|height| height.of(numbers) * MM).collect();
        let rows: Vec<Vec<f64>> = self.rows.iter().map(metres).collect();
        scenery::Heights::new([self.spacing.of(numbers) * MM; 2], &rows)
    }
}
