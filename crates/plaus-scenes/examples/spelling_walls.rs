//! Whether any ball ever leaves the box or passes through a partition or a floor. Every candidate that a chain
//! simulates is examined, piece by piece of every ball's path, at the exact times at which the ball is lowest, farthest
//! out, or over a partition.
//!
//!     cargo run --release -p plaus-scenes --example spelling_walls -- \
//!         scenarios/spelling-hi.toml 500000 [key=value ...]
//!
//! for 500,000 simulated candidates.
#![allow(clippy::print_stdout, reason = "a checking program: it prints")]

use plaus_dist::{LogDensity, LogPotential, Seed, Stream, math};
use plaus_mcmc::view::{View, lend};
use plaus_mcmc::{Chain, ModelError, Simulated, StateRefOf, Target};
use plaus_scenes::spelling::{Config, Drops, Rest, Spelling, Work};
use plaus_scenes::{Scenario, Scene, World};
use plaus_sim::motion::Parabola;
use std::sync::Mutex;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// A ball that is deeper than this share of its radius has passed through; lasting contact is solved to a fraction of
/// that.
const THROUGH: f64 = 0.02;

/// The faces of a box, in metres.
struct Faces {
    side: f64,
    /// Half the thickness of a partition.
    half: f64,
    height: f64,
    bowl: f64,
    radius: f64,
    extent: [f64; 2],
}

/// What was seen so far: how deep a ball was beyond a wall, in a floor, and in a partition over whose middle it passed,
/// at most.
#[derive(Default, Clone, Copy, Debug)]
struct Seen {
    simulated: u64,
    pieces: u64,
    over: u64,
    through: u64,
    deepest: [f64; 3],
}

impl Faces {
    fn new(config: &Config, scene: &Spelling) -> Self {
        let (size, mm) = (&config.dimensions, 1e-3);
        let side = size.bin_mm * mm;
        Self {
            side,
            half: 0.5 * size.partition_mm * mm,
            height: size.partition_height_mm * mm,
            bowl: size.floor_radius_mm * mm,
            radius: config.ball_radius_mm * mm,
            extent: [scene.word().columns() as f64 * side, scene.word().rows() as f64 * side],
        }
    }

    fn look(&self, path: &Parabola, until: f64, seen: &mut Seen) {
        seen.pieces += 1;
        let mut depths = [0.0_f64; 3];
        let bounds = path.bounds(0.0, until - path.t);
        for axis in 0..2 {
            let edge = self.half + self.radius;
            let out = (edge - bounds.min[axis]).max(bounds.max[axis] - (self.extent[axis] - edge));
            depths[0] = depths[0].max(out);
        }
        for time in [path.t, until] {
            depths[1] = depths[1].max(self.in_floor(path, time));
        }
        for axis in 0..2 {
            let first = (bounds.min[axis] / self.side).ceil().max(1.0) as u64;
            let last = (bounds.max[axis] / self.side).floor();
            for line in
                (first..).take_while(|&line| line as f64 <= last && (line as f64) * self.side < self.extent[axis])
            {
                for time in times_at(path, axis, line as f64 * self.side, until) {
                    seen.over += 1;
                    depths[2] = depths[2].max(self.top() - path.at(time).z);
                }
            }
        }
        seen.through += u64::from(depths.iter().any(|&depth| depth > THROUGH * self.radius));
        for (deepest, depth) in seen.deepest.iter_mut().zip(depths) {
            *deepest = deepest.max(depth);
        }
    }

    /// The lowest place of a centre over the middle of a partition: on both its upper edges. They do not move, whatever
    /// the ridge between them does.
    fn top(&self) -> f64 {
        self.height + (math::square(self.radius) - math::square(self.half)).sqrt()
    }

    /// How deep a ball is in its bin's bowl.
    fn in_floor(&self, path: &Parabola, time: f64) -> f64 {
        let at = path.at(time);
        let off = |x: f64| x - ((x / self.side).floor() + 0.5) * self.side;
        let (x, y, z) = (off(at.x), off(at.y), at.z - self.bowl);
        // Over the rims of the bowls, the partitions are in the way.
        let from_middle = (x * x + y * y + z * z).sqrt();
        if z < 0.0 { from_middle - (self.bowl - self.radius) } else { 0.0 }
    }
}

/// When a path has the coordinate `value` along `axis`.
fn times_at(path: &Parabola, axis: usize, value: f64, until: f64) -> Vec<f64> {
    let (a, b, c) = (0.5 * path.a[axis], path.v[axis], path.x[axis] - value);
    let roots = if a == 0.0 {
        vec![-c / b]
    } else {
        let q = -0.5 * (b + b.signum() * (b * b - 4.0 * a * c).sqrt());
        vec![q / a, c / q]
    };
    roots.into_iter().filter(|&t| t.is_finite() && t >= 0.0 && path.t + t <= until).map(|t| path.t + t).collect()
}

/// A word whose simulations are examined.
struct Watched {
    scene: Spelling,
    faces: Faces,
    seen: Mutex<Seen>,
}

impl Target for Watched {
    type Draw = Drops;
    type Outcome = Rest;
    type Scratch = Work;

    fn start(&self, stream: &mut Stream) -> Drops {
        self.scene.start(stream)
    }

    fn log_prior(&self, draw: &Drops) -> std::result::Result<LogDensity, ModelError> {
        self.scene.log_prior(draw)
    }

    fn simulate(
        &self,
        draw: &Drops,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        work: &mut Work,
    ) -> std::result::Result<Simulated<Rest>, ModelError> {
        let simulated = self.scene.simulate(draw, current, floor, work)?;
        if let (Simulated::Complete(_), Ok(mut seen)) = (&simulated, self.seen.lock()) {
            seen.simulated += 1;
            work.ways().for_each(|(_, path, until)| self.faces.look(path, until, &mut seen));
        }
        Ok(simulated)
    }

    fn log_constraint(&self, rest: &Rest) -> std::result::Result<LogPotential, ModelError> {
        self.scene.log_constraint(rest)
    }

    fn decided(&self, accepted: bool, work: &mut Work) {
        self.scene.decided(accepted, work);
    }
}

impl View for Watched {
    type Seen = Spelling;
    fn seen(&self) -> &Spelling {
        &self.scene
    }
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap_or_else(|| "scenarios/spelling-hi.toml".into());
    let wanted: u64 = args.next().map_or(Ok(500), |text| text.parse())?;
    let overrides: Vec<String> = args.collect();
    let scenario = Scenario::read(&path, &std::fs::read_to_string(&path)?, &overrides)?;
    let World::Spelling(config) = &scenario.world else { return Err("this checks words only".into()) };
    let scene = Spelling::new(config)?;
    let moves = lend::<Watched>(scene.moves(&scenario.sampler.rules)?)?;
    let watched = Watched { faces: Faces::new(config, &scene), scene, seen: Mutex::default() };
    let seen = || watched.seen.lock().map(|seen| *seen).unwrap_or_default();
    // Chains of 20,000 iterations, so that states on the way to a word are examined as well as words.
    for number in 0.. {
        let mut chain = Chain::start(&watched, &moves, Seed(scenario.sampler.seed).chain(number))?;
        while seen().simulated < wanted && chain.iteration() < 20_000 {
            chain.step()?;
        }
        if seen().simulated >= wanted {
            break;
        }
    }
    let Seen { simulated, pieces, over, through, deepest } = seen();
    let [wall, floor, partition] = deepest.map(|depth| 1e6 * depth);
    println!(
        "{path} {overrides:?}: {simulated} simulations, {pieces} pieces of motion, {over} passages over a partition"
    );
    println!(
        "deepest, in µm: beyond a wall {wall:.3}, in a floor {floor:.3}, in a partition passed over {partition:.3}"
    );
    println!("deeper than {THROUGH} radii: {through}");
    if through == 0 { Ok(()) } else { Err("a ball was where it cannot be".into()) }
}
