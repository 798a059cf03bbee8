//! Lasting contacts, for the sound of rolling and sliding.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A time during which a body rolls or slides on something. A long one is divided into several in a row.
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
    /// Where the body touches at the start.
    pub point: DVec3,
    /// Mean speed of the body's surface over the other's, m/s.
    pub slip: f64,
    /// Mean speed at which the point of contact moves along the surface without slipping, m/s.
    pub roll: f64,
    /// Mean force between the two, N: it supports the body, and changes its velocity.
    pub force: f64,
}

impl Contact {
    /// Whether a body took part.
    #[must_use]
    pub fn involves(&self, name: &str) -> bool {
        self.body == name || self.other == name
    }
}
