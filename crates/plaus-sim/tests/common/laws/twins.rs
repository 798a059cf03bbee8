//! Records made wrong in ways in which a simulator can go wrong.

use super::checks::energies;
use super::record::{Facts, Moment, Record};
use glam::DVec3;

/// Changes all events of a body from the first one after `impacts` impacts at which it still moves. Returns whether
/// there is one.
fn from_then_on(record: &mut Record, body: usize, impacts: usize, change: impl Fn(&Facts, &mut Moment)) -> bool {
    let Record { facts, moments, .. } = record;
    let (facts, moments) = (&facts[body], &mut moments[body]);
    let Some(at) = moments.iter().position(|m| m.impacts >= impacts && m.v != DVec3::ZERO) else { return false };
    for m in moments[at..].iter_mut() {
        change(facts, m);
    }
    true
}

/// Velocities scaled after an impact, as by a guard of energy.
pub fn scaled(record: &Record, body: usize, factor: f64) -> Option<Record> {
    let mut twin = record.clone();
    let done = from_then_on(&mut twin, body, 1, |_, m| {
        m.v *= factor;
        m.w *= factor;
    });
    done.then_some(twin)
}

/// From the event at which it shows most, the velocities of a body are larger by the fraction `part`: energy out of
/// nothing. `None` if at no event this energy exceeds the energy lost so far by more than twice `bound` (in J).
pub fn quickened(record: &Record, body: usize, part: f64, bound: f64) -> Option<Record> {
    let facts = &record.facts[body];
    let sums = energies(record);
    let gain = |m: &Moment| {
        let at = sums.iter().rposition(|s| s.0 == m.time)?;
        let least = sums[..at].iter().map(|s| s.2).fold(f64::INFINITY, f64::min);
        Some(m.kinetic(facts) * (2.0 * part + part * part) - (least - sums[at].2))
    };
    let gains = record.moments[body].iter().enumerate().filter_map(|(k, m)| Some((k, gain(m)?)));
    let (at, most) = gains.filter(|g| g.1.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut twin = record.clone();
    for m in &mut twin.moments[body][at..] {
        m.v *= 1.0 + part;
        m.w *= 1.0 + part;
    }
    (most > 2.0 * bound).then_some(twin)
}

/// The error of an interrupted step of lasting contact that is charged with the whole of its half kick of friction: ½ µ
/// g h along the friction. `None` if the body never slides with all of its friction.
pub fn braked(record: &Record, friction: f64) -> Option<Record> {
    let g = record.gravity.length();
    let moments = &record.moments[0];
    let kick = 0.5 * friction * g * record.accuracy.step * (record.facts[0].size / g).sqrt();
    let rubs = |pair: &[Moment]| {
        let (dt, dv) = (pair[1].time - pair[0].time, pair[1].v - pair[0].v);
        let load = friction * (g * dt + dv.z);
        load > 0.0 && dv.with_z(0.0).length() > 0.999 * load
    };
    let at = moments.windows(2).position(rubs)?;
    let way = (moments[at + 1].v - moments[at].v).with_z(0.0).normalize();
    let mut twin = record.clone();
    for m in &mut twin.moments[0][at + 1..] {
        m.v += way * kick;
    }
    Some(twin)
}
