//! Impacts that scatter: where a draw has what they are, and which the simulator had.

use super::ending::Scattered;
use super::plan::{Built, Plan, World};
use super::values::Drawn;
use crate::uneven::Site;
use plaus_sim::rigid::{ImpactName, ImpactScores, Partner};

impl Built {
    /// What the simulator says of impacts that scattered, by the numbers of things among all, of which `bodies` are
    /// bodies.
    pub(super) fn scattered(&self, all: Vec<(usize, Partner, u32)>, bodies: usize) -> Vec<Scattered> {
        let struck = |body, other| numbers(&self.there, &self.parts, bodies, body, other);
        all.into_iter().map(|(body, other, count)| (struck(body, other), count)).collect()
    }
}

/// The numbers of the two things of an impact, of which the simulator has those that are there.
fn numbers(there: &[usize], parts: &[usize], bodies: usize, body: usize, other: Partner) -> [u32; 2] {
    let other = match other {
        Partner::Body(k) => there[k as usize],
        Partner::Part(k) => bodies + parts[k as usize],
    };
    [there[body] as u32, other as u32]
}

impl Plan {
    /// Gives the simulator's world the scores of a draw's impacts.
    pub(super) fn scatter_impacts(&self, draw: &Drawn, built: &mut Built) {
        let (Some(index), World::Turning(rigid)) = (self.scatter, &mut built.world) else { return };
        let (score, bodies) = (draw.tables[index].source(), self.bodies.len());
        let (there, parts) = (built.there.clone(), built.parts.clone());
        rigid.scatter_by(ImpactScores::new(move |ImpactName { body, other, ordinal }| {
            Site::of_impact(numbers(&there, &parts, bodies, body as usize, other), ordinal).map(&score)
        }));
    }
}
