//! Sound of an animation, from a simple physical model: which things hit each other, how hard, and what both are made
//! of.
//!
//! - **Impacts** press two things together for the time that Hertz gives (Johnson, *Contact Mechanics*, 1985, equation
//!   11.24), with a force that rises and falls as half a sine wave and has the impact's impulse. Short, hard contact
//!   sounds bright; long, soft contact sounds dull.
//! - **Clicks**: a small body that is suddenly slowed pushes air like an oscillating sphere, with a pressure
//!   proportional to the rate of change of its acceleration (Koss & Alfredson, *J. Sound Vib.* 27, 1973). This is the
//!   sound of marbles and dice, whose own tones are too high to hear.
//! - **Rings**: modes of free spheres, bars and panels, with frequencies from size and stiffness and losses from the
//!   material, radiate as small pistons (van den Doel & Pai, *Presence* 7, 1998, for modal synthesis; Rayleigh for the
//!   piston).
//! - **Rolling and slipping**: moving over roughness presses the contact in and out. This gives a random force whose
//!   pitch is proportional to the speed, and whose strength is the roughness of both surfaces times the stiffness of
//!   their contact (after Thompson, *Railway Noise and Vibration*, 2009, chapter 2, above the contact's resonance).
//!
//! The pressure is that at a distance of one metre. A file is scaled so that its loudest moment is at −1 dB: nothing
//! clips. Noise comes from a counter, sines from [`plaus_dist::math`]: the same bytes everywhere.

mod substance;

use crate::clip::{Clip, ExportError};
use plaus_animation::Animation;
use plaus_dist::math::{cbrt, cos, exp, ln, square};
use std::f64::consts::{PI, TAU};
use substance::{Mode, Sounding, of_body, of_prop, unknown};

/// Samples per second.
pub const RATE: u32 = 48_000;
/// Silence after the last moment, in s, so that ringing can fade.
const TAIL: f64 = 0.6;
/// Highest audible frequency of a mode, in Hz.
const HIGHEST: f64 = 18_000.0;
/// Density of air, kg/m³, and the speed of sound, m/s.
const AIR: [f64; 2] = [1.2, 343.0];
/// Distance of the listener, m.
const DISTANCE: f64 = 1.0;
/// Size of the grains of roughness, m; the pitch is the speed divided by this.
const GRAIN: f64 = 1e-3;
/// Samples over which rolling and slipping fade in and out: a millisecond.
const EDGE: f64 = 48.0;
/// Slowest motion of a contact that is heard, m/s.
const SLOWEST: f64 = 1e-3;
/// Force of slipping over that of rolling at the same speed: grains are torn over each other.
const SLIPPING: f64 = 3.0;
/// Loudest moment of a file, as a share of what a sample can hold: −1 dB.
const LOUDEST: f64 = 0.891;

/// The sounds of an animation: things that sound, and what presses them and when.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Score {
    /// Things by name, in the order in which they are first pressed.
    pub things: Vec<(String, Thing)>,
    /// One for each impact of the animation, in order.
    pub strikes: Vec<Strike>,
    /// One for each contact that lasts and in which something moves, in order.
    pub rubs: Vec<Rub>,
}

/// A thing that sounds, a metre away.
#[derive(Debug, Clone, PartialEq)]
pub struct Thing {
    /// Pressure for a rate of change of force, Pa s/N: the sound of a body that is slowed down.
    pub click: f64,
    /// Its audible modes.
    pub modes: Vec<Resonator>,
    /// Its material, mass and curvature.
    sounding: Sounding,
}

/// A mode: its response to a force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonator {
    /// Rad/s.
    pub omega: f64,
    /// How fast it fades, 1/s.
    pub fades: f64,
    /// Pressure for a change of its velocity by the impulse of 1 N s, Pa/(N s), times s.
    pub loud: f64,
}

/// An impact: a force like half a sine wave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strike {
    /// s, from the beginning of the animation.
    pub start: f64,
    /// s.
    pub length: f64,
    /// N s.
    pub impulse: f64,
    /// Numbers of both things.
    pub pair: [usize; 2],
}

/// A contact: forces that follow the grains of both surfaces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rub {
    /// s, from the beginning of the animation.
    pub start: f64,
    /// s, from the beginning of the animation.
    pub end: f64,
    /// m/s, of rolling and of slipping.
    pub speeds: [f64; 2],
    /// N, of rolling and of slipping.
    pub forces: [f64; 2],
    /// Numbers of both things.
    pub pair: [usize; 2],
}

/// The sounds of an animation.
#[must_use]
pub fn score(animation: &Animation) -> Score {
    let mut score = Score::default();
    for hit in &animation.motion.impacts {
        let pair = [score.place(animation, &hit.body), score.place(animation, &hit.other)];
        let [a, b] = pair.map(|thing| &score.things[thing].1.sounding);
        let length = contact_time(a, b, hit.speed);
        score.strikes.push(Strike { start: hit.time, length, impulse: hit.impulse, pair });
    }
    for contact in animation.motion.contacts.iter().filter(|contact| contact.slip + contact.roll > SLOWEST) {
        let pair = [score.place(animation, &contact.body), score.place(animation, &contact.other)];
        let [a, b] = pair.map(|thing| &score.things[thing].1.sounding);
        let (speeds, force) = ([contact.roll, contact.slip], roughly(a, b, contact.force));
        let (start, end) = (contact.start, contact.end);
        score.rubs.push(Rub { start, end, speeds, forces: [force, SLIPPING * force], pair });
    }
    score
}

impl Score {
    fn place(&mut self, animation: &Animation, name: &str) -> usize {
        if let Some(place) = self.things.iter().position(|(known, _)| known == name) {
            return place;
        }
        let body = animation.motion.tracks.iter().find(|track| track.name == name).map(of_body);
        let prop = || animation.scenery.iter().find(|prop| prop.name == name).map(of_prop);
        let sounding = body.or_else(prop).unwrap_or_else(unknown);
        self.things.push((name.to_owned(), Thing::of(sounding)));
        self.things.len() - 1
    }
}

/// Pressure at a metre, in Pa, [`RATE`] samples a second, from the beginning of the clip until shortly after its end.
#[must_use]
pub fn pressure(clip: &Clip<'_>) -> Vec<f64> {
    let samples = ((clip.cut.length() + TAIL) * f64::from(RATE)).ceil() as usize;
    let (score, begin) = (score(clip.animation), clip.cut.from());
    let mut forces = Forces(vec![vec![0.0; samples]; score.things.len()]);
    for strike in score.strikes.iter().filter(|strike| clip.cut.holds(strike.start)) {
        let mut strike_one = |thing| forces.strike(thing, strike.start - begin, strike.length, strike.impulse);
        strike.pair.into_iter().for_each(&mut strike_one);
    }
    for (number, rub) in score.rubs.iter().enumerate() {
        let span = [rub.start, rub.end].map(|time| time - begin);
        for kind in 0..2 {
            let noise = (2 * number + kind) as u64;
            let mut rub_one = |thing| forces.rub(thing, span, rub.speeds[kind], rub.forces[kind], noise);
            rub.pair.into_iter().for_each(&mut rub_one);
        }
    }
    let mut air = vec![0.0; samples];
    for ((_, thing), force) in score.things.iter().zip(&forces.0) {
        click(thing, force, &mut air);
        thing.modes.iter().for_each(|mode| ring(mode, force, &mut air));
    }
    air
}

/// The force on each thing that sounds, N, sample by sample.
struct Forces(Vec<Vec<f64>>);

impl Forces {
    /// A force like half a sine wave. Each sample is the mean over its duration, so that pulses shorter than one sample
    /// keep their impulse.
    fn strike(&mut self, thing: usize, start: f64, time: f64, impulse: f64) {
        let rate = f64::from(RATE);
        // The impulse up to a time, for a pulse of impulse 1.
        let so_far = |t: f64| 0.5 * (1.0 - cos(PI * (t / time).clamp(0.0, 1.0)));
        let first = (start * rate).floor().max(0.0) as usize;
        let last = ((start + time) * rate).ceil() as usize;
        let force = &mut self.0[thing];
        for (sample, force) in force.iter_mut().enumerate().take(last + 1).skip(first) {
            let at = |sample: usize| sample as f64 / rate - start;
            *force += impulse * (so_far(at(sample + 1)) - so_far(at(sample))) * rate;
        }
    }

    /// A random force that follows the grains of a surface. It fades in and out within a millisecond around its ends,
    /// so that successive contacts make one continuous sound.
    fn rub(&mut self, thing: usize, [start, end]: [f64; 2], speed: f64, strength: f64, noise: u64) {
        if speed <= 0.0 || strength <= 0.0 {
            return;
        }
        let rate = f64::from(RATE);
        let half = 0.5 * EDGE / rate;
        let [first, last] = [start - half, end + half].map(|time| (time * rate).max(0.0) as usize);
        // One number for each grain, with a cosine between them.
        let step = (speed / GRAIN / rate).min(1.0);
        let force = &mut self.0[thing];
        for (sample, force) in force.iter_mut().enumerate().take(last).skip(first) {
            let along = (sample - first) as f64 * step;
            let (grain, share) = (along.floor(), along.fract());
            let [a, b] = [0, 1].map(|next| uneven(noise, grain as u64 + next));
            let smooth = 0.5 * (1.0 - cos(PI * share));
            let edge = ((sample - first).min(last - 1 - sample) as f64 / EDGE).min(1.0);
            *force += strength * edge * (a + (b - a) * smooth);
        }
    }
}

/// A number from −1 to 1 for each index: a hash (the finaliser of SplitMix64).
fn uneven(noise: u64, place: u64) -> f64 {
    let mut x = noise.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(place).wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// Reduced modulus, Pa, and radius, m, of two things that touch.
fn reduced(a: &Sounding, b: &Sounding) -> [f64; 2] {
    let soft = |thing: &Sounding| (1.0 - square(thing.substance.poisson)) / thing.substance.young;
    [1.0 / (soft(a) + soft(b)), 1.0 / (1.0 / a.radius + 1.0 / b.radius)]
}

/// The force of roughness on two things pressed together, N: how far the grains of both push the contact in, times its
/// stiffness (Hertz, `(6 E² R F)^(1/3)`). It is at most the force itself; otherwise the things would separate.
fn roughly(a: &Sounding, b: &Sounding, force: f64) -> f64 {
    let [modulus, radius] = reduced(a, b);
    let stiffness = cbrt(6.0 * square(modulus) * radius * force);
    let grains = (square(a.substance.rough) + square(b.substance.rough)).sqrt();
    (stiffness * grains).min(force)
}

/// How long two things touch when they meet at a given speed, s: Hertz. At most a hundredth of a second.
fn contact_time(a: &Sounding, b: &Sounding, speed: f64) -> f64 {
    let [stiff, radius] = reduced(a, b);
    let mass = 1.0 / (1.0 / a.mass + 1.0 / b.mass);
    let fifth = |x: f64| exp(0.2 * ln(x));
    (2.87 * fifth(square(mass) / (radius * square(stiff) * speed.max(1e-3)))).min(0.01)
}

impl Thing {
    fn of(sounding: Sounding) -> Self {
        let heard = sounding.modes.iter().filter(|mode| mode.frequency < HIGHEST);
        let modes = heard.map(Resonator::of).collect();
        // The pressure of an oscillating sphere: ρ a³ / (2 c r) times the rate of its acceleration.
        let volume = sounding.mass / sounding.substance.density;
        let cube = volume * 3.0 / (4.0 * PI);
        let click =
            if sounding.mass.is_finite() { AIR[0] * cube / (2.0 * AIR[1] * DISTANCE * sounding.mass) } else { 0.0 };
        Self { click, modes, sounding }
    }
}

impl Resonator {
    /// A piston of the mode's area, which radiates less the smaller it is compared with its wavelength.
    fn of(mode: &Mode) -> Self {
        let omega = TAU * mode.frequency;
        let size = omega / AIR[1] * (mode.area / PI).sqrt();
        let radiates = square(size) / (1.0 + square(size));
        let loud = AIR[0] * mode.area * radiates / (2.0 * PI * DISTANCE) * omega / mode.mass;
        Self { omega, fades: 0.5 * mode.loss * omega, loud }
    }
}

fn click(thing: &Thing, force: &[f64], air: &mut [f64]) {
    let factor = thing.click * f64::from(RATE);
    if factor == 0.0 {
        return;
    }
    for (air, pair) in air.iter_mut().skip(1).zip(force.windows(2)) {
        *air += factor * (pair[1] - pair[0]);
    }
}

/// The pressure of a mode: a resonator that the force drives.
fn ring(mode: &Resonator, force: &[f64], air: &mut [f64]) {
    let step = 1.0 / f64::from(RATE);
    let decay = exp(-mode.fades * step);
    let (first, second) = (2.0 * decay * cos(mode.omega * step), -decay * decay);
    // The velocity that an impulse gives, and the pressure from its rate of change.
    let factor = mode.loud * step;
    let (mut before, mut last) = (0.0, 0.0);
    for (air, force) in air.iter_mut().zip(force) {
        let now = first * last + second * before + force;
        *air += factor * (now - last * decay);
        (before, last) = (last, now);
    }
}

/// A WAV file of one channel and 16 bits: one clip after the other.
///
/// # Errors
/// [`ExportError::TooLong`] if it would be longer than 4 GiB.
pub fn wav(pressure: &[f64], generator: &str) -> Result<Vec<u8>, ExportError> {
    let peak = pressure.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let gain = if peak > 0.0 { LOUDEST * f64::from(i16::MAX) / peak } else { 0.0 };
    let mut name = generator.as_bytes().to_vec();
    name.resize((name.len() + 1).next_multiple_of(2), 0);
    let (info, data) = (4 + 8 + name.len(), 2 * pressure.len());
    let as_u32 = |length: usize| u32::try_from(length).map(u32::to_le_bytes).map_err(|_| ExportError::TooLong);
    let mut file = Vec::with_capacity(44 + 8 + info + data);
    file.extend(b"RIFF");
    file.extend(as_u32(4 + 24 + 8 + info + 8 + data)?);
    file.extend(b"WAVELIST");
    file.extend(as_u32(info)?);
    file.extend(b"INFOISFT");
    file.extend(as_u32(name.len())?);
    file.extend(name);
    file.extend(b"fmt ");
    file.extend(16_u32.to_le_bytes());
    file.extend([1_u16, 1].map(u16::to_le_bytes).as_flattened());
    file.extend([RATE, 2 * RATE].map(u32::to_le_bytes).as_flattened());
    file.extend([2_u16, 16].map(u16::to_le_bytes).as_flattened());
    file.extend(b"data");
    file.extend(as_u32(data)?);
    file.extend(pressure.iter().flat_map(|x| ((x * gain).round() as i16).to_le_bytes()));
    Ok(file)
}

#[cfg(test)]
mod tests;
