//! Moves over sets of variables, for any target that declares its [`Variables`].
//!
//! | move | what it does | log ratio |
//! | --- | --- | --- |
//! | [`RedrawAll`] | draws everything anew | prior of the old draw over that of the new one |
//! | [`Learned`] | draws numbers, all or some of one body, from a density learnt in the warm-up | its density, old over new |
//! | [`RedrawOne`] | draws one variable of a set anew | its old density over its new one |
//! | [`RedrawSome`] | draws each variable of a set anew with some probability | their old densities over their new ones |
//! | [`RedrawGroup`] | draws all variables of one body or part anew | their old densities over their new ones |
//! | [`ShiftHalf`] | gives each variable a uniform step with probability ½ | 0 |
//! | [`ShiftSome`] | shifts each variable in a random direction with some probability | 0 |
//! | [`ShiftOne`] | shifts one variable that the draw has in a random direction | 0 |
//! | [`ShiftAll`] | shifts all variables, by steps of one size or of many | 0 |
//! | [`Step`] | makes one variable take a step that leaves its law invariant | its Gaussian, old value over new |
//! | [`StepAll`] | makes all variables of a set take such a step of one size | the sum of theirs |
//! | [`Favoured`] | changes one variable, rather one that the state favours | the change's; how likely it is chosen, new over old |
//! | [`Swap`] | exchanges the values of two variables of a set | 0 |
//! | [`Symmetry`] | applies a map that is its own reverse, or as likely as its reverse | 0 |
//! | [`Toggle`] | adds or removes optional variables | includes a factor for each one that was left as it was |
//!
//! Each move is tested on a target that has a variable of every law, together with a wrong twin: `tests/library.rs`.

mod favoured;
mod learned;
mod redraw_all;
mod redraw_group;
mod redraw_one;
mod redraw_some;
mod shift_all;
mod shift_half;
mod shift_one;
mod shift_some;
mod sizes;
mod step;
mod step_all;
mod swap;
mod symmetry;
mod toggle;

pub use favoured::{Favoured, Favours};
pub use learned::{Chosen, Learned};
pub use redraw_all::RedrawAll;
pub use redraw_group::RedrawGroup;
pub use redraw_one::RedrawOne;
pub use redraw_some::RedrawSome;
pub use shift_all::{ShiftAll, Stride};
pub use shift_half::ShiftHalf;
pub use shift_one::ShiftOne;
pub use shift_some::ShiftSome;
pub use sizes::{Sizes, normal_step};
pub use step::{Step, Way};
pub use step_all::StepAll;
pub use swap::Swap;
pub use symmetry::{Map, Symmetry};
pub use toggle::Toggle;

use crate::moves::Path;
use crate::target::ModelError;
use crate::vars::{Variables, log_density};
use plaus_dist::{LogRatio, Stream, math, open_unit, standard_normal};

/// Largest number of coordinates of a variable.
const MOST: usize = 3;

/// True with the given probability.
pub fn happens(chance: f64, stream: &mut Stream) -> bool {
    open_unit(stream) < chance
}

/// The place of one of some weights, each as likely as its share of their sum; `None` if rounding passes the last one.
pub fn one_of(weights: impl Iterator<Item = f64> + Clone, stream: &mut Stream) -> Option<usize> {
    let (mut weights, mut left) = (weights.clone(), weights.sum::<f64>() * open_unit(stream));
    weights.position(|weight| {
        left -= weight;
        left < 0.0
    })
}

/// A shift by a length N(0, `sd`) in a uniformly random direction in `axes` dimensions. It is as likely as its
/// opposite.
fn walk(sd: f64, axes: usize, stream: &mut Stream) -> [f64; MOST] {
    // Independent normal components have a uniform direction; they are never all 0.
    let mut direction = [0.0; MOST];
    direction[..axes].iter_mut().for_each(|x| *x = standard_normal(stream));
    let norm = direction[..axes].iter().map(|x| math::square(*x)).sum::<f64>().sqrt();
    let length = sd * standard_normal(stream);
    direction.map(|x| x / norm * length)
}

/// Shifts a variable by a step of a random walk, if the draw has it. Returns whether it has.
fn walk_var<T: Variables>(target: &T, draw: &mut T::Draw, var: usize, sd: f64, stream: &mut Stream) -> bool {
    let Some(values) = target.get_mut(draw, var) else { return false };
    let step = walk(sd, values.len(), stream);
    target.vars().get(var).law.add(&step, values);
    true
}

/// Density of the old values of some variables over that of the new ones.
fn old_over_new<T: Variables>(
    target: &T,
    vars: &[usize],
    from: &T::Draw,
    to: &T::Draw,
) -> Result<LogRatio, ModelError> {
    vars.iter().try_fold(LogRatio::ONE, |ratio, &var| {
        let new = log_density(target, to, var)?;
        if new.is_zero() {
            // The chain rejects it for its prior; no ratio is needed.
            return Ok(ratio);
        }
        Ok(ratio.times(LogRatio::of(log_density(target, from, var)?, new)?)?)
    })
}

/// A bit in a path: set if the step's size did not come from the adapted scale.
const WIDE: u64 = 1 << 63;

/// A path that records where the step's size came from. No ratio depends on that.
#[must_use]
pub fn marked(path: Path, is_wide: bool) -> Path {
    Path(path.0 | if is_wide { WIDE } else { 0 })
}

/// The path without that record.
#[must_use]
pub fn unmarked(path: Path) -> Path {
    Path(path.0 & !WIDE)
}

/// Whether a step's size came from the adapted scale.
#[must_use]
pub fn is_adapted(path: Path) -> bool {
    path.0 & WIDE == 0
}
