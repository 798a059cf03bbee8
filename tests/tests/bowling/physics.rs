//! What the scene passes to the simulator, compared with closed forms and symmetries: slide, hook and roll under the
//! lane's friction, mirrored shots, energy.

use super::pins::shots::{Ledger, Tally};
use super::straight::scene;
use glam::DVec3;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{Simulated, StateOf, Target};
use plaus_scenes::bowling::{Bowling, Delivery, Quantity, Rest, Shot, Work};
use plaus_sim::Scratch;

/// m/s².
const GRAVITY: f64 = 9.81;
/// Distances in m, from the foul line: to the head pin's spot, and to where the oil of the regulation delivery ends.
const LANE: f64 = 60.0 * 12.0 * 0.0254;
const OIL: f64 = 12.0;

/// Position, velocity and angular velocity of a ball's centre.
#[derive(Clone, Copy)]
struct Ball {
    x: DVec3,
    v: DVec3,
    w: DVec3,
}

/// A ball slides on friction `mu`, by the closed forms, until it rolls, is `end` along the lane, or has slid
/// for `left` seconds. If it rolls first, it rolls until one of the other two. Returns the time that is left.
fn glide(ball: &mut Ball, [radius, gyration]: [f64; 2], mu: f64, end: f64, mut left: f64) -> f64 {
    let arm = DVec3::new(0.0, 0.0, -radius);
    let leverage = (radius / gyration) * (radius / gyration);
    for rolls in [false, true] {
        let slip = ball.v + ball.w.cross(arm);
        let (push, stop) = if rolls || slip.length() < 1e-12 {
            (DVec3::ZERO, f64::INFINITY)
        } else {
            (-mu * GRAVITY * slip.normalize(), slip.length() / (mu * GRAVITY * (1.0 + leverage)))
        };
        let way = end - ball.x.y;
        let arrival = 2.0 * way / (ball.v.y + (ball.v.y * ball.v.y + 2.0 * push.y * way).sqrt());
        let time = stop.min(arrival).min(left);
        ball.x += time * ball.v + 0.5 * time * time * push;
        ball.v += time * push;
        // The push acts at the end of the arm, against the moment of inertia m gyration².
        ball.w += time * arm.cross(push) / (gyration * gyration);
        left -= time;
        if time < stop {
            break;
        }
    }
    left
}

/// A draw of this delivery with the ball set on the lane, so that it does not bounce.
fn laid_down(scene: &Bowling, values: &[(Quantity, f64)]) -> Shot {
    let mut draw = scene.start(&mut Seed(4).chain(0).at(0, Purpose::START));
    for (quantity, value) in values {
        draw.ball[*quantity as usize] = *value;
    }
    draw.ball[Quantity::Height as usize] = draw.get(Quantity::Radius);
    draw
}

/// Relative rounding error of some dozen operations.
const TOLERANCE: f64 = 1e-12;

#[test]
fn balls_slide_hook_and_roll_as_the_closed_form_says() {
    use Quantity::{Across, Drift, Gyration, Hook, Radius, Roll, Speed, Twist};
    let scene = scene(|config| config.delivery = Delivery::Regulation);
    for (across, drift, roll, hook, twist) in
        [(0.2, 0.1, 12.0, -27.0, 6.0), (0.1, 0.1, 0.0, 0.0, 0.0), (-0.2, -0.15, 30.0, 30.0, -8.0)]
    {
        let spin = [(Roll, roll), (Hook, hook), (Twist, twist)];
        let draw = laid_down(&scene, &[&[(Across, across), (Speed, 8.0), (Drift, drift)][..], &spin].concat());
        let (world, starts) = scene.world(&draw).unwrap();
        let size = [draw.get(Radius), draw.get(Gyration) * draw.get(Radius)];
        for until in [0.7, 1.4, 1.7, 2.0, 2.2] {
            let mut state = world.state(&starts).unwrap();
            world.run(&mut state, &mut Scratch::default(), until, &mut ()).unwrap();
            let body = world.at(0, &state.bodies()[0], until);
            let mut ball = Ball { x: starts[0].position, v: starts[0].velocity, w: starts[0].spin };
            let left = glide(&mut ball, size, 0.04, OIL - LANE, until);
            glide(&mut ball, size, 0.2, f64::INFINITY, left);
            assert!(
                ball.x.y < -0.3 && ball.x.x.abs() < 0.5,
                "still on the lane, before the pins, at {until} s: {}",
                ball.x
            );
            for (name, found, expected) in
                [("at", body.path.x, ball.x), ("with", body.path.v, ball.v), ("spinning", body.spin, ball.w)]
            {
                // A ball that does not spin has no angular velocity to scale by, so that of a rolling ball is used.
                let scale = expected.length().max(1.0);
                assert!((found - expected).length() <= TOLERANCE * scale, "{name} {found} for {expected} at {until} s");
            }
        }
    }
}

fn bowl(scene: &Bowling, draw: &Shot) -> Rest {
    let floor = plaus_dist::LogPotential::ZERO;
    match scene.simulate(draw, None, floor, &mut Work::default()).unwrap() {
        Simulated::Complete(rest) => rest,
        Simulated::CannotExceedFloor => panic!("no outcome is below this floor"),
    }
}

/// The draw in the mirror: quantities that have a side change it, and pins exchange their places.
fn mirrored(draw: &Shot, twins: &[usize]) -> Shot {
    let mut there = draw.clone();
    for quantity in Quantity::ALL {
        there.ball[quantity as usize] = quantity.mirrored(draw.get(quantity));
    }
    for (offset, twin) in there.pins.iter_mut().zip(twins) {
        *offset = [-draw.pins[*twin][0], draw.pins[*twin][1]];
    }
    there
}

/// The way to the pins and the ball's first pins are the same to the last bit. After that the two ways part, because
/// the contacts of a group are handled in an order that is reversed in the mirror. A single pin is no group, so with
/// one pin the ends are the same too.
#[test]
fn mirrored_shots_have_mirrored_results() {
    let ten = [0, 2, 1, 5, 4, 3, 9, 8, 7, 6];
    for (pins, twins) in [(vec![1], &[0][..]), ((1..=10).collect(), &ten[..])] {
        let scene = scene(|config| (config.pins, config.delivery) = (pins.clone(), Delivery::Regulation));
        let mut met = 0;
        for shot in 0..if pins.len() == 1 { 60 } else { 12 } {
            let draw = scene.start(&mut Seed(5).chain(shot).at(0, Purpose::START));
            let (here, there) = (bowl(&scene, &draw), bowl(&scene, &mirrored(&draw, twins)));
            let sides = [&here, &there].map(|rest| rest.entry.map(|entry| (entry.across, entry.angle)));
            assert_eq!(sides[0], sides[1].map(|(across, angle)| (-across, -angle)), "shot {shot}");
            let first = |rest: &Rest| rest.struck.first().copied();
            let twin = |pin: u8| pins[twins[pins.iter().position(|known| *known == u32::from(pin)).unwrap()]] as u8;
            assert_eq!(first(&here), first(&there).map(twin), "shot {shot}");
            met += u32::from(here.entry.is_some());
            if pins.len() == 1 {
                assert_eq!(here.pins, there.pins, "shot {shot}");
            }
        }
        assert!(met >= 3, "{met} shots met a pin");
    }
}

/// In these shots at ten pins with the standard preset, the energy never grows by more than a hundredth of a pin's
/// weight times the radius of its foot: 4 mJ, of some 150 J that the ball brings. Pushing bodies out of overlaps needs
/// this much, and in one of thousands of shots up to 28 mJ. In the last of these, two pins wedge each other in a
/// gutter: if they passed on all of their impulses, an event would make 246 J.
#[test]
fn energy_does_not_grow_over_a_shot() {
    let scene = scene(|_| ());
    let bound = 0.01 * scene.config().pin_kg * GRAVITY * 0.0258;
    for shot in [2, 7, 9, 28, 49_360] {
        let draw = scene.start(&mut Seed(1).chain(shot).at(0, Purpose::START));
        let (world, starts) = scene.world(&draw).unwrap();
        let mut state = world.state(&starts).unwrap();
        let mut rises = Tally::default();
        let mut ledger = Ledger::of(&world, state.bodies(), 1.0, &mut rises);
        let first = ledger.sum();
        world.run(&mut state, &mut Scratch::default(), scene.config().duration_s, &mut ledger).unwrap();
        let reached = StateOf::<Bowling>::evaluate(&scene, draw, &mut Work::default()).unwrap().outcome.struck.len();
        ledger.close();
        assert!(ledger.sum() < first, "shot {shot}");
        assert!(rises.largest <= bound, "shot {shot}: {} J, of {bound} J", rises.largest);
        assert!(reached > 0, "shot {shot} meets no pin");
    }
}
