//! Many runs of one world; each thread has a copy of it.

use super::engine::{Engine, Pose, Start};
use crate::errors::{WorldError, room, volume};
use glam::{DQuat, DVec3};
use plaus_scenes::Physical;
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::trace::Trace;
use plaus_sim::{Outcome, Scratch};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Acquire, Ordering::Relaxed, Ordering::Release};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Number of starts that a thread takes at a time.
const AT_ONCE: usize = 8;
/// Time between two checks whether Python wants to stop.
const TICK: Duration = Duration::from_millis(20);

/// Arrays (start, body, …), each row by row.
pub(super) struct Starts {
    pub(super) count: usize,
    pub(super) bodies: usize,
    pub(super) position: Vec<f64>,
    pub(super) velocity: Option<Vec<f64>>,
    pub(super) spin: Option<Vec<f64>>,
    pub(super) orientation: Option<Vec<f64>>,
    pub(super) release: Option<Vec<f64>>,
}

impl Starts {
    fn of(&self, index: usize) -> impl Iterator<Item = Start> {
        let first = index * self.bodies;
        let vector = |from: &[f64], k: usize| DVec3::from_slice(&from[3 * k..]);
        let maybe = move |from: &Option<Vec<f64>>, k| from.as_ref().map_or(DVec3::ZERO, |from| vector(from, k));
        (first..first + self.bodies).map(move |k| Start {
            position: vector(&self.position, k),
            velocity: maybe(&self.velocity, k),
            spin: maybe(&self.spin, k),
            orientation: self.orientation.as_ref().map_or(DQuat::IDENTITY, |from| DQuat::from_slice(&from[4 * k..])),
            release: self.release.as_ref().map_or(0.0, |from| from[k]),
        })
    }
}

/// What to run, and what to keep.
pub(super) struct Batch {
    pub(super) starts: Starts,
    pub(super) until: f64,
    /// Times at which poses are kept.
    pub(super) times: Vec<f64>,
    /// Whether impacts are kept.
    pub(super) events: bool,
}

/// Poses, row by row.
#[derive(Default)]
pub(super) struct Poses {
    pub(super) position: Vec<f64>,
    pub(super) velocity: Vec<f64>,
    pub(super) spin: Vec<f64>,
    pub(super) orientation: Vec<f64>,
}

/// Impacts as columns.
#[derive(Default)]
pub(super) struct Events {
    pub(super) start: Vec<i64>,
    pub(super) t: Vec<f64>,
    pub(super) body: Vec<i64>,
    /// −1 for the scenery.
    pub(super) other: Vec<i64>,
    pub(super) point: Vec<f64>,
    pub(super) normal: Vec<f64>,
    pub(super) speed: Vec<f64>,
    pub(super) impulse: Vec<f64>,
}

/// The results of a batch.
pub(super) struct Made {
    /// 0 at rest, 1 time over, 2 out of events, 3 not finite, 4 crushed.
    pub(super) ending: Vec<u8>,
    pub(super) time: Vec<f64>,
    pub(super) impacts: Vec<i64>,
    pub(super) rest: Poses,
    /// At the times asked for.
    pub(super) way: Poses,
    pub(super) events: Option<Events>,
}

/// The place for the results of one run of a batch.
struct Row<'a> {
    index: usize,
    ending: &'a mut u8,
    time: &'a mut f64,
    impacts: &'a mut i64,
    position: &'a mut [f64],
    velocity: &'a mut [f64],
    spin: &'a mut [f64],
    orientation: &'a mut [f64],
    positions: &'a mut [f64],
    orientations: &'a mut [f64],
    events: Vec<Impact>,
}

/// The first start that could not be simulated, and why.
type Failed = (usize, plaus_sim::WorldError);

impl Made {
    fn of(batch: &Batch) -> PyResult<Self> {
        let (count, bodies, times) = (batch.starts.count, batch.starts.bodies, batch.times.len());
        let (poses, ways) = (volume(&[count, bodies, 4])? / 4, volume(&[count, bodies, times, 4])? / 4);
        let rest = Poses {
            position: room(0.0, 3 * poses)?,
            velocity: room(0.0, 3 * poses)?,
            spin: room(0.0, 3 * poses)?,
            orientation: room(0.0, 4 * poses)?,
        };
        let way = Poses { position: room(0.0, 3 * ways)?, orientation: room(0.0, 4 * ways)?, ..Poses::default() };
        let (ending, time, impacts) = (room(0, count)?, room(0.0, count)?, room(0, count)?);
        Ok(Self { ending, time, impacts, rest, way, events: None })
    }

    fn rows(&mut self, bodies: usize, times: usize) -> Vec<Row<'_>> {
        let Self { ending, time, impacts, rest, way, .. } = self;
        fn parts(all: &mut [f64], size: usize) -> impl Iterator<Item = &mut [f64]> {
            // An empty array gives everyone an empty piece.
            all.chunks_mut(size.max(1)).map(Some).chain(std::iter::repeat_with(|| None)).map(Option::unwrap_or_default)
        }
        let mut position = parts(&mut rest.position, 3 * bodies);
        let mut velocity = parts(&mut rest.velocity, 3 * bodies);
        let mut spin = parts(&mut rest.spin, 3 * bodies);
        let mut orientation = parts(&mut rest.orientation, 4 * bodies);
        let mut positions = parts(&mut way.position, 3 * bodies * times);
        let mut orientations = parts(&mut way.orientation, 4 * bodies * times);
        let scalars = ending.iter_mut().zip(time).zip(impacts).enumerate();
        let row = |(index, ((ending, time), impacts))| Row {
            index,
            ending,
            time,
            impacts,
            position: position.next().unwrap_or_default(),
            velocity: velocity.next().unwrap_or_default(),
            spin: spin.next().unwrap_or_default(),
            orientation: orientation.next().unwrap_or_default(),
            positions: positions.next().unwrap_or_default(),
            orientations: orientations.next().unwrap_or_default(),
            events: Vec::new(),
        };
        scalars.map(row).collect()
    }
}

/// Reports that a worker is done, even if it panics, and wakes the waiting thread.
struct Over<'a>(&'a AtomicUsize, &'a thread::Thread);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Release);
        self.1.unpark();
    }
}

impl Batch {
    /// Runs everything without Python's lock, except for checks now and then whether Python wants to stop.
    pub(super) fn run(&self, py: Python<'_>, world: &Mutex<Physical>, threads: usize) -> PyResult<Made> {
        let world = world.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let mut made = Made::of(self)?;
        let ran = match world {
            Physical::Marbles(world) => py.detach(|| self.run_in(*world, &mut made, threads)),
            Physical::Rigid(world) => py.detach(|| self.run_in(*world, &mut made, threads)),
        };
        let (failed, events) = ran?;
        match failed {
            Some((index, error)) => Err(WorldError::new_err(format!("start {index}: {error}"))),
            None => Ok(Made { events: self.events.then_some(events), ..made }),
        }
    }

    fn run_in<E: Engine + Clone + Send>(
        &self,
        world: E,
        made: &mut Made,
        threads: usize,
    ) -> PyResult<(Option<Failed>, Events)> {
        let cores = || thread::available_parallelism().map_or(1, usize::from);
        let threads = if threads == 0 { cores() } else { threads }.min(self.starts.count.max(1));
        let rows = Mutex::new(made.rows(self.starts.bodies, self.times.len()).into_iter());
        let (stop, all) = (AtomicBool::new(false), Mutex::new((None::<Failed>, Vec::new())));
        let (left, waiting) = (AtomicUsize::new(threads), thread::current());
        let asked = thread::scope(|scope| {
            let worker = |world: E| {
                let (rows, stop, all, left, waiting) = (&rows, &stop, &all, &left, &waiting);
                move || {
                    let _over = Over(left, waiting);
                    let mut scratch = Scratch::default();
                    let take = || -> Vec<Row<'_>> {
                        let mut rows = rows.lock().unwrap_or_else(PoisonError::into_inner);
                        rows.by_ref().take(AT_ONCE).collect()
                    };
                    loop {
                        let taken = take();
                        if taken.is_empty() || stop.load(Relaxed) {
                            return;
                        }
                        for mut row in taken {
                            let ran = self.run_one(&world, &mut scratch, &mut row);
                            let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
                            match ran {
                                Ok(()) if row.events.is_empty() => {}
                                Ok(()) => all.1.push((row.index, row.events)),
                                Err(error) if all.0.as_ref().is_none_or(|(first, _)| row.index < *first) => {
                                    all.0 = Some((row.index, error));
                                }
                                Err(_) => {}
                            }
                        }
                    }
                }
            };
            (0..threads).for_each(|_| drop(scope.spawn(worker(world.clone()))));
            while left.load(Acquire) > 0 {
                thread::park_timeout(TICK);
                if left.load(Acquire) == 0 {
                    break;
                }
                let asked = Python::attach(|py| py.check_signals());
                if asked.is_err() {
                    stop.store(true, Relaxed);
                    return asked;
                }
            }
            Ok(())
        });
        asked?;
        let (failed, mut events) = all.into_inner().unwrap_or_else(PoisonError::into_inner);
        events.sort_unstable_by_key(|(index, _)| *index);
        Ok((failed, Events::of(&events)))
    }

    fn run_one<E: Engine>(
        &self,
        world: &E,
        scratch: &mut Scratch<E::Scratch>,
        row: &mut Row<'_>,
    ) -> Result<(), plaus_sim::WorldError> {
        let starts: Vec<Start> = self.starts.of(row.index).collect();
        let mut state = world.begin(&starts)?;
        let outcome = if self.times.is_empty() && !self.events {
            world.go(&mut state, scratch, self.until, &mut ())?
        } else {
            let mut trace = Trace::default();
            let outcome = world.go(&mut state, scratch, self.until, &mut trace)?;
            self.keep_way(world, &trace, &starts, row);
            row.events = if self.events { trace.impacts } else { Vec::new() };
            outcome
        };
        *row.ending = match outcome {
            Outcome::AllAtRest => 0,
            Outcome::TimeReached | Outcome::Stopped => 1,
            Outcome::OutOfEvents => 2,
            Outcome::NotFinite { .. } => 3,
            Outcome::Crushed { .. } => 4,
        };
        *row.time = state.time();
        *row.impacts = i64::try_from(state.counts().impacts).unwrap_or(i64::MAX);
        for (k, body) in state.bodies().iter().enumerate() {
            let Pose { position, velocity, spin, orientation } = world.pose_at(k, body, state.time());
            row.position[3 * k..3 * k + 3].copy_from_slice(&position.to_array());
            row.velocity[3 * k..3 * k + 3].copy_from_slice(&velocity.to_array());
            row.spin[3 * k..3 * k + 3].copy_from_slice(&spin.to_array());
            row.orientation[4 * k..4 * k + 4].copy_from_slice(&orientation.to_array());
        }
        Ok(())
    }

    /// Poses at the times asked for. Before its release, a body is at its start.
    fn keep_way<E: Engine>(&self, world: &E, trace: &Trace<E::Body>, starts: &[Start], row: &mut Row<'_>) {
        let places = self.times.iter().flat_map(|&time| (0..starts.len()).map(move |k| (time, k)));
        let rooms = row.positions.chunks_exact_mut(3).zip(row.orientations.chunks_exact_mut(4));
        for ((time, k), (position, orientation)) in places.zip(rooms) {
            let motion = trace.motion_at(k, time, |body| world.clock(body));
            let (x, turn) = match motion {
                Some(body) => {
                    let pose = world.pose_at(k, body, time);
                    (pose.position, pose.orientation)
                }
                None => (starts[k].position, starts[k].orientation),
            };
            position.copy_from_slice(&x.to_array());
            orientation.copy_from_slice(&turn.to_array());
        }
    }
}

impl Events {
    fn of(all: &[(usize, Vec<Impact>)]) -> Self {
        let mut events = Self::default();
        for (start, impact) in all.iter().flat_map(|(start, impacts)| impacts.iter().map(move |hit| (start, hit))) {
            events.start.push(*start as i64);
            events.t.push(impact.time);
            events.body.push(impact.body as i64);
            events.other.push(match impact.other {
                Other::Body(other) => other as i64,
                Other::Surface(_) => -1,
            });
            events.point.extend(impact.point.to_array());
            events.normal.extend(impact.normal.to_array());
            events.speed.push(impact.approach);
            events.impulse.push(impact.impulse.length());
        }
        events
    }
}
