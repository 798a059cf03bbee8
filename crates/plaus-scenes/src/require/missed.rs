//! By how much a requirement is missed, in the unit of its keys.

use super::score::FAR;

/// How far from being met something is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Missed {
    /// By so much, in this unit.
    By(f64, &'static str),
    /// What is asked for never happened, or the body that it is about was not there.
    Never,
}

impl Missed {
    /// Of a margin that measures what is lacking in this unit itself, not in nats.
    #[must_use]
    pub fn lacking(margin: f64, unit: &'static str) -> Self {
        if margin <= -FAR { Self::Never } else { Self::By(-margin, unit) }
    }
}

/// What a nat of a margin measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nat {
    /// So much of the unit; 0 if something only happens or does not.
    amount: f64,
    unit: &'static str,
    /// The margin, below 0, at which nothing is lacking but the last step.
    edge: f64,
}

impl Nat {
    /// So much of a unit, of a margin that is 0 at the edge.
    pub(super) fn of(amount: f64, unit: &'static str) -> Self {
        Self { amount, unit, edge: 0.0 }
    }

    /// Nothing: something happens or does not.
    pub(super) const YES_OR_NO: Self = Self { amount: 0.0, unit: "", edge: 0.0 };

    /// The same, of a margin that jumps from `edge` to its opposite.
    pub(super) fn beyond(self, edge: f64) -> Self {
        Self { edge, ..self }
    }

    /// Whether the opposite of what it measures is measured alike.
    pub(super) fn is_smooth(&self) -> bool {
        self.amount > 0.0 && self.edge == 0.0
    }

    /// How much is lacking at a margin below 0.
    pub(super) fn missed(&self, margin: f64) -> Missed {
        let by = (self.edge - margin) * self.amount;
        if by > 0.0 && margin > -FAR { Missed::By(by, self.unit) } else { Missed::Never }
    }
}

/// What all of them measure, if that is one thing.
pub(super) fn shared(each: impl IntoIterator<Item = Option<Nat>>) -> Option<Nat> {
    let mut each = each.into_iter();
    let first = each.next()??;
    each.all(|other| other == Some(first)).then_some(first)
}

#[cfg(test)]
mod tests {
    use crate::require::{Bounces, FAR, Missed, Not, Require, RestsAt, Stands, Touches};

    /// A requirement that is missed by so much has the margin from which that follows.
    #[test]
    fn margins_are_told_in_the_unit_of_the_keys() {
        let at = Require::RestsAt(RestsAt { within_mm: 10.0, scale_mm: 5.0, ..RestsAt::default() });
        // 47 mm away: 37 mm too far.
        assert_eq!(at.missed((10.0 - 47.0) / 5.0), Some(Missed::By(37.0, "mm")));
        assert_eq!(at.missed(-FAR), Some(Missed::Never));
        let upright = Require::Stands(Stands { scale_deg: 10.0, ..Stands::default() });
        assert_eq!(upright.missed(-1.5), Some(Missed::By(15.0, "degrees")));
        // Three bounces asked for, one found: the margin is (1 − 2.5) · 2.
        let bounces = Require::Bounces(Bounces { at_least: Some(3), nats_each: 2.0, ..Bounces::default() });
        assert_eq!(bounces.missed(-3.0), Some(Missed::By(2.0, "bounces")));
        let touches = Require::Touches(Touches { nats: 2.0, scale_mm: 20.0, ..Touches::default() });
        assert_eq!(touches.missed(-2.0 - 30.0 / 20.0), Some(Missed::By(30.0, "mm")));
        assert_eq!(touches.missed(-2.0), Some(Missed::Never), "how far it was is not known");
        let none = Require::Not(Not(Box::new(touches.clone())));
        assert_eq!(none.missed(-2.0), None, "it touched: by how much has no measure");
        let not = Require::Not(Not(Box::new(at.clone())));
        assert_eq!(not.missed(-1.0), Some(Missed::By(5.0, "mm")));
        let both = Require::All(crate::require::All(vec![at.clone(), at.clone()]));
        assert_eq!(both.missed(-1.0), Some(Missed::By(5.0, "mm")));
        let mixed = Require::All(crate::require::All(vec![at, upright]));
        assert_eq!(mixed.missed(-1.0), None, "millimetres or degrees");
    }
}
