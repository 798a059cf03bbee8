//! Every move leaves the prior and the constrained target invariant. Moves with typical mistakes do not.

use super::straight::{AnyMove, Straight, all_moves, learnt, shifted, small, statistics};
use plaus_dist::{LogPotential, Stream};
use plaus_mcmc::check::{OneStep, OneStepReport, Ratios, any_of, one_step, prior, ratios, rejection, visited};
use plaus_mcmc::library::{RedrawAll, RedrawOne, RedrawSome, Symmetry};
use plaus_mcmc::view::lend;
use plaus_mcmc::{At, Mixture, ModelError, Move, Proposal, Recipe, StateRefOf, Transition, Variables};
use plaus_scenes::bowling::{Aim, Bowling, Config, Delivery, Quantity, Shot, mirror};
use plaus_scenes::{Rules, Scene};

const PLAN: OneStep = OneStep { seed: plaus_dist::Seed(0), samples: 20_000, steps: 1, cells: 16, false_alarm: 1e-6 };

/// One step of `kernel` alone from exact draws: of the prior if λ = 1, otherwise of the target.
fn step(scene: &Bowling, kernel: AnyMove) -> OneStepReport {
    let toy = Straight(scene);
    let moves = lend::<Straight>(Mixture::of(kernel)).unwrap();
    if scene.config().ln_lambda == 0.0 {
        return one_step(&toy, &moves, prior(&toy), &statistics(scene), PLAN).unwrap();
    }
    // Three pins, and one that has not moved far.
    let bound = LogPotential::new(scene.config().ln_lambda * 4.0).unwrap();
    one_step(&toy, &moves, rejection(&toy, bound), &statistics(scene), PLAN).unwrap()
}

#[test]
fn every_move_leaves_prior_and_target_invariant() {
    for ln_lambda in [0.0, 1.0] {
        let scene = small(ln_lambda, Delivery::Regulation);
        for kernel in all_moves(&scene) {
            let report = step(&scene, kernel);
            assert!(report.passed(), "{report}");
            assert!(report.accepted() > 500, "{report}");
        }
    }
}

/// Where left and right may not be exchanged, an aim learns the place itself. The twin that proposes either side with
/// the density of one is caught.
#[test]
fn an_aim_tells_sides_apart_where_they_differ() {
    let symmetric = small(0.0, Delivery::Regulation);
    let sided = super::straight::scene(|config| *config = Config { leave: vec![4], ..symmetric.config().clone() });
    let aim = |scene| learnt(scene, &Aim::new(scene, 0.5), false);
    let report = step(&sided, aim(&sided));
    assert!(report.passed() && report.accepted() > 500, "{report}");
    let (proposes, ratio) = (aim(&symmetric), aim(&sided));
    let report = step(&symmetric, Box::new(Taught { proposes, ratio, of: Some(sided) }));
    assert!(!report.passed(), "not caught: {report}");
}

#[test]
fn ratios_agree_with_their_reverse() {
    for delivery in [Delivery::Paper, Delivery::Regulation] {
        let scene = small(1.0, delivery);
        let toy = Straight(&scene);
        let mixture = lend::<Straight>(scene.moves(&Rules::exact()).unwrap()).unwrap();
        let states = visited(&toy, &mixture, plaus_dist::Seed(5), 5, 2000).unwrap();
        for kernel in all_moves(&scene) {
            let moves = lend::<Straight>(Mixture::of(kernel)).unwrap();
            let (_, lent) = moves.iter().next().unwrap();
            let report = ratios(&toy, lent, any_of(&states), Ratios::default()).unwrap();
            assert!(report.passed(), "{report}");
        }
    }
}

/// How a right move is made wrong.
#[derive(Clone, Copy, Debug)]
enum Fault {
    /// Uses the ratio 1, whatever the right one is.
    Symmetric,
    /// A radius that leaves its interval is moved to the interval's end.
    Clamps,
    /// Steps of the speed have a mean.
    Leans,
    /// The mirror image keeps its drift.
    Forgets,
}

struct Faulty(AnyMove, Fault);

impl Move<Bowling> for Faulty {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn propose(&self, at: At<'_, Bowling>, candidate: &mut Shot, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let proposal = self.0.propose(at, candidate, stream)?;
        if proposal == Proposal::Stay {
            return Ok(proposal);
        }
        let [radius, speed, drift] = [Quantity::Radius, Quantity::Speed, Quantity::Drift].map(|q| q as usize);
        match self.1 {
            Fault::Symmetric => return Ok(Proposal::SYMMETRIC),
            Fault::Clamps => {
                // A step of more than half the interval went around.
                let step = candidate.ball[radius] - at.state.draw.ball[radius];
                if step.abs() > 0.5 * (0.10916 - 0.10795) {
                    candidate.ball[radius] = if step > 0.0 { 0.10795 } else { 0.10916_f64.next_down() };
                }
            }
            Fault::Leans => candidate.ball[speed] += 0.1,
            // Some other map that is not its own inverse: drifts of one sign only.
            Fault::Forgets => candidate.ball[drift] = at.state.draw.ball[drift].abs(),
        }
        Ok(proposal)
    }

    fn log_ratio(&self, step: Transition<'_, Bowling>) -> Result<plaus_dist::LogRatio, ModelError> {
        self.0.log_ratio(step)
    }
}

/// An aim that proposes what it learnt, with the ratio of another aim, or of another scene.
struct Taught {
    proposes: AnyMove,
    ratio: AnyMove,
    of: Option<Bowling>,
}

impl Move<Bowling> for Taught {
    fn name(&self) -> &str {
        self.proposes.name()
    }

    fn propose(&self, at: At<'_, Bowling>, candidate: &mut Shot, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let proposal = self.proposes.propose(at, candidate, stream)?;
        let Some(path) = proposal.path() else { return Ok(proposal) };
        // An aim looks at draws alone.
        let to = StateRefOf::<Bowling> { draw: &*candidate, ..at.state };
        let scene = self.of.as_ref().unwrap_or(at.target);
        Ok(Proposal::with_ratio(self.ratio.log_ratio(At { target: scene, ..at }.to(to, path))?))
    }

    fn log_ratio(&self, step: Transition<'_, Bowling>) -> Result<plaus_dist::LogRatio, ModelError> {
        self.ratio.log_ratio(step)
    }
}

#[test]
fn wrong_twins_are_caught() {
    let scene = small(0.0, Delivery::Regulation);
    let (ball, pins) = (scene.vars().which(|var| var.member.is_none()), scene.vars().named(&["offset"]));
    let (all, aim) = (RedrawAll::exact("change_all"), Aim::new(&scene, 0.5));
    let twins: Vec<AnyMove> = vec![
        // The paper's errors.
        Box::new(RedrawAll { symmetric: true, ..all }),
        Box::new(RedrawAll { recipe: Recipe::Radial, ..all }),
        Box::new(RedrawOne { name: "redraw", among: ball, symmetric: true }),
        Box::new(Faulty(Box::new(RedrawSome { name: "redraw_pins", among: pins, chance: 0.3 }), Fault::Symmetric)),
        Box::new(Faulty(Box::new(Aim::new(&scene, 0.0)), Fault::Symmetric)),
        Box::new(Faulty(Box::new(Aim::new(&scene, 1.0)), Fault::Symmetric)),
        // Learnt proposals, with the ratio of an aim that has learnt nothing, or has its place depend on another
        // number.
        Box::new(Taught { proposes: learnt(&scene, &aim, false), ratio: Box::new(aim.clone()), of: None }),
        Box::new(Taught { proposes: learnt(&scene, &aim, false), ratio: learnt(&scene, &aim, true), of: None }),
        Box::new(Faulty(shifted(&scene, &[Quantity::Radius]), Fault::Clamps)),
        Box::new(Faulty(shifted(&scene, &[Quantity::Speed, Quantity::Drift]), Fault::Leans)),
        Box::new(Faulty(Box::new(Symmetry { name: "mirror", map: mirror }), Fault::Forgets)),
    ];
    for twin in twins {
        let report = step(&scene, twin);
        assert!(!report.passed(), "not caught: {report}");
    }
}

/// A height drawn for one radius does not have the law for another radius: the truncation's mass must be part of the
/// ratio. At the paper's height a ball of the largest radius touches the lane if its height is one standard deviation
/// below the mean.
#[test]
fn a_shift_of_the_radius_keeps_the_height_s_law() {
    let scene = super::straight::scene(|config| config.ln_lambda = 0.0);
    let report = step(&scene, shifted(&scene, &[Quantity::Radius]));
    assert!(report.passed() && report.accepted() > 10_000, "{report}");
}
