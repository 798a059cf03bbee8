//! Shots at ten pins.

use crate::peer::{AlleyParts, AlleyPeer};
use crate::world::{Outcome, Places, Reading, Way, World};
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_figures::Result;
use plaus_figures::clock::timed;
use plaus_scenes::bowling::Alley;
use plaus_sim::rigid::{Phase, RigidScratch, RigidWorld, Start};
use plaus_sim::{Accuracy, Preset, Scratch};

/// Longest shot in s.
const DURATION: f64 = 5.0;
/// Distance from the head pin at which a shot begins, in m.
const DISTANCE: f64 = 2.0;
const PINS: usize = 10;

pub(crate) struct Shots {
    alley: Alley,
    worlds: Vec<(Preset, RigidWorld)>,
    peer: AlleyParts,
    scratch: Scratch<RigidScratch>,
}

impl Shots {
    pub(crate) fn new() -> Result<Self> {
        let alley = Alley { duration: DURATION, ..Alley::default() };
        let world = |preset| Ok((preset, Alley { accuracy: Accuracy::preset(preset), ..alley }.world()?));
        let worlds = Preset::ALL.into_iter().map(world).collect::<Result<_>>()?;
        Ok(Self { alley, worlds, peer: AlleyParts::new(&alley)?, scratch: Scratch::default() })
    }

    /// Towards the pocket between the head pin and the 3 pin, at −1 to 6 degrees, rolling.
    fn starts(&self, draw: u64) -> Result<Vec<Start>> {
        let mut stream = Seed(7).chain(3).at(draw, Purpose::START);
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(&mut stream);
        let (angle, speed) = (between(-0.02, 0.1), between(7.0, 8.5));
        let velocity = DVec3::new(-angle * speed, speed, 0.0);
        let spin = DVec3::new(-velocity.y, velocity.x, 0.0) / self.alley.ball_radius;
        let x = between(0.0, 0.1) + angle * DISTANCE;
        Ok(self.alley.starts(DISTANCE, x, velocity, spin)?)
    }

    fn world(&self, preset: Preset) -> Result<&RigidWorld> {
        Ok(&self.worlds.iter().find(|world| world.0 == preset).ok_or("no such preset")?.1)
    }

    /// How many pins fell; and for each pin whether it stands.
    fn read(&self, pose: impl Fn(usize) -> Option<(DVec3, DQuat)>) -> Outcome {
        let stands = |pin: usize| pose(pin).is_some_and(|(x, turn)| Alley::stands(pin, x, turn * DVec3::Z));
        let pins: Vec<u16> = (1..=PINS).map(|pin| (2 * (pin - 1)) as u16 + u16::from(stands(pin))).collect();
        let fallen = pins.iter().filter(|&pin| pin % 2 == 0).count();
        vec![vec![fallen as u16], pins]
    }
}

impl World for Shots {
    fn name(&self) -> &'static str {
        "bowling"
    }

    fn title(&self) -> &'static str {
        "A bowling ball at ten pins"
    }

    fn about(&self) -> String {
        format!(
            "A 15 lb ball rolls from {DISTANCE} m before the head pin, at 7 to 8.5 m/s and −1 to 6 degrees, towards the pocket; {DURATION} s, less where everything rests. Read: how many pins fell; of \
             each pin whether it stands. The peer has the same lane, gutters, kickbacks and pit, the same masses, \
             inertias, friction and restitution for each pair, pins made of seven convex pieces \
             with 20 corners around (belly, five slices of the neck, head), and continuous collision detection. Timed: the simulation of a world that is ready."
        )
    }

    fn readings(&self) -> Vec<Reading> {
        vec![Reading { name: "pins down", categories: PINS + 1 }, Reading { name: "which pins", categories: 2 * PINS }]
    }

    /// A tenth of the radius of a pin's foot.
    fn tolerance(&self) -> f64 {
        0.0026
    }

    /// A shot takes longest of all.
    fn patience(&self) -> f64 {
        3.0
    }

    fn outcome(&mut self, way: Way, draw: u64) -> Result<(Outcome, f64)> {
        let starts = self.starts(draw)?;
        match way {
            Way::Preset(preset) => {
                let (_, world) = self.worlds.iter().find(|world| world.0 == preset).ok_or("no such preset")?;
                let mut state = world.state(&starts)?;
                let (outcome, seconds) = timed(|| world.run(&mut state, &mut self.scratch, DURATION, &mut ()));
                outcome?;
                let pose = |pin: usize| {
                    let body = world.at(pin, &state.bodies()[pin], state.time());
                    (body.phase != Phase::Gone).then_some((body.path.x, body.turn))
                };
                Ok((self.read(pose), seconds))
            }
            Way::Peer(rate) => {
                let mut peer = AlleyPeer::new(&self.peer, &starts, rate);
                let ((), seconds) = timed(|| peer.run_to(DURATION));
                Ok((self.read(|pin| peer.pin(pin)), seconds))
            }
        }
    }

    fn places(&mut self, way: Way, draw: u64, times: &[f64]) -> Result<Vec<Places>> {
        let starts = self.starts(draw)?;
        match way {
            Way::Preset(preset) => {
                let mut scratch = std::mem::take(&mut self.scratch);
                let world = self.world(preset)?;
                let mut state = world.state(&starts)?;
                let at = |&time: &f64| {
                    world.run(&mut state, &mut scratch, time, &mut ())?;
                    let place = |k: usize| {
                        let body = world.at(k, &state.bodies()[k], time);
                        (body.phase != Phase::Gone).then_some(body.path.x)
                    };
                    Ok((0..=PINS).map(place).collect())
                };
                let places = times.iter().map(at).collect();
                self.scratch = scratch;
                places
            }
            Way::Peer(rate) => {
                let mut peer = AlleyPeer::new(&self.peer, &starts, rate);
                let at = |&time: &f64| {
                    peer.run_to(time);
                    peer.places()
                };
                Ok(times.iter().map(at).collect())
            }
        }
    }
}
