//! Joints that break.

use serde::{Deserialize, Serialize};

/// A joint breaks, for good.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Break {
    /// When, in s.
    pub time: f64,
    /// The joint's name.
    pub joint: String,
}
