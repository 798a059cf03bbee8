//! A lazily realised spline field.

use super::cell::{Bounds, Cell, Sample, Values};
use super::lookup::Lookup;
use crate::error::WorldError;
use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;

/// Where the control points are: `(i, j)` at `origin + spacing · (i, j)`, endlessly in all directions.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Grid {
    /// Control point (0, 0), in m.
    pub origin: [f64; 2],
    /// Distance of neighbours, in m.
    pub spacing: f64,
}

/// A field over the plane. It can be sent to another thread, but two threads cannot evaluate it at once: each chain has
/// its own.
#[derive(Clone)]
pub struct Spline {
    name: &'static str,
    grid: Grid,
    range: [f64; 2],
    source: Arc<dyn Fn(i64, i64) -> f64 + Send + Sync>,
    made: RefCell<Made>,
}

/// A set of control points.
#[derive(Debug, Clone, Default)]
pub struct Points(Lookup);

impl Points {
    /// Whether a point is among them.
    #[must_use]
    pub fn has(&self, key: [i64; 2]) -> bool {
        self.0.get(key).is_some()
    }

    /// All of them, in order of their indices.
    #[must_use]
    pub fn in_order(&self) -> Vec<[i64; 2]> {
        let mut keys: Vec<[i64; 2]> = self.0.keys().collect();
        keys.sort_unstable();
        keys
    }
}

/// Everything computed so far.
#[derive(Clone, Default)]
struct Made {
    point_places: Lookup,
    points: Vec<([i64; 2], f64)>,
    cell_places: Lookup,
    cells: Vec<Cell>,
    /// The cells last evaluated, by the low bits of their indices.
    recent: [Option<([i64; 2], u32)>; RECENT],
    /// The last rectangle of cells for which bounds were asked.
    window: Option<([[i64; 2]; 2], Bounds)>,
    fault: Option<([i64; 2], f64)>,
}

impl fmt::Debug for Spline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Spline {{ name: {:?}, grid: {:?}, touched: {} }}", self.name, self.grid, self.touched_count())
    }
}

impl Spline {
    /// A field whose control values come from `source(i, j)`, a pure function with values in `range`. That promise is
    /// checked whenever a point is made. Tight ranges make detection faster; ±8σ is fine for a Gaussian.
    ///
    /// # Errors
    /// [`WorldError::BadNumber`] if the spacing is not positive or a number is not finite.
    pub fn new(
        name: &'static str,
        grid: Grid,
        range: [f64; 2],
        source: impl Fn(i64, i64) -> f64 + Send + Sync + 'static,
    ) -> Result<Self, WorldError> {
        if !(grid.spacing > 0.0 && grid.spacing.is_finite()) {
            return Err(WorldError::BadNumber {
                field: "grid spacing",
                value: grid.spacing,
                expected: "a positive length",
            });
        }
        for value in [grid.origin[0], grid.origin[1], range[0], range[1]] {
            if !value.is_finite() {
                return Err(WorldError::BadNumber { field: "grid origin or range", value, expected: "finite numbers" });
            }
        }
        if range[0] > range[1] {
            return Err(WorldError::BadNumber {
                field: "range",
                value: range[0],
                expected: "a lower end that is not above the upper",
            });
        }
        Ok(Self { name, grid, range, source: Arc::new(source), made: RefCell::default() })
    }

    /// The grid.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The range of all control values, and therefore of the field.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        self.range
    }

    /// The first control value that was not finite or out of range, if any. The nearer end of the range was used in its
    /// place (or the middle, for NaN).
    #[must_use]
    pub fn fault(&self) -> Option<WorldError> {
        let (key, value) = self.made.borrow().fault?;
        Some(WorldError::BadControlPoint { field: self.name, i: key[0], j: key[1], value })
    }

    /// Whether a control value was bad.
    #[inline]
    #[must_use]
    pub fn is_faulty(&self) -> bool {
        self.made.borrow().fault.is_some()
    }

    #[inline]
    fn locate(&self, x: f64, y: f64) -> ([i64; 2], f64, f64) {
        let (u, v) = ((x - self.grid.origin[0]) / self.grid.spacing, (y - self.grid.origin[1]) / self.grid.spacing);
        let (i, j) = (floor(u), floor(v));
        ([i, j], u - i as f64, v - j as f64)
    }

    /// Value and derivatives at a point.
    #[inline]
    #[must_use]
    pub fn at(&self, x: f64, y: f64) -> Sample {
        let (key, u, v) = self.locate(x, y);
        let made = &mut *self.made.borrow_mut();
        let place = self.cell(made, key);
        made.cells[place as usize].at(u, v, 1.0 / self.grid.spacing)
    }

    /// Value and derivatives along x and y at a point.
    #[inline]
    #[must_use]
    pub fn slope_at(&self, x: f64, y: f64) -> (f64, [f64; 2]) {
        let (key, u, v) = self.locate(x, y);
        let made = &mut *self.made.borrow_mut();
        let place = self.cell(made, key);
        made.cells[place as usize].slope_at(u, v, 1.0 / self.grid.spacing)
    }

    /// Value at a point.
    #[inline]
    #[must_use]
    pub fn value(&self, x: f64, y: f64) -> f64 {
        let (key, u, v) = self.locate(x, y);
        let made = &mut *self.made.borrow_mut();
        let place = self.cell(made, key);
        made.cells[place as usize].value(u, v)
    }

    /// Bounds over a rectangle. All the cells that meet it are made, up to [`MOST_CELLS`]; beyond that the result is
    /// `None`.
    #[must_use]
    pub fn bounds(&self, min: [f64; 2], max: [f64; 2]) -> Option<Bounds> {
        let (low, ..) = self.locate(min[0], min[1]);
        let (high, ..) = self.locate(max[0], max[1]);
        let count =
            (high[0].checked_sub(low[0])?.checked_add(1)?).checked_mul(high[1].checked_sub(low[1])?.checked_add(1)?)?;
        if !(1..=MOST_CELLS).contains(&count) {
            return None;
        }
        let made = &mut *self.made.borrow_mut();
        if let Some((cells, bounds)) = made.window
            && cells == [low, high]
        {
            return Some(bounds);
        }
        let (mut all, mut near) = (Bounds::NONE, None);
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                let place = match made.cell_places.get([i, j]) {
                    Some(place) => place,
                    None => self.add(made, [i, j], &mut near),
                };
                all = all.and(&made.cells[place as usize].bounds);
            }
        }
        made.window = Some(([low, high], all));
        Some(all)
    }

    /// The control points on which the value at a point depends.
    #[must_use]
    pub fn support(&self, x: f64, y: f64) -> [[i64; 2]; 16] {
        let ([i, j], ..) = self.locate(x, y);
        std::array::from_fn(|k| [i - 1 + (k / 4) as i64, j - 1 + (k % 4) as i64])
    }

    /// All control points made so far with their values, in order of their indices.
    #[must_use]
    pub fn touched(&self) -> Vec<([i64; 2], f64)> {
        let mut points = self.made.borrow().points.clone();
        points.sort_unstable_by_key(|p| p.0);
        points
    }

    /// How many control points have been made.
    #[must_use]
    pub fn touched_count(&self) -> usize {
        self.made.borrow().points.len()
    }

    /// Forgets everything computed so far, and returns the control points that were used: nothing else of the field had
    /// any influence on the results.
    pub fn take_touched(&mut self) -> Points {
        Points(std::mem::take(self.made.get_mut()).point_places)
    }

    /// Memory used so far, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let made = self.made.borrow();
        made.point_places.bytes()
            + made.cell_places.bytes()
            + size_of_val(&made.points[..])
            + size_of_val(&made.cells[..])
    }

    /// Gives one control point another value; cells that depend on it are computed again. The source is not asked for
    /// this point again.
    pub fn set(&mut self, key: [i64; 2], value: f64) {
        let made = &mut *self.made.borrow_mut();
        let value = checked(self.range, made, key, value);
        made.window = None;
        made.recent = [None; RECENT];
        match made.point_places.get(key) {
            Some(place) => made.points[place as usize].1 = value,
            None => made.push_point(key, value),
        }
        for k in 0..16_i64 {
            let cell = [key[0] + 1 - k / 4, key[1] + 1 - k % 4];
            if let Some(place) = made.cell_places.get(cell) {
                made.cells[place as usize] = Cell::new(&self.points(made, cell, None), self.grid.spacing);
            }
        }
    }

    #[inline]
    fn cell(&self, made: &mut Made, key: [i64; 2]) -> u32 {
        let slot = (key[0] & 3) as usize * 4 + (key[1] & 3) as usize;
        match made.recent[slot] {
            Some((last, place)) if last == key => place,
            _ => {
                let place = made.cell_places.get(key).unwrap_or_else(|| self.add(made, key, &mut None));
                made.cells[place as usize].prepare();
                made.recent[slot] = Some((key, place));
                place
            }
        }
    }

    /// Makes a cell. `near` holds the control values of the last cell made here, with which a neighbour shares three
    /// rows.
    #[cold]
    fn add(&self, made: &mut Made, key: [i64; 2], near: &mut Option<([i64; 2], Values)>) -> u32 {
        let points = self.points(made, key, near.take());
        let cell = Cell::new(&points, self.grid.spacing);
        *near = Some((key, points));
        let place = made.cells.len() as u32;
        made.cells.push(cell);
        made.cell_places.insert(key, place);
        place
    }

    /// The control values over a cell.
    fn points(&self, made: &mut Made, [i, j]: [i64; 2], near: Option<([i64; 2], Values)>) -> Values {
        let mut points = [[0.0; 4]; 4];
        // The number of points known, first along x and then along y.
        let known = match near {
            Some((key, last)) if key == [i, j.wrapping_sub(1)] => {
                for (row, last) in points.iter_mut().zip(&last) {
                    row[..3].copy_from_slice(&last[1..]);
                }
                [0, 3]
            }
            Some((key, last)) if key == [i.wrapping_sub(1), j] => {
                points[..3].copy_from_slice(&last[1..]);
                [3, 0]
            }
            _ => [0, 0],
        };
        for (a, row) in points.iter_mut().enumerate().skip(known[0]) {
            for (b, p) in row.iter_mut().enumerate().skip(known[1]) {
                *p = self.point(made, [i.saturating_add(a as i64 - 1), j.saturating_add(b as i64 - 1)]);
            }
        }
        points
    }

    fn point(&self, made: &mut Made, key: [i64; 2]) -> f64 {
        if let Some(place) = made.point_places.get(key) {
            return made.points[place as usize].1;
        }
        let value = checked(self.range, made, key, (self.source)(key[0], key[1]));
        made.push_point(key, value);
        value
    }
}

/// Cells kept at hand: four by four, as many as a die covers whose edge is as long as two cells.
const RECENT: usize = 16;

/// The largest whole number not above `x`, by a cast: calling the library is slower on processors without an
/// instruction for it.
#[inline]
fn floor(x: f64) -> i64 {
    let i = x as i64;
    if i as f64 > x { i.saturating_sub(1) } else { i }
}

/// The value, or a replacement for one that breaks the promise, which is noted.
fn checked([low, high]: [f64; 2], made: &mut Made, key: [i64; 2], value: f64) -> f64 {
    if value >= low && value <= high {
        return value;
    }
    made.fault.get_or_insert((key, value));
    if value.is_nan() { 0.5 * (low + high) } else { value.clamp(low, high) }
}

impl Made {
    fn push_point(&mut self, key: [i64; 2], value: f64) {
        self.point_places.insert(key, self.points.len() as u32);
        self.points.push((key, value));
    }
}

/// Maximum number of cells that one request for bounds may make. Default 4096, a square of 64 by 64 cells; larger
/// footprints are requested in pieces.
pub const MOST_CELLS: i64 = 4096;
