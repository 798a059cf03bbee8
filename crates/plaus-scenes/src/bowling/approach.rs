//! Where a delivery would lead without pins and gutters.

use super::draw::Shot;
use super::lane::{LENGTH, Lane};
use super::release::Quantity;
use plaus_mcmc::ModelError;
use plaus_sim::motion::Parabola;
use plaus_sim::rigid::{RigidBodyState, RigidWorld};
use plaus_sim::trace::Observer;
use plaus_sim::{Scratch, State};

impl Lane {
    /// How far the ball has moved to the side when its centre is first at each of these distances beyond the head pin's
    /// spot, in m, in ascending order; `None` if it does not get there during a shot. It depends neither on its place
    /// across the lane nor on the pins.
    pub(super) fn approach(&self, draw: &Shot, distances: &[f64]) -> Result<Option<Vec<f64>>, ModelError> {
        let mut draw = draw.clone();
        draw.ball[Quantity::Across as usize] = 0.0;
        let alley = self.alley(&draw);
        let world = alley.practice().map_err(ModelError::new)?;
        let mut state = world.state(&[Self::start(&draw, LENGTH)]).map_err(ModelError::new)?;
        let Some(farthest) = distances.last() else { return Ok(Some(Vec::new())) };
        let mut way = Way { pieces: Vec::new(), beyond: *farthest };
        world.run(&mut state, &mut Scratch::default(), alley.duration, &mut way).map_err(ModelError::new)?;
        Ok(distances.iter().map(|distance| way.across(*distance, alley.duration)).collect())
    }
}

/// The ball's motions until one begins beyond a distance.
struct Way {
    pieces: Vec<Parabola>,
    beyond: f64,
}

impl Way {
    /// Place across the lane where the distance is first reached.
    fn across(&self, distance: f64, until: f64) -> Option<f64> {
        let ends = self.pieces.iter().skip(1).map(|next| next.t).chain([until]);
        self.pieces.iter().zip(ends).find_map(|(piece, end)| {
            let time = first_at(piece, distance)?;
            (time <= end - piece.t).then(|| piece.after(time).x)
        })
    }
}

/// How long after its start a motion first has this y, if ever.
fn first_at(piece: &Parabola, y: f64) -> Option<f64> {
    let (left, speed, half) = (y - piece.x.y, piece.v.y, 0.5 * piece.a.y);
    if left <= 0.0 {
        return Some(0.0);
    }
    // left = speed t + half t²; this form of the root does not cancel.
    let root = (speed * speed + 4.0 * half * left).sqrt();
    let time = 2.0 * left / (speed + root);
    (time >= 0.0 && time.is_finite()).then_some(time)
}

impl Observer<RigidWorld> for Way {
    fn motion(&mut self, _: usize, body: &RigidBodyState) {
        self.pieces.push(body.path);
    }

    fn proceed(&mut self, _: &State<RigidBodyState>) -> bool {
        self.pieces.last().is_none_or(|piece| piece.x.y < self.beyond)
    }
}
