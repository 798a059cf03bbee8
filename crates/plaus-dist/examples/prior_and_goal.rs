//! A prior, a goal, and why a random direction with a Gaussian length is not a Gaussian.
//!
//! `cargo run -p plaus-dist --example prior_and_goal`

#![allow(clippy::print_stdout, reason = "an example talks")]

use plaus_dist::{Density, Gibbs, IsotropicGaussian, LogDensity, Purpose, Radial, Sample, Seed};

/// Vertices of a partition that may be moved, each by an offset in space.
const VERTICES: usize = 48;
/// Standard deviation of an offset, in metres.
const SD: f64 = 1e-4;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let prior = IsotropicGaussian::<3>::new(SD)?;
    let printed = Radial::<3>::new(SD)?;
    let goal = Gibbs::from_ln_lambda(5.0)?;
    let chain = Seed(1).chain(0);

    let log_prior = |offsets: &[[f64; 3]]| -> Result<LogDensity, plaus_dist::NotANumber> {
        offsets.iter().map(|offset| prior.log_density(offset)).sum()
    };
    let mut stream = chain.at(0, Purpose::START);
    let gaussian: Vec<_> = (0..VERTICES).map(|_| prior.sample(&mut stream)).collect();
    let mut stream = chain.at(1, Purpose::START);
    let radial: Vec<_> = (0..VERTICES).map(|_| printed.sample(&mut stream)).collect();

    let (matching, shorter) = (log_prior(&gaussian)?, log_prior(&radial)?);
    println!("log prior of 48 fresh offsets, in nats");
    println!("  drawn from the prior itself:           {:8.1}", matching.value());
    println!("  random direction, length N(0, sigma):  {:8.1}", shorter.value());
    let gain = shorter.value() - matching.value();
    println!("The second looks {gain:.1} nats likelier (48 on average), only because it is not a draw from the prior.");
    println!("At lambda = e^5 per ball that pays for {:.1} balls lost:", gain / goal.ln_lambda());
    println!("  prior x goal, seven balls home: {:8.1}", (matching + goal.log_potential(7)).value());
    println!("  printed recipe, none home:      {:8.1}", (shorter + goal.log_potential(0)).value());
    Ok(())
}
