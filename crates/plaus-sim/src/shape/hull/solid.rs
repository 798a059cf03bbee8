//! The regular solids.

use glam::DVec3;

/// A regular (Platonic) solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solid {
    /// Four triangles: a d4.
    Tetrahedron,
    /// Six squares: the usual die.
    Cube,
    /// Eight triangles: a d8.
    Octahedron,
    /// Twelve pentagons: a d12.
    Dodecahedron,
    /// Twenty triangles: a d20.
    Icosahedron,
}

impl Solid {
    /// All of them, by the number of their faces.
    pub const ALL: [Self; 5] = [Self::Tetrahedron, Self::Cube, Self::Octahedron, Self::Dodecahedron, Self::Icosahedron];

    /// How many faces it has.
    #[must_use]
    pub fn faces(self) -> usize {
        match self {
            Self::Tetrahedron => 4,
            Self::Cube => 6,
            Self::Octahedron => 8,
            Self::Dodecahedron => 12,
            Self::Icosahedron => 20,
        }
    }

    /// Its corners about its middle, with edges of this length in m.
    #[must_use]
    pub fn corners(self, edge: f64) -> Vec<DVec3> {
        let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
        let signs = |x: f64, y: f64, z: f64| {
            [-1.0, 1.0].into_iter().flat_map(move |a| {
                [-1.0, 1.0].into_iter().flat_map(move |b| [-1.0, 1.0].map(|c| DVec3::new(a * x, b * y, c * z)))
            })
        };
        let turned = |p: DVec3| [p, DVec3::new(p.z, p.x, p.y), DVec3::new(p.y, p.z, p.x)];
        // Corners in the usual coordinates, and their edge.
        let (mut corners, usual): (Vec<DVec3>, f64) = match self {
            Self::Tetrahedron => {
                let all = signs(1.0, 1.0, 1.0).filter(|p| p.x * p.y * p.z > 0.0);
                (all.collect(), 8.0_f64.sqrt())
            }
            Self::Cube => (signs(1.0, 1.0, 1.0).collect(), 2.0),
            Self::Octahedron => (DVec3::AXES.into_iter().flat_map(|e| [e, -e]).collect(), 2.0_f64.sqrt()),
            Self::Dodecahedron => {
                let rest = signs(0.0, 1.0 / golden, golden).flat_map(turned);
                (signs(1.0, 1.0, 1.0).chain(rest).collect(), 2.0 / golden)
            }
            Self::Icosahedron => (signs(0.0, 1.0, golden).flat_map(turned).collect(), 2.0),
        };
        // A zero with a sign is the same corner.
        let mut distinct: Vec<DVec3> = Vec::new();
        for p in corners.drain(..) {
            if !distinct.contains(&p) {
                distinct.push(p);
            }
        }
        distinct.into_iter().map(|p| p * (edge / usual)).collect()
    }
}
