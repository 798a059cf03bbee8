//! Heights of the table where a die touches it: in solutions, and in solutions with one throw, compared with the prior.

use super::Thrown;
use super::sensitivity::mean;
use super::steering::{KINDS, Row, basis, contact, lift};
use crate::{Result, Work};
use plaus_dist::{Purpose, Seed, Stream, math, open_unit, standard_normal};
use plaus_mcmc::diagnose::{mcse_mean, mcse_sd};
use plaus_mcmc::{Chain, Goal, State, StateOf, StateRefOf, Target};
use plaus_scenes::dice::{Dice, Field, LARGEST_SCORE, Site, Work as Memory};
use rayon::prelude::*;

/// The posterior of the height at a place that a solution touches, given the throw and the rest of the table. Over
/// throws, the root mean square of the mean, and the mean of the standard deviation.
pub(super) struct Fixed {
    pub(super) shift: Row,
    pub(super) spread: Row,
}

/// Heights at the contacts of the animation itself.
pub(super) struct Free {
    /// Their mean over solutions, and over throws of the prior that come to rest.
    pub(super) solutions: Row,
    pub(super) prior: Row,
    /// Their standard deviation over solutions, relative to that of the prior.
    pub(super) spread: Row,
}

/// The heights at the contacts of every kind of one animation.
fn lifts(scene: &Dice, state: StateRefOf<'_, Dice>) -> [Option<f64>; KINDS] {
    let (trip, cell) = (&state.outcome.trips[0], scene.config().table.grid_mm * 1e-3);
    std::array::from_fn(|kind| {
        let [_, x, y] = trip.impacts[contact(kind, trip.impacts.len(), 0.5)?];
        Some(lift(&state.draw.tables[0], &basis(x, y, cell).collect::<Vec<_>>()))
    })
}

/// Chains that keep everything of a solution except the sixteen control points under one of its contacts. The solution
/// that they start from determines that place.
pub(super) fn given_the_throw(work: &Work, thrown: &Thrown) -> Result<Fixed> {
    let scene = &thrown.scene;
    let (throws, iterations): (u64, u64) = work.size((24, 300), (1, 3));
    // For each kind of contact: mean and standard deviation of the chain, each with its error.
    let of_throw = |seed: u64| -> Result<Vec<Option<[f64; 4]>>> {
        let (_, state) = thrown.solution(100 + seed, work.size(100_000, 2))?;
        let cell = scene.config().table.grid_mm * 1e-3;
        let impacts = &state.outcome.trips[0].impacts;
        let of_kind = |kind: usize| -> Result<Option<[f64; 4]>> {
            let Some(contact) = contact(kind, impacts.len(), 0.5) else { return Ok(None) };
            let sites: Vec<([i32; 2], f64)> = basis(impacts[contact][1], impacts[contact][2], cell).collect();
            let mut stream = Seed(10).chain(seed).at(kind as u64, Purpose::START);
            Ok(summary(&heights(scene, state.clone(), &sites, iterations, &mut stream)?))
        };
        (0..KINDS).map(of_kind).collect()
    };
    let all = (0..throws).into_par_iter().map(of_throw).collect::<Result<Vec<_>>>()?;
    let of = |kind: usize| all.iter().filter_map(move |row| row[kind]);
    // Subtracts what the chains' own errors add to the square of a mean.
    let shift = |kind: usize| {
        let squares: Vec<f64> = of(kind).map(|[mean, error, ..]| math::square(mean) - math::square(error)).collect();
        let (square, error) = mean(&squares);
        let root = square.max(0.0).sqrt();
        (root, error / (2.0 * root.max(error.sqrt())))
    };
    let spread = |kind: usize| mean(&of(kind).map(|[_, _, sd, _]| sd).collect::<Vec<_>>());
    Ok(Fixed { shift: std::array::from_fn(shift), spread: std::array::from_fn(spread) })
}

/// The height at a place along a chain that changes only the control points under it: autoregressive steps of all
/// sizes, which leave the points' law invariant, accepted with the ratio of the constraints.
fn heights(
    scene: &Dice,
    mut state: StateOf<Dice>,
    sites: &[([i32; 2], f64)],
    iterations: u64,
    stream: &mut Stream,
) -> Result<Vec<f64>> {
    let (mut memory, mut trace) = (Memory::default(), Vec::new());
    for iteration in 0..iterations {
        let step = math::exp(math::ln(0.03) * open_unit(stream));
        let mut draw = state.draw.clone();
        for &([i, j], _) in sites {
            let site = Site { field: Field::Height, i, j };
            let score = (1.0 - step * step).sqrt() * draw.tables[0].score(site) + step * standard_normal(stream);
            draw.tables[0].set(site, score);
        }
        let possible = draw.tables[0].changed_points().iter().all(|(_, score)| score.abs() <= LARGEST_SCORE);
        if possible {
            let new = State::evaluate(scene, draw, &mut memory)?;
            if math::ln(open_unit(stream)) < new.log_constraint.value() - state.log_constraint.value() {
                state = new;
            }
        }
        if 10 * iteration >= iterations {
            trace.push(lift(&state.draw.tables[0], sites));
        }
    }
    Ok(trace)
}

/// Mean and standard deviation of a chain with their errors; `None` if it is too short for them.
fn summary(trace: &[f64]) -> Option<[f64; 4]> {
    let n = trace.len() as f64;
    let mean = trace.iter().sum::<f64>() / n;
    let sd = (trace.iter().map(|x| math::square(x - mean)).sum::<f64>() / (n - 1.0)).sqrt();
    let chain = [trace];
    // A chain that never moved has no error; only its place is known.
    let (error, error_of_sd) = (mcse_mean(&chain).ok()?, mcse_sd(&chain).ok()?);
    [mean, error, sd, error_of_sd].iter().all(|x| x.is_finite()).then_some([mean, error, sd, error_of_sd])
}

/// Heights at the contacts of solutions, from chains with all moves, and of throws of the prior.
pub(super) fn of_solutions(work: &Work, thrown: &Thrown) -> Result<Free> {
    let scene = &thrown.scene;
    let (chains, iterations, apart): (u64, u64, u64) = work.size((16, 2400, 10), (2, 6, 1));
    type Lifts = Vec<[Option<f64>; KINDS]>;
    let of_chain = |k: u64| -> Result<Lifts> {
        let mut chain = Chain::start(scene, &thrown.moves, Seed(11).chain(k))?;
        let mut found = Vec::new();
        for iteration in 0..iterations {
            chain.step()?;
            let due = iteration >= iterations / 8 && iteration.is_multiple_of(apart);
            if due && (work.quick || scene.class(chain.state().by_ref()).is_some()) {
                found.push(lifts(scene, chain.state().by_ref()));
            }
        }
        Ok(found)
    };
    let of_prior = |k: u64| -> Result<Lifts> {
        let (mut stream, mut memory) = (Seed(12).chain(k).at(0, Purpose::START), Memory::default());
        let mut found = Vec::new();
        for _ in 0..work.size(100, 2) {
            let state = State::evaluate(scene, scene.start(&mut stream), &mut memory)?;
            if state.outcome.complete() {
                found.push(lifts(scene, state.by_ref()));
            }
        }
        Ok(found)
    };
    let solutions = (0..chains).into_par_iter().map(of_chain).collect::<Result<Vec<_>>>()?;
    let prior = (0..chains).into_par_iter().map(of_prior).collect::<Result<Vec<_>>>()?;
    // Chains are independent of each other, so errors follow from the spread of their means and standard deviations.
    let each = |all: &[Lifts], kind: usize| -> Vec<(f64, f64)> {
        let of = |chain: &Lifts| {
            let values: Vec<f64> = chain.iter().filter_map(|row| row[kind]).collect();
            let (mean, error) = mean(&values);
            (mean, error * (values.len() as f64).sqrt())
        };
        all.iter().map(of).filter(|(mean, sd)| mean.is_finite() && sd.is_finite()).collect()
    };
    let average = |all: &[Lifts], kind: usize| mean(&each(all, kind).iter().map(|(mean, _)| *mean).collect::<Vec<_>>());
    let spread = |kind: usize| {
        let of = |all: &[Lifts]| mean(&each(all, kind).iter().map(|(_, sd)| *sd).collect::<Vec<_>>());
        let ((a, da), (b, db)) = (of(&solutions), of(&prior));
        (a / b, a / b * (math::square(da / a) + math::square(db / b)).sqrt())
    };
    Ok(Free {
        solutions: std::array::from_fn(|kind| average(&solutions, kind)),
        prior: std::array::from_fn(|kind| average(&prior, kind)),
        spread: std::array::from_fn(spread),
    })
}
