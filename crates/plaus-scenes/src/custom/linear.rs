//! Sums of multiples of values: what most formulas come to. The range of a difference of two of them is exact, although
//! values occur in both.

use super::range::Range;

/// A number and multiples of values that are uncertain, each once.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Linear<V> {
    number: f64,
    terms: Vec<(V, f64)>,
}

impl<V: Copy + PartialEq> Linear<V> {
    pub(super) fn number(number: f64) -> Self {
        Self { number, terms: Vec::new() }
    }

    pub(super) fn value(value: V) -> Self {
        Self { number: 0.0, terms: vec![(value, 1.0)] }
    }

    pub(super) fn plus(mut self, other: &Self) -> Self {
        self.number += other.number;
        for &(value, factor) in &other.terms {
            match self.terms.iter_mut().find(|(known, _)| *known == value) {
                Some((_, sum)) => *sum += factor,
                None => self.terms.push((value, factor)),
            }
        }
        self.terms.retain(|&(_, factor)| factor != 0.0);
        self
    }

    pub(super) fn times(mut self, factor: f64) -> Self {
        self.number *= factor;
        self.terms.iter_mut().for_each(|(_, multiple)| *multiple *= factor);
        self.terms.retain(|&(_, factor)| factor != 0.0);
        self
    }

    /// The values with their factors.
    pub(super) fn terms(&self) -> &[(V, f64)] {
        &self.terms
    }

    /// The number, if no value has a part in it.
    pub(super) fn alone(&self) -> Option<f64> {
        self.terms.is_empty().then_some(self.number)
    }

    /// What it may be, if each value may be anything in its range whatever the others are.
    pub(super) fn range(&self, range: impl Fn(V) -> Range) -> Range {
        let parts = self.terms.iter().map(|&(value, factor)| Range::point(factor).times(range(value)));
        parts.fold(Range::point(self.number), Range::plus)
    }
}
