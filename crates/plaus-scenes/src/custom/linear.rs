//! Sums of multiples of values: what most formulas come to. The range of a difference of two of them is exact, although
//! values occur in both.

use super::range::Range;
use super::values::Value;

/// A number and multiples of values that are uncertain, each once.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Linear {
    number: f64,
    terms: Vec<(Value, f64)>,
}

impl Linear {
    pub(super) fn number(number: f64) -> Self {
        Self { number, terms: Vec::new() }
    }

    pub(super) fn value(value: Value) -> Self {
        match value {
            Value::Fixed(number) => Self::number(number),
            _ => Self { number: 0.0, terms: vec![(value, 1.0)] },
        }
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

    /// The number, if no value has a part in it.
    pub(super) fn alone(&self) -> Option<f64> {
        self.terms.is_empty().then_some(self.number)
    }

    /// What it may be, if each value may be anything in its range whatever the others are.
    pub(super) fn range(&self, range: impl Fn(Value) -> Range) -> Range {
        let parts = self.terms.iter().map(|&(value, factor)| Range::point(factor).times(range(value)));
        parts.fold(Range::point(self.number), Range::plus)
    }
}

#[cfg(test)]
mod tests {
    use super::super::formula::Formula;
    use super::*;

    /// The range of a difference holds whatever points give; and it is no wider where both are sums of multiples.
    #[test]
    fn differences_are_exact() {
        let ranges = [Range(0.7, 1.4), Range(-2.0, 3.0)];
        let range = |value| ranges[usize::from(value == Value::Drawn(1))];
        for (low, high, exact) in [
            ("a", "2 * a", true),
            ("0.1 + a", "0.1 + a + a", true),
            ("a + b", "b + 3 * a / 2 - 1", true),
            ("-(b - a) * 2", "(a - b) * -(1 + 1)", true),
            ("a + b", "max(a, b) * 0 + b + a", false),
            ("a * b", "a * b + 1", false),
            ("a", "a / b", false),
        ] {
            let [low, high] = [low, high].map(|text| Formula::read(text).unwrap());
            let known = |formula: &Formula| -> Vec<usize> {
                formula.names.iter().map(|name| usize::from(name == "b")).collect()
            };
            let linear = |formula: &Formula| {
                let values: Vec<Linear> =
                    known(formula).into_iter().map(|which| Linear::value(Value::Drawn(which))).collect();
                formula.linear(&values)
            };
            let gap = linear(&high).zip(linear(&low)).map(|(high, low)| high.plus(&low.times(-1.0)).range(range));
            assert_eq!(gap.is_some(), exact);
            let Some(gap) = gap else { continue };
            let mut seen = Range(f64::INFINITY, f64::NEG_INFINITY);
            for corner in 0..4 {
                let point = [ranges[0], ranges[1]].map(|Range(low, high)| [low, high]);
                let point = [point[0][corner & 1], point[1][corner >> 1]];
                let at = |formula: &Formula| {
                    let values: Vec<Range> =
                        known(formula).into_iter().map(|which| Range::point(point[which])).collect();
                    formula.of(&values).0
                };
                let difference = at(&high) - at(&low);
                seen = Range(seen.0.min(difference), seen.1.max(difference));
            }
            // Rounding of a few numbers below 10.
            assert!((seen.0 - gap.0).abs() < 1e-14 && (seen.1 - gap.1).abs() < 1e-14, "{seen:?} {gap:?}");
        }
    }
}
