//! Shots with the simulator itself.

use super::straight::scene;
use plaus_dist::{LogPotential, Purpose, Seed};
use plaus_mcmc::{Simulated, StateOf, Target};
use plaus_scenes::Scene;
use plaus_scenes::bowling::{Bowling, Fate, Quantity, Shot, Work};

fn shot(scene: &Bowling, number: u64) -> Shot {
    scene.start(&mut Seed(1).chain(number).at(0, Purpose::START))
}

fn simulate(
    scene: &Bowling,
    draw: &Shot,
    floor: LogPotential,
    work: &mut Work,
) -> Simulated<plaus_scenes::bowling::Rest> {
    scene.simulate(draw, None, floor, work).unwrap()
}

/// A floor ends shots that cannot exceed it, and changes nothing in other shots.
#[test]
fn early_rejection_decides_as_the_whole_shot() {
    let scene = scene(|config| config.leave = vec![6, 7]);
    let (mut work, mut ended) = (Work::default(), 0);
    for number in 0..12 {
        let draw = shot(&scene, number);
        let Simulated::Complete(whole) = simulate(&scene, &draw, LogPotential::ZERO, &mut work) else { panic!() };
        let value = scene.log_constraint(&whole).unwrap();
        for reward in [20.0, 25.0, 27.5] {
            let floor = LogPotential::new(reward).unwrap();
            match simulate(&scene, &draw, floor, &mut work) {
                Simulated::Complete(rest) => assert_eq!(rest, whole),
                Simulated::CannotExceedFloor => {
                    assert!(value <= floor, "shot {number}");
                    ended += 1;
                }
            }
        }
    }
    assert!(ended > 0);
}

/// A ball in the gutter leaves all pins. It scores nothing towards a strike, except under appendix A's other reading.
#[test]
fn a_ball_in_the_gutter_is_no_strike() {
    for rewarded in ["meant_to_stand", "any_standing"] {
        let text = format!("[world.bowling]\nrewarded = \"{rewarded}\"");
        let scenario = plaus_scenes::Scenario::read("gutter", &text, &[]).unwrap();
        let plaus_scenes::registry::World::Bowling(config) = scenario.world else { panic!() };
        let scene = Bowling::new(&config).unwrap();
        let mut draw = shot(&scene, 0);
        draw.ball[Quantity::Across as usize] = 0.5;
        draw.ball[Quantity::Drift as usize] = 0.3;
        let Simulated::Complete(rest) = simulate(&scene, &draw, LogPotential::ZERO, &mut Work::default()) else {
            panic!()
        };
        assert!(rest.struck.is_empty() && rest.entry.is_none());
        assert!(rest.pins.iter().all(|fate| *fate == Fate::Standing(0.0)));
        let all = if rewarded == "any_standing" { 10 } else { 0 };
        assert_eq!(scene.counts(&rest), (0, all));
        assert!(!scene.is_satisfied(&rest));
    }
}

/// An animation agrees with the outcome: pins that are down lean, or are gone.
#[test]
fn animations_show_the_outcome() {
    let scene = scene(|_| ());
    for number in [2, 9] {
        let state = StateOf::<Bowling>::evaluate(&scene, shot(&scene, number), &mut Work::default()).unwrap();
        let animation = scene.animate(&state.draw).unwrap();
        assert_eq!(animation.motion.tracks.len(), 11);
        for (track, fate) in animation.motion.tracks[1..].iter().zip(&state.outcome.pins) {
            let up = (track.orientation(animation.motion.duration) * glam::DVec3::Z).y;
            let low = track.position(animation.motion.duration).y < 0.1;
            assert_eq!(fate.stands(), up > 0.5 && !low, "shot {number}, {}: {up}", track.name);
        }
    }
}

/// A shot that begins at the foul line is the shot of its draw. A ball that begins rolling just before the pins meets
/// them on the straight line along which it was sent.
#[test]
fn balls_may_begin_before_the_pins() {
    let scene = scene(|_| ());
    let (mut work, mut draw) = (Work::default(), shot(&scene, 2));
    let Simulated::Complete(whole) = simulate(&scene, &draw, LogPotential::ZERO, &mut work) else { panic!() };
    assert_eq!(scene.bowl_from(60.0 * 12.0 * 0.0254, &draw, &mut work).unwrap(), whole);
    assert!(whole.entry.is_some());
    let radius = draw.get(Quantity::Radius);
    let (speed, drift) = (8.0, -0.8);
    for (quantity, value) in [
        (Quantity::Across, 0.12),
        (Quantity::Height, radius),
        (Quantity::Speed, speed),
        (Quantity::Drift, drift),
        (Quantity::Roll, speed / radius),
        (Quantity::Hook, drift / radius),
        (Quantity::Twist, 0.0),
    ] {
        draw.ball[quantity as usize] = value;
    }
    let entry = scene.bowl_from(0.6, &draw, &mut work).unwrap().entry.unwrap();
    let angle = plaus_dist::math::atan2(drift, speed).to_degrees();
    assert!((entry.angle - angle).abs() < 1e-9, "{} for {angle}", entry.angle);
    assert!(entry.across < 0.12 && entry.across > 0.06);
}
