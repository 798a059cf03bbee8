//! The animation of a draw. In the simulator z points up, in an animation y.

use super::draw::Shot;
use super::lane::{Lane, Work};
use super::props;
use super::release::Quantity;
use crate::animation::{
    Animation, Contact, Impact, Look, Material, Piece, Shape, Stripe, Track, Turn, UPRIGHT, View, upright,
};
use crate::scene::Until;
use crate::touch::{Toucher, in_order};
use glam::DVec3;
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::{Phase, Rigid, Turning};
use plaus_sim::shape::{MassProperties, Profile};
use plaus_sim::trace::Trace;

/// Points of a pin's drawn outline.
const OUTLINE: usize = 40;

pub(super) fn animate(lane: &Lane, draw: &Shot, shown: f64, until: Option<Until>) -> Result<Animation, ModelError> {
    let (world, trace, end) = lane.record(draw, &mut Work::default(), until)?;
    let begin = begin(&world, &trace, shown);
    let pin = lane.pin();
    let look = |body| if body == 0 { Look::new([36, 52, 120], Material::Glossy) } else { Look::IVORY };
    let outline = Profile::pin().outline(OUTLINE).map_err(ModelError::new)?;
    let profile: Vec<[f64; 2]> = outline.iter().map(|[r, height]| [*r, height - pin.balance()]).collect();
    let shape = |body| match body {
        0 => Shape::Sphere { radius: draw.get(Quantity::Radius), holes: true },
        _ => Shape::Revolution { profile: profile.clone(), stripes: stripes(pin.balance()) },
    };
    let MassProperties { inertia, .. } = pin.mass_properties(1.0);
    let precession = inertia.z / inertia.x;
    let tracks = trace.motions.iter().enumerate().map(|(body, motions)| {
        let ratio = if body == 0 { 1.0 } else { precession };
        Track::new(lane.name(body), shape(body), look(body), pieces(&world, body, motions, begin, ratio))
    });
    let impacts = trace.impacts.iter().filter(|hit| hit.time >= begin).map(|hit| {
        let other = match hit.other {
            Other::Body(other) => lane.name(other),
            Other::Surface(_) => props::part(hit.point, hit.normal).into(),
        };
        Impact::new(hit.time - begin, lane.name(hit.body), other, upright(hit.point), upright(hit.normal))
            .with_strength(hit.approach, hit.impulse.length())
    });
    let [low, high] = props::deck();
    let view = View::from(0.0, 0.9, 1.0).only(upright(low), upright(high));
    let animation = Animation::new(end - begin, tracks.collect(), impacts.collect());
    let contacts = contacts(lane, draw, &trace, &animation, begin);
    Ok(animation.with_contacts(contacts).with_scenery(props::props()).with_view(view))
}

/// The rolling and sliding contacts.
fn contacts(lane: &Lane, draw: &Shot, trace: &Trace<Turning>, animation: &Animation, begin: f64) -> Vec<Contact> {
    let alley = lane.alley(draw);
    let of_body = |(index, track): (usize, &Track)| {
        let Track { name, shape, pieces, .. } = track;
        let mass = if index == 0 { alley.ball_mass } else { alley.pin_mass };
        let motions = &trace.motions[index];
        let touches = |piece: usize| {
            // The motion that the piece was made of: the last that had begun.
            let time = pieces[piece].start + begin;
            let motion = motions.partition_point(|motion| motion.path.t <= time).checked_sub(1).map(|k| &motions[k])?;
            if !matches!(motion.phase, Phase::Glide | Phase::Step) {
                return None;
            }
            let fixed = motion.phase == Phase::Glide || !motion.touching().is_empty();
            let part = || props::part(motion.path.x, DVec3::Z).to_owned();
            let hits = animation.impacts.iter().rev().filter(|hit| hit.time <= pieces[piece].start);
            let pin = || {
                hits.filter(|hit| hit.involves(name)).map(|hit| if hit.body == *name { &hit.other } else { &hit.body })
            };
            let body = || pin().find(|other| animation.tracks.iter().any(|track| track.name == **other)).cloned();
            if fixed { Some(part()) } else { body().or_else(|| Some(part())) }
        };
        Toucher { name, shape, mass, pieces, end: animation.duration }.contacts(touches)
    };
    in_order(animation.tracks.iter().enumerate().flat_map(of_body).collect())
}

/// The time at which the ball is `shown` m before the head pin's spot, or 0 if it starts nearer.
fn begin(world: &Rigid, trace: &Trace<Turning>, shown: f64) -> f64 {
    let Some(ball) = trace.motions.first() else { return 0.0 };
    let after = ball.partition_point(|motion| motion.path.x.y < -shown);
    let Some(motion) = after.checked_sub(1).and_then(|k| ball.get(k)) else { return 0.0 };
    let until = ball.get(after).map_or(motion.path.t, |next| next.path.t);
    // The ball is before that place at the motion's start and beyond it at its end, so the time between is halved, to a
    // microsecond.
    let (mut low, mut high) = (motion.path.t, until);
    while high - low > 1e-6 {
        let middle = 0.5 * (low + high);
        if world.at(0, motion, middle).path.x.y < -shown { low = middle } else { high = middle }
    }
    low
}

/// The motions of a body from `begin` on. `ratio` is its moment of inertia about its third axis over that about the
/// others.
fn pieces(world: &Rigid, index: usize, motions: &[Turning], begin: f64, ratio: f64) -> Vec<Piece> {
    let first = motions.partition_point(|motion| motion.path.t <= begin).saturating_sub(1);
    let mut pieces: Vec<Piece> = Vec::with_capacity(motions.len() - first);
    for motion in &motions[first..] {
        let body = world.on_its_way(index, motion, motion.path.t.max(begin));
        let moves = !matches!(body.phase, Phase::Rest | Phase::Waiting | Phase::Gone);
        let start = body.path.t - begin;
        let [v, a] = if moves { [body.path.v, body.path.a] } else { [DVec3::ZERO; 2] };
        let spin = if moves { body.spin } else { DVec3::ZERO };
        // A free top precesses about its angular momentum, here over its moment about the other axes, while it spins
        // about its own axis.
        let axis = body.turn * DVec3::Z;
        let own = if matches!(body.phase, Phase::Flight | Phase::Step) { spin.dot(axis) * (1.0 - ratio) } else { 0.0 };
        let turn = Turn { orientation: (UPRIGHT * body.turn).normalize(), spin: upright(spin - axis * own), own };
        let piece = Piece::ballistic(start, upright(body.path.x), upright(v), upright(a)).turning(turn);
        // Of motions that begin at the same time only the last takes effect.
        if pieces.last().is_some_and(|last| last.start == piece.start) {
            pieces.pop();
        }
        pieces.push(piece);
    }
    Piece::lead_on(&mut pieces);
    pieces
}

/// Two red rings about the neck.
fn stripes(balance: f64) -> Vec<Stripe> {
    let look = Look::new([200, 40, 40], Material::Glossy);
    let stripe = |from: f64| Stripe { from: from - balance, to: from + 0.008 - balance, look };
    vec![stripe(0.238), stripe(0.262)]
}
