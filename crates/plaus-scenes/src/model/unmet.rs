//! A move that favours the variables on which unmet requirements depend.

use plaus_mcmc::Variables;
use plaus_mcmc::library::{Favoured, Favours, Sizes};

/// The least size of steps of all scales.
pub(super) const FINEST: f64 = 1e-3;

/// How many times as often as another variable one is chosen that an unmet requirement depends on.
const BY: f64 = 8.0;

/// How often the variable is drawn anew; otherwise it makes a step.
const ANEW: f64 = 0.4;

/// The move. A scene whose table lists it offers it with nothing favoured; under requirements it is replaced by one
/// that knows them.
pub(crate) fn unmet<T: Variables>(target: &T, favours: Favours<T>) -> Favoured<T> {
    let among = target.vars().which(|_| true);
    Favoured { name: "unmet", among, favours, by: BY, anew: ANEW, sizes: Sizes::new(FINEST, 1.0) }
}
