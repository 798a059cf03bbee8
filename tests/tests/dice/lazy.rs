//! A table that is made only where a die comes near is the same as a whole one.

use super::plain::scene;
use plaus_dist::{LogDensity, LogPotential, LogRatio, Purpose, Seed, Stream};
use plaus_mcmc::{At, Chain, Mixture, ModelError, Move, Proposal, Simulated, State, StateRefOf, Target, Transition};
use plaus_run::codec::{Kind, decode, encode};
use plaus_scenes::dice::{Dice, Draw, Field, Realisation, Rest, Site, Work};
use plaus_scenes::{Rules, Scene};

/// The sites within the table's edges and slightly beyond.
fn sites() -> impl Iterator<Item = Site> {
    let all = (-40..=40).flat_map(|i| (-27..=27).map(move |j| (i, j)));
    all.flat_map(|(i, j)| Field::ALL.map(|field| Site { field, i, j }))
}

/// Gives every point its score at once, as if a move had done so.
fn make_whole(table: &mut Realisation) {
    let scores: Vec<(Site, f64)> = sites().map(|site| (site, table.score(site))).collect();
    scores.into_iter().for_each(|(site, score)| table.set(site, score));
}

/// Full bookkeeping: the density of a draw includes the density of every control point of the table,
/// `Π exp(−score²/2)`, and ratios are ratios of densities of scores.
struct Booked<'a>(&'a Dice);

fn booked(draw: &Draw) -> f64 {
    sites().map(|site| draw.tables[0].score(site)).map(|score| -0.5 * score * score).sum()
}

impl Target for Booked<'_> {
    type Draw = Draw;
    type Outcome = Rest;
    type Scratch = Work;

    fn start(&self, stream: &mut Stream) -> Draw {
        let mut draw = self.0.start(stream);
        make_whole(&mut draw.tables[0]);
        draw
    }

    fn log_prior(&self, draw: &Draw) -> Result<LogDensity, ModelError> {
        Ok(self.0.log_prior(draw)? + LogDensity::new(booked(draw))?)
    }

    fn simulate(
        &self,
        draw: &Draw,
        _: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        work: &mut Work,
    ) -> Result<Simulated<Rest>, ModelError> {
        self.0.simulate(draw, None, floor, work)
    }

    fn log_constraint(&self, rest: &Rest) -> Result<LogPotential, ModelError> {
        self.0.log_constraint(rest)
    }
}

/// A move whose step between scores has the density of the autoregressive proposal, or of the prior if everything is
/// drawn anew. So its ratio is `exp(−old²/2)/exp(−new²/2)` for each point that it changes, times the lazy move's ratio
/// for the rest.
struct OnScores {
    inner: Mixture<Dice>,
    index: plaus_mcmc::MoveId,
}

impl Move<Booked<'_>> for OnScores {
    fn name(&self) -> &str {
        self.inner.get(self.index).1.name()
    }

    fn propose(
        &self,
        at: At<'_, Booked<'_>>,
        candidate: &mut Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let proposal =
            self.inner.get(self.index).1.propose(At { target: at.target.0, state: at.state }, candidate, stream)?;
        let Proposal::Candidate { log_ratio, path, later } = proposal else { return Ok(proposal) };
        if candidate.tables[0].changed() == 0 {
            // The table was drawn anew, so it is made whole again.
            make_whole(&mut candidate.tables[0]);
        }
        let points = LogRatio::new(booked(at.state.draw) - booked(candidate))?;
        Ok(Proposal::Candidate { log_ratio: log_ratio.times(points)?, path, later })
    }

    fn log_ratio(&self, _: Transition<'_, Booked<'_>>) -> Result<LogRatio, ModelError> {
        Err(ModelError::new("not asked for by a chain"))
    }

    fn log_ratio_after(&self, step: Transition<'_, Booked<'_>>) -> Result<LogRatio, ModelError> {
        self.inner
            .get(self.index)
            .1
            .log_ratio_after(At { target: step.target.0, state: step.from }.to(step.to, step.path))
    }
}

/// A chain that holds only the points that moves have changed makes the same states, bit for bit, as a chain that holds
/// all points and their densities.
#[test]
fn changed_points_alone_give_the_same_chain_as_full_bookkeeping() {
    // Without shifts, which would move the window that is kept whole.
    let dice = scene(|config| config.weights.set("shift", 0.0));
    let moves = dice.moves(&Rules::exact()).unwrap();
    let whole = Booked(&dice);
    let mixed = |(k, (weight, _))| -> (f64, Box<dyn Move<Booked<'_>>>) {
        let inner = dice.moves(&Rules::exact()).unwrap();
        (weight, Box::new(OnScores { inner, index: plaus_mcmc::MoveId(k) }))
    };
    let booked = Mixture::new((0..).zip(moves.iter()).map(mixed).collect()).unwrap();
    let mut lazy = Chain::start(&dice, &moves, Seed(11).chain(0)).unwrap();
    let mut full = Chain::start(&whole, &booked, Seed(11).chain(0)).unwrap();
    let mut accepted = 0;
    for iteration in 0..300 {
        let (a, b) = (lazy.step().unwrap(), full.step().unwrap());
        assert_eq!((a, &lazy.state().draw.throws), (b, &full.state().draw.throws), "iteration {iteration}");
        assert_eq!(lazy.state().outcome, full.state().outcome, "iteration {iteration}");
        accepted += u32::from(a.decision == plaus_mcmc::Decision::Accepted);
    }
    assert!(accepted > 50, "{accepted}");
    assert!(lazy.state().draw.tables[0].changed() < 300 && full.state().draw.tables[0].changed() == sites().count());
}

/// A record needs only the draw: read back, it makes the same state, bit for bit.
#[test]
fn a_sample_is_rebuilt_from_its_record_alone() {
    const KIND: Kind = Kind::new(*b"dice", 1, "a draw");
    let dice = scene(|_| ());
    let moves = dice.moves(&Rules::exact()).unwrap();
    let mut chain = Chain::start(&dice, &moves, Seed(4).chain(1)).unwrap();
    for _ in 0..300 {
        chain.step().unwrap();
    }
    let bytes = encode(KIND, &chain.state().draw).unwrap();
    let draw: Draw = decode(KIND, &bytes).unwrap();
    assert!(draw.tables[0].changed() > 0);
    assert_eq!(&State::evaluate(&dice, draw, &mut Work::default()).unwrap(), chain.state());
}

/// Three fields of a thousand by a thousand control points each: 24 MB if all of them were made.
#[test]
fn only_the_parts_of_a_large_table_that_are_touched_cost_memory() {
    let dice = scene(|config| (config.table.length_mm, config.table.width_mm) = (8000.0, 8000.0));
    let mut stream = Seed(1).chain(0).at(0, Purpose::START);
    for _ in 0..5 {
        let draw = dice.start(&mut stream);
        let (points, bytes) = dice.touched(&draw).unwrap();
        // A strip of some twelve points' width and less than a metre's length, and the cells' polynomials of 18
        // numbers.
        assert!((100..6000).contains(&points) && bytes < 2_000_000, "{points} points, {bytes} bytes");
        assert_eq!(draw.tables[0].changed(), 0);
    }
}
