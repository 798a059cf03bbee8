//! Every move of the library leaves prior and target invariant, for a draw that has a variable of every law. A wrong
//! twin of each does not.

use crate::toys::slots::{ANGLE, BALLS, FACE, FACES, HEIGHT, PINS, SIZE, SPEED, Slots, Things, VERTEX};
use plaus_dist::{Gaussian, LogPotential, LogRatio, Purpose, Seed, Stream, math, open_unit};
use plaus_mcmc::check::{OneStep, OneStepReport, PriorOnly, Ratios, Statistic, one_step, prior, ratios, rejection};
use plaus_mcmc::library::{
    Favoured, Learned, RedrawAll, RedrawGroup, RedrawOne, RedrawSome, ShiftAll, ShiftHalf, ShiftOne, ShiftSome, Sizes,
    Step, StepAll, Stride, Swap, Symmetry, Toggle,
};
use plaus_mcmc::view::lend;
use plaus_mcmc::{
    At, Fit, Law, Mixture, ModelError, Move, Proposal, Recipe, State, StateOf, StateRefOf, Target, Transition, Var,
    Variables, Vars, vars,
};

type AnyMove = Box<dyn Move<Slots>>;
type S<'a> = StateRefOf<'a, Slots>;

const PLAN: OneStep = OneStep { seed: Seed(3), samples: 20_000, steps: 1, cells: 16, false_alarm: 1e-6 };
const NUMBERS: [usize; 4] = [SPEED, SIZE, HEIGHT, ANGLE];
/// The variables that are neither optional nor without numbers.
const ALWAYS: [usize; 7] = [SPEED, SIZE, HEIGHT, ANGLE, PINS[0], PINS[1], VERTEX];

/// One step of `kernel` alone from exact draws, of the prior or with the constraint on.
fn step(kernel: AnyMove, constrained: bool) -> OneStepReport {
    let slots = Slots::new();
    let moves = Mixture::of(kernel);
    if constrained {
        return one_step(&slots, &moves, rejection(&slots, LogPotential::ONE), &statistics(), PLAN).unwrap();
    }
    let free = PriorOnly::new(&slots);
    one_step(&free, &lend::<PriorOnly<'_, Slots>>(moves).unwrap(), prior(&free), &statistics(), PLAN).unwrap()
}

fn statistics<'a>() -> Vec<Statistic<'a, Things, f64>> {
    vec![
        Statistic::new("speed", |state: &StateOf<Slots>| state.draw.speed + state.draw.shift),
        Statistic::new("size", |state: &StateOf<Slots>| state.draw.size),
        Statistic::new("height", |state: &StateOf<Slots>| state.draw.height),
        Statistic::new("room", |state: &StateOf<Slots>| state.draw.height - state.draw.size),
        Statistic::new("angle", |state: &StateOf<Slots>| state.draw.angle),
        Statistic::new("pin x", |state: &StateOf<Slots>| state.draw.pins[0][0]),
        Statistic::new("pin y", |state: &StateOf<Slots>| state.draw.pins[1][1]),
        Statistic::new("vertex", |state: &StateOf<Slots>| state.draw.vertex[0]),
        Statistic::new("balls", |state: &StateOf<Slots>| state.draw.balls.iter().flatten().count() as f64),
        Statistic::new("ball x", |state: &StateOf<Slots>| state.draw.balls[0].map_or(-1.0, |ball| ball[0])),
        Statistic::new("ball y", |state: &StateOf<Slots>| state.draw.balls[2].map_or(-1.0, |ball| ball[1])),
        Statistic::new("face", |state: &StateOf<Slots>| state.draw.face as f64),
        Statistic::new("outcome", |state: &StateOf<Slots>| state.outcome),
    ]
}

fn strides() -> Vec<Stride> {
    ALWAYS.map(|var| Stride { var, part: 0.3, of: 1.0 }).to_vec()
}

/// Exchanges left and right, and the pins with them.
fn mirrored(_: &Slots, _: S<'_>, draw: &mut Things, _: &mut Stream) -> bool {
    draw.pins.swap(0, 1);
    draw.pins.iter_mut().for_each(|pin| pin[0] = -pin[0]);
    true
}

/// Any other face, each equally likely.
fn turned(_: &Slots, _: S<'_>, draw: &mut Things, stream: &mut Stream) -> bool {
    draw.face = (draw.face + 1 + plaus_dist::stream::below(stream, FACES - 1)) % FACES;
    true
}

/// How many times as often a favoured variable is chosen.
const BY: f64 = 20.0;

/// What is favoured follows from a variable itself, and from the outcome, which every variable changes.
fn favours(_: &Slots, state: S<'_>) -> Vec<bool> {
    (0..=FACE).map(|var| (var == SIZE && state.draw.size > 1.5) || (var == ANGLE && *state.outcome > 5.0)).collect()
}

fn favoured() -> Favoured<Slots> {
    let (among, sizes) = ((0..=FACE).collect(), Sizes::new(0.2, 1.0));
    Favoured { name: "favoured", among, favours, by: BY, anew: 0.4, sizes }
}

/// The same without the ratio of the choice.
struct Blind(Favoured<Slots>);

impl Move<Slots> for Blind {
    fn name(&self) -> &str {
        "blind"
    }

    fn propose(&self, at: At<'_, Slots>, to: &mut Things, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let proposal = self.0.propose(at, to, stream)?;
        let Proposal::Candidate { log_ratio, path, .. } = proposal else { return Ok(proposal) };
        Ok(Proposal::with_ratio(log_ratio.times(self.0.log_ratio_after(at.to(at.state, path))?)?))
    }

    fn log_ratio(&self, step: Transition<'_, Slots>) -> Result<LogRatio, ModelError> {
        self.0.log_ratio(step)
    }
}

/// What a learning move could learn from states that satisfy the constraint, for each part.
fn fits(learned: &Learned) -> Vec<Option<Fit>> {
    let (slots, mut stream) = (Slots::new(), Seed(9).chain(0).at(0, Purpose(100)));
    let numbers: usize = learned.parts().iter().map(Vec::len).sum();
    let mut points = Vec::new();
    while points.len() < 40 * numbers {
        let state = State::evaluate(&slots, slots.start(&mut stream), &mut ()).unwrap();
        if math::ln(open_unit(&mut stream)) < state.log_constraint.value() {
            points.push(learned.point(&slots, &state.draw));
        }
    }
    let mut begin = 0;
    let of_part = |part: &Vec<usize>| {
        let of_point = |point: &Vec<f64>| point[begin..begin + part.len()].to_vec();
        let of_part: Vec<f64> = points.iter().flat_map(of_point).collect();
        begin += part.len();
        Some(Fit::to(&of_part, part.len()).unwrap())
    };
    learned.parts().iter().map(of_part).collect()
}

fn learned() -> Learned {
    Learned::of("learned", Slots::new().vars())
}

fn learned_some() -> Learned {
    Learned::some_of("learned_some", Slots::new().vars())
}

/// A learning move after it has learnt.
fn learnt(learned: &Learned) -> AnyMove {
    learned.at_fits(&fits(learned)).unwrap()
}

/// Every move of the library, with settings that make each of its ways likely.
fn all() -> Vec<AnyMove> {
    let toggle = Toggle { name: "toggle", among: BALLS.to_vec(), chance: 0.25, incomplete: false };
    let pins = PINS.to_vec();
    let walked = [PINS.as_slice(), &[VERTEX], &BALLS].concat();
    vec![
        Box::new(RedrawAll::exact("redraw_all")),
        Box::new(RedrawOne { name: "redraw_one", among: (0..=FACE).collect(), symmetric: false }),
        Box::new(RedrawSome { name: "redraw_some", among: walked.clone(), chance: 0.3 }),
        Box::new(RedrawGroup { name: "redraw_group" }),
        Box::new(ShiftHalf { name: "shift_half", among: NUMBERS.to_vec(), half_width: 0.5 }),
        Box::new(ShiftSome { name: "shift_some", among: walked.clone(), chance: 0.4, sd: 0.3, adapts: true }),
        Box::new(ShiftOne { name: "shift_one", among: walked, sd: 0.5 }),
        Box::new(ShiftAll::by("shift_all", strides())),
        Box::new(ShiftAll::at_many_scales("refine", strides(), Sizes::down_to(0.01))),
        Box::new(Step::of("step", &(0..=FACE).collect::<Vec<_>>(), Sizes::new(0.2, 1.0))),
        Box::new(StepAll { name: "step_all", among: (0..=FACE).collect(), sizes: Sizes::new(0.2, 1.0) }),
        Box::new(favoured()),
        Box::new(Swap { name: "swap", among: BALLS.to_vec() }),
        Box::new(Swap { name: "swap_pins", among: pins }),
        Box::new(Symmetry { name: "mirror", map: mirrored }),
        Box::new(Symmetry { name: "turn", map: turned }),
        Box::new(toggle),
        Box::new(learned()),
        learnt(&learned()),
        Box::new(learned_some()),
        learnt(&learned_some()),
    ]
}

#[test]
fn every_move_leaves_prior_and_target_invariant() {
    for constrained in [false, true] {
        for kernel in all() {
            let report = step(kernel, constrained);
            assert!(report.passed() && report.accepted() > 1000, "{report}");
        }
    }
}

#[test]
fn steps_near_an_adapted_scale_leave_them_invariant_too() {
    let adapted = |kernel: AnyMove| {
        let scales = kernel.scales();
        assert!(scales.iter().all(|scale| scale.least < scale.start && scale.start < scale.most));
        kernel.at_scales(&vec![Some(0.4); scales.len()])
    };
    let kernels: Vec<AnyMove> = all().into_iter().filter_map(adapted).collect();
    assert_eq!(kernels.len(), 8);
    for kernel in kernels {
        let report = step(kernel, true);
        assert!(report.passed() && report.accepted() > 1000, "{report}");
    }
}

#[test]
fn ratios_agree_with_their_reverse() {
    let slots = Slots::new();
    for kernel in all() {
        let report = ratios(&slots, kernel.as_ref(), prior(&slots), Ratios::default()).unwrap();
        assert!(report.passed(), "{report}");
    }
}

/// How a right move is made wrong.
#[derive(Clone, Copy, Debug)]
enum Fault {
    /// Uses the ratio 1, whatever the right one is.
    Symmetric,
    /// Steps have a mean.
    Leans,
    /// A value that leaves an interval stops at its end.
    Clamps,
    /// The first of two values never exceeds the second.
    Sorts,
    /// A map that is not its own reverse.
    Folds,
}

struct Twin(AnyMove, Fault);

impl Move<Slots> for Twin {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn propose(&self, at: At<'_, Slots>, to: &mut Things, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let proposal = self.0.propose(at, to, stream)?;
        if proposal == Proposal::Stay {
            return Ok(proposal);
        }
        match self.1 {
            Fault::Symmetric => return Ok(Proposal::SYMMETRIC),
            Fault::Leans => {
                to.speed += if to.speed == at.state.draw.speed { 0.0 } else { 0.1 };
                to.vertex[0] += if to.vertex == at.state.draw.vertex { 0.0 } else { 0.05 };
            }
            Fault::Clamps => {
                for (ball, before) in to.balls.iter_mut().zip(&at.state.draw.balls) {
                    if let (Some(ball), Some(before)) = (ball, before)
                        && (ball[0] - before[0]).abs() > 1.0
                    {
                        ball[0] = if ball[0] > before[0] { 0.0 } else { 2.0_f64.next_down() };
                    }
                }
            }
            Fault::Sorts if to.pins[0][0] > to.pins[1][0] => return Ok(Proposal::Stay),
            Fault::Sorts => (),
            Fault::Folds => {
                to.pins[0][0] = to.pins[0][0].abs();
                to.face = to.face.min(FACES - 2);
            }
        }
        Ok(proposal)
    }

    fn log_ratio(&self, step: Transition<'_, Slots>) -> Result<LogRatio, ModelError> {
        self.0.log_ratio(step)
    }
}

/// How a learnt move is mistaken about the density of its own proposals.
#[derive(Clone, Copy)]
enum Slip {
    /// It is right.
    None,
    /// It uses the fit's density, even if the laws made the proposal.
    FitAlone,
    /// It uses the mixture's density without regard to the variables that stay.
    Unconditional,
}

struct Slipping(AnyMove, Learned, Vec<Option<Fit>>, Slip);

impl Move<Slots> for Slipping {
    fn name(&self) -> &str {
        "learned"
    }

    fn propose(&self, at: At<'_, Slots>, to: &mut Things, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let proposal = self.0.propose(at, to, stream)?;
        let Proposal::Candidate { log_ratio, path, .. } = proposal else { return Ok(proposal) };
        let chosen = self.1.chosen(path);
        let (known, fit) = (chosen.known, self.2[chosen.part].as_ref().unwrap().ordered(&chosen.order).unwrap());
        let begin: usize = self.1.parts()[..chosen.part].iter().map(Vec::len).sum();
        let point = |draw: &Things| {
            let all = self.1.point(at.target, draw);
            chosen.order.iter().map(|&k| all[begin + k]).collect::<Vec<f64>>()
        };
        let (old, new) = (point(at.state.draw), point(to));
        let wrong = match self.3 {
            Slip::None => log_ratio.value(),
            Slip::FitAlone => fit.log_density(&old, known) - fit.log_density(&new, known),
            // Variables that are not chosen are moved to the other ones' mean, so that old and new no longer have them
            // in common.
            Slip::Unconditional => {
                let apart = |point: &[f64]| {
                    let moved: Vec<f64> =
                        point.iter().enumerate().map(|(k, x)| if k < known { 1.0 } else { *x }).collect();
                    fit.log_density(&moved, known) - fit.log_density(point, known)
                };
                log_ratio.value() + apart(&old) - apart(&new)
            }
        };
        Ok(Proposal::with_ratio(LogRatio::new(wrong)?))
    }

    fn log_ratio(&self, step: Transition<'_, Slots>) -> Result<LogRatio, ModelError> {
        self.0.log_ratio(step)
    }
}

/// Two kinds of variables are not learnt: one that another depends on, and one that is not shown.
#[test]
fn learnt_variables_have_densities_of_their_own() {
    assert_eq!(learned().parts(), [[SPEED, ANGLE]]);
    assert_eq!(learned_some().parts(), [[SPEED, ANGLE]]);
    let laws = || Law::Gaussian(Gaussian::new(0.0, 1.0).unwrap());
    let of_body = |k: usize| Var::new("x", "", laws()).of("body", 1 + k as u32 % 2).column(1.0);
    let vars = Vars::new((0..7).map(of_body).chain((0..20).map(|_| Var::new("y", "", laws()).column(1.0))).collect());
    let sizes: Vec<usize> = Learned::some_of("learned_some", &vars).parts().iter().map(Vec::len).collect();
    assert_eq!(sizes, [16, 4, 4, 3], "what belongs to no body, then bodies");
}

#[test]
fn wrong_twins_are_caught() {
    // Any fit will do. In this one angles follow speeds, so it matters which variables are given.
    let mut stream = Seed(9).chain(0).at(0, Purpose(101));
    let mut steep = |_| {
        let [x, y] = [(); 2].map(|()| plaus_dist::standard_normal(&mut stream));
        [2.2 + x, 0.3 + 0.6 * x + 0.1 * y]
    };
    let steep = vec![Fit::to(&(0..80).flat_map(&mut steep).collect::<Vec<f64>>(), 2)];
    let slipping = |learned: Learned, slip| {
        let right = learned.at_fits(&steep).unwrap();
        if let Slip::None = slip { right } else { Box::new(Slipping(right, learned, steep.clone(), slip)) }
    };
    let report = step(slipping(learned_some(), Slip::None), false);
    assert!(report.passed() && report.accepted() > 1000, "{report}");
    let errata: [AnyMove; 8] = [
        Box::new(Blind(favoured())),
        slipping(learned(), Slip::FitAlone),
        slipping(learned_some(), Slip::FitAlone),
        slipping(learned_some(), Slip::Unconditional),
        Box::new(RedrawAll { symmetric: true, ..RedrawAll::exact("redraw_all") }),
        Box::new(RedrawAll { recipe: Recipe::Radial, ..RedrawAll::exact("redraw_all") }),
        Box::new(RedrawOne { name: "redraw_one", among: NUMBERS.to_vec(), symmetric: true }),
        Box::new(Toggle { name: "toggle", among: BALLS.to_vec(), chance: 0.25, incomplete: true }),
    ];
    let fault = |name: &str| match name {
        "redraw_all" | "redraw_one" | "redraw_some" | "redraw_group" | "step" | "step_all" | "favoured" | "toggle"
        | "learned" | "learned_some" => Fault::Symmetric,
        "shift_half" | "shift_some" | "shift_all" | "refine" => Fault::Leans,
        "shift_one" => Fault::Clamps,
        "swap" | "swap_pins" => Fault::Sorts,
        _ => Fault::Folds,
    };
    // The order of balls does not matter to where they come to lie. Of the exchanges, only those of the pins show the
    // fault.
    let right = all().into_iter().filter(|kernel| kernel.name() != "swap");
    let twins = right.map(|kernel| {
        let fault = fault(kernel.name());
        Box::new(Twin(kernel, fault)) as AnyMove
    });
    for twin in errata.into_iter().chain(twins) {
        let report = step(twin, false);
        assert!(!report.passed(), "not caught: {report}");
    }
}

/// The density of a whole draw is the sum of its variables' densities, and of ½ for each variable that may be missing.
#[test]
fn densities_add_up() {
    let slots = Slots::new();
    let draw = slots.start(&mut Seed(1).chain(0).at(0, plaus_dist::Purpose::START));
    let parts = vars::log_density_of(&slots, &draw, 0..=FACE).unwrap().value();
    let whole = slots.log_prior(&draw).unwrap().value();
    // A dozen roundings of terms below 10.
    assert!((whole - parts + 3.0 * std::f64::consts::LN_2).abs() < 1e-13, "{whole} {parts}");
    let lower = Things { height: draw.size - 1e-9, ..draw };
    assert!(slots.log_prior(&lower).unwrap().is_zero(), "the height is above the size");
}
