//! Moves that follow from what a world is: throws of bodies that meet only level planes are led to where they should
//! end, shifted, turned and relabelled. Each leaves exact draws of the target what they are, in many random worlds, and
//! a twin without its ratio does not.

use plaus_dist::stream::below;
use plaus_dist::{LogPotential, LogRatio, Purpose, Seed, Stream};
use plaus_mcmc::check::{OneStep, OneStepReport, Ratios, Statistic, one_step, prior, ratios, rejection};
use plaus_mcmc::{At, Mixture, ModelError, Move, Path, Proposal, StateOf, Target, Transition};
use plaus_scenes::{Rules, Scenario, Scene, Stage};
use std::sync::Arc;

type Kernel = Arc<dyn Move<Stage>>;

/// One of the stage's moves, or a twin of it that takes its ratio for 1.
struct Only {
    all: Mixture<Stage>,
    name: &'static str,
    forgets: bool,
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
        Ok(if self.forgets && proposal != Proposal::Stay { Proposal::SYMMETRIC } else { proposal })
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

fn only(stage: &Stage, name: &'static str, forgets: bool) -> Only {
    Only { all: stage.moves(&Rules::default()).unwrap(), name, forgets }
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

/// 25 worlds with three or four moves each: with a false alarm in 10⁶ checks, none is expected.
fn checked(stage: &Stage, kernel: Only, steps: u64) -> OneStepReport {
    let plan = OneStep { samples: 1000, steps, cells: 8, ..OneStep::default() };
    one_step(stage, &Mixture::of(Box::new(kernel)), rejection(stage, LogPotential::ONE), &statistics(stage), plan)
        .unwrap()
}

#[test]
fn exact_draws_stay_exact_in_many_worlds() {
    let mut accepted = [0; MOVES.len()];
    for nth in 0..16 {
        let text = random_world(&mut Seed(11).chain(0).at(nth, Purpose::START));
        let stage = stage(&text);
        for (k, name) in MOVES.into_iter().enumerate().filter(|(_, name)| names(&stage).iter().any(|one| one == name)) {
            let report = checked(&stage, only(&stage, name, false), 1);
            assert!(report.passed(), "{name}: {report}\n{text}");
            accepted[k] += report.accepted();
            let kernel = only(&stage, name, false);
            let report = ratios(&stage, &kernel, prior(&stage), Ratios { pairs: 100, ..Ratios::default() }).unwrap();
            assert!(report.passed(), "{name}: {report}\n{text}");
        }
    }
    assert!(accepted.iter().all(|&count| count > 500), "{accepted:?}");
}

const DIE: &str = "
[world.custom]
duration_s = 2
accuracy = 'draft'
[[world.custom.bodies]]
name = 'die'
shape = { box = { size_mm = [16, 16, 16] } }
at_mm = [{ normal = [0, 30] }, { normal = [0, 30] }, 60]
any_turn = true
velocity_m_s = [{ normal = [0.2, 0.2] }, { normal = [0, 0.2] }, 0]
[[require]]
rests_at = { body = 'die', x_mm = 60, within_mm = 30, scale_mm = 60 }
[[require]]
faces_up = { body = 'die', within_deg = 20, scale_deg = 60 }
";

/// Without their ratios, a recast follows where it leads and not the laws, and a shift ends where it is wanted whatever
/// the law of its start is.
#[test]
fn twins_without_their_ratios_are_caught() {
    let stage = stage(DIE);
    for name in ["recast", "shift"] {
        let right = checked(&stage, only(&stage, name, false), 3);
        assert!(right.passed() && right.accepted() > 300, "{name}: {right}");
        let wrong = checked(&stage, only(&stage, name, true), 3);
        assert!(!wrong.passed(), "{name} is not caught: {wrong}");
    }
}
