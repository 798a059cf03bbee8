//! One cell of a spline: its polynomial and what bounds it.

/// Value and derivatives of a field at a point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// The value.
    pub value: f64,
    /// Derivatives along x and y, per m.
    pub slope: [f64; 2],
    /// Second derivatives xx, xy, yy, per m².
    pub bend: [f64; 3],
}

/// What holds all over a region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// No value is lower.
    pub low: f64,
    /// No value is higher.
    pub high: f64,
    /// No gradient is longer, per m.
    pub slope: f64,
    /// No second derivative in any direction is larger, per m².
    pub bend: f64,
}

impl Bounds {
    /// What holds in no region.
    pub const NONE: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY, slope: 0.0, bend: 0.0 };

    /// What holds in both regions.
    #[inline]
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            slope: self.slope.max(other.slope),
            bend: self.bend.max(other.bend),
        }
    }
}

/// Coefficients of `uᵃ vᵇ`, `u` and `v` from 0 to 1 within the cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    power: [[f64; 4]; 4],
    pub(super) bounds: Bounds,
}

/// Row `a`: coefficients of `uᵃ` from the four control values.
const TO_POWER: [[f64; 4]; 4] = [
    [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0],
    [-0.5, 0.0, 0.5, 0.0],
    [0.5, -1.0, 0.5, 0.0],
    [-1.0 / 6.0, 0.5, -0.5, 1.0 / 6.0],
];
/// Row `a`: the Bernstein coefficient from the four control values.
const TO_BERNSTEIN: [[f64; 4]; 4] = [
    [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0],
    [0.0, 2.0 / 3.0, 1.0 / 3.0, 0.0],
    [0.0, 1.0 / 3.0, 2.0 / 3.0, 0.0],
    [0.0, 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0],
];

fn transform(by: &[[f64; 4]; 4], points: &[[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let dot = |m: &[f64; 4], p: [f64; 4]| m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3] * p[3];
    let mut half = [[0.0; 4]; 4];
    for a in 0..4 {
        for (j, h) in half[a].iter_mut().enumerate() {
            *h = dot(&by[a], [points[0][j], points[1][j], points[2][j], points[3][j]]);
        }
    }
    half.map(|row| [dot(&by[0], row), dot(&by[1], row), dot(&by[2], row), dot(&by[3], row)])
}

impl Cell {
    /// The cell over control values `points[a][b]`.
    pub(super) fn new(points: &[[f64; 4]; 4], spacing: f64) -> Self {
        Self { power: transform(&TO_POWER, points), bounds: bounds(&transform(&TO_BERNSTEIN, points), spacing) }
    }

    /// Value and derivatives; `per` is 1/spacing.
    #[inline]
    pub(super) fn at(&self, u: f64, v: f64, per: f64) -> Sample {
        let mut rows = [[0.0; 3]; 4];
        for (row, c) in rows.iter_mut().zip(&self.power) {
            *row = horner(c, v);
        }
        let column = |k: usize| [rows[0][k], rows[1][k], rows[2][k], rows[3][k]];
        let (along, across) = (horner(&column(0), u), horner(&column(1), u));
        let c = column(2);
        let yy = c[0] + u * (c[1] + u * (c[2] + u * c[3]));
        Sample {
            value: along[0],
            slope: [along[1] * per, across[0] * per],
            bend: [along[2] * per * per, across[1] * per * per, yy * per * per],
        }
    }

    /// Value and first derivatives, the same bits as those of [`at`](Self::at).
    #[inline]
    pub(super) fn slope_at(&self, u: f64, v: f64, per: f64) -> (f64, [f64; 2]) {
        let mut rows = [[0.0; 2]; 4];
        for (row, c) in rows.iter_mut().zip(&self.power) {
            let [value, slope, _] = horner(c, v);
            *row = [value, slope];
        }
        let column = |k: usize| [rows[0][k], rows[1][k], rows[2][k], rows[3][k]];
        let (along, across) = (horner(&column(0), u), horner(&column(1), u));
        (along[0], [along[1] * per, across[0] * per])
    }

    #[inline]
    pub(super) fn value(&self, u: f64, v: f64) -> f64 {
        let row = |c: &[f64; 4]| c[0] + v * (c[1] + v * (c[2] + v * c[3]));
        let p = &self.power;
        row(&p[0]) + u * (row(&p[1]) + u * (row(&p[2]) + u * row(&p[3])))
    }
}

/// Value, first and second derivative of a cubic.
#[inline]
fn horner(c: &[f64; 4], x: f64) -> [f64; 3] {
    [
        c[0] + x * (c[1] + x * (c[2] + x * c[3])),
        c[1] + x * (2.0 * c[2] + x * (3.0 * c[3])),
        2.0 * c[2] + x * (6.0 * c[3]),
    ]
}

fn bounds(b: &[[f64; 4]; 4], spacing: f64) -> Bounds {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut x, mut y, mut xx, mut yy, mut xy) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for i in 0..4 {
        for j in 0..4 {
            low = low.min(b[i][j]);
            high = high.max(b[i][j]);
            if i < 3 {
                x = x.max((b[i + 1][j] - b[i][j]).abs());
                y = y.max((b[j][i + 1] - b[j][i]).abs());
            }
            if i < 2 {
                xx = xx.max((b[i + 2][j] - 2.0 * b[i + 1][j] + b[i][j]).abs());
                yy = yy.max((b[j][i + 2] - 2.0 * b[j][i + 1] + b[j][i]).abs());
            }
            if i < 3 && j < 3 {
                xy = xy.max((b[i + 1][j + 1] - b[i][j + 1] - b[i + 1][j] + b[i][j]).abs());
            }
        }
    }
    let (per, square) = (1.0 / spacing, 1.0 / (spacing * spacing));
    let slope = 3.0 * per * (x * x + y * y).sqrt();
    // The largest eigenvalue of a symmetric matrix is at most its larger diagonal plus the off-diagonal.
    let bend = square * (6.0 * xx.max(yy) + 9.0 * xy);
    Bounds { low, high, slope, bend }
}
