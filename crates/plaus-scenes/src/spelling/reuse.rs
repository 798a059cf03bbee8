//! The outcome of a draw: the balls are simulated group by group, see [`crate::model::groups`]. A group need not be
//! simulated again if its balls are the same, with the same starts, among the same vertices.

use super::Rest;
use super::arena::Arena;
use super::draw::Drops;
use super::fall::{Fall, Recorder};
use crate::model::groups::{Groups, Memory};
use plaus_mcmc::ModelError;
use plaus_sim::Scratch;
use plaus_sim::marbles::{MarbleScratch, Marbles, Start};
use plaus_sim::mechanics::Impact;
use plaus_sim::motion::Parabola;

/// Optimisations of a simulation. They have no influence on a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Savings {
    /// Candidates with too few balls to be accepted are not simulated.
    pub bound: bool,
    /// Balls that a candidate does not change, and that nothing else touches, are not simulated again.
    pub reuse: bool,
}

impl Savings {
    /// All of it.
    pub const ALL: Self = Self { bound: true, reuse: true };
    /// None of it: every simulation is made from scratch.
    pub const NONE: Self = Self { bound: false, reuse: false };
}

/// Balls whose centres are nearer than this many radii are simulated together: 2, and slightly more for rounding.
const NEAR: f64 = 2.0 * (1.0 + 1e-6);

/// Working memory of a chain: simulations of its current state, and room to simulate.
#[derive(Default)]
pub struct Work {
    /// Worlds by their number of balls.
    rooms: Vec<Option<Room>>,
    scratch: Scratch<MarbleScratch>,
    recorder: Recorder,
    memory: Memory<Drops, Fall>,
    counts: WorkCounts,
}

/// How much was simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WorkCounts {
    /// Draws evaluated.
    pub draws: u64,
    /// Candidates that were not simulated at all.
    pub skipped: u64,
    /// Balls simulated alone.
    pub alone: u64,
    /// Balls simulated together with others.
    pub together: u64,
    /// Balls of evaluated draws.
    pub balls: u64,
}

/// A world, and where its vertices are.
struct Room {
    world: Marbles,
    offsets: Vec<[f64; 3]>,
}

impl Work {
    /// How much was simulated so far.
    #[must_use]
    pub fn counts(&self) -> WorkCounts {
        self.counts
    }

    /// The paths of the balls of the draw simulated last, until that is accepted or rejected: each piece with its ball
    /// and the time at which it ends, in m and s.
    pub fn ways(&self) -> impl Iterator<Item = (usize, &Parabola, f64)> {
        let groups = self.memory.candidate().last().iter();
        let balls = groups.flat_map(|group| group.members.iter().zip(&group.ways));
        balls.flat_map(|(&ball, way)| way.pieces.iter().map(move |piece| (ball, &piece.path, piece.until)))
    }

    /// A candidate that needs no simulation.
    pub(super) fn skip(&mut self) {
        self.counts.skipped += 1;
    }

    /// Keeps what is known about the candidate simulated last if it became the current state.
    pub(super) fn decided(&mut self, accepted: bool) {
        self.memory.decided(accepted);
    }

    /// Where the balls of `draw` come to rest. `known` is a draw whose simulation can be reused in part; it is
    /// simulated now unless it is remembered.
    pub(super) fn simulate(&mut self, arena: &Arena, draw: &Drops, known: Option<&Drops>) -> Result<Rest, ModelError> {
        let mut memory = std::mem::take(&mut self.memory);
        let made = memory.simulate(draw, known, |draw, known, next| self.simulate_after(arena, draw, known, next));
        let rest = made.map(|groups| {
            let mut rest = Rest { bins: vec![None; draw.balls.len()], complete: true };
            for group in groups.last() {
                rest.complete &= group.complete;
                for (&ball, &bin) in group.members.iter().zip(&group.bins) {
                    rest.bins[ball] = bin;
                }
            }
            rest
        });
        self.memory = memory;
        rest
    }

    /// The final groups of a draw, each with its impacts.
    pub(super) fn record(&mut self, arena: &Arena, draw: &Drops) -> Result<Vec<(Fall, Vec<Impact>)>, ModelError> {
        self.simulate(arena, draw, None)?;
        let starts: Vec<Option<Start>> = arena.starts(draw).collect();
        let groups = self.memory.candidate().last().to_vec();
        let record = |group: std::sync::Arc<Fall>| {
            self.recorder.impacts = Some(Vec::new());
            let fall = self.fall(arena, draw, group.members.clone(), &starts)?;
            Ok((fall, self.recorder.impacts.take().unwrap_or_default()))
        };
        groups.into_iter().map(record).collect()
    }

    /// Simulates `draw` into `next`, reusing parts of `known` that do not change.
    fn simulate_after(
        &mut self,
        arena: &Arena,
        draw: &Drops,
        known: &Groups<Drops, Fall>,
        next: &mut Groups<Drops, Fall>,
    ) -> Result<(), ModelError> {
        self.counts.draws += 1;
        self.counts.balls += draw.active() as u64;
        let moved = known.draw().map_or_else(Vec::new, |old| moved(old, draw));
        let starts: Vec<Option<Start>> = arena.starts(draw).collect();
        let same = |fall: &Fall| {
            let mut own = fall.members.iter().zip(&fall.starts);
            own.all(|(&ball, start)| starts[ball] == Some(*start)) && !fall.depends_on(&moved)
        };
        let reach = arena.touch().then_some(NEAR * arena.bins().marble);
        next.simulate(draw, starts.iter().map(Option::is_some), reach, (known, same), |members| {
            match members.len() {
                1 => self.counts.alone += 1,
                several => self.counts.together += several as u64,
            }
            self.fall(arena, draw, members, &starts)
        })
    }

    /// Simulates some balls by themselves.
    fn fall(
        &mut self,
        arena: &Arena,
        draw: &Drops,
        members: Vec<usize>,
        starts: &[Option<Start>],
    ) -> Result<Fall, ModelError> {
        let count = members.len();
        if self.rooms.len() <= count {
            self.rooms.resize_with(count + 1, || None);
        }
        let room = match &mut self.rooms[count] {
            Some(room) => room,
            none => none.insert(Room::new(arena, count)?),
        };
        room.place(arena, draw)?;
        let starts = members.iter().filter_map(|&ball| starts[ball]).collect();
        Fall::simulate(arena, &room.world, (members, starts), &mut self.scratch, &mut self.recorder)
    }
}

impl Room {
    fn new(arena: &Arena, count: usize) -> Result<Self, ModelError> {
        let world = arena.world(count).map_err(ModelError::new)?;
        Ok(Self { world, offsets: vec![[0.0; 3]; arena.vertices().len()] })
    }

    /// Moves the vertices to the draw's places.
    fn place(&mut self, arena: &Arena, draw: &Drops) -> Result<(), ModelError> {
        let differing = (0..draw.offsets.len()).filter(|&k| self.offsets[k] != draw.offsets[k]);
        let moved: Vec<_> = differing.map(|k| arena.moved(k, &draw.offsets[k])).collect();
        if !moved.is_empty() {
            self.world.move_vertices(&moved).map_err(ModelError::new)?;
            self.offsets.clone_from(&draw.offsets);
        }
        Ok(())
    }
}

/// Random vertices that have another place in `draw`.
fn moved(old: &Drops, draw: &Drops) -> Vec<usize> {
    (0..draw.offsets.len()).filter(|&k| old.offsets[k] != draw.offsets[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spelling::{Config, Letters, Spelling};
    use plaus_dist::{Purpose, Seed};
    use plaus_mcmc::Target;

    /// Simulated group by group, balls end where they do when all are simulated at once. The two round differently, and
    /// balls that hit several others amplify that without bound. So one draw in a hundred may differ, although hardly
    /// any does.
    #[test]
    fn simulating_by_groups_ends_like_simulating_all_at_once() {
        let acm = Config { text: Some("ACM".into()), letters: Letters::Tall, ..Config::default() };
        for (config, draws) in [(Config::default(), 300), (acm, 30)] {
            let scene = Spelling::new(&config).unwrap();
            let (mut work, mut together) = (Work::default(), Work::default());
            let mut stream = Seed(2).chain(0).at(0, Purpose::START);
            let mut differing = 0;
            for _ in 0..draws {
                let draw = scene.start(&mut stream);
                let by_groups = work.simulate(&scene.arena, &draw, None).unwrap();
                let starts: Vec<Option<Start>> = scene.arena.starts(&draw).collect();
                let members: Vec<usize> = (0..starts.len()).filter(|&ball| starts[ball].is_some()).collect();
                let all = together.fall(&scene.arena, &draw, members.clone(), &starts).unwrap();
                differing +=
                    usize::from(members.iter().zip(&all.bins).any(|(&ball, bin)| by_groups.bins[ball] != *bin));
            }
            assert!(100 * differing <= draws, "{differing} of {draws} draws differ");
            assert!(work.counts().together > 0, "no balls met");
        }
    }
}
