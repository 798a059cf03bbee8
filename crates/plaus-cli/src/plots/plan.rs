//! Where things end, over the plan of the scene, as text and as SVG.

use super::values::{Place, Values};
use crate::svg::{Frame, PANEL, Svg};
use plaus_export::mesh;
use plaus_scenes::animation::Animation;

/// Most dots in a picture: of more places an even choice.
const MOST: usize = 5000;
/// Most columns and rows of a plan on a terminal. A character is about twice as high as it is wide.
const CELLS: [usize; 2] = [64, 24];
/// Scenery longer than this many times the range of the places does not widen the plan.
const LARGE: f64 = 4.0;

/// Metres in a unit of length.
fn metres(unit: &str) -> Option<f64> {
    [("mm", 1e-3), ("cm", 1e-2), ("m", 1.0)].into_iter().find(|(name, _)| *name == unit).map(|(_, metres)| metres)
}

/// The plan of a scene with the places where its things end.
pub(crate) struct Plan {
    names: Vec<String>,
    unit: &'static str,
    /// For each thing, its places.
    places: Vec<Vec<[f64; 2]>>,
    /// The outlines of scenery from above.
    outlines: Vec<Vec<[f64; 2]>>,
    /// The ranges of x and y, with the same scale.
    range: [[f64; 2]; 2],
}

impl Plan {
    /// The places of things, whose coordinates follow each other in `values`, over the scenery of `animation`.
    pub(crate) fn new(places: &[Place], unit: &'static str, values: &Values, animation: &Animation) -> Self {
        let stride = values.rows.len().div_ceil(MOST).max(1);
        let of_thing = |thing: usize| -> Vec<[f64; 2]> {
            let rows = values.rows.iter().step_by(stride).map(|(_, row)| [row[2 * thing], row[2 * thing + 1]]);
            rows.filter(|place| place.iter().all(|x| x.is_finite())).collect()
        };
        let all: Vec<Vec<[f64; 2]>> = (0..places.len()).map(of_thing).collect();
        let outlines = metres(unit).map_or(Vec::new(), |metres| outlines(animation, metres));
        let range = range(&all, &outlines);
        Self { names: places.iter().map(|place| place.name.clone()).collect(), unit, places: all, outlines, range }
    }

    /// A letter for each thing; the more of its places in a cell, the more it stands out.
    pub(crate) fn in_words(&self) -> String {
        let [x, y] = self.range;
        let (wide, high) = (x[1] - x[0], y[1] - y[0]);
        let cell = (wide / CELLS[0] as f64).max(high / (2.0 * CELLS[1] as f64));
        let [columns, rows] = [(wide / cell).ceil() as usize, (0.5 * high / cell).ceil() as usize].map(|n| n.max(1));
        let mut counts = vec![0_usize; columns * rows];
        for [at_x, at_y] in self.places.iter().flatten() {
            let column = (((at_x - x[0]) / cell) as usize).min(columns - 1);
            let row = (((y[1] - at_y) / (2.0 * cell)) as usize).min(rows - 1);
            counts[row * columns + column] += 1;
        }
        let most = counts.iter().max().copied().unwrap_or(0).max(1) as f64;
        let shade = |&count: &usize| match count {
            0 => ' ',
            _ => ['.', ':', 'o', 'O', '@'][((5.0 * (count as f64 / most).sqrt()).ceil() as usize).clamp(1, 5) - 1],
        };
        let line = |row: &[usize]| format!("  |{}|\n", row.iter().map(shade).collect::<String>());
        let edge = format!("  +{}+\n", "-".repeat(columns));
        let middle: String = counts.chunks(columns).map(line).collect();
        let [x, y] = [x, y].map(|[low, high]| format!("{} to {}", round(low, cell), round(high, cell)));
        format!("{edge}{middle}{edge}  across: x from {x} {unit}; up: y from {y} {unit}\n", unit = self.unit)
    }

    /// A dot for each place, over the outlines of the scenery.
    pub(crate) fn picture(&self) -> String {
        let [x, y] = self.range;
        let legend = if self.names.len() > 1 { 26.0 * self.names.len() as f64 } else { 0.0 };
        // The frame is as high as its scale asks for.
        let size = [PANEL[0] * 1.6, 0.0];
        let frame = Frame::to_scale(x, y, size[0]);
        let mut svg = Svg::new(size[0] as usize, (frame.height() + legend) as usize);
        svg.axes(&frame, &format!("where they end: y ({}) over x ({})", self.unit, self.unit), "seen from above");
        svg.clipped(&frame, |svg| {
            self.outlines.iter().for_each(|outline| svg.outline(&frame, outline));
            for (number, places) in self.places.iter().enumerate() {
                places.iter().for_each(|place| svg.dot(&frame, number, *place));
            }
        });
        if legend > 0.0 {
            for (number, name) in self.names.iter().enumerate() {
                svg.legend(number, frame.height() + 26.0 * number as f64, name);
            }
        }
        svg.finish()
    }
}

/// A number to a step's last digit.
fn round(value: f64, step: f64) -> String {
    let steps = [1.0, 0.1, 0.01, 1e-3, 1e-4, 1e-5];
    let digits = steps.iter().position(|&least| step >= least).unwrap_or(steps.len());
    format!("{value:.digits$}")
}

/// The outlines of all scenery, seen from above, in units of so many metres.
fn outlines(animation: &Animation, metres: f64) -> Vec<Vec<[f64; 2]>> {
    let of_prop = |prop: &plaus_scenes::animation::Prop| {
        let part = mesh::of_form(&prop.form, prop.look);
        // Animations have y up, scenarios z: what is y in a scenario is −z in an animation.
        let flat = |at: &[f32; 3]| [f64::from(at[0]) / metres, -f64::from(at[2]) / metres];
        hull(part.mesh.positions.iter().map(flat).collect())
    };
    animation.scenery.iter().map(of_prop).filter(|outline| outline.len() > 2).collect()
}

/// The convex hull of points in the plane, counter-clockwise (Andrew 1979).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..] {
                if turn(a, b, point) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut all = half(&mut points.iter().copied());
    all.extend(half(&mut points.iter().rev().copied()));
    all
}

/// The smallest ranges of x and y that hold all places, and the scenery that is not much larger than they spread.
fn range(places: &[Vec<[f64; 2]>], outlines: &[Vec<[f64; 2]>]) -> [[f64; 2]; 2] {
    let around = |points: &mut dyn Iterator<Item = &[f64; 2]>| {
        points.fold([[f64::INFINITY, f64::NEG_INFINITY]; 2], |range, point| {
            [0, 1].map(|axis: usize| [range[axis][0].min(point[axis]), range[axis][1].max(point[axis])])
        })
    };
    let size = |range: [[f64; 2]; 2]| range.map(|[low, high]| high - low).into_iter().fold(0.0, f64::max);
    let mut range = around(&mut places.iter().flatten());
    if !size(range).is_finite() {
        return [[0.0, 1.0]; 2];
    }
    let spread = size(range).max(1e-9);
    for outline in outlines {
        let own = around(&mut outline.iter());
        if size(own) < LARGE * spread {
            range = around(&mut range_corners(range).iter().chain(&range_corners(own)));
        }
    }
    let room = 0.04 * size(range).max(1e-9);
    range.map(|[low, high]| [low - room, high + room])
}

fn range_corners([x, y]: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [[x[0], y[0]], [x[1], y[1]]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_have_the_corners_alone() {
        let grid = (0..5).flat_map(|x| (0..5).map(move |y| [f64::from(x), f64::from(y)])).collect();
        assert_eq!(hull(grid), [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]);
    }

    #[test]
    fn a_large_floor_does_not_widen_the_plan_and_a_table_does() {
        let places = [vec![[0.0, 0.0], [1.0, 0.5]]];
        let square = |half: f64| vec![[-half, -half], [half, -half], [half, half], [-half, half]];
        let small = range(&places, &[square(50.0)]);
        assert!(small[0][1] < 1.1 && small[1][0] > -0.1, "{small:?}");
        let wide = range(&places, &[square(50.0), square(1.5)]);
        assert!(wide[0][1] > 1.5 && wide[1][0] < -1.5, "{wide:?}");
    }
}
