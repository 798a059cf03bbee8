//! Solutions as bytes: closed-form pieces in columns of 16-bit numbers, which a browser plays at any frame rate.

use crate::models::{Bytes, Things};
use crate::sounds::Sounds;
use glam::DVec3;
use plaus_export::sound;
use plaus_scenes::animation::{Animation, Piece, Track, View};
use plaus_scenes::require::Timed;
use plaus_scenes::{Role, Scalar};
use serde_json::{Value, json};

/// A solution to show.
pub(crate) struct Shown<'a> {
    /// Its name on the page.
    pub(crate) id: String,
    pub(crate) chain: u32,
    /// Its number in its phase.
    pub(crate) draw: u64,
    pub(crate) phase: Value,
    pub(crate) iteration: u64,
    pub(crate) log_p: f64,
    pub(crate) log_prior: f64,
    pub(crate) log_constraint: f64,
    pub(crate) scalars: Vec<f64>,
    /// The times asked for, with the times found.
    pub(crate) times: Vec<(String, Timed)>,
    pub(crate) animation: &'a Animation,
}

/// Ranges of the quantised numbers, over all solutions that share them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ranges {
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
    pub(crate) spin: f64,
}

/// What solutions share, each thing once: they name it by its number.
#[derive(Debug, Default)]
pub(crate) struct Shared {
    pub(crate) things: Things,
    pub(crate) sounds: Sounds,
    pub(crate) names: Vec<String>,
}

impl Shared {
    /// How many there are of each: names, models, parts of the scenery, sounds.
    pub(crate) fn counts(&self) -> [usize; 4] {
        let Things { model_list, prop_list, .. } = &self.things;
        [self.names.len(), model_list.len(), prop_list.len(), self.sounds.list.len()]
    }

    /// Those that came after the first so many.
    pub(crate) fn since(&self, [names, models, props, sounds]: [usize; 4]) -> Value {
        let Things { model_list, prop_list, .. } = &self.things;
        json!({
            "names": self.names[names..], "models": model_list[models..], "props": prop_list[props..],
            "sounds": self.sounds.list[sounds..],
        })
    }
}

/// The numbers of a solution that a page shows.
pub(crate) fn without_details(scalars: &[Scalar], values: impl Iterator<Item = f64>) -> Vec<f64> {
    let all = values.zip(scalars);
    all.filter(|(_, scalar)| scalar.role != Role::Detail).map(|(value, _)| value).collect()
}

/// Length of a description, the description, bytes that it points into.
pub(crate) fn joined(description: &Value, bytes: &[u8]) -> Vec<u8> {
    let mut json = description.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut whole = (json.len() as u32).to_le_bytes().to_vec();
    whole.extend(json);
    whole.extend(bytes);
    whole
}

/// Where the eye is, and what it sees.
pub(crate) fn view(view: &View) -> Value {
    let frame = view.frame.map(|corners| corners.map(|corner| corner.to_array()));
    json!({"from": view.from.to_array(), "frame": frame, "alone": view.alone})
}

/// A solution, with its columns in `bytes`.
pub(crate) fn of_one(shown: &Shown<'_>, ranges: &Ranges, bytes: &mut Bytes, shared: &mut Shared) -> Value {
    let Shared { things, sounds, names } = shared;
    let animation = shown.animation;
    let mut number = |name: &str| {
        names.iter().position(|known| known == name).unwrap_or_else(|| {
            names.push(name.to_owned());
            names.len() - 1
        })
    };
    // A fourth number says that a body is not there before its first piece.
    let mut track = |track: &Track| {
        let three = [number(&track.name), things.model(bytes, track), track.pieces.len()];
        three.into_iter().chain(track.late.then_some(1)).collect()
    };
    let tracks: Vec<Vec<usize>> = animation.motion.tracks.iter().map(&mut track).collect();
    let hits: Vec<[u16; 2]> =
        animation.motion.impacts.iter().map(|hit| [number(&hit.body) as u16, number(&hit.other) as u16]).collect();
    let props: Vec<usize> = animation.scenery.iter().map(|prop| things.prop(bytes, prop)).collect();
    let turning = animation.motion.tracks.iter().any(Track::turns);
    let at = bytes.len();
    columns(animation, ranges, turning, bytes);
    bytes.f32s(animation.motion.impacts.iter().map(|hit| hit.time));
    bytes.f32s(animation.motion.impacts.iter().map(|hit| hit.speed));
    for side in 0..2 {
        bytes.u16s(hits.iter().map(|pair| pair[side]));
    }
    for axis in 0..3 {
        bytes.u16s(animation.motion.impacts.iter().map(|hit| ranges.share(hit.point, axis)));
    }
    let score = sound::score(animation);
    let rubs = sounds.add(&score, bytes);
    json!({
        "id": shown.id, "chain": shown.chain, "draw": shown.draw, "phase": shown.phase,
        "iteration": shown.iteration, "log_p": shown.log_p, "log_prior": shown.log_prior,
        "log_constraint": shown.log_constraint, "scalars": shown.scalars, "duration": animation.motion.duration,
        "tracks": tracks, "props": props, "turning": turning, "hits": hits.len(), "at": at,
        "rubs": rubs, "box": extent(animation).map(|corner| corner.to_array()), "asked": asked(&shown.times),
    })
}

/// The times asked for, with the times found; those with the same words are numbered.
fn asked(times: &[(String, Timed)]) -> Value {
    let one = |(k, (_, at)): (usize, &(String, Timed))| {
        let before = times[..k].iter().filter(|(_, other)| other.what == at.what).count();
        let what = if before == 0 { at.what.clone() } else { format!("{} ({})", at.what, before + 1) };
        // Infinity becomes `null`.
        json!({"what": what, "from": at.wanted.from, "to": at.wanted.to, "found": at.found})
    };
    times.iter().enumerate().map(one).collect()
}

/// All pieces of all tracks, one column after the other.
fn columns(animation: &Animation, ranges: &Ranges, turning: bool, bytes: &mut Bytes) {
    let pieces: Vec<&Piece> = animation.motion.tracks.iter().flat_map(|track| &track.pieces).collect();
    bytes.f32s(pieces.iter().map(|piece| piece.start));
    for axis in 0..3 {
        bytes.u16s(pieces.iter().map(|piece| ranges.share(piece.position, axis)));
    }
    for axis in 0..3 {
        bytes.i16s(pieces.iter().map(|piece| signed(piece.velocity[axis], ranges.velocity)));
    }
    for axis in 0..3 {
        bytes.i16s(pieces.iter().map(|piece| signed(piece.acceleration[axis], ranges.acceleration)));
    }
    if turning {
        for part in 0..4 {
            bytes.i16s(pieces.iter().map(|piece| signed(piece.turn.orientation.to_array()[part], 1.0)));
        }
        for axis in 0..3 {
            bytes.i16s(pieces.iter().map(|piece| signed(piece.turn.spin[axis], ranges.spin)));
        }
        bytes.i16s(pieces.iter().map(|piece| signed(piece.turn.own, ranges.spin)));
    }
}

impl Ranges {
    pub(crate) fn of<'a>(animations: impl Iterator<Item = &'a Animation>) -> Self {
        let tiny = f64::MIN_POSITIVE;
        let mut ranges =
            Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, velocity: tiny, acceleration: tiny, spin: tiny };
        for animation in animations {
            for piece in animation.motion.tracks.iter().flat_map(|track| &track.pieces) {
                ranges.include(piece.position);
                ranges.velocity = ranges.velocity.max(piece.velocity.abs().max_element());
                ranges.acceleration = ranges.acceleration.max(piece.acceleration.abs().max_element());
                ranges.spin = ranges.spin.max(piece.turn.spin.abs().max_element()).max(piece.turn.own.abs());
            }
            animation.motion.impacts.iter().for_each(|hit| ranges.include(hit.point));
        }
        ranges
    }

    fn include(&mut self, point: DVec3) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
    }

    fn share(&self, point: DVec3, axis: usize) -> u16 {
        let size = (self.high[axis] - self.low[axis]).max(f64::MIN_POSITIVE);
        ((point[axis] - self.low[axis]) / size * 65535.0).round() as u16
    }
}

fn signed(value: f64, largest: f64) -> i16 {
    (value / largest * 32767.0).round() as i16
}

/// The box in which all bodies move, including their extent.
fn extent(animation: &Animation) -> [DVec3; 2] {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for track in &animation.motion.tracks {
        let reach = DVec3::splat(track.shape.reach());
        for (index, piece) in track.pieces.iter().enumerate() {
            let end = track.pieces.get(index + 1).map_or(animation.motion.duration, |next| next.start).max(piece.start);
            let turns = (0..3).map(|axis| piece.start - piece.velocity[axis] / piece.acceleration[axis]);
            let within = turns.filter(|time| (piece.start..end).contains(time));
            for time in within.chain([piece.start, end]) {
                low = low.min(piece.position(time) - reach);
                high = high.max(piece.position(time) + reach);
            }
        }
    }
    if low.is_finite() && high.is_finite() { [low, high] } else { [DVec3::NEG_ONE, DVec3::ONE] }
}
