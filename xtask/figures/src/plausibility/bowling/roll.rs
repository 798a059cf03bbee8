//! Balls that roll onto the pins along a given line, and the pins that they leave.

use crate::Result;
use crate::plausibility::chance::Count;
use plaus_dist::math::square;
use plaus_dist::{Purpose, Seed, Stream, math, standard_normal};
use plaus_mcmc::{ModelError, StateOf, Target};
use plaus_scenes::AccuracyPreset;
use plaus_scenes::bowling::{Bowling, Coefficients, Config, Delivery, Quantity, Rest, Shot, Work};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Width of one of a lane's 39 boards in m.
pub(super) const BOARD: f64 = 41.5 * 0.0254 / 39.0;

/// A 15 lb ball within the rules: radius in m, density in kg/m³, and radius of gyration over radius.
const BALL: [f64; 3] = [0.1085, 1271.0, 0.608];

/// Where the ball begins, in m before the head pin's spot: well clear of all pins.
const BEGINS: f64 = 0.6;

/// Distance from the head pin's axis to the ball's centre when they meet, in m: the sum of their radii at the height of
/// the ball's centre.
const REACH: f64 = 0.1685;

/// Standard deviation of the ball's speed in m/s.
const SPEED_SD: f64 = 0.2;

/// Pins that a shot left: bit k − 1 for pin k.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(super) struct Leave(u16);

impl Leave {
    pub(super) const STRIKE: Self = Self(0);

    pub(super) fn of_pins(pins: &[u16]) -> Self {
        Self(pins.iter().fold(0, |bits, pin| bits | 1 << (pin - 1)))
    }

    fn of_rest(rest: &Rest) -> Self {
        let standing = rest.pins.iter().enumerate().filter(|(_, fate)| fate.stands());
        Self(standing.fold(0, |bits, (place, _)| bits | 1 << place))
    }

    fn pins(self) -> impl Iterator<Item = u16> {
        (1..=10).filter(move |pin| self.0 >> (pin - 1) & 1 == 1)
    }

    /// Left and right exchanged.
    pub(super) fn mirrored(self) -> Self {
        // The numbers of a pin and of its mirror image have the same sum as the first and the last number of their row.
        let image = |pin| match pin {
            1 => 1,
            2..=3 => 5 - pin,
            4..=6 => 10 - pin,
            _ => 17 - pin,
        };
        Self::of_pins(&self.pins().map(image).collect::<Vec<_>>())
    }

    /// In the notation of bowlers.
    pub(super) fn name(self) -> String {
        if self == Self::STRIKE {
            return "strike".to_owned();
        }
        self.pins().map(|pin| pin.to_string()).collect::<Vec<_>>().join("-")
    }
}

/// The straight line along which a ball rolls onto the pins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// Board over which the ball's centre would cross the head pin's row. Boards are counted from the right; the centre
    /// of the middle one is 20.
    pub(super) board: f64,
    /// Angle of entry in degrees, from the right.
    pub(super) angle: f64,
    /// Mean speed in m/s.
    pub(super) speed: f64,
    /// Whether everything is mirrored, as for a left-hander's ball from the left.
    pub(super) from_left: bool,
}

impl Line {
    pub(super) fn new(board: f64, angle: f64) -> Self {
        Self { board, angle, speed: 8.0, from_left: false }
    }

    /// The ball of a shot, rolling without slipping.
    fn set(&self, draw: &mut Shot, speed: f64) {
        let side = if self.from_left { -1.0 } else { 1.0 };
        let (sin, cos) = math::sin_cos(self.angle.to_radians());
        let across = (20.0 - self.board) * BOARD + BEGINS * sin / cos;
        let [radius, density, gyration] = BALL;
        for (quantity, value) in [
            (Quantity::Radius, radius),
            (Quantity::Density, density),
            (Quantity::Gyration, gyration),
            (Quantity::Across, side * across),
            (Quantity::Height, radius),
            (Quantity::Speed, speed * cos),
            (Quantity::Drift, -side * speed * sin),
            (Quantity::Roll, speed * cos / radius),
            (Quantity::Hook, -side * speed * sin / radius),
            (Quantity::Twist, 0.0),
        ] {
            draw.ball[quantity as usize] = value;
        }
    }
}

/// The results of shots.
#[derive(Debug, Clone, Default)]
pub(super) struct Tally {
    /// How many shots left which pins.
    pub(super) leaves: BTreeMap<Leave, u64>,
    pub(super) shots: u64,
    /// Shots in which the ball itself struck pins 1, 3, 5 and 9 and no other; mirrored for a left-hander's ball.
    pub(super) four: u64,
    /// Board, as in [`Line`], and angle of entry in degrees, from the right, of every ball that met a pin.
    pub(super) entries: Vec<[f64; 2]>,
    /// Shots that did not end within the simulator's budget of events; they are in no other count.
    pub(super) unfinished: u64,
}

impl Tally {
    fn add(&mut self, rest: &Rest) {
        if !rest.complete {
            self.unfinished += 1;
            return;
        }
        self.shots += 1;
        *self.leaves.entry(Leave::of_rest(rest)).or_default() += 1;
        self.entries.extend(rest.entry.map(|entry| {
            // From where the ball meets the pin, given their radii, on to the head pin's row.
            let before = (square(REACH) - square(entry.across)).max(0.0).sqrt();
            let across = entry.across + before * math::tan(entry.angle.to_radians());
            [20.0 - across / BOARD, -entry.angle]
        }));
        let struck = rest.struck.iter().fold(0_u16, |bits, pin| bits | 1 << (pin - 1));
        self.four += u64::from([Leave::of_pins(&[1, 3, 5, 9]), Leave::of_pins(&[1, 2, 5, 8])].contains(&Leave(struck)));
    }

    pub(super) fn of(&self, leave: Leave) -> Count {
        Count::new(self.leaves.get(&leave).copied().unwrap_or(0), self.shots)
    }

    pub(super) fn strikes(&self) -> Count {
        self.of(Leave::STRIKE)
    }

    /// Leaves, the most frequent first.
    pub(super) fn most(&self) -> Vec<(Leave, u64)> {
        let mut all: Vec<_> = self.leaves.iter().map(|(leave, count)| (*leave, *count)).collect();
        all.sort_by_key(|(leave, count)| (std::cmp::Reverse(*count), *leave));
        all
    }

    /// The most frequent leaves except strikes, in words, in percent.
    pub(super) fn words(&self, count: usize) -> String {
        let leaves = self.most().into_iter().filter(|(leave, _)| *leave != Leave::STRIKE).take(count);
        let word = |(leave, hits): (Leave, u64)| {
            format!("{} {:.1}", leave.name(), 100.0 * Count::new(hits, self.shots).share())
        };
        leaves.map(word).collect::<Vec<_>>().join(", ")
    }
}

/// The regulation scene with these coefficients.
pub(super) fn scene(contact: Coefficients) -> Result<Bowling> {
    scene_at(AccuracyPreset::default(), contact)
}

/// The same at a given accuracy.
pub(super) fn scene_at(accuracy: AccuracyPreset, contact: Coefficients) -> Result<Bowling> {
    Ok(Bowling::new(&Config { delivery: Delivery::Regulation, contact, accuracy, ..Config::default() })?)
}

/// Bowls this many shots, each with pins set at random as in the scene; `shot` gives the line of each.
pub(super) fn along(
    scene: &Bowling,
    shots: u64,
    seed: u64,
    line: impl Fn(&mut Stream) -> Line + Sync,
) -> Result<Tally> {
    tally(shots, seed, |work, stream| {
        let mut draw = scene.start(stream);
        let line = line(stream);
        line.set(&mut draw, line.speed + SPEED_SD * standard_normal(stream));
        scene.bowl_from(BEGINS, &draw, work)
    })
}

/// Bowls this many shots of the scene's prior, from the foul line.
pub(super) fn from_prior(scene: &Bowling, shots: u64, seed: u64) -> Result<Tally> {
    tally(shots, seed, |work, stream| Ok(StateOf::<Bowling>::evaluate(scene, scene.start(stream), work)?.outcome))
}

fn tally(
    shots: u64,
    seed: u64,
    bowl: impl Fn(&mut Work, &mut Stream) -> std::result::Result<Rest, ModelError> + Sync,
) -> Result<Tally> {
    let one = |work: &mut Work, shot: u64| bowl(work, &mut Seed(seed).chain(0).at(shot, Purpose::START));
    let rests: Vec<Rest> =
        (0..shots).into_par_iter().map_init(Work::default, one).collect::<std::result::Result<_, _>>()?;
    let mut tally = Tally::default();
    rests.iter().for_each(|rest| tally.add(rest));
    Ok(tally)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_are_named_and_mirrored() {
        let leave = Leave::of_pins(&[4, 6, 7, 10]);
        assert_eq!((leave.name().as_str(), leave.mirrored()), ("4-6-7-10", leave));
        assert_eq!(Leave::of_pins(&[3, 10]).mirrored(), Leave::of_pins(&[2, 7]));
        assert_eq!(Leave::of_pins(&[9]).mirrored().name(), "8");
        assert_eq!(Leave::STRIKE.name(), "strike");
    }

    /// The ball meets the head pin on the line along which it was sent: the angle to rounding, the place to the pin's
    /// own offset, of which five standard deviations are 5 mm.
    #[test]
    fn balls_take_their_line() {
        let scene = scene(Coefficients::default()).unwrap();
        for (board, angle, from_left) in [(17.5, 6.0, false), (17.5, 6.0, true), (18.0, 0.0, false)] {
            let line = Line { from_left, ..Line::new(board, angle) };
            let mut draw = scene.start(&mut Seed(1).chain(0).at(0, Purpose::START));
            line.set(&mut draw, 8.0);
            let rest = scene.bowl_from(BEGINS, &draw, &mut Work::default()).unwrap();
            let entry = rest.entry.unwrap();
            let side = if from_left { -1.0 } else { 1.0 };
            assert!((entry.angle + side * angle).abs() < 1e-9, "{}", entry.angle);
            // At contact the ball is as far before the row as the sum of the radii allows: 168 to 169 mm from the pin's
            // axis.
            let before = (entry.across * side - (20.0 - board) * BOARD) / math::tan(angle.to_radians());
            if angle > 0.0 {
                let reach = math::hypot(before, entry.across);
                assert!((reach - REACH).abs() < 0.006, "{reach}");
            } else {
                assert!((entry.across - (20.0 - board) * BOARD).abs() < 1e-9);
            }
        }
    }
}
