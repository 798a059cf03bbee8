//! How often square cuboids x × y × y land on a square face, for several coefficients, next to a published experiment
//! (Math. Gazette 97.16, 2013).
//!
//! `cargo run --release -p plaus-sim --example cuboids -- [throws per number]`
//!
//! Nothing here is fitted: the experiment's coefficients and throws are not known, and the rows show how they affect
//! the probabilities.
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a measuring program: it prints")]

use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Law, Scratch};

/// x/y, probability of a square face, throws.
const EXPERIMENT: [(f64, f64, u32); 7] = [
    (0.47, 0.916, 332),
    (0.75, 0.548, 799),
    (0.93, 0.399, 516),
    (1.16, 0.148, 1011),
    (1.44, 0.052, 654),
    (1.60, 0.017, 702),
    (1.87, 0.009, 680),
];

fn main() {
    let throws: u64 = std::env::args().nth(1).map_or(20, |a| a.parse().unwrap());
    print!("{:<52}", "x/y");
    EXPERIMENT.iter().for_each(|e| print!("{:>7}", e.0));
    print!("\n{:<52}", "experiment");
    EXPERIMENT.iter().for_each(|e| print!("{:>7.3}", e.1));
    print!("\n{:<52}", "its standard error");
    EXPERIMENT.iter().for_each(|e| print!("{:>7.3}", (e.1 * (1.0 - e.1) / f64::from(e.2)).sqrt()));
    println!();
    let usual = DieOnTable::default();
    let law = |friction, e| DieOnTable { law: Law::new(friction, e), ..usual };
    row("friction 0.35, restitution 0.5 (default)", &usual, 1.0, throws);
    row("restitution 0.1", &law(0.35, 0.1), 1.0, throws);
    row("restitution 0.3", &law(0.35, 0.3), 1.0, throws);
    row("restitution 0.7", &law(0.35, 0.7), 1.0, throws);
    row("friction 0.1", &law(0.1, 0.5), 1.0, throws);
    row("friction 0.2", &law(0.2, 0.5), 1.0, throws);
    row("friction 0.8", &law(0.8, 0.5), 1.0, throws);
    for rounding in [0.05, 0.1, 0.2] {
        let die = DieOnTable { rounding: rounding * 0.5, ..usual };
        row(&format!("edges rounded by {rounding} of the shorter half edge"), &die, 1.0, throws);
    }
    row("friction 0.2, restitution 0.3, rounded by 0.1", &DieOnTable { rounding: 0.05, ..law(0.2, 0.3) }, 1.0, throws);
    row("thrown at half the speeds", &usual, 0.5, throws);
    row("thrown at twice the speeds", &usual, 2.0, throws);
}

/// One row; here `die` has its rounding over its shorter edge.
fn row(name: &str, die: &DieOnTable, speed: f64, throws: u64) {
    print!("{name:<52}");
    let mut scratch = Scratch::default();
    for (ratio, ..) in EXPERIMENT {
        let y = 0.016;
        let edges = DVec3::new(ratio * y, y, y);
        let die = DieOnTable { edges, rounding: die.rounding * edges.min_element(), ..*die };
        let world = die.world(|_, _| 0.0).unwrap();
        let mut square = 0;
        for k in 0..throws {
            let mut stream = Seed(41).chain(0).at(k, Purpose::START);
            let mut start = die.throw(|| open_unit(&mut stream));
            start.velocity *= speed;
            start.spin *= speed;
            let mut state = world.state(&[start]).unwrap();
            world.run(&mut state, &mut scratch, 20.0, &mut ()).unwrap();
            let body = &state.bodies()[0];
            square += u64::from((body.turn.conjugate() * DVec3::Z).x.abs() > 0.8);
        }
        print!("{:>7.3}", square as f64 / throws as f64);
    }
    println!();
}
