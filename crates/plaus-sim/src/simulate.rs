//! The loop: take the earliest event, bring the bodies concerned to its time, resolve it (`simulate/instant.rs`), let
//! their groups settle, and look ahead again.
//!
//! Nothing else moves. A body far from others is touched only at its own events.

mod instant;

use crate::broad::BoxTree;
use crate::groups::{Marks, Neighbours, add_group};
use crate::interrupt;
use crate::links::Link;
use crate::mechanics::{Impact, Island, Mechanics, Meeting, Other, TimeSteppedIsland};
use crate::outcome::Outcome;
use crate::queue::{Event, Happening, Tournament};
use crate::state::{Counts, State};
use crate::trace::Observer;
use crate::work;

/// Reusable work space. Make one per thread and keep it.
#[derive(Debug, Default)]
pub struct Scratch<S> {
    queue: Tournament,
    concerned: Vec<u32>,
    group: Vec<u32>,
    /// Bodies that are concerned.
    marks: Marks,
    /// Bodies that have been seen while groups settle.
    seen: Marks,
    /// Bodies that have settled as part of a time-stepped island.
    stepped: Marks,
    /// Pairs of a time-stepped island that may touch.
    pairs: Vec<Link>,
    /// Impacts that may be due next.
    worklist: Vec<Meeting>,
    /// The last round of meetings of an event.
    met: Vec<Meeting>,
    /// Those examined now.
    round: Vec<Meeting>,
    /// Those of them that are due, with what else is struck at the same bodies.
    struck: Vec<Meeting>,
    tree: BoxTree,
    near: Vec<u32>,
    settle: S,
}

/// Runs until `until` (at most the world's duration) or until the run is over earlier, and says how it ended.
pub(crate) fn simulate<M: Mechanics>(
    mechanics: &M,
    state: &mut State<M::Body>,
    scratch: &mut Scratch<M::Scratch>,
    until: f64,
    observer: &mut dyn Observer<M>,
) -> Outcome {
    let before = state.counts.events;
    let outcome = go(mechanics, state, scratch, until, observer);
    work::add(state.counts.events - before);
    outcome
}

fn go<M: Mechanics>(
    mechanics: &M,
    state: &mut State<M::Body>,
    scratch: &mut Scratch<M::Scratch>,
    until: f64,
    observer: &mut dyn Observer<M>,
) -> Outcome {
    let mut run = Run { mechanics, state, scratch, observer };
    let until = until.min(mechanics.duration());
    if let Some(outcome) = run.start() {
        return outcome;
    }
    while let Some(body) = run.scratch.queue.first() {
        let event = run.state.events[body];
        if event.time > until || event.happening == Happening::End {
            break;
        }
        run.state.time = event.time;
        run.take(body, event);
        if let Some(outcome) = run.settle().or_else(|| run.look_ahead()).or_else(|| run.is_over()) {
            return outcome;
        }
    }
    run.state.time = until.max(run.state.time);
    if run.state.all_resting(mechanics) { Outcome::AllAtRest } else { Outcome::TimeReached }
}

struct Run<'r, M: Mechanics> {
    mechanics: &'r M,
    state: &'r mut State<M::Body>,
    scratch: &'r mut Scratch<M::Scratch>,
    observer: &'r mut dyn Observer<M>,
}

/// Motions over events that a run may have in all: an event of a large island gives a new motion to each of its bodies.
/// 64.
const MOTIONS: u64 = 64;

impl<M: Mechanics> Run<'_, M> {
    /// Examines every body for the first time, or restores the queue of a state that was paused.
    fn start(&mut self) -> Option<Outcome> {
        self.scratch.tree.reset();
        if self.state.started {
            self.scratch.queue.rebuild(&self.state.events, &self.state.places);
            return self.state.all_resting(self.mechanics).then_some(Outcome::AllAtRest);
        }
        self.state.started = true;
        let n = self.state.bodies.len() as u32;
        self.scratch.concerned.clear();
        self.scratch.concerned.extend(0..n);
        for k in 0..n as usize {
            self.observer.motion(k, &self.state.bodies[k]);
        }
        self.scratch.queue.rebuild(&self.state.events, &self.state.places);
        self.look_ahead()
    }

    /// Resolves an event; an impact together with all others that are due at the same time. If it concerns a large
    /// island, also resolves the other events at that time, so that the large island settles only once.
    fn take(&mut self, mut body: usize, mut event: Event) {
        self.scratch.concerned.clear();
        self.scratch.marks.wipe(self.state.bodies.len());
        loop {
            // The end of a step is a single event for all bodies of its group.
            if event.happening != Happening::Expiry || !self.scratch.marks.has(body as u32) {
                self.state.counts.events += 1;
                self.bring_to(body as u32, &event);
                self.impacts(body, &event);
            }
            let is_time_stepped = self.mechanics.is_time_stepped(&self.state.bodies[body]);
            if self.scratch.concerned.len() < M::LARGE_ISLAND && !is_time_stepped {
                return;
            }
            self.put_off(body, &event);
            let Some(next) = self.scratch.queue.first() else { return };
            let due = self.state.events[next];
            if due.time > event.time || due.happening == Happening::End || self.is_stale(&due) || self.is_spent() {
                return;
            }
            (body, event) = (next, due);
        }
    }

    /// Takes an event out of the queue until its bodies are examined anew.
    fn put_off(&mut self, body: usize, event: &Event) {
        let never = Event { time: f64::INFINITY, happening: Happening::End };
        self.state.events[body] = never;
        self.scratch.queue.update(body, &self.state.events, &self.state.places);
        if let Happening::Body { other, .. } = event.happening
            && matches!(
                self.state.events[other as usize].happening,
                Happening::Body { other, .. } if other as usize == body
            )
        {
            self.state.events[other as usize] = never;
            self.scratch.queue.update(other as usize, &self.state.events, &self.state.places);
        }
    }

    fn is_stale(&self, event: &Event) -> bool {
        matches!(
            event.happening,
            Happening::Body { other, generation } if generation != self.state.generations[other as usize]
        )
    }

    /// Brings the bodies of an event, and all bodies in lasting contact with them, to its time.
    fn bring_to(&mut self, body: u32, event: &Event) {
        let mut other = None;
        if let Happening::Body { other: partner, generation } = event.happening {
            if generation != self.state.generations[partner as usize] {
                // Stale: its motion goes on unchanged, and the body is only examined anew.
                return;
            }
            other = Some(partner);
        }
        for seed in std::iter::once(body).chain(other) {
            self.bring(seed, event.time);
        }
    }

    /// Brings a body, and all bodies in lasting contact with it, to a time.
    fn bring(&mut self, seed: u32, time: f64) {
        let Scratch { concerned, marks, settle, .. } = &mut *self.scratch;
        let State { bodies, links, .. } = &mut *self.state;
        let first = concerned.len();
        add_group(links, seed, marks, concerned);
        self.mechanics.bring(&concerned[first..], bodies, links, settle, time);
    }

    /// Gives every concerned body its next closed form, group by group. A body whose form is not finite ends the run.
    fn settle(&mut self) -> Option<Outcome> {
        let n = self.state.bodies.len();
        self.scratch.stepped.wipe(n);
        if self.scratch.concerned.len() >= M::LEAST_TIME_STEPPED {
            self.settle_stepped();
        }
        let Self { mechanics, state, scratch, observer } = self;
        let Scratch { concerned, group, seen, stepped, settle, .. } = &mut **scratch;
        let State { bodies, links, .. } = &mut **state;
        seen.wipe(n);
        for &seed in concerned.iter().filter(|&&k| !stepped.has(k)) {
            group.clear();
            add_group(links, seed, seen, group);
            if !group.is_empty() {
                mechanics.settle(group, bodies, links, settle);
                observer.settled(mechanics, &Island { members: group, bodies, links, scratch: settle });
            }
        }
        for &k in &self.scratch.concerned {
            let body = &self.state.bodies[k as usize];
            if !self.mechanics.is_finite(body) {
                return Some(Outcome::NotFinite { body: k as usize, touched: self.touched(k) });
            }
            self.state.generations[k as usize] = self.state.generations[k as usize].wrapping_add(1);
            self.observer.motion(k as usize, body);
        }
        self.state.counts.motions += self.scratch.concerned.len() as u64;
        None
    }

    /// What a body met last in this event; if nothing, the first body or surface that it is in lasting contact with.
    fn touched(&self, k: u32) -> Option<Other> {
        let surface_of = |s| Other::Surface(self.mechanics.as_described(&self.state.bodies[k as usize], s));
        let met = |meeting: &Meeting| match *meeting {
            Meeting::Surface(i, surface) if i == k as usize => Some(surface_of(surface)),
            Meeting::Bodies(i, j) if i == k as usize || j == k as usize => Some(Other::Body(i + j - k as usize)),
            _ => None,
        };
        let linked = || self.state.links.of(k).next().map(|other| Other::Body(other as usize));
        let held = || self.mechanics.contacts(&self.state.bodies[k as usize]).first().map(|s| surface_of(*s));
        self.scratch.met.iter().rev().find_map(met).or_else(linked).or_else(held)
    }

    /// Gives large islands, with the bodies that they may touch, their next step.
    fn settle_stepped(&mut self) {
        self.scratch.seen.wipe(self.state.bodies.len());
        let mut next = 0;
        while let Some(&seed) = self.scratch.concerned.get(next) {
            next += 1;
            let Scratch { group, seen, stepped, .. } = &mut *self.scratch;
            group.clear();
            if !stepped.has(seed) {
                add_group(&self.state.links, seed, seen, group);
            }
            if group.len() < M::LEAST_TIME_STEPPED {
                continue;
            }
            let Some(ahead) = self.mechanics.lookahead(group, &self.state.bodies) else { continue };
            group.iter().for_each(|&k| _ = stepped.mark(k));
            let Self { mechanics, state, scratch, observer } = self;
            let Scratch { concerned, group, marks, stepped, pairs, tree, near, .. } = &mut **scratch;
            Neighbours { concerned, group, marks, stepped, pairs, tree, near }.add(*mechanics, state, &ahead);
            let State { bodies, counts, links, .. } = &mut **state;
            let mut report = |impact: &Impact| {
                counts.impacts += 1;
                observer.impact(impact);
            };
            let island = TimeSteppedIsland { members: &scratch.group, near: &scratch.pairs, ahead };
            mechanics.settle_time_stepped(&island, bodies, links, &mut scratch.settle, &mut report);
            let (members, scratch) = (&scratch.group[..], &scratch.settle);
            observer.settled(mechanics, &Island { members, bodies, links, scratch });
        }
    }

    /// Finds the next event of each concerned body; if there is none, that of the body whose event was stale.
    fn look_ahead(&mut self) -> Option<Outcome> {
        if self.scratch.concerned.is_empty() {
            self.scratch.concerned.extend(self.scratch.queue.first().map(|k| k as u32));
        }
        for k in 0..self.scratch.concerned.len() {
            let body = self.scratch.concerned[k] as usize;
            if let Some(by) = self.mechanics.crushed_by(&self.state.bodies[body]) {
                return Some(Outcome::Crushed { body, by });
            }
            self.surfaces(body);
        }
        self.scratch.marks.wipe(self.state.bodies.len());
        for k in 0..self.scratch.concerned.len() {
            let body = self.scratch.concerned[k] as usize;
            self.meetings(body);
            self.scratch.marks.mark(body as u32);
            self.scratch.queue.update(body, &self.state.events, &self.state.places);
        }
        None
    }

    /// The first event of a body alone: the end of its closed form or a surface.
    fn surfaces(&mut self, k: usize) {
        let body = &self.state.bodies[k];
        let (expiry, end) = (self.mechanics.expiry(body), self.mechanics.duration());
        let mut event = if expiry <= end {
            Event { time: expiry, happening: Happening::Expiry }
        } else {
            Event { time: end, happening: Happening::End }
        };
        if self.mechanics.is_present(body)
            && let Some((time, surface)) = self.mechanics.first_surface(k, body, event.time)
        {
            event = Event { time, happening: Happening::Surface(surface) };
        }
        self.state.boxes[k] =
            self.mechanics.swept(k, body, self.mechanics.clock(body).max(self.state.time), event.time);
        self.scratch.tree.change(k, &self.state.boxes[k]);
        self.state.events[k] = event;
    }

    /// Whether another body comes first, of those not examined since the last event: if the event of one that was comes
    /// before its meeting with this one, it is then examined anew.
    fn meetings(&mut self, k: usize) {
        let body = &self.state.bodies[k];
        if !self.mechanics.is_present(body) {
            return;
        }
        let mut event = self.state.events[k];
        let around = self.state.boxes[k];
        self.scratch.tree.meeting(&self.state.boxes, &around, &mut self.scratch.near);
        for j in self.scratch.near.iter().map(|&j| j as usize) {
            if j == k || self.scratch.marks.has(j as u32) {
                continue;
            }
            let (other, linked) = (&self.state.bodies[j], self.state.links.contains(j as u32, k as u32));
            if !self.mechanics.is_present(other) || linked && !M::WATCHES_LINKED {
                continue;
            }
            let from = self.state.time.max(self.mechanics.clock(other)).max(self.mechanics.clock(body));
            let until = event.time.min(self.state.events[j].time);
            let (pair, both) = if k < j { ([k, j], [body, other]) } else { ([j, k], [other, body]) };
            let met = if linked {
                self.mechanics.first_new_meeting(pair, both, from, until)
            } else {
                self.mechanics.first_meeting(pair, both, from, until)
            };
            if let Some(time) = met {
                let found = Event {
                    time,
                    happening: Happening::Body { other: j as u32, generation: self.state.generations[j] },
                };
                if found.precedes(k as u32, &event, k as u32, &self.state.places) {
                    event = found;
                }
            }
        }
        self.state.events[k] = event;
        if let Happening::Body { other, .. } = event.happening {
            let back = Event {
                time: event.time,
                happening: Happening::Body { other: k as u32, generation: self.state.generations[k] },
            };
            if back.precedes(other, &self.state.events[other as usize], other, &self.state.places) {
                self.state.events[other as usize] = back;
                self.scratch.queue.update(other as usize, &self.state.events, &self.state.places);
            }
        }
    }

    /// Whether the run has had as many events as it may, or as many motions. What is still due at that time then stays
    /// unresolved.
    fn is_spent(&self) -> bool {
        let Counts { events, motions, .. } = self.state.counts;
        let budget = self.mechanics.event_budget();
        events >= budget || motions >= MOTIONS.saturating_mul(budget)
    }

    fn is_over(&mut self) -> Option<Outcome> {
        if !self.observer.proceed(self.state) || interrupt::is_interrupted() {
            return Some(Outcome::Stopped);
        }
        if self.is_spent() {
            return Some(Outcome::OutOfEvents);
        }
        let all = self.scratch.concerned.iter().all(|&k| self.mechanics.is_resting(&self.state.bodies[k as usize]))
            && self.state.all_resting(self.mechanics);
        all.then_some(Outcome::AllAtRest)
    }
}
