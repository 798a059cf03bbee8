//! Solutions as bytes: closed-form pieces in columns of 16-bit numbers, which a browser plays at any frame rate.

use crate::Options;
use crate::map::Maps;
use crate::models::{Bytes, Things};
use crate::page::Packed;
use crate::sounds::Sounds;
use crate::words::words;
use glam::DVec3;
use plaus_export::sound;
use plaus_run::RunReader;
use plaus_run::replay::Replay;
use plaus_scenes::animation::{Animation, Piece, View};
use plaus_scenes::require::Timed;
use plaus_scenes::{Role, Scene, Until};
use serde_json::{Value, json};

/// What the page says about itself.
pub(crate) struct About<'a> {
    pub(crate) options: &'a Options,
    pub(crate) distinct: usize,
    pub(crate) candidates: usize,
}

/// Ranges of the quantised numbers, over all solutions.
#[derive(Debug, Clone, Copy)]
struct Ranges {
    low: DVec3,
    high: DVec3,
    velocity: f64,
    acceleration: f64,
    spin: f64,
}

pub(crate) fn pack(run: &RunReader<'_>, replays: &[Replay], maps: &Maps, about: &About<'_>) -> Packed {
    let (mut bytes, mut things, mut names) = (Bytes::default(), Things::default(), Vec::new());
    let mut sounds = Sounds::default();
    let ranges = Ranges::of(replays);
    let mut scalars = run.scene().scalars();
    let mut samples = Vec::new();
    for (number, replay) in replays.iter().enumerate() {
        let mut sample = of_replay(replay, &ranges, &mut bytes, &mut things, &mut sounds, &mut names);
        let shown = replay.scalars.iter().zip(&scalars).filter(|(_, scalar)| scalar.role != Role::Detail);
        sample["scalars"] = json!(shown.map(|((_, value), _)| *value).collect::<Vec<f64>>());
        sample["outcome"] = json!(maps.outcomes[number]);
        sample["path"] = json!(maps.paths[number]);
        sample["asked"] = asked(&run.scene().times(&replay.animation));
        samples.push(sample);
    }
    let manifest = run.run().manifest();
    // The last ones are the margins of the requirements, in order.
    let required = &run.run().scenario().require;
    for (scalar, one) in scalars.iter_mut().rev().zip(required.iter().rev()) {
        scalar.name = format!("{}: {}", scalar.name, words(one));
    }
    let scalars: Vec<Value> = scalars
        .iter()
        .filter(|scalar| scalar.role != Role::Detail)
        .map(|scalar| json!({"name": scalar.name, "unit": scalar.unit, "draw": scalar.role == Role::Draw}))
        .collect();
    let view = replays.iter().filter_map(|replay| replay.animation.view).reduce(both);
    let meta = json!({
        "plaus": manifest.plaus,
        "scene": manifest.scene,
        "scenario": manifest.scenario.file,
        "overrides": manifest.said().collect::<Vec<_>>(),
        "hash": manifest.scenario.hash,
        "seed": manifest.plan.seed,
        "chains": manifest.plan.chains,
        "run": about.options.run,
        "until": match about.options.until {
            Until::Rest => Value::Null,
            Until::Decided => json!("decided"),
            Until::Time(seconds) => json!(format!("{seconds}s")),
        },
        "distinct": about.distinct,
        "candidates": about.candidates,
        "scalars": scalars,
        "names": names,
        "models": things.model_list,
        "props": things.prop_list,
        "sounds": sounds.list,
        "low": ranges.low.to_array(),
        "high": ranges.high.to_array(),
        "velocity": ranges.velocity,
        "acceleration": ranges.acceleration,
        "spin": ranges.spin,
        "from": view.map(|view| view.from.to_array()),
        "frame": view.and_then(|view| view.frame).map(|corners| corners.map(|corner| corner.to_array())),
        "alone": view.is_some_and(|view| view.alone),
        "samples": samples,
    });
    let set = manifest.said().map(|set| format!(" --set {set}")).collect::<String>();
    let title = format!("{} · {}{set} · plaus", manifest.scene, manifest.scenario.file);
    Packed { meta, bytes: bytes.0, title }
}

fn of_replay(
    replay: &Replay,
    ranges: &Ranges,
    bytes: &mut Bytes,
    things: &mut Things,
    sounds: &mut Sounds,
    names: &mut Vec<String>,
) -> Value {
    let animation = &replay.animation;
    let mut number = |name: &str| {
        names.iter().position(|known| known == name).unwrap_or_else(|| {
            names.push(name.to_owned());
            names.len() - 1
        })
    };
    let tracks: Vec<[usize; 3]> = animation
        .tracks
        .iter()
        .map(|track| [number(&track.name), things.model(bytes, track), track.pieces.len()])
        .collect();
    let hits: Vec<[u16; 2]> =
        animation.impacts.iter().map(|hit| [number(&hit.body) as u16, number(&hit.other) as u16]).collect();
    let props: Vec<usize> = animation.scenery.iter().map(|prop| things.prop(bytes, prop)).collect();
    let turning = animation.tracks.iter().any(plaus_scenes::animation::Track::turns);
    let at = bytes.len();
    columns(animation, ranges, turning, bytes);
    bytes.f32s(animation.impacts.iter().map(|hit| hit.time));
    bytes.f32s(animation.impacts.iter().map(|hit| hit.speed));
    for side in 0..2 {
        bytes.u16s(hits.iter().map(|pair| pair[side]));
    }
    for axis in 0..3 {
        bytes.u16s(animation.impacts.iter().map(|hit| ranges.share(hit.point, axis)));
    }
    let score = sound::score(animation);
    let rubs = sounds.add(&score, bytes);
    json!({
        "id": replay.sample.to_string(), "chain": replay.sample.chain, "draw": replay.sample.draw, "phase": replay.sample.phase,
        "iteration": replay.iteration, "log_p": replay.log_p, "log_prior": replay.log_prior,
        "log_constraint": replay.log_constraint, "duration": animation.duration,
        "tracks": tracks, "props": props, "turning": turning, "hits": hits.len(), "at": at,
        "rubs": rubs, "box": extent(animation).map(|corner| corner.to_array()),
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
    let pieces: Vec<&Piece> = animation.tracks.iter().flat_map(|track| &track.pieces).collect();
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
    fn of(replays: &[Replay]) -> Self {
        let tiny = f64::MIN_POSITIVE;
        let mut ranges =
            Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, velocity: tiny, acceleration: tiny, spin: tiny };
        for replay in replays {
            for piece in replay.animation.tracks.iter().flat_map(|track| &track.pieces) {
                ranges.include(piece.position);
                ranges.velocity = ranges.velocity.max(piece.velocity.abs().max_element());
                ranges.acceleration = ranges.acceleration.max(piece.acceleration.abs().max_element());
                ranges.spin = ranges.spin.max(piece.turn.spin.abs().max_element()).max(piece.turn.own.abs());
            }
            replay.animation.impacts.iter().for_each(|hit| ranges.include(hit.point));
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

/// A view that shows everything that either of the two shows.
fn both(one: View, other: View) -> View {
    let frame = match (one.frame, other.frame) {
        (Some([a, b]), Some([c, d])) => Some([a.min(b).min(c).min(d), a.max(b).max(c).max(d)]),
        (frame, None) | (None, frame) => frame,
    };
    View { frame, alone: one.alone && other.alone, ..one }
}

/// The box in which all bodies move, including their extent.
fn extent(animation: &Animation) -> [DVec3; 2] {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for track in &animation.tracks {
        let reach = DVec3::splat(track.shape.reach());
        for (index, piece) in track.pieces.iter().enumerate() {
            let end = track.pieces.get(index + 1).map_or(animation.duration, |next| next.start).max(piece.start);
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
