//! Keys of bodies as channels of one animation.

use super::Document;
use crate::clip::Clip;
use crate::keys::{Key, of_track, orientations};
use glam::{DQuat, DVec3};
use gltf_json::animation::{Animation, Channel, Interpolation, Property, Sampler, Target};
use gltf_json::extras::Extras;
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Mesh, Node, accessor::Accessor};
use plaus_animation::Track;

/// The node of a body, where the body is at `time`.
pub(super) fn node_at(track: &Track, time: f64, mesh: Option<Index<Mesh>>) -> Node {
    Node {
        mesh,
        name: Some(track.name.clone()),
        translation: Some(vector(track.position(time))),
        rotation: track.turns().then(|| UnitQuaternion(quaternion(track.orientation(time)))),
        ..Node::default()
    }
}

/// Adds the animation of all bodies, whose nodes are `nodes`.
pub(super) fn animate(document: &mut Document, clip: &Clip<'_>, nodes: &[Index<Node>], extras: Extras) {
    let mut animation = Animation {
        extensions: None,
        extras,
        channels: Vec::new(),
        name: Some(clip.label.name.clone()),
        samplers: Vec::new(),
    };
    let begin = clip.cut.from();
    for (track, &node) in clip.animation.tracks.iter().zip(nodes) {
        let keys = of_track(clip.animation, track, &clip.cut);
        let (times, splines) = translation(&keys, begin);
        let input = document.blob.times(&mut document.root, &times);
        let output = document.blob.values(&mut document.root, &splines);
        channel(&mut animation, node, Property::Translation, [input, output], Interpolation::CubicSpline);
        if track.turns() {
            let (times, values) = rotation(&orientations(track, &keys), begin);
            let input = document.blob.times(&mut document.root, &times);
            let output = document.blob.values(&mut document.root, &values);
            channel(&mut animation, node, Property::Rotation, [input, output], Interpolation::Linear);
        }
    }
    if !animation.channels.is_empty() {
        document.root.push(animation);
    }
}

fn channel(
    animation: &mut Animation,
    node: Index<Node>,
    path: Property,
    [input, output]: [Index<Accessor>; 2],
    interpolation: Interpolation,
) {
    let sampler = Sampler { extensions: None, extras: None, input, interpolation: Valid(interpolation), output };
    let sampler = Index::push(&mut animation.samplers, sampler);
    let target = Target { extensions: None, extras: None, node, path: Valid(path) };
    animation.channels.push(Channel { sampler, target, extensions: None, extras: None });
}

/// Times, and per key the tangent on arrival, the value, and the tangent on leaving. Keys that single precision cannot tell apart become one.
fn translation(keys: &[Key], begin: f64) -> (Vec<f32>, Vec<[f32; 3]>) {
    let (mut times, mut splines) = (Vec::<f32>::new(), Vec::<[f32; 3]>::new());
    for key in keys {
        let time = (key.time - begin) as f32;
        if times.last() == Some(&time) {
            // Arrives as the first of them did, leaves as the last.
            splines.truncate(splines.len() - 2);
        } else {
            times.push(time);
            splines.push(vector(key.arriving));
        }
        splines.extend([vector(key.position), vector(key.leaving)]);
    }
    (times, splines)
}

fn rotation(turns: &[(f64, DQuat)], begin: f64) -> (Vec<f32>, Vec<[f32; 4]>) {
    let (mut times, mut values) = (Vec::<f32>::new(), Vec::<[f32; 4]>::new());
    for &(time, orientation) in turns {
        let time = (time - begin) as f32;
        if times.last() == Some(&time) {
            values.pop();
        } else {
            times.push(time);
        }
        values.push(quaternion(orientation));
    }
    (times, values)
}

fn vector(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}

fn quaternion(q: DQuat) -> [f32; 4] {
    q.as_quat().normalize().to_array()
}
