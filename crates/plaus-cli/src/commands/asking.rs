//! The flags that ask for a chance. `plaus chance` and `plaus submit --chance` share them, so that both mean the same.

use plaus_mcmc::chance::Method;
use plaus_run::chance::Asking;

/// Methods, and how much work each does.
#[derive(Debug, Clone, PartialEq, Eq, Default, clap::Args)]
pub(crate) struct How {
    /// Use this method; may be given several times. By default: counting; all of them if few draws hit
    #[arg(long, value_name = "METHOD", value_enum)]
    method: Vec<Way>,
    /// Batches of each method, independent of each other and equally long. Four times as many halve the error
    #[arg(long, value_name = "B", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    batches: Option<u32>,
    /// Draws in each batch of counting, and of importance sampling
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    draws: Option<u64>,
    /// Particles in each batch of splitting
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000_000))]
    particles: Option<u32>,
    /// Steps that each copied particle makes
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    steps: Option<u64>,
    /// Rungs in each batch of stepping stones
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=256))]
    rungs: Option<u32>,
}

/// A method, under its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Way {
    /// Draw from the prior and count the hits
    Counting,
    /// Let particles climb the constraint
    Splitting,
    /// Run chains on a ladder between prior and target
    Stones,
    /// Draw from a widened prior and weight the hits
    Importance,
}

impl From<Way> for Method {
    fn from(way: Way) -> Self {
        match way {
            Way::Counting => Self::Counting,
            Way::Splitting => Self::Splitting,
            Way::Stones => Self::Stones,
            Way::Importance => Self::Importance,
        }
    }
}

impl How {
    /// The methods asked for. An empty list lets the program choose.
    pub(super) fn methods(&self) -> Vec<Method> {
        self.method.iter().copied().map(Method::from).collect()
    }

    /// What is asked: the defaults in `asking`, with the flags' values in their place. `iterations` is the number for
    /// each rung.
    pub(super) fn asking(&self, mut asking: Asking, iterations: Option<u64>) -> Asking {
        let Asking { batches, draws, splitting, stones, .. } = &mut asking;
        *batches = self.batches.unwrap_or(*batches);
        *draws = self.draws.unwrap_or(*draws);
        splitting.particles = self.particles.unwrap_or(splitting.particles);
        splitting.steps = self.steps.unwrap_or(splitting.steps);
        stones.rungs = self.rungs.unwrap_or(stones.rungs);
        stones.iterations = iterations.unwrap_or(stones.iterations);
        stones.warmup = stones.iterations / 4;
        asking
    }

    /// The flags that say the same, one word each.
    pub(super) fn words(&self) -> Vec<String> {
        let Self { method, batches, draws, particles, steps, rungs } = self;
        let named = |way: &Way| {
            let name = clap::ValueEnum::to_possible_value(way).map(|value| value.get_name().to_owned());
            format!("--method={}", name.unwrap_or_default())
        };
        let numbers = [
            ("batches", batches.map(u64::from)),
            ("draws", *draws),
            ("particles", particles.map(u64::from)),
            ("steps", *steps),
            ("rungs", rungs.map(u64::from)),
        ];
        let numbers = numbers.into_iter().filter_map(|(name, number)| Some(format!("--{name}={}", number?)));
        method.iter().map(named).chain(numbers).collect()
    }
}
