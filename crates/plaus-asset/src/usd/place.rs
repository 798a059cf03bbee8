//! Where prims are: their `xformOps`, at any time.

use super::scene::Scene;
use crate::AssetError;
use crate::mjcf::words::about;
use glam::{DMat4, DQuat, DVec3};

/// Most operations of one prim.
const MOST_OPS: usize = 64;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Translate,
    Scale,
    /// About one axis.
    Rotate(usize),
    /// About three axes, the first first.
    Euler([usize; 3]),
    Orient,
    Matrix,
}

impl Kind {
    /// Of a name such as `rotateXYZ`, with how many numbers it has.
    fn of(name: &str) -> Option<(Self, usize)> {
        let axis = |letter: u8| b"XYZ".iter().position(|known| *known == letter);
        Some(match name {
            "translate" => (Self::Translate, 3),
            "scale" => (Self::Scale, 3),
            "orient" => (Self::Orient, 4),
            "transform" => (Self::Matrix, 16),
            name => match name.strip_prefix("rotate")?.as_bytes() {
                [one] => (Self::Rotate(axis(*one)?), 1),
                [a, b, c] => {
                    let axes = [axis(*a)?, axis(*b)?, axis(*c)?];
                    let differ = axes[0] != axes[1] && axes[1] != axes[2] && axes[2] != axes[0];
                    (differ.then_some(Self::Euler(axes))?, 3)
                }
                _ => return None,
            },
        })
    }
}

/// One operation, with its values at times; with one if it does not change.
#[derive(Debug)]
struct Op {
    kind: Kind,
    inverted: bool,
    samples: Vec<(f64, Vec<f64>)>,
}

fn quaternion(wxyz: &[f64]) -> DQuat {
    let turn = DQuat::from_xyzw(wxyz[1], wxyz[2], wxyz[3], wxyz[0]);
    if turn.length() > 1e-12 { turn.normalize() } else { DQuat::IDENTITY }
}

impl Op {
    fn at(&self, time: f64) -> DMat4 {
        let after = self.samples.partition_point(|(known, _)| *known <= time);
        let (before, next) = (after.saturating_sub(1), after.min(self.samples.len() - 1));
        let [(from, a), (to, b)] = [&self.samples[before], &self.samples[next]];
        let share = if to > from { ((time - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        if self.kind == Kind::Orient {
            return DMat4::from_quat(quaternion(a).slerp(quaternion(b), share));
        }
        let now: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect();
        self.kind.matrix(&now)
    }

    fn varies(&self) -> bool {
        self.samples.iter().any(|(_, value)| *value != self.samples[0].1)
    }
}

impl Kind {
    fn matrix(self, n: &[f64]) -> DMat4 {
        let turn = |axis: usize, degrees: f64| DMat4::from_quat(about(DVec3::AXES[axis], degrees.to_radians()));
        match self {
            Self::Translate => DMat4::from_translation(DVec3::from_slice(n)),
            Self::Scale => DMat4::from_scale(DVec3::from_slice(n)),
            Self::Rotate(axis) => turn(axis, n[0]),
            // Its numbers are those of x, y and z, whatever the order.
            Self::Euler([a, b, c]) => turn(c, n[c]) * turn(b, n[b]) * turn(a, n[a]),
            Self::Orient => DMat4::from_quat(quaternion(n)),
            // Its rows are the images of the axes.
            Self::Matrix => <[f64; 16]>::try_from(n).map_or(DMat4::IDENTITY, |all| DMat4::from_cols_array(&all)),
        }
    }
}

/// How a prim is placed in the one above it.
#[derive(Debug, Default)]
struct Local {
    ops: Vec<Op>,
    /// Whether what is above it has no bearing on it.
    resets: bool,
}

/// How all prims are placed.
#[derive(Debug)]
pub(super) struct Places {
    locals: Vec<Local>,
    parents: Vec<Option<usize>>,
    /// The time code of the start.
    pub(super) start: f64,
    /// Whether each, or one above it, moves.
    moving: Vec<bool>,
}

impl Places {
    pub(super) fn read(scene: &Scene) -> Result<Self, AssetError> {
        let locals: Vec<Local> = (0..scene.prims.len()).map(|prim| local(scene, prim)).collect::<Result<_, _>>()?;
        let parents: Vec<Option<usize>> = scene.prims.iter().map(|prim| prim.parent).collect();
        let times = locals.iter().flat_map(|local| &local.ops).filter(|op| op.varies()).map(|op| op.samples[0].0);
        let start = scene.start.or_else(|| times.reduce(f64::min)).unwrap_or(0.0);
        let mut moving = Vec::new();
        for (local, parent) in locals.iter().zip(&parents) {
            let carried = !local.resets && parent.is_some_and(|parent| moving[parent]);
            moving.push(carried || local.ops.iter().any(Op::varies));
        }
        let places = Self { locals, parents, start, moving };
        let odd = (0..scene.prims.len()).find(|&prim| !places.world(prim, start).is_finite());
        match odd {
            Some(prim) => Err(scene.prims[prim].wrong("its xformOps place it nowhere: a number is not finite")),
            None => Ok(places),
        }
    }

    /// Where a prim is at a time code: the matrix from its own axes to those of the stage.
    pub(super) fn world(&self, prim: usize, time: f64) -> DMat4 {
        let mut world = DMat4::IDENTITY;
        let mut next = Some(prim);
        while let Some(prim) = next {
            let local = &self.locals[prim];
            world = local.ops.iter().rev().fold(world, |world, op| {
                let matrix = op.at(time);
                (if op.inverted { matrix.inverse() } else { matrix }) * world
            });
            next = self.parents[prim].filter(|_| !local.resets);
        }
        world
    }

    /// Whether it moves, by itself or with one above it.
    pub(super) fn moves(&self, prim: usize) -> bool {
        self.moving[prim]
    }

    /// Whether it moves by itself.
    pub(super) fn moves_itself(&self, prim: usize) -> bool {
        self.locals[prim].ops.iter().any(Op::varies)
    }

    /// Whether what is above it has no bearing on where it is.
    pub(super) fn resets(&self, prim: usize) -> bool {
        self.locals[prim].resets
    }

    /// The time codes at which something of how it moves is said.
    pub(super) fn times(&self, prim: usize) -> Vec<f64> {
        let mut times = Vec::new();
        let mut next = Some(prim);
        while let Some(prim) = next {
            let ops = self.locals[prim].ops.iter().filter(|op| op.varies());
            times.extend(ops.flat_map(|op| op.samples.iter().map(|(time, _)| *time)));
            next = self.parents[prim].filter(|_| !self.locals[prim].resets);
        }
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }
}

fn local(scene: &Scene, prim: usize) -> Result<Local, AssetError> {
    let mut found = Local::default();
    let own = &scene.prims[prim];
    let order = scene.words(prim, "xformOpOrder")?;
    if order.len() > MOST_OPS {
        return Err(own.wrong(format!("xformOpOrder has {} operations: at most {MOST_OPS} are read", order.len())));
    }
    for name in &order {
        if name == "!resetXformStack!" {
            found = Local { ops: Vec::new(), resets: true };
            continue;
        }
        let (attribute, inverted) = name.strip_prefix("!invert!").map_or((name.as_str(), false), |name| (name, true));
        let kind = attribute.strip_prefix("xformOp:").and_then(|rest| Kind::of(rest.split(':').next()?));
        let Some((kind, count)) = kind else {
            return Err(own.wrong(format!("xformOpOrder has {name}, which is no operation")));
        };
        let mut samples = scene.samples(prim, attribute)?;
        if samples.is_empty() {
            // What has no value does nothing.
            let Some(value) = scene.numbers(prim, attribute)? else { continue };
            samples.push((0.0, value));
        }
        let is_sound = |(time, value): &(f64, Vec<f64>)| {
            value.len() == count && time.is_finite() && value.iter().all(|x| x.is_finite())
        };
        if !samples.iter().all(is_sound) || !samples.is_sorted_by(|a, b| a.0 < b.0) {
            return Err(own.wrong(format!("{attribute}: {count} finite numbers are needed, at times in order")));
        }
        found.ops.push(Op { kind, inverted, samples });
    }
    Ok(found)
}
