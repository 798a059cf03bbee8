//! Balls at rest in bins that spell a word.

use crate::require::kinds::Ask;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Mark, Reach};
use crate::require::ways::level;
use crate::scene::ConfigError;
use crate::spelling::picture::{self, Grid};
use plaus_animation::Track;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::OnceLock;

/// At the end, each bin of a word or a picture holds a ball at rest. Other bins may hold balls too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Spells {
    /// The word, in the scene's font, in the middle of its bins.
    pub text: String,
    /// A picture in place of a word, as for the scene.
    pub bitmap: String,
    /// What each bin without a ball costs.
    #[schemars(extend("minimum" = 1e-3, "maximum" = 1000.0, "x-unit" = "nat"))]
    pub nats_each: f64,
    #[serde(skip)]
    known: Known,
}

/// The bins to fill in a grid, worked out when they are first asked for. They follow from the rest, so any two are
/// equal.
#[derive(Debug, Clone, Default)]
struct Known(OnceLock<(Grid, Vec<u16>)>);

impl PartialEq for Known {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Default for Spells {
    fn default() -> Self {
        Self::of(String::new(), String::new(), 5.0)
    }
}

impl Spells {
    /// A word, or a picture, and what each bin without a ball costs, in nats.
    #[must_use]
    pub fn of(text: String, bitmap: String, nats_each: f64) -> Self {
        Self { text, bitmap, nats_each, known: Known::default() }
    }

    /// The bins to fill in a grid in which they [can be](Ask::check).
    fn filled_in(&self, grid: &Grid) -> Option<Cow<'_, [u16]>> {
        let worked_out = || Some((*grid, self.bins(grid).ok()?));
        if self.known.0.get().is_none() {
            _ = self.known.0.set(worked_out()?);
        }
        match self.known.0.get() {
            Some((of, bins)) if of == grid => Some(Cow::Borrowed(bins)),
            _ => worked_out().map(|(_, bins)| Cow::Owned(bins)),
        }
    }

    /// The bins to fill, or what is wrong, with its key.
    fn bins(&self, grid: &Grid) -> Result<Vec<u16>, (&'static str, String)> {
        let (key, picture) = match (self.text.as_str(), self.bitmap.as_str()) {
            (text, "") => ("text", picture::write(text, grid.letters)),
            ("", bitmap) => ("bitmap", picture::read(bitmap)),
            _ => return Err(("text", "there is a `bitmap` too: leave one of them out".into())),
        };
        let picture = picture.map_err(|message| (key, message))?;
        let [width, height] = picture::size(&picture);
        let (columns, rows) = (grid.bins.columns, grid.bins.rows);
        if width > columns || height > rows {
            let message = format!(
                "it takes {width} × {height} bins, but the box has {columns} × {rows}: set world.spelling.columns and rows"
            );
            return Err((key, message));
        }
        let bins = picture::bins(&picture, [columns, rows]);
        if bins.is_empty() {
            Err((key, "there is no bin to fill: there must be at least one".into()))
        } else {
            Ok(bins)
        }
    }

    fn mark(&self, empty: usize) -> Mark {
        Mark::of_faults(empty as u32, empty as u32, self.nats_each)
    }
}

impl Ask for Spells {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        let Some(grid) = &place.cast().bins else {
            return Err(place.wrong("this world has no bins in which balls can spell: only the scene `spelling` has"));
        };
        let bins = self.bins(grid).map_err(|(key, message)| place.at(key).wrong(&message))?;
        place.body("text", "ball_*")?;
        let balls = place.cast().bodies.len();
        if balls < bins.len() {
            let message = format!("{balls} balls cannot fill {} bins: set world.spelling.balls", bins.len());
            return Err(place.at(if self.bitmap.is_empty() { "text" } else { "bitmap" }).wrong(&message));
        }
        Ok(())
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(1.0 / self.nats_each, "bins").beyond(0.5 * self.nats_each))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let Some((grid, bins)) = probe.cast().bins.and_then(|grid| Some((grid, self.filled_in(&grid)?))) else {
            return Reach::NEVER;
        };
        let mark = |full: usize| self.mark(bins.len().saturating_sub(full));
        if !probe.is_whole() {
            // Each ball fills at most one bin. Before anything is known of a motion, it does not show which there are.
            let dropped = probe.bodies("ball_*").filter(|ball| probe.track(ball).is_some()).count();
            return Reach { least: mark(0), most: mark(if probe.known() > 0.0 { dropped } else { bins.len() }) };
        }
        let resting = |track: &Track| track.pieces.last().filter(|piece| piece.rests()).map(|piece| piece.position);
        let full: Vec<u16> =
            probe.bodies("ball_*").filter_map(|ball| grid.bins.holds(level(resting(probe.track(ball)?)?))).collect();
        let mark = mark(bins.iter().filter(|bin| full.contains(bin)).count());
        Reach { least: mark, most: mark }
    }
}
