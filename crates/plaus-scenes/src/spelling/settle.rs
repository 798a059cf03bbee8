//! What becomes of a draw: every ball is simulated alone; those that would meet are simulated together, until no two
//! groups meet.
//!
//! Balls that never touch do not influence each other, so this is the simulation of all of them at once, up to
//! rounding; and by this procedure, which knows nothing of the chain, it is defined to the last bit. What a candidate
//! leaves as it is need not be simulated again: groups of the same balls with the same starts among the same vertices.

use super::Rest;
use super::arena::Arena;
use super::draw::Drops;
use super::fall::{Fall, Recorder};
use crate::way::merge;
use plaus_mcmc::ModelError;
use plaus_sim::Scratch;
use plaus_sim::marbles::{MarbleScratch, Marbles, Start};
use plaus_sim::mechanics::Impact;
use plaus_sim::motion::Parabola;
use std::sync::Arc;

/// What a simulation may save. None of it has any influence on a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Savings {
    /// Candidates with too few balls to be accepted are not simulated.
    pub bound: bool,
    /// Balls that a candidate leaves as they are, and that nothing else touches, are not simulated again.
    pub reuse: bool,
}

impl Savings {
    /// All of it.
    pub const ALL: Self = Self { bound: true, reuse: true };
    /// Nothing: every simulation is made from scratch.
    pub const NONE: Self = Self { bound: false, reuse: false };
}

/// Centres nearer than this many radii are simulated together: 2, and a little for rounding.
const NEAR: f64 = 2.0 * (1.0 + 1e-6);

/// Working memory of a chain: simulations of its current state, and room to simulate.
#[derive(Default)]
pub struct Work {
    /// Worlds by their number of balls.
    rooms: Vec<Option<Room>>,
    scratch: Scratch<MarbleScratch>,
    recorder: Recorder,
    current: Falls,
    candidate: Falls,
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

/// The simulations of one draw.
#[derive(Default)]
struct Falls {
    draw: Option<Drops>,
    /// Each ball alone.
    alone: Vec<Option<Arc<Fall>>>,
    /// Groups that were simulated together, on the way to the final ones.
    together: Vec<Arc<Fall>>,
    /// The final groups.
    groups: Vec<Arc<Fall>>,
}

impl Work {
    /// How much was simulated so far.
    #[must_use]
    pub fn counts(&self) -> WorkCounts {
        self.counts
    }

    /// The ways of the balls of the draw that was simulated last, until it is settled: each piece with its ball and the
    /// time at which it ends, in m and s.
    pub fn ways(&self) -> impl Iterator<Item = (usize, &Parabola, f64)> {
        let groups = self.candidate.groups.iter();
        let balls = groups.flat_map(|group| group.members.iter().zip(&group.ways));
        balls.flat_map(|(&ball, way)| way.pieces.iter().map(move |piece| (ball, &piece.path, piece.until)))
    }

    /// A candidate that needs no simulation.
    pub(super) fn skip(&mut self) {
        self.counts.skipped += 1;
    }

    /// Keeps what is known about the candidate that was simulated last, if it became the current state.
    pub(super) fn settle(&mut self, accepted: bool) {
        if accepted {
            std::mem::swap(&mut self.current, &mut self.candidate);
        }
    }

    /// Where the balls of `draw` come to rest. `known`: a draw from whose simulation, made now unless it is remembered,
    /// parts may be taken.
    pub(super) fn simulate(&mut self, arena: &Arena, draw: &Drops, known: Option<&Drops>) -> Result<Rest, ModelError> {
        let Some(known) = known else {
            let nothing = Falls::default();
            return self.simulate_after(arena, draw, &nothing);
        };
        if self.current.draw.as_ref() != Some(known) {
            self.simulate_after(arena, known, &Falls::default())?;
            std::mem::swap(&mut self.current, &mut self.candidate);
        }
        let current = std::mem::take(&mut self.current);
        let rest = self.simulate_after(arena, draw, &current);
        self.current = current;
        rest
    }

    /// The final groups of a draw, each with its impacts.
    pub(super) fn record(&mut self, arena: &Arena, draw: &Drops) -> Result<Vec<(Fall, Vec<Impact>)>, ModelError> {
        self.simulate(arena, draw, None)?;
        let starts: Vec<Option<Start>> = arena.starts(draw).collect();
        let groups = self.candidate.groups.clone();
        let record = |group: Arc<Fall>| {
            self.recorder.impacts = Some(Vec::new());
            let fall = self.fall(arena, draw, group.members.clone(), &starts)?;
            Ok((fall, self.recorder.impacts.take().unwrap_or_default()))
        };
        groups.into_iter().map(record).collect()
    }

    /// Simulates `draw` into `self.candidate`, taking from `known` what stays as it is.
    fn simulate_after(&mut self, arena: &Arena, draw: &Drops, known: &Falls) -> Result<Rest, ModelError> {
        self.counts.draws += 1;
        let moved = known.moved(draw);
        let starts: Vec<Option<Start>> = arena.starts(draw).collect();
        let mut next = std::mem::take(&mut self.candidate);
        next.alone.clear();
        next.together.clear();
        next.groups.clear();
        for (ball, start) in starts.iter().enumerate() {
            let Some(start) = *start else {
                next.alone.push(None);
                continue;
            };
            self.counts.balls += 1;
            let same = |fall: &&Arc<Fall>| fall.starts == [start] && !fall.depends_on(&moved);
            let fall = match known.alone.get(ball).and_then(Option::as_ref).filter(same) {
                Some(fall) => Arc::clone(fall),
                None => {
                    self.counts.alone += 1;
                    Arc::new(self.fall(arena, draw, vec![ball], &starts)?)
                }
            };
            next.groups.push(Arc::clone(&fall));
            next.alone.push(Some(fall));
        }
        if arena.touch() {
            self.join(arena, draw, &starts, known, (&moved, &mut next))?;
        }
        let mut rest = Rest { bins: vec![None; starts.len()], complete: true };
        for group in &next.groups {
            rest.complete &= group.complete;
            for (&ball, &bin) in group.members.iter().zip(&group.bins) {
                rest.bins[ball] = bin;
            }
        }
        match &mut next.draw {
            Some(old) => old.clone_from(draw),
            none => *none = Some(draw.clone()),
        }
        self.candidate = next;
        Ok(rest)
    }

    /// Simulates groups that meet together, until none do.
    fn join(
        &mut self,
        arena: &Arena,
        draw: &Drops,
        starts: &[Option<Start>],
        known: &Falls,
        (moved, next): (&[usize], &mut Falls),
    ) -> Result<(), ModelError> {
        let reach = NEAR * arena.bins().marble;
        loop {
            let merged = merge(next.groups.len(), |a, b| next.groups[a].meets(&next.groups[b], reach));
            if merged.len() == next.groups.len() {
                return Ok(());
            }
            let mut groups = Vec::with_capacity(merged.len());
            for union in merged {
                if let [only] = *union {
                    groups.push(Arc::clone(&next.groups[only]));
                    continue;
                }
                let mut members: Vec<usize> =
                    union.iter().flat_map(|&k| next.groups[k].members.iter().copied()).collect();
                members.sort_unstable();
                let is_same = |fall: &&Arc<Fall>| {
                    fall.members == members
                        && members.iter().zip(&fall.starts).all(|(&ball, start)| starts[ball] == Some(*start))
                };
                let fall = match known.together.iter().find(|fall| is_same(fall) && !fall.depends_on(moved)) {
                    Some(fall) => Arc::clone(fall),
                    None => {
                        self.counts.together += members.len() as u64;
                        Arc::new(self.fall(arena, draw, members, starts)?)
                    }
                };
                next.together.push(Arc::clone(&fall));
                groups.push(fall);
            }
            next.groups = groups;
        }
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

    /// Moves the vertices to where the draw has them.
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

impl Falls {
    /// Random vertices that are elsewhere in `draw`.
    fn moved(&self, draw: &Drops) -> Vec<usize> {
        let Some(old) = &self.draw else { return Vec::new() };
        (0..draw.offsets.len()).filter(|&k| old.offsets[k] != draw.offsets[k]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spelling::{Config, Letters, Spelling};
    use plaus_dist::{Purpose, Seed};
    use plaus_mcmc::Target;

    /// Group by group, balls end where they do when all are simulated at once. Both round differently, and balls that
    /// hit several others amplify that without bound: one draw in a hundred may differ, and hardly any does.
    #[test]
    fn groups_end_as_all_at_once() {
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
