//! An animation with everything in it, and a reader of GLB that evaluates splines as the specification says.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

use glam::{DQuat, DVec3, Quat, Vec3};
use gltf::animation::util::ReadOutputs;
use gltf::animation::{Interpolation, Property};
use plaus_animation::{Animation, Impact, Look, Material, Piece, Prop, Shape, Stripe, Track, Turn};

/// A die that bounces, a pin that precesses, a ball that rolls fast.
pub fn tumbling() -> Animation {
    let gravity = DVec3::new(0.0, -9.81, 0.0);
    let spin = DVec3::new(11.0, -7.0, 3.0);
    let drop = Piece::ballistic(0.0, DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.4, 0.0, 0.1), gravity).turning(Turn {
        orientation: DQuat::from_rotation_x(0.3),
        spin,
        own: 0.0,
    });
    let landing = (2.0_f64 * 0.9 / 9.81).sqrt();
    let bounce = Piece::ballistic(landing, drop.position(landing), DVec3::new(0.3, 2.7, 0.0), gravity).turning(Turn {
        orientation: drop.orientation(landing),
        spin: -0.5 * spin,
        own: 0.0,
    });
    let upright = DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    let top = Turn { orientation: upright * DQuat::from_rotation_y(0.4), spin: DVec3::new(1.0, 9.0, 0.0), own: 14.0 };
    let pin = Piece::ballistic(0.0, DVec3::new(0.5, 0.2, 0.0), DVec3::new(0.1, 2.0, 0.0), gravity).turning(top);
    let roll = Turn { orientation: DQuat::IDENTITY, spin: DVec3::new(0.0, 0.0, -160.0), own: 0.0 };
    let roll = Piece::ballistic(0.0, DVec3::new(-1.0, 0.05, 0.3), DVec3::X, DVec3::X * -0.2).turning(roll);
    let profile = vec![[0.03, -0.15], [0.06, -0.05], [0.025, 0.1], [0.03, 0.18], [0.0, 0.23]];
    let stripe = Stripe { from: 0.06, to: 0.09, look: Look::new([190, 30, 40], Material::Glossy) };
    let tracks = vec![
        Track::new("die_0", Shape::die(0.2), Look::IVORY, vec![drop, bounce]),
        Track::new("pin_0", Shape::Revolution { profile, stripes: vec![stripe] }, Look::IVORY, vec![pin]),
        Track::new("ball_0", Shape::Sphere { radius: 0.05, holes: true }, Look::nth(1), vec![roll]),
    ];
    let point = drop.position(landing) - DVec3::Y * 0.1;
    let hit = Impact::new(landing, "die_0", "table", point, DVec3::Y).with_strength(4.2, 0.3);
    let table = Prop::block("table", Look::WOOD, DVec3::new(0.0, -0.05, 0.0), DVec3::new(2.0, 0.05, 1.0));
    Animation::new(1.5, tracks, vec![hit]).with_scenery(vec![table])
}

/// A GLB file as another crate reads it.
pub struct Glb {
    document: gltf::Document,
    bytes: Vec<u8>,
}

/// The keys of one body.
pub struct Body {
    times: Vec<f32>,
    /// Values; for splines also the tangents before and after each value.
    values: Vec<Vec3>,
    cubic: bool,
    turn_times: Vec<f32>,
    turns: Vec<Quat>,
    /// Times and sizes, of a body that appears.
    pub scales: Vec<(f32, Vec3)>,
    /// The node's own orientation, for a body that does not turn.
    still: Quat,
}

impl Glb {
    pub fn read(bytes: &[u8]) -> Self {
        let gltf = gltf::Gltf::from_slice(bytes).unwrap();
        Self { document: gltf.document, bytes: gltf.blob.unwrap_or_default() }
    }

    pub fn names(&self) -> Vec<&str> {
        self.document.nodes().map(|node| node.name().unwrap()).collect()
    }

    pub fn extras(&self) -> String {
        self.document.animations().next().unwrap().extras().as_ref().unwrap().get().to_owned()
    }

    pub fn body(&self, name: &str) -> Body {
        let node = self.document.nodes().find(|node| node.name() == Some(name)).unwrap();
        let still = Quat::from_array(node.transform().decomposed().1);
        let mut body = Body {
            times: vec![],
            values: vec![],
            cubic: false,
            turn_times: vec![],
            turns: vec![],
            scales: vec![],
            still,
        };
        for channel in self.document.animations().flat_map(|animation| animation.channels()) {
            if channel.target().node().name() != Some(name) {
                continue;
            }
            let reader = channel.reader(|_| Some(&self.bytes));
            let times: Vec<f32> = reader.read_inputs().unwrap().collect();
            assert!(times.is_sorted_by(|a, b| a < b), "times strictly increase");
            match (channel.target().property(), reader.read_outputs().unwrap()) {
                (Property::Translation, ReadOutputs::Translations(values)) => {
                    body.values = values.map(Vec3::from).collect();
                    body.cubic = channel.sampler().interpolation() == Interpolation::CubicSpline;
                    body.times = times;
                }
                (Property::Rotation, ReadOutputs::Rotations(values)) => {
                    body.turns = values.into_f32().map(Quat::from_array).collect();
                    body.turn_times = times;
                }
                (Property::Scale, ReadOutputs::Scales(values)) => {
                    assert_eq!(channel.sampler().interpolation(), Interpolation::Step);
                    body.scales = times.into_iter().zip(values.map(Vec3::from)).collect();
                }
                (other, _) => panic!("{other:?}"),
            }
        }
        body
    }
}

/// The key at or before a time, and the share of the way to the next.
fn place(times: &[f32], time: f64) -> (usize, f64, f64) {
    let at = times.partition_point(|&key| f64::from(key) <= time).saturating_sub(1).min(times.len().saturating_sub(2));
    let length = f64::from(times[at + 1]) - f64::from(times[at]);
    (at, ((time - f64::from(times[at])) / length).clamp(0.0, 1.0), length)
}

impl Body {
    pub fn key_at(&self, time: f64) -> Option<Vec3> {
        let index = self.times.iter().position(|&key| key == time as f32)?;
        Some(if self.cubic { self.values[3 * index + 1] } else { self.values[index] })
    }

    pub fn keys(&self) -> usize {
        self.times.len()
    }

    /// glTF 2.0, appendix C.4 and C.5: linear and cubic spline interpolation.
    pub fn position(&self, time: f64) -> DVec3 {
        if self.times.len() == 1 {
            return self.values[self.values.len() / 2].as_dvec3();
        }
        let (k, t, length) = place(&self.times, time);
        if !self.cubic {
            return self.values[k].as_dvec3().lerp(self.values[k + 1].as_dvec3(), t);
        }
        let [value, leaving] = [1, 2].map(|part| self.values[3 * k + part].as_dvec3());
        let [arriving, next] = [0, 1].map(|part| self.values[3 * k + 3 + part].as_dvec3());
        let (t2, t3) = (t * t, t * t * t);
        (2.0 * t3 - 3.0 * t2 + 1.0) * value
            + length * (t3 - 2.0 * t2 + t) * leaving
            + (3.0 * t2 - 2.0 * t3) * next
            + length * (t3 - t2) * arriving
    }

    pub fn orientation(&self, time: f64) -> DQuat {
        if self.turns.is_empty() {
            return self.still.as_dquat();
        }
        if self.turns.len() == 1 {
            return self.turns[0].as_dquat();
        }
        let (k, t, _) = place(&self.turn_times, time);
        self.turns[k].as_dquat().slerp(self.turns[k + 1].as_dquat(), t)
    }
}
