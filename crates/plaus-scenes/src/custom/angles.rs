//! Angles by which throws are turned: so many that none is special, and how likely each is, by cells.

use glam::DVec2;
use plaus_dist::stream::below;
use plaus_dist::{Stream, math};
use plaus_mcmc::library::one_of;

/// Cells into which angles are divided, and angles in each: a throw is turned by one of so many angles.
const CELLS: usize = 32;
pub(super) const EACH: u64 = 1 << 15;
/// How many angles there are.
pub(super) const ANGLES: u64 = CELLS as u64 * EACH;
/// Share of throws that are turned by any angle.
const ANY: f64 = 0.05;
/// A turn about the vertical.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    /// In rad.
    pub(super) angle: f64,
    sin: f64,
    cos: f64,
}

impl Turn {
    pub(super) fn by(angle: f64) -> Self {
        let (sin, cos) = math::sin_cos(angle);
        Self { angle, sin, cos }
    }

    /// The opposite.
    pub(super) fn back(self) -> Self {
        Self { angle: -self.angle, sin: -self.sin, ..self }
    }

    /// A vector turned.
    pub(super) fn of(self, vector: DVec2) -> DVec2 {
        DVec2::new(self.cos, self.sin).rotate(vector)
    }
}

/// Probabilities of cells by the logarithms of their weights; each has some.
fn shares(logs: &[f64]) -> Vec<f64> {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let of = |log: f64| if most == f64::NEG_INFINITY { 1.0 } else { math::exp(log - most) };
    let weights: Vec<f64> = logs.iter().map(|&log| of(log)).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|weight| (1.0 - ANY) * weight / sum + ANY / CELLS as f64).collect()
}

/// How likely each angle is, by cells; `None` if throws are not turned.
#[derive(Debug)]
pub(super) struct Angles(Option<Vec<f64>>);

impl Angles {
    /// None, where throws are not turned.
    pub(super) const NONE: Self = Self(None);

    /// By the logarithms of the weights of cells.
    pub(super) fn new(logs: &[f64]) -> Self {
        Self(Some(shares(logs)))
    }

    /// One of them, by its number.
    pub(super) fn sample(&self, stream: &mut Stream) -> u64 {
        let Some(cells) = &self.0 else { return 0 };
        let cell = one_of(cells.iter().copied(), stream).unwrap_or(CELLS - 1);
        cell as u64 * EACH + below(stream, EACH as usize) as u64
    }

    /// Log probability of one of them.
    pub(super) fn log(&self, angle: u64) -> f64 {
        self.0.as_ref().map_or(0.0, |cells| math::ln(cells[(angle / EACH) as usize] / EACH as f64))
    }
}

/// An angle by its number, of those between `span` and its opposite.
pub(super) fn angle_of(span: f64, angle: u64) -> f64 {
    span * (2.0 * (angle as f64 + 0.5) / ANGLES as f64 - 1.0)
}

/// The turns in the middle of all cells.
pub(super) fn cells_of(span: f64) -> Vec<Turn> {
    (0..CELLS as u64).map(|cell| Turn::by(angle_of(span, cell * EACH + EACH / 2))).collect()
}
