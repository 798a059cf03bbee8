//! First contact with a curved track: with its front, of a ball in closed form, and with what is behind it.

use super::advancement::Advance;
use super::convex::TimeOfImpact;
use super::static_search::StaticTimeOfImpact;
use crate::rigid::body_state::Pose;
use crate::rigid::narrow_phase::arc::{FRONT, for_arc_elements, on_arc};
use crate::rigid::narrow_phase::contact_id::ContactId;
use crate::rigid::narrow_phase::ground::{StaticGeometry, StaticPieces};
use crate::rigid::narrow_phase::static_collider::StaticCollider;
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{ARC_ENTRY_BISECTIONS, ARC_ENTRY_LOOKS, BELOW_TRIANGLE_ADVANCE};
use crate::roots::{earliest, fall_of_quartic, falls_of_quartic, squared_distance};
use crate::scenery::ArcTrack;
use crate::shape::convex_pair::Meeting;
use crate::shape::piece::Piece;
use crate::special_case::SpecialCase;
use glam::DVec3;

impl StaticTimeOfImpact<'_> {
    pub(crate) fn arc(&mut self, part: u16, (whole, arc): (&StaticShape, &ArcTrack), collider: &StaticCollider) {
        if !collider.bounds().meets(&self.swept) {
            return;
        }
        if self.spec.is_ball && SpecialCase::BallOnArc.is_on() {
            if let Some(time) = self.ball_on_arc(part, arc) {
                self.hit(time, part, 0);
            }
        } else {
            self.pieces(part, StaticPieces::all(StaticGeometry::Arc(arc)), [0.0, self.until]);
        }
        let half = 0.5 * (self.swept.max - self.swept.min);
        if !arc.covers(self.swept.min + half, half.length()) {
            self.solid(part, whole, collider);
        }
    }

    /// When a ball touches the front: its centre then is on a cylinder, and a parabola meets that at the roots of a
    /// quartic.
    fn ball_on_arc(&self, part: u16, arc: &ArcTrack) -> Option<f64> {
        let (spec, form) = (self.spec, arc.form());
        let level = form.radius - spec.bounding_radius - 0.5 * spec.gap;
        if level <= 0.0 || self.lasts(part, 0) {
            return None;
        }
        let path = &self.body.path;
        let flat = |p: DVec3| p.with_y(0.0);
        let (x, v, a) = (flat(arc.place(path.x)), flat(arc.way(path.v)), flat(arc.way(path.a)));
        let beyond = squared_distance(x, v, a, level);
        let (before, until) = (beyond.map(|c| -c), self.until);
        let gap = |at: DVec3| form.radius - arc.normal(at).1 - spec.bounding_radius;
        let is_over = |time: f64| {
            let at = path.after(time);
            arc.is_on((at, path.velocity_after(time)), gap(at), spec.gap)
        };
        let mut beside = Vec::new();
        let found = falls_of_quartic(&before, 0.0, until, |time| {
            let touches = is_over(time);
            if !touches {
                beside.push(time);
            }
            touches
        });
        // Beyond the cylinder but not deep, beside the track, it may come over the track from there.
        let deep = squared_distance(x, v, a, level + 0.5 * form.thickness);
        if before[0] <= 0.0 && deep[0] <= 0.0 {
            beside.push(0.0);
        }
        beside.extend(fall_of_quartic(&deep, 0.0, until));
        let entered = beside.into_iter().filter_map(|time| {
            let until = found.unwrap_or(until).max(time);
            let ends = [fall_of_quartic(&beyond, time, until), fall_of_quartic(&deep.map(|c| -c), time, until)];
            let end = ends.into_iter().flatten().filter(|&end| end > time).fold(until, f64::min);
            let comes = |time: f64| {
                let at = path.after(time);
                let closes = arc.normal(at).0.dot(path.velocity_after(time)) < 0.0;
                closes && gap(at) <= 0.5 * spec.gap && is_over(time)
            };
            let (mut low, looks) = (time, f64::from(ARC_ENTRY_LOOKS));
            let mut high = (1..=ARC_ENTRY_LOOKS).map(|k| time + (end - time) * (f64::from(k) / looks)).find(|&t| {
                let found = comes(t);
                if !found {
                    low = t;
                }
                found
            })?;
            for _ in 0..ARC_ENTRY_BISECTIONS {
                let middle = 0.5 * (low + high);
                if comes(middle) { high = middle } else { low = middle }
            }
            Some(high)
        });
        entered.chain(found).min_by(f64::total_cmp)
    }
}

impl TimeOfImpact<'_> {
    /// Calls `each` for the points of a piece within a gap of the front of a track, with their rates.
    pub(super) fn for_arc_points(
        &self,
        at: &Pose,
        (own, piece): (usize, &Piece),
        arc: &ArcTrack,
        within: f64,
        mut each: impl FnMut(ContactId, &Meeting, f64),
    ) {
        let form = arc.form();
        if piece.rounding >= form.radius {
            return;
        }
        for_arc_elements(arc, at.x, &piece.placed(&at.r, DVec3::ZERO), |mark, p, _| {
            let m = on_arc(arc, at.x, p, piece.rounding, mark);
            if m.gap <= within && arc.is_on((at.x + p, at.velocity(p)), m.gap, self.level) {
                let id = ContactId { own: own as u8, other: FRONT, mark };
                each(id, &m, at.velocity(m.points[0]).dot(m.normal));
            }
        });
    }

    /// Examines a piece over the front of a track. Of a point at the distance `ρ` from the axis, `(R² − ρ²)/2R` falls
    /// no faster than with the acceleration `m + u²/R`, where `u` bounds its speed; it is at most the gap.
    pub(super) fn examine_arc(
        &self,
        at: &Pose,
        (own, piece): (usize, &Piece),
        arc: &ArcTrack,
        (speed, m): (f64, f64),
        next: &mut Advance,
    ) {
        let form = arc.form();
        let radius = form.radius - piece.rounding;
        if radius <= 0.0 {
            return;
        }
        let first = piece.placed(&at.r, DVec3::ZERO);
        // No point of it is nearer than this.
        let away = form.radius - arc.normal(at.x + first.centre).1 - piece.bounding_radius - self.level;
        if away > 0.0 && away > speed * next.step {
            return;
        }
        let bend = m + speed * speed / radius;
        for_arc_elements(arc, at.x, &first, |mark, p, is_rim| {
            let meeting = on_arc(arc, at.x, p, piece.rounding, mark);
            let (gap, id) = (meeting.gap, ContactId { own: own as u8, other: FRONT, mark });
            let (place, velocity) = (at.x + p, at.velocity(p));
            let rate = velocity.dot(meeting.normal);
            if gap <= self.level {
                let (beside, half) = (-arc.inside(place), 0.5 * form.thickness);
                if beside > self.level || gap < -self.level && (gap < beside || gap <= -half) {
                    // Beside the track, or behind it: this is how near it may come to the front until the next look.
                    let least = BELOW_TRIANGLE_ADVANCE * self.spec.size;
                    let away = beside.max(0.5 * (beside - gap)).max(-gap - half).max(least);
                    next.step = next.step.min(away / speed.max(f64::MIN_POSITIVE));
                    next.nearest.get_or_insert((f64::INFINITY, id));
                    return;
                }
                if arc.is_on((place, velocity), gap, self.level) {
                    next.touches(at.velocity(meeting.points[0]).dot(meeting.normal), id);
                }
            }
            if next.nearest.is_none_or(|n| gap < n.0) {
                next.nearest = Some((gap, id));
            }
            let room = self.room(gap);
            let below = room * (1.0 - 0.5 * room / radius);
            // Another point of a rim may come down faster than the lowest.
            let falls = if is_rim { -speed } else { rate * ((radius - gap) / radius).max(0.0) };
            next.step = next.step.min(earliest(below, falls, bend));
        });
    }
}
