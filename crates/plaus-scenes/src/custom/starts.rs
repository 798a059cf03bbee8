//! Whether things begin inside each other, in some draws of the prior.

use super::Custom;
use super::ending::Overlap;
use super::flight::Work;
use crate::scene::ConfigError;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use std::collections::BTreeMap;

/// Draws of the prior of which one must be free of overlaps.
const TRIES: u64 = 200;

/// How many pairs are named that begin inside each other.
const SHOWN: usize = 3;

impl Custom {
    /// What begins inside what, in words.
    pub(super) fn in_words(&self, Overlap { body, other, depth }: &Overlap) -> String {
        let millimetres = depth * 1e3;
        format!("{:?} begins {millimetres:.3} mm inside {:?}", self.name(*body), self.name(*other))
    }

    /// What begins inside what, in each of some draws of the prior: one thing of each draw.
    fn starts(&self) -> impl Iterator<Item = Result<Option<Overlap>, ConfigError>> {
        let (streams, mut work) = (Seed(0).chain(0), Work::default());
        (0..if self.vars.is_empty() { 1 } else { TRIES }).map(move |nth| {
            let draw = self.start(&mut streams.at(nth, Purpose::START));
            self.plan.overlap(&draw, &mut work).map_err(|error| ConfigError::new("world.custom", error))
        })
    }

    /// Refuses a world in which things begin inside each other in all of many draws.
    pub(super) fn check_starts(&self) -> Result<(), ConfigError> {
        let mut first = None;
        for found in self.starts() {
            match found? {
                None => return Ok(()),
                Some(overlap) => first = first.or(Some(overlap)),
            }
        }
        let Some(overlap) = first else { return Ok(()) };
        let share = if self.vars.is_empty() { String::new() } else { format!("in all of {TRIES} draws, ") };
        let message = format!("things begin inside each other: {share}{}", self.in_words(&overlap));
        Err(ConfigError::new(format!("{}.at_mm", self.plan.bodies[overlap.body as usize].key), message))
    }

    /// In which share of draws nothing begins inside another.
    pub(crate) fn free_share(&self) -> f64 {
        let (count, free) = self.starts().fold((0_u32, 0_u32), |(count, free), found| {
            (count + 1, free + u32::from(found.is_ok_and(|overlap| overlap.is_none())))
        });
        f64::from(free) / f64::from(count)
    }

    /// In which share of draws things begin inside each other, and the pairs that do so most often.
    pub(super) fn overlaps(&self) -> Option<String> {
        let mut pairs: BTreeMap<[u32; 2], (u64, Overlap)> = BTreeMap::new();
        for one in self.starts().filter_map(|found| found.ok().flatten()) {
            let (count, deepest) = pairs.entry([one.body, one.other]).or_insert((0, one));
            (*count, *deepest) = (*count + 1, if one.depth > deepest.depth { one } else { *deepest });
        }
        let share = |count: u64| format!("{:.1}%", 100.0 * count as f64 / TRIES as f64);
        let mut pairs: Vec<(u64, Overlap)> = pairs.into_values().collect();
        pairs.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
        let all: u64 = pairs.iter().map(|(count, _)| count).sum();
        let pair = |(count, one): &(u64, Overlap)| {
            let [body, other] = [one.body, one.other].map(|index| self.name(index));
            format!("{body:?} inside {other:?} in {}, by up to {:.3} mm", share(*count), one.depth * 1e3)
        };
        let shown: Vec<String> = pairs.iter().take(SHOWN).map(pair).collect();
        let more = if pairs.len() > SHOWN { "; and others" } else { "" };
        (all > 0).then(|| {
            format!(
                "things begin inside each other in {} of {TRIES} draws, which are never accepted: {}{more}",
                share(all),
                shown.join("; ")
            )
        })
    }
}
