//! How exact a scene's simulation is, under the names used in scenario files and commands.

use plaus_sim::{Accuracy, Preset};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A setting between fast and exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AccuracyPreset {
    /// For trying out ideas: contact is coarse.
    Draft,
    /// Outcome distributions agree with the reference within sampling noise.
    #[default]
    Standard,
    /// Trajectories agree with the reference until chaos separates them.
    Fine,
    /// The standard that the others are compared with; slow.
    Reference,
}

impl AccuracyPreset {
    /// All of them, fastest first.
    pub const ALL: [Self; 4] = [Self::Draft, Self::Standard, Self::Fine, Self::Reference];

    /// The simulator's name for it.
    #[must_use]
    pub fn preset(self) -> Preset {
        match self {
            Self::Draft => Preset::Draft,
            Self::Standard => Preset::Standard,
            Self::Fine => Preset::Fine,
            Self::Reference => Preset::Reference,
        }
    }

    /// The simulator's tolerances.
    #[must_use]
    pub fn tolerances(self) -> Accuracy {
        Accuracy::preset(self.preset())
    }

    /// Its name in scenario files.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.preset().name()
    }
}

impl std::str::FromStr for AccuracyPreset {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|one| one.name() == text).ok_or_else(|| {
            let known: Vec<&str> = Self::ALL.map(Self::name).to_vec();
            format!("`{text}` is not an accuracy: write one of {}", known.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_scenario_files() {
        for one in AccuracyPreset::ALL {
            assert_eq!(serde_json::to_string(&one).unwrap(), format!("\"{}\"", one.name()));
            assert_eq!(one.name().parse(), Ok(one));
        }
        assert!("exact".parse::<AccuracyPreset>().unwrap_err().contains("draft, standard, fine, reference"));
    }
}
