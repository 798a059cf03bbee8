//! The paper's 2D ball (sections 3 and 5.1): where it comes to rest is demanded, the table's normals are uncertain.

mod animate;
mod config;
mod flight;
mod moves;

pub use config::{Config, Downward, MAX_COLLISIONS, Moves, Weights};
pub use moves::{Aim, Perturb, Redraw};

use crate::animation::Animation;
use crate::require::{Cast, Require, RestsAt};
use crate::rules::Rules;
use crate::scene::{ConfigError, Role, Scalar, Scene};
use flight::Table;
use glam::DVec2;
use plaus_dist::{Density, Gaussian, LogDensity, LogPotential, NotANumber, Sample, Stream};
use plaus_mcmc::{Goal, Mixture, ModelError, Simulated, SolutionClass, StateOf, Target};
use serde::{Deserialize, Serialize};

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.806_65;

/// The 2D ball.
///
/// `log p = −½((x − target)/σ_d)² + Σ log N(θ_i; 0, σ_θ)`, with x the place of the collision after the last bounce.
#[derive(Debug, Clone)]
pub struct Ball2d {
    config: Config,
    table: Table,
    angle: Gaussian,
    /// tan of the largest angle [`Aim`] looks for.
    reach: f64,
}

/// Angles of the normals from the vertical, in degrees, in order of the bounces.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Normals(pub Vec<f64>);

impl Normals {
    /// Unit vectors.
    fn directions(&self) -> impl Iterator<Item = DVec2> {
        self.0.iter().map(|&degrees| flight::normal(degrees))
    }
}

impl Clone for Normals {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
    fn clone_from(&mut self, source: &Self) {
        self.0.clone_from(&source.0);
    }
}

/// What became of the ball.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Rest {
    /// Where it came to rest, in D; `None` where a downward normal rejected the draw.
    pub x: Option<f64>,
    /// Which bounces the rule for downward normals decided: bit i for bounce i, counted from 0.
    pub downward: u64,
}

impl Ball2d {
    /// The scene of a configuration whose keys are each in range.
    ///
    /// # Errors
    /// [`ConfigError`] where a key is out of the range its documentation states.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        let angle = Gaussian::new(0.0, config.sigma_theta_deg)
            .map_err(|error| ConfigError::new("world.ball2d.sigma_theta_deg", error))?;
        Gaussian::new(config.target, config.sigma_d)
            .map_err(|error| ConfigError::new("world.ball2d.sigma_d", error))?;
        if !(1..=MAX_COLLISIONS).contains(&config.collisions) {
            let message = format!("{} is not between 1 and {MAX_COLLISIONS}", config.collisions);
            return Err(ConfigError::new("world.ball2d.collisions", message));
        }
        for (key, value, ok) in [
            ("drop_height", config.drop_height, config.drop_height > 0.0),
            ("restitution", config.restitution, (0.0..=1.0).contains(&config.restitution)),
            ("tolerance", config.tolerance, config.tolerance > 0.0),
            ("step_deg", config.step_deg, config.step_deg > 0.0),
            ("distinct_cell", config.distinct_cell, config.distinct_cell > 0.0),
            ("diameter_m", config.diameter_m, config.diameter_m > 0.0),
        ] {
            if !ok || !value.is_finite() {
                return Err(ConfigError::new(format!("world.ball2d.{key}"), format!("{value} is out of range")));
            }
        }
        let table = Table { restitution: config.restitution, downward: config.downward };
        let reach = moves::reach(config.sigma_theta_deg);
        Ok(Self { config: config.clone(), table, angle, reach })
    }

    /// The configuration.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// The law of each angle, in degrees.
    #[must_use]
    pub fn angle(&self) -> &Gaussian {
        &self.angle
    }

    /// Places of the bounces and, last, of the rest, in D; empty where a downward normal rejects the draw.
    #[must_use]
    pub fn path(&self, draw: &Normals) -> Vec<f64> {
        let mut places = Vec::with_capacity(draw.0.len() + 1);
        let rest = flight::fly(&self.table, self.config.drop_height, draw.directions(), |x, _, _| places.push(x));
        match rest {
            Some(x) => places.push(x),
            None => places.clear(),
        }
        places
    }
}

impl Target for Ball2d {
    type Draw = Normals;
    type Outcome = Rest;
    type Scratch = ();

    fn start(&self, stream: &mut Stream) -> Normals {
        Normals((0..self.config.collisions).map(|_| self.angle.sample(stream)).collect())
    }

    fn log_prior(&self, draw: &Normals) -> Result<LogDensity, ModelError> {
        let sum = draw.0.iter().try_fold(LogDensity::ONE, |sum, angle| Ok(sum + self.angle.log_density(angle)?));
        sum.map_err(|error: NotANumber| error.into())
    }

    fn simulate(
        &self,
        draw: &Normals,
        _current: Option<&StateOf<Self>>,
        _floor: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<Rest>, ModelError> {
        let (x, downward) = flight::rest(&self.table, self.config.drop_height, draw.directions());
        Ok(Simulated::Complete(Rest { x, downward }))
    }

    fn log_constraint(&self, outcome: &Rest) -> Result<LogPotential, ModelError> {
        let Some(x) = outcome.x else { return Ok(LogPotential::ZERO) };
        let z = (x - self.config.target) / self.config.sigma_d;
        Ok(LogPotential::new(-0.5 * z * z)?)
    }
}

/// Solutions are told apart by the cells their bounces fall into.
impl Goal for Ball2d {
    fn class(&self, state: &StateOf<Self>) -> Option<SolutionClass> {
        let x = state.outcome.x?;
        if (x - self.config.target).abs() >= self.config.tolerance {
            return None;
        }
        let per_cell = 1.0 / self.config.distinct_cell;
        let mut class = SolutionClass::EMPTY;
        flight::fly(&self.table, self.config.drop_height, state.draw.directions(), |place, _, _| {
            class = class.with((place * per_cell).floor() as i64);
        });
        Some(class)
    }
}

impl Scene for Ball2d {
    const NUMBERED: &'static str = "bounce";

    fn moves(&self, rules: &Rules) -> Result<Mixture<Self>, ConfigError> {
        let perturb = Box::new(Perturb::new(self.config.step_deg));
        let Weights { perturb: often, redraw, aim } = self.config.weights;
        match self.config.moves {
            Moves::Paper => Ok(Mixture::of(perturb)),
            Moves::Mixed => Mixture::new(vec![
                (often, perturb),
                (redraw, Box::new(Redraw { symmetric: rules.symmetric_redraws() })),
                (aim, Box::new(Aim)),
            ])
            .map_err(|error| ConfigError::new("world.ball2d.weights", error)),
        }
    }

    fn scalars(&self) -> Vec<Scalar> {
        let angle = |i| Scalar { name: format!("theta_{i}"), unit: "degree", role: Role::Draw };
        let rest = Scalar { name: "rest_x".into(), unit: "D", role: Role::Outcome };
        std::iter::once(rest).chain((1..=self.config.collisions).map(angle)).collect()
    }

    fn write_scalars(&self, state: &StateOf<Self>, values: &mut [f64]) {
        if let Some((rest, angles)) = values.split_first_mut() {
            *rest = state.outcome.x.unwrap_or(f64::NAN);
            angles.copy_from_slice(&state.draw.0);
        }
    }

    fn cast(&self) -> Cast {
        Cast { bodies: vec!["ball_0".into()], fixed: vec!["table".into()], longest: f64::INFINITY, faces: false }
    }

    fn most(&self) -> Option<LogPotential> {
        Some(LogPotential::ONE)
    }

    /// Where the ball comes to rest.
    fn demands(&self) -> Vec<(String, Require)> {
        let millimetres = 1e3 * self.config.diameter_m;
        let (x_mm, within_mm) = (self.config.target * millimetres, self.config.tolerance * millimetres);
        vec![("world.ball2d.target".into(), Require::RestsAt(RestsAt { x_mm, within_mm, ..RestsAt::default() }))]
    }

    fn animate(&self, draw: &Normals) -> Result<Animation, ModelError> {
        animate::animate(&self.config, &self.table, draw)
    }
}
