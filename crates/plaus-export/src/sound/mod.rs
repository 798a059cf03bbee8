//! Sound of an animation, by a simple physical model: what hits what, how hard, and what both are made of.
//!
//! - **Impacts** press two things together for as long as Hertz says (Johnson, *Contact Mechanics*, 1985, equation
//!   11.24), with a force that rises and falls as half a sine wave and has the impact's impulse. Short and hard contact
//!   is bright, long and soft contact dull.
//! - **Clicks**: a small body that is suddenly slowed down pushes air about as an oscillating sphere does: a pressure
//!   that goes with the rate of its acceleration (Koss & Alfredson, *J. Sound Vib.* 27, 1973). That is what one hears
//!   of marbles and dice, whose own tones are beyond hearing.
//! - **Rings**: modes of free spheres, bars and panels, with the frequencies that size and stiffness give and the loss
//!   of what they are made of, radiate as small pistons (van den Doel & Pai, *Presence* 7, 1998, for modal synthesis;
//!   Rayleigh for the piston).
//! - **Rolling and slipping**: roughness that is run over lifts the body: a random force whose pitch goes with the
//!   speed, and whose strength goes with the force between the two and with the roughness of both (after Thompson,
//!   *Railway Noise and Vibration*, 2009, chapter 2, without its wheels).
//!
//! The pressure is that at a metre. A file is turned up or down so that its loudest moment is at −1 dB: nothing clips.
//! Noise comes from a counter, sines from [`plaus_dist::math`]: the same bytes everywhere.

mod substance;

use crate::clip::{Clip, ExportError};
use plaus_dist::math::{cos, exp, ln, square};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use substance::{Mode, Sounding, of_body, of_prop, unknown};

/// Samples a second.
pub const RATE: u32 = 48_000;
/// Silence after the last moment, s: what rings then may fade.
const TAIL: f64 = 0.6;
/// Highest frequency of a mode that is heard, Hz.
const HIGHEST: f64 = 18_000.0;
/// Density of air, kg/m³, and the speed of sound, m/s.
const AIR: [f64; 2] = [1.2, 343.0];
/// Distance of whoever listens, m.
const DISTANCE: f64 = 1.0;
/// Size of what roughness consists of, m: its pitch is the speed over that.
const GRAIN: f64 = 1e-3;
/// Loudest moment of a file, as a share of what a sample can hold: −1 dB.
const LOUDEST: f64 = 0.891;

/// The force on each thing that sounds, N, sample by sample.
struct Forces {
    names: BTreeMap<String, usize>,
    things: Vec<(Sounding, Vec<f64>)>,
    samples: usize,
}

/// Pressure at a metre, in Pa, [`RATE`] samples a second, from the beginning of the clip until shortly after its end.
#[must_use]
pub fn pressure(clip: &Clip<'_>) -> Vec<f64> {
    let samples = ((clip.cut.length() + TAIL) * f64::from(RATE)).ceil() as usize;
    let mut forces = Forces { names: BTreeMap::new(), things: Vec::new(), samples };
    for hit in clip.animation.impacts.iter().filter(|hit| clip.cut.holds(hit.time)) {
        let pair = [forces.place(clip, &hit.body), forces.place(clip, &hit.other)];
        let time = contact_time(&forces.things[pair[0]].0, &forces.things[pair[1]].0, hit.speed);
        pair.into_iter().for_each(|thing| forces.strike(thing, hit.time - clip.cut.from(), time, hit.impulse));
    }
    for (number, contact) in clip.animation.contacts.iter().enumerate() {
        let pair = [forces.place(clip, &contact.body), forces.place(clip, &contact.other)];
        let rough = pair.map(|thing| forces.things[thing].0.substance.rough);
        let [start, end] = [contact.start, contact.end].map(|time| time - clip.cut.from());
        // What lifts the body as it runs over a grain: the share of the weight that the grain's slope is.
        let slope = (square(rough[0]) + square(rough[1])).sqrt() / GRAIN;
        let (roll, slip) = (contact.roll, contact.slip);
        for (speed, strength, noise) in [(roll, 1.0, 2 * number), (slip, 3.0, 2 * number + 1)] {
            let force = strength * slope * contact.force;
            pair.into_iter().for_each(|thing| forces.rub(thing, [start, end], speed, force, noise as u64));
        }
    }
    let mut air = vec![0.0; samples];
    for (sounding, force) in &forces.things {
        click(sounding, force, &mut air);
        sounding.modes.iter().filter(|mode| mode.frequency < HIGHEST).for_each(|mode| ring(mode, force, &mut air));
    }
    air
}

impl Forces {
    fn place(&mut self, clip: &Clip<'_>, name: &str) -> usize {
        if let Some(place) = self.names.get(name) {
            return *place;
        }
        let body = clip.animation.tracks.iter().find(|track| track.name == name).map(of_body);
        let prop = || clip.animation.scenery.iter().find(|prop| prop.name == name).map(of_prop);
        let sounding = body.or_else(prop).unwrap_or_else(unknown);
        self.things.push((sounding, vec![0.0; self.samples]));
        self.names.insert(name.to_owned(), self.things.len() - 1);
        self.things.len() - 1
    }

    /// A force like half a sine wave: each sample has its mean over the sample, so that pulses shorter than one keep
    /// their impulse.
    fn strike(&mut self, thing: usize, start: f64, time: f64, impulse: f64) {
        let rate = f64::from(RATE);
        // The impulse so far of a pulse of impulse 1.
        let so_far = |t: f64| 0.5 * (1.0 - cos(PI * (t / time).clamp(0.0, 1.0)));
        let first = (start * rate).floor().max(0.0) as usize;
        let last = ((start + time) * rate).ceil() as usize;
        let force = &mut self.things[thing].1;
        for (sample, force) in force.iter_mut().enumerate().take(last + 1).skip(first) {
            let at = |sample: usize| sample as f64 / rate - start;
            *force += impulse * (so_far(at(sample + 1)) - so_far(at(sample))) * rate;
        }
    }

    /// A random force that follows grains of a surface, smooth at its ends.
    fn rub(&mut self, thing: usize, [start, end]: [f64; 2], speed: f64, strength: f64, noise: u64) {
        if speed <= 0.0 || strength <= 0.0 {
            return;
        }
        let rate = f64::from(RATE);
        let [first, last] = [start, end].map(|time| (time * rate).max(0.0) as usize);
        // One number a grain, and a cosine between them.
        let step = (speed / GRAIN / rate).min(1.0);
        let force = &mut self.things[thing].1;
        for (sample, force) in force.iter_mut().enumerate().take(last).skip(first) {
            let along = (sample - first) as f64 * step;
            let (grain, share) = (along.floor(), along.fract());
            let [a, b] = [0, 1].map(|next| uneven(noise, grain as u64 + next));
            let smooth = 0.5 * (1.0 - cos(PI * share));
            let edge = ((sample - first).min(last - 1 - sample) as f64 / 48.0).min(1.0);
            *force += strength * edge * (a + (b - a) * smooth);
        }
    }
}

/// A number from −1 to 1 for each place: a hash (the finaliser of SplitMix64).
fn uneven(noise: u64, place: u64) -> f64 {
    let mut x = noise.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(place).wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// How long two things touch that meet at a speed, s: Hertz. Shorter than a hundredth of a second in any case.
fn contact_time(a: &Sounding, b: &Sounding, speed: f64) -> f64 {
    let soft = |thing: &Sounding| (1.0 - square(thing.substance.poisson)) / thing.substance.young;
    let stiff = 1.0 / (soft(a) + soft(b));
    let radius = 1.0 / (1.0 / a.radius + 1.0 / b.radius);
    let mass = 1.0 / (1.0 / a.mass + 1.0 / b.mass);
    let fifth = |x: f64| exp(0.2 * ln(x));
    (2.87 * fifth(square(mass) / (radius * square(stiff) * speed.max(1e-3)))).min(0.01)
}

/// The pressure of a body that is slowed down, as an oscillating sphere's: ρ a³ / (2 c r) times the rate of its
/// acceleration.
fn click(sounding: &Sounding, force: &[f64], air: &mut [f64]) {
    if !sounding.mass.is_finite() {
        return;
    }
    let volume = sounding.mass / sounding.substance.density;
    let cube = volume * 3.0 / (4.0 * PI);
    let factor = AIR[0] * cube / (2.0 * AIR[1] * DISTANCE * sounding.mass) * f64::from(RATE);
    for (air, pair) in air.iter_mut().skip(1).zip(force.windows(2)) {
        *air += factor * (pair[1] - pair[0]);
    }
}

/// The pressure of a mode: a resonator that the force drives, and a piston of its area that radiates, the less the
/// smaller it is to its wave length.
fn ring(mode: &Mode, force: &[f64], air: &mut [f64]) {
    let (step, omega) = (1.0 / f64::from(RATE), TAU * mode.frequency);
    let decay = exp(-0.5 * mode.loss * omega * step);
    let (first, second) = (2.0 * decay * cos(omega * step), -decay * decay);
    // The velocity that an impulse gives, and the pressure of its rate.
    let size = omega / AIR[1] * (mode.area / PI).sqrt();
    let radiates = square(size) / (1.0 + square(size));
    let factor = AIR[0] * mode.area * radiates / (2.0 * PI * DISTANCE) * omega * step / mode.mass;
    let (mut before, mut last) = (0.0, 0.0);
    for (air, force) in air.iter_mut().zip(force) {
        let now = first * last + second * before + force;
        *air += factor * (now - last * decay);
        (before, last) = (last, now);
    }
}

/// A WAV file of one channel and 16 bits: clips one after the other.
///
/// # Errors
/// [`ExportError::TooLong`] where it would be longer than 4 GiB.
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
