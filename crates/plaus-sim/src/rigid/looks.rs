//! When convex pieces in lasting contact touch at a new point.
//!
//! They are examined [`LOOKS`] times within a step, for points away from the contacts of the step: the steps deal with
//! those contacts.

use super::bound::Scene;
use super::hunt::{Hunt, Target};
use super::scratch::TOUCHING;
use super::spots::for_elements;
use super::still::Ground;
use super::touch::Spot;
use super::tumble::Tumble;
use crate::shape::convex_pair::{Both, Meeting, nearest};
use crate::shape::piece::Core;
use glam::DVec3;

/// Number of times that bodies in lasting contact are examined within one of their steps. Default 8.
const LOOKS: u32 = 8;

/// Halvings of the time between two such times.
const HALVINGS: usize = 12;

/// Distance over the size within which a point counts as part of the lasting contact. Default 0.25.
const PART_OF_IT: f64 = 0.25;

/// The same for points of a rim, over its radius. Default 0.5: far more than a rim rolls in one step.
const PART_OF_RIM: f64 = 0.5;

/// Least cosine of the angle between the normals of points that are part of one contact. Default 0.995.
const ALIKE: f64 = 0.995;

/// A point of a lasting contact: its place and normal, and the rim it belongs to.
struct Held {
    at: [DVec3; 2],
    rim: Option<(u8, u8, f64)>,
}

/// A point at which two bodies touch, or nearly so.
#[derive(Debug, Clone, Copy)]
struct Seen {
    /// Its position from the first body's centre of gravity, and its normal.
    at: [DVec3; 2],
    gap: f64,
    rate: f64,
    spot: Spot,
}

impl Hunt<'_> {
    /// For bodies in lasting contact: looks within the step for a point that is not part of the contact.
    pub(super) fn looked(&self, tumbles: &mut [Option<Tumble>; 2]) -> Option<(f64, Spot)> {
        let (mut near, mut held) = (Vec::new(), Vec::new());
        let scene = self.scene(tumbles, self.from);
        self.for_points(&scene, &mut near, TOUCHING * self.level, |p| held.push(self.held(&p)));
        if self.stays_above(&scene, &held) {
            return None;
        }
        let mut newest = |time: f64, held: &[Held]| {
            let scene = self.scene(tumbles, time);
            let mut new: Option<Seen> = None;
            self.for_points(&scene, &mut near, 0.5 * self.level, |p| {
                let is_new = || !self.is_part(held, p.at, p.spot, 0.0);
                if p.rate < 0.0 && new.is_none_or(|n| p.rate < n.rate) && is_new() {
                    new = Some(p);
                }
            });
            new
        };
        let (mut low, mut looks) = (self.from, 1);
        while looks <= LOOKS {
            let mut high = self.from + (self.until - self.from) * (f64::from(looks) / f64::from(LOOKS));
            let Some(mut found) = newest(high, &held) else {
                (low, looks) = (high, looks + 1);
                continue;
            };
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                match newest(middle, &held) {
                    Some(f) => (high, found) = (middle, f),
                    None => low = middle,
                }
            }
            if low == self.from && found.gap - found.rate * (high - low) <= 0.5 * self.level {
                // It touched at the start. Of pieces that overlap, only the deepest point is listed, and which one that
                // is may change with each look.
                held.push(self.held(&found));
                continue;
            }
            return Some((high, found.spot));
        }
        None
    }

    fn held(&self, p: &Seen) -> Held {
        Held { at: p.at, rim: self.rim(p.spot) }
    }

    /// The rim that a point belongs to: piece, ring and radius.
    fn rim(&self, spot: Spot) -> Option<(u8, u8, f64)> {
        let core = &self.spec.pieces[usize::from(spot.own)].core;
        let (ring, _) = spot.mark.own_rim(core)?;
        let Core::Discs(discs) = core else { return None };
        Some((spot.own, ring, discs.radii[usize::from(ring)]))
    }

    /// Whether a point is part of a lasting contact, and is so until it has moved by `turn`. A rim that leans rolls on
    /// one point, which runs around it.
    fn is_part(&self, held: &[Held], [p, n]: [DVec3; 2], spot: Spot, turn: f64) -> bool {
        let (usual, rim) = (PART_OF_IT * self.spec.size, self.rim(spot));
        held.iter().any(|Held { at: [h, m], rim: other }| {
            let reach =
                if rim == *other { rim.map_or(usual, |rim| usual.max(PART_OF_RIM * rim.2)) } else { usual } - turn;
            reach > 0.0 && (*h - p).length_squared() <= reach * reach && m.dot(n) >= ALIKE
        })
    }

    /// Whether the points of a body that are not part of its lasting contact with a plane are too high to come down in
    /// time, or to become part of it.
    fn stays_above(&self, scene: &Scene, held: &[Held]) -> bool {
        let Target::Ground(Ground::Flat(plane)) = self.target else { return false };
        let (n, time) = (plane.normal, self.until - self.from);
        let turn = self.body.fastest(self.spec, self.until) * self.spec.reach * time;
        let sink = (scene.a.v.dot(n).abs() + self.body.path.a.length() * time) * time + turn;
        let (height, mut is_off) = (plane.distance(scene.a.x) - sink - self.level, true);
        for (own, piece) in self.spec.pieces.iter().enumerate() {
            let first = piece.placed(&scene.a.r, DVec3::ZERO);
            for_elements(piece, plane.face, first.axes.transpose() * -n, |mark, at| {
                let p = first.centre + first.axes * at - n * piece.rounding;
                let spot = Spot { own: own as u8, other: plane.piece, mark };
                is_off &= height + n.dot(p) > 0.0 || self.is_part(held, [p, n], spot, turn);
            });
        }
        is_off
    }

    /// Calls `each` for all points within a gap.
    fn for_points(&self, scene: &Scene, near: &mut Vec<u32>, within: f64, mut each: impl FnMut(Seen)) {
        let shift = scene.b.x - scene.a.x;
        for (own, piece) in self.spec.pieces.iter().enumerate() {
            let mut take = |other: u32, m: &Meeting| {
                let spot = Spot { own: own as u8, other, mark: m.mark };
                each(Seen { at: [m.points[0], m.normal], gap: m.gap, rate: self.rate(scene, m, shift), spot });
            };
            match self.target {
                Target::Ground(Ground::Flat(plane)) => {
                    let (first, n) = (piece.placed(&scene.a.r, DVec3::ZERO), plane.normal);
                    for_elements(piece, plane.face, first.axes.transpose() * -n, |mark, at| {
                        let p = first.centre + first.axes * at - n * piece.rounding;
                        let gap = plane.distance(scene.a.x) + n.dot(p);
                        if gap <= within {
                            let (rate, spot) =
                                (scene.a.velocity(p).dot(n), Spot { own: own as u8, other: plane.piece, mark });
                            each(Seen { at: [p, n], gap, rate, spot });
                        }
                    });
                }
                Target::Ground(Ground::Still(still)) => {
                    let middle = scene.a.x + scene.a.r * piece.at;
                    still.near(middle, piece.reach + within, near);
                    for &other in &*near {
                        if !still.is_far(other, middle, piece.reach + within) && !still.facets.has(self.skip, other) {
                            let both = still.both(piece, other, &scene.a);
                            still.for_touching(other, &both, scene.a.x, within, |m| take(other, m));
                        }
                    }
                }
                Target::Body(spec, _) => {
                    for (other, theirs) in spec.pieces.iter().enumerate() {
                        let first = piece.placed(&scene.a.r, DVec3::ZERO);
                        let both = Both { first, second: theirs.placed(&scene.b.r, shift) };
                        let away = (first.centre - both.second.centre).length() - both.size();
                        if away <= within && both.separated().0 <= within {
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
