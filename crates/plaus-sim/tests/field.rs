//! Spline fields: values against the plain formula, derivatives, bounds, laziness, faults.

use plaus_sim::WorldError;
use plaus_sim::field::{Grid, Spline};
use proptest::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const SPACING: f64 = 0.25;
const GRID: Grid = Grid { origin: [0.5, -0.25], spacing: SPACING };

/// Numbers in [-1, 1] that look random.
fn noise(i: i64, j: i64) -> f64 {
    let mut h = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (j as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    h ^= h >> 31;
    h = h.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (h >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn field() -> Spline {
    Spline::new("height", GRID, [-1.0, 1.0], noise).unwrap()
}

/// The formula of the module's documentation, summed plainly.
fn plain(x: f64, y: f64) -> f64 {
    let basis = |u: f64| {
        let w = 1.0 - u;
        [
            w * w * w / 6.0,
            (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
            (-3.0 * u * u * u + 3.0 * u * u + 3.0 * u + 1.0) / 6.0,
            u * u * u / 6.0,
        ]
    };
    let (u, v) = ((x - GRID.origin[0]) / SPACING, (y - GRID.origin[1]) / SPACING);
    let (i, j) = (u.floor(), v.floor());
    let (bu, bv) = (basis(u - i), basis(v - j));
    let mut sum = 0.0;
    for (a, wu) in bu.iter().enumerate() {
        for (b, wv) in bv.iter().enumerate() {
            sum += wu * wv * noise(i as i64 + a as i64 - 1, j as i64 + b as i64 - 1);
        }
    }
    sum
}

proptest! {
    /// 1e-14: sixteen products of numbers below 1.
    #[test]
    fn value_is_the_formula(x in -5.0..5.0_f64, y in -5.0..5.0_f64) {
        let f = field();
        prop_assert!((f.value(x, y) - plain(x, y)).abs() < 1e-14);
        prop_assert_eq!(f.value(x, y), f.at(x, y).value);
    }

    /// Central differences over h = 1e-4 spacings: truncation h² f‴/6 is below 1e-6 of the derivatives' scale
    /// 1/spacing, rounding below 1e-11.
    #[test]
    fn derivatives_agree_with_differences(x in -5.0..5.0_f64, y in -5.0..5.0_f64) {
        let (f, h) = (field(), 1e-4 * SPACING);
        let s = f.at(x, y);
        let (px, mx, py, my) = (f.at(x + h, y), f.at(x - h, y), f.at(x, y + h), f.at(x, y - h));
        let scale = 1.0 / SPACING;
        prop_assert!(((px.value - mx.value) / (2.0 * h) - s.slope[0]).abs() < 1e-6 * scale);
        prop_assert!(((py.value - my.value) / (2.0 * h) - s.slope[1]).abs() < 1e-6 * scale);
        // The second derivative is continuous but has kinks at the grid lines, so the error there is of first order in
        // h.
        let tolerance = 1e-2 * scale * scale;
        prop_assert!(((px.slope[0] - mx.slope[0]) / (2.0 * h) - s.bend[0]).abs() < tolerance);
        prop_assert!(((py.slope[0] - my.slope[0]) / (2.0 * h) - s.bend[1]).abs() < tolerance);
        prop_assert!(((py.slope[1] - my.slope[1]) / (2.0 * h) - s.bend[2]).abs() < tolerance);
    }

    #[test]
    fn bounds_hold(
        x in -5.0..5.0_f64,
        y in -5.0..5.0_f64,
        w in 0.0..1.0_f64,
        d in 0.0..1.0_f64,
        u in 0.0..1.0_f64,
        v in 0.0..1.0_f64,
    ) {
        let f = field();
        let b = f.bounds([x, y], [x + w, y + d]).unwrap();
        let s = f.at(x + u * w, y + v * d);
        let slack = 1.0 + 1e-12;
        prop_assert!(b.low <= s.value + 1e-12 && s.value <= b.high + 1e-12);
        prop_assert!(s.slope[0].hypot_of(s.slope[1]) <= b.slope * slack);
        let mean = 0.5 * (s.bend[0] + s.bend[2]);
        let half = (0.5 * (s.bend[0] - s.bend[2])).hypot_of(s.bend[1]);
        prop_assert!(mean.abs() + half <= b.bend * slack);
    }
}

trait Hypot {
    fn hypot_of(self, other: f64) -> f64;
}

impl Hypot for f64 {
    fn hypot_of(self, other: f64) -> f64 {
        (self * self + other * other).sqrt()
    }
}

#[test]
fn the_basis_sums_to_one_and_keeps_planes() {
    let f = Spline::new("plane", GRID, [-100.0, 100.0], |i, j| 2.0 * i as f64 - 3.0 * j as f64).unwrap();
    let s = f.at(1.1, 2.3);
    // Rounding of values of about 30.
    assert!((s.value - (2.0 * (1.1 - 0.5) - 3.0 * (2.3 + 0.25)) / SPACING).abs() < 1e-12);
    assert!((s.slope[0] - 8.0).abs() < 1e-12 && (s.slope[1] + 12.0).abs() < 1e-12);
    assert!(s.bend.iter().all(|b| b.abs() < 1e-11));
}

#[test]
fn each_point_is_asked_for_once_and_only_where_touched() {
    let asked = Arc::new(AtomicUsize::new(0));
    let count = Arc::clone(&asked);
    let f = Spline::new("height", GRID, [-1.0, 1.0], move |i, j| {
        count.fetch_add(1, Ordering::Relaxed);
        noise(i, j)
    })
    .unwrap();
    assert_eq!(asked.load(Ordering::Relaxed), 0);
    for k in 0..100 {
        let _ = f.at(0.51 + 0.002 * f64::from(k), -0.24);
    }
    assert_eq!((asked.load(Ordering::Relaxed), f.touched_count()), (16, 16));
    let _ = f.at(0.51 + SPACING, -0.24);
    assert_eq!(asked.load(Ordering::Relaxed), 20);
    let touched = f.touched();
    assert!(touched.windows(2).all(|w| w[0].0 < w[1].0));
    assert!(f.support(0.51, -0.24).iter().all(|k| touched.iter().any(|t| t.0 == *k)));
}

#[test]
fn a_large_table_costs_only_what_is_touched() {
    let f = field();
    // A path right across a table of 1000 × 1000 points.
    for k in 0..100 {
        let _ = f.at(0.5 + SPACING * 10.0 * f64::from(k), -0.25 + SPACING * 10.0 * f64::from(k));
    }
    assert_eq!(f.touched_count(), 1600);
    assert!(f.bytes() < 200_000, "{} bytes; the whole table would take 8,000,000", f.bytes());
}

#[test]
fn setting_a_point_is_as_good_as_having_had_its_value() {
    let mut f = field();
    for k in 0..50 {
        let _ = f.at(0.1 * f64::from(k), 0.3);
    }
    f.set([3, 2], 0.75);
    let g = Spline::new("height", GRID, [-1.0, 1.0], |i, j| if (i, j) == (3, 2) { 0.75 } else { noise(i, j) }).unwrap();
    for k in 0..200 {
        let (x, y) = (0.02 * f64::from(k), 0.3 + 0.001 * f64::from(k));
        assert_eq!(f.at(x, y), g.at(x, y));
    }
}

#[test]
fn bad_values_are_typed_errors() {
    let f = Spline::new("friction", GRID, [0.0, 1.0], |i, _| if i == 2 { f64::NAN } else { 0.5 }).unwrap();
    let _ = f.at(-3.0, 0.0);
    assert!(f.fault().is_none());
    let here = f.at(GRID.origin[0] + 2.5 * SPACING, 0.0);
    assert!(here.value.is_finite());
    assert!(
        matches!(f.fault(), Some(WorldError::BadControlPoint { field: "friction", i: 2, value, .. }) if value.is_nan())
    );
    let g = Spline::new("restitution", GRID, [0.0, 1.0], |_, _| 1.5).unwrap();
    let _ = g.at(0.0, 0.0);
    assert!(g.is_faulty());
    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Spline::new("height", Grid { origin: [0.0; 2], spacing }, [0.0, 1.0], |_, _| 0.0).is_err());
    }
    assert!(Spline::new("height", GRID, [1.0, 0.0], |_, _| 0.0).is_err());
    assert!(f.bounds([-1e300, 0.0], [1e300, 0.0]).is_none());
}
