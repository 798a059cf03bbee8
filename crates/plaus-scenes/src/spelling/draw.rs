//! What is random: vertex offsets and drop positions; and their prior.

use plaus_dist::{
    Density, IsotropicGaussian, LogDensity, NotANumber, ParamError, Radial, Sample, Stream, Uniform, UniformBox,
    WrappedUniform, math, open_unit,
};
use serde::{Deserialize, Serialize};

/// The values of all random variables, in millimetres.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Drops {
    /// Offset of each random partition vertex.
    pub offsets: Vec<[f64; 3]>,
    /// Where each ball is dropped; `None`: it is not.
    pub balls: Vec<Option<[f64; 2]>>,
}

impl Drops {
    /// Number of balls that are dropped.
    #[must_use]
    pub fn active(&self) -> usize {
        self.balls.iter().flatten().count()
    }
}

impl Clone for Drops {
    fn clone(&self) -> Self {
        Self { offsets: self.offsets.clone(), balls: self.balls.clone() }
    }
    fn clone_from(&mut self, source: &Self) {
        self.offsets.clone_from(&source.offsets);
        self.balls.clone_from(&source.balls);
    }
}

/// The prior: vertex offsets Gaussian, cut off far out; each ball dropped with probability ½, uniformly over a
/// rectangle.
///
/// The paper's `Π 1/a` over the balls that are dropped is this law: a ball has weight ∫ 1/a = 1 in either state.
#[derive(Debug, Clone)]
pub struct Prior {
    offset: IsotropicGaussian<3>,
    fresh_as_printed: Radial<3>,
    /// Offsets longer than this have density 0. The factor that this cut puts on the density is the same for every
    /// draw, and left out.
    longest: f64,
    vertices: usize,
    balls: usize,
    rectangle: UniformBox<2>,
    wrapped: [WrappedUniform; 2],
    area: f64,
}

impl Prior {
    /// `vertices` offsets of standard deviation `sigma` an axis, not longer than `longest`; `balls` over a rectangle
    /// given by its lower and upper ends along each axis.
    ///
    /// # Errors
    /// [`ParamError`] where a scale is no scale or a side is no interval.
    pub fn new(
        (vertices, sigma, longest): (usize, f64, f64),
        balls: usize,
        [x, y]: [[f64; 2]; 2],
    ) -> Result<Self, ParamError> {
        Ok(Self {
            offset: IsotropicGaussian::new(sigma)?,
            fresh_as_printed: Radial::new(sigma)?,
            longest,
            vertices,
            balls,
            rectangle: UniformBox::new([Uniform::new(x[0], x[1])?, Uniform::new(y[0], y[1])?]),
            wrapped: [WrappedUniform::new(x[0], x[1])?, WrappedUniform::new(y[0], y[1])?],
            area: (x[1] - x[0]) * (y[1] - y[0]),
        })
    }

    /// Area of the rectangle, in mm².
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The rectangle, its edges joined.
    #[must_use]
    pub fn wrapped(&self) -> &[WrappedUniform; 2] {
        &self.wrapped
    }

    /// The longest offset a vertex can have.
    #[must_use]
    pub fn longest(&self) -> f64 {
        self.longest
    }

    /// Most balls there can be.
    #[must_use]
    pub fn balls(&self) -> usize {
        self.balls
    }

    /// A drop position.
    pub fn position(&self, stream: &mut Stream) -> [f64; 2] {
        self.rectangle.sample(stream)
    }

    /// The offset of one vertex.
    pub fn offset(&self, stream: &mut Stream) -> [f64; 3] {
        self.held(|| self.offset.sample(stream))
    }

    /// The first of `fresh` offsets that is not too long.
    fn held(&self, mut fresh: impl FnMut() -> [f64; 3]) -> [f64; 3] {
        let mut offset = fresh();
        while !self.holds(&offset) {
            offset = fresh();
        }
        offset
    }

    /// A draw of the prior; with the paper's recipe for offsets (a random direction, a Gaussian length) where
    /// `as_printed`, which is another law.
    pub fn sample(&self, as_printed: bool, draw: &mut Drops, stream: &mut Stream) {
        draw.offsets.clear();
        for _ in 0..self.vertices {
            let offset =
                if as_printed { self.held(|| self.fresh_as_printed.sample(stream)) } else { self.offset(stream) };
            draw.offsets.push(offset);
        }
        draw.balls.clear();
        draw.balls.extend((0..self.balls).map(|_| (open_unit(stream) < 0.5).then(|| self.position(stream))));
    }

    fn holds(&self, offset: &[f64; 3]) -> bool {
        let squared: f64 = offset.iter().map(|x| math::square(*x)).sum();
        squared <= math::square(self.longest)
    }

    /// Log density of a draw.
    ///
    /// # Errors
    /// [`NotANumber`] where the draw holds a NaN.
    pub fn log_density(&self, draw: &Drops) -> Result<LogDensity, NotANumber> {
        let mut sum = LogDensity::new(-(self.balls as f64) * std::f64::consts::LN_2)?;
        for offset in &draw.offsets {
            sum = sum + self.offset.log_density(offset)?;
            if !self.holds(offset) {
                return Ok(LogDensity::ZERO);
            }
        }
        draw.balls.iter().flatten().try_fold(sum, |sum, position| Ok(sum + self.rectangle.log_density(position)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_is_that_of_appendix_b() {
        let prior = Prior::new((2, 0.1, 0.8), 3, [[7.0, 133.0], [7.0, 93.0]]).unwrap();
        let log = |offset: f64, balls: &[Option<[f64; 2]>]| {
            let draw = Drops { offsets: vec![[0.0; 3], [0.0, offset, 0.0]], balls: balls.to_vec() };
            prior.log_density(&draw).unwrap().value()
        };
        let here = Some([50.0, 50.0]);
        // One ball more: 1/a. One standard deviation: e^(−1/2).
        assert!((log(0.0, &[here, None, here]) - log(0.0, &[here, None, None]) + math::ln(126.0 * 86.0)).abs() < 1e-12);
        assert!((log(0.1, &[None; 3]) - log(0.0, &[None; 3]) + 0.5).abs() < 1e-12);
        assert_eq!(log(0.81, &[None; 3]), f64::NEG_INFINITY);
        assert_eq!(log(0.0, &[Some([6.9, 50.0]), None, None]), f64::NEG_INFINITY);
    }
}
