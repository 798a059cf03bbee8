//! Free rotation of a body with three different moments: a Taylor series, re-expanded before the body has turned by
//! half a radian; the terms left out are below rounding ([`ORDER`]). Deviation from a closed form in Jacobi's elliptic
//! functions: the series needs no special cases near the separatrix, and is just as exact.
//!
//! Whole periods of Euler's equations, whose length is a complete elliptic integral, are skipped in long requests
//! ([`LONG`]), so that a body that turns a million times costs no more than one that turns a thousand times.

use super::inertia::{Inertia, InertiaKind};
use glam::{DQuat, DVec3};

/// Free rotation of a body with three different moments, by Taylor series.
#[derive(Debug, Clone)]
pub(crate) struct Series {
    moments: DVec3,
    /// Where the rotation started, so that it can start anew.
    origin: (DQuat, DVec3),
    elapsed: f64,
    pub(crate) turn: DQuat,
    /// Angular velocity in body axes.
    pub(crate) w: DVec3,
    /// Terms below this are left out.
    left_out: f64,
}

/// Terms of the series at most. With steps of at most [`STEP`] radians, the first term left out is below
/// `0.3¹⁶/16! ≈ 2e-22` times a small power of the ratio of moments.
const ORDER: usize = 16;

/// Shorter steps need fewer terms: those left out stay below this. Default 1e-18; rounding is 1e-16.
pub(crate) const LEFT_OUT: f64 = 1e-18;

/// Longest step in radians of turning (times the ratio of moments where that exceeds 1).
const STEP: f64 = 0.3;

/// Number of steps from which whole periods are skipped. Default 4096, which is 1200 radians, more than a body turns
/// from one event to the next unless something is odd about its speed. Danger: a smaller number costs bits, as a period
/// that is repeated n times repeats its rounding n times.
const LONG: f64 = 4096.0;

/// Maximum number of steps for one request: 9000 radians. Only bodies with nearly equal moments have longer periods
/// than that; they turn as the symmetric top does that has the mean of the two nearest moments.
const MOST_STEPS: f64 = 3e4;

/// Orientation and angular velocity after a time of free rotation.
pub(super) type Drift = fn(&Inertia, DQuat, DVec3, f64) -> (DQuat, DVec3);

impl Series {
    pub(crate) fn new(inertia: &Inertia, turn: DQuat, w: DVec3) -> Self {
        let w = turn.conjugate() * w;
        Self { moments: inertia.moments, origin: (turn, w), elapsed: 0.0, turn, w, left_out: LEFT_OUT }
    }

    /// The same, but terms below `left_out` may be left out.
    pub(crate) fn within(self, left_out: f64) -> Self {
        Self { left_out, ..self }
    }

    /// The largest `|ω̇| / |ω|²`.
    fn anisotropy(&self) -> f64 {
        Inertia { moments: self.moments, kind: InertiaKind::Different }.anisotropy()
    }

    pub(super) fn seek(&mut self, dt: f64, drift: Drift) {
        if dt < self.elapsed {
            (self.turn, self.w) = self.origin;
            self.elapsed = 0.0;
        }
        self.go(dt - self.elapsed, drift);
        self.elapsed = dt;
    }

    /// How many steps a time takes.
    fn steps(&self, dt: f64) -> f64 {
        let i = self.moments;
        // |ω| in free rotation is at most √(2 E / I_min).
        let fastest = ((i * self.w).dot(self.w) / i.min_element()).sqrt();
        (fastest * (i.max_element() / i.min_element()).min(4.0) * dt / STEP).ceil()
    }

    /// Moves on by `dt` seconds, in a number of steps that is bounded whatever `dt` is. `drift` turns a symmetric top.
    pub(crate) fn go(&mut self, dt: f64, drift: Drift) {
        if self.steps(dt) <= LONG {
            return self.walk(dt);
        }
        if let Some(period) = self.period().filter(|&period| 2.0 * period <= dt && self.steps(period) <= MOST_STEPS) {
            let times = (dt / period).floor();
            // The angular velocity in body axes comes back; the body has turned about its angular momentum.
            let (from, w) = (self.turn, self.w);
            self.walk(period);
            let once = (self.turn * from.conjugate()).normalize();
            (self.turn, self.w) = ((power(once, times) * from).normalize(), w);
            return self.walk((dt - times * period).max(0.0));
        }
        if self.steps(dt) <= MOST_STEPS {
            return self.walk(dt);
        }
        let (turn, w) = drift(&nearest_top(self.moments), self.turn, self.turn * self.w, dt);
        (self.turn, self.w) = (turn, turn.conjugate() * w);
    }

    /// The period of the angular velocity in body axes, in s (Landau and Lifshitz, *Mechanics*, § 37); `None` where it
    /// has none, which is at the separatrix.
    fn period(&self) -> Option<f64> {
        let mut i = self.moments.to_array();
        i.sort_by(f64::total_cmp);
        let [a, b, c] = i;
        let l = self.moments * self.w;
        let (squared, twice) = (l.length_squared(), l.dot(self.w));
        let (low, high) = (squared - twice * a, twice * c - squared);
        let [outer, inner] =
            if squared > twice * b { [(c - b) * low, (b - a) * high] } else { [(b - a) * high, (c - b) * low] };
        // The complete elliptic integral, by the arithmetic-geometric mean.
        let (mut x, mut y) = (1.0, (1.0 - inner / outer).sqrt());
        for _ in 0..64 {
            (x, y) = (0.5 * (x + y), (x * y).sqrt());
        }
        let period = 2.0 * std::f64::consts::PI / (x * (outer / (a * b * c)).sqrt());
        (period.is_finite() && period > 0.0).then_some(period)
    }

    /// Moves on by `dt` seconds in steps of the series.
    fn walk(&mut self, dt: f64) {
        let i = self.moments;
        let fastest = ((i * self.w).dot(self.w) / i.min_element()).sqrt();
        let ratio = (i.max_element() / i.min_element()).min(4.0);
        let steps = self.steps(dt).clamp(1.0, MOST_STEPS);
        let h = dt / steps;
        // The n-th terms are at most `angleⁿ/n!` for the orientation and `growthⁿ` for the angular velocity.
        let (angle, growth) = ((fastest * ratio * h).abs(), (fastest * h).abs() * self.anisotropy());
        let (mut order, mut turned, mut grown) = (0, 1.0_f64, 1.0_f64);
        while order < ORDER && turned.max(grown) > self.left_out {
            order += 1;
            (turned, grown) = (turned * angle / order as f64, grown * growth);
        }
        let mut k = 0.0;
        while k < steps {
            self.step(h, order);
            k += 1.0;
        }
    }

    fn step(&mut self, h: f64, order: usize) {
        let i = self.moments;
        let c = DVec3::new((i.y - i.z) / i.x, (i.z - i.x) / i.y, (i.x - i.y) / i.z);
        let mut w = [DVec3::ZERO; ORDER + 1];
        let mut q = [DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0); ORDER + 1];
        w[0] = self.w;
        q[0] = self.turn;
        for n in 0..order {
            let (mut products, mut turned) = (DVec3::ZERO, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
            for k in 0..=n {
                let (a, b) = (w[k], w[n - k]);
                products += DVec3::new(a.y * b.z, a.z * b.x, a.x * b.y);
                turned += q[k] * DQuat::from_xyzw(b.x, b.y, b.z, 0.0);
            }
            let next = h / (n + 1) as f64;
            w[n + 1] = c * products * next;
            q[n + 1] = turned * (0.5 * next);
        }
        // Smallest terms first.
        self.w = w[..=order].iter().rev().fold(DVec3::ZERO, |sum, &t| sum + t);
        self.turn = q[..=order].iter().rev().fold(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), |sum, &t| sum + t).normalize();
    }
}

/// A rotation made a whole number of times, by repeated squaring.
fn power(rotation: DQuat, mut times: f64) -> DQuat {
    let (mut all, mut square) = (DQuat::IDENTITY, rotation);
    while times >= 1.0 && times.is_finite() {
        let half = (0.5 * times).floor();
        if times - 2.0 * half >= 1.0 {
            all = (square * all).normalize();
        }
        (square, times) = ((square * square).normalize(), half);
    }
    all
}

/// The symmetric top whose moments are the nearest.
fn nearest_top(i: DVec3) -> Inertia {
    let apart = DVec3::new((i.y - i.z).abs(), (i.z - i.x).abs(), (i.x - i.y).abs());
    let axis = (1..3).fold(0, |best, k| if apart[k] < apart[best] { k } else { best });
    let mean = 0.5 * (i[(axis + 1) % 3] + i[(axis + 2) % 3]);
    let mut moments = DVec3::splat(mean);
    moments[axis] = i[axis];
    Inertia::new(moments)
}

#[cfg(test)]
mod tests {
    use super::super::free_rotation::drift;
    use super::*;

    /// Whole periods are skipped: the same as walking all the way, for bodies in each of the two kinds of rotation,
    /// short of the separatrix. Rounding of some 10⁴ steps, and of a period's end repeated some thousand times.
    #[test]
    fn periods_of_free_rotation_are_skipped() {
        for (moments, w) in [
            (DVec3::new(1.0, 1.5, 2.2), DVec3::new(3.0, -1.0, 7.0)),
            (DVec3::new(1.0, 1.5, 2.2), DVec3::new(7.0, 1.0, 1.0)),
            (DVec3::new(0.2, 1.5, 1.6), DVec3::new(-1.0, 4.0, 2.0)),
            (DVec3::new(2.9, 2.0, 1.0), DVec3::new(0.1, 5.0, 0.3)),
            (DVec3::new(1.0, 1.0 + 1e-9, 2.0), DVec3::new(1.0, 2.0, 3.0)),
        ] {
            let inertia = Inertia::new(moments);
            let turn = DQuat::from_xyzw(0.1, -0.4, 0.3, 0.8).normalize();
            for t in [400.3, 1234.5] {
                let mut whole = Series::new(&inertia, turn, w);
                for _ in 0..100 {
                    whole.walk(t / 100.0);
                }
                let mut skipped = Series::new(&inertia, turn, w);
                assert!(skipped.steps(t) > LONG);
                skipped.go(t, drift);
                let off = 1.0 - whole.turn.dot(skipped.turn).abs();
                let apart = (whole.w - skipped.w).length();
                assert!(off < 1e-13 && apart < 1e-7, "{moments} {w} {t}: {off} {apart}");
            }
        }
    }

    /// Any time takes a bounded number of steps, keeps energy and momentum, and gives finite numbers: that of a top
    /// that stands for moments that differ by 1e-13 too, whose energy is that of the body to as much.
    #[test]
    fn however_fast_a_body_turns_its_rotation_is_bounded() {
        for moments in [DVec3::new(1.0, 1.5, 2.2), DVec3::new(1.0, 1.0 + 1e-13, 1.0 + 3e-13)] {
            let inertia = Inertia::new(moments);
            let energy = |q: DQuat, w: DVec3| 0.5 * w.dot(inertia.momentum(q, w));
            for (speed, t) in [(1e6, 10.0), (1e9, 1e3), (1e100, 1e3)] {
                let (turn, w) = (DQuat::IDENTITY, DVec3::new(0.1, 0.7, -0.7) * speed);
                let mut series = Series::new(&inertia, turn, w);
                series.go(t, drift);
                let (q, v) = (series.turn, series.turn * series.w);
                assert!(q.is_finite() && v.is_finite());
                assert!((energy(q, v) / energy(turn, w) - 1.0).abs() < 1e-11);
                let kept = (inertia.momentum(q, v) - inertia.momentum(turn, w)).length() / speed;
                // The turn of one period is repeated up to 1e103 times: about which axis is as exact as rounding, and
                // the axis is the angular momentum.
                assert!(kept < 1e-9, "{kept}");
            }
        }
    }
}
