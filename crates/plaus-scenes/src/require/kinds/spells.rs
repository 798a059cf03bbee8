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
}

impl Default for Spells {
    fn default() -> Self {
        Self { text: String::new(), bitmap: String::new(), nats_each: 5.0 }
    }
}

impl Spells {
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
        let Some((grid, bins)) = probe.cast().bins.and_then(|grid| Some((grid, self.bins(&grid).ok()?))) else {
            return Reach::NEVER;
        };
        if !probe.is_whole() {
            return Reach { least: self.mark(bins.len()), most: self.mark(0) };
        }
        let resting = |track: &Track| track.pieces.last().filter(|piece| piece.rests()).map(|piece| piece.position);
        let full: Vec<u16> =
            probe.bodies("ball_*").filter_map(|ball| grid.bins.holds(level(resting(probe.track(ball)?)?))).collect();
        let mark = self.mark(bins.iter().filter(|bin| !full.contains(bin)).count());
        Reach { least: mark, most: mark }
    }
}
