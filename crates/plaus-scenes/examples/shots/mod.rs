//! Shots at ten pins until everything is at rest, and the energy that they add.

use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_scenes::bowling::Alley;
use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Preset, Scratch};
use std::error::Error;

/// Rises of the energy of all bodies together from one time to the next, over a pin's weight times its foot's radius.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    /// How many rises are above [`Tally::LEAST`].
    pub(crate) above: [u64; 3],
    pub(crate) largest: f64,
    pub(crate) times: u64,
}

impl Tally {
    pub(crate) const LEAST: [f64; 3] = [1e-9, 1e-4, 1e-2];

    fn count(&mut self, rise: f64) {
        for (count, least) in self.above.iter_mut().zip(Self::LEAST) {
            *count += u64::from(rise > least);
        }
        self.largest = self.largest.max(rise);
        self.times += 1;
    }
}

/// Sums the bodies' energies whenever time has gone on: all reports of one event have the same clock.
pub(crate) struct Ledger<'w> {
    world: &'w RigidWorld,
    each: Vec<f64>,
    clock: f64,
    before: f64,
    /// In J, what rises are counted in.
    unit: f64,
    tally: &'w mut Tally,
}

impl<'w> Ledger<'w> {
    /// Begins with the energies of these bodies.
    pub(crate) fn of(world: &'w RigidWorld, bodies: &[RigidBodyState], unit: f64, tally: &'w mut Tally) -> Self {
        let each: Vec<f64> = bodies.iter().enumerate().map(|(k, body)| world.energy(k, body)).collect();
        let before = each.iter().sum();
        Self { world, each, clock: 0.0, before, unit, tally }
    }

    /// Counts the rise since the last event; also to be called after the last one.
    pub(crate) fn close(&mut self) {
        let now = self.sum();
        self.tally.count((now - self.before) / self.unit);
        self.before = now;
    }

    /// The energy of all bodies, in J.
    pub(crate) fn sum(&self) -> f64 {
        self.each.iter().sum()
    }
}

impl Observer<RigidWorld> for Ledger<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        if body.path.t != self.clock {
            self.close();
            self.clock = body.path.t;
        }
        if body.phase == Phase::Gone {
            // A body that leaves takes its energy along, which is negative below the deck.
            (self.each[index], self.before) = (0.0, f64::INFINITY);
        } else {
            self.each[index] = self.world.energy(index, body);
        }
    }
}

/// Rises of energy in this many shots of five seconds, or until all is at rest. The shots are always the same.
pub(crate) fn rises(shots: usize, preset: Preset) -> Result<Tally, Box<dyn Error>> {
    let alley = Alley { accuracy: Accuracy::preset(preset), ..Alley::default() };
    let world = alley.world()?;
    let unit = alley.pin_mass * 9.81 * alley.pin()?.rings()[0].circle;
    let mut stream = Seed(3).chain(0).at(0, Purpose::START);
    let mut between = |low: f64, high: f64| low + (high - low) * open_unit(&mut stream);
    let mut tally = Tally::default();
    for _ in 0..shots {
        let (angle, speed) = (between(-0.02, 0.1), between(7.0, 8.5));
        let velocity = DVec3::new(-angle * speed, speed, 0.0);
        let spin = DVec3::new(-velocity.y, velocity.x, 0.0) / alley.ball_radius;
        let starts = alley.starts(2.0, between(0.0, 0.1) + angle * 2.0, velocity, spin)?;
        let mut state = world.state(&starts)?;
        let mut ledger = Ledger::of(&world, state.bodies(), unit, &mut tally);
        world.run(&mut state, &mut Scratch::default(), 5.0, &mut ledger)?;
        ledger.close();
    }
    Ok(tally)
}
