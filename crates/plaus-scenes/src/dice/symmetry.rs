//! The rotations that map a cuboid to itself, and the faces of a die.
//!
//! Besides the orientation of a die's body, a draw holds which of these rotations its pips are turned by. The body
//! moves as if it had no pips, so another rotation changes which face comes up, and no bit of the motion.

use glam::{DMat3, DQuat, DVec3};

/// Where a die's pips are on its body: the pips' axis `k` is the body's axis `axis[k]`, reversed if `sign[k]` is −1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    axis: [usize; 3],
    sign: [f64; 3],
}

/// Face 1 lies along the third of the pips' axes, 2 along the second, 3 along the first; opposite faces add up to
/// seven.
fn face_along(axis: usize, sign: f64) -> u8 {
    let front = 3 - axis as u8;
    if sign > 0.0 { front } else { 7 - front }
}

/// The pips' axis of a face from 1 to 6, and its direction.
fn axis_of(face: u8) -> (usize, f64) {
    let front = face.min(7 - face);
    (3 - usize::from(front), if face == front { 1.0 } else { -1.0 })
}

/// An orientation in which this face is uppermost, for pips along the body's own axes.
pub(super) fn facing(face: u8) -> DQuat {
    let (axis, sign) = axis_of(face);
    // The rotation from the face's normal to the vertical.
    DQuat::from_rotation_arc(DVec3::AXES[axis] * sign, DVec3::Z)
}

impl Rotation {
    /// Pips along the body's own axes.
    pub const IDENTITY: Self = Self { axis: [0, 1, 2], sign: [1.0; 3] };

    /// The proper rotations that map a cuboid with these edges to itself, the identity first: 24 for a cube, 8 if two
    /// edges are equal, otherwise 4.
    #[must_use]
    pub fn of_cuboid(edges: DVec3) -> Vec<Self> {
        let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
        let mut found = Vec::new();
        for (k, axis) in orders.into_iter().enumerate() {
            // The last three orders are odd.
            let parity = if k < 3 { 1.0 } else { -1.0 };
            for signs in 0..8_u8 {
                let sign: [f64; 3] = std::array::from_fn(|axis| if signs >> axis & 1 == 1 { -1.0 } else { 1.0 });
                let fits = (0..3).all(|k| edges[axis[k]] == edges[k]);
                if fits && sign.iter().product::<f64>() == parity {
                    found.push(Self { axis, sign });
                }
            }
        }
        found
    }

    /// A direction given along the body's axes, along the pips' axes.
    fn seen(&self, body: DVec3) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|k| self.sign[k] * body[self.axis[k]]))
    }

    /// The uppermost face of a body with this orientation, and the cosine of the angle between its normal and the
    /// vertical.
    #[must_use]
    pub fn uppermost(&self, orientation: DQuat) -> (u8, f64) {
        let up = self.seen(orientation.conjugate() * DVec3::Z);
        let axis = (1..3).fold(0, |best, k| if up[k].abs() > up[best].abs() { k } else { best });
        (face_along(axis, up[axis]), up[axis].abs())
    }

    /// The cosine of the angle between a face's normal and the vertical.
    #[must_use]
    pub fn cosine(&self, face: u8, orientation: DQuat) -> f64 {
        let up = self.seen(orientation.conjugate() * DVec3::Z);
        let (axis, sign) = axis_of(face);
        sign * up[axis]
    }

    /// The orientation of the pips, given that of the body.
    #[must_use]
    pub fn pips(&self, orientation: DQuat) -> DQuat {
        let column = |k: usize| DVec3::AXES[self.axis[k]] * self.sign[k];
        (orientation * DQuat::from_mat3(&DMat3::from_cols(column(0), column(1), column(2)))).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuboids_have_as_many_rotations_as_they_should() {
        let count = |x, y, z| Rotation::of_cuboid(DVec3::new(x, y, z)).len();
        assert_eq!(
            [count(1.0, 1.0, 1.0), count(1.0, 2.0, 2.0), count(2.0, 1.0, 2.0), count(1.0, 2.0, 3.0)],
            [24, 8, 8, 4]
        );
        let cube = Rotation::of_cuboid(DVec3::ONE);
        assert_eq!(cube[0], Rotation::IDENTITY);
        for (k, one) in cube.iter().enumerate() {
            assert!(cube[..k].iter().all(|other| other != one));
        }
    }

    /// Each of the six faces is uppermost under four of the rotations, whatever the body's orientation.
    #[test]
    fn rotations_bring_every_face_up_alike() {
        let orientation = DQuat::from_xyzw(0.1, -0.4, 0.3, 0.8).normalize();
        let mut counts = [0; 7];
        for rotation in Rotation::of_cuboid(DVec3::ONE) {
            let (face, cosine) = rotation.uppermost(orientation);
            counts[usize::from(face)] += 1;
            assert!((rotation.cosine(face, orientation) - cosine).abs() < 1e-15);
            assert!((rotation.cosine(7 - face, orientation) + cosine).abs() < 1e-15);
            // The drawn pips show that face, too: its normal, turned with the pips.
            let (axis, sign) = axis_of(face);
            let up = rotation.pips(orientation) * (DVec3::AXES[axis] * sign);
            assert!((up.z - cosine).abs() < 1e-14);
        }
        assert_eq!(counts, [0, 4, 4, 4, 4, 4, 4]);
    }

    #[test]
    fn faces_are_a_die_s() {
        assert_eq!(Rotation::IDENTITY.uppermost(DQuat::IDENTITY), (1, 1.0));
        for face in 1..=6 {
            assert_eq!(Rotation::IDENTITY.uppermost(facing(face)).0, face);
        }
        assert_eq!(Rotation::IDENTITY.cosine(6, DQuat::IDENTITY), -1.0);
        assert_eq!(
            (1..=6).map(axis_of).map(|(axis, sign)| face_along(axis, sign)).collect::<Vec<_>>(),
            [1, 2, 3, 4, 5, 6]
        );
    }
}
