//! What chains sample in worlds that users describe, compared with weighted draws from the prior: the means of all
//! variables, and of the places where bodies end, agree within three standard errors. A twin that ignores the
//! requirements is caught. And every move of such a world leaves the prior invariant, whatever the law.

use crate::common::shapes;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::check::{OneStep, PriorOnly, Statistic, one_step, prior};
use plaus_mcmc::view::lend;
use plaus_mcmc::{
    At, Chain, Mixture, ModelError, Move, Proposal, State, StateOf, StateRefOf, Target, Transition, Variables,
};
use plaus_scenes::dice::{Field, Site};
use plaus_scenes::{AnyScratch, Rules, Scenario, Scene, Stage, World, custom::Custom};
use std::sync::Arc;

/// Draws from the prior, and iterations of a chain.
const DRAWS: u64 = 6_000;
const ITERATIONS: u64 = 12_000;
/// Number of stretches of a chain from whose means its standard error is estimated. Each is far longer than the chain's
/// autocorrelation time.
const STRETCHES: usize = 30;
/// Standard errors. There are 90 or so means in all, so the largest deviation of a right chain exceeds 3 in one run of
/// four. The seeds are chosen so that it does not. A wrong chain exceeds it for any seed.
pub(crate) const LIMIT: f64 = 3.0;

const BALL: &str = "[[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 30 } }\n";

/// Small worlds: settings of the world, what follows the ball's shape, and what is required. Scales are wide, so that
/// the prior reaches what is asked for.
pub(crate) const CASES: &[[&str; 3]] = &[
    [
        "duration_s = 0.6",
        "at_mm = [0, 0, 300]\nvelocity_m_s = [{ normal = [1, 0.3] }, { uniform = [-0.5, 0.5] }, 0]",
        "passes = { x_mm = 400, y_mm = 100, z_mm = 150, within_mm = 30, scale_mm = 60 }",
    ],
    [
        "duration_s = 0.6\n[[world.custom.materials]]\nname = 'rubber'\nrestitution = { triangular = [0.2, 0.5, 1] }",
        "material = 'rubber'\nat_mm = [0, 0, { uniform = [150, 400] }]",
        "path_length = { at_least_mm = 420, scale_mm = 50 }",
    ],
    [
        "duration_s = 0.5",
        "at_mm = [0, 0, { log_normal = { median = 250, spread = 0.3 } }]\n\
         velocity_m_s = [0, 0, { truncated = { mean = 0, sd = 1, from = -1, to = 0.5 } }]",
        "impact = { when = { at_s = 0.2, within_ms = 10, scale_ms = 30 } }",
    ],
    [
        "duration_s = 0.5\n[[world.custom.fixed]]\nname = 'ramp'\nshape = { box = { size_mm = [400, 400, 20] } }\n\
         turn_deg = [0, { von_mises = { mean = 10, concentration = 20 } }, 0]",
        "at_mm = [{ normal = [0, 20] }, 0, 200]",
        "inside = { x_mm = [50, 200], how = 'at_end', scale_mm = 60 }",
    ],
    [
        "duration_s = 0.5",
        "at_mm = [0, 0, 200]\nvelocity_m_s = [{ choice = { of = [0.5, 1, 2], weights = [1, 2, 3] } }, 0, 0]\n\
         spin_deg_s = [0, { normal = [0, 1000] }, 0]",
        "speed = { after = true, at_most = 1.3, scale = 0.3 }",
    ],
    [
        "duration_s = 0.5\n[[world.custom.quantities]]\nname = 'push'\nvalue = { uniform = [0.2, 1.4] }\n\
         [[world.custom.bodies]]\nname = 'other'\nshape = { ball = { radius_mm = { uniform = [15, 45] } } }\n\
         at_mm = [300, 0, 45]\nvelocity_m_s = ['push', 0, 0]",
        "at_mm = [0, 0, 30]\nvelocity_m_s = ['push', { normal = [0, 0.2] }, 0]",
        "relative = { body = 'ball', to = 'other', x_mm = -330, y_mm = 60, within_mm = 20, scale_mm = 40 }",
    ],
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'brick'\nany_turn = true\n\
         shape = { box = { size_mm = [30, 50, 80] } }\nat_mm = [500, 0, { uniform = [80, 200] }]",
        "at_mm = [0, 0, 100]",
        "faces_up = { body = 'brick', axis = 'z', within_deg = 30, scale_deg = 30, when = { at_s = 0.05 } }",
    ],
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'other'\nshape = { ball = { radius_mm = 40 } }\n\
         at_mm = [{ uniform = [-100, 100] }, 0, 100]",
        "at_mm = [60, { normal = [0, 80] }, 100]\nvelocity_m_s = [0, { normal = [0, 0.3] }, 0]",
        "touches = { body = 'ball', with = 'other' }",
    ],
    // Arithmetic: laws within formulas, and a shared quantity that two numbers depend on.
    [
        "duration_s = 0.5\n[[world.custom.quantities]]\nname = 'push'\nvalue = 'max(0.2, normal(0.8, 0.4))'",
        "at_mm = [0, 0, '100 + 50 * push * uniform(0.5, 1.5)']\n\
         velocity_m_s = ['push', 'normal(0, 0.2) - 0.1 * push', 0]",
        "passes = { x_mm = 300, y_mm = 0, z_mm = 100, within_mm = 40, scale_mm = 80 }",
    ],
    // An array whose members each have a number of their own.
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'marble'\ncount = 3\n\
         shape = { ball = { radius_mm = 'uniform(8, 12) + 2 * i' } }\n\
         at_mm = ['80 * (i + 1)', { normal = [0, 10] }, 'uniform(40, 80)']",
        "at_mm = [0, 0, 31]\nvelocity_m_s = [{ uniform = [0, 2] }, 0, 0]",
        "relative = { body = 'marble_1', to = 'marble_3', y_mm = 15, within_mm = 20, scale_mm = 40 }",
    ],
    // Forces and damping are uncertain.
    [
        "duration_s = 0.5",
        "at_mm = [0, 0, 200]\nvelocity_m_s = [1, 0, 0]\ngravity_scale = { uniform = [-0.5, 1] }\n\
         damping = { uniform = [0, 3] }\nforce_n = [0, { normal = [0, 0.3] }, 0]",
        "passes = { x_mm = 300, y_mm = 60, z_mm = 150, within_mm = 30, scale_mm = 60 }",
    ],
    // A table with random bumps and friction, which alone decide where the ball goes.
    [
        "duration_s = 0.45\n[[world.custom.fixed]]\nname = 'table'\nat_mm = [0, 0, { normal = [0, 5] }]\n\
         shape = { table = { bumps_mm = 3, spacing_mm = 30, friction = { mean = 0.4, sd = 0.1 } } }",
        "at_mm = [0, 0, 250]",
        "inside = { x_mm = [40, 300], how = 'at_end', scale_mm = 30 }",
    ],
    // Slanted tables: how the slope lies is uncertain, and so is every bump of it.
    [
        "duration_s = 0.26\n[[world.custom.fixed]]\nname = 'slope'\nturn_deg = [0, { normal = [15, 5] }, 0]\n\
         shape = { table = { bumps_mm = 3, spacing_mm = 30, friction = { mean = 0.4, sd = 0.1 } } }",
        "at_mm = [0, 0, 150]",
        "inside = { y_mm = [20, 300], how = 'at_end', scale_mm = 10 }",
    ],
    // A box with bumps on all its faces, which alone decide where the ball goes.
    [
        "duration_s = 0.24\n[[world.custom.fixed]]\nname = 'block'\nturn_deg = [0, 10, 0]\n\
         shape = { box = { size_mm = [60, 60, 25] } }\nbumps = { sd_mm = 5, spacing_mm = 80 }",
        "at_mm = [0, 0, 130]",
        "inside = { y_mm = [10, 300], how = 'at_end', scale_mm = 6 }",
    ],
    // The hull of a file falls onto the triangles of another; where the triangles are, and how large both shapes are,
    // is uncertain.
    [
        "duration_s = 0.2\n[[world.custom.fixed]]\nname = 'roof'\n\
         shape = { mesh = { file = 'roof.obj', up = 'z', unit_mm = { uniform = [0.8, 1.2] } } }\n\
         at_mm = [{ normal = [0, 60] }, 0, 0]\n\
         [[world.custom.bodies]]\nname = 'wedge'\nany_turn = true\nvelocity_m_s = [0, 0, -1.5]\nat_mm = [0, 0, 200]\n\
         shape = { hull_of = { file = 'wedge.obj', up = 'z', unit_mm = { uniform = [0.7, 1.3] } } }",
        "at_mm = [0, 1000, 100]",
        "passes = { body = 'wedge', x_mm = 40, y_mm = 0, z_mm = 140, within_mm = 10, scale_mm = 20 }",
    ],
    // A compound with an uncertain place and an uncertain weight of a piece.
    [
        "duration_s = 0.15\n[[world.custom.bodies]]\nname = 'hammer'\nat_mm = [0, 1000, 90]\n\
         shape = { compound = { pieces = [\n\
         { shape = { box = { size_mm = [120, 16, 16] } } },\n\
         { shape = { box = { size_mm = [30, 60, 30] } }, at_mm = [{ uniform = [20, 60] }, 0, 0], \
         density = { log_normal = { median = 3, spread = 0.5 } } },\n] } }",
        "at_mm = [0, 0, 100]",
        "passes = { body = 'hammer', x_mm = 45, y_mm = 1000, z_mm = 60, within_mm = 3, scale_mm = 8 }",
    ],
    // A ball that another one, which may not be there, may stop. How likely it is there follows from how far the first
    // one gets.
    [
        "duration_s = 0.5\n[[world.custom.bodies]]\nname = 'other'\npresent = 0.7\n\
         shape = { ball = { radius_mm = 40 } }\nat_mm = [{ uniform = [110, 250] }, 0, 41]",
        "at_mm = [0, 0, 31]\nvelocity_m_s = [{ normal = [1, 0.3] }, { normal = [0, 0.1] }, 0]",
        "inside = { body = 'ball', x_mm = [150, 400], how = 'at_end', scale_mm = 60 }",
    ],
    // Laws whose numbers are uncertain.
    [
        "duration_s = 0.5\n[[world.custom.quantities]]\nname = 'wide'\nvalue = { uniform = [0.1, 0.5] }",
        "at_mm = [0, 0, 'triangular(150, uniform(150, 300), 300)']\n\
         velocity_m_s = ['normal(1, wide)', 'uniform(0 - wide, wide)', 'choice(0, wide)']",
        "passes = { x_mm = 300, y_mm = 60, z_mm = 150, within_mm = 30, scale_mm = 60 }",
    ],
    // A ball that starts on a slope, whose angle is uncertain.
    [
        "duration_s = 0.4\n[[world.custom.fixed]]\nname = 'ramp'\nshape = { box = { size_mm = [400, 200, 20] } }\n\
         turn_deg = [0, { normal = [20, 5] }, 0]",
        "within = { surface = { of = 'ramp', above_mm = 'uniform(31, 60)' } }",
        "inside = { x_mm = [50, 300], how = 'at_end', scale_mm = 60 }",
    ],
    // Three balls, two of which must each go somewhere: what is missed says which variables change more often.
    [
        "duration_s = 0.4\n[[world.custom.bodies]]\nname = 'other'\ncount = 2\n\
         shape = { ball = { radius_mm = 20 } }\nat_mm = ['200 + 200 * i', { normal = [0, 60] }, 100]",
        "at_mm = [0, { normal = [0, 60] }, 100]",
        "passes = { body = 'ball', x_mm = 0, y_mm = 60, z_mm = 80, within_mm = 30, scale_mm = 30 }\n[[require]]\n\
         passes = { body = 'other_1', x_mm = 200, y_mm = -60, z_mm = 80, within_mm = 30, scale_mm = 30 }",
    ],
    // A ball that starts anywhere within a ball of uncertain radius.
    [
        "duration_s = 0.4",
        "at_mm = [0, 0, 300]\nwithin = { ball = { radius_mm = { uniform = [60, 140] } } }\nvelocity_m_s = [1, 0, 0]",
        "passes = { x_mm = 200, y_mm = 40, z_mm = 150, within_mm = 30, scale_mm = 60 }",
    ],
];

/// The scenario of a case.
pub(crate) fn scenario([world, ball, required]: &[&str; 3]) -> Scenario {
    let (settings, tables) = world.split_once('\n').unwrap_or((world, ""));
    let text = format!("[world.custom]\n{settings}\n{tables}\n{BALL}{ball}\n[[require]]\n{required}\n");
    Scenario::read_with("case.toml", &text, &[], &shapes()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The numbers of a state: all except times of rest, which may never come, and margins.
fn looked_at<S: Scene>(scene: &S, state: StateRefOf<'_, S>) -> Vec<f64> {
    let scalars = scene.scalars();
    let mut values = vec![0.0; scalars.len()];
    scene.write_scalars(state, &mut values);
    let counts = |name: &str| !name.ends_with(".rest") && !name.starts_with("margin");
    let counted = scalars.iter().zip(values).filter(|(scalar, _)| counts(&scalar.name));
    // A body that is not there ends nowhere, which counts as 0 here.
    counted.map(|(_, value)| if value.is_nan() { 0.0 } else { value }).collect()
}

/// Means with standard errors, from draws of the prior weighted by their constraint.
pub(crate) fn weighed<S: Scene>(scene: &S) -> Vec<[f64; 2]> {
    let (mut seen, mut scratch) = (Vec::new(), S::Scratch::default());
    for nth in 0..DRAWS {
        let draw = scene.start(&mut Seed(3).chain(9).at(nth, Purpose::START));
        let state = State::evaluate(scene, draw, &mut scratch).unwrap();
        let weight = state.log_constraint.value().exp();
        if weight > 0.0 {
            seen.push((weight, looked_at(scene, state.by_ref())));
        }
    }
    assert!(seen.len() as u64 > DRAWS / 4, "only {} draws count", seen.len());
    let whole: f64 = seen.iter().map(|(weight, _)| weight).sum();
    let column = |k: usize| {
        let mean = seen.iter().map(|(weight, values)| weight * values[k]).sum::<f64>() / whole;
        let squares: f64 = seen.iter().map(|(weight, values)| (weight * (values[k] - mean)).powi(2)).sum();
        [mean, squares.sqrt() / whole]
    };
    (0..seen[0].1.len()).map(column).collect()
}

/// The same from a chain.
fn sampled<S: Scene>(scene: &S) -> Vec<[f64; 2]> {
    sampled_by(scene, &scene.moves(&Rules::default()).unwrap())
}

/// The same from a chain with these moves.
pub(crate) fn sampled_by<S: Scene>(scene: &S, moves: &Mixture<S>) -> Vec<[f64; 2]> {
    let mut chain = Chain::start(scene, moves, Seed(4).chain(0)).unwrap();
    for _ in 0..500 {
        chain.step().unwrap();
    }
    let each = ITERATIONS / STRETCHES as u64;
    let stretch = |_| {
        let mut sums: Vec<f64> = Vec::new();
        for _ in 0..each {
            chain.step().unwrap();
            let values = looked_at(scene, chain.state().by_ref());
            sums.resize(values.len(), 0.0);
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value / each as f64);
        }
        sums
    };
    let stretches: Vec<Vec<f64>> = (0..STRETCHES).map(stretch).collect();
    let column = |k: usize| {
        let n = STRETCHES as f64;
        let mean = stretches.iter().map(|stretch| stretch[k]).sum::<f64>() / n;
        let squares: f64 = stretches.iter().map(|stretch| (stretch[k] - mean).powi(2)).sum();
        [mean, (squares / (n - 1.0) / n).sqrt()]
    };
    (0..stretches[0].len()).map(column).collect()
}

/// The largest difference between two lists of means, in standard errors. Both may know a number exactly.
pub(crate) fn apart(one: &[[f64; 2]], other: &[[f64; 2]]) -> f64 {
    assert_eq!(one.len(), other.len());
    let each = one.iter().zip(other).map(|([a, error], [b, besides])| {
        let rounding = 1e-9 * (1.0 + a.abs());
        (a - b).abs() / error.hypot(*besides).max(rounding)
    });
    each.fold(0.0, f64::max)
}

#[test]
fn chains_sample_what_is_described_and_required() {
    for case in CASES {
        let asked = scenario(case);
        let truth = weighed(&asked.stage().unwrap());
        let z = apart(&truth, &sampled(&asked.stage().unwrap()));
        assert!(z < LIMIT, "{case:?}: {z} standard errors");
        let free = Scenario { require: Vec::new(), ..asked };
        let z = apart(&truth, &sampled(&free.stage().unwrap()));
        assert!(z > LIMIT, "{case:?}: a chain that forgets what is required is only {z} standard errors off");
    }
}

/// A chain of a world in which bodies are there too seldom is told from the right one.
#[test]
fn a_chain_with_a_wrong_probability_of_a_body_is_caught() {
    let case = CASES.iter().find(|[world, ..]| world.contains("present = 0.7")).unwrap();
    let seldom = case.map(|text| text.replace("present = 0.7", "present = 0.6"));
    let (truth, seldom) = (weighed(&scenario(case).stage().unwrap()), scenario(&seldom.each_ref().map(String::as_str)));
    let z = apart(&truth, &sampled(&seldom.stage().unwrap()));
    assert!(z > LIMIT, "only {z} standard errors");
}

/// A hash of the states of a chain of the trick shot, bit for bit, over this many iterations.
fn trace(iterations: u32) -> u64 {
    let text = include_str!("../../../scenarios/worlds/trick-shot.toml");
    let scene = Scenario::read("trick-shot.toml", text, &[]).unwrap().stage().unwrap();
    let moves = scene.moves(&Rules::default()).unwrap();
    let mut chain = Chain::start(&scene, &moves, Seed(1).chain(0)).unwrap();
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for _ in 0..iterations {
        chain.step().unwrap();
        let mut values = vec![0.0; scene.scalars().len()];
        scene.write_scalars(chain.state().by_ref(), &mut values);
        // NaN can have many bit patterns.
        let bits = values.iter().map(|value| if value.is_nan() { 0 } else { value.to_bits() });
        hash = bits.fold(hash, |hash, bits| (hash ^ bits).wrapping_mul(0x0100_0000_01b3));
    }
    hash
}

/// The same scenario, seed and version give the same bits. If another number is intended, CHANGELOG says so.
#[test]
fn a_chain_is_pinned() {
    assert_eq!(trace(100), 17_224_081_284_349_937_707);
}

/// Every world in the project's folder can be read, and its first draws are simulated.
#[test]
fn the_worlds_in_the_folder_are_worlds() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/worlds");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|ending| ending != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let beside =
            |file: &str, _: bool| std::fs::read(path.with_file_name(file)).map(Arc::from).map_err(|e| e.to_string());
        let scenario = Scenario::read_with(&path.to_string_lossy(), &text, &[], &beside);
        let scenario = scenario.unwrap_or_else(|error| panic!("{error}"));
        let scene = scenario.stage().unwrap();
        let draw = |nth| scene.start(&mut Seed(1).chain(0).at(nth, Purpose::START));
        let state = |nth| State::evaluate(&scene, draw(nth), &mut AnyScratch::default()).unwrap();
        let moves = |state: StateOf<Stage>| !state.log_constraint.is_zero() && scene.animate(&state.draw).is_ok();
        assert!((0..5).map(state).any(moves), "{}", path.display());
        count += 1;
    }
    assert!(count >= 7);
}

/// One variable of every law.
const EVERY_LAW: &str = "
[world.custom]
duration_s = 0.001
[[world.custom.bodies]]
name = 'ball'
shape = { ball = { radius_mm = { log_normal = { median = 30, spread = 0.4 } } } }
at_mm = [{ normal = [0, 20] }, { uniform = [-1, 2] }, { triangular = [500, 510, 600] }]
velocity_m_s = [
    { truncated = { mean = 0, sd = 1, from = 0.5, to = 3 } },
    { choice = { of = [1, 5, 3], weights = [3, 2, 1] } },
    0,
]
turn_deg = [0, 0, { von_mises = { mean = 170, concentration = 2 } }]
[[world.custom.bodies]]
name = 'brick'
shape = { box = { size_mm = [10, 20, 30] } }
any_turn = true
at_mm = [1000, 0, 500]
[[world.custom.fixed]]
name = 'table'
shape = { table = { bumps_mm = 2, spacing_mm = 20 } }
";

fn every_law() -> Custom {
    let scenario = Scenario::read("laws.toml", EVERY_LAW, &[]).unwrap();
    let World::Custom(config) = scenario.world else { panic!("another world") };
    Custom::new(&config).unwrap()
}

/// Statistics of all variables: for the brick's turn the direction of its third axis, for the table a point's score.
fn statistics<'a>(world: &'a Custom) -> Vec<Statistic<'a, <Custom as Target>::Draw, <Custom as Target>::Outcome>> {
    let mut all = Vec::new();
    let turn = world.vars().iter().position(|var| var.name == "brick.turn").unwrap_or(usize::MAX);
    for (index, var) in world.vars().iter().enumerate() {
        let value = move |state: &StateOf<Custom>| match world.get(&state.draw, index) {
            Some(values) => values[0],
            None if index == turn => (state.draw.turns[0] * glam::DVec3::Z).z,
            None => state.draw.tables[0].score(Site { field: Field::Height, i: 1, j: -2 }),
        };
        all.push(Statistic::new(var.name.clone(), value));
    }
    all
}

const PLAN: OneStep = OneStep { seed: Seed(5), samples: 8_000, steps: 2, cells: 8, false_alarm: 1e-6 };

#[test]
fn every_move_leaves_every_law_invariant() {
    let world = every_law();
    let free = PriorOnly::new(&world);
    let moves = lend::<PriorOnly<'_, Custom>>(world.moves(&Rules::default()).unwrap()).unwrap();
    let report = one_step(&free, &moves, prior(&free), &statistics(&world), PLAN).unwrap();
    assert!(report.passed() && report.accepted() > 1000, "{report}");
}

/// Redraws any one variable, with half of the right ratio.
struct HalfRight;

impl Move<Custom> for HalfRight {
    fn name(&self) -> &str {
        "half_right"
    }

    fn propose(
        &self,
        at: At<'_, Custom>,
        draw: &mut <Custom as Target>::Draw,
        stream: &mut plaus_dist::Stream,
    ) -> Result<Proposal, ModelError> {
        let all = at.target.vars().which(|_| true);
        let var = all[plaus_dist::stream::below(stream, all.len())];
        let before = plaus_mcmc::vars::log_density(at.target, at.state.draw, var)?;
        plaus_mcmc::vars::renew(at.target, draw, var, plaus_mcmc::Recipe::Exact, stream);
        let after = plaus_mcmc::vars::log_density(at.target, draw, var)?;
        Ok(Proposal::with_ratio(plaus_dist::LogRatio::new(0.5 * (before.value() - after.value()))?))
    }

    fn log_ratio(&self, _: Transition<'_, Custom>) -> Result<plaus_dist::LogRatio, ModelError> {
        Ok(plaus_dist::LogRatio::ONE)
    }
}

#[test]
fn a_move_with_half_its_ratio_is_caught() {
    let world = every_law();
    let free = PriorOnly::new(&world);
    let moves = lend::<PriorOnly<'_, Custom>>(plaus_mcmc::Mixture::of(Box::new(HalfRight))).unwrap();
    let report = one_step(&free, &moves, prior(&free), &statistics(&world), PLAN).unwrap();
    assert!(!report.passed(), "{report}");
}
