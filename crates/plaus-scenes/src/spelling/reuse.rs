//! The outcome of a draw: the balls are simulated group by group, see [`crate::model::groups`]. A group need not be
//! simulated again if its balls are the same, with the same starts, among the same vertices.

use super::animate::film;
use super::arena::Arena;
use super::draw::Drops;
use super::fall::{Fall, Recorder};
use super::{Rest, Spelling};
use crate::model::groups::{Groups, Memory, Runner};
use crate::require::{Kept, Stop};
use plaus_mcmc::ModelError;
use plaus_sim::Scratch;
use plaus_sim::marbles::{MarbleScratch, Marbles, Start};
use plaus_sim::motion::Parabola;
use std::sync::Arc;

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
    pub(super) kept: Kept,
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
        let groups = self.memory.candidate.last.iter();
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

    /// Where the balls of `draw` come to rest; `None` if the draw can no longer be accepted. `known` is a draw whose
    /// simulation can be reused in part; it is simulated now unless it is remembered.
    pub(super) fn simulate(
        &mut self,
        scene: &Spelling,
        draw: &Drops,
        known: Option<&Drops>,
        stop: Option<Stop>,
    ) -> Result<Option<Rest>, ModelError> {
        let mut memory = std::mem::take(&mut self.memory);
        let made = memory.simulate((draw, stop), known, |draw, known, next, stop| {
            self.simulate_after((scene, draw), known, next, stop)
        });
        let of_balls = |groups: &Groups<Drops, Fall>| {
            let mut rest = Rest { bins: vec![None; draw.balls.len()], complete: true, failed: None };
            for group in &groups.last {
                rest.complete &= group.failed.is_none();
                rest.failed = rest.failed.or_else(|| group.failed.clone());
                for (&ball, &bin) in group.members.iter().zip(&group.bins) {
                    rest.bins[ball] = bin;
                }
            }
            rest
        };
        let rest = made.map(|groups| groups.map(of_balls));
        self.memory = memory;
        rest
    }

    /// The motions of a draw, if it was simulated last and they were kept.
    pub(super) fn recorded(&self, draw: &Drops) -> Option<&[Arc<Fall>]> {
        let candidate = &self.memory.candidate;
        let kept = candidate.draw.as_ref() == Some(draw) && candidate.last.iter().all(|fall| fall.impacts.is_some());
        kept.then_some(candidate.last.as_slice())
    }

    /// Simulates `draw` into `next`, reusing parts of `known` that do not change; returns whether it came to the end.
    fn simulate_after(
        &mut self,
        (scene, draw): (&Spelling, &Drops),
        known: &Groups<Drops, Fall>,
        next: &mut Groups<Drops, Fall>,
        stop: Option<Stop>,
    ) -> Result<bool, ModelError> {
        let arena = &scene.arena;
        self.counts.draws += 1;
        self.counts.balls += draw.active() as u64;
        let moved = known.draw.as_ref().map_or_else(Vec::new, |old| moved(old, draw));
        let starts: Vec<Option<Start>> = arena.starts(draw).collect();
        let records = self.kept.motions;
        let same = |fall: &Fall| {
            let mut own = fall.members.iter().zip(&fall.starts);
            let same = own.all(|(&ball, start)| starts[ball] == Some(*start)) && !fall.depends_on(&moved);
            same && (fall.impacts.is_some() || !records)
        };
        let reach = arena.touch.then_some(NEAR * arena.bins.marble);
        let mut dropping = Dropping { work: self, scene, draw, starts: &starts, stop };
        next.simulate(draw, starts.iter().map(Option::is_some), reach, (known, same), &mut dropping)
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
        self.recorder.impacts = self.kept.motions.then(Vec::new);
        Fall::simulate(arena, &room.world, (members, starts), &mut self.scratch, &mut self.recorder)
    }
}

/// Balls of a draw that are simulated.
struct Dropping<'a> {
    work: &'a mut Work,
    scene: &'a Spelling,
    draw: &'a Drops,
    starts: &'a [Option<Start>],
    stop: Option<Stop>,
}

impl Runner<Fall> for Dropping<'_> {
    fn run(&mut self, members: Vec<usize>) -> Result<Option<Fall>, ModelError> {
        let counts = &mut self.work.counts;
        match members.len() {
            1 => counts.alone += 1,
            several => counts.together += several as u64,
        }
        self.work.fall(&self.scene.arena, self.draw, members, self.starts).map(Some)
    }

    fn is_hopeless(&self, groups: &[Arc<Fall>], known: impl FnOnce() -> f64) -> bool {
        let Some(stop) = &self.stop else { return false };
        stop.is_hopeless(self.scene.most_of(self.draw.active()), &film(&self.scene.arena, groups, known()))
    }
}

impl Room {
    fn new(arena: &Arena, count: usize) -> Result<Self, ModelError> {
        let world = arena.world(count).map_err(ModelError::new)?;
        Ok(Self { world, offsets: vec![[0.0; 3]; arena.vertices.len()] })
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
                let by_groups = work.simulate(&scene, &draw, None, None).unwrap().unwrap();
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
