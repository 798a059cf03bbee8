//! Which faces come up: each face of a cube a sixth of the time, and a square face of cuboids x × y × y beside rolls of
//! real ones (Mathematical Gazette 97.16, 2013).
//!
//!     cargo run --release -p plaus-scenes --example dice_faces -- \
//!         100000 5000     # throws of a cube, and of each cuboid
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{State, Target};
use plaus_scenes::dice::{Config, Dice, End, Rotation, Work};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Edge x over y, share of throws of real cuboids in which a square face came up, and how many there were.
const REAL: [(f64, f64, u32); 7] = [
    (0.47, 0.916, 332),
    (0.75, 0.548, 799),
    (0.93, 0.399, 516),
    (1.16, 0.148, 1011),
    (1.44, 0.052, 654),
    (1.60, 0.017, 702),
    (1.87, 0.009, 680),
];

/// How often each face of the body is uppermost at rest, its pips left aside; first, how often none is.
fn faces(ratio: f64, throws: u64, seed: u64) -> Result<[u64; 7]> {
    let mut config = Config { constraints: Vec::new(), ..Config::default() };
    config.die.edge_x_mm = 16.0 * ratio;
    config.die.rounding_mm = 0.0;
    // So large that no die leaves it.
    (config.table.length_mm, config.table.width_mm) = (10_000.0, 10_000.0);
    (config.table.bumps_mm, config.table.bounce_sd, config.table.grip_sd) = (0.0, 0.0, 0.0);
    let scene = Dice::new(&config)?;
    let (mut work, mut counts) = (Work::default(), [0; 7]);
    for k in 0..throws {
        let draw = scene.start(&mut Seed(seed).chain(0).at(k, Purpose::START));
        let trip = &State::evaluate(&scene, draw, &mut work)?.outcome.trips[0];
        let face = if trip.end == End::AtRest { Rotation::IDENTITY.uppermost(trip.orientation).0 } else { 0 };
        counts[usize::from(face)] += 1;
    }
    Ok(counts)
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let cube: u64 = args.next().map_or(Ok(300), |text| text.parse())?;
    let each: u64 = args.next().map_or(Ok(60), |text| text.parse())?;
    let counts = faces(1.0, cube, 1)?;
    let expected = cube as f64 / 6.0;
    let chi2: f64 = counts[1..].iter().map(|&n| (n as f64 - expected) * (n as f64 - expected) / expected).sum();
    // The 99.9999% point of χ² with 5 degrees of freedom is 35.9.
    println!(
        "{cube} throws of a cube: faces {:?}, none {}, χ² = {chi2:.1} (5 degrees of freedom)",
        &counts[1..],
        counts[0]
    );
    println!("x/y    simulated         real");
    for (k, (ratio, share, rolls)) in REAL.into_iter().enumerate() {
        let counts = faces(ratio, each, 2 + k as u64)?;
        // Faces 3 and 4 lie along the first axis.
        let square = (counts[3] + counts[4]) as f64 / each as f64;
        let error = |share: f64, n: f64| (share * (1.0 - share) / n).sqrt();
        println!(
            "{ratio:.2}   {square:.3} ± {:.3}   {share:.3} ± {:.3}",
            error(square, each as f64),
            error(share, f64::from(rolls))
        );
    }
    Ok(())
}
