//! Ellipsoids, as polyhedra.

use super::{
    Amount, ConfigError, Deserialize, Form, JsonSchema, Length, MM, Made, Reader, Round, Said, Serialize, Value,
    Values, vector,
};
use glam::DVec3;
use plaus_sim::shape::ConvexHull;

/// An ellipsoid along its own axes. A polyhedron of its volume with 42 corners is simulated: they lie outside it by up
/// to 4.7 % of half its longest axis, and the faces' middles inside it by up to 2.3 %.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ellipsoid {
    /// The lengths of its axes.
    pub size_mm: [Amount<Length>; 3],
}

/// How far out corners lie, over the ellipsoid's surface there, so that the polyhedron has its volume.
const OUT: f64 = 1.046_132_721_926_497;
/// How far inside the middles of faces lie at most, over the same.
const INSIDE: f64 = 0.977_268_272_630_162_1;

/// The corners of an icosahedron and the middles of its edges, moved outwards: 42 corners of a polyhedron that stands
/// for an ellipsoid and has its volume.
pub(crate) fn corners(half: DVec3) -> Vec<DVec3> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let signs = [1.0, -1.0];
    let corner = |a: f64, b: f64| {
        [DVec3::new(0.0, a, b * golden), DVec3::new(a, b * golden, 0.0), DVec3::new(b * golden, 0.0, a)]
    };
    let corners: Vec<DVec3> = signs.iter().flat_map(|&a| signs.iter().flat_map(move |&b| corner(a, b))).collect();
    let mut points = corners.clone();
    for (index, one) in corners.iter().enumerate() {
        // Edges have the length 2, all other distances are larger.
        points.extend(
            corners[..index].iter().filter(|other| one.distance(**other) < 2.5).map(|other| 0.5 * (one + other)),
        );
    }
    points.into_iter().map(|point| OUT * half * point.normalize()).collect()
}

/// How far a polyhedron's corners lie outside an ellipsoid at most, in the unit of half its axes.
pub(crate) fn error(half: DVec3) -> f64 {
    (OUT - 1.0) * half.max_element()
}

impl Said for Ellipsoid {
    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let size = reader.three("size_mm", "size_", &self.size_mm)?;
        let form = reader.form(Round::Partly, move |numbers| {
            Made::hull(ConvexHull::new(&corners(0.5 * MM * vector(&size, numbers)), 0.0)?)
        });
        Ok(Form { note: Some(note(&size)), ..form })
    }
}

/// What is simulated of it, in words.
fn note(size: &Values) -> String {
    let [most, least] = [OUT - 1.0, 1.0 - INSIDE];
    let far = match size {
        [Value::Fixed(x), Value::Fixed(y), Value::Fixed(z)] => {
            let half = 0.5 * DVec3::new(*x, *y, *z);
            format!("{:.3} mm outside it and {:.3} mm inside", error(half), least * half.max_element())
        }
        _ => format!("{:.1} % outside it and {:.1} % inside", 1e2 * most, 1e2 * least),
    };
    format!("an ellipsoid, by a polyhedron of its volume with 42 corners, up to {far}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::custom::hull_volume;
    use std::f64::consts::PI;

    #[test]
    fn the_polyhedron_has_the_volume_and_the_error_that_are_told() {
        for half in [DVec3::ONE, DVec3::new(0.1, 0.2, 0.15), DVec3::new(3.0, 0.5, 0.5)] {
            let points = corners(half);
            assert_eq!(points.len(), 42);
            let volume = 4.0 / 3.0 * PI * half.element_product();
            assert!((hull_volume(&points).unwrap_or(0.0) / volume - 1.0).abs() < 1e-12, "{half}");
            let far = points.iter().map(|point| (*point - *point / OUT).length()).fold(0.0, f64::max);
            assert!(far <= error(half) * (1.0 + 1e-12) && far > 0.8 * error(half), "{half}: {far}");
        }
        // Of a ball: a point outside the polyhedron of `INSIDE` leaves its hull's volume as it is, one outside adds.
        let ball = corners(DVec3::ONE);
        let whole = hull_volume(&ball).unwrap_or(0.0);
        let middles = (0..42).flat_map(|a| (0..a).flat_map(move |b| (0..b).map(move |c| [a, b, c])));
        let faces = middles.map(|face| face.map(|corner| ball[corner]));
        let flat = |[a, b, c]: [DVec3; 3]| [a - b, b - c, c - a].iter().all(|edge| edge.length() < 0.7);
        let depths = faces.filter(|face| flat(*face)).map(|[a, b, c]| {
            let normal = (b - a).cross(c - a).normalize();
            normal.dot(a).abs()
        });
        let least = depths.fold(f64::INFINITY, f64::min);
        assert!((least - INSIDE).abs() < 1e-12 && whole > 0.0, "{least}");
    }
}
