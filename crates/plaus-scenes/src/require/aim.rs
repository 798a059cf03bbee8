//! Where requirements want bodies to end, for moves that lead them there.

use glam::DVec3;
use plaus_dist::stream::below;
use plaus_dist::{Stream, math, open_unit};
use std::f64::consts::{PI, TAU};

/// What a requirement wants of a body's end.
#[derive(Debug, Clone, PartialEq)]
pub struct Aim {
    /// Name of the body; empty for the only one.
    pub body: String,
    /// What is wanted.
    pub end: End,
}

/// What is wanted of a body's end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// It lies in a zone, and, if so, at rest.
    In(Zone, bool),
    /// An axis in its own frame points up.
    Up(Up),
}

/// An axis that should point up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Up {
    /// The axis, in the body's frame.
    pub axis: DVec3,
    /// How far from upright it may be, in degrees.
    pub within: f64,
    /// How many degrees beyond that cost one nat.
    pub scale: f64,
}

impl Up {
    /// What it adds to the log density, for the direction in the body's frame that points up.
    #[must_use]
    pub fn log(&self, up: DVec3) -> f64 {
        let angle = math::acos(self.axis.dot(up).clamp(-1.0, 1.0)).to_degrees();
        ((self.within - angle) / self.scale).min(0.0)
    }
}

/// A level region with a scale: outside, each `scale` costs one nat. That makes a density, which can be drawn from; a
/// quarter of the draws are uniform inside, so that what only counts inside is found soon. Lengths are in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Zone {
    /// Around a place.
    Disc {
        /// The place.
        centre: [f64; 2],
        /// The radius.
        radius: f64,
        /// The scale.
        scale: f64,
    },
    /// Between ends along x, y or both; along the other axis it may be anywhere.
    Box {
        /// The ends.
        sides: [Option<[f64; 2]>; 2],
        /// The scale.
        scale: f64,
    },
}

/// Share of draws that are uniform inside.
const INSIDE: f64 = 0.25;

/// A length with density `e^(−x/scale) / scale`.
fn exponential(scale: f64, stream: &mut Stream) -> f64 {
    -scale * math::ln(open_unit(stream))
}

/// How far outside a region, if the line around it at distance d is `at_once + d × growth` long.
fn outside([at_once, growth]: [f64; 2], scale: f64, stream: &mut Stream) -> f64 {
    let first = exponential(scale, stream);
    let is_short = open_unit(stream) * (at_once + growth * scale) < at_once;
    if is_short { first } else { first + exponential(scale, stream) }
}

impl Zone {
    /// Along which axes it says where.
    #[must_use]
    pub fn leads(&self) -> [bool; 2] {
        match self {
            Self::Disc { .. } => [true; 2],
            Self::Box { sides, .. } => sides.map(|side| side.is_some()),
        }
    }

    /// Its middle, along the axes along which it says where.
    #[must_use]
    pub fn middle(&self) -> [Option<f64>; 2] {
        match self {
            Self::Disc { centre, .. } => centre.map(Some),
            Self::Box { sides, .. } => sides.map(|side| side.map(|[low, high]| 0.5 * (low + high))),
        }
    }

    /// A place; 0 along axes along which it may be anywhere.
    pub fn sample(&self, stream: &mut Stream) -> [f64; 2] {
        let is_inside = open_unit(stream) < INSIDE || open_unit(stream) * self.whole() < self.inside();
        match *self {
            Self::Disc { centre: [x, y], radius, scale } => {
                let r = if is_inside {
                    radius * open_unit(stream).sqrt()
                } else {
                    radius + outside([TAU * radius, TAU], scale, stream)
                };
                let (sin, cos) = math::sin_cos(TAU * open_unit(stream));
                [x + r * cos, y + r * sin]
            }
            Self::Box { sides: [Some(x), Some(y)], scale } => {
                let [a, b] = [x, y].map(|[low, high]| high - low);
                if is_inside {
                    return [x[0] + a * open_unit(stream), y[0] + b * open_unit(stream)];
                }
                let d = outside([2.0 * (a + b), 8.0], scale, stream);
                let [a, b] = [a + 2.0 * d, b + 2.0 * d];
                let along = 2.0 * (a + b) * open_unit(stream);
                let is_far = below(stream, 2) == 1;
                let place = if along < 2.0 * a {
                    [0.5 * along, if is_far { b } else { 0.0 }]
                } else {
                    [if is_far { a } else { 0.0 }, 0.5 * along - a]
                };
                [x[0] - d + place[0], y[0] - d + place[1]]
            }
            Self::Box { sides, scale } => {
                let along = |[low, high]: [f64; 2], stream: &mut Stream| {
                    if is_inside {
                        return low + (high - low) * open_unit(stream);
                    }
                    let d = exponential(scale, stream);
                    if below(stream, 2) == 1 { high + d } else { low - d }
                };
                sides.map(|side| side.map_or(0.0, |side| along(side, stream)))
            }
        }
    }

    /// Log density at a place, in mm along the axes along which it says where.
    #[must_use]
    pub fn log_density(&self, place: [f64; 2]) -> f64 {
        let depth = self.depth(place);
        if depth >= 0.0 { self.log_most() } else { depth / self.scale() + math::ln((1.0 - INSIDE) / self.whole()) }
    }

    /// The largest log density.
    #[must_use]
    pub fn log_most(&self) -> f64 {
        math::ln((1.0 - INSIDE) / self.whole() + INSIDE / self.inside())
    }

    /// Whether a place is inside.
    #[must_use]
    pub fn holds(&self, place: [f64; 2]) -> bool {
        self.depth(place) >= 0.0
    }

    /// How deep inside a place is.
    fn depth(&self, place: [f64; 2]) -> f64 {
        match self {
            Self::Disc { centre, radius, .. } => {
                radius - (math::square(place[0] - centre[0]) + math::square(place[1] - centre[1])).sqrt()
            }
            Self::Box { sides, .. } => {
                let ends = sides.iter().zip(place);
                ends.filter_map(|(side, x)| side.map(|[low, high]| (x - low).min(high - x)))
                    .fold(f64::INFINITY, f64::min)
            }
        }
    }

    fn scale(&self) -> f64 {
        match self {
            Self::Disc { scale, .. } | Self::Box { scale, .. } => *scale,
        }
    }

    /// Its area or length.
    fn inside(&self) -> f64 {
        match self {
            Self::Disc { radius, .. } => PI * math::square(*radius),
            Self::Box { sides, .. } => sides.iter().flatten().map(|[low, high]| high - low).product(),
        }
    }

    /// The same with what is outside, as much as it weighs.
    fn whole(&self) -> f64 {
        let (inside, scale) = (self.inside(), self.scale());
        inside
            + match self {
                Self::Disc { radius, .. } => TAU * scale * (radius + scale),
                Self::Box { sides: [Some(x), Some(y)], .. } => {
                    2.0 * scale * (x[1] - x[0] + y[1] - y[0]) + 8.0 * math::square(scale)
                }
                Self::Box { .. } => 2.0 * scale,
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_dist::{Purpose, Seed};

    /// Draws fall into cells as often as the density says, by a χ² test; and the density adds up to 1. With twice the
    /// scale it is caught.
    #[test]
    fn places_have_the_density_that_is_told() {
        let disc = |scale| Zone::Disc { centre: [3.0, -2.0], radius: 4.0, scale };
        let boxed = |scale| Zone::Box { sides: [Some([-3.0, 5.0]), Some([0.0, 3.0])], scale };
        let strip = |scale| Zone::Box { sides: [None, Some([-1.0, 4.0])], scale };
        for of in [&disc as &dyn Fn(f64) -> Zone, &boxed, &strip] {
            let zone = of(2.0);
            let mut stream = Seed(1).chain(0).at(0, Purpose::START);
            // Cells as wide as 2 mm, from −30 to 30 mm.
            const DRAWS: usize = 40_000;
            let mut counts = vec![0.0; 900];
            for _ in 0..DRAWS {
                let [x, y] = zone.sample(&mut stream).map(|x| ((x + 30.0) / 2.0).floor());
                if (0.0..30.0).contains(&x) && (0.0..30.0).contains(&y) {
                    counts[x as usize * 30 + y as usize] += 1.0;
                }
            }
            // The middle of 20 × 20 parts of a cell. The edge of the inside, where the density falls by less than half,
            // cuts 20 or 30 of them, half of which are counted too much and half too little.
            let share = |zone: &Zone, cell: usize| {
                let at = |k: usize, part: usize| -30.0 + 2.0 * k as f64 + 0.1 * (part as f64 + 0.5);
                let parts = (0..400).map(|part| [at(cell / 30, part / 20), at(cell % 30, part % 20)]);
                let is_line = zone.leads() == [false, true];
                let sum: f64 = parts.map(|place| math::exp(zone.log_density(place))).sum();
                if is_line { if cell / 30 == 15 { sum * 0.1 / 20.0 } else { 0.0 } } else { sum * 0.01 }
            };
            let off = |zone: &Zone| {
                let shares: Vec<f64> = (0..900).map(|cell| share(zone, cell)).collect();
                let z =
                    |(count, share): (&f64, &f64)| math::square(count - share * DRAWS as f64) / (share * DRAWS as f64);
                let kept: Vec<_> =
                    counts.iter().zip(&shares).filter(|(_, share)| **share * DRAWS as f64 > 20.0).collect();
                let n = kept.len() as f64;
                (shares.iter().sum::<f64>(), (kept.into_iter().map(z).sum::<f64>() - n) / (2.0 * n).sqrt())
            };
            let (whole, z) = off(&zone);
            assert!((whole - 1.0).abs() < 2e-3, "{zone:?}: {whole}");
            // Five standard deviations of χ².
            assert!(z < 5.0, "{zone:?}: {z}");
            assert!(off(&of(4.0)).1 > 5.0, "{zone:?} with twice the scale is not caught");
        }
    }
}
