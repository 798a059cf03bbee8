//! The law of one variable of a draw, for moves that serve variables of any law.

use plaus_dist::{
    Density, Gaussian, IsotropicGaussian, LogDensity, NotANumber, NumberLaw, ParamError, Radial, Sample, Stream,
    TruncatedGaussian, Uniform, UniformBox, WrappedUniform, math,
};
use std::sync::Arc;

/// The law of a variable: of one number, or of all coordinates of an offset or a place together.
#[derive(Debug, Clone)]
pub enum Law {
    /// Always this value: no move changes it.
    Fixed(f64),
    /// A Gaussian number.
    Gaussian(Gaussian),
    /// A Gaussian number within bounds.
    Truncated(TruncatedGaussian),
    /// A Gaussian number of this mean and standard deviation, but not below the value of another variable, given by its
    /// index, which comes before this one.
    Above(f64, f64, usize),
    /// A number uniform on an interval whose ends are joined: a value that leaves at one end enters at the other.
    Uniform(WrappedUniform),
    /// A number of any other law.
    Number(Arc<dyn NumberLaw>),
    /// A place uniform on a rectangle, opposite sides joined.
    Rectangle(Rectangle),
    /// An offset in the plane.
    Plane(Offset<2>),
    /// An offset in space.
    Space(Offset<3>),
    /// The target's own law, for a variable that is not made of numbers: an orientation, a table. Its density is 1
    /// everywhere, because densities are taken with respect to its law.
    Own,
}

/// How new values are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Recipe {
    /// The law itself.
    #[default]
    Exact,
    /// Offsets in a random direction with a Gaussian length, as Chenney & Forsyth print it. Their density is not the
    /// Gaussian that the paper gives (erratum).
    Radial,
}

impl Law {
    /// Whether anything is uncertain.
    #[must_use]
    pub fn is_uncertain(&self) -> bool {
        !matches!(self, Self::Fixed(_))
    }

    /// The variable on whose value this law depends.
    #[must_use]
    pub fn depends_on(&self) -> Option<usize> {
        match self {
            Self::Above(_, _, other) => Some(*other),
            _ => None,
        }
    }

    /// Draws new values into `values`; `other` is the value of the variable that the law depends on, if it does.
    pub fn sample(&self, other: f64, recipe: Recipe, stream: &mut Stream, values: &mut [f64]) {
        match self {
            Self::Fixed(value) => values.fill(*value),
            Self::Gaussian(law) => values.fill(law.sample(stream)),
            Self::Truncated(law) => values.fill(law.sample(stream)),
            Self::Above(mean, sd, _) => {
                values.fill(above(*mean, *sd, other).map_or(*mean, |law| law.sample(stream)));
            }
            Self::Uniform(law) => values.fill(law.sample(stream)),
            Self::Number(law) => values.fill(law.draw(stream)),
            Self::Rectangle(law) => values.copy_from_slice(&law.sample(stream)),
            Self::Plane(law) => values.copy_from_slice(&law.sample(recipe, stream)),
            Self::Space(law) => values.copy_from_slice(&law.sample(recipe, stream)),
            Self::Own => {}
        }
    }

    /// Log density at `values`.
    ///
    /// # Errors
    /// [`NotANumber`] if a value is NaN.
    pub fn log_density(&self, other: f64, values: &[f64]) -> Result<LogDensity, NotANumber> {
        let x = values.first().copied().unwrap_or(f64::NAN);
        match self {
            // The mirror image of 0 is −0.
            Self::Fixed(value) => Ok(if x - value == 0.0 { LogDensity::ONE } else { LogDensity::ZERO }),
            Self::Gaussian(law) => law.log_density(&x),
            Self::Truncated(law) => law.log_density(&x),
            Self::Above(mean, sd, _) => {
                above(*mean, *sd, other).map_or(Ok(LogDensity::ZERO), |law| law.log_density(&x))
            }
            Self::Uniform(law) => law.log_density(&x),
            Self::Number(law) => law.log_density_at(x),
            Self::Rectangle(law) => law.log_density(&array(values)),
            Self::Plane(law) => law.log_density(&array(values)),
            Self::Space(law) => law.log_density(&array(values)),
            Self::Own => Ok(LogDensity::ONE),
        }
    }

    /// Adds a step to values; where ends are joined, values go around. If a step is as likely as its opposite, so is
    /// the change.
    #[inline]
    pub fn add(&self, step: &[f64], values: &mut [f64]) {
        if let (Self::Gaussian(_), [x], [by]) = (self, &mut *values, step) {
            *x += by;
            return;
        }
        self.add_any(step, values);
    }

    fn add_any(&self, step: &[f64], values: &mut [f64]) {
        match self {
            Self::Fixed(_) | Self::Own => {}
            Self::Uniform(law) => values.iter_mut().zip(step).for_each(|(x, by)| *x = law.wrap(*x + by)),
            Self::Number(law) => values.iter_mut().zip(step).for_each(|(x, by)| *x = law.step(*x, *by)),
            Self::Rectangle(law) => {
                let sides = values.iter_mut().zip(step).zip(&law.sides);
                sides.for_each(|((x, by), side)| *x = side.wrap(*x + by));
            }
            _ => values.iter_mut().zip(step).for_each(|(x, by)| *x += by),
        }
    }

    /// The unit for a step of usual size: a standard deviation, or the width of an interval; 0 if there is none.
    #[must_use]
    pub fn width(&self) -> f64 {
        match self {
            Self::Uniform(law) => law.high() - law.low(),
            Self::Number(law) => law.width(),
            Self::Rectangle(law) => {
                (law.sides[0].high() - law.sides[0].low()).min(law.sides[1].high() - law.sides[1].low())
            }
            _ => self.gaussian().map_or(0.0, |law| law.sd()),
        }
    }

    /// Whether it is the law of one number, has a normalised density, and depends on no other variable.
    #[must_use]
    pub fn is_density(&self) -> bool {
        match self {
            Self::Gaussian(_) | Self::Truncated(_) | Self::Uniform(_) => true,
            Self::Number(law) => law.is_continuous(),
            _ => false,
        }
    }

    /// The Gaussian of each coordinate, before anything is cut off; `None` for other laws.
    #[must_use]
    pub fn gaussian(&self) -> Option<Gaussian> {
        match self {
            Self::Gaussian(law) => Some(*law),
            Self::Truncated(law) => Gaussian::new(law.mean(), law.sd()).ok(),
            Self::Above(mean, sd, _) => Gaussian::new(*mean, *sd).ok(),
            Self::Plane(law) => Gaussian::new(0.0, law.sd()).ok(),
            Self::Space(law) => Gaussian::new(0.0, law.sd()).ok(),
            _ => None,
        }
    }
}

/// A Gaussian above another variable's value; `None` if there is no such law for that value.
fn above(mean: f64, sd: f64, least: f64) -> Option<TruncatedGaussian> {
    TruncatedGaussian::new(mean, sd, least, f64::INFINITY).ok()
}

/// The first coordinates; missing ones are NaN, which densities refuse.
fn array<const D: usize>(values: &[f64]) -> [f64; D] {
    std::array::from_fn(|k| values.get(k).copied().unwrap_or(f64::NAN))
}

/// The uniform law on a rectangle whose opposite sides are joined.
#[derive(Debug, Clone)]
pub struct Rectangle {
    inside: UniformBox<2>,
    sides: [WrappedUniform; 2],
}

impl Rectangle {
    /// Lower and upper ends along each axis.
    ///
    /// # Errors
    ///
    /// [`ParamError`] if a side is not an interval.
    pub fn new([x, y]: [[f64; 2]; 2]) -> Result<Self, ParamError> {
        Ok(Self {
            inside: UniformBox::new([Uniform::new(x[0], x[1])?, Uniform::new(y[0], y[1])?]),
            sides: [WrappedUniform::new(x[0], x[1])?, WrappedUniform::new(y[0], y[1])?],
        })
    }

    /// The interval along each axis.
    #[must_use]
    pub fn sides(&self) -> &[WrappedUniform; 2] {
        &self.sides
    }

    /// Its area.
    #[must_use]
    pub fn area(&self) -> f64 {
        let [x, y] = &self.sides;
        (x.high() - x.low()) * (y.high() - y.low())
    }

    /// A place.
    pub fn sample(&self, stream: &mut Stream) -> [f64; 2] {
        self.inside.sample(stream)
    }

    /// Log density at a place.
    ///
    /// # Errors
    /// [`NotANumber`] if a coordinate is NaN.
    pub fn log_density(&self, place: &[f64; 2]) -> Result<LogDensity, NotANumber> {
        self.inside.log_density(place)
    }
}

/// The law of an offset from a spot: Gaussian, the same along each axis, and cut off far out. The cut multiplies the
/// density by a constant, which is left out.
#[derive(Debug, Clone)]
pub struct Offset<const D: usize> {
    exact: IsotropicGaussian<D>,
    radial: Radial<D>,
    longest: f64,
}

impl<const D: usize> Offset<D> {
    /// An offset with standard deviation `sd` along each axis, not longer than `longest`, which may be infinite.
    ///
    /// # Errors
    ///
    /// [`ParamError`] if `sd` is not a scale.
    pub fn new(sd: f64, longest: f64) -> Result<Self, ParamError> {
        Ok(Self { exact: IsotropicGaussian::new(sd)?, radial: Radial::new(sd)?, longest })
    }

    /// The standard deviation along each axis.
    #[must_use]
    pub fn sd(&self) -> f64 {
        self.exact.sd()
    }

    /// The longest possible offset.
    #[must_use]
    pub fn longest(&self) -> f64 {
        self.longest
    }

    /// The first of several new offsets that is not too long.
    pub fn sample(&self, recipe: Recipe, stream: &mut Stream) -> [f64; D] {
        loop {
            let offset = match recipe {
                Recipe::Exact => self.exact.sample(stream),
                Recipe::Radial => self.radial.sample(stream),
            };
            if self.holds(&offset) {
                return offset;
            }
        }
    }

    /// Log density of an offset.
    ///
    /// # Errors
    /// [`NotANumber`] if a coordinate is NaN.
    pub fn log_density(&self, offset: &[f64; D]) -> Result<LogDensity, NotANumber> {
        let density = self.exact.log_density(offset)?;
        Ok(if self.holds(offset) { density } else { LogDensity::ZERO })
    }

    fn holds(&self, offset: &[f64; D]) -> bool {
        offset.iter().map(|x| math::square(*x)).sum::<f64>() <= math::square(self.longest)
    }
}
