//! What each special case of the simulator's narrow phase and times of impact gives: how much longer draws of the prior
//! take without it, in worlds that users have.
//!
//!     cargo run --release -p plaus-scenes --features leave-out --example special_cases -- [SECONDS] [CASE...] FILE...
//!
//! Each CASE is the name of a special case; if none is named, all are measured. Draws of each scenario FILE are made
//! for SECONDS of the processor with and without each case, in turn, each twice; the faster counts. Prints the table of
//! `docs/validation/special_cases.md`: the mean factor over draws (of logarithms, so that one draw that goes another
//! way does not decide), in the world where it is largest and in the next.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a measuring program: it prints")]

#[path = "../shared/mod.rs"]
mod shared;

use plaus_dist::{LogPotential, Purpose, Seed, math};
use plaus_mcmc::Target;
use plaus_scenes::{Scenario, Stage};
use plaus_sim::interruptible;
use plaus_sim::special_case::SpecialCase;
use shared::seconds;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Most draws of a world.
const DRAWS: usize = 60;

/// Seconds after which a case that takes so much longer is measured in fewer draws.
const PATIENCE: f64 = 2.0;

/// Seconds after which it is given up.
const LONGEST: u64 = 20;

/// Factors up to which a special case is not worth its lines.
const WORTH: f64 = 1.3;

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1).peekable();
    let patience: f64 = args.next_if(|a| a.parse::<f64>().is_ok()).map_or(Ok(0.2), |a| a.parse())?;
    let (named, paths): (Vec<String>, Vec<String>) =
        args.partition(|a| SpecialCase::ALL.iter().any(|(name, _)| name == a));
    let mut best: Vec<Vec<(f64, String)>> = vec![Vec::new(); SpecialCase::ALL.len()];
    for path in paths {
        let name = Path::new(&path).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mut world = World::read(&path, patience)?;
        for (k, (case, special)) in SpecialCase::ALL.into_iter().enumerate() {
            if world.met[k] && (named.is_empty() || named.iter().any(|name| name == case)) {
                let factor = world.factor(special)?;
                eprintln!("{name:20} {case:20} {factor:.2}");
                // It is not a number if not even one draw was simulated in time.
                best[k].extend(factor.is_finite().then(|| (factor, name.clone())));
            }
        }
    }
    println!("| special case | longest without it | next | worth it |\n| --- | --- | --- | --- |");
    for ((case, _), mut factors) in SpecialCase::ALL.into_iter().zip(best) {
        factors.sort_by(|a, b| b.0.total_cmp(&a.0));
        let cell = |k: usize| factors.get(k).map_or("–".into(), |(f, name)| format!("{f:.2} (`{name}`)"));
        let is_worth = factors.first().is_some_and(|f| f.0 >= WORTH);
        println!("| {case} | {} | {} | {} |", cell(0), cell(1), if is_worth { "yes" } else { "no" });
    }
    Ok(())
}

/// A world and draws of its prior, with how long each takes in s.
struct World {
    scenario: Scenario,
    stage: Stage,
    draws: Vec<<Stage as Target>::Draw>,
    /// Which special cases it has.
    met: Vec<bool>,
}

impl World {
    fn read(path: &str, patience: f64) -> Result<Self> {
        let folder = Path::new(path).parent().unwrap_or(Path::new("."));
        let files = |name: &str, _: bool| std::fs::read(folder.join(name)).map(Into::into).map_err(|e| e.to_string());
        let scenario = Scenario::read_with(path, &std::fs::read_to_string(path)?, &[], &files)?;
        let stage = scenario.stage()?;
        SpecialCase::take_met();
        let (mut stream, mut draws, begin) = (Seed(7).chain(0).at(0, Purpose::START), Vec::new(), seconds());
        let mut scratch = <Stage as Target>::Scratch::default();
        while draws.len() < 2 || draws.len() < DRAWS && seconds() - begin < patience {
            let draw = stage.start(&mut stream);
            if !stage.log_prior(&draw)?.is_zero() {
                stage.simulate(&draw, None, LogPotential::ZERO, &mut scratch)?;
                draws.push(draw);
            }
        }
        Ok(Self { scenario, stage, draws, met: SpecialCase::take_met() })
    }

    /// How much longer draws take without a special case.
    fn factor(&mut self, special: SpecialCase) -> Result<f64> {
        SpecialCase::leave_out(&[special]);
        let without = self.scenario.stage();
        SpecialCase::leave_out(&[]);
        let stages = [&self.stage, &without?];
        let mut scratch = [(); 2].map(|()| <Stage as Target>::Scratch::default());
        let mut times = vec![[f64::INFINITY; 2]; self.draws.len()];
        let flag = Arc::new(AtomicBool::new(false));
        let (watched, begin) = (Arc::downgrade(&flag), seconds());
        std::thread::spawn(move || {
            std::thread::sleep(Duration::from_secs(LONGEST));
            watched.upgrade().inspect(|flag| flag.store(true, Ordering::Relaxed));
        });
        for _ in 0..2 {
            for (draw, times) in self.draws.iter().zip(&mut times) {
                for k in 0..2 {
                    if k == 0 && seconds() - begin > PATIENCE || flag.load(Ordering::Relaxed) {
                        continue;
                    }
                    SpecialCase::leave_out(if k == 0 { &[] } else { std::slice::from_ref(&special) });
                    let begin = seconds();
                    let run = || stages[k].simulate(draw, None, LogPotential::ZERO, &mut scratch[k]).map(drop);
                    // One that is cut short has taken so long at least.
                    interruptible(&flag, run).transpose()?;
                    times[k] = times[k].min(seconds() - begin);
                }
            }
        }
        SpecialCase::leave_out(&[]);
        let measured = || times.iter().filter(|times| times.iter().all(|t| t.is_finite()));
        let sum: f64 = measured().map(|[with, without]| math::ln(without / with)).sum();
        Ok(math::exp(sum / measured().count() as f64))
    }
}
