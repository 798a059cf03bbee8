//! Redraw some normals and solve for another, so that the ball lands near the target all the same.
//!
//! With every other normal held, the place of rest is a trigonometric polynomial of degree two in twice the angle θ of one normal, as long as
//! no bounce is downward: the bounce maps the incoming velocity to one affine in (cos 2θ, sin 2θ), all later bounces are linear maps, and each hop's length is a
//! quadratic form of its velocity. So the angles that land the ball at a given x are the roots of a quartic in tan θ.
//!
//! The move draws x from the constraint's own Gaussian, finds all roots, and chooses one with probability in proportion to
//! `w = φ(θ)/|dx/dθ|`, φ the angle's prior. The density of the result is `h(θ) = N(x(θ); target, σ_d) · φ(θ) / S(x(θ))` with `S` the sum of `w` over the roots.
//! Together with the redrawn angles the acceptance ratio becomes `S` of the candidate over `S` of the current state (a collapsed independence sampler),
//! wherever no bounce is downward; where one is, `h` is still the density proposed from, and the ratio true.

use super::roots::{Roots, quartic};
use crate::ball2d::flight::{self, Table};
use crate::ball2d::{Ball2d, Normals};
use glam::{DMat2, DVec2};
use plaus_dist::stream::below;
use plaus_dist::{Density, LogRatio, Sample, Stream, math, open_unit, standard_normal};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// Angles looked for, in standard deviations and in degrees at most: beyond, the proposal density is 0.
const REACH_SD: f64 = 8.0;
const REACH_DEG: f64 = 89.0;

/// Which normals a path redraws, and which it aims with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Choice {
    aimed: usize,
    redrawn: Redrawn,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Redrawn {
    AllOthers,
    /// Only this one; the aimed one itself means none.
    One(usize),
}

impl Choice {
    fn draw(collisions: usize, stream: &mut Stream) -> Self {
        let aimed = below(stream, collisions);
        let other = below(stream, 2 * collisions);
        let redrawn = if other < collisions { Redrawn::One(other) } else { Redrawn::AllOthers };
        Self { aimed, redrawn }
    }

    fn path(self) -> Path {
        let other = match self.redrawn {
            Redrawn::One(index) => index as u64 + 1,
            Redrawn::AllOthers => 0,
        };
        Path(other << 32 | self.aimed as u64)
    }

    fn of(path: Path) -> Self {
        let redrawn = match path.0 >> 32 {
            0 => Redrawn::AllOthers,
            index => Redrawn::One(index as usize - 1),
        };
        Self { aimed: (path.0 & 0xffff_ffff) as usize, redrawn }
    }

    fn redraws(self, index: usize) -> bool {
        index != self.aimed && (self.redrawn == Redrawn::AllOthers || self.redrawn == Redrawn::One(index))
    }
}

/// Redraws one or all of the other normals and aims with one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Aim;

/// Where the ball comes to rest as a function of one angle θ: `a0 + a1·cos φ + a2·sin φ + a3·cos 2φ + a4·sin 2φ`, φ = 2θ.
struct Landing {
    a: [f64; 5],
}

impl Landing {
    /// `None` where a bounce before the aimed one rejects the draw.
    fn of(table: &Table, height: f64, degrees: &[f64], aimed: usize) -> Option<Self> {
        let (before, after) = (&degrees[..aimed], &degrees[aimed + 1..]);
        let mut incoming = flight::fallen(height);
        let start = flight::fly(table, height, before, |_, _, bounce| incoming = flight::landing(bounce.velocity))?;
        // Place of rest = start + vᵀ·form·v, v the velocity after the aimed bounce.
        let mut form = hop(DMat2::IDENTITY);
        let mut map = DMat2::IDENTITY;
        for &angle in after {
            let n = flight::normal(angle);
            let outer = DMat2::from_cols(n * n.x, n * n.y);
            let reflect = DMat2::IDENTITY - (1.0 + table.restitution) * outer;
            map = reflect * DMat2::from_diagonal(DVec2::new(1.0, -1.0)) * map;
            form += hop(map);
        }
        // v = level + cosine·cos φ + sine·sin φ.
        let half = 0.5 * (1.0 + table.restitution);
        let level = (1.0 - half) * incoming;
        let cosine = half * DVec2::new(incoming.x, -incoming.y);
        let sine = -half * DVec2::new(incoming.y, incoming.x);
        let [cc, ss] = [cosine.dot(form * cosine), sine.dot(form * sine)];
        Some(Self {
            a: [
                start + level.dot(form * level) + 0.5 * (cc + ss),
                2.0 * level.dot(form * cosine),
                2.0 * level.dot(form * sine),
                0.5 * (cc - ss),
                cosine.dot(form * sine),
            ],
        })
    }

    /// Place of rest and its slope in θ (per radian), from t = tan θ.
    fn at(&self, t: f64) -> (f64, f64) {
        let (c, s) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
        let (c2, s2) = (c * c - s * s, 2.0 * c * s);
        let [a0, a1, a2, a3, a4] = self.a;
        (a0 + a1 * c + a2 * s + a3 * c2 + a4 * s2, 2.0 * (a2 * c - a1 * s + 2.0 * (a4 * c2 - a3 * s2)))
    }

    /// tan θ of every angle within reach that lands the ball at `x`.
    fn tangents(&self, x: f64, reach: f64) -> Roots {
        let [a0, a1, a2, a3, a4] = self.a;
        let a0 = a0 - x;
        let coefficients = [a0 + a1 + a3, 2.0 * a2 + 4.0 * a4, 2.0 * a0 - 6.0 * a3, 2.0 * a2 - 4.0 * a4, a0 - a1 + a3];
        quartic(&coefficients, -reach, reach)
    }
}

/// The quadratic form of a hop's length, for a velocity that `map` makes of the aimed bounce's: 2·vx·vy.
fn hop(map: DMat2) -> DMat2 {
    let (x, y) = (map.row(0), map.row(1));
    DMat2::from_cols(x * y.x + y * x.x, x * y.y + y * x.y)
}

/// The proposal of one angle given all others.
struct Aiming {
    landing: Landing,
    reach: f64,
    sd: f64,
    target: f64,
    sigma: f64,
}

const DEGREE: f64 = std::f64::consts::PI / 180.0;

impl Aiming {
    fn new(scene: &Ball2d, degrees: &[f64], aimed: usize) -> Option<Self> {
        let config = scene.config();
        let landing = Landing::of(&scene.table, config.drop_height, degrees, aimed)?;
        let reach = math::tan(DEGREE * (REACH_SD * config.sigma_theta_deg).min(REACH_DEG));
        Some(Self { landing, reach, sd: config.sigma_theta_deg, target: config.target, sigma: config.sigma_d })
    }

    /// ln of `exp(−½(θ/sd)²)/|dx/dθ|`, from tan θ.
    fn ln_weight(&self, t: f64) -> f64 {
        let z = math::atan(t) / (DEGREE * self.sd);
        -0.5 * z * z - math::ln(self.landing.at(t).1.abs())
    }

    /// ln of the sum of weights over the angles that land at `x`.
    fn ln_sum(&self, x: f64) -> f64 {
        let roots = self.landing.tangents(x, self.reach);
        roots.as_slice().iter().fold(f64::NEG_INFINITY, |sum, &t| math::ln_add_exp(sum, self.ln_weight(t)))
    }

    /// Draws an angle in degrees; `None` where the drawn place cannot be reached.
    fn sample(&self, stream: &mut Stream) -> Option<f64> {
        let x = self.target + self.sigma * standard_normal(stream);
        let roots = self.landing.tangents(x, self.reach);
        let roots = roots.as_slice();
        let t = if roots.len() < 2 {
            *roots.first()?
        } else {
            let threshold = math::ln(open_unit(stream)) + self.ln_sum(x);
            let mut sum = f64::NEG_INFINITY;
            *roots
                .iter()
                .find(|&&t| {
                    sum = math::ln_add_exp(sum, self.ln_weight(t));
                    sum >= threshold
                })
                .or(roots.last())?
        };
        Some(math::atan(t) / DEGREE)
    }

    /// Log density of `sample` at `degrees`, up to a constant of the scene.
    fn ln_density(&self, degrees: f64) -> f64 {
        let t = math::tan(DEGREE * degrees);
        if degrees.abs() >= 90.0 || t.abs() > self.reach {
            return f64::NEG_INFINITY;
        }
        let x = self.landing.at(t).0;
        let (z, off) = (degrees / self.sd, (x - self.target) / self.sigma);
        -0.5 * (z * z + off * off) - self.ln_sum(x)
    }
}

/// `ln q(from | to) − ln q(to | from)`.
fn ratio(scene: &Ball2d, from: &[f64], to: &[f64], choice: Choice) -> Result<LogRatio, ModelError> {
    let density = |degrees: &[f64]| {
        Aiming::new(scene, degrees, choice.aimed)
            .map_or(f64::NEG_INFINITY, |aiming| aiming.ln_density(degrees[choice.aimed]))
    };
    let (back, forth) = (density(from), density(to));
    if back == f64::NEG_INFINITY {
        return Ok(LogRatio::ZERO);
    }
    let mut redrawn = 0.0;
    for (index, (old, new)) in from.iter().zip(to).enumerate() {
        if choice.redraws(index) {
            redrawn += scene.angle().log_density(old)?.value() - scene.angle().log_density(new)?.value();
        }
    }
    Ok(LogRatio::new(back - forth + redrawn)?)
}

impl Move<Ball2d> for Aim {
    fn name(&self) -> &'static str {
        "aim"
    }

    fn propose(
        &self,
        scene: &Ball2d,
        current: &StateOf<Ball2d>,
        candidate: &mut Normals,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let choice = Choice::draw(candidate.0.len(), stream);
        for (index, angle) in candidate.0.iter_mut().enumerate() {
            if choice.redraws(index) {
                *angle = scene.angle().sample(stream);
            }
        }
        let aimed = Aiming::new(scene, &candidate.0, choice.aimed).and_then(|aiming| aiming.sample(stream));
        let Some(aimed) = aimed else { return Ok(Proposal::Stay) };
        candidate.0[choice.aimed] = aimed;
        let log_ratio = ratio(scene, &current.draw.0, &candidate.0, choice)?;
        Ok(Proposal::Candidate { log_ratio, path: choice.path(), later: None })
    }

    fn log_ratio(
        &self,
        scene: &Ball2d,
        from: &StateOf<Ball2d>,
        to: &StateOf<Ball2d>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        ratio(scene, &from.draw.0, &to.draw.0, Choice::of(path))
    }
}
