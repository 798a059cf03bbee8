//! A ball that nothing but flat ground touches, at any slope, in closed form: sliding, rolling, spinning and rest
//! (`crate::roll`). Ground is a plane or a triangle of a mesh.
//!
//! On a triangle the motion ends at its sides. Where the next triangle lies in the same plane, the ball goes on; where
//! it rises, the ball touches it before it reaches the side; where it falls away, the ball flies if it is fast enough,
//! and otherwise turns over the edge in a step. A ball may touch several faces, for example where it has just come to a
//! rising one. It goes on along one of them if it then leaves the others, or presses against none.

use crate::material::Law;
use crate::rigid::body_state::{Momentum, NEVER, Phase, RigidBodyState};
use crate::rigid::narrow_phase::contact_id::ContactId;
use crate::rigid::narrow_phase::contact_point::ContactPoint;
use crate::rigid::narrow_phase::static_collider::{EdgeNeighbour, StaticCollider};
use crate::rigid::scratch::RigidScratch;
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{
    AT_TRIANGLE_SIDE, EDGE_LEAN, EDGE_PARTING_SPEED, EDGE_TURN, LEVEL_TRIANGLE, MAX_CROSSED_FACES, NO_PRESSURE,
    ROLL_CLOCK_RESOLUTION, SHORT_ROLL,
};
use crate::rigid::{BodyDef, RigidWorld};
use crate::roll::{End, Going, Kind, Slope};
use crate::roots::fall_of_quadratic;
use crate::scenery::Surface;
use glam::DVec3;
use plaus_dist::math;

/// Flat ground under a ball.
struct RollingGround<'w> {
    /// For a mesh: the part, and the number of the triangle.
    triangle: Option<(u16, &'w StaticCollider, u32)>,
}

/// How a ball that touches something goes on.
enum NextMotion {
    /// As it has been told.
    Found,
    /// Along this triangle.
    Onto(ContactPoint),
    /// Over an edge of the triangle, which it touches from now on.
    Over(ContactPoint),
    /// In steps.
    Unknown,
}

/// A ball alone, and what is asked of it.
struct RollingBall<'w> {
    world: &'w RigidWorld,
    index: usize,
    spec: &'w BodyDef,
    island: &'w RigidScratch,
}

/// Starts a closed form, a flight over an edge or a turn about it, if a body is a ball and there is one.
pub(crate) fn begin(world: &RigidWorld, island: &mut RigidScratch, bodies: &mut [RigidBodyState]) -> bool {
    let ([place], [], [], []) = (&island.places[..], &island.pairs[..], &island.parting[..], &island.rows[..]) else {
        return false;
    };
    let (index, spec) = (place.body, &world.specs[place.body]);
    if !island.stops.is_empty() || !spec.is_ball || spec.is_driven() || spec.damping.is_some() || spec.anisotropy != 0.0
    {
        return false;
    }
    // A curved track may have the same normal as the face beside it, and rises from there.
    if island.touches.iter().any(|(_, t)| world.front(t.surface).is_some()) {
        return false;
    }
    for k in 0..island.touches.len() {
        let ball = RollingBall { world, index, spec, island };
        let (mut touch, mut is_over) = (island.touches[k].1, false);
        for _ in 0..MAX_CROSSED_FACES {
            let way = match RollingEdge::under(world, &touch) {
                Some(edge) => ball.over(&mut bodies[index], &touch, &edge),
                None => ball.along(&mut bodies[index], &touch),
            };
            match way {
                NextMotion::Found => return true,
                NextMotion::Onto(next) | NextMotion::Over(next) => {
                    (touch, is_over) = (next, matches!(way, NextMotion::Over(_)))
                }
                NextMotion::Unknown => break,
            }
        }
        if is_over {
            island.touches[k].1 = touch;
        }
    }
    false
}

impl RollingBall<'_> {
    /// Whether the ball, at velocity `v`, leaves all that it touches elsewhere than at `touch`.
    fn leaves_others(&self, touch: &ContactPoint, v: DVec3) -> bool {
        self.others(touch).all(|t| v.dot(t.normal) > self.slowest(v))
    }

    /// Other points at which it touches something. Two triangles that share an edge touch it at the same point.
    fn others<'t>(&'t self, touch: &'t ContactPoint) -> impl Iterator<Item = &'t ContactPoint> {
        let all = self.island.touches.iter().chain(&self.island.leaving).map(|t| &t.1);
        all.filter(|t| (t.normal - touch.normal).length() > EDGE_LEAN)
    }

    /// Rate at which the ball neither leaves a face nor presses against it.
    fn slowest(&self, v: DVec3) -> f64 {
        NO_PRESSURE * (v.length() + self.spec.speed)
    }

    fn law(&self, body: &RigidBodyState, touch: &ContactPoint) -> Law {
        self.world.law_at(self.index, touch, body.path.x + touch.arm)
    }

    /// Whether a contact is lasting, and no overlap that a step would have to push out.
    fn lasts(&self, body: &RigidBodyState, touch: &ContactPoint, law: &Law) -> bool {
        let rate = body.path.v.dot(touch.normal).abs();
        touch.gap >= -self.spec.gap && rate <= self.world.settle_speed(self.spec, law)
    }

    fn slope(&self, touch: &ContactPoint, law: &Law) -> Option<Slope> {
        let spec = self.spec;
        let gyration = spec.inertia.moments.x / (spec.mass * spec.bounding_radius * spec.bounding_radius);
        Slope::new(touch.normal, spec.gravity, law, [gyration, spec.bounding_radius], LEVEL_TRIANGLE)
    }

    /// Goes on along a face.
    fn along(&self, body: &mut RigidBodyState, touch: &ContactPoint) -> NextMotion {
        let (spec, n) = (self.spec, touch.normal);
        let (Some(ground), law) = (RollingGround::under(self.world, touch), self.law(body, touch)) else {
            return NextMotion::Unknown;
        };
        if !self.lasts(body, touch, &law) {
            return NextMotion::Unknown;
        }
        // Slow approach is stopped, and so is slow parting: the contact lasts.
        let mut v = along(body.path.v, n);
        if let Some((side, beyond)) = ground.side_reached(spec, body, n, v) {
            return match (beyond, ground.triangle) {
                (EdgeNeighbour::Flat(next), Some((part, collider, _))) => {
                    NextMotion::Onto(collider.face_under(part, next, body.path.x, spec.bounding_radius))
                }
                (EdgeNeighbour::Down, Some((part, collider, k))) => {
                    NextMotion::Over(ContactPoint { surface: collider.side(k, side).surface(part), ..*touch })
                }
                _ => NextMotion::Unknown,
            };
        }
        let Some(slope) = self.slope(touch, &law) else { return NextMotion::Unknown };
        let mut spin = body.spin;
        let Some(going) = settled(&slope, spec, &mut v, &mut spin) else { return NextMotion::Unknown };
        let (slowest, weakest) = (self.slowest(v), NO_PRESSURE * spec.gravity_magnitude);
        let leaves = |t: &ContactPoint| v.dot(t.normal) > slowest;
        let rests_on = |t: &ContactPoint| v.dot(t.normal) >= -slowest && going.acceleration.dot(t.normal) >= -weakest;
        let is_free = self.others(touch).all(|t| leaves(t) || rests_on(t));
        if !is_free || !follow(&slope, ground.sides(), &going, body, [v, spin]) {
            return NextMotion::Unknown;
        }
        let held = self.others(touch).filter(|t| !leaves(t)).map(|t| t.surface);
        body.list(std::iter::once(touch.surface).chain(held));
        NextMotion::Found
    }

    /// Goes over an edge: onto a triangle, if it is over one already; flying, if it is fast; otherwise turning.
    fn over(&self, body: &mut RigidBodyState, touch: &ContactPoint, edge: &RollingEdge) -> NextMotion {
        let (spec, n) = (self.spec, touch.normal);
        let law = self.law(body, touch);
        if !self.lasts(body, touch, &law) {
            return NextMotion::Unknown;
        }
        let v = along(body.path.v, n);
        let Some(slope) = self.slope(touch, &law) else { return NextMotion::Unknown };
        let across = |u: DVec3| along(u, edge.along);
        let ahead = if across(v).length() > self.slowest(v) { across(v) } else { across(slope.downhill) };
        let Some(ahead) = ahead.try_normalize() else { return NextMotion::Unknown };
        let next = edge.ahead(n, ahead);
        if let Some((face, sine)) = next
            && sine <= EDGE_LEAN
        {
            return NextMotion::Onto(edge.collider.face_under(edge.part, face, body.path.x, spec.bounding_radius));
        }
        // What of the load is left for the edge to carry.
        let load = slope.load - v.dot(ahead) * v.dot(ahead) / spec.bounding_radius;
        if !self.leaves_others(touch, v) {
            return NextMotion::Unknown;
        }
        if load < 0.0 {
            body.path.v = v + n * (EDGE_PARTING_SPEED * v.length());
            body.list(std::iter::empty());
            self.world.fly(self.index, body);
            return NextMotion::Found;
        }
        let angle = next.map_or(f64::INFINITY, |(face, sine)| math::atan2(sine, n.dot(edge.collider.normal(face))));
        let angle = angle.min(EDGE_TURN * self.world.accuracy.step);
        let rolls = law.rolling == 0.0 && law.spinning == 0.0 && slope.grips(load);
        let is_known = law.friction == 0.0 || rolls && slope.skid(v, body.spin) <= SHORT_ROLL * spec.gap;
        if is_known && self.turn(body, touch, [v, ahead, edge.along], angle, &slope) {
            NextMotion::Found
        } else {
            NextMotion::Unknown
        }
    }

    /// Turns about an edge by an angle in one step, rolling if there is friction. The energy says how fast the ball is
    /// then; only the time that it takes is approximate, with an error of the order of the angle's square. False if the
    /// ball does not get so far.
    fn turn(
        &self,
        body: &mut RigidBodyState,
        touch: &ContactPoint,
        [v, ahead, edge]: [DVec3; 3],
        angle: f64,
        slope: &Slope,
    ) -> bool {
        let (spec, n) = (self.spec, touch.normal);
        let (v, spin, lag) = if slope.is_rough() {
            let v = slope.caught(v, body.spin);
            (v, slope.rolling(v, body.spin), 1.0 + slope.gyration())
        } else {
            (v, body.spin, 1.0)
        };
        let (s, c) = math::sin_cos(angle);
        let (up, forward) = (n * c + ahead * s, ahead * c - n * s);
        let radius = spec.bounding_radius + touch.gap;
        let way = (up - n) * radius;
        let squared = v.dot(ahead) * v.dot(ahead) + 2.0 * spec.gravity.dot(way) / lag;
        let time = 2.0 * radius * angle / (v.dot(ahead) + squared.max(0.0).sqrt());
        if squared <= 0.0 || body.path.t + time <= body.path.t {
            return false;
        }
        let glides = [v.dot(edge), v.dot(edge) + spec.gravity.dot(edge) / lag * time];
        let end = forward * squared.sqrt() + edge * glides[1];
        let end_spin = if slope.is_rough() { up.cross(end) / spec.bounding_radius + up * spin.dot(n) } else { spin };
        body.ends = [(v, spin), (end, end_spin)].map(|(v, w)| Momentum { v, l: spec.inertia.momentum(body.turn, w) });
        body.path.v = (way + edge * (0.5 * (glides[0] + glides[1]) * time)) / time;
        body.spin = (spin + end_spin) * 0.5;
        body.angular_momentum_transport = DVec3::ZERO;
        body.pair_loads.clear();
        body.set_loads(std::iter::empty());
        body.begin(Phase::Step, DVec3::ZERO);
        body.expiry = body.path.t + time;
        body.list(std::iter::once(touch.surface));
        true
    }
}

/// How the ball goes on. A slide or a roll that is too short to matter is over at once.
fn settled(slope: &Slope, spec: &BodyDef, v: &mut DVec3, spin: &mut DVec3) -> Option<Going> {
    if slope.grips(slope.load) && slope.skid(*v, *spin) <= SHORT_ROLL * spec.gap {
        *v = slope.caught(*v, *spin);
        *spin = slope.rolling(*v, *spin);
    }
    let going = slope.going(*v, spin)?;
    if going.end == End::Stops && 0.5 * v.length() * going.lasts <= SHORT_ROLL * spec.gap {
        *v = DVec3::ZERO;
        *spin = slope.rolling(*v, *spin);
        return slope.going(*v, spin);
    }
    Some(going)
}

/// Gives the body its closed form; false if it would be over at once.
fn follow(
    slope: &Slope,
    sides: &[(DVec3, f64)],
    going: &Going,
    body: &mut RigidBodyState,
    [v, mut spin]: [DVec3; 2],
) -> bool {
    if going.kind == Kind::Rests {
        body.lie_still();
        return true;
    }
    let (n, t) = (slope.normal, body.path.t);
    let (mut lasts, mut spin_rate) = (going.lasts, going.spin_rate);
    let (about, drill) = (spin.dot(n), slope.drill());
    if drill > 0.0 && about != 0.0 {
        let drills = about.abs() / drill;
        if drills <= ROLL_CLOCK_RESOLUTION * t {
            spin -= n * about;
        } else {
            spin_rate -= n * (drill * about.signum());
            lasts = lasts.min(drills);
        }
    }
    for (inward, offset) in sides {
        let c = [inward.dot(body.path.x) - offset, inward.dot(v), 0.5 * inward.dot(going.acceleration)];
        lasts = fall_of_quadratic(c, lasts).unwrap_or(lasts);
    }
    let expiry = (t + lasts).min(NEVER);
    if expiry <= t {
        return false;
    }
    (body.path.v, body.spin) = (v, spin);
    body.begin(Phase::Glide, going.acceleration);
    (body.spin_rate, body.rolls_after, body.line, body.expiry) = (spin_rate, false, None, expiry);
    true
}

fn along(v: DVec3, normal: DVec3) -> DVec3 {
    v - normal * v.dot(normal)
}

impl<'w> RollingGround<'w> {
    /// The flat ground that a ball touches, if it is some.
    fn under(world: &'w RigidWorld, touch: &ContactPoint) -> Option<Self> {
        let triangle = match touch.surface {
            Surface::Part { part, .. } => {
                matches!(world.parts[usize::from(part)], StaticShape::Plane(_)).then_some(())?;
                None
            }
            Surface::Spot { part, piece, point } => {
                let collider = world.static_colliders.get(usize::from(part))?;
                Some((part, collider, collider.face_of(ContactId::of_surface(piece, point))?))
            }
            _ => return None,
        };
        Some(Self { triangle })
    }

    fn sides(&self) -> &[(DVec3, f64)] {
        self.triangle.and_then(|(_, collider, k)| collider.sides(k)).map_or(&[], |sides| &sides[..])
    }

    /// The side of the triangle that the ball is at and moves beyond, and what is there.
    fn side_reached(
        &self,
        spec: &BodyDef,
        body: &RigidBodyState,
        n: DVec3,
        v: DVec3,
    ) -> Option<(usize, EdgeNeighbour)> {
        let (_, collider, k) = self.triangle?;
        let gravity = along(spec.gravity, n);
        let is_reached = |&(inward, offset): &(DVec3, f64)| {
            let rate = inward.dot(v);
            inward.dot(body.path.x) - offset <= AT_TRIANGLE_SIDE * spec.size
                && (rate < 0.0 || (rate == 0.0 && inward.dot(gravity) < 0.0))
        };
        let side = self.sides().iter().position(is_reached)?;
        Some((side, collider.beyond(k, side)))
    }
}

/// An edge of a mesh under a ball.
struct RollingEdge<'w> {
    part: u16,
    collider: &'w StaticCollider,
    along: DVec3,
    faces: [Option<u32>; 2],
}

impl<'w> RollingEdge<'w> {
    fn under(world: &'w RigidWorld, touch: &ContactPoint) -> Option<Self> {
        let Surface::Spot { part, piece, point } = touch.surface else { return None };
        let collider = world.static_colliders.get(usize::from(part))?;
        let (along, faces) = collider.edge_under(ContactId::of_surface(piece, point))?;
        Some(Self { part, collider, along, faces })
    }

    /// The triangle towards which the ball turns, and the sine of the angle that is left. Beyond the edge of a sheet
    /// there is none.
    fn ahead(&self, n: DVec3, ahead: DVec3) -> Option<(u32, f64)> {
        let before = self.faces.iter().flatten().filter(|&&f| self.lies(f, ahead));
        let sines = before.map(|&f| (f, self.collider.normal(f).dot(ahead)));
        let next = sines.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (next.1 >= -EDGE_LEAN && self.collider.normal(next.0).dot(n) > 0.0).then_some(next)
    }

    /// Whether a triangle beside the edge is on this side of it.
    fn lies(&self, face: u32, ahead: DVec3) -> bool {
        let inwards = self.collider.sides(face).into_iter().flatten().map(|side| side.0);
        let lean = |inward: DVec3| inward.dot(self.along).abs();
        inwards.min_by(|&a, &b| lean(a).total_cmp(&lean(b))).is_some_and(|inward| inward.dot(ahead) > 0.0)
    }
}
