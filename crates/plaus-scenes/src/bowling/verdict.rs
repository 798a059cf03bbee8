//! When a shot is over: when it can no longer change which pins stand.

use super::alley::{Alley, END};
use super::measures::{Measures, slant};
use super::pool::Pool;
use super::still::Still;
use glam::DVec3;
use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld};
use plaus_sim::shape::Revolution;
use plaus_sim::{State, WorldError};

/// Height of a pin's axis (as a cosine) below which it is down. Default 0.5, 60° from upright: six times the angle from
/// which it falls by itself.
const FALLEN: f64 = 0.5;

/// A pin is down if the middle of its foot is deeper than this below the deck, in m. Default 0.01: the foot of a pin
/// that leans on the deck is above that; gutters are at least 0.05 deep.
const SUNK: f64 = 0.01;

/// Height in m of a pin's centre of gravity over its foot, for [`Profile::pin`](plaus_sim::shape::Profile::pin); to a
/// millimetre, as `SUNK` needs it.
const BALANCE: f64 = 0.147;

/// Says when a shot on an [`Alley`] is decided.
///
/// A pin is down from the moment at which it leans by more than 60°, its foot is below the deck, or it is gone,
/// whatever it does later. A pin that leans less, held by something, stands. A shot is decided when all pins are down.
/// It is also decided when the ball is gone or at rest, every standing pin stands on the deck with its whole foot, and
/// the moving bodies are too weak to tip any of them. Asked after each event, the verdict ends a shot early:
///
/// ```
/// use glam::DVec3;
/// use plaus_scenes::bowling::{Alley, Verdict};
/// use plaus_sim::{Outcome, Scratch, trace::While};
///
/// let alley = Alley::default();
/// let (world, verdict) = (alley.world()?, Verdict::new(&alley)?);
/// let starts = alley.starts(1.0, 0.06, DVec3::new(-0.4, 7.5, 0.0), DVec3::new(-70.0, -4.0, 0.0))?;
/// let mut state = world.state(&starts)?;
/// let mut until_decided = While(|state: &_| !verdict.is_final(&world, state));
/// let outcome = world.run(&mut state, &mut Scratch::default(), 5.0, &mut until_decided)?;
/// assert!(outcome == Outcome::Stopped && state.time() < 5.0);
/// # Ok::<(), plaus_sim::WorldError>(())
/// ```
///
/// Too weak means: all bodies that move, and those at rest that they may reach, can together free less energy than tips
/// a pin. On the deck, each body's energy is counted down to the lowest possible height of its middle. Added to this is
/// the energy of bodies that may be pushed over an edge or may come up again from gutters and pit, with all that these
/// would free on their floors. It is left out if a body cannot get there, or cannot reach a body on the deck from
/// there.
///
/// Proved, since energy only falls (except for the little that `plaus_sim::rigid` describes): the most energy that
/// a body on the deck can have, and that nothing in gutter or pit comes up with more than that. Bounded: how far a body
/// rolls or slides, from the energy that resistance to rolling takes on the way while it touches (hops are not
/// included); and how far a pin in a gutter reaches over the lane, by a search over its poses. Assumed: that a pin that
/// falls off the gutter's end does not throw up another one, and that a body that has kept to its place for a while,
/// see `still.rs`, stays there unless something comes.
#[derive(Debug, Clone, Copy)]
pub struct Verdict {
    measures: Measures,
    /// Height of a pin's axis, as a cosine, at which it tips; the radius of the circle on which it stands, in m.
    tipped: f64,
    foot: f64,
    /// Least energy in J that a sliding pin loses for each metre of its path.
    slide: f64,
}

impl Verdict {
    /// For shots on this alley.
    ///
    /// # Errors
    /// [`WorldError`] for impossible numbers.
    pub fn new(alley: &Alley) -> Result<Self, WorldError> {
        Ok(Self::of(alley, &alley.pin()?))
    }

    /// The same, with an [`Alley::pin`] made earlier.
    #[must_use]
    pub fn of(alley: &Alley, pin: &Revolution) -> Self {
        let rim = pin.rings()[0];
        let measures = Measures::of(alley, pin);
        let slide = measures.weights[1] * alley.pin_lane.friction;
        Self { measures, tipped: -rim.height / slant(pin), foot: rim.circle, slide }
    }

    /// For shots that differ in the ball.
    #[must_use]
    pub fn with_ball(mut self, alley: &Alley) -> Self {
        self.measures = self.measures.with_ball(alley);
        self
    }

    /// Whether a pin is down at present. A pin that has ever been down counts as down.
    #[must_use]
    pub fn has_fallen(pin: &RigidBodyState) -> bool {
        let up = pin.turn * DVec3::Z;
        pin.phase == Phase::Gone || up.z < FALLEN || pin.path.x.z - BALANCE * up.z < -SUNK
    }

    /// Whether the set of standing pins can no longer change, if no pin has risen again. Body 0 is the ball, the others
    /// are pins.
    #[must_use]
    pub fn is_final(&self, world: &RigidWorld, state: &State<RigidBodyState>) -> bool {
        self.settled(world, state, &Still::default(), |k| Self::has_fallen(&state.bodies()[k])).is_some()
    }

    /// If no pin can fall any more except those that are down: how far in m the middles of the others may still move.
    /// `is_down` is asked about bodies from 1 on.
    #[must_use]
    pub fn settled(
        &self,
        world: &RigidWorld,
        state: &State<RigidBodyState>,
        still: &Still,
        is_down: impl Fn(usize) -> bool,
    ) -> Option<f64> {
        let bodies = state.bodies();
        let mut standing = 0;
        for k in (1..bodies.len()).filter(|k| !is_down(*k)) {
            if !self.stands(&bodies[k]) {
                return None;
            }
            standing |= 1 << k;
        }
        if standing == 0 {
            return Some(0.0);
        }
        let left = Pool { measures: &self.measures, world, state, still, standing }.left()?;
        // How far it slides, and how far its middle leans. The barrier to tipping is concave, so the angle is at most
        // proportional to the energy.
        Some(left / self.slide + left / self.measures.tipping * self.foot)
    }

    /// Whether a pin stands on the deck with its whole foot, and would not tip by itself.
    fn stands(&self, pin: &RigidBodyState) -> bool {
        let up = pin.turn * DVec3::Z;
        let foot = pin.path.x - self.measures.upright * up;
        // It may still be pushed along the deck.
        let margin = self.foot + self.measures.harmless / self.slide;
        up.z >= self.tipped && foot.x.abs() <= 0.5 * Alley::WIDTH - margin && foot.y <= END - margin
    }
}
