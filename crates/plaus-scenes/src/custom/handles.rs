//! Numbers of a draw by which a body's release can be shifted and turned.

use super::Custom;
use super::angles::Turn;
use super::moving::{Moving, Release, Turned};
use super::plan::Plan;
use super::values::{Collector, Drawn, Numbers, Value};
use crate::turns::turned;
use glam::{DQuat, DVec2, DVec3};
use std::collections::BTreeSet;

/// A number of a draw that changes one value and no other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Handle {
    /// Its variable, and its place among the numbers of a draw.
    pub(super) var: usize,
    pub(super) number: usize,
    /// By how much the value grows for each unit of the number.
    pub(super) factor: f64,
}

impl Handle {
    /// Changes the value by this much.
    pub(super) fn add(self, draw: &mut Drawn, by: f64) {
        draw.numbers[self.number] += by / self.factor;
    }
}

/// Two values along x and y.
#[derive(Debug, Clone, Copy)]
pub(super) struct Level {
    values: [Value; 2],
    /// `None`: both are 0 in every draw.
    handles: Option<[Handle; 2]>,
}

impl Level {
    /// The numbers that turn the vector about a vertical line, each with its handle; `numbers` are those of `draw`.
    fn turned(
        &self,
        draw: &Drawn,
        numbers: &Numbers<'_>,
        (turn, about): (Turn, [f64; 2]),
    ) -> Option<[(Handle, f64); 2]> {
        let handles = self.handles?;
        let old = self.values.map(|value| value.of(numbers));
        let about = DVec2::from_array(about);
        let new = about + turn.of(DVec2::from_array(old) - about);
        let number = |axis: usize| draw.numbers[handles[axis].number] + (new[axis] - old[axis]) / handles[axis].factor;
        Some([0, 1].map(|axis| (handles[axis], number(axis))))
    }
}

/// How a body's orientation can be turned about the vertical.
#[derive(Debug, Clone, Copy)]
pub(super) enum Upright {
    /// It does not matter.
    Round,
    /// The orientation of this place in a draw.
    Any(usize),
    /// By an angle in degrees.
    Angle(Handle),
}

/// Which way a body goes, and how it can be turned.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    velocity: Level,
    spin: Level,
    pub(super) upright: Upright,
}

impl Course {
    /// Whether anything of it changes if it is turned.
    pub(super) fn is_any(&self) -> bool {
        let is_round = matches!(self.upright, Upright::Round);
        self.velocity.handles.is_some() || self.spin.handles.is_some() || !is_round
    }

    /// The numbers that turn it about the vertical by an angle, each with its handle; `numbers` are those of `draw`.
    /// An orientation that is random as a whole is turned too, but is no number.
    pub(super) fn turned<'a>(
        &'a self,
        (world, draw): (&'a Custom, &'a Drawn),
        numbers: &Numbers<'_>,
        turn: Turn,
    ) -> impl Iterator<Item = (Handle, f64)> + 'a {
        let vectors = [self.velocity, self.spin].map(|level| level.turned(draw, numbers, (turn, [0.0; 2])));
        let handle = if let Upright::Angle(handle) = self.upright { Some(handle) } else { None };
        let by_angle = handle.map(|handle| {
            let mut number = [draw.numbers[handle.number]];
            world.vars.get(handle.var).law.add(&[turn.angle.to_degrees() / handle.factor], &mut number);
            (handle, number[0])
        });
        vectors.into_iter().flatten().flatten().chain(by_angle)
    }

    /// Turns it in a draw.
    pub(super) fn turn(&self, world: &Custom, draw: &mut Drawn, angle: f64) {
        let numbers = world.plan.works.numbers(Some(draw));
        let turned: Vec<(Handle, f64)> = self.turned((world, draw), &numbers, Turn::by(angle)).collect();
        turned.into_iter().for_each(|(handle, number)| draw.numbers[handle.number] = number);
        if let Upright::Any(index) = self.upright {
            draw.turns[index] = (turned_by(angle) * draw.turns[index]).normalize();
        }
    }

    /// Rounds what is turned, so that it is the same after a turn and its opposite.
    pub(super) fn round(&self, world: &Custom, draw: &mut Drawn) {
        let angle = if let Upright::Angle(handle) = self.upright { Some(handle) } else { None };
        let vectors = [self.velocity, self.spin].into_iter().filter_map(|level| level.handles).flatten();
        for handle in vectors.chain(angle) {
            let unit = FINEST * world.vars.get(handle.var).law.width();
            let number = &mut draw.numbers[handle.number];
            *number = (*number / unit).round() * unit;
        }
    }
}

/// Finest part of what a trial begins with: it is a multiple of this, relative to its spread. The same throw turned and
/// relabelled differs by rounding, but not in these multiples, so it has the same trial.
pub(super) const FINEST: f64 = 1.0 / (1_u64 << 40) as f64;

/// A turn about the vertical.
pub(super) fn turned_by(angle: f64) -> DQuat {
    turned(DVec3::Z * angle)
}

/// By which numbers a body's release can be changed.
#[derive(Debug, Clone)]
pub(super) struct Handles {
    /// The variables that belong to this body alone.
    pub(super) own: Vec<usize>,
    /// Where it starts along x and along y.
    pub(super) place: [Option<Handle>; 2],
    /// Its velocity, spin and orientation, if all of them can be turned about the vertical.
    pub(super) course: Option<Course>,
    /// Where it starts, if both coordinates can be changed.
    pub(super) start: Option<Level>,
    /// Its place along x and y.
    pub(super) at: [Value; 2],
    /// Its orientation, if that is random as a whole: its place in a draw.
    pub(super) turn: Option<usize>,
}

impl Handles {
    /// Of a body that is released so. `own` are the variables that nothing else depends on.
    pub(super) fn new(collector: &Collector, own: Vec<usize>, release: &Release, is_ball: bool) -> Self {
        let Release { at, turn, velocity, spin, time } = *release;
        let angles = if let Turned::Angles(angles) = turn { angles } else { [Value::Fixed(0.0); 3] };
        let all: Vec<Value> = [at, velocity, spin, angles].into_iter().flatten().chain([time]).collect();
        let uses = |var: usize| all.iter().filter(|value| collector.follows_from(**value).contains(&var)).count();
        let handle = |value: Value| {
            let sum = collector.linear(value);
            let handles = sum.terms().iter().filter_map(|&(term, factor)| {
                let Value::Drawn(number) = term else { return None };
                let var = collector.var_of[number];
                let law = &collector.vars[var].law;
                let fits = own.contains(&var) && uses(var) == 1 && law.is_density() && law.width() > 0.0;
                fits.then_some(Handle { var, number, factor })
            });
            let width = |handle: &Handle| (collector.vars[handle.var].law.width() * handle.factor).abs();
            handles.max_by(|a, b| width(a).total_cmp(&width(b)))
        };
        let level = |[x, y, _]: [Value; 3], is_vector: bool| {
            let handles = match [x, y] {
                [Value::Fixed(0.0), Value::Fixed(0.0)] if is_vector => None,
                [x, y] => Some([handle(x)?, handle(y)?]),
            };
            Some(Level { values: [x, y], handles })
        };
        let upright = match turn {
            Turned::Any(index) => Some(Upright::Any(index)),
            Turned::Angles(_) | Turned::Known(_) if is_ball => Some(Upright::Round),
            Turned::Known(_) => None,
            Turned::Angles(angles) => handle(angles[2]).map(Upright::Angle),
        };
        let course = || {
            let (velocity, spin) = (level(velocity, true)?, level(spin, true)?);
            Some(Course { velocity, spin, upright: upright? })
        };
        let turn = if let Turned::Any(index) = turn { Some(index) } else { None };
        let place = [handle(at[0]), handle(at[1])];
        Self { place, course: course(), start: level(at, false), at: [at[0], at[1]], turn, own: own.clone() }
    }

    /// Turns the place where the body starts about a vertical line, in mm.
    pub(super) fn turn_start(&self, world: &Custom, draw: &mut Drawn, angle: f64, about: [f64; 2]) {
        let Some(start) = &self.start else { return };
        let numbers = world.plan.works.numbers(Some(draw));
        let turned = start.turned(draw, &numbers, (Turn::by(angle), about));
        turned.into_iter().flatten().for_each(|(handle, number)| draw.numbers[handle.number] = number);
    }
}

impl Plan {
    /// Of each body, by which numbers its release can be changed.
    pub(super) fn handles(&self, collector: &Collector) -> Vec<Handles> {
        let mut uses = vec![0_u32; collector.vars.len()];
        let of = |thing: &Vec<usize>| thing.iter().copied().collect::<BTreeSet<usize>>();
        self.bearing.of.iter().flat_map(of).for_each(|var| uses[var] += 1);
        let handles = |(body, vars): (&Moving, &Vec<usize>)| {
            let own = of(vars).into_iter().filter(|&var| uses[var] == 1).collect();
            let handles = Handles::new(collector, own, &body.release(), body.is_ball());
            Handles { course: handles.course.filter(|_| body.acting.is_upright()), ..handles }
        };
        self.free().iter().zip(&self.bearing.of).map(handles).collect()
    }
}
