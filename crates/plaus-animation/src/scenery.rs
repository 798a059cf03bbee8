//! Scenery and viewpoints.

use super::look::Look;
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

/// A piece of scenery.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Prop {
    /// Stable name; unique within an animation, including its bodies.
    pub name: String,
    /// Colour and material.
    pub look: Look,
    /// Its form.
    pub form: Form,
}

/// The form of a piece of scenery, in metres and in the world's frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// A box.
    Block {
        /// Its centre.
        centre: DVec3,
        /// Half its lengths along its own axes.
        half: DVec3,
        /// From its own axes to the world's.
        orientation: DQuat,
    },
    /// A square part of a plane, seen from the side that its normal points to.
    Plane {
        /// Its centre.
        centre: DVec3,
        /// Unit normal.
        normal: DVec3,
        /// Half the square's side.
        half: f64,
    },
    /// Triangles, counter-clockwise as seen from outside.
    Mesh {
        /// Corners.
        vertices: Vec<DVec3>,
        /// Three corners each.
        triangles: Vec<[u32; 3]>,
    },
    /// Heights over a regular grid in the plane of x and z.
    Heightfield {
        /// Position of the first height's foot.
        origin: DVec3,
        /// Distance between neighbours along x and along z.
        step: [f64; 2],
        /// Number of heights along x before the next row in z begins.
        columns: u32,
        /// Heights above the origin's y; a whole number of rows.
        heights: Vec<f64>,
    },
}

/// A viewpoint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Direction from the point looked at to the eye; its length does not matter.
    pub from: DVec3,
    /// Points that should be visible, besides everything that moves: two corners of a box.
    pub frame: Option<[DVec3; 2]>,
    /// Whether only that box must be visible, wherever bodies go.
    pub alone: bool,
    /// Whether pictures look from there whatever is hidden, rather than from higher up. Not written: pages can be
    /// turned.
    #[serde(skip)]
    pub exact: bool,
}

impl Prop {
    /// A part of the scenery of any form.
    pub fn new(name: impl Into<String>, look: Look, form: Form) -> Self {
        Self { name: name.into(), look, form }
    }

    /// A box along the world's axes, given by its centre and half its lengths.
    pub fn block(name: impl Into<String>, look: Look, centre: DVec3, half: DVec3) -> Self {
        Self::new(name, look, Form::Block { centre, half, orientation: DQuat::IDENTITY })
    }

    /// Marks a box, given by its centre and half its lengths, as a place to reach.
    pub fn target(name: impl Into<String>, centre: DVec3, half: DVec3) -> Self {
        Self::block(name, Look::TARGET, centre, half)
    }
}

impl View {
    /// Looks from a direction; everything that moves should be visible.
    #[must_use]
    pub fn from(x: f64, y: f64, z: f64) -> Self {
        Self { from: DVec3::new(x, y, z), frame: None, alone: false, exact: false }
    }

    /// The same; pictures look from there whatever is hidden.
    #[must_use]
    pub fn exactly(self) -> Self {
        Self { exact: true, ..self }
    }

    /// The same; a box between two corners should be visible as well.
    #[must_use]
    pub fn showing(self, low: DVec3, high: DVec3) -> Self {
        Self { frame: Some([low, high]), ..self }
    }

    /// The same; only a box between two corners must be visible.
    #[must_use]
    pub fn only(self, low: DVec3, high: DVec3) -> Self {
        Self { frame: Some([low, high]), alone: true, ..self }
    }
}
