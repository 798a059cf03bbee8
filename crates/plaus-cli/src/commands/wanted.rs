//! Which run is asked for: a scenario, and the flags that change it. `plaus sample` and `plaus submit` share this, so
//! that they mean the same run.

use crate::failure::Failure;
use crate::scenario_file;
use plaus_mcmc::Plan;
use plaus_run::Recipe;
use std::path::PathBuf;

/// What to sample.
#[derive(Clone, clap::Args)]
pub(crate) struct Wanted {
    /// Scenario file (TOML); `plaus new` writes one
    pub(super) scenario: PathBuf,
    /// Seed of all randomness
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Number of independent chains
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    chains: Option<u64>,
    /// Iterations of each chain after the warm-up
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    iterations: Option<u64>,
    /// Iterations before sampling begins
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    warmup: Option<u64>,
    /// Record one in N iterations
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    thin: Option<u64>,
    /// Stop once K clearly different solutions are recorded. Where draws from the prior seldom succeed, each gets a
    /// search of its own, and carries no statistical weight
    #[arg(long, value_name = "K", value_parser = super::from_one, allow_negative_numbers = true)]
    pub(super) solutions: Option<u64>,
    /// With `--solutions`: count only sampled solutions, which represent the distribution
    #[arg(long, requires = "solutions")]
    exact: bool,
    /// Set any key of the scenario, e.g. `--set sigma_d=0.05`; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
}

impl Wanted {
    /// Reads the scenario for a chance, which has no chains; also gives the iterations of each rung.
    pub(super) fn of_chance(self) -> Result<(Recipe, Option<u64>), Failure> {
        let Self { chains, warmup, thin, solutions, iterations, .. } = &self;
        let of_runs = [("chains", chains), ("warmup", warmup), ("thin", thin), ("solutions", solutions)];
        if let Some((name, _)) = of_runs.iter().find(|(_, value)| value.is_some()) {
            return Err(Failure::Message(format!("--{name} is for a run; it cannot be used with --chance")));
        }
        let iterations = *iterations;
        Ok((Self { iterations: None, ..self }.recipe(false)?, iterations))
    }

    /// Whether the command line says how many iterations there are.
    fn says_iterations(&self) -> bool {
        let is_said = |said: &String| matches!(said.split('=').next(), Some("iterations" | "sampler.iterations"));
        self.iterations.is_some() || self.overrides.iter().any(is_said)
    }

    /// Reads the scenario, and applies all that the command line says. A run that looks for solutions for a given time
    /// does so for all of it: the scenario's number of iterations does not end it. (Pieces of a run keep theirs.)
    pub(super) fn recipe(self, has_time: bool) -> Result<Recipe, Failure> {
        let is_endless = has_time && self.solutions.is_some() && !self.says_iterations();
        let flags = [
            ("seed", self.seed),
            ("chains", self.chains),
            ("iterations", if is_endless { Some(Plan::ENDLESS) } else { self.iterations }),
            ("warmup", self.warmup),
            ("thin", self.thin),
        ];
        let given = flags.into_iter().filter_map(|(key, value)| {
            let value = value?;
            Some((format!("sampler.{key}={value}"), format!("--{key} {value}")))
        });
        let exact = self.exact.then(|| ("sampler.sampled_only=true".to_owned(), "--exact".to_owned()));
        let given: Vec<(String, String)> = given.chain(exact).collect();
        let overrides = [self.overrides, given.iter().map(|(key, _)| key.clone()).collect()].concat();
        let recipe = scenario_file::read(&self.scenario, overrides, self.solutions);
        recipe.map_err(|failure| failure.naming(&given))
    }
}
