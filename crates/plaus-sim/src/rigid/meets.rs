//! When bodies that meet others by their convex pieces first touch: each other, and fixed parts.

use super::Rigid;
use super::body::{Phase, Turning};
use super::detect::Search;
use super::hunt::{Hunt, Target};
use super::still::Ground;
use crate::scenery::Surface;

impl Rigid {
    /// First time in `[from, until]` at which pieces of two bodies touch while approaching. For bodies in lasting
    /// contact (`linked`), only points that are not yet part of it count.
    pub(super) fn first_of_pieces(
        &self,
        [i, j]: [usize; 2],
        bodies: [&Turning; 2],
        [from, until]: [f64; 2],
        linked: bool,
    ) -> Option<f64> {
        let target = Target::Body(&self.specs[j], bodies[1]);
        let level = self.pair_gap([i, j]);
        let hunt = Hunt { spec: &self.specs[i], body: bodies[0], target, level, from, until, linked };
        hunt.first().map(|found| found.0)
    }
}

impl Search<'_> {
    /// First contact of a body's pieces with a part.
    pub(super) fn pieces(&mut self, part: u16, ground: Ground) {
        let (spec, body) = (self.spec, self.body);
        if spec.is_ball
            && let Ground::Still(still) = ground
            && let Some(mesh) = still.mesh()
        {
            return self.ball(part, still, mesh);
        }
        let of_part = |s: &Surface| matches!(s, Surface::Spot { part: p, .. } if *p == part);
        let linked = matches!(body.phase, Phase::Step | Phase::Glide) && body.touching().iter().any(of_part);
        let start = body.path.t;
        let (from, until) = (start, start + self.until);
        let hunt = Hunt { spec, body, target: Target::Ground(ground), level: spec.gap, from, until, linked };
        if let Some((time, spot)) = hunt.first() {
            self.strikes(time - start, spot.surface(part));
        }
    }
}
