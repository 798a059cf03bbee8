//! Control points of random fields: their names, their scores as functions of keys, and those that moves have changed.

use crate::in_place::clone_in_place;
use plaus_dist::stream::ChainStreams;
use plaus_dist::{Purpose, Seed, Stream, standard_normal};
use plaus_mcmc::library::{Sizes, unmarked};
use plaus_mcmc::{Path, Scale};
use serde::{Deserialize, Serialize};

/// Scores beyond this have density 0. Without the cut, one in 5·10⁸ would be beyond it.
pub const LARGEST_SCORE: f64 = 6.0;

/// A property of the table. The scores of impacts are held in the same way: there, height and friction are the tilt of
/// an impact's normal along the slip and across it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Field {
    /// Its height.
    Height,
    /// Restitution of what hits it.
    Restitution,
    /// Friction of what slides on it.
    Friction,
}

impl Field {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Height, Self::Restitution, Self::Friction];

    /// The tilts of an impact's normal along the slip and across it, and its restitution.
    const OF_IMPACT: [Self; 3] = [Self::Height, Self::Friction, Self::Restitution];

    /// Streams of control points have purposes of their own.
    fn purpose(self) -> Purpose {
        Purpose(32 + self as u16)
    }
}

/// A control point of one field of a table, by its indices on the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Site {
    /// Which field.
    pub field: Field,
    /// Index along x.
    pub i: i32,
    /// Index along y.
    pub j: i32,
}

/// What the variable is called that holds the scores of all impacts.
pub(crate) const SCATTER: &str = "impacts.scatter";

impl Site {
    /// The scores of an impact of two things, by their numbers, that had so many impacts before. Things repeat after
    /// 2¹⁴, impacts of two things after 2²⁰, more than a motion has.
    pub(crate) fn of_impact([one, other]: [u32; 2], ordinal: u32) -> [Self; 3] {
        let number = |thing: u32| u64::from(thing & 0x3fff);
        Self::of_code(number(one) << 34 | number(other) << 20 | u64::from(ordinal & 0xf_ffff))
    }

    /// The same, of 48 bits that say which.
    fn of_code(code: u64) -> [Self; 3] {
        let index = |bits: u64| (((bits as u32) << 8).cast_signed()) >> 8;
        Field::OF_IMPACT.map(|field| Self { field, i: index(code >> 24), j: index(code) })
    }
}

/// An impact as a path, from one of its scores.
pub(crate) fn path_of_impact(site: Site) -> Path {
    path(0, Site { field: Field::Height, ..site })
}

/// What [`path_of_impact`] made.
pub(crate) fn impact_of_path(path: Path) -> [Site; 3] {
    Site::of_code(unmarked(path).0)
}

/// The streams of a table's points, from its key.
pub(crate) fn streams(key: u64) -> ChainStreams {
    Seed(key).chain(0)
}

/// The initial score of a point: a standard normal number within [`LARGEST_SCORE`], from a stream addressed by field
/// and indices.
fn fresh(streams: &ChainStreams, site: Site) -> f64 {
    // Indices repeat after 2²⁴ cells, farther than any table is large.
    let index = |k: i32| u64::from(k.cast_unsigned() & 0x00ff_ffff);
    let mut stream = streams.at(index(site.i) << 24 | index(site.j), site.field.purpose());
    held(&mut stream)
}

/// A standard normal number within [`LARGEST_SCORE`].
fn held(stream: &mut Stream) -> f64 {
    loop {
        let score = standard_normal(stream);
        if score.abs() <= LARGEST_SCORE {
            return score;
        }
    }
}

/// Control points that moves have changed, with their scores, in order of their sites. All others have the scores that
/// follow from the table's key.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Changed(Vec<(Site, f64)>);

clone_in_place!(Changed { 0 });

impl Changed {
    /// The points.
    pub(crate) fn points(&self) -> &[(Site, f64)] {
        &self.0
    }

    /// Forgets all changes.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    fn place(&self, site: Site) -> Result<usize, usize> {
        self.0.binary_search_by(|(known, _)| known.cmp(&site))
    }

    /// The score of a point of the table with these streams.
    pub(crate) fn score(&self, streams: &ChainStreams, site: Site) -> f64 {
        self.place(site).map_or_else(|_| fresh(streams, site), |place| self.0[place].1)
    }

    /// Gives a point another score.
    pub(crate) fn set(&mut self, site: Site, score: f64) {
        match self.place(site) {
            Ok(place) => self.0[place].1 = score,
            Err(place) => self.0.insert(place, (site, score)),
        }
    }
}

/// The scales of a move of control points, from its sizes of steps: one for each field.
pub(crate) fn declared(sizes: &[Sizes; 3]) -> Vec<Scale> {
    let names = ["height", "restitution", "friction"];
    names.iter().zip(sizes).map(|(name, sizes)| sizes.declared(name, Scale::ONE)).collect()
}

/// The same sizes near other scales.
pub(crate) fn about(sizes: [Sizes; 3], values: &[Option<f64>]) -> [Sizes; 3] {
    std::array::from_fn(|k| sizes[k].about(values.get(k).copied().flatten()))
}

/// A control point as a path: table, field and indices.
pub(crate) fn path(table: usize, site: Site) -> Path {
    let index = |k: i32| u64::from(k.cast_unsigned() & 0x00ff_ffff);
    Path((table as u64) << 50 | (site.field as u64) << 48 | index(site.i) << 24 | index(site.j))
}

/// What [`path`] made.
pub(crate) fn site(path: Path) -> (usize, Site) {
    let index = |bits: u64| (((bits as u32) << 8).cast_signed()) >> 8;
    let field = Field::ALL[((path.0 >> 48) & 3).min(2) as usize];
    ((unmarked(path).0 >> 50) as usize, Site { field, i: index(path.0 >> 24), j: index(path.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_mcmc::library::{is_adapted, marked};
    use std::collections::BTreeSet;

    #[test]
    fn paths_hold_any_impact() {
        let mut seen = BTreeSet::new();
        for (two, ordinal) in [([0, 0], 0), ([0, 1], 0), ([1, 0], 0), ([0, 0], 1), ([16_383, 9], 1_048_575)] {
            let sites = Site::of_impact(two, ordinal);
            assert!(seen.insert(sites), "two impacts share scores");
            let path = marked(path_of_impact(sites[0]), true);
            assert_eq!((impact_of_path(path), is_adapted(path)), (sites, false));
        }
    }

    #[test]
    fn paths_hold_any_site() {
        for (table, i, j) in [(0, 0, 0), (23, -1, 5), (7, -400_000, 399_999)] {
            for field in Field::ALL {
                let there = Site { field, i, j };
                for is_wide in [false, true] {
                    let path = marked(path(table, there), is_wide);
                    assert_eq!((site(path), is_adapted(path)), ((table, there), !is_wide));
                }
            }
        }
    }
}
