//! Pieces of a run: whole chains, divided as evenly as possible, for other machines to work on.
//!
//! A piece is a run of its own: it can be killed, resumed, diagnosed, exported. Its chains keep their numbers in the
//! whole run, and its files have the same bytes as if one machine had run all chains; [`merge`](mod@crate::merge) only
//! puts them side by side.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// One of the pieces that a run is cut into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    piece: u32,
    of: u32,
}

/// Why a text or numbers do not name a piece.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ShardError {
    /// Not two whole numbers.
    #[error("`{0}` names no piece: write PIECE/PIECES, e.g. 3/16")]
    Text(String),
    /// Pieces are numbered from 1.
    #[error("there is no piece {piece} of {of}: pieces are numbered from 1 to {of}")]
    Range {
        /// The piece.
        piece: u32,
        /// How many there are.
        of: u32,
    },
    /// A piece needs at least one chain.
    #[error("{chains} chains cannot be cut into {of} pieces: every piece needs a chain, so ask for at most {chains}")]
    TooMany {
        /// Pieces.
        of: u32,
        /// Chains.
        chains: u32,
    },
}

impl Shard {
    /// Piece number `piece`, counted from 1, of `of`.
    ///
    /// # Errors
    /// [`ShardError::Range`] if there is none.
    pub fn new(piece: u32, of: u32) -> Result<Self, ShardError> {
        if (1..=of).contains(&piece) { Ok(Self { piece, of }) } else { Err(ShardError::Range { piece, of }) }
    }

    /// All pieces that something is cut into, in order.
    pub fn all(of: u32) -> impl Iterator<Item = Self> {
        (1..=of).map(move |piece| Self { piece, of })
    }

    /// Its number, from 1.
    #[must_use]
    pub fn piece(self) -> u32 {
        self.piece
    }

    /// How many pieces there are.
    #[must_use]
    pub fn of(self) -> u32 {
        self.of
    }

    /// Its part of `total` things that are cut into pieces. Here these are chains; batches of particles or of draws are
    /// cut in the same way.
    ///
    /// # Errors
    ///
    /// [`ShardError`] if its part would be empty, or its numbers do not name a piece.
    pub fn range(self, total: u32) -> Result<Range<u32>, ShardError> {
        let Self { piece, of } = Self::new(self.piece, self.of)?;
        if of > total {
            return Err(ShardError::TooMany { of, chains: total });
        }
        let until = |pieces: u32| (u64::from(total) * u64::from(pieces) / u64::from(of)) as u32; // at most `total`
        Ok(until(piece - 1)..until(piece))
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.piece, self.of)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let parts = text.split_once('/').and_then(|(piece, of)| Some((piece.parse().ok()?, of.parse().ok()?)));
        let (piece, of) = parts.ok_or_else(|| ShardError::Text(text.to_owned()))?;
        Self::new(piece, of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_all_chains_once_and_as_even_as_can_be() {
        for total in [1, 2, 7, 16, 1000, 100_000] {
            for of in [1, 2, 3, 7, 16, 999, 100_000].into_iter().filter(|&of| of <= total) {
                let ranges: Vec<_> = Shard::all(of).map(|shard| shard.range(total).unwrap()).collect();
                assert!(ranges[0].start == 0 && ranges.last().unwrap().end == total);
                assert!(ranges.windows(2).all(|pair| pair[0].end == pair[1].start));
                let (least, most) = (total / of, total.div_ceil(of));
                assert!(ranges.iter().all(|range| (least..=most).contains(&(range.len() as u32))));
            }
        }
    }

    #[test]
    fn texts_that_name_no_piece_are_refused() {
        assert_eq!("3/16".parse::<Shard>().map(|shard| shard.to_string()), Ok("3/16".to_owned()));
        for wrong in ["0/0", "0/4", "5/4", "4294967295/1"] {
            assert!(matches!(wrong.parse::<Shard>(), Err(ShardError::Range { .. })), "{wrong}");
        }
        for wrong in ["", "3", "3/", "/4", "-1/4", "1/4/2", "one/4", "1/4294967296"] {
            assert!(matches!(wrong.parse::<Shard>(), Err(ShardError::Text(_))), "{wrong}");
        }
        let many = Shard::new(1, 5).unwrap().range(4).unwrap_err();
        assert_eq!(many, ShardError::TooMany { of: 5, chains: 4 });
        // Read from a manifest that was tampered with.
        let torn: Shard = serde_json::from_str(r#"{"piece":7,"of":2}"#).unwrap();
        assert!(torn.range(10).is_err());
    }
}
