//! Dice on random tables: figure 9, the table's surface, how fast solutions come, and which bumps steer a die.

mod composite;
mod confirmed;
mod hits;
mod mixing;
mod posterior;
mod sensitivity;
mod steering;
mod surface;

use crate::{Make, Result, Work};
use plaus_dist::Seed;
use plaus_mcmc::{Chain, Goal, Mixture, StateOf};
use plaus_scenes::dice::{Config, Dice};
use plaus_scenes::{Rules, Scenario, Scene, World};

/// The scenarios, as users run them.
const ONE: &str = include_str!("../../../../scenarios/dice-one.toml");
const SIX: &str = include_str!("../../../../scenarios/dice-six.toml");
const TOGETHER: &str = include_str!("../../../../scenarios/dice-six-together.toml");

/// A scenario with its moves.
struct Thrown {
    scene: Dice,
    moves: Mixture<Dice>,
}

impl Thrown {
    fn new(scenario: &str, change: impl FnOnce(&mut Config)) -> Result<Self> {
        let scenario = Scenario::read("a scenario of dice", scenario, &[])?;
        let World::Dice(mut config) = scenario.world else { return Err("the scenario is of no dice".into()) };
        change(&mut config);
        let scene = Dice::new(&config)?;
        let moves = scene.moves(&Rules::exact())?;
        Ok(Self { scene, moves })
    }

    /// The first solution of a chain, with its iteration; if there is none up to `limit`, the last state.
    fn solution(&self, seed: u64, limit: u64) -> Result<(u64, StateOf<Dice>)> {
        let mut chain = Chain::start(&self.scene, &self.moves, Seed(seed).chain(0))?;
        while chain.iteration() < limit && self.scene.class(chain.state().by_ref()).is_none() {
            chain.step()?;
        }
        Ok((chain.iteration(), chain.state().clone()))
    }
}

/// Parts of the scene's figures by name, as in `--only dice/steering`. Slow parts come last.
const PARTS: &[(&str, Make)] = &[
    ("composite", composite::make),
    ("surface", surface::make),
    ("hits", hits::make),
    ("mixing", mixing::make),
    ("confirmed", confirmed::make),
    ("steering", steering::make),
];

pub(crate) fn make(work: &mut Work) -> Result<()> {
    work.make_parts("dice", PARTS)
}
