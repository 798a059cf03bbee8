//! When a shot is over: which pins stand can no longer change.

use super::alley::{END, GRAVITY};
use super::pool::Pool;
use super::{Alley, Still};
use crate::error::WorldError;
use crate::rigid::{Phase, Rigid, Turning};
use crate::shape::Revolution;
use crate::state::State;
use glam::DVec3;
use plaus_dist::math;

/// Height of a pin's axis (as a cosine) below which it is down. Default 0.5, 60° from upright: six times the angle from
/// which it falls by itself.
const FALLEN: f64 = 0.5;

/// Depth in m of the middle of a pin's foot below the deck from which on it is down. Default 0.01. One that leans on
/// the deck has it above; gutters are 0.05 and more deep.
const SUNK: f64 = 0.01;

/// Height in m of a pin's centre of gravity over its foot, of [`Profile::pin`](crate::shape::Profile::pin); to a
/// millimetre, as `SUNK` needs it.
const BALANCE: f64 = 0.147;

/// Energy that all that can still meet a standing pin may have together, over that which tips one. Default 0.75: the
/// rest, 9 mJ, is for what lasting contact may add by pushing bodies out of overlaps, 4 mJ at most at a time. Danger:
/// at 1 and more nothing is certain.
const HARMLESS: f64 = 0.75;

/// Angles at which a lying pin's lowest height is looked for: less than 0.1 mm, or 2 mJ, apart. Default 8000.
const ANGLES: u32 = 8000;

/// Way of a pin's middle over that of its farther end where it rolls, in a circle, on belly and head. Default 0.7.
const ENDS: f64 = 0.7;

/// Part of its weight that rests on its head. Default 0.13, as its middle is 26 mm from where the belly touches, and
/// the head 230 mm.
const HEAD: f64 = 0.13;

/// Distance in m along its axis from a pin's middle within which it is convex. Default 0.04: from there to the head it
/// is narrower.
const BELLY: f64 = 0.04;

/// Says when a shot on an [`Alley`] is decided.
///
/// A pin is down from the moment at which it leans by more than 60°, its foot is below the deck, or it is gone,
/// whatever it does later; one that leans less, held by something, stands. A shot is decided when all pins are down; or
/// when the ball is gone or at rest, every other pin stands on the deck with its whole foot, and what moves is too weak
/// to tip any of them. Asked after each event, it ends a shot early:
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
/// Too weak means: what all bodies that move, and those at rest to which they may get, can set free together is less
/// than what tips a pin. On the deck each is counted down to where its middle would be lowest, and so is what it may
/// push over an edge or what may come up again from gutters and pit, with all that these would set free on their
/// floors; unless it can't get there, or can't reach a body on the deck from there.
///
/// Proved, since energy only falls (but for the little that [`rigid`](crate::rigid) tells of): what a body on the deck
/// can have at most, and that nothing in gutter or pit comes up with more than that. Bounded: how far something rolls
/// or slides, from what resistance to rolling takes on the way while it touches (hops are not reckoned with), and how
/// far a pin in a gutter reaches over the lane, by a search over its poses. Assumed: that a pin which falls off the
/// gutter's end does not throw up another one, and that a body which has kept to its place for a while, see [`Still`],
/// stays there if nothing comes.
#[derive(Debug, Clone, Copy)]
pub struct Verdict {
    /// Energy in J that tips a standing pin, and what of it bodies may have that it need not fear.
    tipping: f64,
    pub(super) harmless: f64,
    /// Height of a pin's axis, as a cosine, at which it tips; the radius of the circle on which it stands, in m.
    tipped: f64,
    foot: f64,
    /// Heights in m of the middle of a standing pin, and least ones of one that lies: with all of it over the ground,
    /// and with its middle only.
    pub(super) upright: f64,
    pub(super) lying: f64,
    pub(super) inside: f64,
    /// Distance in m of a pin's farthest point from its middle, and its largest radius.
    pub(super) reach: f64,
    pub(super) widest: f64,
    /// Radius of the ball in m.
    pub(super) ball: f64,
    /// Weights in N of the ball and of a pin.
    pub(super) weights: [f64; 2],
    /// Energy in J that a pin loses at least for each metre of its way while it touches, and while it slides.
    pub(super) roll: f64,
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

    /// The same, with [`Alley::pin`] made before.
    #[must_use]
    pub fn of(alley: &Alley, pin: &Revolution) -> Self {
        let (rim, weight, law) = (pin.rings()[0], alley.pin_mass * GRAVITY, alley.pin_lane);
        let slant = (rim.height * rim.height + rim.circle * rim.circle).sqrt();
        let tipping = weight * (slant + rim.height);
        Self {
            tipping,
            harmless: HARMLESS * tipping,
            tipped: -rim.height / slant,
            foot: rim.circle,
            upright: pin.balance(),
            lying: lying(pin, f64::INFINITY),
            inside: lying(pin, BELLY),
            reach: pin.reach(),
            widest: pin.row().iter().map(|ball| ball.radius).fold(0.0, f64::max),
            ball: alley.ball_radius,
            weights: [alley.ball_mass * GRAVITY, weight],
            roll: weight * (ENDS * law.rolling).min(HEAD * law.friction),
            slide: weight * law.friction,
        }
    }

    /// For shots that differ in the ball.
    #[must_use]
    pub fn with_ball(mut self, alley: &Alley) -> Self {
        self.weights[0] = alley.ball_mass * GRAVITY;
        self.ball = alley.ball_radius;
        self
    }

    /// Whether a pin is down as it is now. One that ever was remains so.
    #[must_use]
    pub fn has_fallen(pin: &Turning) -> bool {
        let up = pin.turn * DVec3::Z;
        pin.phase == Phase::Gone || up.z < FALLEN || pin.path.x.z - BALANCE * up.z < -SUNK
    }

    /// Whether which pins stand can no longer change, where no pin has risen again. Body 0 is the ball, the others are
    /// pins.
    #[must_use]
    pub fn is_final(&self, world: &Rigid, state: &State<Turning>) -> bool {
        self.settled(world, state, &Still::default(), |k| Self::has_fallen(&state.bodies()[k])).is_some()
    }

    /// Once no other pin than those that are down can fall any more: how far in m the middles of the others may still
    /// go. `is_down` is asked of bodies from 1 on.
    #[must_use]
    pub fn settled(
        &self,
        world: &Rigid,
        state: &State<Turning>,
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
        let left = Pool { verdict: self, world, state, still, standing }.left()?;
        // What slides it, and how far its middle leans: tipping takes a concave barrier, so that the angle is at most
        // in proportion to the energy.
        Some(left / self.slide + left / self.tipping * self.foot)
    }

    /// Whether a pin stands on the deck with its whole foot, and would not tip by itself.
    fn stands(&self, pin: &Turning) -> bool {
        let up = pin.turn * DVec3::Z;
        let foot = pin.path.x - self.upright * up;
        // It may still be slid.
        let margin = self.foot + self.harmless / self.slide;
        up.z >= self.tipped && foot.x.abs() <= 0.5 * Alley::WIDTH - margin && foot.y <= END - margin
    }
}

/// The least height of the middle of a pin that lies on the deck, at whatever angle, where only what is so near to its
/// middle along its axis has ground below it.
pub(super) fn lying(pin: &Revolution, near: f64) -> f64 {
    let step = std::f64::consts::PI / f64::from(ANGLES);
    let height = |angle: f64| {
        let (sin, cos) = math::sin_cos(angle);
        let row = pin.row().iter().filter(|ball| ball.centre.z.abs() <= near);
        let rings = pin.rings().iter().filter(|ring| ring.height.abs() <= near);
        let balls = row.map(|ball| ball.radius - ball.centre.z * cos);
        let rings = rings.map(|ring| ring.radius + ring.circle * sin - ring.height * cos);
        balls.chain(rings).fold(0.0, f64::max)
    };
    // Between two angles it is lower by what turning by half a step can lower it at most.
    let least = (0..=ANGLES).map(|k| height(f64::from(k) * step)).fold(f64::INFINITY, f64::min);
    least - 0.5 * step * pin.reach()
}
