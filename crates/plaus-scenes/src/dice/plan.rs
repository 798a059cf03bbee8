//! What follows from a configuration, computed once.

use super::config::{Config, MOST_DICE};
use super::constraint::{Constraint, Mark};
use super::flight::{Asked, Looking, Trip};
use super::prior::Prior;
use super::surface::Surface;
use super::symmetry::Rotation;
use crate::scene::ConfigError;
use glam::DVec3;
use plaus_sim::Accuracy;
use plaus_sim::shape::{Cuboid, Shape};

/// A constraint with its die, and the index of its answer.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Demand {
    pub(super) constraint: Constraint,
    /// From 0 on.
    pub(super) die: usize,
    slot: usize,
}

impl Demand {
    pub(super) fn mark(&self, trip: &Trip, pips: &Rotation, offset: DVec3) -> Mark {
        self.constraint.mark(trip, pips, self.slot, offset)
    }

    /// What a trip that misses it lacks, in words.
    pub(super) fn lacks(&self, trip: &Trip, pips: &Rotation, offset: DVec3) -> String {
        self.constraint.lacks(trip, pips, self.slot, offset)
    }
}

#[derive(Debug)]
pub(super) struct Plan {
    pub(super) surface: Surface,
    pub(super) cuboid: Cuboid,
    pub(super) rotations: Vec<Rotation>,
    pub(super) demands: Vec<Demand>,
    /// What is asked about each die's path.
    pub(super) asked: Vec<Asked>,
    /// Where each die should come to rest, in m, according to the first constraint that says so.
    pub(super) places: Vec<Option<[f64; 2]>>,
    pub(super) looking: Looking,
    pub(super) accuracy: Accuracy,
    pub(super) together: bool,
    pub(super) longest: f64,
    pub(super) density: f64,
}

/// Room between a die at its release and the highest bump, in m.
const CLEARANCE: f64 = 1e-4;

impl Plan {
    pub(super) fn new(config: &Config) -> Result<Self, ConfigError> {
        if !(1..=MOST_DICE).contains(&config.dice) {
            return Err(ConfigError::new(
                "world.dice.dice",
                format!("{} is not between 1 and {MOST_DICE}", config.dice),
            ));
        }
        let edges = edges(config);
        let (rounding, shortest) = (config.die.rounding_mm, edges.min_element() * 1e3);
        if 2.0 * rounding >= shortest {
            let message = format!(
                "{rounding} mm is too much: it must be less than half the shortest edge, {} mm",
                0.5 * shortest
            );
            return Err(ConfigError::new("world.dice.die.rounding_mm", message));
        }
        let cuboid = Cuboid::new(edges, rounding * 1e-3)
            .map_err(|error| ConfigError::new("world.dice.die.rounding_mm", error))?;
        let demands = demands(config)?;
        let mut asked = vec![Asked::default(); config.dice as usize];
        let mut places = vec![None; config.dice as usize];
        let demand = |(constraint, die): (Constraint, usize)| {
            let asked = &mut asked[die];
            let slot = match &constraint {
                Constraint::PoseAt(pose) => push(&mut asked.times, pose.time_s),
                Constraint::Passes(at) => push(&mut asked.points, DVec3::new(at.x_mm, at.y_mm, at.z_mm) * 1e-3),
                Constraint::RestAt(at) => {
                    places[die].get_or_insert([at.x_mm * 1e-3, at.y_mm * 1e-3]);
                    0
                }
                _ => 0,
            };
            Demand { constraint, die, slot }
        };
        let demands = demands.into_iter().map(demand).collect();
        Ok(Self {
            surface: Surface::new(config)?,
            rotations: Rotation::of_cuboid(edges),
            cuboid,
            demands,
            asked,
            places,
            looking: Looking {
                edge: [config.table.length_mm, config.table.width_mm].map(|side| side * 0.5e-3),
                cell: config.distinct_cell_mm * 1e-3,
                every: config.distinct_every_s,
            },
            accuracy: config.accuracy.tolerances(),
            together: config.together && config.dice > 1,
            longest: config.longest_s,
            density: config.die.density,
        })
    }

    /// The prior, with heights of release clear of the table.
    pub(super) fn prior(&self, config: &Config) -> Result<Prior, ConfigError> {
        let reach = self.reach_of_die();
        let lowest = self.surface.highest() + reach + CLEARANCE;
        let bad = |error| ConfigError::new("world.dice.throw", error);
        let config = Config { together: self.together, ..config.clone() };
        Prior::new(&config, lowest, self.rotations.len(), 2.0 * (reach + CLEARANCE)).map_err(bad)
    }

    /// Whether each die has a random table of its own, so that both can be shifted together.
    pub(super) fn carries(&self) -> bool {
        !self.together && !self.surface.random.is_empty()
    }

    /// Radius of the sphere about a die's middle that holds it, in m.
    pub(super) fn reach_of_die(&self) -> f64 {
        Shape::Cuboid(self.cuboid).reach()
    }

    /// The indices of the table's control points along x and y go from minus these to these.
    pub(super) fn reach(&self) -> [i32; 2] {
        self.looking.edge.map(|half| (half / self.surface.spacing()).ceil() as i32)
    }
}

/// Appends a value; gives its index.
fn push<T>(list: &mut Vec<T>, value: T) -> usize {
    list.push(value);
    list.len() - 1
}

/// A die's edges in m.
fn edges(config: &Config) -> DVec3 {
    DVec3::new(config.die.edge_x_mm, config.die.edge_y_mm, config.die.edge_z_mm) * 1e-3
}

/// The constraints with the index of the die each is about.
fn demands(config: &Config) -> Result<Vec<(Constraint, usize)>, ConfigError> {
    let demand = |(k, constraint): (usize, &Constraint)| {
        let blame = |key: &str, message: String| {
            let name = constraint.name();
            Err(ConfigError::new(format!("world.dice.constraints[{k}].{name}.{key}"), message))
        };
        let die = constraint.die();
        if !(1..=config.dice).contains(&die) {
            return blame("die", format!("there is no die {die}: dice are numbered from 1 to {}", config.dice));
        }
        let Constraint::RestAt(at) = constraint else {
            return match constraint {
                Constraint::FaceUp(up) if !(1..=6).contains(&up.face) => {
                    blame("face", format!("a die has no face {}: faces are 1 to 6", up.face))
                }
                _ => Ok((*constraint, die as usize - 1)),
            };
        };
        let table = &config.table;
        for (key, at, side) in [("x_mm", at.x_mm, table.length_mm), ("y_mm", at.y_mm, table.width_mm)] {
            if at.is_nan() || at.abs() > 0.5 * side {
                let message =
                    format!("{at} mm is off the table, which reaches from {} to {} mm", -0.5 * side, 0.5 * side);
                return blame(key, message);
            }
        }
        Ok((*constraint, die as usize - 1))
    };
    config.constraints.iter().enumerate().map(demand).collect()
}
