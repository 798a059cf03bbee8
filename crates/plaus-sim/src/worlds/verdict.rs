//! When a shot is over: which pins stand can no longer change.

use super::Alley;
use super::alley::{END, GRAVITY};
use crate::error::WorldError;
use crate::mechanics::Mechanics;
use crate::rigid::{Phase, Rigid, Turning};
use crate::shape::Revolution;
use crate::state::State;
use glam::DVec3;
use plaus_dist::math;

/// Height of a pin's axis (as a cosine) below which it has fallen for good. Default 0.5, 60° from upright: six times the angle from which it falls by itself. Danger: larger
/// values count pins as fallen that a wall or another pin may still set upright again.
const FALLEN: f64 = 0.5;

/// Energy that bodies moving on the deck may still have together, over that which tips a standing pin. Default 0.5.
const HARMLESS: f64 = 0.5;

/// Angles at which a lying pin's lowest height is looked for: less than 0.1 mm, or 2 mJ, apart. Default 8000.
const ANGLES: u32 = 8000;

/// How far in m below that of a standing pin the middle of one may be that still counts as on the deck. Default 0.01; gutters are 0.05 and more deep.
const SUNK: f64 = 0.01;

/// Way in m that the ball's middle is beyond the deck's end when it can no longer come back. Default 0.11, its radius.
const PAST: f64 = 0.11;

/// Says when a shot on an [`Alley`] is decided.
///
/// Decided means: every pin is gone, has fallen, or stands on its foot, and all that moves, pins that still rock included, has too little energy together to tip one that
/// stands; nothing gains any. Where a standing pin is slid by so little, it may go on for a few millimetres. Asked after each event, it ends a shot early:
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
    /// Height of a pin's axis, as a cosine, at which it tips.
    tipped: f64,
    /// Weight in N, and least height in m of the middle of what lies on the deck: of the ball and of a pin.
    lowest: [(f64, f64); 2],
    /// Height of a standing pin's middle in m.
    upright: f64,
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
        let (rim, weight) = (pin.rings()[0], alley.pin_mass * GRAVITY);
        let slant = (rim.height * rim.height + rim.circle * rim.circle).sqrt();
        Self {
            tipping: weight * (slant + rim.height),
            tipped: -rim.height / slant,
            lowest: [(0.0, 0.0), (weight, lying(pin))],
            upright: pin.balance(),
        }
        .with_ball(alley)
    }

    /// For shots that differ in the ball.
    #[must_use]
    pub fn with_ball(mut self, alley: &Alley) -> Self {
        self.lowest[0] = (alley.ball_mass * GRAVITY, alley.ball_radius);
        self
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
        for pin in state.bodies().iter().skip(1).filter(|pin| !Self::has_fallen(pin)) {
            // Not at rest it may only rock: not lean farther than it tips from, nor be on its way into gutter or pit.
            let leans = (pin.turn * DVec3::Z).z < self.tipped || pin.path.x.z < self.upright - SUNK;
            if pin.phase != Phase::Rest && leans {
                return false;
            }
            standing = true;
        }
        !standing || self.is_calm(world, state)
    }

    /// Whether all that moves has too little energy on the deck to tip a pin.
    fn is_calm(&self, world: &Rigid, state: &State<Turning>) -> bool {
        let harmless = HARMLESS * self.tipping;
        let mut left = 0.0;
        for (k, body) in state.bodies().iter().enumerate() {
            if world.is_resting(body) || is_out(k == 0, body) {
                continue;
            }
            // Over what it has at least with its middle on the deck; a pin in a gutter may have less.
            let (weight, low) = self.lowest[usize::from(k > 0)];
            let low = if k > 0 && !Self::has_fallen(body) { self.upright } else { low };
            left += (world.energy(k, body) - weight * low).max(0.0);
            if left > harmless {
                return false;
            }
        }
        true
    }
}

/// The least height of the middle of a pin that lies on the deck, at whatever angle.
fn lying(pin: &Revolution) -> f64 {
    let step = std::f64::consts::PI / f64::from(ANGLES);
    let height = |angle: f64| {
        let (sin, cos) = math::sin_cos(angle);
        let balls = pin.row().iter().map(|ball| ball.radius - ball.centre.z * cos);
        let rings = pin.rings().iter().map(|ring| ring.radius + ring.circle * sin - ring.height * cos);
        balls.chain(rings).fold(0.0, f64::max)
    };
    // Between two angles it is lower by what turning by half a step can lower it at most.
    let least = (0..=ANGLES).map(|k| height(f64::from(k) * step)).fold(f64::INFINITY, f64::min);
    least - 0.5 * step * pin.reach()
}

/// Whether a body has left the deck for the pit.
fn is_out(is_ball: bool, body: &Turning) -> bool {
    let beyond = body.path.x.y - END;
    beyond > 0.0 && body.path.x.z < 0.0 || is_ball && beyond > PAST
}
