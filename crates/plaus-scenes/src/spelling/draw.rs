//! What is random: vertex offsets and drop positions.

use super::Spelling;
use crate::in_place::clone_in_place;
use plaus_mcmc::{Law, Offset, Rectangle, Var, Variables, Vars};
use serde::{Deserialize, Serialize};

/// The values of all random variables, in millimetres.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Drops {
    /// Offset of each random partition vertex.
    pub offsets: Vec<[f64; 3]>,
    /// Where each ball is dropped; `None` if it is not.
    pub balls: Vec<Option<[f64; 2]>>,
}

impl Drops {
    /// Number of balls that are dropped.
    #[must_use]
    pub fn active(&self) -> usize {
        self.balls.iter().flatten().count()
    }
}

clone_in_place!(Drops { offsets, balls });

/// The variables: offsets of the vertices, cut off far out, then drop positions, each ball dropped with probability ½.
///
/// The paper's `Π 1/a` over the balls that are dropped is this law: a ball has weight ∫ 1/a = 1 in either state.
pub(super) fn vars(vertices: usize, offset: &Offset<3>, balls: usize, rectangle: &Rectangle) -> Vars {
    let vertex = |k| Var::new("offset", "mm", Law::Space(offset.clone())).of("vertex", k as u32);
    let ball = |k| Var::new("drop", "mm", Law::Rectangle(rectangle.clone())).of("ball", k as u32).optional();
    Vars::new((0..vertices).map(vertex).chain((0..balls).map(ball)).collect())
}

impl Variables for Spelling {
    fn vars(&self) -> &Vars {
        &self.vars
    }

    fn get<'a>(&self, draw: &'a Drops, var: usize) -> Option<&'a [f64]> {
        match var.checked_sub(draw.offsets.len()) {
            None => Some(&draw.offsets[var]),
            Some(ball) => draw.balls[ball].as_ref().map(<[f64; 2]>::as_slice),
        }
    }

    fn get_mut<'a>(&self, draw: &'a mut Drops, var: usize) -> Option<&'a mut [f64]> {
        match var.checked_sub(draw.offsets.len()) {
            None => Some(&mut draw.offsets[var]),
            Some(ball) => draw.balls[ball].as_mut().map(<[f64; 2]>::as_mut_slice),
        }
    }

    fn set_present(&self, draw: &mut Drops, var: usize, present: bool) {
        if let Some(ball) = var.checked_sub(draw.offsets.len()) {
            draw.balls[ball] = present.then_some([0.0; 2]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spelling::Config;
    use plaus_dist::math;
    use plaus_mcmc::Target;

    #[test]
    fn the_density_is_that_of_appendix_b() {
        let scene = Spelling::new(&Config::default()).unwrap();
        let log = |offset: f64, balls: [Option<[f64; 2]>; 3]| {
            let mut draw = Drops { offsets: vec![[0.0; 3]; 48], balls: vec![None; 10] };
            draw.offsets[1][1] = offset;
            draw.balls[..3].copy_from_slice(&balls);
            scene.log_prior(&draw).unwrap().value()
        };
        let here = Some([50.0, 50.0]);
        // One ball more: 1/a. One standard deviation: e^(−1/2). Sums of some hundred nats.
        let area = math::ln(126.0 * 86.0);
        assert!((log(0.0, [here, None, here]) - log(0.0, [here, None, None]) + area).abs() < 1e-11);
        assert!((log(0.1, [None; 3]) - log(0.0, [None; 3]) + 0.5).abs() < 1e-11);
        assert_eq!(log(0.81, [None; 3]), f64::NEG_INFINITY);
        assert_eq!(log(0.0, [Some([6.9, 50.0]), None, None]), f64::NEG_INFINITY);
    }
}
