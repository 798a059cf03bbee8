//! What happens when two materials touch: one law for each unordered pair of materials.

use crate::error::WorldError;
use serde::{Deserialize, Serialize};

/// A material: an index into the world's [`Laws`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Material(pub u16);

/// The constitutive numbers of one pair of materials. All are dimensionless.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Law {
    /// Coulomb's coefficient of friction where surfaces slide on each other; in [0, ∞).
    pub friction: f64,
    /// The same where they do not slide; in [0, ∞). Below `friction` it counts as `friction`, so 0 makes the two equal.
    /// Marbles have only one.
    #[serde(default)]
    pub static_friction: f64,
    /// Restitution of the normal motion; in [0, 1]. Newton's ratio for spheres, Stronge's energetic ratio for other
    /// bodies (the two agree for spheres).
    pub restitution: f64,
    /// Restitution of the tangential motion of a sphere; in [0, 1]. 0 sticks (the usual case), 1 is Garwin's
    /// super-ball.
    pub tangential: f64,
    /// Rolling resistance: the resisting torque is at most this × normal force × radius; in [0, ∞). Glass on wood:
    /// 0.001–0.02. It acts while the ball rolls. If it is at least `friction`, a ball that slides without turning does
    /// not begin to turn.
    pub rolling: f64,
    /// Resistance to spinning about the normal: torque = this × normal force × radius; in [0, ∞).
    pub spinning: f64,
    /// How much impacts differ from each other. Nothing scatters where a world has no
    /// [scores](crate::rigid::ImpactScores), nor do impacts of marbles.
    #[serde(default)]
    pub scatter: Scatter,
}

/// How impacts on real, imperfect surfaces differ from each other, as standard deviations of Gaussian laws.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Scatter {
    /// Tilt of the normal about each of two axes across it, in rad; in [0, ∞).
    pub tilt: f64,
    /// Restitution, over its mean; in [0, ∞).
    pub restitution: f64,
}

impl Scatter {
    /// Whether impacts do not differ.
    #[inline]
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.tilt == 0.0 && self.restitution == 0.0
    }
}

/// Friction 0.3, restitution 0.5, no resistance: about that of wood on wood.
impl Default for Law {
    fn default() -> Self {
        Self::new(0.3, 0.5)
    }
}

impl Law {
    /// Coulomb friction and restitution, no resistance to rolling or spinning.
    #[must_use]
    pub const fn new(friction: f64, restitution: f64) -> Self {
        let scatter = Scatter { tilt: 0.0, restitution: 0.0 };
        Self { friction, static_friction: 0.0, restitution, tangential: 0.0, rolling: 0.0, spinning: 0.0, scatter }
    }

    /// The same law with resistance to rolling and to spinning.
    #[must_use]
    pub const fn with_resistance(self, rolling: f64, spinning: f64) -> Self {
        Self { rolling, spinning, ..self }
    }

    /// The same law with a coefficient of friction for surfaces that do not slide.
    #[must_use]
    pub const fn with_static_friction(self, static_friction: f64) -> Self {
        Self { static_friction, ..self }
    }

    /// The same law with impacts that differ from each other.
    #[must_use]
    pub const fn with_scatter(self, scatter: Scatter) -> Self {
        Self { scatter, ..self }
    }

    /// The coefficient of friction where surfaces do not slide.
    #[inline]
    pub(crate) fn grip(&self) -> f64 {
        self.friction.max(self.static_friction)
    }

    /// The same law with this coefficient of friction, sliding or not.
    #[inline]
    pub(crate) fn rubbing(&self, friction: f64) -> Self {
        Self { friction, static_friction: 0.0, ..*self }
    }

    /// The same law with tangential restitution.
    #[must_use]
    pub const fn with_tangential(self, tangential: f64) -> Self {
        Self { tangential, ..self }
    }

    /// Whether sliding friction cannot make a ball turn that does not turn yet, because the resistance to rolling is at
    /// least as large.
    #[inline]
    pub(crate) fn holds_from_turning(&self) -> bool {
        self.rolling >= self.friction
    }

    fn check(&self) -> Result<(), (&'static str, f64)> {
        let non_negative = [
            ("friction", self.friction),
            ("static_friction", self.static_friction),
            ("rolling", self.rolling),
            ("spinning", self.spinning),
            ("scatter of the normal", self.scatter.tilt),
            ("scatter of the restitution", self.scatter.restitution),
        ];
        let unit = [("restitution", self.restitution), ("tangential", self.tangential)];
        for (name, value) in non_negative {
            if !(value >= 0.0 && value.is_finite()) {
                return Err((name, value));
            }
        }
        for (name, value) in unit {
            if !(0.0..=1.0).contains(&value) {
                return Err((name, value));
            }
        }
        Ok(())
    }
}

/// The table of laws: one for each unordered pair of materials.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Laws {
    materials: u16,
    table: Vec<Law>,
}

/// One material with the default law.
impl Default for Laws {
    fn default() -> Self {
        Self { materials: 1, table: vec![Law::default()] }
    }
}

impl Laws {
    /// A world of one material only.
    ///
    /// # Errors
    /// [`WorldError::BadLaw`] if a number is out of its range or NaN.
    pub fn uniform(law: Law) -> Result<Self, WorldError> {
        Self::new(1, law)
    }

    /// A table for `materials` materials, all pairs with the law `default`.
    ///
    /// # Errors
    /// [`WorldError::BadLaw`] if a number is out of its range or NaN.
    pub fn new(materials: u16, default: Law) -> Result<Self, WorldError> {
        let mut laws = Self { materials, table: vec![default; usize::from(materials) * usize::from(materials)] };
        if materials > 0 {
            laws.set(Material(0), Material(0), default)?;
        }
        Ok(laws)
    }

    /// Gives one unordered pair its own law.
    ///
    /// # Errors
    /// [`WorldError::BadLaw`] if a number is out of its range or NaN, [`WorldError::UnknownMaterial`] if the
    /// table lacks a material.
    pub fn set(&mut self, a: Material, b: Material, law: Law) -> Result<(), WorldError> {
        self.require(a)?;
        self.require(b)?;
        law.check().map_err(|(field, value)| WorldError::BadLaw { a: a.0, b: b.0, field, value })?;
        let n = usize::from(self.materials);
        self.table[usize::from(a.0) * n + usize::from(b.0)] = law;
        self.table[usize::from(b.0) * n + usize::from(a.0)] = law;
        Ok(())
    }

    /// A coefficient of static friction that is larger than that of sliding, if there is one.
    pub(crate) fn static_friction(&self) -> Option<f64> {
        self.table.iter().find(|law| law.static_friction > law.friction).map(|law| law.static_friction)
    }

    /// Checks that the table has a material.
    ///
    /// # Errors
    ///
    /// [`WorldError::UnknownMaterial`] if it does not.
    pub fn require(&self, material: Material) -> Result<(), WorldError> {
        if material.0 < self.materials {
            Ok(())
        } else {
            Err(WorldError::UnknownMaterial { material: material.0, known: self.materials })
        }
    }

    /// The law of a pair.
    #[inline]
    #[must_use]
    pub fn of(&self, a: Material, b: Material) -> &Law {
        &self.table[usize::from(a.0) * usize::from(self.materials) + usize::from(b.0)]
    }
}
