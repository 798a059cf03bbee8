//! Shapes of files: their triangles, and the convex hulls of these.

use super::{
    ConfigError, Deserialize, EachFile, Faces, Form, FromFile, JsonSchema, Made, Reader, Round, Said, Serialize, Value,
    Wanted, What, animation,
};
use crate::custom::from_file::Loaded;
use glam::DVec3;
use plaus_sim::shape::ConvexHull;
use std::sync::Arc;

/// The convex hull of the triangles in a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline)]
pub struct HullOf(pub FromFile);

impl Said for HullOf {
    fn for_files(&mut self, key: &str, each: EachFile<'_>) -> Result<(), ConfigError> {
        each(key, Wanted::Hull, &mut self.0)
    }

    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let (loaded, unit) = opened(reader, &self.0)?;
        let note = loaded.note(unit);
        let form = reader.form(Round::Not, move |numbers| {
            let unit = unit.metres(numbers);
            let points = loaded.corners.iter().flat_map(|corners| &corners.points);
            let points: Vec<DVec3> = points.map(|&point| point * unit).collect();
            let made = Made::hull(ConvexHull::new(&points, 0.0)?)?;
            // The file's own triangles are drawn.
            let seen = &loaded.triangles;
            let vertices = seen.corners.iter().map(|&corner| corner * unit - made.centre).collect();
            let drawn = animation::Shape::Solid { vertices, triangles: seen.faces.clone() };
            Ok(Made { drawn: drawn.into(), ..made })
        });
        Ok(Form { note, ..form })
    }
}

/// The triangles of a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline)]
pub struct Mesh(pub FromFile);

impl Said<What> for Mesh {
    fn for_files(&mut self, key: &str, each: EachFile<'_>) -> Result<(), ConfigError> {
        each(key, Wanted::Triangles, &mut self.0)
    }

    fn read(&self, reader: &mut Reader<'_>) -> Result<What, ConfigError> {
        let (loaded, unit) = opened(reader, &self.0)?;
        let faces = Faces::new(unit.is_fixed(), move |_, numbers| {
            let (unit, file) = (unit.metres(numbers), &loaded.triangles);
            Ok((file.corners.iter().map(|&corner| corner * unit).collect(), file.faces.clone()))
        });
        Ok(What::Mesh(Faces { is_file: true, ..faces }))
    }
}

/// What a file holds, and how many millimetres its unit is.
fn opened(reader: &mut Reader<'_>, file: &FromFile) -> Result<(Arc<Loaded>, Value), ConfigError> {
    let loaded =
        file.loaded(&format!("{}.{}", reader.owner.key, reader.key.trim_end_matches('.')), reader.owner.nth)?;
    let unit = match &file.unit_mm {
        None => Value::Fixed(loaded.unit_mm),
        Some(unit) => reader.number("unit_mm", "unit", unit)?,
    };
    Ok((loaded, unit))
}
