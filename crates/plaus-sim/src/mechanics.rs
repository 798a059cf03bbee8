//! The interface between the event loop and the kinds of bodies: what a kind must say about its bodies.
//!
//! The loop is compiled once per kind, so a world of marbles holds no orientation, no shape and no code for rigid
//! bodies.

use crate::links::{Link, Links};
use crate::scenery::{Aabb, Surface};
use glam::DVec3;
use std::cmp::Ordering;

/// Gravity in the default worlds, in m/s².
pub(crate) const EARTH: DVec3 = DVec3::new(0.0, 0.0, -9.81);

/// What one impact did, for traces and observers.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Impact {
    /// When, in s.
    pub time: f64,
    /// The body that was hit; the lower index of two.
    pub body: usize,
    /// What it hit.
    pub other: Other,
    /// Where, in m.
    pub point: DVec3,
    /// Unit normal towards `body`.
    pub normal: DVec3,
    /// Impulse on `body` in N s.
    pub impulse: DVec3,
    /// Normal relative speed before, in m/s.
    pub approach: f64,
    /// Whether the contact lasts from here on.
    pub lasting: bool,
}

/// The partner of an impact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Other {
    /// Another body, by index.
    Body(usize),
    /// The scenery.
    Surface(Surface),
}

/// What a contact carries while nothing happens to the bodies that touch there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce {
    /// The body; the lower index of two.
    pub body: usize,
    /// What it touches.
    pub other: Other,
    /// Where, in m.
    pub point: DVec3,
    /// Unit normal towards `body`.
    pub normal: DVec3,
    /// Force on `body` in N: within a step the mean, at rest one of those that hold the bodies still. Where several
    /// do, because they are wedged or stand on more points than they need, which of them is left open.
    pub force: DVec3,
    /// How far apart the two are there, in m; negative where they overlap.
    pub gap: f64,
}

/// Bodies in lasting contact with each other that have just settled.
#[derive(Debug)]
pub struct Island<'i, M: Mechanics + ?Sized> {
    /// In ascending order.
    pub members: &'i [u32],
    /// All bodies of the world.
    pub bodies: &'i [M::Body],
    /// Which bodies are in lasting contact with each other.
    pub links: &'i Links,
    /// The work space in which the island has settled.
    pub scratch: &'i M::Scratch,
}

/// A body at a surface, or two bodies, the lower index first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meeting {
    /// A body at a surface.
    Surface(usize, Surface),
    /// Two bodies.
    Bodies(usize, usize),
}

impl Meeting {
    /// The body, or both.
    pub fn bodies(self) -> impl Iterator<Item = usize> {
        let (first, second) = match self {
            Self::Surface(k, _) => (k, None),
            Self::Bodies(i, j) => (i, Some(j)),
        };
        std::iter::once(first).chain(second)
    }
}

/// How far ahead a large island looks for what its bodies may touch.
#[derive(Debug, Clone, Copy)]
pub struct Lookahead {
    /// In s: its next step is no longer.
    pub span: f64,
    /// How much nearer bodies may come in that time than their present velocities say, in m.
    pub slack: f64,
    /// How far bodies fall in that time from rest, in m.
    pub fall: f64,
}

/// A large island with all bodies that it may touch within its next step, at one time.
#[derive(Debug)]
pub struct TimeSteppedIsland<'c> {
    /// In ascending order.
    pub members: &'c [u32],
    /// The pairs that may touch, in ascending order.
    pub near: &'c [Link],
    /// How far ahead it looks.
    pub ahead: Lookahead,
}

/// A kind of bodies and the scenery that they live in. Everything here is immutable; bodies are passed in.
pub trait Mechanics {
    /// The moving state of one body, with the closed form of its current motion.
    type Body: Clone + std::fmt::Debug;
    /// Work space for [`Mechanics::settle`], kept between calls.
    type Scratch: Default;

    /// Whether bodies in lasting contact with each other can meet at more points while it lasts.
    const WATCHES_LINKED: bool = false;

    /// From this many bodies on, an event's group counts as a large island: events at one time are all resolved before
    /// it settles.
    const LARGE_ISLAND: usize = usize::MAX;

    /// From this many bodies on, an event's group may be one that takes up meetings within its steps.
    const LEAST_TIME_STEPPED: usize = usize::MAX;

    /// Whether an impact of a body on a surface takes all surfaces that it strikes then, not only that one.
    const WHOLE: bool = false;

    /// How many bodies there are.
    fn len(&self) -> usize;
    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// When the world's runs end, in s.
    fn duration(&self) -> f64;
    /// Maximum number of events in a run, and of new motions that they give to bodies.
    fn event_budget(&self) -> u64;

    /// The body's own clock.
    fn clock(&self, body: &Self::Body) -> f64;
    /// Time at which the closed form ends by itself; `f64::MAX` where it does not.
    fn expiry(&self, body: &Self::Body) -> f64;
    /// Whether the body takes part: not before it is released.
    fn is_present(&self, body: &Self::Body) -> bool;
    /// Whether the body is at rest until something hits it.
    fn is_resting(&self, body: &Self::Body) -> bool;
    /// Whether all numbers are finite.
    fn is_finite(&self, body: &Self::Body) -> bool;
    /// The driven body that has left a body no way, if one has.
    #[inline]
    fn crushed_by(&self, _body: &Self::Body) -> Option<usize> {
        None
    }
    /// Which of two bodies, with these indices, comes first if an impact passes through both at once. By index, unless
    /// a kind of bodies has an order that does not depend on labels.
    fn order(&self, [i, j]: [u32; 2], _bodies: [&Self::Body; 2]) -> Ordering {
        i.cmp(&j)
    }
    /// Moves a body along its closed form to `time`, its new clock.
    fn advance(&self, index: usize, body: &mut Self::Body, time: f64);
    /// Moves a group of bodies in lasting contact with each other to `time`.
    #[inline]
    fn bring(
        &self,
        members: &[u32],
        bodies: &mut [Self::Body],
        _links: &mut Links,
        _scratch: &mut Self::Scratch,
        time: f64,
    ) {
        for &k in members {
            self.advance(k as usize, &mut bodies[k as usize], time);
        }
    }

    /// A box around the body from `from` to `until`.
    fn swept(&self, index: usize, body: &Self::Body, from: f64, until: f64) -> Aabb;
    /// First surface touched while approaching, not after `until`.
    fn first_surface(&self, index: usize, body: &Self::Body, until: f64) -> Option<(f64, Surface)>;
    /// First time in `[from, until]` at which two bodies touch while approaching.
    fn first_meeting(&self, pair: [usize; 2], bodies: [&Self::Body; 2], from: f64, until: f64) -> Option<f64>;

    /// Whether two bodies, within their present motions, touch and approach each other at `time` so that an impact is
    /// due; an approach within rounding is none. `linked` says whether they are in lasting contact.
    fn strikes(&self, pair: [usize; 2], bodies: [&Self::Body; 2], linked: bool, time: f64) -> bool;

    /// Calls `add` for the surfaces that a body strikes at its clock in the same way; if the kind is
    /// [`WHOLE`](Self::WHOLE), only for the first.
    fn strikes_surfaces(&self, index: usize, body: &mut Self::Body, add: &mut dyn FnMut(Surface));

    /// Whether a body moves when it is struck, and so connects what strikes it.
    #[inline]
    fn gives(&self, _index: usize) -> bool {
        true
    }

    /// The same for two bodies in lasting contact, at points that are not part of it.
    fn first_new_meeting(&self, _pair: [usize; 2], _bodies: [&Self::Body; 2], _from: f64, _until: f64) -> Option<f64> {
        None
    }

    /// Collides a body with a surface, both at the body's clock; records the contact if it lasts. Reports the impacts,
    /// one for each point that is struck; returns whether there were any.
    fn hit_surface(
        &self,
        index: usize,
        body: &mut Self::Body,
        surface: Surface,
        report: &mut dyn FnMut(&Impact),
    ) -> bool;
    /// Collides two bodies in the same way. If they did collide, returns whether they should be linked. `linked` says
    /// whether they already are.
    fn hit_body(
        &self,
        pair: [usize; 2],
        bodies: [&mut Self::Body; 2],
        linked: bool,
        report: &mut dyn FnMut(&Impact),
    ) -> Option<bool>;
    /// Collides a body with something, together with all that joints hold to either; `None` if there are no joints.
    /// Otherwise it returns what [`hit_body`](Self::hit_body) does.
    #[inline]
    fn hit_joined(
        &self,
        _index: usize,
        _other: Other,
        _linked: bool,
        _bodies: &mut [Self::Body],
        _report: &mut dyn FnMut(&Impact),
    ) -> Option<Option<bool>> {
        None
    }
    /// Collides bodies that are struck by each other and by surfaces at one instant, all at once. Links those whose
    /// contact lasts. Returns false, with nothing changed, if it cannot be done.
    fn hit_at_once(
        &self,
        meetings: &[Meeting],
        bodies: &mut [Self::Body],
        links: &mut Links,
        report: &mut dyn FnMut(&Impact),
    ) -> bool;
    /// Other bodies that an impact of one or two bodies moves at once, through joints.
    #[inline]
    fn joined(&self, _a: u32, _b: Option<u32>, _bodies: &[Self::Body]) -> Vec<u32> {
        Vec::new()
    }
    /// The lasting surface contacts of a body.
    fn contacts<'b>(&self, body: &'b Self::Body) -> &'b [Surface];
    /// A surface that a body touches, as the description of the world numbers it.
    fn as_described(&self, _body: &Self::Body, surface: Surface) -> Surface {
        surface
    }
    /// How far ahead a large island plans its next step, if that step takes up all meetings of its bodies; none if
    /// meetings are events as elsewhere.
    #[inline]
    fn lookahead(&self, _members: &[u32], _bodies: &[Self::Body]) -> Option<Lookahead> {
        None
    }
    /// Whether a body takes its present step as part of a time-stepped island.
    #[inline]
    fn is_time_stepped(&self, _body: &Self::Body) -> bool {
        false
    }
    /// Whether two bodies may be so near at `time` that it takes a closer look whether they may touch.
    #[inline]
    fn may_be_near(&self, _pair: [usize; 2], _bodies: [&Self::Body; 2], _time: f64, _ahead: &Lookahead) -> bool {
        true
    }
    /// Whether two bodies, whose clocks are equal, may touch within a large island's next step.
    #[inline]
    fn may_touch(&self, _pair: [usize; 2], _bodies: [&Self::Body; 2], _ahead: &Lookahead) -> bool {
        false
    }
    /// Decides what a large island and all bodies that may touch it within its next step do next. `near` are the pairs
    /// that may touch. Meetings within the step are part of it, and are reported.
    fn settle_time_stepped(
        &self,
        _island: &TimeSteppedIsland,
        _bodies: &mut [Self::Body],
        _links: &mut Links,
        _scratch: &mut Self::Scratch,
        _report: &mut dyn FnMut(&Impact),
    ) {
    }
    /// Decides what a group of bodies in lasting contact with each other (`links` among `members`, all clocks equal)
    /// does next, and gives each a closed form. Drops contacts and links that have ended.
    fn settle(&self, members: &[u32], bodies: &mut [Self::Body], links: &mut Links, scratch: &mut Self::Scratch);
    /// Calls `each` for the points at which an island that has just settled bears load, which they do until one of its
    /// bodies settles again. Of bodies at rest, others at rest that they touch are told too. `work` is space of the
    /// caller's own: that in which the island has settled stays as it is.
    fn contact_forces(&self, island: &Island<'_, Self>, work: &mut Self::Scratch, each: &mut dyn FnMut(&ContactForce));
}
