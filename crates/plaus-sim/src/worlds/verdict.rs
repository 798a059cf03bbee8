//! When a shot is over: which pins stand can no longer change.

use super::Alley;
use super::alley::{END, GRAVITY};
use crate::error::WorldError;
use crate::mechanics::Mechanics;
use crate::rigid::{Phase, Rigid, Turning};
use crate::shape::Revolution;
use crate::state::State;
use glam::DVec3;

/// Height of a pin's axis (as a cosine) below which it has fallen for good. Default 0.5, 60° from upright: six times the angle from which it falls by itself. Danger: larger
/// values count pins as fallen that a wall or another pin may still set upright again.
const FALLEN: f64 = 0.5;

/// Energy that bodies moving on the deck may still have together, over that which tips a standing pin. Default 0.5.
const HARMLESS: f64 = 0.5;

/// Way in m that the ball's middle is beyond the deck's end when it can no longer come back. Default 0.11, its radius.
const PAST: f64 = 0.11;

/// Says when a shot on an [`Alley`] is decided.
///
/// Decided means: every pin is gone, has fallen or is at rest, and nothing that moves has the energy to tip one that stands. Asked after each event, it ends a shot early:
///
/// ```
/// use glam::DVec3;
/// use plaus_sim::worlds::{Alley, Verdict};
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
/// What it leaves to chance: that a fallen pin is set upright again, and that a ball in the pit rebounds onto the deck. The example `pins` counts the shots whose
/// standing pins differ from those after the whole run.
#[derive(Debug, Clone, Copy)]
pub struct Verdict {
    /// Energy in J that tips a standing pin.
    tipping: f64,
    /// Mass in kg and least height in m of the middle on the deck, of the ball and of a pin.
    lowest: [(f64, f64); 2],
}

impl Verdict {
    /// For shots on this alley.
    ///
    /// # Errors
    /// [`WorldError`] for impossible numbers.
    pub fn new(alley: &Alley) -> Result<Self, WorldError> {
        Ok(Self::of(alley, &alley.pin()?))
    }

    /// The same, with [`Alley::pin`] made before.
    #[must_use]
    pub fn of(alley: &Alley, pin: &Revolution) -> Self {
        let rim = pin.rings()[0];
        let raised = (rim.height * rim.height + rim.circle * rim.circle).sqrt() + rim.height;
        // A pin that lies rests on its belly and its head: its middle is no lower than the thinner of them is thick.
        let head = pin.row().last().map_or(0.0, |cap| cap.radius);
        let lowest = [(alley.ball_mass, alley.ball_radius), (alley.pin_mass, head)];
        Self { tipping: alley.pin_mass * GRAVITY * raised, lowest }
    }

    /// Whether a pin has fallen for good, or is gone.
    #[must_use]
    pub fn has_fallen(pin: &Turning) -> bool {
        pin.phase == Phase::Gone || (pin.turn * DVec3::Z).z < FALLEN
    }

    /// Whether which pins stand can no longer change. Body 0 is the ball, the others are pins.
    #[must_use]
    pub fn is_final(&self, world: &Rigid, state: &State<Turning>) -> bool {
        let mut standing = false;
        for pin in state.bodies().iter().skip(1) {
            let has_fallen = Self::has_fallen(pin);
            if !has_fallen && pin.phase != Phase::Rest {
                return false;
            }
            standing |= !has_fallen;
        }
        !standing || self.is_calm(world, state)
    }

    /// Whether all that moves has too little energy on the deck to tip a pin.
    fn is_calm(&self, world: &Rigid, state: &State<Turning>) -> bool {
        let mut left = 0.0;
        for (k, body) in state.bodies().iter().enumerate() {
            if world.is_resting(body) || is_out(k == 0, body) {
                continue;
            }
            // Over what it has at least with its middle on the deck; a pin in a gutter may have less.
            let (mass, low) = self.lowest[usize::from(k > 0)];
            left += (world.energy(k, body) - mass * GRAVITY * low).max(0.0);
        }
        left <= HARMLESS * self.tipping
    }
}

/// Whether a body has left the deck for the pit.
fn is_out(is_ball: bool, body: &Turning) -> bool {
    let beyond = body.path.x.y - END;
    beyond > 0.0 && body.path.x.z < 0.0 || is_ball && beyond > PAST
}
