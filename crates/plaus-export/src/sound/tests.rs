//! Pitches, loudness, silence, and the file.

use super::*;
use crate::clip::{Cut, Label};
use glam::DVec3;
use plaus_animation::{Animation, Contact, Impact, Look, Motion, Piece, Prop, Shape, Track};
use plaus_dist::math::sin;

fn heard(shape: Shape, look: Look, table: Look, impulse: f64, contacts: Vec<Contact>) -> Vec<f64> {
    let body = Track::new("body", shape, look, vec![Piece::resting(0.0, DVec3::ZERO)]);
    let hit = Impact::new(0.1, "body", "table", DVec3::ZERO, DVec3::Y).with_strength(1.0, impulse);
    let table = Prop::block("table", table, DVec3::ZERO, DVec3::new(0.5, 0.02, 0.5));
    let animation =
        Animation::from(Motion::new(0.5, vec![body], vec![hit]).with_contacts(contacts)).with_scenery(vec![table]);
    let label = Label::new("one");
    pressure(&Clip::new(&animation, &label, Cut::new(60.0, None, &animation).unwrap()))
}

/// Mean of the frequencies between 100 Hz and 20 kHz, weighted by power.
fn brightness(air: &[f64]) -> f64 {
    let window = &air[4700..6700];
    let power = |frequency: f64| {
        let part = |wave: fn(f64) -> f64| -> f64 {
            let at = |k: usize| wave(TAU * frequency * k as f64 / f64::from(RATE));
            window.iter().enumerate().map(|(k, x)| x * at(k)).sum()
        };
        square(part(cos)) + square(part(sin))
    };
    let bands: Vec<f64> = (1..=200).map(|k| 100.0 * f64::from(k)).collect();
    let powers: Vec<f64> = bands.iter().map(|band| power(*band)).collect();
    bands.iter().zip(&powers).map(|(band, power)| band * power).sum::<f64>() / powers.iter().sum::<f64>()
}

fn energy(air: &[f64]) -> f64 {
    air.iter().map(|x| x * x).sum()
}

fn pin() -> Shape {
    let profile = vec![[0.026, -0.15], [0.06, -0.05], [0.024, 0.1], [0.032, 0.18], [0.0, 0.23]];
    Shape::Revolution { profile, stripes: vec![] }
}

#[test]
fn marbles_are_brighter_than_dice_and_dice_than_pins() {
    let marble = brightness(&heard(Shape::ball(0.008), Look::nth(0), Look::GLASS, 0.01, vec![]));
    let die = brightness(&heard(Shape::die(0.016), Look::IVORY, Look::FELT, 0.01, vec![]));
    let pin = brightness(&heard(pin(), Look::IVORY, Look::WOOD, 0.5, vec![]));
    assert!(marble > 1.5 * die.max(pin), "{marble} {die} {pin} Hz");
    assert!((500.0..4000.0).contains(&pin), "wood: {pin} Hz");
}

#[test]
fn harder_impacts_are_louder_and_silence_comes_before() {
    let [soft, hard] = [0.1, 0.2].map(|impulse| heard(pin(), Look::IVORY, Look::WOOD, impulse, vec![]));
    assert!((energy(&hard) / energy(&soft) - 4.0).abs() < 1e-9, "linear in the impulse");
    assert_eq!(energy(&soft[..4799]), 0.0);
    assert!(energy(&soft[40_000..]) < 1e-3 * energy(&soft), "it fades");
}

fn rolls([start, end]: [f64; 2], roll: f64, force: f64) -> Contact {
    Contact {
        start,
        end,
        body: "body".into(),
        other: "table".into(),
        point: DVec3::ZERO,
        normal: DVec3::Y,
        slip: 0.0,
        roll,
        force,
    }
}

/// A bowling ball of 6.8 kg on planed maple, computed by hand: the reduced modulus is 3.44e9 Pa, Hertz gives a
/// stiffness of 8.00e6 N/m, and grains of 4 µm and 1 µm are 4.12 µm together, so the force is 33.0 N.
#[test]
fn the_force_of_roughness_follows_the_stiffness_of_the_contact() {
    let ball = Track::new("ball", Shape::Sphere { radius: 0.108, holes: true }, Look::nth(1), vec![]);
    let lane = Prop::block("lane", Look::WOOD, DVec3::ZERO, DVec3::new(0.5, 0.02, 0.5));
    let [ball, lane] = [of_body(&ball), of_prop(&lane)];
    let force = roughly(&ball, &lane, 6.8 * 9.81);
    assert!((force - 33.0).abs() < 0.1, "{force} N"); // three digits
    assert_eq!(roughly(&ball, &lane, 1e-3), 1e-3, "roughness never presses harder than the contact itself");
}

#[test]
fn successive_contacts_make_one_sound() {
    let ball = Shape::Sphere { radius: 0.108, holes: true };
    let loud = |contacts: Vec<Contact>| heard(ball.clone(), Look::nth(1), Look::WOOD, 0.0, contacts);
    // A tenth of a second in one piece, and in fifty pieces: the same noise, with other grains.
    let whole = energy(&loud(vec![rolls([0.1, 0.2], 6.0, 60.0)]));
    let pieces = (0..50).map(|k| rolls([0.1 + 2e-3 * f64::from(k), 0.102 + 2e-3 * f64::from(k)], 6.0, 60.0));
    let ratio = energy(&loud(pieces.collect())) / whole;
    // During a cross-fade, which is half of the time, two noises together have between 1/2 and 1 of the power of one.
    assert!((0.5..1.2).contains(&ratio), "{ratio}");
}

#[test]
fn rolling_is_heard_and_faster_is_brighter() {
    let roll = |roll: f64, force: f64| {
        let contact = rolls([0.09, 0.2], roll, force);
        heard(Shape::Sphere { radius: 0.108, holes: true }, Look::nth(1), Look::WOOD, 0.0, vec![contact])
    };
    assert_eq!(energy(&roll(2.0, 0.0)), 0.0);
    assert!(energy(&roll(2.0, 60.0)) > 0.0);
    assert!(brightness(&roll(8.0, 60.0)) > brightness(&roll(0.5, 60.0)));
}

#[test]
fn a_file_has_its_length_and_never_clips() {
    let air: Vec<f64> = (0..100).map(|k| 3e4 * sin(0.3 * f64::from(k))).collect();
    let file = wav(&air, "plaus 1").unwrap();
    let word = |at: usize| u32::from_le_bytes([file[at], file[at + 1], file[at + 2], file[at + 3]]);
    assert_eq!((&file[..4], word(4) as usize), (&b"RIFF"[..], file.len() - 8));
    let data = file.len() - 200;
    assert_eq!((&file[data - 8..data - 4], word(data - 4)), (&b"data"[..], 200));
    let largest = file[data..].chunks(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]]).unsigned_abs()).max();
    assert!((29_000..=29_196).contains(&largest.unwrap()), "{largest:?}: -1 dB");
    assert_eq!(wav(&[0.0; 4], "plaus 1").unwrap().len(), file.len() - 192);
}
