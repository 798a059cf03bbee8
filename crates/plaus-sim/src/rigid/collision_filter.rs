//! Bodies that pass through each other.

use super::RigidWorld;
use super::body_state::RigidBodyState;
use crate::error::WorldError;

/// Which bodies pass through each other, joints aside.
#[derive(Debug, Clone, Default)]
pub(crate) struct CollisionFilter {
    /// The groups that each body is in, in order; empty if the world has none at all.
    groups: Vec<Vec<u32>>,
    count: u32,
}

impl CollisionFilter {
    fn excludes(&self, [i, j]: [usize; 2]) -> bool {
        let (Some(a), Some(b)) = (self.groups.get(i), self.groups.get(j)) else { return false };
        a.iter().any(|group| b.contains(group))
    }
}

impl RigidWorld {
    /// Lets some bodies, driven ones among them, pass through each other. A body may be in several such groups.
    ///
    /// # Errors
    /// [`WorldError::BadBody`] for a body that is not there.
    pub fn exclude_contacts(&mut self, bodies: &[usize]) -> Result<(), WorldError> {
        let count = self.specs.len();
        if let Some(&body) = bodies.iter().find(|body| **body >= count) {
            let (field, value, expected) = ("index of what passes through others", body as f64, "a body of the world");
            return Err(WorldError::BadBody { body, field, value, expected });
        }
        let filter = &mut self.filter;
        filter.groups.resize(count, Vec::new());
        bodies.iter().for_each(|&body| filter.groups[body].push(filter.count));
        filter.count += 1;
        Ok(())
    }

    /// Whether two bodies never touch: a joint holds them to each other, or they are in one group that passes through
    /// itself.
    #[inline]
    pub(crate) fn never_touch(&self, pair: [usize; 2], bodies: [&RigidBodyState; 2]) -> bool {
        self.is_joined(pair, bodies) || self.filter.excludes(pair)
    }
}
