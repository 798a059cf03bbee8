//! The paper's three shots, and two ways to look for them: by chains, and by drawing from the prior until one comes.

use crate::Result;
use crate::clock::seconds;
use crate::sampler::Sampler;
use plaus_dist::{LogPotential, Purpose, Seed};
use plaus_mcmc::{Chain, Decision, Goal, Simulated, SolutionClass, StateOf, Target};
use plaus_scenes::bowling::{Bowling, Config, Work};
use plaus_scenes::{Animation, Scenario, World};
use std::collections::BTreeSet;

/// A scenario that comes with plaus.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shot {
    /// Its name.
    pub(super) name: &'static str,
    /// Its file.
    pub(super) file: &'static str,
    text: &'static str,
}

macro_rules! shot {
    ($name:literal, $file:literal) => {
        Shot { name: $name, file: $file, text: include_str!(concat!("../../../../scenarios/", $file)) }
    };
}

pub(super) const STRIKE: Shot = shot!("strike", "bowling-strike.toml");
pub(super) const LEAVE: Shot = shot!("leave 6-7", "bowling-leave-6-7.toml");
pub(super) const SPARE: Shot = shot!("spare 6-7", "bowling-spare-6-7.toml");
pub(super) const SEVEN_TEN: Shot = shot!("spare 7-10", "bowling-spare-7-10.toml");
pub(super) const SEVEN_TEN_PAPER: Shot = shot!("spare 7-10, the paper's delivery", "bowling-spare-7-10-paper.toml");

pub(super) type Bowler = Sampler<Bowling>;

impl Shot {
    /// The scenario's scene.
    pub(super) fn bowler(self) -> Result<Bowler> {
        self.bowler_with(|_| ())
    }

    /// The scenario's scene, with changes.
    pub(super) fn bowler_with(self, change: impl FnOnce(&mut Config)) -> Result<Bowler> {
        let World::Bowling(mut config) = Scenario::read(self.file, self.text, &[])?.world else {
            return Err(format!("{} is not about bowling", self.file).into());
        };
        change(&mut config);
        Sampler::new(Bowling::new(&config)?)
    }
}

/// The result of looking for solutions for some time.
#[derive(Debug, Default)]
pub(super) struct Haul {
    pub(super) seconds: f64,
    /// Number of draws proposed or made.
    pub(super) draws: u64,
    /// Number of iterations at a solution, or of draws that are one.
    pub(super) hits: u64,
    pub(super) classes: BTreeSet<SolutionClass>,
}

impl Haul {
    pub(super) fn distinct_a_minute(&self) -> f64 {
        60.0 * self.classes.len() as f64 / self.seconds
    }

    pub(super) fn add(&mut self, other: Self) {
        self.seconds += other.seconds;
        self.draws += other.draws;
        self.hits += other.hits;
        self.classes.extend(other.classes);
    }
}

/// Until when to look.
#[derive(Debug, Clone, Copy)]
pub(super) enum Until {
    Seconds(f64),
    Draws(u64),
}

impl Until {
    fn is_over(self, haul: &Haul) -> bool {
        match self {
            Self::Seconds(most) => haul.seconds >= most,
            Self::Draws(most) => haul.draws >= most,
        }
    }
}

/// What a chain finds from its start on; its solutions are passed to `see`.
pub(super) fn by_chain(
    bowler: &Bowler,
    seed: u64,
    until: Until,
    mut see: impl FnMut(&StateOf<Bowling>) -> Result<()>,
) -> Result<Haul> {
    let begin = seconds();
    let mut chain = Chain::start(&bowler.scene, &bowler.moves, Seed(seed).chain(0))?;
    let mut haul = Haul::default();
    let mut class = bowler.scene.class(chain.state().by_ref());
    while !until.is_over(&haul) {
        if chain.step()?.decision == Decision::Accepted {
            class = bowler.scene.class(chain.state().by_ref());
        }
        if let Some(class) = class {
            haul.hits += 1;
            haul.classes.insert(class);
            see(chain.state())?;
        }
        haul.draws += 1;
        haul.seconds = seconds() - begin;
    }
    Ok(haul)
}

/// What independent draws of the prior find; as in a chain, a shot ends as soon as it can no longer be a solution.
pub(super) fn by_rejection(bowler: &Bowler, seed: u64, until: Until) -> Result<Haul> {
    let (begin, scene) = (seconds(), &bowler.scene);
    let (mut haul, mut work) = (Haul::default(), Work::default());
    let floor = just_short(scene)?;
    while !until.is_over(&haul) {
        let draw = scene.start(&mut Seed(seed).chain(haul.draws).at(0, Purpose::START));
        if let Simulated::Complete(outcome) = scene.simulate(&draw, None, floor, &mut work)? {
            let (log_prior, log_constraint) = (scene.log_prior(&draw)?, scene.log_constraint(&outcome)?);
            let class = scene.class(StateOf::<Bowling> { draw, outcome, log_prior, log_constraint }.by_ref());
            haul.hits += u64::from(class.is_some());
            haul.classes.extend(class);
        }
        haul.draws += 1;
        haul.seconds = seconds() - begin;
    }
    Ok(haul)
}

/// The reward of an outcome with one fault, a pin that should have fallen or should have stayed. A solution exceeds it.
fn just_short(scene: &Bowling) -> Result<LogPotential> {
    let left = scene.rack().leave().iter().filter(|leave| **leave).count();
    let all = (scene.rack().pins().len() + left) as f64;
    Ok(LogPotential::new((all - 1.0) * scene.config().ln_lambda)?)
}

/// When two bodies first touch, by the names that they have in an animation.
pub(super) fn first_touch(animation: &Animation, name: &str, other: impl Fn(&str) -> bool) -> Option<f64> {
    let pair = |a: &str, b: &str| a == name && other(b);
    let touch = animation.motion.impacts.iter().find(|i| pair(&i.body, &i.other) || pair(&i.other, &i.body));
    touch.map(|impact| impact.time)
}

/// Whether a body is a pin.
pub(super) fn is_pin(name: &str) -> bool {
    name.starts_with("pin_")
}
