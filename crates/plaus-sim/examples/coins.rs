//! How often a tossed coin ends on its edge, over its thickness:
//! `cargo run --release -p plaus-sim --example coins -- [TOSSES] [PRESET] [RESISTANCE] [SPEED] [SPIN]`.
//! Resistance to rolling and to spinning is 0.05 by default; speed is up to 0.5 m/s along each axis, spin up to 40
//! rad/s.
//!
//! Beside it stand two laws without bounces. The angle law: the coin turns about a level axis and lies down on the side
//! over which its centre is, 2/π atan(h/d). The solid-angle law (John von Neumann's, as told by Mosteller, *Fifty
//! Challenging Problems in Probability* (1965), no. 38): it is turned at random, sin atan(h/d); a third at 0.354.
//! Murray and Teare (Phys. Rev. E 48, 2547 (1993)) extrapolate their experiments to 1 in 6000 for a nickel, whose ratio
//! is 0.0919.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

#[path = "../tests/common/dice.rs"]
mod dice;

use dice::Dice;
use glam::DVec3;
use plaus_dist::math;
use plaus_sim::rigid::{BodySpec, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::Frustum;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch};
use std::error::Error;
use std::f64::consts::FRAC_2_PI;

/// Radius in m: that of a nickel.
const RADIUS: f64 = 0.0106;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let tosses: u64 = args.next().map_or(Ok(200), |a| a.parse())?;
    let name = args.next().unwrap_or("standard".into());
    let preset = Preset::ALL.into_iter().find(|p| p.name() == name).ok_or("draft, standard, fine or reference")?;
    let resistance: f64 = args.next().map_or(Ok(0.05), |a| a.parse())?;
    let speed: f64 = args.next().map_or(Ok(0.5), |a| a.parse())?;
    let spin: f64 = args.next().map_or(Ok(40.0), |a| a.parse())?;
    println!("{tosses} tosses of each at the {name} preset; friction 0.3, resistance to rolling {resistance}");
    println!("  h/d  restitution    edge  std. error  angle law  solid angle  not at rest  events");
    for ratio in [0.0919, 0.2, 0.3, 0.354, 0.5, 0.577, 0.707, 1.0] {
        for restitution in [0.1, 0.5] {
            let (edge, moving, events) = toss(ratio, [restitution, resistance, speed, spin], preset, tosses)?;
            let share = edge as f64 / tosses as f64;
            let error = (share * (1.0 - share) / tosses as f64).sqrt();
            let angle = math::atan(ratio);
            println!(
                "{ratio:5.3}  {restitution:11}  {share:6.4}  {error:10.4}  {:9.4}  {:11.4}  {moving:11}  {:6}",
                FRAC_2_PI * angle,
                math::sin(angle),
                events / tosses
            );
        }
    }
    Ok(())
}

/// How many coins end on their edge and how many are not at rest after a minute; and all events.
fn toss(
    ratio: f64,
    [restitution, resistance, speed, spin]: [f64; 4],
    preset: Preset,
    tosses: u64,
) -> Result<(u64, u64, u64), Box<dyn Error>> {
    let metal = Material(0);
    let coin = Frustum::cylinder(RADIUS, 2.0 * RADIUS * ratio)?;
    let world = RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(coin.into(), 8900.0, metal)],
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, metal)?)],
        laws: Laws::uniform(Law::new(0.3, restitution).with_resistance(resistance, resistance))?,
        accuracy: Accuracy::preset(preset),
        ..RigidWorldDesc::default()
    })?;
    let mut scratch = Scratch::default();
    let (mut edge, mut moving, mut events) = (0, 0, 0);
    for k in 0..tosses {
        let mut dice = Dice::new(61, k);
        let start = Start {
            orientation: dice.turn(),
            velocity: dice.in_cube() * speed,
            spin: dice.in_cube() * spin,
            ..Start::at_rest(DVec3::Z * dice.between(0.2, 0.5))
        };
        let mut state = world.state(&[start])?;
        let outcome = world.run(&mut state, &mut scratch, 60.0, &mut ())?;
        let up = (world.at(0, &state.bodies()[0], state.time()).turn * DVec3::Z).z;
        edge += u64::from(up.abs() < 0.5);
        moving += u64::from(outcome != Outcome::AllAtRest);
        events += state.counts().events;
    }
    Ok((edge, moving, events))
}
