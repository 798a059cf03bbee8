//! Marbles behind the interface of the event loop.

use super::body::{MOST_CONTACTS, Marble, Phase};
use super::island::MarbleScratch;
use super::{Marbles, ROUNDING, step};
use crate::detect;
use crate::links::Links;
use crate::material::Law;
use crate::mechanics::{ContactForce, Impact, Island, Mechanics, Meeting, Other};
use crate::resolve::{Struck, Touch, sphere_impact, spheres_at_once};
use crate::scenery::{Aabb, Projection, Surface};
use glam::DVec3;
use std::cmp::Ordering;

impl Marbles {
    #[inline]
    pub(crate) fn touch(&self, index: usize, body: &Marble) -> Touch {
        let s = &self.specs[index];
        let inverse_mass = self.balls[index].inverse_mass;
        Touch { v: body.path.v, w: body.spin, inverse_mass, radius: s.radius, gyration: s.gyration }
    }

    /// Largest rebound speed at which a contact lasts.
    #[inline]
    pub(crate) fn settle_speed(&self, scale: f64, law: &Law) -> f64 {
        self.accuracy.settle * (1.0 - law.restitution) * scale
    }

    /// Time between impacts within which a marble rattles.
    #[inline]
    fn rattle(&self, index: usize) -> f64 {
        self.rattles[index]
    }

    /// Largest separating speed at which a lasting contact continues. After an impact, it is that of a rebound that
    /// settles. Otherwise only the error of a step separates a contact; and a bounce below the height that the preset
    /// sees does not count as separated, however elastic the law.
    #[inline]
    pub(crate) fn parting_speed(&self, scale: f64, law: &Law, was_hit: bool) -> f64 {
        if was_hit { self.settle_speed(scale, law) } else { self.accuracy.settle * scale }
    }

    /// How a marble meets a surface at its clock.
    fn meet_surface(&self, index: usize, body: &Marble, surface: Surface) -> (Projection, Approach) {
        let projection = self.scenery.project(surface, body.path.x);
        let speed = -body.path.v.dot(projection.normal);
        let pressed = -body.path.a.dot(projection.normal).min(self.gravity.dot(projection.normal));
        let (law, fastest) = (self.surface_law(index, surface), body.path.v.length());
        let lasts = self.lasts(self.speed_scale(index), law, [speed, fastest, pressed], body.rattles());
        (projection, Approach { speed, fastest, lasts })
    }

    /// The normal towards the first of two marbles, at the clock of both, and how they meet.
    fn meet(&self, [i, j]: [usize; 2], [a, b]: [&Marble; 2]) -> (DVec3, Approach) {
        let offset = a.path.x - b.path.x;
        let distance = offset.length();
        let normal = if distance > 0.0 { offset / distance } else { DVec3::Z };
        let speed = -(a.path.v - b.path.v).dot(normal);
        let fastest = a.path.v.length().max(b.path.v.length());
        let pressed = -(a.path.a - b.path.a).dot(normal);
        let (scale, law) = (self.speed_scale(i).min(self.speed_scale(j)), self.pair_law(i, j));
        let lasts = self.lasts(scale, law, [speed, fastest, pressed], a.rattles() || b.rattles());
        (normal, Approach { speed, fastest, lasts })
    }

    /// Whether an impact begins lasting contact: its rebound would be unseen, or its approach is lost in rounding. It
    /// takes the speed of approach, that of the faster body, and the acceleration with which they are pressed together.
    fn lasts(&self, scale: f64, law: &Law, [speed, fastest, pressed]: [f64; 3], rattles: bool) -> bool {
        let rebound = law.restitution * speed;
        rattles && law.restitution < 1.0
            || rebound <= self.settle_speed(scale, law).max(GRAZE * fastest)
            || self.is_unseen(scale, rebound, pressed)
    }

    /// Whether a rebound is too low to be seen at any preset. A body pressed on at `pressed` m/s² rises by v²/(2 ·
    /// pressed).
    fn is_unseen(&self, scale: f64, rebound: f64, pressed: f64) -> bool {
        let height = ROUNDING.min(0.5 * self.accuracy.settle * self.accuracy.settle);
        // The square of the scale is gravity times radius.
        pressed > 0.0 && rebound * rebound * self.strength <= 2.0 * height * pressed * scale * scale
    }

    /// An order of centres along which loads travel upwards, and which does not depend on labels.
    pub(super) fn bottom_first(&self, a: DVec3, b: DVec3) -> Ordering {
        let key = |x: DVec3| [-self.gravity.dot(x), x.x, x.y, x.z];
        let (p, q) = (key(a), key(b));
        p.iter().zip(&q).map(|(s, t)| s.total_cmp(t)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
    }

    pub(crate) fn surface_law(&self, index: usize, surface: Surface) -> &Law {
        self.laws.of(self.specs[index].material, self.scenery.material(surface))
    }

    pub(crate) fn pair_law(&self, i: usize, j: usize) -> &Law {
        self.laws.of(self.specs[i].material, self.specs[j].material)
    }
}

/// Approach over the speed of the faster body that is lost in rounding. Dimensionless; default 1e-12, a few thousand
/// rounding errors.
const GRAZE: f64 = 1e-12;

/// Two things about to collide.
#[derive(Clone, Copy)]
struct Approach {
    /// Normal relative speed in m/s.
    speed: f64,
    /// Speed of the faster of both.
    fastest: f64,
    /// Whether their contact lasts from then on.
    lasts: bool,
}

/// A law, without rebound if the contact lasts.
fn used(law: &Law, lasting: bool) -> Law {
    if lasting { Law { restitution: 0.0, ..*law } } else { *law }
}

impl Mechanics for Marbles {
    type Body = Marble;
    type Scratch = MarbleScratch;

    fn len(&self) -> usize {
        self.specs.len()
    }

    fn duration(&self) -> f64 {
        self.duration
    }

    fn event_budget(&self) -> u64 {
        self.accuracy.events * self.specs.len() as u64
    }

    #[inline]
    fn clock(&self, body: &Marble) -> f64 {
        body.path.t
    }

    #[inline]
    fn expiry(&self, body: &Marble) -> f64 {
        body.expiry
    }

    #[inline]
    fn is_present(&self, body: &Marble) -> bool {
        body.phase != Phase::Waiting
    }

    #[inline]
    fn is_resting(&self, body: &Marble) -> bool {
        body.phase == Phase::Rest
    }

    fn is_finite(&self, body: &Marble) -> bool {
        body.path.x.is_finite()
            && body.path.v.is_finite()
            && body.path.a.is_finite()
            && body.spin.is_finite()
            && !body.expiry.is_nan()
    }

    #[inline]
    fn advance(&self, _index: usize, body: &mut Marble, time: f64) {
        body.advance(time);
    }

    /// Bottom first, then by position.
    fn order(&self, [i, j]: [u32; 2], [a, b]: [&Marble; 2]) -> Ordering {
        self.bottom_first(a.path.x, b.path.x).then(i.cmp(&j))
    }

    #[inline]
    fn swept(&self, index: usize, body: &Marble, from: f64, until: f64) -> Aabb {
        // Grown a little beyond the radius, so that rounding cannot hide a touching pair.
        body.path.bounds(from - body.path.t, until - body.path.t).grown(self.specs[index].radius * (1.0 + 1e-9))
    }

    #[inline]
    fn first_surface(&self, index: usize, body: &Marble, until: f64) -> Option<(f64, Surface)> {
        if matches!(body.phase, Phase::Rest | Phase::Spin) {
            return None;
        }
        let found = detect::next_surface(
            &self.scenery,
            &body.path,
            self.specs[index].radius,
            body.contacts(),
            until - body.path.t,
        )?;
        Some((body.path.t + found.0, found.1))
    }

    #[inline]
    fn first_meeting(&self, [i, j]: [usize; 2], [a, b]: [&Marble; 2], from: f64, until: f64) -> Option<f64> {
        let (reach, horizon) = (self.specs[i].radius + self.specs[j].radius, a.expiry.min(b.expiry).min(self.duration));
        detect::sphere_pair(&a.path, &b.path, reach, [from, until, horizon])
    }

    fn strikes(&self, [i, j]: [usize; 2], [a, b]: [&Marble; 2], linked: bool, time: f64) -> bool {
        let reach = self.specs[i].radius + self.specs[j].radius;
        let apart = (a.path.at(time) - b.path.at(time)).length() - reach;
        if apart > ROUNDING * reach {
            return false;
        }
        let [mut a, mut b] = [*a, *b];
        a.advance(time);
        b.advance(time);
        let (_, met) = self.meet([i, j], [&a, &b]);
        met.speed > GRAZE * met.fastest && !(linked && met.lasts)
    }

    fn strikes_surfaces(&self, index: usize, body: &mut Marble, add: &mut dyn FnMut(Surface)) {
        let speed = body.path.v.length();
        if speed == 0.0 {
            return;
        }
        let (known, radius) = (body.contacts().len(), self.specs[index].radius);
        let mut all = [Surface::Plane(0); 2 * MOST_CONTACTS];
        all[..known].copy_from_slice(body.contacts());
        let mut normals = [DVec3::ZERO; MOST_CONTACTS];
        let mut count = 0;
        let is_struck = |projection: &Projection, met: &Approach, known: bool, others: &[DVec3]| {
            // Faces that are level with each other are one.
            let is_new = others.iter().all(|n| n.cross(projection.normal).length() > ROUNDING);
            met.speed > GRAZE * met.fastest && !(known && met.lasts) && is_new
        };
        for &surface in body.contacts() {
            let (projection, met) = self.meet_surface(index, body, surface);
            if is_struck(&projection, &met, true, &normals[..count]) {
                (normals[count], count) = (projection.normal, count + 1);
                add(surface);
            }
        }
        let mut seen = known;
        while seen < all.len() && count < MOST_CONTACTS {
            let within = ROUNDING * radius / speed;
            let next = detect::next_surface(&self.scenery, &body.path, radius, &all[..seen], within);
            let Some((_, surface)) = next else { return };
            (all[seen], seen) = (surface, seen + 1);
            let (projection, met) = self.meet_surface(index, body, surface);
            if is_struck(&projection, &met, false, &normals[..count]) {
                (normals[count], count) = (projection.normal, count + 1);
                add(surface);
            }
        }
    }

    fn hit_surface(&self, index: usize, body: &mut Marble, surface: Surface, report: &mut dyn FnMut(&Impact)) -> bool {
        let (projection, met) = self.meet_surface(index, body, surface);
        let known = body.contacts().contains(&surface);
        // A new contact whose approach is lost in rounding is taken as one that lasts: settling decides what becomes of
        // it.
        if known && (met.lasts || met.speed <= 0.0) {
            return false;
        }
        let lasting = met.lasts && body.add_contact(surface);
        let mut touch = self.touch(index, body);
        let law = used(self.surface_law(index, surface), lasting);
        let impulse = sphere_impact(&mut touch, &mut Touch::fixed(), projection.normal, &law);
        (body.path.v, body.spin) = (touch.v, touch.w);
        body.note_impact(self.rattle(index));
        let point = body.path.x - projection.normal * self.specs[index].radius;
        let other = Other::Surface(surface);
        report(&Impact {
            time: body.path.t,
            body: index,
            other,
            point,
            normal: projection.normal,
            impulse: impulse.on_first,
            approach: met.speed,
            lasting,
        });
        true
    }

    fn hit_body(
        &self,
        [i, j]: [usize; 2],
        [a, b]: [&mut Marble; 2],
        linked: bool,
        report: &mut dyn FnMut(&Impact),
    ) -> Option<bool> {
        let (normal, met) = self.meet([i, j], [a, b]);
        let (lasting, approach) = (met.lasts, met.speed);
        if linked && (lasting || approach <= 0.0) {
            return None;
        }
        let (mut first, mut second) = (self.touch(i, a), self.touch(j, b));
        let impulse = sphere_impact(&mut first, &mut second, normal, &used(self.pair_law(i, j), lasting));
        (a.path.v, a.spin, b.path.v, b.spin) = (first.v, first.w, second.v, second.w);
        a.note_impact(self.rattle(i));
        b.note_impact(self.rattle(j));
        let point = b.path.x + normal * self.specs[j].radius;
        let other = Other::Body(j);
        report(&Impact { time: a.path.t, body: i, other, point, normal, impulse: impulse.on_first, approach, lasting });
        Some(lasting)
    }

    fn hit_at_once(
        &self,
        meetings: &[Meeting],
        bodies: &mut [Marble],
        links: &mut Links,
        report: &mut dyn FnMut(&Impact),
    ) -> bool {
        let mut all: Vec<usize> = meetings.iter().flat_map(|m| m.bodies()).collect();
        all.sort_unstable();
        all.dedup();
        let at = |k: usize| all.partition_point(|&other| other < k);
        let mut touches: Vec<Touch> = all.iter().map(|&k| self.touch(k, &bodies[k])).collect();
        let mut told = Vec::with_capacity(meetings.len());
        let mut struck = Vec::with_capacity(meetings.len());
        for &meeting in meetings {
            let (normal, met, lasting, law) = match meeting {
                Meeting::Surface(k, surface) => {
                    let (projection, met) = self.meet_surface(k, &bodies[k], surface);
                    let lasting = met.lasts && bodies[k].add_contact(surface);
                    (projection.normal, met, lasting, self.surface_law(k, surface))
                }
                Meeting::Bodies(i, j) => {
                    let (normal, met) = self.meet([i, j], [&bodies[i], &bodies[j]]);
                    if met.lasts {
                        links.insert(i as u32, j as u32);
                    }
                    (normal, met, met.lasts, self.pair_law(i, j))
                }
            };
            let mut ends = meeting.bodies().map(at);
            struck.push(Struck::new(ends.next().unwrap_or(0), ends.next(), normal, used(law, lasting)));
            told.push((met.speed, lasting));
        }
        spheres_at_once(&mut touches, &mut struck);
        for (&k, touch) in all.iter().zip(&touches) {
            (bodies[k].path.v, bodies[k].spin) = (touch.v, touch.w);
            bodies[k].note_impact(self.rattle(k));
        }
        for ((&meeting, s), (approach, lasting)) in meetings.iter().zip(&struck).zip(told) {
            let (body, other, point) = match meeting {
                Meeting::Surface(k, surface) => {
                    (k, Other::Surface(surface), bodies[k].path.x - s.normal * self.specs[k].radius)
                }
                Meeting::Bodies(i, j) => (i, Other::Body(j), bodies[j].path.x + s.normal * self.specs[j].radius),
            };
            let (time, normal, impulse) = (bodies[body].path.t, s.normal, s.impulse);
            report(&Impact { time, body, other, point, normal, impulse, approach, lasting });
        }
        true
    }

    #[inline]
    fn contacts<'b>(&self, body: &'b Marble) -> &'b [Surface] {
        body.contacts()
    }

    fn settle(&self, members: &[u32], bodies: &mut [Marble], links: &mut Links, scratch: &mut MarbleScratch) {
        step::settle(self, members, bodies, links, scratch);
    }

    fn contact_forces(&self, island: &Island<'_, Self>, work: &mut MarbleScratch, each: &mut dyn FnMut(&ContactForce)) {
        self.tell_forces(island, work, each);
    }
}
