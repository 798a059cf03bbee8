//! Moves that follow from what a world is: throws of bodies that meet only level planes are led to where they should
//! end, shifted, turned and relabelled. Each leaves exact draws of the target what they are, in many random worlds, and
//! a twin without its ratio does not.

use plaus_dist::stream::below;
use plaus_dist::{LogPotential, LogRatio, Purpose, Seed, Stream};
use plaus_mcmc::check::{OneStep, OneStepReport, Ratios, Statistic, one_step, prior, ratios, rejection};
use plaus_mcmc::{At, Mixture, ModelError, Move, Path, Proposal, StateOf, Target, Transition, Variables};
use plaus_scenes::{Rules, Scenario, Scene, Stage};

/// What is wrong with a twin.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    None,
    /// It takes its ratio for 1.
    Forgets,
    /// It also lets one number grow by a fifth or shrink by as much, and takes no notice of the volume.
    Grows,
}

/// One of the stage's moves, or a twin of it.
struct Only {
    all: Mixture<Stage>,
    name: &'static str,
    fault: Fault,
}

impl Only {
    fn inner(&self) -> &dyn Move<Stage> {
        self.all.iter().find(|(_, kernel)| kernel.name() == self.name).unwrap().1
    }
}

impl Move<Stage> for Only {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(
        &self,
        at: At<'_, Stage>,
        draw: &mut <Stage as Target>::Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let proposal = self.inner().propose(at, draw, stream)?;
        if self.fault == Fault::None || proposal == Proposal::Stay {
            return Ok(proposal);
        }
        if self.fault == Fault::Grows
            && let Some(numbers) = at.target.get_mut(draw, 0)
        {
            numbers[0] *= 1.2;
        }
        Ok(Proposal::SYMMETRIC)
    }

    fn log_ratio(&self, step: Transition<'_, Stage>) -> Result<LogRatio, ModelError> {
        self.inner().log_ratio(step)
    }

    fn log_ratio_after(&self, step: Transition<'_, Stage>) -> Result<LogRatio, ModelError> {
        self.inner().log_ratio_after(step)
    }

    fn reverse(&self, path: Path) -> Path {
        self.inner().reverse(path)
    }
}

fn stage(text: &str) -> Stage {
    let scenario = Scenario::read("throws.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    scenario.stage().unwrap()
}

fn names(stage: &Stage) -> Vec<String> {
    stage.moves(&Rules::default()).unwrap().names()
}

fn only(stage: &Stage, name: &'static str, fault: Fault) -> Only {
    Only { all: stage.moves(&Rules::default()).unwrap(), name, fault }
}

const MOVES: [&str; 4] = ["recast", "shift", "turn", "relabel"];

/// A world of one thrown body, or two that seldom meet, of random shapes, laws and requirements. So many draws meet the
/// requirements that exact draws of the target are cheap.
fn random_world(stream: &mut Stream) -> String {
    let one_of = |stream: &mut Stream, all: &[&str]| all[below(stream, all.len())].to_owned();
    let place = |stream: &mut Stream, from: i32| {
        let all = [
            format!("{{ normal = [{from}, 30] }}"),
            format!("{{ uniform = [{}, {}] }}", from - 50, from + 60),
            format!("{{ truncated = {{ mean = {from}, sd = 40, from = {}, to = {} }} }}", from - 60, from + 90),
            format!("'{from} - 2 * normal(0, 20)'"),
        ];
        all[below(stream, all.len())].clone()
    };
    let shapes = [
        ("{ ball = { radius_mm = 12 } }", true),
        ("{ box = { size_mm = [16, 16, 16] } }", false),
        ("{ box = { size_mm = [10, 16, 16] } }", false),
        ("{ cylinder = { radius_mm = 12, height_mm = 6 } }", false),
    ];
    let speed = |stream: &mut Stream| one_of(stream, &["{ normal = [0, 0.2] }", "{ uniform = [-0.3, 0.3] }"]);
    let mut text = "[world.custom]\nduration_s = 2\naccuracy = 'draft'\n[[world.custom.materials]]\nname = 'felt'\n\
                    friction = { uniform = [0.3, 0.6] }\nrestitution = 0.2\nrolling = 0.1\n"
        .to_owned();
    for body in ["a", "b"].iter().take(1 + below(stream, 2)) {
        let (shape, is_round) = shapes[below(stream, shapes.len())];
        let (x, y) = (place(stream, if *body == "a" { 0 } else { 400 }), place(stream, -20));
        let (vx, vy) = (speed(stream), speed(stream));
        let turn = if is_round { "" } else { "any_turn = true\n" };
        let spin = one_of(stream, &["{ normal = [0, 300] }", "0"]);
        text += &format!(
            "[[world.custom.bodies]]\nname = '{body}'\nmaterial = 'felt'\nshape = {shape}\nat_mm = [{x}, {y}, 60]\n\
             velocity_m_s = [{vx}, {vy}, 0]\nspin_deg_s = [{spin}, {spin}, 0]\n{turn}"
        );
    }
    text += &one_of(
        stream,
        &[
            "[[require]]\nrests_at = { body = 'a', x_mm = 40, within_mm = 30, scale_mm = 60 }\n",
            "[[require]]\ninside = { body = 'a', x_mm = [20, 90], y_mm = [-40, 30], scale_mm = 60 }\n",
            "[[require]]\ninside = { body = 'a', y_mm = [20, 50], scale_mm = 40 }\n",
            "[[require]]\nany = [\n{ rests_at = { body = 'a', x_mm = 60, within_mm = 30, scale_mm = 50 } },\n\
             { rests_at = { body = 'a', x_mm = -80, within_mm = 20, scale_mm = 60 } },\n]\n",
        ],
    );
    if text.contains("box") || text.contains("cylinder") {
        let body = if text.contains("any_turn") && !text.contains("shape = { ball") { "a" } else { "" };
        if !body.is_empty() {
            text += "[[require]]\nfaces_up = { body = 'a', axis = 'z', within_deg = 40, scale_deg = 60 }\n";
        }
    }
    text
}

/// What a step must keep: all numbers of a draw, where things end, and which axis is up.
fn statistics(stage: &Stage) -> Vec<Statistic<'_, <Stage as Target>::Draw, <Stage as Target>::Outcome>> {
    let scalars = stage.scalars();
    let count = scalars.len();
    let kept = scalars.into_iter().enumerate().filter(|(_, scalar)| !scalar.name.ends_with(".rest"));
    let value = move |k: usize| {
        move |state: &StateOf<Stage>| {
            let mut values = vec![0.0; count];
            stage.write_scalars(state.by_ref(), &mut values);
            values[k]
        }
    };
    kept.map(|(k, scalar)| Statistic::new(scalar.name, value(k))).collect()
}

/// Of exact draws of the target, what some steps of these moves make: 1,000 of them, and 1,000 to compare with. Of 100
/// such checks, one in 10,000 gives a false alarm.
fn checked(stage: &Stage, kernels: Vec<Only>, steps: u64) -> OneStepReport {
    let plan = OneStep { samples: 1000, steps, cells: 8, ..OneStep::default() };
    let kernels = kernels.into_iter().map(|kernel| -> (f64, Box<dyn Move<Stage>>) { (1.0, Box::new(kernel)) });
    let moves = Mixture::new(kernels.collect()).unwrap();
    one_step(stage, &moves, rejection(stage, LogPotential::ONE), &statistics(stage), plan).unwrap()
}

/// Each pair of states is one of a draw of the prior and what a move makes of it. The ratio is a function of the states
/// but for rounding, which a motion may amplify before it ends: so the tolerance is a thousandth of a nat.
fn check_ratios(stage: &Stage, kernel: &Only, text: &str) {
    let plan = Ratios { pairs: 60, tolerance: 1e-3, ..Ratios::default() };
    let report = ratios(stage, kernel, prior(stage), plan).unwrap();
    assert!(report.passed(), "{}: {report}\n{text}", kernel.name);
}

#[test]
fn exact_draws_stay_exact_in_many_worlds() {
    let mut seen = [0; MOVES.len()];
    for nth in 0..8 {
        let text = random_world(&mut Seed(11).chain(0).at(nth, Purpose::START));
        let stage = stage(&text);
        let has = |name: &str| names(&stage).iter().any(|one| one == name);
        let there: Vec<&str> = MOVES.into_iter().filter(|name| has(name)).collect();
        seen.iter_mut().zip(MOVES).for_each(|(seen, name)| *seen += i32::from(has(name)));
        let kernels = || there.iter().map(|name| only(&stage, name, Fault::None));
        let report = checked(&stage, kernels().collect(), 3);
        assert!(report.passed() && report.accepted() > 300, "{report}\n{text}");
        kernels().for_each(|kernel| check_ratios(&stage, &kernel, &text));
    }
    assert!(seen.iter().all(|&count| count > 2), "{seen:?}");
}

const DIE: &str = "
[world.custom]
duration_s = 2
accuracy = 'draft'
[[world.custom.bodies]]
name = 'die'
shape = { box = { size_mm = [16, 16, 16] } }
at_mm = [{ normal = [0, 20] }, { normal = [0, 20] }, 60]
any_turn = true
velocity_m_s = [{ normal = [0.2, 0.1] }, { normal = [0, 0.1] }, 0]
[[require]]
rests_at = { body = 'die', x_mm = 60, within_mm = 15, scale_mm = 30 }
[[require]]
faces_up = { body = 'die', within_deg = 20, scale_deg = 60 }
";

/// Without their ratios, a recast follows where it leads and not the laws, and a shift ends where it is wanted whatever
/// the law of its start is. A turn, a relabelling and a swap that let a number grow are caught, too.
#[test]
fn twins_are_caught() {
    let (die, pair) = (stage(DIE), stage(PAIR));
    for (stage, name, steps, fault) in [
        (&die, "recast", 3, Fault::Forgets),
        (&die, "shift", 12, Fault::Forgets),
        (&die, "turn", 2, Fault::Grows),
        (&die, "relabel", 2, Fault::Grows),
        (&pair, "swap", 2, Fault::Grows),
    ] {
        let right = checked(stage, vec![only(stage, name, Fault::None)], steps);
        assert!(right.passed() && right.accepted() > 200, "{name}: {right}");
        let wrong = checked(stage, vec![only(stage, name, fault)], steps);
        assert!(!wrong.passed(), "{name} is not caught: {wrong}");
    }
}

/// Two balls that begin by the same laws.
const PAIR: &str = "
[world.custom]
duration_s = 2
accuracy = 'draft'
[[world.custom.materials]]
name = 'felt'
rolling = 0.1
[[world.custom.bodies]]
name = 'ball'
count = 2
material = 'felt'
shape = { ball = { radius_mm = 12 } }
at_mm = ['200 * i + normal(10, 20)', { normal = [0, 20] }, 40]
velocity_m_s = [{ normal = [0, 0.1] }, 0, 0]
[[require]]
rests_at = { body = 'ball_2', x_mm = 220, within_mm = 15, scale_mm = 30 }
";

/// Bodies of an array may swap where something is asked of the end of one, and only if their laws are the same.
#[test]
fn equal_bodies_swap() {
    let swaps = |text: &str| names(&stage(text)).iter().any(|name| name == "swap");
    assert!(swaps(PAIR));
    assert!(!swaps(&PAIR.replace("normal(10, 20)", "normal(10, 20 + i)")));
    assert!(!swaps(&PAIR.replace("count = 2", "").replace("ball_2", "ball").replace("200 * i + ", "")));
    assert!(!swaps(&PAIR.replace(
        "rests_at = { body = 'ball_2', x_mm = 220, within_mm = 15, scale_mm = 30 }",
        "rests = { body = 'ball_2' }"
    )));
}

/// Ground that is not level, or anything beside it, leaves no such move; and each move needs what it changes.
#[test]
fn moves_are_there_where_the_world_lets_them_lead() {
    let moves = |text: &str| -> Vec<&str> {
        let names = names(&stage(text));
        MOVES.into_iter().filter(|name| names.iter().any(|one| one == name)).collect()
    };
    assert_eq!(moves(DIE), MOVES);
    let part = |text: &str| DIE.replace("[[require]]\nrests", &format!("{text}\n[[require]]\nrests"));
    let fixed = |text: &str| part(&format!("[[world.custom.fixed]]\nname = 'thing'\n{text}"));
    let none: [&str; 0] = [];
    assert_eq!(moves(&fixed("shape = { plane = {} }\nat_mm = [0, 0, -5]")), MOVES);
    for (text, wanted) in [
        (fixed("shape = { plane = {} }\nturn_deg = [1, 0, 0]"), &none[..]),
        (fixed("shape = { ball = { radius_mm = 5 } }\nat_mm = [900, 0, 0]"), &none),
        (
            DIE.replace("rests_at = { body = 'die', x_mm = 60, within_mm = 15, scale_mm = 30 }", "rests = {}"),
            &["recast", "relabel"],
        ),
        (DIE.replace("faces_up = { body = 'die', within_deg = 20, scale_deg = 60 }", "rests = {}"), &MOVES[..3]),
        (DIE.replace("[{ normal = [0, 20] }, { normal = [0, 20] }, 60]", "[0, 0, 60]"), &["recast", "relabel"]),
        (DIE.replace("{ normal = [0, 0.1] }", "0.1"), &["recast", "shift", "relabel"]),
        (DIE.replace("any_turn = true", "turn_deg = [10, 20, 30]"), &["recast", "shift"]),
        (DIE.replace("[[require]]\nrests_at", "[[require]]\nnot.rests_at"), &["recast", "relabel"]),
    ] {
        assert_eq!(moves(&text), wanted, "{text}");
    }
}
