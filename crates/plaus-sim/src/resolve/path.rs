//! The way of an impact's velocities over its normal impulse (Darboux and Keller's equations), step by step.
//!
//! While the friction force is constant, because the contact sticks or its slip keeps its direction, velocities are linear in the impulse and a step ends exactly where it is to.
//! Elsewhere Kutta's third-order rule is used; between the ends of such a step velocities are the cubics with its values and slopes, so that where it is to end is found without
//! another step, and the change of velocity is that of the impulse there.

use super::ContactMatrix;
use crate::roots::refine;
use glam::{DVec2, DVec3};

/// What ended a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// Nothing: the way goes on.
    Open,
    /// Nothing ever will.
    Never,
    /// The normal velocity has changed its sign.
    Turned,
    /// All that is to come back has come back.
    Released,
}

/// A point of the way.
#[derive(Debug, Clone, Copy)]
struct Place {
    slip: DVec2,
    normal: f64,
    friction: DVec2,
    work: f64,
    load: f64,
}

/// Rates over the normal impulse, and the friction force per unit normal force that makes them.
#[derive(Debug, Clone, Copy)]
struct Rate {
    slip: DVec2,
    normal: f64,
    friction: DVec2,
}

/// The way so far.
pub(super) struct Path<'k> {
    k: &'k ContactMatrix,
    friction: f64,
    turn: f64,
    /// Relative speed at the start.
    speed: f64,
    /// The force that holds a stuck contact, where friction can.
    holding: Option<DVec2>,
    at: Place,
    /// Rates there, of a contact that slips; found when they are needed.
    rate: Option<Rate>,
}

/// Sideways velocity, over the speed and the square of the largest turn of a step, with which slip that is about to stop may be taken to stop. Default 1e-2: at turns of 0.3
/// a thousandth of the speed, as the steps' own error.
const STOPS: f64 = 1e-2;

/// Part of the slip that a step may take. Default 0.5.
const SHRINKS: f64 = 0.5;

/// How much farther than it is expected to be needed a step goes. Default 1.1; one that falls short costs another.
const FARTHER: f64 = 1.1;

/// Turn over change of the slip's rate below which it keeps its direction: rounding.
const STRAIGHT: f64 = 1e-12;

impl<'k> Path<'k> {
    pub(super) fn new(k: &'k ContactMatrix, u: DVec3, friction: f64, turn: f64) -> Self {
        let holding = k.holding();
        let at = Place { slip: u.truncate(), normal: u.z, friction: DVec2::ZERO, work: 0.0, load: 0.0 };
        let holding = (holding.length() <= friction).then_some(holding);
        Self { k, friction, turn, speed: u.length(), holding, at, rate: None }
    }

    /// Normal work so far, negative while compressing.
    pub(super) fn work(&self) -> f64 {
        self.at.work
    }

    pub(super) fn impulse(&self) -> DVec3 {
        self.at.friction.extend(self.at.load)
    }

    fn rate_under(&self, friction: DVec2) -> Rate {
        let (slip, normal) = self.k.rate(friction);
        Rate { slip, normal, friction }
    }

    fn slipping(&self, slip: DVec2) -> Rate {
        self.rate_under(slip * (-self.friction / slip.length()))
    }

    /// One step, until the normal velocity changes its sign or, where that is given, the work has grown to `released`. Slip of at most `tiny` is none.
    pub(super) fn step(&mut self, tiny: f64, released: Option<f64>) -> End {
        if self.friction == 0.0 {
            return self.straight(&self.rate_under(DVec2::ZERO), f64::INFINITY, released);
        }
        let speed = self.at.slip.length();
        if speed <= tiny {
            return match self.holding {
                Some(force) => self.straight(&Rate { slip: DVec2::ZERO, ..self.rate_under(force) }, f64::INFINITY, released),
                None => {
                    let force = -self.k.escape(self.friction) * self.friction;
                    self.straight(&self.rate_under(force), f64::INFINITY, released)
                }
            };
        }
        let rate = self.rate.unwrap_or_else(|| self.slipping(self.at.slip));
        let u = self.at.slip / speed;
        let (along, across) = (u.dot(rate.slip), u.perp_dot(rate.slip).abs());
        let is_straight = across <= STRAIGHT * rate.slip.length();
        let stop = if along < 0.0 { -speed / along } else { f64::INFINITY };
        // Friction that can hold draws the slip to its end ever straighter.
        let closes = self.holding.is_some() && across * stop <= STOPS * self.turn * self.turn * self.speed;
        if is_straight || closes {
            return self.straight(&rate, stop, released);
        }
        let longest = (self.turn * speed / across).min(SHRINKS * stop);
        self.curved(&rate, longest, released)
    }

    /// A step under a constant force; slip is gone at `stop`.
    fn straight(&mut self, rate: &Rate, stop: f64, released: Option<f64>) -> End {
        let at = self.at;
        let (end, why) = at.until(rate.normal, released);
        let step = end.min(stop);
        if !step.is_finite() {
            return End::Never;
        }
        self.rate = None;
        self.at = Place {
            slip: if step == stop { DVec2::ZERO } else { at.slip + rate.slip * step },
            normal: at.normal + rate.normal * step,
            friction: at.friction + rate.friction * step,
            work: at.work + step * (at.normal + 0.5 * rate.normal * step),
            load: at.load + step,
        };
        if step < end { End::Open } else { why }
    }

    /// A step of Kutta's rule of at most this length.
    fn curved(&mut self, first: &Rate, longest: f64, released: Option<f64>) -> End {
        let at = self.at;
        let (expected, why) = at.until(first.normal, released);
        if expected == 0.0 {
            return why;
        }
        let h = longest.min(FARTHER * expected);
        let second = self.slipping(at.slip + first.slip * (0.5 * h));
        let third = self.slipping(at.slip + (second.slip * 2.0 - first.slip) * h);
        let sixth = h / 6.0;
        let ahead = Place {
            slip: at.slip + (first.slip + second.slip * 4.0 + third.slip) * sixth,
            normal: at.normal + (first.normal + 4.0 * second.normal + third.normal) * sixth,
            friction: at.friction + (first.friction + second.friction * 4.0 + third.friction) * sixth,
            work: at.work,
            load: at.load + h,
        };
        let last = self.slipping(ahead.slip);
        // The normal velocity after a part x of the step: a cubic; and the work, its integral.
        let rise = ahead.normal - at.normal;
        let c1 = h * first.normal;
        let (c2, c3) = (3.0 * rise - h * (2.0 * first.normal + last.normal), h * (first.normal + last.normal) - 2.0 * rise);
        let normal = |x: f64| at.normal + x * (c1 + x * (c2 + x * c3));
        let work = |x: f64| at.work + h * x * (at.normal + x * (c1 / 2.0 + x * (c2 / 3.0 + x * c3 / 4.0)));
        let ahead = Place { work: work(1.0), ..ahead };
        let turned = || crossing(|x| (normal(x), c1 + x * (2.0 * c2 + x * (3.0 * c3))), expected / h, released.is_some());
        let (x, why) = match released {
            None if ahead.normal >= 0.0 => (turned(), End::Turned),
            Some(most) if ahead.work >= most => {
                (crossing(|x| (work(x) - most, h * normal(x)), expected / h, false), End::Released)
            }
            Some(_) if ahead.normal < 0.0 => (turned(), End::Turned),
            _ => {
                (self.at, self.rate) = (ahead, Some(last));
                return End::Open;
            }
        };
        // Cubics through the ends: what of the way, and of the slopes there, is behind.
        let (way, y) = (x * x * (3.0 - 2.0 * x), 1.0 - x);
        let (from, to) = (h * x * y * y, -h * x * x * y);
        let between = |a: DVec2, b: DVec2, p: DVec2, q: DVec2| a + (b - a) * way + p * from + q * to;
        self.rate = None;
        self.at = Place {
            slip: between(at.slip, ahead.slip, first.slip, last.slip),
            normal: if why == End::Turned { 0.0 } else { normal(x) },
            friction: between(at.friction, ahead.friction, first.friction, last.friction),
            work: work(x),
            load: at.load + h * x,
        };
        why
    }
}

/// Where a function that changes its sign once between 0 and 1 does so, by Newton's rule from nearby, which mostly does.
fn crossing(eval: impl Fn(f64) -> (f64, f64), near: f64, falls: bool) -> f64 {
    let mut x = near.min(1.0);
    for _ in 0..ROUNDS {
        let (value, slope) = eval(x);
        let next = x - value / slope;
        if (next - x).abs() <= NEAR && next <= 1.0 {
            return next;
        }
        x = next.clamp(0.0, 1.0);
    }
    refine(eval, 0.0, 1.0, falls)
}

/// Rounds of Newton's rule before the search is bracketed.
const ROUNDS: usize = 4;

/// Last change of a part of a step after which the next would be rounding, Newton's rule being quadratic. Default 1e-9.
const NEAR: f64 = 1e-9;

impl Place {
    /// Normal impulse until a step is to end, and why it ends then, where the normal velocity has this rate.
    fn until(&self, rate: f64, released: Option<f64>) -> (f64, End) {
        match released {
            None if rate > 0.0 => ((-self.normal / rate).max(0.0), End::Turned),
            None => (f64::INFINITY, End::Never),
            Some(released) => self.until_released(rate, released),
        }
    }

    /// Until the work reaches `released`; or, where the bodies approach again before that, until they begin to.
    fn until_released(&self, rate: f64, released: f64) -> (f64, End) {
        // W + u p + r p²/2 = released, with u ≥ 0: the positive root in the form that does not cancel.
        let missing = released - self.work;
        let discriminant = self.normal * self.normal + 2.0 * rate * missing;
        if missing <= 0.0 {
            (0.0, End::Released)
        } else if discriminant >= 0.0 {
            (2.0 * missing / (self.normal + discriminant.sqrt()), End::Released)
        } else {
            ((self.normal / -rate).max(0.0), End::Turned)
        }
    }
}
