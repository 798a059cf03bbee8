//! Keyframes of nodes.

use super::{Glb, pose};
use glam::{DMat4, DQuat, DVec3};
use gltf::animation::util::ReadOutputs;
use gltf::animation::{Channel, Interpolation, Property};

/// Where a node is at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// In s.
    pub time: f64,
    /// Where its origin is in the file, in m.
    pub at: DVec3,
    /// Turns its axes into those of the file.
    pub turn: DQuat,
}

/// How a node moves between keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Between {
    /// It jumps.
    Step,
    /// Straight, and turning the shorter way.
    #[default]
    Linear,
    /// By a cubic spline.
    Cubic,
}

/// Values of one property at times.
struct Track<T> {
    times: Vec<f64>,
    values: Vec<T>,
    is_step: bool,
}

impl<T: Copy> Track<T> {
    /// The value at a time; `None` if there are no values.
    fn at(&self, time: f64, mix: impl Fn(T, T, f64) -> T) -> Option<T> {
        let after = self.times.partition_point(|&known| known <= time);
        let before = self.values.get(after.saturating_sub(1))?;
        let (Some(next), Some(&start)) = (self.values.get(after), self.times.get(after.wrapping_sub(1))) else {
            return Some(*before);
        };
        if self.is_step {
            return Some(*before);
        }
        Some(mix(*before, *next, (time - start) / (self.times[after] - start)))
    }
}

impl Glb {
    /// The keys of a node whose pose without animation is `world`, how it moves between them, and what is left out.
    pub(super) fn keys(&self, node: &gltf::Node<'_>, world: &DMat4) -> (Vec<Key>, Between, Vec<String>) {
        let (mut places, mut turns): (Option<Track<DVec3>>, Option<Track<DQuat>>) = (None, None);
        let (mut between, mut left_out) = (Between::Linear, Vec::new());
        let ours = |channel: &Channel<'_>| channel.target().node().index() == node.index();
        let channels = self.document.animations().flat_map(|animation| animation.channels().collect::<Vec<_>>());
        for channel in channels.filter(ours) {
            let property = channel.target().property();
            let (times, values) = self.samples(&channel);
            let is_new = match property {
                Property::Translation => places.is_none(),
                Property::Rotation => turns.is_none(),
                Property::Scale | Property::MorphTargetWeights => {
                    left_out.push(format!("its animated {property:?}: shapes do not change"));
                    continue;
                }
            };
            if !is_new {
                let what = format!("its {property:?} in another animation: the first one is used");
                if !left_out.contains(&what) {
                    left_out.push(what);
                }
                continue;
            }
            let interpolation = channel.sampler().interpolation();
            let is_step = interpolation == Interpolation::Step;
            between = match interpolation {
                Interpolation::Step => Between::Step,
                Interpolation::Linear => between,
                Interpolation::CubicSpline => Between::Cubic,
            };
            match values {
                Some(Values::Places(values)) if values.len() == times.len() => {
                    places = Some(Track { times, values, is_step });
                }
                Some(Values::Turns(values)) if values.len() == times.len() => {
                    turns = Some(Track { times, values, is_step });
                }
                _ => left_out.push(format!("its animated {property:?}: its keys cannot be read")),
            }
        }
        let mut times: Vec<f64> = Vec::new();
        times.extend(places.iter().flat_map(|track| &track.times).chain(turns.iter().flat_map(|track| &track.times)));
        times.sort_by(f64::total_cmp);
        times.dedup();
        let (translation, rotation, scale) = node.transform().decomposed();
        let own = DMat4::from_cols_array_2d(&node.transform().matrix().map(|column| column.map(f64::from)));
        let parent = *world * own.inverse();
        let key = |time: f64| {
            let at = places.as_ref().and_then(|track| track.at(time, |a, b, s| a.lerp(b, s)));
            let turn = turns.as_ref().and_then(|track| track.at(time, |a, b, s| a.slerp(b, s)));
            let at = at.unwrap_or_else(|| DVec3::from_array(translation.map(f64::from)));
            let turn = turn.unwrap_or_else(|| DQuat::from_array(rotation.map(f64::from)));
            let scale = DVec3::from_array(scale.map(f64::from));
            let (at, turn) = pose(&(parent * DMat4::from_scale_rotation_translation(scale, turn.normalize(), at)));
            Key { time, at, turn }
        };
        let keys: Vec<Key> = if parent.is_finite() { times.into_iter().map(key).collect() } else { Vec::new() };
        if keys.iter().any(|key| !key.time.is_finite() || !key.at.is_finite() || !key.turn.is_finite()) {
            left_out.push("its keys: not all are finite".into());
            return (Vec::new(), between, left_out);
        }
        (keys, between, left_out)
    }

    /// Times and values of a channel. For a cubic spline, only the values.
    fn samples(&self, channel: &Channel<'_>) -> (Vec<f64>, Option<Values>) {
        let reader = channel.reader(|_| Some(&self.blob[..]));
        let times: Vec<f64> = reader.read_inputs().into_iter().flatten().map(f64::from).collect();
        let cubic = channel.sampler().interpolation() == Interpolation::CubicSpline;
        let values = match reader.read_outputs() {
            Some(ReadOutputs::Translations(values)) => {
                Some(Values::Places(middle(values.map(|v| DVec3::from_array(v.map(f64::from))).collect(), cubic)))
            }
            Some(ReadOutputs::Rotations(values)) => {
                let turns = values.into_f32().map(|v| DQuat::from_array(v.map(f64::from)));
                Some(Values::Turns(middle(turns.collect(), cubic)))
            }
            _ => None,
        };
        (times, values)
    }
}

/// Values of a channel.
enum Values {
    Places(Vec<DVec3>),
    Turns(Vec<DQuat>),
}

/// The values from a spline's triples of tangent, value and tangent.
fn middle<T>(values: Vec<T>, is_cubic: bool) -> Vec<T> {
    if is_cubic { values.into_iter().skip(1).step_by(3).collect() } else { values }
}
