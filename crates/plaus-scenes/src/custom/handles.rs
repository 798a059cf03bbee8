//! Numbers of a draw by which a body's release can be shifted and turned.

use super::moving::{Moving, Release, Turned};
use super::plan::Plan;
use super::values::{Collector, Drawn, Numbers, Value};
use plaus_mcmc::Law;
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
    /// Turns the vector about the vertical, given the numbers of the draw.
    pub(super) fn turn(&self, draw: &mut Drawn, numbers: &Numbers<'_>, [sin, cos]: [f64; 2], about: [f64; 2]) {
        let Some(handles) = self.handles else { return };
        let old = self.values.map(|value| value.of(numbers));
        let [x, y] = [0, 1].map(|axis| old[axis] - about[axis]);
        let new = [about[0] + cos * x - sin * y, about[1] + sin * x + cos * y];
        for axis in 0..2 {
            handles[axis].add(draw, new[axis] - old[axis]);
        }
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

/// By which numbers a body's release can be changed.
#[derive(Debug, Clone)]
pub(super) struct Handles {
    /// The variables that belong to this body alone.
    pub(super) own: Vec<usize>,
    /// Where it starts along x and along y.
    pub(super) place: [Option<Handle>; 2],
    /// Its place, velocity and spin, and its orientation, if all of them can be turned about the vertical.
    pub(super) level: Option<([Level; 3], Upright)>,
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
                let fits = own.contains(&var) && uses(var) == 1 && collector.vars[var].law.is_density();
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
            Turned::Angles(_) if is_ball => Some(Upright::Round),
            Turned::Angles(angles) => handle(angles[2]).map(Upright::Angle),
        };
        let levels = || Some([level(at, false)?, level(velocity, true)?, level(spin, true)?]);
        let turn = if let Turned::Any(index) = turn { Some(index) } else { None };
        Self { place: [handle(at[0]), handle(at[1])], level: levels().zip(upright), turn, own: own.clone() }
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
            Handles { level: handles.level.filter(|_| body.acting.is_upright()), ..handles }
        };
        self.free().iter().zip(&self.bearing.of).map(handles).collect()
    }
}

/// Changes an angle in degrees; where ends of its law are joined, it goes around.
pub(super) fn turn_by(law: &Law, draw: &mut Drawn, handle: Handle, degrees: f64) {
    law.add(&[degrees / handle.factor], std::slice::from_mut(&mut draw.numbers[handle.number]));
}
