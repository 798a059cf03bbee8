#![allow(warnings)]
use glam::*; use plaus_dist::*; use plaus_sim::*; use plaus_sim::rigid::*; use plaus_sim::shape::*; use plaus_sim::field::*; use plaus_sim::worlds::*; use plaus_sim::trace::*;
const EDGE: f64 = 0.016; const M: Material = Material(0);
fn noise(i: i64, j: i64) -> f64 {
    let mut h = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (j as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    h ^= h >> 31; h = h.wrapping_mul(0xbf58_476d_1ce4_e5b9); h ^= h >> 29;
    let u = |k: u32| f64::from((h >> (16 * k)) as u16) / 65535.0 - 0.5;
    (u(0) + u(1) + u(2) + u(3)) * 3.0_f64.sqrt()
}
fn main() {
    let bumps: f64 = std::env::args().nth(1).unwrap().parse().unwrap();
    let watch: Option<u64> = std::env::args().nth(2).map(|s| s.parse().unwrap());
    for kind in [Some(Solid::Tetrahedron), None, Some(Solid::Octahedron), Some(Solid::Icosahedron)] {
        let shape = match kind { Some(k) => { let u = ConvexHull::new(&k.corners(1.0), 0.0).unwrap(); let u = Shape::Hull(u.into());
            Shape::Hull(ConvexHull::new(&k.corners(0.5*EDGE/u.size()), 0.0).unwrap().into()) }
            None => Shape::Cuboid(Cuboid::new(DVec3::splat(EDGE), 0.0).unwrap()) };
        let spacing = 0.5*EDGE; let spread = bumps*spacing;
        let height = Spline::new("height", Grid { origin: [0.0;2], spacing }, [-8.0*spread, 8.0*spread], move |i,j| spread*noise(i,j)).unwrap();
        let world = Rigid::new(RigidWorld { bodies: vec![BodySpec::solid(shape, 1200.0, M)], parts: vec![Part::Table(Box::new(Table::new(height, M)))],
            laws: Laws::uniform(Law::new(0.35, 0.5)).unwrap(), gravity: DVec3::new(0.0,0.0,-9.81), accuracy: Accuracy::default(), skin: 1.0, sink: f64::NEG_INFINITY, duration: 20.0 }).unwrap();
        let mut bad = vec![];
        let (mut events, mut n) = (0, 0);
        for k in 0..400u64 {
            let mut stream = Seed(23).chain(0).at(k, Purpose::START);
            let s = DieOnTable::default().throw(|| open_unit(&mut stream));
            let s = Start { position: s.position + DVec3::Z*0.05, ..s };
            let mut state = world.state(&[s]).unwrap();
            let mut trace = Trace::default();
            let o = world.run(&mut state, &mut Scratch::default(), 20.0, &mut trace).unwrap();
            events += state.counts().events; n += 1;
            if o != Outcome::AllAtRest { bad.push((k, o, state.time(), state.bodies()[0].path.x.z)); 
                if watch == Some(k) { let m = &trace.motions[0]; for b in &m[m.len()-60..] { println!("{:.9} {:?} v {:.2e} w {:.2e} z {:.9} {:?}", b.path.t, b.phase, b.path.v.length(), b.spin.length(), b.path.x.z, b.touching().iter().map(|s| if let scenery::Surface::Part{point,..}=s {*point} else {0}).collect::<Vec<_>>()); }
                  for i in &trace.impacts[trace.impacts.len()-20..] { println!("{i:?}"); } }
            }
        }
        println!("{kind:?}: {} events/throw, bad {}: {:?}", events/n, bad.len(), &bad[..bad.len().min(8)]);
    }
}
