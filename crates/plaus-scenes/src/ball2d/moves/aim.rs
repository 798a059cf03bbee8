//! Redraws some normals and solves for another, so that the ball still lands near the target.
//!
//! The move redraws some angles from their prior. It draws a pattern of downward bounces (mostly the one that the other
//! angles have together with a probe angle), and a place x from the constraint's own Gaussian. It finds all angles that
//! land the ball there with bounces that follow the pattern, and chooses one with probability proportional to `w =
//! φ(θ)/|dx/dθ|`, where φ is the angle's prior. The density of the result is `h(θ) = P(pattern) · N(x(θ); target, σ_d)
//! · φ(θ) / S(x(θ))`, with `S` the sum of `w` over the angles found. Together with the redrawn angles, the acceptance
//! ratio becomes `S/P(pattern)` of the candidate over that of the current state: nearly an independence sampler of the
//! target. The probe, the angles to redraw and the one to solve for are drawn without looking at the state: they are
//! the path.

use super::landing::{Course, Landing};
use super::roots::Roots;
use crate::ball2d::flight::{self, Pattern};
use crate::ball2d::{Ball2d, Normals};
use plaus_dist::stream::below;
use plaus_dist::{Density, LogRatio, Sample, Stream, math, open_unit, standard_normal};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, Transition};

/// Angles looked for, in standard deviations and in degrees at most: beyond, the proposal density is 0.
const REACH_SD: f64 = 5.0;
const REACH_DEG: f64 = 89.0;

/// How many probe angles there are, and how far they reach, in standard deviations.
const PROBES: usize = 64;
const PROBE_REACH_SD: f64 = 3.0;

/// Probability of drawing the pattern found at the probe angle outright.
const EXPECTED: f64 = 0.7;

/// Otherwise: the probability of each later bounce to be drawn as downward.
const DOWNWARD: f64 = 0.12;

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// tan of the largest angle looked for, given the angles' standard deviation in degrees.
pub(in crate::ball2d) fn reach(sigma_theta_deg: f64) -> f64 {
    math::tan(DEGREE * (REACH_SD * sigma_theta_deg).min(REACH_DEG))
}

/// Redraws one or all of the other normals and solves for one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Aim;

/// Which normal is aimed with, which are redrawn, and the aimed angle at which a pattern is looked up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Choice {
    aimed: usize,
    redrawn: Redrawn,
    /// One of [`PROBES`] angles, evenly spaced over ±[`PROBE_REACH_SD`] standard deviations.
    probe: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Redrawn {
    AllOthers,
    /// Only this one; the aimed one itself means none.
    One(usize),
}

impl Choice {
    /// The first normal moves the ball furthest, so it is aimed with more often.
    fn draw(collisions: usize, stream: &mut Stream) -> Self {
        let aimed = below(stream, 2 * collisions).saturating_sub(collisions);
        let other = below(stream, 2 * collisions);
        let redrawn = if other < collisions { Redrawn::One(other) } else { Redrawn::AllOthers };
        Self { aimed, redrawn, probe: below(stream, PROBES) }
    }

    fn redraws(self, index: usize) -> bool {
        index != self.aimed && (self.redrawn == Redrawn::AllOthers || self.redrawn == Redrawn::One(index))
    }

    fn course<'a>(self, scene: &'a Ball2d, degrees: &[f64]) -> Course<'a> {
        Course::new(&scene.table, scene.config.drop_height, degrees, self.aimed)
    }

    fn probe_degrees(self, sigma_theta_deg: f64) -> f64 {
        let place = (2 * self.probe + 1) as f64 / PROBES as f64 - 1.0;
        place * PROBE_REACH_SD * sigma_theta_deg
    }

    /// Three fields of 16 bits; in that of the redrawn one, 0 stands for all others.
    fn path(self) -> Path {
        let redrawn = match self.redrawn {
            Redrawn::One(index) => index + 1,
            Redrawn::AllOthers => 0,
        };
        Path(self.aimed as u64 | (redrawn as u64) << 16 | (self.probe as u64) << 32)
    }

    fn of(path: Path) -> Self {
        let field = |shift: u32| ((path.0 >> shift) & 0xffff) as usize;
        let redrawn = field(16).checked_sub(1).map_or(Redrawn::AllOthers, Redrawn::One);
        Self { aimed: field(0), redrawn, probe: field(32) }
    }
}

/// The proposal of one angle given all others.
struct Aiming<'a> {
    scene: &'a Ball2d,
    course: &'a Course<'a>,
    expected: Option<Pattern>,
}

impl<'a> Aiming<'a> {
    fn new(scene: &'a Ball2d, course: &'a Course<'a>, choice: Choice) -> Self {
        let expected = course.pattern(flight::normal(choice.probe_degrees(scene.config.sigma_theta_deg)));
        Self { scene, course, expected }
    }

    /// A pattern of the bounces after the aimed one: the expected one, or, in case that is wrong, any.
    fn draw_pattern(&self, stream: &mut Stream) -> Pattern {
        match self.expected {
            Some(pattern) if open_unit(stream) < EXPECTED => pattern,
            _ => {
                let later = self.course.aimed + 1..self.course.collisions;
                later.filter(|_| open_unit(stream) < DOWNWARD).fold(0, |pattern, index| pattern | 1 << index)
            }
        }
    }

    /// ln of the probability of drawing `pattern`.
    fn ln_pattern(&self, pattern: Pattern) -> f64 {
        let downward = pattern.count_ones() as i32;
        let upward = (self.course.collisions - 1 - self.course.aimed) as i32 - downward;
        let any = math::powi(DOWNWARD, downward) * math::powi(1.0 - DOWNWARD, upward);
        math::ln(match self.expected {
            None => any,
            Some(expected) if expected == pattern => EXPECTED + (1.0 - EXPECTED) * any,
            Some(_) => (1.0 - EXPECTED) * any,
        })
    }

    /// Roots that land at `x` and follow `pattern`, each with its weight `exp(−½(θ/sd)²)/|dx/dθ|`, and the sum of the
    /// weights.
    fn roots(&self, landing: &Landing, pattern: Pattern, x: f64) -> (Roots, [f64; 4], f64) {
        let roots = landing.tangents(x, self.scene.reach);
        let mut weights = [0.0; 4];
        for (weight, &t) in weights.iter_mut().zip(roots.as_slice()) {
            if self.course.follows(Course::normal(t), pattern) {
                let z = math::atan(t) / (DEGREE * self.scene.config.sigma_theta_deg);
                *weight = math::exp(-0.5 * z * z) / landing.at(t).1.abs();
            }
        }
        (roots, weights, weights.iter().sum())
    }

    /// Draws an angle in degrees, with the log of its density up to a constant of the scene; `None` if the drawn
    /// place cannot be reached.
    fn sample(&self, stream: &mut Stream) -> Option<(f64, f64)> {
        let pattern = self.draw_pattern(stream);
        let off = standard_normal(stream);
        let config = &self.scene.config;
        let landing = self.course.landing(pattern)?;
        let (roots, weights, sum) = self.roots(&landing, pattern, config.target + config.sigma_d * off);
        let mut left = open_unit(stream) * sum;
        let index = weights.iter().position(|&weight| {
            left -= weight;
            weight > 0.0 && left < 0.0
        })?;
        let degrees = math::atan(roots.as_slice()[index]) / DEGREE;
        Some((degrees, self.ln_density_of(degrees, off, pattern, sum)))
    }

    /// Log density of `sample` at `degrees`, up to the same constant.
    fn ln_density(&self, degrees: f64) -> f64 {
        let t = math::tan(DEGREE * degrees);
        let pattern = self.course.pattern(flight::normal(degrees));
        let (Some(pattern), true) = (pattern, degrees.abs() < 90.0 && t.abs() <= self.scene.reach) else {
            return f64::NEG_INFINITY;
        };
        let Some(landing) = self.course.landing(pattern) else { return f64::NEG_INFINITY };
        let x = landing.at(t).0;
        let (_, _, sum) = self.roots(&landing, pattern, x);
        let config = &self.scene.config;
        self.ln_density_of(degrees, (x - config.target) / config.sigma_d, pattern, sum)
    }

    fn ln_density_of(&self, degrees: f64, off: f64, pattern: Pattern, sum: f64) -> f64 {
        if sum == 0.0 {
            // The angle itself was lost among the roots, at a turning point or the edge of a pattern: it cannot be
            // proposed.
            return f64::NEG_INFINITY;
        }
        let z = degrees / self.scene.config.sigma_theta_deg;
        self.ln_pattern(pattern) - 0.5 * (z * z + off * off) - math::ln(sum)
    }
}

/// Log density of the draw's aimed angle, as [`Aiming::ln_density`].
fn ln_density(scene: &Ball2d, draw: &Normals, choice: Choice) -> f64 {
    Aiming::new(scene, &choice.course(scene, &draw.0), choice).ln_density(draw.0[choice.aimed])
}

/// Log ratio of proposing the redrawn angles of `from` to proposing those of `to`.
fn ln_redrawn(scene: &Ball2d, from: &[f64], to: &[f64], choice: Choice) -> Result<f64, ModelError> {
    let mut sum = 0.0;
    for (index, (old, new)) in from.iter().zip(to).enumerate() {
        if choice.redraws(index) {
            sum += scene.angle().log_density(old)?.value() - scene.angle().log_density(new)?.value();
        }
    }
    Ok(sum)
}

/// `back − forth + redrawn` as a ratio; 0 where there is no way back.
fn ratio(back: f64, forth: f64, redrawn: f64) -> Result<LogRatio, ModelError> {
    if back == f64::NEG_INFINITY {
        return Ok(LogRatio::ZERO);
    }
    Ok(LogRatio::new(back - forth + redrawn)?)
}

impl Move<Ball2d> for Aim {
    fn name(&self) -> &'static str {
        "aim"
    }

    fn propose(
        &self,
        at: At<'_, Ball2d>,
        candidate: &mut Normals,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let choice = Choice::draw(candidate.0.len(), stream);
        for (index, angle) in candidate.0.iter_mut().enumerate() {
            if choice.redraws(index) {
                *angle = at.target.angle().sample(stream);
            }
        }
        let course = choice.course(at.target, &candidate.0);
        let drawn = Aiming::new(at.target, &course, choice).sample(stream);
        let Some((aimed, forth)) = drawn else { return Ok(Proposal::Stay) };
        candidate.0[choice.aimed] = aimed;
        let back = ln_density(at.target, at.state.draw, choice);
        let redrawn = ln_redrawn(at.target, &at.state.draw.0, &candidate.0, choice)?;
        Ok(Proposal::Candidate { log_ratio: ratio(back, forth, redrawn)?, path: choice.path(), later: None })
    }

    fn log_ratio(&self, step: Transition<'_, Ball2d>) -> Result<LogRatio, ModelError> {
        let choice = Choice::of(step.path);
        let (back, forth) =
            (ln_density(step.target, step.from.draw, choice), ln_density(step.target, step.to.draw, choice));
        ratio(back, forth, ln_redrawn(step.target, &step.from.draw.0, &step.to.draw.0, choice)?)
    }
}
