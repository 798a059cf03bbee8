//! What makes solutions different in kind: a list of features, the same for all scenes. Two solutions count as one if
//! all their features agree. Whole numbers (bins, faces, what met what) agree if they are equal; places agree if they
//! lie in the same cell, whose width the scene states and a scenario's `distinct_scale` multiplies.

use crate::scene::Scene;
use plaus_mcmc::{SolutionClass, StateRefOf};

/// The features of one solution, one after another.
#[derive(Debug, Clone, Copy)]
pub struct Features {
    class: SolutionClass,
    scale: f64,
}

impl Features {
    /// A whole number.
    #[inline]
    pub fn number(&mut self, number: i64) {
        self.class = self.class.with(number);
    }

    /// A place along one axis, in widths of its cell.
    #[inline]
    pub fn place(&mut self, in_cells: f64) {
        self.number((in_cells / self.scale).floor() as i64);
    }
}

/// The class of a state with cells `scale` times as wide; `None` if it is no solution.
pub(crate) fn class<S: Scene>(scene: &S, state: StateRefOf<'_, S>, scale: f64) -> Option<SolutionClass> {
    let mut features = Features { class: SolutionClass::EMPTY, scale };
    scene.features(state, &mut features).then_some(features.class)
}
