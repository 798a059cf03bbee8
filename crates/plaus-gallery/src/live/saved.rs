//! What a page found, as a file: a scenario with draws, from which `plaus replay` rebuilds them bit for bit.

use super::{Found, World, in_words};
use serde::{Deserialize, Serialize};
use serde_json::json;

/// What the file is, and its version.
const FORMAT: &str = "plaus draws 1";

/// A scenario with draws.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Saved {
    /// What the file is.
    format: String,
    /// Version of plaus that made the draws.
    pub plaus: String,
    /// The scenario with its files.
    pub world: World,
    /// The draws.
    pub draws: Vec<Found>,
}

impl Saved {
    /// The file of some draws.
    #[must_use]
    pub fn text(world: &World, draws: &[Found]) -> String {
        let plaus = env!("CARGO_PKG_VERSION");
        json!({"format": FORMAT, "plaus": plaus, "world": world, "draws": draws}).to_string()
    }

    /// Reads such a file.
    ///
    /// # Errors
    /// In words, if it is something else, or another version of plaus made it.
    pub fn read(text: &str) -> Result<Self, String> {
        let saved: Self = serde_json::from_str(text).map_err(in_words)?;
        if saved.format != FORMAT {
            return Err(format!("{:?} is not {FORMAT:?}", saved.format));
        }
        let present = env!("CARGO_PKG_VERSION");
        match saved.plaus == present {
            true => Ok(saved),
            false => Err(format!("plaus {} made its draws, and this is {present}", saved.plaus)),
        }
    }

    /// The draw with this name, such as `4:1234`.
    #[must_use]
    pub fn draw(&self, id: &str) -> Option<&Found> {
        self.draws.iter().find(|found| found.id() == id)
    }
}
