//! Rolls a ball at ten pins many times. Counts how often the energy of all bodies together rises between two events,
//! and by how much: pushing bodies out of overlaps that steps of lasting contact leave costs nothing in the simulation.
//!
//! `cargo run --release -p plaus-scenes --example bowling_energy -- [shots] [preset]`
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod shots;

use plaus_sim::Preset;
use shots::Tally;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let shots: usize = args.next().map_or(Ok(20), |a| a.parse())?;
    let name = args.next().unwrap_or("standard".into());
    let preset = Preset::ALL.into_iter().find(|p| p.name() == name).ok_or("draft, standard, fine or reference")?;
    let Tally { above, largest, times } = shots::rises(shots, preset)?;
    println!("{shots} shots, {times} times at the {name} preset; in units of a pin's weight times its foot's radius:");
    println!("rises above {:?}: {above:?}; largest {largest:.2e}", Tally::LEAST);
    Ok(())
}
