//! The numbers for one world: time, error before chaos, outcomes.

use crate::world::{Outcome, Places, Way, World};
use plaus_figures::Result;
use plaus_figures::clock;

/// How much to simulate.
pub(crate) struct Plan {
    /// Draws per simulator.
    pub(crate) draws: u64,
    /// Seconds of processor time after which a simulator gets no further draws.
    pub(crate) seconds: f64,
    /// All simulators, the reference first.
    pub(crate) ways: Vec<Way>,
}

/// The results of one simulator.
pub(crate) struct Row {
    pub(crate) way: Way,
    /// Computing time of each draw in s, in ascending order.
    pub(crate) seconds: Vec<f64>,
    pub(crate) outcomes: Vec<Outcome>,
    /// Median over draws of the largest error of a body at each of [`times`], in m; empty for the reference.
    pub(crate) errors: Vec<f64>,
    /// Median time of agreement in s.
    pub(crate) agreement: Option<f64>,
    /// Share of draws whose outcome in the first reading differs from the reference's outcome for the same draw.
    pub(crate) differing: Option<f64>,
}

/// Number of draws whose trajectories are compared.
const COMPARED: u64 = 100;
/// Share of a simulator's seconds that comparing trajectories may take.
const SHARE: f64 = 0.25;
/// Rounds in which simulators take turns, so that anything that slows the machine down slows all of them.
const ROUNDS: u64 = 10;
/// Offset between the draws of the reference and of the peer's finest step, so that independent samples are compared.
const APART: u64 = 1 << 32;

/// Times at which places are compared, in s: every twentieth of a second, which is a whole number of steps at 60, 240
/// and 1000 per second.
pub(crate) fn times() -> Vec<f64> {
    (1..=30).map(|k| f64::from(k) / 20.0).collect()
}

impl Plan {
    /// The peer's steps a second.
    pub(crate) fn rates(&self) -> Vec<f64> {
        self.ways.iter().filter_map(|way| if let Way::Peer(rate) = way { Some(*rate) } else { None }).collect()
    }

    /// The peer's finest step, if there is a peer.
    pub(crate) fn finest(&self) -> Option<Way> {
        self.rates().into_iter().reduce(f64::max).map(Way::Peer)
    }

    fn first_draw(&self, way: Way) -> u64 {
        if way == Way::REFERENCE {
            APART
        } else if Some(way) == self.finest() {
            2 * APART
        } else {
            0
        }
    }
}

/// Measures a world.
pub(crate) fn measure(world: &mut dyn World, plan: &Plan) -> Result<Vec<Row>> {
    let empty = |&way: &Way| Row {
        way,
        seconds: Vec::new(),
        outcomes: Vec::new(),
        errors: Vec::new(),
        agreement: None,
        differing: None,
    };
    let mut rows: Vec<Row> = plan.ways.iter().map(empty).collect();
    let mut spent = vec![0.0; rows.len()];
    let enough = plan.seconds * world.patience();
    for round in 1..=ROUNDS {
        for (row, spent) in rows.iter_mut().zip(&mut spent) {
            let first = plan.first_draw(row.way);
            let begin = clock::now();
            let before = *spent;
            while (row.outcomes.len() as u64) < plan.draws * round / ROUNDS && *spent < enough {
                let draw = first + row.outcomes.len() as u64;
                let (outcome, seconds) = world.outcome(row.way, draw)?;
                row.outcomes.push(outcome);
                row.seconds.push(seconds);
                *spent = before + clock::now().saturating_sub(begin).as_secs_f64();
            }
        }
        eprintln!(
            "  {}: {} % of the outcomes, {:.0} s of computing",
            world.name(),
            100 * round / ROUNDS,
            spent.iter().sum::<f64>()
        );
    }
    rows.iter_mut().for_each(|row| row.seconds.sort_by(f64::total_cmp));
    if plan.ways.contains(&Way::REFERENCE) {
        compare(world, plan, &mut rows)?;
    }
    Ok(rows)
}

/// Compares paths and outcomes with the reference's for the same draws.
fn compare(world: &mut dyn World, plan: &Plan, rows: &mut [Row]) -> Result<()> {
    let times = times();
    let mut truth: Vec<(Vec<Places>, Outcome)> = Vec::new();
    for row in rows {
        let (mut errors, mut agreements, mut differing) = (vec![Vec::new(); times.len()], Vec::new(), 0);
        let begin = clock::now();
        let most = if truth.is_empty() { COMPARED.min(plan.draws) } else { truth.len() as u64 };
        for draw in 0..most {
            if draw > 0 && clock::now().saturating_sub(begin).as_secs_f64() > SHARE * plan.seconds * world.patience() {
                break;
            }
            let places = world.places(row.way, draw, &times)?;
            let (outcome, _) = world.outcome(row.way, draw)?;
            if row.way == Way::REFERENCE {
                truth.push((places, outcome));
                continue;
            }
            let (exact, end) = &truth[draw as usize];
            let apart: Vec<f64> = places.iter().zip(exact).map(|(a, b)| farthest(a, b)).collect();
            let agrees = apart.iter().position(|&d| d > world.tolerance());
            agreements.push(agrees.map_or(times[times.len() - 1], |k| times[k]));
            errors.iter_mut().zip(apart).for_each(|(all, error)| all.push(error));
            differing += usize::from(outcome[0] != end[0]);
        }
        if row.way == Way::REFERENCE {
            continue;
        }
        row.differing = Some(differing as f64 / agreements.len().max(1) as f64);
        row.errors = errors.into_iter().filter_map(median).collect();
        row.agreement = median(agreements);
        eprintln!("  {}: ways of {} compared", world.name(), row.way.name());
    }
    Ok(())
}

/// Largest distance of a body from where it should be; bodies that have left either world don't count.
fn farthest(a: &Places, b: &Places) -> f64 {
    a.iter().zip(b).filter_map(|(a, b)| Some((*a.as_ref()? - *b.as_ref()?).length())).fold(0.0, f64::max)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

impl Row {
    /// A quantile of the computing time in s.
    pub(crate) fn time(&self, part: f64) -> f64 {
        let last = self.seconds.len().saturating_sub(1);
        self.seconds.get((last as f64 * part).round() as usize).copied().unwrap_or(f64::NAN)
    }

    /// Mean computing time in s.
    pub(crate) fn mean(&self) -> f64 {
        self.seconds.iter().sum::<f64>() / self.seconds.len().max(1) as f64
    }
}
