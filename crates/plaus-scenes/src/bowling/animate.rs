//! The animation of a draw. In the simulator z points up, in an animation y.

use super::draw::Shot;
use super::lane::Lane;
use super::props;
use super::release::Quantity;
use crate::animation::{
    Animation, Impact, Look, Material, Motion, Piece, Shape, Stripe, Track, UPRIGHT, View, upright,
};
use crate::film::{Figure, Pieces, begun, impact, met_last};
use crate::require::Begun;
use glam::DVec3;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld};
use plaus_sim::shape::MassProperties;
use plaus_sim::trace::Trace;

/// The animation of a recorded shot, with the alley.
pub(super) fn animate(motion: Motion) -> Animation {
    Animation::from(motion).with_scenery(props::props()).with_view(view())
}

/// From where the alley is looked at.
pub(super) fn view() -> View {
    let [low, high] = props::deck();
    View::from(0.0, 0.9, 1.0).only(upright(low), upright(high))
}

/// The bodies of a trace that is known before `known` and ends at `end`, in s from the release. The film begins when
/// the ball is as near as is shown; `None` until then.
pub(super) fn film(
    lane: &Lane,
    draw: &Shot,
    (world, trace): (&RigidWorld, &Trace<RigidBodyState>),
    [end, known]: [f64; 2],
) -> Option<Begun> {
    let begin = begin(world, trace, lane.shown, known)?;
    let (alley, pin, release) = (lane.alley(draw), &lane.pin, known);
    let known = known - begin;
    let look = |body| if body == 0 { Look::new([36, 52, 120], Material::Glossy) } else { Look::IVORY };
    let shape = |body| match body {
        0 => Shape::Sphere { radius: draw.get(Quantity::Radius), holes: true },
        _ => Shape::Revolution { profile: lane.profile.clone(), stripes: stripes(pin.balance()) },
    };
    let MassProperties { inertia, .. } = pin.mass_properties(1.0);
    let precession = inertia.z / inertia.x;
    let mut turns = known;
    let figure = |(body, motions): (usize, &Vec<RigidBodyState>)| {
        let (ratio, mass) = if body == 0 { (1.0, alley.ball_mass) } else { (precession, alley.pin_mass) };
        let (motions, turning) = begun(motions, release);
        turns = turns.min(turning - begin);
        let track = Track::new(lane.name(body), shape(body), look(body), pieces(world, body, motions, begin, ratio));
        Figure { track, mass, end: end - begin }
    };
    let figures: Vec<Figure> = trace.motions.iter().enumerate().map(figure).collect();
    let shown = trace.impacts.iter().filter(|hit| hit.time >= begin && hit.time < release);
    let impacts = shown.map(|hit| {
        let other = match hit.other {
            Other::Body(other) => lane.name(other),
            Other::Surface(_) => props::part(hit.point, hit.normal).into(),
        };
        impact(hit, [lane.name(hit.body), other], hit.time - begin, DVec3::ZERO)
    });
    let touches = |index: usize, piece: usize, figures: &[Figure], impacts: &[Impact]| {
        let (track, motions) = (&figures[index].track, &trace.motions[index]);
        // The motion that the piece was made of: the last that had begun.
        let time = track.pieces[piece].start + begin;
        let motion = motions.partition_point(|motion| motion.path.t <= time).checked_sub(1).map(|k| &motions[k])?;
        if !matches!(motion.phase, Phase::Glide | Phase::Step) {
            return None;
        }
        let is_body = |name: &&String| figures.iter().any(|figure| figure.track.name == **name);
        let on_part = motion.phase == Phase::Glide || !motion.touching().is_empty();
        let body = || met_last(track, piece, impacts).find(is_body).cloned();
        (!on_part).then(body).flatten().or_else(|| Some(props::part(motion.path.x, DVec3::Z).to_owned()))
    };
    Some(crate::film::film(figures, impacts.collect(), (end - begin, known, turns), touches))
}

/// The time at which the ball is `shown` m before the head pin's spot, or 0 if it starts nearer; `None` if a trace that
/// is known before `known` does not tell.
pub(super) fn begin(world: &RigidWorld, trace: &Trace<RigidBodyState>, shown: f64, known: f64) -> Option<f64> {
    let Some(ball) = trace.motions.first() else { return Some(0.0) };
    let after = ball.partition_point(|motion| motion.path.x.y < -shown);
    let Some(motion) = after.checked_sub(1).and_then(|k| ball.get(k)) else { return Some(0.0) };
    let until = match ball.get(after) {
        Some(next) => next.path.t,
        None if known.is_finite() => return None,
        None => motion.path.t,
    };
    // The ball is before that place at the motion's start and beyond it at its end, so the time between is halved, to a
    // microsecond.
    let (mut low, mut high) = (motion.path.t, until);
    while high - low > 1e-6 {
        let middle = 0.5 * (low + high);
        if world.at(0, motion, middle).path.x.y < -shown { low = middle } else { high = middle }
    }
    Some(low)
}

/// The motions of a body from `begin` on. `ratio` is its moment of inertia about its third axis over that about the
/// others.
fn pieces(world: &RigidWorld, index: usize, motions: &[RigidBodyState], begin: f64, ratio: f64) -> Vec<Piece> {
    let first = motions.partition_point(|motion| motion.path.t <= begin).saturating_sub(1);
    let mut pieces = Pieces::default();
    for motion in &motions[first..] {
        let body = world.on_its_way(index, motion, motion.path.t.max(begin));
        // A free top precesses about its angular momentum, here over its moment about the other axes, while it spins
        // about its own axis.
        let free = matches!(body.phase, Phase::Flight | Phase::Step);
        let own = if free { body.spin.dot(body.turn * DVec3::Z) * (1.0 - ratio) } else { 0.0 };
        pieces.add(&body, (body.path.t - begin, body.path.x), UPRIGHT * body.turn, own);
    }
    Piece::lead_on(&mut pieces.0);
    pieces.0
}

/// Two red rings about the neck.
fn stripes(balance: f64) -> Vec<Stripe> {
    let look = Look::new([200, 40, 40], Material::Glossy);
    let stripe = |from: f64| Stripe { from: from - balance, to: from + 0.008 - balance, look };
    vec![stripe(0.238), stripe(0.262)]
}
