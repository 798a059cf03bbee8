//! The path of an impact's velocities over its normal impulse (Darboux and Keller's equations), step by step.
//!
//! While the friction force is constant, because the contact sticks or its slip keeps its direction, velocities are
//! linear in the impulse, and a step ends exactly where it should. Elsewhere Kutta's third-order rule is used. Between
//! the ends of such a step, velocities are the cubics with its values and slopes, so the end is found without another
//! step, and the change of velocity is that of the impulse there.

use super::ContactMatrix;
use crate::roots::refine;
use glam::{DVec2, DVec3};

/// What ended a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    /// Nothing: the path continues.
    Open,
    /// Nothing ever will.
    Never,
    /// The normal velocity has changed its sign.
    Turned,
    /// Everything that should be released has been.
    Released,
}

/// A point of the path.
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

/// The path so far.
pub(super) struct Path<'k> {
    k: &'k ContactMatrix,
    friction: f64,
    turn: f64,
    /// Relative speed at the start.
    speed: f64,
    /// The force that holds a stuck contact, if friction can hold it.
    holding: Option<DVec2>,
    at: Place,
    /// Rates there for a slipping contact; computed when needed.
    rate: Option<Rate>,
    /// The curved step on which the normal velocity has just changed its sign: it goes on.
    leg: Option<Leg>,
    restitution: f64,
}

/// A curved step.
#[derive(Debug, Clone, Copy)]
struct Leg {
    /// Its length in normal impulse.
    h: f64,
    ends: [Place; 2],
    rates: [Rate; 2],
    /// Coefficients of the normal velocity as a polynomial in the fraction of the step, from the first power on.
    cubic: [f64; 3],
    /// The fraction of the step that is done.
    from: f64,
}

/// Slip that is about to stop may be taken to stop if its sideways velocity, over the speed and the square of the
/// largest turn of a step, is below this. Default 1e-2: at turns of 0.3, a thousandth of the speed, like the error of
/// the steps.
const STOPS: f64 = 1e-2;

/// Fraction of the slip that a step may take away. Default 0.5.
const SHRINKS: f64 = 0.5;

/// A step goes this much farther than is probably necessary. Default 1.1; falling short costs another step.
const FARTHER: f64 = 1.1;

/// Tangent of the angle by which a step may have turned the slip, over that of the intended angle. Default 1.5; a step
/// that turned it farther is halved.
const WIDEST: f64 = 1.5;

/// Turn over change of the slip's rate below which it keeps its direction: rounding.
const STRAIGHT: f64 = 1e-12;

impl<'k> Path<'k> {
    pub(super) fn new(k: &'k ContactMatrix, u: DVec3, restitution: f64, [friction, grip]: [f64; 2], turn: f64) -> Self {
        let holding = k.holding();
        let at = Place { slip: u.truncate(), normal: u.z, friction: DVec2::ZERO, work: 0.0, load: 0.0 };
        let holding = (holding.length() <= grip).then_some(holding);
        Self { k, friction, turn, speed: u.length(), holding, at, rate: None, leg: None, restitution }
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

    /// One step, until the normal velocity changes its sign or, if given, the work has grown to `released`. Slip of at
    /// most `tiny` counts as none.
    pub(super) fn step(&mut self, tiny: f64, released: Option<f64>) -> End {
        if let Some(leg) = self.leg {
            // The two halves of an impact are alike except for the loss.
            return self.along(leg, leg.from * (1.0 + self.restitution), released);
        }
        if self.friction == 0.0 {
            return self.straight(&self.rate_under(DVec2::ZERO), f64::INFINITY, released);
        }
        let speed = self.at.slip.length();
        if speed <= tiny {
            return match self.holding {
                Some(force) => {
                    self.straight(&Rate { slip: DVec2::ZERO, ..self.rate_under(force) }, f64::INFINITY, released)
                }
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
        // If friction can hold the contact, the slip gets straighter and straighter towards its end.
        let closes = self.holding.is_some() && across * stop <= STOPS * self.turn * self.turn * self.speed;
        if is_straight || closes {
            return self.straight(&rate, stop, released);
        }
        let longest = (self.turn * speed / across).min(SHRINKS * stop);
        self.curved(rate, longest, released)
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
    fn curved(&mut self, first: Rate, longest: f64, released: Option<f64>) -> End {
        let at = self.at;
        let (expected, why) = at.until(first.normal, released);
        if expected == 0.0 {
            return why;
        }
        // Decompression follows the same path back.
        let on = if released.is_none() { 1.0 + self.restitution } else { 1.0 };
        let mut h = longest.min(FARTHER * on * expected);
        let mut ahead = self.kutta(&first, h);
        // The slip's rate of turning may grow along the path.
        while self.at.slip.perp_dot(ahead.slip).abs() > WIDEST * self.turn * self.at.slip.dot(ahead.slip) {
            h *= 0.5;
            ahead = self.kutta(&first, h);
        }
        let last = self.slipping(ahead.slip);
        let rise = ahead.normal - at.normal;
        let cubic = [
            h * first.normal,
            3.0 * rise - h * (2.0 * first.normal + last.normal),
            h * (first.normal + last.normal) - 2.0 * rise,
        ];
        let leg = Leg { h, ends: [at, at], rates: [first, last], cubic, from: 0.0 };
        ahead.work = leg.work(1.0);
        self.along(Leg { ends: [at, ahead], ..leg }, expected / h, released)
    }

    /// Where a step of this length leads, without the work.
    fn kutta(&self, first: &Rate, h: f64) -> Place {
        let at = self.at;
        let second = self.slipping(at.slip + first.slip * (0.5 * h));
        let third = self.slipping(at.slip + (second.slip * 2.0 - first.slip) * h);
        let sixth = h / 6.0;
        Place {
            slip: at.slip + (first.slip + second.slip * 4.0 + third.slip) * sixth,
            normal: at.normal + (first.normal + 4.0 * second.normal + third.normal) * sixth,
            friction: at.friction + (first.friction + second.friction * 4.0 + third.friction) * sixth,
            work: at.work,
            load: at.load + h,
        }
    }

    /// Continues along the rest of a curved step until its end, which is probably near `near`.
    fn along(&mut self, leg: Leg, near: f64, released: Option<f64>) -> End {
        let ahead = leg.ends[1];
        let turned = || crossing(|x| (leg.normal(x), leg.slope(x)), [leg.from, near], released.is_some());
        let (x, why) = match released {
            None if ahead.normal >= 0.0 => (turned(), End::Turned),
            Some(most) if ahead.work >= most => {
                let rest = |x: f64| (leg.work(x) - most, leg.h * leg.normal(x));
                (crossing(rest, [leg.from, near], false), End::Released)
            }
            Some(_) if ahead.normal < 0.0 => (turned(), End::Turned),
            _ => {
                (self.at, self.rate, self.leg) = (ahead, Some(leg.rates[1]), None);
                return End::Open;
            }
        };
        self.at = leg.at(x, why == End::Turned, self.friction);
        (self.rate, self.leg) = (None, (why == End::Turned).then_some(Leg { from: x, ..leg }));
        why
    }
}

impl Leg {
    /// Normal velocity after the fraction `x` of the step.
    fn normal(&self, x: f64) -> f64 {
        let [a, b, c] = self.cubic;
        self.ends[0].normal + x * (a + x * (b + x * c))
    }

    fn slope(&self, x: f64) -> f64 {
        let [a, b, c] = self.cubic;
        a + x * (2.0 * b + x * (3.0 * c))
    }

    /// Work up to then: the integral of the normal velocity.
    fn work(&self, x: f64) -> f64 {
        let [a, b, c] = self.cubic;
        let mean = self.ends[0].normal + x * (a * (1.0 / 2.0) + x * (b * (1.0 / 3.0) + x * (c * (1.0 / 4.0))));
        self.ends[0].work + self.h * x * mean
    }

    /// The place after a fraction of the step, by cubics through its ends.
    fn at(&self, x: f64, has_turned: bool, coefficient: f64) -> Place {
        let ([a, b], [p, q], y) = (self.ends, self.rates, 1.0 - x);
        let (way, from, to) = (x * x * (3.0 - 2.0 * x), self.h * x * y * y, -self.h * x * x * y);
        let between = |a: DVec2, b: DVec2, p: DVec2, q: DVec2| a + (b - a) * way + p * from + q * to;
        let (load, friction) = (a.load + self.h * x, between(a.friction, b.friction, p.friction, q.friction));
        Place {
            slip: between(a.slip, b.slip, p.slip, q.slip),
            normal: if has_turned { 0.0 } else { self.normal(x) },
            // Between its ends, a cubic may leave the cone by as much as its own error.
            friction: friction.clamp_length_max(coefficient * load),
            work: self.work(x),
            load,
        }
    }
}

/// The point between `from` and 1 at which a function changes its sign, which it does once; by Newton's method from a
/// nearby guess, which usually succeeds.
fn crossing(eval: impl Fn(f64) -> (f64, f64), [from, near]: [f64; 2], falls: bool) -> f64 {
    let mut x = near.min(1.0);
    for _ in 0..ROUNDS {
        let (value, slope) = eval(x);
        let next = x - value / slope;
        if (next - x).abs() <= NEAR && next >= from && next <= 1.0 {
            return next;
        }
        x = next.clamp(from, 1.0);
    }
    refine(eval, from, 1.0, falls)
}

/// Rounds of Newton's rule before the search is bracketed.
const ROUNDS: usize = 4;

/// Last change of the fraction of a step after which the next change would be rounding, because Newton's rule is
/// quadratic. Default 1e-9.
const NEAR: f64 = 1e-9;

impl Place {
    /// Normal impulse until the end of a step, and the reason for that end, if the normal velocity has this rate.
    fn until(&self, rate: f64, released: Option<f64>) -> (f64, End) {
        match released {
            None if rate > 0.0 => ((-self.normal / rate).max(0.0), End::Turned),
            None => (f64::INFINITY, End::Never),
            Some(released) => self.until_released(rate, released),
        }
    }

    /// Until the work reaches `released`, or until the bodies begin to approach again, if that comes first.
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
