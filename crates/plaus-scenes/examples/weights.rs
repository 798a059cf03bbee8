//! What other weights of moves are worth: each file with and without some overrides, by turns, on one core.
//!
//!     cargo run --release -p plaus-scenes --example weights -- 10 6 world.custom.weights.unmet=0 W
//!
//! for a file W. Arguments: seconds of processor time for each seed and side, seeds, overrides (all arguments with
//! `=`), and files.
//! Both sides of a seed have the same time, in slices of a tenth of a second by turns. Printed are the numbers of
//! distinct solutions and of hits, of all seeds, without and with the overrides; the ratio of distinct solutions with
//! its standard error over seeds; and for how many seconds each side looked for its first solution, in the mean.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod shared;

use plaus_dist::{Seed, math};
use plaus_mcmc::{Chain, Goal, SolutionClass};
use plaus_scenes::{Rules, Scenario, Scene, Stage};
use shared::seconds;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Processor time after which the other side goes on.
const SLICE: f64 = 0.1;

/// What one side of a seed found.
#[derive(Debug, Default)]
struct Found {
    seconds: f64,
    hits: u64,
    classes: BTreeSet<SolutionClass>,
    first: Option<f64>,
}

impl Found {
    /// Lets the chain run for a slice of time.
    fn go_on(&mut self, chain: &mut Chain<'_, Stage>, stage: &Stage) -> Result<()> {
        let begin = seconds();
        loop {
            chain.step()?;
            let now = seconds() - begin;
            if let Some(class) = stage.class(chain.state().by_ref()) {
                self.hits += 1;
                self.classes.insert(class);
                self.first.get_or_insert(self.seconds + now);
            }
            if now > SLICE {
                self.seconds += now;
                return Ok(());
            }
        }
    }
}

/// The scenario at a path, with files beside it.
fn read(path: &str, overrides: &[String]) -> Result<Stage> {
    let folder = Path::new(path).parent().map(Path::to_path_buf).unwrap_or_default();
    let beside = move |file: &str, _: bool| {
        std::fs::read(folder.join(file)).map(Arc::<[u8]>::from).map_err(|error| error.to_string())
    };
    Ok(Scenario::read_with(path, &std::fs::read_to_string(path)?, overrides, &beside)?.stage()?)
}

fn compare(path: &str, overrides: &[String], time: f64, seeds: u64) -> Result<()> {
    let sides = [read(path, &[])?, read(path, overrides)?];
    let (mut all, mut logs) = ([Found::default(), Found::default()], Vec::new());
    let mut waits = [0.0; 2];
    let (mut distinct, rules) = ([0; 2], Rules::default());
    for seed in 0..seeds {
        let mut found = [Found::default(), Found::default()];
        let moves = [sides[0].moves(&rules)?, sides[1].moves(&rules)?];
        let start = |k: usize| Chain::start(&sides[k], &moves[k], Seed(seed).chain(0));
        let mut chains = [start(0)?, start(1)?];
        while found.iter().any(|found| found.seconds < time) {
            for k in 0..2 {
                if found[k].seconds < time {
                    found[k].go_on(&mut chains[k], &sides[k])?;
                }
            }
        }
        let rate = |found: &Found| (found.classes.len().max(1)) as f64 / found.seconds;
        logs.push(math::ln(rate(&found[0]) / rate(&found[1])));
        for k in 0..2 {
            all[k].seconds += found[k].seconds;
            all[k].hits += found[k].hits;
            distinct[k] += found[k].classes.len();
            waits[k] += found[k].first.unwrap_or(found[k].seconds) / seeds as f64;
        }
    }
    let mean = logs.iter().sum::<f64>() / seeds as f64;
    let squares: f64 = logs.iter().map(|log| math::square(log - mean)).sum();
    let error = (squares / (seeds.max(2) - 1) as f64 / seeds as f64).sqrt();
    println!(
        "{path}: distinct {} and {}, ratio {:.2} (from {:.2} to {:.2}); hits a second {:.1} and {:.1}, ratio {:.2}; \
         first after {:.2} and {:.2} s",
        distinct[0],
        distinct[1],
        math::exp(mean),
        math::exp(mean - error),
        math::exp(mean + error),
        all[0].hits as f64 / all[0].seconds,
        all[1].hits as f64 / all[1].seconds,
        all[0].hits as f64 / all[0].seconds / (all[1].hits as f64 / all[1].seconds),
        waits[0],
        waits[1],
    );
    Ok(())
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let time: f64 = args.next().map_or(Ok(1.0), |text| text.parse())?;
    let seeds: u64 = args.next().map_or(Ok(2), |text| text.parse())?;
    let (overrides, files): (Vec<String>, Vec<String>) = args.partition(|arg| arg.contains('='));
    files.iter().try_for_each(|file| compare(file, &overrides, time, seeds))
}
