//! Arithmetic with ranges: the range of a result follows from the ranges of its numbers. A certain number is a range of
//! one point, and stays one.
//!
//! Every operation gives a range that holds all results. It may be too wide if a number occurs twice in a formula.

use plaus_dist::math;

/// All numbers from the first to the second. Not a number at an end: some of what goes in gives no number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Range(pub(super) f64, pub(super) f64);

impl Range {
    /// Nothing that has a value.
    pub(super) const NONE: Self = Self(f64::NAN, f64::NAN);

    pub(super) fn point(value: f64) -> Self {
        Self(value, value)
    }

    /// Whether all that goes in gives a number.
    pub(super) fn is_number(self) -> bool {
        !self.0.is_nan() && !self.1.is_nan()
    }

    fn is_point(self) -> bool {
        self.0 == self.1
    }

    /// One of the two.
    pub(super) fn or(self, other: Self) -> Self {
        if self.is_number() && other.is_number() { Self(self.0.min(other.0), self.1.max(other.1)) } else { Self::NONE }
    }

    pub(super) fn minus(self) -> Self {
        Self(-self.1, -self.0)
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }

    pub(super) fn times(self, other: Self) -> Self {
        if !(self.is_number() && other.is_number()) {
            return Self::NONE;
        }
        // An end that is infinite is none of the numbers, so that 0 of it is 0.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let all = [self.0, self.1].map(|a| [product(a, other.0), product(a, other.1)]);
        let all = [all[0][0], all[0][1], all[1][0], all[1][1]];
        Self(all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(f64::NEG_INFINITY, f64::max))
    }

    pub(super) fn over(self, other: Self) -> Self {
        if !other.is_number() || (other.0 <= 0.0 && other.1 >= 0.0) {
            return Self::NONE;
        }
        if self.is_point() && other.is_point() {
            return Self::point(self.0 / other.0);
        }
        self.times(Self(1.0 / other.1, 1.0 / other.0))
    }

    /// What is left of whole multiples of `other`, from 0 up to it.
    pub(super) fn modulo(self, other: Self) -> Self {
        if !(self.is_number() && other.0 > 0.0) {
            return Self::NONE;
        }
        if self.is_point() && other.is_point() {
            return Self::point(self.0 - other.0 * (self.0 / other.0).floor());
        }
        Self(0.0, other.1)
    }

    /// A function that never falls.
    pub(super) fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        Self(f(self.0), f(self.1))
    }

    pub(super) fn abs(self) -> Self {
        match self {
            Self(low, _) if low >= 0.0 => self,
            Self(_, high) if high <= 0.0 => self.minus(),
            Self(low, high) => Self(0.0, high.max(-low)).checked(low),
        }
    }

    /// Of one whose end is no number, none.
    fn checked(self, end: f64) -> Self {
        if end.is_nan() { Self::NONE } else { self }
    }

    pub(super) fn sqrt(self) -> Self {
        self.rising(f64::sqrt)
    }

    /// A sine or cosine, of degrees.
    pub(super) fn wave(self, f: fn(f64) -> f64) -> Self {
        match self {
            Self(low, _) if self.is_point() => Self::point(f(low.to_radians())),
            _ if self.is_number() => Self(-1.0, 1.0),
            _ => Self::NONE,
        }
    }

    pub(super) fn min(self, other: Self) -> Self {
        self.both(other, f64::min)
    }

    pub(super) fn max(self, other: Self) -> Self {
        self.both(other, f64::max)
    }

    fn both(self, other: Self, f: fn(f64, f64) -> f64) -> Self {
        if !(self.is_number() && other.is_number()) {
            return Self::NONE;
        }
        Self(f(self.0, other.0), f(self.1, other.1))
    }

    /// To a power; whatever is not certain must be positive.
    pub(super) fn pow(self, power: Self) -> Self {
        if self.is_point() && power.is_point() {
            let divides = self.0 == 0.0 && power.0 < 0.0;
            return if divides { Self::NONE } else { Self::point(math::powf(self.0, power.0)) };
        }
        if !(self.0 > 0.0 && power.is_number()) {
            return Self::NONE;
        }
        power.times(Self(math::ln(self.0), math::ln(self.1))).rising(math::exp)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever is drawn from the ranges that go in is held by the range that comes out.
    #[test]
    fn ranges_hold_what_points_give() {
        type Two = fn(Range, Range) -> Range;
        let all: [(&str, Two); 13] = [
            ("+", Range::plus),
            ("*", Range::times),
            ("/", Range::over),
            ("%", Range::modulo),
            ("min", Range::min),
            ("max", Range::max),
            ("pow", Range::pow),
            ("-", |a, _| a.minus()),
            ("abs", |a, _| a.abs()),
            ("sqrt", |a, _| a.sqrt()),
            ("sin", |a, _| a.wave(math::sin)),
            ("floor", |a, _| a.rising(f64::floor)),
            ("exp", |a, _| a.rising(math::exp)),
        ];
        let ends = [-3.5, -1.0, -0.25, 0.0, 0.5, 2.0, 7.0];
        let ranges = || ends.iter().flat_map(|&a| ends.iter().filter(move |b| a <= **b).map(move |&b| Range(a, b)));
        for (name, f) in all {
            let mut counted = 0;
            for (a, b) in ranges().flat_map(|a| ranges().map(move |b| (a, b))) {
                let whole = f(a, b);
                for part in 0..25 {
                    let [s, t] = [f64::from(part % 5) / 4.0, f64::from(part / 5) / 4.0];
                    let point = f(Range::point(a.0 + (a.1 - a.0) * s), Range::point(b.0 + (b.1 - b.0) * t));
                    let slack = 1e-12 * point.0.abs();
                    let inside = point.0 >= whole.0 - slack && point.0 <= whole.1 + slack && point.is_point();
                    assert!(inside || !whole.is_number(), "{name} {a:?} {b:?}: {point:?} is not in {whole:?}");
                    counted += u32::from(inside);
                }
            }
            assert!(counted > 1000, "{name}: refused nearly everywhere");
        }
    }

    #[test]
    fn what_may_be_no_number_is_none() {
        assert!(!Range(1.0, 2.0).over(Range(-1.0, 1.0)).is_number());
        assert!(!Range(-1.0, 4.0).sqrt().is_number());
        assert!(!Range(-1.0, 4.0).pow(Range::point(0.5)).is_number());
        assert!(!Range::NONE.times(Range::point(0.0)).is_number());
    }
}
