//! Balls that spell HI and ACM, drawn from the scene's prior.

use crate::peer::MarblePeer;
use crate::world::{Outcome, Places, Reading, Way, World};
use glam::DVec3;
use plaus_dist::{LogPotential, Purpose, Seed};
use plaus_figures::Result;
use plaus_figures::clock::timed;
use plaus_mcmc::{Simulated, Target};
use plaus_scenes::AccuracyPreset;
use plaus_scenes::Scene;
use plaus_scenes::spelling::Bins;
use plaus_scenes::spelling::{Config, Drops, Letters, Rest, Spelling, Work};
use plaus_sim::Preset;
use plaus_sim::marbles::Start;

const MM: f64 = 1e-3;

pub(crate) struct Word {
    name: &'static str,
    title: &'static str,
    scenes: Vec<(Preset, Spelling, Work)>,
    /// The same box without the scene, for the peer.
    bins: Bins,
    duration: f64,
}

impl Word {
    pub(crate) fn hi() -> Result<Self> {
        Self::new("hi", "Balls that spell HI", &Config::default())
    }

    pub(crate) fn acm() -> Result<Self> {
        let config = Config { text: Some("ACM".into()), letters: Letters::Tall, ..Config::default() };
        Self::new("acm", "Balls that spell ACM", &config)
    }

    fn new(name: &'static str, title: &'static str, config: &Config) -> Result<Self> {
        let scene = |preset| {
            let accuracy = match preset {
                Preset::Draft => AccuracyPreset::Draft,
                Preset::Standard => AccuracyPreset::Standard,
                Preset::Fine => AccuracyPreset::Fine,
                Preset::Reference => AccuracyPreset::Reference,
            };
            Ok((preset, Spelling::new(&Config { accuracy, ..config.clone() })?, Work::default()))
        };
        let scenes: Vec<(Preset, Spelling, Work)> = Preset::ALL.into_iter().map(scene).collect::<Result<_>>()?;
        let any = &scenes[0].1;
        let (size, contact) = (&config.dimensions, &config.contact);
        let bins = Bins {
            columns: any.word().columns(),
            rows: any.word().rows(),
            side: size.bin_mm * MM,
            thickness: size.partition_mm * MM,
            height: size.partition_height_mm * MM,
            depth: size.depth_mm * MM,
            bowl: size.floor_radius_mm * MM,
            drop: config.drop_height_mm * MM,
            marble: config.ball_radius_mm * MM,
            density: config.density,
            wall_law: plaus_sim::Law::new(contact.box_friction, contact.box_restitution),
            marble_law: plaus_sim::Law::new(contact.ball_friction, contact.ball_restitution),
            ..Bins::default()
        };
        let duration = config.drop_interval_s * any.balls() as f64 + config.settle_s;
        Ok(Self { name, title, scenes, bins, duration })
    }

    fn scene(&self, preset: Preset) -> Result<&Spelling> {
        Ok(&self.scenes.iter().find(|scene| scene.0 == preset).ok_or("no such preset")?.1)
    }

    /// The same draw for every preset.
    fn draw(&self, draw: u64) -> Drops {
        self.scenes[0].1.start(&mut Seed(7).chain(1).at(draw, Purpose::START))
    }

    fn peer(&self, draw: u64, rate: f64) -> Result<(MarblePeer, Drops)> {
        let (drops, config) = (self.draw(draw), self.scenes[0].1.config());
        let mut mesh = self.bins.mesh()?;
        let offset =
            |(k, offset): (usize, &[f64; 3])| (k as u32, self.bins.crossing(k) + DVec3::from_array(*offset) * MM);
        mesh.move_vertices(&drops.offsets.iter().enumerate().map(offset).collect::<Vec<_>>())?;
        // Each ball has its slot in time, whether or not the others are dropped.
        let start = |(slot, ball): (usize, &Option<[f64; 2]>)| {
            let [x, y] = (*ball)?;
            let time = config.drop_interval_s * slot as f64;
            Some(Start { time, ..Start::at_rest(DVec3::new(x * MM, y * MM, self.bins.drop)) })
        };
        let starts = drops.balls.iter().enumerate().filter_map(start).collect();
        Ok((MarblePeer::new(&self.bins, &mesh, starts, rate)?, drops))
    }

    /// The peer's balls as the scene sees them: a ball is in the bin over whose floor it lies, if its lowest point is
    /// less than halfway up the partitions.
    fn rest(&self, drops: &Drops, places: &Places) -> Rest {
        let bin = |x: &DVec3| {
            let low = x.z - self.bins.marble < 0.5 * self.bins.height;
            let (column, row) = self.bins.bin_of(*x).filter(|_| low)?;
            Some(((self.bins.rows - 1 - row) * self.bins.columns + column) as u16)
        };
        let mut places = places.iter();
        let of_ball = |ball: &Option<[f64; 2]>| {
            ball.as_ref()?;
            places.next()?.as_ref().and_then(bin)
        };
        Rest { bins: drops.balls.iter().map(of_ball).collect(), complete: true, failed: None }
    }

    /// How many bins of the word are filled; and for each dropped ball its bin, or the last category if it is in none.
    fn read(&self, drops: &Drops, rest: &Rest) -> Outcome {
        let none = (self.bins.columns * self.bins.rows) as u16;
        let dropped = rest.bins.iter().zip(&drops.balls).filter(|(_, ball)| ball.is_some());
        let bins = dropped.map(|(bin, _)| bin.unwrap_or(none)).collect();
        vec![vec![self.scenes[0].1.filled(rest) as u16], bins]
    }
}

impl World for Word {
    fn name(&self) -> &'static str {
        self.name
    }

    fn title(&self) -> &'static str {
        self.title
    }

    fn about(&self) -> String {
        format!(
            "The scene's prior: of {} balls each is dropped or not, one every {} s at a random place over {} × {} bins whose partitions' vertices are off by 0.1 mm an axis; {} s. Read: how many \
             of the word's bins are filled (k); the bin of each ball. The peer has the same world as for ten marbles. \
             Timed: all that the scene does for a draw without knowing another, groups of balls \
             and moved vertices included; of the peer, stepping alone.",
            self.scenes[0].1.balls(),
            self.scenes[0].1.config().drop_interval_s,
            self.bins.columns,
            self.bins.rows,
            self.duration
        )
    }

    fn readings(&self) -> Vec<Reading> {
        let (bins, wanted) = (self.bins.columns * self.bins.rows, self.scenes[0].1.word().designated().len());
        vec![Reading { name: "k", categories: wanted + 1 }, Reading { name: "bin of a ball", categories: bins + 1 }]
    }

    fn tolerance(&self) -> f64 {
        0.1 * self.bins.marble
    }

    fn outcome(&mut self, way: Way, draw: u64) -> Result<(Outcome, f64)> {
        match way {
            Way::Preset(preset) => {
                let drops = self.draw(draw);
                let (_, scene, work) = self.scenes.iter_mut().find(|s| s.0 == preset).ok_or("no such preset")?;
                let (simulated, seconds) = timed(|| scene.simulate(&drops, None, LogPotential::ZERO, work));
                match simulated? {
                    Simulated::Complete(rest) => Ok((self.read(&drops, &rest), seconds)),
                    Simulated::CannotExceedFloor => Err("a simulation stopped that had no floor".into()),
                }
            }
            Way::Peer(rate) => {
                let (mut peer, drops) = self.peer(draw, rate)?;
                let ((), seconds) = timed(|| peer.run_to(self.duration));
                let rest = self.rest(&drops, &peer.places());
                Ok((self.read(&drops, &rest), seconds))
            }
        }
    }

    fn places(&mut self, way: Way, draw: u64, times: &[f64]) -> Result<Vec<Places>> {
        match way {
            Way::Preset(preset) => {
                let animation = self.scene(preset)?.animate(&self.draw(draw))?;
                // An animation's y points up.
                let turned = |p: DVec3| Some(DVec3::new(p.x, -p.z, p.y));
                let at =
                    |&time: &f64| animation.motion.tracks.iter().map(|track| turned(track.position(time))).collect();
                Ok(times.iter().map(at).collect())
            }
            Way::Peer(rate) => {
                let (mut peer, _) = self.peer(draw, rate)?;
                let at = |&time: &f64| {
                    peer.run_to(time);
                    peer.places()
                };
                Ok(times.iter().map(at).collect())
            }
        }
    }
}
