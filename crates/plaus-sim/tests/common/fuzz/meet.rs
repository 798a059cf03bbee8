//! Bodies that meet: every pair of shapes, both moving or one fixed, at every orientation and of very different sizes.

use super::Verdict;
use super::exact::{self, Core, Piece};
use super::form::{Form, Kind};
use super::run::{Judge, Limit, Ran, run};
use super::world::{Fixed, G, Mover, Saying, World};
use crate::laws::checks::{self, Free};
use crate::laws::twins;
use crate::laws::worlds::Dice;
use glam::{DQuat, DVec3};
use plaus_sim::rigid::{Phase, RigidWorld};
use plaus_sim::{Accuracy, Law, Outcome, Preset};

/// Mean size of two bodies, in m, and the largest ratio of sizes.
const SIZE: f64 = 0.03;
const RATIO: f64 = 30.0;

/// How long worlds are followed, in s.
const UNTIL: f64 = 0.8;

/// How deep a body may be at the end of a motion, in gaps of the preset. Bodies touch when they are within half of a
/// gap, and what lies is kept at three eighths of it. So an overlap of a gap is an error of three halves of one.
/// Default 4:
/// each of two bodies has a gap of its own, and each may be pressed by others from both sides.
pub const DEEP: Limit = Limit::Gaps(4.0);

/// How deep a body may be on its way, over the smaller size. While contact lasts, new points of it are looked for eight
/// times a step only (`rigid/convex.rs`), between which a body moves by up to a fifth of its size; each look comes half
/// way at worst. As in `rigid_pieces`.
const ON_ITS_WAY: Limit = Limit::Size(0.1);

/// Events per body until a run counts as without an end: what ten marbles need about 40 each for, and a hundred times
/// that for smaller steps.
fn most(preset: Preset, bodies: usize) -> u64 {
    let each = match preset {
        Preset::Draft | Preset::Standard => 3_000,
        Preset::Fine => 10_000,
        Preset::Reference => 50_000,
    };
    each * bodies as u64
}

fn law(dice: &mut Dice) -> Law {
    let law = Law::new(dice.of(&[0.0, 0.1, 0.3, 0.6, 1.0]), dice.of(&[0.0, 0.2, 0.5, 0.9]));
    if dice.of(&[true, false]) { law } else { law.with_resistance(0.02, 0.02) }
}

/// Two sizes of ratio 1:30 to 30:1.
fn sizes(dice: &mut Dice) -> [f64; 2] {
    let half = dice.of_any_size(1.0 / RATIO, RATIO).sqrt();
    [SIZE * half, SIZE / half]
}

/// The kinds of two bodies: all pairs come up in 169 seeds.
fn kinds(seed: u64) -> [Kind; 2] {
    let (k, n) = (seed as usize, Kind::ALL.len());
    [Kind::ALL[k % n], Kind::ALL[(k / n + k) % n]]
}

/// A body that flies towards a place from a distance, so that it hits it from any side.
fn flung(form: Form, from: DVec3, to: DVec3, speed: f64, spin: f64, dice: &mut Dice) -> Mover {
    let shape = form.shape();
    let turn = dice.turn();
    let velocity = (to - from).normalize_or(DVec3::NEG_Z) * speed;
    Mover { at: from - turn * shape.1, turn, velocity, spin: dice.in_cube() * spin, form }
}

/// Two bodies in space.
pub fn in_space(seed: u64, preset: Preset) -> World {
    let mut dice = Dice::new(103, seed);
    let sizes = sizes(&mut dice);
    let forms = [0, 1].map(|k| Form::random(kinds(seed)[k], sizes[k], &mut dice));
    let reach = forms.each_ref().map(|f| f.shape().0.reach());
    let apart = 1.05 * (reach[0] + reach[1]);
    let speed = (G * apart).sqrt() * dice.of_any_size(0.1, 3.0);
    let way = dice.turn() * DVec3::X;
    let aside = dice.in_cube() * (0.6 * reach[0].max(reach[1]));
    let [a, b] = forms;
    let movers = vec![
        flung(a, way * apart, aside, 0.5 * speed, speed / apart, &mut dice),
        flung(b, DVec3::ZERO, way, 0.5 * speed, speed / apart, &mut dice),
    ];
    let law = Law::new(dice.of(&[0.0, 0.1, 0.3, 0.6, 1.0]), dice.of(&[0.0, 0.2, 0.5, 0.9]));
    World { movers, fixed: Vec::new(), law, gravity: 0.0, preset, until: UNTIL, wanted: Vec::new() }
}

/// A fixed body at the origin. A box is said in any way.
fn standing(form: Form, dice: &mut Dice) -> Vec<Fixed> {
    let turn = if dice.of(&[true, false]) { DQuat::IDENTITY } else { dice.turn() };
    match form {
        Form::Cuboid { edges, rounding: 0.0 } => {
            dice.of(&Saying::ALL).parts(DVec3::ZERO, edges, turn, dice.between(0.2, 0.8))
        }
        // Scenarios have no fixed ones.
        Form::Skittle(profile) => {
            let form = Form::Frustum { radii: [profile.foot; 2], height: profile.top, rounding: 0.0 };
            vec![Fixed::Solid { form, at: DVec3::ZERO, turn }]
        }
        form => vec![Fixed::Solid { form, at: DVec3::ZERO, turn }],
    }
}

/// Ground at a height, said in some way.
fn ground(level: f64, width: f64, dice: &mut Dice) -> Vec<Fixed> {
    let edges = DVec3::new(width, width, 0.2 * width);
    let at = DVec3::Z * (level - 0.5 * edges.z);
    match dice.of(&[0, 1, 2, 3, 4]) {
        0 => vec![Fixed::Table { level, bumps: dice.of(&[0.0, 0.001]), spacing: 0.02 }],
        1 => Saying::Mesh.parts(at, edges, DQuat::IDENTITY, 0.5),
        2 => Saying::Blocks.parts(at, edges, DQuat::IDENTITY, 0.5),
        3 => Saying::Quarter.parts(at, edges, DQuat::IDENTITY, 0.5),
        _ => vec![Fixed::Plane(level)],
    }
}

/// A body that meets another one, which is fixed or moves, over ground. In some worlds, one or two more fall upon them.
pub fn meeting(seed: u64, preset: Preset) -> World {
    let mut dice = Dice::new(101, seed);
    let sizes = sizes(&mut dice);
    let [a, b] = [0, 1].map(|k| Form::random(kinds(seed)[k], sizes[k], &mut dice));
    let (ra, rb) = (a.shape().0.reach(), b.shape().0.reach());
    let speed = (G * (ra + rb)).sqrt() * dice.of_any_size(0.1, 4.0);
    let way = (dice.in_cube() + DVec3::Z * dice.between(0.0, 2.0)).normalize_or(DVec3::Z);
    let aside = dice.in_cube() * (0.8 * rb);
    let first = flung(a, way * (1.2 * (ra + rb)), aside, speed, 0.5 * speed / ra, &mut dice);
    let level = -dice.between(1.1, 2.0) * (rb + 2.0 * ra);
    let mut fixed = ground(level, 40.0 * (ra + rb), &mut dice);
    let mut movers = vec![first];
    if dice.of(&[true, false]) {
        fixed.extend(standing(b, &mut dice));
    } else {
        movers.push(flung(b, DVec3::ZERO, way, 0.3 * speed, 0.3 * speed / rb, &mut dice));
    }
    for k in 0..dice.of(&[0, 0, 1, 2]) {
        let s = SIZE * dice.of_any_size(0.3, 3.0);
        let form = Form::random(dice.of(&Kind::ALL), s, &mut dice);
        let high = 2.5 * (ra + rb) + form.shape().0.reach() + f64::from(k) * 8.0 * SIZE * 3.0;
        let from = DVec3::Z * high + (dice.in_cube() * rb).with_z(0.0);
        movers.push(flung(form, from, DVec3::ZERO, 0.5 * speed, 0.2 * speed / s, &mut dice));
    }
    World { movers, fixed, law: law(&mut dice), gravity: G, preset, until: UNTIL, wanted: Vec::new() }
}

fn ran(world: &World, limit: Limit) -> Option<Ran> {
    run(world, limit, most(world.preset, world.movers.len())).ok()
}

/// What is deepest in what, as text.
fn told(ran: &Ran, world: &World) -> String {
    let d = ran.deepest;
    let n = world.movers.len();
    let body = |k: usize| format!("body_{k} ({})", world.movers[k].form.told());
    let part = |k: usize| format!("part_{k} ({})", world.fixed[k].told());
    if d.worst == 0.0 {
        return "nothing is in anything".into();
    }
    let other = if d.other < n { body(d.other) } else { part(d.other - n) };
    let is = body(d.body);
    format!("{is} is {:.2e} m in {other} at {:.4} s, {:.1} times what may be", d.depth, d.time, d.worst)
}

pub fn through(seed: u64, preset: Preset) -> Option<Verdict> {
    judged(seed, preset, ON_ITS_WAY)
}

pub fn overlap(seed: u64, preset: Preset) -> Option<Verdict> {
    judged(seed, preset, DEEP)
}

fn judged(seed: u64, preset: Preset, limit: Limit) -> Option<Verdict> {
    let world = meeting(seed, preset);
    let ran = ran(&world, limit)?;
    Some(Verdict { worst: ran.deepest.worst, found: told(&ran, &world), twin: twin(&world, &ran, limit), world })
}

/// What lies at the end on ground that is a plane is in the judge's ground, if that is higher: by a fifth of the body's
/// size, or by eight gaps.
fn twin(world: &World, ran: &Ran, limit: Limit) -> Option<bool> {
    let Some(Fixed::Plane(level)) = world.fixed.first() else { return None };
    let rigid = RigidWorld::new(world.rigid()).ok()?;
    let part = match limit {
        Limit::Gaps(gaps) => 2.0 * gaps * Accuracy::preset(world.preset).gap,
        Limit::Size(part) => 2.0 * part,
    };
    let resting = |k: &usize| ran.record.moments[*k].last().is_some_and(|m| m.phase == Phase::Rest);
    let body = (0..world.movers.len()).find(resting)?;
    let last = ran.record.moments[body].last()?;
    let pieces: Vec<Piece> = world.movers[body].pieces().iter().map(|p| p.moved(last.x, last.turn)).collect();
    let size = world.sizes()[body];
    let ground = |lift: f64| Piece::new(Core::Half, 0.0).moved(DVec3::Z * (level + lift), DQuat::IDENTITY);
    let deep = |lift: f64, least: f64| {
        let ball = (last.x, ran.record.facts[body].reach);
        pieces.iter().map(|p| exact::overlap(p, &ground(lift), ball, least)).fold(0.0, f64::max)
    };
    // It lies on the ground, not on another body.
    let lies = deep(0.5 * part * size, 1e-3 * part * size) > 0.0;
    let mut state = rigid.state(&world.starts()).ok()?;
    let mut judge = Judge::new(world, &rigid, limit).of_parts(vec![vec![ground(part * size)]]);
    let mut seen = 0;
    let most = ran.record.events;
    let mut stop = plaus_sim::trace::While(|_: &plaus_sim::State<_>| {
        seen += 1;
        seen < most
    });
    let both = &mut (&mut judge, &mut stop);
    let _ = rigid.run(&mut state, &mut plaus_sim::Scratch::default(), world.until, both);
    let time = state.time();
    judge.look(&state, time, true);
    lies.then_some(judge.deepest.worst > 1.0)
}

pub fn ends(seed: u64, preset: Preset) -> Option<Verdict> {
    let world = meeting(seed, preset);
    let ran = ran(&world, DEEP)?;
    let is_bad = |o: &Outcome| matches!(o, Outcome::NotFinite { .. } | Outcome::OutOfEvents | Outcome::Stopped);
    let finite = ran.record.moments.iter().flatten().all(|m| m.x.is_finite() && m.v.is_finite() && m.w.is_finite());
    let last = ran.record.moments.iter().flatten().map(|m| m.time).fold(0.0, f64::max);
    let found = format!("{:?} after {} events at {last:.4} s", ran.record.outcome, ran.record.events);
    let worst = if is_bad(&ran.record.outcome) || !finite { f64::INFINITY } else { 0.0 };
    // Every outcome that is bad is refused.
    let twin = Some(is_bad(&Outcome::NotFinite { body: 0, touched: None }) && is_bad(&Outcome::OutOfEvents));
    Some(Verdict { worst, found, twin, world })
}

pub fn energy_holds(seed: u64, preset: Preset) -> Option<Verdict> {
    let world = meeting(seed, preset);
    let ran = ran(&world, DEEP)?;
    let finding = checks::energy(&ran.record);
    let twin = twins::quickened(&ran.record, 0, 0.01, checks::energy_bound(&ran.record))
        .map(|t| checks::energy(&t).is_breach());
    let found = format!("body_{} gains {:.2e} m g size at {:.4} s", finding.body, finding.size, finding.time);
    Some(Verdict { worst: finding.worst, found, twin, world })
}

pub fn momentum_holds(seed: u64, preset: Preset) -> Option<Verdict> {
    let world = in_space(seed, preset);
    let ran = ran(&world, DEEP)?;
    let check = |r: &crate::laws::record::Record| {
        let [p, l] = checks::momentum(r, Free::Space);
        p.or(l)
    };
    let finding = check(&ran.record);
    let twin = twins::scaled(&ran.record, 1, 0.999).map(|t| check(&t).is_breach());
    let found = format!("momentum changes by {:.2e} of itself at {:.4} s", finding.size, finding.time);
    Some(Verdict { worst: finding.worst, found, twin, world })
}
