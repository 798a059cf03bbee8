#![allow(clippy::all, clippy::disallowed_methods, clippy::print_stdout, clippy::unwrap_used)]
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Preset, Scratch};
use plaus_sim::rigid::{Rigid, Turning};
use plaus_sim::trace::Observer;
use plaus_sim::mechanics::Impact;
struct P(usize);
impl Observer<Rigid> for P {
    fn impact(&mut self, i: &Impact) { println!("   hit t={:.6} {:?} approach={:.5} lasting={} J={:.2e}", i.time, i.other, i.approach, i.lasting, i.impulse.length()); }
    fn motion(&mut self, _: usize, b: &Turning) { self.0+=1; if self.0<400 { println!("t={:.6} {:?} z={:.3e} v={:.4?} w={:.3?} touch={}", b.path.t, b.phase, b.path.x.z, b.path.v.to_array(), b.spin.to_array(), b.touching().len()); } }
}
fn noise(i: i64, j: i64) -> f64 {
    let mut h = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (j as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    h ^= h >> 31;
    h = h.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h ^= h >> 29;
    let u = |k: u32| f64::from((h >> (16 * k)) as u16) / 65535.0 - 0.5;
    (u(0) + u(1) + u(2) + u(3)) * 3.0_f64.sqrt()
}
fn main() {
    let n: usize = std::env::args().nth(1).map_or(0, |a| a.parse().unwrap());
    let bumps: f64 = std::env::args().nth(2).map_or(0.0, |a| a.parse().unwrap());
    let most: u64 = std::env::args().nth(3).map_or(2000, |a| a.parse().unwrap());
    let die = DieOnTable { bumps, accuracy: Accuracy{events:most, ..Accuracy::preset(Preset::Standard)}, ..DieOnTable::default() };
    let mut rng = Seed(1).chain(0).at(0, Purpose::START);
    for k in 0..1000 {
    let start = die.throw(|| open_unit(&mut rng));
    if n < 1000 && k != n { continue; }
    let world = die.world(noise).unwrap();
    let mut state = world.state(&[start]).unwrap();
    if n < 1000 { println!("{:?}", world.run(&mut state, &mut Scratch::default(), 20.0, &mut P(0)).unwrap()); }
    else { let o = world.run(&mut state, &mut Scratch::default(), 20.0, &mut ()).unwrap(); if o != plaus_sim::Outcome::AllAtRest || state.counts().events > 300 { println!("{k} {o:?} {:?}", state.counts()); } }
    }
}
