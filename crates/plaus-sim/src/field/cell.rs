//! One cell of a spline: its polynomial, and bounds on it.

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

/// Bounds over a region.
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
    /// The bounds of an empty region.
    pub const NONE: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY, slope: 0.0, bend: 0.0 };

    /// Bounds that hold in both regions.
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

/// Control values over a cell, the second index along y.
pub(super) type Values = [[f64; 4]; 4];

/// A cell: its bounds are computed at once, its polynomial when it is first evaluated. Most cells are only passed over.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    /// Control values; once it is prepared, coefficients: those of `vᵇ` in row `b`, from `u⁰` to `u³`.
    numbers: [Lanes; 4],
    is_ready: bool,
    pub(super) bounds: Bounds,
}

/// Four numbers processed together.
type Lanes = [f64; 4];

#[inline]
fn scaled(by: f64, p: &Lanes) -> Lanes {
    [by * p[0], by * p[1], by * p[2], by * p[3]]
}

#[inline]
fn plus(a: &Lanes, b: &Lanes) -> Lanes {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
}

/// Coefficients of `u⁰` to `u³` from four control values, in each lane.
#[inline]
fn to_power(p: &[Lanes; 4]) -> [Lanes; 4] {
    let sixth = |k: usize| scaled(1.0 / 6.0, &p[k]);
    let half = |k: usize| scaled(0.5, &p[k]);
    let minus = |by: f64, k: usize| scaled(-by, &p[k]);
    [
        plus(&plus(&sixth(0), &scaled(4.0 / 6.0, &p[1])), &sixth(2)),
        plus(&minus(0.5, 0), &half(2)),
        plus(&plus(&half(0), &minus(1.0, 1)), &half(2)),
        plus(&plus(&plus(&minus(1.0 / 6.0, 0), &half(1)), &minus(0.5, 2)), &sixth(3)),
    ]
}

/// Bernstein coefficients from four control values, in each lane.
#[inline]
fn to_bernstein(p: &[Lanes; 4]) -> [Lanes; 4] {
    let thirds = |two: usize, one: usize| [scaled(2.0 / 3.0, &p[two]), scaled(1.0 / 3.0, &p[one])];
    let ([a, b], [d, c]) = (thirds(1, 2), thirds(2, 1));
    let end =
        |k: usize| plus(&plus(&scaled(1.0 / 6.0, &p[k]), &scaled(4.0 / 6.0, &p[k + 1])), &scaled(1.0 / 6.0, &p[k + 2]));
    [end(0), plus(&a, &b), plus(&c, &d), end(1)]
}

#[inline]
fn transposed(p: &[Lanes; 4]) -> [Lanes; 4] {
    let column = |k: usize| [p[0][k], p[1][k], p[2][k], p[3][k]];
    [column(0), column(1), column(2), column(3)]
}

impl Cell {
    /// The cell over control values `points[a][b]`.
    pub(super) fn new(points: &Values, spacing: f64) -> Self {
        let along_y = to_bernstein(&transposed(&to_bernstein(points)));
        Self { numbers: *points, is_ready: false, bounds: bounds(&along_y, spacing) }
    }

    /// Computes the polynomial; to be called before the first evaluation.
    #[inline]
    pub(super) fn prepare(&mut self) {
        if !self.is_ready {
            self.numbers = to_power(&transposed(&to_power(&self.numbers)));
            self.is_ready = true;
        }
    }

    /// Values of the polynomials in `v` whose coefficients the lanes hold.
    #[inline]
    fn along(&self, v: f64) -> Lanes {
        let c = &self.numbers;
        plus(&c[0], &scaled(v, &plus(&c[1], &scaled(v, &plus(&c[2], &scaled(v, &c[3]))))))
    }

    /// Their derivatives.
    #[inline]
    fn slopes(&self, v: f64) -> Lanes {
        let c = &self.numbers;
        plus(&c[1], &scaled(v, &plus(&scaled(2.0, &c[2]), &scaled(v, &scaled(3.0, &c[3])))))
    }

    /// Value and derivatives; `per` is 1/spacing.
    #[inline]
    pub(super) fn at(&self, u: f64, v: f64, per: f64) -> Sample {
        let c = &self.numbers;
        let bends = plus(&scaled(2.0, &c[2]), &scaled(v, &scaled(6.0, &c[3])));
        let (along, across) = (horner(&self.along(v), u), horner(&self.slopes(v), u));
        let yy = bends[0] + u * (bends[1] + u * (bends[2] + u * bends[3]));
        Sample {
            value: along[0],
            slope: [along[1] * per, across[0] * per],
            bend: [along[2] * per * per, across[1] * per * per, yy * per * per],
        }
    }

    /// Value and first derivatives, the same bits as those of [`at`](Self::at).
    #[inline]
    pub(super) fn slope_at(&self, u: f64, v: f64, per: f64) -> (f64, [f64; 2]) {
        let (along, across) = (horner(&self.along(v), u), horner(&self.slopes(v), u));
        (along[0], [along[1] * per, across[0] * per])
    }

    #[inline]
    pub(super) fn value(&self, u: f64, v: f64) -> f64 {
        let row = self.along(v);
        row[0] + u * (row[1] + u * (row[2] + u * row[3]))
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

/// Bounds from Bernstein coefficients, with the first index along y.
fn bounds(b: &[Lanes; 4], spacing: f64) -> Bounds {
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
                xy = xy.max((b[i + 1][j + 1] - b[i + 1][j] - b[i][j + 1] + b[i][j]).abs());
            }
        }
    }
    let (per, square) = (1.0 / spacing, 1.0 / (spacing * spacing));
    let slope = 3.0 * per * (x * x + y * y).sqrt();
    // The largest eigenvalue of a symmetric matrix is at most its larger diagonal plus the off-diagonal.
    let bend = square * (6.0 * xx.max(yy) + 9.0 * xy);
    Bounds { low, high, slope, bend }
}
