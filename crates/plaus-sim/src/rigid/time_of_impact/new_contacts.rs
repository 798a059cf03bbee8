//! When convex pieces in lasting contact touch at a new point.
//!
//! They are examined [`CONVEX_LOOKS_PER_STEP`] times within a step, for points away from the contacts of the step, as
//! the steps deal with those contacts, and for points beside them that are deeper than the steps know.

use super::advancement::PosePair;
use super::convex::{ImpactTarget, TimeOfImpact};
use crate::rigid::motion::free_rotation::FreeRotation;
use crate::rigid::narrow_phase::contact_id::ContactId;
use crate::rigid::narrow_phase::convex_contacts::for_elements;
use crate::rigid::narrow_phase::ground::StaticGeometry;
use crate::rigid::tolerances::{
    CONTACT_MARGIN, CONVEX_LOOK_AT_ONCE, CONVEX_LOOK_CLOSE, CONVEX_LOOK_HALVINGS, CONVEX_LOOKS_PER_STEP, HELD_DISTANCE,
    HELD_NORMAL_COSINE, HELD_RIM_DISTANCE,
};
use crate::shape::convex_pair::{Both, Meeting, nearest};
use crate::shape::piece::Core;
use glam::DVec3;

/// A point of a lasting contact: its place and normal, its name, and the rim it belongs to.
struct HeldContact {
    at: [DVec3; 2],
    id: ContactId,
    rim: Option<(u8, u8, f64)>,
}

/// A point at which two bodies touch, or nearly so.
#[derive(Debug, Clone, Copy)]
struct NewContact {
    /// Its position from the first body's centre of gravity, and its normal.
    at: [DVec3; 2],
    gap: f64,
    rate: f64,
    id: ContactId,
    /// Its gap, or near a lasting contact how much farther it is than it may be there: see [`TimeOfImpact::room_at`].
    room: f64,
}

impl TimeOfImpact<'_> {
    /// For bodies in lasting contact: looks within the step for a point that is not part of the contact.
    pub(super) fn first_new_contact(&self, rotations: &mut [Option<FreeRotation>; 2]) -> Option<(f64, ContactId)> {
        let (mut near, mut held) = (Vec::new(), Vec::new());
        let scene = self.scene(rotations, self.from);
        self.for_points(&scene, &mut near, CONTACT_MARGIN * self.level, &mut |p| held.push(self.held(&p)));
        let mut newest = |time: f64, held: &[HeldContact]| {
            let scene = self.scene(rotations, time);
            let mut new: Option<NewContact> = None;
            self.for_points(&scene, &mut near, 0.5 * self.level, &mut |p| {
                if p.rate < 0.0
                    && new.is_none_or(|n| p.rate < n.rate)
                    && let Some(room) = self.room_at(&scene, held, &p)
                {
                    new = Some(NewContact { room, ..p });
                }
            });
            new
        };
        let (mut low, mut looks) = (self.from, 1);
        while looks <= CONVEX_LOOKS_PER_STEP {
            let mut high = self.from + (self.until - self.from) * (f64::from(looks) / f64::from(CONVEX_LOOKS_PER_STEP));
            let Some(mut found) = newest(high, &held) else {
                (low, looks) = (high, looks + 1);
                continue;
            };
            if low == self.from {
                let soon = low + CONVEX_LOOK_AT_ONCE * (high - low);
                match newest(soon, &held) {
                    Some(f) if f.room - f.rate * (soon - low) <= 0.5 * self.level => {
                        // It touched at the start. Of pieces that overlap, only the deepest point is listed, and which
                        // one that is may change with each look.
                        held.push(self.held(&f));
                        continue;
                    }
                    Some(f) => (high, found) = (soon, f),
                    None => low = soon,
                }
            }
            // Until it just touches: where its rate says, or half way.
            let [least, aim] = [1.0, 0.5].map(|part| 0.5 * self.level * (1.0 - part * CONVEX_LOOK_CLOSE));
            for round in 0..CONVEX_LOOK_HALVINGS {
                if found.room >= least {
                    break;
                }
                let touches = high + (aim - found.room) / found.rate;
                let middle = if round % 2 == 0 && touches > low { touches } else { 0.5 * (low + high) };
                match newest(middle, &held) {
                    Some(f) => (high, found) = (middle, f),
                    None => low = middle,
                }
            }
            return Some((high, found.id));
        }
        None
    }

    fn held(&self, p: &NewContact) -> HeldContact {
        HeldContact { at: p.at, id: p.id, rim: self.rim(p.id) }
    }

    /// The rim that a point belongs to: piece, ring and radius.
    fn rim(&self, id: ContactId) -> Option<(u8, u8, f64)> {
        let core = &self.spec.pieces[usize::from(id.own)].core;
        let (ring, _) = id.mark.own_rim(core)?;
        let Core::Discs(discs) = core else { return None };
        Some((id.own, ring, discs.radii[usize::from(ring)]))
    }

    /// The gap of a point that is not part of a lasting contact; of one near such a contact, how much farther it is
    /// than it may be there; `None` of a point that is part of it. A rim that leans rolls on one point, which runs
    /// around it. Steps keep the points that they know out of what these touch; a point that is deeper than they are,
    /// by the gap up to which points touch, is another one.
    fn room_at(&self, scene: &PosePair, held: &[HeldContact], p: &NewContact) -> Option<f64> {
        let (usual, rim) = (HELD_DISTANCE * self.spec.size, self.rim(p.id));
        let is_near = |h: &&HeldContact| {
            let reach =
                if rim == h.rim { rim.map_or(usual, |rim| usual.max(HELD_RIM_DISTANCE * rim.2)) } else { usual };
            (h.at[0] - p.at[0]).length_squared() <= reach * reach && h.at[1].dot(p.at[1]) >= HELD_NORMAL_COSINE
        };
        let mut near = held.iter().filter(is_near).peekable();
        if near.peek().is_none() {
            return Some(p.gap);
        }
        let (touching, least) = (0.5 * self.level, CONTACT_MARGIN * self.level);
        if p.gap + least > touching {
            return None;
        }
        let deepest = near.map(|h| self.gap_again(scene, h.id, p.at[1])).fold(0.0, f64::min);
        Some(p.gap + least - deepest).filter(|&room| room <= touching)
    }

    /// The gap of a point with a name. `normal` is about its own.
    fn gap_again(&self, scene: &PosePair, id: ContactId, normal: DVec3) -> f64 {
        match self.target {
            ImpactTarget::Ground(geometry) => geometry.again(self.spec, &scene.a, id).gap,
            ImpactTarget::Body(spec, _) => {
                let first = self.spec.pieces[usize::from(id.own)].placed(&scene.a.r, DVec3::ZERO);
                let second = spec.pieces[id.other as usize].placed(&scene.b.r, scene.b.x - scene.a.x);
                let both = Both { first, second };
                let is_ball = self.spec.is_ball || spec.is_ball;
                if is_ball { nearest(&both) } else { both.again(id.mark, normal) }.gap
            }
        }
    }

    /// Calls `each` for all points within a gap.
    fn for_points(&self, scene: &PosePair, near: &mut Vec<u32>, within: f64, each: &mut dyn FnMut(NewContact)) {
        let shift = scene.b.x - scene.a.x;
        for (own, piece) in self.spec.pieces.iter().enumerate() {
            let mut take = |other: u32, m: &Meeting| {
                let id = ContactId { own: own as u8, other, mark: m.mark };
                each(NewContact {
                    at: [m.points[0], m.normal],
                    gap: m.gap,
                    rate: self.rate(scene, m, shift),
                    id,
                    room: m.gap,
                });
            };
            match self.target {
                ImpactTarget::Ground(StaticGeometry::Flat(plane)) => {
                    let (first, n) = (piece.placed(&scene.a.r, DVec3::ZERO), plane.normal);
                    for_elements(piece, plane.face, first.axes.transpose() * -n, |mark, at| {
                        let p = first.centre + first.axes * at - n * piece.rounding;
                        let gap = plane.distance(scene.a.x) + n.dot(p);
                        if gap <= within {
                            let (rate, id) =
                                (scene.a.velocity(p).dot(n), ContactId { own: own as u8, other: plane.piece, mark });
                            each(NewContact { at: [p, n], gap, rate, id, room: gap });
                        }
                    });
                }
                ImpactTarget::Ground(StaticGeometry::Arc(arc)) => {
                    self.for_arc_points(&scene.a, (own, piece), arc, within, |id, m, rate| {
                        each(NewContact { at: [m.points[0], m.normal], gap: m.gap, rate, id, room: m.gap });
                    });
                }
                ImpactTarget::Ground(StaticGeometry::Collider(collider)) => {
                    let middle = scene.a.x + scene.a.r * piece.at;
                    collider.near(middle, piece.bounding_radius + within, near);
                    for &other in &*near {
                        if !collider.is_far(other, middle, piece.bounding_radius + within)
                            && self.skip.binary_search(&other).is_err()
                        {
                            let both = collider.both(piece, other, &scene.a);
                            collider.for_touching(other, &both, scene.a.x, within, |m| take(other, m));
                        }
                    }
                }
                ImpactTarget::Body(spec, _) => {
                    let first = piece.placed(&scene.a.r, DVec3::ZERO);
                    for (other, theirs) in spec.pieces.iter().enumerate() {
                        let both = Both { first, second: theirs.placed(&scene.b.r, shift) };
                        let away = (first.centre - both.second.centre).length() - both.size();
                        if away <= within && !both.are_beyond(within) {
                            both.touching(&nearest(&both), within, |m| {
                                if self.is_real(scene, [own, other], &m) {
                                    take(other as u32, &m);
                                }
                            });
                        }
                    }
                }
            }
        }
    }
}
