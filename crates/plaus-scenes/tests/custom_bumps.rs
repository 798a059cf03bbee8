//! The move that changes one bump keeps the prior as it is, and its ratios agree both ways: on level tables, on slanted
//! ones, and on surfaces of triangles. A twin that forgets the part of the ratio that needs the candidate's motion is
//! caught. Bumps move a surface along its normals, and draws in which they fold it are refused.

use glam::DVec3;
use plaus_dist::{LogRatio, Purpose, Seed, Stream};
use plaus_mcmc::check::{OneStep, OneStepReport, PriorOnly, Ratios, Statistic, one_step, prior, ratios};
use plaus_mcmc::view::lend;
use plaus_mcmc::{At, Mixture, ModelError, Move, MoveId, Proposal, State, StateOf, Target, Transition};
use plaus_scenes::animation::{Form, UPRIGHT};
use plaus_scenes::custom::{Custom, Drawn, Ending, Work};
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
";

/// What it falls onto: a level table, a slanted one, and a slanted box.
const GROUNDS: [&str; 3] = [
    "shape = { table = { bumps_mm = 4, spacing_mm = 15, friction = { mean = 0.4, sd = 0.1 } } }",
    "shape = { table = { bumps_mm = 4, spacing_mm = 15, friction = { mean = 0.4, sd = 0.1 } } }\n\
     turn_deg = [10, { normal = [0, 10] }, 30]",
    "shape = { box = { size_mm = [60, 60, 30] } }\nbumps = { sd_mm = 3, spacing_mm = 30 }\n\
     turn_deg = [10, { normal = [0, 10] }, 0]",
];

fn world(ground: &str) -> Custom {
    custom(&format!("{BUMPY}{ground}\n"))
}

fn custom(text: &str) -> Custom {
    let World::Custom(config) = Scenario::read("bumpy.toml", text, &[]).unwrap().world else { panic!("another") };
    Custom::new(&config).unwrap()
}

/// A move alone; made wrong, it forgets the part of its ratio that needs the candidate's motion.
pub(crate) struct Only {
    pub(crate) kernel: Box<dyn Move<Custom>>,
    pub(crate) forgets: bool,
}

/// The only move of the world, with large steps.
fn only(world: &Custom, forgets: bool) -> Only {
    let moves = world.moves(&Rules::default()).unwrap();
    assert_eq!(moves.names(), ["bump"]);
    Only { kernel: moves.get(MoveId(0)).1.at_scales(&[Some(1.0); 3]).unwrap(), forgets }
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
        _ => -1.0,
    };
    let score = |field, i, j| move |state: &StateOf<Custom>| state.draw.tables[0].score(Site { field, i, j });
    vec![
        Statistic::new("how far the ball goes", far),
        Statistic::new("height below the ball", score(Field::Height, 0, 0)),
        Statistic::new("height beside the ball", score(Field::Height, 2, 0)),
        Statistic::new("friction below the ball", score(Field::Friction, 1, 0)),
    ]
}

fn report(ground: usize, samples: u64, forgets: bool) -> OneStepReport {
    let world = world(GROUNDS[ground]);
    let free = PriorOnly::new(&world);
    let moves = lend::<PriorOnly<'_, Custom>>(Mixture::of(Box::new(only(&world, forgets)))).unwrap();
    let plan = OneStep { seed: Seed(7), samples, steps: 16, cells: 8, false_alarm: 1e-6 };
    one_step(&free, &moves, prior(&free), &statistics(), plan).unwrap()
}

#[test]
fn changing_one_bump_keeps_the_prior() {
    for (ground, samples) in [(0, 2_500), (2, 1_000)] {
        let report = report(ground, samples, false);
        assert!(report.passed() && report.accepted() > samples / 3, "{}: {report}", GROUNDS[ground]);
    }
}

#[test]
fn a_bump_that_forgets_half_its_ratio_is_caught() {
    let report = report(0, 2_500, true);
    assert!(!report.passed(), "{report}");
}

#[test]
fn ratios_of_bumps_agree_both_ways() {
    for ground in GROUNDS {
        let world = world(ground);
        let plan = Ratios { pairs: 700, ..Ratios::default() };
        let right = ratios(&world, &only(&world, false), prior(&world), plan).unwrap();
        assert!(right.passed(), "{ground}: {right}");
        let wrong = ratios(&world, &only(&world, true), prior(&world), plan).unwrap();
        assert!(!wrong.passed(), "{ground}: {wrong}");
    }
}

/// Corners of the only scenery, in m with z up, in some draws.
fn drawn(text: &str) -> Vec<Vec<DVec3>> {
    let world = custom(text);
    let corners = |nth| {
        let draw = world.start(&mut Seed(4).chain(0).at(nth, Purpose::START));
        let animation = world.animate(&draw).unwrap();
        let Form::Mesh { vertices, .. } = &animation.scenery[0].form else { panic!("no triangles") };
        vertices.iter().map(|vertex| UPRIGHT.conjugate() * *vertex).collect()
    };
    (0..40).map(corners).collect()
}

/// On the level top of a box, away from its edges, corners move straight up and down: where they are in the plane is
/// the same in each draw, and their heights have the variance of a b-spline with independent control points, which at a
/// control point is 1/2 per axis of the grid (its weights are 1/6, 2/3, 1/6) and nowhere less than 0.46 (half way:
/// 1/48, 23/48, 23/48, 1/48); to the third power, from 0.0973 to 0.125. Of 40 draws and 100 corners the mean of squares
/// is known to about 15 % (corners that are near each other count as one), so that bumps of half or twice the height
/// are told.
#[test]
fn bumps_move_a_surface_along_its_normal() {
    let text = "[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 5 } }\nat_mm = [0, 0, 90]\n\
                [[world.custom.fixed]]\nname = 'block'\nshape = { box = { size_mm = [200, 200, 20] } }\n\
                bumps = { sd_mm = 2, spacing_mm = 20 }\n";
    let draws = drawn(&format!("[world.custom]\nduration_s = 0.01\n{text}"));
    let top = |corner: &&DVec3| corner.z > 0.0 && corner.truncate().abs().max_element() < 0.085;
    let first: Vec<usize> = (0..draws[0].len()).filter(|&k| top(&&draws[0][k])).collect();
    let (mut squares, mut count) = (0.0, 0.0);
    for corners in &draws {
        for &k in &first {
            assert!((corners[k] - draws[0][k]).truncate().length() < 1e-15);
            let height = (corners[k].z - 0.01) / 2e-3;
            squares += height * height;
            count += 1.0;
        }
    }
    let mean = squares / count;
    assert!(first.len() > 100 && (0.0973..0.125 * 1.3).contains(&mean), "{}: {mean}", first.len());
}

/// Bumps far higher than a plate is thick, close to each other, turn triangles at its edges over: such draws are
/// refused, and `check` says what is asked.
#[test]
fn bumps_that_fold_a_surface_are_refused() {
    let text = "[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 5 } }\nat_mm = [0, 0, 200]\n\
                [[world.custom.fixed]]\nname = 'plate'\nshape = { box = { size_mm = [60, 60, 20] } }\n";
    let ending = |bumps: &str, nth| {
        let world = custom(&format!("[world.custom]\nduration_s = 0.01\n{text}bumps = {{ {bumps} }}\n"));
        assert!(world.asked()[1].contains("no bumps fold"));
        let draw = world.start(&mut Seed(4).chain(0).at(nth, Purpose::START));
        State::evaluate(&world, draw, &mut Work::default()).unwrap()
    };
    assert!((0..20).all(|nth| matches!(ending("sd_mm = 0.2, spacing_mm = 20", nth).outcome, Ending::Done(_))));
    let high: Vec<_> = (0..20).map(|nth| ending("sd_mm = 60, spacing_mm = 20", nth)).collect();
    let refused = |state: &StateOf<Custom>| {
        matches!(state.outcome, Ending::Folded(0)) && state.log_constraint.value() == f64::NEG_INFINITY
    };
    assert!(high.iter().filter(|state| refused(state)).count() >= 10);
}
