//! Places on the surface of scenery, all of its area equally likely.
//!
//! A place follows from two variables that are uniform from 0 to 1: the first says which triangle and how far from its
//! first corner, the second where between the other two. Equal areas stay equal, so any move over variables is exact.

use super::amount::{Amount, Plain};
use super::laws::LawOf;
use super::standing::Standing;
use super::values::{Collector, Numbers, Owner, Value};
use super::within::WithinSurface;
use crate::scenario::nearest;
use crate::scene::ConfigError;
use glam::{DQuat, DVec3};
use plaus_dist::math;
use std::sync::Arc;

/// Rounding of a normal, as an angle in degrees.
const ROUNDING: f64 = 1e-6;

/// Where a body starts on a piece of scenery.
#[derive(Debug, Clone)]
pub(super) struct On {
    /// Which piece.
    pub(super) part: usize,
    standing: Standing,
    /// The largest angle between a face's normal and the scenery's z axis, in degrees.
    facing: f64,
    place: [Value; 2],
    above: Value,
    is_along: bool,
    /// Its faces, unless a draw changes them.
    kept: Option<Arc<Faces>>,
}

/// Faces about the scenery's place and along its axes.
#[derive(Debug)]
struct Faces {
    corners: Vec<[DVec3; 3]>,
    /// The area of each and those before it.
    areas: Vec<f64>,
}

impl Faces {
    /// Those that look up to within an angle in degrees.
    fn new(all: impl IntoIterator<Item = [DVec3; 3]>, facing: f64) -> Self {
        let (mut corners, mut areas, mut sum) = (Vec::new(), Vec::new(), 0.0);
        for face @ [a, b, c] in all {
            let across = (b - a).cross(c - a);
            let angle = math::acos((across.z / across.length()).clamp(-1.0, 1.0)).to_degrees();
            if angle <= facing + ROUNDING {
                sum += 0.5 * across.length();
                corners.push(face);
                areas.push(sum);
            }
        }
        Self { corners, areas }
    }

    /// A point, and the outward normal there, for two numbers from 0 to 1.
    fn at(&self, [u, v]: [f64; 2]) -> (DVec3, DVec3) {
        let area = u * self.areas.last().copied().unwrap_or_default();
        let face = self.areas.partition_point(|sum| *sum <= area).min(self.corners.len() - 1);
        let before = face.checked_sub(1).map_or(0.0, |before| self.areas[before]);
        let [a, b, c] = self.corners[face];
        // From the first corner, area grows with the square of the distance.
        let out = ((area - before) / (self.areas[face] - before)).clamp(0.0, 1.0).sqrt();
        (a + ((b - a) * (1.0 - v) + (c - a) * v) * out, (b - a).cross(c - a).normalize())
    }
}

impl On {
    /// A place on a piece of scenery, with the variables `ball.within_u` and `ball.within_v`.
    pub(super) fn new(
        collector: &mut Collector,
        owner: &Owner<'_>,
        surface: &WithinSurface,
        parts: &[Standing],
    ) -> Result<Self, ConfigError> {
        let wrong = |message: String| owner.wrong("within.surface.of", message);
        let names = || parts.iter().map(|part| part.name.as_str());
        let part = names().position(|name| name == surface.of).ok_or_else(|| {
            let near = nearest(&surface.of, names()).map(|near| format!("did you mean {near:?}? "));
            wrong(format!("there is no scenery {:?}; {}", surface.of, near.unwrap_or_default()))
        })?;
        let uniform = Amount::<Plain>::of(LawOf::Uniform([0.0, 1.0]));
        let mut place = [Value::Fixed(0.0); 2];
        for (value, name) in place.iter_mut().zip(["within_u", "within_v"]) {
            *value = collector.number(owner, "within", name, &uniform)?;
        }
        let above = collector.number(owner, "within.surface.above_mm", "within_above", &surface.above_mm)?;
        let (standing, facing, is_along) = (parts[part].clone(), surface.facing_deg, surface.along);
        let mut on = Self { part, standing, facing, place, above, is_along, kept: None };
        let middle = collector.works();
        let faces = on.faces(&middle.numbers(None)).map_err(wrong)?;
        if faces.corners.is_empty() {
            return Err(owner.wrong("within.surface.facing_deg", format!("no face of {:?} looks there", surface.of)));
        }
        on.kept = on.standing.has_fixed_faces().then_some(faces);
        Ok(on)
    }

    fn faces(&self, numbers: &Numbers<'_>) -> Result<Arc<Faces>, String> {
        match &self.kept {
            Some(faces) => Ok(Arc::clone(faces)),
            None => Ok(Arc::new(Faces::new(self.standing.faces(numbers)?, self.facing))),
        }
    }

    /// The place of a draw, in m, and the outward normal there.
    fn point(&self, numbers: &Numbers<'_>) -> (DVec3, DVec3) {
        let (at, turn) = self.standing.pose(numbers);
        // That the scenery has such faces was checked.
        let Ok(faces) = self.faces(numbers) else { return (at, turn * DVec3::Z) };
        let (point, normal) = faces.at(self.place.map(|value| value.of(numbers)));
        (at + turn * point, turn * normal)
    }

    /// Where a body starts, in m.
    pub(super) fn place(&self, numbers: &Numbers<'_>) -> DVec3 {
        let (point, normal) = self.point(numbers);
        point + normal * self.above.metres(numbers)
    }

    /// How the surface turns it, if it does.
    pub(super) fn along(&self, numbers: &Numbers<'_>) -> Option<DQuat> {
        self.is_along.then(|| DQuat::from_rotation_arc(DVec3::Z, self.point(numbers).1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of two triangles of unlike size: the share on each, and the mean and mean square about the first corner.
    #[test]
    fn equal_areas_are_equally_likely() {
        let [o, x, y, up] = [DVec3::ZERO, DVec3::X * 3.0, DVec3::Y * 2.0, DVec3::Z];
        let flat = [o, x, y];
        let steep = [x + up, x + y + up, x + y];
        let faces = Faces::new([flat, steep, [o, y, x]], 90.0);
        assert_eq!(faces.corners, [flat, steep], "what looks down is left out");
        let n = 400;
        let grid = (0..n * n).map(|k| [f64::from(k % n), f64::from(k / n)].map(|i| (i + 0.5) / f64::from(n)));
        let all: Vec<DVec3> = grid.map(|place| faces.at(place).0).collect();
        let on_flat: Vec<&DVec3> =
            all.iter().filter(|point| point.z == 0.0 && point.x < 3.0 * (1.0 - point.y / 2.0) + 1e-9).collect();
        let share = on_flat.len() as f64 / f64::from(n * n);
        // Areas: 3, and half of |(0, 2, 0) × (0, 2, −1)| = 1. The grid has 400 lines.
        assert!((share - 3.0 / 4.0).abs() < 1.0 / 400.0, "{share}");
        let mean = |f: &dyn Fn(&DVec3) -> f64| on_flat.iter().map(|point| f(point)).sum::<f64>() / on_flat.len() as f64;
        // Over a triangle with a right angle and the edge b along an axis: b / 3, and b² / 6.
        for (value, truth) in [
            (mean(&|point| point.x), 1.0),
            (mean(&|point| point.y), 2.0 / 3.0),
            (mean(&|point| point.x * point.x), 1.5),
            (mean(&|point| point.y * point.y), 4.0 / 6.0),
        ] {
            assert!((value - truth).abs() < 0.01, "{value} {truth}");
        }
    }
}
