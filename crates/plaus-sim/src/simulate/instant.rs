//! The impacts of one instant.
//!
//! What is struck at one instant is resolved at once, so that neither the order in which bodies are listed nor rounding
//! decides: a mirror-symmetric world stays so. Impacts come in rounds. A round has all impacts that are due when it
//! begins; those that share a body belong together and are resolved at once ([`Mechanics::hit_at_once`]), others do not
//! touch each other's bodies. What these impacts drive together is the next round: so a row of touching balls passes an
//! impact on, ball by ball. Those that are resolved at once are first put into an order in which labels play no part
//! ([`Mechanics::order`]), so that not even rounding depends on how bodies are listed.
//!
//! At one instant are: events of the queue whose times differ by rounding ([`TIE`]), and whatever touches a struck body
//! at that time and approaches it ([`Mechanics::strikes`]): marbles to rounding, rigid bodies within the gap at which
//! the preset lets them touch. Bodies in lasting contact are struck within the same event, others by the queue, whose
//! next events are then due at the same time.

use super::Run;
use crate::mechanics::{Impact, Mechanics, Meeting, Other};
use crate::queue::{Event, Happening};
use crate::state::State;

/// Maximum number of impacts within one event; the rest is left to the queue. Default 80: ten at each of 8 contacts.
const MOST_AT_ONCE: usize = 80;

/// Difference of times, over the time since the start, that counts as none. Default 1e-12: some thousand rounding
/// errors. Larger values strike bodies that have not met yet.
const TIE: f64 = 1e-12;

impl<M: Mechanics> Run<'_, M> {
    /// Resolves an event's impact, if it is one, with all that are due at the same time, and those they cause through
    /// lasting contacts.
    pub(super) fn impacts(&mut self, body: usize, event: &Event) {
        self.scratch.worklist.clear();
        self.scratch.met.clear();
        self.note(body, event);
        if self.scratch.worklist.is_empty() {
            return;
        }
        self.add_ties(body, event);
        let (mut count, mut is_first) = (0, true);
        while !self.scratch.worklist.is_empty() && count < MOST_AT_ONCE {
            count += self.scratch.worklist.len();
            self.scratch.met.clone_from(&self.scratch.worklist);
            self.take_round(is_first, event.time);
            is_first = false;
        }
    }

    /// Notes what meets in an event, if its prediction is still valid, and counts it otherwise.
    fn note(&mut self, body: usize, event: &Event) {
        let meeting = match event.happening {
            Happening::Surface(surface) => Meeting::Surface(body, surface),
            Happening::Body { other, generation } if generation == self.state.generations[other as usize] => {
                let other = other as usize;
                Meeting::Bodies(body.min(other), body.max(other))
            }
            Happening::Body { .. } => return self.state.counts.stale += 1,
            Happening::Expiry | Happening::End => return self.state.counts.expiries += 1,
        };
        if !self.scratch.worklist.contains(&meeting) {
            self.scratch.worklist.push(meeting);
        }
    }

    /// Adds the impacts that the queue has at the time of this one.
    fn add_ties(&mut self, body: usize, event: &Event) {
        let time = event.time;
        let (mut body, mut event) = (body, *event);
        loop {
            self.put_off(body, &event);
            let Some(next) = self.scratch.queue.first() else { return };
            let due = self.state.events[next];
            let is_impact = matches!(due.happening, Happening::Surface(_) | Happening::Body { .. });
            if due.time - time > TIE * time || !is_impact || self.is_stale(&due) || self.is_spent() {
                return;
            }
            self.state.counts.events += 1;
            self.bring_to(next as u32, &Event { time, ..due });
            self.note(next, &due);
            (body, event) = (next, due);
        }
    }

    /// Resolves the impacts that are due among those of the work list, which then holds those they may cause.
    fn take_round(&mut self, is_first: bool, time: f64) {
        let mut round = std::mem::take(&mut self.scratch.round);
        let mut struck = std::mem::take(&mut self.scratch.struck);
        std::mem::swap(&mut round, &mut self.scratch.worklist);
        self.scratch.worklist.clear();
        struck.clear();
        if let (true, &[only]) = (is_first, &round[..]) {
            struck.push(only);
            self.add_struck(&mut struck, time);
            if struck.len() > 1 && !self.is_due(only, time) {
                struck.truncate(1);
            }
        } else {
            for &meeting in &round {
                if self.is_listed(&struck, meeting) {
                    continue;
                }
                if self.is_due(meeting, time) {
                    struck.push(meeting);
                } else if is_first {
                    self.collide(meeting);
                }
            }
            self.add_struck(&mut struck, time);
        }
        self.strike(&mut struck);
        (self.scratch.round, self.scratch.struck) = (round, struck);
    }

    /// Whether a meeting is part of these.
    fn is_listed(&self, struck: &[Meeting], meeting: Meeting) -> bool {
        struck.iter().any(|&other| match (other, meeting) {
            (Meeting::Surface(k, s), Meeting::Surface(m, t)) => k == m && (M::WHOLE || s == t),
            _ => other == meeting,
        })
    }

    /// Whether bodies at their clocks strike each other, or a surface.
    fn is_due(&mut self, meeting: Meeting, time: f64) -> bool {
        let Self { mechanics, state, .. } = self;
        let State { bodies, links, .. } = &mut **state;
        match meeting {
            Meeting::Surface(k, surface) => {
                let mut is_struck = false;
                mechanics.strikes_surfaces(k, &mut bodies[k], &mut |s| is_struck |= M::WHOLE || s == surface);
                is_struck
            }
            Meeting::Bodies(i, j) => {
                mechanics.strikes([i, j], [&bodies[i], &bodies[j]], links.contains(i as u32, j as u32), time)
            }
        }
    }

    /// Adds all that is struck at the bodies of these meetings, at the bodies that these are, and so on.
    fn add_struck(&mut self, struck: &mut Vec<Meeting>, time: f64) {
        let mut next = 0;
        while let Some(&meeting) = struck.get(next) {
            let earlier = next;
            next += 1;
            for k in meeting.bodies() {
                let is_new = |k: usize| !struck[..earlier].iter().any(|m| m.bodies().any(|other| other == k));
                if self.mechanics.gives(k) && is_new(k) {
                    self.add_struck_at(k, struck, time);
                    for other in self.mechanics.joined(k as u32, None, &self.state.bodies) {
                        self.add_struck_at(other as usize, struck, time);
                    }
                }
            }
        }
    }

    /// Adds all that is struck at one body, which is at its clock.
    fn add_struck_at(&mut self, k: usize, struck: &mut Vec<Meeting>, time: f64) {
        let mut found = |s| {
            let meeting = Meeting::Surface(k, s);
            let is_known = |m: &Meeting| *m == meeting || M::WHOLE && matches!(m, Meeting::Surface(j, _) if *j == k);
            if !struck.iter().any(is_known) {
                struck.push(meeting);
            }
        };
        self.mechanics.strikes_surfaces(k, &mut self.state.bodies[k], &mut found);
        let around = self.mechanics.swept(k, &self.state.bodies[k], time, time);
        let mut near = std::mem::take(&mut self.scratch.near);
        self.scratch.tree.meeting(&self.state.boxes, &around, &mut near);
        for &j in &near {
            let other = j as usize;
            let meeting = Meeting::Bodies(k.min(other), k.max(other));
            let is_candidate = other != k && self.mechanics.is_present(&self.state.bodies[other]);
            if is_candidate && !struck.contains(&meeting) && self.is_due(meeting, time) {
                self.bring(j, time);
                struck.push(meeting);
            }
        }
        self.scratch.near = near;
    }

    /// Resolves meetings that are due, those that share bodies at once.
    fn strike(&mut self, struck: &mut [Meeting]) {
        let mut first = 0;
        while first < struck.len() {
            let end = self.bring_together(struck, first);
            self.sort(&mut struck[first..end]);
            let together = &struck[first..end];
            if together.len() > 1 && self.hit_at_once(together) {
                together.iter().for_each(|&meeting| self.add_neighbours(meeting));
            } else {
                // One alone; or one after the other, where the impulses of all were not found.
                for &meeting in together {
                    if self.collide(meeting) {
                        self.add_neighbours(meeting);
                    }
                }
            }
            first = end;
        }
    }

    /// Collides all bodies of these meetings at once, if that can be done.
    fn hit_at_once(&mut self, meetings: &[Meeting]) -> bool {
        let Self { mechanics, state, observer, .. } = self;
        let State { bodies, counts, links, .. } = &mut **state;
        let mut report = |impact: &Impact| {
            counts.impacts += 1;
            observer.impact(impact);
        };
        mechanics.hit_at_once(meetings, bodies, links, &mut report)
    }

    /// Moves all meetings that share bodies with the first, directly or through others, behind it; returns their end.
    fn bring_together(&self, struck: &mut [Meeting], first: usize) -> usize {
        let (mut at, mut end) = (first, first + 1);
        while at < end && end < struck.len() {
            for k in struck[at].bodies().filter(|&k| self.mechanics.gives(k)) {
                let joined = self.mechanics.joined(k as u32, None, &self.state.bodies);
                let is_one = |m: usize| m == k || joined.contains(&(m as u32));
                let mut other = end;
                while other < struck.len() {
                    if struck[other].bodies().any(is_one) {
                        struck[end..=other].rotate_right(1);
                        end += 1;
                    }
                    other += 1;
                }
            }
            at += 1;
        }
        end
    }

    /// Puts meetings that are resolved together into an order in which labels of bodies play no part: sums are rounded
    /// differently in any other.
    fn sort(&self, meetings: &mut [Meeting]) {
        let Self { mechanics, state, .. } = self;
        let order = |i: usize, j: usize| mechanics.order([i as u32, j as u32], [&state.bodies[i], &state.bodies[j]]);
        let key = |meeting: Meeting| match meeting {
            Meeting::Surface(k, surface) => (k, k, Some(surface)),
            Meeting::Bodies(i, j) if order(i, j).is_le() => (i, j, None),
            Meeting::Bodies(i, j) => (j, i, None),
        };
        meetings.sort_unstable_by(|&p, &q| {
            let ((a, b, s), (c, d, t)) = (key(p), key(q));
            order(a, c).then_with(|| order(b, d)).then_with(|| s.cmp(&t))
        });
    }

    /// Collides two bodies, or one with a surface; returns whether there was an impact.
    fn collide(&mut self, meeting: Meeting) -> bool {
        let Self { mechanics, state, observer, .. } = self;
        let State { bodies, counts, links, .. } = &mut **state;
        let mut report = |impact: &Impact| {
            counts.impacts += 1;
            observer.impact(impact);
        };
        let (first, other, linked) = match meeting {
            Meeting::Surface(k, surface) => (k, Other::Surface(surface), false),
            Meeting::Bodies(i, j) => (i, Other::Body(j), links.contains(i as u32, j as u32)),
        };
        let joined = mechanics.hit_joined(first, other, linked, bodies, &mut report);
        let met = match meeting {
            _ if joined.is_some() => joined.flatten(),
            Meeting::Surface(k, surface) => {
                mechanics.hit_surface(k, &mut bodies[k], surface, &mut report).then_some(false)
            }
            Meeting::Bodies(i, j) => {
                let (low, high) = bodies.split_at_mut(j);
                mechanics.hit_body([i, j], [&mut low[i], &mut high[0]], linked, &mut report)
            }
        };
        if let (Meeting::Bodies(i, j), Some(true)) = (meeting, met) {
            links.insert(i as u32, j as u32);
        }
        met.is_some()
    }

    /// After an impact, the lasting contacts of the bodies involved may approach: they are next.
    fn add_neighbours(&mut self, meeting: Meeting) {
        let Self { mechanics, state, scratch, .. } = self;
        let mut ends = meeting.bodies();
        let (a, b) = (ends.next().unwrap_or(0), ends.next());
        let worklist = &mut scratch.worklist;
        let joined = mechanics.joined(a as u32, b.map(|k| k as u32), &state.bodies);
        for k in std::iter::once(a).chain(b).chain(joined.into_iter().map(|k| k as usize)) {
            let own = mechanics.contacts(&state.bodies[k]).iter().map(|&s| Meeting::Surface(k, s));
            worklist.extend(own.filter(|&m| m != meeting));
            let links = state.links.of(k as u32).map(|other| other as usize);
            worklist.extend(links.map(|other| Meeting::Bodies(k.min(other), k.max(other))).filter(|&m| m != meeting));
        }
    }
}
