#![allow(warnings)]
use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::marbles::*;
use plaus_sim::mechanics::*;
use plaus_sim::trace::Observer;
use plaus_sim::worlds::{Bins, drops};
use plaus_sim::{Accuracy, Outcome, Preset, Scratch, State};
struct P(u64);
impl Observer<Marbles> for P {
    fn impact(&mut self, i: &Impact) { if self.0 > 1500 { println!("  {:?} {:?} n {:?} appr {:e} lasting {}", i.body, i.other, i.normal, i.approach, i.lasting);} }
    fn motion(&mut self, k: usize, b: &Marble) { if self.0 > 1500 { println!("  {k} {:?} t {} x {:?} v {:?} a {:?} w {:?} {:?}", b.phase, b.path.t, b.path.x, b.path.v, b.path.a, b.spin, b.contacts());} }
    fn proceed(&mut self, s: &State<Marble>) -> bool { self.0 = s.counts().events; if self.0>1500 {println!("{} {:?} {:?}", s.time(), s.counts(), s.links())}; self.0 < 1515 }
}
fn main() {
    let run: u64 = std::env::args().nth(1).unwrap().parse().unwrap();
    let bins = Bins::default();
    let mut world = bins.world(10, Accuracy::default(), 2.0).unwrap();
    let mut stream = Seed(7).chain(0).at(run, Purpose::START);
    let mut uniform = || open_unit(&mut stream);
    let moved: Vec<(u32, DVec3)> = (0..bins.crossings()).map(|k| {
            let normal = || DVec3::new(uniform(), uniform(), uniform());
            let offset = std::iter::repeat_with(normal).take(4).fold(DVec3::splat(-2.0), |a, b| a + b) * (0.0001 * 3.0_f64.sqrt());
            (k as u32, bins.crossing(k) + offset)
        }).collect();
    world.move_vertices(&moved).unwrap();
    let starts = drops(&bins, 10, 0.1, &mut uniform);
    let mut state = world.state(&starts).unwrap();
    println!("{:?}", world.run(&mut state, &mut Scratch::default(), 1e9, &mut P(0)));
}
