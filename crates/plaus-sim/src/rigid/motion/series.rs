//! Free rotation of a body with three different moments over a short time: a Taylor series of Euler's equations and of
//! the quaternion. Over longer times, `asymmetric_top.rs` costs less.

use super::inertia::Inertia;
use glam::{DQuat, DVec3};

/// Terms of the series at most. Within [`MOST_TURN`], the first term left out is below `0.3¹⁶/16! ≈ 2e-22` times a
/// small power of the ratio of moments.
const ORDER: usize = 16;

/// Fewer terms are taken where those left out stay below this. Default 1e-18; rounding is 1e-16.
pub(crate) const LEFT_OUT: f64 = 1e-18;

/// Largest angle in radians (times the ratio of moments where that exceeds 1) that the series is for.
const MOST_TURN: f64 = 0.3;

const NO_TURN: DQuat = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);

/// Orientation and angular velocity in body axes after a time; `None` if it is too long for the series. Terms below
/// `left_out` are left out.
pub(super) fn series(inertia: &Inertia, turn: DQuat, w: DVec3, dt: f64, left_out: f64) -> Option<(DQuat, DVec3)> {
    let mut series = Series::new(inertia, turn, w);
    series.unit = dt;
    series.at(dt, left_out)
}

/// Orientation after a time that is short beside a turn: the rotation of Magnus' series up to the third power of the
/// time. What is left out turns the body by the order of `(ω dt)⁴/24`, more where moments differ by large factors.
/// Source: Iserles & Nørsett, "On the solution of linear differential equations in Lie groups" (1999).
pub(super) fn magnus(inertia: &Inertia, turn: DQuat, w: DVec3, dt: f64) -> DQuat {
    let i = inertia.moments;
    let products = |a: DVec3, b: DVec3| DVec3::new(a.y * b.z, a.z * b.x, a.x * b.y);
    let c = DVec3::new((i.y - i.z) / i.x, (i.z - i.x) / i.y, (i.x - i.y) / i.z);
    let first = c * products(w, w);
    let second = c * (products(first, w) + products(w, first));
    let bend = second * (dt / 6.0) + w.cross(first) * (dt / 12.0);
    let angle = (w + (first * 0.5 + bend) * dt) * dt;
    (turn * super::inertia::rotation(angle)).normalize()
}

/// The series of one motion, for many times.
#[derive(Debug, Clone)]
pub(super) struct Series {
    /// (I₂ − I₃)/I₁ and so on, of Euler's equations.
    c: DVec3,
    /// Bounds on the terms at time 1: those of the orientation are at most `angleⁿ/n!`, those of the angular velocity
    /// `growthⁿ`.
    angle: f64,
    growth: f64,
    /// The terms so far are those of this time, in s.
    unit: f64,
    known: usize,
    rates: [DVec3; ORDER + 1],
    turns: [DQuat; ORDER + 1],
}

impl Series {
    /// The series from an orientation and an angular velocity in body axes on.
    pub(super) fn new(inertia: &Inertia, turn: DQuat, w: DVec3) -> Self {
        let i = inertia.moments;
        // |ω| in free rotation is at most √(2 E / I_min).
        let most = ((i * w).dot(w) / i.min_element()).sqrt();
        let ratio = (i.max_element() / i.min_element()).min(4.0);
        let mut all = Self {
            c: DVec3::new((i.y - i.z) / i.x, (i.z - i.x) / i.y, (i.x - i.y) / i.z),
            angle: most * ratio,
            growth: most * inertia.anisotropy(),
            // The longest time that it is for, so that no term underflows.
            unit: if most > 0.0 { MOST_TURN / (most * ratio) } else { 1.0 },
            known: 0,
            rates: [DVec3::ZERO; ORDER + 1],
            turns: [NO_TURN; ORDER + 1],
        };
        (all.rates[0], all.turns[0]) = (w, turn);
        all
    }

    /// Orientation and angular velocity in body axes after a time; `None` if it is too long for the series. Terms below
    /// `left_out` are left out.
    pub(super) fn at(&mut self, dt: f64, left_out: f64) -> Option<(DQuat, DVec3)> {
        let (angle, growth) = (self.angle * dt.abs(), self.growth * dt.abs());
        let is_short = angle <= MOST_TURN;
        if !is_short {
            return None;
        }
        let (mut order, mut turned, mut grown) = (0, 1.0_f64, 1.0_f64);
        while order < ORDER && turned.max(grown) > left_out {
            order += 1;
            (turned, grown) = (turned * angle / order as f64, grown * growth);
        }
        self.extend(order);
        let s = if self.unit == dt { 1.0 } else { dt / self.unit };
        // Smallest terms first.
        let w = self.rates[..=order].iter().rev().fold(DVec3::ZERO, |sum, &t| sum * s + t);
        let turn = self.turns[..=order].iter().rev().fold(NO_TURN, |sum, &t| sum * s + t);
        Some((turn.normalize(), w))
    }

    /// Finds the terms up to an order.
    fn extend(&mut self, order: usize) {
        for n in self.known..order {
            let (mut products, mut turned) = (DVec3::ZERO, NO_TURN);
            for k in 0..=n {
                let (a, b) = (self.rates[k], self.rates[n - k]);
                products += DVec3::new(a.y * b.z, a.z * b.x, a.x * b.y);
                turned += self.turns[k] * DQuat::from_xyzw(b.x, b.y, b.z, 0.0);
            }
            let next = self.unit / (n + 1) as f64;
            self.rates[n + 1] = self.c * products * next;
            self.turns[n + 1] = turned * (0.5 * next);
        }
        self.known = self.known.max(order);
    }
}
