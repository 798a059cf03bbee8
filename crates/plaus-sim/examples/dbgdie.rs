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
fn main() {
    let n: usize = std::env::args().nth(1).map_or(0, |a| a.parse().unwrap());
    let bumps: f64 = std::env::args().nth(2).map_or(0.0, |a| a.parse().unwrap());
    let die = DieOnTable { bumps, accuracy: Accuracy{events:400, ..Accuracy::preset(Preset::Standard)}, ..DieOnTable::default() };
    let mut rng = Seed(1).chain(0).at(0, Purpose::START);
    for _ in 0..n { die.throw(|| open_unit(&mut rng)); }
    let start = die.throw(|| open_unit(&mut rng));
    let world = die.world(|i,j| ((i*7+j*13)%5) as f64/2.0-1.0).unwrap();
    let mut state = world.state(&[start]).unwrap();
    let o = world.run(&mut state, &mut Scratch::default(), 20.0, &mut P(0)).unwrap();
    println!("{o:?} {:?}", state.counts());
}
