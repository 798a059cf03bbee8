//! Names of recorded draws.

use serde::{Deserialize, Serialize};

/// A phase of a chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChainPhase {
    /// Before sampling, while moves and ladders are adapted; tables and diagnostics leave it out.
    Warmup,
    /// The sampling phase. Its recorded draws are numbered from 0.
    #[default]
    Sampling,
}

impl ChainPhase {
    /// Whether statistics use its draws.
    #[must_use]
    pub fn is_sampling(&self) -> bool {
        *self == Self::Sampling
    }
}

/// A recorded draw. As text, `0:17` is draw 17 of chain 0, and `0:w17` is draw 17 of its warm-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct SampleId {
    /// Its chain.
    pub chain: u32,
    /// Where it was recorded.
    #[serde(skip_serializing_if = "ChainPhase::is_sampling")]
    pub phase: ChainPhase,
    /// Its number in that phase, from 0: as in the table of `plaus export`.
    pub draw: u64,
}

impl std::fmt::Display for SampleId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mark = if self.phase.is_sampling() { "" } else { "w" };
        write!(f, "{}:{mark}{}", self.chain, self.draw)
    }
}

impl std::str::FromStr for SampleId {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let parse = |(chain, draw): (&str, &str)| {
            let (phase, draw) =
                draw.strip_prefix('w').map_or((ChainPhase::Sampling, draw), |draw| (ChainPhase::Warmup, draw));
            Some(Self { chain: chain.parse().ok()?, phase, draw: draw.parse().ok()? })
        };
        let wrong =
            || format!("`{text}` names no sample: write CHAIN:DRAW, e.g. 0:17, or 0:w17 for one from the warm-up");
        text.split_once(':').and_then(parse).ok_or_else(wrong)
    }
}
