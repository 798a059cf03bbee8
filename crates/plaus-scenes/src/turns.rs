//! Orientations: uniform, slightly turned, from a vector, from angles. The same bits on every platform.

use glam::{DQuat, DVec3};
use plaus_dist::{Stream, math, standard_normal};

/// A uniform orientation: a direction in four dimensions, like that of four standard normal numbers.
pub(crate) fn any_orientation(stream: &mut Stream) -> DQuat {
    let [x, y, z, w] = std::array::from_fn(|_| standard_normal(stream));
    DQuat::from_xyzw(x, y, z, w).normalize()
}

/// An orientation turned about a random axis by a Gaussian angle, with standard deviation `size` times half a turn for
/// each component. It is as likely as the way back.
pub(crate) fn turned_a_little(orientation: DQuat, size: f64, stream: &mut Stream) -> DQuat {
    let vector = DVec3::from_array(std::array::from_fn(|_| standard_normal(stream)));
    (turned(vector * (size * std::f64::consts::PI)) * orientation).normalize()
}

/// The rotation by a vector.
pub(crate) fn turned(vector: DVec3) -> DQuat {
    let angle = vector.length();
    if angle == 0.0 {
        return DQuat::IDENTITY;
    }
    let (sin, cos) = math::sin_cos(0.5 * angle);
    let axis = vector * (sin / angle);
    DQuat::from_xyzw(axis.x, axis.y, axis.z, cos)
}

/// The rotation by angles in degrees about the world's x, then about its y, then about its z.
pub(crate) fn by_angles([x, y, z]: [f64; 3]) -> DQuat {
    let about = |axis: DVec3, degrees: f64| turned(axis * degrees.to_radians());
    (about(DVec3::Z, z) * about(DVec3::Y, y) * about(DVec3::X, x)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_turn_about_the_world_s_axes_one_after_the_other() {
        let turn = by_angles([90.0, 0.0, 90.0]);
        assert!((turn * DVec3::Z - DVec3::X).length() < 1e-15, "up goes to −y, and from there to x");
        assert!((by_angles([0.0, 90.0, 0.0]) * DVec3::Z - DVec3::X).length() < 1e-15);
        assert_eq!(by_angles([0.0; 3]), DQuat::IDENTITY);
    }
}
