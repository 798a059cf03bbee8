//! Pins: standing for ever, tipping at the analytic angle, and a ball that goes through none of them.

#[path = "../../../crates/plaus-scenes/examples/shots/mod.rs"]
pub(super) mod shots;
#[path = "../../../crates/plaus-sim/tests/common/turning.rs"]
#[allow(dead_code, unreachable_pub)]
mod turning;

use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, math, open_unit};
use plaus_scenes::bowling::Alley;
use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld, Start};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Outcome, Preset, Scratch};

fn alley() -> Alley {
    Alley { duration: 60.0, ..Alley::default() }
}

#[test]
fn ten_pins_stand_for_a_minute_and_do_not_move_a_bit() {
    let alley = alley();
    let world = alley.world().unwrap();
    // The ball lies far up the lane.
    let starts = alley.starts(10.0, 0.0, DVec3::ZERO, DVec3::ZERO).unwrap();
    let mut state = world.state(&starts).unwrap();
    let outcome = world.run(&mut state, &mut Scratch::default(), 60.0, &mut ()).unwrap();
    assert_eq!(outcome, Outcome::AllAtRest);
    for (k, start) in starts.iter().enumerate().skip(1) {
        let body = world.at(k, &state.bodies()[k], 60.0);
        assert_eq!((body.path.x, body.turn), (start.position, start.orientation), "pin {k}");
    }
}

/// One pin leaning by `angle` on its rim, at rest, with the others and the ball out of its way. Returns how upright it
/// ends.
fn leaning(angle: f64, preset: Preset) -> f64 {
    let alley = Alley { accuracy: Accuracy::preset(preset), duration: 6.0, ..Alley::default() };
    let world = alley.world().unwrap();
    let pin = alley.pin().unwrap();
    let rim = pin.rings()[0];
    let mut starts = alley.starts(15.0, 0.0, DVec3::ZERO, DVec3::ZERO).unwrap();
    let (s, c) = math::sin_cos(angle);
    // Turned about −y it leans towards −x; the rim's lowest circle point then touches at z = 0.
    let height = rim.circle * s - rim.height * c + rim.radius;
    starts[1].position = DVec3::new(0.0, -1.0, height);
    starts[1].orientation = DQuat::from_xyzw(0.0, -math::sin(0.5 * angle), 0.0, math::cos(0.5 * angle));
    let mut state = world.state(&starts).unwrap();
    world.run(&mut state, &mut Scratch::default(), 6.0, &mut ()).unwrap();
    let body = world.at(1, &state.bodies()[1], state.time());
    (body.turn * DVec3::Z).z
}

/// The centre of gravity is over the rim's circle at `atan(circle / height over it)`: at smaller angles the pin
/// returns, at larger ones it falls.
#[test]
fn a_pin_tips_at_its_static_angle() {
    let pin = alley().pin().unwrap();
    let rim = pin.rings()[0];
    let angle = math::atan2(rim.circle, -rim.height);
    let degrees = angle.to_degrees();
    assert!((9.0..11.5).contains(&degrees), "{degrees}");
    let tenth = 0.1_f64.to_radians();
    for preset in [Preset::Standard, Preset::Fine] {
        assert!(leaning(angle - tenth, preset) > 0.9999, "{} below", preset.name());
        assert!(leaning(angle + tenth, preset) < 0.7, "{} above", preset.name());
        assert!(leaning(0.5 * angle, preset) > 0.9999, "{} half", preset.name());
    }
}

/// Checks at every new motion for overlaps of ball and pins and of pins with one another, by the balls of their skins.
struct Overlaps<'w> {
    world: &'w RigidWorld,
    last: Vec<Option<RigidBodyState>>,
    row: Vec<(f64, f64)>,
    ball: f64,
    worst: f64,
}

impl Overlaps<'_> {
    fn depth(&self, a: usize, b: usize) -> f64 {
        let balls = |k: usize| {
            let body = self.last[k].as_ref().unwrap();
            let up = body.turn * DVec3::Z;
            let row: Vec<(DVec3, f64)> = if k == 0 {
                vec![(body.path.x, self.ball)]
            } else {
                self.row.iter().map(|&(z, r)| (body.path.x + up * z, r)).collect()
            };
            row
        };
        let mut worst = f64::NEG_INFINITY;
        for (p, r) in balls(a) {
            for (q, s) in balls(b) {
                worst = worst.max(r + s - (p - q).length());
            }
        }
        worst
    }
}

impl Observer<RigidWorld> for Overlaps<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        if body.phase == Phase::Gone {
            self.last[index] = None;
            return;
        }
        let time = body.path.t;
        self.last[index] = Some(body.clone());
        for other in 0..self.last.len() {
            if other == index {
                continue;
            }
            let Some(mut there) = self.last[other].clone() else { continue };
            if there.path.t <= time && (there.path.x - body.path.x).length() < 0.6 {
                there = self.world.at(other, &there, time);
                let kept = self.last[other].replace(there);
                self.worst = self.worst.max(self.depth(index, other));
                self.last[other] = kept;
            }
        }
    }
}

#[test]
fn nothing_goes_through_anything() {
    let alley = Alley { accuracy: Accuracy::preset(Preset::Standard), duration: 3.0, ..Alley::default() };
    let world = alley.world().unwrap();
    let pin = alley.pin().unwrap();
    for shot in 0..12 {
        let x = -0.12 + 0.02 * f64::from(shot);
        let velocity = DVec3::new(0.02 * f64::from(shot % 5), 7.0 + 0.1 * f64::from(shot), 0.0);
        let spin = DVec3::new(-velocity.y, velocity.x, 0.0) / alley.ball_radius;
        let starts: Vec<Start> = alley.starts(0.5, x, velocity, spin).unwrap();
        let mut state = world.state(&starts).unwrap();
        let mut overlaps = Overlaps {
            world: &world,
            last: vec![None; 11],
            row: pin.row().iter().map(|f| (f.centre.z, f.radius)).collect(),
            ball: alley.ball_radius,
            worst: f64::NEG_INFINITY,
        };
        let outcome = world.run(&mut state, &mut Scratch::default(), 3.0, &mut overlaps).unwrap();
        assert!(matches!(outcome, Outcome::TimeReached | Outcome::AllAtRest), "{outcome:?}");
        // A millimetre: the overlap that a step of lasting contact may leave; it takes 46 mm to go through a pin's
        // neck.
        assert!(overlaps.worst < 1e-3, "{} m in shot {shot}", overlaps.worst);
    }
}

/// Pins jammed between the side of the lane and the wall once gained energy: pushing them out of overlaps of
/// micrometres gave a pin 240 km/s.
#[test]
fn pins_gain_no_energy_until_they_rest() {
    // A body that is lifted out of an overlap rises by its depth: by a thousandth of its size at most, and there are
    // ten.
    let tolerance = 10.0 * 1e-3;
    let rise = shots::rises(120, Preset::Standard).unwrap().largest;
    assert!(rise <= tolerance, "a rise of {rise} of a pin's weight times its foot");
}

/// Two shots in which a pin once went through another: its far end came first while its nearest point receded. An
/// overlap of 20 mm would be through the neck.
#[test]
fn pins_whose_far_ends_meet_are_seen() {
    let alley = Alley::default();
    let world = alley.world().unwrap();
    for shot in [13, 21] {
        let mut stream = Seed(31).chain(0).at(shot, Purpose::START);
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(&mut stream);
        let (angle, speed) = (between(-0.1, 0.1), between(3.0, 9.0));
        let velocity = DVec3::new(-angle * speed, speed, 0.0);
        let spin = DVec3::new(-velocity.y, velocity.x, 0.0) * (between(0.0, 1.0) / alley.ball_radius);
        let starts = alley.starts(0.5, between(-0.4, 0.4), velocity, spin).unwrap();
        let mut state = world.state(&starts).unwrap();
        let mut overlaps = turning::Overlaps::new(&world, &state);
        world.run(&mut state, &mut Scratch::default(), 1.0, &mut overlaps).unwrap();
        assert!(overlaps.worst < 2e-3, "{} m in shot {shot}", overlaps.worst);
    }
}
