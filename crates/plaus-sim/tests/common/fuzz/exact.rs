//! The judge of overlaps, which shares nothing with the simulator: signed distances of convex pieces, and the largest
//! ball that fits into two of them at once.

use glam::{DMat3, DQuat, DVec2, DVec3};

/// A convex core about its own origin.
#[derive(Debug, Clone)]
pub enum Core {
    Point,
    /// Half the edges.
    Cuboid(DVec3),
    /// A polygon (distance from the z axis, height), turned about the z axis. Its edges off the axis, from the lowest
    /// to the highest.
    Lathe(Vec<DVec2>),
    /// Unit normals out of it with their distances from the origin, and the distance of the farthest corner.
    Planes(Vec<(DVec3, f64)>, f64),
    /// All that is below z = 0.
    Half,
}

impl Core {
    /// From a chain of points from the axis to the axis.
    pub fn lathe(chain: &[DVec2]) -> Self {
        let mut points: Vec<DVec2> = Vec::new();
        for &p in chain {
            if points.last().is_none_or(|&q| (p - q).length() > 1e-12) {
                points.push(p);
            }
        }
        Self::Lathe(points)
    }

    /// An outline (distance from the axis, height) from foot to top as convex solids, one on the other: a run ends
    /// where the outline bends inwards.
    pub fn lathes(outline: &[[f64; 2]]) -> Vec<Self> {
        let points: Vec<DVec2> = outline.iter().map(|p| DVec2::from_array(*p)).collect();
        let (mut cores, mut from) = (Vec::new(), 0);
        while from + 1 < points.len() {
            let mut to = from + 1;
            while to + 1 < points.len() && (points[to] - points[to - 1]).perp_dot(points[to + 1] - points[to]) >= 0.0 {
                to += 1;
            }
            let on_axis = |k: usize| DVec2::new(0.0, points[k].y);
            let mut chain = vec![on_axis(from)];
            chain.extend(&points[from..=to]);
            chain.push(on_axis(to));
            cores.push(Self::lathe(&chain));
            from = to;
        }
        cores
    }

    /// The hull of a few points: a plane through three of them is a face if no other is beyond it.
    pub fn planes(points: &[DVec3]) -> Self {
        let size = points.iter().map(|p| p.length()).fold(0.0, f64::max);
        let mut planes: Vec<(DVec3, f64)> = Vec::new();
        for (i, &a) in points.iter().enumerate() {
            for (j, &b) in points.iter().enumerate() {
                for &c in points.iter().skip(j + 1) {
                    let cross = (b - a).cross(c - a);
                    if i == j || cross.length() < 1e-9 * size * size {
                        continue;
                    }
                    for normal in [cross.normalize(), -cross.normalize()] {
                        let known = planes.iter().any(|(n, _)| (*n - normal).length() < 1e-7);
                        if !known && points.iter().all(|&p| normal.dot(p - a) < 1e-9 * size) {
                            planes.push((normal, normal.dot(a)));
                        }
                    }
                }
            }
        }
        Self::Planes(planes, size)
    }

    fn reach(&self) -> f64 {
        match self {
            Self::Point => 0.0,
            Self::Cuboid(half) => half.length(),
            Self::Lathe(points) => points.iter().map(|p| p.length()).fold(0.0, f64::max),
            Self::Planes(_, reach) => *reach,
            Self::Half => f64::INFINITY,
        }
    }

    /// A convex function that is the signed distance inside, and positive outside (there the distance, but for
    /// polyhedra); and its slope.
    fn signed(&self, p: DVec3) -> (f64, DVec3) {
        match self {
            Self::Point => (p.length(), p.normalize_or(DVec3::Z)),
            Self::Half => (p.z, DVec3::Z),
            Self::Cuboid(half) => {
                let beyond = p.abs() - *half;
                let out = beyond.max(DVec3::ZERO);
                if out != DVec3::ZERO {
                    return (out.length(), out.normalize() * p.signum());
                }
                let axis = if beyond.x >= beyond.y.max(beyond.z) {
                    0
                } else if beyond.y >= beyond.z {
                    1
                } else {
                    2
                };
                (beyond[axis], DVec3::AXES[axis] * p[axis].signum())
            }
            Self::Planes(planes, _) => {
                let beyond = |(n, d): &(DVec3, f64)| (n.dot(p) - d, *n);
                planes.iter().map(beyond).max_by(|a, b| a.0.total_cmp(&b.0)).expect("a hull has faces")
            }
            Self::Lathe(points) => {
                let (flat, q) = (p.truncate(), DVec2::new(p.truncate().length(), p.z));
                let (distance, way) = polygon(points, q);
                let out = flat.normalize_or(DVec2::X) * way.x;
                (distance, out.extend(way.y))
            }
        }
    }
}

/// Signed distance from a convex chain whose inside is on its left, and its slope.
fn polygon(points: &[DVec2], q: DVec2) -> (f64, DVec2) {
    let is_flat = points.iter().all(|p| p.x == 0.0);
    let (mut inside, mut nearest) = ((f64::NEG_INFINITY, DVec2::Y), (f64::INFINITY, DVec2::Y));
    for pair in points.windows(2) {
        let (a, along) = (pair[0], pair[1] - pair[0]);
        let normal = -along.perp().normalize();
        let beyond = normal.dot(q - a);
        if beyond > inside.0 {
            inside = (beyond, normal);
        }
        let foot = a + along * ((q - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let distance = (q - foot).length();
        if distance < nearest.0 {
            nearest = (distance, (q - foot).normalize_or(normal));
        }
    }
    if inside.0 <= 0.0 && !is_flat { inside } else { nearest }
}

/// A convex piece in its place: all within `rounding` of its core.
#[derive(Debug, Clone)]
pub struct Piece {
    core: Core,
    rounding: f64,
    at: DVec3,
    turn: DQuat,
}

impl Piece {
    pub fn new(core: Core, rounding: f64) -> Self {
        Self { core, rounding, at: DVec3::ZERO, turn: DQuat::IDENTITY }
    }

    /// Turned about the origin, then moved.
    pub fn moved(&self, at: DVec3, turn: DQuat) -> Self {
        Self { at: at + turn * self.at, turn: turn * self.turn, ..self.clone() }
    }

    pub fn signed(&self, p: DVec3) -> (f64, DVec3) {
        let (distance, way) = self.core.signed(self.turn.inverse() * (p - self.at));
        (distance - self.rounding, self.turn * way)
    }

    fn reach(&self) -> f64 {
        self.core.reach() + self.rounding
    }
}

/// Rounds of the search. Each shrinks the ellipsoid's mean radius by at least e^(1/24): three hundred by 3e-6.
const ROUNDS: usize = 300;

/// The diameter of the largest ball that fits into both pieces, 0 if they have no point in common that is deeper than
/// half of `least`. Moving one of the pieces by less does not part them, so the depth of their overlap is at least
/// this. `[centre, radius]` of a ball that holds one of them.
///
/// The depth of a point in both is concave, so cutting planes find its greatest value: the ellipsoid method with deep
/// cuts (Bland, Goldfarb, Todd 1981), which also knows a bound of what it can still find.
pub fn overlap(a: &Piece, b: &Piece, (start, radius): (DVec3, f64), least: f64) -> f64 {
    let (mut c, mut p) = (start, DMat3::from_diagonal(DVec3::splat(radius * radius)));
    if (a.at - b.at).length() > a.reach() + b.reach() {
        return 0.0;
    }
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let (fa, fb) = (a.signed(c), b.signed(c));
        let (f, slope) = if fa.0 >= fb.0 { fa } else { fb };
        best = best.min(f);
        let width = slope.dot(p * slope).max(0.0).sqrt();
        let bound = f - width;
        if width <= 0.0 || bound > -0.5 * least || best - bound < 1e-3 * least {
            break;
        }
        let cut = ((f - best) / width).clamp(0.0, 0.999);
        let g = p * slope / width;
        let outer = DMat3::from_cols(g * g.x, g * g.y, g * g.z);
        c -= g * ((1.0 + 3.0 * cut) / 4.0);
        p = (p - outer * (2.0 * (1.0 + 3.0 * cut) / (4.0 * (1.0 + cut)))) * (9.0 / 8.0 * (1.0 - cut * cut));
    }
    let depth = -2.0 * best;
    if depth > least { depth } else { 0.0 }
}
