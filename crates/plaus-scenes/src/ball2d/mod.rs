//! The paper's 2D ball (sections 3 and 5.1): its resting place is asked for, the table's normals are uncertain.

mod animate;
mod config;
mod flight;
mod moves;
mod physics;

pub use config::{Config, Downward, MAX_COLLISIONS};
pub use moves::{Aim, Ball2dMoves};

/// Weights of the 2D ball's moves.
pub type Weights = crate::Weights<Ball2dMoves>;

use crate::animation::{Animation, Physics};
use crate::in_place::clone_in_place;
use crate::model::{Column, Features, Scalar, columns, distinct};
use crate::require::{Cast, Mark, Missed, Require, RestsAt};
use crate::rules::Rules;
use crate::scene::{ConfigError, Scene};
use flight::Table;
use glam::DVec2;
use plaus_dist::{Density, Gaussian, LogDensity, LogPotential, NotANumber, Stream};
use plaus_mcmc::{
    Goal, Law, Mixture, ModelError, Recipe, Simulated, SolutionClass, StateRefOf, Target, Var, Variables, Vars,
};
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
    vars: Vars,
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

clone_in_place!(Normals { 0 });

/// The outcome for the ball.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Rest {
    /// Where it came to rest, in D; `None` if a downward normal rejected the draw.
    pub x: Option<f64>,
    /// The bounces that were decided by the rule for downward normals: bit i for bounce i, counted from 0.
    pub downward: u64,
}

impl Ball2d {
    /// The scene of a configuration whose keys are each in range.
    ///
    /// # Errors
    /// [`ConfigError`] if a key is out of the range its documentation states.
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
        let theta = |bounce| Var::new("theta", "degree", Law::Gaussian(angle)).of("bounce", bounce).column(1.0);
        let vars = Vars::new((1..=config.collisions).map(theta).collect());
        Ok(Self { config: config.clone(), table, angle, vars, reach })
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

    /// How far beyond the tolerance the ball rests, in D; infinite if it has no resting place.
    fn off(&self, rest: &Rest) -> f64 {
        let off = |x: f64| {
            if self.config.constrained.unwrap_or(true) {
                (x - self.config.target).abs() - self.config.tolerance
            } else {
                -1.0
            }
        };
        rest.x.map_or(f64::INFINITY, off)
    }

    /// Places of the bounces and finally the resting place, in D; empty if a downward normal rejects the draw.
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
        let mut draw = Normals(vec![0.0; self.vars.len()]);
        self.renew_all(&mut draw, Recipe::Exact, stream);
        draw
    }

    fn log_prior(&self, draw: &Normals) -> Result<LogDensity, ModelError> {
        // What `vars::log_prior` sums; looking each variable up would cost a tenth of this scene's time.
        let sum = draw.0.iter().try_fold(LogDensity::ONE, |sum, angle| Ok(sum + self.angle.log_density(angle)?));
        sum.map_err(|error: NotANumber| error.into())
    }

    fn simulate(
        &self,
        draw: &Normals,
        _current: Option<StateRefOf<'_, Self>>,
        _floor: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<Rest>, ModelError> {
        let (x, downward) = flight::rest(&self.table, self.config.drop_height, draw.directions());
        Ok(Simulated::Complete(Rest { x, downward }))
    }

    fn log_constraint(&self, outcome: &Rest) -> Result<LogPotential, ModelError> {
        let Some(x) = outcome.x else { return Ok(LogPotential::ZERO) };
        if !self.config.constrained.unwrap_or(true) {
            return Ok(LogPotential::ONE);
        }
        let z = (x - self.config.target) / self.config.sigma_d;
        Ok(LogPotential::new(-0.5 * z * z)?)
    }

    fn most(&self) -> Option<LogPotential> {
        Some(LogPotential::ONE)
    }

    fn numbers(&self, state: StateRefOf<'_, Self>) -> Vec<f64> {
        crate::scene::numbers(self, state)
    }
}

impl Variables for Ball2d {
    #[inline]
    fn vars(&self) -> &Vars {
        &self.vars
    }

    #[inline]
    fn get<'a>(&self, draw: &'a Normals, var: usize) -> Option<&'a [f64]> {
        draw.0.get(var).map(std::slice::from_ref)
    }

    #[inline]
    fn get_mut<'a>(&self, draw: &'a mut Normals, var: usize) -> Option<&'a mut [f64]> {
        draw.0.get_mut(var).map(std::slice::from_mut)
    }
}

impl Goal for Ball2d {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        distinct::class(self, state, 1.0)
    }
}

impl Scene for Ball2d {
    fn moves(&self, rules: &Rules) -> Result<Mixture<Self>, ConfigError> {
        self.config.weights.mix(self.config.moves, self, moves::all(self, rules))
    }

    fn scalars(&self) -> Vec<Scalar> {
        columns::scalars(vec![Column::result("rest_x", "D").of(None)], &self.vars)
    }

    fn write_scalars(&self, state: StateRefOf<'_, Self>, values: &mut [f64]) {
        if let Some((rest, angles)) = values.split_first_mut() {
            *rest = state.outcome.x.unwrap_or(f64::NAN);
            angles.copy_from_slice(&state.draw.0);
        }
    }

    /// The cells of the bounces.
    fn features(&self, state: StateRefOf<'_, Self>, features: &mut Features) -> bool {
        let is_met = self.off(state.outcome) < 0.0;
        let per_cell = 1.0 / self.config.distinct_cell;
        if is_met {
            let (height, directions) = (self.config.drop_height, state.draw.directions());
            flight::fly(&self.table, height, directions, |place, _, _| features.place(place * per_cell));
        }
        is_met
    }

    fn cast(&self) -> Cast {
        let (bodies, fixed) = (vec!["ball_0".into()], vec!["table".into()]);
        Cast { bodies, fixed, turns: false, ..Cast::default() }
    }

    /// Where the ball comes to rest.
    fn demands(&self) -> Vec<(String, Require)> {
        let millimetres = 1e3 * self.config.diameter_m;
        let (x_mm, within_mm) = (self.config.target * millimetres, self.config.tolerance * millimetres);
        let rests = Require::RestsAt(RestsAt { x_mm, within_mm, ..RestsAt::default() });
        self.config.constrained.unwrap_or(true).then(|| ("world.ball2d.target".into(), rests)).into_iter().collect()
    }

    fn asked(&self) -> Vec<String> {
        let key = self.demands().pop().map(|(key, _)| key);
        vec![key.unwrap_or_else(|| "the ball comes to rest".into())]
    }

    fn missed(&self, _: usize, margin: f64) -> Option<Missed> {
        Some(Missed::lacking(margin, "D"))
    }

    /// The margin is minus the distance that is too much, in D.
    fn answers(&self, state: StateRefOf<'_, Self>) -> Vec<Mark> {
        let off = self.off(state.outcome);
        vec![Mark::of(if off < 0.0 { 0.0 } else { -off.max(f64::MIN_POSITIVE) })]
    }

    fn animate(&self, draw: &Normals) -> Result<Animation, ModelError> {
        animate::animate(&self.config, &self.table, draw)
    }

    fn physics(&self, draw: &Normals) -> Result<Option<Physics>, ModelError> {
        physics::physics(&self.config, &self.motion(draw)?).map(Some).map_err(ModelError::new)
    }
}
