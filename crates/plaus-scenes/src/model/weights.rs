//! Weights of moves, by the moves' names.
//!
//! A scene lists its moves in a table, one row each: what the move does, its weight, and what the paper gives it. Keys
//! of scenario files, their meanings, ranges and defaults, the presets and the mixture follow from that.

use super::offered::Offered;
pub use super::row::{Printed, Row};
use crate::scene::ConfigError;
use plaus_mcmc::{Mixture, Move, Variables};
use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

/// Which moves the chain makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Moves {
    /// All moves, weighted by `weights`.
    #[default]
    Mixed,
    /// Only the paper's moves, with the paper's weights; if the paper leaves a weight to the user, it is taken from
    /// `weights`.
    Paper,
}

/// The moves of a scene.
pub trait Menu: Clone + PartialEq {
    /// The scene.
    type Scene: Variables + 'static;
    /// The scene's name.
    const SCENE: &'static str;
    /// One row for each move of its own.
    const ROWS: &'static [Row];
    /// Weights of moves that every scene offers, if they are not 0.
    const OFFERED: &'static [(&'static str, f64)] = &[];
}

/// The rows of a scene: its own, and those that every scene offers.
fn rows<M: Menu>() -> impl Iterator<Item = Row> {
    let offered = <M::Scene as Offered>::ROWS.iter().map(|&(row, _)| {
        let weight = M::OFFERED.iter().find(|(name, _)| *name == row.name);
        Row { weight: weight.map_or(row.weight, |&(_, weight)| weight), ..row }
    });
    M::ROWS.iter().copied().chain(offered)
}

/// Relative weights of the moves of a scene.
#[derive(Clone, PartialEq)]
pub struct Weights<M: Menu> {
    /// In the order of the menu.
    values: Vec<f64>,
    menu: PhantomData<fn() -> M>,
}

impl<M: Menu> Weights<M> {
    /// The paper's weights; those that it leaves to the user have their default values.
    #[must_use]
    pub fn paper() -> Self {
        Self::default().printed()
    }

    /// The weights that remain if only the paper's moves are made.
    fn printed(&self) -> Self {
        let one = |(row, &set): (Row, &f64)| match row.printed {
            Printed::Not => 0.0,
            Printed::Weight(weight) => weight,
            Printed::Free => set,
        };
        Self { values: rows::<M>().zip(&self.values).map(one).collect(), menu: PhantomData }
    }

    /// The same weights with another one for a move.
    ///
    /// # Panics
    ///
    /// If the scene has no such move.
    #[must_use]
    pub fn with(mut self, name: &str, weight: f64) -> Self {
        self.set(name, weight);
        self
    }

    /// Gives a move another weight.
    ///
    /// # Panics
    ///
    /// If the scene has no such move.
    pub fn set(&mut self, name: &str, weight: f64) {
        let place = Self::place(name);
        self.values[place] = weight;
    }

    /// The weight of a move.
    ///
    /// # Panics
    ///
    /// If the scene has no such move.
    #[must_use]
    pub fn get(&self, name: &str) -> f64 {
        self.values[Self::place(name)]
    }

    fn place(name: &str) -> usize {
        let place = rows::<M>().position(|row| row.name == name);
        place.unwrap_or_else(|| panic!("{} has no move `{name}`", M::SCENE))
    }

    /// The mixture of moves, each with the weight for its name. Moves that are left out have no weight.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] if no weight is positive, or a weight is invalid.
    ///
    /// # Panics
    ///
    /// If a move is not in the scene's table.
    pub fn mix(
        &self,
        which: Moves,
        scene: &M::Scene,
        mut kernels: Vec<Box<dyn Move<M::Scene>>>,
    ) -> Result<Mixture<M::Scene>, ConfigError> {
        let printed = self.printed();
        let weights = if which == Moves::Paper { &printed } else { self };
        kernels.extend(<M::Scene as Offered>::ROWS.iter().map(|(_, make)| make(scene)));
        let weighed = kernels.into_iter().map(|kernel| (weights.get(kernel.name()), kernel));
        Mixture::new(weighed.collect()).map_err(|error| ConfigError::new(format!("world.{}.weights", M::SCENE), error))
    }
}

impl<M: Menu> Default for Weights<M> {
    fn default() -> Self {
        Self { values: rows::<M>().map(|row| row.weight).collect(), menu: PhantomData }
    }
}

impl<M: Menu> fmt::Debug for Weights<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(rows::<M>().map(|row| row.name).zip(&self.values)).finish()
    }
}

impl<M: Menu> Serialize for Weights<M> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(rows::<M>().map(|row| row.name).zip(&self.values))
    }
}

/// Moves that are not named keep their default weights.
impl<'de, M: Menu> Deserialize<'de> for Weights<M> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut weights = Self::default();
        for (name, weight) in BTreeMap::<String, f64>::deserialize(deserializer)? {
            let Some(place) = rows::<M>().position(|row| row.name == name) else {
                let names: Vec<&str> = rows::<M>().map(|row| row.name).collect();
                let message = format!("{} has no move `{name}`: its moves are {}", M::SCENE, names.join(", "));
                return Err(D::Error::custom(message));
            };
            weights.values[place] = weight;
        }
        Ok(weights)
    }
}

#[cfg(feature = "schema")]
impl<M: Menu> schemars::JsonSchema for Weights<M> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("WeightsOf_{}", M::SCENE).into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let row = |row: Row| {
            let schema = serde_json::json!({
                "description": row.meaning,
                "type": "number",
                "format": "double",
                "minimum": 0.0,
                "maximum": 1e6,
                "default": row.weight,
            });
            (row.name.to_owned(), schema)
        };
        let properties: serde_json::Map<String, serde_json::Value> = rows::<M>().map(row).collect();
        schemars::json_schema!({
            "description": "Relative weights of the moves, by their names.",
            "type": "object",
            "properties": properties,
            "additionalProperties": false,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone, PartialEq)]
    struct Toy;

    impl Menu for Toy {
        type Scene = crate::ball2d::Ball2d;
        const SCENE: &'static str = "toy";
        const ROWS: &'static [Row] = &[
            Row::paper("change", 0.5, Printed::Weight(0.9), "Changes."),
            Row::paper("point", 0.25, Printed::Free, "Points."),
            Row::own("aim", 0.25, "Aims."),
        ];
    }

    #[test]
    fn presets_follow_from_the_table() {
        let all = |weights: &Weights<Toy>| ["change", "point", "aim"].map(|name| weights.get(name));
        assert_eq!(all(&Weights::default()), [0.5, 0.25, 0.25]);
        assert_eq!(all(&Weights::paper()), [0.9, 0.25, 0.0]);
        assert_eq!(all(&Weights::default().with("point", 3.0).printed()), [0.9, 3.0, 0.0]);
    }

    #[test]
    fn tables_are_read_and_written_by_name() {
        let read = |text: &str| toml::from_str::<Weights<Toy>>(text).map_err(|error| error.to_string());
        assert_eq!(read("aim = 1").unwrap(), Weights::default().with("aim", 1.0));
        assert_eq!(
            toml::to_string(&Weights::<Toy>::default()).unwrap(),
            "change = 0.5\npoint = 0.25\naim = 0.25\nredraw_any = 0.0\nstep_any = 0.0\nstep_all = 0.0\nlearned = 0.0\n\
             learned_some = 0.0\n"
        );
        assert!(
            read("aimm = 1")
                .unwrap_err()
                .contains("toy has no move `aimm`: its moves are change, point, aim, redraw_any")
        );
    }
}
