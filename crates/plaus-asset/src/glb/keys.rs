//! Keyframes of nodes.
//!
//! A node's pose is that of its own channels within those of the nodes above it. What is told is keys of that pose, in
//! one of three ways to go between them. Where the file goes another way (tangents, a chain of turning nodes), more
//! keys are put between its own, until no point of the node is off by more than [`OFF`].

use super::{Glb, matrix, pose};
use glam::{DMat4, DQuat, DVec3, DVec4};
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
    /// On cubics of its place and of its quaternion's components, which is then normalised. At a key their slopes are
    /// the mean rates from the key before to the one after, at the ends 0.
    Cubic,
}

/// How far in m a point of a node may be from where the file has it between keys. Default 0.05 mm.
pub(crate) const OFF: f64 = 5e-5;

/// Parts at most into which the time between two keys is cut, for cubics.
const MOST_PARTS: u32 = 32;

/// Halvings at most of the time between two keys, where it is straight between them.
const HALVINGS: u32 = 9;

/// Most keys of one node.
const MOST_KEYS: usize = 5000;

/// Values of one property at times.
struct Track {
    times: Vec<f64>,
    /// Tangent before, value, and tangent after, each as four numbers. Without tangents they are 0.
    values: Vec<[DVec4; 3]>,
    interpolation: Interpolation,
}

impl Track {
    /// The value at a time; `None` if there are no values.
    fn at(&self, time: f64, is_turn: bool) -> Option<DVec4> {
        let after = self.times.partition_point(|&known| known <= time);
        let [_, before, out] = *self.values.get(after.saturating_sub(1))?;
        let (Some(&[into, next, _]), Some(&start)) = (self.values.get(after), self.times.get(after.wrapping_sub(1)))
        else {
            return Some(before);
        };
        let h = self.times[after] - start;
        let s = (time - start) / h;
        Some(match self.interpolation {
            Interpolation::Step => before,
            Interpolation::Linear if is_turn => {
                DVec4::from(DQuat::from_vec4(before).normalize().slerp(DQuat::from_vec4(next).normalize(), s))
            }
            Interpolation::Linear => before.lerp(next, s),
            Interpolation::CubicSpline => hermite([before, out * h, next, into * h], s),
        })
    }

    /// Whether it never changes.
    fn is_constant(&self) -> bool {
        self.values.iter().all(|v| v[0] == DVec4::ZERO && v[2] == DVec4::ZERO && v[1] == self.values[0][1])
    }
}

/// The cubic from a value with a slope to another with its slope.
fn hermite([p, m, q, n]: [DVec4; 4], s: f64) -> DVec4 {
    let rise = q - p;
    p + (m + (rise * 3.0 - m * 2.0 - n + (m + n - rise * 2.0) * s) * s) * s
}

/// The motion of one node of a chain relative to the one above it.
struct Link {
    fixed: DMat4,
    translation: DVec3,
    turn: DQuat,
    scale: DVec3,
    places: Option<Track>,
    turns: Option<Track>,
}

impl Link {
    fn tracks(&self) -> impl Iterator<Item = &Track> {
        self.places.iter().chain(&self.turns)
    }

    fn at(&self, time: f64) -> DMat4 {
        if self.places.is_none() && self.turns.is_none() {
            return self.fixed;
        }
        let at = self.places.as_ref().and_then(|track| track.at(time, false));
        let turn = self.turns.as_ref().and_then(|track| track.at(time, true));
        let at = at.map_or(self.translation, DVec4::truncate);
        let turn = turn.map_or(self.turn, DQuat::from_vec4);
        DMat4::from_scale_rotation_translation(self.scale, turn.normalize(), at)
    }
}

/// A node with all those above it, from the top down.
struct Chain(Vec<Link>);

impl Chain {
    fn at(&self, time: f64) -> Key {
        let world = self.0.iter().fold(DMat4::IDENTITY, |world, link| world * link.at(time));
        let (at, turn) = pose(&world);
        Key { time, at, turn }
    }

    /// The keys that follow it, and how far they are off where they cannot.
    fn keys(&self, reach: f64) -> (Vec<Key>, Between, f64) {
        let tracks = || self.0.iter().flat_map(Link::tracks);
        let mut times: Vec<f64> = tracks().flat_map(|track| track.times.iter().copied()).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let keys: Vec<Key> = times.iter().map(|&time| self.at(time)).collect();
        let has = |way: Interpolation| tracks().any(|track| track.interpolation == way && !track.is_constant());
        if has(Interpolation::Step) && !has(Interpolation::Linear) && !has(Interpolation::CubicSpline) {
            return (keys, Between::Step, 0.0);
        }
        if !keys.iter().all(|key| key.time.is_finite() && key.at.is_finite() && key.turn.is_finite()) {
            return (keys, Between::Linear, 0.0);
        }
        if has(Interpolation::CubicSpline) {
            let mut parts = 1;
            while parts <= MOST_PARTS && keys.len() * (parts as usize) < MOST_KEYS {
                let fine = self.cut(&keys, parts);
                if self.off_cubics(&fine, reach) <= OFF {
                    return (fine, Between::Cubic, 0.0);
                }
                parts *= 2;
            }
        }
        let (fine, worst) = straight(&|time| self.at(time), &keys, reach);
        (fine, Between::Linear, worst)
    }

    /// Its keys with as many parts of equal length between each two.
    fn cut(&self, keys: &[Key], parts: u32) -> Vec<Key> {
        let mut fine = Vec::with_capacity(keys.len() * parts as usize);
        for pair in keys.windows(2) {
            let span = pair[1].time - pair[0].time;
            fine.extend((0..parts).map(|k| self.at(pair[0].time + span * (f64::from(k) / f64::from(parts)))));
        }
        fine.extend(keys.last());
        fine
    }

    /// How far cubics through keys are off.
    fn off_cubics(&self, keys: &[Key], reach: f64) -> f64 {
        let mut turns: Vec<DVec4> = keys.iter().map(|key| DVec4::from(key.turn)).collect();
        for k in 1..turns.len() {
            if turns[k].dot(turns[k - 1]) < 0.0 {
                turns[k] = -turns[k];
            }
        }
        let places: Vec<DVec4> = keys.iter().map(|key| key.at.extend(0.0)).collect();
        let slope = |values: &[DVec4], k: usize| match (k.checked_sub(1), keys.get(k + 1)) {
            (Some(before), Some(after)) => (values[k + 1] - values[before]) / (after.time - keys[before].time),
            _ => DVec4::ZERO,
        };
        let mut worst = 0.0_f64;
        for k in 1..keys.len() {
            let h = keys[k].time - keys[k - 1].time;
            for eighth in 1..8 {
                let s = f64::from(eighth) / 8.0;
                let [at, turn] = [&places, &turns].map(|values| {
                    hermite([values[k - 1], slope(values, k - 1) * h, values[k], slope(values, k) * h], s)
                });
                let time = keys[k - 1].time + s * h;
                let key = Key { time, at: at.truncate(), turn: DQuat::from_vec4(turn).normalize() };
                worst = worst.max(off(&key, &self.at(time), reach));
            }
        }
        worst
    }
}

/// Keys with others between them, so that what goes straight from one to the next follows `at`, and how far in m the
/// farthest point of something that reaches so far is off.
pub(crate) fn straight(at: &dyn Fn(f64) -> Key, keys: &[Key], reach: f64) -> (Vec<Key>, f64) {
    let mut fine = Vec::with_capacity(keys.len());
    let mut worst = 0.0_f64;
    for pair in keys.windows(2) {
        fine.push(pair[0]);
        worst = worst.max(refine(at, [pair[0], pair[1]], reach, HALVINGS, &mut fine));
    }
    fine.extend(keys.last());
    (fine, worst)
}

/// Adds keys between two, where it is straight between them, and tells how far off what is left is.
fn refine(at: &dyn Fn(f64) -> Key, [from, to]: [Key; 2], reach: f64, halvings: u32, keys: &mut Vec<Key>) -> f64 {
    let straight = |s: f64| {
        let (place, turn) = (from.at.lerp(to.at, s), from.turn.slerp(to.turn, s));
        off(&Key { time: 0.0, at: place, turn }, &at(from.time + (to.time - from.time) * s), reach)
    };
    let worst = [0.125, 0.25, 0.5, 0.75, 0.875].map(straight).into_iter().fold(0.0, f64::max);
    if worst <= OFF || halvings == 0 || keys.len() >= MOST_KEYS {
        return worst;
    }
    let middle = at(0.5 * (from.time + to.time));
    let before = refine(at, [from, middle], reach, halvings - 1, keys);
    keys.push(middle);
    before.max(refine(at, [middle, to], reach, halvings - 1, keys))
}

/// How far the farthest point of a node is off, in m.
fn off(key: &Key, truth: &Key, reach: f64) -> f64 {
    // Twice the sine of half the angle: what a point at a distance of 1 moves by.
    let turned = (key.turn * truth.turn.conjugate()).xyz().length() * 2.0;
    (key.at - truth.at).length() + turned * reach
}

impl Glb {
    /// The keys of a node, how it moves between them, and what is left out.
    pub(super) fn keys(&self, node: &gltf::Node<'_>) -> (Vec<Key>, Between, Vec<String>) {
        let mut left_out = Vec::new();
        let mut chain = vec![self.link(node, &mut left_out)];
        if chain[0].tracks().next().is_none() {
            return (Vec::new(), Between::Linear, left_out);
        }
        let above = |index: usize| self.nodes.iter().find(|placed| placed.index == index)?.parent;
        let mut next = above(node.index());
        while let Some(parent) = next.and_then(|index| self.document.nodes().nth(index)) {
            // What is left out of its motion is told of itself.
            chain.push(self.link(&parent, &mut Vec::new()));
            next = above(parent.index());
        }
        chain.reverse();
        let (keys, between, off) = Chain(chain).keys(self.reach(node.index()));
        if keys.iter().any(|key| !key.time.is_finite() || !key.at.is_finite() || !key.turn.is_finite()) {
            left_out.push("its keys: not all are finite".into());
            return (Vec::new(), between, left_out);
        }
        if off > OFF {
            left_out.push(format!("its motion between keys, by up to {:.2} mm: it is too fast, or jumps", off * 1e3));
        }
        (keys, between, left_out)
    }

    /// Largest distance from a node's origin of what it and the nodes below it show, without animation.
    fn reach(&self, index: usize) -> f64 {
        let Some(origin) = self.nodes.iter().find(|placed| placed.index == index) else { return 0.0 };
        let (origin, mut within, mut reach) = (origin.world.w_axis.truncate(), vec![index], 0.0_f64);
        for placed in &self.nodes {
            // The nodes are in the order of the tree.
            if placed.index != index && !placed.parent.is_some_and(|parent| within.contains(&parent)) {
                continue;
            }
            within.push(placed.index);
            let mesh = self.document.nodes().nth(placed.index).and_then(|node| node.mesh());
            for primitive in mesh.iter().flat_map(gltf::Mesh::primitives) {
                let bounds = primitive.bounding_box();
                let [low, high] = [bounds.min, bounds.max].map(|corner| DVec3::from_array(corner.map(f64::from)));
                for corner in 0..8 {
                    let pick = |axis: usize| if corner >> axis & 1 == 1 { high[axis] } else { low[axis] };
                    let corner = placed.world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
                    reach = reach.max((corner - origin).length());
                }
            }
        }
        reach
    }

    /// How a node moves relative to the one above it.
    fn link(&self, node: &gltf::Node<'_>, left_out: &mut Vec<String>) -> Link {
        let (translation, rotation, scale) = node.transform().decomposed();
        let mut link = Link {
            fixed: matrix(node),
            translation: DVec3::from_array(translation.map(f64::from)),
            turn: DQuat::from_array(rotation.map(f64::from)),
            scale: DVec3::from_array(scale.map(f64::from)),
            places: None,
            turns: None,
        };
        let ours = |channel: &Channel<'_>| channel.target().node().index() == node.index();
        let channels = self.document.animations().flat_map(|animation| animation.channels().collect::<Vec<_>>());
        for channel in channels.filter(ours) {
            let property = channel.target().property();
            let track = match property {
                Property::Translation => &mut link.places,
                Property::Rotation => &mut link.turns,
                Property::Scale | Property::MorphTargetWeights => {
                    left_out.push(format!("its animated {property:?}: shapes do not change"));
                    continue;
                }
            };
            if track.is_some() {
                let what = format!("its {property:?} in another animation: the first one is used");
                if !left_out.contains(&what) {
                    left_out.push(what);
                }
                continue;
            }
            *track = self.samples(&channel);
            if track.is_none() {
                left_out.push(format!("its animated {property:?}: its keys cannot be read"));
            }
        }
        link
    }

    /// Times and values of a channel; `None` if they do not belong together.
    fn samples(&self, channel: &Channel<'_>) -> Option<Track> {
        let reader = channel.reader(|_| Some(&self.blob[..]));
        let times: Vec<f64> = reader.read_inputs().into_iter().flatten().map(f64::from).collect();
        let interpolation = channel.sampler().interpolation();
        let numbers: Vec<DVec4> = match reader.read_outputs()? {
            ReadOutputs::Translations(values) => {
                values.map(|v| DVec3::from_array(v.map(f64::from)).extend(0.0)).collect()
            }
            ReadOutputs::Rotations(values) => values.into_f32().map(|v| DVec4::from_array(v.map(f64::from))).collect(),
            _ => return None,
        };
        let values: Vec<[DVec4; 3]> = if interpolation == Interpolation::CubicSpline {
            numbers.chunks_exact(3).map(|three| [three[0], three[1], three[2]]).collect()
        } else {
            numbers.into_iter().map(|value| [DVec4::ZERO, value, DVec4::ZERO]).collect()
        };
        (values.len() == times.len()).then_some(Track { times, values, interpolation })
    }
}
