//! A shot that ends as soon as it is decided leaves the same pins as the same shot simulated until everything is at
//! rest.

use super::straight::scene;
use glam::{DQuat, DVec3};
use plaus_dist::{LogPotential, Purpose, Seed};
use plaus_mcmc::{Simulated, Target};
use plaus_scenes::bowling::{Alley, Bowling, Rest, Shot, Verdict, Work};
use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld, Start};
use plaus_sim::trace::{Observer, While};
use plaus_sim::{Scratch, State};

/// Shots of the scene's prior that once ended with other pins than an early verdict said. Those verdicts did not wait
/// for the pit or for pins at an edge, or took a body that flies over the pit without meeting anything for one at rest.
const SHOTS: [u64; 5] = [11_484, 14_243, 5_722, 26_827, 1_526];

fn draw(scene: &Bowling, shot: u64) -> Shot {
    scene.start(&mut Seed(1).chain(shot).at(0, Purpose::START))
}

fn early(scene: &Bowling, draw: &Shot) -> Rest {
    match scene.simulate(draw, None, LogPotential::ZERO, &mut Work::default()).unwrap() {
        Simulated::Complete(rest) => rest,
        Simulated::CannotExceedFloor => panic!("no outcome is below this floor"),
    }
}

/// Which bodies ever fell.
struct Falls(Vec<bool>);

impl Observer<RigidWorld> for Falls {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        self.0[index] |= Verdict::has_fallen(body);
    }
}

/// Which pins are left when `is_over` becomes true, and when that is, in s.
fn left(world: &RigidWorld, starts: &[Start], is_over: impl Fn(&State<RigidBodyState>) -> bool) -> (Vec<bool>, f64) {
    let mut state = world.state(starts).unwrap();
    let mut falls = Falls(vec![false; starts.len()]);
    let until = While(|state: &_| !is_over(state));
    world.run(&mut state, &mut Scratch::default(), 8.0, &mut (&mut falls, until)).unwrap();
    (falls.0[1..].iter().map(|fell| !fell).collect(), state.time())
}

#[test]
fn an_early_end_leaves_what_the_whole_shot_leaves() {
    let scene = scene(|_| ());
    for shot in SHOTS {
        let draw = draw(&scene, shot);
        let (world, starts) = scene.world(&draw).unwrap();
        let (whole, _) = left(&world, &starts, |_| false);
        let told: Vec<bool> = early(&scene, &draw).pins.iter().map(|fate| fate.stands()).collect();
        assert_eq!(told, whole, "shot {shot}");
    }
}

/// End of the deck, in m.
const END: f64 = 34.1875 * 0.0254;

/// The wrong twin: it ignores bodies past the deck and below it, and how near to an edge a pin stands.
fn is_calm(alley: &Alley, world: &RigidWorld, state: &State<RigidBodyState>) -> bool {
    let weight = 9.81 * alley.pin_mass;
    let mut left = 0.0;
    for (k, body) in state.bodies().iter().enumerate().skip(1) {
        let is_out = body.path.x.y > END && body.path.x.z < 0.0;
        if is_out || matches!(body.phase, Phase::Rest | Phase::Gone) {
            continue;
        }
        let is_lying = Verdict::has_fallen(body);
        if !is_lying && ((body.turn * DVec3::Z).z < 0.9842 || body.path.x.z < 0.1372) {
            return false;
        }
        left += (world.energy(k, body) - weight * if is_lying { 0.058 } else { 0.1472 }).max(0.0);
    }
    left <= 0.018
}

/// One pin comes back out of the pit and hits pin nine; pin eight stands with its centre a centimetre past the end of
/// the deck. The ball lies far away.
#[test]
fn a_verdict_waits_for_the_pit_and_for_the_edge() {
    let alley = Alley { duration: 8.0, ..Alley::default() };
    let (world, verdict) = (alley.world().unwrap(), Verdict::new(&alley).unwrap());
    let starts = alley.starts(10.0, 0.0, DVec3::ZERO, DVec3::ZERO).unwrap();
    let upright = starts[1].position.z;
    let back = Start {
        position: DVec3::new(0.152, 1.05, -0.03),
        orientation: DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2),
        velocity: DVec3::new(0.0, -2.0, 2.2),
        ..starts[10]
    };
    let edge = Start::at_rest(DVec3::new(-0.152, END + 0.01, upright));
    for (pin, start, falls) in [(10, back, 9), (8, edge, 8)] {
        let mut starts = starts.clone();
        starts[pin] = start;
        let (whole, end) = left(&world, &starts, |_| false);
        assert!(!whole[falls - 1], "pin {falls} falls");
        let (told, sooner) = left(&world, &starts, |state| verdict.is_final(&world, state));
        assert!(told == whole && sooner <= end, "{told:?} of {whole:?}");
        let (twin, _) = left(&world, &starts, |state| is_calm(&alley, &world, state));
        assert!(twin[falls - 1], "the twin is caught: {twin:?}");
    }
}

/// A pin is down if it leans by more than 60° or stands lower than the deck, no matter how it came there.
#[test]
fn a_pin_that_leans_far_or_stands_in_the_gutter_is_down() {
    let scene = scene(|_| ());
    let (world, starts) = scene.world(&draw(&scene, 0)).unwrap();
    let upright = starts[1].position.z;
    let is_down = |x: f64, z: f64, lean: f64| {
        let mut starts = starts.clone();
        starts[1].position = DVec3::new(x, -1.0, z);
        starts[1].orientation = DQuat::from_rotation_y(lean.to_radians());
        Verdict::has_fallen(&world.state(&starts).unwrap().bodies()[1])
    };
    assert!(!is_down(0.0, upright, 0.0));
    // Held in the air, a pin is down only if it leans.
    assert!(!is_down(0.0, 0.3, 59.9) && is_down(0.0, 0.3, 60.1));
    // The gutter's floor is 48 mm deep there.
    assert!(is_down(0.645, upright - 0.0476, 0.0));
}
