//! The checks. Each returns its worst breach in units of its bound: at most 1 where the law is kept.

use super::record::{Facts, Moment, Record};
use glam::DVec3;

/// Roundings of one event: a few dozen operations whose errors add up at worst. A flight's rotation is evaluated from a
/// series, in which about as many take part.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// The worst breach of a law in a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// In units of the bound.
    pub worst: f64,
    /// The same in the law's own unit: m/s, or a fraction of the quantity.
    pub size: f64,
    /// When, in s.
    pub time: f64,
    /// Which body.
    pub body: usize,
}

impl Finding {
    const NONE: Self = Self { worst: 0.0, size: 0.0, time: 0.0, body: 0 };

    fn add(&mut self, worst: f64, size: f64, time: f64, body: usize) {
        // NaN is a breach.
        if worst > self.worst || worst.is_nan() {
            *self = Self { worst: if worst.is_nan() { f64::INFINITY } else { worst }, size, time, body };
        }
    }

    /// The worse of two.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        if other.worst > self.worst { other } else { self }
    }

    pub fn is_breach(&self) -> bool {
        self.worst > 1.0
    }
}

/// The directions in which nothing outside the bodies pushes them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Free {
    /// Nothing but the bodies: all of the momentum and angular momentum is kept.
    Space,
    /// A level floor without friction: horizontal momentum, and angular momentum about the vertical.
    Level,
}

impl Free {
    fn part(self, v: DVec3, is_angular: bool) -> DVec3 {
        match (self, is_angular) {
            (Self::Space, _) => v,
            (Self::Level, false) => v.with_z(0.0),
            (Self::Level, true) => DVec3::new(0.0, 0.0, v.z),
        }
    }
}

/// Whether all bodies together keep their momentum (first finding, as a fraction of Σ m v) and their angular momentum
/// about the origin (second) along the free directions.
///
/// Bound: the roundings of all events so far, relative to the largest momentum so far.
pub fn momentum(record: &Record, free: Free) -> [Finding; 2] {
    let mut found = [Finding::NONE; 2];
    let (fastest, n) = (record.fastest(), record.facts.len());
    let mass: f64 = record.facts.iter().map(|f| f.mass).sum();
    let far = record.moments.iter().flatten().map(|m| m.x.length()).fold(0.0, f64::max);
    let reach = record.facts.iter().map(|f| f.reach).fold(0.0, f64::max);
    let scales = [mass * fastest, mass * fastest * (reach + far)];
    let mut now: Vec<Option<Moment>> = vec![None; n];
    let mut first: Option<[DVec3; 2]> = None;
    let mut seen = 0.0;
    let all = record.in_order();
    for (k, (body, moment)) in all.iter().enumerate() {
        now[*body] = Some(*moment);
        seen += 1.0;
        if all.get(k + 1).is_some_and(|next| next.1.time == moment.time) || now.iter().any(Option::is_none) {
            continue;
        }
        let sum = total(&record.facts, &now, free);
        let start = *first.get_or_insert(sum);
        let bounds = [scales[0] * ROUNDINGS * seen, scales[1] * ROUNDINGS * seen];
        for part in 0..2 {
            let off = (sum[part] - start[part]).length();
            found[part].add(off / bounds[part].max(f64::MIN_POSITIVE), off / scales[part], moment.time, *body);
        }
    }
    found
}

/// Momentum and angular momentum about the origin of all bodies.
fn total(facts: &[Facts], now: &[Option<Moment>], free: Free) -> [DVec3; 2] {
    let mut sum = [DVec3::ZERO; 2];
    for (f, m) in facts.iter().zip(now.iter().flatten()) {
        sum[0] += m.v * f.mass;
        sum[1] += m.spin_momentum(f) + m.x.cross(m.v) * f.mass;
    }
    [free.part(sum[0], false), free.part(sum[1], true)]
}

/// Coulomb's bound for each body that touches nothing but one level floor with friction µ: from event to event
/// `|Δv_h| ≤ µ (g Δt + Δv_z)`, whatever the impulses were and wherever they acted.
///
/// Bound: the roundings of an event. At the event at which a preset calls a supported body at rest, also the speed
/// below which it does so.
pub fn coulomb(record: &Record, friction: f64) -> Finding {
    let mut found = Finding::NONE;
    let (g, fastest) = (record.gravity.length(), record.fastest());
    for (body, (facts, moments)) in record.facts.iter().zip(&record.moments).enumerate() {
        for pair in moments.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            let (dt, dv) = (b.time - a.time, b.v - a.v);
            let load = friction * (g * dt + dv.z);
            let stops = b.phase == plaus_sim::rigid::Phase::Rest && b.v == DVec3::ZERO;
            let rest = if stops && friction > 0.0 { record.accuracy.rest_speed * (g * facts.size).sqrt() } else { 0.0 };
            let bound = ROUNDINGS * (fastest + g * dt) * (1.0 + friction) + rest;
            let excess = dv.with_z(0.0).length() - load;
            found.add(excess / bound, excess, b.time, body);
        }
    }
    found
}

/// Coulomb's bound for each impact: the tangential impulse is at most µ times the normal one. Bound: roundings.
pub fn coulomb_of_impacts(record: &Record, friction: f64) -> Finding {
    let mut found = Finding::NONE;
    for impact in &record.impacts {
        let normal = impact.impulse.dot(impact.normal);
        let along = (impact.impulse - impact.normal * normal).length();
        let excess = (along - friction * normal).max(-normal);
        let scale = impact.impulse.length().max(f64::MIN_POSITIVE);
        found.add(excess / (scale * ROUNDINGS * (1.0 + friction)), excess / scale, impact.time, impact.body);
    }
    found
}

/// The largest energy that takes part in a record's sums, in J.
fn energy_scale(record: &Record) -> f64 {
    let (g, fastest) = (record.gravity.length(), record.fastest());
    let mass: f64 = record.facts.iter().map(|f| f.mass).sum();
    let high = record.moments.iter().flatten().map(|m| m.x.length()).fold(0.0, f64::max);
    mass * (fastest * fastest + g * high)
}

/// What [`energy`] allows at the end of a record, in J.
pub fn energy_bound(record: &Record) -> f64 {
    let unit: f64 = record.facts.iter().map(|f| f.mass * record.gravity.length() * f.size).sum();
    let events: usize = record.moments.iter().map(Vec::len).sum();
    rise(record) * unit + ROUNDINGS * events as f64 * energy_scale(record)
}

/// How far energy may rise, over Σ m g size: by lifting every body by the touching gap once, and by the error of a step
/// of lasting contact, which is of second order. A twentieth of the step's square is ten times the smallest error that
/// was seen, and twice the largest.
fn rise(record: &Record) -> f64 {
    let accuracy = &record.accuracy;
    2.0 * accuracy.gap + accuracy.step * accuracy.step / 20.0
}

/// Whether the energy of all bodies ever rises above its lowest earlier value. `size` is in units of Σ m g size.
///
/// Bound: roundings, and [`rise`].
pub fn energy(record: &Record) -> Finding {
    let mut found = Finding::NONE;
    let g = record.gravity.length();
    let unit: f64 = record.facts.iter().map(|f| f.mass * (g * f.size)).sum();
    let (scale, lift) = (energy_scale(record), rise(record) * unit);
    let unit = if unit > 0.0 { unit } else { scale };
    let mut least = f64::INFINITY;
    for (k, (time, body, sum)) in energies(record).into_iter().enumerate() {
        if least.is_finite() {
            let rise = sum - least;
            found.add(rise / (lift + ROUNDINGS * (k + 1) as f64 * scale), rise / unit, time, body);
        }
        least = least.min(sum);
    }
    found
}

/// The energy of all bodies after everything that happened at one time, and one of the bodies concerned.
pub fn energies(record: &Record) -> Vec<(f64, usize, f64)> {
    let mut each = vec![None; record.facts.len()];
    let mut sums = Vec::new();
    let all = record.in_order();
    for (k, (body, moment)) in all.iter().enumerate() {
        each[*body] = Some(moment.energy(&record.facts[*body], record.gravity));
        let is_last = all.get(k + 1).is_none_or(|next| next.1.time != moment.time);
        if is_last && each.iter().all(Option::is_some) {
            sums.push((moment.time, *body, each.iter().flatten().sum()));
        }
    }
    sums
}
