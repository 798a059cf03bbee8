//! Moves with typical mistakes, the paper's errors among them. Each is caught by the check that the right move passes.

use super::moves::{constrained, free};
use super::straight::{AnyMove, change_ball, change_vertices, redraw_vertices, small, toggle};
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::library::RedrawAll;
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, Recipe, Target, Transition, Variables};
use plaus_scenes::spelling::{BirthDeath, Drops, Redrop, Spelling};
use plaus_scenes::{Rules, Scene};

/// How a right move is made wrong.
#[derive(Clone, Copy, Debug)]
enum Fault {
    /// Uses the ratio 1, whatever the right one is.
    Symmetric,
    /// Leaves out the part of the ratio that is known only after the simulation.
    Forgets,
    /// Measures the area of the drop rectangle in another unit: m² instead of mm².
    Unit,
    /// Positions that leave the rectangle are moved to its edge.
    Clamps,
    /// Steps have a mean.
    Leans,
}

struct Faulty(AnyMove, Fault);

impl Move<Spelling> for Faulty {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn propose(
        &self,
        at: At<'_, Spelling>,
        candidate: &mut Drops,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let proposal = self.0.propose(at, candidate, stream)?;
        let Proposal::Candidate { log_ratio, path, later } = proposal else { return Ok(proposal) };
        let ring = at.target.rectangle().sides();
        Ok(match self.1 {
            Fault::Symmetric => Proposal::SYMMETRIC,
            Fault::Forgets => {
                Proposal::Candidate { log_ratio: log_ratio.times(later.unwrap_or(LogRatio::ONE))?, path, later: None }
            }
            Fault::Unit => {
                let balls = candidate.active() as f64 - at.state.draw.active() as f64;
                Proposal::Candidate {
                    log_ratio: LogRatio::new(log_ratio.value() - balls * math::ln(1e6))?,
                    path,
                    later,
                }
            }
            Fault::Clamps => {
                for (new, old) in candidate.balls.iter_mut().zip(&at.state.draw.balls) {
                    if let (Some(new), Some(old)) = (new, old) {
                        for axis in 0..2 {
                            // A step of more than half the rectangle went around.
                            let (low, high) = (ring[axis].low(), ring[axis].high());
                            if (new[axis] - old[axis]).abs() > 0.5 * (high - low) {
                                new[axis] = if new[axis] > old[axis] { low } else { high.next_down() };
                            }
                        }
                    }
                }
                proposal
            }
            Fault::Leans => {
                for (new, old) in candidate.offsets.iter_mut().zip(&at.state.draw.offsets) {
                    if new != old {
                        new[0] += 0.02;
                    }
                }
                proposal
            }
        })
    }

    fn log_ratio(&self, step: Transition<'_, Spelling>) -> Result<LogRatio, ModelError> {
        self.0.log_ratio(step)
    }

    fn reverse(&self, path: Path) -> Path {
        self.0.reverse(path)
    }

    fn log_ratio_after(&self, step: Transition<'_, Spelling>) -> Result<LogRatio, ModelError> {
        self.0.log_ratio_after(step)
    }
}

#[test]
fn the_paper_s_errata_change_the_law() {
    let all = |symmetric, recipe| Box::new(RedrawAll { name: "change_all", symmetric, recipe });
    let twins: Vec<AnyMove> = vec![
        all(true, Recipe::Exact),
        all(false, Recipe::Radial),
        all(true, Recipe::Radial),
        Box::new(toggle(&small(0.0), true)),
    ];
    for twin in twins {
        let report = free(&small(0.0), twin);
        assert!(!report.passed(), "not caught: {report}");
    }
}

#[test]
fn other_faults_change_the_law() {
    let scene = small(0.0);
    let twins: Vec<(AnyMove, Fault)> = vec![
        (Box::new(toggle(&scene, false)), Fault::Symmetric),
        (Box::new(toggle(&scene, false)), Fault::Unit),
        (Box::new(BirthDeath { aimed: 0.7 }), Fault::Symmetric),
        (Box::new(BirthDeath { aimed: 0.7 }), Fault::Forgets),
        (Box::new(BirthDeath { aimed: 0.7 }), Fault::Unit),
        (redraw_vertices(&scene), Fault::Symmetric),
        (Box::new(Redrop { aimed: 0.7 }), Fault::Symmetric),
        (Box::new(Redrop { aimed: 0.7 }), Fault::Forgets),
        (change_ball(&scene), Fault::Clamps),
        (change_vertices(&scene), Fault::Leans),
    ];
    for (kernel, fault) in twins {
        let report = free(&scene, Box::new(Faulty(kernel, fault)));
        assert!(!report.passed(), "{fault:?} not caught: {report}");
    }
    // With the constraint on, the fault of aiming shows even more.
    let report = constrained(&small(1.0), Box::new(Faulty(Box::new(Redrop { aimed: 0.7 }), Fault::Symmetric)));
    assert!(!report.passed(), "not caught: {report}");
}

/// Under the Gaussian, a fresh radial draw is likelier than a draw of the Gaussian itself, by about a nat per vertex.
/// This is the effect of the paper's change-all.
#[test]
fn radial_offsets_gain_a_nat_a_vertex() {
    let scene = super::straight::scene(|_| ());
    let mean = |recipe: Recipe| {
        let mut stream = plaus_dist::Seed(1).chain(0).at(0, plaus_dist::Purpose::START);
        let mut draw = scene.start(&mut stream);
        let sum: f64 = (0..20_000)
            .map(|_| {
                scene.renew_all(&mut draw, recipe, &mut stream);
                draw.offsets.iter().flatten().map(|x| -0.5 * math::square(x / 0.1)).sum::<f64>()
            })
            .sum();
        sum / 20_000.0
    };
    // −V/2 compared with −3V/2, for V = 48. A draw has a variance of 48 · ½ or 144 · ½, so six standard errors of the
    // means are 0.21 and 0.36.
    assert!((mean(Recipe::Radial) + 24.0).abs() < 0.21, "{}", mean(Recipe::Radial));
    assert!((mean(Recipe::Exact) + 72.0).abs() < 0.36, "{}", mean(Recipe::Exact));
}

#[test]
fn rules_reach_the_moves_flag_by_flag() {
    let scene = small(0.0);
    let rules = |text: &str| -> Rules {
        let scenario = format!("[sampler.rules]\n{text}\n[world.spelling]");
        plaus_scenes::Scenario::read("rules", &scenario, &[]).unwrap().sampler.rules
    };
    assert!(scene.moves(&Rules::exact()).is_ok() && Rules::exact().is_exact());
    let flags =
        |text: &str| rules(text).flags().into_iter().filter(|flag| flag.1).map(|flag| flag.0).collect::<Vec<_>>();
    assert_eq!(flags("preset = \"as-printed\""), ["symmetric_redraws", "radial_offsets", "incomplete_toggles"]);
    assert_eq!(flags("radial_offsets = true"), ["radial_offsets"]);
    assert_eq!(flags("preset = \"as-printed\"\nradial_offsets = false"), ["symmetric_redraws", "incomplete_toggles"]);
    assert_eq!(flags("incomplete_toggles = true"), ["incomplete_toggles"]);
}
