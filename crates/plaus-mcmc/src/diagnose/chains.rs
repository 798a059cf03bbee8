//! The draws, checked once, and their split into halves.

use std::cmp::Ordering;

/// Fewest draws per chain any diagnostic accepts: two in each half.
pub const MIN_DRAWS: usize = 4;

/// Why draws cannot be diagnosed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DiagnoseError {
    /// There is no chain at all.
    #[error("no chains to diagnose")]
    NoChains,
    /// Chains must have one length.
    #[error("chain {chain} holds {found} draws, chain 0 holds {expected}: chains must be equally long")]
    UnequalLengths {
        /// Index of the first chain of another length.
        chain: usize,
        /// Draws in chain 0.
        expected: usize,
        /// Draws in that chain.
        found: usize,
    },
    /// Too few draws to split the chains.
    #[error("{found} draws per chain: diagnostics need at least {MIN_DRAWS}")]
    TooFewDraws {
        /// Draws per chain.
        found: usize,
    },
    /// A draw is NaN or infinite, so means and variances are undefined.
    #[error("draw {draw} of chain {chain} is {value}: diagnostics need finite draws")]
    NotFinite {
        /// Index of the chain.
        chain: usize,
        /// Index of the draw in its chain.
        draw: usize,
        /// NaN, +∞ or −∞.
        value: f64,
    },
}

/// One row per chain, all finite, equally long, at least [`MIN_DRAWS`] draws each.
///
/// Rows have an order of their own, by content. So sums over chains are the same to the last bit, whatever the order of
/// the chains; and where such a sum is compared with 0, that order cannot decide through rounding.
pub(super) struct Chains<'a> {
    rows: Vec<&'a [f64]>,
}

impl<'a> Chains<'a> {
    pub(super) fn new<C: AsRef<[f64]>>(chains: &'a [C]) -> Result<Self, DiagnoseError> {
        let mut rows: Vec<&[f64]> = chains.iter().map(AsRef::as_ref).collect();
        let expected = rows.first().ok_or(DiagnoseError::NoChains)?.len();
        if let Some((chain, row)) = rows.iter().enumerate().find(|(_, row)| row.len() != expected) {
            return Err(DiagnoseError::UnequalLengths { chain, expected, found: row.len() });
        }
        if expected < MIN_DRAWS {
            return Err(DiagnoseError::TooFewDraws { found: expected });
        }
        for (chain, row) in rows.iter().enumerate() {
            if let Some(draw) = row.iter().position(|x| !x.is_finite()) {
                return Err(DiagnoseError::NotFinite { chain, draw, value: row[draw] });
            }
        }
        rows.sort_by(|a, b| in_order(a, b));
        Ok(Self { rows })
    }

    /// The whole chains.
    pub(super) fn rows(&self) -> &[&'a [f64]] {
        &self.rows
    }

    /// First halves, then second halves.
    pub(super) fn halves(&self) -> Vec<&'a [f64]> {
        halves(&self.rows)
    }

    pub(super) fn chain_count(&self) -> usize {
        self.rows.len()
    }

    pub(super) fn draws_per_chain(&self) -> usize {
        self.rows[0].len()
    }
}

/// By the first draw that differs.
fn in_order(a: &[f64], b: &[f64]) -> Ordering {
    let mut pairs = a.iter().zip(b).map(|(x, y)| x.total_cmp(y));
    pairs.find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

/// First halves of all rows, then their second halves; the middle draw of an odd number belongs to neither.
pub(super) fn halves<'a>(rows: &[&'a [f64]]) -> Vec<&'a [f64]> {
    let first = rows.iter().map(|row| &row[..row.len() / 2]);
    let second = rows.iter().map(|row| &row[row.len() - row.len() / 2..]);
    first.chain(second).collect()
}

/// Views a flat table as rows of one length.
pub(super) fn as_rows(table: &[f64], length: usize) -> Vec<&[f64]> {
    table.chunks_exact(length).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_draws_are_named() {
        let none: [Vec<f64>; 0] = [];
        assert_eq!(Chains::new(&none).err(), Some(DiagnoseError::NoChains));
        let short = [vec![1.0, 2.0, 3.0]];
        assert_eq!(Chains::new(&short).err(), Some(DiagnoseError::TooFewDraws { found: 3 }));
        let ragged = [vec![0.0; 5], vec![0.0; 5], vec![0.0; 4]];
        let expected = DiagnoseError::UnequalLengths { chain: 2, expected: 5, found: 4 };
        assert_eq!(Chains::new(&ragged).err(), Some(expected));
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let chains = [vec![0.0; 4], vec![0.0, 0.0, 0.0, value]];
            let error = Chains::new(&chains).err();
            assert!(matches!(error, Some(DiagnoseError::NotFinite { chain: 1, draw: 3, .. })), "{error:?}");
        }
    }

    #[test]
    fn an_odd_chain_loses_its_middle_draw() {
        let draws = [[0.0, 1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0, 9.0]];
        let halves = Chains::new(&draws).map(|chains| chains.halves());
        assert_eq!(halves, Ok(vec![&[0.0, 1.0][..], &[5.0, 6.0], &[3.0, 4.0], &[8.0, 9.0]]));
    }
}
