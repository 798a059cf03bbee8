//! The move that changes one bump of a table keeps the prior as it is, and its ratios agree both ways. A twin that
//! forgets the part of the ratio that needs the candidate's motion is caught.

use plaus_dist::{LogRatio, Seed, Stream};
use plaus_mcmc::check::{OneStep, OneStepReport, PriorOnly, Ratios, Statistic, one_step, prior, ratios};
use plaus_mcmc::view::lend;
use plaus_mcmc::{At, Mixture, ModelError, Move, MoveId, Proposal, StateOf, Transition};
use plaus_scenes::custom::{Custom, Drawn, Ending};
use plaus_scenes::dice::{Field, Site};
use plaus_scenes::{Rules, Scenario, Scene, World};

/// A ball falls onto high bumps, which throw it aside. Only this move changes anything.
const BUMPY: &str = "
[world.custom]
duration_s = 0.5
[world.custom.weights]
redraw_all = 0
redraw_body = 0
redraw_any = 0
step_any = 0
step_all = 0
unmet = 0
[[world.custom.bodies]]
name = 'ball'
shape = { ball = { radius_mm = 10 } }
at_mm = [5, 0, 250]
[[world.custom.fixed]]
name = 'table'
at_mm = [0, 0, { normal = [0, 5] }]
shape = { table = { bumps_mm = 4, spacing_mm = 15, friction = { mean = 0.4, sd = 0.1 } } }
";

fn world() -> Custom {
    let World::Custom(config) = Scenario::read("bumpy.toml", BUMPY, &[]).unwrap().world else { panic!("another") };
    Custom::new(&config).unwrap()
}

/// The only move of the world, with large steps; made wrong, it forgets the part of its ratio that needs the
/// candidate's motion.
struct Only {
    kernel: Box<dyn Move<Custom>>,
    forgets: bool,
}

impl Only {
    fn of(world: &Custom, forgets: bool) -> Self {
        let moves = world.moves(&Rules::default()).unwrap();
        assert_eq!(moves.names(), ["bump"]);
        Self { kernel: moves.get(MoveId(0)).1.at_scales(&[Some(1.0); 3]).unwrap(), forgets }
    }
}

impl Move<Custom> for Only {
    fn name(&self) -> &str {
        self.kernel.name()
    }

    fn propose(&self, at: At<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let proposal = self.kernel.propose(at, candidate, stream)?;
        Ok(match proposal {
            Proposal::Candidate { path, .. } if self.forgets => {
                Proposal::Candidate { log_ratio: LogRatio::ONE, path, later: None }
            }
            right => right,
        })
    }

    fn log_ratio(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        self.kernel.log_ratio(step)
    }

    fn log_ratio_after(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        self.kernel.log_ratio_after(step)
    }
}

type Number<'a> = Statistic<'a, Drawn, Ending>;

/// How far the ball goes, and scores of points below it and beside it, and of friction.
fn statistics<'a>() -> Vec<Number<'a>> {
    let far = |state: &StateOf<Custom>| match &state.outcome {
        Ending::Done(done) => done.bodies[0].place.truncate().length(),
        Ending::Overlap(_) | Ending::Unfinished | Ending::Crushed(_) => -1.0,
    };
    let score = |field, i, j| move |state: &StateOf<Custom>| state.draw.tables[0].score(Site { field, i, j });
    vec![
        Statistic::new("how far the ball goes", far),
        Statistic::new("height below the ball", score(Field::Height, 0, 0)),
        Statistic::new("height beside the ball", score(Field::Height, 2, 0)),
        Statistic::new("friction below the ball", score(Field::Friction, 1, 0)),
    ]
}

fn report(forgets: bool) -> OneStepReport {
    let world = world();
    let free = PriorOnly::new(&world);
    let moves = lend::<PriorOnly<'_, Custom>>(Mixture::of(Box::new(Only::of(&world, forgets)))).unwrap();
    let plan = OneStep { seed: Seed(7), samples: 10_000, steps: 16, cells: 8, false_alarm: 1e-6 };
    one_step(&free, &moves, prior(&free), &statistics(), plan).unwrap()
}

#[test]
fn changing_one_bump_keeps_the_prior() {
    let report = report(false);
    assert!(report.passed() && report.accepted() > 4_000, "{report}");
}

#[test]
fn a_bump_that_forgets_half_its_ratio_is_caught() {
    let report = report(true);
    assert!(!report.passed(), "{report}");
}

#[test]
fn ratios_of_bumps_agree_both_ways() {
    let world = world();
    let plan = Ratios { pairs: 2_000, ..Ratios::default() };
    let right = ratios(&world, &Only::of(&world, false), prior(&world), plan).unwrap();
    assert!(right.passed(), "{right}");
    let wrong = ratios(&world, &Only::of(&world, true), prior(&world), plan).unwrap();
    assert!(!wrong.passed(), "{wrong}");
}
