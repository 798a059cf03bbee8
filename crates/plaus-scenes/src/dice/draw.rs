//! What is random: how each die is thrown, and the tables' control points, which are made only where something looks at
//! them.
//!
//! A control point is held as its *score*, a standard normal number that the law of its place turns into a height, a
//! restitution or a friction. The score of a point that no move has changed is a pure function of the table's key, the
//! field and the point's indices, as if it had been drawn at the start; so a draw holds only the points that moves have
//! changed, and yet the whole table.

use crate::in_place::clone_in_place;
use crate::uneven::{Changed, streams};
pub use crate::uneven::{Field, LARGEST_SCORE, Site};
use glam::{DQuat, DVec3};
use plaus_dist::Stream;
use rand::Rng;
use serde::{Deserialize, Serialize};

/// How one die is thrown: SI units, world axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Throw {
    /// Its middle at time 0, in m; if its table has been shifted, its place is shifted by as much.
    pub position: DVec3,
    /// Turns the body's axes into the world's.
    pub orientation: DQuat,
    /// In m/s.
    pub velocity: DVec3,
    /// Angular velocity in rad/s.
    pub spin: DVec3,
    /// Which of the body's symmetries its pips are turned by: an index into [`super::Rotation::of_cuboid`].
    pub turn: u8,
}

impl Throw {
    /// Whether the body moves in the same way, whatever its pips.
    #[must_use]
    pub fn moves_like(&self, other: &Self) -> bool {
        Self { turn: other.turn, ..*self } == *other
    }
}

/// A whole table: the scores of all its control points.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Realisation {
    /// The scores of unchanged points follow from it.
    pub key: u64,
    /// By how many cells the table, with the die thrown onto it, has been shifted along x and y. Indices of points and
    /// positions of throws do not include the shift, so that it changes no bit of a motion.
    pub shifted: [i32; 2],
    /// Points that moves have changed.
    changed: Changed,
}

clone_in_place!(Realisation { key, shifted, changed });

/// The values of all random variables.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Draw {
    /// One for each die.
    pub throws: Vec<Throw>,
    /// One for each die if each is thrown alone, otherwise one for all.
    pub tables: Vec<Realisation>,
}

clone_in_place!(Draw { throws, tables });

impl Draw {
    /// The index of the table that a die is thrown onto.
    #[must_use]
    pub fn table_of(&self, die: usize) -> usize {
        die.min(self.tables.len().saturating_sub(1))
    }

    /// By how much a die's place is shifted from what its throw and its trip say, in m; `spacing` is that of control
    /// points.
    #[must_use]
    pub fn offset(&self, die: usize, spacing: f64) -> DVec3 {
        let [x, y] = self.tables[self.table_of(die)].shifted.map(|cells| f64::from(cells) * spacing);
        DVec3::new(x, y, 0.0)
    }
}

impl Realisation {
    /// A draw from the prior.
    pub fn new(stream: &mut Stream) -> Self {
        Self { key: stream.next_u64(), shifted: [0; 2], changed: Changed::default() }
    }

    /// Draws everything anew, keeping allocations.
    pub fn renew(&mut self, stream: &mut Stream) {
        (self.key, self.shifted) = (stream.next_u64(), [0; 2]);
        self.changed.clear();
    }

    /// The score of a point. For many points, use [`Realisation::source`].
    #[must_use]
    pub fn score(&self, site: Site) -> f64 {
        self.changed.score(&streams(self.key), site)
    }

    /// Gives a point another score.
    pub fn set(&mut self, site: Site, score: f64) {
        self.changed.set(site, score);
    }

    /// The points that moves have changed, with their scores.
    #[must_use]
    pub fn changed_points(&self) -> &[(Site, f64)] {
        self.changed.points()
    }

    /// Whether all points have the scores of another table's, shifted or not.
    #[must_use]
    pub fn has_points_of(&self, other: &Self) -> bool {
        self.key == other.key && self.changed == other.changed
    }

    /// The points whose scores differ from another table's; `None` if all of them may differ.
    pub(super) fn differing(&self, other: &Self) -> Option<Vec<Site>> {
        if self.key != other.key || self.shifted != other.shifted {
            return None;
        }
        // Both lists are in order of their sites.
        let (mut ours, mut theirs) =
            (self.changed_points().iter().peekable(), other.changed_points().iter().peekable());
        let mut sites = Vec::new();
        loop {
            match (ours.peek(), theirs.peek()) {
                (None, None) => return Some(sites),
                (Some(a), Some(b)) if a.0 == b.0 => {
                    if a.1 != b.1 {
                        sites.push(a.0);
                    }
                    ours.next();
                    theirs.next();
                }
                (Some(a), b) if b.is_none_or(|b| a.0 < b.0) => sites.extend(ours.next().map(|point| point.0)),
                _ => sites.extend(theirs.next().map(|point| point.0)),
            }
        }
    }

    /// How many points moves have changed since the table was drawn.
    #[must_use]
    pub fn changed(&self) -> usize {
        self.changed_points().len()
    }

    /// The scores as a function that owns everything it needs.
    pub fn source(&self) -> impl Fn(Site) -> f64 + Send + Sync + 'static {
        let (changed, streams) = (self.changed.clone(), streams(self.key));
        move |site| changed.score(&streams, site)
    }
}

/// The number of numbers in the initial conditions of a die, besides its orientation: place, velocity and angular
/// velocity along three axes.
pub const NUMBERS: usize = 9;

/// How many variables a die has: its numbers, its orientation, which of its symmetries its pips are turned by.
pub(super) const EACH: usize = NUMBERS + 2;

/// The place of the orientation among them.
pub(super) const ORIENTATION: usize = NUMBERS;

/// One number of a throw: place, velocity, angular velocity, each along x, y, z; without its table's shift.
pub(super) fn number(throw: &Throw, number: usize) -> &f64 {
    &[&throw.position, &throw.velocity, &throw.spin][number / 3][number % 3]
}

/// The same, to change.
pub(super) fn number_mut(throw: &mut Throw, number: usize) -> &mut f64 {
    let part = match number / 3 {
        0 => &mut throw.position,
        1 => &mut throw.velocity,
        _ => &mut throw.spin,
    };
    &mut part[number % 3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_dist::{Purpose, Seed};

    fn table(seed: u64) -> Realisation {
        Realisation::new(&mut Seed(seed).chain(0).at(0, Purpose::START))
    }

    #[test]
    fn points_are_functions_of_their_address() {
        let mut table = table(1);
        let site = |field, i, j| Site { field, i, j };
        let here = site(Field::Height, -3, 7);
        assert_eq!(table.score(here), table.score(here));
        for other in [site(Field::Friction, -3, 7), site(Field::Height, 7, -3), site(Field::Height, -3, 8)] {
            assert_ne!(table.score(here), table.score(other));
        }
        table.set(site(Field::Height, 0, 0), 2.5);
        let (score, source) = (table.score(here), table.source());
        assert_eq!((source(here), source(site(Field::Height, 0, 0))), (score, 2.5));
        table.shifted = [5, -1];
        assert_eq!((table.score(here), table.changed_points()), (score, &[(site(Field::Height, 0, 0), 2.5)][..]));
        table.set(site(Field::Height, 0, 0), -0.5);
        table.set(here, 1.0);
        assert_eq!((table.score(site(Field::Height, 0, 0)), table.changed()), (-0.5, 2));
        let mut other = Realisation { key: table.key, shifted: [5, -1], changed: Changed::default() };
        other.set(here, 1.0);
        other.set(site(Field::Friction, 9, 9), 0.0);
        let differing = Some(vec![site(Field::Height, 0, 0), site(Field::Friction, 9, 9)]);
        assert_eq!((table.differing(&other), other.differing(&table)), (differing.clone(), differing));
        other.shifted = [0; 2];
        assert_eq!(table.differing(&other), None);
    }

    /// Mean, variance and correlation of neighbours over 10⁵ points: five standard errors, a false alarm in 10⁶ for
    /// all.
    #[test]
    fn unchanged_points_are_independent_standard_normal_numbers() {
        let table = table(2);
        let source = table.source();
        let side = 316;
        let n = f64::from(side * side);
        let (mut sum, mut squares, mut products) = (0.0, 0.0, [0.0; 3]);
        for i in 0..side {
            for j in 0..side {
                let at = |field, i, j| source(Site { field, i, j });
                let z = at(Field::Height, i, j);
                sum += z;
                squares += z * z;
                products[0] += z * at(Field::Height, i + 1, j);
                products[1] += z * at(Field::Height, i, j + 1);
                products[2] += z * at(Field::Restitution, i, j);
            }
        }
        assert!((sum / n).abs() < 5.2 / n.sqrt(), "{}", sum / n);
        assert!((squares / n - 1.0).abs() < 5.2 * (2.0 / n).sqrt());
        assert!(products.iter().all(|p| (p / n).abs() < 5.2 / n.sqrt()), "{products:?}");
    }
}
