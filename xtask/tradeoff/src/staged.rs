//! Worlds of turning bodies that are said once, for both simulators.

use crate::peer::{Cast, CastPeer, GRAVITY, Pose};
use crate::world::{Outcome, Places, Reading, Way, World};
use glam::DVec3;
use plaus_dist::{Purpose, Seed, Stream};
use plaus_figures::Result;
use plaus_figures::clock::timed;
use plaus_sim::rigid::{RigidScratch, RigidWorld, RigidWorldDesc, Start};
use plaus_sim::{Accuracy, Laws, Preset, Scratch};

/// What such a world is.
pub(crate) trait Setting {
    fn name(&self) -> &'static str;
    fn title(&self) -> &'static str;
    /// What it is, and what is read.
    fn about(&self) -> String;
    fn cast(&self) -> Result<Cast>;
    /// Random starts.
    fn starts(&self, stream: &mut Stream) -> Vec<Start>;
    fn readings(&self) -> Vec<Reading>;
    /// From the poses of all bodies at the end.
    fn read(&self, ends: &[Pose]) -> Outcome;
    fn tolerance(&self) -> f64;
    /// Longest time of a draw, in s.
    fn duration(&self) -> f64;
    fn patience(&self) -> f64 {
        1.0
    }
    /// Height in m of the bodies' centres of gravity, on average by mass, where they have least energy.
    fn lowest(&self) -> f64 {
        0.0
    }
}

pub(crate) struct Staged<S> {
    setting: S,
    cast: Cast,
    worlds: Vec<(Preset, RigidWorld)>,
    scratch: Scratch<RigidScratch>,
}

impl<S: Setting> Staged<S> {
    pub(crate) fn new(setting: S) -> Result<Self> {
        let cast = setting.cast()?;
        let world = |preset| Ok((preset, build(&cast, preset, setting.duration())?));
        let worlds = Preset::ALL.into_iter().map(world).collect::<Result<_>>()?;
        Ok(Self { setting, cast, worlds, scratch: Scratch::default() })
    }

    fn starts(&self, draw: u64) -> Vec<Start> {
        self.setting.starts(&mut Seed(7).chain(4).at(draw, Purpose::START))
    }
}

/// Our world of a cast.
pub(crate) fn build(cast: &Cast, preset: Preset, duration: f64) -> Result<RigidWorld> {
    let mut world = RigidWorld::new(RigidWorldDesc {
        bodies: cast.bodies.iter().map(|(spec, _)| spec.clone()).collect(),
        parts: cast.parts.iter().map(|(part, _)| part.clone()).collect(),
        laws: Laws::uniform(cast.law)?,
        gravity: DVec3::new(0.0, 0.0, -GRAVITY),
        accuracy: Accuracy::preset(preset),
        skin: 0.5,
        sink: f64::NEG_INFINITY,
        duration,
    })?;
    for joint in &cast.joints {
        world.join(*joint)?;
    }
    Ok(world)
}

impl<S: Setting> World for Staged<S> {
    fn name(&self) -> &'static str {
        self.setting.name()
    }

    fn title(&self) -> &'static str {
        self.setting.title()
    }

    fn about(&self) -> String {
        let ends = "The peer has the same shapes, masses, moments of inertia and coefficients, and continuous \
                    collision detection; it ends when all speeds have been below ours at rest for 0.1 s. Timed: the \
                    simulation of a world that is ready.";
        format!("{} At most {} s. {ends}", self.setting.about(), self.setting.duration())
    }

    fn readings(&self) -> Vec<Reading> {
        self.setting.readings()
    }

    fn tolerance(&self) -> f64 {
        self.setting.tolerance()
    }

    fn patience(&self) -> f64 {
        self.setting.patience()
    }

    fn outcome(&mut self, way: Way, draw: u64) -> Result<(Outcome, f64)> {
        let (starts, duration) = (self.starts(draw), self.setting.duration());
        let (ends, seconds): (Vec<Pose>, f64) = match way {
            Way::Preset(preset) => {
                let (_, world) = self.worlds.iter().find(|world| world.0 == preset).ok_or("no such preset")?;
                let mut state = world.state(&starts)?;
                let (outcome, seconds) = timed(|| world.run(&mut state, &mut self.scratch, duration, &mut ()));
                outcome?;
                let end = |(k, body)| {
                    let body = world.at(k, body, state.time());
                    (body.path.x, body.turn)
                };
                (state.bodies().iter().enumerate().map(end).collect(), seconds)
            }
            Way::Peer(rate) => {
                let mut peer = CastPeer::new(&self.cast, &starts, rate);
                let ((), seconds) = timed(|| peer.run_to(duration));
                ((0..starts.len()).map(|k| peer.pose(k)).collect(), seconds)
            }
        };
        Ok((self.setting.read(&ends), seconds))
    }

    fn places(&mut self, way: Way, draw: u64, times: &[f64]) -> Result<Vec<Places>> {
        let starts = self.starts(draw);
        match way {
            Way::Preset(preset) => {
                let (_, world) = self.worlds.iter().find(|world| world.0 == preset).ok_or("no such preset")?;
                let (mut state, scratch) = (world.state(&starts)?, &mut self.scratch);
                let at = |&time: &f64| {
                    world.run(&mut state, scratch, time, &mut ())?;
                    Ok(state.bodies().iter().enumerate().map(|(k, b)| Some(world.at(k, b, time).path.x)).collect())
                };
                times.iter().map(at).collect()
            }
            Way::Peer(rate) => {
                let mut peer = CastPeer::new(&self.cast, &starts, rate);
                let at = |&time: &f64| {
                    peer.run_to(time);
                    Ok((0..starts.len()).map(|k| Some(peer.pose(k).0)).collect())
                };
                times.iter().map(at).collect()
            }
        }
    }
}
