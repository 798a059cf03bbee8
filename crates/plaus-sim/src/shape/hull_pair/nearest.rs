//! The distance of two polyhedra.
//!
//! Cores that are apart are best separated along a face's normal or along the common perpendicular of two edges. If
//! not, the nearest point of one of them is a corner, over an edge or a corner of the other. So the distance is exact
//! after all faces, all pairs of edges that can face each other and, if these do not decide, all corners against all
//! edges: there is no iteration. If cores overlap, the axis of least overlap gives the depth, which is the shortest way
//! out.
//!
//! Two points prove themselves to be nearest: the planes through them across the line between them, each touching its
//! core, are just as far apart. So a guess from a nearby pose needs only this proof ([`HullPair::nearest`]).

use super::{Feature, HullPair, Meeting};
use crate::shape::hull::{Face, On};
use glam::DVec3;

/// By how much, over their size, edges must keep cores farther apart than faces do in order to be chosen: so that
/// rounding decides nothing. Default 1e-12.
pub(super) const SLACK: f64 = 1e-12;

/// Distance over the size below which cores count as touching, because the direction between their nearest points is
/// then meaningless. Default 1e-11.
const TOUCHING: f64 = 1e-11;

/// Distance over the size by which nearest points may be farther apart than the planes that separate the cores. Default
/// 1e-10, above rounding.
const TIE: f64 = 1e-10;

impl HullPair<'_> {
    /// The nearest points of two polyhedra; for cores that overlap, the points along the axis of least overlap. `guess`
    /// is the feature that was nearest at a nearby pose, with its normal.
    pub(crate) fn nearest(&self, guess: Option<(Feature, DVec3)>) -> Meeting {
        guess.and_then(|(feature, normal)| self.proved(feature, normal)).unwrap_or_else(|| self.searched())
    }

    /// Whether neither the line of centres nor the normal of a face keeps them farther apart than a gap.
    pub(crate) fn may_be_within(&self, gap: f64) -> bool {
        let most = gap + self.roundings();
        if self.offset.try_normalize().is_some_and(|n| self.apart(n) > most) {
            return false;
        }
        (0..2).all(|of| {
            let (own, other) = (self.hulls[of].core, self.hulls[1 - of].core);
            own.faces.iter().all(|face| {
                let beyond = self.centre_beyond(of, face);
                beyond <= most || beyond - other.support(self.across[1 - of] * -face.normal) <= most
            })
        })
    }

    /// A feature's points, if they are the nearest.
    fn proved(&self, feature: Feature, towards: DVec3) -> Option<Meeting> {
        let (meeting, is_on) = match feature {
            Feature::Corner { of, corner, on } => self.at_corner(usize::from(of), corner, on),
            Feature::Edges(a, b) => {
                let (meeting, within) = self.at_edges([a, b], towards);
                (meeting, within >= 0.0)
            }
        };
        let distance = meeting.gap + self.roundings();
        let is_nearest =
            is_on && distance > TOUCHING * self.size && distance <= self.apart(meeting.normal) + SLACK * self.size;
        is_nearest.then_some(meeting)
    }

    fn searched(&self) -> Meeting {
        let size = self.size;
        let face = self.best_face();
        if let Some((apart, of, face)) = face
            && apart > TOUCHING * size
            && let (meeting, true) = self.support_corner(of, face)
        {
            // The face's plane keeps the cores as far apart as these points are: no edges are nearer.
            return meeting;
        }
        let edges = self.best_edges(face.map_or(f64::NEG_INFINITY, |f| f.0 + SLACK * size));
        let best = edges.map(|e| e.0).or(face.map(|f| f.0)).unwrap_or(f64::INFINITY);
        if best <= TOUCHING * size {
            if let Some((_, pair, towards)) = edges {
                return self.at_edges(pair, towards).0;
            }
            if let Some((_, of, face)) = face {
                return self.support_corner(of, face).0;
            }
        }
        if let Some((_, pair, towards)) = edges {
            let (meeting, within) = self.at_edges(pair, towards);
            if within >= 0.0 {
                return meeting;
            }
        }
        let meeting = self.nearest_corner();
        if meeting.gap + self.roundings() <= self.apart(meeting.normal) + TIE * size {
            return meeting;
        }
        let Some((_, of, face)) = face else { return meeting };
        // Faces are so parallel that edges cross without a perpendicular of their own, or that corners are just beside
        // them: the face's normal keeps cores as far apart as they are.
        let (meeting, _) = self.support_corner(of, face);
        self.crossing(&meeting, TIE * size).unwrap_or(meeting)
    }

    /// The face that keeps the cores farthest apart: how far, of which polyhedron, and its index.
    fn best_face(&self) -> Option<(f64, usize, u8)> {
        // A face keeps them no farther apart than the other's centre is beyond it, so the one that the centre is
        // farthest beyond leaves few others to examine.
        let (mut farthest, mut first) = (f64::NEG_INFINITY, None);
        for of in 0..2 {
            for (k, face) in self.hulls[of].core.faces.iter().enumerate() {
                let beyond = self.centre_beyond(of, face);
                if beyond > farthest {
                    (farthest, first) = (beyond, Some((of, k)));
                }
            }
        }
        let (of, k) = first?;
        // The last deepest corner of each below a face of the other: a face keeps the cores no farther apart than it is
        // from that corner, which tells most others without examining all corners.
        let mut deepest = [None; 2];
        let mut apart_at = |of: usize, face: &Face, centre_beyond: f64, least: f64| {
            let (other, down) = (self.hulls[1 - of].core, self.across[1 - of] * -face.normal);
            if let Some(corner) = deepest[of]
                && centre_beyond - other.corner(corner).dot(down) < least
            {
                return f64::NEG_INFINITY;
            }
            let (corner, reach) = other.farthest(down);
            deepest[of] = Some(corner);
            centre_beyond - reach
        };
        let apart = apart_at(of, &self.hulls[of].core.faces[k], farthest, f64::NEG_INFINITY);
        let mut best = (apart, of, k as u8);
        let found = best;
        for of in 0..2 {
            for (k, face) in self.hulls[of].core.faces.iter().enumerate() {
                let beyond = self.centre_beyond(of, face);
                if beyond < best.0 || (of, k as u8) == (found.1, found.2) {
                    continue;
                }
                let apart = apart_at(of, face, beyond, best.0);
                // Of those that are equally good, the first.
                if apart > best.0 || (apart == best.0 && (of, k as u8) < (best.1, best.2)) {
                    best = (apart, of, k as u8);
                }
            }
        }
        Some(best)
    }

    /// How far the other's centre is beyond a face.
    #[inline]
    fn centre_beyond(&self, of: usize, face: &Face) -> f64 {
        face.normal.dot(self.other[of]) - face.offset
    }

    /// The corner of the other polyhedron that is deepest below a face; if several are equally deep, one that is over
    /// the face, if there is one. Also returns whether it is over the face.
    fn support_corner(&self, of: usize, face: u8) -> (Meeting, bool) {
        let (own, other) = (self.hulls[of].core, self.hulls[1 - of].core);
        let down = self.across[1 - of] * -own.face(face).normal;
        let (deepest, lowest) = other.farthest(down);
        let level = lowest - SLACK * self.size;
        let same = (0..other.corners.len() as u8).filter(|&k| other.corner(k).dot(down) >= level);
        let over = same.into_iter().find(|&k| own.is_over(face, self.corner_seen(1 - of, k), 0.0));
        (self.at_corner(1 - of, over.unwrap_or(deepest), On::Face(face)).0, over.is_some())
    }

    /// The corner nearest to an edge or a corner of the other polyhedron.
    fn nearest_corner(&self) -> Meeting {
        let (mut least, mut best) = (f64::INFINITY, (0, 0, On::Corner(0)));
        for of in 0..2 {
            let (own, other) = (self.hulls[of].core, self.hulls[1 - of].core);
            for corner in 0..own.corners.len() as u8 {
                let seen = self.corner_seen(of, corner);
                // A face keeps the corner at least as far away as its plane is.
                let away = other.farthest_face(seen).map_or(0.0, |f| f.1) - SLACK * self.size;
                if away > 0.0 && away * away > least {
                    continue;
                }
                let (on, squared) = other.nearest_edge(seen);
                if squared < least {
                    (least, best) = (squared, (of, corner, on));
                }
            }
        }
        let (of, corner, on) = best;
        self.at_corner(of, corner, on).0
    }

    /// Edges that cross in the plane across a meeting's normal, no farther apart than its points.
    fn crossing(&self, meeting: &Meeting, slack: f64) -> Option<Meeting> {
        let mut found = None;
        self.crossings(meeting.normal, 0.0, [meeting.gap + slack, 0.0], |m| {
            if found.is_none() && m.gap <= meeting.gap + slack {
                found = Some(m);
            }
        });
        found
    }
}
