//! Many random worlds, each under the check of a law, and each again as a wrong twin.

use super::checks::{Finding, Free, coulomb, coulomb_of_impacts, energy, energy_bound, momentum};
use super::record::{Record, record};
use super::twins;
use super::worlds::{self, Dice, Kind};
use plaus_sim::{Law, Preset};

/// What is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Case {
    /// One body on a level floor without friction: horizontal momentum.
    Sliding,
    /// The same: angular momentum about the vertical.
    Turning,
    /// One body on a level floor with friction: Coulomb's bound from event to event.
    Braking,
    /// The same: Coulomb's bound of each impact.
    Impacts,
    /// One body on a level floor: energy.
    Energy,
    /// Two bodies in space: momentum and angular momentum.
    Meeting,
    /// Two bodies in space: energy.
    MeetingEnergy,
    /// Two bodies, one above the other, that rub against each other on a level floor without friction.
    Riding,
}

impl Case {
    pub const ALL: [Self; 8] = [
        Self::Sliding,
        Self::Turning,
        Self::Braking,
        Self::Impacts,
        Self::Energy,
        Self::Meeting,
        Self::MeetingEnergy,
        Self::Riding,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Sliding => "no friction: momentum",
            Self::Turning => "no friction: angular momentum",
            Self::Braking => "Coulomb, event to event",
            Self::Impacts => "Coulomb, each impact",
            Self::Energy => "energy",
            Self::Meeting => "two in space: momentum",
            Self::MeetingEnergy => "two in space: energy",
            Self::Riding => "two on ice: momentum",
        }
    }
}

const RESTITUTIONS: [f64; 6] = [0.0, 0.125, 0.5, 0.8, 0.95, 1.0];
const FRICTIONS: [f64; 5] = [0.02, 0.18, 0.35, 0.6, 1.2];

/// How long a throw is followed, in s, and for how many events at most; the same for two bodies.
const UNTIL: f64 = 3.0;
const MOST_EVENTS: u64 = 4000;
const MOST_OF_TWO: u64 = 1000;

/// The check is told a friction that is too small by this factor.
const TOO_ROUGH: f64 = 1.05;

/// The result for one random world.
#[derive(Debug, Clone, Copy)]
pub struct Examined {
    pub finding: Finding,
    /// Whether the check refuses the wrong twin; none if the run has nothing that could be wrong.
    pub twin: Option<bool>,
    pub events: u64,
}

/// From this world on, the bodies are made of convex pieces: cylinders, cones, capsules, compounds.
pub const OF_PIECES: u64 = 1 << 32;

/// The bodies of world number `throw` of a case.
pub fn kinds(case: Case, throw: u64) -> [Kind; 2] {
    let k = throw as usize;
    if throw >= OF_PIECES {
        let (k, own) = ((throw - OF_PIECES) as usize, Kind::OF_PIECES);
        // Every second body meets a body of another kind.
        let other = if k % 2 == 0 { own[k / 2 % 5] } else { Kind::MEET[k / 2 % 5] };
        return [own[k % 5], other];
    }
    match case {
        Case::Meeting | Case::MeetingEnergy | Case::Riding => [Kind::MEET[k % 5], Kind::MEET[k / 5 % 5]],
        _ => [Kind::ALL[k % 8]; 2],
    }
}

/// Runs world number `throw` of a case and checks it.
pub fn examine(case: Case, throw: u64, preset: Preset) -> Examined {
    let mut dice = Dice::new(5, throw);
    let (e, mu) = (dice.of(&RESTITUTIONS), dice.of(&FRICTIONS));
    let run = |friction: f64| single(kinds(case, throw)[0], throw, Law::new(friction, e), preset);
    match case {
        Case::Sliding | Case::Turning => {
            let r = run(0.0);
            let at = usize::from(case == Case::Turning);
            let twin = twins::scaled(&r, 0, 0.999).map(|t| momentum(&t, Free::Level)[at].is_breach());
            Examined { finding: momentum(&r, Free::Level)[at], twin, events: r.events }
        }
        Case::Braking => {
            let r = run(mu);
            let twin = twins::braked(&r, mu).map(|t| coulomb(&t, mu).is_breach());
            Examined { finding: coulomb(&r, mu), twin, events: r.events }
        }
        Case::Impacts => {
            let (r, rough) = (run(mu), run(mu * TOO_ROUGH));
            // Only a body that slides through its impact, and whose slip turns little, has all of the friction.
            let twin = slides(&rough, mu * TOO_ROUGH).then(|| coulomb_of_impacts(&rough, mu).is_breach());
            Examined { finding: coulomb_of_impacts(&r, mu), twin, events: r.events }
        }
        Case::Energy => {
            let r = run(dice.of(&[0.0, mu]));
            let twin = twins::quickened(&r, 0, 0.01, energy_bound(&r)).map(|t| energy(&t).is_breach());
            Examined { finding: energy(&r), twin, events: r.events }
        }
        Case::Meeting | Case::MeetingEnergy => {
            let (bodies, starts) = worlds::two(kinds(case, throw), throw);
            let law = Law::new(dice.of(&[0.0, mu]), e);
            let r = record(worlds::in_space(bodies, law, preset), &starts, UNTIL, MOST_OF_TWO);
            let check = |r: &Record| {
                let [p, l] = momentum(r, Free::Space);
                if case == Case::Meeting { p.or(l) } else { energy(r) }
            };
            let twin = match case {
                Case::Meeting => twins::scaled(&r, 1, 0.999),
                _ => twins::quickened(&r, 1, 0.01, energy_bound(&r)),
            };
            let twin = twin.map(|t| check(&t).is_breach());
            Examined { finding: check(&r), twin, events: r.events }
        }
        Case::Riding => {
            let r = riding(throw, preset, Law::new(mu, e));
            let check = |r: &Record| momentum(r, Free::Level)[0];
            let twin = twins::scaled(&r, 1, 0.999).filter(|t| is_quick(t, 1)).map(|t| check(&t).is_breach());
            Examined { finding: check(&r), twin, events: r.events }
        }
    }
}

fn single(kind: Kind, throw: u64, law: Law, preset: Preset) -> Record {
    let (world, starts) = worlds::thrown(kind, throw, law, preset);
    record(world, &starts, UNTIL, MOST_EVENTS)
}

/// Whether some impact has all the friction that it may have.
fn slides(record: &Record, friction: f64) -> bool {
    record.impacts.iter().any(|i| {
        let normal = i.impulse.dot(i.normal);
        (i.impulse - i.normal * normal).length() > 0.999 * friction * normal
    })
}

/// Whether a body still moves after an impact, at a speed that is not small compared with √(g·size).
fn is_quick(record: &Record, body: usize) -> bool {
    let f = &record.facts[body];
    record.moments[body].iter().any(|m| m.impacts > 0 && m.v.with_z(0.0).length_squared() > 0.5 * f.size * 9.81)
}

/// One body over another, both over ice: there is friction between the bodies, but none on the floor.
fn riding(throw: u64, preset: Preset, law: Law) -> Record {
    use plaus_sim::{Laws, Material};
    let mut dice = Dice::new(13, throw);
    let mut bodies: Vec<_> = kinds(Case::Riding, throw).iter().map(|k| k.body(&mut dice)).collect();
    let mut starts = [dice.throw(&bodies[0]), dice.throw(&bodies[1])];
    starts[1].position.z = starts[0].position.z + bodies[0].shape.reach() + 1.1 * bodies[1].shape.reach();
    // The upper body comes down on the lower one.
    starts[1].velocity = starts[0].velocity - glam::DVec3::Z * 0.5;
    let ice = Material(1);
    bodies.iter_mut().for_each(|b| b.material = Material(0));
    let mut world = worlds::on_floor(bodies, law, preset);
    let mut laws = Laws::new(2, law).expect("a law");
    laws.set(Material(0), ice, Law::new(0.0, law.restitution)).expect("a law");
    world.laws = laws;
    if let plaus_sim::rigid::StaticShape::Plane(plane) = &mut world.parts[0] {
        plane.material = ice;
    }
    record(world, &starts, UNTIL, MOST_OF_TWO)
}

/// The results of many worlds.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    pub worlds: u64,
    pub events: u64,
    /// Worlds in which the law was broken, with the findings.
    pub broken: Vec<(u64, Kind, f64, f64)>,
    /// The worst breach, in units of the bound and in the law's own unit.
    pub worst: [f64; 2],
    /// Wrong twins, and how many of them the check refused.
    pub twins: [u64; 2],
}

/// Examines the worlds of a case in this range.
pub fn tally(case: Case, preset: Preset, throws: std::ops::Range<u64>) -> Tally {
    let mut tally = Tally::default();
    for throw in throws {
        let v = examine(case, throw, preset);
        tally.worlds += 1;
        tally.events += v.events;
        if v.finding.is_breach() {
            tally.broken.push((throw, kinds(case, throw)[0], v.finding.worst, v.finding.size));
        }
        if v.finding.worst > tally.worst[0] {
            tally.worst = [v.finding.worst, v.finding.size];
        }
        if let Some(caught) = v.twin {
            tally.twins[0] += 1;
            tally.twins[1] += u64::from(caught);
        }
    }
    tally
}
