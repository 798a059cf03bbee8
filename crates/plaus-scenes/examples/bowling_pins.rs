//! Rolls a ball at ten pins many times, to the end and until it is decided which pins stand. Prints how many fell, how
//! much work that was, how long it took, and in how many shots the early end gave other standing pins. The first shot,
//! until it is decided, is written as JSON: all motions and impacts.
//!
//! `cargo run --release -p plaus-scenes --example bowling_pins -- [shots] [preset] [--trace PATH]`
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

#[path = "../../plaus-sim/examples/measure/mod.rs"]
mod measure;

use glam::DVec3;
use measure::{Digest, Stopwatch, arguments, write_trace};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_scenes::bowling::{Alley, Verdict};
use plaus_sim::rigid::Start;
use plaus_sim::trace::{Trace, While};
use plaus_sim::{Accuracy, Outcome, Preset, Scratch, WorldError};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (args, path) = arguments("target/pins.json")?;
    let shots: usize = args.first().map_or(Ok(50), |a| a.parse())?;
    let is_asked = |p: &Preset| args.get(1).map_or(*p <= Preset::Standard, |name| name == p.name());
    println!(
        "{:>9} {:>7} {:>9} {:>9} {:>9} {:>7} {:>8}  {:<16}  pins down 0..10; outcomes (time, rest, decided, events, bad)",
        "preset", "end", "median", "90 %", "cpu/shot", "events", "impacts", "digest"
    );
    for preset in Preset::ALL.into_iter().filter(is_asked) {
        let alley = Alley { accuracy: Accuracy::preset(preset), ..Alley::default() };
        let starts = deliveries(&alley, shots)?;
        let whole = row(&alley, preset.name(), false, &starts)?;
        let early = row(&alley, preset.name(), true, &starts)?;
        let other = whole.iter().zip(&early).filter(|(a, b)| a != b).count();
        println!("{:>9} {other} of {shots} shots leave other pins when they end early", preset.name());
    }
    let alley = Alley::default();
    let world = alley.world()?;
    let mut state = world.state(&deliveries(&alley, 1)?[0])?;
    let mut trace = Trace::default();
    let verdict = Verdict::new(&alley)?;
    let mut listeners = (&mut trace, While(|s: &_| !verdict.is_final(&world, s)));
    let outcome = world.run(&mut state, &mut Scratch::default(), 5.0, &mut listeners)?;
    write_trace(&path, &trace)?;
    let motions: usize = trace.motions.iter().map(Vec::len).sum();
    println!(
        "wrote {path}: {motions} motions and {} impacts, {outcome:?} at {:.3} s",
        trace.impacts.len(),
        state.time()
    );
    Ok(())
}

/// Deliveries towards the pocket between the head pin and the 3 pin, up to 6 degrees, rolling.
fn deliveries(alley: &Alley, shots: usize) -> Result<Vec<Vec<Start>>, WorldError> {
    let mut stream = Seed(3).chain(0).at(0, Purpose::START);
    let mut between = |low: f64, high: f64| low + (high - low) * open_unit(&mut stream);
    let shot = |_| {
        let (angle, speed, distance) = (between(-0.02, 0.1), between(7.0, 8.5), 2.0);
        let velocity = DVec3::new(-angle * speed, speed, 0.0);
        let x = between(0.0, 0.1) + angle * distance;
        let spin = DVec3::new(-velocity.y, velocity.x, 0.0) / alley.ball_radius;
        alley.starts(distance, x, velocity, spin)
    };
    (0..shots).map(shot).collect()
}

/// Prints a row and returns which pins stood after each shot, as bits.
fn row(alley: &Alley, preset: &str, early: bool, starts: &[Vec<Start>]) -> Result<Vec<u16>, WorldError> {
    let (world, verdict) = (alley.world()?, Verdict::new(alley)?);
    let mut scratch = Scratch::default();
    let (mut events, mut impacts) = (0, 0);
    let (mut down, mut outcomes, mut digest) = ([0; 11], [0; 5], Digest::new());
    let mut stood = Vec::new();
    let mut watch = Stopwatch::start();
    for starts in starts {
        let (state, outcome) = watch.time(|| {
            let mut state = world.state(starts)?;
            let outcome = if early {
                world.run(&mut state, &mut scratch, 5.0, &mut While(|s: &_| !verdict.is_final(&world, s)))
            } else {
                world.run(&mut state, &mut scratch, 5.0, &mut ())
            };
            Ok::<_, WorldError>((state, outcome?))
        })?;
        events += state.counts().events;
        impacts += state.counts().impacts;
        outcomes[match outcome {
            Outcome::TimeReached => 0,
            Outcome::AllAtRest => 1,
            Outcome::Stopped => 2,
            Outcome::OutOfEvents => 3,
            Outcome::NotFinite { .. } | Outcome::Crushed { .. } => 4,
        }] += 1;
        let mut standing = 0_u16;
        for k in 1..=10 {
            let body = world.at(k, &state.bodies()[k], state.time());
            digest.add_all(body.path.x.to_array().into_iter().chain(body.turn.to_array()));
            standing |= u16::from(Alley::stands(k, body.path.x, body.turn * DVec3::Z)) << k;
        }
        down[10 - standing.count_ones() as usize] += 1;
        stood.push(standing);
    }
    let shots = starts.len() as u64;
    println!(
        "{preset:>9} {:>7} {:>7.2}ms {:>7.2}ms {:>7.2}ms {:>7} {:>8}  {:016x}  {down:?} {outcomes:?}",
        if early { "decided" } else { "5 s" },
        1e3 * watch.quantile(0.5),
        1e3 * watch.quantile(0.9),
        1e3 * watch.mean(),
        events / shots,
        impacts / shots,
        digest.get()
    );
    Ok(stood)
}
