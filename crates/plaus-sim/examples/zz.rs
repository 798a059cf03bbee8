#![allow(warnings)]
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::mechanics::Impact;
use plaus_sim::rigid::{BodySpec, Part, Phase, Rigid, RigidWorld, Start, Turning};
use plaus_sim::scenery::Aabb;
use plaus_sim::shape::{ConvexHull, Shape, Solid};
use plaus_sim::trace::{Observer, Trace};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Scratch};
const M: Material = Material(0);
const EDGE: f64 = 0.016;
fn block(min: [f64; 3], max: [f64; 3]) -> Part {
    let bounds = Aabb { min: DVec3::from(min) * EDGE, max: DVec3::from(max) * EDGE };
    Part::Block { bounds, material: M, sections: Vec::new() }
}
struct D<'w> {
    world: &'w Rigid,
    last: Vec<Turning>,
    n: usize,
}
impl Observer<Rigid> for D<'_> {
    fn impact(&mut self, i: &Impact) {
        println!("   impact {:?}", i);
    }
    fn motion(&mut self, index: usize, body: &Turning) {
        let half = self.world.at(index, &self.last[index], 0.5 * (self.last[index].path.t + body.path.t));
        self.n += 1;
        let d: Vec<f64> = [&half, body]
            .iter()
            .filter(|b| b.phase != Phase::Waiting)
            .map(|b| self.world.depth(index, b) / 0.0033)
            .collect();
        if self.n < 400 {
            println!(
                "{} t {:.9} {:?} v {:?} w {:.1} x {:?} touch {:?} deep {:?}",
                self.n,
                body.path.t,
                body.phase,
                body.path.v.length(),
                body.spin.length(),
                body.path.x / EDGE,
                body.touching().len(),
                d
            );
            if d.iter().any(|d| *d > 0.01) {
                println!("    {:?}", body.touching());
            }
        }
        self.last[index] = body.clone();
    }
}
fn main() {
    let mut parts = vec![block([-40.0, -40.0, -4.0], [40.0, 40.0, -2.0])];
    for k in 0..12 {
        let (x, y) = (f64::from(k % 4) * 1.1 + 1.0, f64::from(k / 4) * 1.2 - 1.4);
        parts.push(block([x, y, -2.0], [x + 0.25, y + 0.35, 0.3 * f64::from(k % 3) - 0.6]));
    }
    parts.push(block([6.0, -40.0, -2.0], [40.0, 40.0, 1.0]));
    let shape = Shape::Hull(ConvexHull::new(&Solid::Tetrahedron.corners(EDGE), 0.0).unwrap().into());
    let world = Rigid::new(RigidWorld {
        bodies: vec![BodySpec::solid(shape.clone(), 1200.0, M)],
        parts,
        laws: Laws::uniform(Law::new(0.35, 0.5)).unwrap(),
        duration: 20.0,
        ..RigidWorld::default()
    })
    .unwrap();
    let mut stream = Seed(29).chain(0).at(12, Purpose::START);
    let start = DieOnTable::default().throw(|| open_unit(&mut stream));
    let start = Start { velocity: start.velocity * 0.5, ..start };
    let mut state = world.state(&[start]).unwrap();
    let mut depths = D { world: &world, last: state.bodies().to_vec(), n: 0 };
    println!("{} {:?}", shape.size(), world.run(&mut state, &mut Scratch::default(), 20.0, &mut depths).unwrap());
}
