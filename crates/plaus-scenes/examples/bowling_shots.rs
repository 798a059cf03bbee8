//! Shots that are drawn from the prior: how long they take, which pins they leave, and, with `--whole`, whether bodies
//! pass through anything.
//!
//!     cargo run --release -p plaus-scenes --example bowling_shots -- [SCENARIO] [SHOTS] [FIRST] [--whole]
//!
//! Shot k does not depend on the first shot, so many shots can be made in parts. Whole shots continue until everything
//! is at rest. At every new motion each pair of neighbouring bodies and each body's place in the alley are examined.
//! The pins that ever fell are compared with those that the early end reported.
#![allow(clippy::print_stdout, reason = "an example reports to the terminal")]

mod shared;
#[allow(dead_code, reason = "its shots are those of another example")]
mod shots;

use glam::DVec3;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{StateOf, Target};
use plaus_scenes::bowling::{Bowling, Fate, Quantity, Rest, Shot, Verdict, Work};
use plaus_scenes::registry::World;
use plaus_scenes::scenario::Scenario;
use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld};
use plaus_sim::trace::Observer;
use plaus_sim::{Outcome, Scratch};
use shared::seconds;
use shots::{Ledger, Tally};
use std::error::Error;

/// Depths in m of overlaps that are counted. Steps of lasting contact may leave such overlaps, and they are far smaller
/// than a pin's neck, 46 mm.
const DEPTHS: [f64; 3] = [1e-4, 1e-3, 1e-2];

/// Energy in J that one event may make without being told: a hundredth of a pin's weight times its foot's radius.
const TOLD: f64 = 4e-3;

/// Inside of the alley: half its width, and the place of its cushion, in m.
const INSIDE: [f64; 2] = [0.5 * 41.5 * 0.0254 + 9.3125 * 0.0254, 66.0 * 0.0254];
/// Half the width of the lane, and its end, in m.
const LANE: [f64; 2] = [0.5 * 41.5 * 0.0254, 34.1875 * 0.0254];

/// Watches a shot.
struct Watch<'w> {
    world: &'w RigidWorld,
    last: Vec<Option<RigidBodyState>>,
    /// The deepest overlap, and how far a centre was inside places where none can be.
    deepest: f64,
    outside: f64,
    /// Whether each body ever fell.
    fell: Vec<bool>,
    energy: Ledger<'w>,
}

impl Watch<'_> {
    /// How far the centre of a body is within the lane or beyond the walls.
    fn beyond(x: DVec3) -> f64 {
        let beyond = (x.x.abs() - INSIDE[0]).max(x.y - INSIDE[1]);
        let within = (LANE[0] - x.x.abs()).min(LANE[1] - x.y).min(-x.z);
        beyond.max(within)
    }
}

impl Observer<RigidWorld> for Watch<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        self.fell[index] |= Verdict::has_fallen(body);
        self.energy.motion(index, body);
        if body.phase == Phase::Gone {
            self.last[index] = None;
            return;
        }
        self.outside = self.outside.max(Self::beyond(body.path.x));
        self.last[index] = Some(body.clone());
        for (other, there) in self.last.iter().enumerate().filter(|(other, _)| *other != index) {
            let Some(there) = there.as_ref().filter(|there| there.path.t <= body.path.t) else { continue };
            let there = self.world.at(other, there, body.path.t);
            self.deepest = self.deepest.max(-self.world.gap([index, other], [body, &there]));
        }
    }
}

/// Counts over whole shots.
#[derive(Default)]
struct Whole {
    deeper: [u64; DEPTHS.len()],
    deepest: f64,
    outside: f64,
    /// The largest growth of the energy from one event to the next, in J.
    gained: f64,
    unfinished: u64,
    other: u64,
    /// Pins that fell but stand upright at the end, and pins that lean without having fallen.
    risen: u64,
    leaning: u64,
}

/// Cosine of the angle beyond which a pin cannot stand by itself: 10.2°.
const TIPPED: f64 = 0.984;

impl Whole {
    fn add(&mut self, scene: &Bowling, draw: &Shot, early: &Rest) -> Result<(), Box<dyn Error>> {
        let (world, starts) = scene.world(draw)?;
        let mut state = world.state(&starts)?;
        let count = starts.len();
        let mut rises = Tally::default();
        let mut watch = Watch {
            world: &world,
            last: vec![None; count],
            deepest: 0.0,
            outside: f64::NEG_INFINITY,
            fell: vec![false; count],
            energy: Ledger::of(&world, state.bodies(), 1.0, &mut rises),
        };
        let outcome = world.run(&mut state, &mut Scratch::default(), scene.config().duration_s, &mut watch)?;
        watch.energy.close();
        for (count, depth) in self.deeper.iter_mut().zip(DEPTHS) {
            *count += u64::from(watch.deepest > depth);
        }
        (self.deepest, self.outside) = (self.deepest.max(watch.deepest), self.outside.max(watch.outside));
        self.unfinished += u64::from(!matches!(outcome, Outcome::AllAtRest | Outcome::TimeReached));
        let mut whole = Rest { pins: Vec::new(), ..early.clone() };
        for ((body, start), fell) in state.bodies().iter().zip(&starts).zip(watch.fell).skip(1) {
            let up = (body.turn * DVec3::Z).z;
            self.risen += u64::from(fell && up > TIPPED && !Verdict::has_fallen(body));
            self.leaning += u64::from(!fell && up < TIPPED);
            let way = (body.path.at(state.time()) - start.position).truncate().length();
            whole.pins.push(if fell { Fate::Down } else { Fate::Standing(way) });
        }
        self.gained = self.gained.max(rises.largest);
        let stand = |rest: &Rest| rest.pins.iter().map(|fate| fate.stands()).collect::<Vec<_>>();
        self.other += u64::from(stand(&whole) != stand(early) || scene.counts(&whole) != scene.counts(early));
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let (flags, given): (Vec<String>, Vec<String>) = std::env::args().skip(1).partition(|said| said.starts_with("--"));
    let file = given.first().cloned().unwrap_or_else(|| "scenarios/bowling-strike.toml".into());
    let number = |place: usize, default: u64| given.get(place).map_or(Ok(default), |count| count.parse());
    let (shots, first) = (number(1, 20)?.max(1), number(2, 0)?);
    // Examples may be run from anywhere in the workspace.
    let path = [file.clone(), format!("{}/../../{file}", env!("CARGO_MANIFEST_DIR"))];
    let text = path.iter().find_map(|path| std::fs::read_to_string(path).ok()).ok_or("no such scenario")?;
    let World::Bowling(config) = Scenario::read(&file, &text, &[])?.world else {
        return Err("not a bowling scenario".into());
    };
    let scene = Bowling::new(&config)?;
    let (mut work, mut times, mut satisfied, mut falls) = (Work::default(), Vec::new(), 0, [0; 11]);
    let mut whole = flags.iter().any(|flag| flag == "--whole").then(Whole::default);
    for shot in first..first + shots {
        let draw = scene.start(&mut Seed(1).chain(shot).at(0, Purpose::START));
        let begin = seconds();
        let state = StateOf::<Bowling>::evaluate(&scene, draw, &mut work)?;
        times.push(((seconds() - begin) * 1e3, shot));
        satisfied += u32::from(scene.is_satisfied(&state.outcome));
        falls[state.outcome.pins.iter().filter(|fate| !fate.stands()).count()] += 1;
        // A ball in the gutter is dead, whatever it does there.
        if let Some(whole) = whole.as_mut().filter(|_| !state.outcome.struck.is_empty()) {
            let (before, outside, gained) = (whole.other, whole.outside.max(0.0), whole.gained);
            whole.add(&scene, &state.draw, &state.outcome)?;
            if whole.other > before {
                println!(
                    "shot {shot} ends with other pins than it was told early ({:.3} m across)",
                    state.draw.get(Quantity::Across)
                );
            }
            if whole.gained > gained.max(TOLD) {
                println!("shot {shot}: an event makes {:.6} J", whole.gained);
            }
            if whole.outside > outside {
                println!("shot {shot}: a middle is {:.3} mm where none can be", whole.outside * 1e3);
            }
        }
    }
    let total: f64 = times.iter().map(|time| time.0).sum();
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let at = |share: f64| times[((shots as f64 - 1.0) * share) as usize];
    println!(
        "{shots} shots of {file}: mean {:.2} ms of processor time, median {:.2} ms, 90% within {:.2} ms, longest {:.2} ms (shot {})",
        total / shots as f64,
        at(0.5).0,
        at(0.9).0,
        at(1.0).0,
        at(1.0).1
    );
    println!("satisfied: {satisfied}; pins that fell, 0 to 10: {falls:?}");
    if let Some(whole) = whole {
        println!(
            "whole shots: overlaps deeper than 0.1, 1, 10 mm in {:?}, deepest {:.3} mm; middles where none can be: by {:.3} mm at most; energy made by one event: {:.6} J at most; out of events: {}; fallen pins that stand again: {}; pins that lean and have not fallen: {}; other pins, or other k and m, than told early: {}",
            whole.deeper,
            whole.deepest * 1e3,
            whole.outside.max(0.0) * 1e3,
            whole.gained,
            whole.unfinished,
            whole.risen,
            whole.leaning,
            whole.other
        );
    }
    Ok(())
}
