//! The cost of describing a world in a scenario file: a die, ten pins and a ball, and ten marbles over bins, once as
//! scenes of the paper and once as described worlds. Both draw from the same laws and are simulated in turn. Then how
//! long it takes to read and build a world of 1,000 bodies, and to report 20,000 unknown keys.
//!
//!     cargo run --release -p plaus-scenes --example said -- 2000
//!
//! A file cannot describe when a shot at pins is decided and can end, so shots of both are also made to their ends. Nor
//! can it describe the bowls in the bins' floors and their uneven partitions; its floors are flat.

#![allow(clippy::print_stdout, reason = "it is run to be read")]

mod shared;

use plaus_dist::{LogPotential, Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::registry::World;
use plaus_scenes::spelling::{Rest, Spelling};
use plaus_scenes::{AnyScratch, Scenario, Scene, Stage};
use shared::seconds;
use std::error::Error;
use std::fmt::Write;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Simulates the n-th draw of a world and returns how much processor time that took, in s.
type Run<'a> = Box<dyn FnMut(u64) -> Result<f64> + 'a>;

fn stage(name: &str, text: &str) -> Result<Stage> {
    Ok(Scenario::read(name, text, &[])?.stage()?)
}

/// Times the simulation of each draw.
fn simulated(stage: &Stage) -> Run<'_> {
    let mut scratch = AnyScratch::default();
    Box::new(move |nth| {
        let draw = stage.start(&mut Seed(7).chain(0).at(nth, Purpose::START));
        let begin = seconds();
        stage.simulate(&draw, None, LogPotential::ZERO, &mut scratch)?;
        Ok(seconds() - begin)
    })
}

/// Times each draw's motion to its end, as an animation without scenery.
fn to_end(stage: &Stage) -> Run<'_> {
    Box::new(|nth| {
        let draw = stage.start(&mut Seed(7).chain(0).at(nth, Purpose::START));
        let begin = seconds();
        stage.motion(&draw)?;
        Ok(seconds() - begin)
    })
}

/// Runs two worlds in turn, and compares means and medians of the times per draw.
fn beside(what: &str, draws: u64, mut scene: Run<'_>, mut said: Run<'_>) -> Result<()> {
    let mut times = [Vec::new(), Vec::new()];
    for nth in 0..draws {
        times[0].push(1e3 * scene(nth)?);
        times[1].push(1e3 * said(nth)?);
    }
    let [mean, said_mean] = times.each_ref().map(|times| times.iter().sum::<f64>() / draws as f64);
    let [median, said_median] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    });
    println!(
        "{what}: mean {mean:.3} and {said_mean:.3} ms, ratio {:.2}; median {median:.3} and {said_median:.3} ms, ratio {:.2}",
        said_mean / mean,
        said_median / median
    );
    Ok(())
}

/// Ten marbles, all of them dropped.
fn spelt(spelling: &Spelling) -> Run<'_> {
    let mut work = <Spelling as Target>::Scratch::default();
    Box::new(move |nth| {
        let mut draw = spelling.start(&mut Seed(7).chain(0).at(nth, Purpose::START));
        let mut more = 0;
        while draw.balls.iter().any(Option::is_none) {
            more += 1;
            let other = spelling.start(&mut Seed(7).chain(more).at(nth, Purpose::START));
            draw.balls.iter_mut().zip(other.balls).for_each(|(ball, other)| *ball = ball.or(other));
        }
        let begin = seconds();
        let _: plaus_mcmc::Simulated<Rest> = spelling.simulate(&draw, None, LogPotential::ZERO, &mut work)?;
        Ok(seconds() - begin)
    })
}

/// A world of this many balls, with uncertain numbers that have names.
fn crowd(bodies: usize) -> String {
    let mut text = String::from("[world.custom]\nduration_s = 0.1\n");
    for k in 0..bodies {
        let (x, y) = (60 * (k % 40), 60 * (k / 40));
        let _ = write!(
            text,
            "[[world.custom.bodies]]\nname = 'b{k}'\nshape = {{ box = {{ size_mm = [20, 30, 40] }} }}\n\
             at_mm = [{{ normal = [{x}, 1] }}, '{y} + normal(0, 1)', 100]\n"
        );
    }
    text
}

fn main() -> Result<()> {
    let draws = std::env::args().nth(1).map_or(Ok(200), |text| text.parse())?;
    let flat = "[world.dice]\nconstraints = []\ntable.bumps_mm = 0\ntable.bounce_sd = 0\ntable.grip_sd = 0\n";
    let (scene, said) = (stage("dice", flat)?, stage("die.toml", include_str!("said/die.toml"))?);
    beside("a die on a flat table", draws, simulated(&scene), simulated(&said))?;
    let bumpy = "[world.dice]\nconstraints = []\n";
    let (scene, said) = (stage("dice", bumpy)?, stage("die-bumps.toml", include_str!("said/die-bumps.toml"))?);
    beside("a die on a bumpy table", draws, simulated(&scene), simulated(&said))?;
    let (scene, said) = (stage("bowling", "[world.bowling]\n")?, stage("pins.toml", include_str!("said/pins.toml"))?);
    beside("ten pins and a ball", draws.div_ceil(4), simulated(&scene), simulated(&said))?;
    beside("the same to the end, as animations", draws.div_ceil(8), to_end(&scene), to_end(&said))?;
    let scenario = Scenario::read("spelling", "[world.spelling]\n", &[])?;
    let World::Spelling(config) = &scenario.world else { return Ok(()) };
    let (scene, text) = (Spelling::new(config)?, include_str!("said/bins.toml"));
    beside("ten marbles into bins", draws, spelt(&scene), simulated(&stage("bins.toml", text)?))?;
    let turning = Scenario::read("bins.toml", text, &["world.custom.mechanics=turning".to_owned()])?.stage()?;
    beside("the same as bodies that turn", draws.div_ceil(8), spelt(&scene), simulated(&turning))?;

    let text = crowd(1_000);
    let begin = seconds();
    let scene = stage("crowd.toml", &text)?;
    let built = seconds() - begin;
    let draw = scene.start(&mut Seed(1).chain(0).at(0, Purpose::START));
    scene.simulate(&draw, None, LogPotential::ZERO, &mut AnyScratch::default())?;
    println!("1,000 bodies: read and built in {built:.3} s; with a first simulation {:.3} s", seconds() - begin);
    let mut text = String::from("[world.custom]\n");
    (0..20_000).for_each(|k| _ = writeln!(text, "durations_{k} = 1"));
    let begin = seconds();
    let error = Scenario::read("keys.toml", &text, &[]).err().map(|error| error.to_string().len());
    println!("20,000 unknown keys: {:.3} s, {} bytes of errors", seconds() - begin, error.unwrap_or(0));
    Ok(())
}
