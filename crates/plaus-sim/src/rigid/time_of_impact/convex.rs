//! When convex pieces first touch: those of two bodies, or of a body and a fixed part.
//!
//! Along a fixed direction, the height of every point of a body can shrink only so fast: its rate is known, and its
//! acceleration is bounded by what gravity and the body's rotation can do. The lowest of the heights
//! `p·n + (p·(n × ω) + n·v) τ` is minus the support function in the direction `−(n + τ n × ω)`. So two support
//! functions give a lower bound on the gap of two pieces along the normal of their nearest points, whatever the pieces
//! are. The bound is concave in τ, and its first root cannot be overshot. The bodies are advanced by the least of those
//! roots (conservative advancement: Mirtich, *Impulse-based Dynamic Simulation* (1996), ch. 2.3, here of second order).
//!
//! Bodies in lasting contact are looked at in another way (`new_contacts.rs`).

use super::advancement::{Advance, PairCache, PairCaches, free_flight_bound};
use super::advancement::{PosePair, SeparationBound};
use crate::rigid::BodyDef;
use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::rigid::motion::free_rotation::FreeRotation;
use crate::rigid::narrow_phase::contact_id::ContactId;
use crate::rigid::narrow_phase::convex_contacts::for_elements;
use crate::rigid::narrow_phase::ground::StaticGeometry;
use crate::rigid::narrow_phase::seams::are_real;
use crate::rigid::tolerances::{
    BELOW_TRIANGLE_ADVANCE, FEW_PIECES, LEAST_CONVEX_ADVANCE, MAX_CONVEX_ADVANCES, SEPARATING_AXIS_DISTANCE,
    STATIC_LOOKAHEAD,
};
use crate::roots::earliest;
use crate::shape::convex_pair::{Both, Mark, Meeting, nearest_from};
use crate::special_case::SpecialCase;
use glam::{DMat3, DVec3};

/// What a body may touch.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ImpactTarget<'w> {
    Body(&'w BodyDef, &'w RigidBodyState),
    Ground(StaticGeometry<'w>),
}

/// A search for the first contact of a body with another, or with a part.
pub(crate) struct TimeOfImpact<'w> {
    pub(crate) spec: &'w BodyDef,
    pub(crate) body: &'w RigidBodyState,
    pub(crate) target: ImpactTarget<'w>,
    /// Gap at which they touch, in m.
    pub(crate) level: f64,
    pub(crate) from: f64,
    pub(crate) until: f64,
    /// Whether they are in lasting contact.
    pub(crate) linked: bool,
    /// Pieces of the part that are left out, in ascending order.
    pub(crate) skip: &'w [u32],
}

impl TimeOfImpact<'_> {
    pub(super) fn other(&self) -> Option<(&BodyDef, &RigidBodyState)> {
        match self.target {
            ImpactTarget::Body(spec, body) => Some((spec, body)),
            ImpactTarget::Ground(_) => None,
        }
    }

    /// The first touch in `[from, until]` while approaching, and its points.
    pub(crate) fn first(&self) -> Option<(f64, ContactId)> {
        let mut rotations =
            [Some(self.body.free_rotation(self.spec)), self.other().map(|(spec, body)| body.free_rotation(spec))];
        if self.linked {
            return self.first_new_contact(&mut rotations);
        }
        let collider = DVec3::ZERO;
        let (gravity, other_reach) = self.other().map_or((self.body.path.a.length(), 0.0), |(s, b)| {
            ((self.body.path.a - b.path.a).length(), s.bounding_radius)
        });
        let swing =
            [self.body.fastest(self.spec, self.until), self.other().map_or(0.0, |(s, b)| b.fastest(s, self.until))];
        let bounding_radius = self.spec.bounding_radius + other_reach;
        let turning = |w: f64, s: &BodyDef| w * w * (1.0 + s.anisotropy) * s.bounding_radius;
        let m = gravity + turning(swing[0], self.spec) + self.other().map_or(0.0, |(s, _)| turning(swing[1], s));
        let (longest, gain) = ((bounding_radius / gravity).sqrt(), (gravity * bounding_radius).sqrt());
        let mut time = self.from;
        let mut window: Option<(f64, Vec<u32>)> = None;
        let mut last = None;
        let mut caches = PairCaches::new(longest);
        if let Some((other, _)) = self.other() {
            caches.all.resize(self.spec.pieces.len() * other.pieces.len(), PairCache::UNKNOWN);
        }
        for _ in 0..MAX_CONVEX_ADVANCES {
            if let Some((_, b)) = self.other() {
                let offset = self.body.path.at(time) - b.path.at(time);
                let away = offset.length() - bounding_radius - self.level;
                if away > 0.0 {
                    time += free_flight_bound([self.body, b], time, away, self.level, gravity);
                    if time >= self.until || time.is_nan() {
                        return None;
                    }
                    continue;
                }
            }
            let scene = self.scene(&mut rotations, time);
            let relative = scene.a.v - self.other().map_or(collider, |_| scene.b.v);
            let speed = relative.length() + (swing[0] * self.spec.bounding_radius + swing[1] * other_reach) + gain;
            let mut next = Advance { step: longest.min(self.until - time), struck: None, nearest: None };
            if let ImpactTarget::Ground(StaticGeometry::Collider(ground)) = self.target {
                if window.as_ref().is_none_or(|w| time >= w.0) {
                    let end = (time + STATIC_LOOKAHEAD * bounding_radius / speed).min(self.until);
                    let start = self.body.path.t;
                    let swept = self.body.path.bounds(time - start, end - start);
                    let mut near = window.take().map_or_else(Vec::new, |w| w.1);
                    ground.meeting(&swept.grown(self.spec.bounding_radius * (1.0 + 1e-9) + self.level), &mut near);
                    window = Some((end, near));
                }
                if let Some((end, _)) = window {
                    next.step = next.step.min(end - time);
                }
            }
            let near = window.as_ref().map_or(&[][..], |w| &w.1);
            self.look(&scene, time, near, (speed, m), &mut caches, &mut next);
            if let Some((_, id)) = next.struck {
                return Some((time, id));
            }
            last = next.nearest.map(|n| n.1).or(last);
            // Nothing that touches approaches: an overlap may at most double until then.
            let least = self.slack(next.nearest.map_or(0.0, |n| n.0));
            time += next.step.max(least / speed.max(f64::MIN_POSITIVE));
            if time >= self.until || time.is_nan() {
                return None;
            }
        }
        last.or_else(|| self.lowest(&mut rotations, time)).map(|id| (time, id))
    }

    /// How much nearer points with this gap may come between two looks if none of them approaches: an overlap may at
    /// most double.
    fn slack(&self, gap: f64) -> f64 {
        (LEAST_CONVEX_ADVANCE * self.level).max((-gap).min(BELOW_TRIANGLE_ADVANCE * self.spec.size))
    }

    /// How much nearer a body may come before it is examined anew. In an overlap the answer is hardly any: while its
    /// deepest points come out, others may go deeper, and each bounce inside would enlarge the overlap.
    pub(super) fn room(&self, gap: f64) -> f64 {
        (gap - 0.5 * self.level).max(LEAST_CONVEX_ADVANCE * self.level)
    }

    /// The lowest point of the body over a plane.
    fn lowest(&self, rotations: &mut [Option<FreeRotation>; 2], time: f64) -> Option<ContactId> {
        let ImpactTarget::Ground(StaticGeometry::Flat(plane)) = self.target else { return None };
        let (r, mut low, mut lowest) = (self.scene(rotations, time).a.r, f64::INFINITY, None);
        for (own, piece) in self.spec.pieces.iter().enumerate() {
            let first = piece.placed(&r, DVec3::ZERO);
            for_elements(piece, plane.face, first.axes.transpose() * -plane.normal, |mark, at| {
                let height = plane.normal.dot(first.centre + first.axes * at) - piece.rounding;
                if height < low {
                    (low, lowest) = (height, Some(ContactId { own: own as u8, other: plane.piece, mark }));
                }
            });
        }
        lowest
    }

    pub(super) fn scene(&self, rotations: &mut [Option<FreeRotation>; 2], time: f64) -> PosePair {
        let none = Pose { x: DVec3::ZERO, r: DMat3::IDENTITY, v: DVec3::ZERO, w: DVec3::ZERO };
        let mut pose = |k: usize, spec: &BodyDef, b: &RigidBodyState| {
            rotations[k].as_mut().map_or(none, |rotation| b.pose_at(spec, rotation, time))
        };
        let a = pose(0, self.spec, self.body);
        let b = self.other().map_or(none, |(spec, body)| pose(1, spec, body));
        PosePair { a, b }
    }

    /// Examines all pairs of pieces.
    fn look<'s>(
        &'s self,
        scene: &PosePair,
        time: f64,
        near: &[u32],
        (speed, m): (f64, f64),
        caches: &mut PairCaches<'s>,
        next: &mut Advance,
    ) {
        let mut aside = Vec::new();
        if let ImpactTarget::Ground(StaticGeometry::Collider(collider)) = self.target
            && self.spec.pieces.len() > FEW_PIECES
        {
            aside.extend(near.iter().copied().filter(|&other| self.is_capsule_off(scene, collider, other, m, next)));
        }
        let soon = caches.begin(time, next.step);
        let PairCaches { all, seconds, longest, .. } = caches;
        for (own, piece) in self.spec.pieces.iter().enumerate() {
            match self.target {
                ImpactTarget::Ground(StaticGeometry::Flat(plane)) => {
                    let first = piece.placed(&scene.a.r, DVec3::ZERO);
                    let n = plane.normal;
                    let gap = plane.distance(scene.a.x) - first.support(-n) - piece.rounding;
                    if gap <= self.level {
                        let down = first.axes.transpose() * -n;
                        for_elements(piece, plane.face, down, |mark, at| {
                            let p = first.centre + first.axes * at - n * piece.rounding;
                            let rate = scene.a.velocity(p).dot(n);
                            if plane.distance(scene.a.x) + n.dot(p) <= self.level {
                                next.touches(rate, ContactId { own: own as u8, other: plane.piece, mark });
                            }
                        });
                    }
                    let bound = SeparationBound::new(self.room(gap), n, m, scene);
                    let p = first.farthest(-n);
                    let rate = scene.a.velocity(p).dot(n);
                    next.step = next.step.min(bound.root(rate, next.step, |d| first.support(d), |_| 0.0));
                }
                ImpactTarget::Ground(StaticGeometry::Arc(arc)) => {
                    self.examine_arc(&scene.a, (own, piece), arc, (speed, m), next);
                }
                ImpactTarget::Ground(StaticGeometry::Collider(collider)) => {
                    let middle = scene.a.x + scene.a.r * piece.at;
                    for &other in near
                        .iter()
                        .filter(|&&other| !aside.contains(&other) && self.skip.binary_search(&other).is_err())
                    {
                        let away = collider.distance(other, middle) - piece.bounding_radius - self.level;
                        if !self.is_off(away, (speed, m), next) {
                            let both = collider.both(piece, other, &scene.a);
                            self.pair(scene, own, other, &both, (speed, m), PairCache::UNKNOWN, next);
                        }
                    }
                }
                ImpactTarget::Body(spec, _) => {
                    let shift = scene.b.x - scene.a.x;
                    seconds.resize(spec.pieces.len(), None);
                    let mut first = None;
                    for (other, theirs) in spec.pieces.iter().enumerate() {
                        next.examine(
                            &mut all[own * spec.pieces.len() + other],
                            [time, soon, *longest],
                            |next, cache| {
                                let first = *first.get_or_insert_with(|| piece.placed(&scene.a.r, DVec3::ZERO));
                                let second = *seconds[other].get_or_insert_with(|| theirs.placed(&scene.b.r, shift));
                                let both = Both { first, second };
                                let away = (first.centre - second.centre).length() - both.size() - self.level;
                                if self.is_off(away, (speed, m), next) {
                                    return PairCache { until: f64::INFINITY, ..cache };
                                }
                                self.pair(scene, own, other as u32, &both, (speed, m), cache, next)
                            },
                        );
                    }
                }
            }
        }
    }

    /// Whether pieces whose spheres or boxes are this far apart need no closer look.
    fn is_off(&self, away: f64, (speed, m): (f64, f64), next: &mut Advance) -> bool {
        if away <= 0.0 {
            return false;
        }
        let safe = earliest(away, -speed, m);
        if safe < next.step && away <= self.spec.size {
            return false;
        }
        next.step = next.step.min(safe);
        true
    }

    /// Examines one pair of pieces; `last` is what the last look found. Returns what this one finds.
    #[allow(clippy::too_many_arguments, reason = "one look at one pair")]
    fn pair(
        &self,
        scene: &PosePair,
        own: usize,
        other: u32,
        both: &Both,
        (speed, m): (f64, f64),
        last: PairCache,
        next: &mut Advance,
    ) -> PairCache {
        let shift = scene.b.x - scene.a.x;
        let collider = if let ImpactTarget::Ground(StaticGeometry::Collider(collider)) = self.target {
            Some(collider)
        } else {
            None
        };
        match collider.and_then(|s| s.over_plane(other, both)) {
            // It may come out from behind the plane at any time.
            Some(None) => return PairCache::UNKNOWN,
            Some(Some(low)) if low > self.level => {
                self.over_facet(scene, other, both, m, next);
                return PairCache::APART;
            }
            _ => {}
        }
        let second = |d: DVec3| if self.other().is_some() { both.second.support(d) - shift.dot(d) } else { 0.0 };
        if SpecialCase::BestAxis.is_on() && self.facet(other).is_none() && last.mark.is_none() {
            let (gap, n) = both.separated();
            if gap > SEPARATING_AXIS_DISTANCE * self.spec.size {
                let rate = self.rate_of([both.first.farthest(-n), both.second.farthest(n)], n, scene, shift);
                let bound = SeparationBound::new(self.room(gap), n, m, scene);
                next.step = next.step.min(bound.root(rate, next.step, |d| both.first.support(d), second));
                return PairCache { along: n, ..PairCache::APART };
            }
        }
        let found = nearest_from(both, last.mark, last.along);
        let rate = |m: &Meeting| self.rate(scene, m, shift);
        let id = |mark: Mark| ContactId { own: own as u8, other, mark };
        if next.nearest.is_none_or(|n| found.gap < n.0) {
            next.nearest = Some((found.gap, id(found.mark)));
        }
        let mut is_one = found.gap > self.level;
        let mut touch = |m: &Meeting| {
            is_one = true;
            next.touches(rate(m), id(m.mark));
        };
        if found.gap <= self.level {
            match collider {
                Some(collider) => collider.for_touching(other, both, scene.a.x, self.level, touch),
                None => both.touching(&found, self.level, |m| {
                    if self.is_real(scene, [own, other as usize], &m) {
                        touch(&m);
                    }
                }),
            }
        } else if let Some(collider) = collider {
            // Beyond a hollow edge of a triangle, farther from the triangle than from its plane.
            collider.for_over(other, both, scene.a.x, self.level, &mut touch);
        }
        if !is_one {
            // The part beside the triangle is nearer, or this is a seam: what is there is felt by the pieces beside it.
            if self.facet(other).is_none() || self.over_facet(scene, other, both, m, next) {
                next.step = next.step.min(self.behind(scene, [own, other as usize], both, &found, (speed, m)));
            }
            return PairCache::UNKNOWN;
        }
        let found = if found.gap <= self.level { both.level(found, self.level) } else { found };
        let bound = SeparationBound::new(self.room(found.gap), found.normal, m, scene);
        next.step = next.step.min(bound.root(rate(&found), next.step, |d| both.first.support(d), second));
        // Of pieces that overlap, no direction proves that they touch at no other point.
        let kept = if found.gap > self.level { PairCache::APART } else { PairCache::UNKNOWN };
        PairCache { along: found.normal, mark: Some(found.mark), ..kept }
    }

    /// Whether a point of two bodies' pieces is no point of a seam of either.
    pub(crate) fn is_real(&self, scene: &PosePair, [own, other]: [usize; 2], m: &Meeting) -> bool {
        let ImpactTarget::Body(spec, _) = self.target else { return true };
        are_real([self.spec, spec], [&scene.a, &scene.b], [own, other], m)
    }

    /// For how long pieces whose nearest points are no contact can touch nowhere else: by the points up to some
    /// distance behind those, each at its rate.
    fn behind(
        &self,
        scene: &PosePair,
        [own, other]: [usize; 2],
        both: &Both,
        found: &Meeting,
        (speed, m): (f64, f64),
    ) -> f64 {
        let within = BELOW_TRIANGLE_ADVANCE * self.spec.size;
        let mut step = within / speed.max(f64::MIN_POSITIVE);
        let shift = scene.b.x - scene.a.x;
        let mut take = |p: &Meeting| step = step.min(earliest(self.room(p.gap), self.rate(scene, p, shift), m));
        match self.target {
            ImpactTarget::Ground(StaticGeometry::Collider(collider)) => {
                collider.for_touching(other as u32, both, scene.a.x, within, take);
            }
            _ => both.touching(found, within, |p| {
                if self.is_real(scene, [own, other], &p) {
                    take(&p);
                }
            }),
        }
        step
    }

    /// The plane of a triangle says when the triangle can be touched; returns whether it does not, as the body is below
    /// it, beside the triangle.
    fn over_facet(&self, scene: &PosePair, other: u32, both: &Both, m: f64, next: &mut Advance) -> bool {
        let Some(facet) = self.facet(other) else { return false };
        let p = both.first.farthest(-facet) - facet * both.first.rounding;
        let gap = facet.dot(p - both.second.centre);
        let rate = scene.a.velocity(p).dot(facet);
        if gap <= 0.5 * self.level && rate <= 0.0 {
            return true;
        }
        let bound = SeparationBound::new(self.room(gap), facet, m, scene);
        next.step = next.step.min(bound.root(rate, next.step, |d| both.first.support(d), |_| 0.0));
        false
    }

    pub(crate) fn rate(&self, scene: &PosePair, m: &Meeting, shift: DVec3) -> f64 {
        self.rate_of(m.points, m.normal, scene, shift)
    }

    /// How fast two points part along a normal.
    fn rate_of(&self, [p, q]: [DVec3; 2], normal: DVec3, scene: &PosePair, shift: DVec3) -> f64 {
        let other = if self.other().is_some() { scene.b.velocity(q - shift) } else { DVec3::ZERO };
        (scene.a.velocity(p) - other).dot(normal)
    }

    fn facet(&self, other: u32) -> Option<DVec3> {
        match self.target {
            ImpactTarget::Ground(StaticGeometry::Collider(collider)) => collider.facet(other),
            _ => None,
        }
    }
}
