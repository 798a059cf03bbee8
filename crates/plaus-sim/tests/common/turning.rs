//! Shared by tests of turning bodies: a check whether bodies are in each other, relabelling.

use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld, Start};
use plaus_sim::trace::Observer;
use plaus_sim::{Scratch, State};

/// At every new motion, and half way before it, checks whether bodies are in each other.
pub struct Overlaps<'w> {
    world: &'w RigidWorld,
    last: Vec<RigidBodyState>,
    /// The deepest overlap so far, in m.
    pub worst: f64,
}

impl<'w> Overlaps<'w> {
    pub fn new(world: &'w RigidWorld, state: &State<RigidBodyState>) -> Self {
        Self { world, last: state.bodies().to_vec(), worst: 0.0 }
    }

    fn look(&mut self, index: usize, body: &RigidBodyState) {
        for (other, there) in self.last.iter().enumerate() {
            let present = [there, body].iter().all(|b| b.phase != Phase::Gone);
            if other != index && present && there.path.t <= body.path.t {
                let there = self.world.at(other, there, body.path.t);
                self.worst = self.worst.max(-self.world.gap([index, other], [body, &there]));
            }
        }
    }
}

impl Observer<RigidWorld> for Overlaps<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        let before = &self.last[index];
        let half = self.world.at(index, before, 0.5 * (before.path.t + body.path.t));
        self.look(index, &half);
        self.look(index, body);
        self.last[index] = body.clone();
    }
}

/// Runs two different bodies, and the same two with exchanged labels, and asserts that they behave the same to the last
/// bit. `of` makes the world with the bodies in the given order. Returns the number of impacts.
pub fn same_when_relabelled(of: impl Fn([usize; 2]) -> RigidWorld, starts: [Start; 2], until: f64, what: &str) -> u64 {
    let run = |order: [usize; 2]| {
        let world = of(order);
        let mut state = world.state(&order.map(|b| starts[b])).unwrap();
        world.run(&mut state, &mut Scratch::default(), until, &mut ()).unwrap();
        (world, state)
    };
    let ((a, plain), (b, shuffled)) = (run([0, 1]), run([1, 0]));
    for label in 0..2 {
        let p = a.at(label, &plain.bodies()[label], until);
        let q = b.at(1 - label, &shuffled.bodies()[1 - label], until);
        assert_eq!((p.path.x, p.path.v, p.turn, p.spin), (q.path.x, q.path.v, q.turn, q.spin), "{what}");
    }
    plain.counts().impacts
}
