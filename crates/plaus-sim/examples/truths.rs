//! How far each preset is from independent truths: tosses and lasting contact in very small steps.
//!
//! `cargo run --release -p plaus-sim --example truths -- [tosses of each kind] [step in µs] [file of tosses]`
//!
//! The file of tosses holds real ones, one per line: see `read_tosses` in `tests/common/cases/throws.rs`.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

#[path = "../tests/common/cases/mod.rs"]
mod cases;
#[path = "../tests/common/laws/mod.rs"]
mod laws;
mod measure;
#[path = "../tests/common/small_steps/mod.rs"]
mod small_steps;

use cases::boxes::{DOMINO, DOMINO_LAW, wave_speed};
use cases::throws::toss_body;
use cases::{Guard, Setting, read_tosses};
use glam::DVec2;
use laws::worlds::G;
use measure::Stopwatch;
use plaus_sim::{Law, Preset};
use small_steps::planar::Row;
use small_steps::tosses::{Look, Toss, smooth, wild};
use std::error::Error;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Real tosses of a cube, as their authors describe it; each is observed at the end, and so is its truth.
fn real(path: &str) -> Result<Toss, Box<dyn Error>> {
    let starts = read_tosses(&std::fs::read_to_string(path)?)?.iter().map(|t| t.start).collect();
    let law = Law::new(0.18, 0.125);
    Ok(Toss { name: "a real cube's tosses", body: toss_body(), law, starts, looks: vec![0.2, 0.4, 3.0] })
}

/// One kind of toss: medians of the presets' errors, and the uncertainty of the truth.
fn table(toss: &Toss, dt: f64) {
    let mut watch = Stopwatch::start();
    let truths: Vec<_> = toss.starts.iter().map(|s| watch.time(|| toss.truth_and_doubt(s, dt))).collect();
    let count = toss.starts.len();
    let impacts = truths.iter().map(|t| t.2).sum::<u64>() as f64 / count as f64;
    println!("\n{}: {count} of {impacts:.1} impacts, {:.2} s each", toss.name, watch.quantile(0.5));
    let looks: String = toss.looks.iter().map(|t| format!("{:>10}", format!("{t} s"))).collect();
    println!("{:<12}{looks}   mean travel in the end", "");
    let row = |name: &str, found: &[Vec<Look>]| {
        let off = |k: usize, look: usize| found[k][look].off(&truths[k].0[look], toss.length());
        let far = |look: usize| median((0..count).map(|k| off(k, look)).collect());
        let cells: String = (0..toss.looks.len()).map(|k| format!("{:>10.1e}", far(k))).collect();
        let last = toss.looks.len() - 1;
        let travel = |k: usize| (found[k][last].x - toss.starts[k].position).with_z(0.0).length() / toss.length();
        println!("{name:<12}{cells}   {:.4}", (0..count).map(travel).sum::<f64>() / count as f64);
    };
    for preset in Preset::ALL {
        let found: Vec<Vec<Look>> = toss.starts.iter().map(|s| toss.ours(s, preset)).collect();
        row(preset.name(), &found);
    }
    row("unknown", &truths.iter().map(|t| t.1.clone()).collect::<Vec<_>>());
    row("truth", &truths.iter().map(|t| t.0.clone()).collect::<Vec<_>>());
}

/// Speed of a wave of dominoes over √(g h): in small steps, and by each preset within `seconds` of wall-clock time.
fn dominoes(dt: f64, seconds: f64) {
    for gap in [0.1, 0.3, 0.5] {
        let half = DVec2::new(DOMINO.x, DOMINO.z) * 0.5;
        let (pitch, push) = (DOMINO.x + gap * DOMINO.z, (G / DOMINO.z).sqrt());
        let row = Row { half, pitch, count: 20, friction: DOMINO_LAW.friction, gravity: G, push };
        let [a, b] = [1.0, 0.5].map(|part| wave_speed(&row.wave(1.5, part * dt), gap).unwrap_or(f64::NAN));
        let truth = 2.0 * b - a;
        println!("\ndominoes, gap {gap} h: truth {truth:.4}, in steps {a:.4}, in half steps {b:.4}");
        for preset in Preset::ALL {
            let setting = Setting { preset, guard: Guard { seconds, events: 10_000_000 }, throws: 1, tosses: &[] };
            println!("{:<12}{}", preset.name(), cases::boxes::dominoes(&setting, gap, truth).text);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let throws: u64 = args.first().map_or(Ok(1), |a| a.parse())?;
    let dt: f64 = 1e-6 * args.get(1).map_or(Ok(400.0), |a| a.parse::<f64>())?;
    println!(
        "Medians of the distance from the truth: of the centre over the shortest edge, and half the angle. The truth"
    );
    println!("is extrapolated from steps of {:.1} and {:.1} µs; the row \"unknown\" is how", 5e5 * dt, 2.5e5 * dt);
    println!("far it is from the same of twice these steps.");
    for toss in smooth().iter().chain(&wild(throws)) {
        table(toss, dt);
    }
    dominoes(0.5 * dt, if throws > 1 { 20.0 } else { 0.05 });
    if let Some(path) = args.get(2) {
        table(&real(path)?, dt);
    }
    Ok(())
}
