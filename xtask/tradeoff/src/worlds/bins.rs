//! Ten marbles dropped one after another into 7 × 5 bins.

use crate::peer::MarblePeer;
use crate::world::{Outcome, Places, Reading, Way, World};
use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_figures::Result;
use plaus_figures::clock::timed;
use plaus_scenes::spelling::{Bins, drops};
use plaus_sim::marbles::{MarbleScratch, Marbles, Start};
use plaus_sim::{Accuracy, Preset, Scratch};

const COUNT: usize = 10;
const INTERVAL: f64 = 0.1;
const DURATION: f64 = 2.0;

pub(crate) struct MarblesOverBins {
    bins: Bins,
    worlds: Vec<(Preset, Marbles)>,
    scratch: Scratch<MarbleScratch>,
}

impl MarblesOverBins {
    pub(crate) fn new() -> Result<Self> {
        let bins = Bins::default();
        let world = |preset| Ok((preset, bins.world(COUNT, Accuracy::preset(preset), DURATION)?));
        let worlds = Preset::ALL.into_iter().map(world).collect::<Result<_>>()?;
        Ok(Self { bins, worlds, scratch: Scratch::default() })
    }

    fn starts(&self, draw: u64) -> Vec<Start> {
        let mut stream = Seed(7).chain(0).at(draw, Purpose::START);
        drops(&self.bins, COUNT, INTERVAL, || open_unit(&mut stream))
    }

    fn peer(&self, draw: u64, rate: f64) -> Result<MarblePeer> {
        MarblePeer::new(&self.bins, &self.bins.mesh()?, self.starts(draw), rate)
    }

    /// How many bins have a marble below the ridges; and for each marble its bin, or the last category if it is in
    /// none.
    fn read(&self, at: impl IntoIterator<Item = DVec3>) -> Outcome {
        let none = self.bins.columns * self.bins.rows;
        let bin = |x: DVec3| {
            let inside = self.bins.bin_of(x).filter(|_| x.z < self.bins.height);
            inside.map_or(none, |(column, row)| row * self.bins.columns + column) as u16
        };
        let bins: Vec<u16> = at.into_iter().map(bin).collect();
        let mut filled: Vec<u16> = bins.iter().copied().filter(|&bin| usize::from(bin) < none).collect();
        filled.sort_unstable();
        filled.dedup();
        vec![vec![filled.len() as u16], bins]
    }
}

impl World for MarblesOverBins {
    fn name(&self) -> &'static str {
        "bins"
    }

    fn title(&self) -> &'static str {
        "Ten marbles over 7 × 5 bins"
    }

    fn about(&self) -> String {
        "12 mm glass marbles, one every 0.1 s, into 20 mm bins with bowls and 2 mm × 12 mm partitions; 2 s. Read: how many bins are filled; the bin of each marble. The peer has the same \
         partitions and walls, bowls of flat facets, no resistance to rolling (it knows none) and continuous collision \
         detection; marbles are put in when they are released. Timed: the \
         simulation of a world that is ready."
            .into()
    }

    fn readings(&self) -> Vec<Reading> {
        let bins = self.bins.columns * self.bins.rows;
        vec![
            Reading { name: "bins filled", categories: COUNT + 1 },
            Reading { name: "bin of a marble", categories: bins + 1 },
        ]
    }

    fn tolerance(&self) -> f64 {
        0.1 * self.bins.marble
    }

    fn outcome(&mut self, way: Way, draw: u64) -> Result<(Outcome, f64)> {
        match way {
            Way::Preset(preset) => {
                let (_, world) = self.worlds.iter().find(|w| w.0 == preset).ok_or("no such preset")?;
                let mut state = world.state(&self.starts(draw))?;
                let (outcome, seconds) = timed(|| world.run(&mut state, &mut self.scratch, DURATION, &mut ()));
                outcome?;
                let place = |(k, ball)| world.at(k, ball, state.time()).path.x;
                Ok((self.read(state.bodies().iter().enumerate().map(place)), seconds))
            }
            Way::Peer(rate) => {
                let mut peer = self.peer(draw, rate)?;
                let ((), seconds) = timed(|| peer.run_to(DURATION));
                Ok((self.read(peer.places().into_iter().flatten()), seconds))
            }
        }
    }

    fn places(&mut self, way: Way, draw: u64, times: &[f64]) -> Result<Vec<Places>> {
        match way {
            Way::Preset(preset) => {
                let (_, world) = self.worlds.iter().find(|w| w.0 == preset).ok_or("no such preset")?;
                let mut state = world.state(&self.starts(draw))?;
                let at = |&time: &f64| {
                    world.run(&mut state, &mut self.scratch, time, &mut ())?;
                    let place = |(k, ball)| Some(world.at(k, ball, time).path.x);
                    Ok(state.bodies().iter().enumerate().map(place).collect())
                };
                times.iter().map(at).collect()
            }
            Way::Peer(rate) => {
                let mut peer = self.peer(draw, rate)?;
                let at = |&time: &f64| {
                    peer.run_to(time);
                    peer.places()
                };
                Ok(times.iter().map(at).collect())
            }
        }
    }
}
