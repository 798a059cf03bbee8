//! Lasting contacts: what bears on what, and how it rolls and slides there.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A time during which a body bears on something: it rests, rolls or slides there. Of bodies that move, a long one is
/// divided into several in a row. One that ends with the animation goes on if nothing moves any more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// When it begins, in s.
    pub start: f64,
    /// When it ends, in s.
    pub end: f64,
    /// The body's name.
    pub body: String,
    /// What it touches: another body or a part of the scenery.
    pub other: String,
    /// Where the body touches at the start: the middle of the points that bear load.
    pub point: DVec3,
    /// Unit vector towards the body, across the surfaces that touch; zero where it is not known.
    #[serde(default)]
    pub normal: DVec3,
    /// Mean speed of the body's surface over the other's, m/s.
    pub slip: f64,
    /// Mean speed at which the point of contact moves along the surface without slipping, m/s.
    pub roll: f64,
    /// Size of the mean force between the two, N.
    pub force: f64,
}

impl Contact {
    /// Whether a body took part.
    #[must_use]
    pub fn involves(&self, name: &str) -> bool {
        self.body == name || self.other == name
    }
}
