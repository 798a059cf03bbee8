//! What a described world is simulated by: bodies that turn, or marbles, which do not. The rest of the world's code is
//! the same for both.

use super::shapes::Made;
use crate::animation::{Piece, Turn, UPRIGHT, upright};
use crate::film::{self, Pieces};
use crate::turns::turned;
use glam::{DQuat, DVec3};
use plaus_sim::marbles::{self, Marble, Marbles};
use plaus_sim::mechanics::Mechanics;
use plaus_sim::motion::Parabola;
use plaus_sim::rigid::{Partner, Phase, RigidBodyState, RigidWorld, Start};
use plaus_sim::trace::{Observer, Trace};
use plaus_sim::{Outcome, Scratch, State, WorldError};

/// Radians by which the turn of a piece of an animation may be off, where a body turns faster and faster, or its
/// moments of inertia differ, so that its motion has no closed form of pieces.
const TURN: f64 = 0.1;

/// How far in m a point of a driven body may be off in an animation, where it turns faster and faster. Default 0.02 mm.
const OFF: f64 = 2e-5;

/// Most pieces of one motion.
const MOST_PIECES: f64 = 2000.0;

/// How far the moments of inertia of a body may differ that turns like a ball: rounding.
const ROUND: f64 = 1e-9;

/// A simulator's world of one kind of bodies.
pub(super) trait Engine: Mechanics {
    /// A state in which every body waits for its release.
    fn begin(&self, starts: &[Start]) -> Result<State<Self::Body>, WorldError>;

    /// Puts a body to sleep until something hits it.
    fn put_to_sleep(&self, state: &mut State<Self::Body>, index: usize) -> Result<(), WorldError>;

    /// Puts a body in at the state's time.
    fn put(&self, state: &mut State<Self::Body>, index: usize, start: &Start) -> Result<(), WorldError>;

    /// Runs to a time, in s, or to the end.
    fn go(
        &self,
        state: &mut State<Self::Body>,
        scratch: &mut Scratch<Self::Scratch>,
        until: f64,
        observer: &mut impl Observer<Self>,
    ) -> Result<Outcome, WorldError>
    where
        Self: Sized;

    /// A copy for a recording.
    fn recorded(body: &Self::Body) -> Self::Body;

    /// The path of a body's present motion.
    fn path(body: &Self::Body) -> &Parabola;

    /// When a body came to rest, if it rests.
    fn rest(body: &Self::Body) -> Option<f64>;

    /// Where a body is at a time of its present motion, and how it is turned.
    fn pose(&self, index: usize, body: &Self::Body, time: f64) -> (DVec3, DQuat);

    /// Where a body is at a time of its present motion, and how it would go on from there.
    fn state_at(&self, index: usize, body: &Self::Body, time: f64) -> Start;

    /// How fast a body moves at a time of its present motion, in m/s, and how fast it turns, in rad/s.
    fn speeds(&self, index: usize, body: &Self::Body, time: f64) -> [f64; 2];

    /// Whether nothing bears a body in its present motion.
    fn is_free(body: &Self::Body) -> bool;

    /// Those of a body's motions that begin before `known`, and until when its orientation is known.
    fn begun(motions: &[Self::Body], known: f64) -> (&[Self::Body], f64);

    /// How many pieces of an animation a motion that lasts for `span` s is cut into.
    fn cuts(motion: &Self::Body, span: f64) -> u32;

    /// Whether a body of this shape is never cut.
    fn is_whole(made: &Made) -> bool;

    /// The motions of a body with this shape, up to `end`, in s.
    fn pieces(&self, index: usize, motions: &[Self::Body], made: &Made, end: f64) -> Vec<Piece>;

    /// Which bodies of a state struck what in impacts that scattered, and how often.
    fn scattered(&self, _: &State<Self::Body>) -> Vec<(usize, Partner, u32)> {
        Vec::new()
    }

    /// Whether a joint is broken in a body's motion.
    fn is_broken(&self, joint: usize, body: &Self::Body) -> bool;

    /// The ends of the free part of a string at a time of a motion, in m.
    fn string(&self, joint: usize, trace: &Trace<Self::Body>, time: f64) -> Option<[DVec3; 2]>;
}

impl Engine for RigidWorld {
    fn begin(&self, starts: &[Start]) -> Result<State<RigidBodyState>, WorldError> {
        self.state(starts)
    }

    fn put_to_sleep(&self, state: &mut State<RigidBodyState>, index: usize) -> Result<(), WorldError> {
        RigidWorld::put_to_sleep(self, state, index)
    }

    fn put(&self, state: &mut State<RigidBodyState>, index: usize, start: &Start) -> Result<(), WorldError> {
        RigidWorld::put(self, state, index, start)
    }

    fn go(
        &self,
        state: &mut State<RigidBodyState>,
        scratch: &mut Scratch<Self::Scratch>,
        until: f64,
        observer: &mut impl Observer<Self>,
    ) -> Result<Outcome, WorldError> {
        self.run(state, scratch, until, observer)
    }

    fn recorded(body: &RigidBodyState) -> RigidBodyState {
        body.recorded()
    }

    fn path(body: &RigidBodyState) -> &Parabola {
        &body.path
    }

    fn rest(body: &RigidBodyState) -> Option<f64> {
        (body.phase == Phase::Rest).then_some(body.path.t)
    }

    fn pose(&self, index: usize, body: &RigidBodyState, time: f64) -> (DVec3, DQuat) {
        let at = if body.phase == Phase::Rest { body.clone() } else { self.on_its_way(index, body, time) };
        (at.path.x, at.turn)
    }

    fn state_at(&self, index: usize, body: &RigidBodyState, time: f64) -> Start {
        let still = matches!(body.phase, Phase::Rest | Phase::Gone);
        let at = if still { body.clone() } else { self.at(index, body, time) };
        Start { position: at.path.x, orientation: at.turn, velocity: at.path.v, spin: at.spin, time }
    }

    fn speeds(&self, index: usize, body: &RigidBodyState, time: f64) -> [f64; 2] {
        let at = self.on_its_way(index, body, time);
        [at.path.v.length(), at.spin.length()]
    }

    fn is_free(body: &RigidBodyState) -> bool {
        matches!(body.phase, Phase::Flight | Phase::Leg | Phase::Gone)
    }

    fn begun(motions: &[RigidBodyState], known: f64) -> (&[RigidBodyState], f64) {
        film::begun(motions, known)
    }

    fn cuts(motion: &RigidBodyState, span: f64) -> u32 {
        let turns = matches!(motion.phase, Phase::Flight | Phase::Leg);
        if turns { parts(motion.spin.length() * span / TURN) } else { 1 }
    }

    /// It turns evenly.
    fn is_whole(made: &Made) -> bool {
        let inertia = made.mass_properties(1.0).inertia;
        inertia.max_element() - inertia.min_element() <= ROUND * inertia.max_element()
    }

    fn pieces(&self, index: usize, motions: &[RigidBodyState], made: &Made, end: f64) -> Vec<Piece> {
        let is_whole = Self::is_whole(made);
        // Turns the scenario's axes into the simulator's body axes.
        let axes = made.axes.conjugate();
        let span = |k: usize, motion: &RigidBodyState| {
            let until = motions.get(k + 1).map_or(end, |next| next.path.t);
            (until - motion.path.t).max(0.0)
        };
        let count = |span: f64, motion: &RigidBodyState| match motion.phase {
            Phase::Driven | Phase::Articulated => {
                let swing = swing(self, index, motion, span) * made.solid.reach();
                parts((swing / (8.0 * OFF)).sqrt() * span)
            }
            _ if is_whole => 1,
            _ => Self::cuts(motion, span),
        };
        let all = motions.iter().enumerate().map(|(k, motion)| count(span(k, motion), motion) as usize).sum();
        let mut pieces = Pieces(Vec::with_capacity(all));
        for (k, motion) in film::while_wanted(motions) {
            let span = span(k, motion);
            let parts = count(span, motion);
            let mut before: Option<RigidBodyState> = None;
            for part in 0..parts {
                let time = motion.path.t + span * f64::from(part) / f64::from(parts);
                let mut body = self.on_its_way(index, before.as_ref().unwrap_or(motion), time);
                // In flight each part goes on from the one before: each from the start would take the square of it.
                if motion.phase == Phase::Flight && part + 1 < parts {
                    before = Some(body.clone());
                }
                if motion.phase == Phase::Leg && part == 0 {
                    // A leg turns with its mean, not as fast as at its start.
                    body.spin = motion.spin;
                }
                pieces.add(&body, (body.path.t, body.path.x), UPRIGHT * body.turn * axes, 0.0);
            }
        }
        Piece::lead_on(&mut pieces.0);
        pieces.0
    }

    fn scattered(&self, state: &State<RigidBodyState>) -> Vec<(usize, Partner, u32)> {
        let of = |(index, body)| RigidWorld::scattered(self, body).map(move |(other, count)| (index, other, count));
        state.bodies().iter().enumerate().flat_map(of).collect()
    }

    fn is_broken(&self, joint: usize, body: &RigidBodyState) -> bool {
        RigidWorld::is_broken(self, joint, body)
    }

    fn string(&self, joint: usize, trace: &Trace<RigidBodyState>, time: f64) -> Option<[DVec3; 2]> {
        let motion = |body: usize| {
            let motions = trace.motions.get(body)?;
            motions.get(motions.partition_point(|motion| motion.path.t <= time).saturating_sub(1))
        };
        self.free_string(joint, time, motion)
    }
}

/// Marbles have no orientation: in animations, their spin is added up from where they begin.
impl Engine for Marbles {
    fn begin(&self, starts: &[Start]) -> Result<State<Marble>, WorldError> {
        let start = |start: &Start| {
            let Start { position, velocity, spin, time, .. } = *start;
            marbles::Start { position, velocity, spin, time }
        };
        self.state(&starts.iter().map(start).collect::<Vec<_>>())
    }

    /// No marble sleeps.
    fn put_to_sleep(&self, _: &mut State<Marble>, _: usize) -> Result<(), WorldError> {
        Ok(())
    }

    /// All marbles are there from the start.
    fn put(&self, _: &mut State<Marble>, _: usize, _: &Start) -> Result<(), WorldError> {
        Ok(())
    }

    fn go(
        &self,
        state: &mut State<Marble>,
        scratch: &mut Scratch<Self::Scratch>,
        until: f64,
        observer: &mut impl Observer<Self>,
    ) -> Result<Outcome, WorldError> {
        self.run(state, scratch, until, observer)
    }

    fn recorded(body: &Marble) -> Marble {
        *body
    }

    fn path(body: &Marble) -> &Parabola {
        &body.path
    }

    fn rest(body: &Marble) -> Option<f64> {
        (body.phase == marbles::Phase::Rest).then_some(body.path.t)
    }

    fn pose(&self, index: usize, body: &Marble, time: f64) -> (DVec3, DQuat) {
        let place = if Self::rest(body).is_some() { body.path.x } else { self.at(index, body, time).path.x };
        (place, DQuat::IDENTITY)
    }

    fn state_at(&self, index: usize, body: &Marble, time: f64) -> Start {
        let at = if Self::rest(body).is_some() { *body } else { self.at(index, body, time) };
        let orientation = DQuat::IDENTITY;
        Start { position: at.path.x, orientation, velocity: at.path.v, spin: at.spin, time }
    }

    fn speeds(&self, index: usize, body: &Marble, time: f64) -> [f64; 2] {
        let at = self.at(index, body, time);
        [at.path.v.length(), at.spin.length()]
    }

    fn is_free(body: &Marble) -> bool {
        body.phase == marbles::Phase::Flight
    }

    fn begun(motions: &[Marble], known: f64) -> (&[Marble], f64) {
        let begun = motions.partition_point(|motion| motion.path.t < known).max(1);
        (&motions[..begun.min(motions.len())], known)
    }

    /// With its mean spin, an eighth of the square is the farthest that the turn is off within a part.
    fn cuts(motion: &Marble, span: f64) -> u32 {
        let rests = matches!(motion.phase, marbles::Phase::Rest | marbles::Phase::Waiting);
        if rests { 1 } else { parts((motion.spin_rate.length() / (8.0 * TURN)).sqrt() * span) }
    }

    fn is_whole(_: &Made) -> bool {
        false
    }

    fn pieces(&self, index: usize, motions: &[Marble], _: &Made, end: f64) -> Vec<Piece> {
        let (mut pieces, mut orientation) = (Pieces::default(), DQuat::IDENTITY);
        for (k, motion) in film::while_wanted(motions) {
            let until = motions.get(k + 1).map_or(end, |next| next.path.t);
            let span = (until - motion.path.t).max(0.0);
            if matches!(motion.phase, marbles::Phase::Rest | marbles::Phase::Waiting) {
                let turn = Turn::still((UPRIGHT * orientation).normalize());
                pieces.push(
                    Piece::ballistic(motion.path.t, upright(motion.path.x), DVec3::ZERO, DVec3::ZERO).turning(turn),
                );
                continue;
            }
            let parts = Self::cuts(motion, span);
            for part in 0..parts {
                let after = |share: f64| span * (f64::from(part) + share) / f64::from(parts);
                let (path, begins) = (&motion.path, after(0.0));
                let spin = self.at(index, motion, path.t + after(0.5)).spin;
                let turn = Turn { orientation: (UPRIGHT * orientation).normalize(), spin: upright(spin), own: 0.0 };
                let [x, v, a] = [path.after(begins), path.velocity_after(begins), path.a].map(upright);
                pieces.push(Piece::ballistic(path.t + begins, x, v, a).turning(turn));
                orientation = turned(spin * (span / f64::from(parts))) * orientation;
            }
        }
        pieces.0
    }

    /// Nothing joins marbles.
    fn is_broken(&self, _: usize, _: &Marble) -> bool {
        false
    }

    fn string(&self, _: usize, _: &Trace<Marble>, _: f64) -> Option<[DVec3; 2]> {
        None
    }
}

/// Times within a motion at which its angular velocity is looked at.
const LOOKS: u32 = 16;

/// How fast the angular velocity of a body that is driven or on joints changes at most within a motion of `span`
/// seconds, in rad/s².
fn swing(world: &RigidWorld, index: usize, motion: &RigidBodyState, span: f64) -> f64 {
    let time = |k: u32| motion.path.t + span * (f64::from(k) + 0.5) / f64::from(LOOKS);
    let mut before = motion.spin;
    let change = (0..LOOKS).map(|k| {
        let spin = world.at(index, motion, time(k)).spin;
        (spin - std::mem::replace(&mut before, spin)).length()
    });
    let most = change.fold(0.0, f64::max);
    if most > 0.0 { most * f64::from(LOOKS) / span } else { 0.0 }
}

/// How many pieces a motion is cut into that asks for so many.
fn parts(asked: f64) -> u32 {
    asked.ceil().clamp(1.0, MOST_PIECES) as u32
}
