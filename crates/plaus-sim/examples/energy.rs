//! Rolls a ball at ten pins many times and counts where the energy of all bodies together rises between two events, and by how much: pushing bodies out of overlaps that steps of lasting
//! contact leave costs nothing in the simulation.
//!
//! `cargo run --release -p plaus-sim --example energy -- [shots] [preset]`
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::rigid::{Phase, Rigid, Turning};
use plaus_sim::trace::Observer;
use plaus_sim::worlds::Alley;
use plaus_sim::{Accuracy, Preset, Scratch};
use std::error::Error;

/// Sums what the bodies have, whenever time has gone on: all that one event concerns is told with the same clock.
struct Ledger<'w> {
    world: &'w Rigid,
    each: Vec<f64>,
    clock: f64,
    before: f64,
    /// Weight of a pin times its size.
    unit: f64,
    rises: [u64; 3],
    worst: f64,
    events: u64,
}

impl Ledger<'_> {
    fn close(&mut self) {
        if self.clock >= 0.0 {
            let now: f64 = self.each.iter().sum();
            let rise = (now - self.before) / self.unit;
            for (count, least) in self.rises.iter_mut().zip([1e-9, 1e-4, 1e-2]) {
                *count += u64::from(rise > least);
            }
            self.worst = self.worst.max(rise);
            self.events += 1;
            self.before = now;
        }
    }
}

impl Observer<Rigid> for Ledger<'_> {
    fn motion(&mut self, index: usize, body: &Turning) {
        if body.path.t != self.clock {
            self.close();
            self.clock = body.path.t;
        }
        if body.phase == Phase::Gone {
            // What leaves takes its energy, negative below the deck, along.
            (self.each[index], self.before) = (0.0, f64::INFINITY);
        } else {
            self.each[index] = self.world.energy(index, body);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let shots: usize = args.next().map_or(Ok(20), |a| a.parse())?;
    let name = args.next().unwrap_or("standard".into());
    let preset = Preset::ALL.into_iter().find(|p| p.name() == name).ok_or("draft, standard, fine or reference")?;
    let alley = Alley { accuracy: Accuracy::preset(preset), ..Alley::default() };
    let world = alley.world()?;
    let mut stream = Seed(3).chain(0).at(0, Purpose::START);
    let mut between = |low: f64, high: f64| low + (high - low) * open_unit(&mut stream);
    let (mut rises, mut events, mut worst) = ([0; 3], 0, 0.0_f64);
    for _ in 0..shots {
        let (angle, speed) = (between(-0.02, 0.1), between(7.0, 8.5));
        let velocity = DVec3::new(-angle * speed, speed, 0.0);
        let spin = DVec3::new(-velocity.y, velocity.x, 0.0) / alley.ball_radius;
        let starts = alley.starts(2.0, between(0.0, 0.1) + angle * 2.0, velocity, spin)?;
        let unit = alley.pin_mass * 9.81 * alley.pin()?.rings()[0].circle;
        let mut ledger = Ledger {
            world: &world,
            each: vec![0.0; world.count()],
            clock: -1.0,
            before: f64::INFINITY,
            unit,
            rises: [0; 3],
            worst: 0.0,
            events: 0,
        };
        let mut state = world.state(&starts)?;
        world.run(&mut state, &mut Scratch::default(), 5.0, &mut ledger)?;
        ledger.close();
        for (sum, more) in rises.iter_mut().zip(ledger.rises) {
            *sum += more;
        }
        (events, worst) = (events + ledger.events, worst.max(ledger.worst));
    }
    println!("{shots} shots, {events} times at the {name} preset; in units of a pin's weight times its size:");
    println!("rises above 1e-9, 1e-4, 1e-2: {rises:?}; largest {worst:.2e}");
    Ok(())
}
