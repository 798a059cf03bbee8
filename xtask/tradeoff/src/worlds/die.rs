//! A die thrown onto a table, flat or bumpy.

#[path = "../../../../crates/plaus-sim/tests/common/bumps.rs"]
mod bumps;

use crate::peer::{DiePeer, Ground};
use crate::world::{Outcome, Places, Reading, Way, World};
use bumps::noise;
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_figures::Result;
use plaus_figures::clock::timed;
use plaus_sim::rigid::{RigidScratch, Start};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Preset, Scratch};

/// Longest throw in s.
const DURATION: f64 = 20.0;
/// Width in m, and number, of the strips across the throw's direction into which the table is divided to read places.
const STRIP: f64 = 0.1;
const STRIPS: usize = 8;
/// Standard deviation of a bumpy table's control heights, relative to the grid's spacing.
const BUMPS: f64 = 0.1;

pub(crate) struct Throws {
    name: &'static str,
    title: &'static str,
    die: DieOnTable,
    ground: Ground,
    scratch: Scratch<RigidScratch>,
}

impl Throws {
    pub(crate) fn flat() -> Result<Self> {
        Self::new("die", "A die on a flat table", DieOnTable::default())
    }

    pub(crate) fn bumpy() -> Result<Self> {
        Self::new("die-bumpy", "A die on a bumpy table", DieOnTable { bumps: BUMPS, ..DieOnTable::default() })
    }

    fn new(name: &'static str, title: &'static str, die: DieOnTable) -> Result<Self> {
        let ground = Ground::of(&die.world(noise)?.parts()[0])?;
        Ok(Self { name, title, die, ground, scratch: Scratch::default() })
    }

    fn at(&self, preset: Preset) -> DieOnTable {
        DieOnTable { accuracy: Accuracy::preset(preset), ..self.die }
    }

    fn start(&self, draw: u64) -> Start {
        let mut stream = Seed(7).chain(2).at(draw, Purpose::START);
        self.die.throw(|| open_unit(&mut stream))
    }

    /// The face that is up; and the same together with the strip in which the die lies.
    fn read(&self, x: DVec3, turn: DQuat) -> Outcome {
        let up = turn.conjugate() * DVec3::Z;
        let axis = (0..3).max_by(|&a, &b| up[a].abs().total_cmp(&up[b].abs())).unwrap_or(0);
        let face = 2 * axis + usize::from(up[axis] > 0.0);
        let strip = ((x.x / STRIP).max(0.0) as usize).min(STRIPS - 1);
        vec![vec![(face * STRIPS + strip) as u16], vec![face as u16]]
    }
}

impl World for Throws {
    fn name(&self) -> &'static str {
        self.name
    }

    fn title(&self) -> &'static str {
        self.title
    }

    fn about(&self) -> String {
        let table = if self.die.bumps > 0.0 {
            format!(
                "a b-spline table, control points every 8 mm with heights of spread {} mm (one table; ours asks for its control points anew in each throw, as a sampler would); the peer's is a height field with \
                 a point every 2 mm",
                1e3 * BUMPS * self.die.spacing * self.die.edges.x
            )
        } else {
            "a flat table".to_owned()
        };
        format!(
            "A 16 mm die from about 10 cm at up to 1.5 m/s and 30 rad/s an axis onto {table}; until it rests, 20 s at most. Read: the face up together with the place along the throw, in {STRIPS} \
             strips of {STRIP} m; the face alone. The peer has continuous collision detection, and ends when speed and \
             spin have been below ours at rest for 0.1 s. Timed: of ours the making of \
             the world and the throw, of the peer stepping alone."
        )
    }

    fn readings(&self) -> Vec<Reading> {
        vec![Reading { name: "face and place", categories: 6 * STRIPS }, Reading { name: "face", categories: 6 }]
    }

    fn tolerance(&self) -> f64 {
        0.05 * self.die.edges.x
    }

    fn outcome(&mut self, way: Way, draw: u64) -> Result<(Outcome, f64)> {
        let start = self.start(draw);
        match way {
            Way::Preset(preset) => {
                let (die, scratch) = (self.at(preset), &mut self.scratch);
                let (end, seconds) = timed(|| -> Result<_> {
                    let world = die.world(noise)?;
                    let mut state = world.state(&[start])?;
                    world.run(&mut state, scratch, DURATION, &mut ())?;
                    Ok(world.at(0, &state.bodies()[0], state.time()))
                });
                let body = end?;
                Ok((self.read(body.path.x, body.turn), seconds))
            }
            Way::Peer(rate) => {
                let mut peer = DiePeer::new(&self.die, &self.ground, &start, rate);
                let ((), seconds) = timed(|| peer.run_to(DURATION));
                let (x, turn) = peer.pose();
                Ok((self.read(x, turn), seconds))
            }
        }
    }

    fn places(&mut self, way: Way, draw: u64, times: &[f64]) -> Result<Vec<Places>> {
        let start = self.start(draw);
        match way {
            Way::Preset(preset) => {
                let world = self.at(preset).world(noise)?;
                let mut state = world.state(&[start])?;
                let at = |&time: &f64| {
                    world.run(&mut state, &mut self.scratch, time, &mut ())?;
                    Ok(vec![Some(world.at(0, &state.bodies()[0], time).path.x)])
                };
                times.iter().map(at).collect()
            }
            Way::Peer(rate) => {
                let mut peer = DiePeer::new(&self.die, &self.ground, &start, rate);
                let at = |&time: &f64| {
                    peer.run_to(time);
                    vec![Some(peer.pose().0)]
                };
                Ok(times.iter().map(at).collect())
            }
        }
    }
}
